//! The scatter that gives the entries the deviations that are asked for, as nearly as any does that is found.

use nalgebra::{DVector, Matrix3, Vector3};

use super::{
    entries::Forms,
    levenberg_marquardt::{Problem, Range, least_squares},
    scatter::{Body, Scatter, roots_of},
};

/// Of relative errors of deviations, stated moments count this much more beside products: what is
/// stated of the products may not make the moments more certain than they are stated.
const MOMENTS_FIRST: f64 = 100.0;
/// An entry that is surer than stated is this much worse than one that is less sure.
const SURER: f64 = 3.0;
/// What a mass centre adds counts this much less beside what is stated.
const ADDED_LAST: f64 = 1.0 / 30.0;
/// Deviations below this share of the largest beside them count as this share.
const SMALL: f64 = 3e-4;
/// The same of what a mass centre adds, where the smaller ones are without interest.
const SMALL_BESIDE: f64 = 0.3;
/// A deviation of zero counts as this share of the trace.
const ZERO: f64 = 1e-9;
/// Relative errors of deviations up to which independent roots and rotations do.
const MET: f64 = 4e-3;
/// What an unknown costs that nothing is asked of, in units of a first guess.
const PULL: f64 = 1e-4;
/// What a correlation costs.
const CORRELATED: f64 = 1e-3;
/// What it costs that the inertia does not follow the mass.
const FOLLOWS: f64 = 0.03;
/// A share of the most that the inertia can follow, which may be the most.
const NEARLY: f64 = 0.95;
/// Times that the search starts anew about the best, while that is better.
const AGAIN: usize = 4;
/// Another start is worth its law if it takes this share off the cost.
const WORTH: f64 = 0.01;
/// Correlations from which the search starts anew.
const START: f64 = 0.7;
/// Their signs.
const SIGNS: [[f64; 3]; 4] =
    [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
/// v/(1 + 8v) of a rotation with the variance v that may be any.
const MOST_TURN: f64 = 0.125;

/// What is asked of three entries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Asked {
    /// Nothing: they move as the rest moves them.
    Nothing,
    /// They have these deviations, kg·m², everything included.
    Stated([f64; 3]),
    /// Beside everything else, these variances come on top, (kg·m²)².
    Added([f64; 3]),
}

/// What is asked of a body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task {
    pub(super) body: Body,
    pub(super) trace: f64,
    pub(super) moments: Asked,
    pub(super) products: Asked,
    /// Variances of the rotations about the principal axes, rad²: as they are, or, beside products, at most.
    pub(super) axes: Option<[f64; 3]>,
    /// The relative deviation of the mass, and the largest share of it that the inertia may take.
    pub(super) mass: Option<(f64, f64)>,
    /// Rotations that do nothing are any, not none.
    pub(super) loose: bool,
}

/// The best scatter that was found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solution {
    pub(super) scatter: Scatter,
    /// The share of the mass's relative change that the inertia takes.
    pub(super) follows: f64,
    /// The deviations that a mass centre would give entries beside everything else, kg·m².
    pub(super) with_centre: [Option<f64>; 6],
}

/// Where the unknowns of the roots stand in M: on the diagonal and beside it.
const ENTRIES_OF_M: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 0), (2, 0), (2, 1)];

/// What is asked of an entry, and what it has: variances, (kg·m²)².
#[derive(Clone, Copy, Debug)]
struct Compared {
    entry: usize,
    wanted: f64,
    found: f64,
    /// The variance below which none matters.
    least: f64,
    /// How much an error counts.
    counts: f64,
}

impl Compared {
    /// The relative error of the deviation, where it is small. In logarithms, so that errors of entries that cannot be
    /// had do not outweigh all others.
    fn error(&self) -> f64 {
        let error = 0.5 * libm::log((self.found + self.least) / (self.wanted + self.least));
        if error < 0.0 { SURER * error } else { error }
    }
}

