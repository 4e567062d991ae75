//! Regions that hold the matter of a link, made of its geometry.

use gyradius_inertia::{Containment, MassProperties, Region, RegionError};
use std::fmt;

/// What holds the matter of a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inside {
    /// The convex hull of its meshes and shapes.
    Hull,
    /// The box around these along the axes of the link.
    Box,
    /// The smallest ellipsoid around these.
    Ellipsoid,
}

impl Inside {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Hull, Self::Box, Self::Ellipsoid];

    /// What it is called.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Hull => "mesh",
            Self::Box => "box",
            Self::Ellipsoid => "ellipsoid",
        }
    }

    /// What it is, in a few words.
    #[must_use]
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Hull => "The convex hull of the meshes and shapes of the link",
            Self::Box => "The box around these along the axes of the link",
            Self::Ellipsoid => "The smallest ellipsoid around these",
        }
    }

    /// The region about points.
    pub(super) fn about(self, points: &[[f64; 3]]) -> Result<Region, RegionError> {
        match self {
            Self::Hull => Region::hull(points),
            Self::Box => Region::box_about(points),
            Self::Ellipsoid => Region::ellipsoid_about(points),
        }
    }
}

impl fmt::Display for Inside {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Whether matter in the region certainly can have these mass properties.
pub(super) fn holds(region: &Region, body: &MassProperties) -> bool {
    region.containment(body) == Containment::Possible
}
