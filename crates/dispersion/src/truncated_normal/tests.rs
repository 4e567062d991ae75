//! Truncated normal laws against quadrature and closed forms.

use super::*;
use proptest::prelude::*;
use rand::RngExt;
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use rand_distr::{Distribution, StandardNormal};

use crate::{RootMoments, ScalarLaw, ScalarRoots};
use gyradius_inertia::RootSecondMoments;

const INF: f64 = f64::INFINITY;

fn roots([mean, deviation, low, high]: [f64; 4]) -> ScalarRoots {
    let mean = RootSecondMoments::new([mean; 3]).unwrap();
    ScalarRoots::truncated_normal(mean, [deviation * deviation; 3], [[low, high]; 3]).unwrap()
}

/// Mean and variance of k and of k², as the two laws that have windows tell them.
fn told(case: [f64; 4]) -> [f64; 4] {
    let [mean, deviation, low, high] = case;
    let scalar = ScalarLaw::truncated_normal(mean, deviation, low, high).unwrap();
    let squares = roots(case).second_moment_statistics();
    let variance = scalar.deviation() * scalar.deviation();
    [scalar.mean(), variance, squares.mean()[0], squares.variances()[0]]
}

/// The mean relative to the larger of itself and the deviation, the others to themselves.
fn assert_agree(found: [f64; 4], expected: [f64; 4], tolerance: f64, what: &str) {
    for (i, name) in ["E k", "Var k", "E K", "Var K"].into_iter().enumerate() {
        let unit = if i == 0 { expected[0].abs().max(expected[1].sqrt()) } else { expected[i] };
        let error = (found[i] - expected[i]).abs() / unit;
        assert!(error <= tolerance, "{what}: {name} off by {error:e}: {found:?} {expected:?}");
    }
}

/// mpmath 1.3 with 60 digits: `quad` of exp(−t²/2) over the window, in (k − low)/(high − low), infinite
/// ends at 40σ; mean, then the central second moment, and the same of k².
#[test]
fn moments_agree_with_mpmath() {
    #[rustfmt::skip]
    let cases = [
        ([0.0, 1.0, -5e-13, 5e-13], [0.0, 8.333333333333333e-26, 8.333333333333333e-26, 5.555555555555555e-51]),
        ([30.0, 3.0, 29.0, 29.000000000003], [29.0000000000015, 7.492453623753529e-25, 841.000000000087, 2.5204613990309475e-21]),
        ([30.0, 3.0, 47.9, 47.90000001], [47.900000004999995, 8.333334712339574e-18, 2294.410000479, 7.648034600532282e-14]),
        ([1.0, 0.5, -2.0, -1.99999], [-1.9999949999000002, 8.333333327331429e-12, 3.999979999633335, 1.3333266656619225e-10]),
        ([0.0, 1.0, 5.9, 5.9000000000059], [5.90000000000295, 2.900126422326551e-24, 34.81000000003481, 4.038136030451528e-22]),
        ([2.0, 1.0, -0.001, 0.002], [0.000501499623650789, 7.49998425678023e-07, 1.001500298199906e-06, 1.2017982613010033e-12]),
        ([0.0, 1.0, -0.25, 0.249], [-0.000489710815221023, 0.020578369515909856, 0.020578609332592403, 0.00034241832977520144]),
        ([1.0, 2.0, -3.0, 0.5], [-0.7576691347462567, 0.7910367047872227, 1.365099222534364, 3.9207303565150915]),
        ([0.0, 1.0, 6.0, INF], [6.158482604544599, 0.02398763678916677, 37.95089562726759, 3.8144505516775973]),
        ([5.0, 1.0, -INF, 0.0], [-0.1865039671258421, 0.032696434617112226, 0.06748016437078942, 0.019851358540173898]),
        ([3.0, 0.1, 0.0, INF], [3.0, 0.010000000000000002, 9.01, 0.3602]),
        ([-4.0, 1.0, -1.0, 1.0], [-0.7173056200577016, 0.06979756607044493, 0.5843249186368086, 0.0835077226578718]),
        ([0.1, 10.0, -0.03, 0.0300001], [3.5000048997997065e-07, 0.0003000006399445875, 0.0003000006400670878, 7.200041830981316e-08]),
        ([1000.0, 0.001, 1000.0005, 1000.000500000001], [1000.0005000000004, 8.724170523020214e-26, 1000001.000000251, 3.4896716988771705e-19]),
    ];
    for (case, expected) in cases {
        assert_agree(told(case), expected, 1e-12, &format!("{case:?}"));
    }
}

