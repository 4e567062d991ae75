//! Least squares over covariances: symmetric matrices that are positive semidefinite.

use nalgebra::{DMatrix, DVector};

/// The barrier is lowered from one to this, in the units of the objective.
const LAST_BARRIER: f64 = 1e-13;
/// By this factor a time.
const LOWER: f64 = 0.1;
/// Newton steps for one height of the barrier. A handful is usual.
const STEPS: usize = 60;

/// An unknown covariance, in units in which its entries are about one.
#[derive(Clone, Debug)]
pub(super) struct Unknown {
    /// What each variance is where the equations leave it open.
    pub(super) preferred: Vec<f64>,
    /// The most that each variance may be; infinite where there is no limit.
    pub(super) most: Vec<f64>,
    /// What a covariance costs: its square times this.
    pub(super) cost: DMatrix<f64>,
    /// What it costs to leave the preferred variances.
    pub(super) pull: f64,
}

/// One equation: Σ tr(A_u X_u) = b, over the unknowns X_u.
#[derive(Clone, Debug)]
pub(super) struct Equation {
    /// The symmetric matrices A_u, one for each unknown.
    pub(super) left: Vec<DMatrix<f64>>,
    /// b.
    pub(super) right: f64,
    /// What its error is multiplied by.
    pub(super) weight: f64,
}

/// The covariances X_u that minimise the sum of the squared weighted errors of the equations and of
/// the costs.
///
/// # Algorithm
/// Newton's method with the barrier −μ(Σ ln det X_u + Σ ln(most − X_jj)) for falling μ (Boyd &
/// Vandenberghe 2004, Convex Optimization, §11.3). The problem is convex and, by its costs,
/// has one solution. What is found is above the least value by at most μ times the number of variances
/// and limits.
pub(super) fn least_squares(unknowns: &[Unknown], equations: &[Equation]) -> Vec<DMatrix<f64>> {
    let problem = Problem::new(unknowns, equations);
    let mut x = problem.start();
    let mut barrier = 1.0;
    while barrier >= LAST_BARRIER {
        for _ in 0..STEPS {
            let Some(next) = problem.step(&x, barrier) else { break };
            x = next;
        }
        barrier *= LOWER;
    }
    problem.matrices(&x)
}

/// ½xᵀHx − gᵀx over the upper triangles of all unknowns, one after the other.
struct Problem<'a> {
    unknowns: &'a [Unknown],
    hessian: DMatrix<f64>,
    gradient: DVector<f64>,
}

impl<'a> Problem<'a> {
    fn new(unknowns: &'a [Unknown], equations: &[Equation]) -> Self {
        let count = unknowns.iter().map(|u| triangle(u.size()).count()).sum();
        let mut hessian = DMatrix::zeros(count, count);
        let mut gradient = DVector::zeros(count);
        for equation in equations {
            let row = DVector::from_iterator(
                count,
                equation.left.iter().flat_map(|a| {
                    triangle(a.nrows()).map(|(i, j)| a[(i, j)] * if i == j { 1.0 } else { 2.0 })
                }),
            );
            let square = equation.weight * equation.weight;
            hessian += &row * row.transpose() * square;
            gradient += row * (equation.right * square);
        }
        let entries = unknowns.iter().flat_map(|u| triangle(u.size()).map(move |(i, j)| (u, i, j)));
        for (n, (unknown, i, j)) in entries.enumerate() {
            if i == j {
                let preferred = unknown.preferred[i];
                // So that a preference far away does not outweigh the equations.
                let pull = unknown.pull / (preferred * preferred).max(1.0);
                hessian[(n, n)] += pull;
                gradient[n] += pull * preferred;
            } else {
                hessian[(n, n)] += unknown.cost[(i, j)];
            }
        }
        Self { unknowns, hessian, gradient }
    }

    /// Matrices well inside.
    fn start(&self) -> DVector<f64> {
        let entries = self.unknowns.iter().flat_map(|u| {
            triangle(u.size())
                .map(move |(i, j)| if i == j { (0.5 * u.most[i]).min(1.0) } else { 0.0 })
        });
        DVector::from_iterator(self.gradient.len(), entries)
    }

