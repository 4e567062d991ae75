//! Scalar laws against their definitions.

use super::*;
use proptest::prelude::*;
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

const INF: f64 = f64::INFINITY;

fn laws() -> Vec<ScalarLaw> {
    vec![
        ScalarLaw::normal(3.0, 2.0).unwrap(),
        ScalarLaw::uniform(-1.0, 4.0).unwrap(),
        ScalarLaw::lognormal(5.0, 0.5).unwrap(),
        ScalarLaw::lognormal(0.01, 0.05).unwrap(),
        ScalarLaw::truncated_normal(1.0, 2.0, 0.0, INF).unwrap(),
        ScalarLaw::truncated_normal(0.0, 1.0, -2.0, 2.0).unwrap(),
        ScalarLaw::truncated_normal(0.0, 1.0, 5.0, INF).unwrap(),
        ScalarLaw::truncated_normal(0.0, 1.0, -7.0, -4.0).unwrap(),
        ScalarLaw::truncated_normal(0.0, 1.0, 0.3, 0.31).unwrap(),
    ]
}

/// Kolmogorov and Smirnov's distance below its 1e-4 point; means and deviations to |z| < 4.
/// Another law of the same mean and deviation is told apart.
#[test]
fn draws_follow_the_law() {
    const N: usize = 40_000;
    let gap = |law: &ScalarLaw, draws: &[f64]| {
        let gaps = draws.iter().enumerate();
        let gap = gaps.map(|(i, x)| (law.cdf(*x) - (i as f64 + 0.5) / N as f64).abs());
        gap.fold(0.0, f64::max) * (N as f64).sqrt()
    };
    for (i, law) in laws().into_iter().enumerate() {
        let mut rng = ChaCha8Rng::seed_from_u64(300 + i as u64);
        let mut draws: Vec<f64> = (0..N).map(|_| law.sample(&mut rng)).collect();
        draws.sort_by(f64::total_cmp);
        assert!(gap(&law, &draws) < 2.23, "{law:?}: {}", gap(&law, &draws));
        if !matches!(law.0, Kind::Normal { .. }) && i != 5 {
            let other = ScalarLaw::normal(law.mean(), law.deviation()).unwrap();
            assert!(gap(&other, &draws) > 2.23, "{law:?} passes for normal");
        }
        let mean = draws.iter().sum::<f64>() / N as f64;
        let z = (mean - law.mean()) / law.deviation() * (N as f64).sqrt();
        assert!(z.abs() < 4.0, "{law:?}: mean {z}");
        let squares: Vec<f64> = draws.iter().map(|x| (x - law.mean()).powi(2)).collect();
        let variance = squares.iter().sum::<f64>() / N as f64;
        let spread = squares.iter().map(|s| (s - variance).powi(2)).sum::<f64>() / N as f64;
        let z = (variance - law.deviation().powi(2)) / (spread / N as f64).sqrt();
        // The variance of the fourth law hangs on its far tail.
        assert!(z.abs() < 4.0 || i == 3, "{law:?}: variance {z}");
    }
}

#[test]
fn probabilities_are_met() {
    let mut rng = ChaCha8Rng::seed_from_u64(310);
    for p in [0.0, 0.02, 0.5, 1.0] {
        let law = ScalarLaw::bernoulli(p).unwrap();
        let count = (0..10_000).map(|_| law.sample(&mut rng)).sum::<f64>();
        let z = (count - 1e4 * p) / (100.0 * law.deviation().max(1e-9));
        assert!(z.abs() < 4.0, "{p}: {count}");
        assert_eq!([law.cdf(-0.1), law.cdf(0.0), law.cdf(1.0)], [0.0, 1.0 - p, 1.0]);
    }
}

proptest! {
    /// F(F⁻¹(Φ(z))) is Φ(z), from both tails.
    #[test]
    fn scores_are_quantiles(z in -6.0..6.0f64) {
        for law in laws() {
            let x = law.at_score(z);
            let error = law.cdf(x) - below(z);
            prop_assert!(error.abs() < 1e-12, "{:?} {} {:e}", law, x, error);
            prop_assert!(law.at_score(z + 0.01) >= x);
        }
    }

    /// Without bounds that matter it is normal, in the tails too.
    #[test]
    fn wide_bounds_are_none(z in -7.0..7.0f64) {
        let law = ScalarLaw::truncated_normal(2.0, 3.0, -INF, INF).unwrap();
        prop_assert!((law.at_score(z) - (2.0 + 3.0 * z)).abs() < 1e-12);
    }
}

#[test]
fn laws_without_width_stay_put() {
    for law in [
        ScalarLaw::normal(2.0, 0.0),
        ScalarLaw::uniform(2.0, 2.0),
        ScalarLaw::truncated_normal(2.0, 0.0, 0.0, 3.0),
        ScalarLaw::lognormal(2.0, 0.0),
    ] {
        let law = law.unwrap();
        assert_eq!([law.at_score(-3.0), law.mean(), law.deviation()], [2.0, 2.0, 0.0]);
        assert_eq!([law.cdf(1.9), law.cdf(2.0)], [0.0, 1.0]);
    }
}

#[test]
fn bad_numbers_are_named() {
    use ScalarLaw as L;
    let cases = [
        (L::normal(f64::NAN, 1.0), "mean = NaN"),
        (L::normal(0.0, -1.0), "sigma = -1.0"),
        (L::normal(0.0, INF), "sigma = inf"),
        (L::uniform(1.0, 0.0), "bounds from 1.0 to 0.0"),
        (L::uniform(-INF, 0.0), "low = -inf"),
        (L::truncated_normal(0.0, 1.0, f64::NAN, 1.0), "low = NaN"),
        (L::truncated_normal(0.0, 1.0, 7.0, 8.0), "bounds from 7.0 to 8.0: the mean"),
        (L::truncated_normal(0.0, 0.0, 1.0, 2.0), "bounds from 1.0 to 2.0: the mean"),
        (L::truncated_normal(0.0, 1.0, 1.0, 1.0), "bounds from 1.0 to 1.0: the second"),
        (L::lognormal(0.0, 1.0), "a lognormal law about 0.0"),
        (L::lognormal(1e-100, 1e100), "sigma = 1e100"),
        (L::bernoulli(1.5), "probability = 1.5"),
        (L::bernoulli(f64::NAN), "probability = NaN"),
    ];
    for (law, expected) in cases {
        let message = law.unwrap_err().to_string();
        assert!(message.starts_with(expected), "{message}");
    }
}

#[cfg(feature = "serde")]
#[test]
fn serde_goes_through_the_constructors() {
    let bernoulli = [ScalarLaw::bernoulli(0.3).unwrap()];
    for law in laws().into_iter().chain(bernoulli) {
        let json = serde_json::to_string(&law).unwrap();
        assert!(json.contains(&format!(r#""law":"{}""#, law.name())), "{json}");
        assert_eq!(serde_json::from_str::<ScalarLaw>(&json).unwrap(), law, "{json}");
    }
    let refused = serde_json::from_str::<ScalarLaw>(r#"{"law":"normal","mean":0.0,"sigma":-1.0}"#);
    assert!(refused.unwrap_err().to_string().contains("sigma = -1.0"));
}
