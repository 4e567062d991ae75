//! The probability of more than some value: elementary laws, and the statistics of tests.
//!
//! ```
//! use gyradius_statistics::tail;
//!
//! assert!((tail::normal(1.959964) - 0.025).abs() < 1e-8);
//! assert!((tail::chi_squared(16.918978, 9.0) - 0.05).abs() < 1e-8);
//! ```
//!
//! Of a NaN, all are NaN.
//!
//! All but χ² of more than 30 or broken degrees of freedom, up to 10⁵, are made from the elementary functions of `libm`, which
//! are the same on every platform.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use statrs::function::gamma::checked_gamma_ur;

use crate::chi_squared::{MANY, tails};

/// Up to this many degrees of freedom χ² has the finite sum, whose terms stay in range.
const SUMMED: f64 = 30.0;

/// The probability that χ² with `freedom` degrees exceeds `x`: up to 30 whole degrees the finite sums (DLMF 8.8.6
/// from Q(½, x) = erfc √x or Q(1, x) = e⁻ˣ), from 10⁵ degrees on the uniform expansion of Temme (1979,
/// doi:10.1137/0510071), else the incomplete gamma function of `statrs`.
///
/// It takes any positive number of degrees. From one degree on the relative error is below 1e-9, and from 10⁵ degrees on below
/// 1e-12. NaN, and degrees that are not positive and finite, give NaN.
#[must_use]
pub fn chi_squared(x: f64, freedom: f64) -> f64 {
    if x.is_nan() || !(freedom > 0.0 && freedom.is_finite()) {
        return f64::NAN;
    }
    if x <= 0.0 {
        return 1.0;
    }
    if freedom >= MANY {
        return tails(x, freedom).1;
    }
    let half = 0.5 * x;
    if !((1.0..=SUMMED).contains(&freedom) && freedom.fract() == 0.0 && half.is_finite()) {
        // Refused are infinity and what halves to zero.
        let above = checked_gamma_ur(0.5 * freedom, half);
        return above.map_or(if half > 0.0 { 0.0 } else { 1.0 }, |p| p.clamp(0.0, 1.0));
    }
    let even = freedom % 2.0 == 0.0;
    let (mut sum, mut term, mut shape) = if even {
        (libm::exp(-half), libm::exp(-half), 1.0)
    } else {
        (libm::erfc(half.sqrt()), libm::exp(-half) / (PI * half).sqrt(), 0.5)
    };
    // Q(a + 1, x) = Q(a, x) + xᵃ e⁻ˣ/Γ(a + 1).
    while shape < 0.5 * freedom {
        term *= half / shape;
        sum += term;
        shape += 1.0;
    }
    sum.min(1.0)
}

/// The probability that a standard normal variable exceeds `x`; Φ(x) is `normal(-x)`.
#[must_use]
pub fn normal(x: f64) -> f64 {
    0.5 * libm::erfc(x * FRAC_1_SQRT_2)
}

/// p-value of Anderson and Darling's A² for a normal law with both parameters estimated
/// (D'Agostino & Stephens 1986, table 4.9).
#[must_use]
pub fn anderson_darling_normal(statistic: f64, count: f64) -> f64 {
    let a = statistic * (1.0 + 0.75 / count + 2.25 / (count * count));
    let p = if a > 10.0 {
        0.0
    } else if a >= 0.6 {
        libm::exp(1.2937 - 5.709 * a + 0.0186 * a * a)
    } else if a >= 0.34 {
        libm::exp(0.9177 - 4.279 * a - 1.38 * a * a)
    } else if a >= 0.2 {
        1.0 - libm::exp(-8.318 + 42.796 * a - 59.938 * a * a)
    } else {
        1.0 - libm::exp(-13.436 + 101.14 * a - 223.73 * a * a)
    };
    p.clamp(0.0, 1.0)
}

/// p-value of Anderson and Darling's A² for a law that was given: the limit of many samples (Marsaglia &
/// Marsaglia 2004, doi:10.18637/jss.v009.i02), and from A² = 4 on what its first term, √3 erfc √A², is
/// above theirs.
#[must_use]
pub fn anderson_darling(a: f64) -> f64 {
    let horner = |c: [f64; 6]| c.into_iter().rev().fold(0.0, |sum, c| sum * a + c);
    let p = if a <= 0.0 {
        1.0
    } else if a < 2.0 {
        let series = horner([2.00012, 0.247105, -0.0649821, 0.0347962, -0.011672, 0.00168691]);
        1.0 - libm::exp(-1.2337141 / a) / a.sqrt() * series
    } else {
        let series = horner([1.0776, -2.30695, 0.43424, -0.082433, 0.008056, -0.0003146]);
        let far = if a < 4.0 { 0.0 } else { 3.0_f64.sqrt() * libm::erfc(a.sqrt()) };
        (-libm::expm1(-libm::exp(series))).max(far)
    };
    p.clamp(0.0, 1.0)
}

