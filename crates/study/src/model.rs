//! Inertia models ready to draw, and the runs that their draws make.

use gyradius_dispersion::{
    DispersionModel, EntrywiseGaussian, KnownMoments, ModelDraw, ModelKind, RealizableOnly,
};
use gyradius_inertia::InertiaMatrix;
use gyradius_separation::{Batch, Clearance, ClearanceError, RunError, Separation};
use nalgebra::UnitQuaternion;
use rand_distr::Distribution;
use std::ops::Range;

use crate::{
    drawn::{self, Draws},
    quantity::Body,
    row::{Failure, Outcome, Row},
    scenario::{Law, ModelSpec, Scenario, ScenarioError, UncertainBody},
    streams::Streams,
};

/// A model ready to draw: a law and its random streams for either body.
#[derive(Debug)]
pub(crate) struct Model {
    name: String,
    payload: BodyModel,
    stage: BodyModel,
    draws: Draws,
}

#[derive(Debug)]
struct BodyModel {
    law: DispersionModel,
    streams: Streams,
}

impl Model {
    pub(crate) fn new(spec: &ModelSpec, scenario: &Scenario) -> Result<Self, ScenarioError> {
        let body = |which: Body, body: &UncertainBody| {
            let purpose = format!("{} inertia", which.name());
            Ok(BodyModel {
                law: law(spec, which, body, scenario).map_err(|error| {
                    let problem = format!("the {}: {error}", which.name());
                    ScenarioError::field(scenario.place(spec), problem)
                })?,
                streams: Streams::new(scenario.seed(), &spec.name, &purpose),
            })
        };
        Ok(Self {
            name: spec.name.clone(),
            payload: body(Body::Payload, scenario.payload())?,
            stage: body(Body::Stage, scenario.stage())?,
            draws: Draws::new(scenario.seed(), &spec.name, scenario.dispersions()),
        })
    }

    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// Which model it is.
    pub(crate) fn kind(&self) -> ModelKind {
        self.payload.law.kind()
    }

    /// The estimated shares of draws for payload and stage that rejection keeps, where it rejects.
    pub(crate) fn acceptance(&self) -> Option<[f64; 2]> {
        Some([self.payload.law.acceptance()?, self.stage.law.acceptance()?])
    }

    /// The deviations of the six entries of payload and stage that the law was given, if it is
    /// entrywise.
    pub(crate) fn given_deviations(&self) -> Option<[[f64; 6]; 2]> {
        match (&self.payload.law, &self.stage.law) {
            (DispersionModel::Entrywise(payload), DispersionModel::Entrywise(stage)) => {
                Some([payload.deviations(), stage.deviations()])
            }
            _ => None,
        }
    }

    /// Draws the bodies of one run.
    pub(crate) fn draw(&self, scenario: &Scenario, run: u64) -> Case {
        let drawn = self.draws.run(scenario.dispersions(), run);
        let mut payload = self.payload.draw(run);
        let mut stage = self.stage.draw(run);
        for (body, draw) in [(Body::Payload, &mut payload), (Body::Stage, &mut stage)] {
            draw.inertia = drawn::scaled(scenario, body, &drawn, draw.inertia);
        }
        let separation = drawn::separation(scenario, &drawn, payload.inertia, stage.inertia);
        Case {
            run,
            payload: payload.inertia,
            stage: stage.inertia,
            payload_axes: payload.axes,
            stage_axes: stage.axes,
            separation,
            drawn,
        }
    }

    /// Draws the bodies of several runs and separates them together, to the bits that each has alone.
    pub(crate) fn run(&self, scenario: &Scenario, runs: Range<u64>, batch: &mut Batch) -> Vec<Row> {
        let cases: Vec<Case> = runs.map(|run| self.draw(scenario, run)).collect();
        let sound = |i: &usize| cases[*i].separation.is_ok();
        let places: Vec<usize> = (0..cases.len()).filter(sound).collect();
        let mut results: Vec<_> = cases.iter().map(|_| None).collect();
        let queue = cases.iter().filter_map(|case| case.separation.as_ref().ok());
        batch.run(queue, |i, result| results[places[i]] = Some(result));
        let cases = cases.iter().zip(results);
        cases.map(|(case, result)| case.row(scenario, result)).collect()
    }
}

