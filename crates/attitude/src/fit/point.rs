//! The law as an engineer sees it: a mean attitude, the covariance of turns about it, and what is
//! radial. Coordinates on the same family as P and b.

use nalgebra::{Matrix3, Matrix4, Vector3, Vector4};

use super::{
    climb::Hill,
    likelihood::{Evaluation, Form, PARAMETERS, Sample, Square, Vector},
};

/// Entries of Λ, in the order of its parameters.
pub(crate) const TRIANGLE: [(usize, usize); 6] = [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)];

/// First parameters of Λ, k and τ; those of the mean come before.
pub(crate) const PRECISION: usize = 3;
pub(crate) const SLOPE: usize = 9;
pub(crate) const TAU: usize = 12;

/// The density exp(−½ (t − k(r − 1))ᵀ Λ (t − k(r − 1)) − ½ τ (r − 1)²), where r is the coordinate
/// along the mean and t are the three across it: a Gaussian in ℝ⁴ whose radial variance is 1/τ,
/// and whose tangent coordinates, given r, have precision Λ and regression k on r. τ = 0 is
/// allowed; with k = 0 the mean is a principal axis, with both the law is Bingham's.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point {
    /// Columns: three tangents, then the mean; in the frame of the sample.
    pub(crate) frame: Matrix4<f64>,
    pub(crate) precision: Matrix3<f64>,
    pub(crate) slope: Vector3<f64>,
    pub(crate) tau: f64,
}

impl Point {
    /// About the greatest of the density's maxima, of which ±b gives two: the one whose last
    /// coordinate in the frame of the sample is not negative.
    pub(crate) fn of(form: &Form) -> Self {
        let (values, axes) = form.eigen();
        let b: [f64; 4] = axes.tr_mul(&form.b).into();
        let lowest = (0..4).fold(0, |l, j| if values[j] < values[l] { j } else { l });
        // (P + μ)m = b with |m| = 1, in d = μ + min P ≥ 0: the trust-region problem.
        let square = |d: f64| -> f64 {
            (0..4).filter(|&j| b[j] != 0.0).map(|j| (b[j] / (values[j] + d)).powi(2)).sum()
        };
        let mut high = Vector4::from(b).norm();
        let mut low = b[lowest].abs();
        for _ in 0..200 {
            let middle = if low < 0.25 * high {
                (low.max(1e-300) * high).sqrt()
            } else {
                0.5 * (low + high)
            };
            if middle <= low || middle >= high {
                break;
            }
            if square(middle) > 1.0 { low = middle } else { high = middle }
        }
        let d = high;
        let lambda = values.map(|v| v + d);
        let mut m: [f64; 4] =
            std::array::from_fn(|j| if b[j] == 0.0 { 0.0 } else { b[j] / lambda[j] });
        // Exact where d is lost beside rounding, and right where b has no part along that axis.
        let others: f64 = (0..4).filter(|&j| j != lowest).map(|j| m[j] * m[j]).sum();
        m[lowest] = (1.0 - others).max(0.0).sqrt().copysign(m[lowest]);
        let mut mean = (axes * Vector4::from(m)).normalize();
        if mean[3] < 0.0 {
            mean = -mean;
        }
        let frame = turn_of_last_axis(&mean);
        let local = axes.tr_mul(&frame);
        let lambda_matrix = Matrix4::from_diagonal(&lambda.into());
        let p = local.tr_mul(&(lambda_matrix * local));
        let precision = p.fixed_view::<3, 3>(0, 0).into_owned();
        let cross = p.fixed_view::<3, 1>(0, 3).into_owned();
        let slope = precision.cholesky().map_or(Vector3::zeros(), |c| -c.solve(&cross));
        let radial: f64 = (0..4).map(|j| m[j] * m[j] / lambda[j]).sum();
        Self { frame, precision, slope, tau: 1.0 / radial }
    }

    /// Σ⁻¹ in the frame of the point.
    pub(crate) fn form_about_mean(&self) -> Matrix4<f64> {
        self.local().0
    }

    /// P and b about the mean.
    fn local(&self) -> (Matrix4<f64>, Vector4<f64>) {
        let n = self.residual();
        let mut p = n.tr_mul(&(embed(&self.precision) * n));
        p[(3, 3)] += self.tau;
        let b = p.column(3).into_owned();
        (p, b)
    }

    /// (t, r) ↦ t − k r, in the first three rows.
    fn residual(&self) -> Matrix4<f64> {
        let mut n = Matrix4::identity();
        for a in 0..3 {
            n[(a, 3)] = -self.slope[a];
        }
        n[(3, 3)] = 0.0;
        n
    }

    pub(crate) fn form(&self) -> Form {
        let (p, b) = self.local();
        let p = self.frame * p * self.frame.transpose();
        Form { p: (p + p.transpose()) * 0.5, b: self.frame * b }
    }

    /// First and second derivatives of P and b, about the mean.
    fn derivatives(&self) -> Derivatives {
        let (p, _) = self.local();
        let n = self.residual();
        let lambda = embed(&self.precision);
        let mut d = Derivatives {
            turns: [Matrix4::zeros(); 3],
            p,
            first: [Matrix4::zeros(); PARAMETERS],
            residual: n,
            lambda,
        };
        for a in 0..3 {
            // e₄ moves towards tangent a.
            d.turns[a][(a, 3)] = 1.0;
            d.turns[a][(3, a)] = -1.0;
        }
        for (k, &(i, j)) in TRIANGLE.iter().enumerate() {
            d.first[PRECISION + k] = n.tr_mul(&(unit(i, j) * n));
        }
        for a in 0..3 {
            let half = Derivatives::tilt(a).tr_mul(&(lambda * n));
            d.first[SLOPE + a] = half + half.transpose();
        }
        d.first[TAU][(3, 3)] = 1.0;
        d
    }
}

