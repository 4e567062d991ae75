//! Weights that are not negative and make a sum as nearly as any do.

use nalgebra::{SMatrix, SVector};

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
    let (mut rest, size) = (*b, b.norm());
    for _ in 0..MOST {
        let outside = columns.iter().enumerate().filter(|(j, _)| !used.contains(j));
        let gains = outside.map(|(j, column)| (j, column.dot(&rest)));
        let Some((best, gain)) = gains.max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
        let is_made = rest.norm() <= 1e-14 * size || used.len() == N;
        if is_made || !(gain > 1e-14 * size * columns[best].norm()) {
            break;
        }
        used.push(best);
        weights.push(0.0);
        // Steps back to the boundary, each of which drops a column, until all weights are positive.
        while !used.is_empty() {
            let found = least_squares(columns, &used, b);
            let blocking = (0..used.len())
                .filter(|&i| found[i] <= 0.0)
                .map(|i| (weights[i] / (weights[i] - found[i]), i))
                .min_by(|a, b| a.0.total_cmp(&b.0));
            let Some((step, first)) = blocking else {
                weights.copy_from_slice(&found.as_slice()[..used.len()]);
                break;
            };
            let step = if step.is_finite() { step } else { 0.0 };
            for (weight, to) in weights.iter_mut().zip(found.iter()) {
                *weight += step * (to - *weight);
            }
            weights[first] = 0.0;
            let mut kept = weights.iter().map(|weight| *weight > 0.0);
            used.retain(|_| kept.next().unwrap_or(false));
            weights.retain(|weight| *weight > 0.0);
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

/// The weights of the columns in use, of any sign, by the factors Q R that Gram and Schmidt find. Made orthogonal twice, they
/// are so to rounding (Giraud, Langou, Rozložník and van den Eshof 2005, doi 10.1007/s00211-005-0615-4). A column that the
/// ones before it make has no weight. There are no more columns than rows.
fn least_squares<const N: usize>(
    columns: &[SVector<f64, N>],
    used: &[usize],
    b: &SVector<f64, N>,
) -> SVector<f64, N> {
    let (mut q, mut r) = (SMatrix::<f64, N, N>::zeros(), SMatrix::<f64, N, N>::zeros());
    for (k, &j) in used.iter().enumerate() {
        let mut rest = columns[j];
        for _ in 0..2 {
            for i in 0..k {
                let along = q.column(i).dot(&rest);
                r[(i, k)] += along;
                rest -= q.column(i) * along;
            }
        }
        let left = rest.norm();
        if left > 1e-13 * columns[j].norm() {
            r[(k, k)] = left;
            q.set_column(k, &(rest / left));
        }
    }
    let mut weights = SVector::<f64, N>::zeros();
    for k in (0..used.len()).rev().filter(|&k| r[(k, k)] > 0.0) {
        let others: f64 = (k + 1..used.len()).map(|i| r[(k, i)] * weights[i]).sum();
        weights[k] = (q.column(k).dot(b) - others) / r[(k, k)];
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Columns of which some are others again or one bit apart, and weights of which some are zero.
    fn columns() -> impl Strategy<Value = (Vec<SVector<f64, 10>>, Vec<f64>)> {
        let column = proptest::array::uniform10(-1.0..1.0f64).prop_map(SVector::from);
        let copy = (any::<prop::sample::Index>(), any::<bool>(), 0..10usize);
        let weights = prop::collection::vec(prop_oneof![Just(0.0), 0.0..2.0], 40);
        let columns = prop::collection::vec(column, 1..24);
        (columns, prop::collection::vec(copy, 0..16), weights).prop_map(
            |(mut columns, copies, weights)| {
                for (index, is_apart, row) in copies {
                    let mut copy = *index.get(&columns);
                    copy[row] += if is_apart { 1e-15 } else { 0.0 };
                    columns.push(copy);
                }
                (columns, weights)
            },
        )
    }

    proptest! {
        /// What the columns make leaves nothing.
        #[test]
        fn what_is_made_leaves_nothing((columns, weights) in columns()) {
            let b: SVector<f64, 10> = columns.iter().zip(&weights).map(|(a, w)| a * *w).sum();
            prop_assert!(rest(&columns, &b).norm() <= 1e-12 * (1.0 + b.norm()));
        }

        /// Nothing nearer is made: what remains of anything has no component along a column, and none along what was made,
        /// so that the plane across it parts b from all that the columns make (Moreau 1962).
        #[test]
        fn what_remains_parts((columns, _) in columns(), b in proptest::array::uniform10(-1.0..1.0f64)) {
            let b = SVector::from(b);
            let rest = rest(&columns, &b);
            for column in &columns {
                prop_assert!(column.dot(&rest) <= 1e-12 * b.norm() * column.norm());
            }
            prop_assert!(((b - rest).dot(&rest)).abs() <= 1e-12 * b.norm_squared());
        }
    }
}