/// The same by tanh-sinh quadrature in x = (k − low)/(high − low).
fn by_quadrature([mean, deviation, low, high]: [f64; 4]) -> [f64; 4] {
    let low = low.max(mean - 14.0 * deviation);
    let high = high.min(mean + 14.0 * deviation);
    let (start, length) = ((low - mean) / deviation, (high - low) / deviation);
    let (mut nodes, mut whole) = (Vec::new(), 0.0);
    for i in -260..=260 {
        let tau = f64::from(i) / 80.0;
        let u = 0.5 * PI * tau.sinh();
        let x = 1.0 / (1.0 + (-2.0 * u).exp());
        let exponent = -length * x * (start + 0.5 * length * x);
        let weight = tau.cosh() / u.cosh().powi(2) * exponent.exp();
        nodes.push((x, weight));
        whole += weight;
    }
    let average = |f: &dyn Fn(f64) -> f64| {
        nodes.iter().map(|(x, weight)| weight * f(*x)).sum::<f64>() / whole
    };
    let x = average(&|x| x);
    let spread = average(&|y| (y - x) * (y - x));
    let (size, k) = (high - low, low + (high - low) * x);
    let gap = |y: f64| 2.0 * k * (y - x) + size * ((y - x) * (y - x) - spread);
    let square_variance = size * size * average(&|y| gap(y) * gap(y));
    [k, size * size * spread, k * k + size * size * spread, square_variance]
}

