//! The order in which samples are fitted: the same for the same bodies, in whatever order and unit they come.

use gyradius_inertia::Inertia;

/// Numbers of the order of one that differ by less than this, 2⁻³⁰, are equal here: the last digits, which another unit changes, decide
/// nothing. Next to no number of a table is so near to the half of a power of two that they decide to which side it is rounded.
const EQUAL: f64 = 1.0 / (1_u64 << 30) as f64;

/// The places of samples in ascending order of their entries, and of `others` where these are equal.
pub(super) fn order(samples: &[Inertia], others: impl Fn(usize) -> [f64; 4]) -> Vec<usize> {
    let count = samples.len() as f64;
    let size: f64 = samples.iter().map(|sample| sample.matrix().trace() / count).sum();
    let whole = |x: f64| (x / EQUAL).round() as i64;
    let mut order: Vec<usize> = (0..samples.len()).collect();
    order.sort_by_cached_key(|row| {
        let entries = samples[*row].entries().map(|entry| whole(entry / size));
        (entries, others(*row).map(whole))
    });
    order
}
