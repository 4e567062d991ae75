//! The command line of gyradius: flags, progress and messages. The science is in the crates below.

mod args;
mod check;
mod compare;
mod fit;
mod model;
mod number;
mod output;
mod progress;
mod replay;

use args::{Cli, Command, StudyArgs};
use clap::Parser;
use gyradius_study::{Options, Scenario, Study, StudyError};
use std::{error::Error, ffi::OsString, process::ExitCode};

/// What the program returns when it was asked for something that cannot be done.
const REFUSED: u8 = 2;

/// Runs the program with the given arguments, the first of which is its name.
///
/// Returns 0, or 2 after a message on standard error; `check` and `fit` also return 1, for findings.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let cli = match Cli::try_parse_from(arguments) {
        Ok(cli) => cli,
        Err(error) => {
            // Help and version are no errors, and clap knows where each belongs.
            let code = if error.use_stderr() { REFUSED } else { 0 };
            let _ = error.print();
            return ExitCode::from(code);
        }
    };
    let result: Result<(), Box<dyn Error>> = match &cli.command {
        Command::Check(arguments) => return check::check(arguments),
        Command::Fit(arguments) => return fit::fit(arguments),
        Command::Model(arguments) => model::model(arguments),
        Command::Replay(arguments) => replay::replay(arguments).map_err(Into::into),
        Command::Study(arguments) => study(arguments).map_err(Into::into),
        Command::Compare(arguments) => compare::compare(arguments).map_err(Into::into),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(REFUSED)
        }
    }
}

fn study(arguments: &StudyArgs) -> Result<(), StudyError> {
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
    let options =
        Options { out: arguments.out.clone(), threads: arguments.threads, force: arguments.force };
    let total = scenario.runs() * scenario.model_names().count() as u64;
    let study = progress::show(total, "runs", |report| Study::run(&scenario, &options, report))?;

    println!("{}: {} runs a model, seed {}\n", scenario.name(), scenario.runs(), scenario.seed());
    println!("{}", study.summary());
    println!("report: {}", study.folder().join("report.html").display());
    Ok(())
}