/// A mean, a deviation, and a window of any width anywhere up to 6σ outside.
fn any_window() -> impl Strategy<Value = [f64; 4]> {
    let scale = (-6.0..6.0f64, -6.0..3.0f64, any::<bool>());
    (scale, -5.9..5.9f64, -12.0..1.2f64, 0..6u8).prop_map(
        |((size, ratio, negative), place, width, kind)| {
            let mean = 10f64.powf(size) * if negative { -1.0 } else { 1.0 };
            let deviation = mean.abs() * 10f64.powf(ratio);
            let width = 10f64.powf(width) * deviation;
            // About zero and about the mean one time in six each, one-sided as often.
            let start = match kind {
                0 => mean + place.min(0.0) * 1e-2 * width - 0.3 * width,
                1 if mean.abs() < 5.0 * deviation => -0.4 * width,
                _ => mean + place * deviation,
            };
            let [low, high] = if place < 0.0 && kind > 1 {
                [start - width, start]
            } else {
                [start, start + width]
            };
            match kind {
                2 => [mean, deviation, low, INF],
                3 => [mean, deviation, -INF, high],
                _ => [mean, deviation, low, high],
            }
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn moments_agree_with_quadrature(case in any_window()) {
        let [mean, deviation, low, high] = case;
        // Rounding may have closed it, or moved it farther out.
        prop_assume!(low < high && low - mean <= 6.0 * deviation && mean - high <= 6.0 * deviation);
        assert_agree(told(case), by_quadrature(case), 1e-12, &format!("{case:?}"));
    }

    /// F(F⁻¹(Φ(z))) is Φ(z), as far as there are numbers in the window, and what it draws lies in it.
    #[test]
    fn scores_are_quantiles_of_any_window(case in any_window(), z in -6.0..6.0f64) {
        let [mean, deviation, low, high] = case;
        prop_assume!(low < high && low - mean <= 6.0 * deviation && mean - high <= 6.0 * deviation);
        let law = ScalarLaw::truncated_normal(mean, deviation, low, high).unwrap();
        let k = law.at_score(z);
        prop_assert!((low..=high).contains(&k));
        let target = above(-z);
        // The mass between neighbours of k.
        let step = law.cdf(k.next_up().next_up()) - law.cdf(k.next_down().next_down());
        let error = (law.cdf(k) - target).abs();
        prop_assert!(error < 1e-12 + step, "{:?} {} {:e} {:e}", case, z, error, step);
        prop_assert!(law.at_score(z + 0.01) >= k);
    }
}

/// A window on one side of zero, of which a bound is zero or small beside the mean or the deviation.
fn any_window_beside_zero() -> impl Strategy<Value = [f64; 4]> {
    let low = prop_oneof![Just(0.0), (-30.0..-1.0f64).prop_map(|e| 10f64.powf(e))];
    let width = prop_oneof![Just(INF), (-2.0..2.0f64).prop_map(|e| 10f64.powf(e))];
    (low, width, -1.3..6.0f64, -1.5..1.5f64, any::<bool>()).prop_map(
        |(low, width, place, deviation, mirrored)| {
            let deviation = 10f64.powf(deviation);
            let mean = if place > 0.0 { place * deviation } else { low + place * 4.0 * deviation };
            // No farther out than is allowed.
            let high = (low + width).max(mean - 5.9 * deviation);
            if mirrored { [-mean, deviation, -high, -low] } else { [mean, deviation, low, high] }
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    /// Near a bound that is small beside the mean, values have all their digits: they do not fall by more than 1e-13 of
    /// themselves where scores rise, and their shares are those of the scores.
    #[test]
    fn values_near_a_small_bound_keep_their_digits(
        case in any_window_beside_zero(),
        scores in prop::collection::vec(-38.0..9.0f64, 10),
        near in prop::collection::vec((-10.0..1.0f64, 1e-12..1e-2f64), 20),
    ) {
        let [mean, deviation, low, high] = case;
        let law = ScalarLaw::truncated_normal(mean, deviation, low, high).unwrap();
        let mut scores = scores;
        scores.extend(near.iter().flat_map(|(z, by)| [*z, z + by]));
        scores.sort_by(f64::total_cmp);
        // Those that go to the bound that is near zero.
        let inwards = if high <= 0.0 { -1.0 } else { 1.0 };
        let values: Vec<f64> = scores.iter().map(|z| law.at_score(inwards * z)).collect();
        for pair in values.windows(2) {
            prop_assert!(inwards * (pair[1] - pair[0]) >= -1e-13 * pair[0].abs(), "{case:?} {pair:?}");
        }
        let is_small = low.abs().min(high.abs()) < 0.02 * deviation.min(high - low);
        let tail = |z: f64| is_small && z < -1.0 && z > -37.0;
        for (z, x) in scores.iter().zip(&values).filter(|(z, _)| tail(**z)) {
            let share = |x: f64| if inwards > 0.0 { law.cdf(x) } else { law.share_above(x) };
            let step = share(x.next_up()) - share(x.next_down());
            let off = (share(*x) - above(-z)).abs();
            prop_assert!(off <= 2.0 * step.abs() + 1e-11 * above(-z), "{case:?} {z}: {x:e} {off:e} of {:e}", above(-z));
        }
    }
}

/// Kolmogorov and Smirnov's distance below its 1e-4 point: against the law where density falls
/// exponentially along the window, which is uniform where it is narrow.
#[test]
fn draws_of_narrow_windows_and_far_tails_have_their_law() {
    const N: usize = 20_000;
    let mut rng = ChaCha8Rng::seed_from_u64(35);
    for width in [1e-12, 1e-9, 1e-4, 1e-2] {
        for place in [0.0, 0.7, -0.7, 3.0, -3.0, 5.9, -5.9] {
            for mean in [0.0, 30.0] {
                let deviation = if mean == 0.0 { 1.0 } else { 3.0 };
                let low = mean + (place - 0.5 * width) * deviation;
                let case = [mean, deviation, low, low + width * deviation];
                let [.., low, high] = case;
                let slope = (0.5 * (low + high) - mean) / deviation * (high - low) / deviation;
                let cdf = |k: f64| {
                    let x = (k - low) / (high - low);
                    if slope == 0.0 { x } else { (-slope * x).exp_m1() / (-slope).exp_m1() }
                };
                // Half a step between neighbouring numbers.
                let grain = 0.5 * (high.next_up() - high) / (high - low);
                let law = roots(case);
                let scalar = ScalarLaw::truncated_normal(mean, deviation, low, high).unwrap();
                let mut both = [Vec::new(), Vec::new()];
                for _ in 0..N {
                    both[0].push(law.sample(&mut rng).values()[0]);
                    both[1].push(scalar.sample(&mut rng));
                }
                for mut draws in both {
                    draws.sort_by(f64::total_cmp);
                    let gap = draws.iter().enumerate().fold(0.0, |gap: f64, (j, k)| {
                        gap.max((cdf(*k) - (j as f64 + 0.5) / N as f64).abs() - grain)
                    });
                    assert!(gap * (N as f64).sqrt() < 2.23, "{case:?}: {gap}");
                }
            }
        }
    }
}

/// Any window has draws, and they lie in it.
#[test]
fn draws_lie_in_the_window() {
    let mut rng = ChaCha8Rng::seed_from_u64(36);
    for _ in 0..3000 {
        let z: f64 = StandardNormal.sample(&mut rng);
        let (mean, deviation) = (z, 10f64.powf(rng.random_range(-9.0..3.0)));
        let place = rng.random_range(-5.9..5.9) * deviation;
        let width = 10f64.powf(rng.random_range(-12.0..2.0)) * deviation;
        let (low, high) = (mean + place, mean + place + width);
        if low < high {
            let k = roots([mean, deviation, low, high]).sample(&mut rng).values()[0];
            assert!((low..=high).contains(&k), "{low:?} {high:?} {k:?}");
        }
    }
}
