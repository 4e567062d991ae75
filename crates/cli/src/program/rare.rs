//! `gyradius rare`: how often a rare event happens.

use gyradius_study::{CampaignError, RareOptions, StudyError};
use std::{error::Error, process::ExitCode};

use crate::program::{
    args::RareArgs,
    output::{complain, print, print_json},
    progress,
    signals::Signals,
    study::scenario,
};

/// Levels that there may be, for the progress: one for each digit of the least probability.
const LEVELS: f64 = 9.0;

/// Runs the verb.
pub(crate) fn rare(arguments: &RareArgs) -> Result<ExitCode, Box<dyn Error>> {
    let scenario = scenario(arguments.scenario.as_deref(), arguments.seed)?;
    let signals = Signals::watch()?;
    let options = RareOptions {
        model: arguments.model.clone(),
        per_level: usize::try_from(arguments.per_level).unwrap_or(usize::MAX),
        replicas: usize::try_from(arguments.replicas).unwrap_or(usize::MAX),
        least: arguments.least,
        threads: arguments.threads,
        stop: Some(signals.stop()),
    };
    // At most; most events need fewer levels.
    let most = LEVELS * (arguments.replicas as f64 + 1.0) * arguments.per_level as f64;
    let found = progress::show(most as u64, "runs at most", |report| {
        scenario.rare(&arguments.event, &options, report)
    });
    let found = match found {
        Err(StudyError::Campaign(CampaignError::Stopped)) => {
            complain("stopped: nothing is kept of the runs");
            return Ok(signals.code());
        }
        other => other?,
    };
    if arguments.json {
        print_json(&serde_json::to_string_pretty(&found)?)?;
    } else {
        print(&found.to_string())?;
    }
    Ok(ExitCode::SUCCESS)
}
