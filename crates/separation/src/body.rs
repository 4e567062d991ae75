//! Rigid bodies and their states.

use gyradius_inertia::InertiaMatrix;
use nalgebra::{Matrix3, Unit, UnitQuaternion, Vector3};
use std::fmt;

use crate::{SpinMetrics, metrics::angle_of};

/// Why a body cannot take part in a separation.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BodyError {
    /// The mass is not positive and finite.
    #[error("mass = {value:?} kg: it must be positive and finite")]
    Mass {
        /// The mass, kg.
        value: f64,
    },
    /// The inertia matrix is singular or has a negative moment.
    #[error(
        "inertia with principal moments {:?}, {:?} and {:?} kg·m²: all three must be positive, \
         and the smallest more than 1.4e-14 of the largest, for the body to turn",
        .moments[0], .moments[1], .moments[2]
    )]
    NotPositiveDefinite {
        /// Principal moments, kg·m².
        moments: [f64; 3],
    },
    /// The attitude is not a unit quaternion.
    #[error("attitude quaternion of norm {norm:?}: it must have norm 1")]
    Attitude {
        /// The norm.
        norm: f64,
    },
    /// Position, velocity or angular velocity holds something that is not a number.
    #[error("{field} = {value}: it must be finite")]
    NotFinite {
        /// Which vector.
        field: &'static str,
        /// The entry.
        value: f64,
    },
}

/// A rigid body: mass, and an inertia matrix that can be inverted.
///
/// The inertia need not be realizable: what unphysical matrices lead to is a question that this
/// crate can be asked.
///
/// ```
/// use gyradius_inertia::InertiaMatrix;
/// use gyradius_separation::Body;
///
/// let inertia = InertiaMatrix::from_entries([5.0, 4.0, 3.0], [0.1, 0.0, 0.0])?;
/// let body = Body::new(100.0, inertia)?;
/// assert_eq!(body.to_string(), "100 kg, inertia 5, 4, 3, 0.1, 0, 0 kg·m²");
/// assert!(Body::new(-1.0, inertia).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "Fields", into = "Fields")
)]
pub struct Body {
    mass: f64,
    inertia: InertiaMatrix,
    inverse: Matrix3<f64>,
}

impl Body {
    /// Mass in kg and inertia in kg·m², about the mass centre in body axes.
    ///
    /// # Errors
    /// The mass is not positive and finite, or the matrix not positive definite.
    pub fn new(mass_kg: f64, inertia: impl Into<InertiaMatrix>) -> Result<Self, BodyError> {
        if !(mass_kg > 0.0 && mass_kg.is_finite()) {
            return Err(BodyError::Mass { value: mass_kg });
        }
        let inertia = inertia.into();
        let Some(inverse) = inertia.inverse() else {
            let moments = inertia.principal_axes().moments();
            return Err(BodyError::NotPositiveDefinite { moments });
        };
        Ok(Self { mass: mass_kg, inertia, inverse })
    }

    /// The same mass with another inertia.
    ///
    /// # Errors
    /// The matrix is not positive definite.
    pub fn with_inertia(&self, inertia: impl Into<InertiaMatrix>) -> Result<Self, BodyError> {
        Self::new(self.mass, inertia)
    }

    /// Mass, kg.
    #[must_use]
    pub fn mass_kg(&self) -> f64 {
        self.mass
    }

    /// Inertia, kg·m².
    #[must_use]
    pub fn inertia(&self) -> &InertiaMatrix {
        &self.inertia
    }

    /// I⁻¹, 1/(kg·m²).
    #[must_use]
    pub fn inverse_inertia(&self) -> &Matrix3<f64> {
        &self.inverse
    }

    /// The body at rest, its axes along the inertial ones, its mass centre at `position` (m).
    #[must_use]
    pub fn at(self, position: Vector3<f64>) -> MovingBody {
        MovingBody { body: self, state: BodyState { position, ..BodyState::default() } }
    }

    /// The body in the given state.
    #[must_use]
    pub fn moving(self, state: BodyState) -> MovingBody {
        MovingBody { body: self, state }
    }
}

