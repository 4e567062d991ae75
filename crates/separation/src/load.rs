//! What a load that the bodies exchange must tell: the one interface between a kind of load and all the
//! rest.
//!
//! A kind of load has three types. One is the load as it is described, and all that is told of it outside ([`Load`], and
//! [`Kind`], by which the others are found). One is the load in its place, which knows its energy, where a state
//! stands with respect to its end, and how large it is ([`Seated`]). The third holds as many of them as there
//! are lanes, and their part in the series of the motion ([`Series`], and what of it concerns one lane
//! alone, [`Events`]). `loads.rs` lists the kinds.

use nalgebra::{UnitQuaternion, Vector3};
use smallvec::SmallVec;
use std::fmt;

use crate::{
    BodyState, LoadState, Parameter,
    lanes::{Lanes, M3, V3},
    state::State,
    vector::Simd,
};

/// A kind of load between a point of the payload and a point of the stage: what all the rest is told of it.
///
/// A scenario's keys, what of the load can be dispersed, its columns and its place in a [`Stack`](crate::Stack) follow
/// from its parameters. The kinds that a separation takes are those of [`AnyLoad`](crate::AnyLoad).
///
/// ```
/// use gyradius_separation::{Load, Parameter, Spring, SpringParameter};
///
/// // A spring of what its parameters are, all in a row.
/// let value = |parameter, component| match parameter {
///     SpringParameter::Stiffness => 1e5,
///     SpringParameter::Stroke => 0.1,
///     SpringParameter::StagePoint => [0.5, 0.0, 0.9][component],
///     SpringParameter::PayloadPoint => [0.5, 0.0, -0.9][component],
///     SpringParameter::Friction | SpringParameter::LineOfAction | SpringParameter::Start => 0.0,
/// };
/// let spring = Spring::from_values(value)?;
/// assert_eq!(SpringParameter::Stroke.nominal(&spring), [0.1]);
/// assert_eq!(Spring::KIND.to_string(), "spring");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Load: Copy + PartialEq + fmt::Debug + fmt::Display + Send + Sync + 'static {
    /// What of it can be uncertain.
    type Parameter: Parameter<Of = Self>;
    /// Why parameters make no load.
    type Error: std::error::Error;
    /// What it is called.
    const KIND: LoadKind;
    /// Where it is attached to payload and stage, from the origins of the bodies' frames, body axes.
    const POINTS: [Self::Parameter; 2];
    /// The rotation of its line about the stage point, if it has a line.
    const LINE_OF_ACTION: Option<Self::Parameter>;
    /// When it begins to act, if it can be late.
    const START: Option<Self::Parameter>;

    /// A load of the values of its parameters; components count from 0.
    ///
    /// # Errors
    /// The values make none.
    fn from_values(value: impl Fn(Self::Parameter, usize) -> f64) -> Result<Self, Self::Error>;
    /// The parameter that is refused.
    fn refused(error: &Self::Error) -> Self::Parameter;
    /// The same load if it fails: it never acts.
    #[must_use]
    fn failed(self) -> Self;
    /// When it begins to act, s; none if it fails.
    fn start_s(&self) -> Option<f64>;
    /// Whether it can push at all.
    fn can_push(&self) -> bool;
    /// The force with which it begins to push if it is not late, N.
    fn force_n(&self) -> f64;
    /// Attachments on payload and stage, from their mass centres, body axes, m.
    fn points_m(&self) -> [Vector3<f64>; 2];
}

/// What a kind of load is called: one and several of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct LoadKind {
    name: &'static str,
    plural: &'static str,
}

/// A load of a separation: its kind, and its number among those of the kind, from 0. Messages count from 1.
///
/// ```
/// use gyradius_separation::{Load, LoadId, Spring};
///
/// let second = LoadId { kind: Spring::KIND, number: 1 };
/// assert_eq!(second.to_string(), "spring 2");
/// assert_eq!(second.column(), "spring_2");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct LoadId {
    /// Its kind.
    pub kind: LoadKind,
    /// Its number among those of its kind, from 0.
    pub number: usize,
}

impl LoadKind {
    pub(crate) const fn new(name: &'static str, plural: &'static str) -> Self {
        Self { name, plural }
    }

    /// One of them, as in `spring`.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.name
    }

    /// Several, as in `springs`: the key of a scenario.
    #[must_use]
    pub fn plural(self) -> &'static str {
        self.plural
    }
}

impl fmt::Display for LoadKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

impl LoadId {
    /// How columns begin, as in `spring_2`.
    #[must_use]
    pub fn column(self) -> String {
        format!("{}_{}", self.kind.name, self.number + 1)
    }
}

