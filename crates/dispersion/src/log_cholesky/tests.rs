//! Gaussians in log-Cholesky coordinates against their moments.

use super::*;
use crate::entry_moments::tests::check_entries;
use gyradius_inertia::{InertiaMatrix, SecondMoments};
use proptest::prelude::*;
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

fn payload() -> Inertia {
    let mean = InertiaMatrix::from_entries([5.0, 4.0, 3.0], [0.3, 0.2, -0.5]).unwrap();
    Inertia::try_from(mean).unwrap()
}

/// A covariance without structure, of deviations about `size`.
fn full(size: f64) -> SMatrix<f64, 6, 6> {
    let f = SMatrix::<f64, 6, 6>::from_fn(|i, j| size * ((3 * i + 5 * j) as f64).sin() / 2.0);
    f * f.transpose()
}

#[test]
fn draws_have_the_moments() {
    for (i, size) in [0.0, 1e-3, 0.1, 0.4].into_iter().enumerate() {
        let law = LogCholeskyGaussian::about(&payload(), full(size)).unwrap();
        let seed = 120 + i as u64;
        check_entries::<Inertia>(&format!("{size}"), &law.entry_moments(), &law, seed);
    }
}

/// The coordinates of the draws are the Gaussian that was asked for.
#[test]
fn coordinates_of_draws_are_gaussian() {
    const N: usize = 50_000;
    let covariance = full(0.3);
    let law = LogCholeskyGaussian::about(&payload(), covariance).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(125);
    let mut sum = SMatrix::<f64, 6, 6>::zeros();
    for _ in 0..N {
        let x = SVector::<f64, 6>::from(coordinates(&law.sample(&mut rng)).unwrap()) - law.mean;
        sum += x * x.transpose();
    }
    for i in 0..6 {
        for j in 0..6 {
            let variance = covariance[(i, i)] * covariance[(j, j)] + covariance[(i, j)].powi(2);
            let gap = sum[(i, j)] / N as f64 - covariance[(i, j)];
            assert!((gap / (variance / N as f64).sqrt()).abs() < 4.0, "{i}{j}");
        }
    }
}

#[test]
fn moments_of_entries_are_matched() {
    // Moments that a law of another family has.
    for delta in [0.01, 0.1, 0.3] {
        let moments = crate::Wishart::new(payload(), delta).unwrap().entry_moments();
        let found = LogCholeskyGaussian::matched(&moments).unwrap().entry_moments();
        let gap = (found.covariance() - moments.covariance()).amax();
        assert!(gap <= 1e-9 * moments.covariance().amax(), "{delta}: {gap}");
        for e in 0..6 {
            assert!((found.mean()[e] - moments.mean()[e]).abs() <= 5e-9);
        }
        // To first order it is near, and not there.
        let near = LogCholeskyGaussian::linearised(&moments).unwrap().entry_moments();
        let gap = (near.covariance() - moments.covariance()).amax();
        let size = moments.covariance().amax();
        assert!(gap > 1e-6 * size && gap < 10.0 * delta * size, "{delta}: {}", gap / size);
    }
    let far = EntryMoments::new(payload().entries(), full(20.0)).unwrap();
    assert_eq!(LogCholeskyGaussian::matched(&far), Err(LogCholeskyGaussianError::NoMatch));
}

proptest! {
    #[test]
    fn no_draw_is_unrealizable(
        mean in prop::array::uniform6(-3.0..3.0f64),
        size in 0.0..2.0f64,
        seed in 0..u64::MAX,
    ) {
        let law = LogCholeskyGaussian::new(mean, full(size)).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        for _ in 0..100 {
            prop_assert!(law.sample(&mut rng).as_inertia_matrix().is_realizable());
        }
    }
}

#[test]
fn bad_parameters_are_named() {
    let error = LogCholeskyGaussian::new([0.0; 6], -full(1.0)).unwrap_err();
    assert!(matches!(error, LogCholeskyGaussianError::Covariance(_)), "{error}");
    let error = LogCholeskyGaussian::new([0.0, f64::NAN, 0.0, 0.0, 0.0, 0.0], full(1.0));
    assert!(error.unwrap_err().to_string().contains("d2"));
    let error = LogCholeskyGaussian::new([0.0, 0.0, 0.0, 0.0, 0.0, 1e80], full(1.0));
    assert!(error.unwrap_err().to_string().contains("s13"));
    let wide = SMatrix::<f64, 6, 6>::identity() * 25.0;
    assert!(LogCholeskyGaussian::new([0.0; 6], wide).unwrap_err().to_string().contains("d1"));
    let plate = SecondMoments::new([1.0, 2.0, 0.0]).unwrap();
    let plate = Inertia::from_second_moments(plate, &nalgebra::UnitQuaternion::identity()).unwrap();
    let error = LogCholeskyGaussian::about(&plate, full(0.1)).unwrap_err();
    assert!(error.to_string().contains("a plate"), "{error}");
}

