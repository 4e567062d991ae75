//! Draws against what is known of their laws, and wrong draws that the same tests catch.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use gyradius_attitude::{
    HypersphericalAngles, MeanHalf, Method, RadiallyConstrainedGaussian, UniformAttitude,
};
use nalgebra::{Matrix3, Matrix4, Quaternion, UnitQuaternion, Vector4};
use rand::{Rng, RngExt};
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use rand_distr::Distribution;

/// Draws for every comparison of moments. With 14 moments and |z| < 4.5 a right sampler fails once
/// in ten thousand laws.
const N: usize = 200_000;
const Z: f64 = 4.5;

type Law = RadiallyConstrainedGaussian;

fn law(mean: [f64; 4], variances: [f64; 4]) -> Law {
    let mean = UnitQuaternion::from_quaternion(Quaternion::from(Vector4::from(mean)));
    Law::new(mean, Matrix4::from_diagonal(&variances.into())).unwrap()
}

/// Peck (2003), Eq. 27 and 30.
fn paper() -> Law {
    law([0.0249, 0.0005, -0.0100, 0.9996], [2e-5, 6e-4, 6e-4, 0.6])
}

fn rng(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

/// The largest deviation of the four means and ten second moments of draws from those of the law,
/// in standard errors.
fn worst_z(law: &Law, mut draw: impl FnMut() -> UnitQuaternion<f64>) -> f64 {
    let values = |x: &Vector4<f64>| {
        let mut all = [0.0; 14];
        let mut k = 4;
        for i in 0..4 {
            all[i] = x[i];
            for j in 0..=i {
                all[k] = x[i] * x[j];
                k += 1;
            }
        }
        all
    };
    let (mean, second) = (law.mean_vector(), law.second_moment());
    let mut expected = [0.0; 14];
    let mut k = 4;
    for i in 0..4 {
        expected[i] = mean[i];
        for j in 0..=i {
            expected[k] = second[(i, j)];
            k += 1;
        }
    }
    let (mut sum, mut squares) = ([0.0; 14], [0.0; 14]);
    for _ in 0..N {
        for (k, value) in values(&draw().coords).into_iter().enumerate() {
            sum[k] += value - expected[k];
            squares[k] += (value - expected[k]).powi(2);
        }
    }
    let n = N as f64;
    (0..14).map(|k| sum[k].abs() / squares[k].sqrt().max(1e-9 * n)).fold(0.0, f64::max)
}

/// Left multiplication by r turns the law into the one with the mean r ⊗ m and L(r) Σ L(r)ᵀ, right
/// multiplication likewise.
#[test]
fn turning_draws_turns_the_law() {
    let r = UnitQuaternion::from_euler_angles(0.4, -1.1, 2.0);
    let multiplication = |product: &dyn Fn(Quaternion<f64>) -> Quaternion<f64>| {
        Matrix4::from_columns(&std::array::from_fn::<_, 4, _>(|j| {
            product(Quaternion::from(Vector4::ith(j, 1.0))).coords
        }))
    };
    let left = multiplication(&|x| r.into_inner() * x);
    let right = multiplication(&|x| x * r.into_inner());
    for (seed, plain) in
        [paper(), law([1.0, 2.0, 3.0, 4.0], [0.1, 0.2, 0.3, 0.4])].into_iter().enumerate()
    {
        for (m, by_left) in [(left, true), (right, false)] {
            let turn = |q: UnitQuaternion<f64>| if by_left { r * q } else { q * r };
            let covariance = m * plain.covariance() * m.transpose();
            let covariance = (covariance + covariance.transpose()) * 0.5;
            let turned = Law::new(turn(plain.mean()), covariance).unwrap();
            assert!((turned.ln_normaliser() - plain.ln_normaliser()).abs() < 1e-10);
            let mut rng = rng(seed as u64);
            let q = UniformAttitude.sample(&mut rng);
            assert!((turned.ln_density(&turn(q)) - plain.ln_density(&q)).abs() < 1e-8);
            let z = worst_z(&turned, || turn(plain.sample(&mut rng)));
            assert!(z < Z, "left {by_left}: {z}");
            let z = worst_z(&turned, || plain.sample(&mut rng));
            assert!(z > 50.0, "unturned draws: {z}");
        }
    }
}

/// The moments catch, at the same number of draws: the Jacobian counted twice, a missing lobe, and a
/// covariance in the frame that the attitude leads to instead of the body's.
#[test]
fn wrong_draws_are_caught() {
    let right = paper();
    let mut rng = rng(11);
    let z = worst_z(&right, || right.sample(&mut rng));
    assert!(z < Z, "right: {z}");

    // On a wider law: next to the identity the Jacobian leaves little to draw.
    let wide = law([0.2, -0.1, 0.3, 0.9], [0.3, 0.4, 0.5, 0.8]);
    let doubled = worst_z(&wide, || {
        loop {
            let q = wide.sample(&mut rng);
            if rng.random::<f64>() < HypersphericalAngles::from(&q).jacobian() {
                return q;
            }
        }
    });
    assert!(doubled > 50.0, "Jacobian twice: {doubled}");

    let half = MeanHalf::new(right.clone());
    let one_lobe = worst_z(&right, || half.sample(&mut rng));
    assert!(one_lobe > 50.0, "one lobe: {one_lobe}");

    // A few degrees about one body axis only: in the other frame it is about another.
    let p = Matrix3::from_diagonal(&nalgebra::Vector3::new(4e-3, 1e-4, 1e-4));
    let mean = UnitQuaternion::from_euler_angles(0.9, -0.5, 2.2);
    let body = Law::from_rotation_covariance(mean, p, 0.01).unwrap();
    let turn = mean.to_rotation_matrix();
    let elsewhere =
        Law::from_rotation_covariance(mean, turn.matrix() * p * turn.matrix().transpose(), 0.01);
    let elsewhere = elsewhere.unwrap();
    let z = worst_z(&body, || body.sample(&mut rng));
    assert!(z < Z, "body frame: {z}");
    let z = worst_z(&body, || elsewhere.sample(&mut rng));
    assert!(z > 20.0, "wrong frame: {z}");
}

/// Laws in the spirit of the hardest: means between axes, eigenvalues of Σ far apart, equal or
/// infinite. Every method serves some of them.
#[test]
fn hard_laws_have_their_moments_and_accept_half_of_their_proposals() {
    let infinite = f64::INFINITY;
    let cases = [
        ([0.098_04, 0.006_388, -0.324_98, 8.8e-7], [0.051_770_6, 0.009_955_4, 1e-6, 8.93e-4]),
        ([-0.4099, 0.868_78, -0.858_79, 0.0], [1.0, 2.498e-5, 2.536e-5, 6.21e-5]),
        ([1.0648, 0.0, -0.9904, 0.3254], [2.941e-6, 3.138e-5, 8.019e-6, 1e8]),
        ([0.0, 0.0, 1.0, -0.5], [1e-8, 1e-8, 1.0, 1.0]),
        ([0.5, 0.5, 0.5, 0.5], [1e-8, 2e-8, 3e-8, 4e-8]),
        ([0.3, 0.5, 0.7, 0.2], [1e-8; 4]),
        ([0.3, 0.5, 0.7, 0.2], [1e8; 4]),
        ([0.3, 0.5, 0.7, 0.2], [1.0; 4]),
        ([0.3, 0.5, 0.7, 0.2], [1e-8, 1e-4, 1.0, 1e4]),
        ([0.3, 0.5, 0.7, 0.2], [1e-8, 0.3, 1.0, 2.0]),
        ([0.0, 0.0, 0.0, 1.0], [1e-5, 3e-5, 1e-4, infinite]),
        ([0.0, 0.0, 0.0, 1.0], [0.1, infinite, 0.3, infinite]),
        ([0.1, 0.7, 0.1, 0.7], [1e-3, 1e8, 1e-3, 1e8]),
    ];
    let mut methods = Vec::new();
    for (seed, (mean, variances)) in cases.into_iter().enumerate() {
        let law = law(mean, variances);
        assert!(law.acceptance() > 0.6, "{mean:?} {variances:?}: {}", law.acceptance());
        let mut rng = rng(seed as u64);
        let z = worst_z(&law, || law.sample(&mut rng));
        assert!(z < Z, "{mean:?} {variances:?} by {:?}: {z}", law.method());
        methods.push(law.method());
    }
    for method in [Method::Chart, Method::Cells, Method::Uniform] {
        assert!(methods.contains(&method), "{method:?} unused");
    }
}

/// Σ = s·1 is von Mises and Fisher's law: x·m has the density ∝ e^{t/s} √(1 − t²), and the rest is
/// isotropic. Kolmogorov's distance, by every method and in batches: √n D > 2.2 once in 8,000.
#[test]
fn isotropic_laws_are_von_mises_fishers() {
    for (s, method) in [(1e-3, Method::Chart), (1.0, Method::Cells), (30.0, Method::Uniform)] {
        let law = law([0.3, 0.5, 0.7, 0.2], [s; 4]);
        assert_eq!(law.method(), method, "s = {s}");
        let mut rng = rng(4);
        let single: Vec<_> = (0..N).map(|_| law.sample(&mut rng)).collect();
        let mut batch = vec![UnitQuaternion::identity(); N];
        law.sample_into(&mut rng, &mut batch);
        for draws in [single, batch] {
            let along = draws.iter().map(|q| q.coords.dot(&law.mean().coords)).collect();
            let d = kolmogorov(along, &fisher_cdf(s));
            assert!(d < 2.2, "s = {s}: {d}");
            // Across the mean, on S²: a coordinate is uniform.
            let across = Vector4::new(0.5, -0.3, 0.2, -0.7).normalize();
            let direction = |q: &UnitQuaternion<f64>| {
                let m = law.mean().coords;
                let rest = q.coords - m * q.coords.dot(&m);
                rest.dot(&across) / rest.norm()
            };
            assert!(across.dot(&law.mean().coords).abs() < 1e-15);
            let d = kolmogorov(draws.iter().map(direction).collect(), &|t| 0.5 * (t + 1.0));
            assert!(d < 2.2, "across, s = {s}: {d}");
        }
        // Negative control: draws of a law one part in thirty wider.
        let wider: Law = self::law([0.3, 0.5, 0.7, 0.2], [s * 1.033; 4]);
        let along = (0..N).map(|_| wider.sample(&mut rng).coords.dot(&law.mean().coords)).collect();
        let d = kolmogorov(along, &fisher_cdf(s));
        assert!(d > 2.2 || s > 10.0, "wider, s = {s}: {d}");
    }
}

/// The distribution function of t ∝ e^{t/s} √(1 − t²), tabulated by the midpoint rule in arccos t.
fn fisher_cdf(s: f64) -> impl Fn(f64) -> f64 {
    const STEPS: usize = 200_000;
    let width = std::f64::consts::PI / STEPS as f64;
    let mut sums = Vec::with_capacity(STEPS + 1);
    let mut sum = 0.0;
    sums.push(0.0);
    for i in 0..STEPS {
        // From t = −1 on.
        let angle = std::f64::consts::PI - (i as f64 + 0.5) * width;
        sum += ((angle.cos() - 1.0) / s).exp() * angle.sin().powi(2);
        sums.push(sum);
    }
    move |t| {
        let place = (std::f64::consts::PI - t.clamp(-1.0, 1.0).acos()) / width;
        let i = (place as usize).min(STEPS - 1);
        (sums[i] + (place - i as f64) * (sums[i + 1] - sums[i])) / sum
    }
}

fn kolmogorov(mut values: Vec<f64>, cdf: &dyn Fn(f64) -> f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let n = values.len() as f64;
    let distance = values.iter().enumerate().map(|(i, &x)| {
        let f = cdf(x);
        (f - i as f64 / n).max((i + 1) as f64 / n - f)
    });
    distance.fold(0.0, f64::max) * n.sqrt()
}

/// Ten million draws of the paper's example, one by one and in batches: none off unit norm by more
/// than 4 units in the last place.
#[test]
fn draws_are_unit_quaternions() {
    const DRAWS: usize = 10_000_000;
    let law = paper();
    let mut rng = rng(6);
    let off = |q: &UnitQuaternion<f64>| (q.norm() - 1.0).abs() > 4.0 * f64::EPSILON;
    assert_eq!((0..DRAWS).filter(|_| off(&law.sample(&mut rng))).count(), 0);
    let mut batch = vec![UnitQuaternion::identity(); 10_000];
    for _ in 0..DRAWS / batch.len() {
        law.sample_into(&mut rng, &mut batch);
        assert!(!batch.iter().any(off));
        UniformAttitude.sample_into(&mut rng, &mut batch);
        assert!(!batch.iter().any(off));
    }
}

/// An infinite variance along the mean: the second lobe weighs as much as the first, and consists of
/// the same attitudes.
#[test]
fn bingham_is_the_limit() {
    let mean = UnitQuaternion::from_euler_angles(0.9, -0.5, 2.2);
    let p = Matrix3::new(4e-6, 1e-6, 0.0, 1e-6, 2e-6, 0.0, 0.0, 0.0, 1e-6);
    let law = Law::from_rotation_covariance(mean, p, f64::INFINITY).unwrap();
    assert!(law.mean_vector().norm() < 1e-13);
    assert!((law.far_half_share() - 0.5).abs() < 1e-12);
    // To first order in p, which is a thousandth of a radian squared.
    assert!((law.rotation_covariance() - p).amax() < 1e-5 * p.amax());
    assert!(law.mean_attitude().angle_to(&mean) < 1e-12);
    let q = mean * UnitQuaternion::from_scaled_axis(nalgebra::Vector3::new(1e-3, 0.0, -1e-3));
    let opposite = UnitQuaternion::new_unchecked(-q.into_inner());
    assert!((law.ln_density(&q) - law.ln_density(&opposite)).abs() < 1e-8);
    let off_axis = Matrix4::from_diagonal(&Vector4::new(1.0, 1.0, 1.0, f64::INFINITY))
        + Matrix4::from_fn(|i, j| if i + j == 3 { 0.1 } else { 0.0 });
    assert!(Law::new(mean, off_axis).is_err(), "an infinite variance has to stand alone");
}

/// The share of the far half is that of draws, also where the rest of the far half is e^−1e8 of its peak:
/// there the pole at −m once passed for the peak.
#[test]
fn shares_of_the_far_half_are_those_of_draws() {
    let narrow = [
        (
            [-0.931_526_7, -0.065_808_4, -0.034_195_1, 0.356_030_8],
            [2.005e-8, 0.787_737, 1.567e-5, 6.791_837],
        ),
        (
            [0.436_424_7, -0.153_347_4, 0.882_235_9, -0.087_623_3],
            [1.78e-5, 1.335e-8, 5.18e-8, 9.8e7],
        ),
        ([0.511_577, 0.414_380_8, -0.172_748_3, 0.732_622_4], [1.07e-11, 1.67e-9, 9.5e-5, 9.4e-8]),
        ([-0.338_108_6, 0.773_703_3, -0.052_905_6, 0.533_166_8], [2.8e-7, 6.8e-14, 2.45e-4, 0.67]),
    ];
    let mut rng = rng(13);
    let random = (0..60).map(|i| {
        let q: UnitQuaternion<f64> = UniformAttitude.sample(&mut rng);
        let level = f64::from(i % 3) * 2.0 - 4.0;
        let variances = std::array::from_fn(|_| 10f64.powf(level + rng.random_range(-3.0..3.0)));
        (q.coords.into(), variances)
    });
    let random: Vec<_> = random.collect();
    let mut far_halves = 0;
    for (mean, variances) in narrow.into_iter().chain(random) {
        const DRAWS: usize = 20_000;
        let law = law(mean, variances);
        let share = law.far_half_share();
        assert!((0.0..=0.5 + 1e-9).contains(&share), "{mean:?} {variances:?}: {share}");
        let far = (0..DRAWS).filter(|_| !law.in_mean_half(&law.sample(&mut rng))).count() as f64;
        let n = DRAWS as f64;
        let error = (share * (1.0 - share) / n).sqrt().max(0.3 / n);
        let z = (far / n - share) / error;
        assert!(z.abs() < 4.5, "{mean:?} {variances:?}: {share}, of draws {}", far / n);
        far_halves += usize::from(share > 1e-3);
    }
    assert!(far_halves > 10, "{far_halves} with something in the far half");
}

/// The covariance of the attitude is that of draws, and to second order that of rotation vectors.
#[test]
fn rotation_covariances_are_those_of_draws() {
    let law = law([0.3, 0.5, 0.7, 0.2], [2e-3, 6e-3, 4e-3, 0.02]);
    let mean = law.mean_attitude();
    let mut rng = rng(8);
    let (mut double, mut vectors) = (Matrix3::zeros(), Matrix3::zeros());
    for _ in 0..N {
        let turn = mean.inverse() * law.sample(&mut rng);
        double += turn.imag() * turn.imag().transpose() * 4.0;
        let v = turn.scaled_axis();
        vectors += v * v.transpose();
    }
    let (double, vectors) = (double / N as f64, vectors / N as f64);
    let exact = law.rotation_covariance();
    for i in 0..3 {
        for j in 0..3 {
            let error = ((exact[(i, i)] * exact[(j, j)] + exact[(i, j)].powi(2)) / N as f64).sqrt();
            let z = (double[(i, j)] - exact[(i, j)]) / error;
            assert!(z.abs() < 6.0, "({i}, {j}): {z}");
            assert!((vectors[(i, j)] - exact[(i, j)]).abs() < 0.03 * exact.amax());
        }
    }
    // Exactly, by quadrature.
    let by_quadrature = law.by_quadrature().expect(|q| {
        let v = (mean.inverse() * q).imag();
        [4.0 * v.x * v.x, 4.0 * v.x * v.y, 4.0 * v.z * v.z]
    });
    let moments = [exact[(0, 0)], exact[(0, 1)], exact[(2, 2)]];
    for (a, b) in by_quadrature.iter().zip(moments) {
        assert!((a - b).abs() < 1e-12, "{a} {b}");
    }
}

/// A generator that is given by reference, as a trait object, will do.
#[test]
fn any_generator_will_do() {
    let mut chacha = rng(1);
    let dynamic: &mut dyn Rng = &mut chacha;
    let mut batch = [UnitQuaternion::identity(); 3];
    paper().sample_into(dynamic, &mut batch);
    let mut own = [UnitQuaternion::identity(); 3];
    paper().sample_into(&mut rng(1), &mut own);
    assert_eq!(batch, own);
}

/// Laws are equal if they are made alike, and differ if mean or covariance do, and so for what is made of them.
#[test]
fn laws_are_equal_as_they_are_made() {
    let made = |angle: f64, variances: [f64; 4]| {
        let mean = UnitQuaternion::from_euler_angles(angle, 0.1, 0.0);
        let covariance = Matrix4::from_diagonal(&variances.into());
        RadiallyConstrainedGaussian::new(mean, covariance).unwrap()
    };
    let all: Vec<_> = [0.0, 0.3]
        .into_iter()
        .flat_map(|angle| (0..4).map(move |i| (angle, i)))
        .map(|(angle, i)| {
            move || made(angle, std::array::from_fn(|j| if i == j { 0.02 } else { 0.01 }))
        })
        .collect();
    for (i, a) in all.iter().enumerate() {
        for (j, b) in all.iter().enumerate() {
            let (a, b) = (a(), b());
            // Whether a sampler has been set up plays no part.
            let _: UnitQuaternion<f64> = a.sample(&mut ChaCha8Rng::seed_from_u64(1));
            assert_eq!(a == b, i == j);
            assert_eq!(MeanHalf::new(a) == MeanHalf::new(b), i == j);
        }
    }
}
