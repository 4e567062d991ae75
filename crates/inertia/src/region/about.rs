//! Regions about points: the box along the body axes, and the smallest ellipsoid.

use nalgebra::{
    Isometry3, Matrix3, Matrix3xX, Matrix4, Rotation3, Translation3, UnitQuaternion, Vector3,
    Vector4,
};

use super::{Region, RegionError};
use crate::RELATIVE_TOLERANCE;

/// Most steps towards the smallest ellipsoid; some hundreds do.
const STEPS: usize = 20_000;
/// By which share the squared distance of a point in four dimensions may exceed that of the others: half of the share by
/// which the volume is too large.
const NEAR: f64 = 5e-6;

impl Region {
    /// The smallest box along the body axes that holds points, m.
    ///
    /// ```
    /// use gyradius_inertia::Region;
    ///
    /// let corners = [[0.0, 0.0, 0.0], [1.0, 2.0, 0.5], [0.5, 0.0, 1.0]];
    /// assert!(Region::box_about(&corners).is_ok());
    /// assert!(Region::box_about(&corners[..2]).is_ok());
    /// assert!(Region::box_about(&corners[..1]).is_err());
    /// ```
    ///
    /// # Errors
    /// There are no points, they lie in a plane across an axis, or one is not finite or too large.
    pub fn box_about(points_m: &[[f64; 3]]) -> Result<Self, RegionError> {
        // Which refuses points that are none.
        Self::hull(points_m)?;
        let end = |pick: fn(f64, f64) -> f64| {
            let all = points_m.iter().map(|p| Vector3::from(*p));
            all.reduce(|a, b| a.zip_map(&b, pick)).unwrap_or_default()
        };
        let (low, high) = (end(f64::min), end(f64::max));
        let centre = (low + high) * 0.5;
        // The middle is rounded, and the farther end decides.
        Self::solid_box(centre, (high - centre).sup(&(centre - low)))
    }

    /// The smallest ellipsoid that holds points, m, to 1e-5 of its volume (Khachiyan 1996, doi:10.1287/moor.21.2.307, with
    /// the steps away from points of Todd & Yıldırım 2007, doi:10.1016/j.dam.2007.02.013), grown to hold them all.
    ///
    /// ```
    /// use gyradius_inertia::{Containment, Region, Shape};
    ///
    /// let cube = [0, 1, 2, 3, 4, 5, 6, 7].map(|i| [i & 1, i >> 1 & 1, i >> 2].map(|x| 2.0 * f64::from(x) - 1.0));
    /// let ball = Region::ellipsoid_about(&cube)?;
    /// let inside = Shape::solid_box([2.0, 2.0, 2.0]).unwrap().of_mass(1.0).unwrap();
    /// assert_eq!(ball.containment(&inside.into()), Containment::Possible);
    /// # Ok::<(), gyradius_inertia::RegionError>(())
    /// ```
    ///
    /// # Errors
    /// There are no points, they lie in a plane, or one is not finite or too large.
    pub fn ellipsoid_about(points_m: &[[f64; 3]]) -> Result<Self, RegionError> {
        let hull = Self::hull(points_m)?;
        let outer = hull.outer_points_m().ok_or(RegionError::Flat)?;
        let all = points_m.iter().map(|p| Vector3::from(*p));
        smallest(outer, all).ok_or(RegionError::Flat)?
    }
}

