//! The likelihood of attitudes under exp(−½ xᵀPx + bᵀx), its gradient and its Hessian.

use nalgebra::{Matrix4, SMatrix, UnitQuaternion, Vector4};
use std::cmp::{Ordering, Reverse};

use super::{
    centered::{Centered, PAIRS, PRODUCTS, STATISTICS, Statistics},
    climb::Evaluation,
    means::Means,
    rounding::{end, sign, whole},
};
use crate::{
    contour::{C64, Contour},
    fisher_bingham::LN_PI_SQUARED,
    jacobi,
};

/// Attitudes in the frame of their second moment, each coordinate over its root mean square: then
/// parameters are of order one however concentrated the sample is.
#[derive(Clone, Debug)]
pub(crate) struct Sample {
    /// Columns: eigenvectors of the second moment, the largest last.
    pub(crate) frame: Matrix4<f64>,
    /// Root mean squares of the coordinates.
    pub(crate) scale: [f64; 4],
    /// The coordinates, one after the other.
    columns: [Vec<f64>; 4],
}

impl Sample {
    pub(crate) fn new(attitudes: &[UnitQuaternion<f64>]) -> Self {
        let mut frame = Matrix4::identity();
        let attitudes = sorted(attitudes);
        let mut points = attitudes.clone();
        let mut squares = [0.25; 4];
        // A second pass in the frame of the first finds small spreads that the first has lost to
        // rounding.
        for _ in 0..2 {
            let moment = second_moment(&points);
            let (values, axes) = jacobi::eigen(&moment);
            let mut order = [0, 1, 2, 3];
            order.sort_by(|&i, &j| values[i].total_cmp(&values[j]));
            let axes = Matrix4::from_columns(&order.map(|j| axes.column(j).into_owned()));
            frame *= axes;
            // From the attitudes again, as rounding must not add up.
            for (point, q) in points.iter_mut().zip(&attitudes) {
                *point = frame.tr_mul(q);
            }
            squares = order.map(|j| values[j].max(0.0));
        }
        let scale = squares.map(f64::sqrt);
        let columns =
            std::array::from_fn(|i| points.iter().map(|point| point[i] / scale[i]).collect());
        Self { frame, scale, columns }
    }

    pub(crate) fn len(&self) -> f64 {
        self.columns[0].len() as f64
    }

    pub(super) fn columns(&self) -> &[Vec<f64>; 4] {
        &self.columns
    }

    pub(crate) fn points(&self) -> impl Iterator<Item = Vector4<f64>> {
        let [x, y, z, w] = &self.columns;
        let points = x.iter().zip(y).zip(z.iter().zip(w));
        points.map(|((x, y), (z, w))| Vector4::new(*x, *y, *z, *w))
    }

    pub(crate) fn point(&self, index: usize) -> Vector4<f64> {
        Vector4::from_fn(|i, _| self.columns[i][index])
    }

    /// Means of the scaled sample with signs that hold one half of it together: the local maxima
    /// of |Σ ±u| over the signs, the greatest first.
    pub(crate) fn halves(&self) -> Vec<Vector4<f64>> {
        let mut means: Vec<Vector4<f64>> = Vec::new();
        for direction in root_lines() {
            let mut mean = self.signed_mean(&direction);
            for _ in 0..100 {
                let next = self.signed_mean(&mean);
                if next == mean {
                    break;
                }
                mean = next;
            }
            if !means.iter().any(|m| (m - mean).norm().min((m + mean).norm()) < 1e-6) {
                means.push(mean);
            }
        }
        means.sort_by_key(|mean| Reverse(whole(mean.norm_squared())));
        means
    }

    /// Mean size of the scaled coordinate.
    pub(crate) fn mean_size(&self, coordinate: usize) -> f64 {
        self.columns[coordinate].iter().map(|x| x.abs()).sum::<f64>() / self.len()
    }

    fn signed_mean(&self, direction: &Vector4<f64>) -> Vector4<f64> {
        let mut sum = Vector4::zeros();
        for u in self.points() {
            sum += u * sign(direction.dot(&u));
        }
        sum / self.len()
    }

