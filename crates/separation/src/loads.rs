//! The kinds of loads that there are: the one list of them, and what holds loads of any kind.

use nalgebra::Vector3;
use smallvec::SmallVec;
use std::{fmt, sync::Arc};

use crate::{
    BodyState, Load, LoadId, LoadKind, Parameter, Spring,
    lanes::{Lanes, M3, V3},
    layout::INLINE_LOADS,
    load::{Events, Kind, Placing, SeatError, Seated, Series, Values, line, offset},
    vector::Simd,
};

/// Declares what holds loads of any kind: a type, and what those of it are called where they are held.
macro_rules! kinds {
    ($($Kind:ident in $kinds:ident;)+) => {
        /// A load of any kind.
        ///
        /// ```
        /// use gyradius_separation::{AnyLoad, Spring};
        /// use nalgebra::Vector3;
        ///
        /// let spring = Spring::new(1e5, 0.1, Vector3::z() * -0.9, Vector3::z() * 0.9)?;
        /// let load = AnyLoad::from(spring);
        /// assert_eq!(load.to_string(), "100000 N/m, stroke 0.1 m");
        /// assert!(load.can_push() && AnyLoad::KINDS.contains(&load.kind()));
        /// # Ok::<(), Box<dyn std::error::Error>>(())
        /// ```
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[non_exhaustive]
        pub enum AnyLoad {
            $(
                #[allow(missing_docs, reason = "the type says it")]
                $Kind($Kind),
            )+
        }

        /// What of a load of any kind can be uncertain.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[non_exhaustive]
        pub enum LoadParameter {
            $(
                #[allow(missing_docs, reason = "the type says it")]
                $Kind(<$Kind as Load>::Parameter),
            )+
        }

        /// Why the values of a load of any kind make none.
        #[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
        #[non_exhaustive]
        pub enum LoadError {
            $(
                #[allow(missing_docs, reason = "the type says it")]
                #[error(transparent)]
                $Kind(#[from] <$Kind as Load>::Error),
            )+
        }

        $(
            impl From<$Kind> for AnyLoad {
                fn from(load: $Kind) -> Self {
                    Self::$Kind(load)
                }
            }

            impl From<<$Kind as Load>::Parameter> for LoadParameter {
                fn from(parameter: <$Kind as Load>::Parameter) -> Self {
                    Self::$Kind(parameter)
                }
            }
        )+

        impl fmt::Display for AnyLoad {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                match self { $(Self::$Kind(load) => load.fmt(f),)+ }
            }
        }

        impl AnyLoad {
            /// All kinds that there are.
            pub const KINDS: &'static [LoadKind] = &[$($Kind::KIND),+];

            /// Of which kind it is.
            #[must_use]
            pub fn kind(&self) -> LoadKind {
                match self { $(Self::$Kind(_) => $Kind::KIND,)+ }
            }

            /// When it begins to act, s; none if it fails.
            #[must_use]
            pub fn start_s(&self) -> Option<f64> {
                match self { $(Self::$Kind(load) => Load::start_s(load),)+ }
            }

            /// Whether it can push at all.
            #[must_use]
            pub fn can_push(&self) -> bool {
                match self { $(Self::$Kind(load) => Load::can_push(load),)+ }
            }

            /// The force with which it begins to push if it is not late, N.
            #[must_use]
            pub fn force_n(&self) -> f64 {
                match self { $(Self::$Kind(load) => Load::force_n(load),)+ }
            }

            /// Attachments on payload and stage, from their mass centres, body axes, m.
            #[must_use]
            pub fn points_m(&self) -> [Vector3<f64>; 2] {
                match self { $(Self::$Kind(load) => Load::points_m(load),)+ }
            }

            /// From the stage point to the payload point, in the axes of the states' positions, m: along it
            /// the load pushes the payload (Peck 2003, Eq. 29).
            #[must_use]
            pub fn line(&self, payload: &BodyState, stage: &BodyState) -> Vector3<f64> {
                line(self.points_m(), payload, stage)
            }

            /// The values of all its parameters, one after the other.
            pub(crate) fn values(&self) -> Values {
                match self { $(Self::$Kind(load) => load.values(),)+ }
            }

            /// A load of this kind of such values.
            pub(crate) fn of_values(&self, values: &[f64], fails: bool) -> Result<Self, LoadError> {
                Ok(match self {
                    $(Self::$Kind(_) => {
                        let load = $Kind::of_values(values)?;
                        Self::$Kind(if fails { load.failed() } else { load })
                    })+
                })
            }

            /// Where the values stand that place it.
            pub(crate) fn placing(&self) -> Placing {
                match self { $(Self::$Kind(_) => Placing::of::<$Kind>(),)+ }
            }

            /// Where a component of a parameter stands among its values; nowhere if it has no such.
            pub(crate) fn place(&self, parameter: LoadParameter, component: usize) -> Option<usize> {
                match (self, parameter) {
                    $((Self::$Kind(_), LoadParameter::$Kind(parameter)) => (component
                        < parameter.components())
                    .then(|| offset(parameter) + component),)+
                    #[allow(unreachable_patterns, reason = "there may be one kind only")]
                    _ => None,
                }
            }
        }

        /// Where a load stands: its kind, and its number among those of the kind.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub(crate) enum Slot {
            $($Kind(usize),)+
        }

        impl Slot {
            pub(crate) fn id(self) -> LoadId {
                match self { $(Self::$Kind(number) => LoadId { kind: $Kind::KIND, number },)+ }
            }
        }

        /// The loads of each kind in their places.
        #[derive(Clone, Debug, Default, PartialEq)]
        struct Seats {
            $($kinds: Vec<<$Kind as Kind>::Seated>,)+
            slots: SmallVec<[Slot; INLINE_LOADS]>,
        }

        impl Loads {
            /// Puts loads in their places between bodies in these states.
            pub(crate) fn new(
                loads: impl IntoIterator<Item = AnyLoad>,
                payload: &BodyState,
                stage: &BodyState,
            ) -> Result<Self, (LoadId, SeatError)> {
                let mut seats = Seats::default();
                for load in loads {
                    match load {
                        $(AnyLoad::$Kind(load) => {
                            let slot = Slot::$Kind(seats.$kinds.len());
                            let seated = load.seat(payload, stage);
                            seats.$kinds.push(seated.map_err(|error| (slot.id(), error))?);
                            seats.slots.push(slot);
                        })+
                    }
                }
                Ok(Self(Arc::new(seats)))
            }

            pub(crate) fn get(&self, load: usize) -> &dyn Seated {
                match self.slot(load) { $(Slot::$Kind(number) => &self.0.$kinds[number],)+ }
            }

            /// As it was described.
            pub(crate) fn described(&self, load: usize) -> AnyLoad {
                match self.slot(load) {
                    $(Slot::$Kind(number) => (*self.0.$kinds[number].load()).into(),)+
                }
            }
        }

        /// The series of the loads in all lanes.
        #[derive(Clone, Debug)]
        pub(crate) struct LoadSeries<const W: usize> {
            $($kinds: SmallVec<[<$Kind as Kind>::Series<W>; INLINE_LOADS]>,)+
        }

        impl<const W: usize> LoadSeries<W> {
            pub(crate) fn new() -> Self {
                Self { $($kinds: SmallVec::new(),)+ }
            }

            pub(crate) fn set(&mut self, lane: usize, loads: &Loads) {
                $(set(&mut self.$kinds, lane, &loads.0.$kinds);)+
            }

            /// The events of a load.
            pub(crate) fn get(&self, slot: Slot) -> &dyn Events {
                match slot { $(Slot::$Kind(number) => &self.$kinds[number],)+ }
            }

            pub(crate) fn act(&mut self, slot: Slot, lane: usize, acts: bool) {
                match slot { $(Slot::$Kind(number) => self.$kinds[number].act(lane, acts),)+ }
            }

            #[inline(always)]
            pub(crate) fn stretch<S: Simd>(
                &mut self,
                simd: S,
                k: usize,
                offset: &V3<W>,
                rotation: &M3<W>,
            ) {
                $(for series in &mut self.$kinds {
                    series.stretch(simd, k, offset, rotation);
                })+
            }

            /// The coefficients of order k of force and torque on the payload.
            #[inline(always)]
            pub(crate) fn push<S: Simd>(&mut self, simd: S, k: usize) -> [V3<W>; 2] {
                let (mut force, mut torque) = ([Lanes::ZERO; 3], [Lanes::ZERO; 3]);
                $(for series in &mut self.$kinds {
                    if let Some([push, moment]) = series.push(simd, k) {
                        force = std::array::from_fn(|i| force[i] + push[i]);
                        torque = std::array::from_fn(|i| torque[i] + moment[i]);
                    }
                })+
                [force, torque]
            }

            /// In how many lanes something that acts ends within a time.
            #[inline(always)]
            pub(crate) fn ends_within(&self, time: Lanes<W>, order: usize) -> Lanes<W> {
                let mut ended = Lanes::ZERO;
                $(for series in &self.$kinds {
                    ended += series.ends_within(time, order);
                })+
                ended
            }

            /// How far the series of those that act are good.
            #[inline(always)]
            pub(crate) fn radius(&self, order: usize) -> Lanes<W> {
                let mut radius = Lanes::splat(f64::INFINITY);
                $(for series in &self.$kinds {
                    radius = radius.zip(series.radius(order), |a, b| if b < a { b } else { a });
                })+
                radius
            }

            #[inline(always)]
            pub(crate) fn bound(&mut self, reach: Lanes<W>, order: usize) {
                $(for series in &mut self.$kinds {
                    series.bound(reach, order);
                })+
            }

            #[inline(always)]
            pub(crate) fn forget(&mut self, lane: usize, orders: std::ops::Range<usize>) {
                $(for series in &mut self.$kinds {
                    series.forget(lane, orders.clone());
                })+
            }
        }
    };
}

kinds! {
    Spring in springs;
}

/// The loads of a separation in their places, numbered through in the order in which they were given.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Loads(Arc<Seats>);

impl Loads {
    pub(crate) fn len(&self) -> usize {
        self.0.slots.len()
    }

    pub(crate) fn slot(&self, load: usize) -> Slot {
        self.0.slots[load]
    }

    pub(crate) fn id(&self, load: usize) -> LoadId {
        self.slot(load).id()
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &dyn Seated> {
        (0..self.len()).map(|load| self.get(load))
    }

    pub(crate) fn springs(&self) -> &[<Spring as Kind>::Seated] {
        &self.0.springs
    }

    /// Energy that they hold at the start, J.
    pub(crate) fn stored_energy(&self) -> f64 {
        self.iter().map(Seated::stored_energy).sum()
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
