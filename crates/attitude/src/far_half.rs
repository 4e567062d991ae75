//! How much of a radially constrained Gaussian lies in the half sphere away from its mean.
//!
//! On the slice x·m = ℓ = cos η, a sphere S² of radius r = sin η, the exponent is a quadratic function
//! of three coordinates s across m: −½κ(1 − ℓ)² − ½(s − s*)ᵀA(s − s*), with κ = 1/(mᵀΣm),
//! A = UᵀΣ⁻¹U for an orthonormal basis U of the coordinates and s* = −(1 − ℓ)κ UᵀΣm. Its integral is
//! the contour integral of [`Contour`] in three dimensions, so that the share is an integral over η
//! alone of positive values: nothing cancels, however small it is.

use nalgebra::{Matrix3, Matrix4x3, Vector3, Vector4};
use std::f64::consts::{FRAC_PI_2, PI};

use crate::{contour::Contour, fisher_bingham::centring_shift, jacobi, quadrature::kronrod};

const TOLERANCE: f64 = 1e-12;
const MAX_ARCS: usize = 200;
/// What is smaller than the peak by e^−60 adds nothing.
const NOTHING: f64 = 60.0;
/// ln 4π.
const LN_SPHERE: f64 = 2.531_024_246_969_290_8;

/// ln ∫ exp(−½ Σ λ(y − c)²) dS over the half y·c < 0 of S³, |c| = 1.
pub(crate) fn ln_integral(lambda: [f64; 4], centre: [f64; 4]) -> f64 {
    let slices = Slices::new(lambda, centre);
    let (peak, ln_peak, width) = slices.peak();
    // Arcs that grow with their distance from the peak.
    let mut ends = vec![FRAC_PI_2, PI, peak];
    let mut step = 2.0 * width;
    while step < FRAC_PI_2 {
        ends.extend([peak - step, peak + step].iter().filter(|e| **e > FRAC_PI_2 && **e < PI));
        step *= 3.0;
    }
    // Towards −m the slices shrink, and the density changes where they reach a deviation.
    for eigenvalue in slices.eigenvalues {
        let mut step = 1.0 / eigenvalue.sqrt();
        while step < FRAC_PI_2 {
            ends.push(PI - step);
            step *= 4.0;
        }
    }
    ends.sort_by(f64::total_cmp);
    ends.dedup();
    let integrate = |low: f64, high: f64| {
        let (mut fine, mut coarse) = (0.0, 0.0);
        for (eta, f, c) in kronrod(low, high) {
            let value = libm::exp(slices.ln_density(eta, ln_peak - NOTHING) - ln_peak);
            fine += f * value;
            coarse += c * value;
        }
        (fine, (fine - coarse).abs(), low, high)
    };
    let mut arcs: Vec<_> = ends.windows(2).map(|e| integrate(e[0], e[1])).collect();
    while arcs.len() < MAX_ARCS {
        let total: f64 = arcs.iter().map(|a| a.0).sum();
        let error: f64 = arcs.iter().map(|a| a.1).sum();
        // The difference of the two rules is far above the error of the better one.
        if error <= TOLERANCE.sqrt() * 1e-2 * total {
            break;
        }
        let worst = (0..arcs.len()).max_by(|&i, &j| arcs[i].1.total_cmp(&arcs[j].1)).unwrap_or(0);
        let (_, _, low, high) = arcs[worst];
        let middle = 0.5 * (low + high);
        arcs[worst] = integrate(low, middle);
        arcs.push(integrate(middle, high));
    }
    ln_peak + libm::log(arcs.iter().map(|a| a.0).sum())
}

struct Slices {
    kappa: f64,
    /// Eigenvalues of A, and s* / (ℓ − 1) in its eigenbasis.
    eigenvalues: [f64; 3],
    drift: Vector3<f64>,
}

impl Slices {
    fn new(lambda: [f64; 4], centre: [f64; 4]) -> Self {
        let mut order = [0, 1, 2, 3];
        order.sort_by(|&i, &j| lambda[i].total_cmp(&lambda[j]));
        let lambda = Vector4::from(order.map(|j| lambda[j]));
        let centre = Vector4::from(order.map(|j| centre[j]));
        let u = across(&centre);
        // Each column of U reaches one stiffer coordinate than the one before it, so that A is graded
        // and its small eigenvalues keep their digits.
        let a: Matrix3<f64> =
            Matrix3::from_fn(|i, j| (0..4).map(|k| u[(k, i)] * lambda[k] * u[(k, j)]).sum::<f64>());
        let (eigenvalues, axes) = jacobi::eigen(&a);
        let spread = centre.component_div(&lambda);
        let kappa = 1.0 / centre.dot(&spread);
        let drift = axes.tr_mul(&u.tr_mul(&spread)) * kappa;
        Self { kappa, eigenvalues, drift }
    }

