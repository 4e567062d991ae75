//! Regions of space, and whether matter inside one can have given mass properties.

mod about;
mod error;
#[cfg(feature = "serde")]
mod file;
mod hull;
mod non_negative;

pub use error::RegionError;
use hull::{Hull, Widths};
use nalgebra::{Isometry3, Matrix3, Quaternion, SVector, Translation3, UnitQuaternion, Vector3};

use crate::mass_properties::check_vector;
use crate::{MassProperties, RELATIVE_TOLERANCE};

/// Points of a lattice along each edge of a box.
const LATTICE: usize = 5;
/// How many middles between two corners of a hull masses are tried at.
const PAIRS: usize = 400;
/// Digits to which point masses must have the mass properties, relative to the size of the region.
const DIGITS: f64 = 1e-10;
/// How far from the mass centre to where a principal axis leaves the region masses are tried.
const OWN_FRACTIONS: [f64; 4] = [1.0, 0.75, 0.5, 0.25];
/// How far from the mass centre to a corner of a hull masses are tried.
const FRACTIONS: [f64; 4] = [1.0, 0.8, 0.6, 0.3];

/// A region in body axes that holds all the matter of a body: an ellipsoid, a box, or the convex hull of points.
///
/// # Definition
/// Mass properties are possible in a region if some distribution of matter, of any density that is not negative and points
/// of mass, lies in the region and has them. Then and only then is J = ∫ (x, 1)(x, 1)ᵀ dm for such a distribution.
///
/// * **Ellipsoid** (x − e)ᵀ Q⁻¹ (x − e) ≤ 1: possible if and only if ∫ (1 − (x − e)ᵀ Q⁻¹ (x − e)) dm ≥ 0, that is
///   tr(Q⁻¹ (Σ_c + m (c − e)(c − e)ᵀ)) ≤ m (Wensing, Kim & Slotine 2018, doi:10.1109/LRA.2017.2729659).
/// * **Box and hull**: no such condition is known. Necessary: of every two parallel faces or planes that hold the region
///   between them, n·x ≤ h and −n·x ≤ h', ∫ (h − n·x)(h' + n·x) dm ≥ 0; of every two faces of a box their product, too.
///   Sufficient: point masses in the region that have the mass properties, found by least squares with weights that are not
///   negative. Between the two the answer is [`Containment::Undecided`].
///
/// ```
/// use gyradius_inertia::{Containment, Region, Shape};
///
/// let region = Region::solid_box([0.0; 3], [0.5, 0.5, 1.0])?;
/// let inside = Shape::solid_box([1.0, 1.0, 2.0])?.of_mass(3.0)?;
/// assert_eq!(region.containment(&inside), Containment::Possible);
/// // A shell of the same mass, a metre from the middle at every side.
/// let wide = Shape::sphere_shell(1.0)?.of_mass(3.0)?;
/// assert_eq!(region.containment(&wide), Containment::Impossible);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "file::RegionForm", into = "file::RegionForm"))]
pub struct Region(Kind);

#[derive(Clone, Debug, PartialEq)]
enum Kind {
    /// The pose takes points of a frame on the axes to body axes.
    Ellipsoid {
        pose: Isometry3<f64>,
        semi_axes: Vector3<f64>,
        /// From body axes to those of the ellipsoid, in parts of its semi-axes.
        to_unit: Matrix3<f64>,
        /// Q⁻¹ = BᵀB, where B is `to_unit`.
        weights: Matrix3<f64>,
    },
    Box {
        pose: Isometry3<f64>,
        half_sides: Vector3<f64>,
    },
    /// The points, and those of them that are farthest out in some direction.
    Hull(Hull),
}

/// Whether matter inside a region can have given mass properties.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Containment {
    /// Some distribution of matter in the region has them.
    Possible,
    /// None has.
    Impossible,
    /// Neither was shown: the mass properties are near the limit of a box or a hull.
    Undecided,
}

impl Region {
    /// An ellipsoid with its axes along those of the body.
    ///
    /// # Errors
    /// The middle is not finite, or a semi-axis not positive; either is too large.
    pub fn ellipsoid(
        middle_m: impl Into<Vector3<f64>>,
        semi_axes_m: impl Into<Vector3<f64>>,
    ) -> Result<Self, RegionError> {
        let (pose, semi_axes) = (pose(middle_m.into())?, sizes("semi-axis", semi_axes_m.into())?);
        Ok(Self::of_ellipsoid(pose, semi_axes))
    }

