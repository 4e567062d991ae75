//! A run that has ended: what was drawn for it, and what came of it.

use gyradius_clearance::{Approach, Clearance, ClearanceError};
use gyradius_dispersion::ModelDraw;
use gyradius_report::significant;
use gyradius_separation::{EnergySplit, Outcome as Separated, RunError, Separation, SpinMetrics};
use nalgebra::{UnitQuaternion, Vector3};
use std::fmt::Write;

use crate::{
    body::Body,
    drawn,
    failure::RunFailure,
    loads::Short,
    scenario::{Scenario, Watched},
};

/// What is drawn for a run.
#[derive(Clone, Debug)]
pub(crate) struct Case {
    /// Of payload and stage.
    pub(crate) bodies: [ModelDraw; 2],
    pub(crate) separation: Result<Separation, RunFailure>,
    /// What else was drawn, in the order of the scenario's dispersions.
    pub(crate) drawn: Box<[f64]>,
    /// Which vehicle it is and which of its flights, from 0, if there are vehicles.
    pub(crate) flight: Option<[i64; 2]>,
}

/// A run that has ended, or is only drawn.
#[derive(Clone, Debug)]
pub(crate) struct Run<'a> {
    pub(crate) case: &'a Case,
    /// None if it is only drawn.
    end: Option<Result<End<'a>, RunFailure>>,
}

/// The end of a run in which the bodies part.
#[derive(Clone, Debug)]
pub(crate) struct End<'a> {
    scenario: &'a Scenario,
    pub(crate) separated: Separated,
    /// Of the payload after the last release.
    pub(crate) spin: SpinMetrics,
    /// Of the payload at the start.
    pub(crate) spin_before: SpinMetrics,
    /// Of payload and stage, body axes, rad/s.
    pub(crate) tip_off: [Vector3<f64>; 2],
    /// Of the payload about its mass centre, inertial axes, kg·m²/s.
    pub(crate) momentum: Vector3<f64>,
    pub(crate) energy: EnergySplit,
    /// How near the bodies come, if that is watched.
    watched: Option<Result<Watched, ClearanceError>>,
}

impl Case {
    /// The bodies without any dispersion.
    pub(crate) fn nominal(scenario: &Scenario) -> Self {
        Self {
            bodies: [scenario.payload(), scenario.stage()]
                .map(|body| ModelDraw::from(*body.nominal().as_inertia_matrix())),
            separation: Ok(scenario.separation().clone()),
            drawn: Box::default(),
            flight: None,
        }
    }

    /// The run that ended so; without a separation there is no end.
    pub(crate) fn ended<'a>(
        &'a self,
        scenario: &'a Scenario,
        result: Option<Result<Separated, RunError>>,
    ) -> Run<'a> {
        let end = match (&self.separation, result) {
            (Ok(separation), Some(Ok(separated))) => self
                .watch(scenario, separation, &separated)
                .map(|watched| End::new(scenario, separated, watched)),
            (Ok(_), Some(Err(error))) => Err(error.into()),
            (Err(failure), _) => Err(failure.clone()),
            // A batch gives every run a result.
            (Ok(_), None) => Err(RunError::NotFinite { time: 0.0 }.into()),
        };
        Run { case: self, end: Some(end) }
    }

    /// The run as it is drawn, which is not separated; failed if it cannot be.
    pub(crate) fn drawn(&self) -> Run<'_> {
        let refused = self.separation.as_ref().err();
        Run { case: self, end: refused.map(|failure| Err(failure.clone())) }
    }

    fn watch(
        &self,
        scenario: &Scenario,
        separation: &Separation,
        separated: &Separated,
    ) -> Result<Option<Result<Watched, ClearanceError>>, RunFailure> {
        let watched = scenario.outlines().map(|outlines| {
            let centres = drawn::mass_centres(scenario.dispersions(), &self.drawn);
            outlines.watch(separation, scenario.settings(), separated, &centres)
        });
        watched.transpose()
    }
}

impl<'a> Run<'a> {
    /// Why it failed, if it did.
    pub(crate) fn failure(&self) -> Option<&RunFailure> {
        self.end.as_ref()?.as_ref().err()
    }

    /// How it ended, unless it failed or is only drawn.
    pub(crate) fn end(&self) -> Option<&End<'a>> {
        self.end.as_ref()?.as_ref().ok()
    }

    /// The drawn inertia: I11, I22, I33, I12, I13, I23, kg·m².
    pub(crate) fn inertia(&self, body: Body) -> [f64; 6] {
        self.case.bodies[body as usize].inertia.entries()
    }

    /// Whether both drawn inertias are realizable.
    pub(crate) fn realizable(&self) -> bool {
        self.case.bodies.iter().all(|drawn| drawn.inertia.is_realizable())
    }

    /// The attitude of the principal axes of a body, as drawn.
    pub(crate) fn axes(&self, body: Body) -> Option<UnitQuaternion<f64>> {
        self.case.bodies[body as usize].axes
    }
}

impl<'a> End<'a> {
    fn new(
        scenario: &'a Scenario,
        separated: Separated,
        watched: Option<Result<Watched, ClearanceError>>,
    ) -> Self {
        Self {
            scenario,
            spin: separated.spin_metrics(scenario.spin_axis()),
            spin_before: separated.start()[0].spin_metrics(scenario.spin_axis()),
            tip_off: separated.tip_off(),
            momentum: separated.payload().inertial_spin_angular_momentum(),
            energy: separated.energy_split(),
            separated,
            watched,
        }
    }

    /// Angle to the intended direction of separation, rad.
    pub(crate) fn direction_error(&self) -> Option<f64> {
        self.separated.direction_error(self.scenario.separation_direction()?)
    }

