//! Regions that hold the matter of a link, made of its geometry.

use gyradius_inertia::{Containment, MassProperties, Region};
use nalgebra::{
    Isometry3, Matrix3, Matrix4, SymmetricEigen, Translation3, UnitQuaternion, Vector3, Vector4,
};
use std::fmt;

/// Steps towards the smallest ellipsoid.
const STEPS: usize = 2000;
/// How near to the smallest it is, in volume.
const NEAR: f64 = 1e-4;

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

    /// The region about points, nothing if they are flat or too large.
    pub(super) fn about(self, points: &[[f64; 3]]) -> Option<Region> {
        match self {
            Self::Hull => Region::hull(points).ok(),
            Self::Box => {
                let end = |pick: fn(f64, f64) -> f64| {
                    let all = points.iter().map(|p| Vector3::from(*p));
                    all.reduce(|a, b| a.zip_map(&b, pick))
                };
                let (low, high) = (end(f64::min)?, end(f64::max)?);
                Region::solid_box((low + high) * 0.5, (high - low) * 0.5).ok()
            }
            Self::Ellipsoid => smallest(points),
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

/// The smallest ellipsoid around points, to a part of its volume (Khachiyan 1996, doi:10.1287/moor.21.2.307), grown to hold
/// them all.
fn smallest(points: &[[f64; 3]]) -> Option<Region> {
    let all: Vec<Vector3<f64>> = points.iter().map(|p| Vector3::from(*p)).collect();
    let hull = Region::hull(points).ok()?;
    let outer = hull.outer_points_m()?;
    let n = outer.len();
    let lifted: Vec<Vector4<f64>> = outer.iter().map(|x| x.push(1.0)).collect();
    let mut weights = vec![1.0 / n as f64; n];
    for _ in 0..STEPS {
        let spread: Matrix4<f64> =
            lifted.iter().zip(&weights).map(|(x, w)| x * x.transpose() * *w).sum();
        let inverse = spread.try_inverse()?;
        let (place, most) = (0..n)
            .map(|j| (j, lifted[j].dot(&(inverse * lifted[j]))))
            .max_by(|a, b| a.1.total_cmp(&b.1))?;
        if !(most > 4.0 * (1.0 + NEAR)) {
            break;
        }
        let step = (most - 4.0) / (4.0 * (most - 1.0));
        weights.iter_mut().for_each(|weight| *weight *= 1.0 - step);
        weights[place] += step;
    }
    let middle: Vector3<f64> = outer.iter().zip(&weights).map(|(x, w)| x * *w).sum();
    let about = |x: &Vector3<f64>| (x - middle) * (x - middle).transpose();
    let spread: Matrix3<f64> = outer.iter().zip(&weights).map(|(x, w)| about(x) * *w).sum();
    let inverse = spread.try_inverse()?;
    let reach = all.iter().map(|x| (x - middle).dot(&(inverse * (x - middle)))).fold(0.0, f64::max);
    let eigen = SymmetricEigen::new(spread * reach);
    let mut axes = eigen.eigenvectors;
    if axes.determinant() < 0.0 {
        axes.column_mut(0).neg_mut();
    }
    let turn =
        UnitQuaternion::from_rotation_matrix(&nalgebra::Rotation3::from_matrix_unchecked(axes));
    // What rounding takes away.
    let semi_axes = eigen.eigenvalues.map(|x| x.max(0.0).sqrt() * (1.0 + 1e-9));
    let region = Region::ellipsoid(Vector3::zeros(), semi_axes).ok()?;
    region.transformed(&Isometry3::from_parts(Translation3::from(middle), turn)).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use gyradius_inertia::Shape;
    use proptest::prelude::*;

    proptest! {
        /// Points all around a known ellipsoid give that, and its box; bodies in it are held, and larger ones are not.
        #[test]
        fn regions_are_about_their_points(
            semi in prop::array::uniform3(0.05..2.0_f64),
            middle in prop::array::uniform3(-1.0..1.0_f64),
            turn in prop::array::uniform3(-1.0..1.0_f64),
        ) {
            let turn = UnitQuaternion::from_scaled_axis(Vector3::from(turn));
            let pose = Isometry3::from_parts(Translation3::from(Vector3::from(middle)), turn);
            let golden = 2.399963;
            let points: Vec<[f64; 3]> = (0..2000)
                .map(|i| {
                    let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 2000.0;
                    let (x, y) = ((golden * f64::from(i)).cos(), (golden * f64::from(i)).sin());
                    let unit = Vector3::new(x * (1.0 - z * z).sqrt(), y * (1.0 - z * z).sqrt(), z);
                    let p = pose * nalgebra::Point3::from(unit.component_mul(&Vector3::from(semi)));
                    p.coords.into()
                })
                .collect();
            let solid = |factor: f64| {
                let [a, b, c] = semi.map(|x| x * factor);
                // A third of the square of a semi-axis along each axis: on the limit of the ellipsoid.
                let body = Shape::solid_box([2.0 * a, 2.0 * b, 2.0 * c]).unwrap();
                body.of_mass(1.0).unwrap().transformed(&pose).unwrap()
            };
            for inside in Inside::ALL {
                let region = inside.about(&points).unwrap();
                prop_assert!(holds(&region, &solid(0.9)), "{inside}");
            }
            let ellipsoid = Inside::Ellipsoid.about(&points).unwrap();
            prop_assert!(!holds(&ellipsoid, &solid(1.03)));
        }
    }

    #[test]
    fn flat_geometry_has_no_ellipsoid() {
        let flat = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
        assert_eq!(Inside::Ellipsoid.about(&flat), None);
        assert_eq!(Inside::Box.about(&flat), None);
        assert_eq!(Inside::Box.about(&[]), None);
    }
}
