//! `gyradius rare`: how often a rare event happens.

use gyradius_study::{CampaignError, RareMethod, RareOptions, StudyError};
use std::{error::Error, process::ExitCode};

use crate::program::{
    args::{RareArgs, RareMethodArg},
    doubts::tell_doubts,
    output::{complain, print, print_json},
    progress,
    signals::Signals,
    study::{notice, scenario},
};

/// Runs the verb.
pub(crate) fn rare(arguments: &RareArgs) -> Result<ExitCode, Box<dyn Error>> {
    let scenario = scenario(arguments.scenario.as_deref(), arguments.seed)?;
    tell_doubts(&scenario, scenario.off_nominal(), str::to_owned);
    let signals = Signals::watch()?;
    let options = RareOptions {
        model: arguments.model.clone(),
        method: method(arguments)?,
        per_level: usize::try_from(arguments.per_level).unwrap_or(usize::MAX),
        least: arguments.least,
        threads: arguments.threads,
        stop: Some(signals.stop()),
    };
    let most = options.most_runs();
    let what = match options.method {
        RareMethod::Subset { .. } => "runs at most",
        RareMethod::Importance { .. } => "runs, or more if there are many ways to the event",
    };
    let found = progress::show(most, what, |report| {
        // What takes more is not at its end yet.
        let report = |done: u64| report(done.min(most.saturating_sub(1)));
        scenario.rare(&arguments.event, &options, &report, &notice)
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

/// The method with its numbers.
fn method(arguments: &RareArgs) -> Result<RareMethod, &'static str> {
    match (arguments.method, arguments.replicas, arguments.sample) {
        (RareMethodArg::Subset, replicas, None) => {
            let replicas = replicas.map(|n| usize::try_from(n).unwrap_or(usize::MAX));
            Ok(RareMethod::Subset { replicas: replicas.unwrap_or(RareMethod::REPLICAS) })
        }
        (RareMethodArg::Importance, None, sample) => {
            Ok(RareMethod::Importance { sample: sample.unwrap_or(RareMethod::SAMPLE) })
        }
        (RareMethodArg::Subset, _, Some(_)) => {
            Err("--sample goes with --method importance; subset simulation has --replicas")
        }
        (RareMethodArg::Importance, Some(_), _) => {
            Err("--replicas goes with --method subset; importance sampling has --sample")
        }
    }
}
