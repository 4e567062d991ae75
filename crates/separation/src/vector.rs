//! Four numbers that go through the same operations in one instruction, where the machine has such.

use std::ops::{Add, Mul, Neg, Sub};

use crate::lanes::{Lanes, WIDTH};

/// Vector instructions. Each operation is rounded in one way only and none is fused, so that every
/// machine gets the same values.
pub(crate) trait Simd: Copy {
    type Four: Copy;
    fn load(self, x: [f64; WIDTH]) -> Self::Four;
    fn store(self, x: Self::Four) -> [f64; WIDTH];
    fn splat(self, x: f64) -> Self::Four;
    fn add(self, a: Self::Four, b: Self::Four) -> Self::Four;
    fn sub(self, a: Self::Four, b: Self::Four) -> Self::Four;
    fn mul(self, a: Self::Four, b: Self::Four) -> Self::Four;
    fn neg(self, a: Self::Four) -> Self::Four;
}

/// What any machine can do.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Baseline;

impl Simd for Baseline {
    type Four = [f64; WIDTH];
    #[inline(always)]
    fn load(self, x: [f64; WIDTH]) -> Self::Four {
        x
    }
    #[inline(always)]
    fn store(self, x: Self::Four) -> [f64; WIDTH] {
        x
    }
    #[inline(always)]
    fn splat(self, x: f64) -> Self::Four {
        [x; WIDTH]
    }
    #[inline(always)]
    fn add(self, a: Self::Four, b: Self::Four) -> Self::Four {
        std::array::from_fn(|i| a[i] + b[i])
    }
    #[inline(always)]
    fn sub(self, a: Self::Four, b: Self::Four) -> Self::Four {
        std::array::from_fn(|i| a[i] - b[i])
    }
    #[inline(always)]
    fn mul(self, a: Self::Four, b: Self::Four) -> Self::Four {
        std::array::from_fn(|i| a[i] * b[i])
    }
    #[inline(always)]
    fn neg(self, a: Self::Four) -> Self::Four {
        a.map(|x| -x)
    }
}

#[cfg(target_arch = "x86_64")]
impl Simd for pulp::x86::V3 {
    type Four = pulp::f64x4;
    #[inline(always)]
    fn load(self, x: [f64; WIDTH]) -> Self::Four {
        pulp::cast(x)
    }
    #[inline(always)]
    fn store(self, x: Self::Four) -> [f64; WIDTH] {
        pulp::cast(x)
    }
    #[inline(always)]
    fn splat(self, x: f64) -> Self::Four {
        pulp::Simd::splat_f64s(self, x)
    }
    #[inline(always)]
    fn add(self, a: Self::Four, b: Self::Four) -> Self::Four {
        pulp::Simd::add_f64s(self, a, b)
    }
    #[inline(always)]
    fn sub(self, a: Self::Four, b: Self::Four) -> Self::Four {
        pulp::Simd::sub_f64s(self, a, b)
    }
    #[inline(always)]
    fn mul(self, a: Self::Four, b: Self::Four) -> Self::Four {
        pulp::Simd::mul_f64s(self, a, b)
    }
    #[inline(always)]
    fn neg(self, a: Self::Four) -> Self::Four {
        pulp::Simd::neg_f64s(self, a)
    }
}

/// Four numbers in a register.
#[derive(Clone, Copy)]
pub(crate) struct Four<S: Simd>(S, S::Four);

impl<S: Simd> Four<S> {
    #[inline(always)]
    pub(crate) fn load(simd: S, x: &Lanes) -> Self {
        Self(simd, simd.load(x.0))
    }

    #[inline(always)]
    pub(crate) fn splat(simd: S, x: f64) -> Self {
        Self(simd, simd.splat(x))
    }

    #[inline(always)]
    pub(crate) fn store(self) -> Lanes {
        Lanes(self.0.store(self.1))
    }
}

impl<S: Simd> Add for Four<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(self.0, self.0.add(self.1, other.1))
    }
}

impl<S: Simd> Sub for Four<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(self.0, self.0.sub(self.1, other.1))
    }
}

impl<S: Simd> Mul for Four<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(self.0, self.0.mul(self.1, other.1))
    }
}

impl<S: Simd> Neg for Four<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0, self.0.neg(self.1))
    }
}

/// A loop that is compiled for every set of vector instructions. What it calls must be inlined.
pub(crate) trait Kernel {
    fn run<S: Simd>(self, simd: S);
}

/// The vector instructions that this machine has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Machine {
    #[cfg(target_arch = "x86_64")]
    avx2: Option<pulp::x86::V3>,
}

impl Machine {
    /// Any machine.
    #[cfg(test)]
    pub(crate) const BASELINE: Self = Self {
        #[cfg(target_arch = "x86_64")]
        avx2: None,
    };

    pub(crate) fn new() -> Self {
        Self {
            #[cfg(target_arch = "x86_64")]
            avx2: pulp::x86::V3::try_new(),
        }
    }

    /// Runs a kernel.
    pub(crate) fn run<K: Kernel>(self, kernel: K) {
        #[cfg(target_arch = "x86_64")]
        if let Some(simd) = self.avx2 {
            // A closure could not be marked to be inlined, and would be compiled for the baseline.
            struct Inlined<K>(K, pulp::x86::V3);
            impl<K: Kernel> pulp::NullaryFnOnce for Inlined<K> {
                type Output = ();
                #[inline(always)]
                fn call(self) {
                    self.0.run(self.1);
                }
            }
            simd.vectorize(Inlined(kernel, simd));
            return;
        }
        kernel.run(Baseline);
    }
}
