//! Verbs and flags of the program, with their help.

use clap::{
    Args, Parser, Subcommand,
    builder::{NonEmptyStringValueParser, PossibleValue, PossibleValuesParser, TypedValueParser},
    value_parser,
};
use gyradius_estimation::TenForm;
use gyradius_inertia::RELATIVE_TOLERANCE;
use gyradius_study::{
    CompareOptions, Event, Inside, ModelKind, RareMethod, RareOptions, Requirement, Rows,
    StoppingRule, TableFormat,
};
use std::path::{Path, PathBuf};

use crate::program::{
    examples::{
        CHECK_EXAMPLES, COMPARE_EXAMPLES, COMPLETIONS_EXAMPLES, DRAW_EXAMPLES, EXAMPLES,
        EXIT_CODES, FIT_EXAMPLES, MAN_EXAMPLES, MODEL_EXAMPLES, RARE_EXAMPLES, REPLAY_EXAMPLES,
        REPORT_EXAMPLES, ROLLUP_EXAMPLES, SLURM_EXAMPLES, STATUS_EXAMPLES, VERDICT_EXAMPLES,
    },
    scheduler::AskedShard,
    share::share,
    stated::{ROBOTS, StatedArgs},
};

/// Uncertain mass properties of rigid bodies: laws of them, draws, Monte Carlo campaigns and verdicts.
#[derive(Debug, Parser)]
#[command(name = "gyradius", version, arg_required_else_help = true, after_help = EXIT_CODES)]
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
    /// figures (SVG) and the report, as report.html and as report.md.
    ///
    /// A scenario with a table [simulation] names a simulator of your own instead: it is sent what is drawn, run by run,
    /// and its answers are reported.
    #[command(after_help = EXAMPLES)]
    Study(StudyArgs),
    /// Make the report and the figures of a study again, from its folder alone
    ///
    /// Reads scenario.toml and summary.json, and draws nothing and runs nothing: the same folder gives the
    /// same report.html, report.md and figures to the byte. Useful after files were deleted, for another place, or for a page of a
    /// study whose run tables are kept elsewhere.
    ///
    /// Of a study whose runs are not put together yet, because it was interrupted or done in shards: puts them together,
    /// or makes the report of the runs that are there and says which are missing.
    #[command(after_help = REPORT_EXAMPLES)]
    Report(ReportArgs),
    /// Say what of a study is there: which runs are done, missing and failed
    ///
    /// Looks at the files of the folder without waiting for anybody, so that it can be asked while runs are being done.
    #[command(after_help = STATUS_EXAMPLES)]
    Status(StatusArgs),
    /// Write a script that does a study on a Slurm cluster: a job array, and the report after it
    ///
    /// Times a few runs, and divides the study so that each task of the array takes ten minutes or so. `bash` runs the
    /// script, and as often as it is run again, only what is missing is done.
    #[command(after_help = SLURM_EXAMPLES)]
    Slurm(SlurmArgs),
    /// Do one run of a study again, bit for bit, and write its full history
    ///
    /// Holds the run against its row in the run table, prints a page on it, and writes a folder with
    /// history.csv (states, spring forces, energies, momenta against time), history.svg (rates,
    /// nutation, spring forces) and animation.html (bodies and springs in three dimensions).
    #[command(after_help = REPLAY_EXAMPLES)]
    Replay(ReplayArgs),
    /// Write what is drawn for the runs of a scenario, without running any; or bodies with laws, or robots with other mass properties
    ///
    /// One row a run, for a simulator of your own: the inertias of payload and stage, and whatever else the
    /// scenario disperses, in the columns of the run table. A study of the scenario has the same values, to the
    /// bit. Any number of runs takes the same memory.
    ///
    /// A file of laws, as `gyradius model` and `gyradius fit` write it with -o or as JSON, gives one row a draw, with mass, mass centre, inertia
    /// and principal axes of its bodies, in the columns that a scenario has for them.
    ///
    /// A robot gives copies in which only the mass, mass centre and inertia of links differ, each of which some body has,
    /// or a table of these.
    #[command(after_help = DRAW_EXAMPLES)]
    Draw(DrawArgs),
    /// Check the inertias in robot and CAD files, and write repaired copies
    ///
    /// Reads URDF, MJCF, SDF, CSV, TOML and JSON files and lists the bodies whose inertia no
    /// distribution of mass has, the worst first: the largest principal moment exceeds the sum of
    /// the others, or a moment is negative. Also lists inertia on a mass of zero or less.
    #[command(after_help = CHECK_EXAMPLES)]
    Check(CheckArgs),
    /// Fit the inertia uncertainty of a scenario to a table of samples
    ///
    /// Reads one inertia a row (CAD variants, a product line, past flights), matches the principal
    /// axes, fits the model of Peck (2003): Gaussian roots of the second moments, radially
    /// constrained Gaussian axes. Prints parameters with standard errors, says whether the model
    /// fits, and writes the part of a scenario file that holds it. Where a table has mass and mass centre
    /// too, the joint law of the ten is fitted beside it.
    ///
    /// With --estimate: the realizable law with the mean and covariance of an identification or of a
    /// Bayesian posterior, as nearly as there is one, and how far it had to move.
    #[command(after_help = FIT_EXAMPLES)]
    Fit(FitArgs),
    /// Make the inertia uncertainty of a scenario from plain statements
    ///
    /// Reads a nominal inertia and what is known of it, “moments ±10 % (1σ), products within ±50
    /// kg·m² (3σ), axes within 2°, mass ±1 %, centre ±10 mm”, each of them optional. Prints the
    /// deviations of all six entries that they come to beside those stated, warns where they
    /// contradict each other or no body, and writes the part of a scenario file that holds the model
    /// of Peck (2003).
    #[command(after_help = MODEL_EXAMPLES)]
    Model(ModelArgs),
    /// Roll the parts of a vehicle up to mass, mass centre and inertia of the whole, with their uncertainty
    ///
    /// Reads one part a row, with mass, mass centre, inertia or shape, and standard deviations, and what belongs to what. Prints
    /// the ten numbers of the whole with standard deviations by first order, as in a mass-properties report, and beside them by
    /// drawing, in which every draw is a body that could be built; warns of deviations that no body can have.
    #[command(after_help = ROLLUP_EXAMPLES)]
    Rollup(RollupArgs),
    /// Compare the models of inertia uncertainty on the same bodies
    ///
    /// Draws from every model about nominal bodies over a growing uncertainty, each model with the same
    /// mean and covariance of the six entries as far as its kind can have them, and shows the share
    /// of draws that no body has, and how widely inertia ratio, wobble, and nutation after a separation
    /// spread. What was matched, and how far it is off, is shown with it.
    #[command(after_help = COMPARE_EXAMPLES)]
    Compare(CompareArgs),
    /// Say whether the runs in a table meet requirements, as "tip_off_deg_per_s <= 1 in 99.73 % at 90 %"
    ///
    /// Reads a Parquet or CSV file of anybody's Monte Carlo, one row a run, or a folder of Parquet files such as runs/proposed of a
    /// study. For each requirement: how many runs fail it and how many may, the bound that the required share of all runs keeps, the
    /// margin, the verdict, how many more runs would decide, how good a vehicle must be to pass, and the worst runs.
    #[command(after_help = VERDICT_EXAMPLES)]
    Verdict(VerdictArgs),
    /// Find how often a rare event happens, as "cone_deg >= 3": probabilities down to 1e-9, with an interval
    ///
    /// Subset simulation: a first level of plain runs, of which the tenth nearest to the event goes on; some of their inputs are drawn
    /// anew from their own laws, one group of inputs at a time, and so on to the event. It takes some thousand runs for each digit
    /// of the probability, where plain runs take ten times as many for each. Nothing is written.
    ///
    /// Importance sampling: masses, mass centres, springs and quantities are drawn from laws under which the event is less rare, and each
    /// run counts with the ratio of the densities, which is exact. Searches find these laws level by level, and a sample
    /// gives the probability. Lengths and roots of the inertia of a body are drawn so, too, if one of them is correlated. Other inertias,
    /// axes, and all of a body with `inside` keep their own laws. The answer says what was drawn from which law.
    #[command(after_help = RARE_EXAMPLES)]
    Rare(RareArgs),
    /// Print a script that lets a shell complete verbs, flags and values
    #[command(after_help = COMPLETIONS_EXAMPLES)]
    Completions(CompletionsArgs),
    /// Print the manual page of the program, or of one verb
    #[command(after_help = MAN_EXAMPLES)]
    Man(ManArgs),
}

