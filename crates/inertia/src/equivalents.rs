//! Solids of uniform density with given mass properties.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

#[cfg(feature = "serde")]
use crate::{MAX_LENGTH, read::belonging};
use crate::{MassProperties, Shape, ShapeError};

/// The solid of uniform density that has given mass properties: how large a body looks.
///
/// Sizes are along the principal axes, in the order of [`PrincipalAxes`](crate::PrincipalAxes).
#[derive(Clone, Copy, Debug, PartialEq, getset::CopyGetters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(remote = "Self", deny_unknown_fields))]
pub struct EquivalentSolid {
    /// The solid in its own frame, which is principal.
    #[getset(get_copy = "pub")]
    shape: Shape,
    /// Sides of the box, or semi-axes of the ellipsoid, m.
    #[getset(get_copy = "pub")]
    sizes_m: [f64; 3],
    centre: Vector3<f64>,
    /// The attitude q that takes body components to components along the solid's axes:
    /// I_B = R(q)ᵀ I_P R(q).
    #[getset(get_copy = "pub")]
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::read::unit"))]
    attitude: UnitQuaternion<f64>,
}

#[cfg(feature = "serde")]
belonging!(EquivalentSolid);

impl EquivalentSolid {
    fn of(
        body: &MassProperties,
        square: f64,
        shape: fn([f64; 3]) -> Result<Shape, ShapeError>,
    ) -> Result<Self, ShapeError> {
        let axes = body.inertia().principal_axes();
        // Rooting first keeps K/m from overflowing or underflowing.
        let root = square.sqrt() / body.mass_kg().sqrt();
        let sizes = axes.second_moments().map(|k| root * k.max(0.0).sqrt());
        let (centre, attitude) = (body.mass_centre_m(), axes.attitude());
        Ok(Self { shape: shape(sizes)?, sizes_m: sizes, centre, attitude })
    }

    /// Whether the sizes are those of the shape, a box or an ellipsoid, and the centre is one of a body.
    #[cfg(feature = "serde")]
    fn belongs_together(&self) -> bool {
        let shapes = [Shape::solid_box, Shape::ellipsoid].map(|shape| shape(self.sizes_m));
        shapes.contains(&Ok(self.shape)) && self.centre.iter().all(|x| x.abs() <= MAX_LENGTH)
    }

    /// Where the solid lies: takes points of its own frame to the reference frame of the body.
    #[must_use]
    pub fn pose(&self) -> Isometry3<f64> {
        Isometry3::from_parts(self.centre.into(), self.attitude.inverse())
    }
}

impl MassProperties {
    /// The solid box of uniform density with these mass properties: sides √(12 K_k/m), because a
    /// side a has K = m a²/12.
    ///
    /// # Errors
    /// A side is too large.
    ///
    /// ```
    /// use gyradius_inertia::{Inertia, MassProperties};
    ///
    /// let inertia = Inertia::try_from([[13.0, 0.0, 0.0], [0.0, 10.0, 0.0], [0.0, 0.0, 5.0]])?;
    /// let body = MassProperties::new(12.0, [0.0; 3], inertia)?;
    /// let sides = body.equivalent_box()?.sizes_m();
    /// assert!(sides.iter().zip([1.0, 2.0, 3.0]).all(|(a, b)| (a - b).abs() < 1e-14));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn equivalent_box(&self) -> Result<EquivalentSolid, ShapeError> {
        EquivalentSolid::of(self, 12.0, Shape::solid_box)
    }

    /// The solid ellipsoid of uniform density with these mass properties: semi-axes √(5 K_k/m),
    /// because a semi-axis a has K = m a²/5.
    ///
    /// # Errors
    /// A semi-axis is too large.
    pub fn equivalent_ellipsoid(&self) -> Result<EquivalentSolid, ShapeError> {
        EquivalentSolid::of(self, 5.0, Shape::ellipsoid)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mass_properties::tests::{any_body, distance};
    use crate::{Inertia, SecondMoments};
    use proptest::prelude::*;

    #[test]
    fn boundary_bodies_have_flat_equivalents_and_huge_ones_none() {
        let rod = Shape::rod(2.0).unwrap().of_mass(1.0).unwrap();
        let sides = rod.equivalent_box().unwrap().sizes_m();
        assert!(sides[0] == 0.0 && sides[1] == 0.0 && (sides[2] - 2.0).abs() < 1e-15);
        let k = SecondMoments::new([1e300; 3]).unwrap();
        let inertia = Inertia::from_second_moments(k, &UnitQuaternion::identity()).unwrap();
        let wide = MassProperties::new(1e-300, [0.0; 3], inertia).unwrap();
        assert!(matches!(wide.equivalent_box(), Err(ShapeError::Size { .. })));
    }

    proptest! {
        #[test]
        fn equivalents_have_the_mass_properties_they_stand_for(body in any_body()) {
            for solid in [body.equivalent_box().unwrap(), body.equivalent_ellipsoid().unwrap()] {
                let own = solid.shape().of_mass(body.mass_kg()).unwrap();
                let back = own.transformed(&solid.pose()).unwrap();
                prop_assert!(distance(&back, &body) < 1e-12);
            }
            let (solid, ball) = (body.equivalent_box().unwrap(), body.equivalent_ellipsoid().unwrap());
            for (side, semi_axis) in solid.sizes_m().iter().zip(ball.sizes_m()) {
                prop_assert!((side * (5.0f64 / 12.0).sqrt() - semi_axis).abs() < 1e-14 * 20.0);
            }
        }
    }
}
