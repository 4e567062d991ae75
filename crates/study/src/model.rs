use gyradius_attitude::{MeanHalf, RadiallyConstrainedGaussian};
use gyradius_dispersion::{
    EntryMoments, EntrywiseGaussian, GaussianRoots, JacobianTwice, PrincipalDispersion,
    PrincipalDraw,
};
use gyradius_inertia::InertiaMatrix;
use gyradius_separation::{RunError, SeparationError};
use nalgebra::UnitQuaternion;
use rand_distr::Distribution;

use crate::{
    row::{Body, Failure, Outcome, Row},
    scenario::{Axes, Law, ModelSpec, Scenario, ScenarioError, UncertainBody},
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
    law: BodyLaw,
    streams: Streams,
}

#[derive(Debug)]
enum BodyLaw {
    WholeSphere(PrincipalDispersion<GaussianRoots, RadiallyConstrainedGaussian>),
    MeanHalf(PrincipalDispersion<GaussianRoots, MeanHalf>),
    JacobianTwice(Box<PrincipalDispersion<GaussianRoots, JacobianTwice>>),
    Entrywise(EntrywiseGaussian),
}

/// A drawn inertia, and the attitude of its principal axes where the law draws one.
struct Draw {
    inertia: InertiaMatrix,
    axes: Option<UnitQuaternion<f64>>,
}

impl Model {
    pub(crate) fn new(spec: &ModelSpec, scenario: &Scenario) -> Result<Self, ScenarioError> {
        let body = |which: Body, body: &UncertainBody| {
            let purpose = format!("{} inertia", which.name());
            Ok(BodyModel {
                law: BodyLaw::new(spec, which, body)
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

    /// The deviations of the six entries of payload and stage that the law was given, if it is
    /// entrywise.
    pub(crate) fn given_deviations(&self) -> Option<[[f64; 6]; 2]> {
        match (&self.payload.law, &self.stage.law) {
            (BodyLaw::Entrywise(payload), BodyLaw::Entrywise(stage)) => {
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
    fn draw(&self, run: u64) -> Draw {
        let rng = &mut self.streams.run(run);
        let principal =
            |draw: PrincipalDraw| Draw { inertia: draw.inertia.into(), axes: Some(draw.axes) };
        match &self.law {
            BodyLaw::WholeSphere(law) => principal(law.sample(rng)),
            BodyLaw::MeanHalf(law) => principal(law.sample(rng)),
            BodyLaw::JacobianTwice(law) => principal(law.sample(rng)),
            BodyLaw::Entrywise(law) => Draw { inertia: law.sample(rng), axes: None },
        }
    }
}

impl BodyLaw {
    fn new(
        spec: &ModelSpec,
        which: Body,
        body: &UncertainBody,
    ) -> Result<Self, Box<dyn std::error::Error>> {
        let whole = || PrincipalDispersion::new(*body.roots(), body.axes().clone());
        let entrywise =
            |deviations| EntrywiseGaussian::new(*body.nominal(), deviations).map(Self::Entrywise);
        Ok(match &spec.law {
            Law::Principal(Axes::WholeSphere) => Self::WholeSphere(whole()),
            Law::Principal(Axes::MeanHalf) => Self::MeanHalf(PrincipalDispersion::new(
                *body.roots(),
                MeanHalf::new(body.axes().clone()),
            )),
            Law::Principal(Axes::JacobianTwice) => {
                let axes = JacobianTwice::new(body.axes().clone())?;
                Self::JacobianTwice(Box::new(PrincipalDispersion::new(*body.roots(), axes)))
            }
            Law::Entrywise { payload, stage } => entrywise(match which {
                Body::Payload => *payload,
                Body::Stage => *stage,
            })?,
            Law::EntrywiseMatched(_) => entrywise(EntryMoments::of(&whole()).deviations())?,
        })
    }
}
