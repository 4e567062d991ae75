//! The maxima of the likelihood within the families, and the interval of the radial variance.

use nalgebra::{Matrix3, Matrix4, Vector3, Vector4};
use std::cmp::Reverse;

use super::{
    FitError, RadialVariance,
    centered::{Centered, PAIRS, PRODUCTS, STATISTICS},
    climb::{Climb, SAME, climb, climb_above},
    likelihood::{Sample, root_lines},
    lobes,
    point::{PARAMETERS, Point, SLOPE, Sheared, TAU},
    rounding::whole,
};

/// The 95 % quantile of χ² with one degree of freedom.
const QUANTILE: f64 = 3.841_458_820_694_124;
/// Range of τ = 1/s.
const TAU_RANGE: std::ops::RangeInclusive<f64> = 1e-14..=1e14;

/// Attitudes that are nearer to a small sphere lie on it, if they are as much nearer to it than to any
/// great one: the least deviation that a law may have.
const THINNEST: f64 = 1e-7;
const NEARER: f64 = 0.1;
/// The mean square of the coordinate along a mean, which is a quarter for the uniform law and greater
/// for any with such a mean, is not below this in a sample.
const LEAST_ALONG: f64 = 0.15;
/// Mean square of the widest coordinate of a narrow cluster.
const NARROW: f64 = 0.01;
/// How many laws of two lobes, and of lobes that overlap, are climbed from.
const LOBES: usize = 3;
const OVERLAPPING: usize = 2;
/// Length of the mean of the latter in coordinates of unit variance: |u| of a half has 0.8.
const OVERLAPPING_MEAN: f64 = 0.7;

pub(super) const ALL: [bool; PARAMETERS] = [true; PARAMETERS];

/// Coordinates of [`Point`] that each family has for a given radial variance.
pub(super) const ALIGNED: [bool; PARAMETERS] = free(false);
pub(super) const GENERAL: [bool; PARAMETERS] = free(true);

const fn free(slope: bool) -> [bool; PARAMETERS] {
    let mut all = [true; PARAMETERS];
    let mut k = SLOPE;
    while k < TAU {
        all[k] = slope;
        k += 1;
    }
    all[TAU] = false;
    all
}

pub(super) struct Search<'a> {
    sample: &'a Sample,
    n: f64,
}

impl<'a> Search<'a> {
    pub(super) fn new(sample: &'a Sample) -> Self {
        Self { sample, n: sample.len() }
    }

    /// Bingham's law, whose axes are those of the sample's second moment.
    pub(super) fn bingham(&self) -> Climb<Point> {
        let mut squares = [false; STATISTICS];
        for (k, &(i, j)) in PAIRS.iter().enumerate() {
            squares[PRODUCTS + k] = i == j;
        }
        let start = self.sample.scale.map(|s| s.powi(-2));
        let start = Centered::new(Matrix4::identity(), start, [0.0; 4]);
        let top = climb(&Sheared(self.sample), start, squares, self.n);
        let lambda = top.place.lambda;
        // Uniform to rounding is as flat as a law can be.
        let precisions = Vector3::from_fn(|i, _| (lambda[i] - lambda[3]).max(*TAU_RANGE.start()));
        let place = Point {
            frame: Matrix4::identity(),
            precision: Matrix3::from_diagonal(&precisions),
            slope: Vector3::zeros(),
            tau: 0.0,
        };
        moved(&top, place)
    }

    /// The most likely law with this τ whose mean is a principal axis.
    pub(super) fn aligned_at(&self, bingham: &Climb<Point>, tau: f64) -> Climb<Point> {
        let start = |place: &Point| Point { tau, ..*place };
        let mut best = climb(self.sample, start(&bingham.place), ALIGNED, self.n);
        for place in self.along_axes() {
            let top = climb_above(self.sample, start(&place), ALIGNED, self.n, best.height);
            if self.n * (top.height - best.height) > SAME {
                best = top;
            }
        }
        best
    }

    /// The τ at which the radial variance begins to be felt.
    fn first_tau(&self) -> f64 {
        let square = self.sample.scale[2].powi(2);
        if square > 0.01 { 0.03 } else { 0.01 / square }
    }

