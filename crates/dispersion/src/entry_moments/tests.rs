//! Exact moments against draws, closed forms and an independent program.

use super::*;
use crate::{
    AttitudeMoments, AxesLaw, CorrelatedRoots, FixedAttitude, JacobianTwice, PrincipalDispersion,
    RootMoments, ScalarLaw, ScalarRoots,
};
use gyradius_attitude::{FisherBingham, MeanHalf, RadiallyConstrainedGaussian, UniformAttitude};
use gyradius_inertia::{Inertia, InertiaMatrix, RootSecondMoments};
use nalgebra::{Complex, Matrix3, Matrix4, Vector4};
use proptest::prelude::*;
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use rand_distr::Distribution;

type Law = PrincipalDispersion<ScalarRoots, RadiallyConstrainedGaussian>;

fn law(moments: [f64; 3], products: [f64; 3], roots: [f64; 3], axes: [f64; 4]) -> Law {
    let nominal =
        Inertia::try_from(InertiaMatrix::from_entries(moments, products).unwrap()).unwrap();
    PrincipalDispersion::new(
        ScalarRoots::normal(nominal.second_moments().roots(), roots).unwrap(),
        RadiallyConstrainedGaussian::new(
            nominal.principal_axes().attitude(),
            Matrix4::from_diagonal(&Vector4::from(axes)),
        )
        .unwrap(),
    )
}

/// The law as derived for the paper's two bodies; deviations by an independent program (mpmath,
/// contour integrals of the quaternion's moments to order 8).
#[test]
fn the_papers_bodies() {
    let axes = [2e-5, 6e-4, 6e-4, 0.6];
    let payload = law([5000.0, 4000.0, 3000.0], [20.0, 2.0, -50.0], [0.125, 0.1, 0.075], axes);
    let stage = law([6700.0, 6700.0, 2000.0], [0.0, 20.0, -20.0], [0.0067, 0.0067, 0.002], axes);
    let expected = [
        (payload, [41.86007876, 37.54040342, 36.59555016, 49.29484652, 97.53376284, 20.7884269]),
        (stage, [15.76387505, 8.23097277, 17.70178099, 7.19674534, 212.60515298, 96.33842351]),
    ];
    for (law, deviations) in expected {
        for (found, expected) in EntryMoments::of(&law).deviations().iter().zip(deviations) {
            assert!((found / expected - 1.0).abs() < 1e-8, "{found} {expected}");
        }
    }
}

/// Mean and covariance of the entries against draws, to |z| < 4.
pub(crate) fn check_entries<T: Into<InertiaMatrix>>(
    what: &str,
    moments: &EntryMoments,
    law: &impl Distribution<T>,
    seed: u64,
) {
    const N: usize = 100_000;
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let draws: Vec<[f64; 6]> = (0..N).map(|_| law.sample(&mut rng).into().entries()).collect();
    let n = N as f64;
    let size = moments.mean().iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    for e in 0..6 {
        let mean = draws.iter().map(|d| d[e]).sum::<f64>() / n;
        let gap = mean - moments.mean()[e];
        let z = gap / (moments.covariance()[(e, e)].max(0.0) / n).sqrt();
        assert!(z.abs() < 4.0 || gap.abs() <= 1e-12 * size, "{what}: mean {e}: z = {z}");
        for f in 0..=e {
            let products: Vec<f64> = draws
                .iter()
                .map(|d| (d[e] - moments.mean()[e]) * (d[f] - moments.mean()[f]))
                .collect();
            let mean = products.iter().sum::<f64>() / n;
            let variance = products.iter().map(|p| (p - mean).powi(2)).sum::<f64>() / n;
            let gap = mean - moments.covariance()[(e, f)];
            let z = gap / (variance / n).sqrt();
            let small = gap.abs() <= 1e-14 * size * size;
            assert!(z.abs() < 4.0 || small, "{what}: covariance {e}{f}: z = {z}");
        }
    }
}

