//! Scenario files: what is uncertain, what flies, how often.

mod as_given;
mod body;
mod chance;
mod clearance;
mod dispersions;
mod each;
mod file;
mod follows;
mod frame;
mod joint;
mod joint_body;
mod law;
mod limits;
mod list;
mod load;
mod meant;
mod model;
mod model_file;
mod outside;
mod parse;
mod placed;
mod scalar;
mod sides;
mod until;
mod vehicles;

use gyradius_campaign::{Kept, Requirement, StoppingRule, Until};
use gyradius_formats::read_text;
use gyradius_separation::{Separation, SeparationError, Settings, SettingsError};
use nalgebra::{Unit, Vector3};
use std::path::{Path, PathBuf};

pub(crate) use as_given::AsGiven;
pub(crate) use body::UncertainBody;
use clearance::Outlines;
pub(crate) use clearance::{Watched, distance_m};
pub(crate) use dispersions::{Dispersions, check_follows};
use file::ScenarioFile;
pub(crate) use file::{
    AxesLawFile, BodyFile, CorrelationFile, DispersionFile, RootsFile, ShapeFile,
};
pub(crate) use frame::{Framed, check_name, check_seed, default_seed, framed, framed_file};
pub(crate) use joint::{Dispersed, Joint, Number, Target};
pub(crate) use law::{GivenLaw, refused};
pub(crate) use limits::{base_runs, largest_mass};
pub(crate) use list::List;
pub(crate) use load::Uncertain;
pub(crate) use model::{Comparison, Law, ModelSpec, check_models, place};
pub(crate) use model_file::{AxesFile as Axes, ModelFile, ModelLaw, Owner};
use outside::OutsideLaws;
pub use parse::{TomlError, parse_toml, whole_number};
pub(crate) use parse::{some_whole, whole};
pub(crate) use scalar::ScalarLawFile;
pub(crate) use {each::Each, until::UntilFile, vehicles::Size};

use crate::{body::Body, fleet::Fleet, folded::FoldedRoot};

const PECK_2003: &str = include_str!("peck-2003.toml");

/// Why a scenario is refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ScenarioError {
    /// The file cannot be read.
    #[error("cannot read {}: {problem}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        problem: std::io::Error,
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

    /// The same, which says in which file.
    pub(crate) fn in_file(self, path: &Path) -> Self {
        match self {
            Self::Parse { message, .. } => Self::Parse { path: Some(path.to_owned()), message },
            Self::Field { field, problem } => {
                Self::Field { field: format!("{}: {field}", path.display()), problem }
            }
            read @ Self::Read { .. } => read,
        }
    }
}

/// A study to be run: bodies with their uncertainty, loads, models, how many runs from which
/// seed. Everything has been checked.
#[derive(Clone, Debug)]
pub struct Scenario {
    file: ScenarioFile,
    size: Size,
    until: Option<Until>,
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
    /// The estimated share of draws that the region of payload and stage keeps, and its standard error, as models read the
    /// axes.
    regions: Vec<(Axes, KeptShares)>,
    /// What no file holds.
    outside: OutsideLaws,
    /// The file that it was read from.
    path: Option<PathBuf>,
}

/// The estimated share of draws that a region keeps and its standard error, of payload and stage where they have one.
pub(crate) type KeptShares = [Option<(f64, f64)>; 2];

framed!(Scenario, ScenarioFile);

