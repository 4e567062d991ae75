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

use nalgebra::{Matrix4, Quaternion, UnitQuaternion, Vector4};
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::{LN_2, PI};

use crate::vector;

/// Proposals made at a time in a batch: few enough for the first-level cache.
const CHUNK: usize = 128;

const BINS: usize = 64;
/// ln 2⁻⁶⁴: what a generator of 64 bits cannot resolve.
const LN_BELT: f64 = -64.0 * LN_2;

const LN_TAU: f64 = 1.837_877_066_409_345_5;

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
    /// Above this h² − h₀², uniform numbers below that many of 4096 mean the upper sheet: worth a look
    /// where that is nearly all of them.
    sure_above: f64,
    sure: u32,
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
    /// with x = V y. Under exp(−½ Σ (λ_j + shift)(y_j − c_j)²) in ℝ⁴, |y|² = 1 holds on average.
    pub(crate) fn new(
        axes: &Matrix4<f64>,
        lambda: [f64; 4],
        centre: [f64; 4],
        ln_integral: f64,
        shift: f64,
    ) -> Option<Self> {
        // The coordinate to drop is the one whose mean is far from zero for its spread.
        let mut order = [0, 1, 2, 3];
        let reach = |k: usize| centre[k].abs() / lambda[k].sqrt();
        order.sort_by(|&a, &b| reach(b).total_cmp(&reach(a)));
        let mut best: Option<(Problem, Proposal)> = None;
        for k in order {
            if best.as_ref().is_some_and(|(_, b)| b.ln_acceptance > -LN_2) {
                break;
            }
            let problem = Problem::new(lambda, centre, ln_integral, k);
            if let Some(proposal) = problem.best_proposal(shift)
                && best.as_ref().is_none_or(|(_, b)| b.ln_acceptance < proposal.ln_acceptance)
            {
                best = Some((problem, proposal));
            }
        }
        best.map(|(problem, proposal)| problem.chart(axes, &proposal))
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
            } else if let Some(height) = self.decide(uniform, h) {
                height
            } else {
                continue;
            };
            let [a, b, c, d] = &self.columns;
            return a * u0 + b * u1 + c * u2 + d * height;
        }
    }
}

impl Chart {
    /// Fills a slice with draws, by the machine's vector units.
    pub(crate) fn sample_into<R: Rng + ?Sized>(
        &self,
        rng: &mut R,
        out: &mut [UnitQuaternion<f64>],
    ) {
        let mut batch = Batch {
            bits: [0; 3 * CHUNK],
            u: [0.0; 3 * CHUNK],
            v: [0.0; CHUNK],
            h: [0.0; CHUNK],
            place: [0; CHUNK],
        };
        let mut rest = out;
        while !rest.is_empty() {
            rng.fill(&mut batch.bits[..]);
            pulp::Arch::new().dispatch(Propose { chart: self, batch: &mut batch });
            let kept = self.keep(rng, &mut batch).min(rest.len());
            let (next, later) = rest.split_at_mut(kept);
            pulp::Arch::new().dispatch(Place { chart: self, batch: &batch, out: next });
            rest = later;
        }
    }

    /// Moves the accepted proposals of a batch to its front; returns how many.
    fn keep<R: Rng + ?Sized>(&self, rng: &mut R, batch: &mut Batch) -> usize {
        const UNIT: f64 = 1.0 / 4096.0;
        let Batch { bits, u, v, h, place } = batch;
        let mut kept = 0;
        for i in 0..CHUNK {
            // Twelve bits, which the length of a normal leaves, are all of a uniform number that nearly
            // every decision needs.
            let few = (bits[i] & 0xfff) as u32;
            if v[i] > self.sure_above && few < self.sure {
                // Where nothing was refused yet, it is in place.
                if kept != i {
                    h[kept] = h[i];
                }
            } else {
                if !(v[i] > 0.0) {
                    continue;
                }
                let bin = &self.bins[place[i] as usize % BINS];
                let (low, high) = (f64::from(few) * UNIT, f64::from(few + 1) * UNIT);
                let plus = high <= bin.plus_low;
                // Without a branch between the sheets, which nobody can predict.
                h[kept] = if plus | ((low >= bin.plus_high) & (high <= bin.total_low)) {
                    if plus { h[i] } else { -h[i] }
                } else if let Some(height) = self.decide(low + UNIT * rng.random::<f64>(), h[i]) {
                    height
                } else {
                    continue;
                };
            }
            if kept != i {
                u[kept] = u[i];
                u[CHUNK + kept] = u[CHUNK + i];
                u[2 * CHUNK + kept] = u[2 * CHUNK + i];
            }
            kept += 1;
        }
        kept
    }

