//! `gyradius replay`: one run of a study again.

use gyradius_study::{Replay, ReplayError, SimulatorReplay, SimulatorScenario, Which};
use std::{error::Error, path::Path, process::ExitCode};

use crate::program::{
    args::ReplayArgs,
    output::{complain, print},
    signals::Signals,
};

/// Where `gyradius study` writes if nothing else is said.
pub(crate) const DEFAULT: &str = "target/study/peck-2003";

/// Runs the verb.
pub(crate) fn replay(arguments: &ReplayArgs) -> Result<ExitCode, Box<dyn Error>> {
    let path = arguments.study.as_deref().unwrap_or(Path::new(DEFAULT));
    let model = arguments.model.as_deref();
    let which = match (arguments.vehicle, arguments.flight) {
        (Some(vehicle), Some(flight)) => Which::Flight { vehicle, flight },
        // One of the two is given.
        _ => Which::Run(arguments.run.unwrap_or_default()),
    };
    if SimulatorScenario::is_in(path) {
        let scenario = SimulatorScenario::of_study(path)?;
        let signals = Signals::watch()?;
        let replay = SimulatorReplay::until_stopped(&scenario, model, which, &signals.stop());
        let mut replay = match replay {
            Err(ReplayError::Stopped) => {
                complain("stopped: the run had not ended");
                return Ok(signals.code());
            }
            other => other?,
        };
        // What was said is told before that it is not what the study has.
        let held = if path.is_dir() { replay.hold_against(path) } else { Ok(()) };
        print(&replay.to_string())?;
        return Ok(held.map(|()| ExitCode::SUCCESS)?);
    }
    let replay = Replay::open(path, model, which, arguments.coast)?;
    let folder = arguments.out.clone().unwrap_or_else(|| replay.default_folder());
    let files = replay.write(&folder, arguments.force)?;
    let mut text = format!("{replay}\n");
    for file in &files {
        text.push_str(&format!("{}\n", file.display()));
    }
    if files.is_empty() {
        text.push_str("no history: no motion can be shown\n");
    }
    print(&text)?;
    Ok(ExitCode::SUCCESS)
}