    fn of_ellipsoid(pose: Isometry3<f64>, semi_axes: Vector3<f64>) -> Self {
        let turn = *pose.rotation.to_rotation_matrix().matrix();
        let to_unit = Matrix3::from_diagonal(&semi_axes.map(f64::recip)) * turn.transpose();
        let weights =
            turn * Matrix3::from_diagonal(&semi_axes.map(|a| 1.0 / (a * a))) * turn.transpose();
        Self(Kind::Ellipsoid { pose, semi_axes, to_unit, weights })
    }

    /// A box with its edges along the axes of the body, from its middle and half its sides.
    ///
    /// # Errors
    /// The middle is not finite, or a side not positive; either is too large.
    pub fn solid_box(
        middle_m: impl Into<Vector3<f64>>,
        half_sides_m: impl Into<Vector3<f64>>,
    ) -> Result<Self, RegionError> {
        let (pose, half_sides) = (pose(middle_m.into())?, sizes("half side", half_sides_m.into())?);
        Ok(Self(Kind::Box { pose, half_sides }))
    }

    /// The convex hull of points, such as the vertices of a mesh.
    ///
    /// # Errors
    /// A point is not finite or too large, or there are none.
    pub fn hull(points_m: &[[f64; 3]]) -> Result<Self, RegionError> {
        let points: Vec<Vector3<f64>> = points_m.iter().map(|p| Vector3::from(*p)).collect();
        for (point, x) in points.iter().enumerate() {
            check_vector("point", x).map_err(|error| RegionError::Point { point, error })?;
        }
        Hull::new(points).map(|hull| Self(Kind::Hull(hull)))
    }

    /// The same region turned about the origin and then moved, as [`MassProperties::transformed`] does with a body.
    ///
    /// # Errors
    /// The region would be too far away, or the rotation is none.
    pub fn transformed(&self, by: &Isometry3<f64>) -> Result<Self, RegionError> {
        let by = Isometry3::from_parts(by.translation, unit(by.rotation.quaternion())?);
        let moved = |pose: &Isometry3<f64>| {
            let pose = by * pose;
            check_vector("middle", &pose.translation.vector)?;
            Ok::<_, RegionError>(pose)
        };
        Ok(match &self.0 {
            Kind::Ellipsoid { pose, semi_axes, .. } => Self::of_ellipsoid(moved(pose)?, *semi_axes),
            Kind::Box { pose, half_sides } => {
                Self(Kind::Box { pose: moved(pose)?, half_sides: *half_sides })
            }
            Kind::Hull(hull) => {
                let points = hull.points();
                let points: Vec<_> =
                    points.iter().map(|p| by.rotation * p + by.translation.vector).collect();
                for (point, x) in points.iter().enumerate() {
                    check_vector("point", x)
                        .map_err(|error| RegionError::Point { point, error })?;
                }
                return Hull::new(points).map(|hull| Self(Kind::Hull(hull)));
            }
        })
    }

