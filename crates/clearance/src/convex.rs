//! Distance of the convex hulls of two sets of points: the algorithm of Gilbert, Johnson & Keerthi
//! (1988, doi:10.1109/56.2083), on directions turned into body axes.

use nalgebra::Vector3;

use crate::motion::Frame;

/// Nearest points of two hulls, as far as found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearest {
    /// From the stage's to the payload's point, inertial axes; zero where the hulls meet.
    pub(crate) gap: Vector3<f64>,
    /// Rate at which its direction turns with the edge or face on which it stands, 1/s.
    pub(crate) turning: Vector3<f64>,
    /// The two points, body axes.
    pub(crate) points: [Vector3<f64>; 2],
    /// The hulls are at least so far apart.
    pub(crate) at_least: f64,
    /// Where they meet, one has to move by this at least for them to part.
    pub(crate) depth: f64,
    /// On what the gap stands: corners, and the unit vector along the edge of two.
    pub(crate) corners: usize,
    pub(crate) edge: Vector3<f64>,
}

impl Nearest {
    pub(crate) fn distance(&self) -> f64 {
        self.gap.norm()
    }

    /// Rate of the unit vector from the other body's point to that of `body`, a single point, as that
    /// point moves with `velocity` and the gap keeps standing on the corner, edge or face it stands on.
    pub(crate) fn following(&self, velocity: &Vector3<f64>, body: usize) -> Vector3<f64> {
        let distance = self.gap.norm();
        if !(distance > 0.0) || self.corners > 2 {
            return Vector3::zeros();
        }
        let n = if body == 0 { self.gap / distance } else { self.gap / -distance };
        let aside = velocity - n * n.dot(velocity);
        let aside = (aside - self.edge * self.edge.dot(&aside)) / distance;
        // At right angles to the last bit, as far as doubles go.
        let aside = aside - n * n.dot(&aside);
        if aside.iter().all(|x| x.abs() < 1e100) { aside } else { Vector3::zeros() }
    }
}

/// A corner of the difference of two hulls.
#[derive(Clone, Copy, Debug)]
struct Corner {
    at: Vector3<f64>,
    indices: (usize, usize),
}

/// Duality gap below which a distance is as good as doubles make it.
const CONVERGED: f64 = 1e-15;
const MOST_ROUNDS: usize = 64;

/// The nearest points, searched from the direction `hint` (stage to payload) on.
pub(crate) fn nearest(frame: &Frame, points: [&[Vector3<f64>]; 2], hint: &Vector3<f64>) -> Nearest {
    let mut simplex = [Corner { at: Vector3::zeros(), indices: (0, 0) }; 4];
    simplex[0] = corner(frame, points, hint);
    let mut size = 1;
    let mut weights = [1.0, 0.0, 0.0, 0.0];
    let mut gap = simplex[0].at;
    let mut at_least = 0.0_f64;
    let mut largest = gap.norm_squared();
    for _ in 0..MOST_ROUNDS {
        let square = gap.norm_squared();
        // Rounding of the corners: nearer than this is touching.
        if !(square > 1e-31 * largest) {
            gap = Vector3::zeros();
            break;
        }
        let next = corner(frame, points, &gap);
        let along = gap.dot(&next.at);
        at_least = at_least.max(along / square.sqrt());
        let known = simplex[..size].iter().any(|c| c.indices == next.indices);
        if known || !(square - along > CONVERGED * square) {
            break;
        }
        largest = largest.max(next.at.norm_squared());
        let mut trial = simplex;
        trial[size] = next;
        let (reduced, found, new_weights, new_gap) = closest_to_origin(&trial, size + 1);
        if new_gap.norm_squared() >= square {
            break;
        }
        (simplex, size, weights, gap) = (reduced, found, new_weights, new_gap);
    }
    let mut ends = [Vector3::zeros(); 2];
    for (c, w) in simplex[..size].iter().zip(weights) {
        ends[0] += points[0][c.indices.0] * w;
        ends[1] += points[1][c.indices.1] * w;
    }
    let turning = turning(frame, points, &simplex[..size], &gap);
    let depth = if size == 4 { depth(&simplex) } else { 0.0 };
    let edge = match &simplex[..size] {
        [a, b] => (b.at - a.at).try_normalize(0.0).unwrap_or_default(),
        _ => Vector3::zeros(),
    };
    Nearest { gap, turning, points: ends, at_least, depth, corners: size, edge }
}

