//! Means and covariances of several statistics of a run, pushed run by run.

/// Means and sums of products of deviations of `K` statistics (West 1979, doi:10.1145/359146.359153).
#[derive(Clone, Debug)]
pub(super) struct Joint<const K: usize> {
    n: u64,
    mean: [f64; K],
    /// On and below the diagonal.
    products: [[f64; K]; K],
}

impl<const K: usize> Joint<K> {
    pub(super) fn new() -> Self {
        Self { n: 0, mean: [0.0; K], products: [[0.0; K]; K] }
    }

    pub(super) fn add(&mut self, x: &[f64; K]) {
        self.n += 1;
        let n = self.n as f64;
        let mut deviation = *x;
        for (deviation, mean) in deviation.iter_mut().zip(&mut self.mean) {
            *deviation -= *mean;
            *mean += *deviation / n;
        }
        let weight = (n - 1.0) / n;
        for (i, row) in self.products.iter_mut().enumerate() {
            for (product, other) in row.iter_mut().zip(&deviation[..=i]) {
                *product += deviation[i] * other * weight;
            }
        }
    }

    /// As if each statistic had been multiplied by its factor before it was pushed.
    pub(super) fn rescale(&mut self, factors: &[f64; K]) {
        for (i, row) in self.products.iter_mut().enumerate() {
            self.mean[i] *= factors[i];
            for (product, factor) in row.iter_mut().zip(factors) {
                *product *= factors[i] * factor;
            }
        }
    }

    pub(super) fn n(&self) -> u64 {
        self.n
    }

    pub(super) fn mean(&self) -> &[f64; K] {
        &self.mean
    }

    /// The covariance of two linear forms of the means.
    pub(super) fn covariance(&self, left: &[f64; K], right: &[f64; K]) -> f64 {
        let n = self.n as f64;
        let mut sum = 0.0;
        for (i, row) in self.products.iter().enumerate() {
            sum += left[i] * right[i] * row[i];
            for (j, product) in row.iter().enumerate().take(i) {
                sum += (left[i] * right[j] + left[j] * right[i]) * product;
            }
        }
        sum / (n - 1.0) / n
    }
}
