//! Sampling in a chart of the sphere: three coordinates from a Gaussian, the fourth from |y| = 1.
//!
//! Drop coordinate k, write u for the other three and h = √(1 − |u|²), so that y_k = ±h and surface
//! measure is du/h on either sheet. On the sphere a multiple μ of |y|² = 1 may be moved freely
//! between the coordinates, which makes exp(−½ Σ λ_j(y_j − c_j)²) the product of a Gaussian in u,
//! precisions p_j = λ_j − μ and means b_j/p_j with b = λc, and a weight of h alone,
//!
//! ψ(h) = [e^{b_k h} + e^{−b_k h}]·exp(−½(λ_k − μ)h²)/h,
//!
//! one term for each sheet. Propose u, accept with ψ(h)/max ψ. μ is chosen to make ψ flat where the
//! Gaussian puts its mass. The weight has a pole at h = 0: the belt h < h₀ is left out, and the
//! chart refuses to serve a law of which the belt holds more than 2⁻⁶⁴.

use nalgebra::{Matrix4, Vector4};
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::{LN_2, PI, TAU};

const BINS: usize = 64;
/// ln 2⁻⁶⁴: what a generator of 64 bits cannot resolve.
const LN_BELT: f64 = -64.0 * LN_2;

/// tanh(x)/x − 1/x² rises to this maximum and falls from there; found by Newton in 50 digits.
const CREST: (f64, f64) = (2.264_885_841_899_889_5, 0.237_160_049_676_758_4);

#[derive(Clone, Debug)]
pub(crate) struct Chart {
    location: [f64; 3],
    scale: [f64; 3],
    /// What the three kept coordinates and the dropped one are of x: eigenvectors, in that order,
    /// so that a draw needs no indices.
    columns: [Vector4<f64>; 4],
    weight: Weight,
    ln_peak: f64,
    /// h₀², and bins a unit of h² above it.
    floor: f64,
    bins_per_unit: f64,
    bins: [Bin; BINS],
    acceptance: f64,
}

/// Bounds of ψ₊/M and (ψ₊ + ψ₋)/M over a range of h²: the squeeze that avoids the exponentials.
#[derive(Clone, Copy, Debug)]
struct Bin {
    plus_low: f64,
    plus_high: f64,
    total_low: f64,
}

impl Chart {
    /// The best chart for exp(−½ Σ λ_j(y_j − c_j)²), whose integral over S³ is exp(ln_integral),
    /// with x = V y.
    pub(crate) fn new(
        axes: &Matrix4<f64>,
        lambda: [f64; 4],
        center: [f64; 4],
        ln_integral: f64,
    ) -> Option<Self> {
        // The coordinate to drop is the one whose mean is far from zero for its spread.
        let mut order = [0, 1, 2, 3];
        let reach = |k: usize| center[k].abs() / lambda[k].sqrt();
        order.sort_by(|&a, &b| reach(b).total_cmp(&reach(a)));
        let mut best: Option<Self> = None;
        for k in order {
            if best.as_ref().is_some_and(|chart| chart.acceptance > 0.5) {
                break;
            }
            let problem = Problem::new(lambda, center, ln_integral, k);
            if let Some(chart) = problem.best_proposal().map(|p| problem.chart(axes, &p))
                && best.as_ref().is_none_or(|b| b.acceptance < chart.acceptance)
            {
                best = Some(chart);
            }
        }
        best
    }

    /// The share of proposals that are accepted.
    pub(crate) fn acceptance(&self) -> f64 {
        self.acceptance
    }

    #[inline]
    pub(crate) fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> Vector4<f64> {
        loop {
            // One by one: an array would go through memory, which costs more than the arithmetic.
            let z: f64 = StandardNormal.sample(rng);
            let u0 = self.location[0] + self.scale[0] * z;
            let z: f64 = StandardNormal.sample(rng);
            let u1 = self.location[1] + self.scale[1] * z;
            let z: f64 = StandardNormal.sample(rng);
            let u2 = self.location[2] + self.scale[2] * z;
            let v = 1.0 - (u0 * u0 + u1 * u1 + u2 * u2);
            // Negated so that a NaN could not pass.
            if !(v > self.floor) {
                continue;
            }
            let uniform: f64 = rng.random();
            let bin = &self.bins[(((v - self.floor) * self.bins_per_unit) as usize).min(BINS - 1)];
            let h = v.sqrt();
            let height = if uniform < bin.plus_low {
                h
            } else if uniform >= bin.plus_high && uniform < bin.total_low {
                -h
            } else {
                let plus = libm::exp(self.weight.ln_sheet(1.0, h) - self.ln_peak);
                let minus = libm::exp(self.weight.ln_sheet(-1.0, h) - self.ln_peak);
                if uniform < plus {
                    h
                } else if uniform < plus + minus {
                    -h
                } else {
                    continue;
                }
            };
            let [a, b, c, d] = &self.columns;
            return a * u0 + b * u1 + c * u2 + d * height;
        }
    }
}

