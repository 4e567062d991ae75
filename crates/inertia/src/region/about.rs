//! Regions about points: the box along the body axes, and the smallest ellipsoid.

use nalgebra::{
    DVector, Isometry3, Matrix3, Matrix3xX, Matrix4, Matrix4xX, Rotation3, Translation3,
    UnitQuaternion, Vector3, Vector4,
};

use super::{Region, RegionError};
use crate::RELATIVE_TOLERANCE;

/// Most steps of Newton towards the smallest ellipsoid of some points; some ten do.
const STEPS: usize = 100;
/// How often points outside the ellipsoid of some are added to these at most; some ten times do.
const ROUNDS: usize = 100;
/// How far the logarithm of the squared volume of the ellipsoid of some points may be from its limit.
const GAP: f64 = 1e-8;
/// The share of the squared distance of the ellipsoid within which points no longer count for it.
const INSIDE: f64 = 0.99;
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

    /// The smallest ellipsoid that holds points, m, to 1e-5 of its volume, grown to hold them all. It is found of some of them by an
    /// interior-point method, and those that lie farthest outside are added until none does (Sun & Freund 2004,
    /// doi:10.1287/opre.1040.0115).
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
        smallest(outer, points_m).ok_or(RegionError::Flat)?
    }
}

/// The smallest ellipsoid about all points, of which some lie outermost; nothing if they are flat.
fn smallest(outer: &[Vector3<f64>], all: &[[f64; 3]]) -> Option<Result<Region, RegionError>> {
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
    let even = |x: &Vector3<f64>| axes.tr_mul(&((x - middle) / size)).component_div(&extents);
    let all = all.iter().map(|p| Vector3::from(*p));
    let Weighted { points, weights } =
        Weighted::about(outer.iter().map(even).collect(), &all.clone().map(|x| even(&x)))?;
    let centre: Vector3<f64> = points.iter().zip(&weights).map(|(x, w)| x * *w).sum();
    let about = |x: &Vector3<f64>| (x - centre) * (x - centre).transpose();
    let spread: Matrix3<f64> = points.iter().zip(&weights).map(|(x, w)| about(x) * *w).sum();
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

/// Points with weights: of their spread about the weighted middle an ellipsoid has the form.
///
/// The ellipsoids about the origin in four dimensions cut the space of the points at height 1. In the spread of points with the
/// right weights, the squared distance of the points with a weight is 4, and no other is farther.
struct Weighted {
    points: Vec<Vector3<f64>>,
    weights: Vec<f64>,
}

impl Weighted {
    /// Those of the smallest ellipsoid about all points, from some of them that do not lie in a plane.
    fn about(
        some: Vec<Vector3<f64>>,
        all: &(impl Iterator<Item = Vector3<f64>> + Clone),
    ) -> Option<Self> {
        let weights = first_weights(&some)?;
        let (points, weights) = some.into_iter().zip(weights).filter(|(_, w)| *w > 0.0).unzip();
        let mut found = Self { points, weights };
        for _ in 0..ROUNDS {
            found.settle()?;
            let outside = found.outside(all.clone())?;
            if outside.is_empty() {
                break;
            }
            let square = found.squares()?;
            // Points well inside say nothing of the ellipsoid.
            let near = |(x, _): &(Vector3<f64>, f64)| square(x) > 4.0 * INSIDE;
            let kept = found.points.into_iter().zip(found.weights).filter(near);
            let added = outside.into_iter().map(|point| (point, 0.0));
            let (points, weights) = kept.chain(added).unzip();
            found = Self { points, weights };
        }
        Some(found)
    }

    /// The squared distances of points in four dimensions, in the spread.
    fn squares(&self) -> Option<impl Fn(&Vector3<f64>) -> f64 + use<>> {
        let weighted = self.points.iter().zip(&self.weights).filter(|(_, w)| **w > 0.0);
        let lifted = weighted.map(|(x, w)| (x.push(1.0), w));
        let spread: Matrix4<f64> = lifted.map(|(x, w)| x * x.transpose() * *w).sum();
        let inverse = spread.try_inverse()?;
        Some(move |x: &Vector3<f64>| {
            let lifted: Vector4<f64> = x.push(1.0);
            lifted.dot(&(inverse * lifted))
        })
    }

    /// The points that lie farthest outside the ellipsoid, one of each side of it.
    fn outside(&self, all: impl Iterator<Item = Vector3<f64>>) -> Option<Vec<Vector3<f64>>> {
        let square = self.squares()?;
        // The sides are told by the signs of the coordinates, and by which of them is the largest.
        let mut sides: [Option<(f64, Vector3<f64>)>; 24] = [None; 24];
        for point in all {
            let far = square(&point);
            let signs = point.iter().fold(0, |signs, x| 2 * signs + usize::from(*x > 0.0));
            let side = &mut sides[3 * signs + point.iamax()];
            if far > 4.0 * (1.0 + NEAR) && side.is_none_or(|(farthest, _)| far > farthest) {
                *side = Some((far, point));
            }
        }
        Some(sides.into_iter().flatten().map(|(_, point)| point).collect())
    }

    /// Finds the weights of the smallest ellipsoid about these points: those for which each weight is none, or the squared distance 4. Newton's
    /// method solves that the product of a weight and of what the squared distance lacks is the same for all, and ever smaller.
    fn settle(&mut self) -> Option<()> {
        let count = self.points.len();
        let lifted =
            Matrix4xX::from_columns(&self.points.iter().map(|x| x.push(1.0)).collect::<Vec<_>>());
        let mut weights = DVector::from_column_slice(&self.weights);
        // Each has some weight to start from.
        weights.iter_mut().for_each(|weight| *weight = 0.9 * *weight + 0.1 / count as f64);
        let mut lacks = DVector::from_element(count, 1.0);
        for _ in 0..STEPS {
            let weighted = Matrix4xX::from_fn(count, |i, j| lifted[(i, j)] * weights[j]);
            let inverse: Matrix4<f64> = (&weighted * lifted.transpose()).try_inverse()?;
            let between = lifted.transpose() * inverse * &lifted;
            let squares = between.diagonal();
            let gap = weights.dot(&lacks);
            let error = (&squares + &lacks).add_scalar(-4.0).amax();
            if gap <= GAP && error <= GAP {
                break;
            }
            let product = 0.1 * gap / count as f64;
            let mut slopes = between.component_mul(&between);
            for i in 0..count {
                slopes[(i, i)] += lacks[i] / weights[i];
            }
            let wanted = squares.add_scalar(-4.0) + weights.map(|weight| product / weight);
            // Where rounding leaves no step, the ellipsoid is the smallest but for that.
            let Some(slopes) = slopes.cholesky() else { break };
            let more = slopes.solve(&wanted);
            let lacks_more = DVector::from_fn(count, |i, _| {
                (product - lacks[i] * more[i]) / weights[i] - lacks[i]
            });
            // Both stay positive.
            let room = |now: &DVector<f64>, more: &DVector<f64>| {
                let each = now.iter().zip(more).filter(|(_, more)| **more < 0.0);
                each.map(|(now, more)| -0.95 * now / more).fold(1.0, f64::min)
            };
            let step = room(&weights, &more).min(room(&lacks, &lacks_more));
            weights.axpy(step, &more, 1.0);
            lacks.axpy(step, &lacks_more, 1.0);
        }
        weights /= weights.sum();
        self.weights = weights.iter().copied().collect();
        Some(())
    }
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
            let excess = excess(&points);
            prop_assert!((-1e-9..1.1e-5).contains(&excess), "{}", excess);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        /// The same of thousands of points on smooth surfaces, where more of them lie near the ellipsoid than it is first found of: those
        /// of |x|ᵖ + |y|ᵖ + |z|ᵖ = 1 from an octahedron to nearly a cube, whole or cut off, stretched, turned, and uneven.
        #[test]
        fn no_smaller_ellipsoid_holds_points_of_smooth_surfaces(
            power in prop_oneof![Just(2.0), Just(4.0), 1.05..12.0_f64],
            count in 1000..12_000_usize,
            cut in prop_oneof![Just(-2.0), -0.9..0.9_f64],
            egg in prop_oneof![Just(0.0), -0.5..0.5_f64],
            stretch in prop::array::uniform3(-3.0..0.0_f64),
            turn in prop::array::uniform3(-3.0..3.0_f64),
            unevenness in prop_oneof![Just(0.0), 0.0..0.05_f64],
        ) {
            let turn = UnitQuaternion::from_scaled_axis(Vector3::from(turn));
            let stretch = Vector3::from(stretch).map(|x| 10_f64.powf(x));
            let golden = std::f64::consts::PI * (3.0 - 5_f64.sqrt());
            let points: Vec<Vector3<f64>> = (0..count)
                .map(|i| {
                    let z = 1.0 - (2 * i + 1) as f64 / count as f64;
                    let (sin, cos) = (golden * i as f64).sin_cos();
                    let x = Vector3::new(cos * (1.0 - z * z).sqrt(), sin * (1.0 - z * z).sqrt(), z);
                    let x = x / x.map(|x| x.abs().powf(power)).sum().powf(1.0 / power);
                    let x = Vector3::new(x.x * (1.0 + egg * x.z), x.y * (1.0 + egg * x.z), x.z.max(cut));
                    // Of fixed irrational steps.
                    let wave = 1.0 - unevenness * (i as f64 * 2_f64.sqrt()).fract();
                    turn * (x * wave).component_mul(&stretch)
                })
                .collect();
            let excess = excess(&points);
            prop_assert!((-1e-9..1.1e-5).contains(&excess), "{}", excess);
        }
    }

    /// By which share the ellipsoid about points is larger than one that weights of them span, than which there is none smaller,
    /// whichever the weights are.
    fn excess(points: &[Vector3<f64>]) -> f64 {
        let given: Vec<[f64; 3]> = points.iter().map(|p| (*p).into()).collect();
        let region = Region::ellipsoid_about(&given).unwrap();
        let Kind::Ellipsoid { pose, to_unit, .. } = &region.0 else { unreachable!("an ellipsoid") };
        // Where the ellipsoid is a ball of radius one.
        let put = |x: &Vector3<f64>| to_unit * (x - pose.translation.vector);
        let outer = Region::hull(&given).unwrap().outer_points_m().unwrap().to_vec();
        let all = points.iter().map(put);
        assert!(all.clone().all(|x| x.norm() <= 1.0));
        let weighted = Weighted::about(outer.iter().map(put).collect(), &all).unwrap();
        let pairs = || weighted.points.iter().zip(&weighted.weights);
        assert!((pairs().map(|(_, w)| w).sum::<f64>() - 1.0).abs() < 1e-9);
        assert!(pairs().all(|(x, w)| *w >= 0.0 && points.iter().any(|point| put(point) == *x)));
        let centre: Vector3<f64> = pairs().map(|(x, w)| x * *w).sum();
        let about = |x: &Vector3<f64>| (x - centre) * (x - centre).transpose();
        let spread: Matrix3<f64> = pairs().map(|(x, w)| about(x) * *w).sum();
        (27.0 * spread.determinant()).sqrt().recip() - 1.0
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
