//! The joint law over its whole space: bodies, moments, correlations, files, refusals.

use gyradius_attitude::{RadiallyConstrainedGaussian, UniformAttitude};
use gyradius_inertia::{Inertia, InertiaMatrix, MassProperties, PseudoInertia, Region};
use nalgebra::{Matrix4, SVector, UnitQuaternion, Vector3, Vector4};
use proptest::prelude::*;
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use rand_distr::Distribution;

use super::*;
use crate::{AxesLaw, FixedAttitude, ScalarLaw, Wishart};

/// The kind that does not vary.
const STILL: usize = 4;

/// Scalar laws of many kinds with about this mean and deviation, the mean positive.
pub(super) fn scalar(kind: usize, mean: f64, sigma: f64) -> ScalarLaw {
    let half = 3f64.sqrt() * sigma;
    match kind % 5 {
        0 => ScalarLaw::normal(mean, sigma),
        1 => ScalarLaw::uniform(mean - half, mean + half),
        2 => ScalarLaw::lognormal(mean, sigma),
        3 => ScalarLaw::truncated_normal(mean, sigma, mean - 1.5 * sigma, mean + 2.0 * sigma),
        _ => ScalarLaw::normal(mean, 0.0),
    }
    .unwrap()
}

pub(super) fn axes(kind: usize, turn: [f64; 3]) -> AxesLaw {
    let mean = UnitQuaternion::from_scaled_axis(Vector3::from(turn));
    match kind % 3 {
        0 => UniformAttitude.into(),
        1 => FixedAttitude::new(mean).into(),
        _ => {
            let covariance = Matrix4::from_diagonal(&Vector4::new(0.02, 0.01, 0.04, 0.9));
            RadiallyConstrainedGaussian::new(mean, covariance).unwrap().into()
        }
    }
}

pub(super) fn tensor(kind: usize, turn: [f64; 3], kinds: [usize; 3]) -> TensorLaw {
    let of = |size: f64| {
        let [a, b, c] = [0.3, 0.7, 0.5];
        [scalar(kinds[0], a * size, 0.1 * size), scalar(kinds[1], b * size, 0.12 * size), {
            scalar(kinds[2], c * size, 0.05 * size)
        }]
    };
    match kind % 4 {
        0 => TensorLaw::gyration_lengths(of(1.0), axes(kind / 4, turn)),
        1 => TensorLaw::roots(of(3.0), axes(kind / 4, turn)),
        2 => {
            let roots = TensorLaw::roots(of(3.0), axes(kind / 4, turn));
            roots.with_follows(0.6, 9.0).unwrap()
        }
        _ => {
            let mean = InertiaMatrix::from_entries([5.0, 4.0, 3.0], [0.2, 0.1, -0.5]).unwrap();
            let wishart = Wishart::new(Inertia::try_from(mean).unwrap(), 0.1).unwrap();
            TensorLaw::model(wishart).unwrap().with_follows(1.0, 9.0).unwrap()
        }
    }
}

pub(super) fn any_law() -> impl Strategy<Value = MassPropertiesLaw> {
    let kinds = prop::array::uniform7(0..5usize);
    let turn = prop::array::uniform3(-2.0..2.0f64);
    let vectors = prop::array::uniform7(prop::array::uniform2(-1.0..1.0f64));
    (kinds, 0..12usize, turn, vectors, 0..3usize).prop_map(|(kinds, kind, turn, vectors, ties)| {
        let centre = [0.4, 0.8, 0.3].map(|mean| (mean, 0.2));
        let centre = std::array::from_fn(|i| scalar(kinds[i + 1], centre[i].0, centre[i].1));
        let own = tensor(kind, turn, [kinds[4], kinds[5], kinds[6]]);
        let law = MassPropertiesLaw::new(scalar(kinds[0], 9.0, 1.1), centre, own).unwrap();
        // Coefficients of a few scalars, as products of unit vectors: no contradiction.
        let count = if kind % 4 == 3 { 4 } else { 7 };
        let picked: Vec<usize> = match ties {
            0 => vec![],
            1 => vec![0, count - 1],
            _ => vec![0, 2, count - 1],
        };
        let picked: Vec<usize> = picked.into_iter().filter(|i| kinds[*i] != STILL).collect();
        let unit = |i: usize| Vector3::new(vectors[i][0], vectors[i][1], 0.7).normalize();
        let mut pairs = Vec::new();
        for (n, &a) in picked.iter().enumerate() {
            for &b in &picked[..n] {
                pairs.push((JointScalar::ALL[a], JointScalar::ALL[b], unit(a).dot(&unit(b))));
            }
        }
        law.with_correlation(&pairs).unwrap()
    })
}

