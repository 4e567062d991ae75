//! Quantiles of the normal, χ², F and beta laws.
//!
//! Every quantile takes the probability *beyond* it: `1 − α/2` would round to 1 long before `α/2`
//! rounds to 0. The incomplete gamma function is that of `statrs` up to 10⁵ degrees of freedom. Its incomplete beta function
//! stops after 140 terms, which costs the F law 0.002 at 10⁶ degrees of freedom and the t quantile
//! 2 % at 10⁷; at one degree and a tail of 10⁻¹⁰ the latter is 36 times too small. Hence the
//! function and the root search below.

use std::f64::consts::{SQRT_2, TAU};

use statrs::function::erf::erfc_inv;
use statrs::function::gamma::{checked_gamma_lr, ln_gamma};

use crate::chi_squared::{MANY, tails};
use crate::tail::chi_squared as chi_squared_tail;

/// What rounding may add to a tail that is compared with a risk, as a part of the risk.
pub(crate) const ROUNDING: f64 = 1e-12;

/// The value a standard normal variable exceeds with probability `tail`.
pub(crate) fn normal(tail: f64) -> f64 {
    SQRT_2 * erfc_inv(2.0 * tail)
}

/// The value Student's t exceeds with probability `tail`, up to one half.
pub(crate) fn students_t(tail: f64, freedom: f64) -> f64 {
    // There the two agree to the last digit, and one over ν would come to be no number.
    if freedom > 1e20 {
        return normal(tail);
    }
    // t² follows F(1, ν) and t is symmetric.
    fisher(2.0 * tail, 1.0, freedom).sqrt()
}

/// The value an F variable exceeds with probability `tail`.
pub(crate) fn fisher(tail: f64, numerator: f64, denominator: f64) -> f64 {
    bisect(0.0, f64::MAX, |f| {
        let r = f * (numerator / denominator);
        beta_cdf(denominator / 2.0, numerator / 2.0, 1.0 / (1.0 + r), 1.0 / (1.0 + 1.0 / r)) > tail
    })
}

/// The value a χ² variable falls below with probability `tail`.
pub(crate) fn chi_squared_lower(tail: f64, freedom: f64) -> f64 {
    let shape = freedom / 2.0;
    // P(a, x) = xᵃ/Γ(a+1)·(1 + O(x)): `statrs` takes P for 0 where this is all there is.
    let leading = ((tail.ln() + ln_gamma(shape + 1.0)) / shape).exp();
    if leading < 1e-10 {
        return 2.0 * leading;
    }
    bisect(0.0, f64::MAX, |x| {
        if freedom >= MANY {
            tails(x, freedom).0 < tail
        } else {
            checked_gamma_lr(shape, x / 2.0).is_ok_and(|p| p < tail)
        }
    })
}

/// The value a χ² variable exceeds with probability `tail`.
pub(crate) fn chi_squared_upper(tail: f64, freedom: f64) -> f64 {
    bisect(0.0, f64::MAX, |x| chi_squared_tail(x, freedom) > tail)
}

/// The value a beta variable falls below with probability `tail`.
pub(crate) fn beta_lower(tail: f64, a: f64, b: f64) -> f64 {
    bisect(0.0, 1.0, |x| beta_cdf(a, b, x, 1.0 - x) < tail)
}

/// The value a beta variable exceeds with probability `tail`.
pub(crate) fn beta_upper(tail: f64, a: f64, b: f64) -> f64 {
    bisect(0.0, 1.0, |x| beta_cdf(b, a, 1.0 - x, x) > tail)
}

/// The probability that `n` independent trials, each a success with probability `p = 1 − q`, give `k` successes or
/// more: `I_p(k, n−k+1)`.
pub(crate) fn at_least(k: u64, n: u64, p: f64, q: f64) -> f64 {
    if k == 0 {
        return 1.0;
    }
    if k > n { 0.0 } else { beta_cdf(k as f64, (n - k + 1) as f64, p, q) }
}

/// The regularised incomplete beta function `I_x(a, b)`, with `y = 1 − x` given apart because it
/// cannot be recovered from an `x` close to 1.
pub(crate) fn beta_cdf(a: f64, b: f64, x: f64, y: f64) -> f64 {
    // The fraction converges in O(√max(a, b)) terms on the near side of the mean only.
    if x * b > y * a { 1.0 - beta_fraction(b, a, y, x) } else { beta_fraction(a, b, x, y) }
}

