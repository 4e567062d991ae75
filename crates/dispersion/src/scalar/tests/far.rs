//! Scalar laws where numbers are small: far tails, events that are rare, and scales near the smallest numbers.

use super::*;
use crate::normal::above;

/// A window that is open to many deviations on both sides is as good as none up to there: its scores are those of the normal
/// law, and its shares of tails too.
#[test]
fn bounds_far_out_are_met() {
    let mut rng = ChaCha8Rng::seed_from_u64(38);
    for case in 0..400 {
        let mut bound = |from: f64| rng.random_range(from..37.5_f64);
        let (low, high) = (-bound(10.0), bound(10.0));
        let law = ScalarLaw::truncated_normal(0.0, 1.0, low, high).unwrap();
        for _ in 0..20 {
            let z = rng.random_range(-38.0..38.0_f64);
            let x = law.at_score(z);
            let expected = z.clamp(low, high);
            // Near a bound, what is beyond it is missing from the share.
            let room = if z < 0.0 { x - low } else { high - x };
            let missing =
                if room > 0.01 { 2.0 * libm::exp(-room * z.abs()) / z.abs() } else { 0.1 };
            assert!((x - expected).abs() < 1e-13 + missing, "{case} {law:?} {z}: {x}");
            let score = law.score(expected);
            let on = z > low + 0.5 && z < high - 0.5;
            assert!(!on || (score - z).abs() < 1e-12 + 2.0 * missing, "{law:?} {z}: {score}");
        }
    }
    let law = ScalarLaw::truncated_normal(0.0, 1.0, -2.3, 27.0).unwrap();
    // 1 − Φ(24) over Φ(2.3), of which the score is 24 + ln Φ(2.3)/24.04 to first order.
    assert!((law.share_above(24.0) / (above(24.0) / below(2.3)) - 1.0).abs() < 1e-11);
    assert!((law.score(24.0) - 23.999_551).abs() < 1e-6, "{}", law.score(24.0));
    let law = ScalarLaw::truncated_normal(0.0, 1.0, 5.0, 33.0).unwrap();
    assert!(law.at_score(38.0) > 33.0 - 1e-9);
}

/// Shares of rare events keep their digits, and the outermost quantile of what can be is its value.
#[test]
fn rare_events_keep_their_shares() {
    for p in [1e-300, 1e-17, 1e-12, 0.3, 1.0 - 1e-16, 1.0] {
        let law = ScalarLaw::bernoulli(p).unwrap();
        assert_eq!([-0.1, 0.0, 0.5, 1.0].map(|x| law.share_above(x)), [1.0, p, p, 0.0]);
        assert_eq!([law.quantile(1.0), law.at_score(INF)], [1.0; 2]);
        let least = f64::from(u8::from(p == 1.0));
        assert_eq!([law.quantile(0.0), law.at_score(-30.0), law.at_score(-INF)], [least; 3]);
    }
    assert_eq!(ScalarLaw::bernoulli(0.0).unwrap().quantile(1.0), 0.0);
    let law = ScalarLaw::samples(&(0..100_000).map(f64::from).collect::<Vec<_>>()).unwrap();
    assert_eq!(law.share_above(99_998.5), 1e-5);
}

/// A triangular law with the mode at a bound, or near it, has the tail of the other law there: p of 1 − (1 − x)².
#[test]
fn triangles_keep_their_lower_tail() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for _ in 0..1000 {
        let p = 10_f64.powf(rng.random_range(-200.0..-0.01));
        let width = 10_f64.powf(rng.random_range(-90.0..90.0));
        let law = ScalarLaw::triangular(0.0, 0.0, width).unwrap();
        let expected = width * p / (1.0 + (1.0 - p).sqrt());
        let (found, share) = (law.quantile(p), law.cdf(expected));
        assert!((found / expected - 1.0).abs() < 1e-11, "{p:e}: {found:e} {expected:e}");
        assert!((share / p - 1.0).abs() < 1e-11, "{p:e}: {share:e}");
        // Mirrored, it has the same upper tail.
        let mirrored = ScalarLaw::triangular(-width, 0.0, 0.0).unwrap();
        assert!((mirrored.share_above(-expected) / p - 1.0).abs() < 1e-9);
        // From the mode on, and below it.
        let mode = width * 10_f64.powf(rng.random_range(-30.0..-5.0));
        let law = ScalarLaw::triangular(0.0, mode, width).unwrap();
        let x = law.quantile(p);
        assert!((law.cdf(x) / p - 1.0).abs() < 1e-9, "{p:e} {mode:e} of {width:e}: {x:e}");
    }
}