/// The unknowns, in this order. The roots have the covariance B M Mᵀ Bᵀ with M lower triangular: its entries
/// on the diagonal and those beside it. The rotations have deviations, and the angles of their correlations. At last
/// the share of the mass that the inertia follows.
const ROOTS: usize = 0;
const ROOTS_BESIDE: usize = 3;
const TURNS: usize = 6;
const TURN_ANGLES: usize = 9;
const SHARE: usize = 12;
const UNKNOWNS: usize = 13;

/// Values of all unknowns, and what the axes do with them.
#[derive(Clone)]
struct Point {
    x: [f64; UNKNOWNS],
    scatter: Scatter,
    forms: Forms,
}

/// The unknowns that are open.
#[derive(Clone)]
struct Search<'a> {
    task: &'a Task,
    /// B.
    basis: Matrix3<f64>,
    open: Vec<usize>,
    guess: [f64; UNKNOWNS],
}

impl Task {
    /// Searches with independent roots and rotations, and with correlated ones where these do not do.
    pub(super) fn solve(&self) -> Solution {
        let roots = self.first_roots();
        let mut search = Search {
            task: self,
            basis: Matrix3::from_diagonal(&roots),
            open: Vec::new(),
            guess: self.guess(),
        };
        let moments = self.moments != Asked::Nothing;
        let products = self.products != Asked::Nothing;
        if moments {
            search.open.extend(ROOTS..ROOTS_BESIDE);
        }
        if products {
            search.open.extend(TURNS..TURN_ANGLES);
        }
        if self.mass.is_some_and(|(_, most)| most > 0.0) && self.moments.is_stated() {
            search.open.push(SHARE);
        }
        let mut best = search.from(search.guess);
        if self.worst(&best.0) > MET {
            let independent = best.0.clone();
            if moments {
                search.basis = self.basis(&roots);
                search.open.extend(ROOTS_BESIDE..TURNS);
            }
            if products {
                search.open.extend(TURN_ANGLES..SHARE);
            }
            best.0.x = search.expressed(&best.0, 1e-12);
            search.improve(&mut best, search.starts(&independent));
            for _ in 0..AGAIN {
                let (before, around) = (best.1, search.correlated(&best.0.x));
                search.improve(&mut best, around);
                if best.1 == before {
                    break;
                }
            }
        }
        // Where the moments cannot be had, the products may be, beside the moments as they are: the errors of the
        // moments, which count for so much more, hide those of the products.
        if self.moments.is_stated() && self.products.is_stated() && self.worst(&best.0) > MET {
            let mut moments = [0.0; 3];
            for it in self.compare(&best.0).iter().filter(|it| it.entry < 3) {
                moments[it.entry] = it.found.sqrt();
            }
            let held = Self { moments: Asked::Stated(moments), ..*self };
            let beside = Search { task: &held, ..search.clone() };
            let mut found = beside.from(best.0.x);
            let around = beside.correlated(&found.0.x);
            beside.improve(&mut found, around);
            best = found;
        }
        // Nearly wholly is wholly, where nothing is lost by it.
        let mut wholly = best.0.clone();
        wholly.x[SHARE] = search.guess[SHARE];
        let near = best.0.x[SHARE] > NEARLY * search.guess[SHARE];
        if near && self.worst(&wholly) < self.worst(&best.0).max(MET) {
            best.0 = wholly;
        }
        let mut with_centre = [None; 6];
        for it in self.compare(&best.0) {
            let asked = if it.entry < 3 { self.moments } else { self.products };
            if !asked.is_stated() {
                with_centre[it.entry] = Some(it.wanted.sqrt());
            }
        }
        Solution { scatter: best.0.scatter, follows: best.0.x[SHARE], with_centre }
    }

    /// Deviations of the roots to begin with: those of equal variances of the second moments, each moment being the
    /// sum of two.
    fn first_roots(&self) -> Vector3<f64> {
        let each = Matrix3::from_diagonal_element(self.first_variance());
        roots_of(self.body.roots, &each).diagonal().map(f64::sqrt)
    }

    fn first_variance(&self) -> f64 {
        match self.moments {
            Asked::Nothing => 0.0,
            Asked::Stated(_) | Asked::Added(_) => {
                0.5 * self.moments.mean_variance().max(self.zero())
            }
        }
    }

