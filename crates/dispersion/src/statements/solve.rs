//! The scatter of second moments and axes that gives the entries the variances asked for, as nearly as
//! any has.

use gyradius_inertia::Inertia;
use nalgebra::{DMatrix, Matrix3};

use super::{
    StatementError,
    body::{Body, MOST_MIXING, Scatter},
    law::Scattered,
    least_squares::{Equation, Unknown, least_squares},
};

/// Rounds at most in which the linear equations are corrected by what the law really gives.
const ROUNDS: usize = 16;
/// Relative errors of variances that need no other round.
const SETTLED: f64 = 1e-5;
/// A round is worth another one if it takes this share off the cost.
const WORTH: f64 = 0.01;
/// Whole rounds without a better law after which they lead nowhere.
const PATIENCE: usize = 4;
/// Shares of the way from the best law to the solution of the equations.
const STEPS: [f64; 5] = [0.5, 0.25, 0.1, 0.03, 0.01];
/// How much more an error of a stated moment counts than one of a stated product: the products may
/// not make the moments more certain than they are stated.
const MOMENTS_FIRST: f64 = 30.0;
/// Deviations below this share of the largest beside them count as this share.
const SMALL: f64 = 1e-3;
/// The same of what a mass centre adds, where the smaller ones are without interest.
const SMALL_BESIDE: f64 = 0.1;
/// A deviation of zero counts as this share of the trace.
const ZERO: f64 = 1e-9;
/// Cost of correlations: what is stated comes out to this share of a variance all the same.
const COST: f64 = 1e-6;
/// The most that the cost of correlating a second moment near zero may grow.
const DEAREST: f64 = 1e4;
/// Pull towards what is preferred where the equations leave it open.
const PULL: f64 = 1e-12;
/// Rotations that cannot contribute this share of the largest variance are left out.
const IDLE: f64 = 1e-10;

/// What is asked of three entries: their variances, (kg·m²)².
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Asked {
    /// Nothing: they move as the rest moves them.
    Nothing,
    /// They have these variances, everything included but what the mass does to all entries.
    Stated {
        /// The variances.
        variances: [f64; 3],
        /// The same with what the mass does, in units of which errors are counted.
        units: [f64; 3],
    },
    /// Beside everything else, these come on top.
    Added([f64; 3]),
}

/// What is asked of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Task {
    pub(super) moments: Asked,
    pub(super) products: Asked,
    /// Mixing of the rotations about the principal axes: as it is, or, beside products, at most.
    pub(super) axes: Option<[f64; 3]>,
}

/// The best law that was found.
pub(super) struct Solution {
    pub(super) scatter: Scatter,
    pub(super) scattered: Scattered,
    /// Sum of the squared relative errors of the stated variances, those of the moments counted first.
    pub(super) cost: f64,
}

/// A law, and where the linear equations are corrected.
#[derive(Clone, Copy)]
struct Point {
    scatter: Scatter,
    /// What the law gives of each variance beyond the linear equations, and in all.
    beyond: [f64; 6],
    found: [f64; 6],
    /// Whether what is stated comes out.
    settled: bool,
}

/// Which unknowns the equations are solved for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Open {
    Moments,
    Mixing,
    Both,
}

/// One equation for a variance.
struct Wanted {
    entry: usize,
    variance: f64,
    weight: f64,
}

impl Task {
    /// Solves the equations, which are linear in the scatter to first order, corrects them by what the
    /// law that this makes gives by quadrature, and keeps the best.
    pub(super) fn solve(&self, body: &Body, nominal: &Inertia) -> Result<Solution, StatementError> {
        let roots = nominal.second_moments().roots();
        let zero = (ZERO * nominal.matrix().trace()).powi(2);
        let given = match self.products {
            Asked::Nothing => self.axes.unwrap_or([0.0; 3]),
            Asked::Stated { .. } | Asked::Added(_) => [0.0; 3],
        };
        let scatter =
            Scatter { moments: Matrix3::zeros(), mixing: Matrix3::from_diagonal(&given.into()) };
        let evaluate = |scatter: Scatter, units: Option<[f64; 6]>| {
            let scattered = Scattered::new(body, roots, &scatter)?;
            let implied = scattered.rough_moments();
            let found = std::array::from_fn(|e| implied.covariance()[(e, e)].max(0.0));
            let linear = body.variances(&scatter);
            let beyond = std::array::from_fn(|e| found[e] - linear[e]);
            let errors = self.errors(&found, &units.unwrap_or(found), zero);
            let cost = errors.iter().map(|e| e * e).sum();
            let settled = errors.iter().all(|e| e.abs() < SETTLED);
            let solution = Solution { scatter, scattered, cost };
            Ok::<_, StatementError>((Point { scatter, beyond, found, settled }, solution))
        };
        let start = Point { scatter, beyond: [0.0; 6], found: [0.0; 6], settled: false };
        let (mut point, mut best) = evaluate(self.round(body, &start, zero, true), None)?;
        let (units, mut at_best) = (Some(point.found), point);

        // Whole steps, which mostly lead straight there. The first ones open what later ones need.
        let mut since = 0;
        for round in 1..ROUNDS {
            let solution;
            (point, solution) = evaluate(self.round(body, &point, zero, false), units)?;
            since += 1;
            if solution.cost <= best.cost {
                if solution.cost < (1.0 - WORTH) * best.cost {
                    since = 0;
                }
                (best, at_best) = (solution, point);
            }
            if round >= 2 && (at_best.settled || since >= PATIENCE) {
                break;
            }
        }
        // From the best law on, steps that are shortened until they do better: where the law is far from
        // linear, whole ones go to and fro.
        for _ in 0..ROUNDS {
            if at_best.settled {
                break;
            }
            let next = self.round(body, &at_best, zero, false);
            let mut worth = false;
            for step in STEPS {
                let (point, solution) = evaluate(at_best.scatter.towards(&next, step), units)?;
                if solution.cost < best.cost {
                    worth = solution.cost < (1.0 - WORTH) * best.cost;
                    (best, at_best) = (solution, point);
                    break;
                }
            }
            if !worth {
                break;
            }
        }
        Ok(best)
    }

