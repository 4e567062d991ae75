//! The covariance of plates and rods that comes nearest to stated deviations, whose correlations nobody stated.

use super::symmetric::{Matrix6, Six, with_eigenvalues};

/// Steps of the search, at most, and the share of the whole that the last of them moves.
const STEPS: usize = 1500;
const STILL: f64 = 1e-6;
/// Deviations smaller than this share of the largest weigh no more than it: a small one, or one that is stated to be none, is no
/// reason to miss the largest.
pub(super) const FLOOR: f64 = 0.25;

/// The positive semidefinite C of six coordinates that minimises Σₑ ((lₑᵀ C lₑ − σₑ²)/sₑ²)², where lₑ are the rows of
/// `map` and sₑ is σₑ or a quarter of the largest: projected gradient steps with momentum (Nesterov).
pub(super) fn nearest_covariance(map: &Matrix6, deviations: &[f64; 6]) -> Matrix6 {
    let largest = deviations.iter().copied().fold(0.0, f64::max);
    if !(largest > 0.0) {
        return Matrix6::zeros();
    }
    let weights = deviations.map(|sigma| 1.0 / sigma.max(FLOOR * largest));
    let rows: [Six; 6] = std::array::from_fn(|e| map.row(e).transpose() * weights[e]);
    let targets: [f64; 6] = std::array::from_fn(|e| (deviations[e] * weights[e]).powi(2));
    let curvature: f64 = 2.0 * rows.iter().map(|l| l.norm_squared().powi(2)).sum::<f64>();
    if !(curvature > 0.0 && curvature.is_finite()) {
        return Matrix6::zeros();
    }
    let (mut found, mut before) = (Matrix6::zeros(), Matrix6::zeros());
    for step in 0..STEPS {
        let ahead = found + (found - before) * (step as f64 / (step as f64 + 3.0));
        let mut gradient = Matrix6::zeros();
        for (l, target) in rows.iter().zip(targets) {
            gradient += l * l.transpose() * (2.0 * (l.dot(&(ahead * l)) - target));
        }
        before = found;
        found = with_eigenvalues(&(ahead - gradient / curvature), |x| x.max(0.0));
        if (found - before).amax() <= STILL * found.amax() {
            break;
        }
    }
    found
}