/// A law with these e^d, with s₁₂, s₂₃ and s₁₃ in these parts of the e^d of their rows' ends, and with coordinates that scatter about
/// as much as this spread.
fn scattered(
    seed: u64,
    spread: f64,
    roots: [f64; 3],
    parts: [f64; 3],
    scale: i32,
) -> LogCholeskyGaussian {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let [a, b, c] = roots.map(|root| root * 10_f64.powi(scale));
    let [s12, s23, s13] = [parts[0] * b, parts[1] * c, parts[2] * c];
    let mean = [a.ln(), b.ln(), c.ln(), s12, s23, s13];
    let normal = |_, _| rand_distr::StandardNormal.sample(&mut rng);
    let factor = SMatrix::<f64, 6, 6>::from_fn(normal) * (spread / 6_f64.sqrt());
    let units = SMatrix::<f64, 6, 6>::from_diagonal(&[1.0, 1.0, 1.0, b, c, c].into());
    let covariance = units * factor * factor.transpose() * units;
    LogCholeskyGaussian::new(mean, (covariance + covariance.transpose()) * 0.5).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    /// The moments of any law, narrow or wide, are those of a law that is found.
    #[test]
    fn what_a_law_has_is_found_again(
        seed in any::<u64>(),
        spread in -9.0..-0.22_f64,
        roots in prop::array::uniform3(0.3..3.0_f64),
        parts in prop::array::uniform3(-1.0..1.0_f64),
        scale in -6..7_i32,
    ) {
        let expected = scattered(seed, 10_f64.powf(spread), roots, parts, scale).entry_moments();
        let found = LogCholeskyGaussian::matched(&expected).unwrap().entry_moments();
        for e in 0..6 {
            let off = (found.mean()[e] - expected.mean()[e]).abs();
            prop_assert!(off <= 1.1e-9 * SVector::<f64, 6>::from(expected.mean()).amax());
        }
        let off = (found.covariance() - expected.covariance()).amax();
        prop_assert!(off <= 1.1e-9 * expected.covariance().amax());
    }

    /// No other law has its moments: the closed form is the law itself.
    #[test]
    fn the_closed_form_is_the_law(
        seed in any::<u64>(),
        spread in -6.0..-0.3_f64,
        roots in prop::array::uniform3(0.3..3.0_f64),
        parts in prop::array::uniform3(-1.0..1.0_f64),
        scale in -6..7_i32,
    ) {
        let law = scattered(seed, 10_f64.powf(spread), roots, parts, scale);
        let (mean, covariance) = closed::matched(&law.entry_moments()).unwrap();
        let deviations = law.covariance().diagonal().map(f64::sqrt);
        for i in 0..6 {
            prop_assert!((mean[i] - law.mean[i]).abs() <= 1e-6 * deviations[i], "{}", mean - law.mean);
            for j in 0..6 {
                let off = (covariance[(i, j)] - law.covariance()[(i, j)]).abs();
                prop_assert!(off <= 1e-6 * deviations[i] * deviations[j], "{i} {j}: {off:e}");
            }
        }
    }
}

/// Shares of a covariance of which a law has all and none has four fifths.
#[test]
fn a_law_is_found_beyond_shares_that_none_has() {
    let seeds = [
        (4386539613286760363, 0.4390457070013577, 2.6907043422498744),
        (1098402476913542184, 0.38671484887045016, 2.728902859113257),
        (13461146951602428446, 0.511024165292831, 2.848528196597181),
        (3560821332655516640, 0.5687447951820931, 2.307600093190639),
        (13527301636834058879, 0.5577936046482627, 1.9544017838156194),
    ];
    for (seed, spread, root) in seeds {
        let law = scattered(seed, spread, [0.3, 0.3, root], [0.0; 3], 0);
        let moments = law.entry_moments();
        let found = LogCholeskyGaussian::matched(&moments).unwrap();
        assert!((found.covariance() - law.covariance()).amax() < 1e-9 * law.covariance().amax());
        let share = EntryMoments::new(moments.mean(), moments.covariance() * 0.8).unwrap();
        let found = LogCholeskyGaussian::matched(&share);
        assert_eq!(found, Err(LogCholeskyGaussianError::NoMatch));
    }
}
