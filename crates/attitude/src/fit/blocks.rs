//! Sums over a sample by blocks of attitudes, in loops that the compiler turns into vector instructions.

use nalgebra::Matrix4;
use std::array;

/// Attitudes that are taken at a time: few enough for the first-level cache.
pub(super) const BLOCK: usize = 64;
/// Sums that each attitude goes to one of, in turn: as many as the widest vector unit has lanes.
pub(super) const LANES: usize = 8;

/// A number of each attitude of a block.
pub(super) type Block = [f64; BLOCK];
/// What adds up to a sum.
pub(super) type Sum = [f64; LANES];
/// What adds up to a symmetric matrix, for i ≥ j.
pub(super) type Squares = [[Sum; 4]; 4];

/// The coordinates of a sample by blocks, each with how many attitudes it has. Beyond the last one all is zero.
#[inline(always)]
pub(super) fn blocks(columns: &[Vec<f64>; 4]) -> impl Iterator<Item = ([Block; 4], usize)> {
    let points = columns[0].len();
    (0..points).step_by(BLOCK).map(move |start| {
        let end = (start + BLOCK).min(points);
        let mut u = [[0.0; BLOCK]; 4];
        for (u, column) in u.iter_mut().zip(columns) {
            u[..end - start].copy_from_slice(&column[start..end]);
        }
        (u, end - start)
    })
}

/// A linear map of coordinates.
#[inline(always)]
pub(super) fn map(map: &Matrix4<f64>, u: &[Block; 4]) -> [Block; 4] {
    array::from_fn(|j| product(&[map[(j, 0)], map[(j, 1)], map[(j, 2)], map[(j, 3)]], u))
}

/// A linear form of coordinates.
#[inline(always)]
pub(super) fn product(form: &[f64; 4], u: &[Block; 4]) -> Block {
    let [a, b, c, d] = form;
    array::from_fn(|i| a * u[0][i] + b * u[1][i] + (c * u[2][i] + d * u[3][i]))
}

/// Adds the values of a block: value i to lane i mod 8, on any machine.
#[inline(always)]
pub(super) fn add(sum: &mut Sum, values: &Block) {
    for values in values.chunks_exact(LANES) {
        for (sum, value) in sum.iter_mut().zip(values) {
            *sum += value;
        }
    }
}

/// Adds the products of two blocks likewise.
#[inline(always)]
pub(super) fn add_products(sum: &mut Sum, a: &Block, b: &Block) {
    for (a, b) in a.chunks_exact(LANES).zip(b.chunks_exact(LANES)) {
        for (sum, (a, b)) in sum.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
}

/// Adds v vᵀ times the weight of each attitude, for i ≥ j.
#[inline(always)]
pub(super) fn add_squares(sums: &mut Squares, v: &[Block; 4], weights: &Block) {
    for i in 0..4 {
        let weighted: Block = array::from_fn(|k| v[i][k] * weights[k]);
        for j in 0..=i {
            add_products(&mut sums[i][j], &weighted, &v[j]);
        }
    }
}

/// The symmetric matrix of what has been added for i ≥ j.
#[inline(always)]
pub(super) fn symmetric(sums: &Squares) -> Matrix4<f64> {
    Matrix4::from_fn(|i, j| total(&sums[i.max(j)][i.min(j)]))
}

/// What has been added.
#[inline(always)]
pub(super) fn total(sum: &Sum) -> f64 {
    sum.iter().sum()
}
