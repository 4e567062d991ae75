//! Laws of axes that scatter by independent small turns, some of which may be any.

use gyradius_attitude::{RadiallyConstrainedGaussian, RcgError};
use nalgebra::{Matrix3, Matrix4, UnitQuaternion, Vector3};

/// The variance of half a turn that stands for an angle nobody knows: uniform to 1e-4, and small
/// enough for the other variances to keep their digits beside it.
const FREE: f64 = 100.0;
/// Radial variance of a law that is concentrated: no second lobe, and no effect on the rest.
const CONCENTRATED: f64 = 0.01;
/// What is added to a Σ⁻¹ that is next to nothing in some direction.
const SHARE: f64 = 1e-4;
/// Deviation of turns, rad, below which axes are taken to be fixed: half its square is what the law
/// of the axes can still hold beside the radial variance.
pub(crate) const FIXED: f64 = 2e-6;

/// The law of axes that scatter by independent small turns about the mean principal axes, of the
/// given variances in rad²; infinite where nothing is known of the turn. Two free turns leave the
/// third one free, too.
pub(crate) fn law_of_turns(
    mean: UnitQuaternion<f64>,
    variances: [f64; 3],
) -> Result<RadiallyConstrainedGaussian, RcgError> {
    law_of_turns_about(mean, mean.to_rotation_matrix().matrix(), variances)
}

/// The same, where the small turns that are independent are about the rows of `axes`, in body axes.
pub(crate) fn law_of_turns_about(
    mean: UnitQuaternion<f64>,
    axes: &Matrix3<f64>,
    variances: [f64; 3],
) -> Result<RadiallyConstrainedGaussian, RcgError> {
    let (local, radial) = chart_variances(variances);
    let body = axes.tr_mul(&(Matrix3::from_diagonal(&Vector3::from(local)) * axes));
    let body = (body + body.transpose()) * 0.5;
    RadiallyConstrainedGaussian::from_rotation_covariance(mean, body, radial)
}

/// The variances of the rotation vector of such a law along its axes, rad², and its radial variance.
pub(crate) fn chart_variances(variances: [f64; 3]) -> ([f64; 3], f64) {
    let free = variances.iter().filter(|v| !v.is_finite()).count();
    // Beside a free turn, variances lose what its own size rounds away.
    let least = if free > 0 { 25.0 * FIXED * FIXED } else { FIXED * FIXED };
    let local = variances
        .map(|v| if free > 1 || !v.is_finite() { 4.0 * FREE } else { v.clamp(least, 4.0 * FREE) });
    // A narrow law is the same for any radial variance; a wide one needs one as wide.
    let widest = local.iter().copied().fold(0.0, f64::max);
    (local, if free > 0 { FREE } else { CONCENTRATED.max(0.25 * widest) })
}