    fn zero(&self) -> f64 {
        (ZERO * self.trace).powi(2)
    }

    /// Deviations of the roots by what they do to the moments, to first order: with this basis, rows of M are
    /// moments, in units of what is asked of them.
    fn basis(&self, roots: &Vector3<f64>) -> Matrix3<f64> {
        let r = *self.body.attitude.to_rotation_matrix().matrix();
        let k = self.body.roots.values();
        // A root near zero moves by its square.
        let slope = |i: usize| 2.0 * (k[i] * k[i] + roots[i] * roots[i]).sqrt();
        let moved = Matrix3::from_fn(|a, i| (1.0 - r[(i, a)] * r[(i, a)]) * slope(i));
        let least = self.moments.least().max(self.zero());
        let asked = Vector3::from(self.moments.variances()).map(|v| (v + least).sqrt());
        // About axes that are tilted so that all moments move alike, it need only be invertible.
        let svd = moved.svd(true, true);
        let largest = svd.singular_values.max();
        let inverse = svd.singular_values.map(|s| 1.0 / s.max(0.01 * largest));
        match (svd.u, svd.v_t) {
            (Some(u), Some(v)) => {
                v.transpose()
                    * Matrix3::from_diagonal(&inverse)
                    * u.transpose()
                    * Matrix3::from_diagonal(&asked)
            }
            _ => Matrix3::from_diagonal(roots),
        }
    }

    /// Where the search starts.
    fn guess(&self) -> [f64; UNKNOWNS] {
        let mut x = [0.0; UNKNOWNS];
        if self.moments != Asked::Nothing {
            x[ROOTS..ROOTS_BESIDE].fill(1.0);
        }
        let k = self.body.roots.values();
        let product = self.products.mean_variance().max(self.zero());
        let most = self.most_turns();
        for j in 0..3 {
            let (m, n) = ((j + 1) % 3, (j + 2) % 3);
            let gap = (k[m] * k[m] - k[n] * k[n]).powi(2) + 2.0 * self.first_variance();
            x[TURNS + j] = match (self.products, self.axes) {
                (Asked::Nothing, None) => 0.0,
                (Asked::Nothing, Some(_)) => most[j],
                (Asked::Stated(_) | Asked::Added(_), _) => turn(product / gap).min(0.9 * most[j]),
            };
        }
        x[SHARE] = self.mass.map_or(0.0, |(_, most)| most);
        x
    }

    /// The most of each rotation.
    fn most_turns(&self) -> [f64; 3] {
        self.axes.unwrap_or([f64::INFINITY; 3]).map(turn)
    }

    /// What is asked of each entry at a point, and what it has there.
    fn compare(&self, point: &Point) -> Vec<Compared> {
        let k = self.body.second_moments(&point.scatter);
        let (means, found) = (point.forms.means(&k), point.forms.variances(&k));
        let still = Scatter { roots: Matrix3::zeros(), ..point.scatter };
        let by_axes = point.forms.variances(&self.body.second_moments(&still));
        let by_roots = Forms::still(&self.body.attitude).variances(&k);
        let by_mass = self.mass.map_or(0.0, |(relative, _)| (relative * point.x[SHARE]).powi(2));
        let both = self.moments.is_stated() && self.products.is_stated();
        let any = self.moments.is_stated() || self.products.is_stated();
        let mut compared = Vec::new();
        for (first_entry, asked, rest) in [(0, self.moments, by_axes), (3, self.products, by_roots)]
        {
            let least = asked.least().max(self.zero());
            let with_mass = |e: usize, v: f64| v * (1.0 + by_mass) + by_mass * means[e] * means[e];
            for e in first_entry..first_entry + 3 {
                let (wanted, counts) = match asked {
                    Asked::Nothing => continue,
                    Asked::Stated(deviations) => {
                        let first = if both && e < 3 { MOMENTS_FIRST } else { 1.0 };
                        (deviations[e - first_entry].powi(2), first)
                    }
                    Asked::Added(variances) => {
                        let last = if any { ADDED_LAST } else { 1.0 };
                        (with_mass(e, rest[e] + variances[e - first_entry]), last)
                    }
                };
                let found = with_mass(e, found[e]);
                compared.push(Compared { entry: e, wanted, found, least, counts });
            }
        }
        compared
    }

