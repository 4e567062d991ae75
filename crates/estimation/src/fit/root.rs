//! A root of a second moment fitted: Gaussian, folded or constant.

use gyradius_statistics::tail;
use std::fmt;

#[cfg(feature = "serde")]
use crate::read::{belong, scatter};

/// From this many deviations on, a mean is so far from zero that no sign is ever lost: e^(−2·36)
/// is below rounding.
const FAR: f64 = 6.0;
/// Roots that scatter by less than this share of their size do not scatter.
const STILL: f64 = 1e-9;
/// A second moment below this share of the largest is the rounding of the six digits that tables carry:
/// the body is a plate or a rod, and its thickness not known.
const FLAT: f64 = 1e-6;

/// How a root of a second moment was fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum RootEstimate {
    /// The mean is many deviations from zero: the plain Gaussian of Peck (2003, Eq. 10).
    Gaussian,
    /// The mean is within six deviations of zero, and the sign of k, which K = k² has lost, matters:
    /// K/σ² is noncentral χ² with one degree of freedom, √K folded normal.
    Folded,
    /// All samples have the same value to nine digits, or values so small beside the other roots,
    /// K below 1e-6 of theirs, that their scatter is the rounding of digits.
    Constant,
}

/// The maximum likelihood law N(k̄, σ²) of one root k = √K, from samples of |k|.
#[derive(Clone, Copy, Debug, PartialEq, getset::CopyGetters)]
#[getset(get_copy = "pub")]
pub struct RootFit {
    /// k̄ ≥ 0, √kg·m.
    mean: f64,
    /// σ, √kg·m; maximum likelihood, so the sum of squares is divided by n.
    deviation: f64,
    /// Standard errors of mean and deviation, √kg·m; none where the likelihood is too flat to have
    /// them (k̄ < σ) or nothing scatters.
    errors: Option<[f64; 2]>,
    /// Which law was fitted.
    law: RootEstimate,
}

impl RootFit {
    /// # Algorithm
    /// Where the mean is far from zero, mean and root mean square deviation. Else both satisfy
    /// k̄ = mean(|k| tanh(k̄|k|/σ²)) and σ² = mean(k²) − k̄² (Johnson 1962,
    /// doi:10.1080/00401706.1962.10490022), which is one equation for k̄ in [0, √mean(k²)], solved
    /// by halving. k̄ = 0 always solves it, and is taken if nothing else does. Standard errors from
    /// the second derivatives of the ln-likelihood.
    ///
    /// `size` is the root mean square of the largest root.
    pub(super) fn of(samples: &[f64], size: f64) -> Self {
        let n = samples.len() as f64;
        let mean = samples.iter().sum::<f64>() / n;
        let variance = samples.iter().map(|k| (k - mean) * (k - mean)).sum::<f64>() / n;
        let deviation = variance.sqrt();
        let square = mean * mean + variance;
        if !(square > FLAT * size * size) {
            let mean = square.sqrt();
            return Self { mean, deviation: 0.0, errors: None, law: RootEstimate::Constant };
        }
        if !(deviation > STILL * mean) {
            return Self { mean, deviation: 0.0, errors: None, law: RootEstimate::Constant };
        }
        if mean > FAR * deviation {
            let errors = Some([deviation / n.sqrt(), deviation / (2.0 * n).sqrt()]);
            return Self { mean, deviation, errors, law: RootEstimate::Gaussian };
        }
        // Positive below the solution, negative above it.
        let excess = |m: f64| {
            let v = square - m * m;
            samples.iter().map(|k| k * libm::tanh(m * k / v)).sum::<f64>() / n - m
        };
        let (mut low, mut high) = (0.0, square.sqrt() * (1.0 - 1e-12));
        // Near zero the excess is of third order: below 1 % of the size it is taken for zero.
        let start = 0.01 * high;
        if excess(start) > 0.0 {
            low = start;
            for _ in 0..46 {
                let middle = 0.5 * (low + high);
                if excess(middle) > 0.0 {
                    low = middle;
                } else {
                    high = middle;
                }
            }
        }
        let mean = low;
        let variance = square - mean * mean;
        Self {
            mean,
            deviation: variance.sqrt(),
            errors: folded_errors(samples, mean, variance).filter(|_| mean * mean >= variance),
            law: RootEstimate::Folded,
        }
    }