    /// The most likely law whose mean is a principal axis; Bingham's where no other is better.
    pub(super) fn aligned(&self, bingham: &Climb<Point>) -> Climb<Point> {
        let mut best = bingham.clone();
        let mut free = ALIGNED;
        free[TAU] = true;
        for place in self.along_axes().into_iter().flat_map(|place| self.tighter(place)) {
            let mut top = climb_above(self.sample, place, free, self.n, best.height);
            let greatest = *TAU_RANGE.end();
            if !(top.place.tau <= greatest) {
                top = climb(self.sample, Point { tau: greatest, ..top.place }, ALIGNED, self.n);
            }
            if self.n * (top.height - best.height) > SAME {
                best = top;
            }
        }
        if self.sample.scale[2].powi(2) < NARROW {
            let edge = self.aligned_at(bingham, *TAU_RANGE.end());
            if self.n * (edge.height - best.height) > SAME {
                best = edge;
            }
        }
        best
    }

    /// A law, and the same with the radial variances of narrow clusters without tails: there the likelihood can have a maximum
    /// of its own, as a law with ever less radial variance has a flatter top.
    fn tighter(&self, place: Point) -> Vec<Point> {
        let square = self.sample.scale[2].powi(2);
        let own = [0.1, 1.0, 10.0].map(|part| part / (square * square));
        let greatest = *TAU_RANGE.end();
        let all = own.into_iter().filter(|_| square < NARROW).map(|tau| tau.min(greatest));
        std::iter::once(place.tau).chain(all).map(|tau| Point { tau, ..place }).collect()
    }

    /// The most likely laws whose axes are those of the sample's second moment, the mean one of those
    /// that the attitudes have a sizeable part along.
    fn along_axes(&self) -> Vec<Point> {
        let mut places = Vec::new();
        for j in (0..4).rev().filter(|&j| self.sample.scale[j].powi(2) > LEAST_ALONG) {
            let mut free = [false; STATISTICS];
            free[j] = true;
            for (k, &(a, b)) in PAIRS.iter().enumerate() {
                free[PRODUCTS + k] = a == b;
            }
            let axis = Vector4::ith(j, 1.0);
            let start = self.sample.gaussian(&(axis * self.sample.mean_size(j)));
            let top = climb(&Sheared(self.sample), start, free, self.n);
            let place = Point::about_axis(&top.place, j, &self.sample.scale);
            places.extend((place.tau > *TAU_RANGE.start()).then_some(place));
        }
        places
    }

    /// Where to look for the most likely law of all, laws of two lobes apart.
    pub(super) fn starts(&self, bingham: &Climb<Point>, aligned: &Climb<Point>) -> Vec<Centered> {
        let narrow = Point { tau: 1.0 / self.sample.scale[2].powi(2), ..bingham.place };
        let mut starts = vec![aligned.place.law()];
        starts.extend(self.sample.halves().iter().map(|mean| self.sample.gaussian(mean)));
        starts.extend(self.overlapping());
        starts.push(narrow.law());
        starts
    }

    /// The likeliest laws of two lobes, in the light and heavy parts of the sample.
    fn lobes(&self) -> Vec<Centered> {
        self.likeliest(lobes::starts(self.sample).iter().map(Point::law), LOBES)
    }

    /// The likeliest Gaussians whose mean is on one of 24 lines that cover all directions: lobes that
    /// overlap are not parted by any division of the sample.
    fn overlapping(&self) -> Vec<Centered> {
        let means = root_lines().into_iter().map(|line| line.normalize() * OVERLAPPING_MEAN);
        self.likeliest(means.map(|mean| self.sample.gaussian(&mean)), OVERLAPPING)
    }

    fn likeliest(&self, laws: impl Iterator<Item = Centered>, count: usize) -> Vec<Centered> {
        let mut ranked: Vec<(f64, Centered)> = laws
            .map(|law| (self.sample.height(&law), law))
            .filter(|(height, _)| height.is_finite())
            .collect();
        ranked.sort_by_key(|(height, _)| Reverse(whole(*height)));
        ranked.into_iter().take(count).map(|(_, law)| law).collect()
    }

    /// The most likely law of all.
    pub(super) fn general(
        &self,
        bingham: &Climb<Point>,
        aligned: &Climb<Point>,
    ) -> Result<Climb<Centered>, FitError> {
        let mut best: Option<Climb<Centered>> = None;
        let mut try_from = |start: Centered, accepted: &dyn Fn(&Centered) -> bool| {
            if !start.is_wide_enough() {
                return;
            }
            // What has not converged is not known.
            let known = best.as_ref().filter(|best| best.converged);
            let known = known.map_or(f64::NEG_INFINITY, |best| best.height);
            let all = [true; STATISTICS];
            let top = climb_above(&Sheared(self.sample), start, all, self.n, known);
            let better = best.as_ref().is_none_or(|best| {
                let more = self.n * (top.height - best.height);
                more > SAME || more > -SAME && top.converged && !best.converged
            });
            if top.height.is_finite() && better && accepted(&top.place) {
                best = Some(top);
            }
        };
        for law in self.lobes() {
            // Lobes that were none may run away; whether the sample is to blame the others tell.
            try_from(law, &|law| self.on_a_small_sphere(law).is_none());
        }
        for law in self.starts(bingham, aligned) {
            try_from(law, &|_| true);
        }
        if let Some(slow) = best.as_ref().filter(|best| !best.converged) {
            let all = [true; STATISTICS];
            best = Some(climb(&Sheared(self.sample), slow.place, all, self.n));
        }
        // Uniform attitudes have no better law than the uniform one, which is of every family.
        let Some(top) = best.filter(|top| self.n * (top.height - aligned.height) > 1e-9) else {
            return Ok(moved(aligned, aligned.place.law()));
        };
        if let Some(spread) = self.on_a_small_sphere(&top.place) {
            return Err(FitError::Degenerate { spread });
        }
        Ok(top)
    }