    /// Whether nothing stays [`Undecided`](Containment::Undecided): so it is of an ellipsoid.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        matches!(self.0, Kind::Ellipsoid { .. })
    }

    /// Whether matter inside the region can have these mass properties.
    #[must_use]
    pub fn containment(&self, body: &MassProperties) -> Containment {
        match &self.0 {
            Kind::Ellipsoid { pose, semi_axes, .. } => {
                if self.room(body) >= -rounding(body, pose, semi_axes) {
                    Containment::Possible
                } else {
                    Containment::Impossible
                }
            }
            Kind::Box { pose, half_sides } => {
                let local = Local::of(body, pose);
                if local.room_in_box(half_sides) < -rounding(body, pose, half_sides) {
                    return Containment::Impossible;
                }
                let inside = |x: &Vector3<f64>| (0..3).all(|i| x[i].abs() <= half_sides[i]);
                if local.is_plain(inside) {
                    return Containment::Possible;
                }
                // To the nearest face along a line.
                let exit = |n: &Vector3<f64>| {
                    let face =
                        |i: usize| (half_sides[i] - n[i].signum() * local.centre[i]) / n[i].abs();
                    (0..3).filter(|i| n[*i] != 0.0).map(face).fold(f64::INFINITY, f64::min)
                };
                let points = lattice().map(|unit| unit.component_mul(half_sides));
                let own = local.on_own_axes(inside, exit);
                local.decide(points.chain(own), half_sides.norm(), &Widths::same())
            }
            Kind::Hull(hull) => {
                let (outer, size, widths) = (hull.outer(), hull.size(), hull.widths());
                let local = Local::of(body, &Isometry3::identity());
                if hull.room(&local.centre, &local.axes, &local.radii) < -RELATIVE_TOLERANCE {
                    return Containment::Impossible;
                }
                let inside = |x: &Vector3<f64>| hull.holds(x);
                if !inside(&local.centre) {
                    return Containment::Undecided;
                }
                if local.is_plain(inside) {
                    return Containment::Possible;
                }
                let rays = outer.iter().flat_map(|corner| {
                    FRACTIONS.map(|fraction| local.centre + (corner - local.centre) * fraction)
                });
                // Middles of edges, of faces and of what joins others.
                let n = outer.len();
                let stride = 1 + n * n / (2 * PAIRS);
                let middles = (0..n).flat_map(|i| (0..i).map(move |j| (i, j))).step_by(stride);
                let middles = middles.map(|(i, j)| (outer[i] + outer[j]) * 0.5);
                let corners: Vec<Vector3<f64>> = rays.chain(middles).collect();
                if local.decide(corners.iter().copied(), size, widths) == Containment::Possible {
                    return Containment::Possible;
                }
                // A body with an extent in all directions needs none but means of what is known to be in the region.
                let is_flat = local.radii.min() == 0.0;
                let inside = |x: &Vector3<f64>| is_flat && hull.holds(x);
                let own = local.on_own_axes(inside, |n| hull.exit(&local.centre, n));
                local.decide(corners.into_iter().chain(own), size, widths)
            }
        }
    }

    /// The room of a mass, a mass centre and a second moment matrix about it in an ellipsoid, in a few operations and
    /// without a check of them; none of another region.
    #[must_use]
    #[inline]
    pub fn room_in_ellipsoid(
        &self,
        mass_kg: f64,
        mass_centre_m: &Vector3<f64>,
        second_moments_kg_m2: &Matrix3<f64>,
    ) -> Option<f64> {
        let Kind::Ellipsoid { pose, to_unit, weights, .. } = &self.0 else { return None };
        let off = mass_centre_m - pose.translation.vector;
        // tr(Q⁻¹ Σ_c)/m + (c − e)ᵀ Q⁻¹ (c − e), the latter as a sum of squares: Q⁻¹ itself has lost what a thin ellipsoid needs.
        let own = weights.component_mul(second_moments_kg_m2).sum() / mass_kg;
        Some(1.0 - own - (to_unit * off).norm_squared())
    }

    /// The least of the conditions that every distribution of matter in the region meets, each relative to what it would
    /// be with all the mass in the middle: negative if and only if no matter in an ellipsoid, and only if none in a box or
    /// hull, has these mass properties.
    #[must_use]
    pub fn room(&self, body: &MassProperties) -> f64 {
        match &self.0 {
            Kind::Ellipsoid { .. } => {
                let sigma = body.inertia().as_inertia_matrix().second_moment_matrix();
                // Always: it is an ellipsoid.
                self.room_in_ellipsoid(body.mass_kg(), &body.mass_centre_m(), &sigma).unwrap_or(1.0)
            }
            Kind::Box { pose, half_sides } => Local::of(body, pose).room_in_box(half_sides),
            Kind::Hull(hull) => {
                let local = Local::of(body, &Isometry3::identity());
                hull.room(&local.centre, &local.axes, &local.radii)
            }
        }
    }

    /// The points that a hull is looked at by, if it is one: of many those that lie farthest out in some direction.
    #[must_use]
    pub fn outer_points_m(&self) -> Option<&[Vector3<f64>]> {
        if let Kind::Hull(hull) = &self.0 { Some(hull.outer()) } else { None }
    }
}