impl fmt::Display for Body {
    /// Mass, then I11, I22, I33, I12, I13, I23.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [xx, yy, zz, xy, xz, yz] = self.inertia.entries();
        write!(f, "{} kg, inertia {xx}, {yy}, {zz}, {xy}, {xz}, {yz} kg·m²", self.mass)
    }
}

/// Where a body is and how it moves; by default at rest at the origin, axes along the inertial ones.
///
/// ```
/// use gyradius_separation::BodyState;
/// use nalgebra::Vector3;
///
/// // A body that turns about its axis 3: a point on its axis 1 goes along axis 2.
/// let state = BodyState { angular_velocity: Vector3::z() * 0.5, ..BodyState::default() };
/// assert_eq!(state.of_point(&Vector3::x()).velocity, Vector3::y() * 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct BodyState {
    /// Mass centre, inertial axes, m.
    #[cfg_attr(feature = "serde", serde(rename = "position_m"))]
    pub position: Vector3<f64>,
    /// Velocity of the mass centre, inertial axes, m/s.
    #[cfg_attr(feature = "serde", serde(rename = "velocity_m_per_s"))]
    pub velocity: Vector3<f64>,
    /// Takes body components to inertial components.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "read_attitude"))]
    pub attitude: UnitQuaternion<f64>,
    /// Angular velocity, body axes, rad/s.
    #[cfg_attr(feature = "serde", serde(rename = "angular_velocity_rad_per_s"))]
    pub angular_velocity: Vector3<f64>,
}

impl BodyState {
    /// The state of another point of the same rigid body, `point_m` from this one in body axes.
    #[must_use]
    pub fn of_point(&self, point_m: &Vector3<f64>) -> Self {
        let speed = self.attitude * self.angular_velocity.cross(point_m);
        Self {
            position: self.position + self.attitude * point_m,
            velocity: self.velocity + speed,
            ..*self
        }
    }

    /// The same state, its attitude of unit norm to rounding.
    pub(crate) fn checked(mut self) -> Result<Self, BodyError> {
        let fields: [(&'static str, &[f64]); 3] = [
            ("position", self.position.as_slice()),
            ("velocity", self.velocity.as_slice()),
            ("angular velocity", self.angular_velocity.as_slice()),
        ];
        for (field, values) in fields {
            if let Some(&value) = values.iter().find(|x| !x.is_finite()) {
                return Err(BodyError::NotFinite { field, value });
            }
        }
        let norm = self.attitude.norm();
        if !((norm - 1.0).abs() < 1e-6) {
            return Err(BodyError::Attitude { norm });
        }
        self.attitude = UnitQuaternion::new_normalize(self.attitude.into_inner());
        Ok(self)
    }
}

/// A body and its state.
///
/// ```
/// use gyradius_inertia::InertiaMatrix;
/// use gyradius_separation::{Body, BodyState};
/// use nalgebra::Vector3;
///
/// let inertia = InertiaMatrix::from_entries([2.0, 3.0, 4.0], [0.0; 3])?;
/// let state = BodyState {
///     velocity: Vector3::x(),
///     angular_velocity: Vector3::z() * 0.5,
///     ..BodyState::default()
/// };
/// let moving = Body::new(10.0, inertia)?.moving(state);
/// assert_eq!(moving.momentum(), Vector3::x() * 10.0);
/// assert_eq!(moving.kinetic_energy(), 5.0 + 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct MovingBody {
    body: Body,
    state: BodyState,
}

impl MovingBody {
    /// The body.
    #[must_use]
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// Its state.
    #[must_use]
    pub fn state(&self) -> &BodyState {
        &self.state
    }

    /// Linear momentum m v, inertial axes, kg·m/s.
    #[must_use]
    pub fn momentum(&self) -> Vector3<f64> {
        self.state.velocity * self.body.mass
    }

    /// Angular momentum about the mass centre, I ω, body axes, kg·m²/s.
    #[must_use]
    pub fn spin_angular_momentum(&self) -> Vector3<f64> {
        self.body.inertia.matrix() * self.state.angular_velocity
    }

