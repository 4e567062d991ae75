//! `gyradius study`: a scenario run, its table, and the exit code.

use gyradius_study::{CampaignError, Notice, Options, Scenario, Study, StudyError};
use std::{error::Error, fmt::Write, process::ExitCode, time::Duration};

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
    let mut scenario = match &arguments.scenario {
        Some(path) => Scenario::read(path)?,
        None => Scenario::peck_2003()?,
    };
    if let Some(runs) = arguments.runs {
        scenario = scenario.with_runs(runs)?;
    }
    if let Some(seed) = arguments.seed {
        scenario = scenario.with_seed(seed)?;
    }
    let signals = Signals::watch()?;
    let options = Options {
        out: arguments.out.clone(),
        threads: arguments.threads,
        force: arguments.force,
        stop: Some(signals.stop()),
    };
    let total = scenario.runs() * scenario.model_names().count() as u64;
    let notice = |notice: Notice| match notice {
        Notice::Forecast(forecast) if forecast.time() > PATIENCE => say(&forecast.to_string()),
        Notice::GoesOn { done, of } if done < of => {
            say(&format!("{done} of {of} runs are finished already; going on"));
        }
        Notice::Damaged(block) => say(&format!("{block}: its runs are done again")),
        // What takes a moment is not worth a word.
        _ => {}
    };
    let study = progress::show(total, "runs", |report| {
        Study::run_with_notices(&scenario, &options, report, &notice)
    });
    let study = match study {
        Err(StudyError::Campaign(CampaignError::Stopped)) => {
            complain("stopped: the runs that were finished are kept, and the same command goes on");
            return Ok(signals.code());
        }
        other => other?,
    };

    let mut text = String::new();
    // Writing to a string does not fail.
    let _ = writeln!(
        text,
        "{}: {} runs a model, seed {}\n",
        scenario.name(),
        scenario.runs(),
        scenario.seed()
    );
    let _ = writeln!(text, "{}", study.summary());
    let _ = writeln!(text, "report: {}", study.folder().join("report.html").display());
    print(&text)?;

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
