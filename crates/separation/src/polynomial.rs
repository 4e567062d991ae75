//! The first zero of a polynomial on [0, 1], none passed over.

/// Intervals shorter than this are not looked into.
const SHORTEST: f64 = 1e-6;
/// What comes as near to zero, as a share of the coefficients, has touched it.
const TOUCHED: f64 = 1e-11;

/// A correction as small as this leaves an error of its square.
const CONVERGED: f64 = 1e-7;

/// Where a polynomial that is negative at 0 first reaches zero on [0, 1], from below. Coefficients
/// from the constant up, two at least. A zero that is touched and not crossed counts.
pub(crate) fn first_zero(p: &[f64]) -> Option<f64> {
    if p[0] >= 0.0 {
        return Some(0.0);
    }
    match direction(p) {
        Some(Direction::Up) => {
            let (end, slope) = value(p, 1.0);
            // The inverse function as a cubic of the same values and slopes at both ends.
            let rise = end - p[0];
            let t = -p[0] / rise;
            let u = 1.0 - t;
            let guess = t * (t * (3.0 - 2.0 * t) + u * rise * (u / p[1] - t / slope));
            (end >= 0.0).then(|| bracketed(p, 0.0, 1.0, guess))
        }
        Some(Direction::Down) => None,
        None => search(p, 0.0, 1.0),
    }
}

#[derive(Clone, Copy)]
enum Direction {
    Up,
    Down,
}

/// Which way p goes on all of [0, 1], if that is sure: its first coefficients are of one sign, and
/// their sum exceeds those of the other sign that follow (x^m falls with m).
fn direction(p: &[f64]) -> Option<Direction> {
    let sign = p[1];
    let (mut first, mut against, mut leading) = (0.0, 0.0, true);
    for (k, x) in p.iter().enumerate().skip(1) {
        let slope = k as f64 * x.abs();
        if (*x >= 0.0) == (sign >= 0.0) {
            first += if leading { slope } else { 0.0 };
        } else {
            leading = false;
            against += slope;
        }
    }
    // NaN goes no way.
    (first > against).then_some(if sign >= 0.0 { Direction::Up } else { Direction::Down })
}

/// Value and slope. Even and odd terms by themselves, which halves the wait for what comes before.
fn value(p: &[f64], x: f64) -> (f64, f64) {
    let y = x * x;
    let (mut even, mut odd) = ((0.0, 0.0), (0.0, 0.0));
    for pair in p.chunks(2).rev() {
        even.1 = even.1 * y + even.0;
        even.0 = even.0 * y + pair[0];
        odd.1 = odd.1 * y + odd.0;
        odd.0 = odd.0 * y + if let [_, c] = pair { *c } else { 0.0 };
    }
    (even.0 + x * odd.0, odd.0 + 2.0 * (x * even.1 + y * odd.1))
}

/// The first zero between two points, negative at the first.
fn search(p: &[f64], from: f64, to: f64) -> Option<f64> {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    // Bound of the second derivative on the interval.
    let (mut bound, mut power) = (0.0, 1.0);
    for (k, c) in p.iter().enumerate().skip(2) {
        bound += (k * (k - 1)) as f64 * c.abs() * power;
        power *= to;
    }
    let (v, slope) = value(p, middle);
    // NaN has no zero.
    if !(v + half * (slope.abs() + 0.5 * half * bound) >= 0.0) {
        return None;
    }
    if half < SHORTEST {
        let size: f64 = p.iter().map(|c| c.abs()).sum();
        return (v >= -TOUCHED * size).then_some(middle);
    }
    if slope > half * bound {
        return (value(p, to).0 >= 0.0).then(|| bracketed(p, from, to, middle - v / slope));
    }
    let left = search(p, from, middle);
    if left.is_some() || v >= 0.0 { left.or(Some(middle)) } else { search(p, middle, to) }
}

/// The zero between a point where the polynomial is negative and one where it is not: Newton's
/// iteration from a guess, bisection where it leaves the bracket.
fn bracketed(p: &[f64], mut low: f64, mut high: f64, guess: f64) -> f64 {
    let mut x = if low <= guess && guess <= high { guess } else { 0.5 * (low + high) };
    for _ in 0..100 {
        let (v, slope) = value(p, x);
        if v < 0.0 {
            low = x;
        } else {
            high = x;
        }
        let newton = x - v / slope;
        let next = if low <= newton && newton <= high { newton } else { 0.5 * (low + high) };
        let done = (next - x).abs() <= CONVERGED;
        x = next;
        if done {
            break;
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn known_zeros() {
        assert_eq!(first_zero(&[-1.0, 0.5, 0.25]), None);
        let x = first_zero(&[-0.25, 0.0, 1.0]).unwrap();
        assert!((x - 0.5).abs() < 1e-15);
        // Up and down again within the interval: −(x − 0.3)(x − 0.6).
        let x = first_zero(&[-0.18, 0.9, -1.0]).unwrap();
        assert!((x - 0.3).abs() < 1e-15);
        // Just short of zero at its peak, and just beyond.
        assert_eq!(first_zero(&[-0.25 - 1e-9, 1.0, -1.0]), None);
        for off in [0.0, 1e-12] {
            assert!((first_zero(&[-0.25 + off, 1.0, -1.0]).unwrap() - 0.5).abs() < 3e-6);
        }
        assert_eq!(first_zero(&[0.0, 1.0]), Some(0.0));
        assert_eq!(first_zero(&[f64::NAN, 1.0, 1.0]), None);
        assert_eq!(first_zero(&[-1.0, f64::NAN, 1.0]), None);
    }

    proptest! {
        /// Products of factors: the smallest zero in (0, 1] is found, however close the next.
        #[test]
        fn the_first_of_many(zeros in prop::collection::vec(0.001..2.0f64, 5)) {
            let mut p = [0.0; 6];
            p[0] = -1.0;
            for (n, z) in zeros.iter().enumerate() {
                for k in (0..=n + 1).rev() {
                    p[k] -= if k > 0 { p[k - 1] / z } else { 0.0 };
                }
            }
            let first = zeros.iter().copied().fold(f64::INFINITY, f64::min);
            // Near-double zeros are ill-conditioned.
            let next = zeros.iter().copied().filter(|z| *z > first).fold(f64::INFINITY, f64::min);
            prop_assume!(next - first > 0.05 && (first - 1.0).abs() > 1e-5);
            match first_zero(&p) {
                Some(x) => prop_assert!((x - first).abs() < 1e-5, "{x} {first}"),
                None => prop_assert!(first > 1.0, "{first}"),
            }
        }
    }
}
