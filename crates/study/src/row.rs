//! What one run of one model leaves.

use gyradius_separation::{
    BodyError, Clearance, ClearanceError, Outcome as Separated, OutlineError, RunError, Separation,
    SeparationError, SpinMetrics, SpringError,
};
use nalgebra::UnitQuaternion;
use std::borrow::Cow;

use crate::{
    quantity::{Body, Quantity},
    scenario::Scenario,
};

/// One run of one model.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    pub(crate) run: u64,
    /// I11, I22, I33, I12, I13, I23, kg·m².
    pub(crate) payload: [f64; 6],
    pub(crate) stage: [f64; 6],
    pub(crate) realizable: bool,
    pub(crate) payload_axes: Option<UnitQuaternion<f64>>,
    pub(crate) stage_axes: Option<UnitQuaternion<f64>>,
    /// What came of it, or why nothing did.
    pub(crate) outcome: Result<Outcome, Failure>,
    /// What else was drawn, in the order of the scenario's dispersions.
    pub(crate) drawn: Box<[f64]>,
}

/// Why a run failed, with the numbers of the run.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Failure {
    /// What was drawn makes no separation.
    #[error(transparent)]
    Refused(#[from] SeparationError),
    /// What was drawn makes no spring.
    #[error("spring {spring}: {source}")]
    Spring {
        /// Its number, from 1.
        spring: usize,
        /// What is wrong with it.
        source: SpringError,
    },
    /// The separation does not come to an end.
    #[error(transparent)]
    Broken(#[from] RunError),
    /// The outline of a body cannot be placed about its mass centre.
    #[error("{body}: outline: {source}")]
    Outline {
        /// Whose.
        body: &'static str,
        /// Why.
        source: OutlineError,
    },
}

impl Failure {
    /// What kind it is, without numbers, so that failures of a kind can be counted.
    #[must_use]
    pub fn kind(&self) -> Cow<'static, str> {
        let plain: &'static str = match self {
            Self::Refused(SeparationError::Body { body, source }) => {
                let what = match source {
                    BodyError::Mass { .. } => "mass not positive",
                    BodyError::NotPositiveDefinite { .. } => "inertia not positive definite",
                    _ => "state refused",
                };
                return format!("{body}: {what}").into();
            }
            Self::Spring { spring, .. } => return format!("spring {spring}: impossible").into(),
            Self::Refused(SeparationError::NonePushes) => "no spring pushes",
            Self::Refused(SeparationError::TouchingPads { .. }) => "points of a spring touch",
            Self::Refused(SeparationError::ShortStroke { .. }) => "stroke too short",
            Self::Refused(_) => "separation refused",
            Self::Broken(RunError::NotReleased { .. }) => "springs not released within the horizon",
            Self::Broken(RunError::PadsMeet { .. }) => "points of a spring meet",
            Self::Broken(RunError::StepUnderflow { .. }) => "step underflow",
            Self::Broken(RunError::TooManySteps { .. }) => "too many steps",
            Self::Broken(RunError::NotFinite { .. }) => "numbers out of range",
            Self::Broken(_) => "integration failed",
            Self::Outline { body, .. } => return format!("{body}: outline beyond bounds").into(),
        };
        plain.into()
    }
}

/// Why a run has no clearance, or not one of its whole coast.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub(crate) enum ClearanceNote {
    /// All outlines touch at the start, part, and do not touch again.
    #[error("all outlines are mated: they touch at the start and do not touch again after parting")]
    Mated,
    /// All outlines touch at the start, and some of them do not part.
    #[error("all outlines are mated, and some do not part")]
    Together,
    /// The bodies turn so far that they are not followed to the end of the coast, in which they could
    /// still come nearer.
    #[error("followed to {until:?} s only: a body turns by more than 7,000 rad in the coast")]
    Partial {
        /// Until when they are followed, s.
        until: f64,
    },
    /// The search has failed.
    #[error("clearance not found: {0}")]
    NotFound(ClearanceError),
}

impl ClearanceNote {
    /// What there is to say of a clearance.
    pub(crate) fn new(found: &Result<Clearance, ClearanceError>) -> Option<Self> {
        let clearance = match found {
            Ok(clearance) => clearance,
            Err(error) => return Some(Self::NotFound(*error)),
        };
        if let Some(until) = clearance.undecided_from_s() {
            return Some(Self::Partial { until });
        }
        if clearance.closest().is_some() {
            return None;
        }
        let parted = clearance.shapes().iter().all(|s| s.counts_from_s().is_some());
        Some(if parted { Self::Mated } else { Self::Together })
    }