    /// The Gaussian with this mean and the sample's second moment, in scaled coordinates.
    pub(crate) fn gaussian(&self, mean: &Vector4<f64>) -> Centered {
        // Steeper forms are rounding where they are flat.
        let slack = (1.0 - mean.norm_squared()).max(1e-8);
        let b = mean / slack;
        let p = Matrix4::identity() + b * mean.transpose();
        let scale = Vector4::from(self.scale);
        let p = Matrix4::from_fn(|i, j| p[(i, j)] / (scale[i] * scale[j]));
        Centered::of(&p, &b.component_div(&scale))
    }

    /// Root mean square distance of the attitudes' quaternions, signs as the law has them, from the
    /// nearest small sphere: along the sphere, in rad.
    pub(crate) fn thickness(&self, law: &Centered) -> f64 {
        let scale = Vector4::from(self.scale);
        let b = (law.axes * Vector4::from(law.linear())).component_mul(&scale);
        let points: Vec<Vector4<f64>> =
            self.points().map(|u| u.component_mul(&scale) * 1.0_f64.copysign(b.dot(&u))).collect();
        let n = self.len();
        let center = points.iter().sum::<Vector4<f64>>() / n;
        let mut axes = Matrix4::identity();
        let mut values = [0.0; 4];
        // A second pass finds what the first has lost to rounding.
        for _ in 0..2 {
            let offsets: Vec<_> = points.iter().map(|y| axes.tr_mul(&(y - center))).collect();
            let (found, turn) = jacobi::eigen(&second_moment(&offsets));
            (values, axes) = (found, axes * turn);
        }
        let distances = (0..4).map(|j| {
            // The farther the sphere is from a great one, the more slanted its plane.
            let normal = axes.column(j);
            let level = |y: &Vector4<f64>| (y - normal * normal.dot(y)).norm_squared();
            (values[j].max(0.0) / (points.iter().map(level).sum::<f64>() / n)).sqrt()
        });
        distances.fold(f64::INFINITY, f64::min)
    }

    /// u ↦ v.
    pub(super) fn turn(&self, law: &Centered) -> Matrix4<f64> {
        Matrix4::from_fn(|i, j| law.axes[(j, i)] * self.scale[j])
    }

    /// Mean ln-likelihood alone.
    pub(crate) fn height(&self, law: &Centered) -> f64 {
        let contour = Contour::new(law.lambda, law.center, law.slack());
        Means::new(&self.columns, self.turn(law), law).exponent - contour.ln_integral()
            + LN_PI_SQUARED
    }

    /// Derivatives are by the factors of the law's own statistics, of which one depends on the others.
    pub(crate) fn evaluate(&self, law: &Centered) -> Evaluation<STATISTICS> {
        let contour = Contour::new(law.lambda, law.center, law.slack());
        let (expected, information) = model_moments(law, &contour);
        let means = Means::new(&self.columns, self.turn(law), law);
        // By how much the statistics of u are ahead of those of −u: linear in v.
        let roots = law.roots();
        let mut ahead = SMatrix::<f64, STATISTICS, 4>::zeros();
        for i in 0..4 {
            ahead[(i, i)] = 2.0 * roots[i];
        }
        for (k, &(i, j)) in PAIRS.iter().enumerate() {
            let factor = 2.0 * half_if(i == j) * roots[i] * roots[j];
            ahead[(PRODUCTS + k, i)] += factor * law.center[j];
            ahead[(PRODUCTS + k, j)] += factor * law.center[i];
        }
        let mut gradient = -expected - ahead * means.other;
        for i in 0..4 {
            gradient[i] += means.first[i];
        }
        for (k, &(i, j)) in PAIRS.iter().enumerate() {
            gradient[PRODUCTS + k] -= half_if(i == j) * means.second[(i, j)];
        }
        let value = means.exponent - contour.ln_integral() + LN_PI_SQUARED;
        let hessian = ahead * means.doubt * ahead.transpose() - information;
        Evaluation { value, gradient, hessian, information }
    }
}

