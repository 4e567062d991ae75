//! Expectations of products of powers of lognormal scalars with a Gaussian copula, in closed form.

use crate::{Correlation, ScalarLaw};

/// A lognormal scalar: its number, its place in a block, its mean, and the deviation of its logarithm.
struct Lognormal {
    scalar: usize,
    place: usize,
    mean: f64,
    log_deviation: f64,
}

/// The lognormal scalars of a block of correlated ones. Products are told by the power of every scalar.
pub(super) struct Lognormals<'a> {
    scalars: Vec<Lognormal>,
    correlation: &'a Correlation,
}

impl<'a> Lognormals<'a> {
    pub(super) fn new(laws: &[&ScalarLaw], block: &[usize], correlation: &'a Correlation) -> Self {
        let scalars = block.iter().enumerate().filter_map(|(place, &scalar)| {
            let [mean, log_deviation] = laws[scalar].as_lognormal()?;
            Some(Lognormal { scalar, place, mean, log_deviation })
        });
        Self { scalars: scalars.collect(), correlation }
    }

    /// How many scalars are lognormal.
    pub(super) fn count(&self) -> usize {
        self.scalars.len()
    }

    /// The covariance of the logarithms of two products.
    pub(super) fn ln_covariance(&self, f: &[i32], g: &[i32]) -> f64 {
        let each =
            |powers: &[i32], own: &Lognormal| f64::from(powers[own.scalar]) * own.log_deviation;
        let pairs = self.scalars.iter().flat_map(|a| self.scalars.iter().map(move |b| (a, b)));
        pairs
            .filter(|(a, b)| f[a.scalar] != 0 && g[b.scalar] != 0)
            .map(|(a, b)| {
                each(f, a) * each(g, b) * self.correlation.coefficient(a.scalar, b.scalar)
            })
            .sum()
    }

    /// The expectation of a product: ∏ m^p exp(½ (Var ln ∏ x^p − Σ p s²)).
    pub(super) fn mean(&self, powers: &[i32]) -> f64 {
        let (means, squares) = self.scalars.iter().fold((1.0, 0.0), |(means, squares), own| {
            let power = powers[own.scalar];
            let square = f64::from(power) * (own.log_deviation * own.log_deviation);
            (means * own.mean.powi(power), squares + square)
        });
        means * libm::exp(0.5 * (self.ln_covariance(powers, powers) - squares))
    }

    /// A product at the values of the block.
    pub(super) fn product(&self, powers: &[i32], values: &[f64]) -> f64 {
        self.scalars.iter().map(|own| values[own.place].powi(powers[own.scalar])).product()
    }
}