    /// Whether the samples tell mean and deviation apart: below k̄ = σ the folded normal law hardly
    /// changes its shape along a curve of both, and standard errors mislead.
    #[must_use]
    pub fn is_identified(&self) -> bool {
        self.law != RootEstimate::Folded || self.mean >= self.deviation
    }

    /// Distribution function of |k|.
    pub(super) fn below(&self, k: f64) -> f64 {
        let below = |x: f64| tail::normal(-(x - self.mean) / self.deviation);
        below(k) - below(-k)
    }
}

gyradius_dispersion::written!(
    RootFit,
    |fit| {
        mean_sqrt_kg_m: f64 = fit.mean,
        deviation_sqrt_kg_m: f64 = fit.deviation,
        errors_sqrt_kg_m: Option<[f64; 2]> = fit.errors,
        law: RootEstimate = fit.law,
    },
    {
        let (mean, deviation, errors) = (mean_sqrt_kg_m, deviation_sqrt_kg_m, errors_sqrt_kg_m);
        scatter(deviation, errors, law == RootEstimate::Constant)?;
        belong(mean >= 0.0, "fit of a root")?;
        RootFit { mean, deviation, errors, law }
    }
);

impl fmt::Display for RootEstimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Gaussian => "Gaussian",
            Self::Folded => "folded Gaussian",
            Self::Constant => "constant",
        })
    }
}

/// Standard errors of m and s from the observed information in (m, v = s²).
///
/// They are computed of roots of about one, for sixth powers of others overflow or vanish. A power of two takes them there and
/// back, which moves no digit.
fn folded_errors(samples: &[f64], m: f64, v: f64) -> Option<[f64; 2]> {
    let (_, exponent) = libm::frexp(v.sqrt());
    let scaled = |x: f64| libm::ldexp(x, -exponent);
    let samples: Vec<f64> = samples.iter().map(|k| scaled(*k)).collect();
    let errors = errors_of_scaled(&samples, scaled(m), scaled(scaled(v)))?;
    Some(errors.map(|error| libm::ldexp(error, exponent)))
}

