//! From a density of second mass moments and one of attitudes to the density of the six entries.
//!
//! Σ = R(q)ᵀ diag(K) R(q) moves by dΣ = Π_{i<j} |K_i − K_j| dK dω, where dω is that of a small rotation vector, of
//! which all attitudes together hold 8π². Every Σ with three different eigenvalues comes of 24 pairs (K, q): the
//! axes named in six orders, and turned by π about none or one of them. I = tr(Σ)·1 − Σ moves by dI = 2 dΣ. So with
//! the density h of q with respect to Haar measure, normalised to one,
//!
//! ```text
//! p(I) = ½ Σ₂₄ p(K) h(q) / (8π² Π_{i<j} |K_i − K_j|).
//! ```

use gyradius_inertia::{Inertia, PrincipalAxes};
use nalgebra::{Quaternion, UnitQuaternion};
use std::f64::consts::{FRAC_1_SQRT_2, LN_2};

use crate::ln_sum::{NEGLIGIBLE, ln_sum};

/// ln 8π².
pub(crate) const LN_ATTITUDES: f64 = 4.368_901_313_378_636;

/// Scalar part first: what takes the axes to each of [`PrincipalAxes::ORDERS`].
const TO_ORDERS: [[f64; 4]; 6] = [
    [1.0, 0.0, 0.0, 0.0],
    [0.5, -0.5, -0.5, -0.5],
    [0.5, 0.5, 0.5, 0.5],
    [0.0, 0.0, FRAC_1_SQRT_2, -FRAC_1_SQRT_2],
    [0.0, FRAC_1_SQRT_2, 0.0, -FRAC_1_SQRT_2],
    [0.0, FRAC_1_SQRT_2, -FRAC_1_SQRT_2, 0.0],
];

/// The logarithm of the density of I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃ in kg·m², where the second moments K and the attitude
/// of the principal axes are independent: from ln of the density of K₁, K₂, K₃ with respect to dK₁ dK₂ dK₃, in each of
/// [`PrincipalAxes::ORDERS`] (see [`in_orders`]), and ln of the density of the attitude with respect to Haar measure
/// normalised to one.
///
/// Where two of the K are equal the density is infinite, if their law and that of the axes are not zero there: that is
/// a ridge without width, beside which the density is large and over which it can be integrated.
pub(crate) fn ln_density_of_entries(
    inertia: &Inertia,
    ln_densities_of_squares: impl FnOnce([f64; 3]) -> [f64; 6],
    ln_haar_density_of_axes: impl FnMut(&UnitQuaternion<f64>) -> f64,
) -> f64 {
    let unbounded = Bounded { density: ln_haar_density_of_axes, at_most: f64::INFINITY };
    ln_density_of_bounded(inertia, ln_densities_of_squares, unbounded)
}

/// ln of a density of attitudes, and what it never exceeds, so that labels that add nothing can be left out.
pub(crate) struct Bounded<F> {
    pub(crate) density: F,
    pub(crate) at_most: f64,
}

/// The same where ln of the density of the attitude is bounded.
pub(crate) fn ln_density_of_bounded(
    inertia: &Inertia,
    ln_densities_of_squares: impl FnOnce([f64; 3]) -> [f64; 6],
    ln_haar_density_of_axes: Bounded<impl FnMut(&UnitQuaternion<f64>) -> f64>,
) -> f64 {
    let axes = inertia.principal_axes();
    let squares = ln_densities_of_squares(axes.second_moments().map(|k| k.max(0.0)));
    ln_density_of_labels(&axes, squares, ln_haar_density_of_axes) - LN_2
}

/// What a function is of three values in each of [`PrincipalAxes::ORDERS`].
pub(crate) fn in_orders(values: [f64; 3], mut of: impl FnMut([f64; 3]) -> f64) -> [f64; 6] {
    PrincipalAxes::ORDERS.map(|(order, _)| of(order.map(|i| values[i])))
}