    /// Angular momentum about the mass centre, I ω, inertial axes, kg·m²/s: constant once nothing pushes.
    #[must_use]
    pub fn inertial_spin_angular_momentum(&self) -> Vector3<f64> {
        self.state.attitude * self.spin_angular_momentum()
    }

    /// Angular momentum about the inertial origin, m r × v + I ω, inertial axes, kg·m²/s.
    #[must_use]
    pub fn angular_momentum(&self) -> Vector3<f64> {
        self.state.position.cross(&self.momentum()) + self.inertial_spin_angular_momentum()
    }

    /// Kinetic energy, translation and rotation, J.
    #[must_use]
    pub fn kinetic_energy(&self) -> f64 {
        0.5 * self.body.mass * self.state.velocity.norm_squared() + self.rotational_energy()
    }

    /// Kinetic energy of rotation, ½ωᵀIω, J.
    #[must_use]
    pub fn rotational_energy(&self) -> f64 {
        0.5 * self.state.angular_velocity.dot(&self.spin_angular_momentum())
    }

    /// Wobble, nutation, coning and the rest about a body axis.
    #[must_use]
    pub fn spin_metrics(&self, spin_axis: &Unit<Vector3<f64>>) -> SpinMetrics {
        SpinMetrics::new(&self.body.inertia, &self.state.angular_velocity, spin_axis)
    }

    /// Angle between the angular momentum about the mass centre and a direction in inertial axes, rad;
    /// none if the body does not turn.
    #[must_use]
    pub fn momentum_error(&self, intended: &Unit<Vector3<f64>>) -> Option<f64> {
        angle_of(&self.inertial_spin_angular_momentum(), intended)
    }

    pub(crate) fn with_body(&self, body: Body) -> Self {
        Self { body, state: self.state }
    }
}

/// An attitude of norm 1 to 1e-9, as it is: momenta and velocities of points are wrong with any other, and a state that
/// is read is not [checked](BodyState::checked) unless a separation starts from it.
#[cfg(feature = "serde")]
fn read_attitude<'de, D>(from: D) -> Result<UnitQuaternion<f64>, D::Error>
where
    D: serde::Deserializer<'de>,
{
    let read = <UnitQuaternion<f64> as serde::Deserialize>::deserialize(from)?;
    let norm = read.norm();
    if !((norm - 1.0).abs() < 1e-9) {
        return Err(serde::de::Error::custom(BodyError::Attitude { norm }));
    }
    Ok(read)
}

/// The serialized form of a body.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Fields {
    mass_kg: f64,
    inertia_kg_m2: InertiaMatrix,
}

#[cfg(feature = "serde")]
impl TryFrom<Fields> for Body {
    type Error = BodyError;

    fn try_from(fields: Fields) -> Result<Self, BodyError> {
        Self::new(fields.mass_kg, fields.inertia_kg_m2)
    }
}