struct Derivatives {
    turns: [Matrix4<f64>; 3],
    p: Matrix4<f64>,
    /// Of P by Λ, k and τ; zero for turns.
    first: [Matrix4<f64>; PARAMETERS],
    residual: Matrix4<f64>,
    lambda: Matrix4<f64>,
}

impl Derivatives {
    /// Of the residual by k_a.
    fn tilt(a: usize) -> Matrix4<f64> {
        let mut m = Matrix4::zeros();
        m[(a, 3)] = -1.0;
        m
    }

    /// Of (P, b) = (e^Ω P e^−Ω, e^Ω P e₄).
    fn first(&self, i: usize) -> (Matrix4<f64>, Vector4<f64>) {
        if i < PRECISION {
            let turn = &self.turns[i];
            (commutator(turn, &self.p), turn * self.p.column(3))
        } else {
            (self.first[i], self.first[i].column(3).into_owned())
        }
    }

    /// For i ≥ j.
    fn second(&self, i: usize, j: usize) -> (Matrix4<f64>, Vector4<f64>) {
        if i < PRECISION {
            let (a, b) = (&self.turns[i], &self.turns[j]);
            let twice =
                commutator(a, &commutator(b, &self.p)) + commutator(b, &commutator(a, &self.p));
            (twice * 0.5, (a * b + b * a) * self.p.column(3) * 0.5)
        } else if j < PRECISION {
            let turn = &self.turns[j];
            (commutator(turn, &self.first[i]), turn * self.first[i].column(3))
        } else {
            let half = match (i, j) {
                (SLOPE..TAU, SLOPE..TAU) => {
                    Self::tilt(i - SLOPE).tr_mul(&(self.lambda * Self::tilt(j - SLOPE)))
                }
                (SLOPE..TAU, PRECISION..SLOPE) => {
                    let (a, b) = TRIANGLE[j - PRECISION];
                    Self::tilt(i - SLOPE).tr_mul(&(unit(a, b) * self.residual))
                }
                _ => Matrix4::zeros(),
            };
            let p = half + half.transpose();
            (p, p.column(3).into_owned())
        }
    }
}

impl Hill for Sample {
    type Place = Point;

    fn survey(&self, place: &Point) -> Evaluation {
        let natural = self.evaluate(&self.parameters(&place.form()));
        let d = place.derivatives();
        let image = |(p, b): (Matrix4<f64>, Vector4<f64>)| {
            let p = place.frame * p * place.frame.transpose();
            self.parameters(&Form { p, b: place.frame * b })
        };
        let mut jacobian = Square::zeros();
        for i in 0..PARAMETERS {
            jacobian.set_column(i, &image(d.first(i)));
        }
        let mut hessian = jacobian.tr_mul(&(natural.hessian * jacobian));
        for i in 0..PARAMETERS {
            for j in 0..=i {
                let bend = natural.gradient.dot(&image(d.second(i, j)));
                hessian[(i, j)] += bend;
                if i != j {
                    hessian[(j, i)] += bend;
                }
            }
        }
        Evaluation {
            value: natural.value,
            gradient: jacobian.tr_mul(&natural.gradient),
            hessian,
            information: jacobian.tr_mul(&(natural.information * jacobian)),
        }
    }

    fn walk(&self, place: &Point, step: &Vector) -> Option<Point> {
        let turn = step.fixed_rows::<3>(0).into_owned();
        let angle = turn.norm();
        let mut next = *place;
        if angle > 0.0 {
            // Not more than a quarter turn, beyond which the quadratic model means nothing.
            if !(angle < 1.5) {
                return None;
            }
            let (sin, cos) = libm::sincos(angle);
            let along = turn / angle;
            let mean = Vector4::new(along[0] * sin, along[1] * sin, along[2] * sin, cos);
            next.frame *= turn_of_last_axis(&mean);
        }
        for (k, &(i, j)) in TRIANGLE.iter().enumerate() {
            next.precision[(i, j)] += step[PRECISION + k];
            next.precision[(j, i)] = next.precision[(i, j)];
        }
        next.slope += step.fixed_rows::<3>(SLOPE);
        next.tau += step[TAU];
        next.precision.cholesky().is_some().then_some(next)
    }
}

/// P and b themselves as coordinates.
pub(crate) struct Natural<'a>(pub(crate) &'a Sample);

impl Hill for Natural<'_> {
    type Place = Vector;

    fn survey(&self, place: &Vector) -> Evaluation {
        self.0.evaluate(place)
    }

    fn walk(&self, place: &Vector, step: &Vector) -> Option<Vector> {
        Some(place + step)
    }
}

/// The rotation in the plane of e₄ and m that takes e₄ to m, for m₄ > −1.
pub(crate) fn turn_of_last_axis(m: &Vector4<f64>) -> Matrix4<f64> {
    let mut sum = *m;
    sum[3] += 1.0;
    let mut turn = Matrix4::identity() - sum * sum.transpose() / sum[3];
    let mut last = turn.column_mut(3);
    last += m * 2.0;
    turn
}

fn embed(m: &Matrix3<f64>) -> Matrix4<f64> {
    let mut out = Matrix4::zeros();
    out.fixed_view_mut::<3, 3>(0, 0).copy_from(m);
    out
}

/// Derivative of a symmetric matrix by its entry (i, j).
fn unit(i: usize, j: usize) -> Matrix4<f64> {
    let mut m = Matrix4::zeros();
    m[(i, j)] = 1.0;
    m[(j, i)] = 1.0;
    m
}

fn commutator(a: &Matrix4<f64>, b: &Matrix4<f64>) -> Matrix4<f64> {
    a * b - b * a
}
