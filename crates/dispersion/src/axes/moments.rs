//! The moments of a law of principal axes that the moments of the entries are made of.

use gyradius_attitude::{
    AboutAxis, FisherBingham, MeanHalf, RadiallyConstrainedGaussian, UniformAttitude,
};
use nalgebra::{Matrix3, SMatrix, UnitQuaternion};
use std::f64::consts::LN_2;

use super::LN_PI_SQUARED;
use super::jacobian_twice::second_jacobian;
use super::weighted_half::WeightedHalf;
use crate::entry_moments::{ENTRIES, expected_forms};
use crate::{EntryMoments, FixedAttitude, JacobianTwice, SecondMomentStatistics};

/// A law of attitudes under which the mean and covariance of the entries of an inertia matrix can be
/// computed, whatever the law of the second moments; and where it has one, the density of an attitude.
///
/// For a law of one's own, [`EntryMoments::by_quadrature`] takes nodes and weights.
pub trait AttitudeMoments {
    /// Mean and covariance of the entries of R(q)ᵀ I_P R(q), I_P = tr(K)·1 − diag(K), q from this law and
    /// K of the given mean and covariance, independent of q.
    fn entry_moments(&self, k: &SecondMomentStatistics) -> EntryMoments;

    /// What the mean of each second moment is multiplied with in the mean of the entries I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃: the
    /// expectation of δ_ab − r_ka r_kb, r_k the k-th row of R(q).
    fn expected_forms(&self) -> [[f64; 6]; 3] {
        std::array::from_fn(|k| {
            let mut one = [0.0; 3];
            one[k] = 1.0;
            self.entry_moments(&SecondMomentStatistics::joint(one, Matrix3::zeros())).mean()
        })
    }

    /// The logarithm of the density of the attitude, whichever of q and −q it is given as, with respect to Haar
    /// measure normalised to one: 0 everywhere for the uniform law. Less ln 8π² it is the density with respect to a small
    /// rotation vector. None where the law has no density, or none that is known: that is so unless a law says otherwise.
    fn ln_density_of_attitude(&self, attitude: &UnitQuaternion<f64>) -> Option<f64> {
        let _ = attitude;
        None
    }

    /// What [`ln_density_of_attitude`](Self::ln_density_of_attitude) never exceeds, which spares the density of the
    /// entries of an inertia most of its work. Infinite unless a law says otherwise.
    fn ln_density_at_most(&self) -> f64 {
        f64::INFINITY
    }
}

impl<T: AttitudeMoments + ?Sized> AttitudeMoments for &T {
    fn entry_moments(&self, k: &SecondMomentStatistics) -> EntryMoments {
        (**self).entry_moments(k)
    }

    fn expected_forms(&self) -> [[f64; 6]; 3] {
        (**self).expected_forms()
    }

    fn ln_density_of_attitude(&self, attitude: &UnitQuaternion<f64>) -> Option<f64> {
        (**self).ln_density_of_attitude(attitude)
    }

    fn ln_density_at_most(&self) -> f64 {
        (**self).ln_density_at_most()
    }
}

/// By the contour integral of the law, to machine precision.
impl AttitudeMoments for RadiallyConstrainedGaussian {
    fn entry_moments(&self, k: &SecondMomentStatistics) -> EntryMoments {
        EntryMoments::by_moments(&self.central_moments(), k)
    }

    fn expected_forms(&self) -> [[f64; 6]; 3] {
        expected_forms(&self.central_moments())
    }

    fn ln_density_of_attitude(&self, attitude: &UnitQuaternion<f64>) -> Option<f64> {
        Some(self.ln_haar_density(attitude))
    }

    fn ln_density_at_most(&self) -> f64 {
        // That of the mean is the largest of any quaternion, and another may stand beside it.
        LN_2 + LN_PI_SQUARED - self.ln_normaliser()
    }
}

/// By the contour integral of the law, to machine precision.
impl AttitudeMoments for FisherBingham {
    fn entry_moments(&self, k: &SecondMomentStatistics) -> EntryMoments {
        EntryMoments::by_moments(&self.central_moments(), k)
    }

    fn expected_forms(&self) -> [[f64; 6]; 3] {
        expected_forms(&self.central_moments())
    }

    fn ln_density_of_attitude(&self, attitude: &UnitQuaternion<f64>) -> Option<f64> {
        Some(self.ln_haar_density(attitude))
    }
}

