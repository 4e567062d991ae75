//! The radially constrained Gaussian against reference values and its own invariants.

use super::*;
use nalgebra::Quaternion;
use proptest::prelude::*;
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

/// Reference values of a law with a diagonal covariance, from the contour integral in 200-bit
/// arithmetic; the mean is normalised first.
struct Case {
    name: &'static str,
    mean: [f64; 4],
    variances: [f64; 4],
    ln_normaliser: f64,
    mean_vector: [f64; 4],
    /// Lower triangle of E[x xᵀ] by rows.
    second_moment: [f64; 10],
}

fn reference() -> Vec<Case> {
    vec![
        Case {
            name: "paper",
            mean: [0.0249, 0.0005, -0.01, 0.9996],
            variances: [2e-05, 0.0006, 0.0006, 0.6],
            ln_normaliser: -10.035477697452611,
            mean_vector: [
                0.02490154679418918,
                0.0005003551755707711,
                -0.010007103511415422,
                0.9299096550480864,
            ],
            second_moment: [
                0.0006400874794873405,
                1.2459617942002008e-05,
                0.0006006526746273734,
                -0.00024919235884004017,
                -5.007107534015433e-06,
                0.0007005444699309814,
                0.02315561389445006,
                0.0004649380923373893,
                -0.009298761846747786,
                0.9980587153759543,
            ],
        },
        Case {
            name: "iso1",
            mean: [0.0, 0.0, 0.0, 1.0],
            variances: [1.0, 1.0, 1.0, 1.0],
            ln_normaliser: 2.1051061453278597,
            mean_vector: [0.0, 0.0, 0.0, 0.24019372387008975],
            second_moment: [
                0.24019372387008975,
                0.0,
                0.24019372387008975,
                0.0,
                0.0,
                0.24019372387008975,
                0.0,
                0.0,
                0.0,
                0.27941882838973076,
            ],
        },
        Case {
            name: "diag1234",
            mean: [1.0, 2.0, 3.0, 4.0],
            variances: [0.1, 0.2, 0.3, 0.4],
            ln_normaliser: 0.3458571649223226,
            mean_vector: [
                0.1714838973168175,
                0.29154448146123724,
                0.36719867677087126,
                0.41737777666940246,
            ],
            second_moment: [
                0.12118547795454061,
                0.04383992680209719,
                0.22833220347508526,
                0.05359869977206694,
                0.08287501868197618,
                0.30059362651557814,
                0.05985849976616203,
                0.09189564569429172,
                0.10993689971892281,
                0.349888692054796,
            ],
        },
        Case {
            name: "aniso",
            mean: [1.0, -1.0, 1.0, -1.0],
            variances: [1e-06, 0.0001, 0.01, 1.0],
            ln_normaliser: -9.770789315952086,
            mean_vector: [
                0.5000027366843739,
                -0.5002738853332012,
                0.5291912302172037,
                -0.10240548964626271,
            ],
            second_moment: [
                0.25000373670080805,
                -0.2501383121042209,
                0.2503740495885614,
                0.26459707467923554,
                -0.2647416623049857,
                0.2903539303625083,
                -0.051202546024309036,
                0.051182849413806075,
                -0.04904726128489428,
                0.20926828334812225,
            ],
        },
        Case {
            name: "bimodal_antipodal_s4",
            mean: [0.02, -0.01, 0.03, 0.999],
            variances: [0.0001, 0.0002, 0.0003, 100.0],
            ln_normaliser: -9.478599176362945,
            mean_vector: [
                0.020008017720486052,
                -0.010005021981804337,
                0.030018107135323817,
                0.00997265958500535,
            ],
            second_moment: [
                0.000500330903257712,
                -0.0002001806651573454,
                0.0003001409734900034,
                0.0006006028557529055,
                -0.00030033185801688745,
                0.0012011780729828984,
                0.0001994931602752837,
                -9.973668084019878e-05,
                0.0002991803384889109,
                0.9979983500502694,
            ],
        },
    ]
}

