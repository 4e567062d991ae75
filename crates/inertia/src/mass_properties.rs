//! Mass, mass centre and inertia of a body.

use nalgebra::{Isometry3, Matrix3, UnitQuaternion, Vector3};

use crate::{
    Inertia, InertiaMatrix, InertiaMatrixError, RadiiOfGyration, RealizabilityError,
    SecondMomentsError,
    second_moment_matrix::{nearest, point_inertia, remainder},
};

/// Largest magnitude of a coordinate or size, in m, so that no volume overflows.
pub const MAX_LENGTH: f64 = 1e100;

/// Why numbers are not the mass properties of a body.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MassPropertiesError {
    /// The mass is not positive and finite.
    #[error("mass = {value:?} kg: it must be positive and finite")]
    Mass {
        /// The value, kg.
        value: f64,
    },
    /// A coordinate is NaN, infinite, or larger in magnitude than [`MAX_LENGTH`].
    #[error("{field}, axis {axis} = {value:?} m: it must be finite and at most {MAX_LENGTH:e}")]
    Coordinate {
        /// Which vector.
        field: &'static str,
        /// Axis, from 1.
        axis: usize,
        /// The value, m.
        value: f64,
    },
    /// A mass or an inertia that is not zero falls below the range in which floats keep their digits.
    #[error(
        "{field} = {value:e}: below {:e} floats lose their digits, and a body becomes a point; a \
         smaller unit keeps them",
        f64::MIN_POSITIVE
    )]
    Lost {
        /// What falls, with its unit.
        field: &'static str,
        /// What is left of it.
        value: f64,
    },
    /// A density factor is not positive and finite.
    #[error("density factor = {value:?}: it must be positive and finite")]
    Factor {
        /// The value.
        value: f64,
    },
    /// The inertia about the mass centre is too large, or no body's, or a rotation is none.
    #[error(transparent)]
    Inertia(#[from] RealizabilityError),
    /// The inertia about another point is smaller than the parallel axis term allows.
    #[error("less the parallel axis term, which leaves the inertia about the mass centre: {0}")]
    AboutMassCentre(RealizabilityError),
    /// A sum of no bodies.
    #[error("no bodies to add: there must be at least one")]
    Empty,
    /// A part is removed that is as heavy as the whole.
    #[error("a part of {part:?} kg taken from {whole:?} kg: the part must be lighter")]
    NothingLeft {
        /// Mass of the whole, kg.
        whole: f64,
        /// Mass of the part, kg.
        part: f64,
    },
    /// A part is removed that the whole cannot hold.
    #[error("the whole does not hold the part; of what is left: {0}")]
    NotAPart(RealizabilityError),
}

impl From<InertiaMatrixError> for MassPropertiesError {
    fn from(error: InertiaMatrixError) -> Self {
        Self::Inertia(error.into())
    }
}

/// The mass, mass centre and inertia of a rigid body that could be built.
///
/// Mass m > 0 in kg; mass centre c in m, in the body's reference frame; inertia in kg·m² about the
/// mass centre, in axes parallel to that frame, products as tensor entries (I₁₂ = −∫ x₁x₂ dm).
///
/// ```
/// use gyradius_inertia::{MassProperties, Shape};
/// use nalgebra::Vector3;
///
/// let bus = Shape::solid_box([1.0, 1.0, 2.0])?.of_mass(300.0)?;
/// let tank = Shape::sphere(0.3)?.of_mass(100.0)?.translated(Vector3::new(0.0, 0.0, 1.3))?;
/// let craft = MassProperties::combined([bus, tank])?;
/// assert!((craft.mass_centre_m().z - 0.325).abs() < 1e-15);
/// assert!((craft.without(&tank)?.inertia().matrix() - bus.inertia().matrix()).amax() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, getset::CopyGetters, getset::Getters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Fields", into = "Fields"))]
pub struct MassProperties {
    /// Mass m, kg.
    #[getset(get_copy = "pub")]
    mass_kg: f64,
    /// Mass centre c in the reference frame, m.
    #[getset(get_copy = "pub")]
    mass_centre_m: Vector3<f64>,
    /// Inertia about the mass centre, axes parallel to the reference frame, kg·m².
    #[getset(get = "pub")]
    inertia: Inertia,
}

