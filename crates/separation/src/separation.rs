//! Two bodies and the loads between them, at the moment the clamp opens.

use gyradius_inertia::InertiaMatrix;
use std::fmt;

use crate::{
    AnyLoad, Body, BodyError, LoadError, LoadId, MovingBody, Role, Spring,
    load::{SeatError, Seated},
    loads::Loads,
    spring::SeatedSpring,
};

/// Why bodies and loads do not make a separation.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SeparationError {
    /// Something is wrong with a body or its state.
    #[error("{body}: {problem}")]
    Body {
        /// Which of the two.
        body: Role,
        /// What.
        problem: BodyError,
    },
    /// The values of a load make none.
    #[error("{load}: {problem}")]
    Load {
        /// Which load.
        load: LoadId,
        /// What is wrong with it.
        problem: LoadError,
    },
    /// There is no load.
    #[error("no {}: there must be at least one", kinds(" and no "))]
    NoLoads,
    /// All loads fail, or none overcomes its friction.
    #[error("none of the {} ever pushes: at least one must", kinds(" and "))]
    NonePushes,
    /// The two points of a load coincide at the start, which leaves its direction undefined.
    #[error(
        "{load}: its points are {distance:e} m apart at the start: they must be apart by \
         more than a millionth of the stroke ({stroke:?} m), for the line between them is the \
         direction of the force; touching pads have none, and nearly touching ones turn with the \
         slightest motion"
    )]
    TouchingPads {
        /// Which load.
        load: LoadId,
        /// Distance of the points, m.
        distance: f64,
        /// Its stroke, m.
        stroke: f64,
    },
    /// A stroke is so short beside the body that rounding of positions would drown it.
    #[error(
        "{load}: its stroke of {stroke:e} m, less what friction takes of it, must be more than 1e-7 of its distance \
         from the mass centres ({reach:?} m) for double precision to follow it"
    )]
    ShortStroke {
        /// Which load.
        load: LoadId,
        /// Its stroke less what friction takes of it, m.
        stroke: f64,
        /// Distance of its points from each other and from their mass centres, m.
        reach: f64,
    },
}

/// All kinds of loads, as in `springs`.
fn kinds(between: &str) -> String {
    AnyLoad::KINDS.iter().map(|kind| kind.plural()).collect::<Vec<_>>().join(between)
}

/// A payload, a stage and the loads between them, at the moment the clamp opens: what moves by Peck
/// (2003, Eq. 28), with forces that push.
///
/// Cheap to clone: the loads are shared.
///
/// ```
/// # use gyradius_inertia::InertiaMatrix;
/// # use gyradius_separation::{Body, Separation, Spring};
/// # use nalgebra::Vector3;
/// # let inertia = InertiaMatrix::from_entries([5e3, 4e3, 3e3], [0.0; 3])?;
/// # let point = |z| Vector3::new(0.5, 0.0, z);
/// # let spring = Spring::new(1e5, 0.1, point(-0.9), point(0.9))?;
/// # let (payload, stage) = (Body::new(1e4, inertia)?, Body::new(4e3, inertia)?);
/// # let separation =
/// #     Separation::new(payload.at(Vector3::z()), stage.at(-Vector3::z()), &[spring])?;
/// println!("{separation}");
/// assert!((separation.stored_energy() - 500.0).abs() < 1e-12);
/// // The points are 0.2 m apart, and the stroke is 0.1 m.
/// assert!(separation.release_lengths().all(|free| (free - 0.3).abs() < 1e-15));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Separation {
    payload: MovingBody,
    stage: MovingBody,
    loads: Loads,
}

impl Separation {
    /// Puts bodies and loads together: springs, or [`AnyLoad`]. The release length of each spring, at which it lets
    /// go, is the distance of its points in the given states plus its stroke, less f/k with a friction f and a stiffness k.
    ///
    /// # Errors
    /// A state is not finite, there is no load that pushes, or a load's points touch.
    pub fn new<L: Into<AnyLoad> + Copy>(
        payload: MovingBody,
        stage: MovingBody,
        loads: &[L],
    ) -> Result<Self, SeparationError> {
        let checked = |body, moving: MovingBody| {
            let state = moving.state().checked();
            state
                .map(|s| moving.body().moving(s))
                .map_err(|problem| SeparationError::Body { body, problem })
        };
        let (payload, stage) = (checked(Role::Payload, payload)?, checked(Role::Stage, stage)?);
        let loads = || loads.iter().map(|load| (*load).into());
        if loads().next().is_none() {
            return Err(SeparationError::NoLoads);
        }
        if !loads().any(|load: AnyLoad| load.can_push()) {
            return Err(SeparationError::NonePushes);
        }
        let loads = Loads::new(loads(), payload.state(), stage.state());
        let loads = loads.map_err(|(load, error)| match error {
            SeatError::Touching { distance, stroke } => {
                SeparationError::TouchingPads { load, distance, stroke }
            }
            SeatError::ShortStroke { stroke, reach } => {
                SeparationError::ShortStroke { load, stroke, reach }
            }
        })?;
        Ok(Self { payload, stage, loads })
    }

