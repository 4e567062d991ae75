//! Scalar laws against their definitions.

use super::parameters::Value;
use super::*;
use crate::normal::below;
use proptest::prelude::*;
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

mod far;
mod scores;

const INF: f64 = f64::INFINITY;

fn laws() -> Vec<ScalarLaw> {
    laws::examples().into_iter().map(|(law, _)| law).collect()
}

/// Whether a value has a probability of its own.
fn has_steps(law: &ScalarLaw) -> bool {
    law.at_score(0.5) == law.at_score(0.5 + 1e-9)
}

/// Two draws by score and two in the quickest way, each pair from a new generator: a change alters results, and
/// needs a **values** entry in the changelog.
#[test]
fn draws_are_pinned() {
    let mut differing = String::new();
    for (law, pinned) in laws::examples() {
        let rng = || ChaCha8Rng::seed_from_u64(2003);
        let (mut one, mut other) = (rng(), rng());
        let score: [f64; 2] = std::array::from_fn(|_| law.sample(&mut one));
        let quick: [f64; 2] = std::array::from_fn(|_| law.draw(&mut other));
        let found = [score[0], score[1], quick[0], quick[1]];
        if found.map(f64::to_bits) != pinned.map(f64::to_bits) {
            differing += &format!("{law:?} => {found:?}\n");
        }
    }
    assert!(differing.is_empty(), "values have changed:\n{differing}");
}