/// What is drawn for a run.
#[derive(Clone, Debug)]
pub(crate) struct Case {
    pub(crate) run: u64,
    pub(crate) payload: InertiaMatrix,
    pub(crate) stage: InertiaMatrix,
    pub(crate) payload_axes: Option<UnitQuaternion<f64>>,
    pub(crate) stage_axes: Option<UnitQuaternion<f64>>,
    pub(crate) separation: Result<Separation, Failure>,
    /// What else was drawn, in the order of the scenario's dispersions.
    pub(crate) drawn: Box<[f64]>,
}

impl Case {
    /// The bodies without any dispersion.
    pub(crate) fn nominal(scenario: &Scenario) -> Self {
        Self {
            run: 0,
            payload: *scenario.payload().nominal().as_inertia_matrix(),
            stage: *scenario.stage().nominal().as_inertia_matrix(),
            payload_axes: None,
            stage_axes: None,
            separation: Ok(scenario.separation().clone()),
            drawn: Box::default(),
        }
    }

    /// The row of a run that ended so; without a separation there is no end.
    pub(crate) fn row(
        &self,
        scenario: &Scenario,
        result: Option<Result<gyradius_separation::Outcome, RunError>>,
    ) -> Row {
        self.ended(scenario, result).0
    }

    /// The row, and how near the bodies come if that is watched and the run ends well.
    pub(crate) fn ended(
        &self,
        scenario: &Scenario,
        result: Option<Result<gyradius_separation::Outcome, RunError>>,
    ) -> (Row, Option<Clearance>) {
        let mut near = None;
        let outcome = match (&self.separation, result) {
            (Ok(separation), Some(Ok(outcome))) => {
                self.clearance(scenario, &outcome).map(|watched| {
                    let outcome = Outcome::new(scenario, separation, &outcome, watched.as_ref());
                    near = watched.and_then(Result::ok);
                    outcome
                })
            }
            (Ok(_), Some(Err(error))) => Err(error.into()),
            (Err(failure), _) => Err(failure.clone()),
            // A batch gives every run a result.
            (Ok(_), None) => Err(RunError::NotFinite { time: 0.0 }.into()),
        };
        let row = Row {
            run: self.run,
            payload: self.payload.entries(),
            stage: self.stage.entries(),
            realizable: self.payload.is_realizable() && self.stage.is_realizable(),
            payload_axes: self.payload_axes,
            stage_axes: self.stage_axes,
            outcome,
            drawn: self.drawn.clone(),
        };
        (row, near)
    }

    fn clearance(
        &self,
        scenario: &Scenario,
        outcome: &gyradius_separation::Outcome,
    ) -> Result<Option<Result<Clearance, ClearanceError>>, Failure> {
        let watched = scenario.outlines().map(|outlines| {
            outlines.clearance(outcome, &drawn::mass_centres(scenario.dispersions(), &self.drawn))
        });
        watched.transpose()
    }
}

impl BodyModel {
    fn draw(&self, run: u64) -> ModelDraw {
        self.law.sample(&mut self.streams.run(run))
    }
}

/// The law of one body.
fn law(
    spec: &ModelSpec,
    which: Body,
    body: &UncertainBody,
    scenario: &Scenario,
) -> Result<DispersionModel, Box<dyn std::error::Error>> {
    match &spec.law {
        Law::Principal(axes) => Ok(body.principal(*axes)?.into()),
        Law::Given { kind, payload, stage } => match which {
            Body::Payload => payload.model(*kind, body.nominal()),
            Body::Stage => stage.model(*kind, body.nominal()),
        },
        Law::Matched { kind, to } => {
            let other = scenario.models().iter().find(|m| m.name == *to).map(|m| &m.law);
            let Some(Law::Principal(axes)) = other else {
                return Err(format!("matched_to {to:?}: no such model").into());
            };
            let moments = body.principal(*axes)?.entry_moments();
            // The naive model knows the nominal body and how far its entries scatter, no more.
            let naive = || EntrywiseGaussian::new(*body.nominal(), moments.deviations());
            Ok(match kind {
                ModelKind::Entrywise => naive()?.into(),
                ModelKind::RealizableEntrywise => RealizableOnly::new(naive()?)?.into(),
                kind => DispersionModel::matched(*kind, &moments)?.into_model(),
            })
        }
    }
}
