use nalgebra::{SMatrix, SVector};

/// Unknowns: variances of three second moments and of three turns.
pub(super) const UNKNOWNS: usize = 6;

/// The x ≥ 0 that minimises |Ax − b|².
///
/// # Algorithm
/// Of the 64 sets of unknowns that may be above zero, each is solved by normal equations, and the best
/// of those with no negative solution is taken: exact, and short for six unknowns. A set whose
/// columns depend on each other is passed over, for a smaller one does as well.
pub(super) fn least_squares<const ROWS: usize>(
    a: &SMatrix<f64, ROWS, UNKNOWNS>,
    b: &SVector<f64, ROWS>,
) -> SVector<f64, UNKNOWNS> {
    let mut best = SVector::zeros();
    let mut least = b.norm_squared();
    for set in 1_u32..1 << UNKNOWNS {
        let chosen: Vec<usize> = (0..UNKNOWNS).filter(|i| set & (1 << i) != 0).collect();
        let columns = a.select_columns(&chosen);
        // Each column in its own unit, so that "depends" does not depend on the units.
        let sizes: Vec<f64> = columns.column_iter().map(|c| c.norm()).collect();
        if sizes.iter().any(|s| !(*s > 0.0)) {
            continue;
        }
        let mut scaled = columns;
        for (mut column, size) in scaled.column_iter_mut().zip(&sizes) {
            column /= *size;
        }
        let normal = scaled.transpose() * &scaled;
        if !(normal.determinant() > 1e-12) {
            continue;
        }
        let Some(solver) = normal.cholesky() else { continue };
        let solution = solver.solve(&(scaled.transpose() * b));
        let rest = (&scaled * &solution - b).norm_squared();
        if solution.iter().all(|x| *x >= 0.0) && rest < least * (1.0 - 1e-9) {
            least = rest;
            best = SVector::zeros();
            for ((i, x), size) in chosen.iter().zip(solution.iter()).zip(&sizes) {
                best[*i] = x / size;
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Karush-Kuhn-Tucker: no step into the allowed region goes down.
        #[test]
        fn nothing_allowed_is_better(
            a in prop::array::uniform6(prop::array::uniform6(-1.0..1.0f64)),
            b in prop::array::uniform6(-1.0..1.0f64),
        ) {
            let a = SMatrix::<f64, 6, 6>::from_fn(|i, j| a[i][j]);
            let b = SVector::<f64, 6>::from(b);
            prop_assume!(a.determinant().abs() > 1e-2);
            let x = least_squares(&a, &b);
            let slope = a.transpose() * (a * x - b);
            for i in 0..6 {
                prop_assert!(x[i] >= 0.0);
                prop_assert!(slope[i] > -1e-6, "{x} {slope}");
                prop_assert!(x[i] == 0.0 || slope[i].abs() < 1e-6, "{x} {slope}");
            }
        }
    }

    #[test]
    fn columns_of_nothing_stay_zero() {
        let mut a = SMatrix::<f64, 6, 6>::identity();
        a[(2, 2)] = 0.0;
        let x = least_squares(&a, &SVector::from([1.0, -1.0, 1.0, 2.0, 0.0, 3.0]));
        assert_eq!(x, SVector::from([1.0, 0.0, 0.0, 2.0, 0.0, 3.0]));
    }
}