/// The smallest ellipsoid about the corners of a hull, which holds all of its points; nothing if they are flat.
fn smallest(
    outer: &[Vector3<f64>],
    all: impl Iterator<Item = Vector3<f64>>,
) -> Option<Result<Region, RegionError>> {
    // An affine map takes the smallest ellipsoid of points to that of their images. It is found of images that spread
    // alike along all axes about the origin, so that neither place nor size nor thickness of the points counts.
    let n = outer.len();
    if n < 4 {
        return None;
    }
    let middle = outer.iter().fold(Vector3::zeros(), |sum, x| sum + x / n as f64);
    let size = outer.iter().map(|x| (x - middle).amax()).fold(0.0, f64::max);
    let away: Vec<Vector3<f64>> = outer.iter().map(|x| (x - middle) / size).collect();
    let found = Matrix3xX::from_columns(&away).svd(true, false);
    let axes: Matrix3<f64> = found.u?.fixed_columns::<3>(0).into_owned();
    let extents: Vector3<f64> = found.singular_values.fixed_rows::<3>(0) / (n as f64).sqrt();
    // As thick are points of a plane whose coordinates are rounded.
    if !(extents.min() > RELATIVE_TOLERANCE * (1.0 + middle.amax() / size)) {
        return None;
    }
    let even: Vec<Vector3<f64>> =
        away.iter().map(|x| axes.tr_mul(x).component_div(&extents)).collect();
    let weights = weights(&even)?;
    let centre: Vector3<f64> = even.iter().zip(&weights).map(|(x, w)| x * *w).sum();
    let about = |x: &Vector3<f64>| (x - centre) * (x - centre).transpose();
    let spread: Matrix3<f64> = even.iter().zip(&weights).map(|(x, w)| about(x) * *w).sum();
    let back = axes * Matrix3::from_diagonal(&extents) * size;
    let centre = middle + back * centre;
    // Singular values of a root of the spread are as exact in the thin directions of the points as in the others.
    let found = (back * spread.cholesky()?.l()).svd(true, false);
    let (semi_axes, mut axes) = (found.singular_values, found.u?);
    if axes.determinant() < 0.0 {
        axes.column_mut(0).neg_mut();
    }
    let reach = |x: Vector3<f64>| axes.tr_mul(&(x - centre)).component_div(&semi_axes).norm();
    // With what rounding takes away.
    let semi_axes = semi_axes * all.map(reach).fold(0.0, f64::max) * (1.0 + 1e-9);
    let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
    let pose = Isometry3::from_parts(Translation3::from(centre), turn);
    let region = Region::ellipsoid(Vector3::zeros(), semi_axes);
    Some(region.and_then(|region| region.transformed(&pose)))
}

/// The weights of points of whose spread about the weighted middle the smallest ellipsoid has the form.
fn weights(points: &[Vector3<f64>]) -> Option<Vec<f64>> {
    // The ellipsoids about the origin in four dimensions cut the space of the points at height 1. In the spread of points
    // with the right weights, the squared distance of the points with a weight is 4, and no other is farther.
    let lifted: Vec<Vector4<f64>> = points.iter().map(|x| x.push(1.0)).collect();
    let mut weights = first_weights(points)?;
    for _ in 0..STEPS {
        let weighted = lifted.iter().zip(&weights).filter(|(_, w)| **w > 0.0);
        let spread: Matrix4<f64> = weighted.map(|(x, w)| x * x.transpose() * *w).sum();
        let inverse = spread.try_inverse()?;
        let squares: Vec<f64> = lifted.iter().map(|x| x.dot(&(inverse * x))).collect();
        let order = |a: &usize, b: &usize| squares[*a].total_cmp(&squares[*b]);
        let far = (0..points.len()).max_by(order)?;
        let near = (0..points.len()).filter(|j| weights[*j] > 0.0).min_by(order)?;
        if !(squares[far] > 4.0 * (1.0 + NEAR)) {
            break;
        }
        // The step along which the ellipsoid grows the most: towards a point, or away from one that has too much weight,
        // which ends where no weight is left.
        let towards = squares[far] - 4.0 > 4.0 - squares[near];
        let place = if towards { far } else { near };
        let best = (squares[place] - 4.0) / (4.0 * (squares[place] - 1.0));
        let all = -weights[place] / (1.0 - weights[place]);
        let has_best = towards || squares[place] > 1.0 && best > all;
        let step = if has_best { best } else { all };
        weights.iter_mut().for_each(|weight| *weight *= 1.0 - step);
        weights[place] = if has_best { weights[place] + step } else { 0.0 };
    }
    Some(weights)
}

/// Equal weights of the outermost points along three directions, each across the differences of those before, so that they
/// do not lie in a plane: the start of Kumar and Yıldırım.
fn first_weights(points: &[Vector3<f64>]) -> Option<Vec<f64>> {
    let mut weights = vec![0.0; points.len()];
    let mut across = |direction: Vector3<f64>| {
        let order = |a: &usize, b: &usize| {
            direction.dot(&points[*a]).total_cmp(&direction.dot(&points[*b]))
        };
        let ends = [(0..points.len()).min_by(order)?, (0..points.len()).max_by(order)?];
        ends.iter().for_each(|end| weights[*end] += 1.0 / 6.0);
        Some(points[ends[1]] - points[ends[0]])
    };
    let first = across(Vector3::x())?;
    let second = across(first.cross(&Vector3::ith(first.iamin(), 1.0)))?;
    across(first.cross(&second))?;
    Some(weights)
}

