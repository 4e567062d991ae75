use gyradius_dispersion::{
    DispersionModel, EntrywiseGaussian, KnownMoments, ModelDraw, ModelKind, RealizableOnly,
};
use gyradius_inertia::InertiaMatrix;
use gyradius_separation::{RunError, SeparationError};
use rand_distr::Distribution;

use crate::{
    row::{Body, Failure, Outcome, Row},
    scenario::{Law, ModelSpec, Scenario, ScenarioError, UncertainBody},
    streams::Streams,
};

/// A model ready to draw: a law and its random streams for either body.
#[derive(Debug)]
pub(crate) struct Model {
    name: String,
    payload: BodyModel,
    stage: BodyModel,
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
                law: law(spec, which, body, scenario)
                    .map_err(|e| ScenarioError::field(format!("models.{}", spec.name), e))?,
                streams: Streams::new(scenario.seed(), &spec.name, &purpose),
            })
        };
        Ok(Self {
            name: spec.name.clone(),
            payload: body(Body::Payload, scenario.payload())?,
            stage: body(Body::Stage, scenario.stage())?,
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

    /// Draws the bodies of one run and separates them.
    pub(crate) fn run(&self, scenario: &Scenario, run: u64) -> Row {
        let payload = self.payload.draw(run);
        let stage = self.stage.draw(run);
        let outcome = separate(scenario, payload.inertia, stage.inertia);
        Row {
            run,
            payload: payload.inertia.entries(),
            stage: stage.inertia.entries(),
            realizable: payload.inertia.is_realizable() && stage.inertia.is_realizable(),
            payload_axes: payload.axes,
            stage_axes: stage.axes,
            outcome,
        }
    }
}

/// Separates the scenario's bodies with the given inertias.
pub(crate) fn separate(
    scenario: &Scenario,
    payload: InertiaMatrix,
    stage: InertiaMatrix,
) -> Result<Outcome, Failure> {
    let bodies = scenario.separation().with_inertias(payload, stage);
    let bodies = bodies.map_err(|error| Failure {
        kind: match &error {
            SeparationError::Body { body, .. } => format!("{body}: inertia not positive definite"),
            _ => "separation refused".to_owned(),
        },
        reason: error.to_string(),
    })?;
    let separated = bodies.run(scenario.settings()).map_err(|error| Failure {
        kind: match &error {
            RunError::NotReleased { .. } => "springs not released within the horizon".to_owned(),
            _ => "integration failed".to_owned(),
        },
        reason: error.to_string(),
    })?;
    Ok(Outcome::new(&separated, scenario.spin_axis()))
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