/// The same from the densities of the three values in each of [`PrincipalAxes::ORDERS`], with respect to the entries of
/// the matrix that has these values, be they second moments or principal moments.
pub(crate) fn ln_density_of_labels(
    axes: &PrincipalAxes,
    ln_in_orders: [f64; 6],
    mut ln_haar_density_of_axes: Bounded<impl FnMut(&UnitQuaternion<f64>) -> f64>,
) -> f64 {
    let q = axes.attitude();
    let mut terms = [f64::NEG_INFINITY; 24];
    // Where the values are likeliest first, which often leaves nothing to the other orders.
    let likeliest = (1..6).fold(0, |i, j| if ln_in_orders[j] > ln_in_orders[i] { j } else { i });
    let mut largest = f64::NEG_INFINITY;
    for place in 0..6 {
        let order = if place == 0 { likeliest } else { place - usize::from(place <= likeliest) };
        let (turn, ln_values) = (&TO_ORDERS[order], ln_in_orders[order]);
        let terms = &mut terms[4 * order..4 * order + 4];
        if !(ln_values > f64::NEG_INFINITY
            && ln_values + ln_haar_density_of_axes.at_most > largest + NEGLIGIBLE)
        {
            continue;
        }
        let [w, x, y, z] = *turn;
        let Quaternion { coords } = Quaternion::new(w, x, y, z) * q.into_inner();
        let (x, y, z, w) = (coords.x, coords.y, coords.z, coords.w);
        // Turned by π about no axis, and about each.
        let turned = [[w, x, y, z], [-x, w, -z, y], [-y, z, w, -x], [-z, -y, x, w]];
        for (term, [w, x, y, z]) in terms.iter_mut().zip(turned) {
            let q = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
            let ln_axes = (ln_haar_density_of_axes.density)(&q);
            if ln_axes > f64::NEG_INFINITY {
                *term = ln_values + ln_axes;
                largest = largest.max(*term);
            }
        }
    }
    let sum = ln_sum(&terms);
    // Nothing over nothing is nothing: no draw comes near.
    if sum == f64::NEG_INFINITY { sum } else { sum - LN_ATTITUDES - ln_gaps(axes.moments()) }
}

