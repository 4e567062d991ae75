//! A scenario whose runs a function of the program does, and the outputs that the function declares by its first answer.

use gyradius_campaign::{Simulator, SimulatorFunction};
use std::sync::{Arc, Mutex, PoisonError};

use super::scenario::SimulatorScenario;
use crate::{ScenarioError, groups::Drawing};

/// Runs that are tried, at most, to see what the outputs are.
const TRIES: u64 = 10;

impl SimulatorScenario {
    /// The same scenario, whose runs this function does. The scenario says `function = "..."` in the place of a command.
    ///
    /// Everything else is as with a command: draws, seeds, columns, failed runs, blocks, report. The function is called from as many
    /// threads at the same time as the study has. If the scenario declares no outputs, the function does: of the
    /// first ten runs of the first model, the first that does not fail says what they are called, and their unit is `1`. Those runs
    /// are done again with all others.
    ///
    /// No file can hold a function. [`to_toml`](Self::to_toml) has the outputs and what the scenario says of the function. From it,
    /// reports are made again, but runs and replays are refused until a function is given again. That it is the same one is not
    /// checked: say in `function` which version it is, for runs with another text there are not mixed with these.
    /// ```
    /// use gyradius_study::{Options, RunInputs, SimulatorFunction, SimulatorScenario};
    ///
    /// let scenario = r#"
    ///     name = "throw"
    ///     runs = 200
    ///
    ///     [simulation]
    ///     function = "range of a ball without drag, version 1"
    ///     outputs = [{ name = "range_m", unit = "m" }]
    ///
    ///     [[quantities]]
    ///     name = "speed_m_per_s"
    ///     unit = "m/s"
    ///     law = { law = "normal", mean = 10.0, sigma = 3.0 }
    /// "#;
    /// let throw = SimulatorFunction::new(|run: &RunInputs<'_>| {
    ///     let speed = run.input("speed_m_per_s").ok_or("no speed")?;
    ///     if speed < 0.0 {
    ///         return Err(format!("thrown backward at {speed} m/s"));
    ///     }
    ///     Ok(vec![("range_m".to_owned(), speed * speed / 9.81)])
    /// });
    /// # let folder = tempfile::tempdir()?;
    /// # let folder = folder.path();
    /// let scenario = SimulatorScenario::from_toml(scenario, folder)?.with_function(throw)?;
    /// let options = Options::to(folder.join("throw"));
    /// let study = scenario.study(&options, &|_done| {}, &|_notice| {})?;
    /// let ranges = study.tables()?[0].values("range_m").unwrap_or_default();
    /// assert!(ranges.len() > 190);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// The scenario names a command. It declares no outputs, and none of the first runs tells any, or what they are called is refused.
    pub fn with_function(self, function: SimulatorFunction) -> Result<Self, ScenarioError> {
        if self.function_name().is_none() {
            let problem = "the scenario names a command, which does its runs: say `function` in its place, and which function it is";
            return Err(ScenarioError::field("simulation.command", problem));
        }
        let scenario = if self.outputs().is_empty() {
            let outputs = self.outputs_of(&function)?;
            self.declaring(outputs)?
        } else {
            self
        };
        Ok(scenario.given(function))
    }

    /// What the outputs of a function are called, in its own order.
    fn outputs_of(&self, function: &SimulatorFunction) -> Result<Vec<String>, ScenarioError> {
        let names = Arc::new(Mutex::new(Vec::new()));
        let (seen, function) = (Arc::clone(&names), function.clone());
        let watched = SimulatorFunction::new(move |inputs| {
            let outputs = function.run(inputs)?;
            // None is declared yet, so nobody else looks at the numbers.
            if let Some((name, value)) = outputs.iter().find(|(_, value)| !value.is_finite()) {
                return Err(format!("the output `{name}` is not a finite number: {value}"));
            }
            *seen.lock().unwrap_or_else(PoisonError::into_inner) =
                outputs.iter().map(|(name, _)| name.clone()).collect();
            Ok(outputs)
        });
        let simulator = Simulator::function(watched);
        let simulation = self.simulation(&simulator, 0, Drawing::Plain)?;
        let mut reason = None;
        for run in 0..self.runs().min(TRIES) {
            let told = simulation.replay(run);
            let names = std::mem::take(&mut *names.lock().unwrap_or_else(PoisonError::into_inner));
            if !names.is_empty() {
                return Ok(names);
            }
            reason = reason.or(told.outputs.err());
        }
        let what = match reason {
            Some(failure) => format!("the first runs failed: {failure}"),
            None => "the function returned none".to_owned(),
        };
        let problem = format!("none are declared, and {what}");
        Err(ScenarioError::field("simulation.outputs", problem))
    }
}