    /// What kind it is, without numbers, so that those of a kind can be counted.
    pub(crate) fn kind(self) -> &'static str {
        match self {
            Self::Mated => "all outlines are mated and do not touch again after parting",
            Self::Together => "all outlines are mated, and some do not part",
            Self::Partial { .. } => "a body turns too far to be followed to the end of the coast",
            Self::NotFound(_) => "the clearance was not found",
        }
    }
}

/// What a run is about; angles in degrees.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Outcome {
    pub(crate) release_time_s: f64,
    pub(crate) relative_speed_m_per_s: f64,
    pub(crate) payload_rate_rad_per_s: [f64; 3],
    /// Of the payload after the last release.
    pub(crate) spin: SpinMetrics,
    /// Of the payload at the start.
    pub(crate) spin_before: SpinMetrics,
    pub(crate) relative_velocity_m_per_s: [f64; 3],
    pub(crate) direction_error_deg: Option<f64>,
    pub(crate) payload_tip_off_deg_per_s: [f64; 3],
    pub(crate) stage_tip_off_deg_per_s: [f64; 3],
    pub(crate) momentum_kg_m2_per_s: [f64; 3],
    pub(crate) momentum_error_deg: Option<f64>,
    /// Of the springs; into translation and rotation of payload and stage.
    pub(crate) energies_j: [f64; 5],
    /// Spring by spring; none of one that never pushes.
    pub(crate) releases_s: Vec<Option<f64>>,
    /// Springs from 1 in the order of their releases, `+` between those that let go together.
    pub(crate) release_order: String,
    /// Springs from 1 that were pressed again after they had let go.
    pub(crate) recompressed: Vec<usize>,
    /// Smallest distance of the outlines, m, and when, s.
    pub(crate) clearance: Option<[f64; 2]>,
    pub(crate) recontact_s: Option<f64>,
    pub(crate) clearance_note: Option<ClearanceNote>,
}

impl Outcome {
    pub(crate) fn new(
        scenario: &Scenario,
        separation: &Separation,
        separated: &Separated,
        watched: Option<&Result<Clearance, ClearanceError>>,
    ) -> Self {
        let clearance = watched.and_then(|found| found.as_ref().ok());
        let degrees = |angle: Option<f64>| angle.map(f64::to_degrees);
        let [payload_tip_off, stage_tip_off] =
            separated.tip_off(separation).map(|rate| rate.map(f64::to_degrees).into());
        let direction = scenario.separation_direction();
        let energy = separated.energy_split(separation);
        let words = |springs: &[usize], between: &str| {
            springs.iter().map(ToString::to_string).collect::<Vec<_>>().join(between)
        };
        let order: Vec<_> = separated.release_order().iter().map(|s| words(s, "+")).collect();
        Self {
            release_time_s: separated.release_time(),
            relative_speed_m_per_s: separated.relative_speed(),
            payload_rate_rad_per_s: separated.payload().state().angular_velocity.into(),
            spin: separated.spin_metrics(scenario.spin_axis()),
            spin_before: separation.payload().spin_metrics(scenario.spin_axis()),
            relative_velocity_m_per_s: separated.relative_velocity().into(),
            direction_error_deg: degrees(direction.and_then(|d| separated.direction_error(d))),
            payload_tip_off_deg_per_s: payload_tip_off,
            stage_tip_off_deg_per_s: stage_tip_off,
            momentum_kg_m2_per_s: separated.payload().inertial_spin_angular_momentum().into(),
            momentum_error_deg: degrees(separated.momentum_error(scenario.momentum_direction())),
            energies_j: [
                energy.stored_j(),
                energy.payload_translation_j(),
                energy.payload_rotation_j(),
                energy.stage_translation_j(),
                energy.stage_rotation_j(),
            ],
            releases_s: separated.release_times().collect(),
            release_order: order.join(" "),
            recompressed: separated.recompressed().map(|(spring, _)| spring).collect(),
            clearance: clearance
                .and_then(Clearance::closest)
                .map(|closest| [closest.distance_m(), closest.time_s()]),
            recontact_s: clearance.and_then(Clearance::contact_s),
            clearance_note: watched.and_then(ClearanceNote::new),
        }
    }
}

impl Row {
    /// The attitude of the principal axes of a body, as drawn.
    pub(crate) fn axes(&self, body: Body) -> Option<UnitQuaternion<f64>> {
        match body {
            Body::Payload => self.payload_axes,
            Body::Stage => self.stage_axes,
        }
    }