/// In closed form: the trace t and the deviatoric part D of an isotropic random matrix are uncorrelated,
/// Cov I = Var(t)/9 · 1⊗1 + E‖D‖²/5 · (½(δ_ik δ_jl + δ_il δ_jk) − ⅓ δ_ij δ_kl).
impl AttitudeMoments for UniformAttitude {
    fn entry_moments(&self, k: &SecondMomentStatistics) -> EntryMoments {
        let (mean, covariance) = (k.principal_mean(), k.principal_covariance());
        let trace: f64 = mean.iter().sum();
        let third = trace / 3.0;
        let of_trace = covariance.sum();
        // E‖D‖² = E Σ I_k² − E t²/3, the means taken about their third so that nothing cancels.
        let of_deviator = mean.iter().map(|m| (m - third) * (m - third)).sum::<f64>()
            + (covariance.trace() - of_trace / 3.0).max(0.0);
        let delta = |i, j| if i == j { 1.0 } else { 0.0 };
        let covariance = SMatrix::from_fn(|e, f| {
            let ((i, j), (k, l)) = (ENTRIES[e], ENTRIES[f]);
            let traces = delta(i, j) * delta(k, l);
            let symmetric = 0.5 * (delta(i, k) * delta(j, l) + delta(i, l) * delta(j, k));
            of_trace / 9.0 * traces + of_deviator / 5.0 * (symmetric - traces / 3.0)
        });
        EntryMoments::unchecked([third, third, third, 0.0, 0.0, 0.0], covariance)
    }

    fn ln_density_of_attitude(&self, _: &UnitQuaternion<f64>) -> Option<f64> {
        Some(0.0)
    }

    fn ln_density_at_most(&self) -> f64 {
        0.0
    }
}

/// The covariance is a trigonometric polynomial of the angle, of degree four: nine equal steps are exact.
impl AttitudeMoments for AboutAxis {
    fn entry_moments(&self, k: &SecondMomentStatistics) -> EntryMoments {
        let step = std::f64::consts::TAU / 9.0;
        EntryMoments::by_quadrature(k, (0..9).map(|i| (1.0 / 9.0, self.at(step * f64::from(i)))))
    }
}

/// One node.
impl AttitudeMoments for FixedAttitude {
    fn entry_moments(&self, k: &SecondMomentStatistics) -> EntryMoments {
        EntryMoments::by_quadrature(k, [(1.0, self.attitude())])
    }
}

/// By adaptive cubature over the half sphere, to about 1e-7 of the largest covariance; where the far
/// half holds less than 1e-14 of the law, that of the whole to machine precision. A thin ridge of the
/// law that winds to the edge of the half can escape the cubature, which shows in the share of the
/// half: then by quadrature over the angles of the whole sphere, to better than 1e-2.
impl AttitudeMoments for MeanHalf {
    fn entry_moments(&self, k: &SecondMomentStatistics) -> EntryMoments {
        if self.whole().far_half_share() < 1e-14 {
            return self.whole().entry_moments(k);
        }
        WeightedHalf::new(self.whole(), |_| 1.0).entry_moments(k)
    }

    fn ln_density_of_attitude(&self, attitude: &UnitQuaternion<f64>) -> Option<f64> {
        Some(self.ln_haar_density(attitude))
    }

    fn ln_density_at_most(&self) -> f64 {
        LN_PI_SQUARED - self.whole().ln_normaliser() - libm::log(self.share())
    }
}

/// By adaptive cubature over the half sphere, to about 1e-5 of the largest covariance: the weight has
/// edges. Where a ridge escapes it, as for [`MeanHalf`].
impl AttitudeMoments for JacobianTwice {
    fn entry_moments(&self, k: &SecondMomentStatistics) -> EntryMoments {
        WeightedHalf::new(self.once(), second_jacobian).entry_moments(k)
    }

    fn ln_density_of_attitude(&self, attitude: &UnitQuaternion<f64>) -> Option<f64> {
        Some(self.ln_haar_density(attitude))
    }
}

#[cfg(test)]
mod tests {
    use super::super::whole_sphere::WholeSphere;
    use super::*;
    use crate::{AxesLaw, KnownMoments, PrincipalDispersion, RootMoments, ScalarRoots};
    use gyradius_inertia::{Inertia, RootSecondMoments};
    use nalgebra::{Matrix4, Quaternion, Unit, Vector3, Vector4};
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
    use rand_distr::Distribution;