fn law(mean: [f64; 4], variances: [f64; 4]) -> RadiallyConstrainedGaussian {
    let mean = UnitQuaternion::from_quaternion(Quaternion::from(Vector4::from(mean)));
    RadiallyConstrainedGaussian::new(mean, Matrix4::from_diagonal(&variances.into())).unwrap()
}

fn paper() -> RadiallyConstrainedGaussian {
    law([0.0249, 0.0005, -0.0100, 0.9996], [2e-5, 6e-4, 6e-4, 0.6])
}

#[test]
fn normaliser_and_moments_match_the_reference() {
    for case in reference() {
        let law = law(case.mean, case.variances);
        let error = law.ln_normaliser() - case.ln_normaliser;
        assert!(error.abs() < 1e-13, "{}: ln C off by {error:e}", case.name);
        let second = law.second_moment();
        let mut k = 0;
        for i in 0..4 {
            let error = law.mean_vector()[i] - case.mean_vector[i];
            assert!(error.abs() < 1e-13, "{}: E x{i} off by {error:e}", case.name);
            for j in 0..=i {
                let error = second[(i, j)] - case.second_moment[k];
                assert!(error.abs() < 1e-13, "{}: E x{i}x{j} off by {error:e}", case.name);
                k += 1;
            }
        }
    }
}

#[test]
fn acceptance_is_useful() {
    for case in reference() {
        let law = law(case.mean, case.variances);
        assert!(law.acceptance() > 0.6, "{}: {}", case.name, law.acceptance());
    }
    assert!(paper().acceptance() > 0.9999, "{}", paper().acceptance());
    assert_eq!(paper().method(), Method::Chart);
}

/// χ² of one coordinate in 40 bins against the marginal density by quadrature over the sphere.
fn chi_squared(
    samples: impl Iterator<Item = UnitQuaternion<f64>>,
    law: &RadiallyConstrainedGaussian,
) -> f64 {
    // Marginal of x₄: integrate the density over the two-sphere of (x₁, x₂, x₃), Gauss-Legendre
    // being unnecessary where the integrand is periodic and smooth.
    const BINS: usize = 40;
    const POINTS: usize = 64;
    let pi = std::f64::consts::PI;
    let density = |x4: f64| {
        let r = (1.0 - x4 * x4).sqrt();
        let mut sum = 0.0;
        for i in 0..POINTS {
            let z = -1.0 + 2.0 * (i as f64 + 0.5) / POINTS as f64;
            for j in 0..POINTS {
                let (s, c) = (2.0 * pi * j as f64 / POINTS as f64).sin_cos();
                let rho = r * (1.0 - z * z).sqrt();
                let q = Quaternion::new(x4, rho * c, rho * s, r * z);
                sum += law.ln_density(&UnitQuaternion::new_unchecked(q)).exp();
            }
        }
        r * sum * 4.0 * pi / (POINTS * POINTS) as f64
    };
    let mut expected = [0.0; BINS];
    for (bin, mass) in expected.iter_mut().enumerate() {
        for k in 0..8 {
            let x = -1.0 + (bin as f64 + (k as f64 + 0.5) / 8.0) * 2.0 / BINS as f64;
            *mass += density(x) * 2.0 / (8 * BINS) as f64;
        }
    }
    assert!((expected.iter().sum::<f64>() - 1.0).abs() < 2e-3);
    let mut counts = [0.0; BINS];
    let mut n = 0.0;
    for q in samples {
        counts[(((q.w + 1.0) * 0.5 * BINS as f64) as usize).min(BINS - 1)] += 1.0;
        n += 1.0;
    }
    counts.iter().zip(expected).map(|(c, e)| (c - n * e) * (c - n * e) / (n * e)).sum()
}

/// Draws of a mild law follow its density; draws with the Jacobian counted twice, or with one
/// lobe missing, do not, and the same test sees it at the same n.
#[test]
fn draws_follow_the_density_and_wrong_ones_do_not() {
    use rand::RngExt;
    const N: usize = 100_000;
    let law = law([0.2, -0.1, 0.3, 0.9], [0.3, 0.4, 0.5, 0.8]);
    let draws = || {
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        let law = law.clone();
        std::iter::repeat_with(move || law.sample(&mut rng))
    };
    // 39 degrees of freedom: 72 is exceeded once in a thousand.
    let right = chi_squared(draws().take(N), &law);
    assert!(right < 72.0, "{right}");
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    let doubled =
        draws().filter(|q| rng.random::<f64>() < HypersphericalAngles::from(q).jacobian());
    assert!(chi_squared(doubled.take(N), &law) > 1000.0);
    let one_lobe = draws().filter(|q| law.in_mean_half(q));
    assert!(chi_squared(one_lobe.take(N), &law) > 1000.0);
}

