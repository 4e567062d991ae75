//! Moments of quartic forms of a half turn (z, w), of laws that are the same for any signs of z: by those of the squares Z = z².

use nalgebra::{Matrix4, SMatrix, SVector, Vector4};

use super::nodes::{Rule, Turns};

/// Powers of Z₁, Z₂ and Z₃ in quadratic polynomials of them, but for the constant part.
const QUADRATIC: [[usize; 3]; 9] = [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
    [2, 0, 0],
    [1, 1, 0],
    [1, 0, 1],
    [0, 2, 0],
    [0, 1, 1],
    [0, 0, 2],
];
/// Where the products of two Z are among these.
const PRODUCTS: [[usize; 3]; 3] = [[3, 4, 5], [4, 6, 7], [5, 7, 8]];
/// Powers in linear polynomials.
const LINEAR: [[usize; 3]; 4] = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]];

/// The other two of three axes, in cyclic order.
fn others(axis: usize) -> [usize; 2] {
    [(axis + 1) % 3, (axis + 2) % 3]
}

/// A quadratic form of (z, w): with W = w² = 1 − Σ Z, linear in Z but for the products of two that change their signs.
#[derive(Clone, Copy)]
pub(super) struct Element {
    /// Of 1, Z₁, Z₂ and Z₃.
    even: Vector4<f64>,
    /// Of the products of two z, by the axis that is left out.
    pairs: [f64; 3],
    /// Of w zₚ.
    turns: [f64; 3],
}

impl Element {
    /// Σ_pq b_p S_pq a_q with S, the rotation matrix of (z, w).
    pub(super) fn of(b: [f64; 3], a: [f64; 3]) -> Self {
        let each: [f64; 3] = std::array::from_fn(|p| b[p] * a[p]);
        let all = each[0] + each[1] + each[2];
        let [x, y, z] = each.map(|own| 2.0 * (own - all));
        let across = [0, 1, 2].map(|axis| {
            let [p, q] = others(axis);
            (2.0 * b[p] * a[q], 2.0 * b[q] * a[p])
        });
        Self {
            even: Vector4::new(all, x, y, z),
            pairs: across.map(|(one, other)| one + other),
            turns: across.map(|(one, other)| other - one),
        }
    }

    /// The product of two, but for what is constant.
    pub(super) fn times(&self, other: &Self) -> Quartic {
        let Self { even: e, pairs: p, turns: t } = self;
        let Self { even: f, pairs: q, turns: u } = other;
        let mut product = Quartic {
            even: SVector::zeros(),
            pairs: std::array::from_fn(|axis| e * q[axis] + f * p[axis]),
            turns: std::array::from_fn(|axis| e * u[axis] + f * t[axis]),
            all: 0.0,
        };
        for i in 0..3 {
            for j in 0..3 {
                // W = 1 − Σ Z.
                product.even[PRODUCTS[i][j]] += e[i + 1] * f[j + 1] - t[i] * u[i];
            }
            let [j, k] = others(i);
            product.even[PRODUCTS[j][k]] += p[i] * q[i];
            product.even[i] += e[0] * f[i + 1] + e[i + 1] * f[0] + t[i] * u[i];
            let of_w = t[j] * u[k] + t[k] * u[j];
            product.pairs[i] += Vector4::new(of_w, -of_w, -of_w, -of_w);
            product.pairs[i][i + 1] += p[j] * q[k] + p[k] * q[j];
            product.turns[i][j + 1] += t[j] * q[k] + p[k] * u[j];
            product.turns[i][k + 1] += t[k] * q[j] + p[j] * u[k];
            product.all += t[i] * q[i] + p[i] * u[i];
        }
        product
    }
}

/// A quartic form of (z, w), but for what is constant: parts of which no two have the same signs.
#[derive(Clone, Copy)]
pub(super) struct Quartic {
    even: SVector<f64, 9>,
    /// What linear polynomials multiply the products of two z, by the axis that is left out.
    pairs: [Vector4<f64>; 3],
    /// And what they multiply w zₚ.
    turns: [Vector4<f64>; 3],
    /// Of w z₁ z₂ z₃.
    all: f64,
}

impl Quartic {
    pub(super) fn dot(&self, other: &Self) -> f64 {
        let dots = |a: &[Vector4<f64>; 3], b: &[Vector4<f64>; 3]| -> f64 {
            a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
        };
        self.even.dot(&other.even)
            + dots(&self.pairs, &other.pairs)
            + dots(&self.turns, &other.turns)
            + self.all * other.all
    }
}

/// Covariances of the monomials of quartic forms. Those that change their signs have no mean, and none with others.
pub(super) struct SquareMoments {
    means: SVector<f64, 9>,
    even: SMatrix<f64, 9, 9>,
    pairs: [Matrix4<f64>; 3],
    turns: [Matrix4<f64>; 3],
    all: f64,
}

impl SquareMoments {
    /// Of turns, at the nodes of a rule.
    pub(super) fn of(turns: &Turns, rule: Rule) -> Self {
        let mut sums = [[[0.0; 5]; 5]; 5];
        turns.each_mirrored(rule, |node| {
            let (z, weight) = node.squares();
            let mut x = weight;
            for (a, sums) in sums.iter_mut().enumerate() {
                let mut y = x;
                for (b, sums) in sums[..5 - a].iter_mut().enumerate() {
                    let mut product = y;
                    for sum in &mut sums[..5 - a - b] {
                        *sum += product;
                        product *= z[2];
                    }
                    y *= z[1];
                }
                x *= z[0];
            }
        });
        let expected = |of: &[[usize; 3]]| {
            let [a, b, c] =
                [0, 1, 2].map(|axis| of.iter().map(|powers| powers[axis]).sum::<usize>());
            sums[a][b][c] / sums[0][0][0]
        };
        // With W = 1 − Σ Z as a factor.
        let with_w = |of: [[usize; 3]; 3]| {
            let more = LINEAR[1..].iter().map(|z| expected(&[of[0], of[1], of[2], *z]));
            expected(&of) - more.sum::<f64>()
        };
        let means = SVector::from_fn(|i, _| expected(&[QUADRATIC[i]]));
        Self {
            even: SMatrix::from_fn(|i, j| {
                expected(&[QUADRATIC[i], QUADRATIC[j]]) - means[i] * means[j]
            }),
            pairs: std::array::from_fn(|axis| {
                let [p, q] = others(axis).map(|axis| LINEAR[axis + 1]);
                Matrix4::from_fn(|i, j| expected(&[p, q, LINEAR[i], LINEAR[j]]))
            }),
            turns: std::array::from_fn(|axis| {
                Matrix4::from_fn(|i, j| with_w([LINEAR[axis + 1], LINEAR[i], LINEAR[j]]))
            }),
            all: with_w([LINEAR[1], LINEAR[2], LINEAR[3]]),
            means,
        }
    }

    pub(super) fn mean(&self, form: &Quartic) -> f64 {
        self.means.dot(&form.even)
    }

    /// What a form has to be multiplied with for its covariance with another.
    pub(super) fn against(&self, form: &Quartic) -> Quartic {
        Quartic {
            even: self.even * form.even,
            pairs: std::array::from_fn(|axis| self.pairs[axis] * form.pairs[axis]),
            turns: std::array::from_fn(|axis| self.turns[axis] * form.turns[axis]),
            all: self.all * form.all,
        }
    }
}
