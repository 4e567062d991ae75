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
    /// Check the inertias in robot and CAD files, and write repaired copies
    ///
    /// Reads URDF, MJCF, SDF, CSV, TOML and JSON files and lists the bodies whose inertia no
    /// distribution of mass has, the worst first: the largest principal moment exceeds the sum of
    /// the others, or a moment is negative. Also lists inertia on a mass of zero or less.
    #[command(after_help = CHECK_EXAMPLES)]
    Check(CheckArgs),
}

const CHECK_EXAMPLES: &str = "\
Examples:
  gyradius check robot.urdf
      The bodies of one file that cannot exist
  gyradius check robots/ parts.csv
      All files below a folder, and a table
  gyradius check --repair robot.urdf
      Write robot.repaired.urdf beside it: the nearest possible inertias, all else as it was
  gyradius check --format json --all robots/ > inertias.json
      Every body, for another program

Folders are searched for .urdf .xacro .mjcf .sdf .world .xml .csv .toml .json; files of other
kinds, hidden ones, *.repaired.* and caches are passed over.

Exit code: 0 if all bodies are possible, 1 if some are not, 2 if something could not be read
or written.";

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

#[derive(Args, Debug)]
pub(crate) struct CheckArgs {
    /// Files, and folders to be searched
    #[arg(required = true, value_name = "FILE|FOLDER")]
    pub(crate) paths: Vec<PathBuf>,

    /// List the good bodies too
    #[arg(long)]
    pub(crate) all: bool,

    /// Write a copy with possible inertias beside each file that needs one, as NAME.repaired.EXT
    #[arg(long)]
    pub(crate) repair: bool,

    /// Replace repaired copies that are there already; never an original
    #[arg(long, requires = "repair")]
    pub(crate) force: bool,

    /// How far outside the possible an inertia may lie, relative to its trace. Files carry about
    /// six digits, and a flat plate written with six digits lies on the boundary to within that
    #[arg(long, value_name = "REL", default_value_t = gyradius_formats::TOLERANCE, value_parser = tolerance)]
    pub(crate) tolerance: f64,

    /// Products of inertia are positive integrals of xy, not matrix entries, in files that do not
    /// say which
    #[arg(long)]
    pub(crate) flip_products: bool,

    /// Form of the output
    #[arg(long, value_enum, default_value_t = Form::Text)]
    pub(crate) format: Form,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Form {
    /// A table to be read by people
    Text,
    /// One JSON object, described in docs/check.md
    Json,
}

fn tolerance(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=0.1).contains(&value) => Ok(value),
        _ => Err("it must lie between 0 and 0.1".to_owned()),
    }
}