/// Largest |z| of means and covariances of draws against those expected.
pub(super) fn worst(moments: &TenMoments, rows: &[SVector<f64, 10>]) -> f64 {
    let n = rows.len() as f64;
    let halves = moments.covariance().rows(0, 4).into_owned();
    assert_eq!(halves, moments.covariance().columns(0, 4).transpose(), "both halves are one");
    let mut worst = 0f64;
    let mut count = |gap: f64, deviation: f64, size: f64| {
        if gap.abs() > 1e-9 * size {
            worst = worst.max(gap.abs() / (deviation / n.sqrt()));
        }
    };
    for i in 0..10 {
        let mean = moments.mean()[i];
        let sample = rows.iter().map(|row| row[i]).sum::<f64>() / n;
        count(sample - mean, moments.deviations()[i], 1.0 + mean.abs());
        for j in 0..=i {
            let product = |row: &SVector<f64, 10>| (row[i] - mean) * (row[j] - moments.mean()[j]);
            let average = rows.iter().map(product).sum::<f64>() / n;
            let spread = rows.iter().map(|r| (product(r) - average).powi(2)).sum::<f64>() / n;
            let size = moments.deviations()[i] * moments.deviations()[j];
            count(average - moments.covariance()[(i, j)], spread.sqrt(), 1e-3 + size);
        }
    }
    worst
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// 130 numbers of each of 32 laws: |z| < 6 is exceeded once in 100,000 times.
    #[test]
    fn moments_are_those_of_the_draws(law in any_law(), seed in any::<u64>()) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let draws: Vec<TenParameters> =
            (0..20_000).map(|_| MassPropertiesModel::draw(&law, &mut rng)).collect();
        let natural: Vec<_> = draws.iter().map(|ten| SVector::from(ten.values())).collect();
        let moments = law.moments().unwrap();
        let z = worst(&moments, &natural);
        prop_assert!(z < 6.0, "{z}");
        let linear: Vec<_> = draws.iter().map(TenParameters::linear).collect();
        let of_linear = law.linear_moments().unwrap();
        let z = worst(&of_linear, &linear);
        prop_assert!(z < 6.0, "{z}");
        // The control: the parallel-axis term left out.
        prop_assert!(worst(&moments, &linear) > 20.0);
    }

    #[test]
    fn draws_are_bodies(law in any_law(), seed in any::<u64>()) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        for _ in 0..200 {
            let body: MassProperties = law.sample(&mut rng);
            prop_assert!(body.inertia().as_inertia_matrix().is_realizable());
            prop_assert!(PseudoInertia::of(&body).is_ok());
            let ten = TenParameters::from(body);
            prop_assert!(ten.is_realizable());
            prop_assert_eq!(TenParameters::from_values(ten.values()).unwrap(), ten);
            let about = body.inertia_about([0.0; 3]).unwrap().entries();
            for (x, y) in ten.linear().iter().skip(4).zip(about) {
                prop_assert!((x - y).abs() < 1e-12 * about[0].max(1.0));
            }
        }
    }

    /// Batches have the same law, rows are columns, and long ones begin with short ones.
    #[test]
    fn batches_have_the_moments_and_are_bodies(law in any_law(), seed in any::<u64>()) {
        const N: usize = 20_000;
        let fill = |n: usize| {
            let mut columns: [Vec<f64>; 10] = std::array::from_fn(|_| vec![0.0; n]);
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            law.draw_columns(&mut rng, columns.each_mut().map(Vec::as_mut_slice)).unwrap();
            columns
        };
        let columns = fill(N);
        let row = |i: usize| columns.each_ref().map(|c| c[i]);
        for i in 0..300 {
            prop_assert!(TenParameters::from_values(row(i)).unwrap().is_realizable());
        }
        let rows: Vec<SVector<f64, 10>> = (0..N).map(|i| row(i).into()).collect();
        let z = worst(&law.moments().unwrap(), &rows);
        prop_assert!(z < 6.0, "{z}");
        let mut pairs = vec![[0.0; 10]; N];
        law.sample_into(&mut ChaCha8Rng::seed_from_u64(seed), &mut pairs);
        prop_assert!((0..N).all(|i| pairs[i] == row(i)));
        for n in [0, 1, 127, 128, 129, 300] {
            let short = fill(n);
            let whole = n / 128 * 128;
            for (short, long) in short.iter().zip(&columns) {
                prop_assert_eq!(&short[..whole], &long[..whole]);
            }
        }
    }

    #[cfg(feature = "serde")]
    #[test]
    fn files_keep_the_law(law in any_law()) {
        let json = serde_json::to_string(&law).unwrap();
        let back: MassPropertiesLaw = serde_json::from_str(&json).unwrap();
        let mut rngs = [4, 4].map(ChaCha8Rng::seed_from_u64);
        let bodies = [&law, &back].map(|law| {
            let body: MassProperties = law.sample(&mut rngs[0]);
            body
        });
        prop_assert_eq!(serde_json::to_string(&back).unwrap(), json);
        let again: MassProperties = back.sample(&mut rngs[1]);
        prop_assert_eq!(bodies[0], again);
    }
}