    /// Its number, from 0.
    #[must_use]
    pub fn run(&self) -> u64 {
        self.run
    }

    /// `ok`, or why the run failed.
    #[must_use]
    pub fn status(&self) -> Cow<'static, str> {
        self.failure().map_or("ok".into(), |failure| failure.to_string().into())
    }

    /// Why the run failed, if it did.
    #[must_use]
    pub fn failure(&self) -> Option<&Failure> {
        self.outcome.as_ref().err()
    }

    /// Springs from 1 in the order of their releases, `+` between those that let go together, without
    /// those that never push; none if the run failed.
    #[must_use]
    pub fn release_order(&self) -> Option<&str> {
        self.outcome.as_ref().ok().map(|o| o.release_order.as_str())
    }

    /// Springs from 1 that were pressed below their free length again after they had let go.
    #[must_use]
    pub fn recompressed(&self) -> &[usize] {
        self.outcome.as_ref().map_or(&[], |o| &o.recompressed)
    }

    /// Why the run has no clearance, or not one of its whole coast; none if there is nothing to say.
    pub(crate) fn clearance_note(&self) -> Option<ClearanceNote> {
        self.outcome.as_ref().ok().and_then(|o| o.clearance_note)
    }

    /// Whether both drawn inertias are realizable.
    #[must_use]
    pub fn realizable(&self) -> bool {
        self.realizable
    }

    /// The value of a quantity; none if the run failed or it has no meaning for this run.
    #[must_use]
    pub fn value(&self, quantity: Quantity) -> Option<f64> {
        let quantity = match quantity {
            Quantity::Payload(entry) => return Some(self.payload[entry as usize]),
            Quantity::Stage(entry) => return Some(self.stage[entry as usize]),
            other => other,
        };
        let o = self.outcome.as_ref().ok()?;
        let bounds =
            |metrics: &SpinMetrics| metrics.nutation_bounds().map(|b| b.map(f64::to_degrees));
        match quantity {
            Quantity::Payload(_) | Quantity::Stage(_) => None,
            Quantity::ReleaseTime => Some(o.release_time_s),
            Quantity::RelativeSpeed => Some(o.relative_speed_m_per_s),
            Quantity::PayloadRate(axis) => Some(o.payload_rate_rad_per_s[axis as usize]),
            Quantity::SpinRate => Some(o.spin.spin_rate()),
            Quantity::Wobble => Some(o.spin.wobble().to_degrees()),
            Quantity::Nutation => o.spin.nutation().map(f64::to_degrees),
            Quantity::Nutation2 => o.spin.nutation_2().map(f64::to_degrees),
            Quantity::Nutation3 => o.spin.nutation_3().map(f64::to_degrees),
            Quantity::Cone => o.spin.cone().map(f64::to_degrees),
            Quantity::InertiaRatio => Some(o.spin.inertia_ratio()),
            Quantity::RelativeVelocity(axis) => Some(o.relative_velocity_m_per_s[axis as usize]),
            Quantity::DirectionError => o.direction_error_deg,
            Quantity::PayloadTipOff(axis) => Some(o.payload_tip_off_deg_per_s[axis as usize]),
            Quantity::StageTipOff(axis) => Some(o.stage_tip_off_deg_per_s[axis as usize]),
            Quantity::NutationLeast => bounds(&o.spin).map(|b| b[0]),
            Quantity::NutationGreatest => bounds(&o.spin).map(|b| b[1]),
            Quantity::NutationBefore => o.spin_before.nutation().map(f64::to_degrees),
            Quantity::NutationLeastBefore => bounds(&o.spin_before).map(|b| b[0]),
            Quantity::NutationGreatestBefore => bounds(&o.spin_before).map(|b| b[1]),
            Quantity::Momentum(axis) => Some(o.momentum_kg_m2_per_s[axis as usize]),
            Quantity::MomentumError => o.momentum_error_deg,
            Quantity::SpringEnergy => Some(o.energies_j[0]),
            Quantity::PayloadTranslation => Some(o.energies_j[1]),
            Quantity::PayloadRotation => Some(o.energies_j[2]),
            Quantity::StageTranslation => Some(o.energies_j[3]),
            Quantity::StageRotation => Some(o.energies_j[4]),
            Quantity::Clearance => o.clearance.map(|c| c[0]),
            Quantity::ClearanceTime => o.clearance.map(|c| c[1]),
            Quantity::RecontactTime => o.recontact_s,
            Quantity::SpringRelease(spring) => o.releases_s.get(spring).copied().flatten(),
        }
    }
}

#[cfg(test)]
mod tests;
