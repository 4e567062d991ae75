//! Bodies of uniform density whose mass properties have closed forms.

mod kind;

use kind::Kind;

use crate::{
    Inertia, MAX_LENGTH, MassProperties, MassPropertiesError, RealizabilityError, SecondMoments,
    mass_properties::{INERTIA, check_lost, check_mass},
};

/// The place of a number in its field, counted from 1.
fn counted(index: Option<usize>) -> String {
    index.map_or_else(String::new, |index| format!("[{}]", index + 1))
}

/// Why sizes or a density do not make a body.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// A size is negative, NaN, infinite or too large.
    #[error("{field}{} = {value:?} m: it must lie in [0, {MAX_LENGTH:e}]", counted(*index))]
    Size {
        /// Which size.
        field: &'static str,
        /// Which of several sizes in that field, from 0; the message counts from 1.
        index: Option<usize>,
        /// The value, m.
        value: f64,
    },
    /// One size is larger than another that must hold it.
    #[error("{inner_field} = {inner:?} m: it must be at most {outer_field} = {outer:?} m")]
    Order {
        /// Which size is too large.
        inner_field: &'static str,
        /// Its value, m.
        inner: f64,
        /// Which size holds it.
        outer_field: &'static str,
        /// Its value, m.
        outer: f64,
    },
    /// Both radii of a frustum are zero: how the mass lies along the axis is not known.
    #[error("base_radius_m and top_radius_m are both 0: one must be positive")]
    NoRadius,
    /// A density is not positive and finite.
    #[error("density = {value:?} {unit}: it must be positive and finite")]
    Density {
        /// The value.
        value: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// A density is given to a body without volume, area or length.
    #[error("the body has no {measure}, and a density gives it no mass: give the mass")]
    NothingToFill {
        /// Volume, area or length.
        measure: &'static str,
    },
    /// The mass properties leave their range.
    #[error(transparent)]
    MassProperties(#[from] MassPropertiesError),
}

/// How much there is of a shape, of the dimension that its density refers to.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Measure {
    /// Of a solid, m³; density in kg/m³.
    Volume(#[cfg_attr(feature = "serde", serde(deserialize_with = "crate::read::size"))] f64),
    /// Of a thin shell or plate, m²; density in kg/m².
    Area(#[cfg_attr(feature = "serde", serde(deserialize_with = "crate::read::size"))] f64),
    /// Of a thin rod, m; density in kg/m.
    Length(#[cfg_attr(feature = "serde", serde(deserialize_with = "crate::read::size"))] f64),
}

impl Measure {
    /// The number: m³, m² or m.
    #[must_use]
    pub fn value(&self) -> f64 {
        match *self {
            Self::Volume(value) | Self::Area(value) | Self::Length(value) => value,
        }
    }

    fn names(&self) -> (&'static str, &'static str) {
        match self {
            Self::Volume(_) => ("volume", "kg/m³"),
            Self::Area(_) => ("area", "kg/m²"),
            Self::Length(_) => ("length", "kg/m"),
        }
    }

    /// Mass at a density in kg per m³, m² or m.
    pub(crate) fn mass_kg(&self, density: f64) -> Result<f64, ShapeError> {
        let (measure, unit) = self.names();
        if !(density > 0.0 && density.is_finite()) {
            return Err(ShapeError::Density { value: density, unit });
        }
        if self.value() == 0.0 {
            return Err(ShapeError::NothingToFill { measure });
        }
        Ok(density * self.value())
    }
}

/// A body of uniform density: sizes in m, in a frame of its own.
///
/// The origin is the centre of the shape and axis 3 its axis of symmetry, except for cones,
/// frustums and half spheres, whose origin is the centre of the base and which rise along +3.
/// *Shells* are thin: their mass lies on the surface, evenly by area, without end caps or lids.
/// Sizes may be zero: a box without height is a plate, a tube without hole a cylinder. The integrals
/// over the mass (Peck 2003, Eq. 3-4) are closed forms.
///
/// With feature `serde`, a table with the name of the constructor as `shape` and its arguments:
/// `{ shape = "cylinder", radius_m = 0.5, height_m = 2.0 }`.
///
/// ```
/// use gyradius_inertia::Shape;
///
/// // An aluminium adapter, 2 mm thick.
/// let adapter = Shape::frustum_shell(0.8, 0.6, 0.5)?.of_density(2700.0 * 0.002)?;
/// assert!((adapter.mass_kg() - 12.79).abs() < 0.01);
/// assert!((adapter.mass_centre_m().z - 0.238).abs() < 0.001);
/// # Ok::<(), gyradius_inertia::ShapeError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Kind", into = "Kind"))]
pub struct Shape(Kind);

macro_rules! constructors {
    ($($(#[$doc:meta])* $name:ident($($size:ident: $type:ty),*) $kind:ident;)*) => {
        /// Constructors. Every one fails if a size is negative, NaN or beyond [`MAX_LENGTH`]; what
        /// else is refused is said where it is.
        #[allow(clippy::missing_errors_doc, reason = "said once for all")]
        impl Shape {$(
            $(#[$doc])*
            pub fn $name($($size: $type),*) -> Result<Self, ShapeError> {
                Self::checked(Kind::$kind { $($size),* })
            }
        )*}

        impl Shape {
            /// The names of the sizes, in the order of the shapes: one that several shapes have stands there for each.
            pub const SIZES: &[&str] = &[$($(stringify!($size)),*),*];
        }
    };
}

constructors! {
    /// A solid box; sides along axes 1, 2, 3.
    solid_box(sides_m: [f64; 3]) SolidBox;
    /// The six thin faces of a box; sides along axes 1, 2, 3.
    box_shell(sides_m: [f64; 3]) BoxShell;
    /// A thin rectangular plate; sides along axes 1, 2.
    plate(sides_m: [f64; 2]) Plate;
    /// A thin rod along axis 3.
    rod(length_m: f64) Rod;
    /// A solid cylinder.
    cylinder(radius_m: f64, height_m: f64) Cylinder;
    /// A cylinder with a hole along its axis, no wider than itself.
    tube(inner_radius_m: f64, outer_radius_m: f64, height_m: f64) Tube;
    /// The thin wall of a cylinder.
    cylinder_shell(radius_m: f64, height_m: f64) CylinderShell;
    /// A thin circular plate across axis 3.
    disc(radius_m: f64) Disc;
    /// A solid sphere.
    sphere(radius_m: f64) Sphere;
    /// A sphere with a hollow in its middle, no wider than itself.
    hollow_sphere(inner_radius_m: f64, outer_radius_m: f64) HollowSphere;
    /// The thin surface of a sphere.
    sphere_shell(radius_m: f64) SphereShell;
    /// Half a solid sphere on its flat face.
    hemisphere(radius_m: f64) Hemisphere;
    /// Half the thin surface of a sphere, open below.
    hemisphere_shell(radius_m: f64) HemisphereShell;
    /// A solid ellipsoid; semi-axes along axes 1, 2, 3.
    ellipsoid(semi_axes_m: [f64; 3]) Ellipsoid;
    /// A solid cone on its base, its mass centre at a quarter of the height.
    cone(radius_m: f64, height_m: f64) Cone;
    /// The thin wall of a cone, its mass centre at a third of the height.
    cone_shell(radius_m: f64, height_m: f64) ConeShell;
    /// A solid truncated cone on its base. One radius must be positive.
    frustum(base_radius_m: f64, top_radius_m: f64, height_m: f64) Frustum;
    /// The thin wall of a truncated cone, open at both ends. One radius must be positive.
    frustum_shell(base_radius_m: f64, top_radius_m: f64, height_m: f64) FrustumShell;
    /// A solid torus about axis 3: the radius of its centre line, and that of its cross-section,
    /// which is no larger. With a cross-section of zero, a thin hoop.
    torus(centre_line_radius_m: f64, section_radius_m: f64) Torus;
}

impl Shape {
    fn checked(kind: Kind) -> Result<Self, ShapeError> {
        kind.check()?;
        Ok(Self(kind))
    }

    /// Volume, area or length, by which mass and density differ.
    #[must_use]
    pub fn measure(&self) -> Measure {
        self.0.measure()
    }

    /// Mass properties for a mass in kg, in the frame of the shape.
    ///
    /// # Errors
    /// The mass is not positive and finite, or the inertia too large, or so small that it would
    /// lose digits.
    pub fn of_mass(&self, mass_kg: f64) -> Result<MassProperties, MassPropertiesError> {
        check_mass(mass_kg)?;
        let (height, squares) = self.0.distribution();
        let moments = SecondMoments::new(
            squares.map(|(factor, length)| (mass_kg * length) * length * factor),
        )
        .map_err(RealizabilityError::from)?;
        if squares.iter().any(|(factor, length)| factor * length > 0.0) {
            check_lost(INERTIA, moments.principal_moments().into_iter().fold(0.0, f64::max))?;
        }
        let inertia = Inertia::from_second_moments(moments, &nalgebra::UnitQuaternion::identity())?;
        MassProperties::new(mass_kg, [0.0, 0.0, height], inertia)
    }

    /// Mass properties for a density in kg/m³ (solids), kg/m² (shells, plates, discs) or kg/m
    /// (rods), in the frame of the shape.
    ///
    /// # Errors
    /// The density is not positive and finite, the shape has no volume, area or length, or mass or
    /// inertia are too large.
    pub fn of_density(&self, density: f64) -> Result<MassProperties, ShapeError> {
        Ok(self.of_mass(self.measure().mass_kg(density)?)?)
    }
}

#[cfg(feature = "serde")]
impl TryFrom<Kind> for Shape {
    type Error = ShapeError;

    fn try_from(kind: Kind) -> Result<Self, ShapeError> {
        Self::checked(kind)
    }
}

#[cfg(feature = "serde")]
impl From<Shape> for Kind {
    fn from(shape: Shape) -> Self {
        shape.0
    }
}

#[cfg(test)]
mod tests;
