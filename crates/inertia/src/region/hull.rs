//! The convex hull of points, looked at from all sides.

use nalgebra::{Matrix3, SVector, Vector3};

use super::{DIGITS, RegionError, non_negative};
use crate::RELATIVE_TOLERANCE;

/// Directions in which a hull is looked at.
const DIRECTIONS: usize = 400;
/// A hull counts as wide as this share of its length at least.
const FLAT: f64 = 1e-6;
/// Of how many points all corners of the hull are found. Of more, those that are seen from the directions are enough: what
/// has hundreds of them is round.
const ALL: usize = 400;
/// Planes that bound a way out, at most; a few do.
const CUTS: usize = 60;

/// Axes of a set of points, as columns, and how wide it is along each, in its sizes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Widths {
    pub(super) axes: Matrix3<f64>,
    pub(super) along: Vector3<f64>,
}

/// The convex hull of points.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Hull {
    points: Vec<Vector3<f64>>,
    /// Those of them that are farthest out in some direction, and of a few points all other corners: of many points, their
    /// hull is a part of the whole.
    outer: Vec<Vector3<f64>>,
    /// Directions, and how far the points reach against and along each.
    reach: Vec<(Vector3<f64>, [f64; 2])>,
    size: f64,
    wide: Widths,
}

impl Hull {
    /// Directions are evenly spread about the points stretched to be as wide as long, so that nothing depends on how flat
    /// they lie.
    pub(super) fn new(points: Vec<Vector3<f64>>) -> Result<Self, RegionError> {
        let Some(&first) = points.first() else { return Err(RegionError::Empty) };
        let size = points.iter().map(|p| (p - first).norm()).fold(0.0, f64::max);
        let wide = Widths::of(&points, first, size);
        let mut outer = Vec::new();
        let mut reach = Vec::new();
        for direction in directions() {
            let n =
                (wide.axes * wide.axes.tr_mul(&direction).component_div(&wide.along)).normalize();
            let (mut low, mut high, mut far) = (f64::INFINITY, f64::NEG_INFINITY, 0);
            for (i, point) in points.iter().enumerate() {
                let along = n.dot(point);
                low = low.min(along);
                if along > high {
                    (high, far) = (along, i);
                }
            }
            outer.push(far);
            reach.push((n, [low, high]));
        }
        outer.sort_unstable();
        outer.dedup();
        let outer = outer.into_iter().map(|i| points[i]).collect();
        let mut hull = Self { points, outer, reach, size, wide };
        if hull.points.len() <= ALL {
            hull.add_corners();
        }
        Ok(hull)
    }

    pub(super) fn points(&self) -> &[Vector3<f64>] {
        &self.points
    }

    pub(super) fn outer(&self) -> &[Vector3<f64>] {
        &self.outer
    }

    pub(super) fn widths(&self) -> &Widths {
        &self.wide
    }

    /// No two points are farther apart than twice this.
    pub(super) fn size(&self) -> f64 {
        self.size
    }

    /// Takes in the corners that are seen from between the directions alone.
    fn add_corners(&mut self) {
        for i in 0..self.points.len() {
            let point = self.points[i];
            if !self.holds(&point) {
                self.outer.push(point);
            }
        }
    }

    /// Whether a point is a mean of corners.
    pub(super) fn holds(&self, point: &Vector3<f64>) -> bool {
        if !(self.size > 0.0) {
            return self.outer.first() == Some(point);
        }
        // Far more than what is told below, for what is plainly outside.
        let slack = 1e-6 * self.size + RELATIVE_TOLERANCE * point.norm();
        let is_beyond = |(n, [low, high]): &(Vector3<f64>, [f64; 2])| {
            let along = n.dot(point);
            along > high + slack || along < low - slack
        };
        !self.reach.iter().any(is_beyond) && self.parting(point).is_none()
    }

    /// The plane that parts a point from the hull, none of a point in it: r₀ > 0 and r with r₀ + r·(q − x)/size ≤ 0 for every q in
    /// the hull.
    ///
    /// Which weights of the points come nearest to x is asked of points as wide as long: of points that lie in a plane but for some last
    /// digits, no others would tell what lies between them. How near that is, is asked in sizes.
    fn parting(&self, point: &Vector3<f64>) -> Option<(f64, Vector3<f64>)> {
        let Widths { axes, along } = &self.wide;
        let place = |x: &Vector3<f64>| {
            let x = axes.tr_mul(&((x - point) / self.size)).component_div(along);
            SVector::<f64, 4>::new(1.0, x.x, x.y, x.z)
        };
        let columns: Vec<_> = self.outer.iter().map(place).collect();
        let rest = non_negative::rest(&columns, &SVector::<f64, 4>::new(1.0, 0.0, 0.0, 0.0));
        let (first, own) = (rest[0], Vector3::new(rest[1], rest[2], rest[3]));
        let is_off = libm::hypot(first, own.component_mul(along).norm()) > DIGITS;
        is_off.then(|| (first, axes * own.component_div(along)))
    }