/// In a region every row of a batch is possible there, as one by one, and unequal columns are refused.
#[test]
fn batches_stay_in_the_region() {
    let region = Region::ellipsoid([0.4, 0.8, 0.3], [1.0, 1.1, 0.9]).unwrap();
    let centre = || [scalar(0, 0.4, 0.2), scalar(1, 0.8, 0.2), scalar(2, 0.3, 0.2)];
    for kind in 0..4 {
        let law =
            MassPropertiesLaw::new(scalar(0, 9.0, 1.1), centre(), tensor(kind, [0.0; 3], [0; 3]));
        let law = law.unwrap().inside(region.clone()).unwrap();
        let (share, _) = law.acceptance();
        assert!(share < 0.999, "{kind}: {share}");
        // A second region would have to replace the first.
        for second in [region.clone(), Region::solid_box([0.0; 3], [9.0; 3]).unwrap()] {
            let refused = law.clone().inside(second).unwrap_err();
            assert_eq!(refused, MassPropertiesLawError::Region(RegionAcceptanceError::Second));
        }
        let mut rows = vec![[0.0; 10]; 2000];
        law.sample_into(&mut ChaCha8Rng::seed_from_u64(1), &mut rows);
        let body = |row: &[f64; 10]| TenParameters::from_values(*row).unwrap();
        let held = |row| region.room(&MassProperties::try_from(body(row)).unwrap()) > -1e-13;
        assert!(rows.iter().all(held), "{kind}");
        let mut columns: [Vec<f64>; 10] = std::array::from_fn(|e| vec![0.0; 10 + e / 9]);
        let rng = &mut ChaCha8Rng::seed_from_u64(1);
        let error = law.sample_columns(rng, columns.each_mut().map(Vec::as_mut_slice)).unwrap_err();
        assert_eq!(error.lengths, [10, 11]);
    }
}

