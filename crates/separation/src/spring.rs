//! A spring between two bodies.

mod events;
mod parameter;
mod seated;
mod series;

use nalgebra::Vector3;
use std::fmt;

use crate::{
    BodyState, Load, LoadKind, Role,
    load::{Kind, SeatError, line},
};

pub use parameter::SpringParameter;
pub(crate) use seated::SeatedSpring;
use seated::TOUCHING;
use series::SpringSeries;

/// Errors of a spring's parameters.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpringError {
    /// The stiffness is not positive and finite.
    #[error("stiffness = {value:?} N/m: it must be positive and finite")]
    Stiffness {
        /// The stiffness, N/m.
        value: f64,
    },
    /// The stroke is not positive and finite.
    #[error("stroke = {value:?} m: it must be positive and finite")]
    Stroke {
        /// The stroke, m.
        value: f64,
    },
    /// The friction is negative or not finite.
    #[error("friction = {value:?} N: it must be zero or positive, and finite")]
    Friction {
        /// The friction, N.
        value: f64,
    },
    /// The start is negative or not finite.
    #[error("start = {value:?} s: it must be zero or positive, and finite")]
    Start {
        /// The start, s.
        value: f64,
    },
    /// An attachment point is not finite.
    #[error("{body} attachment point has entry {value}: it must be finite")]
    Point {
        /// On which body.
        body: Role,
        /// The entry, m.
        value: f64,
    },
}

/// A massless linear spring between a point of the payload and a point of the stage, compressed at
/// the start by its stroke.
///
/// At a compression x (Peck 2003, Eq. 29) it pushes with k x − f, f the friction of its guide, which opposes the
/// expansion, and is lost once that is zero. A late spring is held back by its latch, which rides
/// on one of the bodies: it pushes from its start, with what compression is left by then.
///
/// ```
/// use gyradius_separation::Spring;
/// use nalgebra::Vector3;
///
/// let spring = Spring::new(1e5, 0.1, Vector3::z() * -0.9, Vector3::z() * 0.9)?;
/// let rubbing = spring.with_friction(500.0)?.starting_at(0.01)?;
/// assert!((rubbing.travel_m() - 0.095).abs() < 1e-15);
/// assert_eq!(rubbing.to_string(), "100000 N/m, stroke 0.1 m, friction 500 N, starts at 0.01 s");
/// assert_eq!(spring.never_pushing().start_s(), None);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "Fields", into = "Fields")
)]
pub struct Spring {
    stiffness: f64,
    stroke: f64,
    payload_point: Vector3<f64>,
    stage_point: Vector3<f64>,
    friction: f64,
    /// Infinite if it never does.
    start: f64,
}

impl Spring {
    /// Stiffness k in N/m, stroke δ (initial compression) in m, and the two points, each from its
    /// body's mass centre in body axes, in m.
    ///
    /// # Errors
    /// Stiffness or stroke is not positive and finite, or a point is not finite.
    pub fn new(
        stiffness_n_per_m: f64,
        stroke_m: f64,
        payload_point_m: Vector3<f64>,
        stage_point_m: Vector3<f64>,
    ) -> Result<Self, SpringError> {
        let positive = |x: f64| x > 0.0 && x.is_finite();
        if !positive(stiffness_n_per_m) {
            return Err(SpringError::Stiffness { value: stiffness_n_per_m });
        }
        if !positive(stroke_m) {
            return Err(SpringError::Stroke { value: stroke_m });
        }
        for (body, point) in [(Role::Payload, payload_point_m), (Role::Stage, stage_point_m)] {
            if let Some(&value) = point.iter().find(|x| !x.is_finite()) {
                return Err(SpringError::Point { body, value });
            }
        }
        Ok(Self {
            stiffness: stiffness_n_per_m,
            stroke: stroke_m,
            payload_point: payload_point_m,
            stage_point: stage_point_m,
            friction: 0.0,
            start: 0.0,
        })
    }

    /// The same spring with a constant friction f in N, which opposes its expansion. One that the
    /// spring cannot overcome, f ≥ k δ, holds it for good: it never pushes.
    ///
    /// # Errors
    /// The friction is negative or not finite.
    pub fn with_friction(self, friction_n: f64) -> Result<Self, SpringError> {
        if !(friction_n >= 0.0 && friction_n.is_finite()) {
            return Err(SpringError::Friction { value: friction_n });
        }
        Ok(Self { friction: friction_n, ..self })
    }

