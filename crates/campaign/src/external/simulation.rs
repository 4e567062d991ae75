//! Runs of a simulator: what is drawn for a run is sent, what comes back are columns beside it.

use rand::Rng;
use std::{cell::RefCell, ops::Range};

use super::{
    child::Child,
    inputs::{Named, RunInputs},
    simulator::{Said, Simulator},
    trouble::Trouble,
};
use crate::{
    cell::Cell,
    column::Column,
    failure::Failure,
    simulation::Simulation,
    streams::Streams,
    table::{Table, TableError},
};

/// What is drawn for a run and sent to the simulator.
pub trait Inputs: Sync {
    /// The columns of numbers that a run has, of which each has the name of the input; runs may have nothing in them.
    fn columns(&self) -> Vec<Column>;

    /// The columns of whole numbers that say which run it is beside its own number, such as those of a vehicle and its flight.
    /// They stand before all others, and are sent beside `run`; none if it does not say otherwise. They must not be called as
    /// anything else that is sent there: `model`, `seed` or `inputs`.
    fn place_columns(&self) -> Vec<Column> {
        Vec::new()
    }

    /// What a run has in these columns.
    fn place(&self, _run: u64) -> Vec<i64> {
        Vec::new()
    }

    /// The stream that the seed of a run is from: that of its number, unless it says otherwise.
    fn seed_stream(&self, run: u64) -> u64 {
        run
    }

    /// Pushes the numbers of a run, one for each column, in their order; none for what the run does not have, which is not
    /// sent. What run i has must depend on i alone: draw it from [`Streams`].
    ///
    /// # Errors
    /// They cannot be drawn. Those that were pushed before stay in the row of the failed run.
    fn draw(&self, run: u64, numbers: &mut Vec<Option<f64>>) -> Result<(), Failure>;
}

/// A simulator of the user's own as a [`Simulation`]: a command in any language that is sent the inputs of each run and
/// answers with its outputs.
///
/// # Line by line
/// A process for each thread is kept for many runs. For each run it reads one line of JSON from standard input,
/// `{"run":17,"model":"proposed","seed":4503599627370496,"inputs":{"payload_mass_kg":812.3}}`, and writes one line to
/// standard output, at once and of 1 MiB at most: `{"run":17,"outputs":{"tip_off_deg_per_s":0.4}}`, or
/// `{"run":17,"error":"diverged at 3.2 s"}` if the run failed. `run` may be left out of the answer; with it, no
/// answer is ever taken for that of another run. What was written before the process read the line is no
/// answer to it: the end of the line is sent once all before it has been read, as far as the system tells that. Messages
/// belong on standard error. When standard input ends, the process should end, too.
///
/// # With files
/// A [`Program::per_run`](super::Program::per_run) is started for each run in a temporary folder of its own,
/// where it reads the same from `input.json` and writes the same to `output.json`.
///
/// # As a function
/// A [`SimulatorFunction`](super::SimulatorFunction) of the program does runs without any process. It is given the same as a process is
/// sent, and fails by the same rules; a panic of it is a run that failed.
///
/// # The seed
/// The seed is for random numbers that the simulator draws itself. It is the first 64-bit word of the run's stream of the
/// purpose “simulator seed” (see [`Streams`]), shifted right by 11 bits: a whole number below 2⁵³, which JavaScript and
/// JSON readers that have nothing but doubles read exactly.
///
/// # What fails
/// A run fails, and its row says why, if its inputs cannot be drawn or are not finite; if the answer does not come in
/// time, is too long, no JSON, written before the run was sent whole, that of another run, or followed by more; if a declared
/// output is missing, repeated or not a finite number, or one is not declared; if the process ends or closes its pipes; and if the simulator says so.
/// An infinite output stays in the row of the run, whatever else is wrong with the answer, so that requirements on it count the run, and also if
/// a process that was started for the run has answered and then ended with an error. A process
/// that did not answer as agreed is killed with everything in its process group. If it had done runs before, the run is
/// sent once more, to a process that is started for it alone, and what that does counts. So a run depends on its inputs
/// alone, as long as the simulator itself keeps nothing from one run to the next, and a process that spoils itself spoils
/// no other run. If the system cannot start a process or use a temporary folder, no run is to blame, and that is the
/// [`fault`](Simulation::fault) that ends the campaign.
/// ```
/// use gyradius_campaign::{
///     Column, ExternalSimulation, Failure, Inputs, Program, Simulator, Streams, run, threads,
/// };
/// use rand::RngExt;
///
/// /// A mass between 90 kg and 110 kg.
/// struct Mass(Streams);
///
/// impl Inputs for Mass {
///     fn columns(&self) -> Vec<Column> {
///         vec![Column::number("mass_kg", "kg", "Mass, as drawn.")]
///     }
///
///     fn draw(&self, run: u64, numbers: &mut Vec<Option<f64>>) -> Result<(), Failure> {
///         numbers.push(Some(self.0.run(run).random_range(90.0..110.0)));
///         Ok(())
///     }
/// }
///
/// # if cfg!(unix) {
/// // A simulator in the shell, which answers the same every time.
/// let answer = r#"while read -r line; do echo '{"outputs":{"speed_m_per_s":2.5}}'; done"#;
/// let command = ["sh", "-c", answer].map(str::to_owned);
/// let simulator = Simulator::start(Program::new(&command, ".".as_ref())?)?;
/// let speed = Column::number("speed_m_per_s", "m/s", "Speed at the end.");
/// let mass = Mass(Streams::new(7, "any", "mass"));
/// let simulation = ExternalSimulation::new(&simulator, 7, "any", mass, vec![speed]);
/// let table = run(&simulation, "any", 100, &threads(Some(2))?, &|_| {})?;
/// assert_eq!(table.values("speed_m_per_s"), Some(vec![2.5; 100]));
/// # }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct ExternalSimulation<'a, I> {
    simulator: &'a Simulator,
    model: String,
    seeds: Streams,
    inputs: I,
    /// The columns of where the run belongs, of the inputs, and of the outputs.
    places: Vec<Column>,
    drawn: Vec<Column>,
    outputs: Vec<Column>,
}