/// Moments in a region are those of other draws that are kept to it, and not those without it.
#[test]
fn moments_in_a_region_are_those_of_its_draws() {
    const N: usize = 30_000;
    let region = Region::ellipsoid([0.4, 0.8, 0.3], [0.8, 0.8, 0.8]).unwrap();
    let centre = || [scalar(0, 0.4, 0.2), scalar(1, 0.8, 0.2), scalar(2, 0.3, 0.2)];
    for kind in 0..4 {
        let law =
            MassPropertiesLaw::new(scalar(0, 9.0, 1.1), centre(), tensor(kind, [0.0; 3], [0; 3]));
        let open = law.unwrap();
        assert_eq!(open.moments_in_region(), None);
        let law = open.clone().inside(region.clone()).unwrap();
        assert_eq!(law.moments(), None);
        let sums = law.moments_in_region().unwrap();
        let (share, _) = law.acceptance();
        assert_eq!(sums.count(), (share * 20_000.0).round() as u64);
        let (mean, spread) = (sums.mean().unwrap(), sums.spread().unwrap());
        let mut rows = vec![[0.0; 10]; N];
        law.sample_into(&mut ChaCha8Rng::seed_from_u64(9), &mut rows);
        let more = (1.0 + sums.count() as f64 / N as f64).sqrt();
        let mut gap = 0_f64;
        for i in 0..10 {
            let average = rows.iter().map(|row| row[i]).sum::<f64>() / N as f64;
            let variance =
                rows.iter().map(|row| (row[i] - average).powi(2)).sum::<f64>() / N as f64;
            let z = (average - mean[i]) / (spread.mean_error[i] * more);
            assert!(z.abs() < 4.5, "{kind} {i}: {z}");
            let z = (variance.sqrt() - spread.deviation[i]) / (spread.deviation_error[i] * more);
            assert!(z.abs() < 4.5, "{kind} {i}: {z}");
            let without = open.moments().map_or(0.0, |moments| moments.deviations()[i]);
            gap = gap.max((without - spread.deviation[i]).abs() / spread.deviation_error[i]);
        }
        assert!(gap > 10.0, "negative control: {kind} {gap}");
    }
}

/// An inertia from gyration lengths follows the mass, one from roots does not, and a share is between.
#[test]
fn inertia_follows_the_mass_as_said() {
    let mass = ScalarLaw::normal(9.0, 0.9).unwrap();
    let still = || ScalarLaw::normal(0.0, 0.0).unwrap();
    let fixed = |x: f64| [ScalarLaw::normal(x, 0.0).unwrap(), still(), still()];
    let axes = || FixedAttitude::new(UnitQuaternion::identity());
    let relative = |tensor: TensorLaw| {
        let law =
            MassPropertiesLaw::new(mass.clone(), [still(), still(), still()], tensor).unwrap();
        let moments = law.moments().unwrap();
        let correlated = moments.covariance()[(0, 5)] > 0.0;
        (moments.deviations()[5] / moments.mean()[5], correlated)
    };
    let near = |(found, correlated): (f64, bool), expected: f64| {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        assert_eq!(correlated, expected > 0.0);
    };
    near(relative(TensorLaw::gyration_lengths(fixed(1.0), axes())), 0.1);
    near(relative(TensorLaw::roots(fixed(3.0), axes())), 0.0);
    near(relative(TensorLaw::roots(fixed(3.0), axes()).with_follows(1.0, 9.0).unwrap()), 0.1);
    near(relative(TensorLaw::roots(fixed(3.0), axes()).with_follows(0.3, 9.0).unwrap()), 0.03);
}