/// The continued fraction of `I_x(a, b)` of DiDonato & Morris (1992, doi:10.1145/131766.131776), by
/// Lentz's method. For `x ≤ a/(a + b)` it is free of cancellation.
fn beta_fraction(a: f64, b: f64, x: f64, y: f64) -> f64 {
    let distance = y * a - x * b;
    let mut fraction = a / (a + 1.0) * (distance + 1.0);
    let (mut c, mut d) = (fraction, 0.0);
    // A billion trials need less than 5000 terms.
    for term in 1..1_000_000 {
        let n = f64::from(term);
        let s = a + 2.0 * n - 1.0;
        let w = n * (b - n) * x;
        let alpha = (a + n - 1.0) / s * ((a + b + n - 1.0) / s) * w * x;
        let beta = n + w / s + (a + n) / (s + 2.0) * (distance + 1.0 + n * (1.0 + y));
        c = beta + alpha / c;
        d = 1.0 / (beta + alpha * d);
        fraction *= c * d;
        if (c * d - 1.0).abs() <= f64::EPSILON {
            break;
        }
    }
    let (root, log) = beta_front(a, b, x, y);
    root * log.exp() / fraction
}

/// The logarithm of `xᵃyᵇ / B(a, b)`.
pub(crate) fn ln_beta_front(a: f64, b: f64, x: f64, y: f64) -> f64 {
    let (root, log) = beta_front(a, b, x, y);
    libm::log(root) + log
}

/// `xᵃyᵇ / B(a, b)` as a factor and the logarithm of another, after Loader (2000): the large terms of `ln B`
/// are cancelled on paper, where a difference of three `ln_gamma` would lose `log₁₀(a + b)` digits.
fn beta_front(a: f64, b: f64, x: f64, y: f64) -> (f64, f64) {
    let log_ratio = |excess: f64, ratio: f64| {
        if excess > -0.5 { excess.ln_1p() } else { ratio.ln() }
    };
    let sum = a + b;
    let offset = x * b - y * a;
    let log = a * log_ratio(offset / a, x * (sum / a))
        + b * log_ratio(-offset / b, y * (sum / b))
        + stirling_remainder(sum)
        - stirling_remainder(a)
        - stirling_remainder(b);
    ((a / sum * b / TAU).sqrt(), log)
}

/// `ln Γ(a) − ((a − ½) ln a − a + ½ ln 2π)`.
fn stirling_remainder(a: f64) -> f64 {
    if a < 16.0 {
        return ln_gamma(a) - ((a - 0.5) * a.ln() - a + 0.5 * TAU.ln());
    }
    let s = 1.0 / (a * a);
    (1.0 / 12.0 - s * (1.0 / 360.0 - s * (1.0 / 1260.0 - s / 1680.0))) / a
}

/// The least float in `(low, high]` at which `below` is false, for a predicate that is true up to
/// some point. Floats from 0 are ordered as their bits are, so some sixty halvings of the bit
/// pattern settle the last bit wherever the point lies.
pub(crate) fn bisect(low: f64, high: f64, below: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (low.to_bits(), high.to_bits());
    while low + 1 < high {
        let middle = low.midpoint(high);
        if below(f64::from_bits(middle)) {
            low = middle;
        } else {
            high = middle;
        }
    }
    f64::from_bits(high)
}