#[derive(Args, Debug)]
pub(crate) struct CompletionsArgs {
    /// Which shell
    #[arg(value_enum, value_name = "SHELL")]
    pub(crate) shell: clap_complete::Shell,
}

#[derive(Args, Debug)]
pub(crate) struct ManArgs {
    /// Which verb [default: the program itself]
    #[arg(value_name = "VERB")]
    pub(crate) verb: Option<String>,
}

/// A scenario, and what its runs are in the place of those that it says.
#[derive(Args, Debug)]
pub(crate) struct ScenarioArgs {
    /// Scenario file (TOML) [default: the built-in study of Peck (2003)]
    #[arg(value_name = "SCENARIO", conflicts_with = "named")]
    file: Option<PathBuf>,

    /// The same as SCENARIO
    #[arg(long = "scenario", value_name = "FILE")]
    named: Option<PathBuf>,

    /// Runs of each model [default: as in the scenario]
    #[arg(short = 'n', long, value_name = "N", allow_negative_numbers = true, value_parser = whole)]
    pub(crate) runs: Option<u64>,

    /// Vehicles, in the place of runs, of a scenario with vehicles and flights [default: as in the scenario]
    #[arg(long, value_name = "V", allow_negative_numbers = true, value_parser = whole, conflicts_with = "runs")]
    pub(crate) vehicles: Option<u64>,