/// ψ, by the slope b_k and the bend λ_k − μ.
#[derive(Clone, Copy, Debug)]
struct Weight {
    slope: f64,
    bend: f64,
}

impl Weight {
    /// ln ψ± of one sheet.
    fn ln_sheet(&self, sign: f64, h: f64) -> f64 {
        sign * self.slope * h - 0.5 * self.bend * h * h - libm::log(h)
    }

    /// ln ψ of both sheets.
    fn ln_total(&self, h: f64) -> f64 {
        let up = self.slope.abs() * h;
        up + libm::log1p(libm::exp(-2.0 * up)) - 0.5 * self.bend * h * h - libm::log(h)
    }

    /// Where ln ψ has its interior maximum: the larger zero of
    /// (λ_k − μ)h² − b_k h tanh(b_k h) + 1. Scanning a grid would miss narrow peaks.
    fn crest(&self) -> Option<f64> {
        let slope = self.slope.abs();
        let ratio = self.bend / (slope * slope);
        // In x = b h: tanh(x)/x − 1/x² = ratio, on the falling branch.
        if !(ratio > 0.0 && ratio < CREST.1) {
            return None;
        }
        let f = |x: f64| libm::tanh(x) / x - 1.0 / (x * x) - ratio;
        let (mut low, mut high) = (CREST.0, 1.0 / ratio);
        let mut x = 0.5 * (1.0 + (1.0 - 4.0 * ratio).max(0.0).sqrt()) / ratio;
        for _ in 0..60 {
            let value = f(x);
            if value > 0.0 {
                low = x
            } else {
                high = x
            }
            let t = libm::tanh(x);
            let derivative = (1.0 - t * t) / x - t / (x * x) + 2.0 / (x * x * x);
            let newton = x - value / derivative;
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            if (next - x).abs() <= 1e-15 * x {
                break;
            }
            x = next;
        }
        Some(x / slope)
    }

    /// ln max ψ over [h₀, 1].
    fn ln_peak(&self, h0: f64) -> f64 {
        let ends = self.ln_total(h0).max(self.ln_total(1.0));
        match self.crest() {
            Some(h) if h > h0 && h < 1.0 => ends.max(self.ln_total(h)),
            _ => ends,
        }
    }

    /// Smallest and largest ln ψ± over [low, high]: at the ends or where bend·h² ∓ b h + 1 = 0.
    fn sheet_range(&self, sign: f64, low: f64, high: f64) -> (f64, f64) {
        let (a, b) = (self.ln_sheet(sign, low), self.ln_sheet(sign, high));
        let mut range = (a.min(b), a.max(b));
        let slope = sign * self.slope;
        let discriminant = slope * slope - 4.0 * self.bend;
        if discriminant > 0.0 {
            // The stable pair of roots: q/bend and 1/q.
            let q = 0.5 * (slope + discriminant.sqrt().copysign(slope));
            for h in [q / self.bend, 1.0 / q] {
                if h > low && h < high {
                    let value = self.ln_sheet(sign, h);
                    range = (range.0.min(value), range.1.max(value));
                }
            }
        }
        range
    }
}

/// A law with one coordinate dropped.
struct Problem {
    dropped: usize,
    kept: [usize; 3],
    lambda: [f64; 3],
    linear: [f64; 3],
    dropped_lambda: f64,
    slope: f64,
    /// −½ Σ λc² − ln C.
    constant: f64,
}

/// What one choice of μ leads to.
struct Proposal {
    precision: [f64; 3],
    weight: Weight,
    h0: f64,
    ln_peak: f64,
    ln_acceptance: f64,
}