/// Every kind of roots about every kind of axes.
#[test]
fn draws_agree_for_every_combination() {
    let wide = law([5.0, 4.0, 3.0], [0.3, 0.2, -0.5], [0.3, 0.1, 0.05], [0.02, 0.1, 0.3, 0.8]);
    let k = RootSecondMoments::new(wide.roots().laws().each_ref().map(ScalarLaw::mean)).unwrap();
    let spread = nalgebra::Vector3::new(0.3, 0.2, 0.1);
    let roots: [crate::RootLaw; 4] = [
        wide.roots().clone().into(),
        CorrelatedRoots::new(k, spread * spread.transpose()).unwrap().into(),
        ScalarRoots::uniform(k, [0.3, 0.1, 0.05]).unwrap().into(),
        ScalarRoots::lognormal(k, [0.3, 0.1, 0.05]).unwrap().into(),
    ];
    let rcg = wide.axes();
    let axes: [AxesLaw; 5] = [
        rcg.clone().into(),
        MeanHalf::new(rcg.clone()).into(),
        JacobianTwice::new(rcg.clone()).unwrap().into(),
        UniformAttitude.into(),
        FixedAttitude::new(rcg.mean()).into(),
    ];
    for (i, roots) in roots.iter().enumerate() {
        for (j, axes) in axes.iter().enumerate() {
            let law = PrincipalDispersion::new(roots.clone(), axes.clone());
            let seed = 600 + (10 * i + j) as u64;
            check_entries::<Inertia>(&format!("{i} {j}"), &EntryMoments::of(&law), &law, seed);
        }
    }
}

/// Half spheres with much at their edge, and a ridge that only the second way finds.
#[test]
fn wide_halves() {
    for (i, axes) in
        [[1.0, 1.0, 1.0, 1.0], [0.01, 0.01, 0.6, 0.1], [1e-4, 1e-2, 1.0, 100.0]].iter().enumerate()
    {
        let whole = law([5.0, 4.0, 3.0], [0.3, 0.2, -0.5], [0.01; 3], *axes);
        let half = MeanHalf::new(whole.axes().clone());
        let law = PrincipalDispersion::new(whole.roots().clone(), half);
        let seed = 650 + i as u64;
        check_entries::<Inertia>("half", &EntryMoments::of(&law), &law, seed);
    }
}

/// A law that has no mean attitude, and its uniform limit.
#[test]
fn fisher_bingham_axes() {
    let roots =
        ScalarRoots::normal(RootSecondMoments::new([1.0, 1.2, 0.5]).unwrap(), [0.01, 0.02, 0.0])
            .unwrap();
    let precision = Matrix4::from_diagonal(&Vector4::new(1.0, -3.0, 2.0, 0.5));
    let axes = FisherBingham::new(precision, Vector4::new(0.3, 0.1, -0.5, 1.0)).unwrap();
    let law = PrincipalDispersion::new(roots.clone(), axes);
    check_entries::<Inertia>("Fisher-Bingham", &EntryMoments::of(&law), &law, 71);

    let flat = FisherBingham::new(Matrix4::zeros(), Vector4::zeros()).unwrap();
    let flat = EntryMoments::of(&PrincipalDispersion::new(roots.clone(), flat));
    let uniform = EntryMoments::of(&PrincipalDispersion::new(roots.clone(), UniformAttitude));
    for e in 0..6 {
        assert!((flat.mean()[e] - uniform.mean()[e]).abs() < 1e-12);
    }
    assert!((flat.covariance() - uniform.covariance()).amax() < 1e-12);
}

/// The half by cubature and the whole by contour are the same where the other half is empty.
#[test]
fn half_and_whole_agree_where_they_are_the_same() {
    let narrow = law([5.0, 4.0, 3.0], [0.3, 0.2, -0.5], [0.3, 0.1, 0.05], [1e-3, 2e-3, 4e-3, 0.01]);
    let k = narrow.roots().second_moment_statistics();
    let whole = narrow.axes().entry_moments(&k);
    let nodes = super_nodes(narrow.axes());
    let half = EntryMoments::by_quadrature(&k, nodes.iter().copied());
    let error = (whole.covariance() - half.covariance()).amax() / whole.covariance().amax();
    assert!(error < 0.02, "{error:e}");
    // And the law's own choice is the contour, to the bit.
    assert_eq!(MeanHalf::new(narrow.axes().clone()).entry_moments(&k), whole);
}