#[cfg(feature = "serde")]
impl From<Body> for Fields {
    fn from(body: Body) -> Self {
        Self { mass_kg: body.mass, inertia_kg_m2: body.inertia }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    /// Turned by 90° about z, body x is inertial y.
    #[test]
    fn momentum_is_told_in_inertial_axes() {
        let inertia = InertiaMatrix::from_entries([2.0, 3.0, 4.0], [0.0; 3]).unwrap();
        let state = BodyState {
            attitude: UnitQuaternion::from_axis_angle(&Vector3::z_axis(), FRAC_PI_2),
            angular_velocity: Vector3::x() * 5.0,
            ..BodyState::default()
        };
        let body = Body::new(1.0, inertia).unwrap().moving(state);
        let found = body.inertial_spin_angular_momentum();
        assert!((found - Vector3::y() * 10.0).norm() < 1e-14, "{found}");
        assert!((body.rotational_energy() - 25.0).abs() < 1e-14);
        assert!(body.momentum_error(&Vector3::y_axis()).unwrap() < 1e-15);
        for axis in [Vector3::x_axis(), Vector3::z_axis()] {
            assert!((body.momentum_error(&axis).unwrap() - FRAC_PI_2).abs() < 1e-15);
        }
        let small = 1e-9;
        let near = Unit::new_normalize(Vector3::new(small, 1.0, 0.0));
        assert!((body.momentum_error(&near).unwrap() / small - 1.0).abs() < 1e-6);
        assert_eq!(body.body().at(Vector3::zeros()).momentum_error(&Vector3::y_axis()), None);
    }

    #[test]
    fn bad_bodies_are_refused() {
        let good = InertiaMatrix::from_entries([1.0, 2.0, 2.5], [0.0; 3]).unwrap();
        for mass in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(Body::new(mass, good), Err(BodyError::Mass { .. })), "{mass}");
        }
        for moments in [[0.0, 1.0, 1.0], [-1.0, 1.0, 1.0]] {
            let bad = InertiaMatrix::from_entries(moments, [0.0; 3]).unwrap();
            let error = Body::new(1.0, bad).unwrap_err();
            assert!(matches!(error, BodyError::NotPositiveDefinite { .. }));
        }
        // Unphysical and yet invertible: allowed here.
        let triangle = InertiaMatrix::from_entries([1.0, 1.0, 3.0], [0.0; 3]).unwrap();
        assert!(Body::new(1.0, triangle).is_ok());
        let state = BodyState { velocity: Vector3::new(0.0, f64::NAN, 0.0), ..Default::default() };
        assert!(matches!(state.checked(), Err(BodyError::NotFinite { field: "velocity", .. })));
        for w in [0.0, 0.5, f64::NAN] {
            let attitude =
                UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(w, 0.0, 0.0, 0.0));
            let state = BodyState { attitude, ..Default::default() };
            assert!(matches!(state.checked(), Err(BodyError::Attitude { .. })), "{w}");
        }
    }

    #[cfg(feature = "serde")]
    #[test]
    fn serde_goes_through_the_constructor() {
        let inertia = InertiaMatrix::from_entries([2.0, 3.0, 4.0], [0.1, 0.2, 0.3]).unwrap();
        let state = BodyState { velocity: Vector3::new(0.1, 0.2, 0.3), ..BodyState::default() };
        let moving = Body::new(7.0, inertia).unwrap().moving(state);
        let json = serde_json::to_string(&moving).unwrap();
        assert_eq!(serde_json::from_str::<MovingBody>(&json).unwrap(), moving);
        let error = serde_json::from_str::<MovingBody>(&json.replace("7.0", "-7.0")).unwrap_err();
        assert!(error.to_string().starts_with("mass = -7.0 kg"), "{error}");
    }

    #[cfg(feature = "serde")]
    proptest::proptest! {
        /// An attitude of any length but one is refused in a state and in all that holds one; any other comes back as it was.
        #[test]
        fn attitudes_that_are_read_are_of_norm_one(
            q in proptest::array::uniform4(-1.0..1.0f64),
            off in proptest::prop_oneof![-8.5..3.0f64, proptest::strategy::Just(f64::NEG_INFINITY)],
        ) {
            let q = nalgebra::Quaternion::from(nalgebra::Vector4::from(q));
            proptest::prop_assume!(q.norm() > 0.1);
            let unit = UnitQuaternion::new_normalize(q);
            let scale = 1.0 + 10f64.powf(off);
            let inertia = InertiaMatrix::from_entries([2.0, 3.0, 4.0], [0.0; 3]).unwrap();
            for scale in [scale, scale.recip()] {
                let attitude = UnitQuaternion::new_unchecked(unit.into_inner() * scale);
                let state = BodyState { attitude, ..BodyState::default() };
                let moving = Body::new(7.0, inertia).unwrap().moving(state);
                let read = [
                    serde_json::from_str(&serde_json::to_string(&state).unwrap()),
                    serde_json::from_str::<MovingBody>(&serde_json::to_string(&moving).unwrap())
                        .map(|moving| moving.state),
                ];
                for read in read {
                    if scale == 1.0 {
                        proptest::prop_assert_eq!(read.unwrap(), state);
                    } else {
                        let error = read.unwrap_err().to_string();
                        proptest::prop_assert!(error.starts_with("attitude quaternion of norm "), "{error}");
                    }
                }
            }
        }
    }
}
