//! The unknowns of a scatter: what they mean, their bounds, and what each costs.

use nalgebra::{DVector, Matrix3, Vector3};

use super::{
    levenberg_marquardt::{Problem, Range},
    reach::{MOST_TURN, most_turns, reach, turn},
    scatter::{Scatter, roots_of},
    task::{Asked, Point, Task},
};

/// What an unknown costs that nothing is asked of, in units of a first guess.
const PULL: f64 = 1e-4;
/// What a correlation costs.
const CORRELATED: f64 = 1e-3;
/// What it costs that the inertia does not follow the mass.
const FOLLOWS: f64 = 0.03;

/// Where the unknowns of the roots stand in M: on the diagonal and beside it.
const ENTRIES_OF_M: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 0), (2, 0), (2, 1)];

/// The unknowns, in this order. The roots have the covariance B M Mᵀ Bᵀ with M lower triangular: its entries
/// on the diagonal and those beside it. The rotations have deviations, and the angles of their correlations. At last
/// the share of the mass that the inertia follows.
pub(super) const ROOTS: usize = 0;
pub(super) const ROOTS_BESIDE: usize = 3;
pub(super) const TURNS: usize = 6;
pub(super) const TURN_ANGLES: usize = 9;
pub(super) const SHARE: usize = 12;
pub(super) const UNKNOWNS: usize = 13;

pub(super) type Values = [f64; UNKNOWNS];

/// The unknowns that are open.
#[derive(Clone)]
pub(super) struct Unknowns<'a> {
    pub(super) task: &'a Task,
    /// B.
    basis: Matrix3<f64>,
    pub(super) open: Vec<usize>,
    pub(super) guess: Values,
    /// How far the products can be moved.
    reach: [f64; 3],
    /// No error counts more than that of a product.
    evenly: bool,
}

/// Values of all unknowns, and where they lead.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trial {
    pub(super) x: Values,
    pub(super) at: Point,
}

impl<'a> Unknowns<'a> {
    /// Those of independent roots and rotations, as far as anything is asked of them, and perhaps the share of the mass that
    /// the inertia follows.
    pub(super) fn new(task: &'a Task, shares: bool) -> Self {
        let mut open = Vec::new();
        if task.moments != Asked::Nothing {
            open.extend(ROOTS..ROOTS_BESIDE);
        }
        if task.products != Asked::Nothing {
            open.extend(TURNS..TURN_ANGLES);
        }
        if shares {
            open.push(SHARE);
        }
        let basis = Matrix3::from_diagonal(&first_roots(task));
        Self { task, basis, open, guess: first_guess(task), reach: reach(task), evenly: false }
    }

    /// The same where no error counts more than that of a product: where all that is asked can be had, it is the same that is
    /// best, and the way to it has no narrow valleys.
    pub(super) fn evenly(&self) -> Self {
        Self { evenly: true, ..self.clone() }
    }

    /// The correlations as well.
    pub(super) fn correlated(mut self) -> Self {
        if self.task.moments != Asked::Nothing {
            self.basis = moved_together(self.task, &first_roots(self.task));
            self.open.extend(ROOTS_BESIDE..TURNS);
        }
        if self.task.products != Asked::Nothing {
            self.open.extend(TURN_ANGLES..SHARE);
        }
        self
    }

    /// The same, of which something else is asked.
    pub(super) fn of(self, task: &'a Task) -> Self {
        Self { task, reach: reach(task), ..self }
    }

    pub(super) fn trial(&self, x: Values) -> Trial {
        let scatter = self.scatter(&x);
        let forms = self.task.forms(&scatter);
        Trial { x, at: Point { scatter, forms, follows: x[SHARE] } }
    }

    /// The unknowns of a trial that was found with another basis, its roots moving at least by a share of what they
    /// move together.
    pub(super) fn expressed(&self, trial: &Trial, least: f64) -> Values {
        let mut x = trial.x;
        x[ROOTS..TURNS].fill(0.0);
        let inverse = self.basis.try_inverse().unwrap_or_default();
        let roots = inverse * trial.at.scatter.roots * inverse.transpose();
        let least = Matrix3::from_diagonal_element(least * roots.trace());
        if let Some(root) = (roots + least).cholesky() {
            let m = root.l();
            for (i, (row, column)) in (ROOTS..).zip(ENTRIES_OF_M) {
                x[i] = m[(row, column)];
            }
        }
        x
    }

    fn scatter(&self, x: &Values) -> Scatter {
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
}

impl Problem for Unknowns<'_> {
    type Point = Trial;