    fn matrices(&self, x: &DVector<f64>) -> Vec<DMatrix<f64>> {
        let mut values = x.iter();
        let matrix = |unknown: &Unknown| {
            let mut matrix = DMatrix::zeros(unknown.size(), unknown.size());
            for ((i, j), value) in triangle(unknown.size()).zip(values.by_ref()) {
                matrix[(i, j)] = *value;
                matrix[(j, i)] = *value;
            }
            matrix
        };
        self.unknowns.iter().map(matrix).collect()
    }

    /// The objective with its barrier; `None` outside.
    fn value(&self, x: &DVector<f64>, barrier: f64) -> Option<f64> {
        let mut value = 0.5 * x.dot(&(&self.hessian * x)) - self.gradient.dot(x);
        for (unknown, matrix) in self.unknowns.iter().zip(self.matrices(x)) {
            for j in 0..unknown.size() {
                let room = unknown.most[j] - matrix[(j, j)];
                if !(room > 0.0) {
                    return None;
                }
                if room.is_finite() {
                    value -= barrier * libm::log(room);
                }
            }
            let factor = matrix.cholesky()?;
            let roots = factor.l_dirty().diagonal();
            value -= 2.0 * barrier * roots.iter().map(|d| libm::log(*d)).sum::<f64>();
        }
        value.is_finite().then_some(value)
    }

    /// A Newton step that goes down; `None` where there is none worth taking.
    fn step(&self, x: &DVector<f64>, barrier: f64) -> Option<DVector<f64>> {
        let mut hessian = self.hessian.clone();
        let mut slope = &self.hessian * x - &self.gradient;
        let mut first = 0;
        for (unknown, matrix) in self.unknowns.iter().zip(self.matrices(x)) {
            let inverse = matrix.clone().cholesky()?.inverse();
            let entries: Vec<_> = triangle(unknown.size()).collect();
            for (n, &(i, j)) in entries.iter().enumerate() {
                let twice = |i, j| if i == j { 1.0 } else { 2.0 };
                slope[first + n] -= barrier * twice(i, j) * inverse[(i, j)];
                for (m, &(k, l)) in entries.iter().enumerate() {
                    // tr(X⁻¹ E_ij X⁻¹ E_kl) of the symmetric basis matrices.
                    let pairs =
                        inverse[(i, k)] * inverse[(j, l)] + inverse[(i, l)] * inverse[(j, k)];
                    hessian[(first + n, first + m)] +=
                        barrier * 0.5 * twice(i, j) * twice(k, l) * pairs;
                }
                if i == j && unknown.most[i].is_finite() {
                    let room = unknown.most[i] - matrix[(i, i)];
                    slope[first + n] += barrier / room;
                    hessian[(first + n, first + n)] += barrier / (room * room);
                }
            }
            first += entries.len();
        }
        let step = -solve(hessian, &slope)?;
        let decrement = -slope.dot(&step);
        // A hundredth of the barrier: the next height begins from there.
        if !(decrement > 1e-2 * barrier) {
            return None;
        }
        let here = self.value(x, barrier)?;
        let mut share = 1.0;
        while share > 1e-9 {
            let next = x + &step * share;
            if self.value(&next, barrier).is_some_and(|there| there < here) {
                return Some(next);
            }
            share *= 0.5;
        }
        None
    }
}

impl Unknown {
    fn size(&self) -> usize {
        self.most.len()
    }
}

/// The solution of a definite system whose rows may be of very different sizes.
fn solve(mut matrix: DMatrix<f64>, right: &DVector<f64>) -> Option<DVector<f64>> {
    let sizes = matrix.diagonal().map(|d| 1.0 / d.sqrt());
    for i in 0..matrix.nrows() {
        for j in 0..matrix.ncols() {
            matrix[(i, j)] *= sizes[i] * sizes[j];
        }
    }
    let scaled = right.component_mul(&sizes);
    let solution = matrix.cholesky()?.solve(&scaled).component_mul(&sizes);
    solution.iter().all(|x| x.is_finite()).then_some(solution)
}