    /// The height of an accepted proposal, y_k with its sign, where the bounds leave it open.
    fn decide(&self, uniform: f64, h: f64) -> Option<f64> {
        let plus = libm::exp(self.weight.ln_sheet(1.0, h) - self.ln_peak);
        let minus = libm::exp(self.weight.ln_sheet(-1.0, h) - self.ln_peak);
        if uniform < plus {
            Some(h)
        } else if uniform < plus + minus {
            Some(-h)
        } else {
            None
        }
    }
}

/// One batch of proposals: random bits, u one coordinate after the other, |y_k|² − h₀², and |y_k|.
struct Batch {
    bits: [u64; 3 * CHUNK],
    u: [f64; 3 * CHUNK],
    v: [f64; CHUNK],
    h: [f64; CHUNK],
    /// The bins.
    place: [u64; CHUNK],
}

/// Makes a batch from random bits.
struct Propose<'a> {
    chart: &'a Chart,
    batch: &'a mut Batch,
}

impl pulp::WithSimd for Propose<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Batch { bits, u, v, h, place } = self.batch;
        vector::normals(bits, u);
        let (first, rest) = u.split_at_mut(CHUNK);
        let (second, third) = rest.split_at_mut(CHUNK);
        const LAST: f64 = (BINS - 1) as f64;
        let Chart { location, scale, floor, bins_per_unit, .. } = *self.chart;
        for i in 0..CHUNK {
            first[i] = location[0] + scale[0] * first[i];
            second[i] = location[1] + scale[1] * second[i];
            third[i] = location[2] + scale[2] * third[i];
            let rest = 1.0 - (first[i] * first[i] + second[i] * second[i] + third[i] * third[i]);
            v[i] = rest - floor;
            h[i] = rest.max(0.0).sqrt();
            // The nearest of the middles: at an edge either bin will do.
            place[i] = vector::rounded((v[i] * bins_per_unit - 0.5).clamp(0.0, LAST));
        }
    }
}

/// Turns what a batch has kept into attitudes.
struct Place<'a> {
    chart: &'a Chart,
    batch: &'a Batch,
    out: &'a mut [UnitQuaternion<f64>],
}

impl pulp::WithSimd for Place<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let [a, b, c, d] = &self.chart.columns;
        let Batch { u, h, .. } = self.batch;
        for (i, q) in self.out.iter_mut().enumerate() {
            let x = a * u[i] + b * u[CHUNK + i] + c * u[2 * CHUNK + i] + d * h[i];
            *q = UnitQuaternion::new_unchecked(Quaternion::from(x));
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

    /// Where ψ is largest over [h₀, 1], and its logarithm there.
    fn peak(&self, h0: f64) -> (f64, f64) {
        let mut best = (1.0, self.ln_total(1.0));
        let crest = self.crest().filter(|h| *h > h0 && *h < 1.0);
        for h in std::iter::once(h0).chain(crest) {
            let value = self.ln_total(h);
            if value > best.1 {
                best = (h, value);
            }
        }
        best
    }

    /// The heights at which ψ± of one sheet is stationary: bend·h² ∓ b h + 1 = 0.
    fn stationary(&self, sign: f64) -> [f64; 2] {
        let slope = sign * self.slope;
        let discriminant = slope * slope - 4.0 * self.bend;
        if !(discriminant > 0.0) {
            return [f64::NAN; 2];
        }
        // The stable pair of roots: q/bend and 1/q.
        let q = 0.5 * (slope + discriminant.sqrt().copysign(slope));
        [q / self.bend, 1.0 / q]
    }

    /// How much ln ψ may be off by the rounding of h and of its own terms.
    fn rounding(&self, h0: f64) -> f64 {
        1e-13 + 1e-14 * (self.slope.abs() + self.bend.abs() + 1.0 / h0)
    }
}

/// A law with one coordinate dropped.
struct Problem {
    dropped: usize,
    kept: [usize; 3],
    lambda: [f64; 3],
    linear: [f64; 3],
    /// min λ_j of those kept.
    floor: f64,
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
    /// Where ψ peaks.
    crest: f64,
    ln_peak: f64,
    ln_acceptance: f64,
}