/// The same of roots that scatter by about one.
fn errors_of_scaled(samples: &[f64], m: f64, v: f64) -> Option<[f64; 2]> {
    let (mut mm, mut mv, mut vv) = (0.0, 0.0, 0.0);
    for &k in samples {
        let t = libm::tanh(m * k / v);
        let c = 1.0 - t * t;
        mm += 1.0 / v - c * k * k / (v * v);
        mv += -m / (v * v) + t * k / (v * v) + c * m * k * k / (v * v * v);
        vv += -0.5 / (v * v) + (k * k + m * m - 2.0 * m * k * t) / (v * v * v)
            - c * (m * k / (v * v)).powi(2);
    }
    let determinant = mm * vv - mv * mv;
    // Flat to rounding counts as flat.
    if m == 0.0 || !(mm > 0.0 && determinant > 1e-9 * mm * vv) {
        return None;
    }
    let errors = [(vv / determinant).sqrt(), (mm / determinant).sqrt() / (2.0 * v.sqrt())];
    errors.iter().all(|e| e.is_finite()).then_some(errors)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::RngExt;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
    use rand_distr::{Distribution, Normal};

    fn draws(m: f64, s: f64, n: usize, seed: u64) -> Vec<f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let law = Normal::new(m, s).unwrap();
        (0..n).map(|_| law.sample(&mut rng).abs()).collect()
    }

    /// Against scipy's `minimize` of the negative ln-likelihood to 1e-12.
    #[test]
    fn the_maximum_is_scipys() {
        let samples = [0.1, 0.7, 1.9, 2.2, 0.4, 1.3, 3.0, 1.1, 0.9, 2.6];
        let fit = RootFit::of(&samples, 1.0);
        assert!((fit.mean() - 1.299_699_613_806_845).abs() < 1e-7, "{fit:?}");
        assert!((fit.deviation() - 1.081_101_712_996_674_4).abs() < 1e-7, "{fit:?}");
        let errors = fit.errors().unwrap();
        assert!((errors[0] / 0.413_507_15 - 1.0).abs() < 1e-4, "{errors:?}");
        assert!((errors[1] / 0.369_653_1 - 1.0).abs() < 1e-4, "{errors:?}");
    }

    /// Truth within 1.96 standard errors in 95 % of repeats, at three distances from zero.
    #[test]
    fn stated_errors_cover() {
        const REPEATS: u64 = 400;
        for (m, s) in [(20.0, 1.0), (3.0, 1.0), (2.0, 1.0)] {
            let mut covered = [0, 0];
            for seed in 0..REPEATS {
                let fit = RootFit::of(&draws(m, s, 1000, seed), 1.0);
                let errors = fit.errors().unwrap();
                covered[0] += u64::from((fit.mean() - m).abs() < 1.96 * errors[0]);
                covered[1] += u64::from((fit.deviation() - s).abs() < 1.96 * errors[1]);
            }
            for c in covered {
                // 95 % ± 4 deviations of 1.1 %.
                assert!((363..=397).contains(&c), "{m}: {covered:?}");
            }
        }
    }

    #[test]
    fn plain_moments_would_be_wrong_near_zero() {
        let samples = draws(1.5, 1.0, 100_000, 3);
        let fit = RootFit::of(&samples, 1.0);
        let errors = fit.errors().unwrap();
        assert!((fit.mean() - 1.5).abs() < 4.0 * errors[0], "{fit:?}");
        let plain = samples.iter().sum::<f64>() / 1e5;
        assert!((plain - 1.5).abs() > 10.0 * errors[0], "negative control: {plain}");
    }

    #[test]
    fn a_mean_of_zero_is_not_determined() {
        let fit = RootFit::of(&draws(0.0, 1.0, 2000, 4), 1.0);
        assert!(!fit.is_identified() && fit.mean() < 0.7, "{fit:?}");
        let square = fit.mean().powi(2) + fit.deviation().powi(2);
        assert!((square - 1.0).abs() < 0.15, "{fit:?}");
    }

    /// Digits of a table: K = 0 ± 1e-7 beside K = 1.
    #[test]
    fn thickness_within_the_rounding_of_digits_is_none() {
        let rounded: Vec<f64> = (0..40).map(|i| 1e-4 * f64::from(i % 3)).collect();
        assert_eq!(RootFit::of(&rounded, 1.0).law(), RootEstimate::Constant);
        assert_eq!(RootFit::of(&rounded, 1e-2).law(), RootEstimate::Folded);
    }

    /// A power of two takes every number with it, to the bit, as far as the squares of roots go.
    #[test]
    fn folded_fits_scale() {
        let mut rng = ChaCha8Rng::seed_from_u64(6);
        let mut with_errors = 0;
        for seed in 0..40 {
            let n = rng.random_range(13..40);
            let roots = draws(rng.random_range(1.0..5.0), 1.0, n, seed);
            let fit = RootFit::of(&roots, 1.0);
            if fit.law() != RootEstimate::Folded {
                continue;
            }
            // As it was computed without a scale.
            let (mean, variance) = (fit.mean(), fit.deviation() * fit.deviation());
            for (a, b) in
                fit.errors().iter().flatten().zip(errors_of_scaled(&roots, mean, variance).unwrap())
            {
                assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
                with_errors += 1;
            }
            // K from 1e-300 to 1e300.
            for exponent in (-498..=498).step_by(83) {
                let scaled = |x: f64| libm::ldexp(x, exponent);
                let samples: Vec<f64> = roots.iter().map(|k| scaled(*k)).collect();
                let found = RootFit::of(&samples, scaled(1.0));
                assert_eq!(found.law(), RootEstimate::Folded);
                assert_eq!(found.mean(), scaled(fit.mean()));
                assert_eq!(found.deviation(), scaled(fit.deviation()));
                assert_eq!(found.errors(), fit.errors().map(|e| e.map(scaled)), "{exponent}");
            }
        }
        assert!(with_errors > 40, "{with_errors}");
    }

    #[test]
    fn constants_are_told() {
        for samples in [[0.0; 20], [3.0; 20], [1e-160; 20], [1e70; 20]] {
            let fit = RootFit::of(&samples, samples[0]);
            assert_eq!((fit.law(), fit.deviation()), (RootEstimate::Constant, 0.0));
            assert!((fit.mean() - samples[0]).abs() <= 1e-14 * samples[0]);
        }
    }
}