/// Near a bound, the share beyond a value is the density there times the distance over the power with which shares rise
/// from that bound, wherever the law lies: on both sides.
#[test]
fn shares_near_the_bounds_keep_their_digits() {
    let mut rng = ChaCha8Rng::seed_from_u64(174);
    for case in 0..4000 {
        let place = [0.0, 1.0, 1e6][case % 3] * rng.random_range(-1.0..1.0);
        let width = 10_f64.powf(rng.random_range(-3.0..3.0));
        let (low, high) = (place - 0.4 * width, place + 0.6 * width);
        let shapes = [(); 2].map(|()| rng.random_range(0.2..5.0));
        let sigma = width * 10_f64.powf(rng.random_range(-0.5..2.0));
        let mean = place + rng.random_range(-2.0..2.0) * sigma;
        let [below_mode, above_mode] = if case % 2 == 0 { [2.0, 2.0] } else { [2.0, 1.0] };
        let mode = if case % 2 == 0 { place } else { high };
        for (law, powers) in [
            (ScalarLaw::uniform(low, high), [1.0; 2]),
            (ScalarLaw::triangular(low, mode, high), [below_mode, above_mode]),
            (ScalarLaw::beta(low, high, shapes[0], shapes[1]), shapes),
            (ScalarLaw::truncated_normal(mean, sigma, low, high), [1.0; 2]),
        ] {
            let law = law.unwrap();
            let part = 10_f64.powf(rng.random_range(-9.0..-5.0));
            let check = |share: f64, x: f64, distance: f64, power: f64| {
                if distance > 0.0 {
                    let expected = law.ln_density(x).unwrap().exp() * distance / power;
                    let off = (share / expected - 1.0).abs();
                    assert!(
                        off < 50.0 * distance / width + 1e-9,
                        "{law:?} {x:?}: {share:e} {expected:e}"
                    );
                }
            };
            let (x, y) = (low + part * width, high - part * width);
            check(law.cdf(x), x, x - low, powers[0]);
            check(law.share_above(y), y, high - y, powers[1]);
        }
    }
}

/// A narrow lognormal law is normal but for a share of its width, however narrow it is.
#[test]
fn narrow_lognormal_laws_are_normal() {
    let mut rng = ChaCha8Rng::seed_from_u64(509);
    for _ in 0..4000 {
        let mean = 10_f64.powf(rng.random_range(-30.0..30.0));
        let sigma = mean * 10_f64.powf(rng.random_range(-15.0..-4.0));
        let [law, normal] =
            [ScalarLaw::lognormal, ScalarLaw::normal].map(|law| law(mean, sigma).unwrap());
        let x = mean + sigma * rng.random_range(-6.0..6.0);
        for [found, expected] in
            [[law.cdf(x), normal.cdf(x)], [law.share_above(x), normal.share_above(x)]]
        {
            // The slope of ln Φ at six deviations, and the change of the score there.
            let room = 6.2 * 18.0 * sigma / mean + 1e-13;
            assert!((found / expected - 1.0).abs() < room, "{law:?} {x:?}: {found:e} {expected:e}");
        }
    }
}

/// Deviations and scores are in proportion to the scale, though squares be no numbers.
#[test]
fn the_smallest_scales_are_scales() {
    let laws = |s: f64| {
        [
            ScalarLaw::normal(0.0, s),
            ScalarLaw::uniform(-s, s),
            ScalarLaw::triangular(-s, 0.0, s),
            ScalarLaw::truncated_normal(0.0, s, -2.0 * s, 2.0 * s),
            ScalarLaw::beta(-s, s, 2.0, 3.0),
            ScalarLaw::weibull(0.0, s, 2.0),
            ScalarLaw::samples(&[-s, 0.5 * s, s]),
        ]
        .map(Result::unwrap)
    };
    for scale in [1e-100, 1e-153, 1e-161, 1e-200, 1e-290] {
        for (small, law) in laws(scale).iter().zip(laws(1.0)) {
            let (found, expected) = (small.deviation() / scale, law.deviation());
            assert!((found / expected - 1.0).abs() < 1e-14, "{small:?}: {found}");
            for x in [-0.7, 0.1, 0.9] {
                let (found, expected) = (small.score(x * scale), law.score(x));
                assert!((found - expected).abs() < 1e-12, "{small:?} {x}: {found} {expected}");
            }
        }
    }
    assert_eq!(ScalarLaw::normal(1.0, 1e-161).unwrap().as_normal(), None);
    assert_eq!(ScalarLaw::normal(1.0, 0.0).unwrap().as_normal(), Some([1.0, 0.0]));
}
