//! Inertia models ready to draw, and the runs that their draws make.

use gyradius_campaign::{Column as RunColumn, Failure, Simulation, Streams, Table, TableError};
use gyradius_dispersion::{
    DispersionModel, EntrywiseGaussian, InertiaLaw, KnownMoments, ModelDraw, ModelKind,
    RealizableOnly,
};
use gyradius_separation::Batch;
use std::ops::Range;

use crate::{
    body::Body,
    column::Column,
    drawn::{self, Draws},
    run::{Case, Run},
    scenario::{Law, ModelSpec, Scenario, ScenarioError, UncertainBody},
};

/// A model ready to draw: a law and its random streams for either body.
#[derive(Debug)]
pub(crate) struct Model {
    name: String,
    kind: ModelKind,
    /// Of the six entries of payload and stage, if the law is entrywise.
    given: Option<[[f64; 6]; 2]>,
    payload: BodyModel,
    stage: BodyModel,
    draws: Draws,
}

#[derive(Debug)]
struct BodyModel {
    law: Box<dyn InertiaLaw>,
    streams: Streams,
}

impl Model {
    /// Those of a scenario.
    pub(crate) fn all(scenario: &Scenario) -> Result<Vec<Self>, ScenarioError> {
        scenario.models().iter().map(|spec| Self::new(spec, scenario)).collect()
    }

    pub(crate) fn new(spec: &ModelSpec, scenario: &Scenario) -> Result<Self, ScenarioError> {
        let law = |which: Body, body: &UncertainBody| {
            law(spec, which, body, scenario).map_err(|error| {
                let problem = format!("the {}: {error}", which.name());
                ScenarioError::field(scenario.place(spec), problem)
            })
        };
        let payload = law(Body::Payload, scenario.payload())?;
        let stage = law(Body::Stage, scenario.stage())?;
        let given =
            if let (DispersionModel::Entrywise(payload), DispersionModel::Entrywise(stage)) =
                (&payload, &stage)
            {
                Some([payload.deviations(), stage.deviations()])
            } else {
                None
            };
        let body = |which: Body, law: DispersionModel| {
            let purpose = format!("{} inertia", which.name());
            let streams = Streams::new(scenario.seed(), &spec.name, &purpose);
            BodyModel { law: Box::new(law), streams }
        };
        Ok(Self {
            name: spec.name.clone(),
            kind: spec.law.kind(),
            given,
            payload: body(Body::Payload, payload),
            stage: body(Body::Stage, stage),
            draws: Draws::new(scenario.seed(), &spec.name, scenario.dispersions()),
        })
    }

    /// What it is called.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// Which model it is.
    pub(crate) fn kind(&self) -> ModelKind {
        self.kind
    }

    /// The estimated shares of draws for payload and stage that rejection keeps, where it rejects.
    pub(crate) fn acceptance(&self) -> Option<[f64; 2]> {
        Some([self.payload.law.acceptance()?, self.stage.law.acceptance()?])
    }

    /// The deviations of the six entries of payload and stage that the law was given, if it is
    /// entrywise.
    pub(crate) fn given_deviations(&self) -> Option<[[f64; 6]; 2]> {
        self.given
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
            payload: payload.inertia,
            stage: stage.inertia,
            payload_axes: payload.axes,
            stage_axes: stage.axes,
            separation,
            drawn,
        }
    }
}

/// The separations of a scenario with the bodies that a model draws.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Separations<'a> {
    scenario: &'a Scenario,
    model: &'a Model,
}

impl<'a> Separations<'a> {
    pub(crate) fn new(scenario: &'a Scenario, model: &'a Model) -> Self {
        Self { scenario, model }
    }

    fn layout(&self) -> Vec<Column> {
        let springs = self.scenario.separation().springs().len();
        Column::all(springs, self.scenario.dispersions().columns().len())
    }

    /// Writes the row of a run that has ended.
    pub(crate) fn push(&self, run: &Run<'_>, rows: &mut Table) -> Result<(), TableError> {
        self.push_as(&self.layout(), run, rows)
    }

    fn push_as(
        &self,
        layout: &[Column],
        run: &Run<'_>,
        rows: &mut Table,
    ) -> Result<(), TableError> {
        rows.push(run.failure().map(Failure::from), layout.iter().map(|column| column.cell(run)))
    }
}

impl Simulation for Separations<'_> {
    type Worker = Batch;

    fn columns(&self) -> Vec<RunColumn> {
        let drawn = self.scenario.dispersions().columns();
        self.layout().into_iter().map(|column| column.declaration(&drawn)).collect()
    }

    fn worker(&self) -> Batch {
        Batch::new(*self.scenario.settings())
    }

    /// Draws the bodies of several runs and separates them together, to the bits that each has alone.
    fn run(&self, runs: Range<u64>, batch: &mut Batch, rows: &mut Table) -> Result<(), TableError> {
        let (scenario, layout) = (self.scenario, self.layout());
        let cases: Vec<Case> = runs.map(|run| self.model.draw(scenario, run)).collect();
        let sound = |i: &usize| cases[*i].separation.is_ok();
        let places: Vec<usize> = (0..cases.len()).filter(sound).collect();
        let mut results: Vec<_> = cases.iter().map(|_| None).collect();
        let queue = cases.iter().filter_map(|case| case.separation.as_ref().ok());
        batch.run(queue, |i, result| results[places[i]] = Some(result));
        for (case, result) in cases.iter().zip(results) {
            self.push_as(&layout, &case.ended(scenario, result), rows)?;
        }
        Ok(())
    }
}

impl BodyModel {
    fn draw(&self, run: u64) -> ModelDraw {
        self.law.draw(&mut self.streams.run(run))
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
