//! The convex hull of points, looked at from all sides.

use nalgebra::{Matrix3, Vector3};

use super::RegionError;
use crate::RELATIVE_TOLERANCE;

/// Directions in which a hull is looked at.
const DIRECTIONS: usize = 400;
/// What a hull that is flat to this share of its size is stretched by at most.
const FLAT: f64 = 1e-6;

/// The convex hull of points.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Hull {
    points: Vec<Vector3<f64>>,
    /// Those of them that are farthest out in some direction, whose hull is a part of the whole.
    outer: Vec<Vector3<f64>>,
    /// Directions, and how far the points reach against and along each.
    reach: Vec<(Vector3<f64>, [f64; 2])>,
    size: f64,
}

impl Hull {
    /// Directions are evenly spread about the points stretched to be as wide as long, so that nothing depends on how flat
    /// they lie.
    pub(super) fn new(points: Vec<Vector3<f64>>) -> Result<Self, RegionError> {
        let Some(&first) = points.first() else { return Err(RegionError::Empty) };
        let size = points.iter().map(|p| (p - first).norm()).fold(0.0, f64::max);
        let stretch = stretch(&points, first, size);
        let mut outer = Vec::new();
        let mut reach = Vec::new();
        for direction in directions() {
            let n = (stretch * direction).normalize();
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
        Ok(Self { points, outer, reach, size })
    }

    pub(super) fn points(&self) -> &[Vector3<f64>] {
        &self.points
    }

    pub(super) fn outer(&self) -> &[Vector3<f64>] {
        &self.outer
    }

    /// No two points are farther apart than twice this.
    pub(super) fn size(&self) -> f64 {
        self.size
    }

    /// The least of the conditions ∫ (h − n·x)(n·x + h') dm ≥ 0, over what it would be with all mass in the middle, of a
    /// mass centre and Σ_c/m.
    pub(super) fn room(&self, centre: &Vector3<f64>, spread: &Matrix3<f64>) -> f64 {
        let least = (RELATIVE_TOLERANCE * self.size).powi(2);
        let between = |(n, [low, high]): &(Vector3<f64>, [f64; 2])| {
            let at = n.dot(centre);
            // Of what is flat the middle is as far as rounding goes.
            let rounding = RELATIVE_TOLERANCE * (self.size + centre.norm());
            let (low, high) = (low - at - rounding, high - at + rounding);
            let quarter = (0.5 * (high - low)).powi(2).max(least).max(f64::MIN_POSITIVE);
            if low > 0.0 || high < 0.0 {
                // The mass centre is outside.
                return -low.max(-high) * low.abs().max(high.abs()) / quarter;
            }
            (-low * high - n.dot(&(spread * n))) / quarter
        };
        self.reach.iter().map(between).fold(f64::INFINITY, f64::min)
    }
}

/// What makes the points as wide as long: the inverse root of their second moments.
fn stretch(points: &[Vector3<f64>], first: Vector3<f64>, size: f64) -> Matrix3<f64> {
    if !(size > 0.0) {
        return Matrix3::identity();
    }
    let shares = || points.iter().map(|point| (point - first) / size);
    let count = points.len() as f64;
    let mean = shares().sum::<Vector3<f64>>() / count;
    let spread: Matrix3<f64> =
        shares().map(|x| (x - mean) * (x - mean).transpose()).sum::<Matrix3<f64>>() / count;
    let eigen = spread.symmetric_eigen();
    let longest = eigen.eigenvalues.max();
    let inverse = eigen.eigenvalues.map(|v| 1.0 / v.max(FLAT * FLAT * longest).sqrt());
    eigen.eigenvectors * Matrix3::from_diagonal(&inverse) * eigen.eigenvectors.transpose()
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
