//! A normal law kept to a window, in the window's own coordinate: right however narrow the window is.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use crate::gauss_legendre::panel;
use crate::normal::above;
use crate::scaled::root_of_squares;

/// The nearer bound may be this many standard deviations from the mean: beyond, the Gaussian holds
/// 1e-9.
pub(crate) const MAX_DISTANCE: f64 = 6.0;
/// Deviations from the near end beyond which nothing is left in double precision.
const END: f64 = 38.0;
/// A window with a smaller width, in deviations, is a point.
const MIN_WIDTH: f64 = 1e-290;
/// The density relative to its largest value where quadrature ends is e to minus this.
const NEGLIGIBLE: f64 = 60.0;
/// So many times a share that is wanted is found by its logarithm.
const FAR_OFF: f64 = 1e6;
/// Up to this width one panel of the rule is exact to rounding, and differences of Φ are not.
const NARROW: f64 = 0.5;
/// Below this share of the anchor, or of a deviation, a value that is found as a sum of the anchor and a distance from it has
/// lost digits: the sum is rounded to 1e-16 of the anchor, and the distance found to 1e-15 of a deviation.
const SMALL: f64 = 1.0 / 16.0;

/// N(k̄, σ²) kept to [low, high].
///
/// # Definition
/// k = anchor + sign · σ · v. The anchor is k̄ where the window holds it, else the bound nearer to it,
/// from which v points away from k̄. With `offset` = |anchor − k̄|/σ the density of v is proportional
/// to exp(−v (offset + v/2)) on `ends`. The width (high − low)/σ is thus never the difference of
/// two rounded numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TruncatedNormal {
    bounds: [f64; 2],
    anchor: f64,
    sign: f64,
    deviation: f64,
    offset: f64,
    ends: [f64; 2],
    /// ∫ exp(−v (offset + v/2)) dv over the window.
    whole: f64,
}

/// An end of a window from which masses are told by the distance: as a difference of two v, a small one would lose its digits.
struct End {
    v: f64,
    inwards: f64,
}

impl End {
    /// The density of v at a distance over its value at the anchor.
    fn density(&self, window: &TruncatedNormal, distance: f64) -> f64 {
        libm::exp(window.ln_density(self.v + self.inwards * distance))
    }

    /// Its integral up to a small distance.
    fn mass(&self, window: &TruncatedNormal, distance: f64) -> f64 {
        let mut sum = 0.0;
        panel(0.0, distance, |u, weight| sum += weight * self.density(window, u));
        sum
    }
}

/// Why bounds are refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum WindowError {
    /// A bound is NaN, or the second is not above the first.
    Bounds,
    /// The nearer bound is this many deviations from the mean, which is too many.
    Distance(f64),
}

/// The moments of a window.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WindowMoments {
    /// E k.
    pub(crate) mean: f64,
    /// √(Var k), which is a number where the variance is too small for one.
    pub(crate) deviation: f64,
    /// E k².
    pub(crate) square_mean: f64,
    /// Var k².
    pub(crate) square_variance: f64,
}

impl TruncatedNormal {
    /// A finite mean and a deviation that is not negative. Without a deviation the bounds may be equal.
    pub(crate) fn new(
        mean: f64,
        deviation: f64,
        [low, high]: [f64; 2],
    ) -> Result<Self, WindowError> {
        let bounds = [low, high];
        if !(low <= high) {
            return Err(WindowError::Bounds);
        }
        if deviation == 0.0 {
            if !(low..=high).contains(&mean) {
                return Err(WindowError::Distance(f64::INFINITY));
            }
            let ends = [0.0; 2];
            let (sign, offset, whole) = (1.0, 0.0, 1.0);
            return Ok(Self { bounds, anchor: mean, sign, deviation, offset, ends, whole });
        }
        let width = (high - low) / deviation;
        if !(width >= MIN_WIDTH) {
            return Err(WindowError::Bounds);
        }
        let (anchor, sign, offset, ends) = if mean < low {
            (low, 1.0, (low - mean) / deviation, [0.0, width])
        } else if mean > high {
            (high, -1.0, (mean - high) / deviation, [0.0, width])
        } else {
            (mean, 1.0, 0.0, [(low - mean) / deviation, (high - mean) / deviation])
        };
        if !(offset <= MAX_DISTANCE) {
            return Err(WindowError::Distance(offset));
        }
        let ends = ends.map(|v| v.clamp(-END, END));
        let mut window = Self { bounds, anchor, sign, deviation, offset, ends, whole: 1.0 };
        window.whole = window.mass(ends[0], ends[1]);
        Ok(window)
    }

    /// Before truncation.
    pub(crate) fn deviation(&self) -> f64 {
        self.deviation
    }

