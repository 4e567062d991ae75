//! The products of series that the equations of motion are made of, term by term: how the
//! coefficients of two orders go into one of their product.
//!
//! The runs of a batch have one lane each. A run alone has several numbers of its own in the lanes, laid out
//! so that the same operations come in the same order: it gets the same bits. Where it multiplies by
//! zeros instead of leaving a term out, sums start from +0 and stay as they are.

pub(crate) mod batch;
pub(crate) mod single;

use std::fmt::Debug;

use crate::{
    lanes::{Lanes, M3, V3, WIDTH},
    layout::STATE,
    vector::{Four, Simd},
};

/// The coefficients of one order of a state.
pub(crate) type Row<const L: usize> = [Lanes<L>; STATE];

/// What sums are made of.
pub(crate) trait Term<S>: Copy {
    fn zero(simd: S) -> Self;
    fn plus(self, other: Self) -> Self;
}

impl<const N: usize, S: Simd> Term<S> for [Four<S>; N] {
    #[inline(always)]
    fn zero(simd: S) -> Self {
        [Four::splat(simd, 0.0); N]
    }
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        std::array::from_fn(|i| self[i] + other[i])
    }
}

/// The coefficients of one order: of a state, and of what else goes into products.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub(crate) struct Coefficients<P, const L: usize> {
    pub(crate) state: Row<L>,
    pub(crate) products: P,
}

/// Coefficients of one order of what is not in the state, and the terms they make.
pub(crate) trait Products<const L: usize>: Copy + Debug {
    type Squares<S: Simd>: Term<S>;
    type Turn<S: Simd>: Term<S>;
    type Crosses<S: Simd>: Term<S>;
    type Gyration<S: Simd>: Term<S>;
    type Vector<S: Simd>: Term<S>;

    const ZERO: Self;
    /// From the state.
    fn set_motion<S: Simd>(&mut self, simd: S, state: &Row<L>);
    /// The angular momenta about the mass centres, body axes.
    fn set_momenta<S: Simd>(&mut self, simd: S, state: &Row<L>, momenta: &[V3<L>; 2]);
    /// Takes stage components to payload components.
    fn set_rotation<S: Simd>(&mut self, simd: S, rotation: &M3<L>);
    /// On the payload, payload axes.
    fn set_force<S: Simd>(&mut self, simd: S, force: &V3<L>);
    /// On the stage, −(ρ × F + T), payload axes.
    fn set_reaction(&mut self, reaction: &V3<L>);

    /// Of the quaternion from stage to payload: of two orders, either way round.
    fn squares<S: Simd>(
        s: S,
        a: &Coefficients<Self, L>,
        b: &Coefficients<Self, L>,
    ) -> Self::Squares<S>;
    /// Of one order by itself.
    fn own_squares<S: Simd>(s: S, a: &Coefficients<Self, L>) -> Self::Squares<S>;
    /// xx, yy, zz, xy, xz, yz, xw, yw, zw.
    fn of_squares<S: Simd>(pairs: &Self::Squares<S>, own: &Self::Squares<S>) -> [Lanes<L>; 9];

    /// 2q̇ of the quaternion from stage to payload, q ∘ ω_L − ω_P ∘ q, by ω_L − ω_P and ω_L + ω_P.
    fn relative<S: Simd>(
        s: S,
        a: &Coefficients<Self, L>,
        b: &Coefficients<Self, L>,
    ) -> Self::Turn<S>;
    /// 2q̇ of the quaternion from payload to inertial, q ∘ ω_P.
    fn attitude<S: Simd>(
        s: S,
        a: &Coefficients<Self, L>,
        b: &Coefficients<Self, L>,
    ) -> Self::Turn<S>;
    fn of_turn<S: Simd>(sum: &Self::Turn<S>) -> [Lanes<L>; 4];

    /// Offset, velocity and angular momentum of the payload, each × the rate of its axes.
    fn crosses<S: Simd>(
        s: S,
        a: &Coefficients<Self, L>,
        b: &Coefficients<Self, L>,
    ) -> Self::Crosses<S>;
    /// The angular momentum of the stage × the rate of its axes, if not among the former.
    fn gyration<S: Simd>(
        s: S,
        a: &Coefficients<Self, L>,
        b: &Coefficients<Self, L>,
    ) -> Self::Gyration<S>;
    fn of_crosses<S: Simd>(sum: &Self::Crosses<S>) -> [V3<L>; 3];
    fn of_gyration<S: Simd>(crosses: &Self::Crosses<S>, sum: &Self::Gyration<S>) -> V3<L>;

    /// ρ × F.
    fn moment<S: Simd>(
        s: S,
        a: &Coefficients<Self, L>,
        b: &Coefficients<Self, L>,
    ) -> Self::Vector<S>;
    /// The reaction in stage axes.
    fn torque<S: Simd>(
        s: S,
        a: &Coefficients<Self, L>,
        b: &Coefficients<Self, L>,
    ) -> Self::Vector<S>;
    fn of_vector<S: Simd>(sum: &Self::Vector<S>) -> V3<L>;
}

#[inline(always)]
pub(crate) fn load<const N: usize, S: Simd>(simd: S, x: &[Lanes<WIDTH>; N]) -> [Four<S>; N] {
    std::array::from_fn(|i| Four::load(simd, &x[i]))
}

#[inline(always)]
pub(crate) fn load_part<const N: usize, S: Simd>(
    simd: S,
    x: &Row<WIDTH>,
    at: usize,
) -> [Four<S>; N] {
    std::array::from_fn(|i| Four::load(simd, &x[at + i]))
}

#[inline(always)]
pub(crate) fn cross<S: Simd>(a: &[Four<S>; 3], b: &[Four<S>; 3]) -> [Four<S>; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