/// What rounding may change the room of an ellipsoid or a box by: of coordinates far from the origin of the body axes it is
/// more, in parts of the thickness of the region, and so it is of wide bodies. A hull takes account of that itself.
fn rounding(body: &MassProperties, pose: &Isometry3<f64>, half: &Vector3<f64>) -> f64 {
    let far = body.mass_centre_m().norm() + pose.translation.vector.norm();
    let moved = RELATIVE_TOLERANCE * far / half.min();
    // Turned into the frame of the region, small second moments have the rounding of the large ones.
    let turned = 0.5 * body.inertia().as_inertia_matrix().matrix().trace() / body.mass_kg();
    // Of (c + δ)², c being at most one where a room is near zero.
    RELATIVE_TOLERANCE * (1.0 + turned / half.min() / half.min()) + moved * (2.0 + moved)
}

/// A body per unit of its mass, in the frame of a region.
struct Local {
    centre: Vector3<f64>,
    /// Σ_c/m.
    spread: Matrix3<f64>,
    /// Columns are principal axes.
    axes: Matrix3<f64>,
    /// √(K_k/m), zero where that is rounding.
    radii: Vector3<f64>,
}

impl Local {
    fn of(body: &MassProperties, pose: &Isometry3<f64>) -> Self {
        let turn = pose.rotation.inverse();
        let centre = turn * (body.mass_centre_m() - pose.translation.vector);
        let principal = body.inertia().principal_axes();
        // Rows of R(q) are principal axes in body axes.
        let axes = turn.to_rotation_matrix().matrix()
            * principal.attitude().to_rotation_matrix().matrix().transpose();
        let mass = body.mass_kg().sqrt();
        let radii = Vector3::from(body.inertia().second_moments().roots().values()) / mass;
        // Of a plate or a rod the last bit of a moment leaves a root that is far above rounding: it is their squares that tell.
        let least = RELATIVE_TOLERANCE * radii.norm_squared();
        let radii = radii.map(|radius| if radius * radius <= least { 0.0 } else { radius });
        let spread = axes * Matrix3::from_diagonal(&radii.component_mul(&radii)) * axes.transpose();
        Self { centre, spread, axes, radii }
    }