#[cfg(test)]
mod tests {
    use super::super::Kind;
    use super::*;
    use crate::{Containment, Shape};
    use proptest::prelude::*;
    use std::array;

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
            let held = |region: &Region, factor: f64| {
                let [a, b, c] = semi.map(|x| x * factor);
                // A third of the square of a semi-axis along each axis: on the limit of the ellipsoid.
                let body = Shape::solid_box([2.0 * a, 2.0 * b, 2.0 * c]).unwrap();
                let body = body.of_mass(1.0).unwrap().transformed(&pose).unwrap();
                region.containment(&body) == Containment::Possible
            };
            let ellipsoid = Region::ellipsoid_about(&points).unwrap();
            for region in [&ellipsoid, &Region::box_about(&points).unwrap(), &Region::hull(&points).unwrap()] {
                prop_assert!(held(region, 0.9), "{region:?}");
            }
            prop_assert!(!held(&ellipsoid, 1.03));
        }
    }

    proptest! {
        /// Each point that a box is about is in it, whatever the rounding of its middle: a point mass there is possible.
        #[test]
        fn a_box_has_its_points(
            points in prop::collection::vec(prop::array::uniform3(-99_i32..99), 4..8),
            exponent in -6..6_i32,
            far in -1e3..1e3_f64,
        ) {
            let points: Vec<[f64; 3]> =
                points.iter().map(|p| p.map(|x| f64::from(x) * 10_f64.powi(exponent) + far)).collect();
            if let Ok(region) = Region::box_about(&points) {
                for point in points {
                    let body = crate::MassProperties::point(1.0, Vector3::from(point)).unwrap();
                    prop_assert_eq!(region.containment(&body), Containment::Possible, "{:?}", point);
                }
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// No ellipsoid about points is smaller than the one that weights of them span, whichever they are: the one that is
        /// found is hardly larger, of clouds of every kind, of 5 to 1000 points.
        #[test]
        fn no_smaller_ellipsoid_holds_the_points(
            cloud in prop_oneof![5..30_usize, 5..1000_usize]
                .prop_flat_map(|n| prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), n)),
            kind in 0..5_usize,
        ) {
            let form = |x: Vector3<f64>| match kind {
                0 => x,
                // Many points on the boundary, on some of it alone, a thin cloud, and points far out.
                1 => x.normalize(),
                2 => Vector3::new(x.x, x.y, x.x * x.x + x.y * x.y),
                3 => x.map(|x| x.powi(3)).component_mul(&Vector3::new(1.0, 0.3, 0.05)),
                _ => x / (1.01 - x.amax()),
            };
            let points: Vec<Vector3<f64>> = cloud.into_iter().map(|x| form(x.into())).collect();
            let region = Region::ellipsoid_about(&points.iter().map(|p| (*p).into()).collect::<Vec<_>>()).unwrap();
            let Kind::Ellipsoid { semi_axes, .. } = &region.0 else {
                unreachable!("an ellipsoid")
            };
            let weights = weights(&points).unwrap();
            prop_assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-9 && weights.iter().all(|w| *w >= 0.0));
            let centre: Vector3<f64> = points.iter().zip(&weights).map(|(x, w)| x * *w).sum();
            let spread: Matrix3<f64> =
                points.iter().zip(&weights).map(|(x, w)| (x - centre) * (x - centre).transpose() * *w).sum();
            let least = (27.0 * spread.determinant()).sqrt();
            let excess = semi_axes.product() / least - 1.0;
            prop_assert!((-1e-9..2e-5).contains(&excess), "{}", excess);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        /// The smallest ellipsoid goes with the points, wherever they are moved, however they are stretched, and holds them;
        /// of points in a plane there is none.
        #[test]
        fn an_ellipsoid_goes_with_its_points(
            off in prop::array::uniform8(prop::array::uniform3(-0.4..0.4_f64)),
            turn in prop::array::uniform3(-3.0..3.0_f64),
            thickness in prop_oneof![Just(1.0), (-7.0..0.0_f64).prop_map(|e| 10_f64.powf(e))],
            exponent in -20..20_i32,
            far in prop_oneof![Just(0.0), (0.0..4.0_f64).prop_map(|e| 10_f64.powf(e))],
        ) {
            let corner = |i: usize, axis: usize| if i >> axis & 1 == 0 { -1.0 } else { 1.0 };
            let points: [[f64; 3]; 8] =
                array::from_fn(|i| array::from_fn(|axis| corner(i, axis) + off[i][axis]));
            let turn = UnitQuaternion::from_scaled_axis(Vector3::from(turn));
            let size = 10_f64.powi(exponent);
            let volume = |points: &[[f64; 3]]| {
                Region::ellipsoid_about(points).map(|region| match &region.0 {
                    Kind::Ellipsoid { semi_axes, .. } => (region.clone(), semi_axes.product()),
                    Kind::Box { .. } | Kind::Hull(_) => unreachable!("an ellipsoid"),
                })
            };
            let put = |thickness: f64| {
                let stretch = Vector3::new(1.0, 1.0, thickness);
                let place = |p: &[f64; 3]| turn * Vector3::from(*p).component_mul(&stretch) + Vector3::repeat(far);
                points.iter().map(|p| (place(p) * size).into()).collect::<Vec<[f64; 3]>>()
            };
            let (_, plain) = volume(&points).unwrap();
            let moved = put(thickness);
            let (region, found) = volume(&moved).unwrap();
            // The coordinates are rounded, in parts of the thickness.
            let rounding = 1e-13 * (1.0 + far) / thickness;
            prop_assert!((found / (plain * thickness * size.powi(3)) - 1.0).abs() < 4e-5 + rounding, "{} {}", found, plain);
            for point in moved {
                let body = crate::MassProperties::point(1.0, Vector3::from(point)).unwrap();
                prop_assert_eq!(region.containment(&body), Containment::Possible, "{:?}", point);
            }
            prop_assert_eq!(Region::ellipsoid_about(&put(0.0)), Err(RegionError::Flat));
        }
    }

    proptest! {
        /// Equal masses at the corners of a box, and at the tips of an ellipsoid, are in there, however thin and turned.
        #[test]
        fn bodies_on_the_boundary_are_inside(
            thickness in (-4.0..0.0_f64).prop_map(|e| 10_f64.powf(e)),
            turn in prop::array::uniform3(-3.0..3.0_f64),
            middle in prop::array::uniform3(-2.0..2.0_f64),
            size in (-3.0..3.0_f64).prop_map(|e| 10_f64.powf(e)),
        ) {
            let half = Vector3::new(1.0, 0.5, thickness) * size;
            let turn = UnitQuaternion::from_scaled_axis(Vector3::from(turn));
            let pose = Isometry3::from_parts(Translation3::from(Vector3::from(middle) * size), turn);
            let corner = |i: usize| Vector3::from_fn(|axis, _| if i >> axis & 1 == 0 { -half[axis] } else { half[axis] });
            let tip = |i: usize| Vector3::ith(i / 2, if i.is_multiple_of(2) { -half[i / 2] } else { half[i / 2] });
            let box_ = Region::solid_box(Vector3::zeros(), half).unwrap();
            let ellipsoid = Region::ellipsoid(Vector3::zeros(), half).unwrap();
            for (region, points) in [(box_, (0..8).map(corner).collect()), (ellipsoid, (0..6).map(tip).collect::<Vec<_>>())] {
                let points = points.into_iter().map(|p| (1.0, (pose * nalgebra::Point3::from(p)).coords));
                let body = crate::MassProperties::from_points(points).unwrap();
                let region = region.transformed(&pose).unwrap();
                prop_assert_ne!(region.containment(&body), Containment::Impossible, "{} {:?}", region.room(&body), region);
                let beyond = body.translated(turn * Vector3::z() * (2e-3 * half.z)).unwrap();
                prop_assert_eq!(region.containment(&beyond), Containment::Impossible);
            }
        }
    }

    #[test]
    fn flat_points_have_no_ellipsoid_and_no_box() {
        let flat = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
        assert_eq!(Region::ellipsoid_about(&flat), Err(RegionError::Flat));
        assert!(matches!(Region::box_about(&flat), Err(RegionError::Size { axis: 3, .. })));
        for about in [Region::ellipsoid_about, Region::box_about] {
            assert_eq!(about(&[]), Err(RegionError::Empty));
            assert!(matches!(
                about(&[[0.0, f64::NAN, 0.0]]),
                Err(RegionError::Point { point: 0, .. })
            ));
        }
    }
}