impl MassProperties {
    /// Takes the mass (kg), the mass centre (m) and the inertia about it (kg·m²).
    ///
    /// # Errors
    /// The mass is not positive and finite, or a coordinate not finite or beyond [`MAX_LENGTH`].
    pub fn new(
        mass_kg: f64,
        mass_centre_m: impl Into<Vector3<f64>>,
        inertia: Inertia,
    ) -> Result<Self, MassPropertiesError> {
        let centre = mass_centre_m.into();
        check_mass(mass_kg)?;
        check_vector("mass centre", &centre)?;
        Ok(Self { mass_kg, mass_centre_m: centre, inertia })
    }

    /// A point mass (kg) at `position_m`.
    ///
    /// # Errors
    /// As [`MassProperties::new`].
    pub fn point(
        mass_kg: f64,
        position_m: impl Into<Vector3<f64>>,
    ) -> Result<Self, MassPropertiesError> {
        Self::new(mass_kg, position_m, Inertia::new(Matrix3::zeros())?)
    }

    /// Takes an inertia about `point_m` (both in the reference frame and its axes) in place of the
    /// one about the mass centre: I_c = I_p − m (|d|²·1 − d dᵀ) with d = c − p, the parallel axis
    /// theorem. What is below zero by [`RELATIVE_TOLERANCE`](crate::RELATIVE_TOLERANCE) of I_p is zero.
    ///
    /// # Errors
    /// As [`MassProperties::new`], or I_c is no body's
    /// ([`AboutMassCentre`](MassPropertiesError::AboutMassCentre)).
    pub fn from_inertia_about(
        point_m: impl Into<Vector3<f64>>,
        mass_kg: f64,
        mass_centre_m: impl Into<Vector3<f64>>,
        inertia: impl Into<InertiaMatrix>,
    ) -> Result<Self, MassPropertiesError> {
        let (point, centre, about) = (point_m.into(), mass_centre_m.into(), inertia.into());
        check_mass(mass_kg)?;
        check_vector("point", &point)?;
        check_vector("mass centre", &centre)?;
        let moved = point_inertia(mass_kg, &(centre - point));
        let size = about.matrix().amax().max(moved.amax());
        let inertia = remainder(about.matrix() - moved, size)
            .map_err(MassPropertiesError::AboutMassCentre)?;
        Self::new(mass_kg, centre, inertia)
    }

    /// Inertia about `point_m`, kg·m²: I_p = I_c + m (|d|²·1 − d dᵀ) with d = c − p, axes parallel
    /// to the reference frame.
    ///
    /// # Errors
    /// The point is not finite or too far, or an entry is too large.
    pub fn inertia_about(
        &self,
        point_m: impl Into<Vector3<f64>>,
    ) -> Result<InertiaMatrix, MassPropertiesError> {
        let point = point_m.into();
        check_vector("point", &point)?;
        let moved = point_inertia(self.mass_kg, &(self.mass_centre_m - point));
        Ok(InertiaMatrix::new(self.inertia.matrix() + moved)?)
    }

    /// Radii of gyration √(K_k/m) about the principal axes through the mass centre, in the order
    /// of [`Inertia::principal_axes`], in m.
    ///
    /// # Errors
    /// A radius overflows.
    pub fn radii_of_gyration(&self) -> Result<RadiiOfGyration, SecondMomentsError> {
        self.inertia.second_moments().radii_of_gyration(self.mass_kg)
    }

    /// The same body in another frame, or after a motion: x becomes R x + t, where `pose` is
    /// (R, t). With the pose of a part's frame in the vehicle's, a part described in its own frame
    /// is then described in the vehicle's.
    ///
    /// # Errors
    /// The rotation is not a unit quaternion, or the new mass centre not finite or too far.
    pub fn transformed(&self, pose: &Isometry3<f64>) -> Result<Self, MassPropertiesError> {
        // First, because it judges the quaternion.
        let inertia = self.inertia.rotated(&pose.rotation)?;
        let rotation = UnitQuaternion::new_normalize(pose.rotation.into_inner());
        Self::new(self.mass_kg, rotation * self.mass_centre_m + pose.translation.vector, inertia)
    }