    /// Seed of all random numbers [default: as in the scenario]
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = whole)]
    pub(crate) seed: Option<u64>,
}

impl ScenarioArgs {
    /// The scenario file, if one is named.
    pub(crate) fn file(&self) -> Option<&Path> {
        self.named.as_deref().or(self.file.as_deref())
    }
}

#[derive(Args, Debug)]
pub(crate) struct StudyArgs {
    #[command(flatten)]
    pub(crate) scenario: ScenarioArgs,

    /// Folder to write [default: target/study/<scenario name>]
    #[arg(short, long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    /// Number of threads [default: one for each core]
    #[arg(long, value_name = "T", allow_negative_numbers = true, value_parser = threads)]
    pub(crate) threads: Option<usize>,

    /// Replace another study in the folder: the files that it wrote, and nothing else
    #[arg(long)]
    pub(crate) force: bool,

    /// Which rows of the run tables to keep once all runs are done [default: as in the scenario, which is all if it does not say]
    ///
    /// Until then all rows are on the disk, for quantiles are found in several passes over them. Nobody can add runs to a
    /// study whose rows were not all kept.
    #[arg(long, value_name = "WHICH", value_parser = rows())]
    pub(crate) rows: Option<Rows>,

    /// Columns of the run tables to keep once all runs are done, besides model, run and status, and of vehicles vehicle and flight [default: as in the scenario]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    pub(crate) columns: Option<Vec<String>>,

    /// Go on until the runs show enough, and to --runs at most: “decided”, “share within 0.1 %”, “mean(wobble_deg) within 0.02”
    ///
    /// decided: each requirement is met or not met, by a rule that keeps its risk however often the runs are looked at. share within:
    /// the share of runs that fail is known to ± this for each requirement, that is, its interval is no wider than twice this. mean
    /// within: so is the mean of a column.
    #[arg(long, value_name = "RULE", conflicts_with = "shard")]
    pub(crate) until: Option<StoppingRule>,

    /// Runs before the first look of --until, or of a rule in the scenario, and between the first of them [default: 1000, or 256 of a
    /// simulator]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole)]
    pub(crate) look_every: Option<u64>,

    /// Find what drives the outcome, by so many base runs of each model: Sobol' indices of the groups of inputs, in the report
    ///
    /// Each base run is done once for each group of inputs that are drawn independently, and twice more. 1000 tell the large
    /// ones from the small ones.
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole, conflicts_with = "shard")]
    pub(crate) drivers: Option<u64>,

    /// Do only a share of the runs, as 2/8, while other processes do the others: `gyradius report` puts them together
    ///
    /// auto/8 takes the number from the environment, as a scheduler says it: Slurm, Kubernetes, HyperQueue, MPI.
    #[arg(long, value_name = "I/N|auto/N", conflicts_with = "force")]
    pub(crate) shard: Option<AskedShard>,

    /// Do the runs again that failed before, as after a licence was not free; the report says how many
    #[arg(long, conflicts_with = "shard")]
    pub(crate) retry_failed: bool,

    /// Begin even if the run tables will not fit onto the disk, or the study into memory
    #[arg(long)]
    pub(crate) even_if_full: bool,

    /// Write JSON in place of the table, for other programs
    #[arg(long)]
    pub(crate) json: bool,

    /// Write nothing but errors: no progress, no table
    #[arg(long, short, conflicts_with = "json")]
    pub(crate) quiet: bool,

    /// Largest share of the runs of a model that may fail, as 0.05 or 5%, for exit code 0
    #[arg(long, value_name = "SHARE", default_value = "50%", allow_negative_numbers = true, value_parser = share)]
    pub(crate) max_failed: f64,
}

