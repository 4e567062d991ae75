//! What a model draws of the bodies and the quantities of a simulator.

use gyradius_campaign::{Cell, Column, Failure, Inputs, Simulation, Streams, Table, TableError};
use gyradius_dispersion::{InertiaLaw, ModelKind};
use std::{ops::Range, sync::Arc};

use super::{
    body::SimulatedBody, file::SimulatedModelFile, number::Number, scenario::SimulatorScenario,
};
use crate::{
    ScenarioError,
    drawn::{self, following},
    model::matched,
    scenario::{Axes, Joint},
};

/// What a model draws of the bodies and the quantities of a simulator: inputs that are sent, or rows of their own.
#[derive(Debug)]
pub(crate) struct SimulatorDraws<'a> {
    columns: Vec<Column>,
    bodies: Vec<BodyDraws<'a>>,
    quantities: &'a [Number],
    dispersed: &'a Joint<usize>,
    draws: drawn::Draws,
}

#[derive(Debug)]
struct BodyDraws<'a> {
    body: &'a SimulatedBody,
    law: Arc<dyn InertiaLaw>,
    inertias: Streams,
}

impl<'a> SimulatorDraws<'a> {
    /// Of the model in a place of the scenario.
    pub(crate) fn new(
        scenario: &'a SimulatorScenario,
        place: usize,
    ) -> Result<Self, ScenarioError> {
        let (seed, name) = (scenario.seed(), scenario.models()[place].name.as_str());
        let body = |body: &'a SimulatedBody| {
            let law = law(scenario, place, body)?;
            let inertias = Streams::new(seed, name, &format!("{} inertia", body.name));
            Ok(BodyDraws { body, law, inertias })
        };
        Ok(Self {
            columns: scenario.inputs().collect(),
            bodies: scenario.bodies().iter().map(body).collect::<Result<_, ScenarioError>>()?,
            quantities: scenario.quantities(),
            dispersed: scenario.dispersed(),
            draws: drawn::Draws::new(seed, name, &scenario.dispersed().all),
        })
    }
}

impl Inputs for SimulatorDraws<'_> {
    fn columns(&self) -> Vec<Column> {
        self.columns.clone()
    }

    fn draw(&self, run: u64, numbers: &mut Vec<Option<f64>>) -> Result<(), Failure> {
        let of_bodies = self.bodies.iter().flat_map(|draws| &draws.body.numbers);
        let mut values: Vec<f64> =
            of_bodies.chain(self.quantities).map(|number| number.nominal).collect();
        for (d, value) in self.dispersed.all.iter().zip(self.draws.values(self.dispersed, |_| run))
        {
            values[d.target] = value;
        }
        let (mut first, mut failure) = (0, None);
        for draws in &self.bodies {
            let body = draws.body;
            let own = &values[first..first + body.numbers.len()];
            first += own.len();
            let mass = own[0];
            let drawn = draws.law.draw(&mut draws.inertias.run(run));
            let inertia = following(drawn.inertia, mass / body.mass_kg, body.follows);
            numbers.extend(own.iter().copied().map(Some));
            numbers.extend(inertia.entries().map(Some));
            let axes = drawn.axes.map(|axes| axes.coords);
            numbers.extend((0..4).map(|i| axes.map(|axes| axes[i])));
            if !(mass > 0.0) && failure.is_none() {
                let name = &body.name;
                let message = format!("{name}: the mass is {mass} kg, and must be positive");
                failure = Some(Failure::new(format!("{name}: mass not positive"), message));
            }
        }
        numbers.extend(values[first..].iter().copied().map(Some));
        failure.map_or(Ok(()), Err)
    }
}

/// The draws alone.
impl Simulation for SimulatorDraws<'_> {
    type Worker = Vec<Option<f64>>;

    fn columns(&self) -> Vec<Column> {
        self.columns.clone()
    }

    fn worker(&self) -> Self::Worker {
        Vec::new()
    }

    fn run(
        &self,
        runs: Range<u64>,
        numbers: &mut Self::Worker,
        rows: &mut Table,
    ) -> Result<(), TableError> {
        for run in runs {
            numbers.clear();
            let failure = self.draw(run, numbers).err();
            rows.push(failure, numbers.iter().map(|number| Cell::from(*number)))?;
        }
        Ok(())
    }
}

/// The law of a body under the model in a place.
fn law(
    scenario: &SimulatorScenario,
    place: usize,
    body: &SimulatedBody,
) -> Result<Arc<dyn InertiaLaw>, ScenarioError> {
    let model = &scenario.models()[place];
    let field = |key: &str| format!("models[{}].{key}", place + 1);
    let refused = |key: &str, problem: &dyn std::fmt::Display| {
        ScenarioError::field(field(key), format!("the body {}: {problem}", body.name))
    };
    match (model.law, model.axes, &model.matched_to) {
        (ModelKind::Principal, Some(axes), None) => {
            if axes != Axes::WholeSphere && body.uncertain.gaussian_axes().is_none() {
                let problem = "only \"whole-sphere\" goes with dispersion.axes that are \"uniform\" or \"fixed\": they have \
                               no far half";
                return Err(refused("axes", &problem));
            }
            Ok(Arc::new(body.uncertain.principal(axes).map_err(|error| refused("axes", &error))?))
        }
        (ModelKind::Principal, None, None) => {
            let problem = "missing: law \"principal\" needs axes: \"whole-sphere\", \"mean-half\" or \"jacobian-twice\"";
            Err(ScenarioError::field(field("axes"), problem))
        }
        (ModelKind::Principal, _, Some(_)) => {
            Err(ScenarioError::field(field("matched_to"), "law \"principal\" does not take it"))
        }
        (kind, Some(_), _) => {
            Err(ScenarioError::field(field("axes"), format!("law \"{kind}\" does not take it")))
        }
        (kind, None, None) => {
            let problem =
                format!("missing: law \"{kind}\" needs the name of a model with law \"principal\"");
            Err(ScenarioError::field(field("matched_to"), problem))
        }
        (kind, None, Some(to)) => {
            let principal = |m: &SimulatedModelFile| m.name == *to && m.law == ModelKind::Principal;
            let other = scenario.models().iter().position(principal).ok_or_else(|| {
                let problem = format!("{to:?}: it must name a model with law \"principal\"");
                ScenarioError::field(field("matched_to"), problem)
            })?;
            let moments = law(scenario, other, body)?.expected_moments().ok_or_else(|| {
                refused("matched_to", &format!("the moments of {to:?} are not known"))
            })?;
            let model = matched(kind, &body.uncertain, &moments)
                .map_err(|error| refused("matched_to", &error))?;
            Ok(Arc::new(model))
        }
    }
}