    /// The same separation with other inertia matrices.
    ///
    /// # Errors
    /// A matrix is not positive definite.
    pub fn with_inertias(
        &self,
        payload: impl Into<InertiaMatrix>,
        stage: impl Into<InertiaMatrix>,
    ) -> Result<Self, SeparationError> {
        let replace = |name, old: &MovingBody, inertia: InertiaMatrix| {
            let body: Result<Body, BodyError> = old.body().with_inertia(inertia);
            body.map(|b| old.with_body(b))
                .map_err(|problem| SeparationError::Body { body: name, problem })
        };
        Ok(Self {
            payload: replace(Role::Payload, &self.payload, payload.into())?,
            stage: replace(Role::Stage, &self.stage, stage.into())?,
            loads: self.loads.clone(),
        })
    }

    /// The payload at the start.
    #[must_use]
    pub fn payload(&self) -> &MovingBody {
        &self.payload
    }

    /// The stage at the start.
    #[must_use]
    pub fn stage(&self) -> &MovingBody {
        &self.stage
    }

    /// The loads, in the order given, and which they are.
    pub fn loads(&self) -> impl ExactSizeIterator<Item = (LoadId, AnyLoad)> {
        (0..self.loads.len()).map(|load| (self.loads.id(load), self.loads.described(load)))
    }

    /// Which load stands at a place among all, from 0; none if there are not so many.
    #[must_use]
    pub fn id(&self, place: usize) -> Option<LoadId> {
        (place < self.loads.len()).then(|| self.loads.id(place))
    }

    /// The place of a load among all, from 0, if there is such a load.
    #[must_use]
    pub fn place(&self, load: LoadId) -> Option<usize> {
        // No load comes before those of its kind that do.
        (load.number..self.loads.len()).find(|place| self.loads.id(*place) == load)
    }

    /// The springs among them.
    pub fn springs(&self) -> impl ExactSizeIterator<Item = &Spring> + Clone {
        self.loads.springs().iter().map(Seated::load)
    }

    /// Release length of each spring, m: where it lets go. Of a spring that can never push, friction is left out.
    pub fn release_lengths(&self) -> impl ExactSizeIterator<Item = f64> {
        self.loads.springs().iter().map(SeatedSpring::release_length_m)
    }

    /// Energy that the loads hold at the start, J.
    #[must_use]
    pub fn stored_energy(&self) -> f64 {
        self.loads.stored_energy()
    }

    pub(crate) fn seated(&self) -> &Loads {
        &self.loads
    }

    /// 1/m of the payload plus 1/m of the stage, 1/kg.
    pub(crate) fn inverse_reduced_mass(&self) -> f64 {
        1.0 / self.payload.body().mass_kg() + 1.0 / self.stage.body().mass_kg()
    }
}

impl fmt::Display for Separation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "payload: {}", self.payload.body())?;
        write!(f, "stage: {}", self.stage.body())?;
        for (id, load) in self.loads() {
            write!(f, "\n{id}: {load}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BodyState, Load};
    use nalgebra::Vector3;

    fn body() -> Body {
        Body::new(1.0, InertiaMatrix::from_entries([1.0; 3], [0.0; 3]).unwrap()).unwrap()
    }

    /// Springs count from 0.
    fn id(number: usize) -> LoadId {
        LoadId { kind: Spring::KIND, number }
    }

    #[test]
    fn touching_pads_and_missing_springs_are_refused() {
        let (up, down) = (Vector3::z() * 1.0, Vector3::z() * -1.0);
        let spring = |gap: f64| {
            let half = Vector3::z() * (1.0 - 0.5 * gap);
            Spring::new(1.0, 0.1, -half, half).unwrap()
        };
        let with = |springs: &[Spring]| Separation::new(body().at(up), body().at(down), springs);
        assert!(matches!(with(&[]), Err(SeparationError::NoLoads)));
        for gap in [0.0, 1e-9] {
            let error = with(&[spring(0.2), spring(gap)]).unwrap_err();
            assert!(
                matches!(error, SeparationError::TouchingPads { load, .. } if load == id(1)),
                "{error}"
            );
        }
        let stuck = spring(0.2).with_friction(0.1).unwrap();
        for none in [[stuck, stuck], [stuck, spring(0.2).never_pushing()]] {
            assert!(matches!(with(&none), Err(SeparationError::NonePushes)));
        }
        assert_eq!(
            with(&[stuck, spring(0.2)]).unwrap().release_lengths().nth(1).unwrap(),
            0.2 + 0.1
        );
        let nearly = spring(0.2).with_friction(0.1 * (1.0 - 1e-9)).unwrap();
        assert!(matches!(
            with(&[nearly]),
            Err(SeparationError::ShortStroke { load, .. }) if load == id(0)
        ));
        let short = Spring::new(1.0, 1e-8, Vector3::z() * -0.9, Vector3::z() * 0.9).unwrap();
        assert!(matches!(
            with(&[short]),
            Err(SeparationError::ShortStroke { load, .. }) if load == id(0)
        ));
        let ok = with(&[spring(1e-5)]).unwrap();
        assert!((ok.release_lengths().next().unwrap() - 0.10001).abs() < 1e-15);
    }

    #[test]
    fn states_that_are_not_numbers_are_refused() {
        let spring = Spring::new(1.0, 0.1, Vector3::zeros(), Vector3::zeros()).unwrap();
        let state = BodyState { angular_velocity: Vector3::x() * f64::NAN, ..Default::default() };
        let error = Separation::new(body().at(Vector3::z()), body().moving(state), &[spring]);
        assert!(error.unwrap_err().to_string().starts_with("stage: angular velocity = NaN"));
    }
}