/// Weighted draws: a crude quadrature of a user's own.
fn super_nodes(law: &RadiallyConstrainedGaussian) -> Vec<(f64, UnitQuaternion<f64>)> {
    let mut rng = ChaCha8Rng::seed_from_u64(72);
    (0..100_000).map(|_| (2.0, law.sample(&mut rng))).collect()
}

#[test]
fn bad_moments_are_named() {
    let zero = SMatrix::<f64, 6, 6>::zeros();
    let error = EntryMoments::new([1.0, 1.0, 1.0, f64::NAN, 0.0, 0.0], zero).unwrap_err();
    assert!(error.to_string().contains("I12"), "{error}");
    let mut bad = zero;
    bad[(4, 4)] = -1.0;
    let error = EntryMoments::new([1.0; 6], bad).unwrap_err();
    assert!(error.to_string().contains("(5, 5)"), "{error}");
    assert!(EntryMoments::new([1.0; 6], zero).is_ok());
}

/// Narrow laws: to first order a small turn δ of the axes moves I by [δ×]I − I[δ×], so that
/// the products vary by the differences of the moments and the moments hardly at all.
#[test]
fn narrow_laws_keep_their_digits() {
    for variance in [1e-4_f64, 1e-6, 1e-8, 1e-10] {
        let law = law([5.0, 4.0, 3.0], [0.0; 3], [0.0; 3], [variance, variance, variance, 1.0]);
        let deviations = EntryMoments::of(&law).deviations();
        // Body rotations are twice the quaternion's vector part.
        let turn = 2.0 * variance.sqrt();
        for (found, expected) in deviations[3..].iter().zip([1.0, 2.0, 1.0]) {
            let error = found / (turn * expected) - 1.0;
            assert!(error.abs() < 20.0 * variance + 1e-6, "{variance:e}: {error:e}");
        }
        // I11 loses δ₃² + 2 δ₂², of deviation √(2 + 8) times the variance of a turn.
        let error = deviations[0] / (10.0_f64.sqrt() * turn * turn) - 1.0;
        assert!(error.abs() < 20.0 * variance + 1e-6, "{variance:e}: {error:e}");
    }
}

/// Without any spread of the axes, only the moments vary.
#[test]
fn fixed_axes_leave_the_closed_form() {
    let law = law([5.0, 4.0, 3.0], [0.0; 3], [0.1, 0.2, 0.3], [1e-13; 4]);
    let moments = EntryMoments::of(&law);
    let [v1, v2, v3] = law.roots().second_moment_statistics().variances();
    let expected = [v2 + v3, v1 + v3, v1 + v2];
    for (found, expected) in moments.deviations().iter().zip(expected) {
        assert!((found * found - expected).abs() < 1e-9, "{found} {expected}");
    }
    assert!((moments.covariance()[(0, 1)] - v3).abs() < 1e-9);
}

/// An inertia times an independent lognormal factor of mean one.
struct Times(Law, f64);

impl Distribution<InertiaMatrix> for Times {
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> InertiaMatrix {
        let Self(law, variance) = self;
        let s = variance.ln_1p().sqrt();
        let z: f64 = rand_distr::StandardNormal.sample(rng);
        let body: Inertia = law.sample(rng);
        InertiaMatrix::new(body.matrix() * (s * (z - 0.5 * s)).exp()).unwrap()
    }
}

/// Factors that hardly vary up to those that vary as much as they are.
#[test]
fn a_factor_scales_the_body() {
    for (i, variance) in [0.0, 1e-6, 1e-3, 0.05, 0.3].into_iter().enumerate() {
        let law =
            law([5.0, 4.0, 3.0], [0.3, 0.2, -0.5], [0.01, 0.02, 0.005], [0.001, 0.002, 0.01, 0.1]);
        let moments = EntryMoments::of(&law).times_factor(variance);
        check_entries(&format!("{variance}"), &moments, &Times(law, variance), 900 + i as u64);
    }
    let law = law([5.0, 4.0, 3.0], [0.3, 0.2, -0.5], [0.01; 3], [0.001; 4]);
    let plain = EntryMoments::of(&law);
    assert_eq!([plain.times_factor(-1.0), plain.times_factor(f64::NAN)], [plain; 2]);
}

