//! What a model draws of the bodies and the quantities of a simulator.

use gyradius_campaign::{Cell, Column, Failure, Inputs, Simulation, Table, TableError};
use std::ops::Range;

use super::{
    body::{Number, SimulatedBody},
    scenario::SimulatorScenario,
};
use crate::{
    ScenarioError,
    drawn::{Draws, Taken},
    groups::{BodyLaw, Drawing, Groups},
    scenario::{Joint, Size},
};

/// What a model draws of the bodies and the quantities of a simulator: inputs that are sent, or rows of their own.
#[derive(Debug)]
pub(crate) struct SimulatorDraws<'a> {
    size: Size,
    /// The columns of vehicle and flight, if there are vehicles, and those of what is drawn.
    own: Vec<Column>,
    columns: Vec<Column>,
    /// Of each of the latter, whether rows have it. A simulator is sent all.
    shown: Vec<bool>,
    bodies: &'a [SimulatedBody],
    quantities: &'a [Number],
    dispersed: &'a Joint<usize>,
    draws: Draws,
    drawing: Drawing,
}

/// What the random numbers of the simulator itself are called.
const SIMULATOR: &str = "the simulator's own random numbers";

impl<'a> SimulatorDraws<'a> {
    /// Of the model in a place of the scenario.
    pub(crate) fn new(
        scenario: &'a SimulatorScenario,
        place: usize,
    ) -> Result<Self, ScenarioError> {
        let name = scenario.model_names().nth(place).unwrap_or_default();
        let (key, bodies) = ((scenario.seed(), name), scenario.bodies());
        let law = |(i, body): (usize, &SimulatedBody)| {
            let (law, own) = scenario.law(place, i)?;
            Ok(BodyLaw::new(key, &body.name, law, body.inertia_drawn, own))
        };
        let laws = bodies.iter().enumerate().map(law).collect::<Result<_, ScenarioError>>()?;
        let mut draws = Draws::new(key, laws, scenario.dispersed());
        draws.groups = draws.groups.and(SIMULATOR);
        let columns: Vec<Column> = scenario.inputs().collect();
        Ok(Self {
            draws,
            drawing: Drawing::Plain,
            size: scenario.size(),
            own: scenario.own(),
            shown: vec![true; columns.len()],
            columns,
            bodies,
            quantities: scenario.quantities(),
            dispersed: scenario.dispersed(),
        })
    }
}

impl SimulatorDraws<'_> {
    /// The groups of inputs that are drawn independently of each other.
    pub(crate) fn groups(&self) -> &Groups {
        &self.draws.groups
    }

    /// The same, without columns of these names in rows.
    pub(crate) fn hiding(self, names: &[String]) -> Self {
        let is_shown = |column: &Column| names.iter().all(|name| name != column.name());
        Self { shown: self.columns.iter().map(is_shown).collect(), ..self }
    }

    /// What rows have of one for each column.
    fn shown<T>(&self, all: impl IntoIterator<Item = T>) -> impl Iterator<Item = T> {
        all.into_iter().zip(&self.shown).filter(|(_, shown)| **shown).map(|(one, _)| one)
    }

    /// The same, which draw this.
    pub(crate) fn drawing(self, drawing: Drawing) -> Self {
        Self { drawing, ..self }
    }

    /// The scores of runs that are steered.
    pub(crate) fn steered(&self, runs: u64) -> Vec<Vec<f64>> {
        self.draws.steered(&self.drawing, self.size, runs)
    }

    /// What a run takes.
    fn taken(&self, run: u64) -> Taken<'_> {
        self.draws.taken(&self.drawing, self.size, run)
    }
}

impl Inputs for SimulatorDraws<'_> {
    fn columns(&self) -> Vec<Column> {
        self.columns.clone()
    }

    fn place_columns(&self) -> Vec<Column> {
        self.own.clone()
    }

    fn place(&self, run: u64) -> Vec<i64> {
        let base = self.taken(run).mix.base();
        self.size.fleet().map_or_else(Vec::new, |fleet| fleet.numbers(base).into())
    }

    fn seed_stream(&self, run: u64) -> u64 {
        let mix = self.taken(run).mix;
        mix.stream(self.groups().names().len() - 1, mix.base())
    }

    fn draw(&self, run: u64, numbers: &mut Vec<Option<f64>>) -> Result<(), Failure> {
        let of_bodies = self.bodies.iter().flat_map(|body| &body.numbers);
        let mut values: Vec<f64> =
            of_bodies.chain(self.quantities).map(|number| number.nominal).collect();
        let (drawn, inertias) = self.draws.run(self.dispersed, self.taken(run));
        for (d, value) in self.dispersed.all.iter().zip(drawn) {
            values[d.target] = value;
        }
        let (mut first, mut failure) = (0, None);
        for (body, drawn) in self.bodies.iter().zip(inertias) {
            let own = &values[first..first + body.numbers.len()];
            first += own.len();
            let mass = own[0];
            numbers.extend(own.iter().copied().map(Some));
            numbers.extend(drawn.inertia.entries().map(Some));
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
        self.own.iter().chain(self.shown(&self.columns)).cloned().collect()
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
            let place = self.place(run).into_iter().map(Cell::Integer);
            let numbers = self.shown(numbers.iter()).map(|number| Cell::from(*number));
            rows.push(failure, place.chain(numbers))?;
        }
        Ok(())
    }
}
