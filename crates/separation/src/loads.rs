//! The loads of a separation, and their series: the one list of the kinds that there are.

use smallvec::SmallVec;
use std::sync::Arc;

use crate::{
    lanes::{Lanes, M3, V3},
    layout::INLINE_LOADS,
    load::{Events, Load, Series},
    spring::{SeatedSpring, SpringSeries},
    vector::Simd,
};

/// The loads of a separation in their places, numbered through in the order of the kinds.
#[derive(Clone, Debug)]
pub(crate) struct Loads {
    pub(crate) springs: Arc<[SeatedSpring]>,
}

/// The series of the loads in all lanes.
#[derive(Clone, Debug)]
pub(crate) struct LoadSeries<const W: usize> {
    springs: SmallVec<[SpringSeries<W>; INLINE_LOADS]>,
}

/// Does the same to the series of every kind. Written out where it stands, for what vector instructions
/// run must be inlined.
macro_rules! each {
    ($series:expr, $one:ident => $body:expr) => {
        for $one in $series.springs.iter_mut() {
            $body
        }
    };
}

impl Loads {
    pub(crate) fn len(&self) -> usize {
        self.springs.len()
    }

    pub(crate) fn get(&self, load: usize) -> &dyn Load {
        &self.springs[load]
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &dyn Load> {
        (0..self.len()).map(|load| self.get(load))
    }

    /// Energy that they hold at the start, J.
    pub(crate) fn stored_energy(&self) -> f64 {
        self.iter().map(Load::stored_energy).sum()
    }
}

/// Makes room for the loads of a run, and takes them into a lane. What a run has fewer of than there is
/// room for does not act.
fn set<S: Series<W>, const W: usize, const N: usize>(
    series: &mut SmallVec<[S; N]>,
    lane: usize,
    loads: &[S::Load],
) where
    [S; N]: smallvec::Array<Item = S>,
{
    while series.len() < loads.len() {
        series.push(S::new());
    }
    for (i, series) in series.iter_mut().enumerate() {
        series.act(lane, false);
        if let Some(load) = loads.get(i) {
            series.set(lane, load);
        }
    }
}

impl<const W: usize> LoadSeries<W> {
    pub(crate) fn new() -> Self {
        Self { springs: SmallVec::new() }
    }

    pub(crate) fn set(&mut self, lane: usize, loads: &Loads) {
        set(&mut self.springs, lane, &loads.springs);
    }

    /// The events of a load.
    pub(crate) fn get(&self, load: usize) -> &dyn Events {
        &self.springs[load]
    }

    pub(crate) fn act(&mut self, load: usize, lane: usize, acts: bool) {
        self.springs[load].act(lane, acts);
    }

    #[inline(always)]
    pub(crate) fn stretch<S: Simd>(&mut self, simd: S, k: usize, offset: &V3<W>, rotation: &M3<W>) {
        each!(self, series => series.stretch(simd, k, offset, rotation));
    }

    /// The coefficients of order k of force and torque on the payload.
    #[inline(always)]
    pub(crate) fn push<S: Simd>(&mut self, simd: S, k: usize) -> [V3<W>; 2] {
        let (mut force, mut torque) = ([Lanes::ZERO; 3], [Lanes::ZERO; 3]);
        each!(self, series => if let Some([push, moment]) = series.push(simd, k) {
            force = std::array::from_fn(|i| force[i] + push[i]);
            torque = std::array::from_fn(|i| torque[i] + moment[i]);
        });
        [force, torque]
    }

    /// In how many lanes something that acts ends within a time.
    #[inline(always)]
    pub(crate) fn ends_within(&mut self, time: Lanes<W>, order: usize) -> Lanes<W> {
        let mut ended = Lanes::ZERO;
        each!(self, series => ended += series.ends_within(time, order));
        ended
    }

    #[inline(always)]
    pub(crate) fn bound(&mut self, reach: Lanes<W>, order: usize) {
        each!(self, series => series.bound(reach, order));
    }

    #[inline(always)]
    pub(crate) fn forget(&mut self, lane: usize, orders: std::ops::Range<usize>) {
        each!(self, series => series.forget(lane, orders.clone()));
    }
}