/// The far half of the paper's example holds 3.46 % of the mass.
#[test]
fn the_far_lobe_is_there() {
    const N: usize = 400_000;
    let law = paper();
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let far = (0..N).filter(|_| !law.in_mean_half(&law.sample(&mut rng))).count();
    let share = far as f64 / N as f64;
    let z = (share - FAR_SHARE) / (FAR_SHARE * (1.0 - FAR_SHARE) / N as f64).sqrt();
    assert!(z.abs() < 3.5, "share {share}, z = {z}");
}

/// The share of the far half against slices in 34 digits (mpmath), in the order of `reference`.
#[test]
fn the_far_half_is_known() {
    let shares = [
        FAR_SHARE,
        0.299_380_051_162_704_14,
        0.052_181_982_158_876_55,
        4.208_169_397_275_7e-19,
        0.495_008_673_263_920_45,
    ];
    for (case, share) in reference().into_iter().zip(shares) {
        let found = law(case.mean, case.variances).far_half_share();
        assert!((found / share - 1.0).abs() < 1e-12, "{}: {found:e} {share:e}", case.name);
    }
}

/// P(x·m < 0) for the paper's example: quadrature over slices of x·m, the normaliser of each
/// slice by a contour integral (mpmath, 50 digits).
const FAR_SHARE: f64 = 0.034_593_156_655_512_09;

#[test]
fn densities_are_consistent() {
    let law = paper();
    let q = UnitQuaternion::from_euler_angles(0.05, 0.01, -0.02);
    let angles = HypersphericalAngles::from(&q);
    let by_angles = law.ln_density_of_angles(&angles) - angles.jacobian().ln();
    assert!((by_angles - law.ln_density(&q)).abs() < 1e-9);
    let sum = law.ln_density(&q).exp() + law.ln_density(&opposite(&q)).exp();
    assert!((law.ln_attitude_density(&q) - sum.ln()).abs() < 1e-12);
    assert_eq!(law.ln_attitude_density(&q), law.ln_attitude_density(&opposite(&q)));
    // At the mean the exponent is zero.
    assert!((law.ln_density(&law.mean()) + law.ln_normaliser()).abs() < 1e-12);
}

#[test]
fn the_haar_density_of_a_flat_law_is_one_and_integrates_to_one() {
    let flat = law([0.1, 0.2, 0.3, 0.9], [1e12; 4]);
    let q = UnitQuaternion::from_euler_angles(0.5, 0.1, -0.2);
    assert!(flat.ln_haar_density(&q).abs() < 1e-11);
    // The mean over an even grid of attitudes is the integral.
    let law = law([0.2, -0.1, 0.3, 0.9], [0.3, 0.4, 0.5, 0.8]);
    let n = 20_000;
    let sum: f64 = crate::super_fibonacci(n).map(|q| law.ln_haar_density(&q).exp()).sum();
    assert!((sum / f64::from(n) - 1.0).abs() < 1e-3, "{}", sum / f64::from(n));
}

