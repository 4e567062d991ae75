//! Scenario files: what is uncertain, what flies, how often.

mod body;
mod clearance;
mod dispersions;
mod file;
mod law;
mod model;

use gyradius_separation::{Separation, Settings, SettingsError, Spring, SpringError};
use nalgebra::{Unit, Vector3};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

pub(crate) use body::UncertainBody;
use clearance::Outlines;
pub(crate) use dispersions::{BodyPart, Dispersed, Dispersions, SpringPart, StackPart, Target};
use file::ScenarioFile;
pub(crate) use file::{AxesFile as Axes, ShapeFile};
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
    separation_direction: Option<Unit<Vector3<f64>>>,
    momentum_direction: Unit<Vector3<f64>>,
    payload: UncertainBody,
    stage: UncertainBody,
    separation: Separation,
    settings: Settings,
    dispersions: Dispersions,
    outlines: Option<Outlines>,
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
        let spin_axis = direction("spin_axis", file.spin_axis)?;
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
                    .and_then(|spring| spring.with_friction(s.friction_n.unwrap_or(0.0)))
                    .and_then(|spring| spring.starting_at(s.start_s.unwrap_or(0.0)))
                    .map_err(|e| {
                        ScenarioError::field(format!("springs[{}].{}", i + 1, spring_key(&e)), e)
                    })
            })
            .collect::<Result<Vec<_>, _>>()?;
        let separation = Separation::new(*payload.moving(), *stage.moving(), &springs)
            .map_err(|e| ScenarioError::field("springs", e))?;
        // Defaults go by way of the file, so that the resolved scenario gives the same bits.
        if file.separation_direction.is_none() {
            file.separation_direction = push(&separation).map(|d| d.into_inner().into());
        }
        let separation_direction = file
            .separation_direction
            .map(|given| direction("separation_direction", given))
            .transpose()?;
        let intended = payload.moving().state().attitude * spin_axis;
        let intended = *file.momentum_direction.get_or_insert(intended.into_inner().into());
        let momentum_direction = direction("momentum_direction", intended)?;
        let settings =
            Settings::new(file.integration.relative_tolerance, file.integration.horizon_s)
                .map_err(|e| {
                    let horizon = matches!(e, SettingsError::Horizon { .. });
                    let field = if horizon { "horizon_s" } else { "relative_tolerance" };
                    ScenarioError::field(format!("integration.{field}"), e)
                })?;
        let dispersions = Dispersions::new(&file)?;
        let outlines = file.clearance.as_ref().map(Outlines::new).transpose()?;
        let models = model::check_models(&file.models, [&payload, &stage])?;
        let comparisons = model::check_comparisons(&file.comparisons, &models)?;
        Ok(Self {
            file,
            spin_axis,
            separation_direction,
            momentum_direction,
            payload,
            stage,
            separation,
            settings,
            dispersions,
            outlines,
            models,
            comparisons,
        })
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

    /// Where the payload's mass centre is meant to go from the stage's, inertial axes; none if not said
    /// and the springs' forces cancel at the start.
    pub(crate) fn separation_direction(&self) -> Option<&Unit<Vector3<f64>>> {
        self.separation_direction.as_ref()
    }

    /// Where the payload's angular momentum is meant to point, inertial axes.
    pub(crate) fn momentum_direction(&self) -> &Unit<Vector3<f64>> {
        &self.momentum_direction
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

    /// What is uncertain besides the inertias.
    pub(crate) fn dispersions(&self) -> &Dispersions {
        &self.dispersions
    }

    /// What of the bodies may touch, if that is asked.
    pub(crate) fn outlines(&self) -> Option<&Outlines> {
        self.outlines.as_ref()
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

fn direction(field: &str, given: [f64; 3]) -> Result<Unit<Vector3<f64>>, ScenarioError> {
    unit(given.into()).ok_or_else(|| {
        let problem = format!("{given:?}: it must be finite and not zero");
        ScenarioError::field(field, problem)
    })
}

fn unit(vector: Vector3<f64>) -> Option<Unit<Vector3<f64>>> {
    // Scaled first: the norm of 1e300 overflows.
    let scaled = vector / vector.amax();
    Unit::try_new(scaled, 0.0).filter(|u| u.iter().all(|x| x.is_finite()))
}

/// The direction in which the springs push the payload at the start, late ones too, if they do not cancel.
fn push(separation: &Separation) -> Option<Unit<Vector3<f64>>> {
    let (payload, stage) = (separation.payload().state(), separation.stage().state());
    let forces = separation.springs().iter().filter(|s| s.can_push()).map(|spring| {
        let line = (payload.position - stage.position)
            + payload.attitude * spring.payload_point_m()
            - stage.attitude * spring.stage_point_m();
        line * (spring.stiffness_n_per_m() * spring.travel_m() / line.norm())
    });
    let (sum, size) = forces
        .fold((Vector3::zeros(), 0.0), |(sum, size): (Vector3<f64>, f64), f| {
            (sum + f, size + f.norm())
        });
    // What is left of forces that cancel is rounding.
    if sum.norm() > 1e-9 * size { unit(sum) } else { None }
}

/// The key of a spring that is wrong.
fn spring_key(error: &SpringError) -> &'static str {
    match error {
        SpringError::Stiffness { .. } => "stiffness_n_per_m",
        SpringError::Stroke { .. } => "stroke_m",
        SpringError::Friction { .. } => "friction_n",
        SpringError::Start { .. } => "start_s",
        SpringError::Point { body: "payload", .. } => "payload_point_m",
        _ => "stage_point_m",
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
    fn directions_and_outlines_are_read_resolved_and_checked() {
        let outlines = "[clearance]\npayload = [{ hull_m = [[0.0, 0.0, -0.5], [0.5, 0.0, -0.5]] }]\n\
                        stage = [{ ring = { centre_m = [0.0, 0.0, 0.4], axis = [0.0, 1.0, 7.0], \
                        radius_m = 0.3 } }, { points_m = [[0.0, 0.0, 0.3]] }]\n";
        let text = PECK_2003.replacen("[payload]", &format!("{outlines}\n[payload]"), 1);
        let text = text.replacen(
            "spin_axis",
            "separation_direction = [0.1, 0.0, 3.0]\nmomentum_direction = [1e300, 1e299, 0.0]\nspin_axis",
            1,
        );
        let resolved = round_trip(&text);
        assert!(resolved.contains("coast_s = 60.0"), "{resolved}");
        assert!(Scenario::from_toml(&text).unwrap().outlines().is_some());
        let many = format!("{}]", "[0.0, 0.0, 0.3],".repeat(1001));
        let error = |from: &str, to: &str| {
            assert!(text.contains(from), "{from}");
            Scenario::from_toml(&text.replacen(from, to, 1)).unwrap_err().to_string()
        };
        for (from, to, expected) in [
            (
                "[0.1, 0.0, 3.0]",
                "[0.0, 0.0, 0.0]",
                "separation_direction: [0.0, 0.0, 0.0]: it must",
            ),
            ("[1e300, 1e299, 0.0]", "[nan, 1.0, 0.0]", "momentum_direction: [NaN, 1.0, 0.0]"),
            ("radius_m = 0.3", "radius_m = -0.3", "clearance.stage[1]: "),
            (
                "radius_m = 0.3",
                "radius_m = nan",
                "clearance.stage[1]: ring radius = NaN m: it must",
            ),
            (
                "[0.0, 1.0, 7.0]",
                "[0.0, 0.0, 0.0]",
                "clearance.stage[1]: ring axis of length 0.0: it",
            ),
            (
                "[0.5, 0.0, -0.5]",
                "[nan, 0.0, 0.0]",
                "clearance.payload[1]: hull_m has coordinate NaN m",
            ),
            (
                "[0.5, 0.0, -0.5]",
                "[0.0, 1e300, 0.0]",
                "clearance.payload[1]: hull_m has coordinate 1e300",
            ),
            (
                "points_m = [[0.0, 0.0, 0.3]]",
                "points_m = []",
                "clearance.stage[2]: points_m is empty",
            ),
            (
                "[0.0, 0.0, 0.3]]",
                many.as_str(),
                "clearance.stage[2]: 1001 points in an outline: at most",
            ),
            (
                "payload = [{ hull_m = [[0.0, 0.0, -0.5], [0.5, 0.0, -0.5]] }]",
                "payload = []",
                "clearance.payload: outline is empty",
            ),
            ("[clearance]\n", "[clearance]\ncoast_s = 0.0\n", "clearance.coast_s: 0.0: it must"),
            ("[clearance]\n", "[clearance]\ncoast_s = nan\n", "clearance.coast_s: NaN"),
        ] {
            let message = error(from, to);
            assert!(message.starts_with(expected), "{message}");
        }
        // The paper's springs push along z, and its payload is to spin about inertial x.
        let paper = Scenario::peck_2003().unwrap();
        assert_eq!(paper.separation_direction(), Some(&Vector3::z_axis()));
        assert_eq!(paper.momentum_direction(), &Vector3::x_axis());
        assert!(paper.outlines().is_none());
    }

    /// Two springs in a V: alike they push straight up; friction takes from the force of one.
    #[test]
    fn springs_push_with_what_friction_leaves() {
        let at = PECK_2003.find("[[springs]]").unwrap();
        let models = PECK_2003.find("# The law as derived").unwrap();
        let spring = |x: f64, friction: f64| {
            format!(
                "[[springs]]\nstiffness_n_per_m = 1e4\nstroke_m = 0.1\nfriction_n = {friction:?}\n\
                 payload_point_m = [{x:?}, 0.0, -0.9]\nstage_point_m = [0.0, 0.0, 0.9]\n\n"
            )
        };
        let direction = |friction: f64| {
            let springs = spring(0.2, friction) + &spring(-0.2, 0.0);
            let text = format!("{}{springs}{}", &PECK_2003[..at], &PECK_2003[models..]);
            *Scenario::from_toml(&text).unwrap().separation_direction().unwrap().as_ref()
        };
        assert!((direction(0.0) - Vector3::z()).norm() < 1e-15);
        // Forces of 600 and 1000 N: (−400, 1600)/√2.
        let expected = Vector3::new(-1.0, 0.0, 4.0).normalize();
        assert!((direction(400.0) - expected).norm() < 1e-14, "{}", direction(400.0));
        // One that cannot overcome its friction does not push.
        let expected = Vector3::new(-1.0, 0.0, 1.0).normalize();
        assert!((direction(1e4) - expected).norm() < 1e-14, "{}", direction(1e4));
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
                "springs[1].stiffness_n_per_m: stiffness = 0.0 N/m",
            ),
            ("stroke_m = 0.1", "stroke_m = inf", "springs[1].stroke_m: stroke = inf m"),
            (
                "stage_point_m = [1.0,",
                "stage_point_m = [nan,",
                "springs[1].stage_point_m: stage attachment point has entry NaN",
            ),
            (
                "stroke_m = 0.1",
                "stroke_m = 0.1\nstart_s = -1.0",
                "springs[1].start_s: start = -1.0 s",
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
            (
                "[source]",
                "[integration]\nhorizon_s = -1e300\n[source]",
                "integration.horizon_s: horizon = -1e300 s: it must be positive and finite",
            ),
            (
                "[source]",
                "[integration]\nrelative_tolerance = nan\n[source]",
                "integration.relative_tolerance: relative tolerance = NaN",
            ),
            ("wobble_deg = 1.144", "wobble_deg = nan", "source.wobble_deg: NaN"),
            ("spin_axis = [1.0,", "spin_axis = [nan,", "spin_axis: [NaN, 0.0, 0.0]"),
        ];
        for (from, to, expected) in cases {
            let message = error(from, to);
            assert!(message.starts_with(expected) || message.contains(expected), "{message}");
        }
    }

    const VARIANCE: &str = "root_second_moment_variance_kg_m2 = [0.125, 0.1, 0.075]";

    fn covariance(size: usize, variance: f64) -> String {
        let row = |i: usize| {
            let entry = |j: usize| if i == j { format!("{variance:e}") } else { "0.0".to_owned() };
            format!("[{}]", (0..size).map(entry).collect::<Vec<_>>().join(", "))
        };
        format!("[{}]", (0..size).map(row).collect::<Vec<_>>().join(", "))
    }

    /// The resolved scenario says the same again, and its models can be made.
    fn round_trip(text: &str) -> String {
        let s = Scenario::from_toml(text).unwrap_or_else(|e| panic!("{e}\n{text}"));
        let resolved = s.to_toml();
        let again = Scenario::from_toml(&resolved).unwrap_or_else(|e| panic!("{e}\n{resolved}"));
        assert_eq!(again.to_toml(), resolved);
        crate::runner::models(&s).unwrap_or_else(|e| panic!("{e}\n{text}"));
        resolved
    }

    #[test]
    fn every_law_of_roots_and_axes_can_be_written() {
        let rcg = &PECK_2003[PECK_2003.find("axes_covariance").unwrap()..];
        let rcg = &rcg[..rcg.find("\n]\n").unwrap() + 3];
        let roots = [
            ("gaussian", VARIANCE.to_owned()),
            ("uniform", VARIANCE.to_owned()),
            ("lognormal", VARIANCE.to_owned()),
            (
                "correlated-gaussian",
                format!("root_second_moment_covariance_kg_m2 = {}", covariance(3, 0.1)),
            ),
            (
                "truncated-gaussian",
                format!(
                    "{VARIANCE}\nroot_second_moment_bounds_sqrt_kg_m = [[30.0, 33.0], [0.0, inf], [-inf, inf]]"
                ),
            ),
            (
                "empirical",
                "root_second_moment_samples_sqrt_kg_m = [[31.0, 44.0, 54.0], [32.0, 45.0, 55.0]]"
                    .to_owned(),
            ),
        ];
        for (law, fields) in &roots {
            for (axes, covariance) in
                [("radially-constrained-gaussian", rcg), ("uniform", ""), ("fixed", "")]
            {
                // The naive model is then matched to each.
                let text = PECK_2003
                    .replacen(
                        VARIANCE,
                        &format!("roots = \"{law}\"\n{fields}\naxes = \"{axes}\""),
                        1,
                    )
                    .replacen(rcg, covariance, 1);
                let text = if axes == "radially-constrained-gaussian" {
                    text
                } else {
                    text.replace("axes = \"jacobian-twice\"", "axes = \"whole-sphere\"")
                };
                let resolved = round_trip(&text);
                assert!(resolved.contains(&format!("roots = \"{law}\"")), "{resolved}");
                assert!(resolved.contains(&format!("axes = \"{axes}\"")), "{resolved}");
            }
        }
        // What is not said is spelled out.
        let resolved = round_trip(PECK_2003);
        assert!(resolved.contains("roots = \"gaussian\""), "{resolved}");
        assert!(resolved.contains("axes = \"radially-constrained-gaussian\""), "{resolved}");
    }

    /// A scenario with one more model.
    fn with_model(law: &str, fields: &str) -> String {
        let at = PECK_2003.find("[[comparisons]]").unwrap();
        let (head, tail) = PECK_2003.split_at(at);
        format!("{head}[[models]]\nname = \"other\"\nlaw = \"{law}\"\n{fields}\n\n{tail}")
    }

    #[test]
    fn every_model_can_be_written() {
        let both = |field: &str, value: &str| {
            format!("payload_{field} = {value}\nstage_{field} = {value}")
        };
        let deviations = both("deviation_kg_m2", &covariance(3, 10.0));
        let entries = both("covariance_kg2_m4", &covariance(6, 100.0));
        let basilisk =
            both("diagonal_deviation_kg_m2", "50.0") + "\n" + &both("angle_deviation_rad", "0.02");
        let bounded = basilisk.clone() + "\n" + &both("diagonal_bounds_kg_m2", "[-100.0, 100.0]");
        let cases = [
            ("principal", "axes = \"mean-half\"".to_owned()),
            ("entrywise", deviations.clone()),
            ("realizable-entrywise", deviations),
            ("correlated-entries", entries.clone()),
            ("realizable-correlated-entries", entries),
            ("log-cholesky", both("log_cholesky_covariance", &covariance(6, 1e-4))),
            ("wishart", both("delta", "0.05")),
            ("basilisk", basilisk),
            ("basilisk", bounded),
        ];
        for (law, fields) in cases {
            let resolved = round_trip(&with_model(law, &fields));
            if law == "basilisk" {
                assert!(resolved.contains("payload_diagonal_bounds_kg_m2"), "{resolved}");
            }
        }
        for kind in gyradius_dispersion::ModelKind::ALL.into_iter().skip(1) {
            // Making the published law takes a while: one model matched to it will do.
            let wishart = kind == gyradius_dispersion::ModelKind::Wishart;
            for to in if wishart { &["proposed", "published"][..] } else { &["proposed"] } {
                let matched = format!("matched_to = \"{to}\"");
                // The stage has two equal moments, which Basilisk's small turns need not reach.
                let text = with_model(kind.name(), &matched);
                let s = Scenario::from_toml(&text).unwrap();
                assert_eq!(Scenario::from_toml(&s.to_toml()).unwrap().to_toml(), s.to_toml());
                if let Err(error) = crate::runner::models(&s) {
                    assert!(error.to_string().starts_with("models.other: basilisk:"), "{error}");
                }
            }
        }
    }

    #[test]
    fn bad_parameters_of_models_are_named() {
        let both = |field: &str, value: &str| {
            format!("payload_{field} = {value}\nstage_{field} = {value}")
        };
        let basilisk = |diagonal: &str, bounds: &str, angle: &str| {
            [
                both("diagonal_deviation_kg_m2", diagonal),
                both("diagonal_bounds_kg_m2", bounds),
                both("angle_deviation_rad", angle),
            ]
            .join("\n")
        };
        let cases = [
            ("wishart", both("delta", "1.5"), "models.other.payload_delta: dispersion δ = 1.5"),
            ("wishart", both("delta", "nan"), "models.other.payload_delta: dispersion δ = NaN"),
            ("wishart", "payload_delta = 0.1".to_owned(), "models.other.stage_delta: missing"),
            ("wishart", String::new(), "models.other.payload_delta: missing"),
            (
                "wishart",
                both("deviation_kg_m2", &covariance(3, 1.0)),
                "models.other.payload_deviation_kg_m2: law \"wishart\" needs either payload_delta",
            ),
            (
                "wishart",
                both("delta", "0.1") + "\nmatched_to = \"proposed\"",
                "models.other.payload_delta: law \"wishart\" needs either",
            ),
            ("wishart", "matched_to = \"naive\"".to_owned(), "models.other.matched_to: \"naive\""),
            ("wishart", "axes = \"mean-half\"".to_owned(), "models.other.axes: law \"wishart\""),
            (
                "correlated-entries",
                both("covariance_kg2_m4", &covariance(6, -1.0)),
                "models.other.payload_covariance_kg2_m4: covariance entry (1, 1)",
            ),
            (
                "realizable-entrywise",
                both("deviation_kg_m2", &covariance(3, -1.0)),
                "models.other.payload_deviation_kg_m2: -1",
            ),
            (
                "log-cholesky",
                both("log_cholesky_covariance", &covariance(6, 100.0)),
                "models.other.payload_log_cholesky_covariance: coordinate d1",
            ),
            (
                "basilisk",
                basilisk("-1.0", "[-1.0, 1.0]", "0.1"),
                "models.other.payload_diagonal_deviation_kg_m2: diagonal deviation = -1.0",
            ),
            (
                "basilisk",
                basilisk("1.0", "[1.0, -1.0]", "0.1"),
                "models.other.payload_diagonal_bounds_kg_m2: bounds from 1.0 to -1.0",
            ),
            (
                "basilisk",
                basilisk("1.0", "[-1.0, 1.0]", "nan"),
                "models.other.payload_angle_deviation_rad: angle deviation = NaN",
            ),
            (
                "principal",
                "axes = \"mean-half\"\npayload_delta = 0.1".to_owned(),
                "models.other.payload_delta: law \"principal\" takes axes",
            ),
        ];
        for (law, fields, expected) in cases {
            let message = Scenario::from_toml(&with_model(law, &fields)).unwrap_err().to_string();
            assert!(message.starts_with(expected), "{message}\nexpected {expected}");
        }
        let message = Scenario::from_toml(&with_model("naive", "")).unwrap_err().to_string();
        assert!(message.contains("naive") && message.contains("wishart"), "{message}");
    }

    #[test]
    fn bad_dispersions_are_named() {
        let place = "payload.dispersion";
        let cases = [
            (VARIANCE.to_owned(), String::new(), "root_second_moment_variance_kg_m2: missing"),
            (
                VARIANCE.to_owned(),
                "roots = \"empirical\"".to_owned(),
                "root_second_moment_samples_sqrt_kg_m: missing",
            ),
            (
                VARIANCE.to_owned(),
                "roots = \"empirical\"\nroot_second_moment_samples_sqrt_kg_m = [[1.0, nan, 2.0]]"
                    .to_owned(),
                "root_second_moment_samples_sqrt_kg_m: sample 1, k_2",
            ),
            (
                VARIANCE.to_owned(),
                format!("roots = \"correlated-gaussian\"\n{VARIANCE}"),
                "root_second_moment_variance_kg_m2: roots = \"correlated-gaussian\" does not take it",
            ),
            (
                VARIANCE.to_owned(),
                format!("roots = \"truncated-gaussian\"\n{VARIANCE}"),
                "root_second_moment_bounds_sqrt_kg_m: missing",
            ),
            (
                VARIANCE.to_owned(),
                format!(
                    "roots = \"truncated-gaussian\"\n{VARIANCE}\nroot_second_moment_bounds_sqrt_kg_m = [[0.0, 1.0], [0.0, 1.0], [0.0, 1.0]]"
                ),
                "root_second_moment_bounds_sqrt_kg_m: k_1",
            ),
            (
                VARIANCE.to_owned(),
                format!("{VARIANCE}\naxes = \"uniform\""),
                "axes_covariance: axes = \"uniform\"",
            ),
        ];
        for (from, to, expected) in cases {
            let message = error(&from, &to);
            assert!(message.starts_with(&format!("{place}.{expected}")), "{message}\n{expected}");
        }
        let message = error(VARIANCE, &format!("{VARIANCE}\nroots = \"normal\""));
        assert!(message.contains("normal") && message.contains("lognormal"), "{message}");
        // No half of the sphere to keep to.
        let rcg = &PECK_2003[PECK_2003.find("axes_covariance").unwrap()..];
        let rcg = &rcg[..rcg.find("\n]\n").unwrap() + 3];
        let message = error(rcg, "axes = \"fixed\"\n");
        assert!(message.starts_with("models.published.axes: only \"whole-sphere\""), "{message}");
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