impl Problem {
    fn new(lambda: [f64; 4], center: [f64; 4], ln_integral: f64, dropped: usize) -> Self {
        let kept = [1, 2, 3].map(|step| (dropped + step) % 4);
        let square: f64 = lambda.iter().zip(center).map(|(l, c)| l * c * c).sum();
        Self {
            dropped,
            kept,
            lambda: kept.map(|j| lambda[j]),
            linear: kept.map(|j| lambda[j] * center[j]),
            dropped_lambda: lambda[dropped],
            slope: lambda[dropped] * center[dropped],
            constant: -0.5 * square - ln_integral,
        }
    }

    /// The proposal for the smallest kept precision p = min λ_j − μ.
    fn proposal(&self, smallest: f64) -> Option<Proposal> {
        let floor = self.lambda.into_iter().fold(f64::INFINITY, f64::min);
        let mu = floor - smallest;
        let precision = self.lambda.map(|l| (l - floor) + smallest);
        let weight = Weight { slope: self.slope, bend: self.dropped_lambda - mu };
        // ln of the constant in front of Gaussian × ψ, relative to C.
        let gain: f64 = self.linear.iter().zip(precision).map(|(b, p)| 0.5 * b * b / p).sum();
        let front = self.constant + gain - 0.5 * mu;
        let h0 = self.belt_edge(&precision, &weight, front)?;
        let ln_peak = weight.ln_peak(h0);
        let volume: f64 = precision.iter().map(|p| 0.5 * libm::log(TAU / p)).sum();
        Some(Proposal {
            precision,
            weight,
            h0,
            ln_peak,
            ln_acceptance: -(front + ln_peak + volume),
        })
    }

    /// The largest h₀ whose belt may be left out.
    fn belt_edge(&self, precision: &[f64; 3], weight: &Weight, front: f64) -> Option<f64> {
        let center: [f64; 3] = std::array::from_fn(|j| self.linear[j] / precision[j]);
        let negligible = |h0: f64| {
            let sup = LN_2 + self.slope.abs() * h0 + (-0.5 * weight.bend * h0 * h0).max(0.0);
            let distance = distance_to_sphere(precision, &center, 1.0 - h0 * h0);
            libm::log(4.0 * PI * h0) + sup + front - 0.5 * distance < LN_BELT
        };
        let (mut low, mut high) = (1e-3, 0.999);
        if !negligible(low) {
            return None;
        }
        for _ in 0..10 {
            let middle = 0.5 * (low + high);
            if negligible(middle) { low = middle } else { high = middle }
        }
        Some(low)
    }

    /// Maximises the acceptance over μ: a scan, then golden sections.
    fn best_proposal(&self) -> Option<Proposal> {
        const STEP: f64 = 0.5;
        let widest = self.lambda.into_iter().fold(self.dropped_lambda, f64::max);
        let (start, end) = (libm::log(0.25), libm::log(4.0 * widest + 100.0));
        let score =
            |t: f64| self.proposal(libm::exp(t)).map_or(f64::NEG_INFINITY, |p| p.ln_acceptance);
        let steps = ((end - start) / STEP) as usize;
        let (best, value) = (0..=steps)
            .map(|i| start + STEP * i as f64)
            .map(|t| (t, score(t)))
            .max_by(|a, b| a.1.total_cmp(&b.1))?;
        if value == f64::NEG_INFINITY {
            return None;
        }
        self.proposal(libm::exp(golden_section(score, best - STEP, best + STEP)))
    }

    fn chart(&self, axes: &Matrix4<f64>, proposal: &Proposal) -> Chart {
        // A hair above the peak, so that rounding in ψ cannot exceed it.
        let ln_peak = proposal.ln_peak + 1e-13;
        let floor = proposal.h0 * proposal.h0;
        let width = (1.0 - floor) / BINS as f64;
        let bins = std::array::from_fn(|i| {
            // Widened by more than the rounding of the bin index.
            let low = (floor + width * (i as f64 - 1e-9)).sqrt();
            let high = (floor + width * (i as f64 + 1.0 + 1e-9)).sqrt();
            let (plus, minus) = (
                proposal.weight.sheet_range(1.0, low, high),
                proposal.weight.sheet_range(-1.0, low, high),
            );
            let scaled = |x: f64, slack: f64| libm::exp(x - ln_peak + slack);
            let plus_low = scaled(plus.0, -1e-12);
            Bin {
                plus_low,
                plus_high: scaled(plus.1, 1e-12),
                total_low: plus_low + scaled(minus.0, -1e-12),
            }
        });
        Chart {
            columns: [self.kept[0], self.kept[1], self.kept[2], self.dropped]
                .map(|j| axes.column(j).into()),
            location: std::array::from_fn(|j| self.linear[j] / proposal.precision[j]),
            scale: proposal.precision.map(|p| 1.0 / p.sqrt()),
            weight: proposal.weight,
            ln_peak,
            floor,
            bins_per_unit: 1.0 / width,
            bins,
            acceptance: libm::exp(proposal.ln_acceptance).min(1.0),
        }
    }
}

