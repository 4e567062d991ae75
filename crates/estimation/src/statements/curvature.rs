//! The part of the curvature of a sum of squares that the curvature of the residuals adds, Σ r ∇²r, estimated from the steps of a search.

use nalgebra::{DMatrix, DVector};

/// Where products of two steps are rounding.
const ROUNDING: f64 = 1e-12;

/// The estimate (Dennis, Gay & Welsch 1981, doi:10.1145/355958.355965, Section 3). Gauss and Newton leave this part out, and large residuals are then brought
/// down slowly, if at all.
pub(super) struct Curvature {
    matrix: DMatrix<f64>,
    last: Option<Place>,
}

/// A point on the way: the unknowns there, the slopes of the residuals, and half the slope of the sum.
struct Place {
    values: DVector<f64>,
    slopes: DMatrix<f64>,
    slope: DVector<f64>,
}

impl Curvature {
    pub(super) fn new(unknowns: usize) -> Self {
        Self { matrix: DMatrix::zeros(unknowns, unknowns), last: None }
    }

    pub(super) fn has_learned(&self) -> bool {
        self.matrix.amax() != 0.0
    }

    pub(super) fn forget(&mut self) {
        *self = Self::new(self.matrix.nrows());
    }

    /// The estimate at the next point on the way, where the residuals and their slopes are these.
    pub(super) fn at(
        &mut self,
        values: &DVector<f64>,
        slopes: &DMatrix<f64>,
        residuals: &DVector<f64>,
    ) -> &DMatrix<f64> {
        let slope = slopes.tr_mul(residuals);
        if let Some(last) = &self.last {
            let step = values - &last.values;
            let change = &slope - &last.slope;
            let of_residuals = &slope - last.slopes.tr_mul(residuals);
            self.learn(&step, &change, &of_residuals);
        }
        self.last = Some(Place { values: values.clone(), slopes: slopes.clone(), slope });
        &self.matrix
    }

    /// Along the step, the matrix now changes the slope as the residuals did (their Equations 3.2 and 3.3).
    fn learn(&mut self, step: &DVector<f64>, change: &DVector<f64>, of_residuals: &DVector<f64>) {
        let along = change.dot(step);
        if along.abs() <= ROUNDING * change.norm() * step.norm() {
            return;
        }
        // Where residuals shrink, what was learned of them shrinks too.
        let own = step.dot(&(&self.matrix * step));
        if own != 0.0 {
            self.matrix *= (step.dot(of_residuals) / own).abs().min(1.0);
        }
        let miss = of_residuals - &self.matrix * step;
        let both = &miss * change.transpose() / along;
        let twice = change * change.transpose() * (miss.dot(step) / along / along);
        self.matrix += &both + both.transpose() - twice;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The matrix is symmetric, and does to the last step what the residuals did.
        #[test]
        fn the_last_step_is_kept(numbers in prop::collection::vec(-1.0..1.0f64, 4 * (3 + 15 + 5))) {
            let mut curvature = Curvature::new(3);
            let mut last: Option<(DVector<f64>, DMatrix<f64>, DVector<f64>)> = None;
            for part in numbers.chunks(23) {
                let values = DVector::from_row_slice(&part[..3]);
                let slopes = DMatrix::from_row_slice(5, 3, &part[3..18]);
                let residuals = DVector::from_row_slice(&part[18..]);
                let found = curvature.at(&values, &slopes, &residuals).clone();
                prop_assert!((&found - found.transpose()).amax() <= 1e-9 * found.amax());
                if let Some((values_before, slopes_before, residuals_before)) = &last {
                    let step = &values - values_before;
                    let change = slopes.tr_mul(&residuals) - slopes_before.tr_mul(residuals_before);
                    let asked = (&slopes - slopes_before).tr_mul(&residuals);
                    // Where the step hardly changes the slope along itself, digits are lost.
                    if change.dot(&step).abs() > 1e-3 {
                        prop_assert!((found.clone() * step - asked).amax() < 1e-9 * (1.0 + found.amax()));
                    }
                }
                last = Some((values, slopes, residuals));
            }
        }
    }
}
