//! What of a body can touch the other: points, hulls and rings.

use nalgebra::{Unit, Vector3};
use std::sync::Arc;

/// Farthest that a point of an outline may lie from the mass centre, m.
const FARTHEST: f64 = 1e6;
/// Most points of an outline, those of all its shapes together: every point of one body may have to
/// be held against every point of the other.
const MOST_POINTS: usize = 1000;

/// A circle fixed in a body: an interface ring, the lip of a nozzle. The curve, not the disc: other
/// parts may pass through it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ring {
    pub(crate) centre: Vector3<f64>,
    /// Unit vector.
    pub(crate) axis: Vector3<f64>,
    pub(crate) radius: f64,
    /// Radius times unit vectors that make a right-handed triad with the axis.
    pub(crate) across: [Vector3<f64>; 2],
}

impl Ring {
    fn new(centre: Vector3<f64>, axis: Vector3<f64>, radius: f64) -> Self {
        let mut first = Vector3::zeros();
        first[axis.iamin()] = 1.0;
        let first = (first - axis * axis.dot(&first)).normalize();
        Self { centre, axis, radius, across: [first * radius, axis.cross(&first) * radius] }
    }

    /// The point at the angle with the given cosine and sine.
    pub(crate) fn point(&self, cos: f64, sin: f64) -> Vector3<f64> {
        self.centre + self.across[0] * cos + self.across[1] * sin
    }
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Kind {
    Points(Arc<[Vector3<f64>]>),
    Hull(Arc<[Vector3<f64>]>),
    Ring(Ring),
}

/// Part of the outline of a body: separate points, the convex hull of points, or a ring. Lengths in
/// m, from the mass centre, body axes.
///
/// # Which to take
/// * Points: pads, bolts, antenna tips, each for itself. There is nothing between them.
/// * Hull: anything solid. Two points make a rod, points in a plane a plate, a prism of 24 sides
///   stands for a cylinder; circumscribe it to be safe.
/// * Ring: a circle as a curve of no thickness, the edge of an adapter or a nozzle. It is hollow:
///   what passes through it touches nothing until it meets the edge. Where it should be closed, take
///   the hull of points on it.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "Fields", into = "Fields")
)]
pub struct OutlineShape {
    kind: Kind,
    radius: f64,
}

impl OutlineShape {
    /// Separate points, m.
    ///
    /// # Errors
    /// There are none or too many, or a coordinate is not finite or beyond 1e6 m.
    pub fn points(points_m: &[Vector3<f64>]) -> Result<Self, OutlineError> {
        checked_points("points_m", points_m).map(|p| Self::of(Kind::Points(p)))
    }

    /// The convex hull of points, m: a point, a rod, a plate or a body. Points inside it are allowed
    /// and cost time.
    ///
    /// # Errors
    /// There are none or too many, or a coordinate is not finite or beyond 1e6 m.
    pub fn hull(points_m: &[Vector3<f64>]) -> Result<Self, OutlineError> {
        checked_points("hull_m", points_m).map(|p| Self::of(Kind::Hull(p)))
    }

    /// A ring: centre in m, direction of its axis (of any length), radius in m.
    ///
    /// # Errors
    /// The centre is not finite or beyond 1e6 m, the axis has no direction, the radius is not positive
    /// or beyond 1e6 m.
    pub fn ring(
        centre_m: Vector3<f64>,
        axis: Vector3<f64>,
        radius_m: f64,
    ) -> Result<Self, OutlineError> {
        check("centre_m", &centre_m)?;
        // Scaled first, so that the squares neither overflow nor vanish. A unit vector stays as it is, so that a ring reads back.
        let largest = axis.amax();
        let is_unit = (axis.norm_squared() - 1.0).abs() <= 8.0 * f64::EPSILON;
        let unit = (largest > 1e-150 && largest.is_finite())
            .then(|| if is_unit { axis } else { Unit::new_normalize(axis / largest).into_inner() });
        let Some(unit) = unit.filter(|a| a.iter().all(|x| x.is_finite())) else {
            let entry = axis.iter().copied().find(|x| !x.is_finite());
            return Err(OutlineError::Axis { norm: entry.unwrap_or(largest) });
        };
        if !(radius_m > 0.0 && radius_m <= FARTHEST) {
            return Err(OutlineError::Radius { value: radius_m });
        }
        Ok(Self::of(Kind::Ring(Ring::new(centre_m, unit, radius_m))))
    }

