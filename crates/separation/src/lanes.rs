//! Several numbers that go through the same operations: one lane for each run.
//!
//! Sums, products, quotients and square roots only, each correctly rounded and never fused: a lane
//! holds the same bits whatever the other lanes hold and however many there are.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// One number for each run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lanes(pub(crate) [f64; WIDTH]);

impl Lanes {
    pub(crate) const ZERO: Self = Self([0.0; WIDTH]);

    #[inline(always)]
    pub(crate) fn splat(x: f64) -> Self {
        Self([x; WIDTH])
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
        impl $operation for Lanes {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.zip(other, |a, b| a $symbol b)
            }
        }
    )*};
}
lanewise!(Add add +, Sub sub -, Mul mul *, Div div /);

impl Mul<f64> for Lanes {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        self.map(|a| a * factor)
    }
}

impl Neg for Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

impl AddAssign for Lanes {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Lanes {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

/// Runs that are computed at a time.
pub(crate) const WIDTH: usize = 4;

/// A vector, and a matrix by rows.
pub(crate) type V3 = [Lanes; 3];
pub(crate) type M3 = [V3; 3];

#[inline(always)]
pub(crate) fn add<const N: usize>(a: [Lanes; N], b: [Lanes; N]) -> [Lanes; N] {
    std::array::from_fn(|i| a[i] + b[i])
}

#[inline(always)]
pub(crate) fn scale<const N: usize>(a: [Lanes; N], s: Lanes) -> [Lanes; N] {
    a.map(|x| x * s)
}

#[inline(always)]
pub(crate) fn dot(a: &V3, b: &V3) -> Lanes {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(crate) fn times(m: &M3, v: &V3) -> V3 {
    [dot(&m[0], v), dot(&m[1], v), dot(&m[2], v)]
}
