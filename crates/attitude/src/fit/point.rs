//! The law as an engineer sees it: a mean attitude, the covariance of turns about it, and what is
//! radial. Coordinates on the same family as P and b.

use nalgebra::{Matrix3, Matrix4, SMatrix, SVector, Vector3, Vector4};

use super::{
    centered::{Centered, PAIRS, PRODUCTS, STATISTICS, Statistics, turn_of_last_axis},
    climb::{Evaluation, Hill, restrict},
    likelihood::Sample,
    rounding::sign,
};

/// The least that a search for laws about an axis begins with for a precision, over the sample's.
const LEAST_PRECISION: f64 = 0.01;
/// The least that τ or an entry on the diagonal of L falls to in one step, over what it was: from zero
/// there is no way back.
const LEAST_ROOT: f64 = 0.1;
/// Variances of statistics of order one that are below this are rounding.
const ROUNDING: f64 = 1e-14;
/// Number of parameters of a law.
pub(crate) const PARAMETERS: usize = 13;

pub(crate) type Vector = SVector<f64, PARAMETERS>;
pub(crate) type Square = SMatrix<f64, PARAMETERS, PARAMETERS>;

/// Entries of Λ, in the order of its parameters.
pub(crate) const TRIANGLE: [(usize, usize); 6] = [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)];

/// First coordinates of L, where Λ = L Lᵀ, of k and of τ; those of the mean come before. In L the edge
/// of the family, where Λ is singular, is a place like any other, and so can be a maximum.
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
    pub(crate) fn of(law: &Centered) -> Self {
        let (lambda, m) = law.gaussian();
        let mean = law.axes * m;
        let sign = sign(mean[3]);
        let frame = turn_of_last_axis(&(mean * sign));
        let local = law.axes.tr_mul(&frame) * sign;
        let p = local.tr_mul(&(Matrix4::from_diagonal(&lambda.into()) * local));
        // Variances over the largest, which may be infinite.
        let least = lambda.into_iter().fold(f64::INFINITY, f64::min);
        let shares = Vector4::from(lambda.map(|l| if l > least { least / l } else { 1.0 }));
        let weighted = shares.component_mul(&m);
        let radial = weighted.dot(&m);
        Self {
            frame,
            precision: p.fixed_view::<3, 3>(0, 0).into_owned(),
            slope: local.tr_mul(&weighted).fixed_rows::<3>(0) / radial,
            tau: least / radial,
        }
    }

    /// A law whose axes are those of the sample and whose b lies along one of them, with the mean along
    /// that axis; the nearest such law where the mean is another.
    /// `scale` are the root mean squares of the sample along its axes.
    pub(crate) fn about_axis(law: &Centered, axis: usize, scale: &[f64; 4]) -> Self {
        let tau = law.linear()[axis].abs();
        let frame = turn_of_last_axis(&Vector4::ith(axis, 1.0));
        let precisions = Vector3::from_fn(|a, _| {
            let own = if a == axis { 3 } else { a };
            (law.lambda[own] - law.lambda[axis] + tau).max(LEAST_PRECISION / scale[own].powi(2))
        });
        Self { frame, precision: Matrix3::from_diagonal(&precisions), slope: Vector3::zeros(), tau }
    }

    /// The law, in the frame of the sample.
    pub(crate) fn law(&self) -> Centered {
        let n = self.residual();
        let across = n.tr_mul(&(embed(&self.precision) * n));
        let slope = self.slope;
        let chord = Vector4::new(slope[0], slope[1], slope[2], 1.0);
        Centered::across_chord(&self.frame, &across, &chord, self.tau)
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

    /// L of Λ = L Lᵀ, lower triangular; Λ may be singular.
    fn root(&self) -> Matrix3<f64> {
        let mut root = Matrix3::zeros();
        for j in 0..3 {
            for i in j..3 {
                let known: f64 = (0..j).map(|k| root[(i, k)] * root[(j, k)]).sum();
                let left = self.precision[(i, j)] - known;
                let pivot: f64 = root[(j, j)];
                root[(i, j)] = if i == j {
                    left.max(0.0).sqrt()
                } else if pivot > 0.0 {
                    left / pivot
                } else {
                    0.0
                };
            }
        }
        root
    }

    /// The derivatives of Λ by the entries of L.
    pub(crate) fn factors(&self) -> [Matrix3<f64>; TRIANGLE.len()] {
        let root = self.root();
        TRIANGLE.map(|(i, j)| {
            let half = Vector3::ith(i, 1.0) * root.column(j).transpose();
            half + half.transpose()
        })
    }

    /// First and second derivatives of P and b, about the mean.
    fn derivatives(&self) -> Derivatives {
        let (p, _) = self.local();
        let n = self.residual();
        let lambda = embed(&self.precision);
        let factors = self.factors();
        let mut d = Derivatives {
            turns: [Matrix4::zeros(); 3],
            p,
            first: [Matrix4::zeros(); PARAMETERS],
            residual: n,
            lambda,
            factors,
        };
        for a in 0..3 {
            // e₄ moves towards tangent a.
            d.turns[a][(a, 3)] = 1.0;
            d.turns[a][(3, a)] = -1.0;
        }
        for (first, factor) in d.first[PRECISION..].iter_mut().zip(&factors) {
            *first = n.tr_mul(&(embed(factor) * n));
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
    /// Of P by L, k and τ; zero for turns.
    first: [Matrix4<f64>; PARAMETERS],
    residual: Matrix4<f64>,
    lambda: Matrix4<f64>,
    /// Of Λ by L.
    factors: [Matrix3<f64>; TRIANGLE.len()],
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
                    let factor = embed(&self.factors[j - PRECISION]);
                    Self::tilt(i - SLOPE).tr_mul(&(factor * self.residual))
                }
                (PRECISION..SLOPE, PRECISION..SLOPE) => {
                    let ((a, c), (b, d)) = (TRIANGLE[i - PRECISION], TRIANGLE[j - PRECISION]);
                    let mut bend = Matrix4::zeros();
                    if c == d {
                        bend[(a, b)] = 1.0;
                    }
                    self.residual.tr_mul(&(bend * self.residual))
                }
                _ => Matrix4::zeros(),
            };
            let p = half + half.transpose();
            (p, p.column(3).into_owned())
        }
    }
}

