//! The likelihood of attitudes under exp(−½ xᵀPx + bᵀx), its gradient and its Hessian.

use nalgebra::{Matrix4, SMatrix, SVector, UnitQuaternion, Vector4};

use crate::{
    contour::{C64, Contour},
    fisher_bingham::centering_shift,
    jacobi,
    rcg::LN_PI_SQUARED,
};

/// Number of parameters: four of b, nine of P (its trace is free).
pub(crate) const PARAMETERS: usize = 13;

pub(crate) type Vector = SVector<f64, PARAMETERS>;
pub(crate) type Square = SMatrix<f64, PARAMETERS, PARAMETERS>;

/// The entries of P that are parameters; P₄₄ is 0.
pub(crate) const PAIRS: [(usize, usize); 9] =
    [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2), (3, 0), (3, 1), (3, 2)];

/// P and b, in the frame of the sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Form {
    pub(crate) p: Matrix4<f64>,
    pub(crate) b: Vector4<f64>,
}

/// The density is ∝ exp(−½ Σ λ_j (v_j − c_j)²) in v = Vᵀy, with |c| ≤ 1.
pub(crate) struct Centered {
    pub(crate) axes: Matrix4<f64>,
    pub(crate) lambda: [f64; 4],
    pub(crate) center: [f64; 4],
}

impl Centered {
    /// ln of the density of ±u, not normalised, and tanh bᵀu; `turn` takes u to v, `linear` is bᵀu.
    fn exponent(&self, turn: &Matrix4<f64>, u: &Vector4<f64>, linear: f64) -> (f64, f64) {
        // The sign that the law prefers, and by how much.
        let sign = 1.0_f64.copysign(linear);
        let other = libm::exp(-2.0 * linear.abs());
        // Centred, as the plain exponent is a difference of large terms.
        let v = turn * u * sign;
        let square: f64 = (0..4).map(|j| self.lambda[j] * (v[j] - self.center[j]).powi(2)).sum();
        (libm::log1p(other) - 0.5 * square, sign * (1.0 - other) / (1.0 + other))
    }
}

impl Form {
    /// Eigenvectors, and eigenvalues less the smallest, in the order of the columns.
    pub(crate) fn eigen(&self) -> ([f64; 4], Matrix4<f64>) {
        // Made definite by a shift that is small where the matrix is graded, so that the small
        // eigenvalues keep their digits.
        let mut shift = 0.0_f64;
        for i in 0..4 {
            shift = shift.max(-self.p[(i, i)]);
        }
        let shifted = self.p + Matrix4::identity() * (shift + 1.0);
        let off: f64 = (0..3).map(|a| shifted[(a, 3)].powi(2) / shifted[(a, a)]).sum();
        let (values, axes) = jacobi::eigen(&(shifted + Matrix4::identity() * off));
        let floor = values.into_iter().fold(f64::INFINITY, f64::min);
        (values.map(|v| v - floor), axes)
    }

    pub(crate) fn centered(&self) -> Centered {
        let (values, axes) = self.eigen();
        let b: [f64; 4] = axes.tr_mul(&self.b).into();
        let shift = centering_shift(values, b);
        let lambda = values.map(|v| v + shift);
        Centered { axes, lambda, center: std::array::from_fn(|j| b[j] / lambda[j]) }
    }
}

/// Attitudes in the frame of their second moment, each coordinate over its root mean square: then
/// parameters are of order one however concentrated the sample is.
#[derive(Clone, Debug)]
pub(crate) struct Sample {
    /// Columns: eigenvectors of the second moment, the largest last.
    pub(crate) frame: Matrix4<f64>,
    /// Root mean squares of the coordinates.
    pub(crate) scale: [f64; 4],
    points: Vec<Vector4<f64>>,
    /// Mean of the products of scaled coordinates.
    second: Matrix4<f64>,
}

/// Mean ln-likelihood an attitude, with respect to Haar measure of total one.
#[derive(Clone, Debug)]
pub(crate) struct Evaluation {
    pub(crate) value: f64,
    pub(crate) gradient: Vector,
    pub(crate) hessian: Square,
    /// Covariance of the sufficient statistics under the law.
    pub(crate) information: Square,
}

