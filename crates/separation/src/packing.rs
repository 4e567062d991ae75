//! How runs and their springs share lanes: a batch has four runs side by side, a run alone four springs.

use crate::{
    lanes::{Lanes, WIDTH},
    products::{Products, batch::Batched, single::Single},
};

/// How runs and their springs share lanes. Springs are added in their order either way, so that a
/// run comes to the same bits alone and in a batch.
pub(crate) trait Packing<const L: usize>: Sized {
    /// Coefficients that go into products.
    type Products: Products<L>;
    /// Springs of one run that go into the lanes side by side.
    const SPRINGS: usize;
    /// What all springs in the lanes share.
    fn spread(self) -> Lanes<WIDTH>;
    /// Adds what the springs in the lanes contribute.
    fn collect(self, springs: Lanes<WIDTH>) -> Self;
}

impl Packing<1> for Lanes<1> {
    type Products = Single;
    const SPRINGS: usize = WIDTH;
    #[inline(always)]
    fn spread(self) -> Lanes<WIDTH> {
        Lanes::splat(self.0[0])
    }
    #[inline(always)]
    fn collect(self, springs: Lanes<WIDTH>) -> Self {
        Self([springs.0.iter().fold(self.0[0], |sum, x| sum + x)])
    }
}

impl Packing<WIDTH> for Lanes<WIDTH> {
    type Products = Batched;
    const SPRINGS: usize = 1;
    #[inline(always)]
    fn spread(self) -> Lanes<WIDTH> {
        self
    }
    #[inline(always)]
    fn collect(self, springs: Lanes<WIDTH>) -> Self {
        self + springs
    }
}