    fn of(kind: Kind) -> Self {
        let radius = match &kind {
            Kind::Points(p) | Kind::Hull(p) => farthest(p),
            Kind::Ring(ring) => {
                // The farthest point of a ring lies where the centre's offset points, in its plane.
                let along = ring.centre.dot(&ring.axis);
                let aside = (ring.centre - ring.axis * along).norm();
                (along * along + (aside + ring.radius) * (aside + ring.radius)).sqrt()
            }
        };
        Self { kind, radius }
    }

    /// Distance of its farthest point from the mass centre, m.
    #[must_use]
    pub fn bounding_radius_m(&self) -> f64 {
        self.radius
    }

    pub(crate) fn kind(&self) -> &Kind {
        &self.kind
    }

    fn count(&self) -> usize {
        match &self.kind {
            Kind::Points(p) | Kind::Hull(p) => p.len(),
            Kind::Ring(_) => 1,
        }
    }

    fn moved(&self, by: &Vector3<f64>) -> Result<Self, OutlineError> {
        let all = |p: &[Vector3<f64>]| p.iter().map(|x| x + by).collect::<Vec<_>>();
        match &self.kind {
            Kind::Points(p) => Self::points(&all(p)),
            Kind::Hull(p) => Self::hull(&all(p)),
            Kind::Ring(r) => Self::ring(r.centre + by, r.axis, r.radius),
        }
    }
}

/// What of a body can touch the other: one or more shapes.
///
/// Cheap to clone: the points are shared.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "Vec<OutlineShape>", into = "Vec<OutlineShape>")
)]
pub struct Outline {
    shapes: Arc<[OutlineShape]>,
}

impl Outline {
    /// Of the given shapes.
    ///
    /// # Errors
    /// There are none, or they have more than 1,000 points together.
    pub fn new(shapes: impl Into<Vec<OutlineShape>>) -> Result<Self, OutlineError> {
        let shapes: Vec<OutlineShape> = shapes.into();
        if shapes.is_empty() {
            return Err(OutlineError::Empty { field: "outline" });
        }
        let count = shapes.iter().map(OutlineShape::count).sum();
        if count > MOST_POINTS {
            return Err(OutlineError::TooManyPoints { count });
        }
        Ok(Self { shapes: shapes.into() })
    }

    /// Its shapes.
    #[must_use]
    pub fn shapes(&self) -> &[OutlineShape] {
        &self.shapes
    }

    /// Distance of its farthest point from the mass centre, m.
    #[must_use]
    pub fn bounding_radius_m(&self) -> f64 {
        self.shapes.iter().map(OutlineShape::bounding_radius_m).fold(0.0, f64::max)
    }

    /// The same outline about a mass centre that lies off the old one by `offset_m` (body axes, m).
    ///
    /// # Errors
    /// A coordinate is not finite or beyond 1e6 m afterwards.
    pub fn about(&self, offset_m: Vector3<f64>) -> Result<Self, OutlineError> {
        if offset_m == Vector3::zeros() {
            return Ok(self.clone());
        }
        let by = -offset_m;
        self.shapes.iter().map(|s| s.moved(&by)).collect::<Result<Vec<_>, _>>().and_then(Self::new)
    }
}

impl TryFrom<Vec<OutlineShape>> for Outline {
    type Error = OutlineError;

    fn try_from(shapes: Vec<OutlineShape>) -> Result<Self, OutlineError> {
        Self::new(shapes)
    }
}

impl From<Outline> for Vec<OutlineShape> {
    fn from(outline: Outline) -> Self {
        outline.shapes.to_vec()
    }
}

impl From<OutlineShape> for Outline {
    fn from(shape: OutlineShape) -> Self {
        Self { shapes: [shape].into() }
    }
}

fn check(field: &'static str, point: &Vector3<f64>) -> Result<(), OutlineError> {
    match point.iter().find(|x| !(x.abs() <= FARTHEST)) {
        Some(&value) => Err(OutlineError::Coordinate { field, value }),
        None => Ok(()),
    }
}

