//! Integrals over the angles against closed forms and the contour integral.

use super::*;
use crate::HypersphericalAngles;
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

fn law(mean: [f64; 4], variances: [f64; 4]) -> RadiallyConstrainedGaussian {
    turned(mean, variances, Matrix4::identity())
}

fn turned(mean: [f64; 4], variances: [f64; 4], turn: Matrix4<f64>) -> RadiallyConstrainedGaussian {
    let mean = UnitQuaternion::from_quaternion(Quaternion::from(Vector4::from(mean)));
    let covariance = turn * Matrix4::from_diagonal(&variances.into()) * turn.transpose();
    let covariance = (covariance + covariance.transpose()) * 0.5;
    RadiallyConstrainedGaussian::new(mean, covariance).unwrap()
}

fn paper() -> RadiallyConstrainedGaussian {
    law([0.0249, 0.0005, -0.0100, 0.9996], [2e-5, 6e-4, 6e-4, 0.6])
}

/// Laws with one, two or three narrow coordinates, means on the axes, on ridges and off them.
fn hard() -> Vec<RadiallyConstrainedGaussian> {
    let mut laws = Vec::new();
    for mean in [
        [1.0, 2.0, 3.0, 4.0],
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 1.0],
        [1e-4, 0.6, 0.0, 0.8],
        [0.6, 1e-5, 0.8, -1e-4],
    ] {
        for variances in [
            [1e-8; 4],
            [1e8; 4],
            [1e-8, 1.0, 1.0, 1.0],
            [1e-8, 1e8, 1e8, 1e8],
            [1e-8, 1e-8, 1e8, 1e8],
            [1e-8, 1e-8, 1e-8, 1e8],
            [1e-8, 1e-5, 1e-2, 10.0],
            [1e8, 1e-8, 1e-4, 1e-8],
        ] {
            laws.push(law(mean, variances));
        }
    }
    laws
}

fn check(law: &RadiallyConstrainedGaussian, tolerance: f64) -> Result<(), String> {
    let rule = law.by_quadrature();
    let errors = [
        (rule.ln_normaliser() - law.ln_normaliser()).abs(),
        (rule.mean_vector() - law.mean_vector()).amax(),
        (rule.second_moment() - law.second_moment()).amax(),
        (rule.second_moment().trace() - 1.0).abs(),
    ];
    let good = |e: f64| e < tolerance && e < rule.estimated_error() + 1e-13;
    if errors.into_iter().all(good) && rule.estimated_error() < 1e-10 {
        return Ok(());
    }
    Err(format!("{errors:?}, {:e} estimated: {law:?}", rule.estimated_error()))
}

/// ln C of five laws from a contour integral in 200-bit arithmetic.
#[test]
fn normaliser_matches_the_reference() {
    for (mean, variances, expected) in [
        ([0.0249, 0.0005, -0.01, 0.9996], [2e-5, 6e-4, 6e-4, 0.6], -10.035_477_697_452_611),
        ([0.0, 0.0, 0.0, 1.0], [1.0; 4], 2.105_106_145_327_859_7),
        ([1.0, 2.0, 3.0, 4.0], [0.1, 0.2, 0.3, 0.4], 0.345_857_164_922_322_6),
        ([1.0, -1.0, 1.0, -1.0], [1e-6, 1e-4, 1e-2, 1.0], -9.770_789_315_952_086),
        ([0.02, -0.01, 0.03, 0.999], [1e-4, 2e-4, 3e-4, 100.0], -9.478_599_176_362_945),
    ] {
        let rule = law(mean, variances).by_quadrature();
        let error = rule.ln_normaliser() - expected;
        assert!(error.abs() < 1e-13, "{variances:?}: {error:e}");
    }
}

#[test]
fn hard_laws_match_the_contour() {
    for law in hard() {
        check(&law, 1e-12).unwrap();
    }
}

#[test]
fn closed_forms() {
    // Isotropic Σ = s·1: C = 4π² s I₁(1/s) exp(−1/s), and |E x| = I₂/I₁, by their integrals.
    let bessel = |n: f64, k: f64| {
        let count = 2000;
        let sum: f64 = (0..count)
            .map(|i| {
                let t = PI * (f64::from(i) + 0.5) / f64::from(count);
                (k * (t.cos() - 1.0)).exp() * (n * t).cos()
            })
            .sum();
        sum / f64::from(count)
    };
    for s in [1e-4, 0.03, 0.5, 3.0, 1e3] {
        let rule = law([0.1, -0.2, 0.3, 0.9], [s; 4]).by_quadrature();
        let expected = (4.0 * PI * PI * s * bessel(1.0, 1.0 / s)).ln();
        assert!((rule.ln_normaliser() - expected).abs() < 1e-11, "{s}");
        let length = bessel(2.0, 1.0 / s) / bessel(1.0, 1.0 / s);
        assert!((rule.mean_vector().norm() - length).abs() < 1e-11, "{s}");
    }
    let flat = FisherBingham::new(Matrix4::zeros(), Vector4::zeros()).unwrap().by_quadrature();
    assert!((flat.ln_normaliser() - (2.0 * PI * PI).ln()).abs() < 1e-14);
    assert!((flat.second_moment() - Matrix4::identity() * 0.25).amax() < 1e-14);
    assert!(flat.mean_vector().amax() < 1e-14);
}