impl Sample {
    pub(crate) fn new(attitudes: &[UnitQuaternion<f64>]) -> Self {
        let mut frame = Matrix4::identity();
        let mut points: Vec<Vector4<f64>> = attitudes.iter().map(|q| q.coords).collect();
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
            for (point, q) in points.iter_mut().zip(attitudes) {
                *point = frame.tr_mul(&q.coords);
            }
            squares = order.map(|j| values[j].max(0.0));
        }
        let scale = squares.map(f64::sqrt);
        for point in &mut points {
            *point = Vector4::from_fn(|i, _| point[i] / scale[i]);
        }
        let second = second_moment(&points);
        Self { frame, scale, points, second }
    }

    pub(crate) fn len(&self) -> f64 {
        self.points.len() as f64
    }

    pub(crate) fn points(&self) -> &[Vector4<f64>] {
        &self.points
    }

    /// P and b from the parameters.
    pub(crate) fn form(&self, eta: &Vector) -> Form {
        let mut p = Matrix4::zeros();
        for (k, &(i, j)) in PAIRS.iter().enumerate() {
            p[(i, j)] = eta[4 + k] / (self.scale[i] * self.scale[j]);
            p[(j, i)] = p[(i, j)];
        }
        Form { p, b: Vector4::from_fn(|i, _| eta[i] / self.scale[i]) }
    }

    /// The parameters of P and b: a linear map.
    pub(crate) fn parameters(&self, form: &Form) -> Vector {
        let mut eta = Vector::zeros();
        for i in 0..4 {
            eta[i] = form.b[i] * self.scale[i];
        }
        for (k, &(i, j)) in PAIRS.iter().enumerate() {
            let own = if i == j { form.p[(3, 3)] } else { 0.0 };
            eta[4 + k] = (form.p[(i, j)] - own) * self.scale[i] * self.scale[j];
        }
        eta
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
        means.sort_by(|a, b| b.norm_squared().total_cmp(&a.norm_squared()));
        means
    }

    fn signed_mean(&self, direction: &Vector4<f64>) -> Vector4<f64> {
        let mut sum = Vector4::zeros();
        for u in &self.points {
            sum += u * 1.0_f64.copysign(direction.dot(u));
        }
        sum / self.len()
    }

    /// The Gaussian with this mean and the sample's second moment, in scaled coordinates.
    pub(crate) fn gaussian(&self, mean: &Vector4<f64>) -> Form {
        // Steeper forms are rounding where they are flat.
        let slack = (1.0 - mean.norm_squared()).max(1e-8);
        let b = mean / slack;
        let p = Matrix4::identity() + b * mean.transpose();
        let scale = Vector4::from(self.scale);
        Form {
            p: Matrix4::from_fn(|i, j| p[(i, j)] / (scale[i] * scale[j])),
            b: b.component_div(&scale),
        }
    }

    /// Root mean square distance of the sample from the law's thinnest hyperplane, signs as the law
    /// has them, and the same over the sample's extent in that direction.
    pub(crate) fn thickness(&self, form: &Form) -> (f64, f64) {
        let law = form.centered();
        let mut squares = Vector4::zeros();
        for u in &self.points {
            let y = Vector4::from_fn(|i, _| u[i] * self.scale[i]);
            let v = law.axes.tr_mul(&y) * 1.0_f64.copysign(form.b.dot(&y));
            let across = v - Vector4::from(law.center);
            squares += across.component_mul(&across) / self.len();
        }
        let mut thinnest = (f64::INFINITY, f64::INFINITY);
        for j in 0..4 {
            let reach: f64 = (0..4).map(|i| (law.axes[(i, j)] * self.scale[i]).powi(2)).sum();
            let share = (squares[j] / reach).sqrt();
            if share < thinnest.1 {
                thinnest = (squares[j].sqrt(), share);
            }
        }
        thinnest
    }

    /// Mean ln-likelihood alone.
    pub(crate) fn height(&self, form: &Form) -> f64 {
        let law = form.centered();
        let slack = 1.0 - law.center.iter().map(|c| c * c).sum::<f64>();
        let turn = Matrix4::from_fn(|i, j| law.axes[(j, i)] * self.scale[j]);
        let b = form.b.component_mul(&Vector4::from(self.scale));
        let sum: f64 = self.points.iter().map(|u| law.exponent(&turn, u, b.dot(u)).0).sum();
        sum / self.len() - Contour::new(law.lambda, law.center, slack).ln_integral() + LN_PI_SQUARED
    }

    pub(crate) fn evaluate(&self, eta: &Vector) -> Evaluation {
        let law = self.form(eta).centered();
        let slack = 1.0 - law.center.iter().map(|c| c * c).sum::<f64>();
        let contour = Contour::new(law.lambda, law.center, slack);
        let (mean, information) = self.model_moments(&law, &contour);

        let b = eta.fixed_rows::<4>(0).into_owned();
        let turn = Matrix4::from_fn(|i, j| law.axes[(j, i)] * self.scale[j]);
        let mut sum = 0.0;
        let (mut first, mut bend) = (Vector4::zeros(), Matrix4::zeros());
        for u in &self.points {
            let (exponent, tanh) = law.exponent(&turn, u, b.dot(u));
            sum += exponent;
            first += u * tanh;
            bend += u * (u * (1.0 - tanh * tanh)).transpose();
        }
        let value = sum / self.len() - contour.ln_integral() + LN_PI_SQUARED;
        let mut gradient = -mean;
        for i in 0..4 {
            gradient[i] += first[i] / self.len();
        }
        for (k, &(i, j)) in PAIRS.iter().enumerate() {
            gradient[4 + k] -= half_if(i == j) * self.second[(i, j)];
        }
        let mut hessian = -information;
        let mut block = hessian.fixed_view_mut::<4, 4>(0, 0);
        block += bend / self.len();
        Evaluation { value, gradient, hessian, information }
    }

    /// Mean and covariance of the statistics (u_i, −½u_a², −u_a u_b) under the law: at every node
    /// of the contour the moments of a Gaussian, by Isserlis's theorem.
    fn model_moments(&self, law: &Centered, contour: &Contour) -> (Vector, Square) {
        let turn = Matrix4::from_fn(|i, j| law.axes[(i, j)] / self.scale[i]);
        let (mut mean, mut square) = (Vector::zeros(), Square::zeros());
        for (weight, node_mean, variance) in contour.nodes() {
            let zero = C64::new(0.0, 0.0);
            let mut m = [zero; 4];
            let mut c = [[zero; 4]; 4];
            for i in 0..4 {
                for k in 0..4 {
                    m[i] += node_mean[k] * turn[(i, k)];
                }
                for j in 0..=i {
                    for (k, v) in variance.iter().enumerate() {
                        c[i][j] += v * (turn[(i, k)] * turn[(j, k)]);
                    }
                    c[j][i] = c[i][j];
                }
            }
            // Only imaginary parts are wanted: the weight goes on one factor of each product.
            let im = |a: C64, b: C64| a.re * b.im + a.im * b.re;
            let table = |f: &dyn Fn(usize, usize) -> C64| -> [[C64; 4]; 4] {
                std::array::from_fn(|i| std::array::from_fn(|j| f(i, j)))
            };
            let product = table(&|i, j| m[i] * m[j]);
            let raw = table(&|i, j| product[i][j] + c[i][j]);
            let weighted_product = table(&|i, j| weight * product[i][j]);
            let weighted = table(&|i, j| weight * raw[i][j]);
            let weighted_mean = m.map(|m| weight * m);
            for i in 0..4 {
                mean[i] += weighted_mean[i].im;
                for j in 0..=i {
                    square[(i, j)] += weighted[i][j].im;
                }
            }
            for (k, &(a, b)) in PAIRS.iter().enumerate() {
                let sign = -half_if(a == b);
                mean[4 + k] += sign * weighted[a][b].im;
                for i in 0..4 {
                    let third = im(weighted_mean[i], raw[a][b])
                        + im(weighted_mean[a], c[i][b])
                        + im(weighted_mean[b], c[i][a]);
                    square[(4 + k, i)] += sign * third;
                }
                for (l, &(d, e)) in PAIRS.iter().enumerate().take(k + 1) {
                    let fourth = im(weighted[a][b], raw[d][e])
                        + im(weighted[a][d], raw[b][e])
                        + im(weighted[a][e], raw[b][d])
                        - 2.0 * im(weighted_product[a][b], product[d][e]);
                    square[(4 + k, 4 + l)] += sign * -half_if(d == e) * fourth;
                }
            }
        }
        square.fill_upper_triangle_with_lower_triangle();
        (mean, square - mean * mean.transpose())
    }
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