/// A mass that scatters widely is never negative, and its moments are those of what is left.
#[test]
fn masses_are_positive() {
    let still = || ScalarLaw::normal(0.1, 0.0).unwrap();
    let lengths = || TensorLaw::gyration_lengths([still(), still(), still()], UniformAttitude);
    let law = |mass| MassPropertiesLaw::new(mass, [still(), still(), still()], lengths());
    let wide = law(ScalarLaw::normal(1.0, 1.0).unwrap()).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let masses: Vec<f64> = (0..40_000)
        .map(|_| {
            let body: MassProperties = wide.sample(&mut rng);
            body.mass_kg()
        })
        .collect();
    assert!(masses.iter().all(|m| *m > 0.0));
    let mean = masses.iter().sum::<f64>() / masses.len() as f64;
    // 1 + φ(1)/Φ(1).
    let expected = 1.287_599_970_939_178;
    assert!((wide.moments().unwrap().mean()[0] - expected).abs() < 1e-9);
    assert!((mean - expected).abs() < 4.0 * 0.8 / 200.0, "{mean}");
    for mass in
        [ScalarLaw::uniform(-1.0, 3.0), ScalarLaw::normal(-1.0, 0.1), ScalarLaw::normal(0.0, 1.0)]
    {
        let error = law(mass.unwrap()).unwrap_err();
        assert!(matches!(error, MassPropertiesLawError::Mass { .. }), "{error}");
    }
    assert!(law(ScalarLaw::uniform(0.0, 3.0).unwrap()).is_ok());
}

proptest! {
    /// What does not vary has its own value as the mean and a deviation of zero, to the bit, whatever varies beside it.
    #[test]
    fn what_is_known_has_no_deviation(
        kind in 0..16_usize, kinds in prop::array::uniform3(0..5_usize), still in 0..16_u8, values in prop::array::uniform4(-4.0..4.0_f64), law in 0..4_usize,
    ) {
        let values = values.map(|x| 10_f64.powf(x));
        let scalars = [0, 1, 2, 3].map(|i| {
            let (value, same) = (values[i], [values[i]; 2]);
            match law {
                _ if still >> i & 1 == 0 => scalar(kinds[i % 3], value, 0.1 * value),
                0 => ScalarLaw::normal(value, 0.0).unwrap(),
                1 => ScalarLaw::uniform(value, value).unwrap(),
                2 => ScalarLaw::triangular(value, value, value).unwrap(),
                _ => ScalarLaw::samples(&same).unwrap(),
            }
        });
        let [mass, x, y, z] = scalars;
        let law = MassPropertiesLaw::new(mass, [x, y, z], tensor(kind, [0.3, 0.1, 0.2], kinds)).unwrap();
        let moments = law.moments().unwrap();
        for i in (0..4).filter(|i| still >> i & 1 == 1) {
            prop_assert_eq!(moments.deviations()[i], 0.0);
            prop_assert_eq!(moments.mean()[i], values[i]);
            prop_assert!((0..10).all(|j| moments.covariance()[(i, j)] == 0.0));
        }
    }

    /// Whatever the law of a mass: it is taken as it is if it is next to never negative, if it is normal and scatters by no more than its
    /// mean as what is above zero of it, and not at all otherwise; and no draw is negative.
    #[test]
    fn one_bound_is_for_all_masses(
        kind in 0..8_usize, deviations in prop_oneof![-1.0..12.0_f64, 7.5..8.5_f64, Just(8.0)], sigma in 1e-3..1e3_f64, cut in 0.1..4.0_f64,
    ) {
        let mean = deviations * sigma;
        let (high, far) = (mean + cut * sigma, f64::INFINITY);
        let mass = match kind {
            0..5 => scalar(if kind == 2 { 0 } else { kind }, mean, sigma),
            5 => ScalarLaw::truncated_normal(mean, sigma, -far, high).unwrap(),
            6 => ScalarLaw::truncated_normal(mean, sigma, mean - cut * sigma, far).unwrap(),
            _ => ScalarLaw::samples(&[mean, high]).unwrap(),
        };
        let below_zero = mass.cdf(0.0);
        let still = || ScalarLaw::normal(0.1, 0.0).unwrap();
        let lengths = TensorLaw::gyration_lengths([still(), still(), still()], UniformAttitude);
        let law = MassPropertiesLaw::new(mass.clone(), [still(), still(), still()], lengths);
        // What eight deviations below the mean of a normal law is.
        let never = below_zero <= 6.2210e-16;
        let is_cut = !never && mass.as_normal().is_some() && deviations >= 1.0;
        prop_assert_eq!(law.is_ok(), never || is_cut, "{:?} {}", mass, below_zero);
        let Ok(law) = law else { return Ok(()) };
        prop_assert_eq!(law.mass() == &mass, never);
        prop_assert!(kind != 0 || deviations < 8.0 || never);
        let mut rng = ChaCha8Rng::seed_from_u64(sigma.to_bits());
        let mut rows = vec![[0.0; 10]; 64];
        law.sample_into(&mut rng, &mut rows);
        prop_assert!(rows.iter().all(|row| row[0] > 0.0));
    }
}