#[derive(Args, Debug)]
pub(crate) struct ReportArgs {
    /// Folder of a study [default: target/study/peck-2003]
    #[arg(value_name = "STUDY")]
    pub(crate) study: Option<PathBuf>,

    /// Folder to write [default: that of the study]
    #[arg(short, long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    /// Replace another report in the folder given with --out
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Args, Debug)]
pub(crate) struct StatusArgs {
    /// Folder of a study [default: target/study/peck-2003]
    #[arg(value_name = "STUDY")]
    pub(crate) study: Option<PathBuf>,

    /// Write JSON, for other programs
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
pub(crate) struct RareArgs {
    /// Event, as "abs(x) >= 1": a column x, abs(x) or norm(x, y, z); <= or >= or both
    #[arg(value_name = "EVENT", allow_hyphen_values = true)]
    pub(crate) event: Event,

    /// Scenario file (TOML) [default: the built-in study of Peck (2003)]
    #[arg(long, value_name = "FILE")]
    pub(crate) scenario: Option<PathBuf>,

    /// Model [default: the first of the scenario]
    #[arg(long, value_name = "NAME")]
    pub(crate) model: Option<String>,

    /// Seed of all random numbers [default: as in the scenario]
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = whole)]
    pub(crate) seed: Option<u64>,

    /// Method
    #[arg(long, value_enum, default_value_t = RareMethodArg::Subset)]
    pub(crate) method: RareMethodArg,

    /// Runs of a level, 100 or more
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole, default_value_t = RareOptions::default().per_level as u64)]
    pub(crate) per_level: u64,

    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = whole, help = format!(
        "Independent repetitions of a subset simulation, from which the interval is found, 2 or more [default: {}]",
        RareMethod::REPLICAS
    ))]
    pub(crate) replicas: Option<u64>,

    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole, help = format!(
        "Runs of the sample of importance sampling, 100 or more [default: {}]",
        RareMethod::SAMPLE
    ))]
    pub(crate) sample: Option<u64>,

    /// Give up where the runs that come nearest are rarer than this and are not the event
    #[arg(long, value_name = "P", allow_negative_numbers = true, default_value_t = RareOptions::default().least, value_parser = probability)]
    pub(crate) least: f64,

    /// Number of threads [default: one for each core]
    #[arg(long, value_name = "T", allow_negative_numbers = true, value_parser = threads)]
    pub(crate) threads: Option<usize>,

    /// Write JSON, for other programs
    #[arg(long)]
    pub(crate) json: bool,
}

/// By which method a rare event is looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum RareMethodArg {
    /// Subset simulation, which serves any law
    Subset,
    /// Importance sampling, for masses, mass centres, springs, quantities, and lengths and roots of inertias that are correlated
    Importance,
}

#[derive(Args, Debug)]
pub(crate) struct VerdictArgs {
    /// Table: a Parquet or CSV file, or a folder of Parquet files; - for CSV on standard input
    #[arg(value_name = "TABLE")]
    pub(crate) table: PathBuf,

    /// Requirement, as "abs(x) <= 1 in 99.73 % at 90 %": a column x, abs(x) or norm(x, y, z); <= or >= or both; a share of all runs; a confidence
    #[arg(long, value_name = "REQUIREMENT", required = true, allow_hyphen_values = true)]
    pub(crate) require: Vec<Requirement>,

    /// Leave out runs without a number, such as those that failed; otherwise they count against every requirement, as infinite numbers always do
    #[arg(long)]
    pub(crate) leave_out_failed: bool,

    /// Write JSON, for other programs
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
pub(crate) struct SlurmArgs {
    #[command(flatten)]
    pub(crate) scenario: ScenarioArgs,

    /// Folder of the study, on a file system that all nodes have in common
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,

    /// Threads, and processor cores, of each task
    #[arg(long, value_name = "T", default_value_t = 1, allow_negative_numbers = true, value_parser = value_parser!(u32).range(1..=1024))]
    pub(crate) threads: u32,

    /// Number of shards, which is the size of the array [default: so that each takes about ten minutes; with a simulator of your own it must be given]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = value_parser!(u32).range(1..=1_000_000))]
    pub(crate) shards: Option<u32>,

    /// Tasks of the array that may run at the same time [default: all]
    #[arg(long, value_name = "K", allow_negative_numbers = true, value_parser = value_parser!(u32).range(1..))]
    pub(crate) max_tasks: Option<u32>,

    /// Partition, as of sbatch [default: that of the cluster]
    #[arg(long, value_name = "NAME", value_parser = NonEmptyStringValueParser::new())]
    pub(crate) partition: Option<String>,