/// What was told to and by a simulator in one run.
#[derive(Clone, Debug)]
pub struct Told {
    /// What was drawn, as far as it could be: a number or nothing for each column of the inputs, in their order.
    pub inputs: Vec<Option<f64>>,
    /// The line or the file that was sent; none if the inputs cannot be sent.
    pub request: Option<String>,
    /// The answer as it came, if one came.
    pub answer: Option<String>,
    /// The outputs in the order in which they are declared, or why there are none.
    pub outputs: Result<Vec<f64>, Failure>,
    /// Those of the declared outputs that are infinite, in their order, if there are any; empty if there are none.
    pub infinite: Vec<Option<f64>>,
}

/// What a run has that failed.
struct Failed {
    failure: Failure,
    /// The outputs that it has nevertheless.
    infinite: Vec<Option<f64>>,
}

impl From<Trouble> for Failed {
    fn from(trouble: Trouble) -> Self {
        Self { infinite: trouble.infinite().to_vec(), failure: trouble.failure() }
    }
}

impl From<Failure> for Failed {
    fn from(failure: Failure) -> Self {
        Self { failure, infinite: Vec::new() }
    }
}

impl<'a, I: Inputs> ExternalSimulation<'a, I> {
    /// Runs of a simulator under a model in a campaign with a seed: what is drawn and sent, and the outputs that it
    /// answers with, which are numbers.
    pub fn new(
        simulator: &'a Simulator,
        seed: u64,
        model: &str,
        inputs: I,
        outputs: Vec<Column>,
    ) -> Self {
        let (places, drawn) = (inputs.place_columns(), inputs.columns());
        let seeds = Streams::new(seed, model, "simulator seed");
        Self { simulator, model: model.to_owned(), seeds, inputs, places, drawn, outputs }
    }

    /// What is drawn and sent.
    #[must_use]
    pub fn inputs(&self) -> &I {
        &self.inputs
    }

    /// Does a run alone, in a process that is started for it, and tells what was said.
    #[must_use]
    pub fn replay(&self, run: u64) -> Told {
        let (mut inputs, said) = (Vec::new(), RefCell::default());
        let outputs = self.outputs(run, &mut inputs, &mut None, Some(&said));
        let Said { request, answer } = said.into_inner();
        let (outputs, infinite) = match outputs {
            Ok(outputs) => (Ok(outputs), Vec::new()),
            Err(failed) => (Err(failed.failure), failed.infinite),
        };
        Told { inputs, request, answer, outputs, infinite }
    }

