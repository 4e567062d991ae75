//! How long a study will take, from the time of a few of its runs. No result depends on it.

use std::{
    fmt,
    time::{Duration, Instant},
};

use crate::{
    simulation::Simulation,
    table::{Table, TableError},
};

/// Runs that are timed, of every model: one, and more while they are quick.
const RUNS: [u64; 3] = [1, 8, 64];
/// Long enough to be measured.
const ENOUGH: Duration = Duration::from_millis(20);

/// The time that a study will take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    runs: u64,
    threads: usize,
    time: Duration,
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
        let (mut each, mut count) = (0.0, 0);
        for simulation in simulations {
            each += seconds_a_run(simulation, runs)?;
            count += 1;
        }
        let seconds = each * runs as f64 / threads.max(1) as f64;
        Ok(Self {
            runs: runs * count,
            threads,
            time: Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX),
        })
    }

    /// The time from the first run to the last, to a factor of two or so.
    #[must_use]
    pub fn time(&self) -> Duration {
        self.time
    }
}

fn seconds_a_run<S: Simulation>(simulation: &S, most: u64) -> Result<f64, TableError> {
    let mut worker = simulation.worker();
    let mut seconds = 0.0;
    for runs in RUNS.into_iter().filter(|runs| *runs == 1 || *runs <= most) {
        let mut rows = Table::new("", 0, simulation.columns())?;
        let start = Instant::now();
        simulation.run(0..runs, &mut worker, &mut rows)?;
        let time = start.elapsed();
        seconds = time.as_secs_f64() / runs as f64;
        if time > ENOUGH {
            break;
        }
    }
    Ok(seconds)
}

/// In one line.
impl fmt::Display for Forecast {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { runs, threads, .. } = self;
        let s = if *threads == 1 { "" } else { "s" };
        write!(f, "about {} for {runs} runs on {threads} thread{s}", rough(self.time))
    }
}

/// One or two digits, for nobody knows more.
fn rough(time: Duration) -> String {
    let seconds = time.as_secs_f64();
    let units =
        [(1.0, "s"), (60.0, "min"), (3600.0, "h"), (86_400.0, "days"), (31_557_600.0, "years")];
    let unit = units.into_iter().rev().find(|(unit, _)| seconds >= 1.5 * unit);
    let (unit, name) = unit.unwrap_or(units[0]);
    let count = seconds / unit;
    if count < 100.0 { format!("{count:.0} {name}") } else { format!("{count:.0e} {name}") }
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
            assert_eq!(rough(Duration::from_secs_f64(seconds)), text, "{seconds}");
        }
    }
}
