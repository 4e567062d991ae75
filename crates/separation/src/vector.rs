//! As many numbers as there are lanes, in a register where the machine has one that long.
//!
//! `pulp` is the layer of vector instructions: a kernel ([`pulp::WithSimd`]) is compiled for each set of
//! them. Each operation is rounded in one way only and none is fused, so that every machine gets the same
//! values, with any number of lanes.

use std::ops::{Add, Mul, Neg, Sub};

pub(crate) use pulp::{Simd, WithSimd};

use crate::lanes::Lanes;

/// Lanes in a register of the instructions `S`, which has room for so many.
#[derive(Clone, Copy)]
pub(crate) struct Register<S: Simd>(S, S::f64s);

impl<S: Simd> Register<S> {
    #[inline(always)]
    pub(crate) fn load<const W: usize>(simd: S, x: &Lanes<W>) -> Self {
        Self(simd, S::as_simd_f64s(&x.0).0[0])
    }

    #[inline(always)]
    pub(crate) fn splat(simd: S, x: f64) -> Self {
        Self(simd, simd.splat_f64s(x))
    }

    #[inline(always)]
    pub(crate) fn store<const W: usize>(self) -> Lanes<W> {
        let mut lanes = Lanes::ZERO;
        S::as_mut_simd_f64s(&mut lanes.0).0[0] = self.1;
        lanes
    }
}

impl<S: Simd> Add for Register<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(self.0, self.0.add_f64s(self.1, other.1))
    }
}

impl<S: Simd> Sub for Register<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(self.0, self.0.sub_f64s(self.1, other.1))
    }
}

impl<S: Simd> Mul for Register<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(self.0, self.0.mul_f64s(self.1, other.1))
    }
}

impl<S: Simd> Neg for Register<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0, self.0.neg_f64s(self.1))
    }
}

/// The vector instructions that this machine has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Machine {
    #[cfg(target_arch = "x86_64")]
    v3: Option<pulp::x86::V3>,
    #[cfg(target_arch = "x86_64")]
    v4: Option<pulp::x86::V4>,
}

impl Machine {
    /// Any machine.
    #[cfg(test)]
    pub(crate) const BASELINE: Self = Self {
        #[cfg(target_arch = "x86_64")]
        v3: None,
        #[cfg(target_arch = "x86_64")]
        v4: None,
    };

    pub(crate) fn new() -> Self {
        Self {
            #[cfg(target_arch = "x86_64")]
            v3: pulp::x86::V3::try_new(),
            #[cfg(target_arch = "x86_64")]
            v4: pulp::x86::V4::try_new(),
        }
    }

    /// Whether it has registers of eight numbers (AVX-512). Four are no slower in arrays.
    pub(crate) fn has_eight(self) -> bool {
        #[cfg(target_arch = "x86_64")]
        return self.v4.is_some();
        #[cfg(not(target_arch = "x86_64"))]
        return false;
    }

    /// Runs a kernel of one, four or eight lanes, in arrays where no register is that long.
    pub(crate) fn run<const W: usize>(self, kernel: impl WithSimd<Output = ()>) {
        const { assert!(W == 1 || W == 4 || W == 8, "lanes that there are instructions for") };
        if W == 1 {
            return Simd::vectorize(pulp::Scalar, kernel);
        }
        if W == 4 {
            #[cfg(target_arch = "x86_64")]
            if let Some(simd) = self.v3 {
                return Simd::vectorize(simd, kernel);
            }
            return Simd::vectorize(pulp::Scalar256b, kernel);
        }
        #[cfg(target_arch = "x86_64")]
        if let Some(simd) = self.v4 {
            return Simd::vectorize(simd, kernel);
        }
        Simd::vectorize(pulp::Scalar512b, kernel);
    }
}
