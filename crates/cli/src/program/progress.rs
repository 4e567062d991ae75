//! How far work has come: a bar with the time left on a terminal, a line a minute elsewhere.

use gyradius_study::rough_time;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::{
    io::{IsTerminal, stderr},
    sync::{
        OnceLock,
        atomic::{AtomicU64, Ordering},
    },
    time::{Duration, Instant},
};

use crate::program::output::say;

/// Work done sooner than this is not worth a bar.
const PATIENCE: Duration = Duration::from_secs(2);
/// Between lines where there is no terminal, s.
const LINES_S: u64 = 60;

/// Shows on standard error how far `work` is, which reports how many of `what` it has done.
pub(crate) fn show<T>(total: u64, what: &str, work: impl FnOnce(&(dyn Fn(u64) + Sync)) -> T) -> T {
    if !stderr().is_terminal() {
        let lines = Lines::new(total, what, LINES_S);
        return work(&|done| lines.report(done, &say));
    }
    let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr());
    let template = format!("{{bar:40}} {{human_pos}} of {{human_len}} {what}, {{msg}}");
    let left = format!("{{bar:40}} {{human_pos}} of {{human_len}} {what}, {{eta}} left");
    let style = |template: &str| ProgressStyle::with_template(template);
    if let Ok(style) = style(&left) {
        bar.set_style(style);
    }
    let start = Instant::now();
    let result = work(&|done| {
        if start.elapsed() > PATIENCE {
            bar.set_position(done);
            if done >= total
                && let Ok(style) = style(&template)
            {
                bar.set_style(style);
                bar.set_message("putting the results together");
            }
        }
    });
    bar.finish_and_clear();
    result
}

/// A line from time to time.
struct Lines<'a> {
    total: u64,
    what: &'a str,
    every_s: u64,
    start: Instant,
    /// How many were done before, in the first report.
    before: OnceLock<u64>,
    /// Lines that were written.
    written: AtomicU64,
}

impl<'a> Lines<'a> {
    fn new(total: u64, what: &'a str, every_s: u64) -> Self {
        let (start, before) = (Instant::now(), OnceLock::new());
        Self { total, what, every_s, start, before, written: AtomicU64::new(0) }
    }

    fn report(&self, done: u64, say: &dyn Fn(&str)) {
        let before = *self.before.get_or_init(|| done);
        let time = self.start.elapsed();
        let due = time.as_secs() / self.every_s.max(1);
        // Of the threads that report at the same time, one writes.
        let last = self.written.fetch_max(due, Ordering::Relaxed);
        if due > last {
            say(&self.line(done, before, time));
        }
    }

    fn line(&self, done: u64, before: u64, time: Duration) -> String {
        let Self { total, what, .. } = self;
        let share = 100 * u128::from(done) / u128::from((*total).max(1));
        let since = done.saturating_sub(before);
        let left = time.as_secs_f64() * total.saturating_sub(done) as f64 / since as f64;
        let left = Duration::try_from_secs_f64(left)
            .map_or_else(|_| String::new(), |left| format!(", about {} left", rough_time(left)));
        format!("{done} of {total} {what} ({share} %){left}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn lines_tell_what_is_left() {
        let lines = Lines::new(400_000, "runs", 60);
        for (done, before, seconds, expected) in [
            (100_000, 0, 60, "100000 of 400000 runs (25 %), about 3 min left"),
            (300_000, 200_000, 60, "300000 of 400000 runs (75 %), about 60 s left"),
            (400_000, 0, 60, "400000 of 400000 runs (100 %), about 0 s left"),
            (7, 7, 60, "7 of 400000 runs (0 %)"),
            (500_000, 0, 60, "500000 of 400000 runs (125 %), about 0 s left"),
        ] {
            assert_eq!(lines.line(done, before, Duration::from_secs(seconds)), expected);
        }
        assert_eq!(Lines::new(0, "runs", 60).line(0, 0, Duration::ZERO), "0 of 0 runs (0 %)");
    }

    /// However many threads report, there is one line for each time that is over.
    #[test]
    fn one_thread_writes() {
        let said = Mutex::new(0);
        let lines = Lines::new(1000, "runs", 60);
        lines.report(1, &|_| *said.lock().unwrap() += 1);
        assert_eq!(*said.lock().unwrap(), 0);
        let lines =
            Lines { start: Instant::now().checked_sub(Duration::from_secs(90)).unwrap(), ..lines };
        (0..50).for_each(|done| lines.report(done, &|_| *said.lock().unwrap() += 1));
        assert_eq!(*said.lock().unwrap(), 1);
    }
}