impl Problem {
    fn new(lambda: [f64; 4], centre: [f64; 4], ln_integral: f64, dropped: usize) -> Self {
        let kept = [1, 2, 3].map(|step| (dropped + step) % 4);
        let square: f64 = lambda.iter().zip(centre).map(|(l, c)| l * c * c).sum();
        Self {
            dropped,
            kept,
            lambda: kept.map(|j| lambda[j]),
            floor: kept.iter().map(|&j| lambda[j]).fold(f64::INFINITY, f64::min),
            linear: kept.map(|j| lambda[j] * centre[j]),
            dropped_lambda: lambda[dropped],
            slope: lambda[dropped] * centre[dropped],
            constant: -0.5 * square - ln_integral,
        }
    }

    /// The kept precisions, for the smallest of them, and what the chart makes of the law with them:
    /// the weight, and ln of the constant in front of Gaussian × ψ relative to C.
    fn split(&self, smallest: f64) -> ([f64; 3], Weight, f64) {
        let mu = self.floor - smallest;
        let precision = self.lambda.map(|l| (l - self.floor) + smallest);
        let weight = Weight { slope: self.slope, bend: self.dropped_lambda - mu };
        let gain: f64 = self.linear.iter().zip(precision).map(|(b, p)| 0.5 * b * b / p).sum();
        (precision, weight, self.constant + gain - 0.5 * mu)
    }

    fn proposal(&self, smallest: f64, h0: f64) -> Proposal {
        let (precision, weight, front) = self.split(smallest);
        let (crest, ln_peak) = weight.peak(h0);
        let volume = 1.5 * LN_TAU - 0.5 * libm::log(precision[0] * precision[1] * precision[2]);
        let ln_acceptance = -(front + ln_peak + volume);
        Proposal { precision, weight, h0, crest, ln_peak, ln_acceptance }
    }

    /// The largest h₀ whose belt may be left out.
    fn belt_edge(&self, smallest: f64) -> Option<f64> {
        let (precision, weight, front) = self.split(smallest);
        let centre: [f64; 3] = std::array::from_fn(|j| self.linear[j] / precision[j]);
        let negligible = |h0: f64| {
            let sup = LN_2 + self.slope.abs() * h0 + (-0.5 * weight.bend * h0 * h0).max(0.0);
            let distance = distance_to_sphere(&precision, &centre, 1.0 - h0 * h0);
            libm::log(4.0 * PI * h0) + sup + front - 0.5 * distance < LN_BELT
        };
        let (mut low, mut high) = (1e-3, 0.999);
        if !negligible(low) {
            return None;
        }
        for _ in 0..8 {
            let middle = 0.5 * (low + high);
            if negligible(middle) { low = middle } else { high = middle }
        }
        Some(low)
    }

    /// Maximises the acceptance over μ. For a given h₀ its logarithm is concave in μ, and stationary
    /// where |u|² + h² = 1 on average, with the mean of |u|² over proposals and h at the peak of ψ.
    fn best_proposal(&self, shift: f64) -> Option<Proposal> {
        let mut smallest = (self.floor + shift).max(1e-3 * self.floor).max(0.05);
        let mut best: Option<Proposal> = None;
        // The belt moves a little with μ: a second look with the edge of the best so far.
        for _ in 0..2 {
            let h0 = self.belt_edge(smallest)?;
            let proposal = self.optimum(smallest, h0);
            smallest = proposal.precision.into_iter().fold(f64::INFINITY, f64::min);
            // Only an edge that holds for the precisions it is used with counts.
            let h0 = self.belt_edge(smallest)?.min(h0);
            let proposal = self.proposal(smallest, h0);
            if best.as_ref().is_none_or(|b| b.ln_acceptance < proposal.ln_acceptance) {
                best = Some(proposal);
            }
            if best.as_ref().is_some_and(|b| b.ln_acceptance > -0.05) {
                break;
            }
        }
        best
    }