/// A lower bound of min Σ p_j(u_j − a_j)² over |u|² ≥ r², nearly sharp: the Lagrangian dual, of
/// which every value is a bound.
fn distance_to_sphere(p: &[f64; 3], a: &[f64; 3], square_radius: f64) -> f64 {
    if a.iter().map(|x| x * x).sum::<f64>() >= square_radius {
        return 0.0;
    }
    let limit = p.iter().copied().fold(f64::INFINITY, f64::min);
    let terms = |eta: f64| {
        let (mut value, mut slope) = (eta * square_radius, square_radius);
        for (p, a) in p.iter().zip(a) {
            let ratio = p / (p - eta);
            value -= eta * a * a * ratio;
            slope -= a * a * ratio * ratio;
        }
        (value, slope)
    };
    let (mut low, mut high) = (0.0, limit * (1.0 - 1e-9));
    if terms(high).1 > 0.0 {
        return terms(high).0;
    }
    for _ in 0..12 {
        let middle = 0.5 * (low + high);
        if terms(middle).1 > 0.0 { low = middle } else { high = middle }
    }
    terms(low).0.max(0.0)
}

/// The maximiser of a function with one maximum in [low, high].
pub(crate) fn golden_section(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    const RATIO: f64 = 0.618_033_988_749_894_9;
    let (mut a, mut b) = (high - RATIO * (high - low), low + RATIO * (high - low));
    let (mut fa, mut fb) = (f(a), f(b));
    // The interval shrinks by 1e-10.
    for _ in 0..48 {
        if fa > fb {
            (high, b, fb) = (b, a, fa);
            a = high - RATIO * (high - low);
            fa = f(a);
        } else {
            (low, a, fa) = (a, b, fb);
            b = low + RATIO * (high - low);
            fb = f(b);
        }
    }
    if fa > fb { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_crest_constant_is_where_the_slope_vanishes() {
        let x = CREST.0;
        let t = libm::tanh(x);
        assert!(((1.0 - t * t) / x - t / (x * x) + 2.0 / (x * x * x)).abs() < 1e-15);
        assert!((t / x - 1.0 / (x * x) - CREST.1).abs() < 1e-15);
    }

    proptest! {
        #[test]
        fn the_peak_bounds_the_weight(
            slope in -1e3..1e3f64,
            bend in -1e3..1e6f64,
            h0 in 0.01..0.9f64,
            h in 0.0..1.0f64,
        ) {
            let weight = Weight { slope, bend };
            let h = h0 + (1.0 - h0) * h;
            prop_assert!(weight.ln_total(h) <= weight.ln_peak(h0) + 1e-9);
            for sign in [1.0, -1.0] {
                let (low, high) = weight.sheet_range(sign, h0, 1.0);
                let value = weight.ln_sheet(sign, h);
                prop_assert!(value >= low - 1e-9 && value <= high + 1e-9);
            }
        }

        #[test]
        fn the_distance_is_a_lower_bound(
            p in prop::array::uniform3(0.1..1e3f64),
            a in prop::array::uniform3(-0.5..0.5f64),
            u in prop::array::uniform3(-1.0..1.0f64),
            r in 0.1..1.0f64,
        ) {
            let norm = u.iter().map(|x| x * x).sum::<f64>().sqrt();
            prop_assume!(norm > 1e-3);
            let value: f64 = (0..3).map(|j| p[j] * (u[j] / norm * r - a[j]).powi(2)).sum();
            prop_assert!(distance_to_sphere(&p, &a, r * r) <= value + 1e-12);
        }
    }
}