/// The same law with a covariance whose entries hold it: with a tiny share of the unit matrix added to Σ⁻¹, which on unit
/// quaternions leaves the density as it is to a factor of e^(±[`SHARE`]). Of a law that is wide in one direction and fixed to
/// 1e-4 rad in another, it is 1e-3, and the smallest variance loses as much.
pub(crate) fn held_by_entries(law: &RadiallyConstrainedGaussian) -> RadiallyConstrainedGaussian {
    if law.covariance().amax() * SHARE <= 1.0 {
        return law.clone();
    }
    // −½(x − m)ᵀ(Σ⁻¹ + c)(x − m) adds −½c(1 + |m|²) + c m·x where |x| = 1.
    let eigen = law.precision().symmetric_eigen();
    // Entries of 1/c lose 1e-16/c of the smallest variance.
    let share = SHARE.max(1e-8 * eigen.eigenvalues.amax().sqrt());
    let variances = eigen.eigenvalues.map(|precision| 1.0 / (precision.max(0.0) + share));
    let axes = eigen.eigenvectors;
    let covariance = axes * Matrix4::from_diagonal(&variances) * axes.transpose();
    let covariance = (covariance + covariance.transpose()) * 0.5;
    RadiallyConstrainedGaussian::new(law.mean(), covariance).unwrap_or_else(|_| law.clone())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Laws of any width with an infinite radial variance: the density hardly changes, and what is read from the entries is
    /// the same law.
    #[test]
    fn entries_hold_wide_laws() {
        use rand::RngExt;
        use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
        let mut rng = ChaCha8Rng::seed_from_u64(8);
        for _ in 0..200 {
            let mut attitude = || gyradius_attitude::UniformAttitude.sample(&mut rng);
            use rand_distr::Distribution;
            let (mean, frame, other) = (attitude(), attitude(), attitude());
            let axes = *frame.to_rotation_matrix().matrix();
            let local = [0; 3].map(|_| libm::pow(10.0, rng.random_range(-8.0..1.0)));
            let turns = axes.tr_mul(&(Matrix3::from_diagonal(&Vector3::from(local)) * axes));
            let turns = (turns + turns.transpose()) * 0.5;
            let law =
                RadiallyConstrainedGaussian::from_rotation_covariance(mean, turns, f64::INFINITY);
            let law = law.unwrap();
            let held = held_by_entries(&law);
            let read = RadiallyConstrainedGaussian::new(held.mean(), held.covariance()).unwrap();
            for q in [mean, mean.slerp(&other, 1e-3), mean.slerp(&other, 0.1), other] {
                let (before, after) = (law.ln_haar_density(&q), read.ln_haar_density(&q));
                let error = (after - before).abs();
                assert!(error <= 3e-3 * (1.0 + before.abs()), "{local:?}: {before} {after}");
            }
        }
    }

    #[test]
    fn turns_are_about_principal_axes() {
        let mean = UnitQuaternion::from_euler_angles(0.4, 0.2, -1.0);
        let law = law_of_turns(mean, [1e-4, 4e-4, 9e-4]).unwrap();
        let r = mean.to_rotation_matrix();
        let principal = r.matrix() * law.rotation_covariance() * r.matrix().transpose();
        for (k, v) in [1e-4, 4e-4, 9e-4].into_iter().enumerate() {
            assert!((principal[(k, k)] / v - 1.0).abs() < 1e-3, "{principal}");
        }
    }

    /// A free turn about principal axis 3: the axis itself stays, the others go round evenly.
    #[test]
    fn a_free_turn_is_uniform_about_its_axis() {
        let mean = UnitQuaternion::from_euler_angles(0.4, 0.2, -1.0);
        let law = law_of_turns(mean, [1e-4, 1e-4, f64::INFINITY]).unwrap();
        let axis = |q: &UnitQuaternion<f64>, k: usize| q.inverse() * Vector3::ith(k, 1.0);
        // E a₃·a₃ and E (a₁·a₁)² by the law's own moments would need eight digits; draws suffice.
        use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
        use rand_distr::Distribution;
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let (mut c, mut c2) = (0.0, 0.0);
        const N: usize = 40_000;
        for _ in 0..N {
            let q = law.sample(&mut rng);
            assert!(axis(&q, 2).dot(&axis(&mean, 2)) > (0.1_f64).cos());
            let x = axis(&q, 0).dot(&axis(&mean, 0));
            c += x / N as f64;
            c2 += x * x / N as f64;
        }
        // Cosine of a uniform angle: mean 0, mean square ½.
        assert!(c.abs() < 4.0 * (0.5 / N as f64).sqrt(), "{c}");
        assert!((c2 - 0.5).abs() < 4.0 * (0.125 / N as f64).sqrt() + 2e-4, "{c2}");
    }

    #[test]
    fn nothing_known_is_uniform() {
        let law = law_of_turns(UnitQuaternion::identity(), [f64::INFINITY; 3]).unwrap();
        let second = law.second_moment();
        for k in 0..4 {
            assert!((second[(k, k)] - 0.25).abs() < 1e-3, "{second}");
        }
    }

    #[test]
    fn fixed_axes_stay_within_the_range_of_the_law() {
        for mean in [UnitQuaternion::identity(), UnitQuaternion::from_euler_angles(1.0, 0.5, 2.0)] {
            assert!(law_of_turns(mean, [0.0; 3]).is_ok());
            assert!(law_of_turns(mean, [0.0, 0.0, f64::INFINITY]).is_ok());
            assert!(law_of_turns(mean, [0.0, 1.0, 1e300]).is_ok());
            // And so does its covariance, written and read again.
            let law = law_of_turns(mean, [0.0, 0.0, f64::INFINITY]).unwrap();
            assert!(RadiallyConstrainedGaussian::new(mean, law.covariance()).is_ok());
        }
    }
}