#[test]
fn what_is_no_law_is_refused_by_name() {
    let still = || ScalarLaw::normal(1.0, 0.0).unwrap();
    let centre = || [still(), still(), still()];
    let lengths = |x: f64| {
        TensorLaw::gyration_lengths(
            [ScalarLaw::normal(x, 0.0).unwrap(), still(), still()],
            UniformAttitude,
        )
    };
    for (mass, length, what) in [(1e100, 1e40, "gyration"), (1e-3, 1e80, "gyration")] {
        let mass = ScalarLaw::normal(mass, 0.0).unwrap();
        let error = MassPropertiesLaw::new(mass, centre(), lengths(length)).unwrap_err();
        assert!(error.to_string().starts_with(what), "{error}");
    }
    let far = ScalarLaw::normal(1e90, 0.0).unwrap();
    let error = MassPropertiesLaw::new(still(), [far, still(), still()], lengths(1.0)).unwrap_err();
    assert!(error.to_string().starts_with("mass centre"), "{error}");
    let entries = InertiaMatrix::from_entries([5.0, 4.0, 3.0], [0.0; 3]).unwrap();
    let naive = crate::EntrywiseGaussian::new(entries, [0.5; 6]).unwrap();
    let error = TensorLaw::model(naive).unwrap_err();
    assert!(error.to_string().contains("entrywise"), "{error}");
    assert_eq!(lengths(1.0).with_follows(1.0, 1.0), Err(TensorLawError::FollowsAnyway));
    let tensor = tensor(3, [0.0; 3], [0; 3]);
    for (share, mass) in [(-0.1, 1.0), (1.1, 1.0), (f64::NAN, 1.0), (0.5, 0.0), (0.5, f64::NAN)] {
        assert!(tensor.clone().with_follows(share, mass).is_err());
    }
    let law = MassPropertiesLaw::new(still(), centre(), tensor).unwrap();
    let pair = [(JointScalar::Mass, JointScalar::Shape2, 0.5)];
    let error = law.clone().with_correlation(&pair).unwrap_err();
    assert_eq!(error, MassPropertiesLawError::NoShape { scalar: JointScalar::Shape2 });
    let pair = [(JointScalar::Mass, JointScalar::Centre2, 1.5)];
    let error = law.with_correlation(&pair).unwrap_err().to_string();
    assert!(error.starts_with("correlation of mass and centre2: "), "{error}");
}

