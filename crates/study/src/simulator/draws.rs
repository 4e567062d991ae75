//! What a model draws of the bodies and the quantities of a simulator.

use gyradius_campaign::{
    Cell, Column, Failure, Inputs, Mix, Simulation, Streams, Table, TableError,
};
use std::ops::Range;

use super::{body::SimulatedBody, number::Number, scenario::SimulatorScenario};
use crate::{
    ScenarioError,
    drawn::{self, BodyLaw, Taken},
    groups::{Drawing, GroupedBody, Groups},
    scenario::{Each, Joint, Size},
    steering::Steered,
};

/// What a model draws of the bodies and the quantities of a simulator: inputs that are sent, or rows of their own.
#[derive(Debug)]
pub(crate) struct SimulatorDraws<'a> {
    size: Size,
    /// The columns of vehicle and flight, if there are vehicles, and those of what is drawn.
    own: Vec<Column>,
    columns: Vec<Column>,
    bodies: &'a [SimulatedBody],
    laws: Vec<BodyLaw>,
    quantities: &'a [Number],
    dispersed: &'a Joint<usize>,
    draws: drawn::Draws,
    groups: Groups,
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
        let (seed, name) = (scenario.seed(), scenario.model_names().nth(place).unwrap_or_default());
        let body = |(i, body): (usize, &'a SimulatedBody)| {
            let (law, own) = scenario.law(place, i)?;
            let streams = Streams::new(seed, name, &format!("{} inertia", body.name));
            Ok(BodyLaw { law, streams, each: body.inertia_drawn, own })
        };
        let bodies = scenario.bodies();
        let laws = bodies.iter().enumerate().map(body);
        let laws: Vec<BodyLaw> = laws.collect::<Result<_, ScenarioError>>()?;
        let grouped = bodies.iter().zip(&laws).map(|(body, drawn)| GroupedBody {
            name: &body.name,
            law: &*drawn.law,
            own: drawn.own,
        });
        Ok(Self {
            groups: Groups::new(grouped, scenario.dispersed()).and(SIMULATOR),
            drawing: Drawing::Plain,
            size: scenario.size(),
            own: scenario.own(),
            columns: scenario.inputs().collect(),
            bodies,
            laws,
            quantities: scenario.quantities(),
            dispersed: scenario.dispersed(),
            draws: drawn::Draws::new(seed, name, scenario.dispersed()),
        })
    }
}

impl SimulatorDraws<'_> {
    /// The groups of inputs that are drawn independently of each other.
    pub(crate) fn groups(&self) -> &Groups {
        &self.groups
    }

    /// The same, which draw this.
    pub(crate) fn drawing(self, drawing: Drawing) -> Self {
        Self { drawing, ..self }
    }

    /// The scores of runs that are steered.
    pub(crate) fn steered(&self, runs: u64) -> Vec<Steered> {
        let Some(steering) = self.drawing.steering() else { return Vec::new() };
        let of = |run| {
            let mix = self.mix(run);
            let scores = steering.of(&self.scores(mix));
            Steered { choice: steering.choice(mix.base()), scores }
        };
        (0..runs).map(of).collect()
    }

    /// The independent scores of a run.
    fn scores(&self, mix: Mix<'_>) -> Vec<f64> {
        let stream = |each| self.size.stream(each, mix.base());
        let taken = Taken { mix, stream: &stream, steering: self.drawing.steering() };
        self.draws.scores(self.dispersed, &self.groups, taken)
    }

    /// Which draws a run takes.
    fn mix(&self, run: u64) -> Mix<'_> {
        self.groups.mix(&self.drawing, run, self.size.fleet())
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
        let base = self.mix(run).base();
        self.size.fleet().map_or_else(Vec::new, |fleet| fleet.numbers(base).into())
    }

    fn seed_stream(&self, run: u64) -> u64 {
        let mix = self.mix(run);
        mix.stream(self.groups.names().len() - 1, mix.base())
    }

    fn draw(&self, run: u64, numbers: &mut Vec<Option<f64>>) -> Result<(), Failure> {
        let of_bodies = self.bodies.iter().flat_map(|body| &body.numbers);
        let mut values: Vec<f64> =
            of_bodies.chain(self.quantities).map(|number| number.nominal).collect();
        let mix = self.mix(run);
        let stream = |each: Each| self.size.stream(each, mix.base());
        let taken = Taken { mix, stream: &stream, steering: self.drawing.steering() };
        let (drawn, inertias) = self.draws.run(self.dispersed, &self.groups, &self.laws, taken);
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
        self.own.iter().chain(&self.columns).cloned().collect()
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
            rows.push(failure, place.chain(numbers.iter().map(|number| Cell::from(*number))))?;
        }
        Ok(())
    }
}
