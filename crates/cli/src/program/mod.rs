//! The command line of gyradius: flags, progress and messages. The science is in the crates below.

mod args;
mod check;
mod compare;
mod doubts;
mod draw;
mod draw_output;
mod draw_robot;
mod examples;
mod fit;
mod model;
mod number;
mod output;
mod progress;
mod quote;
mod rare;
mod replay;
mod report;
mod rollup;
mod scheduler;
mod share;
mod shell;
mod signals;
mod slurm;
mod stated;
mod status;
mod study;
mod verdict;

use args::{Cli, Command};
use clap::Parser;
use output::{complain, say};
use std::{error::Error, ffi::OsString, io, process::ExitCode};

/// What the program returns when it was asked for something that cannot be done.
const REFUSED: u8 = 2;
/// The path that stands for standard input.
const STANDARD_INPUT: &str = "-";

/// Runs the program with the given arguments, the first of which is its name.
///
/// Returns 0, or 2 after a message on standard error; `check`, `fit`, `report`, `status`, `study` and `verdict` also return 1, for what
/// was found or is missing.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    run_as(Vec::new(), arguments)
}

/// The same, where the words that call the program in a shell are not the path of the executable, as `python -m gyradius`: scripts
/// that it writes call it so.
pub fn run_as(called: Vec<OsString>, arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let cli = match Cli::try_parse_from(arguments) {
        Ok(cli) => cli,
        Err(error) => return not_run(&error),
    };
    if let Err(error) = signals::survive_large_files() {
        complain(error);
        return ExitCode::from(REFUSED);
    }
    let done = |()| ExitCode::SUCCESS;
    let result: Result<ExitCode, Box<dyn Error>> = match &cli.command {
        Command::Check(arguments) => return check::check(arguments),
        Command::Fit(arguments) => return fit::fit(arguments),
        Command::Model(arguments) => model::model(arguments).map(done),
        Command::Report(arguments) => report::report(arguments),
        Command::Status(arguments) => status::status(arguments),
        Command::Slurm(arguments) => slurm::slurm(arguments, called).map(done),
        Command::Replay(arguments) => replay::replay(arguments),
        Command::Draw(arguments) => draw::draw(arguments),
        Command::Rollup(arguments) => rollup::rollup(arguments),
        Command::Study(arguments) => study::study(arguments),
        Command::Rare(arguments) => rare::rare(arguments),
        Command::Verdict(arguments) => verdict::verdict(arguments),
        Command::Compare(arguments) => compare::compare(arguments).map(done).map_err(Into::into),
        Command::Completions(arguments) => {
            shell::completions(arguments).map(done).map_err(Into::into)
        }
        Command::Man(arguments) => shell::man(arguments).map(done).map_err(Into::into),
    };
    result.unwrap_or_else(|error| {
        complain(error);
        ExitCode::from(REFUSED)
    })
}

/// Help and version, which are no errors, and what cannot be understood.
fn not_run(error: &clap::Error) -> ExitCode {
    if error.use_stderr() {
        // Names of files may stand in it.
        say(error.render().to_string().trim_end());
        return ExitCode::from(REFUSED);
    }
    match error.print() {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            complain(format_args!("standard output: {error}"));
            ExitCode::from(REFUSED)
        }
        _ => ExitCode::SUCCESS,
    }
}