/// The least of `low..=high` at which `reached` is true, or `high + 1`, for what stays true once it is.
pub(crate) fn first(low: u64, high: u64, reached: impl Fn(u64) -> bool) -> u64 {
    let (mut low, mut high) = (low, high + 1);
    while low < high {
        let middle = u64::midpoint(low, high);
        if reached(middle) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    low
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn assert_close(value: f64, reference: f64, tolerance: f64) {
        assert!(
            (value - reference).abs() <= tolerance * reference.abs(),
            "{value:e} is not {reference:e}"
        );
    }

    // References of these tests: scipy 1.17.1, `stats.<law>.isf(tail, …)` and `.ppf`.

    #[test]
    fn normal_quantiles() {
        assert_close(normal(0.025), 1.9599639845400545, 1e-14);
        assert_close(normal(1e-16), 8.222082216130435, 1e-13);
    }

    #[test]
    fn students_t_quantiles() {
        for (tail, freedom, reference) in [
            (0.025, 1.0, 12.706204736174705),
            (0.025, 9.0, 2.2621571627982053),
            (0.025, 1e7, 1.9599642217672055),
            (1e-12, 1.0, 318309886183.7907),
            (0.4, 3.0, 0.2766706623326898),
        ] {
            assert_close(students_t(tail, freedom), reference, 1e-12);
        }
    }

    #[test]
    fn chi_squared_quantiles() {
        for (tail, freedom, lower, upper) in [
            (0.025, 1.0, 0.0009820691171752555, 5.02388618731489),
            (1e-12, 1.0, 1.5707963267948931e-24, 50.844127911818155),
            (0.025, 9.0, 2.7003894999803584, 19.022767798641638),
            (0.025, 1e7, 9991236.669053895, 10008767.119557811),
        ] {
            assert_close(chi_squared_lower(tail, freedom), lower, 1e-10);
            assert_close(chi_squared_upper(tail, freedom), upper, 1e-10);
        }
    }

    #[test]
    fn fisher_quantiles() {
        for (tail, numerator, denominator, reference) in [
            (0.025, 9.0, 19.0, 2.880052046723775),
            (0.025, 1.0, 1.0, 647.7890114778442),
            (0.025, 1e6, 1e6, 1.0039276231790089),
            (0.005, 99.0, 5.0, 12.30115634817652),
        ] {
            assert_close(fisher(tail, numerator, denominator), reference, 1e-12);
        }
    }

    #[test]
    fn beta_distribution_and_quantiles() {
        // scipy 1.17.1, `special.betainc(a, b, x)`.
        for (a, b, x, reference) in [
            (2.0, 3.0, 0.25, 0.26171875),
            (0.5, 0.5, 0.1, 0.20483276469913345),
            (5e5, 5e5, 0.4995, 0.1586552539314459),
            (1e8, 3.0, 0.9999999, 0.00276939436546218),
            (1000.0, 2000.0, 0.35, 0.9729045043168851),
        ] {
            // 1 − x rounds: at a = 10⁸ that is worth 10⁻⁸ of the result.
            assert_close(beta_cdf(a, b, x, 1.0 - x), reference, if a > 1e6 { 1e-7 } else { 1e-12 });
        }
        assert_close(beta_lower(0.025, 1.0, 1000.0), 2.531748749129404e-05, 1e-12);
        assert_close(beta_lower(0.025, 500000.0, 500001.0), 0.49901951919531184, 1e-12);
    }

    #[test]
    fn a_billion_trials_converge() {
        // The median of Beta(a, a) is ½.
        assert_close(beta_cdf(5e8, 5e8, 0.5, 0.5), 0.5, 1e-10);
    }

    #[test]
    fn bisection_settles_the_last_bit() {
        assert_eq!(bisect(0.0, f64::MAX, |x| x < 1.0), 1.0);
        assert_eq!(bisect(0.0, f64::MAX, |x| x <= 1.0), 1.0f64.next_up());
        assert_eq!(bisect(0.0, f64::MAX, |_| false), f64::from_bits(1));
        assert_eq!(bisect(0.0, 2.0, |_| true), 2.0);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn quantiles_invert_their_tails(tail in 1e-12..0.5f64, a in 0.5..1e4f64, b in 0.5..1e4f64) {
            let f = fisher(tail, a, b);
            let x = 1.0 / (1.0 + f * a / b);
            let back = beta_cdf(b / 2.0, a / 2.0, x, 1.0 / (1.0 + b / a / f));
            prop_assert!((back - tail).abs() <= 1e-9 * tail, "F: {} {}", back, tail);
            let back = chi_squared_tail(chi_squared_upper(tail, a), a);
            prop_assert!((back - tail).abs() <= 1e-9 * tail, "chi2: {} {}", back, tail);
        }

        #[test]
        fn every_tail_and_freedom_gives_a_number(
            tail in 5e-17..0.5f64,
            exponents in (0.0..9.0f64, 0.0..9.0f64),
        ) {
            let (a, b) = (10f64.powf(exponents.0).ceil(), 10f64.powf(exponents.1).ceil());
            for value in [
                normal(tail),
                students_t(tail, a),
                chi_squared_lower(tail, a),
                chi_squared_upper(tail, a),
                fisher(tail, a, b),
                beta_lower(tail, a, b),
                beta_upper(tail, a, b),
            ] {
                prop_assert!(value > 0.0 && value.is_finite(), "{value}");
            }
        }
    }
}