    /// A concave function of the smallest precision, which may have a kink where the peak of ψ jumps:
    /// bracketed, then searched where the tangents of the two ends meet.
    fn optimum(&self, start: f64, h0: f64) -> Proposal {
        /// What is left to gain in ln acceptance.
        const ENOUGH: f64 = 1e-4;
        // Twice the slope: positive where proposals lie too far out.
        let at = |p: f64| {
            let proposal = self.proposal(p, h0);
            let square = |j: usize| {
                let location = self.linear[j] / proposal.precision[j];
                location * location + 1.0 / proposal.precision[j]
            };
            let excess = square(0) + square(1) + square(2) + proposal.crest * proposal.crest - 1.0;
            (p, excess, proposal)
        };
        let first = at(start);
        let (mut low, mut high);
        let mut step = 1.0;
        if first.1 > 0.0 {
            low = first;
            loop {
                high = at(low.0 + step);
                if high.1 <= 0.0 || step > 1e16 {
                    break;
                }
                (low, step) = (high, 4.0 * step);
            }
        } else {
            high = first;
            loop {
                low = at((high.0 - step).max(0.5 * high.0));
                if low.1 > 0.0 || low.0 < 1e-3 {
                    break;
                }
                (high, step) = (low, 4.0 * step);
            }
        }
        for _ in 0..30 {
            let width = high.0 - low.0;
            let (a, b) = (low.2.ln_acceptance, high.2.ln_acceptance);
            let meet = (b - a - 0.5 * high.1 * width) / (0.5 * (low.1 - high.1));
            let roof = a + 0.5 * low.1 * meet;
            if !(roof - a.max(b) > ENOUGH && meet > 0.0 && meet < width) {
                break;
            }
            let middle = at(low.0 + meet);
            if middle.1 > 0.0 { low = middle } else { high = middle }
        }
        if low.2.ln_acceptance > high.2.ln_acceptance { low.2 } else { high.2 }
    }

    fn chart(&self, axes: &Matrix4<f64>, proposal: &Proposal) -> Chart {
        // A hair above the peak, so that rounding in ψ cannot exceed it.
        let ln_peak = proposal.ln_peak + 1e-13;
        let floor = proposal.h0 * proposal.h0;
        let width = (1.0 - floor) / BINS as f64;
        let weight = &proposal.weight;
        let value = |sign: f64, h: f64| libm::exp(weight.ln_sheet(sign, h) - ln_peak);
        let edges: [[f64; 3]; BINS + 1] = std::array::from_fn(|i| {
            let h = (floor + width * i as f64).sqrt();
            [h, value(1.0, h), value(-1.0, h)]
        });
        let slack = weight.rounding(proposal.h0);
        let turns = [1.0, -1.0].map(|sign| weight.stationary(sign).map(|h| (h, value(sign, h))));
        let bins: [Bin; BINS] = std::array::from_fn(|i| {
            let (low, high) = (edges[i], edges[i + 1]);
            let range = |sheet: usize| {
                let ends = (low[sheet].min(high[sheet]), low[sheet].max(high[sheet]));
                let inside = turns[sheet - 1].iter().filter(|(h, _)| *h >= low[0] && *h <= high[0]);
                inside.fold(ends, |r, (_, v)| (r.0.min(*v), r.1.max(*v)))
            };
            let (plus, minus) = (range(1), range(2));
            let plus_low = plus.0 * (1.0 - slack);
            Bin {
                plus_low,
                plus_high: plus.1 * (1.0 + slack),
                total_low: plus_low + minus.0 * (1.0 - slack),
            }
        });
        const WORTH: f64 = 0.8;
        let first = bins.iter().rposition(|b| b.plus_low < WORTH).map_or(0, |i| i + 1);
        let least = bins[first..].iter().map(|b| b.plus_low).fold(1.0, f64::min);
        Chart {
            // A bin further, to be clear of rounding at the edge.
            sure_above: if first + 1 < BINS { width * (first as f64 + 1.0) } else { f64::INFINITY },
            sure: (least * 4096.0) as u32,
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
            prop_assert!(weight.ln_total(h) <= weight.peak(h0).1 + 1e-9);
            for sign in [1.0, -1.0] {
                let ends = [h0, 1.0].into_iter().chain(weight.stationary(sign));
                let values: Vec<f64> = ends
                    .filter(|h| *h >= h0 && *h <= 1.0)
                    .map(|h| weight.ln_sheet(sign, h))
                    .collect();
                let value = weight.ln_sheet(sign, h);
                prop_assert!(values.iter().any(|v| *v <= value + 1e-9));
                prop_assert!(values.iter().any(|v| *v >= value - 1e-9));
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