/// The entries on and above the diagonal.
fn triangle(size: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..size).flat_map(move |i| (i..size).map(move |j| (i, j)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn open(size: usize, most: f64) -> Unknown {
        Unknown {
            preferred: vec![0.0; size],
            most: vec![most; size],
            cost: DMatrix::repeat(size, size, 1e-6),
            pull: 1e-9,
        }
    }

    proptest! {
        /// Karush-Kuhn-Tucker: no step towards any other covariance goes down.
        #[test]
        fn nothing_allowed_is_better(
            a in prop::collection::vec(prop::array::uniform6(-1.0..1.0f64), 1..7),
            b in prop::array::uniform6(-1.0..1.0f64),
            other in prop::collection::vec(prop::array::uniform6(-1.0..1.0f64), 20),
            most in 0.01..3.0f64,
        ) {
            let symmetric = |x: &[f64; 6]| {
                DMatrix::from_row_slice(3, 3, &[x[0], x[1], x[2], x[1], x[3], x[4], x[2], x[4], x[5]])
            };
            let equations: Vec<_> = a
                .iter()
                .zip(b)
                .map(|(a, right)| Equation { left: vec![symmetric(a)], right, weight: 1.0 })
                .collect();
            let unknown = open(3, most);
            let x = least_squares(std::slice::from_ref(&unknown), &equations).remove(0);
            let cost = |x: &DMatrix<f64>| {
                let errors = equations.iter().map(|e| ((&e.left[0] * x).trace() - e.right).powi(2));
                let costs = triangle(3).map(|(i, j)| {
                    x[(i, j)].powi(2) * if i == j { unknown.pull } else { 1e-6 }
                });
                0.5 * (errors.sum::<f64>() + costs.sum::<f64>())
            };
            let found = cost(&x);
            prop_assert!(x.clone().cholesky().is_some());
            prop_assert!((0..3).all(|i| x[(i, i)] < most));
            for other in &other {
                // F Fᵀ, within the limits.
                let f = symmetric(other);
                let y = &f * f.transpose();
                let largest = y.diagonal().max() / most;
                let y = y / largest.max(1.0);
                for share in [1e-3, 1e-2, 0.1, 1.0] {
                    let there = cost(&(&x * (1.0 - share) + &y * share));
                    prop_assert!(there > found - 1e-9, "{there:e} {found:e}");
                }
            }
        }
    }

    /// Independent unless the equations cannot be met so.
    #[test]
    fn covariances_are_none_unless_they_must() {
        // Variances of sums of two: those of a plate that keeps its shape need both to go together.
        for (rights, covariance) in [([1.0, 1.0, 2.0], 0.0), ([1.0, 1.0, 4.0], 1.0)] {
            let sums = [[0.0, 1.0], [1.0, 0.0], [1.0, 1.0]];
            let equations: Vec<_> = sums
                .iter()
                .zip(rights)
                .map(|(s, right)| {
                    let s = DVector::from_row_slice(s);
                    Equation { left: vec![&s * s.transpose()], right, weight: 1.0 }
                })
                .collect();
            let x = least_squares(&[open(2, f64::INFINITY)], &equations).remove(0);
            assert!((x[(0, 1)] - covariance).abs() < 1e-3, "{x}");
            assert!((x[(0, 0)] - 1.0).abs() < 1e-3, "{x}");
        }
    }

    #[test]
    fn what_is_open_is_as_preferred() {
        let mut unknown = open(2, 10.0);
        unknown.preferred = vec![0.0, 5.0];
        let left = vec![DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 0.0, 0.0])];
        let x = least_squares(&[unknown], &[Equation { left, right: 2.0, weight: 1.0 }]).remove(0);
        assert!((x[(0, 0)] - 2.0).abs() < 1e-3 && (x[(1, 1)] - 5.0).abs() < 0.01, "{x}");
    }
}