    /// The least of the conditions of a box about the origin: ∫ (1 − a x_i)(1 − b x_j) dm/m ≥ 0 for every two faces, in units
    /// of half a side.
    fn room_in_box(&self, half_sides: &Vector3<f64>) -> f64 {
        let c = self.centre.component_div(half_sides);
        let s = self.spread.component_div(&(half_sides * half_sides.transpose()));
        let mut least = f64::INFINITY;
        for i in 0..3 {
            least = least.min(1.0 - c[i] * c[i] - s[(i, i)]);
            for j in 0..i {
                for (a, b) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
                    least = least.min((1.0 - a * c[i]) * (1.0 - b * c[j]) + a * b * s[(i, j)]);
                }
            }
        }
        least
    }

    /// Whether six or eight equal masses do.
    fn is_plain(&self, inside: impl Fn(&Vector3<f64>) -> bool) -> bool {
        [self.octahedron(), self.cuboid()].iter().any(|points| points.iter().all(&inside))
    }

    /// Points in the region of a lattice on the principal axes, on which alone a rod or a plate has matter, from the mass
    /// centre to where they leave it.
    fn on_own_axes(
        &self,
        inside: impl Fn(&Vector3<f64>) -> bool,
        exit: impl Fn(&Vector3<f64>) -> f64,
    ) -> Vec<Vector3<f64>> {
        let steps = [0, 1, 2].map(|k| {
            let axis: Vector3<f64> = self.axes.column(k).into();
            if self.radii[k] == 0.0 {
                return vec![(Vector3::zeros(), 0.0)];
            }
            let [there, back] = [axis, -axis].map(|n| n * (exit(&n) * (1.0 - DIGITS)));
            let fractions = OWN_FRACTIONS.into_iter().flat_map(|f| [(there * f, f), (back * f, f)]);
            fractions.chain([(Vector3::zeros(), 0.0)]).collect()
        });
        let [first, second, third] = &steps;
        let all = first.iter().flat_map(|a| {
            second.iter().flat_map(move |b| {
                third.iter().map(move |c| (self.centre + a.0 + b.0 + c.0, a.1 + b.1 + c.1))
            })
        });
        // A mean of the mass centre and of where the axes leave the region is in it.
        all.filter(|(x, share)| *share <= 1.0 || inside(x)).map(|(x, _)| x).collect()
    }

    /// Six equal masses on the principal axes that have the mass properties.
    fn octahedron(&self) -> Vec<Vector3<f64>> {
        let arm = |k: usize| self.axes.column(k) * (self.radii[k] * 3f64.sqrt());
        (0..3).flat_map(|k| [self.centre + arm(k), self.centre - arm(k)]).collect()
    }

    /// Eight equal masses at the corners of a cuboid that have them.
    fn cuboid(&self) -> Vec<Vector3<f64>> {
        let corner = |signs: usize| {
            (0..3).fold(self.centre, |x, k| {
                let sign = if signs & (1 << k) == 0 { 1.0 } else { -1.0 };
                x + self.axes.column(k) * (sign * self.radii[k])
            })
        };
        (0..8).map(corner).collect()
    }

    /// Whether masses at some of these points have the mass properties, the size and widths of the region being as given.
    fn decide(
        &self,
        points: impl Iterator<Item = Vector3<f64>>,
        size: f64,
        widths: &Widths,
    ) -> Containment {
        if !(size > 0.0) {
            // All at one point.
            let same = self.radii.amax() == 0.0;
            return if same { Containment::Possible } else { Containment::Undecided };
        }
        // Each number counts by how wide the points are: of what is nearly flat, what is across it would else be lost beside the rest.
        // Squares across it are small beside all rounding, and count once by the width, as the others do.
        let Widths { axes, along: w } = widths;
        let counts = pack(w, &Matrix3::from_fn(|i, j| w[i].min(w[j]))).map(|width| 1.0 / width);
        let moments = |x: Vector3<f64>| {
            let x = axes.tr_mul(&((x - self.centre) / size));
            pack(&x, &(x * x.transpose())).component_mul(&counts)
        };
        let columns: Vec<SVector<f64, 10>> = points.map(moments).collect();
        let spread = axes.tr_mul(&(self.spread / (size * size))) * axes;
        let wanted = pack(&Vector3::zeros(), &spread).component_mul(&counts);
        let rest = non_negative::rest(&columns, &wanted);
        if rest.component_div(&counts).norm() <= DIGITS {
            Containment::Possible
        } else {
            Containment::Undecided
        }
    }
}

/// 1, x, and the six of x xᵀ.
fn pack(x: &Vector3<f64>, square: &Matrix3<f64>) -> SVector<f64, 10> {
    let s = square;
    SVector::from([
        1.0,
        x.x,
        x.y,
        x.z,
        s[(0, 0)],
        s[(1, 1)],
        s[(2, 2)],
        s[(0, 1)],
        s[(0, 2)],
        s[(1, 2)],
    ])
}

/// The rotation of a quaternion of length one to 1e-6, which is made so.
fn unit(q: &Quaternion<f64>) -> Result<UnitQuaternion<f64>, RegionError> {
    let norm = q.norm();
    if !((norm - 1.0).abs() <= 1e-6) {
        return Err(RegionError::Rotation { norm });
    }
    Ok(UnitQuaternion::new_normalize(*q))
}

fn pose(middle: Vector3<f64>) -> Result<Isometry3<f64>, RegionError> {
    check_vector("middle", &middle)?;
    Ok(Isometry3::from_parts(Translation3::from(middle), UnitQuaternion::identity()))
}

fn sizes(field: &'static str, sizes: Vector3<f64>) -> Result<Vector3<f64>, RegionError> {
    // Squares of them and of their inverses are finite.
    match sizes.iter().position(|size| !(1e-100..=1e100).contains(size)) {
        Some(axis) => Err(RegionError::Size { field, axis: axis + 1, value: sizes[axis] }),
        None => Ok(sizes),
    }
}

/// Points of a lattice on [−1, 1]³.
fn lattice() -> impl Iterator<Item = Vector3<f64>> {
    let at = |i: usize| 2.0 * i as f64 / (LATTICE - 1) as f64 - 1.0;
    (0..LATTICE * LATTICE * LATTICE).map(move |i| {
        let (x, y, z) = (i % LATTICE, i / LATTICE % LATTICE, i / LATTICE / LATTICE);
        Vector3::new(at(x), at(y), at(z))
    })
}

#[cfg(test)]
mod tests;