    fn values(&self, trial: &Trial) -> DVector<f64> {
        DVector::from_iterator(self.open.len(), self.open.iter().map(|&i| trial.x[i]))
    }

    fn at(&self, values: DVector<f64>, near: &Trial) -> Trial {
        let mut trial = *near;
        for (&i, value) in self.open.iter().zip(&values) {
            trial.x[i] = *value;
        }
        trial.at.scatter = self.scatter(&trial.x);
        if trial.x[TURNS..SHARE] != near.x[TURNS..SHARE] {
            trial.at.forms = self.task.forms(&trial.at.scatter);
        }
        trial.at.follows = trial.x[SHARE];
        trial
    }

    fn residuals(&self, trial: &Trial) -> DVector<f64> {
        let compared = self.task.compare(&trial.at);
        let errors = compared.iter().map(|it| {
            if self.evenly {
                it.even_cost() * it.counts.min(1.0)
            } else {
                it.cost(&self.reach) * it.counts
            }
        });
        let most = most_turns(self.task);
        let costs = self.open.iter().map(|&i| match i {
            ROOTS..ROOTS_BESIDE => PULL * trial.x[i],
            // Those of the roots, of which M holds as many numbers.
            ROOTS_BESIDE..TURNS => {
                CORRELATED * correlation(&trial.at.scatter.roots, ENTRIES_OF_M[i - ROOTS])
            }
            TURNS..TURN_ANGLES => {
                let limited = self.task.axes.is_some() || self.task.loose;
                let preferred = if limited { most[i - TURNS] } else { 0.0 };
                PULL * (trial.x[i] - preferred) / most[i - TURNS]
            }
            TURN_ANGLES..SHARE => CORRELATED * libm::sin(trial.x[i]),
            _ => FOLLOWS * (1.0 - trial.x[i] / self.guess[i]),
        });
        DVector::from_iterator(errors.len() + costs.len(), errors.chain(costs))
    }

    fn range(&self, trial: &Trial, unknown: usize) -> Range {
        let i = self.open[unknown];
        let (least, most) = match i {
            TURNS..TURN_ANGLES => (0.0, most_turns(self.task)[i - TURNS]),
            SHARE => (0.0, self.guess[i]),
            _ => (f64::NEG_INFINITY, f64::INFINITY),
        };
        let unit = match i {
            TURNS..TURN_ANGLES => trial.x[i].max(1e-3 * self.guess[i]),
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

/// Deviations of the roots to begin with: those of equal variances of the second moments, each moment being the
/// sum of two.
fn first_roots(task: &Task) -> Vector3<f64> {
    let each = Matrix3::from_diagonal_element(task.first_variance());
    roots_of(task.body.roots, &each).diagonal().map(f64::sqrt)
}

/// Where the search starts.
fn first_guess(task: &Task) -> Values {
    let mut x = [0.0; UNKNOWNS];
    if task.moments != Asked::Nothing {
        x[ROOTS..ROOTS_BESIDE].fill(1.0);
    }
    let k = task.body.roots.values();
    let product = task.products.mean_variance().max(task.zero());
    let most = most_turns(task);
    for j in 0..3 {
        let (m, n) = ((j + 1) % 3, (j + 2) % 3);
        let gap = (k[m] * k[m] - k[n] * k[n]).powi(2) + 2.0 * task.first_variance();
        x[TURNS + j] = match (task.products, task.axes) {
            (Asked::Nothing, None) => 0.0,
            (Asked::Nothing, Some(_)) => most[j],
            (Asked::Stated(_) | Asked::Added(_), _) => turn(product / gap).min(0.9 * most[j]),
        };
    }
    x[SHARE] = task.mass.map_or(0.0, |(_, most)| most);
    x
}

/// Deviations of the roots by what they do to the moments, to first order: with this basis, rows of M are
/// moments, in units of what is asked of them.
fn moved_together(task: &Task, roots: &Vector3<f64>) -> Matrix3<f64> {
    let r = *task.body.attitude.to_rotation_matrix().matrix();
    let k = task.body.roots.values();
    // A root near zero moves by its square.
    let slope = |i: usize| 2.0 * (k[i] * k[i] + roots[i] * roots[i]).sqrt();
    let moved = Matrix3::from_fn(|a, i| (1.0 - r[(i, a)] * r[(i, a)]) * slope(i));
    let least = task.least(task.moments);
    let asked = Vector3::from(task.moments.variances()).map(|v| (v + least).sqrt());
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
