use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

/// Uncertain rigid-body inertia: Monte Carlo studies of spacecraft separation.
#[derive(Debug, Parser)]
#[command(name = "gyradius", version, arg_required_else_help = true)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run a Monte Carlo study of a separation and write its report
    ///
    /// Draws the inertia of payload and stage under every model of the scenario, separates them,
    /// and writes a folder with the resolved scenario, the run tables (Parquet), summary.json, the
    /// figures (SVG) and report.html.
    #[command(after_help = EXAMPLES)]
    Study(StudyArgs),
}

const EXAMPLES: &str = "\
Examples:
  gyradius study
      The study of Peck (2003): four models, 2,000 runs each, into target/study/peck-2003
  gyradius study --runs 200 --out /tmp/quick
      A quick look
  gyradius study --scenario my-vehicle.toml --seed 7 --threads 4
      Another vehicle. Start from the scenario.toml that any study writes
  gyradius study --seed 8 --force
      Replace the study in the folder by another one

The same scenario, runs and seed give the same numbers on any number of threads.";

#[derive(Args, Debug)]
pub(crate) struct StudyArgs {
    /// Scenario file (TOML) [default: the built-in study of Peck (2003)]
    #[arg(long, value_name = "FILE")]
    pub(crate) scenario: Option<PathBuf>,

    /// Runs of each model [default: as in the scenario]
    #[arg(long, value_name = "N")]
    pub(crate) runs: Option<u64>,

    /// Seed of all random numbers [default: as in the scenario]
    #[arg(long, value_name = "S")]
    pub(crate) seed: Option<u64>,

    /// Folder to write [default: target/study/<scenario name>]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    /// Number of threads [default: one for each core]
    #[arg(long, value_name = "T")]
    pub(crate) threads: Option<usize>,

    /// Replace another study in the folder
    #[arg(long)]
    pub(crate) force: bool,
}