/// ln Π_{i<j} |I_i − I_j|, which is that of the K too; −∞ where two are equal.
fn ln_gaps([a, b, c]: [f64; 3]) -> f64 {
    let size = a.abs().max(b.abs()).max(c.abs());
    if size == 0.0 {
        return f64::NEG_INFINITY;
    }
    // As shares, so that products stay in range.
    let gap = |x: f64, y: f64| ((x - y) / size).abs();
    libm::log(gap(a, b) * gap(b, c) * gap(c, a)) + 3.0 * libm::log(size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{PrincipalDispersion, ScalarLaw, ScalarRoots};
    use gyradius_attitude::{RadiallyConstrainedGaussian, UniformAttitude};
    use gyradius_inertia::{InertiaMatrix, SecondMoments};
    use nalgebra::{Matrix4, SMatrix, Vector3};
    use proptest::prelude::*;
    use rand::RngExt;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
    use rand_distr::Distribution;

    /// The labels are what they are said to be: each of the 24 pairs makes the same matrix, and no two are alike.
    #[test]
    fn every_label_makes_the_matrix() {
        let q = UnitQuaternion::from_euler_angles(0.4, -0.9, 2.0);
        let k = [1.0, 2.5, 4.0];
        let body = Inertia::from_second_moments(SecondMoments::new(k).unwrap(), &q).unwrap();
        let axes = body.principal_axes();
        let k = axes.second_moments();
        let mut attitudes = Vec::new();
        for (order, k) in in_orders_of(k).into_iter().enumerate() {
            let mut only = [f64::NEG_INFINITY; 6];
            only[order] = 0.0;
            let density = |q: &UnitQuaternion<f64>| {
                let again = Inertia::from_second_moments(SecondMoments::new(k).unwrap(), q);
                assert!((again.unwrap().matrix() - body.matrix()).amax() < 1e-13, "{order}");
                attitudes.push(*q);
                0.0
            };
            let _ = ln_density_of_labels(&axes, only, Bounded { density, at_most: 0.0 });
        }
        assert_eq!(attitudes.len(), 24);
        for (i, a) in attitudes.iter().enumerate() {
            assert!((a.norm() - 1.0).abs() < 1e-14);
            assert!(attitudes[..i].iter().all(|b| a.coords.dot(&b.coords).abs() < 0.99));
        }
    }

    fn in_orders_of(k: [f64; 3]) -> [[f64; 3]; 6] {
        let mut found = [k; 6];
        let mut next = 0;
        let _ = in_orders(k, |k| {
            found[next] = k;
            next += 1;
            0.0
        });
        found
    }

    /// The derivative of the six entries by K and a small rotation vector, by differences, which is the density of one
    /// label upside down.
    #[test]
    fn the_jacobian_is_that_of_the_map() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        for _ in 0..50 {
            let q = UniformAttitude.sample(&mut rng);
            let k: [f64; 3] = std::array::from_fn(|i| i as f64 + rng.random_range(0.1..0.9));
            let entries = |step: &[f64; 6]| {
                let moved = SecondMoments::new([k[0] + step[0], k[1] + step[1], k[2] + step[2]]);
                let turn = UnitQuaternion::new(Vector3::new(step[3], step[4], step[5]));
                Inertia::from_second_moments(moved.unwrap(), &(turn * q)).unwrap().entries()
            };
            const H: f64 = 1e-5;
            let derivative = SMatrix::<f64, 6, 6>::from_fn(|e, j| {
                let mut step = [0.0; 6];
                step[j] = H;
                let after = entries(&step)[e];
                step[j] = -H;
                (after - entries(&step)[e]) / (2.0 * H)
            });
            let axes = Inertia::from_second_moments(SecondMoments::new(k).unwrap(), &q)
                .unwrap()
                .principal_axes();
            let mut one = true;
            let mut only = [f64::NEG_INFINITY; 6];
            only[0] = 0.0;
            let density = |_: &_| {
                if std::mem::take(&mut one) { LN_ATTITUDES } else { f64::NEG_INFINITY }
            };
            let bounded = Bounded { density, at_most: LN_ATTITUDES };
            let ln_density = ln_density_of_labels(&axes, only, bounded) - LN_2;
            let expected = -derivative.determinant().abs().ln();
            assert!((ln_density - expected).abs() < 1e-6, "{ln_density} {expected}");
        }
    }

    /// A law with any roots about axes with any mean, of any size.
    fn any_law(
        scale: f64,
        seed: u64,
    ) -> (PrincipalDispersion<ScalarRoots, RadiallyConstrainedGaussian>, ChaCha8Rng) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let root = scale.sqrt();
        let laws = [(); 3].map(|()| {
            let mean = rng.random_range(0.1..3.0);
            ScalarLaw::normal(root * mean, root * rng.random_range(0.01..1.0)).unwrap()
        });
        let q = UniformAttitude.sample(&mut rng);
        let covariance = Matrix4::from_diagonal_element(rng.random_range(0.01..2.0));
        let axes = RadiallyConstrainedGaussian::new(q, covariance).unwrap();
        (PrincipalDispersion::new(ScalarRoots::new(laws).unwrap(), axes), rng)
    }

    proptest! {
        /// p(c I) = p(I)/c⁶ under the law that is c times as large, from 1e-60 to 1e60 kg·m².
        #[test]
        fn size_is_a_unit(seed in 0..u64::MAX, exponent in -60..60i32) {
            let c = 2f64.powi(2 * exponent * 5 / 3);
            let ((unit, mut rng), (scaled, _)) = (any_law(1.0, seed), any_law(c, seed));
            let body: Inertia = unit.sample(&mut rng);
            let large = InertiaMatrix::new(body.matrix() * c).unwrap();
            let (a, b) = (unit.ln_density(&body.into()).unwrap(), scaled.ln_density(&large).unwrap());
            prop_assert!(a.is_finite() && b.is_finite());
            prop_assert!((a - b - 6.0 * c.ln()).abs() < 1e-9 * (1.0 + b.abs()), "{} {}", a, b);
        }

        /// Turning the body axes turns the law: the density stays.
        #[test]
        fn body_axes_do_not_matter(seed in 0..u64::MAX) {
            let (law, mut rng) = any_law(1.0, seed);
            let body: Inertia = law.sample(&mut rng);
            let turn = UniformAttitude.sample(&mut rng);
            let axes = law.axes();
            let turned = RadiallyConstrainedGaussian::new(
                axes.mean() * turn.inverse(),
                axes.covariance(),
            ).unwrap();
            let other = PrincipalDispersion::new(law.roots().clone(), turned);
            let (a, b) = (
                law.ln_density(&body.into()).unwrap(),
                other.ln_density(&body.rotated(&turn).unwrap().into()).unwrap(),
            );
            prop_assert!((a - b).abs() < 1e-7 * (1.0 + a.abs()), "{} {}", a, b);
        }
    }

    /// However close two second moments are: their difference loses what rounding of the entries takes, and no more.
    #[test]
    fn close_second_moments_are_told_apart() {
        let root = |mean: f64| ScalarLaw::normal(mean, 0.3).unwrap();
        let laws = ScalarRoots::new([root(1.0), root(1.2), root(1.6)]).unwrap();
        let law = PrincipalDispersion::new(laws.clone(), UniformAttitude);
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        for exponent in 0..14 {
            let gap = 10f64.powi(-exponent);
            for k in
                [[1.0, 1.0 + gap, 3.0], [1.0, 2.5, 2.5 + gap], [2.0 + 2.0 * gap, 2.0, 2.0 + gap]]
            {
                let q = UniformAttitude.sample(&mut rng);
                let body =
                    Inertia::from_second_moments(SecondMoments::new(k).unwrap(), &q).unwrap();
                let found = law.ln_density(&body.into()).unwrap();
                let folded = |i: usize, k: f64| {
                    let f = |x: f64| laws.laws()[i].ln_density(x).unwrap().exp();
                    (f(k.sqrt()) + f(-k.sqrt())) / (2.0 * k.sqrt())
                };
                let values: f64 = PrincipalAxes::ORDERS
                    .iter()
                    .map(|(o, _)| (0..3).map(|i| folded(i, k[o[i]])).product::<f64>())
                    .sum();
                let gaps = (k[0] - k[1]) * (k[1] - k[2]) * (k[2] - k[0]);
                let pi = std::f64::consts::PI;
                let expected = (values * 4.0 / (16.0 * pi * pi * gaps.abs())).ln();
                let gap = gap.min(0.1);
                assert!((found - expected).abs() < 4e-15 / gap, "{k:?}: {found} {expected}");
            }
        }
    }

    /// Equal second moments, and none: infinite where the law has something there, never NaN.
    #[test]
    fn edges_are_told() {
        let (law, _) = any_law(1.0, 5);
        let of = |i: [f64; 3]| law.ln_density(&InertiaMatrix::from_entries(i, [0.0; 3]).unwrap());
        assert_eq!(of([2.0, 2.0, 3.0]), Some(f64::INFINITY));
        assert_eq!(of([2.0, 2.0, 2.0]), Some(f64::INFINITY));
        assert_eq!(of([2.0, 3.0, 5.0]), Some(f64::INFINITY));
        assert_eq!(of([0.0; 3]), Some(f64::INFINITY));
        assert_eq!(of([2.0, 3.0, 6.0]), Some(f64::NEG_INFINITY));
        assert!(of([2.0, 2.0 + 1e-9, 3.0]).unwrap().is_finite());
        let near = ScalarLaw::uniform(1.0, 2.0).unwrap();
        let roots = ScalarRoots::new([near.clone(), near.clone(), near]).unwrap();
        let near = PrincipalDispersion::new(roots, UniformAttitude);
        let of = |i: [f64; 3]| near.ln_density(&InertiaMatrix::from_entries(i, [0.0; 3]).unwrap());
        assert_eq!(of([20.0, 20.0, 20.0]), Some(f64::NEG_INFINITY));
        assert_eq!(of([0.0; 3]), Some(f64::NEG_INFINITY));
        assert_eq!(of([6.0; 3]), Some(f64::INFINITY));
    }
}