    /// The same body turned about the origin: x becomes R x.
    ///
    /// # Errors
    /// The rotation is not a unit quaternion.
    pub fn rotated(&self, rotation: &UnitQuaternion<f64>) -> Result<Self, MassPropertiesError> {
        self.transformed(&Isometry3::from_parts(Vector3::zeros().into(), *rotation))
    }

    /// The same body moved: x becomes x + t, t in m.
    ///
    /// # Errors
    /// The new mass centre is not finite or too far.
    pub fn translated(
        &self,
        translation_m: impl Into<Vector3<f64>>,
    ) -> Result<Self, MassPropertiesError> {
        Self::new(self.mass_kg, self.mass_centre_m + translation_m.into(), self.inertia)
    }

    /// The same shape, everywhere `factor` times as dense.
    ///
    /// # Errors
    /// The factor is not positive and finite, or mass or inertia leave their range.
    pub fn scaled_density(&self, factor: f64) -> Result<Self, MassPropertiesError> {
        if !(factor > 0.0 && factor.is_finite()) {
            return Err(MassPropertiesError::Factor { value: factor });
        }
        let mass = self.mass_kg * factor;
        check_mass(mass).and_then(|()| check_lost("mass, kg", mass))?;
        let inertia = nearest(self.inertia.matrix() * factor)?;
        Self::new(mass, self.mass_centre_m, self.kept(inertia)?)
    }

    /// The same shape of another mass (kg).
    ///
    /// # Errors
    /// The mass is not positive and finite, or the inertia leaves its range.
    pub fn with_mass(&self, mass_kg: f64) -> Result<Self, MassPropertiesError> {
        check_mass(mass_kg)?;
        let (factor, own) = (mass_kg / self.mass_kg, self.inertia.matrix());
        let scaled = if factor.is_normal() {
            own * factor
        } else {
            // Masses at opposite ends of the range: I/m is not, being squares of lengths.
            own.map(|x| x / self.mass_kg * mass_kg)
        };
        Self::new(mass_kg, self.mass_centre_m, self.kept(nearest(scaled)?)?)
    }

    /// A scaled inertia, unless one that was not zero has lost its digits.
    fn kept(&self, inertia: Inertia) -> Result<Inertia, MassPropertiesError> {
        if self.inertia.matrix().amax() > 0.0 {
            check_lost(INERTIA, inertia.matrix().amax())?;
        }
        Ok(inertia)
    }
}

/// The mass must be positive and finite.
pub(crate) fn check_mass(value: f64) -> Result<(), MassPropertiesError> {
    if value > 0.0 && value.is_finite() { Ok(()) } else { Err(MassPropertiesError::Mass { value }) }
}

/// The inertia as [`MassPropertiesError::Lost`] names it.
pub(crate) const INERTIA: &str = "largest moment of inertia, kg·m²";

/// Of a result that is not zero: it must be a normal float.
pub(crate) fn check_lost(field: &'static str, value: f64) -> Result<(), MassPropertiesError> {
    if value < f64::MIN_POSITIVE { Err(MassPropertiesError::Lost { field, value }) } else { Ok(()) }
}

/// Coordinates must be finite and in range.
pub(crate) fn check_vector(
    field: &'static str,
    vector: &Vector3<f64>,
) -> Result<(), MassPropertiesError> {
    // Negated so that NaN is refused too.
    match vector.iter().position(|x| !(x.abs() <= MAX_LENGTH)) {
        Some(i) => Err(MassPropertiesError::Coordinate { field, axis: i + 1, value: vector[i] }),
        None => Ok(()),
    }
}

/// The serialized form.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Fields {
    mass_kg: f64,
    mass_centre_m: [f64; 3],
    inertia_kg_m2: Inertia,
}

#[cfg(feature = "serde")]
impl TryFrom<Fields> for MassProperties {
    type Error = MassPropertiesError;