#[test]
fn bad_parameters_are_named() {
    let mean = UnitQuaternion::identity();
    let one = Matrix4::<f64>::identity();
    let with = |i, j, value| {
        let mut m = one;
        m[(i, j)] = value;
        m[(j, i)] = value;
        RadiallyConstrainedGaussian::new(mean, m)
    };
    assert!(matches!(with(1, 1, f64::NAN), Err(RcgError::Entry { row: 2, column: 2, .. })));
    assert!(matches!(with(1, 2, f64::INFINITY), Err(RcgError::Entry { .. })));
    for bad in [0.0, -1.0, 1e-300, 1e300, -0.0] {
        assert!(matches!(with(3, 3, bad), Err(RcgError::Eigenvalue { .. })), "{bad}");
    }
    assert!(matches!(with(0, 1, 1.0), Err(RcgError::Eigenvalue { .. })), "singular");
    assert!(matches!(with(0, 1, 1.1), Err(RcgError::Eigenvalue { .. })), "indefinite");
    let mut skew = one;
    skew[(2, 0)] = 0.3;
    assert!(matches!(
        RadiallyConstrainedGaussian::new(mean, skew),
        Err(RcgError::NotSymmetric { row: 1, column: 3, .. })
    ));
    for bad in [Quaternion::new(2.0, 0.0, 0.0, 0.0), Quaternion::new(f64::NAN, 0.0, 0.0, 0.0)] {
        let bad = UnitQuaternion::new_unchecked(bad);
        assert!(matches!(RadiallyConstrainedGaussian::new(bad, one), Err(RcgError::Mean { .. })));
    }
}

/// L(q) Σ L(q)ᵀ is symmetric to rounding of its variances, not of its own small entries.
#[test]
fn covariances_symmetric_to_rounding_are_accepted() {
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    let variances = Matrix4::from_diagonal(&Vector4::new(1e-4, 1e-4, 1e-4, 1e-2));
    for _ in 0..1000 {
        let m: UnitQuaternion<f64> = crate::UniformAttitude.sample(&mut rng);
        let (x, w) = (m.imag(), m.w);
        let left = Matrix4::new(
            w, -x.z, x.y, x.x, x.z, w, -x.x, x.y, -x.y, x.x, w, x.z, -x.x, -x.y, -x.z, w,
        );
        assert!(RadiallyConstrainedGaussian::new(m, left * variances * left.transpose()).is_ok());
    }
}

/// Σ cannot hold these: 20 decades of variances, off the coordinate axes.
#[cfg(feature = "serde")]
#[test]
fn laws_of_narrow_turns_are_read_back_to_the_bit() {
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    for variance in [1e-12, 1e-6, 1.0] {
        for radial in [1e-3, 1.0, f64::INFINITY] {
            let mean: UnitQuaternion<f64> = crate::UniformAttitude.sample(&mut rng);
            let turns = Matrix3::new(2.0, 0.3, 0.1, 0.3, 1.0, -0.2, 0.1, -0.2, 3.0) * variance;
            let law =
                RadiallyConstrainedGaussian::from_rotation_covariance(mean, turns, radial).unwrap();
            let json = serde_json::to_string(&law).unwrap();
            let back: RadiallyConstrainedGaussian = serde_json::from_str(&json).unwrap();
            assert_eq!(serde_json::to_string(&back).unwrap(), json);
            assert_eq!(back.covariance(), law.covariance());
            assert_eq!(back.ln_normaliser(), law.ln_normaliser());
            let mut two = [9, 9].map(ChaCha8Rng::seed_from_u64);
            assert_eq!(back.sample(&mut two[0]), law.sample(&mut two[1]));
            let bent = json.replace("\"principal_axes\":[[", "\"principal_axes\":[[1");
            assert!(serde_json::from_str::<RadiallyConstrainedGaussian>(&bent).is_err());
        }
    }
}

/// The first draws from a fixed seed, by every method: they change only on purpose.
#[test]
fn value_stability() {
    let chart = paper();
    let cells = law([1.0, 2.0, 3.0, 4.0], [0.1, 0.2, 0.3, 0.4]);
    let uniform = law([0.1, 0.2, 0.3, 0.9], [30.0, 40.0, 50.0, 60.0]);
    let methods = [&chart, &cells, &uniform].map(RadiallyConstrainedGaussian::method);
    assert_eq!(methods, [Method::Chart, Method::Cells, Method::Uniform]);
    let rng = || ChaCha8Rng::seed_from_u64(2003);
    let first = |law: &RadiallyConstrainedGaussian| -> [[f64; 4]; 2] {
        let mut rng = rng();
        std::array::from_fn(|_| law.sample(&mut rng).coords.into())
    };
    let mut batch = [UnitQuaternion::identity(); 2];
    chart.sample_into(&mut rng(), &mut batch);
    let batch = batch.map(|q| q.coords.into());
    let draws = [first(&chart), first(&cells), first(&uniform), batch];
    assert_eq!(draws, STABLE, "{draws:?}");
}