    /// Angle of the payload's momentum to its intended direction, rad.
    pub(crate) fn momentum_error(&self) -> Option<f64> {
        self.separated.momentum_error(self.scenario.momentum_direction())
    }

    /// How near the bodies come, if that is watched and found.
    pub(crate) fn clearance(&self) -> Option<&Clearance> {
        self.watched.as_ref()?.as_ref().ok().map(Watched::clearance)
    }

    /// Where they are nearest.
    pub(crate) fn closest(&self) -> Option<&Approach> {
        self.clearance()?.closest()
    }

    /// Whether a search of the outlines was given up, so that they may touch where no contact was found.
    pub(crate) fn is_given_up(&self) -> bool {
        let watched = self.watched.as_ref().and_then(|watched| watched.as_ref().ok());
        watched.is_some_and(Watched::is_given_up)
    }

    /// What there is to say of the clearance; nothing if it is that of the whole motion.
    pub(crate) fn clearance_notes(&self) -> Vec<ClearanceNote> {
        self.watched.as_ref().map_or_else(Vec::new, ClearanceNote::all)
    }

    /// Loads in the order of their releases, `+` between those that let go together.
    pub(crate) fn release_order(&self) -> String {
        let mut order = String::new();
        for group in self.separated.release_order() {
            for (i, load) in group.iter().enumerate() {
                let between = if i > 0 {
                    "+"
                } else if order.is_empty() {
                    ""
                } else {
                    " "
                };
                if let Some(id) = self.scenario.separation().id(*load) {
                    // Writing into a text cannot fail.
                    let _ = write!(order, "{between}{}", Short(id));
                }
            }
        }
        order
    }

    /// Loads that were pressed again after they had let go.
    pub(crate) fn recompressed(&self) -> String {
        let separation = self.scenario.separation();
        let loads = self.separated.recompressed();
        let loads = loads.filter_map(|(place, _)| Some(Short(separation.id(place)?).to_string()));
        loads.collect::<Vec<_>>().join(" ")
    }
}

/// Why a run has no clearance, or not one of its whole motion: several may hold.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub(crate) enum ClearanceNote {
    /// All outlines touch at the start, part, and do not touch again.
    #[error("all outlines are mated: they touch at the start and do not touch again after parting")]
    Mated,
    /// All outlines touch at the start, and some of them do not part.
    #[error("all outlines are mated, and some do not part")]
    Together,
    /// Some outlines touch at the start and do not part, beside others that have a clearance.
    #[error("some outlines are mated and do not part: the clearance is that of the others")]
    SomeTogether,
    /// The bodies turn so far that they are not followed to the end of the coast, in which they could
    /// still come nearer.
    #[error("followed to {until:?} s only: a body turns too far in the coast")]
    Partial {
        /// Until when they are followed, s.
        until: f64,
    },
    /// The search for what counts was given up.
    #[error(
        "not proven: the bodies may come nearer, or touch earlier, for the search was given up after {looks} looks"
    )]
    NotProven {
        /// Instants and spans looked at.
        looks: usize,
    },
    /// The search before the last release was given up.
    #[error(
        "not proven before the last release: the bodies may come nearer there, or touch, for the search was given up after {looks} looks"
    )]
    NotProvenBefore {
        /// Instants and spans looked at.
        looks: usize,
    },
    /// Before the last release the bodies come nearer than when the clamp opened, and than after it.
    #[error(
        "the outlines come nearer before the last release: to {} m at {} s",
        significant(*distance, 3),
        significant(*time, 3)
    )]
    NearerBefore {
        /// How near, m, known to 1 %.
        distance: f64,
        /// When, s.
        time: f64,
    },
    /// The search has failed.
    #[error("clearance not found: {0}")]
    NotFound(ClearanceError),
}

impl ClearanceNote {
    /// All that there is to say of a clearance.
    fn all(found: &Result<Watched, ClearanceError>) -> Vec<Self> {
        let watched = match found {
            Ok(watched) => watched,
            Err(error) => return vec![Self::NotFound(*error)],
        };
        let clearance = watched.clearance();
        let partial = clearance.undecided_from_s().map(|until| Self::Partial { until });
        let looks = clearance.looks();
        let not_proven = clearance.is_stopped().then_some(Self::NotProven { looks });
        let before = watched.given_up_before().map(|looks| Self::NotProvenBefore { looks });
        let nearer = watched.nearer_before().map(|nearest| Self::NearerBefore {
            distance: nearest.distance_m(),
            time: nearest.time_s(),
        });
        let parted = clearance.shapes().iter().all(|s| s.counts_from_s().is_some());
        let mated = match (clearance.closest().is_some(), parted) {
            (true, true) => None,
            (true, false) => Some(Self::SomeTogether),
            (false, true) => Some(Self::Mated),
            (false, false) => Some(Self::Together),
        };
        // Up to when the bodies are followed comes first, for what is said of the outlines holds until then.
        [partial, not_proven, before, nearer, mated].into_iter().flatten().collect()
    }

    /// What kind it is, without numbers, so that those of a kind can be counted.
    pub(crate) fn kind(self) -> &'static str {
        match self {
            Self::Mated => "all outlines are mated and do not touch again after parting",
            Self::Together => "all outlines are mated, and some do not part",
            Self::SomeTogether => "some outlines are mated and do not part",
            Self::Partial { .. } => "a body turns too far to be followed to the end of the coast",
            Self::NotProven { .. } => "the search was given up before the clearance was proven",
            Self::NotProvenBefore { .. } => {
                "the search before the last release was given up before the clearance there was proven"
            }
            Self::NearerBefore { .. } => {
                "the outlines come nearer before the last release than after it"
            }
            Self::NotFound(_) => "the clearance was not found",
        }
    }
}

#[cfg(test)]
mod tests;