    /// How far from a point in it the hull ends in a direction: the plane that parts a point outside from it bounds the way,
    /// and the next point is where it does.
    pub(super) fn exit(&self, from: &Vector3<f64>, direction: &Vector3<f64>) -> f64 {
        let mut far = 2.0 * self.size;
        for _ in 0..CUTS {
            let Some((first, along)) = self.parting(&(from + direction * far)) else {
                return far;
            };
            let step = first * self.size / along.dot(direction);
            if !(step > 0.0 && step < far) {
                break;
            }
            far -= step;
        }
        0.0
    }

    /// The least of the conditions ∫ (h − n·x)(n·x + h') dm ≥ 0, over what it would be with all mass in the middle, of a
    /// mass centre and Σ_c/m = Σ_k r_k² a_k a_kᵀ with axes a_k and radii r_k.
    pub(super) fn room(
        &self,
        centre: &Vector3<f64>,
        axes: &Matrix3<f64>,
        radii: &Vector3<f64>,
    ) -> f64 {
        // Rounding of Σ_c/m by ε tr Σ_c/m in any direction changes r_k a_k by half of it over r_k. Across what is flat, a share
        // of the trace would be far more than all that there is.
        let trace = radii.norm_squared();
        let arms =
            [0, 1, 2].map(|k| (axes.column(k) * radii[k], RELATIVE_TOLERANCE * trace / radii[k]));
        let between = |(n, [low, high]): &(Vector3<f64>, [f64; 2])| {
            let at = n.dot(centre);
            // Of what is flat the middle is as far as rounding goes.
            let rounding = RELATIVE_TOLERANCE * (self.size + centre.norm());
            let (low, high) = (low - at - rounding, high - at + rounding);
            let quarter = (0.5 * (high - low)).powi(2).max(f64::MIN_POSITIVE);
            if low > 0.0 || high < 0.0 {
                // The mass centre is outside.
                return -low.max(-high) * low.abs().max(high.abs()) / quarter;
            }
            let along = |(arm, rounding): &(Vector3<f64>, f64)| {
                // Without a radius the rounding is infinite or, of a point, none.
                (n.dot(arm).abs() - rounding).max(0.0).powi(2)
            };
            (-low * high - arms.iter().map(along).sum::<f64>()) / quarter
        };
        self.reach.iter().map(between).fold(f64::INFINITY, f64::min)
    }
}

impl Widths {
    /// Of what is as wide as long.
    pub(super) fn same() -> Self {
        Self { axes: Matrix3::identity(), along: Vector3::from_element(1.0) }
    }

    /// The roots of the second moments of points.
    fn of(points: &[Vector3<f64>], first: Vector3<f64>, size: f64) -> Self {
        if !(size > 0.0) {
            return Self::same();
        }
        let shares = || points.iter().map(|point| (point - first) / size);
        let count = points.len() as f64;
        let mean = shares().sum::<Vector3<f64>>() / count;
        let spread: Matrix3<f64> =
            shares().map(|x| (x - mean) * (x - mean).transpose()).sum::<Matrix3<f64>>() / count;
        let eigen = spread.symmetric_eigen();
        let longest = eigen.eigenvalues.max();
        let along = eigen.eigenvalues.map(|v| v.max(FLAT * FLAT * longest).sqrt());
        Self { axes: eigen.eigenvectors, along }
    }
}

/// Directions all over the sphere, on a spiral, and the axes.
pub(super) fn directions() -> impl Iterator<Item = Vector3<f64>> {
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let spiral = (0..DIRECTIONS).map(move |i| {
        let z = 1.0 - (2 * i + 1) as f64 / DIRECTIONS as f64;
        let (radius, angle) = ((1.0 - z * z).sqrt(), golden * i as f64);
        Vector3::new(radius * libm::cos(angle), radius * libm::sin(angle), z)
    });
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    spiral.chain(axes.into_iter().flat_map(|axis| [axis, -axis]))
}
