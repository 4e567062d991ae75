//! `gyradius study`: a scenario run, its table, and the exit code.

use gyradius_study::{
    CampaignError, Notice, Options, Scenario, ScenarioError, Study, StudyError, planned_runs,
    run_shard,
};
use std::{error::Error, fmt::Write, path::Path, process::ExitCode, time::Duration};

use crate::program::{
    args::StudyArgs,
    number::short,
    output::{complain, print, say},
    progress,
    signals::Signals,
};

/// What the program returns when too many runs failed.
const FAILED: u8 = 1;
/// A study that takes less is begun without a word.
const PATIENCE: Duration = Duration::from_secs(20);

/// Runs the verb.
pub(crate) fn study(arguments: &StudyArgs) -> Result<ExitCode, Box<dyn Error>> {
    let mut scenario = scenario(arguments.scenario.as_deref(), arguments.seed)?;
    if let Some(runs) = arguments.runs {
        scenario = scenario.with_runs(runs)?;
    }
    let signals = Signals::watch()?;
    let options = Options {
        out: arguments.out.clone(),
        threads: arguments.threads,
        force: arguments.force,
        stop: Some(signals.stop()),
    };
    let total = planned_runs(&scenario, arguments.shard);
    if let Some(shard) = arguments.shard {
        let done = progress::show(total, "runs", |report| {
            run_shard(&scenario, &options, shard, report, &notice)
        });
        return match done {
            Err(StudyError::Campaign(CampaignError::Stopped)) => Ok(stopped(&signals)),
            other => {
                other?;
                print(&format!("shard {shard} of {} is done: {total} runs\n", scenario.name()))?;
                Ok(ExitCode::SUCCESS)
            }
        };
    }
    let study = progress::show(total, "runs", |report| {
        Study::run_with_notices(&scenario, &options, report, &notice)
    });
    let study = match study {
        Err(StudyError::Campaign(CampaignError::Stopped)) => return Ok(stopped(&signals)),
        other => other?,
    };
    print(&answer(&study))?;

    let mut code = ExitCode::SUCCESS;
    for (model, failed, runs) in study.summary().failed() {
        if failed as f64 > arguments.max_failed * runs as f64 {
            complain(format_args!(
                "{model}: {failed} of {runs} runs failed, and --max-failed allows {} %",
                short(100.0 * arguments.max_failed)
            ));
            code = ExitCode::from(FAILED);
        }
    }
    Ok(code)
}

/// The scenario in a file or the built-in one, with a seed if one is given.
pub(crate) fn scenario(file: Option<&Path>, seed: Option<u64>) -> Result<Scenario, ScenarioError> {
    let scenario = file.map_or_else(Scenario::peck_2003, Scenario::read)?;
    match seed {
        Some(seed) => scenario.with_seed(seed),
        None => Ok(scenario),
    }
}

/// What is said before the runs.
pub(crate) fn notice(notice: Notice) {
    match notice {
        Notice::Forecast(forecast) if forecast.time() > PATIENCE => say(&forecast.to_string()),
        Notice::GoesOn { done, of } if done < of => {
            say(&format!("{done} of {of} runs are finished already; going on"));
        }
        Notice::Damaged(block) => say(&format!("{block}: its runs are done again")),
        // What takes a moment is not worth a word.
        _ => {}
    }
}

fn stopped(signals: &Signals) -> ExitCode {
    complain("stopped: the runs that were finished are kept, and the same command goes on");
    signals.code()
}

/// The answer on the terminal.
pub(crate) fn answer(study: &Study) -> String {
    let summary = study.summary();
    let (runs, seed) = (summary.runs_per_model(), summary.seed());
    let report = study.folder().join("report.html");
    let mut text =
        format!("{}: {runs} runs a model, seed {seed}\n\n{summary}\n", summary.scenario());
    for runs in summary.missing() {
        // Writing to a string does not fail.
        let _ = writeln!(text, "missing: {runs}");
    }
    let _ = writeln!(text, "report: {}", report.display());
    text
}