fn checked_points(
    field: &'static str,
    points: &[Vector3<f64>],
) -> Result<Arc<[Vector3<f64>]>, OutlineError> {
    if points.is_empty() {
        return Err(OutlineError::Empty { field });
    }
    if points.len() > MOST_POINTS {
        return Err(OutlineError::TooManyPoints { count: points.len() });
    }
    points.iter().try_for_each(|p| check(field, p))?;
    Ok(points.into())
}

/// Distance of the farthest point from the mass centre.
pub(crate) fn farthest(points: &[Vector3<f64>]) -> f64 {
    points.iter().map(Vector3::norm_squared).fold(0.0, f64::max).sqrt()
}

/// The serialized form.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum Fields {
    PointsM(Vec<[f64; 3]>),
    HullM(Vec<[f64; 3]>),
    Ring { centre_m: [f64; 3], axis: [f64; 3], radius_m: f64 },
}

#[cfg(feature = "serde")]
impl TryFrom<Fields> for OutlineShape {
    type Error = OutlineError;

    fn try_from(fields: Fields) -> Result<Self, OutlineError> {
        let vectors = |p: Vec<[f64; 3]>| p.into_iter().map(Vector3::from).collect::<Vec<_>>();
        match fields {
            Fields::PointsM(p) => Self::points(&vectors(p)),
            Fields::HullM(p) => Self::hull(&vectors(p)),
            Fields::Ring { centre_m, axis, radius_m } => {
                Self::ring(centre_m.into(), axis.into(), radius_m)
            }
        }
    }
}

#[cfg(feature = "serde")]
impl From<OutlineShape> for Fields {
    fn from(shape: OutlineShape) -> Self {
        let arrays = |p: &[Vector3<f64>]| p.iter().map(|&x| x.into()).collect();
        match &shape.kind {
            Kind::Points(p) => Self::PointsM(arrays(p)),
            Kind::Hull(p) => Self::HullM(arrays(p)),
            Kind::Ring(r) => {
                Self::Ring { centre_m: r.centre.into(), axis: r.axis.into(), radius_m: r.radius }
            }
        }
    }
}