    /// The largest error.
    fn worst(&self, point: &Point) -> f64 {
        self.compare(point).iter().fold(0.0, |worst, it| it.error().abs().max(worst))
    }
}

impl Asked {
    fn is_stated(&self) -> bool {
        matches!(self, Self::Stated(_))
    }

    fn variances(&self) -> [f64; 3] {
        match *self {
            Self::Nothing => [0.0; 3],
            Self::Stated(deviations) => deviations.map(|d| d * d),
            Self::Added(variances) => variances,
        }
    }

    fn mean_variance(&self) -> f64 {
        self.variances().iter().sum::<f64>() / 3.0
    }

    /// The variance below which none matters.
    fn least(&self) -> f64 {
        let share = match self {
            Self::Nothing | Self::Stated(_) => SMALL,
            Self::Added(_) => SMALL_BESIDE,
        };
        self.variances().into_iter().fold(0.0, f64::max) * (share * share)
    }
}

impl Search<'_> {
    /// The best point downhill from here, and its cost.
    fn from(&self, x: [f64; UNKNOWNS]) -> (Point, f64) {
        let scatter = self.scatter(&x);
        let start = Point { x, scatter, forms: self.task.body.forms(&scatter) };
        if self.open.is_empty() {
            return (start, 0.0);
        }
        least_squares(self, start)
    }

    /// Takes the first start that does, or the best of them, if it is better.
    fn improve(&self, best: &mut (Point, f64), starts: Vec<[f64; UNKNOWNS]>) {
        for start in starts {
            if self.task.worst(&best.0) < MET {
                return;
            }
            let found = self.from(start);
            if found.1 < (1.0 - WORTH) * best.1 {
                *best = found;
            }
        }
    }

    fn scatter(&self, x: &[f64; UNKNOWNS]) -> Scatter {
        let variance = |d: f64| {
            let square = d * d;
            square / (1.0 - square / MOST_TURN).max(1e-6)
        };
        let rotations = [0, 1, 2].map(|j| variance(x[TURNS + j]).sqrt());
        let mut m = Matrix3::zeros();
        for (x, at) in x[ROOTS..TURNS].iter().zip(ENTRIES_OF_M) {
            m[at] = *x;
        }
        let root = self.basis * m;
        Scatter {
            roots: root * root.transpose(),
            rotations: covariance(rotations, &x[TURN_ANGLES..SHARE]),
        }
    }

    /// Where to start with correlations: where independent roots and rotations came to and where they began, and
    /// from correlations of either sign.
    fn starts(&self, independent: &Point) -> Vec<[f64; UNKNOWNS]> {
        // None of them still.
        let mut again = self.expressed(independent, 1e-4);
        let turns = TURNS..TURN_ANGLES;
        for (turn, guess) in again[turns.clone()].iter_mut().zip(&self.guess[turns]) {
            *turn = turn.max(0.1 * guess);
        }
        let mut starts = vec![again, self.guess];
        starts.extend(self.correlated(&self.guess));
        starts
    }

    /// The unknowns of a point that was found with another basis, its roots moving at least by a share of what they
    /// move together.
    fn expressed(&self, point: &Point, least: f64) -> [f64; UNKNOWNS] {
        let mut x = point.x;
        x[ROOTS..TURNS].fill(0.0);
        let inverse = self.basis.try_inverse().unwrap_or_default();
        let roots = inverse * point.scatter.roots * inverse.transpose();
        let least = Matrix3::from_diagonal_element(least * roots.trace());
        if let Some(root) = (roots + least).cholesky() {
            let m = root.l();
            for (i, (row, column)) in (ROOTS..).zip(ENTRIES_OF_M) {
                x[i] = m[(row, column)];
            }
        }
        x
    }

    /// Correlations of every pair of signs on top.
    fn correlated(&self, x: &[f64; UNKNOWNS]) -> Vec<[f64; UNKNOWNS]> {
        let correlations =
            [ROOTS_BESIDE, TURN_ANGLES].into_iter().filter(|i| self.open.contains(i));
        let starts = SIGNS.map(|signs| {
            let mut start = *x;
            for first in correlations.clone() {
                for (i, sign) in (first..).zip(signs) {
                    start[i] += sign * START;
                }
            }
            start
        });
        starts.into()
    }
}