const STABLE: [[[f64; 4]; 2]; 4] = [
    [
        [0.021931335513137543, 0.028758680952151113, -0.022801111764040222, 0.9990856139965315],
        [0.01803179853973027, -0.023412739435957442, -0.013338272616791994, 0.9994742559751735],
    ],
    [
        [0.4781400671436293, 0.33720595561793343, 0.8074743528955786, 0.07522891135427],
        [0.05106772118743973, 0.37527717545126393, 0.9206337127346604, -0.09482982871669668],
    ],
    [
        [-0.36825331736519773, 0.3210772847171893, 0.624186793829993, 0.6096636104413626],
        [0.03501630558720559, -0.39485538788929203, -0.7197994827305837, 0.5698699725890143],
    ],
    [
        [0.021196543776986033, -0.04324901390506127, -0.025808891677750443, -0.9985059491252499],
        [0.01556455563597926, 0.03901980617150276, 0.023827323845572717, 0.9988330480979046],
    ],
];

/// A batch is independent of its length, and of the same law.
#[test]
fn batches_are_draws_of_the_law() {
    const N: usize = 400_000;
    let law = paper();
    let mut batch = vec![UnitQuaternion::identity(); N];
    law.sample_into(&mut ChaCha8Rng::seed_from_u64(5), &mut batch);
    let mut short = vec![UnitQuaternion::identity(); 1001];
    law.sample_into(&mut ChaCha8Rng::seed_from_u64(5), &mut short);
    assert_eq!(short[..], batch[..1001]);
    let second = law.second_moment();
    for i in 0..4 {
        for j in 0..=i {
            let values = || batch.iter().map(|q| q.coords[i] * q.coords[j]);
            let mean = values().sum::<f64>() / N as f64;
            let square = values().map(|v| (v - mean) * (v - mean)).sum::<f64>() / N as f64;
            let z = (mean - second[(i, j)]) / (square / N as f64).sqrt();
            assert!(z.abs() < 4.0, "E x{i} x{j}: z = {z}");
        }
    }
    let far = batch.iter().filter(|q| !law.in_mean_half(q)).count() as f64;
    let z = (far / N as f64 - FAR_SHARE) / (FAR_SHARE * (1.0 - FAR_SHARE) / N as f64).sqrt();
    assert!(z.abs() < 4.0, "far half: z = {z}");
    assert!(batch.iter().all(|q| (q.norm() - 1.0).abs() <= 4.0 * f64::EPSILON));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]
    /// Any covariance is served, and well.
    #[test]
    fn any_covariance_is_served(
        x in prop::array::uniform16(-1.0..1.0f64),
        level in -8.0..0.0f64,
        spread in prop::array::uniform4(0.0..8.0f64),
        mean in prop::array::uniform4(-1.0..1.0f64),
        seed in 0..u64::MAX,
    ) {
        let turn = Matrix4::from_row_slice(&x).qr().q();
        let variances = spread.map(|s| 10f64.powf(level + s));
        let covariance = turn * Matrix4::from_diagonal(&variances.into()) * turn.transpose();
        let covariance = (covariance + covariance.transpose()) * 0.5;
        let mean = Vector4::from(mean);
        prop_assume!(mean.norm() > 0.1);
        let mean = UnitQuaternion::from_quaternion(Quaternion::from(mean));
        let law = match RadiallyConstrainedGaussian::new(mean, covariance) {
            Ok(law) => law,
            Err(error) => return Err(TestCaseError::fail(error.to_string())),
        };
        prop_assert!(law.acceptance() > 0.6, "{} {:?}", law.acceptance(), law.method());
        prop_assert!(law.ln_normaliser().is_finite() && law.ln_normaliser() < 3.0);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        for _ in 0..10 {
            let q = law.sample(&mut rng);
            prop_assert!((q.norm() - 1.0).abs() < 1e-15 && law.ln_density(&q).is_finite());
        }
    }
}

fn opposite(q: &UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(-q.into_inner())
}
