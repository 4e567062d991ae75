//! Why numbers are no region.

use crate::MassPropertiesError;

/// Why numbers are no region.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RegionError {
    /// A size is not positive, or out of range.
    #[error("{field} {axis} = {value:?} m: it must lie in [1e-100, 1e100]")]
    Size {
        /// Which.
        field: &'static str,
        /// Axis, from 1.
        axis: usize,
        /// The value, m.
        value: f64,
    },
    /// The middle is none.
    #[error(transparent)]
    Middle(#[from] MassPropertiesError),
    /// A point is none.
    #[error("point {point}: {error}")]
    Point {
        /// Point, from 0.
        point: usize,
        /// What is wrong with it.
        error: MassPropertiesError,
    },
    /// A file says no shape.
    #[error("there is no shape: it must have one of ellipsoid, box and hull")]
    NoShape,
    /// A file says two shapes.
    #[error("it has {first} and {second}: it must have one of ellipsoid, box and hull")]
    Shapes {
        /// One of them.
        first: &'static str,
        /// Another one.
        second: &'static str,
    },
    /// There are no points.
    #[error("no points: a hull has at least one")]
    Empty,
    /// Points in a plane have no smallest ellipsoid.
    #[error("all points lie in a plane, or nearly so: an ellipsoid about them has no volume")]
    Flat,
    /// The quaternion is not of unit length.
    #[error("rotation of length {norm:?}: it must be 1")]
    Rotation {
        /// Its length.
        norm: f64,
    },
}
