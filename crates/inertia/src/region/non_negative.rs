//! Weights that are not negative and make a sum as nearly as any do.

use nalgebra::{DMatrix, DVector, SVector};

/// How many columns are taken in at most, many times what a sum of ten needs.
const MOST: usize = 200;

/// Minimises ‖Σ_j w_j a_j − b‖ over w ≥ 0 and gives what remains of b: the active set of Lawson and Hanson (1974,
/// *Solving Least Squares Problems*, chapter 23). No more columns than rows are ever in use. But for rounding no column has a
/// component along what remains, so that it is the normal of a plane between the columns and b.
pub(super) fn rest<const N: usize>(
    columns: &[SVector<f64, N>],
    b: &SVector<f64, N>,
) -> SVector<f64, N> {
    let mut used: Vec<usize> = Vec::new();
    let mut weights: Vec<f64> = Vec::new();
    let mut rest = *b;
    for _ in 0..MOST {
        let size = b.norm();
        let gain = |j: usize| columns[j].dot(&rest);
        let outside = (0..columns.len()).filter(|j| !used.contains(j));
        let Some(best) = outside.max_by(|&i, &j| gain(i).total_cmp(&gain(j))) else { break };
        if rest.norm() <= 1e-14 * size || !(gain(best) > 1e-14 * size * columns[best].norm()) {
            break;
        }
        used.push(best);
        weights.push(0.0);
        // Steps back to the boundary, each of which drops a column, until all weights are positive.
        while let Some(found) = least_squares(columns, &used, b) {
            let blocking = (0..used.len())
                .filter(|&i| found[i] <= 0.0)
                .map(|i| (weights[i] / (weights[i] - found[i]), i))
                .min_by(|a, b| a.0.total_cmp(&b.0));
            let Some((step, first)) = blocking else {
                weights = found.iter().copied().collect();
                break;
            };
            let step = if step.is_finite() { step } else { 0.0 };
            for (weight, to) in weights.iter_mut().zip(found.iter()) {
                *weight += step * (to - *weight);
            }
            weights[first] = 0.0;
            let kept = |i: &usize| weights[*i] > 0.0;
            let stay: Vec<usize> = (0..used.len()).filter(kept).collect();
            used = stay.iter().map(|&i| used[i]).collect();
            weights = stay.iter().map(|&i| weights[i]).collect();
        }
        let made = used.iter().zip(&weights).map(|(&j, w)| columns[j] * *w);
        let left = b - made.sum::<SVector<f64, N>>();
        // No progress but rounding.
        if !(left.norm() < rest.norm()) {
            return if left.norm() <= rest.norm() { left } else { rest };
        }
        rest = left;
    }
    rest
}

/// The weights of the columns in use, of any sign.
fn least_squares<const N: usize>(
    columns: &[SVector<f64, N>],
    used: &[usize],
    b: &SVector<f64, N>,
) -> Option<DVector<f64>> {
    if used.is_empty() {
        return None;
    }
    let matrix = DMatrix::from_fn(N, used.len(), |i, j| columns[used[j]][i]);
    matrix.svd(true, true).solve(b, 1e-13).ok().map(|x| DVector::from_column_slice(x.as_slice()))
}