    /// Account, as of sbatch [default: yours]
    #[arg(long, value_name = "NAME", value_parser = NonEmptyStringValueParser::new())]
    pub(crate) account: Option<String>,

    /// Time limit of a task, and of the report, as of sbatch [default: five times the forecast, and ten minutes; with a simulator of your own it must be given]
    #[arg(long, value_name = "TIME", value_parser = time_limit)]
    pub(crate) time: Option<String>,

    /// Memory of a task, and of the report, as of sbatch [default: that of the cluster]
    #[arg(long, value_name = "SIZE", value_parser = memory)]
    pub(crate) mem: Option<String>,

    /// Folder of the logs [default: beside that of the study, with -slurm at the end of its name]
    #[arg(long, value_name = "DIR")]
    pub(crate) logs: Option<PathBuf>,

    /// File to write; - is standard output [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,

    /// Replace the file if it is there
    #[arg(long, requires = "output")]
    pub(crate) force: bool,
}

#[derive(Args, Debug)]
pub(crate) struct ReplayArgs {
    /// Folder of a study, or a scenario file [default: target/study/peck-2003]
    #[arg(value_name = "STUDY")]
    pub(crate) study: Option<PathBuf>,

    /// Which run, from 0
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole,
          required_unless_present_any = ["vehicle", "flight"])]
    pub(crate) run: Option<u64>,

    /// In the place of --run: which vehicle of a scenario with vehicles, from 0
    #[arg(long, value_name = "V", allow_negative_numbers = true, value_parser = whole, requires = "flight", conflicts_with = "run")]
    pub(crate) vehicle: Option<u64>,

    /// Which flight of the vehicle, from 0
    #[arg(long, value_name = "F", allow_negative_numbers = true, value_parser = whole, requires = "vehicle", conflicts_with = "run")]
    pub(crate) flight: Option<u64>,

    /// Which model [default: the first of the scenario]
    #[arg(long, value_name = "NAME")]
    pub(crate) model: Option<String>,

    /// Seconds to go on for after the last release, 3600 at most, and less of bodies that spin fast: the motion must take no more than 100000
    /// steps
    #[arg(long, value_name = "SECONDS", default_value_t = 5.0, allow_negative_numbers = true)]
    pub(crate) coast: f64,

    /// Folder to write [default: target/replay/<scenario name>/<model>-<run>]
    #[arg(short, long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    /// Replace files of another replay in the folder
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Args, Debug)]
pub(crate) struct DrawArgs {
    /// Scenario file (TOML) [default: the built-in study of Peck (2003)], a file of laws as `gyradius model` and `gyradius fit` write them
    /// (TOML, JSON), or a robot (URDF, MJCF, SDF)
    #[arg(value_name = "SCENARIO|LAWS|ROBOT")]
    pub(crate) scenario: Option<PathBuf>,

    /// Runs of each model; 0 for the columns alone [default: as in the scenario; 2000 of laws]. Of a robot: how many
    #[arg(short = 'n', long, value_name = "N", allow_negative_numbers = true, value_parser = whole)]
    pub(crate) runs: Option<u64>,

    /// The first run, or the first robot
    #[arg(long, value_name = "K", default_value_t = 0, allow_negative_numbers = true, value_parser = whole)]
    pub(crate) first: u64,

    /// Which model; may be given several times [default: all of the scenario, one after the other]
    #[arg(long = "model", value_name = "NAME")]
    pub(crate) models: Vec<String>,

    /// Seed of all random numbers [default: as in the scenario; 1 of laws; 0 of a robot]
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = whole)]
    pub(crate) seed: Option<u64>,

    #[command(flatten)]
    pub(crate) stated: StatedArgs,

    /// Of a robot: which links, by names in which * stands for any characters and ? for one [default: all with an inertia]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', help_heading = ROBOTS)]
    pub(crate) links: Vec<String>,

    /// Of a robot: every draw must be possible for matter in this region of the link's own collision or visual geometry
    #[arg(long, value_name = "REGION", value_parser = inside(), help_heading = ROBOTS)]
    pub(crate) inside: Option<Inside>,

    /// Form of the output [default: by the extension of the file; csv on standard output]
    #[arg(long, value_name = "FORMAT", value_parser = table_format())]
    pub(crate) format: Option<TableFormat>,

    /// Table to write; - is standard output [default: standard output]. Of a robot also a folder, for a file of each draw
    #[arg(short, long, value_name = "FILE|FOLDER")]
    pub(crate) output: Option<PathBuf>,

    /// Replace the file if it is there; in a folder, robots of another draw
    #[arg(long, requires = "output")]
    pub(crate) force: bool,

    /// Number of threads [default: one for each core]
    #[arg(long, value_name = "T", allow_negative_numbers = true, value_parser = threads)]
    pub(crate) threads: Option<usize>,
}