    /// On the paper's example nothing lies at the edge of the half, and the quadrature over the angles
    /// of the whole sphere, the far half left out, is another way to the same moments.
    #[test]
    fn cubature_and_quadrature_agree() {
        let mean =
            UnitQuaternion::from_quaternion(Quaternion::new(0.9996, 0.0249, 0.0005, -0.0100));
        let covariance = Matrix4::from_diagonal(&Vector4::new(2e-5, 6e-4, 6e-4, 0.6));
        let law = RadiallyConstrainedGaussian::new(mean, covariance).unwrap();
        let k =
            SecondMomentStatistics::independent([1000.0, 2000.0, 3000.0], [500.0, 700.0, 900.0]);
        let jacobian = |x: &[f64; 4]| {
            let planar = x[0] * x[0] + x[1] * x[1];
            ((planar + x[2] * x[2]) * planar).sqrt()
        };

        let half = MeanHalf::new(law.clone()).entry_moments(&k);
        let twice = JacobianTwice::new(law.clone()).unwrap().entry_moments(&k);
        let plain = WholeSphere::new(&law, |_| 1.0);
        let weighted = WholeSphere::new(&law, jacobian);
        for (found, expected, allowed) in [
            (half, EntryMoments::by_expectation(&k, &plain), 1e-7),
            (twice, EntryMoments::by_expectation(&k, &weighted), 1e-5),
        ] {
            let size = expected.covariance().amax();
            let error = (found.covariance() - expected.covariance()).amax() / size;
            assert!(error < allowed, "{error:e}");
            for e in 0..6 {
                let error = (found.mean()[e] - expected.mean()[e]).abs() / 5000.0;
                assert!(error < allowed, "{error:e}");
            }
        }
        // The two laws are not the same.
        assert!((half.covariance() - twice.covariance()).amax() > 0.1 * half.covariance().amax());
    }

    /// Every law with a density has the mean 1 of it over all attitudes, q and −q alike, and its bound is one.
    #[test]
    fn densities_of_attitudes_are_normalised_and_bounded() {
        const N: u32 = 200_000;
        let mut rng = ChaCha8Rng::seed_from_u64(61);
        for (i, variances) in [[0.1, 0.2, 0.3, 1.0], [0.02, 0.5, 0.03, 0.6], [1.0, 2.0, 0.5, 3.0]]
            .into_iter()
            .enumerate()
        {
            let mean = UniformAttitude.sample(&mut rng);
            let covariance = Matrix4::from_diagonal(&Vector4::from(variances));
            let law = RadiallyConstrainedGaussian::new(mean, covariance).unwrap();
            let bingham =
                FisherBingham::new(law.precision(), Vector4::new(1.0, 0.0, -2.0, 0.5)).unwrap();
            let twice = JacobianTwice::new(law.clone()).unwrap();
            let laws: [AxesLaw; 4] = [
                law.clone().into(),
                MeanHalf::new(law.clone()).into(),
                twice.into(),
                UniformAttitude.into(),
            ];
            let all = laws.iter().map(|law| law as &dyn AttitudeMoments);
            for (kind, axes) in all.chain([&bingham as &dyn AttitudeMoments]).enumerate() {
                let mut sum = 0.0;
                for q in gyradius_attitude::super_fibonacci(N).chain([mean]) {
                    let density = axes.ln_density_of_attitude(&q).unwrap();
                    assert!(density <= axes.ln_density_at_most() + 1e-12, "{i} {kind}");
                    let opposite = UnitQuaternion::new_unchecked(-q.into_inner());
                    let other = axes.ln_density_of_attitude(&opposite).unwrap();
                    assert!(density == other || (density - other).abs() < 1e-12, "{i} {kind}");
                    sum += density.exp();
                }
                let whole = sum / f64::from(N);
                assert!((whole - 1.0).abs() < 2e-3, "{i} {kind}: {whole}");
            }
        }
        let none: [&dyn AttitudeMoments; 2] = [
            &FixedAttitude::new(UnitQuaternion::identity()),
            &AboutAxis::new(UnitQuaternion::identity(), Vector3::z_axis()),
        ];
        assert!(
            none.iter()
                .all(|law| { law.ln_density_of_attitude(&UnitQuaternion::identity()).is_none() })
        );
    }

    fn law(axis: Vector3<f64>, roots: [f64; 3]) -> PrincipalDispersion<ScalarRoots, AboutAxis> {
        let roots = RootSecondMoments::new(roots).unwrap();
        let mean = UnitQuaternion::from_euler_angles(0.3, -0.8, 1.1);
        let axes = AboutAxis::new(mean, Unit::new_normalize(axis));
        PrincipalDispersion::new(ScalarRoots::normal(roots, [0.01, 0.02, 0.03]).unwrap(), axes)
    }