/// Radius of a ball about the origin within a tetrahedron around it.
fn depth(simplex: &[Corner; 4]) -> f64 {
    let face = |i: usize, j: usize, k: usize| {
        let [a, b, c] = [i, j, k].map(|i| simplex[i].at);
        let normal = (b - a).cross(&(c - a));
        normal.dot(&a).abs() / normal.norm()
    };
    // The minimum passes over a NaN: a face that is none leaves the others.
    let least = face(0, 1, 2).min(face(0, 1, 3)).min(face(0, 2, 3)).min(face(1, 2, 3));
    // A hair less, for rounding; a tetrahedron that is flat holds nothing.
    let size = simplex.iter().map(|c| c.at.norm()).fold(0.0, f64::max);
    (least * (1.0 - 1e-9) - 1e-12 * size).max(0.0)
}

/// How the unit vector along the gap has to turn for the corners of an edge or a face on which it
/// stands to stay level, to first order. About an edge, and on a corner, it is left free to stay.
fn turning(
    frame: &Frame,
    points: [&[Vector3<f64>]; 2],
    simplex: &[Corner],
    gap: &Vector3<f64>,
) -> Vector3<f64> {
    let distance = gap.norm();
    if !(distance > 0.0) {
        return Vector3::zeros();
    }
    let n = gap / distance;
    let velocity = |c: &Corner| {
        let arm = |body: usize, i: usize| {
            frame.rate[body].cross(&(frame.rotation[body] * points[body][i]))
        };
        frame.velocity + arm(0, c.indices.0) - arm(1, c.indices.1)
    };
    let velocities: [Vector3<f64>; 4] =
        std::array::from_fn(|k| simplex.get(k).map_or_else(Vector3::zeros, velocity));
    let rise = |k: usize| -n.dot(&(velocities[k] - velocities[0]));
    let turning = match simplex {
        [a, b] => {
            let edge = b.at - a.at;
            edge * (rise(1) / edge.norm_squared())
        }
        [a, b, c] => {
            // The two edges are level: a gradient in their plane, by its duals.
            let (e, f) = (b.at - a.at, c.at - a.at);
            let normal = e.cross(&f);
            (f.cross(&normal) * rise(1) + normal.cross(&e) * rise(2)) / normal.norm_squared()
        }
        _ => Vector3::zeros(),
    };
    let turning = turning - n * n.dot(&turning);
    if turning.iter().all(|x| x.abs() < 1e100) { turning } else { Vector3::zeros() }
}

/// The corner of the difference payload − stage that lies least along `direction`.
fn corner(frame: &Frame, points: [&[Vector3<f64>]; 2], direction: &Vector3<f64>) -> Corner {
    let i = farthest_along(points[0], &-frame.rotation[0].tr_mul(direction));
    let j = farthest_along(points[1], &frame.rotation[1].tr_mul(direction));
    let at = frame.offset + frame.rotation[0] * points[0][i] - frame.rotation[1] * points[1][j];
    Corner { at, indices: (i, j) }
}

fn farthest_along(points: &[Vector3<f64>], direction: &Vector3<f64>) -> usize {
    let mut best = (f64::NEG_INFINITY, 0);
    for (i, p) in points.iter().enumerate() {
        let along = p.dot(direction);
        if along > best.0 {
            best = (along, i);
        }
    }
    best.1
}

/// The point of a simplex nearest to the origin: the corners it needs, how many, weights, point.
///
/// Looks at every face that has the last corner, which is new and nearer, so that the nearest face has
/// it: slower than walking Voronoi regions, and no rounding leads it astray.
fn closest_to_origin(
    simplex: &[Corner; 4],
    size: usize,
) -> ([Corner; 4], usize, [f64; 4], Vector3<f64>) {
    let mut best = (f64::INFINITY, [0; 3], 1, [1.0, 0.0, 0.0], Vector3::zeros());
    let mut offer = |chosen: [usize; 3], n: usize, weights: [f64; 3], point: Vector3<f64>| {
        let square = point.norm_squared();
        if square < best.0 {
            best = (square, chosen, n, weights, point);
        }
    };
    let at = |i: usize| &simplex[i].at;
    let i = size - 1;
    offer([i, 0, 0], 1, [1.0, 0.0, 0.0], *at(i));
    for j in 0..i {
        let edge = at(j) - at(i);
        let square = edge.norm_squared();
        let t = -at(i).dot(&edge) / square;
        if t > 0.0 && t < 1.0 {
            // Once more at right angles: where the point is near the origin, rounding turns it by more
            // than a bound along its direction can bear.
            let point = at(i) + edge * t;
            let point = point - edge * (point.dot(&edge) / square);
            offer([i, j, 0], 2, [1.0 - t, t, 0.0], point);
        }
        for k in 0..j {
            if let Some((weights, point)) = on_triangle(at(i), at(j), at(k)) {
                offer([i, j, k], 3, weights, point);
            }
        }
    }
    if size == 4
        && let Some(weights) = within(simplex)
    {
        return (*simplex, 4, weights, Vector3::zeros());
    }
    let (_, chosen, n, [a, b, c], point) = best;
    let mut reduced = *simplex;
    for (slot, &i) in reduced.iter_mut().zip(&chosen[..n]) {
        *slot = simplex[i];
    }
    (reduced, n, [a, b, c, 0.0], point)
}