#[derive(Args, Debug)]
pub(crate) struct CheckArgs {
    /// Files, and folders to be searched; - is standard input
    #[arg(required = true, value_name = "FILE|FOLDER|-")]
    pub(crate) paths: Vec<PathBuf>,

    /// List the good bodies too
    #[arg(long)]
    pub(crate) all: bool,

    /// Write a copy with possible inertias beside each file that needs one, as NAME.repaired.EXT, and
    /// show what changes in it
    #[arg(long, value_enum, value_name = "HOW", num_args = 0..=1, require_equals = true,
          default_missing_value = "nearest")]
    pub(crate) repair: Option<RepairArg>,

    /// Replace repaired copies that are there already; never an original
    #[arg(long, requires = "repair")]
    pub(crate) force: bool,

    /// How far outside the possible an inertia may lie, relative to its trace. Files carry about
    /// six digits, and a flat plate written with six digits lies on the boundary to within that. Less than 1.4e-14, also 0, is taken
    /// as 1.4e-14: the computation itself rounds by as much
    #[arg(long, value_name = "REL", allow_negative_numbers = true, default_value_t = gyradius_formats::TOLERANCE, value_parser = tolerance)]
    pub(crate) tolerance: f64,

    /// Products of inertia are positive integrals of xy, not matrix entries, in files that do not
    /// say which
    #[arg(long)]
    pub(crate) flip_products: bool,

    /// Form of the output
    #[arg(long, value_enum, default_value_t = Form::Text)]
    pub(crate) format: Form,
}

/// What becomes of an inertia that no body has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum RepairArg {
    /// The nearest that a body has
    Nearest,
    /// The signs of its products flipped where a body has that, the nearest elsewhere
    Flip,
}

#[derive(Args, Debug)]
pub(crate) struct FitArgs {
    /// Table of samples, one inertia a row, or one body with mass and mass centre
    #[arg(value_name = "FILE", required_unless_present = "estimate")]
    pub(crate) file: Option<PathBuf>,

    /// An estimate in place of samples: mean and covariance of ten parameters (JSON, TOML or CSV)
    #[arg(long, value_name = "FILE", conflicts_with_all = ["file", "body", "skip_impossible", "flip_products"])]
    pub(crate) estimate: Option<PathBuf>,

    /// What mass, mass centre and inertia are in the file [default: natural for tables]
    #[arg(long, value_enum)]
    pub(crate) parameters: Option<ParametersArg>,

    #[command(flatten)]
    pub(crate) fragment: FragmentArgs,

    /// Set samples aside that no body has, and count them, instead of refusing the table
    #[arg(long)]
    pub(crate) skip_impossible: bool,

    /// Products of inertia are positive integrals of xy, not matrix entries, in files that do not
    /// say which
    #[arg(long)]
    pub(crate) flip_products: bool,
}

impl FitArgs {
    /// The table of samples.
    pub(crate) fn table(&self) -> &Path {
        self.file.as_deref().unwrap_or(Path::new(""))
    }
}

/// Which ten numbers a body or an estimate has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum ParametersArg {
    /// Mass centre, and inertia about it
    Natural,
    /// First moments m c, and inertia about the origin, in which the equations of motion are linear
    Linear,
}

impl From<ParametersArg> for TenForm {
    fn from(parameters: ParametersArg) -> Self {
        match parameters {
            ParametersArg::Natural => Self::Natural,
            ParametersArg::Linear => Self::Linear,
        }
    }
}

#[derive(Args, Debug)]
pub(crate) struct ModelArgs {
    /// Nominal inertia and statements (TOML)
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,

    #[command(flatten)]
    pub(crate) fragment: FragmentArgs,
}

/// Where a fragment of a scenario goes.
#[derive(Args, Debug)]
pub(crate) struct FragmentArgs {
    /// Body of the scenario that the fragment is for
    #[arg(long, value_enum, default_value_t = BodyArg::Payload)]
    pub(crate) body: BodyArg,

    /// File to write the fragment to; - is standard output [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,

    /// Replace the file if it is there
    #[arg(long, requires = "output")]
    pub(crate) force: bool,

