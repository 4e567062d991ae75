//! Mean, deviations and correlations of draws, with the errors that come of their number.

use gyradius_campaign::Table;
use gyradius_dispersion::TenParameters;
use gyradius_estimation::FirstOrder;
use nalgebra::{SMatrix, SVector};

type Ten = SVector<f64, 10>;
type Square = SMatrix<f64, 10, 10>;

/// What draws of the ten come to.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnMoments {
    /// How many there are.
    pub draws: u64,
    /// How many sums left the range of floats.
    pub failed: u64,
    /// How many are no body's: none.
    pub impossible: u64,
    /// Means; none without a draw.
    pub mean: Option<[f64; 10]>,
    /// How they scatter; nothing of fewer than two draws.
    pub spread: Option<DrawnSpread>,
}

/// How draws of the ten scatter.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnSpread {
    /// Standard errors of the means, σ/√n.
    pub mean_error: [f64; 10],
    /// Standard deviations.
    pub deviation: [f64; 10],
    /// Their standard errors, √(m₄ − σ⁴)/(2σ√n) with the fourth central moment m₄.
    pub deviation_error: [f64; 10],
    /// Correlations; zero where one of two does not vary.
    pub correlation: [[f64; 10]; 10],
}

/// Sums over draws, in their order, of differences from the nominal in deviations by first order.
#[derive(Clone, Debug)]
pub(super) struct Sums {
    origin: Ten,
    scale: Ten,
    count: u64,
    failed: u64,
    impossible: u64,
    first: Ten,
    second: Square,
    third: Ten,
    fourth: Ten,
}

impl Sums {
    pub(super) fn new(moments: &FirstOrder) -> Self {
        let scale = Ten::from(moments.deviations()).map(|s| if s > 0.0 { s } else { 1.0 });
        Self {
            origin: moments.values().into(),
            scale,
            count: 0,
            failed: 0,
            impossible: 0,
            first: Ten::zeros(),
            second: Square::zeros(),
            third: Ten::zeros(),
            fourth: Ten::zeros(),
        }
    }

    pub(super) fn add(&mut self, table: &Table) {
        for row in table.rows() {
            let ten = TenParameters::COLUMNS.map(|name| row.number(name));
            if ten.iter().any(Option::is_none) {
                self.failed += 1;
                continue;
            }
            let ten = ten.map(Option::unwrap_or_default);
            let parameters = TenParameters::from_values(ten);
            let possible = parameters.is_ok_and(|ten| ten.is_realizable());
            let ten = Ten::from(ten);
            self.impossible += u64::from(!possible);
            let x = (ten - self.origin).component_div(&self.scale);
            let square = x.component_mul(&x);
            self.count += 1;
            self.first += x;
            self.second += x * x.transpose();
            self.third += square.component_mul(&x);
            self.fourth += square.component_mul(&square);
        }
    }

    pub(super) fn moments(&self) -> DrawnMoments {
        let n = self.count.max(1) as f64;
        let mean = self.first / n;
        let raw = self.second / n;
        let central = raw - mean * mean.transpose();
        let variance = central.diagonal().map(|v| v.max(0.0));
        // E(x − μ)⁴ from moments about the nominal, which lies within a few deviations.
        let fourth = Ten::from_fn(|i, _| {
            let m = mean[i];
            let moment =
                self.fourth[i] / n - 4.0 * m * self.third[i] / n + 6.0 * m * m * raw[(i, i)];
            moment - 3.0 * m.powi(4)
        });
        let deviation = variance.map(|v| (v * n / (n - 1.0).max(1.0)).sqrt());
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
        let spread = (self.count > 1).then(|| DrawnSpread {
            mean_error: scaled(&(deviation / n.sqrt())),
            deviation: scaled(&deviation),
            deviation_error: scaled(&error),
            correlation: std::array::from_fn(|i| std::array::from_fn(|j| correlation(i, j))),
        });
        let mean: [f64; 10] = (mean.component_mul(&self.scale) + self.origin).into();
        DrawnMoments {
            draws: self.count,
            failed: self.failed,
            impossible: self.impossible,
            mean: (self.count > 0).then_some(mean),
            spread,
        }
    }
}