/// The covariance of the entries by quadrature at every node of the contour: the definition, polynomial by polynomial.
fn covariance_by_definition(
    axes: &FisherBingham,
    k: &SecondMomentStatistics,
    mean: [f64; 6],
) -> SMatrix<f64, 6, 6> {
    let forms = |[x, y, z, w]: [Complex<f64>; 4]| {
        let square = x * x + y * y + z * z + w * w;
        let r = [
            [x * x - y * y - z * z + w * w, (x * y - z * w) * 2.0, (x * z + y * w) * 2.0],
            [(x * y + z * w) * 2.0, -x * x + y * y - z * z + w * w, (y * z - x * w) * 2.0],
            [(x * z - y * w) * 2.0, (y * z + x * w) * 2.0, -x * x - y * y + z * z + w * w],
        ];
        let fourth = square * square;
        let of = |k: usize| {
            ENTRIES.map(|(a, b)| fourth * f64::from(u8::from(a == b)) - r[k][a] * r[k][b])
        };
        (fourth, [of(0), of(1), of(2)])
    };
    let sums: [f64; 36] = axes.expect(|x| {
        let (fourth, forms) = forms(*x);
        let centred: [Complex<f64>; 6] = std::array::from_fn(|e| {
            (0..3).map(|j| forms[j][e] * k.mean()[j]).sum::<Complex<f64>>() - fourth * mean[e]
        });
        std::array::from_fn(|n| {
            let (e, f) = (n / 6, n % 6);
            let mut sum = centred[e] * centred[f];
            for j in 0..3 {
                for l in 0..3 {
                    sum += forms[j][e] * forms[l][f] * k.covariance()[(j, l)];
                }
            }
            sum
        })
    });
    SMatrix::from_row_slice(&sums)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Wide laws, narrow ones in any direction, and those that are narrow in some directions only: to seven digits of the
    /// deviations. Either way loses digits to laws that are much narrower in one direction than in another.
    #[test]
    fn moments_are_those_of_the_definition(
        sizes in prop::array::uniform4(-10.0..1.0_f64),
        shears in prop::array::uniform6(-0.5..0.5_f64),
        mean in prop::array::uniform4(-1.0..1.0_f64),
        k in prop::array::uniform3(0.1..5.0_f64),
        spread in prop::array::uniform6(-0.5..0.5_f64),
        fixed in any::<bool>(),
    ) {
        prop_assume!(Vector4::from(mean).norm() > 0.1);
        let [a, b, c, d, e, f] = shears;
        let root = Matrix4::new(
            1.0, 0.0, 0.0, 0.0, a, 1.0, 0.0, 0.0, b, c, 1.0, 0.0, d, e, f, 1.0,
        ) * Matrix4::from_diagonal(&Vector4::from(sizes.map(|e| 10f64.powf(0.5 * e))));
        let covariance = root * root.transpose();
        let mean = UnitQuaternion::from_quaternion(Vector4::from(mean).into());
        let precision = covariance.try_inverse().unwrap();
        let precision = (precision + precision.transpose()) * 0.5;
        let axes = FisherBingham::new(precision, precision * mean.coords).unwrap();
        let [a, b, c, d, e, f] = spread;
        let root = Matrix3::new(a, 0.0, 0.0, b, c, 0.0, d, e, f);
        let spread = if fixed { Matrix3::zeros() } else { root * root.transpose() };
        let k = SecondMomentStatistics::joint(k, spread);
        let found = axes.entry_moments(&k);
        let expected = covariance_by_definition(&axes, &k, found.mean());
        // Entries of size 1 to 30: what they hardly vary by is rounding.
        let deviations: [f64; 6] = std::array::from_fn(|e| expected[(e, e)].max(0.0).sqrt() + 1e-12);
        let forms = axes.expected_forms();
        for e in 0..6 {
            let mean: f64 = (0..3).map(|j| k.mean()[j] * forms[j][e]).sum();
            prop_assert!((mean - found.mean()[e]).abs() < 1e-14, "mean {e}");
            for f in 0..6 {
                let error = (found.covariance()[(e, f)] - expected[(e, f)]) / (deviations[e] * deviations[f]);
                prop_assert!(error.abs() < 1e-7, "{e}{f}: {error:e} of {:e}", deviations[e]);
            }
        }
    }
}
