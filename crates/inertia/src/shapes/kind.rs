//! The shapes, their sizes, and their integrals in closed form.

use std::f64::consts::PI;

use super::{Measure, ShapeError};
use crate::MAX_LENGTH;

/// The shapes and their sizes, which is also their serialized form.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "shape", rename_all = "snake_case", deny_unknown_fields))]
pub(super) enum Kind {
    #[cfg_attr(feature = "serde", serde(alias = "box"))]
    SolidBox {
        sides_m: [f64; 3],
    },
    BoxShell {
        sides_m: [f64; 3],
    },
    Plate {
        sides_m: [f64; 2],
    },
    Rod {
        length_m: f64,
    },
    Cylinder {
        radius_m: f64,
        height_m: f64,
    },
    Tube {
        inner_radius_m: f64,
        outer_radius_m: f64,
        height_m: f64,
    },
    CylinderShell {
        radius_m: f64,
        height_m: f64,
    },
    Disc {
        radius_m: f64,
    },
    #[cfg_attr(feature = "serde", serde(alias = "ball"))]
    Sphere {
        radius_m: f64,
    },
    HollowSphere {
        inner_radius_m: f64,
        outer_radius_m: f64,
    },
    SphereShell {
        radius_m: f64,
    },
    Hemisphere {
        radius_m: f64,
    },
    HemisphereShell {
        radius_m: f64,
    },
    Ellipsoid {
        semi_axes_m: [f64; 3],
    },
    Cone {
        radius_m: f64,
        height_m: f64,
    },
    ConeShell {
        radius_m: f64,
        height_m: f64,
    },
    Frustum {
        base_radius_m: f64,
        top_radius_m: f64,
        height_m: f64,
    },
    FrustumShell {
        base_radius_m: f64,
        top_radius_m: f64,
        height_m: f64,
    },
    Torus {
        centre_line_radius_m: f64,
        section_radius_m: f64,
    },
}

/// K_k/m as a factor times the square of a length.
type Square = (f64, f64);

