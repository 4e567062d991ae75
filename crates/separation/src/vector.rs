//! Loops over lanes that the compiler turns into vector instructions.

/// A loop that is compiled for every set of vector instructions. What it calls must be inlined.
pub(crate) trait Kernel {
    fn run(self);
}

/// Runs a kernel with the widest vector instructions there are. Operations are rounded in one way
/// only and never fused, so that every machine gets the same values.
pub(crate) fn run<K: Kernel>(kernel: K) {
    // A closure could not be marked to be inlined, and would be compiled for the baseline alone.
    struct Inlined<K>(K);
    impl<K: Kernel> pulp::WithSimd for Inlined<K> {
        type Output = ();
        #[inline(always)]
        fn with_simd<S: pulp::Simd>(self, _: S) {
            self.0.run();
        }
    }
    pulp::Arch::new().dispatch(Inlined(kernel));
}
