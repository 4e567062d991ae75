//! Scenario files: what is uncertain, what flies, how often.

mod body;
mod file;
mod model;

use gyradius_separation::{Separation, Settings, Spring};
use nalgebra::{Unit, Vector3};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

pub(crate) use body::UncertainBody;
pub(crate) use file::AxesFile as Axes;
use file::ScenarioFile;
pub(crate) use model::{Comparison, Law, ModelSpec};

const PECK_2003: &str = include_str!("peck-2003.toml");

/// Most runs of a model in one study: what fits into memory.
const MAX_RUNS: u64 = 10_000_000;

/// Why a scenario is refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ScenarioError {
    /// The file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The file is not TOML, or has a wrong, missing or unknown key.
    #[error("{}{message}", path.as_ref().map(|p| format!("{}: ", p.display())).unwrap_or_default())]
    Parse {
        /// The file, if it came from one.
        path: Option<PathBuf>,
        /// What, with the place.
        message: String,
    },
    /// A value is not allowed.
    #[error("{field}: {problem}")]
    Field {
        /// The key, as in the file.
        field: String,
        /// The value and what is allowed.
        problem: String,
    },
}

impl ScenarioError {
    #[allow(clippy::needless_pass_by_value, reason = "errors are given away as they come")]
    pub(crate) fn field(field: impl Into<String>, problem: impl std::fmt::Display) -> Self {
        Self::Field { field: field.into(), problem: format!("{problem}") }
    }
}

/// A study to be run: bodies with their uncertainty, springs, models, how many runs from which
/// seed. Everything has been checked.
#[derive(Clone, Debug)]
pub struct Scenario {
    file: ScenarioFile,
    spin_axis: Unit<Vector3<f64>>,
    payload: UncertainBody,
    stage: UncertainBody,
    separation: Separation,
    settings: Settings,
    models: Vec<ModelSpec>,
    comparisons: Vec<Comparison>,
}

impl Scenario {
    /// The separation study of Peck (2003), under four models.
    ///
    /// # Errors
    /// None: the built-in file is tested. The signature is that of every other way in.
    pub fn peck_2003() -> Result<Self, ScenarioError> {
        Self::from_toml(PECK_2003)
    }