impl Kind {
    /// Sizes in range, and in the order that the shape needs.
    pub(super) fn check(&self) -> Result<(), ShapeError> {
        let checked = |field: &'static str, index: Option<usize>, value: f64| {
            // Negated so that NaN is refused too.
            if (0.0..=MAX_LENGTH).contains(&value) {
                Ok(())
            } else {
                Err(ShapeError::Size { field, index, value })
            }
        };
        let size = |field: &'static str, value: f64| checked(field, None, value);
        let sizes = |field: &'static str, values: &[f64]| {
            let mut values = values.iter().enumerate();
            values.try_for_each(|(i, &value)| checked(field, Some(i), value))
        };
        let order = |inner_field, inner: f64, outer_field, outer: f64| {
            if inner <= outer {
                Ok(())
            } else {
                Err(ShapeError::Order { inner_field, inner, outer_field, outer })
            }
        };
        match *self {
            Self::SolidBox { sides_m } | Self::BoxShell { sides_m } => sizes("sides_m", &sides_m),
            Self::Plate { sides_m } => sizes("sides_m", &sides_m),
            Self::Ellipsoid { semi_axes_m } => sizes("semi_axes_m", &semi_axes_m),
            Self::Rod { length_m } => size("length_m", length_m),
            Self::Disc { radius_m }
            | Self::Sphere { radius_m }
            | Self::SphereShell { radius_m }
            | Self::Hemisphere { radius_m }
            | Self::HemisphereShell { radius_m } => size("radius_m", radius_m),
            Self::Cylinder { radius_m, height_m }
            | Self::CylinderShell { radius_m, height_m }
            | Self::Cone { radius_m, height_m }
            | Self::ConeShell { radius_m, height_m } => {
                size("radius_m", radius_m)?;
                size("height_m", height_m)
            }
            Self::Tube { inner_radius_m, outer_radius_m, height_m } => {
                size("height_m", height_m)?;
                Self::HollowSphere { inner_radius_m, outer_radius_m }.check()
            }
            Self::HollowSphere { inner_radius_m, outer_radius_m } => {
                size("inner_radius_m", inner_radius_m)?;
                size("outer_radius_m", outer_radius_m)?;
                order("inner_radius_m", inner_radius_m, "outer_radius_m", outer_radius_m)
            }
            Self::Frustum { base_radius_m, top_radius_m, height_m }
            | Self::FrustumShell { base_radius_m, top_radius_m, height_m } => {
                size("base_radius_m", base_radius_m)?;
                size("top_radius_m", top_radius_m)?;
                size("height_m", height_m)?;
                if base_radius_m.max(top_radius_m) > 0.0 {
                    Ok(())
                } else {
                    Err(ShapeError::NoRadius)
                }
            }
            Self::Torus { centre_line_radius_m: centre, section_radius_m: section } => {
                size("centre_line_radius_m", centre)?;
                size("section_radius_m", section)?;
                order("section_radius_m", section, "centre_line_radius_m", centre)
            }
        }
    }

    pub(super) fn measure(&self) -> Measure {
        match *self {
            Self::SolidBox { sides_m: [a, b, c] } => Measure::Volume(a * b * c),
            Self::BoxShell { sides_m: [a, b, c] } => Measure::Area(2.0 * (a * b + b * c + c * a)),
            Self::Plate { sides_m: [a, b] } => Measure::Area(a * b),
            Self::Rod { length_m } => Measure::Length(length_m),
            Self::Cylinder { radius_m: r, height_m: h } => Measure::Volume(PI * r * r * h),
            Self::Tube { inner_radius_m: a, outer_radius_m: b, height_m: h } => {
                Measure::Volume(PI * (b - a) * (b + a) * h)
            }
            Self::CylinderShell { radius_m: r, height_m: h } => Measure::Area(2.0 * PI * r * h),
            Self::Disc { radius_m: r } => Measure::Area(PI * r * r),
            Self::Sphere { radius_m: r } => Measure::Volume(4.0 / 3.0 * PI * r * r * r),
            Self::HollowSphere { inner_radius_m: a, outer_radius_m: b } => {
                Measure::Volume(4.0 / 3.0 * PI * (b - a) * (b * b + a * b + a * a))
            }
            Self::SphereShell { radius_m: r } => Measure::Area(4.0 * PI * r * r),
            Self::Hemisphere { radius_m: r } => Measure::Volume(2.0 / 3.0 * PI * r * r * r),
            Self::HemisphereShell { radius_m: r } => Measure::Area(2.0 * PI * r * r),
            Self::Ellipsoid { semi_axes_m: [a, b, c] } => {
                Measure::Volume(4.0 / 3.0 * PI * a * b * c)
            }
            Self::Cone { radius_m: a, height_m: h } => Measure::Volume(PI / 3.0 * a * a * h),
            Self::ConeShell { radius_m: a, height_m: h } => {
                Measure::Area(PI * a * libm::hypot(a, h))
            }
            Self::Frustum { base_radius_m: a, top_radius_m: b, height_m: h } => {
                Measure::Volume(PI / 3.0 * (a * a + a * b + b * b) * h)
            }
            Self::FrustumShell { base_radius_m: a, top_radius_m: b, height_m: h } => {
                Measure::Area(PI * (a + b) * libm::hypot(h, a - b))
            }
            Self::Torus { centre_line_radius_m: a, section_radius_m: r } => {
                Measure::Volume(2.0 * PI * PI * a * r * r)
            }
        }
    }

    /// Height of the mass centre, and K_k/m about it on each axis.
    pub(super) fn distribution(&self) -> (f64, [Square; 3]) {
        let box_of = |sides: [f64; 3]| (0.0, sides.map(|side| (1.0 / 12.0, side)));
        // A shape of revolution: the squares across and along the axis.
        let about = |centre: f64, across: Square, along: Square| (centre, [across, across, along]);
        match *self {
            Self::SolidBox { sides_m } => box_of(sides_m),
            Self::Plate { sides_m: [a, b] } => box_of([a, b, 0.0]),
            Self::Rod { length_m } => box_of([0.0, 0.0, length_m]),
            Self::BoxShell { sides_m } => box_shell(sides_m),
            Self::Cylinder { radius_m: r, height_m: h } => about(0.0, (0.25, r), (1.0 / 12.0, h)),
            Self::Tube { inner_radius_m: a, outer_radius_m: b, height_m: h } => {
                let t = ratio(a, b);
                about(0.0, (0.25 * (1.0 + t * t), b), (1.0 / 12.0, h))
            }
            Self::CylinderShell { radius_m: r, height_m: h } => {
                about(0.0, (0.5, r), (1.0 / 12.0, h))
            }
            Self::Disc { radius_m: r } => about(0.0, (0.25, r), (0.0, r)),
            Self::Sphere { radius_m: r } => about(0.0, (0.2, r), (0.2, r)),
            Self::HollowSphere { inner_radius_m: a, outer_radius_m: b } => {
                // (b⁵ − a⁵) / 5 (b³ − a³), both divided by b − a: exact down to the thinnest wall.
                let t = ratio(a, b);
                let quartic = 1.0 + t * (1.0 + t * (1.0 + t * (1.0 + t)));
                let square = (0.2 * quartic / (1.0 + t * (1.0 + t)), b);
                about(0.0, square, square)
            }
            Self::SphereShell { radius_m: r } => about(0.0, (1.0 / 3.0, r), (1.0 / 3.0, r)),
            Self::Hemisphere { radius_m: r } => about(0.375 * r, (0.2, r), (19.0 / 320.0, r)),
            Self::HemisphereShell { radius_m: r } => {
                about(0.5 * r, (1.0 / 3.0, r), (1.0 / 12.0, r))
            }
            Self::Ellipsoid { semi_axes_m } => (0.0, semi_axes_m.map(|a| (0.2, a))),
            Self::Cone { radius_m: r, height_m: h } => about(0.25 * h, (0.15, r), (0.0375, h)),
            Self::ConeShell { radius_m: r, height_m: h } => {
                about(h / 3.0, (0.25, r), (1.0 / 18.0, h))
            }
            Self::Frustum { base_radius_m: a, top_radius_m: b, height_m: h } => {
                let r = a.max(b);
                let (a, b) = (a / r, b / r);
                let q = a * a + a * b + b * b;
                let (aa, ab, bb) = (a * a, a * b, b * b);
                let across = 0.15 * (aa * aa + ab * (aa + ab + bb) + bb * bb) / q;
                let along = aa * aa + ab * (4.0 * aa + 10.0 * ab + 4.0 * bb) + bb * bb;
                let centre = 0.25 * (aa + 2.0 * ab + 3.0 * bb) / q * h;
                about(centre, (across, r), (0.0375 * along / (q * q), h))
            }
            Self::FrustumShell { base_radius_m: a, top_radius_m: b, height_m: h } => {
                let r = a.max(b);
                let (a, b) = (a / r, b / r);
                let along = (a * a + 4.0 * a * b + b * b) / (18.0 * (a + b) * (a + b));
                let centre = (a + 2.0 * b) / (3.0 * (a + b)) * h;
                about(centre, (0.25 * (a * a + b * b), r), (along, h))
            }
            Self::Torus { centre_line_radius_m: a, section_radius_m: r } => {
                let t = ratio(r, a);
                about(0.0, (0.5 + 0.375 * t * t, a), (0.25, r))
            }
        }
    }
}

/// inner/outer of sizes in order; of a point it does not matter.
fn ratio(inner: f64, outer: f64) -> f64 {
    if outer > 0.0 { inner / outer } else { 0.0 }
}

/// Faces across an axis lie at half a side from the middle, the other four are spread along it:
/// K₁/m = a² (3bc + ab + ac) / 12 (ab + bc + ca).
fn box_shell(sides: [f64; 3]) -> (f64, [Square; 3]) {
    let size = sides[0].max(sides[1]).max(sides[2]);
    let [a, b, c] = sides.map(|side| ratio(side, size));
    let (bc, ca, ab) = (b * c, c * a, a * b);
    let area = bc + ca + ab;
    // Sides that leave no area leave a rod.
    let factor =
        |across: f64| if area > 0.0 { (1.0 + 2.0 * across / area) / 12.0 } else { 1.0 / 12.0 };
    (0.0, [(factor(bc), sides[0]), (factor(ca), sides[1]), (factor(ab), sides[2])])
}
