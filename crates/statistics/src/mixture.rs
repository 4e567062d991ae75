//! Evidence against a share, which a mixture of other shares gives and which may be looked at after every run.

use crate::law::{beta_cdf, ln_beta_front};

/// The lesser parameter of the beta law of the mixture.
const SHAPE: f64 = 0.5;

/// Shares u with the law Beta(a, b), whose lesser parameter is ½ and whose mean is a given share.
///
/// With k failures in n runs, `∫ uᵏ(1−u)ⁿ⁻ᵏ dπ(u) / (θᵏ(1−θ)ⁿ⁻ᵏ)` is a martingale of mean 1 as n grows if θ is the
/// true share, for any law π that does not depend on the runs. By Ville's inequality it reaches 1/α after some run or other with a
/// probability of α at most.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mixture {
    a: f64,
    b: f64,
    /// The mean and what is left of one.
    mean: [f64; 2],
    /// The logarithm of `xᵃyᵇ / B(a, b)` at the mean.
    ln_front: f64,
}

impl Mixture {
    /// Of this mean, strictly between 0 and 1.
    pub(crate) fn about(share: f64) -> Self {
        let rest = 1.0 - share;
        let (a, b) = if share <= rest {
            (SHAPE, SHAPE * (rest / share))
        } else {
            (SHAPE * (share / rest), SHAPE)
        };
        Self { a, b, mean: [share, rest], ln_front: ln_beta_front(a, b, share, rest) }
    }

    /// The logarithm of the evidence against the share θ = x = 1 − y, from all shares.
    pub(crate) fn against(&self, [x, y]: [f64; 2], failures: f64, runs: f64) -> f64 {
        let (a, b) = self.after(failures, runs);
        let [mean, rest] = self.mean;
        // B(a + k, b + n − k) / (B(a, b) θᵏ(1−θ)ⁿ⁻ᵏ), where logarithms of B would lose digits.
        self.a * ln_ratio(x, mean) + self.b * ln_ratio(y, rest) + self.ln_front
            - ln_beta_front(a, b, x, y)
    }

    /// The logarithm of the evidence that the share is below the mean, from the shares below it: against the mean
    /// and against any larger share, for which its mean falls with every run.
    pub(crate) fn below(&self, failures: f64, runs: f64) -> f64 {
        let [x, y] = self.mean;
        let (a, b) = self.after(failures, runs);
        self.against(self.mean, failures, runs)
            + libm::log(beta_cdf(a, b, x, y) / beta_cdf(self.a, self.b, x, y))
    }

    /// The same that the share is above the mean, from the shares above it.
    pub(crate) fn above(&self, failures: f64, runs: f64) -> f64 {
        let [x, y] = self.mean;
        let (a, b) = self.after(failures, runs);
        self.against(self.mean, failures, runs)
            + libm::log(beta_cdf(b, a, y, x) / beta_cdf(self.b, self.a, y, x))
    }

    /// The parameters after so many failures in so many runs.
    fn after(&self, failures: f64, runs: f64) -> (f64, f64) {
        (self.a + failures, self.b + (runs - failures))
    }
}

/// `ln(x / y)`, also of what is nearly the same.
fn ln_ratio(x: f64, y: f64) -> f64 {
    let excess = (x - y) / y;
    if excess > -0.5 { libm::log1p(excess) } else { libm::log(x / y) }
}
