//! `gyradius study`: a scenario run, its table, and the exit code.

use gyradius_study::{
    Again, AnyScenario, CampaignError, Kept, Notice, Options, Scenario, ScenarioError, StudyError,
    Verdict,
};
use serde_json::json;
use std::{error::Error, path::Path, process::ExitCode, time::Duration};

use crate::program::{
    args::{ScenarioArgs, StudyArgs},
    doubts::tell_doubts,
    number::short,
    output::{complain, print, print_json, say},
    progress,
    scheduler::AskedShard,
    share::exceeds,
    signals::Signals,
};

/// What the program returns when too many runs failed.
const FAILED: u8 = 1;
/// A study that takes less is begun without a word.
const PATIENCE: Duration = Duration::from_secs(20);

/// Runs the verb.
pub(crate) fn study(arguments: &StudyArgs) -> Result<ExitCode, Box<dyn Error>> {
    let scenario = stated(&arguments.scenario)?;
    let scenario = match (&arguments.until, arguments.look_every) {
        (None, Some(runs)) if scenario.until().is_none() => {
            return Err(format!("--look-every {runs}: it goes with --until, or with a rule in the table until of the scenario, and there is neither").into());
        }
        (None, None) => scenario,
        (rule, look_every) => scenario.with_until(rule.clone(), look_every)?,
    };
    let scenario = match arguments.drivers {
        Some(base_runs) => scenario.with_drivers(base_runs)?,
        None => scenario,
    };
    let kept = scenario.kept();
    let columns = arguments.columns.clone().or_else(|| kept.columns().map(<[_]>::to_vec));
    let scenario = scenario.with_kept(&Kept::new(arguments.rows.unwrap_or(kept.rows()), columns));
    let shard = arguments.shard.map(AskedShard::find).transpose()?;
    if !arguments.quiet {
        tell_doubts(&scenario, scenario.off_nominal(), str::to_owned);
    }
    let signals = Signals::watch()?;
    let options = Options {
        out: arguments.out.clone(),
        threads: arguments.threads,
        force: arguments.force,
        retry_failed: arguments.retry_failed,
        even_if_full: arguments.even_if_full,
        stop: Some(signals.stop()),
    };
    let total = scenario.planned_runs(shard);
    if let Some(shard) = shard {
        let done = shown(total, arguments.quiet, |report, notice| {
            scenario.run_shard(&options, shard, report, notice)
        });
        return match done {
            Err(StudyError::Campaign(CampaignError::Stopped)) => Ok(stopped(&signals)),
            other => {
                other?;
                let text = if arguments.json {
                    format!("{}\n", json!({ "shard": shard.to_string(), "runs": total }))
                } else {
                    format!("shard {shard} of {} is done: {total} runs\n", scenario.name())
                };
                if !arguments.quiet {
                    print(&text)?;
                }
                Ok(ExitCode::SUCCESS)
            }
        };
    }
    let total = total + scenario.driver_runs()?;
    let outcome =
        shown(total, arguments.quiet, |report, notice| scenario.run(&options, report, notice));
    let outcome = match outcome {
        Err(StudyError::Campaign(CampaignError::Stopped)) => return Ok(stopped(&signals)),
        other => other?,
    };
    if arguments.json {
        print_json(&serde_json::to_string_pretty(&outcome)?)?;
    } else if !arguments.quiet {
        print(&outcome.to_string())?;
    }

    let mut code = ExitCode::SUCCESS;
    for judged in outcome.requirements() {
        if judged.judgement().verdict() != Verdict::Met {
            let requirement = judged.judgement().requirement().name();
            complain(format_args!(
                "{requirement}, {}: {}",
                judged.model(),
                judged.judgement().line()
            ));
            code = ExitCode::from(FAILED);
        }
    }
    for (model, failed, runs) in outcome.failed() {
        if exceeds(failed, runs, arguments.max_failed) {
            complain(format_args!(
                "{model}: {failed} of {runs} runs failed, and --max-failed allows {} %",
                short(100.0 * arguments.max_failed)
            ));
            code = ExitCode::from(FAILED);
        }
    }
    Ok(code)
}

/// Does what reports its progress and has things to say, which nobody hears if it is to be quiet.
fn shown<T>(
    total: u64,
    quiet: bool,
    work: impl FnOnce(&(dyn Fn(u64) + Sync), &dyn Fn(Notice)) -> T,
) -> T {
    if quiet {
        return work(&|_| {}, &|_| {});
    }
    progress::show(total, "runs", |report| work(report, &notice))
}

/// The scenario in a file or the built-in one, with a seed if one is given.
pub(crate) fn scenario(
    file: Option<&Path>,
    seed: Option<u64>,
) -> Result<AnyScenario, ScenarioError> {
    let built_in = || Ok(AnyScenario::Separation(Box::new(Scenario::peck_2003()?)));
    let scenario = file.map_or_else(built_in, AnyScenario::read)?;
    match seed {
        Some(seed) => scenario.with_seed(seed),
        None => Ok(scenario),
    }
}

/// The scenario that is asked for.
pub(crate) fn stated(arguments: &ScenarioArgs) -> Result<AnyScenario, ScenarioError> {
    let mut scenario = scenario(arguments.file(), arguments.seed)?;
    if let Some(runs) = arguments.runs {
        scenario = scenario.with_runs(runs)?;
    }
    if let Some(vehicles) = arguments.vehicles {
        scenario = scenario.with_vehicles(vehicles)?;
    }
    Ok(scenario)
}

/// What is said before the runs, and of how they were done.
pub(crate) fn notice(notice: Notice) {
    match notice {
        Notice::Forecast(forecast) if forecast.time() > Some(PATIENCE) => {
            say(&forecast.to_string());
        }
        Notice::GoesOn { done, of } if done < of => {
            say(&format!("{done} of {of} runs are finished already; going on"));
        }
        Notice::Damaged { block, again: true } => say(&format!("{block}: its runs are done again")),
        Notice::Damaged { block, again: false } => say(&format!("{block}: its runs are missing")),
        Notice::Finished => say(
            "this study is finished already, and --force replaces another one only: to do its runs again, choose another folder or \
             delete this one",
        ),
        Notice::Again(Again { runs, failed }) => {
            let s = if runs == 1 { "" } else { "s" };
            say(&format!("{runs} run{s} that had failed, done again: {failed} failed again"));
        }
        Notice::Unasked(unasked) => say(&format!("warning: {unasked}")),
        Notice::Replacement(told) => say(&format!("note: {told}")),
        Notice::DriversLeft => say(
            "what drives the outcome is not found yet: `gyradius study` with the scenario finds it in this folder, which keeps all of \
             the runs until then",
        ),
        // What takes a moment is not worth a word.
        _ => {}
    }
}

fn stopped(signals: &Signals) -> ExitCode {
    complain("stopped: the runs that were finished are kept, and the same command goes on");
    signals.code()
}