    fn try_from(fields: Fields) -> Result<Self, MassPropertiesError> {
        Self::new(fields.mass_kg, fields.mass_centre_m, fields.inertia_kg_m2)
    }
}

#[cfg(feature = "serde")]
impl From<MassProperties> for Fields {
    fn from(body: MassProperties) -> Self {
        Self {
            mass_kg: body.mass_kg,
            mass_centre_m: body.mass_centre_m.into(),
            inertia_kg_m2: body.inertia,
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::SecondMoments;
    use proptest::prelude::*;

    pub(crate) fn any_attitude() -> impl Strategy<Value = UnitQuaternion<f64>> {
        prop::array::uniform3(-3.0..3.0f64)
            .prop_map(|v| UnitQuaternion::from_scaled_axis(Vector3::from(v)))
    }

    /// Bodies of all proportions, a few metres from the origin.
    pub(crate) fn any_body() -> impl Strategy<Value = MassProperties> {
        let k = prop::array::uniform3(0.0..9.0f64);
        let c = prop::array::uniform3(-5.0..5.0f64);
        (0.1..10.0f64, c, k, any_attitude()).prop_map(|(mass, c, k, q)| {
            let k = SecondMoments::new(k).unwrap();
            MassProperties::new(mass, c, Inertia::from_second_moments(k, &q).unwrap()).unwrap()
        })
    }

    /// Largest difference of mass (kg), mass centre (m) and inertia (kg·m²).
    pub(crate) fn distance(a: &MassProperties, b: &MassProperties) -> f64 {
        let inertia = (a.inertia.matrix() - b.inertia.matrix()).amax();
        (a.mass_kg - b.mass_kg).abs().max((a.mass_centre_m - b.mass_centre_m).amax()).max(inertia)
    }

    /// Meriam & Kraige, *Engineering Mechanics: Dynamics*, App. D: a slender rod, m l²/12 about
    /// its middle and m l²/3 about its end.
    #[test]
    fn a_rod_about_its_end() {
        let rod = Inertia::new(Matrix3::from_diagonal(&Vector3::new(0.0, 1.0, 1.0))).unwrap();
        let rod = MassProperties::new(3.0, [1.0, 0.0, 0.0], rod).unwrap();
        let end = rod.inertia_about([0.0; 3]).unwrap();
        assert_eq!(end.entries(), [0.0, 4.0, 4.0, 0.0, 0.0, 0.0]);
        let back = MassProperties::from_inertia_about([0.0; 3], 3.0, [1.0, 0.0, 0.0], end).unwrap();
        assert_eq!(back, rod);
    }

    #[test]
    fn too_little_inertia_for_the_distance_is_refused() {
        // 3 kg at 1 m need 3 kg·m² about the origin.
        let about = InertiaMatrix::from_entries([1.0, 2.9, 3.5], [0.0; 3]).unwrap();
        let error =
            MassProperties::from_inertia_about([0.0; 3], 3.0, [1.0, 0.0, 0.0], about).unwrap_err();
        assert!(matches!(error, MassPropertiesError::AboutMassCentre(_)));
        assert!(error.to_string().starts_with("less the parallel axis term"), "{error}");
    }

    #[test]
    fn numbers_of_no_body_are_refused_by_name() {
        let inertia = Inertia::new(Matrix3::identity()).unwrap();
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let error = MassProperties::new(bad, [0.0; 3], inertia).unwrap_err();
            assert!(error.to_string().starts_with("mass = "), "{error}");
            assert!(MassProperties::point(bad, [0.0; 3]).is_err());
            let ball = MassProperties::new(1.0, [0.0; 3], inertia).unwrap();
            assert!(ball.scaled_density(bad).is_err() && ball.with_mass(bad).is_err());
        }
        for bad in [f64::NAN, f64::NEG_INFINITY, 1e101, -1e300] {
            let error = MassProperties::new(1.0, [0.0, 0.0, bad], inertia).unwrap_err();
            assert!(error.to_string().starts_with("mass centre, axis 3 = "), "{error}");
            let ball = MassProperties::new(1.0, [0.0; 3], inertia).unwrap();
            assert!(ball.inertia_about([bad, 0.0, 0.0]).is_err());
            assert!(ball.translated([bad, 0.0, 0.0]).is_err());
        }
        let long = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(2.0, 0.0, 0.0, 0.0));
        assert!(MassProperties::point(1.0, [1.0; 3]).unwrap().rotated(&long).is_err());
        let heavy = MassProperties::new(1e300, [0.0; 3], inertia).unwrap();
        assert!(heavy.scaled_density(1e10).is_err());
        assert!(heavy.inertia_about([1e10, 0.0, 0.0]).is_err(), "entries overflow");
        let light = MassProperties::new(1e-300, [0.0; 3], inertia).unwrap();
        assert!(light.scaled_density(1e-300).is_err(), "no mass is left");
    }