/// Why shapes are none, or make no outline.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OutlineError {
    /// A coordinate is not finite or absurdly far out.
    #[error(
        "{field} has coordinate {value:?} m: it must be within {FARTHEST:e} m of the mass centre"
    )]
    Coordinate {
        /// Which field.
        field: &'static str,
        /// The coordinate, m.
        value: f64,
    },
    /// The axis of a ring has no direction.
    #[error("ring axis of length {norm:?}: it must be finite and longer than 1e-150")]
    Axis {
        /// Its length.
        norm: f64,
    },
    /// The radius of a ring is not positive, or absurdly large.
    #[error("ring radius = {value:?} m: it must be positive and at most {FARTHEST:e} m")]
    Radius {
        /// The radius, m.
        value: f64,
    },
    /// A shape has no points, or an outline no shapes.
    #[error("{field} is empty: it must hold at least one entry")]
    Empty {
        /// Which field.
        field: &'static str,
    },
    /// More points than can be compared in reasonable time.
    #[error("{count} points in an outline: at most {MOST_POINTS} are allowed")]
    TooManyPoints {
        /// How many.
        count: usize,
    },
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn bad_shapes_are_refused() {
        let (o, z) = (Vector3::zeros(), Vector3::z());
        for bad in [f64::NAN, f64::INFINITY, -1e7, 1e300] {
            let p = Vector3::new(0.0, bad, 0.0);
            assert!(matches!(
                OutlineShape::points(&[o, p]),
                Err(OutlineError::Coordinate { field: "points_m", .. })
            ));
            assert!(matches!(
                OutlineShape::hull(&[p]),
                Err(OutlineError::Coordinate { field: "hull_m", .. })
            ));
            assert!(matches!(
                OutlineShape::ring(p, z, 1.0),
                Err(OutlineError::Coordinate { field: "centre_m", .. })
            ));
            assert!(matches!(OutlineShape::ring(o, z, bad), Err(OutlineError::Radius { .. })));
        }
        for bad in [0.0, f64::NAN, f64::INFINITY, 1e-200] {
            let axis = Vector3::new(0.0, bad, 0.0);
            assert!(
                matches!(OutlineShape::ring(o, axis, 1.0), Err(OutlineError::Axis { .. })),
                "{bad}"
            );
        }
        assert!(matches!(OutlineShape::ring(o, z, 0.0), Err(OutlineError::Radius { .. })));
        assert_eq!(OutlineShape::hull(&[]), Err(OutlineError::Empty { field: "hull_m" }));
        assert_eq!(Outline::new([]), Err(OutlineError::Empty { field: "outline" }));
        assert!(matches!(
            OutlineShape::points(&[o; 1001]),
            Err(OutlineError::TooManyPoints { count: 1001 })
        ));
        let half = OutlineShape::points(&[o; 600]).unwrap();
        assert!(matches!(
            Outline::new([half.clone(), half]),
            Err(OutlineError::TooManyPoints { count: 1200 })
        ));
    }

    #[test]
    fn moving_the_mass_centre_moves_the_points_the_other_way() {
        let outline: Outline = OutlineShape::hull(&[Vector3::x(), Vector3::y()]).unwrap().into();
        let moved = outline.about(Vector3::x()).unwrap();
        let expected =
            OutlineShape::hull(&[Vector3::zeros(), Vector3::new(-1.0, 1.0, 0.0)]).unwrap();
        assert_eq!(moved.shapes(), [expected]);
        assert!(outline.about(Vector3::new(f64::NAN, 0.0, 0.0)).is_err());
    }

    proptest! {
        #[test]
        fn rings_are_circles_within_their_bounding_radius(
            c in prop::array::uniform3(-5.0..5.0f64),
            a in prop::array::uniform3(-1.0..1.0f64),
            scale in -100..100i32,
            radius in 0.01..10.0f64,
        ) {
            let axis = Vector3::from(a) * 10.0_f64.powi(scale);
            prop_assume!(Vector3::from(a).norm() > 1e-3);
            let shape = OutlineShape::ring(c.into(), axis, radius).unwrap();
            let Kind::Ring(ring) = shape.kind() else { panic!() };
            // What is written of it reads back as it.
            prop_assert_eq!(&OutlineShape::ring(ring.centre, ring.axis, ring.radius).unwrap(), &shape);
            let mut largest = 0.0_f64;
            for i in 0..720 {
                let (sin, cos) = f64::from(i).to_radians().mul_add(0.5, 0.0).sin_cos();
                let p = ring.point(cos, sin);
                prop_assert!(((p - ring.centre).norm() - radius).abs() < 1e-13 * (1.0 + radius));
                prop_assert!((p - ring.centre).dot(&ring.axis).abs() < 1e-12 * (1.0 + radius));
                largest = largest.max(p.norm());
            }
            let bound = shape.bounding_radius_m();
            prop_assert!(largest <= bound * (1.0 + 1e-14) && largest > bound * (1.0 - 1e-4));
        }
    }

    #[cfg(feature = "serde")]
    #[test]
    fn serde_goes_through_the_constructors() {
        let text = r#"[{"hull_m":[[0.0,0.0,1.0],[1.0,0.0,1.0]]},
            {"ring":{"centre_m":[0.0,0.0,-1.0],"axis":[0.0,0.0,2.0],"radius_m":0.6}},
            {"points_m":[[1.0,2.0,3.0]]}]"#;
        let outline: Outline = serde_json::from_str(text).unwrap();
        assert_eq!(outline.shapes().len(), 3);
        let back = serde_json::to_string(&outline).unwrap();
        assert_eq!(serde_json::from_str::<Outline>(&back).unwrap(), outline);
        for bad in [
            "[]",
            r#"[{"hull_m":[]}]"#,
            r#"[{"ring":{"centre_m":[0,0,0],"axis":[0,0,0],"radius_m":1}}]"#,
            r#"[{"ring":{"centre_m":[0,0,0],"axis":[0,0,1],"radius_m":1,"width_m":1}}]"#,
            r#"[{"cone":{}}]"#,
        ] {
            assert!(serde_json::from_str::<Outline>(bad).is_err(), "{bad}");
        }
    }
}