/// The foot of the perpendicular from the origin on a triangle, if it lies within, and its weights.
fn on_triangle(
    a: &Vector3<f64>,
    b: &Vector3<f64>,
    c: &Vector3<f64>,
) -> Option<([f64; 3], Vector3<f64>)> {
    let normal = (b - a).cross(&(c - a));
    let square = normal.norm_squared();
    let weights = [normal.dot(&b.cross(c)), normal.dot(&c.cross(a)), normal.dot(&a.cross(b))]
        .map(|x| x / square);
    (weights.iter().all(|w| *w > 0.0) && square > 0.0)
        .then(|| (weights, normal * (normal.dot(a) / square)))
}

/// Weights of the corners of a tetrahedron around the origin, if it is around it.
fn within(simplex: &[Corner; 4]) -> Option<[f64; 4]> {
    let [a, b, c, d] = simplex.map(|c| c.at);
    let volume = |p: &Vector3<f64>, q: &Vector3<f64>, r: &Vector3<f64>| p.dot(&q.cross(r));
    let parts = [volume(&b, &d, &c), volume(&a, &c, &d), volume(&a, &d, &b), volume(&a, &b, &c)];
    let total: f64 = parts.iter().sum();
    let weights = parts.map(|v| v / total);
    weights.iter().all(|w| *w >= 0.0).then_some(weights)
}

/// How far the hulls are apart along `normals` (stage to payload, inertial axes, each of about unit
/// length) at the two times `times` from the frame's, if every point kept its velocity.
pub(crate) fn gap_along(
    frame: &Frame,
    points: [&[Vector3<f64>]; 2],
    normals: &[Vector3<f64>; 2],
    times: [f64; 2],
) -> [f64; 2] {
    let [low, high] = [-1.0, 1.0].map(|sign: f64| {
        let body = usize::from(sign > 0.0);
        let directions = [0, 1].map(|k| direction(frame, body, &normals[k], times[k]) * sign);
        let mut most = [f64::NEG_INFINITY; 2];
        for p in points[body] {
            most = [most[0].max(p.dot(&directions[0])), most[1].max(p.dot(&directions[1]))];
        }
        most
    });
    [0, 1].map(|k| normals[k].dot(&(frame.offset + frame.velocity * times[k])) - low[k] - high[k])
}