    /// The same spring, let off `start_s` after the clamp opens. It exerts no force before, and none
    /// at all if its points have come to be its release length apart by then.
    ///
    /// # Errors
    /// The start is negative or not finite.
    pub fn starting_at(self, start_s: f64) -> Result<Self, SpringError> {
        if !(start_s >= 0.0 && start_s.is_finite()) {
            return Err(SpringError::Start { value: start_s });
        }
        Ok(Self { start: start_s, ..self })
    }

    /// The same spring if it fails: it never pushes.
    #[must_use]
    pub fn never_pushing(self) -> Self {
        Self { start: f64::INFINITY, ..self }
    }

    /// Stiffness k, N/m.
    #[must_use]
    pub fn stiffness_n_per_m(&self) -> f64 {
        self.stiffness
    }

    /// Stroke δ, m.
    #[must_use]
    pub fn stroke_m(&self) -> f64 {
        self.stroke
    }

    /// Attachment on the payload, from its mass centre, body axes, m.
    #[must_use]
    pub fn payload_point_m(&self) -> Vector3<f64> {
        self.payload_point
    }

    /// Attachment on the stage, from its mass centre, body axes, m.
    #[must_use]
    pub fn stage_point_m(&self) -> Vector3<f64> {
        self.stage_point
    }

    /// Friction f that opposes the expansion, N.
    #[must_use]
    pub fn friction_n(&self) -> f64 {
        self.friction
    }

    /// When it is let off, s; none if it fails.
    #[must_use]
    pub fn start_s(&self) -> Option<f64> {
        self.start.is_finite().then_some(self.start)
    }

    /// How far it can push, m: the stroke less f/k, where friction holds it; zero or less if it
    /// cannot overcome its friction.
    #[must_use]
    pub fn travel_m(&self) -> f64 {
        self.stroke - self.friction / self.stiffness
    }

    /// Whether it can push at all: it does not fail, and overcomes its friction.
    #[must_use]
    pub fn can_push(&self) -> bool {
        self.start.is_finite() && self.travel_m() > 0.0
    }

    /// From the stage point to the payload point, in the axes of the states' positions, m: along it the
    /// spring pushes the payload (Peck 2003, Eq. 29).
    #[must_use]
    pub fn line(&self, payload: &BodyState, stage: &BodyState) -> Vector3<f64> {
        line(self.points_m(), payload, stage)
    }

    /// Energy stored at the start, ½kδ², J: before friction and latch have their part.
    #[must_use]
    pub fn stored_energy(&self) -> f64 {
        0.5 * self.stiffness * self.stroke * self.stroke
    }
}

impl Load for Spring {
    type Parameter = SpringParameter;
    type Error = SpringError;
    const KIND: LoadKind = LoadKind::new("spring", "springs");
    const POINTS: [SpringParameter; 2] =
        [SpringParameter::PayloadPoint, SpringParameter::StagePoint];
    const LINE_OF_ACTION: Option<SpringParameter> = Some(SpringParameter::LineOfAction);
    const START: Option<SpringParameter> = Some(SpringParameter::Start);

    fn from_values(value: impl Fn(SpringParameter, usize) -> f64) -> Result<Self, SpringError> {
        let point = |parameter| Vector3::from_fn(|i, _| value(parameter, i));
        let number = |parameter| value(parameter, 0);
        Self::new(
            number(SpringParameter::Stiffness),
            number(SpringParameter::Stroke),
            point(SpringParameter::PayloadPoint),
            point(SpringParameter::StagePoint),
        )?
        .with_friction(number(SpringParameter::Friction))?
        .starting_at(number(SpringParameter::Start))
    }

    fn refused(error: &SpringError) -> SpringParameter {
        match error {
            SpringError::Stiffness { .. } => SpringParameter::Stiffness,
            SpringError::Stroke { .. } => SpringParameter::Stroke,
            SpringError::Friction { .. } => SpringParameter::Friction,
            SpringError::Start { .. } => SpringParameter::Start,
            SpringError::Point { body, .. } => Self::POINTS[*body as usize],
        }
    }

    fn failed(self) -> Self {
        self.never_pushing()
    }

    fn start_s(&self) -> Option<f64> {
        self.start_s()
    }

    fn can_push(&self) -> bool {
        self.can_push()
    }

    fn force_n(&self) -> f64 {
        self.stiffness * self.travel_m()
    }