    /// Form of the report
    #[arg(long, value_enum, default_value_t = Form::Text)]
    pub(crate) format: Form,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum BodyArg {
    /// What is separated
    Payload,
    /// What it is separated from
    Stage,
}

#[derive(Args, Debug)]
pub(crate) struct CompareArgs {
    /// A body: payload, slender-stage, panel or bus; payload or stage of the scenario; or its inertia
    /// in kg·m², I11,I22,I33[,I12,I13,I23]. May be given several times [default: all by name]
    #[arg(long = "body", value_name = "NAME|I11,I22,...", allow_hyphen_values = true)]
    pub(crate) bodies: Vec<String>,

    /// Scenario file (TOML) for the bodies and the separation [default: Peck (2003)]
    #[arg(long, value_name = "FILE")]
    pub(crate) scenario: Option<PathBuf>,

    /// Uncertainties in percent of the largest moment
    #[arg(
        long,
        value_name = "P,P,...",
        value_delimiter = ',',
        default_value = "1,2,5,10,20,50",
        value_parser = level,
        allow_hyphen_values = true
    )]
    pub(crate) levels: Vec<f64>,

    /// What every model is matched to at a level
    #[arg(long, value_enum, default_value_t = ReferenceName::Principal)]
    pub(crate) reference: ReferenceName,

    #[arg(long, value_name = "M,M,...", value_delimiter = ',', help = models())]
    pub(crate) models: Vec<ModelKind>,

    /// Draws of each model about each body at each level
    #[arg(long, value_name = "N", default_value_t = CompareOptions::default().draws, allow_negative_numbers = true, value_parser = whole)]
    pub(crate) draws: u64,

    /// How many of the draws are separated [default: 150, or all draws if they are fewer]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole)]
    pub(crate) separations: Option<u64>,

    /// Seed of all random numbers
    #[arg(long, value_name = "S", default_value_t = CompareOptions::default().seed, allow_negative_numbers = true, value_parser = whole)]
    pub(crate) seed: u64,

    /// Number of threads [default: one for each core]
    #[arg(long, value_name = "T", allow_negative_numbers = true, value_parser = threads)]
    pub(crate) threads: Option<usize>,

    /// Form of the output
    #[arg(long, value_enum, default_value_t = CompareForm::Text)]
    pub(crate) format: CompareForm,

    /// Folder to write compare.html, compare.csv, compare.json and figures to
    #[arg(short, long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    /// Replace another comparison in the folder
    #[arg(long, requires = "out")]
    pub(crate) force: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum ReferenceName {
    /// The moments of a law of bodies: the paper's, of that size
    Principal,
    /// Six independent entries with deviations of that size
    Entries,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum CompareForm {
    /// Tables to be read by people
    Text,
    /// One JSON object, described in docs/compare.md
    Json,
    /// One row for each body, level, model and measure
    Csv,
}

#[derive(Args, Debug)]
pub(crate) struct RollupArgs {
    /// List of the parts: a CSV file with a header
    #[arg(value_name = "PARTS")]
    pub(crate) parts: PathBuf,

    /// Table of the columns child and parent that says what belongs to what [default: the column parent of the list]
    #[arg(long, value_name = "FILE")]
    pub(crate) edges: Option<PathBuf>,

    /// What products of inertia are where the list does not say it
    #[arg(long, value_enum, value_name = "SIGN")]
    pub(crate) products: Option<Sign>,

    /// How many draws of the whole; 0 leaves first order alone
    #[arg(short = 'n', long, value_name = "N", default_value = "100000", allow_negative_numbers = true, value_parser = whole)]
    pub(crate) draws: u64,

    /// Seed of all random numbers
    #[arg(long, value_name = "S", default_value_t = 2003, allow_negative_numbers = true, value_parser = whole)]
    pub(crate) seed: u64,

    /// Form of the report
    #[arg(long, value_enum, default_value_t = Form::Text)]
    pub(crate) format: Form,

    /// File for the draws, one row each: its extension tells the form
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,

    /// Replace the file if it is there
    #[arg(long, requires = "output")]
    pub(crate) force: bool,

    /// Number of threads [default: one for each core]
    #[arg(long, value_name = "T", allow_negative_numbers = true, value_parser = threads)]
    pub(crate) threads: Option<usize>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Sign {
    /// Entries of the tensor, I12 = -∫xy dm
    Tensor,
    /// Positive integrals, ∫xy dm
    Integrals,
}

impl From<Sign> for gyradius_formats::Products {
    fn from(sign: Sign) -> Self {
        match sign {
            Sign::Tensor => Self::TensorEntries,
            Sign::Integrals => Self::Integrals,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Form {
    /// A table to be read by people
    Text,
    /// One JSON object, described in the documentation of the command
    Json,
}

/// A whole number: 1000000, 1_000_000 or 1e6.
fn whole(text: &str) -> Result<u64, String> {
    let digits = text.replace('_', "");
    let grouped = text.split('_').all(|part| !part.is_empty());
    let float = || digits.parse().ok().and_then(gyradius_study::whole_number);
    digits.parse().ok().or_else(float).filter(|_| grouped).ok_or_else(|| {
        if grouped && digits.bytes().all(|byte| byte.is_ascii_digit()) {
            return format!("it must be at most {}", u64::MAX);
        }
        let certain = 1_u64 << 53;
        format!(
            "it must be a whole number and not negative, as 1000000, 1_000_000 or 1e6; one of {certain} or more must be written \
             with all its digits"
        )
    })
}

/// A time limit as `sbatch` has it (Slurm's manual page of sbatch, `--time`).
fn time_limit(text: &str) -> Result<String, String> {
    let number = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    let parts = |text: &str, most: usize| {
        let parts: Vec<&str> = text.split(':').collect();
        parts.len() <= most && parts.into_iter().all(number)
    };
    let is_time = match text.split_once('-') {
        Some((days, rest)) => number(days) && parts(rest, 3),
        None => {
            parts(text, 3)
                || ["unlimited", "infinite"].iter().any(|word| text.eq_ignore_ascii_case(word))
        }
    };
    let allowed = "it must be minutes, minutes:seconds, hours:minutes:seconds, days-hours, days-hours:minutes, days-hours:minutes:seconds \
                   or UNLIMITED";
    if is_time { Ok(text.to_owned()) } else { Err(allowed.to_owned()) }
}

/// A size of memory as `sbatch` has it: megabytes, or a number with a unit.
fn memory(text: &str) -> Result<String, String> {
    const UNITS: [char; 8] = ['k', 'K', 'm', 'M', 'g', 'G', 't', 'T'];
    let of_bytes = text.strip_suffix(['b', 'B']).filter(|size| size.ends_with(UNITS));
    let size = of_bytes.unwrap_or(text);
    let number = size.strip_suffix(UNITS).unwrap_or(size);
    if !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit()) {
        return Ok(text.to_owned());
    }
    Err("it must be a whole number of megabytes, or one with K, M, G or T after it, as 4G"
        .to_owned())
}

/// A level of a comparison in percent of the largest moment: 5 or 5%.
fn level(text: &str) -> Result<f64, String> {
    text.strip_suffix('%').unwrap_or(text).trim().parse().map_err(|_| {
        "it must be a number, in percent of the largest moment, as 5 or 5%, and a comma parts it from the next".to_owned()
    })
}

/// A number of threads, as any whole number; how many there may be is asked where they are made.
fn threads(text: &str) -> Result<usize, String> {
    whole(text).map(|number| usize::try_from(number).unwrap_or(usize::MAX))
}

/// The forms of tables, by their names.
fn table_format() -> impl TypedValueParser<Value = TableFormat> {
    let value = |format: TableFormat| PossibleValue::new(format.name()).help(format.meaning());
    let names = PossibleValuesParser::new(TableFormat::ALL.map(value));
    // Each of these is the name of one.
    names.map(|name| TableFormat::named(&name).unwrap_or_default())
}

/// The regions of a link, by their names.
fn inside() -> impl TypedValueParser<Value = Inside> {
    let value = |inside: Inside| PossibleValue::new(inside.name()).help(inside.meaning());
    // Each of these is the name of one.
    PossibleValuesParser::new(Inside::ALL.map(value)).map(|name| {
        Inside::ALL.into_iter().find(|inside| inside.name() == name).unwrap_or(Inside::Box)
    })
}

/// Which rows are kept, by their names.
fn rows() -> impl TypedValueParser<Value = Rows> {
    let value = |rows: Rows| PossibleValue::new(rows.name()).help(rows.meaning());
    // Each of these is the name of one.
    PossibleValuesParser::new(Rows::ALL.map(value))
        .map(|name| Rows::ALL.into_iter().find(|rows| rows.name() == name).unwrap_or_default())
}

/// The help of `--models`.
fn models() -> String {
    format!("Models [default: all]: {}", ModelKind::ALL.map(ModelKind::name).join(", "))
}

fn probability(text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| "it must be a number between 1e-9 and 1, such as 1e-6".to_owned())
}

/// As it is applied, so that all that is written says so.
fn tolerance(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=0.1).contains(&value) => Ok(value.max(RELATIVE_TOLERANCE)),
        _ => Err("it must lie between 0 and 0.1".to_owned()),
    }
}
