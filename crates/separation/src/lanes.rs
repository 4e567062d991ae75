//! Several numbers that go through the same operations: one lane for each run.
//!
//! Sums, products, quotients and square roots only, each correctly rounded and never fused: a lane
//! holds the same bits whatever the other lanes hold and however many there are.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// One number for each run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lanes<const W: usize>(pub(crate) [f64; W]);

impl<const W: usize> Lanes<W> {
    pub(crate) const ZERO: Self = Self([0.0; W]);

    #[inline(always)]
    pub(crate) fn splat(x: f64) -> Self {
        Self([x; W])
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
        impl<const W: usize> $operation for Lanes<W> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.zip(other, |a, b| a $symbol b)
            }
        }
    )*};
}
lanewise!(Add add +, Sub sub -, Mul mul *, Div div /);

impl<const W: usize> Mul<f64> for Lanes<W> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        self.map(|a| a * factor)
    }
}

impl<const W: usize> Neg for Lanes<W> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

impl<const W: usize> AddAssign for Lanes<W> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<const W: usize> SubAssign for Lanes<W> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

/// A vector, and a matrix by rows.
pub(crate) type V3<const W: usize> = [Lanes<W>; 3];
pub(crate) type M3<const W: usize> = [V3<W>; 3];

#[inline(always)]
pub(crate) fn add<const W: usize, const N: usize>(
    a: [Lanes<W>; N],
    b: [Lanes<W>; N],
) -> [Lanes<W>; N] {
    std::array::from_fn(|i| a[i] + b[i])
}

#[inline(always)]
pub(crate) fn scale<const W: usize, const N: usize>(
    a: [Lanes<W>; N],
    s: Lanes<W>,
) -> [Lanes<W>; N] {
    a.map(|x| x * s)
}

#[inline(always)]
pub(crate) fn dot<const W: usize>(a: &V3<W>, b: &V3<W>) -> Lanes<W> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(crate) fn times<const W: usize>(m: &M3<W>, v: &V3<W>) -> V3<W> {
    [dot(&m[0], v), dot(&m[1], v), dot(&m[2], v)]
}