    /// The distance from the small sphere that the attitudes lie on, signs as the law has them.
    fn on_a_small_sphere(&self, law: &Centered) -> Option<f64> {
        let spread = self.sample.thickness(law);
        (!(spread > THINNEST) && spread < NEARER * self.sample.scale[0]).then_some(spread)
    }

    /// The least radial variance that the attitudes allow next to any larger one.
    pub(super) fn lowest(&self, best: &Climb<Point>, free: [bool; PARAMETERS]) -> f64 {
        let from = best.place.tau.max(self.first_tau());
        1.0 / self.edge(best, free, from, 1.0)
    }

    /// The values of s for which twice the ln-likelihood, maximised over all else, is within the
    /// quantile of its maximum.
    pub(super) fn interval(&self, best: &Climb<Point>, free: [bool; PARAMETERS]) -> RadialVariance {
        let tau = best.place.tau;
        if !(tau > 0.0) {
            return RadialVariance::Undetermined { low: self.lowest(best, free) };
        }
        let low = 1.0 / self.edge(best, free, tau, 1.0);
        let at_infinity = climb(self.sample, Point { tau: 0.0, ..best.place }, free, self.n);
        if 2.0 * self.n * (best.height - at_infinity.height) < QUANTILE {
            return RadialVariance::Undetermined { low };
        }
        let high = 1.0 / self.edge(best, free, tau, -1.0);
        RadialVariance::Determined { value: 1.0 / tau, low, high }
    }

    /// The τ above or below `from` at which the deviance reaches the quantile.
    fn edge(
        &self,
        best: &Climb<Point>,
        free: [bool; PARAMETERS],
        from: f64,
        direction: f64,
    ) -> f64 {
        let target = QUANTILE.sqrt();
        let (ln_low, ln_high) = (libm::log(*TAU_RANGE.start()), libm::log(*TAU_RANGE.end()));
        let mut place = best.place;
        // The root of the deviance is nearly linear in τ, and so easily solved for.
        let mut excess = |ln_tau: f64| {
            let start = Point { tau: libm::exp(ln_tau), ..place };
            let top = climb(self.sample, start, free, self.n);
            let excess = (2.0 * self.n * (best.height - top.height)).max(0.0).sqrt() - target;
            // Far outside, wide laws climb to another maximum, from which none comes back.
            if excess < 0.0 {
                place = top.place;
            }
            excess
        };
        let mut inside = (libm::log(from), -target);
        let mut step = 0.5;
        let mut outside = loop {
            let ln_tau = (inside.0 + direction * step).clamp(ln_low, ln_high);
            let value = excess(ln_tau);
            if !(value < 0.0) {
                break (ln_tau, if value.is_finite() { value } else { 1.0 });
            }
            if ln_tau == ln_low || ln_tau == ln_high {
                return libm::exp(ln_tau);
            }
            inside = (ln_tau, value);
            step *= 1.6;
        };
        for _ in 0..40 {
            let share = (inside.1 / (inside.1 - outside.1)).clamp(0.05, 0.95);
            let ln_tau = inside.0 + share * (outside.0 - inside.0);
            let value = excess(ln_tau);
            if value.abs() < 1e-3 || (outside.0 - inside.0).abs() < 1e-6 {
                return libm::exp(ln_tau);
            }
            if value < 0.0 { inside = (ln_tau, value) } else { outside = (ln_tau, value) }
        }
        libm::exp(inside.0)
    }
}

/// The same climb, its end in other coordinates.
pub(super) fn moved<P, Q>(climb: &Climb<P>, place: Q) -> Climb<Q> {
    let Climb { height, converged, iterations, gain, .. } = *climb;
    Climb { place, height, converged, iterations, gain }
}