impl Scenario {
    /// The separation study of Peck (2003: Table 1, Eq. 27, 30 and 31), under four models.
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
        let text = scenario_text(path)?;
        Ok(Self::from_toml(&text).map_err(|error| error.in_file(path))?.read_from(path))
    }

    /// Reads a scenario from the text of a file.
    ///
    /// # Errors
    /// It is not TOML, has an unknown key, or a value that is not allowed.
    pub fn from_toml(text: &str) -> Result<Self, ScenarioError> {
        let file = parse_toml::<ScenarioFile>(text)
            .map_err(|error| ScenarioError::Parse { path: None, message: error.to_string() })?;
        limits::check(&file)?;
        Self::check(file)
    }

    fn check(mut file: ScenarioFile) -> Result<Self, ScenarioError> {
        file.models.iter_mut().for_each(|model| model.fill(&Body::BOTH));
        for body in [&mut file.payload, &mut file.stage] {
            body.dispersion.fill(body.law.as_ref());
        }
        let (size, until) = file.check_frame()?;
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
        let mut payload = UncertainBody::new("payload", &file.payload)?;
        let mut stage = UncertainBody::new("stage", &file.stage)?;
        let loads = file.loads().map(|(id, given)| {
            let refused =
                |(key, error)| ScenarioError::field(format!("{}.{key}", load::key(id)), error);
            given.load().map_err(refused)
        });
        let loads = loads.collect::<Result<Vec<_>, _>>()?;
        let separation = Separation::new(*payload.moving(), *stage.moving(), &loads)
            .map_err(separation_error)?;
        let push = push(&separation);
        sides::check(&separation, file.separation_direction, push)?;
        // What follows from other keys is not written into the resolved scenario: whoever changes those in a copy of it means
        // what follows from the changed ones.
        let separation_direction =
            file.separation_direction.or(push.map(|d| d.into_inner().into()));
        let separation_direction = separation_direction
            .map(|given| direction("separation_direction", given))
            .transpose()?;
        let intended = payload.moving().state().attitude * spin_axis;
        let intended = file.momentum_direction.unwrap_or(intended.into_inner().into());
        let momentum_direction = direction("momentum_direction", intended)?;
        let settings =
            Settings::new(file.integration.relative_tolerance, file.integration.horizon_s)
                .map_err(|e| {
                    let horizon = matches!(e, SettingsError::Horizon { .. });
                    let field = if horizon { "horizon_s" } else { "relative_tolerance" };
                    ScenarioError::field(format!("integration.{field}"), e)
                })?;
        let both = [&payload, &stage];
        let dispersions = Dispersions::new(&file, size.fleet(), &separation, both)?;
        for (i, body) in [&mut payload, &mut stage].into_iter().enumerate() {
            dispersions.joint.correlate_roots(i, body);
        }
        let outlines = file.clearance.as_ref().map(Outlines::new).transpose()?;
        let bodies = [(Body::Payload, &payload), (Body::Stage, &stage)];
        let models = check_models(&file.models, &bodies)?;
        let comparisons = model::check_comparisons(&file.comparisons, &models)?;
        let mut kept: Vec<(Axes, [_; 2])> = Vec::new();
        for axes in models.iter().filter_map(|model| model.law.own_axes()) {
            if kept.iter().all(|(other, _)| *other != axes) {
                let of = |(body, own): (Body, &UncertainBody)| {
                    dispersions.joint.acceptance(body as usize, body.name(), own, axes)
                };
                let [payload, stage] = bodies.map(of);
                kept.push((axes, [payload?, stage?]));
            }
        }
        Ok(Self {
            file,
            size,
            until,
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
            regions: kept,
            outside: OutsideLaws::default(),
            path: None,
        })
    }

    /// Lengths and roots of payload and stage whose laws lie below zero by more than 2.28 %, as a normal law does whose mean is
    /// less than two standard deviations.
    #[must_use]
    pub fn folded(&self) -> Vec<FoldedRoot> {
        self.bodies().into_iter().flat_map(|(body, own)| own.folded(body.name())).collect()
    }

    /// Payload and stage.
    pub(crate) fn bodies(&self) -> [(Body, &UncertainBody); 2] {
        [(Body::Payload, &self.payload), (Body::Stage, &self.stage)]
    }

    /// The fleet, if flights of a vehicle have something in common, so that runs are not independent.
    pub(crate) fn sharing(&self) -> Option<Fleet> {
        self.size.sharing(self.dispersions.drawn_for())
    }

    /// SHA-256 of [`to_toml`](Self::to_toml), in hexadecimal: two studies with the same fingerprint
    /// by the same version have the same results. Of a law from [`with_model`](Self::with_model) the file holds
    /// a digest of its draws, so that this is then as sure as that the law always draws the same.
    #[must_use]
    pub fn fingerprint(&self) -> String {
        gyradius_campaign::sha256(self.to_toml())
    }

    /// The axis that the payload spins about, body axes.
    #[must_use]
    pub fn spin_axis(&self) -> &Unit<Vector3<f64>> {
        &self.spin_axis
    }

    /// Where the payload's mass centre is meant to go from the stage's, inertial axes; none if not said
    /// and the loads' forces cancel at the start.
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

    /// The separation of the nominal bodies.
    #[must_use]
    pub fn separation(&self) -> &Separation {
        &self.separation
    }

    /// How it is integrated.
    #[must_use]
    pub fn settings(&self) -> &Settings {
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

    /// The key of a model in the file.
    pub(crate) fn place(&self, model: &ModelSpec) -> String {
        let index = self.models.iter().position(|m| m.name == model.name);
        index.map_or_else(|| format!("model {:?}", model.name), place)
    }

    /// Whether a model was given exactly the deviations of another.
    pub(crate) fn is_matched(&self, model: &str, to: &str) -> bool {
        let matched = |law: &Law| matches!(law, Law::Matched { to: name, .. } if name == to);
        self.models.iter().any(|m| m.name == model && matched(&m.law))
    }

    /// The estimated share of draws that the region of payload and stage keeps under a model, and its standard error.
    pub(crate) fn regions(&self, model: &ModelSpec) -> KeptShares {
        let axes = model.law.own_axes();
        let of_model = self.regions.iter().find(|(read, _)| Some(*read) == axes);
        of_model.map_or([None; 2], |(_, kept)| *kept)
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

/// The direction in which the loads push the payload at the start, late ones too, if they do not cancel.
fn push(separation: &Separation) -> Option<Unit<Vector3<f64>>> {
    let forces = separation.loads().filter(|(_, load)| load.can_push()).map(|(_, load)| {
        let line = load.line(separation.payload().state(), separation.stage().state());
        line * (load.force_n() / line.norm())
    });
    let (sum, size) = forces
        .fold((Vector3::zeros(), 0.0), |(sum, size): (Vector3<f64>, f64), f| {
            (sum + f, size + f.norm())
        });
    // What is left of forces that cancel is rounding.
    if sum.norm() > 1e-9 * size { unit(sum) } else { None }
}

/// What does not go together, by its key.
fn separation_error(error: SeparationError) -> ScenarioError {
    let (field, from) = match &error {
        SeparationError::Body { body, .. } => (body.to_string(), ""),
        SeparationError::TouchingPads { load, .. } => {
            (format!("{}.payload_point_m", load::key(*load)), POINTS)
        }
        SeparationError::ShortStroke { load, .. } => {
            (format!("{}.stroke_m", load::key(*load)), POINTS)
        }
        _ => ("springs".to_owned(), ""),
    };
    ScenarioError::field(field, format!("{error}{from}"))
}

/// What the distances of a load come from.
const POINTS: &str = "; where its points are follows from payload_point_m, stage_point_m, and position_m and \
                      body_to_inertial of the bodies";

/// The scenario file that a path names: a file, or that in the folder of a study.
pub(crate) fn scenario_file(path: &Path) -> PathBuf {
    if path.is_dir() { path.join("scenario.toml") } else { path.to_owned() }
}

/// The text of a scenario file. One in the folder of a study may have been put aside by a command that was killed.
///
/// # Errors
/// It is no regular file, or larger than a scenario may be, or no text; or the system refuses.
pub fn scenario_text(path: &Path) -> Result<String, ScenarioError> {
    let unread = |problem| ScenarioError::Read { path: path.to_owned(), problem };
    gyradius_campaign::restore(gyradius_campaign::folder_of(path))
        .map_err(|error| unread(std::io::Error::other(error)))?;
    read_text(path, limits::BYTES).map_err(unread)
}

#[cfg(test)]
mod copies;
#[cfg(test)]
mod mutations;
#[cfg(test)]
pub(crate) mod tests;