/// n·(x + t ω × x) = x·(n + t n × ω), in body axes.
pub(crate) fn direction(frame: &Frame, body: usize, normal: &Vector3<f64>, t: f64) -> Vector3<f64> {
    frame.rotation[body].tr_mul(&(normal + normal.cross(&frame.rate[body]) * t))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RigidState;
    use nalgebra::UnitQuaternion;
    use proptest::prelude::*;

    type V = Vector3<f64>;

    pub(crate) fn frame(offset: V, a: [f64; 3], b: [f64; 3]) -> Frame {
        let state = |position, turn: [f64; 3]| RigidState {
            position,
            attitude: UnitQuaternion::from_scaled_axis(turn.into()),
            ..RigidState::default()
        };
        Frame::new(&[state(offset, a), state(V::zeros(), b)]).unwrap()
    }

    fn cube(half: f64) -> Vec<V> {
        (0..8)
            .map(|i| {
                let sign = |bit: u32| if i >> bit & 1 == 0 { -half } else { half };
                V::new(sign(0), sign(1), sign(2))
            })
            .collect()
    }

    #[test]
    fn cubes() {
        let (a, b) = (cube(1.0), cube(0.5));
        let distance = |offset: V, turn: [f64; 3]| {
            nearest(&frame(offset, turn, [0.0; 3]), [&a, &b], &V::new(0.3, 0.2, 0.1)).distance()
        };
        // Face to face, edge to edge, corner to corner, and through each other.
        assert!((distance(V::new(2.0, 0.1, 0.2), [0.0; 3]) - 0.5).abs() < 1e-15);
        assert!((distance(V::new(2.0, 2.5, 0.1), [0.0; 3]) - 1.25_f64.sqrt()).abs() < 1e-15);
        assert!((distance(V::new(2.5, -2.5, 2.5), [0.0; 3]) - 3.0_f64.sqrt()).abs() < 1e-15);
        let edge = std::f64::consts::FRAC_PI_4;
        let gap = 3.0 - 2.0_f64.sqrt() - 0.5;
        assert!((distance(V::new(3.0, 0.0, 0.0), [0.0, 0.0, edge]) - gap).abs() < 1e-14);
        assert_eq!(distance(V::new(0.3, 0.2, 1.0), [0.1, 0.2, 0.3]), 0.0);
        assert_eq!(distance(V::zeros(), [0.0; 3]), 0.0);
    }

    /// An independent way: Frank and Wolfe's iteration with line search on the difference of the
    /// hulls, with pairwise steps, to its own duality gap.
    fn by_pairwise_descent(corners: &[V]) -> (f64, f64) {
        let mut weights = vec![0.0; corners.len()];
        weights[0] = 1.0;
        let mut x = corners[0];
        let mut gap = f64::INFINITY;
        for _ in 0..200_000 {
            let along = |i: &usize| x.dot(&corners[*i]);
            let to = (0..corners.len()).min_by(|i, j| along(i).total_cmp(&along(j))).unwrap();
            let from = (0..corners.len())
                .filter(|&i| weights[i] > 0.0)
                .max_by(|i, j| along(i).total_cmp(&along(j)))
                .unwrap();
            gap = x.dot(&(x - corners[to]));
            if gap < 1e-13 {
                break;
            }
            let step = corners[to] - corners[from];
            let t = (-x.dot(&step) / step.norm_squared()).clamp(0.0, weights[from]);
            weights[from] -= t;
            weights[to] += t;
            x += step * t;
        }
        (x.norm(), gap)
    }

    fn cloud() -> impl Strategy<Value = Vec<[f64; 3]>> {
        prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), 1..12)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(256))]
        #[test]
        fn distances_agree_with_descent_and_bounds_hold(
            a in cloud(),
            b in cloud(),
            offset in prop::array::uniform3(-2.5..2.5f64),
            turns in prop::array::uniform2(prop::array::uniform3(-3.0..3.0f64)),
            flat in any::<bool>(),
        ) {
            // Flat ones too: plates and rods.
            let flatten = |v: Vec<[f64; 3]>| {
                v.into_iter()
                    .map(|p| if flat { V::new(p[0], p[1].round(), 0.5) } else { V::from(p) })
                    .collect::<Vec<_>>()
            };
            let (a, b) = (flatten(a), flatten(b));
            let frame = frame(offset.into(), turns[0], turns[1]);
            let found = nearest(&frame, [&a, &b], &frame.offset);
            let corners: Vec<V> = a
                .iter()
                .flat_map(|p| b.iter().map(move |q| (p, q)))
                .map(|(p, q)| frame.offset + frame.rotation[0] * p - frame.rotation[1] * q)
                .collect();
            let (exact, gap) = by_pairwise_descent(&corners);
            let distance = found.distance();
            prop_assert!(distance <= exact + 1e-12, "{distance} {exact}");
            // Its own gap bounds what descent may still be above.
            let least = (exact * exact - gap).max(0.0).sqrt();
            prop_assert!(distance >= least - 1e-7 * f64::from(u8::from(exact < 1e-6)) - 1e-12,
                "{distance} {exact} {gap}");
            prop_assert!(found.at_least <= distance + 1e-14);
            prop_assert!(distance - found.at_least < 1e-12, "{} {distance}", found.at_least);
            let between = frame.offset + frame.rotation[0] * found.points[0]
                - frame.rotation[1] * found.points[1];
            prop_assert!((between - found.gap).norm() < 1e-13);
        }
    }

    /// Hulls that meet still meet after any move shorter than the depth.
    #[test]
    fn depth_is_no_deeper_than_it_is() {
        let (a, b) = (cube(1.0), cube(0.5));
        let mut deepest = 0.0_f64;
        for k in 0..200 {
            let angle = f64::from(k);
            let offset =
                V::new(0.6 * angle.sin(), 0.5 * (1.7 * angle).cos(), 0.4 * (2.3 * angle).sin());
            let at = frame(offset, [0.1 * angle, 0.3, 0.0], [0.0, 0.2 * angle, 0.1]);
            let found = nearest(&at, [&a, &b], &V::new(angle.cos(), angle.sin(), 0.3));
            if found.distance() > 0.0 {
                continue;
            }
            deepest = deepest.max(found.depth);
            for i in 0..60 {
                let (s, c) = (f64::from(i) * 2.4).sin_cos();
                let z = f64::from(i) / 30.0 - 1.0;
                let way = V::new(c, s, 0.0) * (1.0 - z * z).sqrt() + V::z() * z;
                let moved = Frame { offset: offset + way * (found.depth * 0.999_999), ..at };
                assert_eq!(nearest(&moved, [&a, &b], &moved.offset).distance(), 0.0, "{k} {i}");
            }
        }
        assert!(deepest > 0.2, "{deepest}");
    }
}
