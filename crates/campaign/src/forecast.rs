//! What a study will take, from the time and the size of a few of its runs. No result depends on it.

use std::{
    fmt,
    time::{Duration, Instant},
};

use crate::{
    campaign::HELD,
    simulation::Simulation,
    table::{Table, TableError},
};

/// Runs that are timed, of every model: one, and more while they are quick.
const RUNS: [u64; 3] = [1, 8, 32];
/// Long enough to be measured.
const ENOUGH: Duration = Duration::from_millis(20);
/// Times that a timing is done: another program may have been given the processor in one of them.
const AGAIN: u32 = 2;
/// Bytes of a number in a run table, where nothing was measured.
const NUMBER: u64 = 8;
/// Memory of a study besides its tables: what its columns amount to, its figures, the program itself; measured, rounded up.
const BESIDES: u64 = 150 << 20;

/// What a study will take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    runs: u64,
    threads: usize,
    /// None if no run was tried.
    time: Option<Duration>,
    disk: u64,
    /// None as long as it is not said of what blocks.
    memory: Option<u64>,
}

/// What runs take.
#[derive(Clone, Copy, Debug, Default)]
struct Cost {
    seconds: f64,
    bytes: f64,
}

impl Forecast {
    /// Times a few runs of each of some simulations, of which so many are to be done.
    ///
    /// # Errors
    /// A simulation writes rows that do not fit its columns.
    pub fn of<'a, S: Simulation + 'a>(
        simulations: impl IntoIterator<Item = &'a S>,
        runs: u64,
        threads: usize,
    ) -> Result<Self, TableError> {
        let (mut each, mut count) = (Cost::default(), 0);
        for simulation in simulations {
            let cost = cost_of_a_run(simulation, runs)?;
            each.seconds += cost.seconds;
            each.bytes += cost.bytes;
            count += 1;
        }
        let seconds = each.seconds * runs as f64 / threads.max(1) as f64;
        Ok(Self {
            runs: runs * count,
            threads,
            time: Some(Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX)),
            disk: (each.bytes * runs as f64) as u64,
            memory: None,
        })
    }

    /// Of runs of which nobody knows how long they take, in tables of so many columns.
    #[must_use]
    pub fn untimed(runs: u64, columns: usize, threads: usize) -> Self {
        let disk = runs.saturating_mul(columns as u64).saturating_mul(NUMBER);
        Self { runs, threads, time: None, disk, memory: None }
    }

    /// The same, in blocks of so many runs with so many columns.
    #[must_use]
    pub fn in_blocks_of(self, block_runs: u64, columns: usize) -> Self {
        let block = block_runs.min(self.runs).saturating_mul(columns as u64).saturating_mul(NUMBER);
        // A thread has a block, and the same as a file.
        let at_work = block.saturating_mul(2).saturating_mul(self.threads as u64);
        let memory = at_work.saturating_add(HELD * NUMBER).saturating_add(BESIDES);
        Self { memory: Some(memory), ..self }
    }

    /// Bytes of memory that are certainly enough, however many runs there are; none as long as it is not said of what
    /// [blocks](Self::in_blocks_of).
    #[must_use]
    pub fn memory(&self) -> Option<u64> {
        self.memory
    }

    /// The time from the first run to the last, to a factor of two or so; none if no run was tried.
    #[must_use]
    pub fn time(&self) -> Option<Duration> {
        self.time
    }

    /// About how many bytes the run tables take on the disk.
    #[must_use]
    pub fn disk(&self) -> u64 {
        self.disk
    }

    /// The time that so many of the runs will take, as many threads doing them; none if no run was tried.
    #[must_use]
    pub fn time_of(&self, runs: u64) -> Option<Duration> {
        let seconds = self.time?.as_secs_f64() / self.runs.max(1) as f64 * runs as f64;
        Some(Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX))
    }
}

fn cost_of_a_run<S: Simulation>(simulation: &S, most: u64) -> Result<Cost, TableError> {
    let mut worker = simulation.worker();
    let mut cost = Cost::default();
    let mut before = None;
    for runs in RUNS.into_iter().filter(|runs| *runs == 1 || *runs <= most) {
        let mut timed = || {
            let mut rows = Table::new("", 0, simulation.columns())?;
            let start = Instant::now();
            simulation.run(0..runs, &mut worker, &mut rows)?;
            Ok::<_, TableError>((start.elapsed(), rows))
        };
        let (mut time, rows) = timed()?;
        for _ in 1..AGAIN {
            // What takes long is not measured wrong by much.
            if runs == RUNS[0] || time > ENOUGH * AGAIN {
                break;
            }
            time = time.min(timed()?.0);
        }
        cost.seconds = time.as_secs_f64() / runs as f64;
        // What a file has besides its rows is in the smaller one too.
        let size = size(&rows);
        let (fewer, less) = before.unwrap_or((0, 0));
        cost.bytes = size.saturating_sub(less) as f64 / (runs - fewer) as f64;
        before = Some((runs, size));
        if time > ENOUGH {
            break;
        }
    }
    Ok(cost)
}

/// Bytes of the file of a table.
fn size(table: &Table) -> usize {
    let mut file = Vec::new();
    // Memory does not refuse.
    let _ = table.write_parquet(&mut file);
    file.len()
}

/// In one line.
impl fmt::Display for Forecast {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { runs, threads, .. } = self;
        let s = if *threads == 1 { "" } else { "s" };
        if let Some(time) = self.time {
            write!(f, "about {} for ", rough_time(time))?;
        }
        write!(f, "{runs} runs on {threads} thread{s}, ")?;
        let disk = rough_size(self.disk);
        match self.memory {
            None => write!(f, "and {disk} of disk"),
            Some(memory) => write!(f, "{disk} of disk and up to {} of memory", rough_size(memory)),
        }
    }
}

/// A time in one or two digits, for nobody knows more.
#[must_use]
pub fn rough_time(time: Duration) -> String {
    let units =
        [(1.0, "s"), (60.0, "min"), (3600.0, "h"), (86_400.0, "days"), (31_557_600.0, "years")];
    rough(time.as_secs_f64(), &units)
}

/// A size in one or two digits.
#[must_use]
pub fn rough_size(bytes: u64) -> String {
    rough(bytes as f64, &[(1.0, "bytes"), (1e3, "kB"), (1e6, "MB"), (1e9, "GB"), (1e12, "TB")])
}

/// In the largest of some units that leaves more than one and a half of them.
fn rough(value: f64, units: &[(f64, &str)]) -> String {
    let unit = units.iter().rev().find(|(unit, _)| value >= 1.5 * unit).or(units.first());
    let (unit, name) = unit.copied().unwrap_or((1.0, ""));
    let count = value / unit;
    if count < 10_000.0 { format!("{count:.0} {name}") } else { format!("{count:.0e} {name}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_short() {
        for (seconds, text) in [
            (0.0, "0 s"),
            (1.4, "1 s"),
            (59.0, "59 s"),
            (200.0, "3 min"),
            (5000.0, "83 min"),
            (6000.0, "2 h"),
            (1e6, "12 days"),
            (1e19, "3e11 years"),
        ] {
            assert_eq!(rough_time(Duration::from_secs_f64(seconds)), text, "{seconds}");
        }
    }

    #[test]
    fn sizes_are_short() {
        for (bytes, text) in [
            (0, "0 bytes"),
            (1499, "1499 bytes"),
            (1500, "2 kB"),
            (210_400_000, "210 MB"),
            (41_000_000_000, "41 GB"),
            (u64::MAX, "2e7 TB"),
        ] {
            assert_eq!(rough_size(bytes), text);
        }
    }
}