/// A mass that counts twice, in the lengths and as a factor, is found by the moments: a negative control.
#[test]
fn a_mass_that_counts_twice_is_found() {
    let law = MassPropertiesLaw::new(
        scalar(0, 9.0, 0.9),
        [scalar(0, 0.1, 0.01), scalar(0, 0.1, 0.01), scalar(0, 0.1, 0.01)],
        tensor(8, [0.0; 3], [0; 3]),
    )
    .unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    let twice: Vec<SVector<f64, 10>> = (0..20_000)
        .map(|_| {
            let body: MassProperties = law.sample(&mut rng);
            let again = body.inertia().matrix() * (body.mass_kg() / 9.0);
            let inertia = InertiaMatrix::new(again).unwrap();
            TenParameters { inertia, ..body.into() }.values().into()
        })
        .collect();
    assert!(worst(&law.moments().unwrap(), &twice) > 10.0);
}

/// 1e8 draws, none of which is of no body or outside of its shape. It takes two minutes:
/// `cargo test -p gyradius-dispersion --lib hundred_million -- --ignored`.
#[test]
#[ignore = "two minutes"]
fn a_hundred_million_draws_are_bodies_in_their_shape() {
    const ROWS: usize = 4096;
    let region = Region::ellipsoid([0.4, 0.8, 0.3], [1.0, 1.1, 0.9]).unwrap();
    let centre = [scalar(0, 0.4, 0.2), scalar(1, 0.8, 0.2), scalar(2, 0.3, 0.2)];
    let law = MassPropertiesLaw::new(scalar(0, 9.0, 1.1), centre, tensor(8, [0.3; 3], [0; 3]));
    let law = law.unwrap().inside(region.clone()).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    let mut rows = vec![[0.0; 10]; ROWS];
    let mut done = 0_u64;
    while done < 100_000_000 {
        law.sample_into(&mut rng, &mut rows);
        for row in &rows {
            let ten = TenParameters::from_values(*row).unwrap();
            let body = MassProperties::try_from(ten).unwrap_or_else(|e| panic!("{row:?}: {e}"));
            assert!(region.room(&body) > -1e-12, "{row:?}");
        }
        done += ROWS as u64;
    }
}

proptest! {
    /// Any scalars that vary or not, of lengths or roots: coefficients are taken of those that vary alone, and a law that has them
    /// is written and read.
    #[test]
    fn what_does_not_vary_has_no_correlation(still in prop::array::uniform7(any::<bool>()), of_lengths: bool, c in -0.3..0.3_f64) {
        let law = |scalar: JointScalar| {
            let deviation = if still[scalar as usize] { 0.0 } else { 0.01 };
            ScalarLaw::normal(1.0, deviation).unwrap()
        };
        use JointScalar::{Centre1, Centre2, Centre3, Mass, Shape1, Shape2, Shape3};
        let sizes = [Shape1, Shape2, Shape3].map(law);
        let uniform = UniformAttitude;
        let tensor = if of_lengths { TensorLaw::gyration_lengths(sizes, uniform) } else { TensorLaw::roots(sizes, uniform) };
        let plain = MassPropertiesLaw::new(law(Mass), [Centre1, Centre2, Centre3].map(law), tensor).unwrap();
        for a in JointScalar::ALL {
            for b in JointScalar::ALL.into_iter().filter(|b| *b != a) {
                for coefficient in [c, 0.0] {
                    let tied = plain.clone().with_correlation(&[(a, b, coefficient)]);
                    let first = [a, b].into_iter().find(|scalar| still[*scalar as usize]);
                    match (first, tied) {
                        (None, Ok(tied)) => {
                            prop_assert_eq!(tied.correlation().coefficient(a as usize, b as usize), coefficient);
                            #[cfg(feature = "serde")]
                            {
                                let text = serde_json::to_string(&tied).unwrap();
                                prop_assert_eq!(serde_json::from_str::<MassPropertiesLaw>(&text).unwrap(), tied);
                            }
                        }
                        (Some(scalar), Err(error)) => {
                            prop_assert_eq!(error, MassPropertiesLawError::Still { scalars: [a, b], scalar });
                        }
                        (expected, found) => prop_assert!(false, "{expected:?}: {found:?}"),
                    }
                }
            }
        }
    }
}
