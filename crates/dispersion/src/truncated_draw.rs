//! Draws of a truncated normal law by rejection (Robert 1995, doi:10.1007/BF00143942).

use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};

use crate::truncated_normal::{TruncatedNormal, WindowError};

/// A normal law kept to a window, and how it is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Truncated {
    /// The mean before truncation.
    pub(crate) mean: f64,
    pub(crate) window: TruncatedNormal,
    proposal: Proposal,
}

/// What is drawn and accepted or not: the Gaussian where the window holds a quarter of it, else the uniform
/// law on the window or an exponential at its near end.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Proposal {
    Fixed,
    Gaussian,
    Uniform,
    /// From the end nearer to the mean.
    Exponential {
        rate: f64,
    },
}

impl Truncated {
    /// As for [`TruncatedNormal::new`].
    pub(crate) fn new(mean: f64, deviation: f64, bounds: [f64; 2]) -> Result<Self, WindowError> {
        let window = TruncatedNormal::new(mean, deviation, bounds)?;
        let (near, [from, to]) = (window.offset(), window.ends());
        let rate = 0.5 * (near + (near * near + 4.0).sqrt());
        let proposal = if window.deviation() == 0.0 {
            Proposal::Fixed
        } else if window.share() >= 0.25 {
            Proposal::Gaussian
        } else if near > 0.0 && (to - from) * rate > 2.0 {
            Proposal::Exponential { rate }
        } else {
            Proposal::Uniform
        };
        Ok(Self { mean, window, proposal })
    }

    pub(crate) fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> f64 {
        let (near, [from, to]) = (self.window.offset(), self.window.ends());
        loop {
            let (v, ln_accept) = match self.proposal {
                Proposal::Fixed => return self.window.value(0.0),
                Proposal::Gaussian => {
                    let t: f64 = StandardNormal.sample(rng);
                    (self.window.sign() * t - near, 0.0)
                }
                Proposal::Uniform => {
                    let v = from + rng.random::<f64>() * (to - from);
                    (v, self.window.ln_density(v))
                }
                Proposal::Exponential { rate } => {
                    let v = -libm::log1p(-rng.random::<f64>()) / rate;
                    (v, -0.5 * (near + v - rate) * (near + v - rate))
                }
            };
            let inside = from <= v && v <= to;
            if inside && (ln_accept == 0.0 || rng.random::<f64>() < libm::exp(ln_accept)) {
                return self.window.value(v);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::truncated_normal::share;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    const INF: f64 = f64::INFINITY;

    /// Kolmogorov and Smirnov's distance from the distribution function, below the 1e-4 point: every
    /// proposal, on either side.
    #[test]
    fn draws_have_the_distribution() {
        const N: usize = 50_000;
        let mut proposals = Vec::new();
        for (low, high) in [
            (-1.0, 2.0),
            (1.5, INF),
            (-6.0, -2.0),
            (0.1, 0.4),
            (2.0, 2.1),
            (-INF, -2.5),
            (4.0, 4.2),
        ] {
            let law = Truncated::new(0.0, 1.0, [low, high]).unwrap();
            proposals.push(std::mem::discriminant(&law.proposal));
            let mut rng = ChaCha8Rng::seed_from_u64(34);
            let mut draws: Vec<f64> = (0..N).map(|_| law.sample(&mut rng)).collect();
            draws.sort_by(f64::total_cmp);
            let total = share(low, high);
            let gap = draws.iter().enumerate().fold(0.0, |gap: f64, (j, t)| {
                gap.max((share(low, *t) / total - (j as f64 + 0.5) / N as f64).abs())
            });
            assert!(gap * (N as f64).sqrt() < 2.23, "{low} {high}: {gap}");
        }
        for rare in [Proposal::Gaussian, Proposal::Uniform, Proposal::Exponential { rate: 1.0 }] {
            assert!(proposals.contains(&std::mem::discriminant(&rare)), "{rare:?}");
        }
    }
}
