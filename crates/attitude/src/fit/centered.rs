//! A law exp(−½ Σ λ_j (v_j − c_j)²) on the sphere, its coordinates of unit variance
//! w_j = √λ_j (v_j − c_j), and the steps of a search in them.

use nalgebra::{Matrix4, SMatrix, SVector, Vector4};

use super::{SMALLEST_VARIANCE, climb::Evaluation, rounding::end};
use crate::{fisher_bingham::centring_shift, jacobi};

/// The law is ∝ exp of a linear combination of w_i, −½ w_i² and −w_i w_j. As |v| = 1 one of the 14
/// depends on the others.
pub(crate) const STATISTICS: usize = 14;
/// The first of the products.
pub(crate) const PRODUCTS: usize = 4;
/// The products, in their order.
pub(crate) const PAIRS: [(usize, usize); 10] =
    [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2), (3, 0), (3, 1), (3, 2), (3, 3)];

/// Two maxima of a density whose logarithms differ by no more than twice this are equally great.
const AS_GREAT: f64 = 1e-6;

pub(crate) type Statistics = SVector<f64, STATISTICS>;

/// The density is ∝ exp(−½ Σ λ_j (v_j − c_j)²) in v = Vᵀy, with λ ≥ 1 and |c| ≤ 1, y in the frame of
/// the sample. Principal axes and precisions hold laws that are narrow across one direction and wide
/// along another, which the entries of Σ⁻¹ do not.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Centered {
    /// V.
    pub(crate) axes: Matrix4<f64>,
    pub(crate) lambda: [f64; 4],
    pub(crate) center: [f64; 4],
}

impl Centered {
    /// exp(−½ Σ precisions·v² + bᵀv). Precisions may have any number added to all of them.
    pub(crate) fn new(axes: Matrix4<f64>, precisions: [f64; 4], b: [f64; 4]) -> Self {
        let floor = precisions.into_iter().fold(f64::INFINITY, f64::min);
        let above = precisions.map(|p| p - floor);
        let shift = centring_shift(above, b);
        let lambda = above.map(|p| p + shift);
        Self { axes, lambda, center: std::array::from_fn(|j| b[j] / lambda[j]) }
    }

    /// exp(−½ yᵀPy + bᵀy).
    pub(crate) fn of(p: &Matrix4<f64>, b: &Vector4<f64>) -> Self {
        // Made definite by a shift that is small where the matrix is graded, so that the small
        // eigenvalues keep their digits.
        let mut shift = 0.0_f64;
        for i in 0..4 {
            shift = shift.max(-p[(i, i)]);
        }
        let shifted = p + Matrix4::identity() * (shift + 1.0);
        let off: f64 = (0..3).map(|a| shifted[(a, 3)].powi(2) / shifted[(a, a)]).sum();
        let (values, axes) = jacobi::eigen(&(shifted + Matrix4::identity() * off));
        Self::new(axes, values, axes.tr_mul(b).into())
    }

    /// 1 − |c|².
    pub(crate) fn slack(&self) -> f64 {
        1.0 - self.center.iter().map(|c| c * c).sum::<f64>()
    }

    /// The b of exp(−½ Σ λ v² + bᵀv).
    pub(crate) fn linear(&self) -> [f64; 4] {
        std::array::from_fn(|j| self.lambda[j] * self.center[j])
    }

    /// √λ.
    pub(crate) fn roots(&self) -> [f64; 4] {
        self.lambda.map(f64::sqrt)
    }

    /// The number that the statistics make by |v| = 1: 2 Σ c_j v_j + … is constant, and these are the
    /// factors of w_i, −½ w_i² and −w_i w_j in it.
    pub(crate) fn dependence(&self) -> Statistics {
        let roots = self.roots();
        let mut factors = Statistics::zeros();
        for i in 0..4 {
            factors[i] = self.center[i] / roots[i];
        }
        for (k, &(i, j)) in PAIRS.iter().enumerate() {
            if i == j {
                factors[PRODUCTS + k] = -1.0 / self.lambda[i];
            }
        }
        factors
    }

    /// Of a pair of axes the one of greater precision first.
    fn steeper(&self, (i, j): (usize, usize)) -> (usize, usize) {
        if self.lambda[i] >= self.lambda[j] { (i, j) } else { (j, i) }
    }