    /// ln of the density of η, not normalised; −∞ where it is surely below `least`.
    fn ln_density(&self, eta: f64, least: f64) -> f64 {
        let (r, l) = libm::sincos(eta);
        if r < 1e-12 {
            // Not some large negative number: narrow laws have −1e12 elsewhere.
            return f64::NEG_INFINITY;
        }
        let off = 1.0 - l;
        let lambda = self.eigenvalues.map(|a| a * r * r);
        let centre: [f64; 3] = (self.drift * (-off / r)).into();
        let square = centre.iter().map(|c| c * c).sum::<f64>();
        // No point of the slice is nearer to s* than this.
        let gap = (square.sqrt() - 1.0).max(0.0);
        let stiffness = lambda.into_iter().fold(f64::INFINITY, f64::min);
        let radial = -0.5 * self.kappa * off * off;
        if radial - 0.5 * stiffness * gap * gap + LN_SPHERE < least {
            return f64::NEG_INFINITY;
        }
        let slice = if square < 4.0 {
            Contour::<3>::new(lambda, centre, 1.0 - square).ln_integral()
        } else {
            // The same linear term with a centre on the slice, which is what the contour is made for.
            let b: [f64; 3] = std::array::from_fn(|j| lambda[j] * centre[j]);
            let shift = centring_shift(lambda, b);
            let stiffer = lambda.map(|l| l + shift);
            let on: [f64; 3] = std::array::from_fn(|j| b[j] / stiffer[j]);
            let slack = 1.0 - on.iter().map(|c| c * c).sum::<f64>();
            let product: f64 = (0..3).map(|j| centre[j] * on[j]).sum();
            Contour::<3>::new(stiffer, on, slack).ln_integral() + 0.5 * shift * (1.0 - product)
        };
        slice + 2.0 * libm::log(r) + radial
    }

    /// Where the density of η is largest in the far half, its logarithm there, and how far it is to
    /// where that has fallen by one half.
    fn peak(&self) -> (f64, f64, f64) {
        const POINTS: i32 = 64;
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let at = |i: i32| FRAC_PI_2 * (1.0 + f64::from(i) / f64::from(POINTS));
        let coarse = (0..=POINTS).map(|i| (i, self.ln_density(at(i), f64::MIN)));
        let (best, _) = coarse.fold((0, f64::MIN), |b, v| if v.1 > b.1 { v } else { b });
        let (mut low, mut high) = (at((best - 1).max(0)), at((best + 1).min(POINTS)));
        while high - low > 1e-7 {
            let (a, b) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
            if self.ln_density(a, f64::MIN) > self.ln_density(b, f64::MIN) {
                high = b
            } else {
                low = a
            }
        }
        let candidates =
            [low, 0.5 * (low + high), at(best)].map(|x| (x, self.ln_density(x, f64::MIN)));
        let (peak, top) =
            candidates.into_iter().fold((low, f64::MIN), |b, v| if v.1 > b.1 { v } else { b });
        let mut width = 1e-7;
        let fallen =
            |x: f64| x <= FRAC_PI_2 || x >= PI || !(self.ln_density(x, top - 1.0) >= top - 0.5);
        while width < 1.0 && !(fallen(peak - width) && fallen(peak + width)) {
            width *= 2.0;
        }
        (peak, top, width)
    }
}

/// Three orthonormal columns across a unit vector, column k with zeros after its entry k + 1.
fn across(c: &Vector4<f64>) -> Matrix4x3<f64> {
    let mut u = Matrix4x3::zeros();
    let mut along = Vector4::new(1.0, 0.0, 0.0, 0.0);
    let mut length = c[0];
    for k in 0..3 {
        // The plane of what came before and the next axis.
        let next = libm::hypot(length, c[k + 1]);
        let (sin, cos) = if next > 0.0 { (length / next, c[k + 1] / next) } else { (0.0, 1.0) };
        let mut column = along * cos;
        column[k + 1] = -sin;
        u.set_column(k, &column);
        along *= sin;
        along[k + 1] = cos;
        length = next;
    }
    u
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Narrow laws, whose far half is e^−1e12 of them: the pole at −m is no peak.
    #[test]
    fn narrow_laws_have_no_far_half() {
        for exponent in 1..=14 {
            let lambda = 10f64.powi(exponent);
            for centre in [[0.0, 0.0, 0.0, 1.0], [0.5; 4], [0.6, 0.0, -0.8, 0.0]] {
                let whole = Contour::new([lambda; 4], centre, 0.0).ln_integral();
                let share = (ln_integral([lambda; 4], centre) - whole).exp();
                // Half of the area is at least √2 away.
                assert!(share <= (-0.9 * lambda).exp(), "{lambda:e} {centre:?}: {share:e}");
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        /// Bingham's law has one half of itself on either side, however bimodal.
        #[test]
        fn half_of_binghams_law_is_far(e in prop::array::uniform3(-6.0..8.0f64), k in 0..4_usize) {
            let mut lambda = [1e-14; 4];
            for j in 0..3 {
                lambda[(k + 1 + j) % 4] = 10f64.powf(e[j]);
            }
            let mut centre = [0.0; 4];
            centre[k] = 1.0;
            let share = (ln_integral(lambda, centre) - Contour::new(lambda, centre, 0.0).ln_integral()).exp();
            prop_assert!((share - 0.5).abs() < 1e-11, "{lambda:?}: {share}");
        }
    }

    proptest! {
        #[test]
        fn columns_are_orthonormal_and_across(c in prop::array::uniform4(-1.0..1.0f64), zeros in 0..16_usize) {
            let mut c = Vector4::from(c);
            for j in (0..4).filter(|j| zeros >> j & 1 == 1) {
                c[j] = 0.0;
            }
            prop_assume!(c.norm() > 0.1);
            let u = across(&c.normalize());
            prop_assert!((u.tr_mul(&u) - Matrix3::identity()).amax() < 1e-15);
            prop_assert!(u.tr_mul(&c).amax() < 1e-15);
        }
    }
}
