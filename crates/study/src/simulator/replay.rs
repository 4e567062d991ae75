//! One run of a simulator again: what was sent, what was answered.

use gyradius_campaign::Told;
use std::fmt;

use super::scenario::SimulatorScenario;
use crate::{Fleet, ReplayError, Which, subject::Subject};

/// One run of a simulator again, in a process that is started for it.
#[derive(Clone, Debug)]
pub struct SimulatorReplay {
    model: String,
    run: u64,
    fleet: Option<Fleet>,
    told: Told,
    outputs: Vec<(String, String)>,
}

impl SimulatorReplay {
    /// Sends a run again. The model is the first of the scenario if not given.
    ///
    /// # Errors
    /// There is no such model or run, or the command cannot be started.
    pub fn new(
        scenario: &SimulatorScenario,
        model: Option<&str>,
        run: impl Into<Which>,
    ) -> Result<Self, ReplayError> {
        let run = run.into().run(scenario)?;
        let mut names = scenario.model_names();
        let place =
            names.position(|name| model.is_none_or(|model| name == model)).ok_or_else(|| {
                let known = scenario.model_names().map(str::to_owned).collect();
                ReplayError::Model { model: model.unwrap_or_default().to_owned(), known }
            })?;
        let simulator = scenario.prepare(None)?;
        scenario.begin(&simulator)?;
        let told = scenario.simulation(&simulator, place)?.replay(run);
        let outputs = scenario.outputs().iter();
        let outputs = outputs.map(|c| (c.name().to_owned(), c.unit().unwrap_or("1").to_owned()));
        let name = scenario.model_names().nth(place).unwrap_or_default().to_owned();
        let fleet = scenario.fleet();
        Ok(Self { model: name, run, fleet, told, outputs: outputs.collect() })
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
