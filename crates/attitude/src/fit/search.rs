//! The maxima of the likelihood within the families, and the interval of the radial variance.

use nalgebra::{Matrix3, Matrix4, Vector3};

use super::{
    FitError, RadialVariance,
    climb::{Climb, climb, climb_above},
    likelihood::{Form, PAIRS, PARAMETERS, Sample, Vector, root_lines},
    lobes,
    point::{Natural, Point, SLOPE, TAU},
};
use crate::jacobi;

/// The 95 % quantile of χ² with one degree of freedom.
const QUANTILE: f64 = 3.841_458_820_694_124;
/// Range of τ = 1/s.
const TAU_RANGE: std::ops::RangeInclusive<f64> = 1e-14..=1e14;

/// The attitudes lie on a small sphere if they are no farther from it than this share of how far
/// they spread. Rounding stops a search that has no end at 1e-7 or so.
const THINNEST: f64 = 1e-5;
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
        let mut diagonal = [false; PARAMETERS];
        let mut start = Vector::zeros();
        for (k, &(i, j)) in PAIRS.iter().enumerate() {
            if i == j {
                diagonal[4 + k] = true;
                start[4 + k] = 1.0 - (self.sample.scale[i] / self.sample.scale[3]).powi(2);
            }
        }
        let top = climb(&Natural(self.sample), start, diagonal, self.n);
        let form = self.sample.form(&top.place);
        // Uniform to rounding is as flat as a law can be.
        let diagonal = form.p.diagonal().fixed_rows::<3>(0).map(|p| p.max(*TAU_RANGE.start()));
        let precision = Matrix3::from_diagonal(&diagonal);
        let place =
            Point { frame: Matrix4::identity(), precision, slope: Vector3::zeros(), tau: 0.0 };
        moved(&top, place)
    }

    /// The most likely law with this τ whose mean is a principal axis.
    pub(super) fn aligned_at(&self, start: &Point, tau: f64) -> Climb<Point> {
        climb(self.sample, Point { tau, ..*start }, ALIGNED, self.n)
    }

    /// The τ at which the radial variance begins to be felt.
    fn first_tau(&self) -> f64 {
        let square = self.sample.scale[2].powi(2);
        if square > 0.01 { 0.03 } else { 0.01 / square }
    }

    /// The most likely law whose mean is a principal axis; Bingham's where no other is better.
    /// Flat-topped samples drive Λ to the edge of the family, beyond which the mean is no mode:
    /// what has not converged for that reason does not count.
    pub(super) fn aligned(&self, bingham: &Climb<Point>) -> Climb<Point> {
        let mut best = bingham.clone();
        let mut place = bingham.place;
        let mut tau = self.first_tau();
        while tau <= *TAU_RANGE.end() {
            let here = self.aligned_at(&place, tau);
            place = here.place;
            let drop = 2.0 * self.n * (best.height - here.height);
            if here.converged && here.height > best.height {
                best = here;
            } else if !(drop < 2.0 * QUANTILE) {
                break;
            }
            tau *= 4.0;
        }
        if best.place.tau == 0.0 {
            return best;
        }
        let top = if self.sample.scale[2] > 0.1 {
            let mut free = ALIGNED;
            free[TAU] = true;
            climb(self.sample, best.place, free, self.n)
        } else {
            self.refined(best)
        };
        let better = self.n * (top.height - bingham.height) > 1e-6;
        if top.converged && better && top.place.tau > *TAU_RANGE.start() {
            top
        } else {
            bingham.clone()
        }
    }

    /// The best τ within a factor of four, by golden section: derivatives by τ are differences of
    /// nearly equal moments, and rounding where the sample is narrow.
    fn refined(&self, mut best: Climb<Point>) -> Climb<Point> {
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let middle = libm::log(best.place.tau);
        let mut low = middle - 1.4;
        let mut high = (middle + 1.4).min(libm::log(*TAU_RANGE.end()));
        for _ in 0..16 {
            let width = GOLDEN * (high - low);
            let [left, right] = [high - width, low + width]
                .map(|ln_tau| self.aligned_at(&best.place, libm::exp(ln_tau)));
            let better = if left.height > right.height {
                high = low + width;
                left
            } else {
                low = high - width;
                right
            };
            if better.converged && better.height > best.height {
                best = better;
            }
        }
        best
    }

    /// Where to look for the most likely law of all, laws of two lobes apart.
    pub(super) fn starts(&self, bingham: &Climb<Point>, aligned: &Climb<Point>) -> Vec<Form> {
        let narrow = Point { tau: 1.0 / self.sample.scale[2].powi(2), ..bingham.place };
        let mut starts = vec![aligned.place.form()];
        starts.extend(self.sample.halves().iter().map(|mean| self.sample.gaussian(mean)));
        starts.extend(self.overlapping());
        starts.push(narrow.form());
        starts
    }

    /// The likeliest laws of two lobes, in the light and heavy parts of the sample.
    fn lobes(&self) -> Vec<Form> {
        self.likeliest(lobes::starts(self.sample).iter().map(Point::form), LOBES)
    }

    /// The likeliest Gaussians whose mean is on one of 24 lines that cover all directions: lobes that
    /// overlap are not parted by any division of the sample.
    fn overlapping(&self) -> Vec<Form> {
        let means = root_lines().into_iter().map(|line| line.normalize() * OVERLAPPING_MEAN);
        self.likeliest(means.map(|mean| self.sample.gaussian(&mean)), OVERLAPPING)
    }

    fn likeliest(&self, forms: impl Iterator<Item = Form>, count: usize) -> Vec<Form> {
        let mut ranked: Vec<(f64, Form)> = forms
            .map(|form| (self.sample.height(&form), form))
            .filter(|(height, _)| height.is_finite())
            .collect();
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        ranked.into_iter().take(count).map(|(_, form)| form).collect()
    }

    /// The most likely law of all.
    pub(super) fn general(
        &self,
        bingham: &Climb<Point>,
        aligned: &Climb<Point>,
    ) -> Result<Climb<Point>, FitError> {
        let mut best: Option<Climb<Vector>> = None;
        let mut try_from = |form: &Form, accepted: &dyn Fn(&Climb<Vector>) -> bool| {
            let known = best.as_ref().map_or(f64::NEG_INFINITY, |best| best.height);
            let start = self.sample.parameters(form);
            let top = climb_above(&Natural(self.sample), start, ALL, self.n, known);
            if top.height.is_finite() && top.height > known && accepted(&top) {
                best = Some(top);
            }
        };
        for form in self.lobes() {
            // Lobes that were none may run away; whether the sample is to blame the others tell.
            try_from(&form, &|top| {
                self.sample.thickness(&self.sample.form(&top.place)).1 > THINNEST
            });
        }
        for form in self.starts(bingham, aligned) {
            try_from(&form, &|_| true);
        }
        // Uniform attitudes have no better law than the uniform one, which is of every family.
        let Some(top) = best.filter(|top| self.n * (top.height - aligned.height) > 1e-9) else {
            return Ok(aligned.clone());
        };
        let form = self.sample.form(&top.place);
        let (spread, share) = self.sample.thickness(&form);
        if !(share > THINNEST) {
            return Err(FitError::Degenerate { spread });
        }
        let place = Point::of(&form);
        let steepest = jacobi::eigen(&place.form_about_mean()).0.into_iter().fold(0.0, f64::max);
        if !(steepest <= *TAU_RANGE.end()) {
            return Err(FitError::Steep { variance: 1.0 / steepest });
        }
        Ok(moved(&top, place))
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
            place = top.place;
            (2.0 * self.n * (best.height - top.height)).max(0.0).sqrt() - target
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

/// The same climb in the coordinates of a point.
fn moved(climb: &Climb<Vector>, place: Point) -> Climb<Point> {
    let Climb { height, converged, iterations, gain, .. } = *climb;
    Climb { place, height, converged, iterations, gain }
}