    /// |anchor − k̄|/σ: zero where the window holds the mean.
    pub(crate) fn offset(&self) -> f64 {
        self.offset
    }

    /// 1, or −1 where the window lies below the mean.
    pub(crate) fn sign(&self) -> f64 {
        self.sign
    }

    /// The window.
    pub(crate) fn bounds(&self) -> [f64; 2] {
        self.bounds
    }

    /// The window in v.
    pub(crate) fn ends(&self) -> [f64; 2] {
        self.ends
    }

    /// ln of the density of v over its value at the anchor.
    pub(crate) fn ln_density(&self, v: f64) -> f64 {
        -v * (self.offset + 0.5 * v)
    }

    /// ln of the density of k; none without a deviation.
    pub(crate) fn ln_density_at(&self, k: f64) -> Option<f64> {
        let [low, high] = self.bounds;
        (self.deviation > 0.0).then(|| {
            if !(low..=high).contains(&k) {
                return f64::NEG_INFINITY;
            }
            let v = self.sign * (k - self.anchor) / self.deviation;
            self.ln_density(v) - libm::log(self.whole) - libm::log(self.deviation)
        })
    }

    /// k at v.
    pub(crate) fn value(&self, v: f64) -> f64 {
        (self.anchor + self.sign * self.deviation * v).clamp(self.bounds[0], self.bounds[1])
    }

    /// The share of the Gaussian that the window holds.
    pub(crate) fn share(&self) -> f64 {
        if self.deviation == 0.0 {
            return 1.0;
        }
        libm::exp(-0.5 * self.offset * self.offset) / (2.0 * PI).sqrt() * self.whole
    }

    /// The probability of a value of at most x.
    pub(crate) fn cdf(&self, x: f64) -> f64 {
        if self.deviation == 0.0 {
            return f64::from(u8::from(x >= self.anchor));
        }
        self.share_beside(x, x - self.bounds[0], self.sign < 0.0)
    }

    /// The probability of a value above x.
    pub(crate) fn share_above(&self, x: f64) -> f64 {
        if self.deviation == 0.0 {
            return f64::from(u8::from(x < self.anchor));
        }
        self.share_beside(x, self.bounds[1] - x, self.sign > 0.0)
    }

    /// The end of the largest v, or of the smallest, where it is a bound of the law and so near that one panel is exact.
    fn end_within(&self, distance: f64, is_largest: bool) -> Option<End> {
        let [from, to] = self.ends;
        let (v, inwards) = if is_largest { (to, -1.0) } else { (from, 1.0) };
        (distance <= NARROW.min(to - from) && v.abs() < END).then_some(End { v, inwards })
    }

    /// The share between x and the bound from which it is so far: that of the largest v, or of the smallest.
    fn share_beside(&self, x: f64, distance: f64, is_largest: bool) -> f64 {
        let [low, high] = self.bounds;
        let [from, to] = self.ends;
        let distance = distance.max(0.0) / self.deviation;
        let mass = if let Some(end) = self.end_within(distance, is_largest) {
            end.mass(self, distance)
        } else {
            let v =
                (self.sign * (x.clamp(low, high) - self.anchor) / self.deviation).clamp(from, to);
            if is_largest { self.mass(v, to) } else { self.mass(from, v) }
        };
        (mass / self.whole).min(1.0)
    }

    /// The value below which a share Φ(z) of the window lies: bisection, by Newton's iteration where
    /// that stays inside.
    pub(crate) fn at_score(&self, z: f64) -> f64 {
        if self.deviation == 0.0 {
            return self.anchor;
        }
        // Where the window is open, the number that ends it for the integrals is no bound of the law.
        if z.is_infinite() {
            return self.bounds[usize::from(z > 0.0)];
        }
        let [from, to] = self.ends;
        let z = self.sign * z;
        let (mut low, mut high) = (from, to);
        let width = to - from;
        // From the end that is nearer, so that small shares keep their digits.
        let rising = z < 0.0;
        let share = above(z.abs());
        let target = self.whole * share;
        let mut v = if width > NARROW {
            (z - self.offset).clamp(from, to)
        } else if rising {
            from + share * width
        } else {
            to - share * width
        };
        for _ in 0..200 {
            let found = if rising { self.mass(from, v) } else { self.mass(v, to) };
            let excess = if rising { found - target } else { target - found };
            if excess < 0.0 {
                low = v;
            } else {
                high = v;
            }
            let density = libm::exp(self.ln_density(v));
            // Far out, where the share is many times what is wanted, Newton's iteration would come nearer by a factor e at
            // each step: there it is done in the logarithm.
            let newton = if found > FAR_OFF * target {
                let step = found * libm::log(found / target) / density;
                if rising { v - step } else { v + step }
            } else {
                v - excess / density
            };
            let next = if newton > low && newton < high { newton } else { 0.5 * low + 0.5 * high };
            let done = (next - v).abs() <= 1e-15 * (width.min(1.0) + v.abs());
            v = next;
            if done {
                break;
            }
        }
        let x = self.value(v);
        self.near_bound(x, !rising, target).unwrap_or(x)
    }