impl Hill<PARAMETERS> for Sample {
    type Place = Point;

    fn survey(&self, place: &Point) -> Evaluation<PARAMETERS> {
        let law = place.law();
        let statistics = self.evaluate(&law);
        let d = place.derivatives();
        let local = place.frame.tr_mul(&law.axes);
        let center = Vector4::from(law.center);
        let widths = Vector4::from(law.roots().map(|r| 1.0 / r));
        // Derivatives of P and b as factors of the law's statistics.
        let image = |(p, b): (Matrix4<f64>, Vector4<f64>)| {
            let p = local.tr_mul(&(p * local));
            let linear = (local.tr_mul(&b) - p * center).component_mul(&widths);
            let mut factors = Statistics::zeros();
            factors.fixed_rows_mut::<4>(0).copy_from(&linear);
            for (k, &(i, j)) in PAIRS.iter().enumerate() {
                factors[PRODUCTS + k] = p[(i, j)] * (widths[i] * widths[j]);
            }
            factors
        };
        let mut jacobian = SMatrix::<f64, STATISTICS, PARAMETERS>::zeros();
        for i in 0..PARAMETERS {
            jacobian.set_column(i, &image(d.first(i)));
        }
        let mut hessian = jacobian.tr_mul(&(statistics.hessian * jacobian));
        for i in 0..PARAMETERS {
            for j in 0..=i {
                let bend = statistics.gradient.dot(&image(d.second(i, j)));
                hessian[(i, j)] += bend;
                if i != j {
                    hessian[(j, i)] += bend;
                }
            }
        }
        Evaluation {
            value: statistics.value,
            gradient: jacobian.tr_mul(&statistics.gradient),
            hessian,
            information: jacobian.tr_mul(&(statistics.information * jacobian)),
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
        let mut root = place.root();
        for (k, &(i, j)) in TRIANGLE.iter().enumerate() {
            let next = root[(i, j)] + step[PRECISION + k];
            root[(i, j)] = if i == j { next.abs().max(LEAST_ROOT * root[(i, i)]) } else { next };
        }
        next.precision = root * root.transpose();
        next.slope += step.fixed_rows::<3>(SLOPE);
        next.tau = (place.tau + step[TAU]).max(LEAST_ROOT * place.tau);
        Some(next)
    }
}

/// Every law, by shears and shifts of the one that is climbed from, in coordinates in which that has
/// unit variance: there it keeps its digits however narrow it is.
pub(crate) struct Sheared<'a>(pub(crate) &'a Sample);

impl Hill<STATISTICS> for Sheared<'_> {
    type Place = Centered;

    fn survey(&self, place: &Centered) -> Evaluation<STATISTICS> {
        let factors = self.0.evaluate(place);
        // The statistic that has most of what depends on the others is not moved along, and none of
        // which nothing but rounding is left.
        let dependence = place.dependence();
        let variance = |k: usize| factors.information[(k, k)];
        let part = |k: usize| dependence[k].powi(2) * variance(k).max(ROUNDING);
        let last = (0..STATISTICS).fold(0, |l, k| if part(k) > part(l) { k } else { l });
        let free = std::array::from_fn(|k| k != last && variance(k) > ROUNDING);
        restrict(place.by_steps(&factors), free)
    }

    fn walk(&self, place: &Centered, step: &Statistics) -> Option<Centered> {
        place.sheared(step).filter(Centered::is_wide_enough)
    }
}

fn embed(m: &Matrix3<f64>) -> Matrix4<f64> {
    let mut out = Matrix4::zeros();
    out.fixed_view_mut::<3, 3>(0, 0).copy_from(m);
    out
}

fn commutator(a: &Matrix4<f64>, b: &Matrix4<f64>) -> Matrix4<f64> {
    a * b - b * a
}