/// Mean, deviation, and mean and variance of the square, against Simpson's rule over scores.
#[test]
fn moments_agree_with_quadrature() {
    const N: u32 = 90_000;
    for law in laws() {
        let step = 36.0 / f64::from(N);
        let nodes: Vec<(f64, f64)> = (0..=N)
            .map(|i| {
                let z = -18.0 + step * f64::from(i);
                let weight = if i % N == 0 { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
                let density = libm::exp(-0.5 * z * z) / (2.0 * std::f64::consts::PI).sqrt();
                (law.at_score(z), weight * density * step / 3.0)
            })
            .collect();
        let over = |f: &dyn Fn(f64) -> f64| nodes.iter().map(|(x, w)| w * f(*x)).sum::<f64>();
        let mean = over(&|x| x);
        let variance = over(&|x| (x - mean) * (x - mean));
        let square = over(&|x| x * x);
        let square_variance = over(&|x| (x * x - square) * (x * x - square));
        let found = law.square_moments();
        // The rule takes a step of the law for a slope.
        let room = if has_steps(&law) { 1e-3 } else { 1e-8 };
        for (what, found, expected) in [
            ("mean", law.mean(), mean),
            ("deviation", law.deviation(), variance.sqrt()),
            ("mean of the square", found.0, square),
            ("deviation of the square", found.1.sqrt(), square_variance.sqrt()),
        ] {
            assert!(
                (found - expected).abs() <= room * expected.abs().max(law.deviation()),
                "{law:?}: {what} {found:?} {expected:?}"
            );
        }
    }
}

/// No draw exceeds the reach, and a law can go nearly there.
#[test]
fn draws_are_within_reach() {
    for law in laws() {
        let far = [-8.0, 8.0].map(|z| law.at_score(z).abs());
        let most = far[0].max(far[1]);
        assert!(most <= law.reach(15.0), "{law:?}: {most} {}", law.reach(15.0));
        assert!(law.reach(7.0) < 100.0 * most, "{law:?}: {most} {}", law.reach(7.0));
    }
}

/// Kolmogorov and Smirnov's distance below its 1e-4 point; means and deviations to |z| < 4.
/// Another law of the same mean and deviation is told apart.
#[test]
fn draws_follow_the_law() {
    const N: usize = 40_000;
    let gap = |law: &ScalarLaw, draws: &[f64]| {
        // Of equal draws, how many there are up to the last.
        let last = |i: usize| i + 1 == N || draws[i + 1] > draws[i];
        let gap = |i: usize| (law.cdf(draws[i]) - (i as f64 + 1.0) / N as f64).abs();
        (0..N).filter(|i| last(*i)).map(gap).fold(0.0, f64::max) * (N as f64).sqrt()
    };
    for (i, law) in laws().into_iter().enumerate() {
        let mut rng = ChaCha8Rng::seed_from_u64(300 + i as u64);
        let mut draws: Vec<f64> = (0..N).map(|_| law.sample(&mut rng)).collect();
        draws.sort_by(f64::total_cmp);
        assert!(gap(&law, &draws) < 2.23, "{law:?}: {}", gap(&law, &draws));
        let quick: &mut Vec<f64> = &mut (0..N).map(|_| law.draw(&mut rng)).collect();
        quick.sort_by(f64::total_cmp);
        assert!(gap(&law, quick) < 2.23, "{law:?}: {}", gap(&law, quick));
        // A law kept to two deviations, and a beta law of large parameters, are nearly normal.
        if law.name() != "normal" && nearly_normal(&law) > 2.0 * 2.23 / (N as f64).sqrt() {
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
        // The variance of a wide lognormal law hangs on its far tail.
        let heavy = law.square_moments().1.sqrt() > 100.0 * law.square_moments().0;
        assert!(z.abs() < 4.0 || heavy, "{law:?}: variance {z}");
    }
}

/// How far a law is from the normal one of the same mean and deviation, at the deviations.
fn nearly_normal(law: &ScalarLaw) -> f64 {
    let normal = ScalarLaw::normal(law.mean(), law.deviation()).unwrap();
    let at = |z: &f64| (law.cdf(normal.at_score(*z)) - normal.cdf(normal.at_score(*z))).abs();
    [-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0].iter().map(at).fold(0.0, f64::max)
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
    /// F(F⁻¹(Φ(z))) is Φ(z), from both tails, between the numbers next to the value.
    #[test]
    fn scores_are_quantiles(z in -6.0..6.0f64) {
        for law in laws() {
            let x = law.at_score(z);
            let [before, after] = [x.next_down(), x.next_up()].map(|x| law.cdf(x));
            let p = below(z);
            prop_assert!(before <= p + 1e-12 && p <= after + 1e-12, "{:?} {}: {:e} {:e} {:e}", law, x, before, p, after);
            prop_assert!(law.at_score(z + 0.01) >= x);
        }
    }

    /// The quantile is the smallest value whose share reaches p, and the share above a value is what is left.
    #[test]
    fn quantiles_and_shares_above_are_those_of_the_shares_below(p in 0.0..=1.0f64, tail in 1e-300..1e-12f64) {
        for law in laws() {
            let x = law.quantile(p);
            prop_assert!(law.cdf(x.next_down()) <= p + 1e-12 && p <= law.cdf(x.next_up()) + 1e-12, "{:?} {}: {}", law, p, x);
            prop_assert!((law.share_above(x) - (1.0 - law.cdf(x))).abs() <= 1e-12, "{:?} {}: {}", law, x, law.share_above(x));
            prop_assert!(law.quantile(0.0) <= law.quantile(tail) && law.quantile(tail) <= x && x <= law.quantile(1.0));
            prop_assert!(law.quantile(-p - 1e-9).is_nan() && law.quantile(f64::NAN).is_nan());
        }
        let normal = ScalarLaw::normal(0.0, 1.0).unwrap();
        let z = normal.quantile(tail);
        for found in [normal.cdf(z), normal.share_above(-z)] {
            prop_assert!((found / tail - 1.0).abs() < 1e-12, "{:e}: {:e}", tail, found);
        }
    }

    /// Any law that is taken keeps its promises: scores rise, the distribution function is one, moments are
    /// finite, and a file gives it back to the bit.
    #[test]
    fn any_law_is_one(
        kind in 0usize..16, a in -50.0..50.0f64, w in 0.0..80.0f64, share in 0.0..1.0f64,
        shape in 0.1..60.0f64, other in 0.1..60.0f64, z in -5.0..5.0f64,
    ) {
        let made = [
            ScalarLaw::normal(a, w),
            ScalarLaw::uniform(a, a + w),
            ScalarLaw::truncated_normal(a, shape, a - w * share, a + w),
            ScalarLaw::lognormal(a.abs() + 0.1, w),
            ScalarLaw::triangular(a, a + share * w, a + w),
            ScalarLaw::beta(a, a + w, shape, other),
            ScalarLaw::weibull(a, w, shape),
            ScalarLaw::samples(&[a, w, share, shape, other]),
            ScalarLaw::bernoulli(share),
        ];
        let Ok(law) = made[kind % made.len()].clone() else { return Ok(()) };
        let (x, above) = (law.at_score(z), law.at_score(z + 0.1));
        prop_assert!(above >= x && x.abs() <= law.reach(6.0) * (1.0 + 1e-12), "{:?}", law);
        prop_assert!(law.cdf(x.next_down()) <= law.cdf(above) && (0.0..=1.0).contains(&law.cdf(x)));
        let (mean, variance) = law.square_moments();
        prop_assert!(law.mean().is_finite() && law.deviation() >= 0.0 && variance >= 0.0, "{:?}", law);
        let again = law.mean() * law.mean() + law.deviation() * law.deviation();
        prop_assert!((mean - again).abs() <= 1e-9 * again, "{:?}: {} {}", law, mean, again);
        prop_assert_eq!(ScalarLaw::try_from(ScalarLawForm::from(law.clone())).unwrap(), law);
    }

    /// Without bounds that matter it is normal, in the tails too.
    #[test]
    fn wide_bounds_are_none(z in -7.0..7.0f64) {
        let law = ScalarLaw::truncated_normal(2.0, 3.0, -INF, INF).unwrap();
        prop_assert!((law.at_score(z) - (2.0 + 3.0 * z)).abs() < 1e-12);
    }
}

/// The quantiles at 0 and 1 are the bounds of what can be drawn, which are infinite where a law is open.
#[test]
fn the_outermost_quantiles_are_the_bounds() {
    let truncated = |mean, low, high| ScalarLaw::truncated_normal(mean, 1.0, low, high);
    for (law, bounds) in [
        (ScalarLaw::normal(1.0, 2.0), [-INF, INF]),
        (truncated(0.0, -INF, INF), [-INF, INF]),
        (truncated(0.0, -INF, 2.0), [-INF, 2.0]),
        (truncated(0.0, 1.0, INF), [1.0, INF]),
        (truncated(0.0, -7.0, -4.0), [-7.0, -4.0]),
        (truncated(0.0, -INF, -4.0), [-INF, -4.0]),
        (truncated(0.0, 5.0, INF), [5.0, INF]),
        (ScalarLaw::lognormal(1.0, 0.5), [0.0, INF]),
        (ScalarLaw::weibull(1.0, 2.0, 3.0), [1.0, INF]),
        (ScalarLaw::uniform(-1.0, 4.0), [-1.0, 4.0]),
        (ScalarLaw::triangular(-1.0, 0.0, 4.0), [-1.0, 4.0]),
        (ScalarLaw::beta(-1.0, 4.0, 2.0, 3.0), [-1.0, 4.0]),
        (ScalarLaw::samples(&[3.0, 1.0, 2.0]), [1.0, 3.0]),
        (ScalarLaw::bernoulli(0.3), [0.0, 1.0]),
    ] {
        let law = law.unwrap();
        assert_eq!([law.quantile(0.0), law.quantile(1.0)], bounds, "{law:?}");
    }
}

/// A NaN has no probability, score or density, and is of no quantile, in any law.
#[test]
fn of_nan_all_is_nan() {
    let mut rng = ChaCha8Rng::seed_from_u64(21);
    let any: Vec<ScalarLaw> = (0..200).map(|_| any_law(&mut rng)).collect();
    for law in laws().into_iter().chain(any) {
        for nan in [f64::NAN, -f64::NAN] {
            let asked = [
                law.cdf(nan),
                law.share_above(nan),
                law.score(nan),
                law.at_score(nan),
                law.quantile(nan),
            ];
            assert!(asked.iter().all(|x| x.is_nan()), "{law:?}: {asked:?}");
            let (density, has) = (law.ln_density(nan), law.ln_density(law.mean()).is_some());
            assert_eq!(density.map(f64::is_nan), has.then_some(true), "{law:?}: {density:?}");
        }
        assert!(
            ![law.cdf(0.0), law.share_above(0.0), law.score(0.0), law.at_score(0.0)]
                .iter()
                .any(|x| x.is_nan())
        );
    }
}

#[test]
fn laws_without_width_stay_put() {
    for law in [
        ScalarLaw::normal(2.0, 0.0),
        ScalarLaw::uniform(2.0, 2.0),
        ScalarLaw::truncated_normal(2.0, 0.0, 0.0, 3.0),
        ScalarLaw::lognormal(2.0, 0.0),
        ScalarLaw::triangular(2.0, 2.0, 2.0),
        ScalarLaw::beta(2.0, 2.0, 0.5, 3.0),
        ScalarLaw::weibull(2.0, 0.0, 3.0),
        ScalarLaw::samples(&[2.0, 2.0]),
    ] {
        let law = law.unwrap();
        assert_eq!([law.at_score(-3.0), law.mean(), law.deviation()], [2.0, 2.0, 0.0]);
        assert_eq!([-INF, INF].map(|z| law.at_score(z)), [2.0, 2.0], "{law:?}");
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
        (L::triangular(0.0, 2.0, 1.0), "mode = 2.0"),
        (L::triangular(1.0, 0.0, 0.0), "bounds from 1.0 to 0.0"),
        (L::triangular(0.0, f64::NAN, 1.0), "mode = NaN"),
        (L::beta(1.0, 0.0, 1.0, 1.0), "bounds from 1.0 to 0.0"),
        (L::beta(0.0, 1.0, 0.0, 1.0), "alpha = 0.0"),
        (L::beta(0.0, 1.0, 1.0, 2e3), "beta = 2000.0"),
        (L::weibull(INF, 1.0, 1.0), "low = inf"),
        (L::weibull(0.0, -1.0, 1.0), "scale = -1.0"),
        (L::weibull(0.0, 1.0, f64::NAN), "shape = NaN"),
        (L::samples(&[]), "0 samples"),
        (L::samples(&[1.0, f64::NAN]), "samples = NaN"),
        (L::samples(&[0.0; 100_001]), "100001 samples"),
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
    for law in laws() {
        let json = serde_json::to_string(&law).unwrap();
        assert!(json.contains(&format!(r#""law":"{}""#, law.name())), "{json}");
        assert_eq!(serde_json::from_str::<ScalarLaw>(&json).unwrap(), law, "{json}");
    }
    for (text, problem) in [
        (
            r#"{"law":"normal","mean":0.0,"sigma":-1.0}"#,
            "sigma: -1.0: it must be a finite number of at least 0.0",
        ),
        (
            r#"{"mean":0.0,"sigma":1.0,"variance":1.0}"#,
            "variance = 1.0: it must not be negative, and",
        ),
        (
            r#"{"law":"uniform","low":0.0,"high":1.0,"mean":1.0}"#,
            "mean: law = \"uniform\" takes low, high, not",
        ),
        (
            r#"{"law":"triangular","low":0.0,"high":1.0}"#,
            "mode: missing: law = \"triangular\" needs mode",
        ),
        (r#"{"law":"cauchy"}"#, "unknown law `cauchy`, expected one of `normal`, `uniform`"),
        (
            r#"{"law":"normal","colour":1}"#,
            "unknown field `colour`, expected one of `law`, `sigma`",
        ),
        ("0.5", "mean"),
    ] {
        let refused = serde_json::from_str::<ScalarLaw>(text).unwrap_err().to_string();
        assert!(refused.contains(problem), "{text}: {refused}");
    }
}

/// About a nominal value, in any unit: what is declared a place moves with it, what is a size does not.
#[test]
fn laws_about_a_nominal_value_are_moved_and_scaled() {
    for (law, _) in laws::examples() {
        if law.name() == "bernoulli" || law.name() == "lognormal" {
            continue;
        }
        let form = ScalarLawForm::from(law.clone());
        let about = |nominal, unit| form.about(nominal, unit).unwrap();
        let (moved, scaled) = (about(100.0, LawUnit::OWN), about(50.0, LawUnit::percent_of(50.0)));
        for z in [-2.0, -0.3, 0.0, 1.0, 2.5] {
            let x = law.at_score(z);
            assert!((moved.at_score(z) - (100.0 + x)).abs() < 1e-12 * 100.0, "{law:?} {z}");
            assert!((scaled.at_score(z) - (50.0 + 0.5 * x)).abs() < 1e-12 * 50.0, "{law:?} {z}");
        }
    }
}

/// Laws of every kind with any parameters, from 1e-30 to 1e30.
fn any_law(rng: &mut ChaCha8Rng) -> ScalarLaw {
    use rand::RngExt;
    let mut within = |low: f64, high: f64| rng.random_range(low..high);
    let size = 10f64.powf(within(-30.0, 30.0));
    let spread = size * 10f64.powf(within(-4.0, 1.0));
    let shapes = [within(-1.0, 3.0), within(-1.0, 3.0)].map(|x| 10f64.powf(x));
    let (a, b, c) = (within(-5.0, 0.0), within(0.5, 3.0), within(0.0, 1.0));
    match within(0.0, 7.0) as u8 {
        0 => ScalarLaw::normal(size * a, spread),
        1 => ScalarLaw::uniform(size * a, size * b),
        2 => ScalarLaw::truncated_normal(size, spread, size + a * spread, size + (a + b) * spread),
        3 => ScalarLaw::lognormal(size, spread),
        4 => ScalarLaw::triangular(size * a, size * (a + c * (b - a)), size * b),
        5 => ScalarLaw::beta(0.0, size, shapes[0].max(0.1), shapes[1].min(1e3)),
        _ => ScalarLaw::weibull(0.0, size, shapes[0].clamp(0.5, 50.0)),
    }
    .unwrap()
}

/// The density between two scores holds the share of the normal law between them, out to eight deviations on both
/// sides, where the law's values are told from one another; all shares together are one.
#[test]
fn densities_hold_the_shares_of_scores() {
    let mut rng = ChaCha8Rng::seed_from_u64(71);
    let mut laws: Vec<ScalarLaw> = laws().into_iter().filter(|law| !has_steps(law)).collect();
    laws.extend((0..300).map(|_| any_law(&mut rng)));
    let mut wide = 0;
    for law in laws {
        let mut whole = 0.0;
        let density = |x: f64| law.ln_density(x).unwrap().exp();
        for i in -32..32 {
            let scores = [0.25 * f64::from(i), 0.25 * f64::from(i + 1)];
            let [from, to] = scores.map(|z| law.at_score(z));
            let expected = crate::truncated_normal::share(scores[0], scores[1]);
            let size = from.abs().max(to.abs()).max(law.deviation());
            // A mode between them bends the rule.
            let bent = law.name() == "triangular" && from < mode(&law) && mode(&law) < to;
            if to - from < 1e-7 * size || bent {
                whole += expected;
                continue;
            }
            const N: i32 = 400;
            let step = (to - from) / f64::from(N);
            let sum: f64 = (0..=N)
                .map(|j| {
                    let weight = if j % N == 0 { 1.0 } else { f64::from(2 + 2 * (j % 2)) };
                    weight * density((from + step * f64::from(j)).min(to))
                })
                .sum();
            let found = sum * step / 3.0;
            assert!(
                (found / expected - 1.0).abs() < 2e-6,
                "{law:?} {scores:?}: {found} {expected}"
            );
            whole += found;
            wide += 1;
        }
        assert!((whole - 1.0).abs() < 1e-6, "{law:?}: {whole}");
    }
    assert!(wide > 15_000, "{wide}");
}

fn mode(law: &ScalarLaw) -> f64 {
    let mode = law.0.values().into_iter().find(|(key, _)| *key == "mode");
    if let Some((_, Value::Number(mode))) = mode { mode } else { f64::NAN }
}

/// No NaN anywhere, nothing outside of the support, and in the far tails what the formula says where e to its power
/// is nothing.
#[test]
fn densities_are_sound_everywhere() {
    let mut rng = ChaCha8Rng::seed_from_u64(72);
    let mut laws: Vec<ScalarLaw> = laws().into_iter().filter(|law| !has_steps(law)).collect();
    laws.extend((0..2000).map(|_| any_law(&mut rng)));
    let extremes = [0.0, 5e-324, 1e-300, 1e-30, 1.0, 1e30, 1e100, 1e300, f64::MAX, INF];
    for law in &laws {
        let quantiles = (-45..=45).map(|z| law.at_score(f64::from(z)));
        let near = quantiles.flat_map(|x| [x.next_down(), x, x.next_up()]);
        for x in near.chain(extremes).chain(extremes.map(|x| -x)) {
            let density = law.ln_density(x).unwrap();
            assert!(!density.is_nan(), "{law:?} {x:e}");
            let (below, to) = (law.cdf(x.next_down()), law.cdf(x.next_up()));
            if x.is_finite() && to > below && law.cdf(x) > 0.0 && law.cdf(x) < 1.0 {
                assert!(density > -INF, "{law:?} {x:e}");
            }
        }
    }
    let [normal, tail] = [ScalarLaw::normal(0.0, 1e-60), ScalarLaw::normal(3.0, 2.0)];
    assert!((normal.unwrap().ln_density(1e-59).unwrap() - 87.236_2).abs() < 1e-3);
    let tail = tail.unwrap().ln_density(3.0 + 2e100).unwrap();
    assert!((tail / -5e199 - 1.0).abs() < 1e-12);
    let at = |law: Result<ScalarLaw, ScalarLawError>, x: f64| law.unwrap().ln_density(x).unwrap();
    for (found, expected) in [
        (at(ScalarLaw::beta(0.0, 1.0, 0.5, 2.0), 0.0), INF),
        (at(ScalarLaw::beta(0.0, 1.0, 1.0, 2.0), 0.0), 2.0_f64.ln()),
        (at(ScalarLaw::beta(0.0, 1.0, 1.0, 2.0), 1.0), -INF),
        (at(ScalarLaw::beta(-2.0, 2.0, 1.0, 1.0), 2.0), -(4.0_f64.ln())),
        (at(ScalarLaw::weibull(1.0, 2.0, 0.5), 1.0), INF),
        (at(ScalarLaw::weibull(1.0, 2.0, 1.0), 1.0), -(2.0_f64.ln())),
        (at(ScalarLaw::weibull(1.0, 2.0, 3.0), 0.5), -INF),
        (at(ScalarLaw::triangular(0.0, 0.0, 4.0), 0.0), 0.5_f64.ln()),
        (at(ScalarLaw::triangular(0.0, 0.0, 4.0), -1.0), -INF),
        (at(ScalarLaw::uniform(0.0, 4.0), 4.0), -(4.0_f64.ln())),
        (at(ScalarLaw::lognormal(1.0, 0.5), 0.0), -INF),
        (at(ScalarLaw::truncated_normal(0.0, 1.0, -1.0, 1.0), 1.5), -INF),
    ] {
        assert!(found == expected || (found - expected).abs() < 1e-12, "{found} {expected}");
    }
    // Without width, of samples and of events there is none.
    for law in [
        ScalarLaw::normal(1.0, 0.0),
        ScalarLaw::uniform(1.0, 1.0),
        ScalarLaw::truncated_normal(1.0, 0.0, 0.0, 2.0),
        ScalarLaw::lognormal(1.0, 0.0),
        ScalarLaw::triangular(1.0, 1.0, 1.0),
        ScalarLaw::beta(1.0, 1.0, 2.0, 2.0),
        ScalarLaw::weibull(1.0, 0.0, 2.0),
        ScalarLaw::samples(&[1.0, 2.0]),
        ScalarLaw::bernoulli(0.5),
    ] {
        let law = law.unwrap();
        assert!([1.0, 5.0, INF].iter().all(|x| law.ln_density(*x).is_none()), "{law:?}");
    }
}