    fn points_m(&self) -> [Vector3<f64>; 2] {
        [self.payload_point, self.stage_point]
    }
}

/// Strokes shorter than this share of the distances that they are differences of have lost half of
/// the digits of a double.
const SHORTEST: f64 = 1e-7;

impl Kind for Spring {
    type Seated = SeatedSpring;
    type Series<const W: usize> = SpringSeries<W>;

    fn seat(&self, payload: &BodyState, stage: &BodyState) -> Result<SeatedSpring, SeatError> {
        let (distance, stroke) = (self.line(payload, stage).norm(), self.stroke);
        if !(distance > TOUCHING * stroke) {
            return Err(SeatError::Touching { distance, stroke });
        }
        let reach = distance + self.payload_point.norm() + self.stage_point.norm();
        let stroke = if self.can_push() { self.travel_m() } else { stroke };
        if !(stroke > SHORTEST * reach) {
            return Err(SeatError::ShortStroke { stroke, reach });
        }
        Ok(SeatedSpring::new(*self, distance))
    }
}

impl fmt::Display for Spring {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} N/m, stroke {} m", self.stiffness, self.stroke)?;
        if self.friction > 0.0 {
            write!(f, ", friction {} N", self.friction)?;
        }
        match self.start_s() {
            None => f.write_str(", never pushes"),
            Some(0.0) => Ok(()),
            Some(start) => write!(f, ", starts at {start} s"),
        }
    }
}

/// The serialized form.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Fields {
    stiffness_n_per_m: f64,
    stroke_m: f64,
    payload_point_m: [f64; 3],
    stage_point_m: [f64; 3],
    #[serde(default)]
    friction_n: f64,
    #[serde(default)]
    start_s: f64,
    #[serde(default)]
    never_pushes: bool,
}

#[cfg(feature = "serde")]
impl TryFrom<Fields> for Spring {
    type Error = SpringError;

    fn try_from(f: Fields) -> Result<Self, SpringError> {
        let (payload, stage) = (f.payload_point_m.into(), f.stage_point_m.into());
        let spring = Self::new(f.stiffness_n_per_m, f.stroke_m, payload, stage)?
            .with_friction(f.friction_n)?
            .starting_at(f.start_s)?;
        Ok(if f.never_pushes { spring.never_pushing() } else { spring })
    }
}

#[cfg(feature = "serde")]
impl From<Spring> for Fields {
    fn from(spring: Spring) -> Self {
        Self {
            stiffness_n_per_m: spring.stiffness,
            stroke_m: spring.stroke,
            payload_point_m: spring.payload_point.into(),
            stage_point_m: spring.stage_point.into(),
            friction_n: spring.friction,
            start_s: spring.start_s().unwrap_or(0.0),
            never_pushes: spring.start_s().is_none(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_springs_are_refused() {
        let o = Vector3::zeros();
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(Spring::new(bad, 1.0, o, o), Err(SpringError::Stiffness { .. })));
            assert!(matches!(Spring::new(1.0, bad, o, o), Err(SpringError::Stroke { .. })));
        }
        let nan = Vector3::new(0.0, f64::NAN, 0.0);
        let error = Spring::new(1.0, 1.0, o, nan).unwrap_err();
        assert!(matches!(error, SpringError::Point { body: Role::Stage, .. }));
        let spring = Spring::new(2.0, 3.0, o, o).unwrap();
        assert_eq!(spring.stored_energy(), 9.0);
        for bad in [-1e-300, f64::NAN, f64::INFINITY] {
            assert!(matches!(spring.with_friction(bad), Err(SpringError::Friction { .. })));
            assert!(matches!(spring.starting_at(bad), Err(SpringError::Start { .. })));
        }
        assert_eq!(spring.with_friction(1.0).unwrap().travel_m(), 2.5);
        assert!(!spring.with_friction(6.0).unwrap().can_push());
        assert!(spring.starting_at(1e9).unwrap().can_push());
        assert!(!spring.never_pushing().can_push());
    }

    #[cfg(feature = "serde")]
    #[test]
    fn serde_goes_through_the_constructor() {
        let spring = Spring::new(2.0, 3.0, Vector3::x(), Vector3::y()).unwrap();
        let json = serde_json::to_string(&spring).unwrap();
        assert_eq!(serde_json::from_str::<Spring>(&json).unwrap(), spring);
        assert!(serde_json::from_str::<Spring>(&json.replace("2.0", "-2.0")).is_err());
    }
}
