//! Binomial probabilities by their definition, which tests compare with.

/// The probabilities of 0 to n successes, from sums of logarithms.
pub(crate) fn masses(n: u64, p: f64, q: f64) -> Vec<f64> {
    let mut ln_choose = 0.0;
    (0..=n)
        .map(|k| {
            if k > 0 {
                ln_choose += ((n - k + 1) as f64 / k as f64).ln();
            }
            (ln_choose + k as f64 * p.ln() + (n - k) as f64 * q.ln()).exp()
        })
        .collect()
}

/// What is added to the probabilities of so many failures by one more run.
pub(crate) fn one_more(masses: &mut Vec<f64>, p: f64, q: f64) {
    masses.push(0.0);
    for k in (1..masses.len()).rev() {
        masses[k] = masses[k] * q + masses[k - 1] * p;
    }
    masses[0] *= q;
}