    /// One solution of the linear equations.
    fn round(&self, body: &Body, at: &Point, zero: f64, first: bool) -> Scatter {
        use Asked::{Added, Nothing, Stated};
        let Point { scatter: last, beyond, found, .. } = at;
        let system = System { body, gaps: body.gaps(&last.moments), axes: self.axes, zero };
        let none = Scatter { moments: Matrix3::zeros(), mixing: Matrix3::zeros() };
        let moments = self
            .moments
            .stated(0, zero)
            .into_iter()
            .map(|w| Wanted { variance: w.variance - beyond[w.entry], ..w });
        // A product that cannot be as small as stated counts in units of what it is.
        let products = self.products.stated(3, zero).into_iter().map(|w| Wanted {
            variance: w.variance - beyond[w.entry],
            weight: w.weight.min(1.0 / found[w.entry].max(zero)),
            ..w
        });
        let added = |first, variances| added(first, variances, zero);
        match (self.moments, self.products) {
            (Nothing, Nothing | Added(_)) => *last,
            (Added(moments), Nothing) => Scatter {
                mixing: last.mixing,
                ..system.solve(Open::Moments, &none, added(0, moments))
            },
            (Added(moments), Added(products)) => {
                let rows = added(0, moments).chain(added(3, products));
                let largest = moments.iter().chain(&products).copied().fold(zero, f64::max);
                let least = SMALL_BESIDE * SMALL_BESIDE * largest;
                let rows = rows.map(|w| Wanted { weight: w.weight.min(1.0 / least), ..w });
                system.solve(Open::Both, &none, rows)
            }
            (Added(moments), Stated { .. }) => {
                let given = system.solve(Open::Moments, &none, added(0, moments));
                system.solve(Open::Mixing, &given, products)
            }
            (Nothing, Stated { .. }) => system.solve(Open::Mixing, &none, products),
            (Stated { .. }, Nothing) => system.solve(Open::Moments, last, moments),
            (Stated { .. }, Added(these)) => {
                let given = system.solve(Open::Mixing, &none, added(3, these));
                system.solve(Open::Moments, &given, moments)
            }
            // The scatter of the moments first, which the products are then weighed against.
            (Stated { .. }, Stated { .. }) if first => system.solve(Open::Moments, &none, moments),
            (Stated { .. }, Stated { .. }) => {
                let moments = moments.map(|w| Wanted { weight: MOMENTS_FIRST * w.weight, ..w });
                system.solve(Open::Both, &none, moments.chain(products))
            }
        }
    }

    /// Relative errors of the stated variances.
    fn errors(&self, found: &[f64; 6], first_found: &[f64; 6], zero: f64) -> Vec<f64> {
        let (moments, products) = (self.moments.stated(0, zero), self.products.stated(3, zero));
        let first = if products.is_empty() { 1.0 } else { MOMENTS_FIRST };
        let moments = moments.into_iter().map(|w| Wanted { weight: first * w.weight, ..w });
        // Of products, in units of what they were at first if that is larger.
        let products = products
            .into_iter()
            .map(|w| Wanted { weight: w.weight.min(1.0 / first_found[w.entry].max(zero)), ..w });
        moments.chain(products).map(|w| w.weight * (found[w.entry] - w.variance)).collect()
    }
}

impl Asked {
    /// What is stated of three entries, each in units of itself.
    fn stated(&self, first: usize, zero: f64) -> Vec<Wanted> {
        match self {
            Self::Nothing | Self::Added(_) => Vec::new(),
            Self::Stated { variances, units } => {
                let largest = units.iter().copied().fold(zero, f64::max);
                let wanted = |i: usize| Wanted {
                    entry: first + i,
                    variance: variances[i],
                    weight: 1.0 / units[i].max(SMALL * SMALL * largest),
                };
                (0..3).map(wanted).collect()
            }
        }
    }
}

/// What is added to three entries, each in units of itself.
fn added(first: usize, variances: [f64; 3], zero: f64) -> impl Iterator<Item = Wanted> {
    let largest = variances.into_iter().fold(zero, f64::max);
    let least = SMALL_BESIDE * SMALL_BESIDE * largest;
    variances.into_iter().enumerate().map(move |(i, variance)| Wanted {
        entry: first + i,
        variance,
        weight: 1.0 / variance.max(least),
    })
}