impl fmt::Display for LoadId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.kind.name, self.number + 1)
    }
}

/// Several loads, as in `springs [1, 2]`.
pub(crate) fn named(loads: &[LoadId]) -> String {
    let kinds = loads.chunk_by(|a, b| a.kind == b.kind).map(|of| {
        let numbers: Vec<_> = of.iter().map(|load| load.number + 1).collect();
        format!("{} {numbers:?}", of[0].kind.plural)
    });
    kinds.collect::<Vec<_>>().join(" and ")
}

/// From a point of the stage to one of the payload, given from the mass centres in body axes, in the axes of the
/// states' positions, m (Peck 2003, Eq. 29).
pub(crate) fn line(
    [payload_point, stage_point]: [Vector3<f64>; 2],
    payload: &BodyState,
    stage: &BodyState,
) -> Vector3<f64> {
    (payload.position - stage.position) + payload.attitude * payload_point
        - stage.attitude * stage_point
}

/// A kind of load as the integrator knows it.
pub(crate) trait Kind: Load {
    /// The load in its place.
    type Seated: Seated<Described = Self> + Clone;
    /// One of them in each lane.
    type Series<const W: usize>: Series<W, Load = Self::Seated> + Clone + fmt::Debug;

    /// Puts it in its place: between bodies in these states.
    fn seat(&self, payload: &BodyState, stage: &BodyState) -> Result<Self::Seated, SeatError>;

    /// The values of all its parameters, one after the other.
    fn values(&self) -> Values {
        let values = Self::Parameter::ALL
            .iter()
            .flat_map(|parameter| parameter.built(self).into_iter().take(parameter.components()));
        values.collect()
    }

    /// The load of such values.
    fn of_values(values: &[f64]) -> Result<Self, Self::Error> {
        let value = |parameter, component| values.get(offset(parameter) + component).copied();
        Self::from_values(|parameter, component| value(parameter, component).unwrap_or(f64::NAN))
    }
}

/// Values of the parameters of a load, one after the other.
pub(crate) type Values = SmallVec<[f64; 16]>;

/// Where the values of a parameter begin among those of all.
pub(crate) fn offset<P: Parameter>(parameter: P) -> usize {
    let before = P::ALL.iter().take_while(|other| **other != parameter);
    before.map(|other| other.components()).sum()
}

/// Where the values stand that place a load between the bodies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placing {
    pub(crate) points: [usize; 2],
    pub(crate) line_of_action: Option<usize>,
}

impl Placing {
    pub(crate) fn of<L: Load>() -> Self {
        Self { points: L::POINTS.map(offset), line_of_action: L::LINE_OF_ACTION.map(offset) }
    }
}

/// Why a load does not act between two points, lengths in m.
#[derive(Clone, Copy, Debug)]
pub(crate) enum SeatError {
    /// They coincide, which leaves its direction undefined.
    Touching { distance: f64, stroke: f64 },
    /// The stroke is drowned by the rounding of their positions.
    ShortStroke { stroke: f64, reach: f64 },
}

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
pub(crate) trait Seated: fmt::Debug + Send + Sync {
    type Described
    where
        Self: Sized;
    /// As it was described.
    fn load(&self) -> &Self::Described
    where
        Self: Sized;
    /// When it begins to act, s; none if it never does.
    fn start_s(&self) -> Option<f64>;
    /// Whether the force has a direction in a state, so that it can begin to act.
    fn can_start(&self, state: &State) -> bool;
    /// Where a state stands with respect to the end of the load.
    fn gap(&self, state: &State) -> Gap;
    /// How fast its two points move past each other, m/s: where they meet, that is how fast they close.
    fn speed(&self, state: &State) -> f64;
    /// What rounding of coordinates makes of a gap, m: it is a difference and no more accurate than they
    /// are.
    fn rounding(&self, state: &State) -> f64;
    /// Energy that it holds at the start, J.
    fn stored_energy(&self) -> f64;
    fn size(&self) -> Size;
    /// What can be seen of it, given whether it acts and the payload's attitude.
    fn seen(&self, state: &State, attitude: &UnitQuaternion<f64>, acts: bool) -> LoadState;
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
    /// How far its own series is good, from the coefficients below an order, s, where that can be less than the state's tells:
    /// a force that is constant along a line moves the bodies by a polynomial, which has no end.
    #[inline(always)]
    fn radius(&self, _order: usize) -> Lanes<W> {
        Lanes::splat(f64::INFINITY)
    }
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