    /// The law ∝ exp(−½ |T w − e|²), where `step` holds e and the entries of T − 1. T is triangular in
    /// the order of the precisions, so that a narrow law that is turned stays as narrow.
    pub(crate) fn sheared(&self, step: &Statistics) -> Option<Self> {
        let mut shear = Matrix4::identity();
        for (k, &pair) in PAIRS.iter().enumerate() {
            shear[self.steeper(pair)] += step[PRODUCTS + k];
        }
        let roots = Vector4::from(self.roots());
        let own = shear.tr_mul(&shear);
        // Small eigenvalues of a graded matrix keep their digits.
        let graded = Matrix4::from_fn(|i, j| own[(i, j)] * (roots[i] * roots[j]));
        let (values, turn) = jacobi::eigen(&graded);
        let old = turn.tr_mul(&Vector4::from(self.center));
        let new = turn.tr_mul(&shear.tr_mul(&step.fixed_rows::<4>(0)).component_mul(&roots));
        let b: [f64; 4] = std::array::from_fn(|j| values[j] * old[j] + new[j]);
        b.iter().all(|b| b.is_finite()).then(|| Self::new(self.axes * turn, values, b))
    }

    /// From derivatives by the factors of the statistics to those by the steps of
    /// [`sheared`](Self::sheared).
    pub(crate) fn by_steps(&self, factors: &Evaluation<STATISTICS>) -> Evaluation<STATISTICS> {
        let own = &factors.gradient;
        // (1 + x)² = 1 + 2x + …
        let speed = Statistics::from_fn(|k, _| match k.checked_sub(PRODUCTS) {
            Some(pair) if PAIRS[pair].0 == PAIRS[pair].1 => 2.0,
            Some(_) | None => 1.0,
        });
        let scaled = |m: &SMatrix<f64, STATISTICS, STATISTICS>| {
            SMatrix::from_fn(|k, l| m[(k, l)] * speed[k] * speed[l])
        };
        let mut hessian = scaled(&factors.hessian);
        let place = |i: usize, j: usize| {
            let (i, j) = (i.max(j), i.min(j));
            PRODUCTS + i * (i + 1) / 2 + j
        };
        for (k, &pair) in PAIRS.iter().enumerate() {
            let (row, column) = self.steeper(pair);
            let entry = PRODUCTS + k;
            hessian[(entry, row)] += own[column];
            hessian[(row, entry)] += own[column];
            for (l, &pair) in PAIRS.iter().enumerate() {
                let (other_row, other) = self.steeper(pair);
                if row == other_row {
                    let factor = if column == other { 2.0 } else { 1.0 };
                    hessian[(entry, PRODUCTS + l)] += factor * own[place(column, other)];
                }
            }
        }
        Evaluation {
            value: factors.value,
            gradient: own.component_mul(&speed),
            hessian,
            information: scaled(&factors.information),
        }
    }

    /// Precisions and mean, in v, of the Gaussian in ℝ⁴ that makes the law and has its mean on the
    /// sphere: at the greatest of the density's maxima, of which ±b gives two.
    pub(crate) fn gaussian(&self) -> ([f64; 4], Vector4<f64>) {
        let floor = self.lambda.into_iter().fold(f64::INFINITY, f64::min);
        let values = self.lambda.map(|l| l - floor);
        let b = self.linear();
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
        let lambda = values.map(|v| v + high);
        let mut m: [f64; 4] =
            std::array::from_fn(|j| if b[j] == 0.0 { 0.0 } else { b[j] / lambda[j] });
        // Exact where d is lost beside rounding, and right where b has no part along that axis.
        let others: f64 = (0..4).filter(|&j| j != lowest).map(|j| m[j] * m[j]).sum();
        let along = (1.0 - others).max(0.0).sqrt();
        // Where that part is rounding there are two maxima, and no sign of it.
        let side = if along * b[lowest].abs() > AS_GREAT {
            b[lowest]
        } else {
            end(&self.axes.column(lowest).into_owned())
        };
        m[lowest] = along.copysign(side);
        (lambda, Vector4::from(m).normalize())
    }

    /// Whether no variance of that Gaussian is below the least that a law may have.
    pub(crate) fn is_wide_enough(&self) -> bool {
        self.gaussian().0.into_iter().all(|lambda| lambda * SMALLEST_VARIANCE <= 1.0)
    }

    /// The law of a plane section: exp(−½ |A(y)|² − ½ τ (m·(y − m))²) where A, of precision Λ, is zero
    /// along `chord`, a vector in the frame whose last axis is m.
    pub(crate) fn across_chord(
        frame: &Matrix4<f64>,
        across: &Matrix4<f64>,
        chord: &Vector4<f64>,
        tau: f64,
    ) -> Self {
        // In axes of which the last is the chord, its small precision is apart from the others.
        let turn = turn_of_last_axis(&chord.normalize());
        let mut p = turn.tr_mul(&(across * turn));
        p.row_mut(3).fill(0.0);
        p.column_mut(3).fill(0.0);
        let radial = turn.row(3).transpose();
        p += radial * radial.transpose() * tau;
        let (values, axes) = jacobi::eigen(&((p + p.transpose()) * 0.5));
        let axes = turn * axes;
        let b: [f64; 4] = std::array::from_fn(|j| values[j] * axes[(3, j)]);
        Self::new(frame * axes, values, b)
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