    /// Of any angle about an axis: against draws, and where the axis is a principal one of a body with two equal
    /// roots, against the same body at one angle.
    #[test]
    fn moments_about_a_known_axis_are_those_of_draws() {
        const N: usize = 60_000;
        for (i, axis) in
            [[0.0, 0.0, 1.0], [1.0, 0.2, -0.4], [0.3, -0.9, 0.1]].into_iter().enumerate()
        {
            let law = law(axis.into(), [2.0, 3.0, 5.0]);
            let (moments, mut rng) = (law.entry_moments(), ChaCha8Rng::seed_from_u64(i as u64));
            let draws: Vec<[f64; 6]> =
                (0..N).map(|_| Distribution::<Inertia>::sample(&law, &mut rng).entries()).collect();
            for e in 0..6 {
                let mean = draws.iter().map(|d| d[e]).sum::<f64>() / N as f64;
                let square = draws.iter().map(|d| (d[e] - mean).powi(2)).sum::<f64>() / N as f64;
                let deviation = moments.deviations()[e];
                let z = (mean - moments.mean()[e]) / deviation * (N as f64).sqrt();
                assert!(z.abs() < 4.5, "{axis:?} {e}: {z}");
                assert!((square.sqrt() / deviation - 1.0).abs() < 0.03, "{axis:?} {e}");
            }
        }
        let mean = UnitQuaternion::from_euler_angles(0.3, -0.8, 1.1);
        let body = RootSecondMoments::new([2.0, 2.0, 5.0]).unwrap();
        let still = ScalarRoots::normal(body, [0.0; 3]).unwrap();
        // Body components of the third principal axis.
        let axis = Unit::new_normalize(mean.inverse() * Vector3::z());
        let free =
            PrincipalDispersion::new(still.clone(), AboutAxis::new(mean, axis)).entry_moments();
        let fixed = PrincipalDispersion::new(still, FixedAttitude::new(mean)).entry_moments();
        for e in 0..6 {
            assert!((free.mean()[e] - fixed.mean()[e]).abs() < 1e-12);
            assert!(free.deviations()[e] < 1e-6);
        }
    }

    /// Chosen at run time they are the same laws, as the axes of a body and by themselves.
    #[test]
    fn any_law_is_the_law_inside() {
        let mean = UnitQuaternion::from_euler_angles(0.3, -0.8, 1.1);
        let about = AboutAxis::new(mean, Vector3::z_axis());
        let linear = Vector4::new(0.3, -1.0, 2.0, 0.5);
        let form = Matrix4::from_diagonal(&Vector4::new(3.0, 1.0, 0.0, 7.0));
        let bingham = FisherBingham::new(form, linear).unwrap();
        let roots = ScalarRoots::normal(RootSecondMoments::new([2.0, 3.0, 5.0]).unwrap(), [0.1; 3]);
        let roots = roots.unwrap();
        let same = |any: AxesLaw, own: &dyn AttitudeMoments, drawn: [UnitQuaternion<f64>; 2]| {
            let k = roots.second_moment_statistics();
            assert_eq!(any.entry_moments(&k), own.entry_moments(&k));
            assert_eq!(any.ln_density_of_attitude(&mean), own.ln_density_of_attitude(&mean));
            assert_eq!(drawn[0], drawn[1]);
        };
        let rng = || ChaCha8Rng::seed_from_u64(3);
        let any = AxesLaw::from(about);
        let drawn = [any.sample(&mut rng()), about.sample(&mut rng())];
        same(any, &about, drawn);
        let any = AxesLaw::from(bingham.clone());
        let drawn = [any.sample(&mut rng()), bingham.sample(&mut rng())];
        same(any, &bingham, drawn);
    }

    /// A law that says no more than it must.
    struct Terse<'a>(&'a dyn AttitudeMoments);

    impl AttitudeMoments for Terse<'_> {
        fn entry_moments(&self, k: &SecondMomentStatistics) -> EntryMoments {
            self.0.entry_moments(k)
        }
    }

    /// To the bit, whether a law takes them at once or one after the other.
    #[test]
    fn forms_are_what_second_moments_are_multiplied_with() {
        let mean = UnitQuaternion::from_euler_angles(0.3, -0.8, 1.1);
        let rcg = |variance| {
            let covariance = Matrix4::from_diagonal(&Vector4::new(0.5, 1.0, 0.2, 3.0)) * variance;
            RadiallyConstrainedGaussian::new(mean, covariance).unwrap()
        };
        let laws: [&dyn AttitudeMoments; 6] = [
            &rcg(1e-6),
            &rcg(0.1),
            &FisherBingham::new(
                -Matrix4::from_diagonal(&Vector4::new(5.0, 1.0, 2.0, 0.0)),
                Vector4::new(1.0, 0.0, 2.0, 0.5),
            )
            .unwrap(),
            &AxesLaw::from(rcg(0.3)),
            &UniformAttitude,
            &FixedAttitude::new(mean),
        ];
        let k = SecondMomentStatistics::joint([2.0, 3.0, 5.0], Matrix3::identity() * 0.1);
        for (i, law) in laws.into_iter().enumerate() {
            let forms = law.expected_forms();
            assert_eq!(forms, Terse(law).expected_forms(), "law {i}");
            for (e, expected) in law.entry_moments(&k).mean().iter().enumerate() {
                let sum: f64 = (0..3).map(|j| k.mean()[j] * forms[j][e]).sum();
                assert!((sum - expected).abs() < 1e-12, "law {i}: {sum} {expected}");
            }
        }
    }
}