impl Problem for Search<'_> {
    type Point = Point;

    fn values(&self, point: &Point) -> DVector<f64> {
        DVector::from_iterator(self.open.len(), self.open.iter().map(|&i| point.x[i]))
    }

    fn at(&self, values: DVector<f64>, near: &Point) -> Point {
        let mut point = near.clone();
        for (&i, value) in self.open.iter().zip(&values) {
            point.x[i] = *value;
        }
        point.scatter = self.scatter(&point.x);
        if point.x[TURNS..SHARE] != near.x[TURNS..SHARE] {
            point.forms = self.task.body.forms(&point.scatter);
        }
        point
    }

    fn residuals(&self, point: &Point) -> DVector<f64> {
        let compared = self.task.compare(point);
        let errors = compared.iter().map(|it| it.error() * it.counts);
        let most = self.task.most_turns();
        let costs = self.open.iter().map(|&i| match i {
            ROOTS..ROOTS_BESIDE => PULL * point.x[i],
            // Those of the roots, of which M holds as many numbers.
            ROOTS_BESIDE..TURNS => {
                CORRELATED * correlation(&point.scatter.roots, ENTRIES_OF_M[i - ROOTS])
            }
            TURNS..TURN_ANGLES => {
                let limited = self.task.axes.is_some() || self.task.loose;
                let preferred = if limited { most[i - TURNS] } else { 0.0 };
                PULL * (point.x[i] - preferred) / most[i - TURNS]
            }
            TURN_ANGLES..SHARE => CORRELATED * libm::sin(point.x[i]),
            _ => FOLLOWS * (1.0 - point.x[i] / self.guess[i]),
        });
        DVector::from_iterator(errors.len() + costs.len(), errors.chain(costs))
    }

    fn range(&self, point: &Point, unknown: usize) -> Range {
        let i = self.open[unknown];
        let (least, most) = match i {
            TURNS..TURN_ANGLES => (0.0, self.task.most_turns()[i - TURNS]),
            SHARE => (0.0, self.guess[i]),
            _ => (f64::NEG_INFINITY, f64::INFINITY),
        };
        let unit = match i {
            TURNS..TURN_ANGLES => point.x[i].max(1e-3 * self.guess[i]),
            SHARE => self.guess[i],
            _ => 1.0,
        };
        Range { least, most, unit }
    }
}

/// The correlation of two roots, none where one of them is still.
fn correlation(covariance: &Matrix3<f64>, (i, j): (usize, usize)) -> f64 {
    let size = (covariance[(i, i)] * covariance[(j, j)]).sqrt();
    if size > 0.0 { covariance[(i, j)] / size } else { 0.0 }
}

/// d with d² = v/(1 + 8v): a bounded measure of a rotation of any variance.
fn turn(variance: f64) -> f64 {
    if variance.is_finite() {
        (variance / (1.0 + variance / MOST_TURN)).sqrt()
    } else {
        MOST_TURN.sqrt()
    }
}

/// A covariance of these deviations, and of correlations given by three angles: the rows of its root are
/// points of spheres (Rapisarda, Brigo & Mercurio 2007, doi:10.1093/imaman/dpl010).
fn covariance(deviations: [f64; 3], angles: &[f64]) -> Matrix3<f64> {
    if angles.iter().all(|angle| *angle == 0.0) {
        return Matrix3::from_diagonal(&deviations.map(|d| d * d).into());
    }
    let [(s1, c1), (s2, c2), (s3, c3)] = [0, 1, 2].map(|i| libm::sincos(angles[i]));
    let root = Matrix3::new(1.0, 0.0, 0.0, s1, c1, 0.0, s2, c2 * s3, c2 * c3);
    let root = Matrix3::from_diagonal(&deviations.into()) * root;
    root * root.transpose()
}
