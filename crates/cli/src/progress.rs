use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::time::{Duration, Instant};

/// Work done sooner than this is not worth a bar.
const PATIENCE: Duration = Duration::from_secs(1);

/// Shows a bar with the time left on standard error while `work` reports how much it has done;
/// silent where standard error is not a terminal.
pub(crate) fn show<T>(total: u64, work: impl FnOnce(&(dyn Fn(u64) + Sync)) -> T) -> T {
    let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr());
    let template = "{bar:40} {human_pos} of {human_len} runs, {eta} left";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    let start = Instant::now();
    let result = work(&|done| {
        // Counting every run would cost more than the display is worth.
        if done.is_multiple_of(64) && start.elapsed() > PATIENCE {
            bar.set_position(done);
        }
    });
    bar.finish_and_clear();
    result
}
