//! Mean, deviations and correlations of ten numbers from draws, with the errors that come of their number.

use nalgebra::{SMatrix, SVector};

type Ten = SVector<f64, 10>;
type Square = SMatrix<f64, 10, 10>;

/// Sums over draws of ten numbers, in their order: of the differences from an origin in scales, which should be near the mean and
/// about a deviation, so that rounding is small.
#[derive(Clone, Debug, PartialEq, getset::CopyGetters)]
pub struct TenSums {
    origin: Ten,
    scale: Ten,
    /// How many draws there are.
    #[getset(get_copy = "pub")]
    count: u64,
    first: Ten,
    second: Square,
    third: Ten,
    fourth: Ten,
}

/// How draws of ten numbers scatter.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct TenSpread {
    /// Standard errors of the means, σ/√n.
    pub mean_error: [f64; 10],
    /// Standard deviations.
    pub deviation: [f64; 10],
    /// Their standard errors, √(m₄ − σ⁴)/(2σ√n) with the fourth central moment m₄.
    pub deviation_error: [f64; 10],
    /// Correlations; zero where one of two does not vary.
    pub correlation: [[f64; 10]; 10],
}

impl TenSums {
    /// No draws yet. A scale of zero is one.
    #[must_use]
    pub fn about(origin: [f64; 10], scale: [f64; 10]) -> Self {
        Self {
            origin: origin.into(),
            scale: Ten::from(scale).map(|s| if s > 0.0 { s } else { 1.0 }),
            count: 0,
            first: Ten::zeros(),
            second: Square::zeros(),
            third: Ten::zeros(),
            fourth: Ten::zeros(),
        }
    }

    /// One more draw.
    pub fn add(&mut self, ten: [f64; 10]) {
        let x = (Ten::from(ten) - self.origin).component_div(&self.scale);
        let square = x.component_mul(&x);
        self.count += 1;
        self.first += x;
        self.second += x * x.transpose();
        self.third += square.component_mul(&x);
        self.fourth += square.component_mul(&square);
    }

    /// Their means; none without a draw.
    #[must_use]
    pub fn mean(&self) -> Option<[f64; 10]> {
        let mean = self.first / self.count as f64;
        (self.count > 0).then(|| (mean.component_mul(&self.scale) + self.origin).into())
    }

    /// How they scatter; nothing of fewer than two draws.
    #[must_use]
    pub fn spread(&self) -> Option<TenSpread> {
        if self.count < 2 {
            return None;
        }
        let n = self.count as f64;
        let mean = self.first / n;
        let raw = self.second / n;
        let central = raw - mean * mean.transpose();
        let variance = central.diagonal().map(|v| v.max(0.0));
        // E(x − μ)⁴ from moments about the origin, which lies within a few deviations.
        let fourth = Ten::from_fn(|i, _| {
            let m = mean[i];
            let moment =
                self.fourth[i] / n - 4.0 * m * self.third[i] / n + 6.0 * m * m * raw[(i, i)];
            moment - 3.0 * m.powi(4)
        });
        let deviation = variance.map(|v| (v * n / (n - 1.0)).sqrt());
        let error = Ten::from_fn(|i, _| {
            let spread = (fourth[i] - variance[i] * variance[i]).max(0.0);
            if deviation[i] > 0.0 { (spread / n).sqrt() / (2.0 * deviation[i]) } else { 0.0 }
        });
        let correlation = |i: usize, j: usize| {
            let scale = (variance[i] * variance[j]).sqrt();
            match (scale > 0.0, i == j) {
                (true, true) => 1.0,
                (true, false) => (central[(i, j)] / scale).clamp(-1.0, 1.0),
                (false, _) => 0.0,
            }
        };
        let scaled = |x: &Ten| -> [f64; 10] { x.component_mul(&self.scale).into() };
        Some(TenSpread {
            mean_error: scaled(&(deviation / n.sqrt())),
            deviation: scaled(&deviation),
            deviation_error: scaled(&error),
            correlation: std::array::from_fn(|i| std::array::from_fn(|j| correlation(i, j))),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Against sums over all draws twice, from any origin and in any scale that is not absurd.
        #[test]
        fn sums_are_those_of_all_draws(
            draws in prop::collection::vec(prop::array::uniform10(-1.0..1.0_f64), 0..40),
            place in prop::array::uniform10(-3.0..3.0_f64),
            size in -20.0..20.0_f64,
            still in any::<bool>(),
        ) {
            let size = 10_f64.powf(size);
            let draws: Vec<[f64; 10]> = draws
                .iter()
                .map(|draw| std::array::from_fn(|i| size * if still && i == 3 { 1.5 } else { draw[i] }))
                .collect();
            let mut sums = TenSums::about(place.map(|x| x * size), [size; 10]);
            draws.iter().for_each(|draw| sums.add(*draw));
            let n = draws.len() as f64;
            let near = |a: f64, b: f64| (a - b).abs() <= 1e-6 * size;
            let moment = |i: usize, j: usize, p: i32| -> f64 {
                let mean = |i: usize| draws.iter().map(|d| d[i]).sum::<f64>() / n;
                let (a, b) = (mean(i), mean(j));
                draws.iter().map(|d| ((d[i] - a) / size).powi(p) * ((d[j] - b) / size).powi(p)).sum::<f64>() / n
            };
            prop_assert_eq!(sums.count(), draws.len() as u64);
            prop_assert_eq!(sums.mean().is_some(), n > 0.0);
            prop_assert_eq!(sums.spread().is_some(), n > 1.0);
            let Some(spread) = sums.spread() else { return Ok(()) };
            for (i, mean) in sums.mean().unwrap().into_iter().enumerate() {
                prop_assert!(near(mean, draws.iter().map(|d| d[i]).sum::<f64>() / n));
                let variance = moment(i, i, 1);
                let deviation = (variance * n / (n - 1.0)).sqrt();
                prop_assert!(near(spread.deviation[i], size * deviation), "{spread:?}");
                prop_assert!(near(spread.mean_error[i], size * deviation / n.sqrt()));
                if variance < 1e-3 {
                    continue;
                }
                let error = ((moment(i, i, 2) - variance * variance).max(0.0) / n).sqrt() / (2.0 * deviation);
                // A difference of fourth powers, of which the root is taken.
                let off = (spread.deviation_error[i] - size * error).abs();
                prop_assert!(off <= 1e-4 * size, "{off} {error}");
                for j in (0..10).filter(|j| moment(*j, *j, 1) > 1e-3) {
                    let expected = moment(i, j, 1) / (variance * moment(j, j, 1)).sqrt();
                    prop_assert!((spread.correlation[i][j] - expected).abs() < 1e-6);
                }
            }
        }
    }
}
