//! The progress bar.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::time::{Duration, Instant};

/// Work done sooner than this is not worth a bar.
const PATIENCE: Duration = Duration::from_secs(2);

/// Shows a bar with the time left on standard error while `work` reports how many of `what` it has
/// done; silent where standard error is not a terminal.
pub(crate) fn show<T>(total: u64, what: &str, work: impl FnOnce(&(dyn Fn(u64) + Sync)) -> T) -> T {
    let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr());
    let template = format!("{{bar:40}} {{human_pos}} of {{human_len}} {what}, {{eta}} left");
    if let Ok(style) = ProgressStyle::with_template(&template) {
        bar.set_style(style);
    }
    let start = Instant::now();
    let result = work(&|done| {
        if start.elapsed() > PATIENCE {
            bar.set_position(done);
        }
    });
    bar.finish_and_clear();
    result
}