/// ∫ g(Φ) dΦ by the midpoint rule in θ₃ and Gauss's, in panels, in θ₁ and θ₂.
fn over_angles(g: impl Fn(&HypersphericalAngles) -> f64) -> f64 {
    let nodes: Vec<_> = (0..3)
        .flat_map(|i| kronrod(f64::from(i) * PI / 3.0, f64::from(i + 1) * PI / 3.0))
        .collect();
    let mut sum = 0.0;
    for &(first, w1, _) in &nodes {
        for &(second, w2, _) in &nodes {
            for k in 0..64 {
                let third = TAU * (f64::from(k) + 0.5) / 64.0;
                let angles = HypersphericalAngles::new([first, second, third]).unwrap();
                sum += w1 * w2 * TAU / 64.0 * g(&angles);
            }
        }
    }
    sum
}

/// Eq. 21 and 26 to the letter, in Φ with the Jacobian of Eq. 25, for a law mild enough; without
/// the Jacobian, or with its square, the same sum is far off.
#[test]
fn a_product_rule_in_the_papers_angles_agrees() {
    let turn = Matrix4::from_fn(|i, j| f64::from((3 * i as i32 + 5 * j as i32) % 7) - 2.5).qr().q();
    let law = turned([0.2, -0.1, 0.3, 0.9], [0.3, 0.4, 0.5, 0.8], turn);
    let e = |a: &HypersphericalAngles| {
        let e = a.quaternion().coords - law.mean().coords;
        (-0.5 * e.dot(&(law.precision() * e))).exp()
    };
    let ln_c = law.by_quadrature().ln_normaliser();
    let right = over_angles(|a| a.jacobian() * e(a));
    assert!((right.ln() - ln_c).abs() < 1e-12, "{:e}", right.ln() - ln_c);
    let total = over_angles(|a| law.ln_density_of_angles(a).exp());
    assert!((total - 1.0).abs() < 1e-12, "{total}");
    for power in [0, 2] {
        let wrong = over_angles(|a| a.jacobian().powi(power) * e(a));
        assert!((wrong.ln() - ln_c).abs() > 0.1, "{power}: {}", wrong.ln() - ln_c);
    }
}

#[test]
fn expectations_are_those_of_the_contour() {
    let law = paper();
    let rule = law.by_quadrature();
    let [one, x4, fourth] = rule.expect(|q| [1.0, q.w, q.w.powi(3) * q.i]);
    let [exact] = law.expect(|x| [x[3] * x[3] * x[3] * x[0]]);
    assert!((one - 1.0).abs() < 1e-13);
    assert!((x4 - law.mean_vector()[3]).abs() < 1e-12);
    assert!((fourth - exact).abs() < 1e-12, "{:e}", fourth - exact);
    // Not a polynomial: the mean turn of a flat law is π/2 + 2/π.
    let flat = self::law([0.0, 0.0, 0.0, 1.0], [1e12; 4]).by_quadrature();
    let [turn] = flat.expect(|q| [q.angle()]);
    assert!((turn - FRAC_PI_2 - 2.0 / PI).abs() < 1e-3, "{turn}");
}

/// Beyond the range of 1e-8 to 1e8 the error grows, and is owned to.
#[test]
fn the_error_is_owned_to() {
    for s in [1e-10, 1e-12, 1e-14] {
        for variances in [[s; 4], [s, s, 1.0, 1.0], [s, 1.0, 1e14, 1e14]] {
            let law = law([0.5, -0.5, 0.1, 0.7], variances);
            let rule = law.by_quadrature();
            let error = (rule.ln_normaliser() - law.ln_normaliser()).abs();
            assert!(error < rule.estimated_error(), "{variances:?}: {error:e}");
            assert!(rule.estimated_error() < 10.0 * f64::EPSILON / s.sqrt());
        }
    }
}

#[test]
fn a_fisher_bingham_law_keeps_its_own_normaliser() {
    let p = Matrix4::from_diagonal(&Vector4::new(1e6, -3e4, 30.0, 0.0));
    for b in [Vector4::zeros(), Vector4::new(1e5, 3e4, 2.0, -1.0)] {
        let law = FisherBingham::new(p, b).unwrap();
        let (rule, exact) = (law.by_quadrature(), law.ln_normaliser());
        let error = (rule.ln_normaliser() - exact).abs();
        assert!(error < 1e-11 + 4.0 * f64::EPSILON * exact.abs(), "{error:e}");
        assert!((rule.second_moment() - law.second_moment()).amax() < 1e-11);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(160))]
    #[test]
    fn any_law_matches_the_contour(
        x in prop::array::uniform16(-1.0..1.0f64),
        exponents in prop::array::uniform4(-8.0..8.0f64),
        mean in prop::array::uniform4(-1.0..1.0f64),
        equal in 0..4usize,
        diagonal in any::<bool>(),
        on_axis in 0..4usize,
    ) {
        let mut mean = mean;
        let mut variances = exponents.map(|e| 10f64.powf(e));
        variances[equal] = variances[0];
        if on_axis > 0 {
            mean[on_axis] = 0.0;
        }
        prop_assume!(Vector4::from(mean).norm() > 0.1);
        let turn = if diagonal { Matrix4::identity() } else { Matrix4::from_row_slice(&x).qr().q() };
        // Turning large variances takes the small ones below rounding.
        let floor = variances.into_iter().fold(0.0, f64::max) * 1e-12;
        if !diagonal {
            variances = variances.map(|s| s.max(floor));
        }
        if let Err(message) = check(&turned(mean, variances, turn), 1e-11) {
            return Err(TestCaseError::fail(message));
        }
    }
}
