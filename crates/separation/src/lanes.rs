//! Several numbers that go through the same operations: one lane for a run alone, four for a batch.
//!
//! Sums, products, quotients and square roots only, each correctly rounded and never fused: a lane
//! holds the same bits whatever the other lanes hold and however many there are.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// One number for each of `L` runs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lanes<const L: usize>(pub(crate) [f64; L]);

impl<const L: usize> Lanes<L> {
    pub(crate) const ZERO: Self = Self([0.0; L]);

    #[inline(always)]
    pub(crate) fn splat(x: f64) -> Self {
        Self([x; L])
    }

    // Loops, for the library's functions are not always inlined.
    #[inline(always)]
    pub(crate) fn map(mut self, f: impl Fn(f64) -> f64) -> Self {
        for x in &mut self.0 {
            *x = f(*x);
        }
        self
    }

    #[inline(always)]
    pub(crate) fn zip(mut self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        for (x, y) in self.0.iter_mut().zip(&other.0) {
            *x = f(*x, *y);
        }
        self
    }

    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        self.map(f64::sqrt)
    }
}

macro_rules! lanewise {
    ($($operation:ident $method:ident $symbol:tt),*) => {$(
        impl<const L: usize> $operation for Lanes<L> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.zip(other, |a, b| a $symbol b)
            }
        }
    )*};
}
lanewise!(Add add +, Sub sub -, Mul mul *, Div div /);

impl<const L: usize> Mul<f64> for Lanes<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        self.map(|a| a * factor)
    }
}

impl<const L: usize> Neg for Lanes<L> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

impl<const L: usize> AddAssign for Lanes<L> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<const L: usize> SubAssign for Lanes<L> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

/// Lanes that springs are computed in: runs of a batch, or springs of a run alone.
pub(crate) const WIDTH: usize = 4;

/// A vector, and a matrix by rows.
pub(crate) type V3<const L: usize> = [Lanes<L>; 3];
pub(crate) type M3<const L: usize> = [V3<L>; 3];

#[inline(always)]
pub(crate) fn add<const N: usize, const L: usize>(
    a: [Lanes<L>; N],
    b: [Lanes<L>; N],
) -> [Lanes<L>; N] {
    std::array::from_fn(|i| a[i] + b[i])
}

#[inline(always)]
pub(crate) fn scale<const N: usize, const L: usize>(
    a: [Lanes<L>; N],
    s: Lanes<L>,
) -> [Lanes<L>; N] {
    a.map(|x| x * s)
}

#[inline(always)]
pub(crate) fn dot<const L: usize>(a: &V3<L>, b: &V3<L>) -> Lanes<L> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(crate) fn times<const L: usize>(m: &M3<L>, v: &V3<L>) -> V3<L> {
    [dot(&m[0], v), dot(&m[1], v), dot(&m[2], v)]
}
