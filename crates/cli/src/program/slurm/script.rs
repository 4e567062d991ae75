//! The script itself: a job array of shards, and the report that waits for it.

use std::{
    ffi::{OsStr, OsString},
    fmt,
    path::PathBuf,
    time::Duration,
};

use crate::program::quote::quote;

/// The forecast is right to a factor of two or so, nodes differ, and file systems are slow at times.
const GENEROUS: f64 = 5.0;
/// Minutes that are allowed for whatever is not runs.
const BESIDES: u64 = 10;
/// Seconds that the report may take for each run: five times what it takes on one core.
const REPORT: f64 = 2e-4;
/// Minutes of the longest limit that is ever asked for: a year.
const LONGEST: u64 = 525_600;

/// What the script says. Paths are absolute.
#[derive(Clone, Debug)]
pub(super) struct Script {
    pub(super) name: String,
    pub(super) models: u64,
    pub(super) program: Vec<OsString>,
    /// Where the program is called.
    pub(super) folder: PathBuf,
    pub(super) scenario: Option<PathBuf>,
    pub(super) runs: u64,
    /// Which say how many runs there are, if there are vehicles.
    pub(super) vehicles: Option<u64>,
    pub(super) seed: Option<u64>,
    pub(super) out: PathBuf,
    pub(super) logs: PathBuf,
    pub(super) threads: u32,
    pub(super) shards: u32,
    /// How long the largest shard will take.
    pub(super) shard_time: Option<Duration>,
    pub(super) limits: Limits,
    pub(super) max_tasks: Option<u32>,
    pub(super) partition: Option<String>,
    pub(super) account: Option<String>,
    pub(super) mem: Option<String>,
}

/// Time limits of the jobs, as sbatch takes them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Limits {
    shard: String,
    report: String,
}

impl Limits {
    /// The same for both.
    pub(super) fn both(time: &str) -> Self {
        Self { shard: time.to_owned(), report: time.to_owned() }
    }

    /// Of a shard that takes so long, and of the report on so many runs.
    pub(super) fn of(shard: Duration, runs: u64) -> Self {
        let minutes = |seconds: f64| {
            (((seconds / 60.0).ceil() as u64).saturating_add(BESIDES)).min(LONGEST).to_string()
        };
        Self {
            shard: minutes(GENEROUS * shard.as_secs_f64()),
            report: minutes(REPORT * runs as f64),
        }
    }
}

/// A flag and its value, quoted.
fn flag(name: &str, value: impl AsRef<OsStr>) -> String {
    format!(" --{name}={}", quote(value.as_ref()))
}

impl Script {
    /// What calls the program.
    fn program(&self) -> String {
        self.program.iter().map(|word| quote(word)).collect::<Vec<_>>().join(" ")
    }

    /// The command of a task, but for the number of its shard.
    fn study(&self) -> String {
        let mut text = format!("{} study", self.program());
        text.extend(self.scenario.iter().map(|file| flag("scenario", file)));
        text += &match self.vehicles {
            Some(vehicles) => format!(" --vehicles={vehicles}"),
            None => format!(" --runs={}", self.runs),
        };
        text.extend(self.seed.iter().map(|seed| format!(" --seed={seed}")));
        text + &flag("out", &self.out) + &format!(" --threads={}", self.threads)
    }

    /// The command that makes the report.
    fn report(&self) -> String {
        format!("{} report -- {}", self.program(), quote(self.out.as_os_str()))
    }

    /// What both jobs tell sbatch.
    fn submission(&self, time: &str) -> String {
        let mut text = "sbatch --parsable --requeue --open-mode=append".to_owned();
        text += &flag("job-name", format!("gyradius-{}", self.name));
        let given =
            [("partition", &self.partition), ("account", &self.account), ("mem", &self.mem)];
        for (name, value) in given {
            text.extend(value.iter().map(|value| flag(name, value)));
        }
        text += &flag("time", time);
        text + &format!(" --cpus-per-task={} --chdir=\"$logs\"", self.threads)
    }
}

impl fmt::Display for Script {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { runs, models, shards, .. } = self;
        let minutes = |time: Duration| (time.as_secs_f64() / 60.0).ceil();
        let time = self
            .shard_time
            .map(|time| format!(", each of which takes about {} min", minutes(time)));
        let count = |count: u64, what: &str| match count {
            1 => format!("one {what}"),
            _ => format!("{count} {what}s"),
        };
        let (of, parts) =
            (if *models == 1 { "" } else { "each of " }, count((*shards).into(), "shard"));
        let models = count(*models, "model");
        let most = self.max_tasks.map(|most| format!("%{most}")).unwrap_or_default();
        write!(
            f,
            r#"#!/bin/bash
# A study on a Slurm cluster: {name}, {runs} runs of {of}{models}, in {parts}{time}.
# Written by gyradius {version}. `bash` and the name of this file submit it. Submitted again once its jobs have ended, it does
# what is missing, and nothing again that is finished.
set -euo pipefail

logs={logs}
mkdir -p -- "$logs"

# What each task of the array does. Its exit code is that of gyradius.
shard() {{
    cat <<'END_OF_JOB'
#!/bin/bash
cd -- {folder} || exit 2
exec {study} --shard="$SLURM_ARRAY_TASK_ID/{shards}"
END_OF_JOB
}}

# What is done when all tasks have ended, in whatever way: it counts which runs are there.
report() {{
    cat <<'END_OF_JOB'
#!/bin/bash
cd -- {folder} || exit 2
exec {report}
END_OF_JOB
}}

# What is said if the report was not submitted: who submitted the array must know.
no_report() {{
    printf '%s: the report is not submitted. Once all tasks have ended, this makes it:\n  %s\n' "$1" {by_hand} >&2
    exit 1
}}

array=$(shard | {shard_job} --array=1-{shards}{most} --output=%A_%a.log)
array=${{array%%;*}}
[[ $array =~ ^[0-9]+$ ]] || no_report "sbatch printed \"$array\" in the place of the number of the array job"
report=$(report | {report_job} --dependency=afterany:"$array" --output=%j-report.log) ||
    no_report "array job $array is submitted"
printf 'array job %s, then report job %s; logs in %s\n' "$array" "${{report%%;*}}" "$logs"
"#,
            name = quote(OsStr::new(&self.name)),
            time = time.unwrap_or_default(),
            version = env!("CARGO_PKG_VERSION"),
            logs = quote(self.logs.as_os_str()),
            folder = quote(self.folder.as_os_str()),
            study = self.study(),
            report = self.report(),
            by_hand = quote(OsStr::new(&self.report())),
            shard_job = self.submission(&self.limits.shard),
            report_job = self.submission(&self.limits.report),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_generous() {
        let of = |seconds, runs| Limits::of(Duration::from_secs(seconds), runs);
        let limits = |shard: &str, report: &str| Limits {
            shard: shard.to_owned(),
            report: report.to_owned(),
        };
        assert_eq!(of(0, 0), limits("10", "10"));
        assert_eq!(of(600, 4_000), limits("60", "11"));
        assert_eq!(of(601, 400_000_000), limits("61", "1344"));
        assert_eq!(Limits::of(Duration::MAX, u64::MAX), limits("525600", "525600"));
    }
}
