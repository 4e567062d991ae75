//! Outlines as the animation draws them.

use nalgebra::Vector3;
use serde_json::{Value, json};

use crate::{scenario::ShapeFile, solid::radii};

/// Corners of a hull up to which its edges are looked for; beyond, its shadow is drawn alone.
const MOST_CORNERS: usize = 160;

/// Shapes from a mass centre that lies at `centre` (body axes, m): points, those of a hull with its
/// edges, or centre and two radii at right angles of a ring.
pub(super) fn drawn(shapes: &[ShapeFile], centre: &Vector3<f64>) -> Vec<Value> {
    let moved = |p: &[f64; 3]| Vector3::from(*p) - centre;
    let list = |points: &[Vector3<f64>]| -> Vec<Value> {
        points.iter().map(|p| Value::Array(short(p.as_slice()))).collect()
    };
    let shape = |shape: &ShapeFile| match shape {
        ShapeFile::PointsM(p) => {
            json!({ "points": list(&p.iter().map(moved).collect::<Vec<_>>()) })
        }
        ShapeFile::HullM(p) => {
            let points: Vec<_> = p.iter().map(moved).collect();
            json!({ "hull": list(&points), "edges": edges(&points) })
        }
        ShapeFile::Ring { centre_m, axis, radius_m } => {
            let [across, other] = radii(*axis, *radius_m);
            json!({ "ring": list(&[moved(centre_m), across, other]) })
        }
    };
    shapes.iter().map(shape).collect()
}

/// Numbers as the animation takes them, to six digits; what is not finite is zero, which draws.
pub(super) fn short(values: &[f64]) -> Vec<Value> {
    let number = |x: &f64| {
        let text = if x.is_finite() { format!("{x:.5e}") } else { "0".to_owned() };
        // Back from text, for the shortest form of it.
        json!(text.parse::<f64>().unwrap_or(0.0))
    };
    values.iter().map(number).collect()
}

/// Edges of the convex hull of points: pairs that, seen along their line, are a corner of all the others.
fn edges(points: &[Vector3<f64>]) -> Vec<[usize; 2]> {
    if points.len() > MOST_CORNERS {
        return Vec::new();
    }
    let size = points.iter().map(|p| (p - points[0]).norm()).fold(0.0, f64::max);
    let pairs = (0..points.len()).flat_map(|j| (0..j).map(move |i| [i, j]));
    pairs.filter(|&[i, j]| is_edge(points, i, j, 1e-9 * size)).collect()
}

fn is_edge(points: &[Vector3<f64>], i: usize, j: usize, small: f64) -> bool {
    let along = points[j] - points[i];
    let length = along.norm();
    if length <= small {
        return false;
    }
    let along = along / length;
    let mut first = None;
    // Angles from the first of the others; all have to lie within less than half a turn.
    let (mut low, mut high) = (0.0_f64, 0.0_f64);
    for p in points {
        let from = p - points[i];
        let (on, aside) = (from.dot(&along), from - along * from.dot(&along));
        if aside.norm() <= small {
            // On the line: it must not stick out.
            if on < -small || on > length + small {
                return false;
            }
            continue;
        }
        let a: Vector3<f64> = *first.get_or_insert(aside);
        let angle = along.dot(&a.cross(&aside)).atan2(a.dot(&aside));
        (low, high) = (low.min(angle), high.max(angle));
    }
    high - low < std::f64::consts::PI - 1e-6
}

#[cfg(test)]
mod tests {
    use super::*;

    fn prism(sides: u32) -> Vec<Vector3<f64>> {
        let corner = |i: u32, z: f64| {
            let (s, c) = (f64::from(i) * std::f64::consts::TAU / f64::from(sides)).sin_cos();
            Vector3::new(c, s, z)
        };
        (0..sides).flat_map(|i| [corner(i, -1.0), corner(i, 1.0)]).collect()
    }

    #[test]
    fn edges_of_solids_plates_and_rods() {
        for sides in [3, 4, 5, 16, 40] {
            assert_eq!(edges(&prism(sides)).len(), 3 * sides as usize, "{sides}");
        }
        // Points inside, and in the middle of a face, have none.
        let mut cube = prism(4);
        cube.extend([Vector3::zeros(), Vector3::z(), Vector3::new(0.1, 0.2, 0.3)]);
        assert_eq!(edges(&cube).len(), 12);
        let plate: Vec<_> = prism(4).into_iter().filter(|p| p.z > 0.0).collect();
        assert_eq!(edges(&plate).len(), 4);
        let (a, b) = (Vector3::x(), Vector3::y());
        assert_eq!(edges(&[a, b]), [[0, 1]]);
        assert_eq!(edges(&[a, b, a * 0.5 + b * 0.5]), [[0, 1]]);
        assert_eq!(edges(&[a, a]), [[0_usize; 2]; 0]);
        assert_eq!(edges(&[a]), [[0_usize; 2]; 0]);
    }

    #[test]
    fn shapes_are_drawn_from_the_mass_centre() {
        let shapes = [
            ShapeFile::PointsM(vec![[1.0, 0.0, 0.0]]),
            ShapeFile::Ring { centre_m: [0.0; 3], axis: [0.0, 0.0, 1e300], radius_m: 2.0 },
        ];
        let drawn = drawn(&shapes, &Vector3::new(1.0, 2.0, 0.0));
        assert_eq!(drawn[0]["points"], json!([[0.0, -2.0, 0.0]]));
        let ring: Vec<Vector3<f64>> =
            serde_json::from_value::<Vec<[f64; 3]>>(drawn[1]["ring"].clone())
                .unwrap()
                .into_iter()
                .map(Vector3::from)
                .collect();
        assert_eq!(ring[0], Vector3::new(-1.0, -2.0, 0.0));
        assert!((ring[1].norm() - 2.0).abs() < 1e-4 && (ring[2].norm() - 2.0).abs() < 1e-4);
        assert!(ring[1].z == 0.0 && ring[2].z == 0.0 && ring[1].dot(&ring[2]).abs() < 1e-9);
    }
}
