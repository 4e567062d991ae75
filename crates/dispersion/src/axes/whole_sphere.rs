//! Quadrature over the angles of the whole sphere, kept to the half around the mean of a radially constrained Gaussian: for
//! laws of which a thin ridge escapes the cubature over the half.

use gyradius_attitude::{AngularQuadrature, RadiallyConstrainedGaussian};
use nalgebra::UnitQuaternion;

use crate::entry_moments::Expectation;

/// A quadrature of one law with a weight, which is zero in the far half.
pub(super) struct WholeSphere<'a, W> {
    law: &'a RadiallyConstrainedGaussian,
    quadrature: AngularQuadrature,
    weight: W,
}

impl<'a, W: Fn(&[f64; 4]) -> f64> WholeSphere<'a, W> {
    pub(super) fn new(law: &'a RadiallyConstrainedGaussian, weight: W) -> Self {
        Self { law, quadrature: law.by_quadrature(), weight }
    }

    fn weight_of(&self, q: &UnitQuaternion<f64>) -> f64 {
        if self.law.in_mean_half(q) { (self.weight)(&q.coords.into()) } else { 0.0 }
    }

    /// The mean of the weight under the law.
    pub(super) fn mean_of_weight(&self) -> f64 {
        let [mean] = self.quadrature.expect(|q| [self.weight_of(q)]);
        mean
    }
}

impl<W: Fn(&[f64; 4]) -> f64> Expectation for WholeSphere<'_, W> {
    fn expect<const N: usize>(
        &self,
        mut functions: impl FnMut(&UnitQuaternion<f64>) -> [f64; N],
    ) -> [f64; N] {
        let mean = self.mean_of_weight();
        let sums = self.quadrature.expect(|q| {
            let weight = self.weight_of(q);
            functions(q).map(|x| x * weight)
        });
        sums.map(|x| x / mean)
    }
}
