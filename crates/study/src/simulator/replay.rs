//! One run of a simulator again: what was sent, what was answered.

use gyradius_campaign::{Simulation, Table, Told, is_stopped};
use std::{
    fmt,
    path::Path,
    sync::{Arc, atomic::AtomicBool},
};

use super::scenario::SimulatorScenario;
use crate::{
    Fleet, ReplayError, Which, groups::Drawing, replay::Held, scenario::Framed, subject::Subject,
};

/// Why a row may be another than that of the study.
const CAUSES: &str = "the table was changed, or something that the simulator uses, such as a file that it imports or the \
                      interpreter, or the simulator answers otherwise to the same inputs and seed";

/// One run of a simulator again, in a process that is started for it, or by the function that the scenario was given.
#[derive(Clone, Debug)]
pub struct SimulatorReplay {
    model: String,
    run: u64,
    fleet: Option<Fleet>,
    told: Told,
    outputs: Vec<(String, String)>,
    /// The table of this run alone, and what it was held against; nothing is said of the latter if they differ.
    own: Table,
    held: Option<Held>,
}

impl SimulatorReplay {
    /// Sends a run again. The model is the first of the scenario if not given.
    ///
    /// # Errors
    /// There is no such model or run, the command cannot be started, or the function was not given.
    pub fn new(
        scenario: &SimulatorScenario,
        model: Option<&str>,
        run: impl Into<Which>,
    ) -> Result<Self, ReplayError> {
        Self::of(scenario, model, run.into(), None)
    }

    /// Sends a run again as [`new`](Self::new) does, until `stop` becomes true: then its process is killed.
    ///
    /// # Errors
    /// As [`new`](Self::new), and [`ReplayError::Stopped`].
    pub fn until_stopped(
        scenario: &SimulatorScenario,
        model: Option<&str>,
        run: impl Into<Which>,
        stop: &Arc<AtomicBool>,
    ) -> Result<Self, ReplayError> {
        Self::of(scenario, model, run.into(), Some(stop))
    }

    fn of(
        scenario: &SimulatorScenario,
        model: Option<&str>,
        run: Which,
        stop: Option<&Arc<AtomicBool>>,
    ) -> Result<Self, ReplayError> {
        let run = run.run(scenario)?;
        let place = scenario.place_of(model)?;
        let simulator = scenario.prepare(stop)?;
        scenario.begin(&simulator)?;
        let simulation = scenario.simulation(&simulator, place, Drawing::Plain)?;
        let told = simulation.replay(run);
        if is_stopped(stop.map(|stop| &**stop)) {
            return Err(ReplayError::Stopped);
        }
        if let Some(problem) = simulation.fault() {
            return Err(ReplayError::Fault { problem });
        }
        let own = simulation.table(run, &told)?;
        let outputs = scenario.outputs().iter();
        let outputs = outputs.map(|c| (c.name().to_owned(), c.unit().unwrap_or("1").to_owned()));
        let name = scenario.model_names().nth(place).unwrap_or_default().to_owned();
        let fleet = scenario.fleet();
        let (outputs, held) = (outputs.collect(), Some(Held::Nowhere));
        Ok(Self { model: name, run, fleet, told, outputs, own, held })
    }

    /// Holds the row, what was drawn and what was answered, against that of the run table in the folder of a study, bit by bit.
    ///
    /// # Errors
    /// There is no such table, or it says otherwise.
    pub fn hold_against(&mut self, folder: &Path) -> Result<(), ReplayError> {
        self.held = None;
        self.held = Some(Held::against(folder, &self.own, CAUSES)?);
        Ok(())
    }

    /// The table of this run alone: its row has what was drawn, what was answered, and how it ended.
    #[must_use]
    pub fn table(&self) -> &Table {
        &self.own
    }

    /// What was told to and by the simulator.
    #[must_use]
    pub fn told(&self) -> &Told {
        &self.told
    }
}

impl fmt::Display for SimulatorReplay {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let flight = self.fleet.map(|fleet| format!(" {}", fleet.told(self.run)));
        writeln!(f, "{}, run {}{}", self.model, self.run, flight.unwrap_or_default())?;
        if let Some(held) = &self.held {
            writeln!(f, "{held}")?;
        }
        let nothing = || "nothing".to_owned();
        writeln!(f, "sent: {}", self.told.request.clone().unwrap_or_else(nothing))?;
        let answer = self.told.answer.as_deref().map(str::trim_end).map(str::to_owned);
        writeln!(f, "answered: {}", answer.unwrap_or_else(nothing))?;
        match &self.told.outputs {
            Ok(numbers) => {
                self.outputs.iter().zip(numbers).try_for_each(|((name, unit), number)| {
                    writeln!(f, "{} = {number:?}", gyradius_report::with_unit(name, unit))
                })
            }
            Err(failure) => writeln!(f, "failed: {failure}"),
        }
    }
}