    /// The value between which and the bound of the largest v, or of the smallest, `target` of the mass lies, from a first guess
    /// of it. None unless both are small beside the anchor or the deviation: other values have their digits, and stay as they are.
    fn near_bound(&self, x: f64, is_largest: bool, target: f64) -> Option<f64> {
        let is_high = is_largest == (self.sign > 0.0);
        let bound = self.bounds[usize::from(is_high)];
        let gap = (x - bound).abs();
        let scale = self.deviation * (self.ends[1] - self.ends[0]).min(1.0);
        if !(x.abs() + gap < SMALL * self.anchor.abs().max(scale)) {
            return None;
        }
        let mut distance = gap / self.deviation;
        let end = self.end_within(distance, is_largest)?;
        // In proportion to the mass, which brings a guess near however small the distance is, and then by Newton's iteration.
        let guessed = end.mass(self, distance);
        distance = if guessed > 0.0 {
            distance * (target / guessed)
        } else {
            target / end.density(self, 0.0)
        };
        for _ in 0..8 {
            let excess = end.mass(self, distance) - target;
            let next = (distance - excess / end.density(self, distance)).max(0.0);
            let done = (next - distance).abs() <= 1e-16 * next;
            distance = next;
            if done {
                break;
            }
        }
        let inwards = if is_high { -self.deviation } else { self.deviation };
        Some((bound + inwards * distance).clamp(self.bounds[0], self.bounds[1]))
    }

    /// ∫ exp(−v (offset + v/2)) dv.
    fn mass(&self, from: f64, to: f64) -> f64 {
        if to - from <= NARROW {
            let mut sum = 0.0;
            panel(from, to, |v, weight| sum += weight * libm::exp(self.ln_density(v)));
            return sum;
        }
        let scale = (2.0 * PI).sqrt() * libm::exp(0.5 * self.offset * self.offset);
        scale * share(self.offset + from, self.offset + to)
    }

    /// Mean and variance of k and of k², to rounding: sums of terms that are not negative.
    pub(crate) fn moments(&self) -> WindowMoments {
        let (s, sign) = (self.deviation, self.sign);
        if s == 0.0 {
            let square_mean = self.anchor * self.anchor;
            let mean = self.anchor;
            let (deviation, square_variance) = (0.0, 0.0);
            return WindowMoments { mean, deviation, square_mean, square_variance };
        }
        // Where offset · v + v²/2 = NEGLIGIBLE.
        let reach = 2.0 * NEGLIGIBLE / (self.offset + self.offset.hypot((2.0 * NEGLIGIBLE).sqrt()));
        let [from, to] = self.ends.map(|v| v.clamp(-reach, reach));
        let panels = (to - from).ceil().max(1.0);
        let at = |i: f64| from + (to - from) * (i / panels);
        let sum = |term: &dyn Fn(f64) -> f64| {
            let mut sum = 0.0;
            for i in 0..panels as u32 {
                let i = f64::from(i);
                panel(at(i), at(i + 1.0), |v, weight| {
                    sum += weight * libm::exp(self.ln_density(v)) * term(v);
                });
            }
            sum
        };
        let whole = sum(&|_| 1.0);
        let mean_v = sum(&|v| v) / whole;
        let variance = sum(&|v| (v - mean_v) * (v - mean_v)) / whole;
        let mean = self.anchor + sign * s * mean_v;
        // k² − E k² = σ (2 E k y + σ (y² − Var v)) with k = E k + σ y.
        let square = sum(&|v| {
            let y = sign * (v - mean_v);
            let gap = 2.0 * mean * y + s * (y * y - variance);
            gap * gap
        }) / whole;
        WindowMoments {
            mean,
            deviation: root_of_squares(s, |unit| (s / unit) * (s / unit) * variance),
            square_mean: mean * mean + s * s * variance,
            square_variance: s * s * square,
        }
    }
}

/// Φ(β) − Φ(α), without cancellation in the tails.
pub(crate) fn share(alpha: f64, beta: f64) -> f64 {
    if alpha > 0.0 {
        above(alpha) - above(beta)
    } else if beta < 0.0 {
        above(-beta) - above(-alpha)
    } else {
        0.5 * (libm::erf(beta * FRAC_1_SQRT_2) - libm::erf(alpha * FRAC_1_SQRT_2))
    }
}

#[cfg(test)]
mod tests;