/// p-value of Rayleigh's test of a uniform angle, from the mean of its unit vectors (Zar 1999,
/// eq. 27.4). NaN of a length that the mean of unit vectors cannot have, unless by rounding.
#[must_use]
pub fn rayleigh(resultant: f64, count: f64) -> f64 {
    if !(0.0..=1.0 + 1e-9).contains(&resultant) {
        return f64::NAN;
    }
    let r = resultant.min(1.0) * count;
    libm::exp((1.0 + 4.0 * count + 4.0 * (count * count - r * r)).sqrt() - (1.0 + 2.0 * count))
        .clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_agree_with_scipy() {
        // scipy 1.17 `stats.chi2.sf`, `stats.norm.sf`.
        for (x, freedom, expected) in [
            (1.0, 1.0, 0.31731050786291415),
            (3.0, 2.0, 0.22313016014842982),
            (7.0, 3.0, 0.07189777249646509),
            (20.0, 9.0, 0.017912404529843298),
            (12.5, 10.0, 0.2529853233092983),
            (400.0, 9.0, 1.3699125019662825e-80),
        ] {
            let found = chi_squared(x, freedom);
            assert!((found / expected - 1.0).abs() < 1e-12, "{x} {freedom}: {found:e}");
        }
        assert!((normal(1.5) - 0.06680720126885807).abs() < 1e-15);
        assert_eq!([0.0, -1.0, f64::NEG_INFINITY].map(|x| chi_squared(x, 3.0)), [1.0; 3]);
    }

    #[test]
    fn anderson_darling_has_the_published_points() {
        // Stephens (1974): 10 %, 5 %, 1 % points 0.631, 0.752, 1.035.
        for (a, p) in [(0.631, 0.10), (0.752, 0.05), (1.035, 0.01)] {
            assert!((anderson_darling_normal(a, 1e9) / p - 1.0).abs() < 0.05, "{a}");
        }
        assert_eq!(anderson_darling_normal(1e6, 100.0), 0.0);
    }

    /// Imhof's integral of Σ χ²₁/(j(j + 1)), mpmath 1.3.
    #[test]
    fn anderson_darling_of_a_given_law_has_its_points() {
        for (a, p) in [
            (0.5, 0.7468138092807445),
            (1.0, 0.35726542673865375),
            (1.933, 0.09999436230213687),
            (2.492, 0.05002207219910968),
            (3.878, 0.010001390685743149),
        ] {
            assert!((anderson_darling(a) / p - 1.0).abs() < 1e-3, "{a}");
        }
        let mut last = 1.0;
        for i in 0..400 {
            let p = anderson_darling(0.1 * f64::from(i));
            assert!(p <= last && p > 0.0, "{i}: {p:e}");
            last = p;
        }
        assert_eq!(anderson_darling(1e6), 0.0);
    }

    /// A NaN is no number that fits perfectly, whatever stands beside it.
    #[test]
    fn of_nan_all_are_nan() {
        let nan = f64::NAN;
        for other in [nan, f64::NEG_INFINITY, -1.0, 0.0, 0.5, 1.0, 100.0, 1e17, f64::INFINITY] {
            for p in [chi_squared, anderson_darling_normal, rayleigh] {
                assert!(p(nan, other).is_nan() && p(other, nan).is_nan(), "{other}");
            }
        }
        assert!(normal(nan).is_nan() && anderson_darling(nan).is_nan());
        assert!(rayleigh(-0.1, 9.0).is_nan() && rayleigh(1.1, 9.0).is_nan());
        assert_eq!(rayleigh(1.0 + 1e-15, 1e6), rayleigh(1.0, 1e6));
    }

    #[test]
    fn rayleigh_has_its_limits() {
        assert!(rayleigh(0.0, 100.0) > 0.99);
        assert!(rayleigh(1.0, 100.0) < 1e-20);
        // Zar's 5 % point for n = 20: z = n R² = 2.959.
        assert!((rayleigh((2.959_f64 / 20.0).sqrt(), 20.0) - 0.05).abs() < 0.001);
    }

    /// The sums of every whole degree against the incomplete gamma function, which takes over beyond them,
    /// from all of the law above x to 1e-300 of it; and between whole degrees, where it alone serves.
    #[test]
    fn chi_squared_of_any_degree_is_the_incomplete_gamma_function() {
        for step in 1..=400_u32 {
            let freedom = 0.1 * f64::from(step);
            for power in -40..=31_i32 {
                let x = 10_f64.powf(0.1 * f64::from(power));
                let found = chi_squared(x, freedom);
                let expected = checked_gamma_ur(0.5 * freedom, 0.5 * x).unwrap();
                let off = (found - expected).abs();
                assert!(off <= 1e-11 * expected + 1e-300, "{x} {freedom}: {found:e} {expected:e}");
            }
            let ends = [0.0, 1e-320, f64::MAX, f64::INFINITY].map(|x| chi_squared(x, freedom));
            assert_eq!([ends[0], ends[2], ends[3]], [1.0, 0.0, 0.0], "{freedom}");
        }
    }
}