    /// Reads a scenario file.
    ///
    /// # Errors
    /// The file cannot be read, is not TOML, has an unknown key, or a value that is not allowed.
    pub fn read(path: &Path) -> Result<Self, ScenarioError> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| ScenarioError::Read { path: path.to_owned(), source })?;
        Self::from_toml(&text).map_err(|error| match error {
            ScenarioError::Parse { message, .. } => {
                ScenarioError::Parse { path: Some(path.to_owned()), message }
            }
            ScenarioError::Field { field, problem } => {
                ScenarioError::Field { field: format!("{}: {field}", path.display()), problem }
            }
            other => other,
        })
    }

    /// Reads a scenario from the text of a file.
    ///
    /// # Errors
    /// It is not TOML, has an unknown key, or a value that is not allowed.
    pub fn from_toml(text: &str) -> Result<Self, ScenarioError> {
        let file: ScenarioFile = toml::from_str(text).map_err(|error| ScenarioError::Parse {
            path: None,
            message: error.to_string().trim_end().to_owned(),
        })?;
        Self::check(file)
    }

    /// The same scenario with another number of runs for each model.
    ///
    /// # Errors
    /// The number is zero or beyond ten million.
    pub fn with_runs(self, runs: u64) -> Result<Self, ScenarioError> {
        check_runs(runs)?;
        Ok(Self { file: ScenarioFile { runs, ..self.file }, ..self })
    }

    /// The same scenario from another seed.
    ///
    /// # Errors
    /// The seed does not fit into a TOML integer.
    pub fn with_seed(self, seed: u64) -> Result<Self, ScenarioError> {
        check_seed(seed)?;
        Ok(Self { file: ScenarioFile { seed, ..self.file }, ..self })
    }

    fn check(mut file: ScenarioFile) -> Result<Self, ScenarioError> {
        file.models.iter_mut().for_each(file::ModelFile::fill);
        check_name("name", &file.name)?;
        check_runs(file.runs)?;
        check_seed(file.seed)?;
        let axis = Vector3::from(file.spin_axis);
        // Scaled first: the norm of 1e300 overflows.
        let spin_axis = Unit::try_new(axis / axis.amax(), 0.0)
            .filter(|u| u.iter().all(|x| x.is_finite()))
            .ok_or_else(|| {
                let problem = format!("{:?}: it must be finite and not zero", file.spin_axis);
                ScenarioError::field("spin_axis", problem)
            })?;
        if let Some(source) = &file.source {
            let values =
                [("inertia_ratio", source.inertia_ratio), ("wobble_deg", source.wobble_deg)];
            for (field, value) in values {
                if let Some(x) = value.filter(|x| !(*x >= 0.0 && *x < 1e3)) {
                    let problem = format!("{x:?}: it must lie in [0, 1000)");
                    return Err(ScenarioError::field(format!("source.{field}"), problem));
                }
            }
        }
        let payload = UncertainBody::new("payload", &file.payload)?;
        let stage = UncertainBody::new("stage", &file.stage)?;
        let springs = file
            .springs
            .iter()
            .enumerate()
            .map(|(i, s)| {
                let (p, l) = (s.payload_point_m.into(), s.stage_point_m.into());
                Spring::new(s.stiffness_n_per_m, s.stroke_m, p, l)
                    .map_err(|e| ScenarioError::field(format!("springs[{}]", i + 1), e))
            })
            .collect::<Result<Vec<_>, _>>()?;
        let separation = Separation::new(*payload.moving(), *stage.moving(), &springs)
            .map_err(|e| ScenarioError::field("springs", e))?;
        let settings =
            Settings::new(file.integration.relative_tolerance, file.integration.horizon_s)
                .map_err(|e| ScenarioError::field("integration", e))?;
        let models = model::check_models(&file.models, [&payload, &stage])?;
        let comparisons = model::check_comparisons(&file.comparisons, &models)?;
        Ok(Self { file, spin_axis, payload, stage, separation, settings, models, comparisons })
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.file.name
    }

    /// Runs of each model.
    #[must_use]
    pub fn runs(&self) -> u64 {
        self.file.runs
    }

    /// Seed of all random streams.
    #[must_use]
    pub fn seed(&self) -> u64 {
        self.file.seed
    }

    /// Names of the models, in order.
    pub fn model_names(&self) -> impl Iterator<Item = &str> {
        self.models.iter().map(|m| m.name.as_str())
    }

    /// The resolved scenario as a TOML file, every default spelled out: enough to run it again.
    #[must_use]
    pub fn to_toml(&self) -> String {
        // Numbers, strings and tables of them always serialize.
        toml::to_string(&self.file).unwrap_or_default()
    }

    /// SHA-256 of [`to_toml`](Self::to_toml), in hexadecimal: two studies with the same fingerprint
    /// by the same version have the same results.
    #[must_use]
    pub fn fingerprint(&self) -> String {
        Sha256::digest(self.to_toml()).iter().map(|byte| format!("{byte:02x}")).collect()
    }

    pub(crate) fn spin_axis(&self) -> &Unit<Vector3<f64>> {
        &self.spin_axis
    }

    pub(crate) fn payload(&self) -> &UncertainBody {
        &self.payload
    }

    pub(crate) fn stage(&self) -> &UncertainBody {
        &self.stage
    }

    pub(crate) fn separation(&self) -> &Separation {
        &self.separation
    }

    pub(crate) fn settings(&self) -> &Settings {
        &self.settings
    }

    pub(crate) fn models(&self) -> &[ModelSpec] {
        &self.models
    }

    /// Whether a model was given exactly the deviations of another.
    pub(crate) fn is_matched(&self, model: &str, to: &str) -> bool {
        let matched = |law: &Law| matches!(law, Law::Matched { to: name, .. } if name == to);
        self.models.iter().any(|m| m.name == model && matched(&m.law))
    }

    pub(crate) fn comparisons(&self) -> &[Comparison] {
        &self.comparisons
    }

    /// Title of the source and its nominal inertia ratio and wobble (deg).
    pub(crate) fn source(&self) -> Option<(&str, Option<f64>, Option<f64>)> {
        self.file.source.as_ref().map(|s| (s.title.as_str(), s.inertia_ratio, s.wobble_deg))
    }
}

