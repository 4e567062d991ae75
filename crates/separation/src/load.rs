//! What a load that the bodies exchange must tell: the one interface between a kind of load and all the
//! rest.
//!
//! A kind of load has two types. One is the load in its place, which knows its energy, where a state
//! stands with respect to its end, and how large it is ([`Load`]). The other holds as many of them as there
//! are lanes, and their part in the series of the motion ([`Series`], and what of it concerns one lane
//! alone, [`Events`]). `loads.rs` lists the kinds.

use nalgebra::UnitQuaternion;

use crate::{
    Parameter, RunError,
    lanes::{Lanes, M3, V3},
    spring::SpringState,
    state::State,
    vector::Simd,
};

/// How far a load is beyond its end, m, and how fast that grows, m/s.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gap {
    pub(crate) value: f64,
    pub(crate) rate: f64,
}

/// What steps and rounding are measured by.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Size {
    /// How far it moves the bodies, m: as built, and with what friction leaves of it.
    pub(crate) stroke: f64,
    pub(crate) travel: f64,
    /// The greatest force, N.
    pub(crate) force: f64,
    /// From the mass centres of payload and stage to where it acts, m.
    pub(crate) arms: [f64; 2],
    /// Between where it acts on the two bodies, at the start, m.
    pub(crate) distance: f64,
}

/// A load in its place between the bodies.
pub(crate) trait Load: std::fmt::Debug {
    /// What of it can be uncertain.
    type Parameter: Parameter
    where
        Self: Sized;
    /// When it begins to act, s; none if it never does.
    fn start_s(&self) -> Option<f64>;
    /// Whether the force has a direction in a state, so that it can begin to act.
    fn can_start(&self, state: &State) -> bool;
    /// Where a state stands with respect to the end of the load.
    fn gap(&self, state: &State) -> Gap;
    /// What rounding of coordinates makes of a gap, m: it is a difference and no more accurate than they
    /// are.
    fn rounding(&self, state: &State) -> f64;
    /// That it has lost its direction at a time, its points closing at a speed. `number` is its place.
    fn lost_direction(&self, number: usize, time: f64, speed: f64) -> RunError;
    /// Energy that it holds at the start, J.
    fn stored_energy(&self) -> f64;
    fn size(&self) -> Size;
    /// What can be seen of it, given whether it acts and the payload's attitude.
    fn seen(&self, state: &State, attitude: &UnitQuaternion<f64>, acts: bool) -> SpringState;
}

/// Loads of a kind, one for each lane, and their series. Everything is in payload axes; coefficients of an
/// order must wait for no other coefficient of the state than those up to that order.
pub(crate) trait Series<const W: usize>: Events {
    type Load;
    fn new() -> Self;
    /// Takes a load into a lane; it does not act yet.
    fn set(&mut self, lane: usize, load: &Self::Load);
    /// The geometry of order k, from the offset of the mass centres and the rotation from stage to payload;
    /// and what else of order k waits for nothing.
    fn stretch<S: Simd>(&mut self, simd: S, k: usize, offset: &V3<W>, rotation: &M3<W>);
    /// The coefficients of order k of the forces on the payload and of their moments about its mass centre;
    /// none if no lane has one that acts. The stage feels the opposite along the same line.
    fn push<S: Simd>(&mut self, simd: S, k: usize) -> Option<[V3<W>; 2]>;
    /// In which lanes one that acts comes to its end within a time, as far as the coefficients below an
    /// order tell: one there, zero elsewhere.
    fn ends_within(&self, time: Lanes<W>, order: usize) -> Lanes<W>;
    /// Notes how far they go within the reach of the series, from the coefficients below an order.
    fn bound(&mut self, reach: Lanes<W>, order: usize);
    /// Leaves out the coefficients from an order to another, in a lane that stopped sooner.
    fn forget(&mut self, lane: usize, orders: std::ops::Range<usize>);
}

/// What may happen to the load in one lane during a step; times as shares of the step.
pub(crate) trait Events {
    /// It begins to act, or ceases to.
    fn act(&mut self, lane: usize, acts: bool);
    /// Whether it may come to its end within the reach of the series: most do not, and NaN does not pass.
    fn may_end(&self, lane: usize) -> bool;
    /// The same, with room for rounding.
    fn may_all_but_end(&self, lane: usize) -> bool;
    /// When it comes to its end, as far as its series of an order tells.
    fn end(&self, lane: usize, order: usize, step: f64) -> Option<f64>;
    /// When it loses its direction, which the equations of motion need not notice.
    fn loses_direction(&self, lane: usize, order: usize, step: f64) -> Option<f64>;
    /// When it is pressed back from beyond its end, clearly.
    fn comes_back(&self, lane: usize, order: usize, step: f64) -> Option<f64>;
}