/// The linear equations about a body, as it scattered in the last round.
struct System<'a> {
    body: &'a Body,
    /// E[ΔI_j ΔI_l].
    gaps: Matrix3<f64>,
    axes: Option<[f64; 3]>,
    zero: f64,
}

impl System<'_> {
    /// The open unknowns, with the others as given.
    fn solve(
        &self,
        open: Open,
        given: &Scatter,
        rows: impl IntoIterator<Item = Wanted>,
    ) -> Scatter {
        let rows: Vec<_> = rows.into_iter().collect();
        let opens = |which| open == which || open == Open::Both;
        let right = |row: &Wanted| {
            let mut right = row.variance;
            if !opens(Open::Moments) {
                right -= (self.body.growth(row.entry) * given.moments).trace();
            }
            if !opens(Open::Mixing) {
                right -= (self.body.swing(row.entry, &self.gaps) * given.mixing).trace();
            }
            right
        };
        let unit = rows.iter().map(|row| row.variance).fold(self.zero, f64::max);
        let rotations = self.rotations(unit);
        let (mut unknowns, mut which) = (Vec::new(), Vec::new());
        if opens(Open::Moments) {
            unknowns.push(self.second_moments());
            which.push(Open::Moments);
        }
        if opens(Open::Mixing) && !rotations.is_empty() {
            unknowns.push(self.mixing(&rotations, unit));
            which.push(Open::Mixing);
        }
        let equations: Vec<_> = rows
            .iter()
            .map(|row| Equation {
                left: which
                    .iter()
                    .map(|which| match which {
                        Open::Mixing => self.swing(row.entry, &rotations),
                        Open::Moments | Open::Both => {
                            DMatrix::from_fn(3, 3, |i, j| self.body.growth(row.entry)[(i, j)])
                        }
                    })
                    .collect(),
                right: right(row) / unit,
                weight: row.weight * unit,
            })
            .collect();
        let found = least_squares(&unknowns, &equations);

        let mut scatter = *given;
        if opens(Open::Mixing) {
            scatter.mixing = Matrix3::from_diagonal(&self.preferred().into());
        }
        for (which, found) in which.iter().zip(found) {
            match which {
                Open::Mixing => {
                    for (i, &j) in rotations.iter().enumerate() {
                        for (k, &l) in rotations.iter().enumerate() {
                            let size = (self.gaps[(j, j)] * self.gaps[(l, l)]).sqrt();
                            scatter.mixing[(j, l)] = found[(i, k)] * (unit / size);
                        }
                    }
                }
                Open::Moments | Open::Both => {
                    scatter.moments = Matrix3::from_fn(|i, j| found[(i, j)] * unit);
                }
            }
        }
        scatter
    }

    /// Mixing of the rotations that the equations leave open.
    fn preferred(&self) -> [f64; 3] {
        self.axes.unwrap_or([0.0; 3])
    }

    /// The most mixing.
    fn most(&self) -> [f64; 3] {
        self.axes.unwrap_or([MOST_MIXING; 3])
    }

    /// The rotations that can contribute to variances of this size.
    fn rotations(&self, unit: f64) -> Vec<usize> {
        (0..3).filter(|&j| self.most()[j] * self.gaps[(j, j)] > IDLE * unit).collect()
    }

    /// The covariance of the second moments. To correlate one that is near zero is dear: all that a
    /// plate has across itself is what it would be bent by.
    fn second_moments(&self) -> Unknown {
        let k = self.body.second_moments;
        let largest = k.into_iter().fold(0.0, f64::max);
        let cost = |i: usize, j: usize| {
            // In this order, so that products of tiny ones do not vanish.
            let share = (k[i] / largest) * (k[j] / largest);
            COST * (1.0 / share).min(DEAREST)
        };
        Unknown {
            preferred: vec![0.0; 3],
            most: vec![f64::INFINITY; 3],
            cost: DMatrix::from_fn(3, 3, cost),
            pull: PULL,
        }
    }

    /// The mixing of some rotations, in units of what they contribute.
    fn mixing(&self, rotations: &[usize], unit: f64) -> Unknown {
        let scaled =
            |of: [f64; 3]| rotations.iter().map(|&j| of[j] * (self.gaps[(j, j)] / unit)).collect();
        let size = rotations.len();
        Unknown {
            preferred: scaled(self.preferred()),
            most: scaled(self.most()),
            cost: DMatrix::repeat(size, size, COST),
            pull: PULL,
        }
    }

    /// What some rotations do to an entry, in their units.
    fn swing(&self, entry: usize, rotations: &[usize]) -> DMatrix<f64> {
        let swing = self.body.swing(entry, &self.gaps);
        DMatrix::from_fn(rotations.len(), rotations.len(), |i, k| {
            let (j, l) = (rotations[i], rotations[k]);
            swing[(j, l)] / (self.gaps[(j, j)] * self.gaps[(l, l)]).sqrt()
        })
    }
}