    /// The table of a run that was done alone: the row that a campaign has of it.
    ///
    /// # Errors
    /// The inputs or the outputs do not go into their columns.
    pub fn table(&self, run: u64, told: &Told) -> Result<Table, TableError> {
        let mut table = Table::new(&self.model, run, self.columns())?;
        let failed = |failure| Failed { failure, infinite: told.infinite.clone() };
        let outputs = told.outputs.clone().map_err(failed);
        self.push(run, &told.inputs, outputs, &mut table)?;
        Ok(table)
    }

    /// Pushes the row of a run. Too many numbers are refused by the table, and so are too few of a run that did not fail.
    fn push(
        &self,
        run: u64,
        inputs: &[Option<f64>],
        outputs: Result<Vec<f64>, Failed>,
        rows: &mut Table,
    ) -> Result<(), TableError> {
        let (outputs, failure) = match outputs {
            Ok(outputs) => (outputs.into_iter().map(Cell::Number).collect(), None),
            Err(Failed { failure, infinite }) => {
                (infinite.into_iter().map(Cell::from).collect::<Vec<_>>(), Some(failure))
            }
        };
        let missing = |all: usize, there: usize| {
            let missing = if failure.is_some() { all.saturating_sub(there) } else { 0 };
            std::iter::repeat_n(Cell::Null, missing)
        };
        let drawn = inputs.iter().map(|number| Cell::from(*number));
        let place = self.inputs.place(run).into_iter().map(Cell::Integer);
        let cells = place
            .chain(drawn)
            .chain(missing(self.drawn.len(), inputs.len()))
            .chain(outputs.iter().cloned())
            .chain(missing(self.outputs.len(), outputs.len()));
        rows.push(failure.clone(), cells)
    }

    /// The outputs of a run. The numbers that are drawn for it are there afterwards, as far as they could be drawn.
    fn outputs(
        &self,
        run: u64,
        numbers: &mut Vec<Option<f64>>,
        kept: &mut Option<Child>,
        said: Option<&RefCell<Said>>,
    ) -> Result<Vec<f64>, Failed> {
        self.inputs.draw(run, numbers)?;
        let mut sent =
            self.drawn.iter().zip(&*numbers).filter_map(|(column, x)| Some((column, (*x)?)));
        if let Some((column, value)) = sent.find(|(_, value)| !value.is_finite()) {
            let name = column.name().to_owned();
            return Err(Trouble::Input { name, value }.into());
        }
        let seed = self.seeds.run(self.inputs.seed_stream(run)).next_u64() >> 11;
        let place: Vec<_> = self.inputs.place(run).into_iter().map(Some).collect();
        let (place, inputs) = (Named(&self.places, &place), Named(&self.drawn, numbers));
        let inputs = RunInputs { run, place, model: &self.model, seed, inputs };
        Ok(self.simulator.ask(&inputs, &self.outputs, kept, said)?)
    }
}

impl<I: Inputs> Simulation for ExternalSimulation<'_, I> {
    /// Processes are the simulator's: a thread would start one for every few runs.
    type Worker = ();

    fn columns(&self) -> Vec<Column> {
        self.places.iter().chain(&self.drawn).chain(&self.outputs).cloned().collect()
    }

    fn worker(&self) {}

    fn together(&self) -> u64 {
        1
    }

    /// A function may compute in parallel.
    fn apart(&self) -> bool {
        self.simulator.is_function()
    }

    fn fault(&self) -> Option<String> {
        self.simulator.fault()
    }

    fn run(&self, runs: Range<u64>, (): &mut (), rows: &mut Table) -> Result<(), TableError> {
        let mut kept = self.simulator.take();
        let mut numbers = Vec::with_capacity(self.drawn.len());
        for run in runs {
            numbers.clear();
            let outputs = self.outputs(run, &mut numbers, &mut kept, None);
            self.push(run, &numbers, outputs, rows)?;
        }
        self.simulator.keep(kept);
        Ok(())
    }
}
