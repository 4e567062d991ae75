//! The density of a Wishart law, however many degrees of freedom it has.

use nalgebra::Matrix3;
use std::f64::consts::LN_2;

use crate::ln_sum::ln_product;
use crate::normal::LN_ROOT_TAU;

/// From this half of the degrees of freedom on, Stirling's series with three terms is exact to rounding.
const MANY: f64 = 1e4;
/// ln π.
const LN_PI: f64 = 1.144_729_885_849_400_2;
/// Changes up to which invariants of the change give the determinant with all its digits.
const SMALL: f64 = 0.05;

/// The density of I where Σ = Mᵀ G M and p G is Wishart's with p degrees of freedom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Density {
    /// a = p/2.
    half_freedom: f64,
    /// W = M⁻ᵀ, so that G − 1 = W (Σ − Σ̄) Wᵀ.
    whiten: Matrix3<f64>,
    /// ln of the density of I where G = 1.
    ln_peak: f64,
}

impl Density {
    /// From p, the roots of the mean's second moments, and the rotation from body to principal components; none if a
    /// second moment is zero.
    pub(super) fn new(freedom: f64, roots: [f64; 3], turn: &Matrix3<f64>) -> Option<Self> {
        if roots.contains(&0.0) {
            return None;
        }
        let half_freedom = 0.5 * freedom;
        let whiten = Matrix3::from_diagonal(&roots.map(|k| 1.0 / k).into()) * turn;
        // dΣ = |M|⁴ dG, and dI = 2 dΣ.
        let ln_volume = LN_2 + 4.0 * roots.map(libm::log).iter().sum::<f64>();
        Some(Self { half_freedom, whiten, ln_peak: ln_peak(half_freedom) - ln_volume })
    }

    /// ln of the density of I from Σ − Σ̄, of a body: with e = G − 1, ln|G|^{a − 2} e^{−a tr e} over its value at e = 0.
    pub(super) fn ln_at(&self, change: &Matrix3<f64>) -> f64 {
        let e = self.whiten * change * self.whiten.transpose();
        let trace = e.trace();
        if !trace.is_finite() {
            // So far out that it overflows.
            return f64::NEG_INFINITY;
        }
        let (ln_determinant, excess) = if e.amax() < SMALL {
            // |1 + e| = 1 + tr e + second invariant + |e|. The small excess ln|G| − tr e is multiplied by p/2, which may
            // be 1e14, and not to be found as a difference.
            let second = e[(0, 0)] * e[(1, 1)] + e[(1, 1)] * e[(2, 2)] + e[(2, 2)] * e[(0, 0)]
                - e[(0, 1)] * e[(0, 1)]
                - e[(1, 2)] * e[(1, 2)]
                - e[(0, 2)] * e[(0, 2)];
            let rest = second + e.determinant();
            let gap = trace + rest;
            let ln = libm::log1p(gap);
            (ln, (ln - gap) + rest)
        } else {
            let Some(factor) = (Matrix3::identity() + e).cholesky() else {
                // At the boundary, or over it by rounding: ln|G| is −∞.
                let power = self.half_freedom - 2.0;
                let ln_determinant = if power == 0.0 { 0.0 } else { power * f64::NEG_INFINITY };
                return self.ln_peak - self.half_freedom * trace + ln_determinant;
            };
            let diagonal = factor.l_dirty().diagonal();
            let ln = 2.0 * ln_product(diagonal.as_slice());
            (ln, ln - trace)
        };
        self.ln_peak + self.half_freedom * excess - 2.0 * ln_determinant
    }
}

/// ln of the density of G at 1: 3a ln a − 3a − ln Γ₃(a), Γ₃(a) = π^{3/2} Γ(a) Γ(a − ½) Γ(a − 1).
fn ln_peak(a: f64) -> f64 {
    if a < MANY {
        let gammas = libm::lgamma(a) + libm::lgamma(a - 0.5) + libm::lgamma(a - 1.0);
        3.0 * a * (libm::log(a) - 1.0) - 1.5 * LN_PI - gammas
    } else {
        let series = (13.0 / 8.0 + 5.0 / 8.0 / a) / a;
        3.0 * libm::log(a) - 1.5 * LN_PI - 3.0 * LN_ROOT_TAU - series
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By mpmath 1.3, 60 digits: 3a ln a − 3a − ln Γ₃(a).
    #[test]
    fn peaks_agree_with_mpmath() {
        for (a, expected) in REFERENCE {
            let found = ln_peak(a);
            assert!((found - expected).abs() < 1e-10, "{a:e}: {found:?} {expected:?}");
        }
    }

    const REFERENCE: [(f64, f64); 8] = [
        (1.0001, -14.499488375659757),
        (1.5, -4.8440845475768155),
        (2.0, -3.437429507779183),
        (8.0, 1.5507253617077137),
        (200.0, 11.41290099960495),
        (9999.0, 23.156648150036183),
        (12345.5, 23.78909865016248),
        (200000000000000.0, 94.31410501904163),
    ];

    /// What is small and what is not: both ways to the determinant.
    #[test]
    fn both_ways_agree() {
        let density = Density::new(7.0, [1.0, 2.0, 0.5], &Matrix3::identity()).unwrap();
        let at = |size: f64| {
            let e = Matrix3::new(1.0, 0.2, -0.3, 0.2, -0.7, 0.1, -0.3, 0.1, 0.4) * size;
            let scale = Matrix3::from_diagonal(&[1.0, 2.0, 0.5].into());
            density.ln_at(&(scale * e * scale))
        };
        // ln_at is smooth: the third difference across the seam is of the third order.
        let h = 1e-4;
        let [a, b, c, d] = [-1.5, -0.5, 0.5, 1.5].map(|i| at(SMALL + i * h));
        assert!((d - 3.0 * c + 3.0 * b - a).abs() < 1e-9);
    }
}