    proptest! {
        #[test]
        fn parallel_axes_there_and_back(
            body in any_body(),
            point in prop::array::uniform3(-20.0..20.0f64),
        ) {
            let about = body.inertia_about(point).unwrap();
            let back =
                MassProperties::from_inertia_about(point, body.mass_kg, body.mass_centre_m, about).unwrap();
            prop_assert!(distance(&body, &back) < 1e-13 * about.matrix().amax());
            // About no point is a moment of inertia smaller than about the mass centre.
            let rise = about.matrix().diagonal() - body.inertia.matrix().diagonal();
            prop_assert!(rise.min() >= 0.0);
        }

        /// Steiner's term with a flipped product would not follow the frame.
        #[test]
        fn inertia_about_a_point_turns_with_the_frame(
            body in any_body(),
            q in any_attitude(),
            point in prop::array::uniform3(-9.0..9.0f64),
        ) {
            let here = body.inertia_about(point).unwrap().rotated(&q).unwrap();
            let there = body.rotated(&q).unwrap();
            let turned = there.inertia_about(q * Vector3::from(point)).unwrap();
            prop_assert!((here.matrix() - turned.matrix()).amax() < 1e-12 * here.matrix().amax());
            // The control: products of the wrong sign.
            let [i11, i22, i33, i12, i13, i23] = body.inertia_about(point).unwrap().entries();
            let wrong = InertiaMatrix::from_entries([i11, i22, i33], [-i12, -i13, -i23]).unwrap();
            let wrong = wrong.rotated(&q).unwrap();
            let products = i12.abs().max(i13.abs()).max(i23.abs());
            prop_assume!(products > 1e-3);
            prop_assert!((wrong.matrix() - turned.matrix()).amax() > 1e-4 * products);
        }

        #[test]
        fn motions_compose_and_come_back(
            body in any_body(),
            (q, t) in (any_attitude(), prop::array::uniform3(-9.0..9.0f64)),
            (p, s) in (any_attitude(), prop::array::uniform3(-9.0..9.0f64)),
        ) {
            let a = Isometry3::from_parts(Vector3::from(t).into(), q);
            let b = Isometry3::from_parts(Vector3::from(s).into(), p);
            let twice = body.transformed(&a).unwrap().transformed(&b).unwrap();
            prop_assert!(distance(&twice, &body.transformed(&(b * a)).unwrap()) < 1e-12);
            let back = body.transformed(&a).unwrap().transformed(&a.inverse()).unwrap();
            prop_assert!(distance(&body, &back) < 1e-12);
        }

        #[test]
        fn density_scales_mass_and_inertia_and_no_length(body in any_body(), f in 1e-3..1e3f64) {
            let dense = body.scaled_density(f).unwrap();
            let a = body.radii_of_gyration().unwrap().values();
            let b = dense.radii_of_gyration().unwrap().values();
            prop_assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6));
            prop_assert!(distance(&dense.with_mass(body.mass_kg).unwrap(), &body) < 1e-12);
        }

        /// Powers of two in place of mass and size: every result is right to the bit, or refused.
        #[test]
        fn bodies_keep_their_digits_over_the_range_of_floats(
            (mass, other, size) in (-1074..1024i32, -1074..1024i32, -600..330i32),
            sides in prop::array::uniform3(1..9u8),
        ) {
            let power = |e: i32| 2f64.powi(e / 2) * 2f64.powi(e - e / 2);
            let exact = |unit: f64, e: i32| {
                // In two steps, so that only the last can leave the range.
                unit * power(e / 2) * power(e - e / 2)
            };
            let sides = sides.map(f64::from);
            let own = crate::Shape::solid_box(sides).unwrap().of_mass(1.0).unwrap();
            // The last bit of the smallest numbers may be lost, and grows with a body that is made of such a one.
            let check = |found: Result<MassProperties, MassPropertiesError>, mass: i32, grown: i32| {
                let largest = exact(own.inertia().matrix().amax(), mass + 2 * size);
                match found {
                    Ok(body) => {
                        prop_assert_eq!(body.mass_kg(), power(mass));
                        let expected = own.inertia().matrix().map(|x| exact(x, mass + 2 * size));
                        let off = (body.inertia().matrix() - expected).amax();
                        prop_assert!(largest >= f64::MIN_POSITIVE && off <= exact(5e-324, grown.max(0)), "{}", off);
                        let sides_m = body.equivalent_box().unwrap().sizes_m();
                        // The order of the axes does not matter here, and near equal ones turn.
                        let mut found = sides_m.map(|x| x / power(size));
                        let mut sides = sides;
                        found.sort_by(f64::total_cmp);
                        sides.sort_by(f64::total_cmp);
                        for (a, b) in found.iter().zip(sides) {
                            prop_assert!((a - b).abs() < 1e-6, "{:?} {:?}", found, sides);
                        }
                    }
                    Err(MassPropertiesError::Lost { value, .. }) => {
                        prop_assert!(value < f64::MIN_POSITIVE && largest < 2e-307, "{:e}", largest);
                    }
                    Err(error) => prop_assert!(largest > 1e305, "{} {:e}", error, largest),
                }
                Ok(())
            };
            let shape = crate::Shape::solid_box(sides.map(|x| x * power(size))).unwrap();
            let body = shape.of_mass(power(mass));
            check(body, mass, 0)?;
            if let Ok(body) = body {
                check(body.with_mass(power(other)), other, other - mass)?;
                let dense = body.scaled_density(power(other));
                let total = mass + other;
                if (-1022..1024).contains(&total) {
                    check(dense, total, other)?;
                } else {
                    prop_assert!(dense.is_err());
                }
            }
        }

        #[test]
        fn no_input_panics(
            x in prop::array::uniform9(prop::num::f64::ANY),
            q in prop::array::uniform4(prop::num::f64::ANY),
        ) {
            let [mass, a, b, c, d, e, f, g, h] = x;
            let about = InertiaMatrix::from_entries([d, e, f], [g, h, a]);
            let about = about.unwrap_or(InertiaMatrix::new(Matrix3::identity()).unwrap());
            let _ = MassProperties::from_inertia_about([d, e, f], mass, [a, b, c], about);
            if let Ok(body) = MassProperties::point(mass, [a, b, c]) {
                let q = UnitQuaternion::new_unchecked(nalgebra::Vector4::from(q).into());
                let _ = (body.rotated(&q), body.translated([g, h, a]), body.inertia_about([d, e, f]));
                let _ = (body.scaled_density(d), body.with_mass(e), body.radii_of_gyration());
            }
        }
    }

    #[cfg(feature = "serde")]
    #[test]
    fn serde_goes_through_the_constructor() {
        let body = MassProperties::point(2.0, [1.0, 0.0, 0.5]).unwrap();
        let json = serde_json::to_string(&body).unwrap();
        assert!(
            json.starts_with(r#"{"mass_kg":2.0,"mass_centre_m":[1.0,0.0,0.5],"inertia_kg_m2":"#)
        );
        assert_eq!(serde_json::from_str::<MassProperties>(&json).unwrap(), body);
        assert!(serde_json::from_str::<MassProperties>(&json.replace("2.0", "-2.0")).is_err());
        let extra = json.replace("\"mass_kg\"", "\"colour\":1,\"mass_kg\"");
        assert!(serde_json::from_str::<MassProperties>(&extra).is_err());
    }
}