/// The quaternions in an order and with signs of their own, so that the same attitudes have the same fit: rounding can decide
/// which of several maxima a search comes to.
fn sorted(attitudes: &[UnitQuaternion<f64>]) -> Vec<Vector4<f64>> {
    let mut points: Vec<Vector4<f64>> =
        attitudes.iter().map(|q| q.coords * end(&q.coords)).collect();
    let order = |a: &Vector4<f64>, b: &Vector4<f64>| {
        let rounded = a.map(whole).iter().cmp(b.map(whole).iter());
        // Sums have the same last digit.
        let pairs = a.iter().zip(b.iter());
        pairs.fold(rounded, |order: Ordering, (a, b)| order.then(a.total_cmp(b)))
    };
    points.sort_by(order);
    points
}

/// Mean and covariance of the statistics under the law. At every node of the contour the w are
/// independent Gaussians, and moments are products of theirs.
fn model_moments(
    law: &Centered,
    contour: &Contour,
) -> (Statistics, SMatrix<f64, STATISTICS, STATISTICS>) {
    let roots = law.roots();
    // The moment of w₁^a w₂^b w₃^c w₄^d has index 125 a + 25 b + 5 c + d.
    const PLACE: [usize; 4] = [125, 25, 5, 1];
    let mut moments = [0.0; 625];
    for (weight, offset, variance) in contour.nodes_about_centre() {
        let powers: [[C64; 5]; 4] = std::array::from_fn(|i| {
            let (m, c) = (offset[i] * roots[i], variance[i] * law.lambda[i]);
            let square = m * m;
            [
                C64::new(1.0, 0.0),
                m,
                square + c,
                m * (square + c * 3.0),
                square * (square + c * 6.0) + c * c * 3.0,
            ]
        });
        for a in 0..5 {
            let first = powers[0][a] * weight;
            for b in 0..5 - a {
                let second = first * powers[1][b];
                for c in 0..5 - a - b {
                    let third = second * powers[2][c];
                    for d in 0..5 - a - b - c {
                        let last = powers[3][d];
                        moments[125 * a + 25 * b + 5 * c + d] +=
                            third.re * last.im + third.im * last.re;
                    }
                }
            }
        }
    }
    let statistic = |k: usize| match k.checked_sub(PRODUCTS) {
        None => (PLACE[k], 1.0),
        Some(pair) => {
            let (i, j) = PAIRS[pair];
            (PLACE[i] + PLACE[j], -half_if(i == j))
        }
    };
    let mean = Statistics::from_fn(|k, _| {
        let (index, factor) = statistic(k);
        factor * moments[index]
    });
    let covariance = SMatrix::from_fn(|k, l| {
        let ((a, x), (b, y)) = (statistic(k), statistic(l));
        x * y * (moments[a + b] - moments[a] * moments[b])
    });
    (mean, covariance)
}

/// The 24 lines through opposite roots of F₄: no direction of ℝ⁴ is farther than 32° from one.
pub(crate) fn root_lines() -> Vec<Vector4<f64>> {
    let mut lines = Vec::with_capacity(24);
    for i in 0..4 {
        lines.push(Vector4::ith(i, 1.0));
        for j in 0..i {
            for sign in [1.0, -1.0] {
                lines.push(Vector4::ith(i, 1.0) + Vector4::ith(j, sign));
            }
        }
    }
    for signs in 0..8_u8 {
        let sign = |bit: u8| if signs >> bit & 1 == 0 { 0.5 } else { -0.5 };
        lines.push(Vector4::new(0.5, sign(0), sign(1), sign(2)));
    }
    lines
}

fn half_if(diagonal: bool) -> f64 {
    if diagonal { 0.5 } else { 1.0 }
}

fn second_moment(points: &[Vector4<f64>]) -> Matrix4<f64> {
    let mut sum = Matrix4::zeros();
    for x in points {
        sum += x * x.transpose();
    }
    sum / points.len() as f64
}