fn check_runs(runs: u64) -> Result<(), ScenarioError> {
    if (1..=MAX_RUNS).contains(&runs) {
        Ok(())
    } else {
        Err(ScenarioError::field("runs", format!("{runs}: it must be between 1 and {MAX_RUNS}")))
    }
}

fn check_seed(seed: u64) -> Result<(), ScenarioError> {
    if i64::try_from(seed).is_ok() {
        Ok(())
    } else {
        let problem = format!("{seed}: it must be between 0 and {}", i64::MAX);
        Err(ScenarioError::field("seed", problem))
    }
}

/// Names become names of folders.
fn check_name(field: &str, name: &str) -> Result<(), ScenarioError> {
    let allowed = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    // What Windows takes for devices.
    let device = ["con", "prn", "aux", "nul"].contains(&name.to_ascii_lowercase().as_str());
    if !name.is_empty() && name.len() <= 64 && name.chars().all(allowed) && !device {
        return Ok(());
    }
    let problem = format!(
        "{name:?}: it must be 1 to 64 letters, digits, hyphens and underscores, for it names a folder"
    );
    Err(ScenarioError::field(field, problem))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(from: &str, to: &str) -> String {
        assert!(PECK_2003.contains(from), "nothing to replace: {from}");
        Scenario::from_toml(&PECK_2003.replacen(from, to, 1)).unwrap_err().to_string()
    }

    #[test]
    fn the_built_in_scenario_is_the_papers() {
        let s = Scenario::peck_2003().unwrap();
        assert_eq!((s.name(), s.runs(), s.seed()), ("peck-2003", 2000, 2003));
        let names: Vec<&str> = s.model_names().collect();
        assert_eq!(names, ["proposed", "published", "naive", "naive-matched"]);
        assert!((s.separation().stored_energy() - 1300.0).abs() < 1e-9);
        assert!((s.separation().free_lengths()[0] - 0.3).abs() < 1e-15);
    }

    #[test]
    fn a_spin_axis_of_any_length_is_a_direction() {
        for length in ["1e300", "1e-300", "7.0"] {
            let text = PECK_2003.replace("spin_axis = [1.0,", &format!("spin_axis = [{length},"));
            assert_eq!(Scenario::from_toml(&text).unwrap().spin_axis(), &Vector3::x_axis());
        }
    }

    #[test]
    fn the_resolved_scenario_reads_back_the_same() {
        let s = Scenario::peck_2003().unwrap();
        let text = s.to_toml();
        for default in ["velocity_m_per_s", "body_to_inertial", "relative_tolerance", "horizon_s"] {
            assert!(text.contains(default), "{default} is not spelled out");
        }
        let again = Scenario::from_toml(&text).unwrap();
        assert_eq!(again.to_toml(), text);
        assert_eq!(again.fingerprint(), s.fingerprint());
        assert_ne!(s.clone().with_seed(7).unwrap().fingerprint(), s.fingerprint());
    }

    #[test]
    fn bad_values_name_the_field_the_value_and_what_is_allowed() {
        let cases = [
            ("runs = 2000", "runs = 0", "runs: 0: it must be between 1"),
            (
                "mass_kg = 10000.0",
                "mass_kg = -3.0",
                "payload.mass_kg: mass = -3.0 kg: it must be pos",
            ),
            ("mass_kg = 10000.0", "mass_kg = nan", "payload.mass_kg: mass = NaN kg"),
            ("[[5000.0, 20.0, 2.0]", "[[9000.0, 20.0, 2.0]", "payload.inertia_kg_m2: no body has"),
            (
                "[[5000.0, 20.0, 2.0]",
                "[[5000.0, 21.0, 2.0]",
                "payload.inertia_kg_m2: I12 = 21.0 kg",
            ),
            ("[2e-5, 0.0,", "[-2e-5, 0.0,", "payload.dispersion.axes_covariance: covariance with"),
            ("[0.125, 0.1,", "[0.125, -0.1,", "root_second_moment_variance_kg_m2: variance of k_2"),
            (
                "stiffness_n_per_m = 1e5",
                "stiffness_n_per_m = 0.0",
                "springs[1]: stiffness = 0.0 N/m",
            ),
            ("spin_axis = [1.0,", "spin_axis = [0.0,", "spin_axis: [0.0, 0.0, 0.0]: it must be"),
            ("name = \"peck-2003\"", "name = \"../peck\"", "name: \"../peck\": it must be 1 to 64"),
            ("name = \"published\"", "name = \"proposed\"", "models: two are named \"proposed\""),
            ("axes = \"whole-sphere\"", "", "models.proposed: law \"principal\" needs axes"),
            (
                "matched_to = \"proposed\"",
                "matched_to = \"naive\"",
                "models.naive-matched.matched_to",
            ),
            (
                "physical = \"published\"",
                "physical = \"none\"",
                "comparisons[1].physical: \"none\"",
            ),
            (
                "physical = \"published\"",
                "physical = \"naive\"",
                "comparisons[1].physical: \"naive\"",
            ),
            ("naive = \"naive\"", "naive = \"proposed\"", "comparisons[1].naive: \"proposed\""),
            ("name = \"published\"", "name = \"Proposed\"", "models: two are named \"Proposed\""),
            ("wobble_deg = 1.144", "wobble_deg = nan", "source.wobble_deg: NaN"),
            ("spin_axis = [1.0,", "spin_axis = [nan,", "spin_axis: [NaN, 0.0, 0.0]"),
        ];
        for (from, to, expected) in cases {
            let message = error(from, to);
            assert!(message.starts_with(expected) || message.contains(expected), "{message}");
        }
    }

    #[test]
    fn touching_pads_are_refused_and_explained() {
        let text = PECK_2003.replace("-0.9]", "-1.0]").replace(", 0.9]", ", 1.0]");
        let message = Scenario::from_toml(&text).unwrap_err().to_string();
        assert!(message.starts_with("springs: spring 1: its points are"), "{message}");
        assert!(message.contains("apart"), "{message}");
    }

    #[test]
    fn unknown_keys_and_bad_toml_are_refused_with_their_place() {
        let message = error("mass_kg = 10000.0", "mass_kg = 10000.0\nmas_kg = 1.0");
        assert!(
            message.contains("unknown field `mas_kg`") && message.contains("line"),
            "{message}"
        );
        let message = error("runs = 2000", "runs = ");
        assert!(message.contains("line 3"), "{message}");
        assert!(error("runs = 2000", "runs = -5").contains("runs"));
        assert!(error("runs = 2000", "runs = \"many\"").contains("runs"));
        assert!(Scenario::from_toml("").unwrap_err().to_string().contains("name"));
    }

    #[test]
    fn seeds_and_runs_are_checked_by_every_way_in() {
        let s = Scenario::peck_2003().unwrap();
        assert!(s.clone().with_runs(0).is_err());
        assert!(s.clone().with_runs(u64::MAX).is_err());
        assert!(s.with_seed(u64::MAX).is_err());
    }
}
