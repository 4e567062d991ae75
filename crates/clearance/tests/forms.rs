//! Shapes as the tests know them, and their distance found in another way than the program's.

use gyradius_clearance::{FreeBody, Outline, OutlineShape, RigidState};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use proptest::prelude::*;

pub(crate) type V = Vector3<f64>;

/// A shape as the tests know it.
#[derive(Clone, Debug)]
pub(crate) enum Form {
    Points(Vec<V>),
    Hull(Vec<V>),
    Ring(V, V, f64),
}

impl Form {
    pub(crate) fn scaled(&self, k: f64) -> Self {
        match self {
            Self::Points(p) => Self::Points(p.iter().map(|x| x * k).collect()),
            Self::Hull(p) => Self::Hull(p.iter().map(|x| x * k).collect()),
            Self::Ring(c, a, r) => Self::Ring(c * k, *a, r * k),
        }
    }

    pub(crate) fn shape(&self) -> OutlineShape {
        match self {
            Self::Points(p) => OutlineShape::points(p),
            Self::Hull(p) => OutlineShape::hull(p),
            Self::Ring(c, a, r) => OutlineShape::ring(*c, *a, *r),
        }
        .unwrap()
    }

    pub(crate) fn outline(&self) -> Outline {
        self.shape().into()
    }

    /// Convex pieces in inertial axes, and how many times as many for a ring cut finer.
    pub(crate) fn pieces(&self, state: &RigidState, count: i32) -> Vec<Vec<V>> {
        let place = |x: &V| state.position + state.attitude * x;
        match self {
            Self::Points(p) => p.iter().map(|x| vec![place(x)]).collect(),
            Self::Hull(p) => vec![p.iter().map(place).collect()],
            Self::Ring(..) => (0..count)
                .map(|k| vec![place(&self.on_ring(f64::from(k) / f64::from(count)))])
                .collect(),
        }
    }

    pub(crate) fn on_ring(&self, turns: f64) -> V {
        let Self::Ring(c, a, r) = self else { panic!() };
        let z = a.normalize();
        let x = z.cross(&V::new(0.3, -0.5, 0.8)).normalize();
        let (s, k) = (turns * std::f64::consts::TAU).sin_cos();
        c + (x * k + z.cross(&x) * s) * *r
    }

    /// How far a point in body axes lies from it.
    pub(crate) fn off(&self, x: &V) -> f64 {
        match self {
            Self::Points(p) => p.iter().map(|q| (q - x).norm()).fold(f64::INFINITY, f64::min),
            Self::Hull(p) => nearest(&p.iter().map(|q| q - x).collect::<Vec<_>>()),
            Self::Ring(c, a, r) => {
                let (d, z) = (x - c, a.normalize());
                let along = d.dot(&z);
                ((d - z * along).norm() - r).hypot(along)
            }
        }
    }
}

/// Distance of the origin from the hull of points: Wolfe's algorithm (1976, doi:10.1007/BF01580381), by
/// linear solves for the nearest point of the plane through the points in use.
pub(crate) fn nearest(corners: &[V]) -> f64 {
    let size = corners.iter().map(V::norm_squared).fold(0.0, f64::max);
    let mut used = vec![0];
    let mut weights = vec![1.0];
    let mut x = corners[0];
    for _ in 0..200 {
        let along = |i: &usize| x.dot(&corners[*i]);
        let next = (0..corners.len()).min_by(|i, j| along(i).total_cmp(&along(j))).unwrap();
        if x.norm_squared() - along(&next) <= 1e-15 * size || used.contains(&next) {
            break;
        }
        used.push(next);
        weights.push(0.0);
        loop {
            let n = used.len();
            if n == 1 {
                weights = vec![1.0];
                break;
            }
            let first = corners[used[0]];
            let edges = DMatrix::from_fn(3, n - 1, |i, k| (corners[used[k + 1]] - first)[i]);
            let rest = edges
                .svd(true, true)
                .solve(&DVector::from_fn(3, |i, _| -first[i]), 1e-12 * size.sqrt());
            let rest = rest.unwrap();
            let flat: Vec<f64> =
                std::iter::once(1.0 - rest.sum()).chain(rest.iter().copied()).collect();
            if flat.iter().all(|w| *w > 1e-13) {
                weights = flat;
                break;
            }
            // As far as the first weight that vanishes, whose point goes.
            let stays = |i: usize| weights[i] / (weights[i] - flat[i]);
            let share = (0..n).filter(|i| flat[*i] <= 1e-13).map(stays);
            let share = share.fold(1.0, f64::min).max(0.0);
            for i in 0..n {
                weights[i] += share * (flat[i] - weights[i]);
            }
            let keep: Vec<usize> = (0..n).filter(|i| weights[*i] > 1e-13).collect();
            used = keep.iter().map(|i| used[*i]).collect();
            weights = keep.iter().map(|i| weights[*i]).collect();
            if used.len() == n {
                break;
            }
        }
        let sum: f64 = weights.iter().sum();
        x = used.iter().zip(&weights).map(|(i, w)| corners[*i] * (*w / sum)).sum();
    }
    x.norm()
}

/// Distance at an instant, from above: rings by points on them, then about the nearest.
pub(crate) fn distance(forms: [&Form; 2], states: &[RigidState; 2]) -> f64 {
    let between = |a: &[V], b: &[V]| {
        let corners: Vec<V> = a.iter().flat_map(|p| b.iter().map(move |q| p - q)).collect();
        nearest(&corners)
    };
    let least = |a: &[Vec<V>], b: &[Vec<V>]| {
        let mut best = (f64::INFINITY, 0, 0);
        for (i, p) in a.iter().enumerate() {
            for (j, q) in b.iter().enumerate() {
                let d = between(p, q);
                if d < best.0 {
                    best = (d, i, j);
                }
            }
        }
        best
    };
    const COUNT: i32 = 48;
    let pieces = [0, 1].map(|k| forms[k].pieces(&states[k], COUNT));
    let (mut best, i, j) = least(&pieces[0], &pieces[1]);
    // Compass search on the angles of the rings.
    let mut turns = [i, j].map(|k| k as f64 / f64::from(COUNT));
    let is_ring = [0, 1].map(|k| matches!(forms[k], Form::Ring(..)));
    let at = |turns: [f64; 2]| {
        let piece = |k: usize, which: usize| {
            if is_ring[k] {
                vec![states[k].position + states[k].attitude * forms[k].on_ring(turns[k])]
            } else {
                pieces[k][which].clone()
            }
        };
        between(&piece(0, i), &piece(1, j))
    };
    if is_ring[0] || is_ring[1] {
        let mut step = 0.5 / f64::from(COUNT);
        while step > 1e-7 {
            let mut moved = false;
            for k in (0..2).filter(|k| is_ring[*k]) {
                for by in [-step, step] {
                    let mut next = turns;
                    next[k] += by;
                    let d = at(next);
                    if d < best {
                        (best, turns, moved) = (d, next, true);
                    }
                }
            }
            if !moved {
                step *= 0.5;
            }
        }
    }
    best
}

pub(crate) fn body(moments: [f64; 3], position: V, velocity: V, angular_velocity: V) -> FreeBody {
    let state = RigidState { position, velocity, angular_velocity, ..RigidState::default() };
    FreeBody::new(state, Matrix3::from_diagonal(&moments.into())).unwrap()
}

pub(crate) fn at_rest() -> FreeBody {
    body([1.0; 3], V::zeros(), V::zeros(), V::zeros())
}

pub(crate) fn vector(range: f64) -> impl Strategy<Value = V> {
    prop::array::uniform3(-range..range).prop_map(V::from)
}

/// Points, solids, rings; and hulls of a point, of a point twice, on a line, in a plane.
pub(crate) fn form() -> impl Strategy<Value = Form> {
    let cloud = |n: std::ops::Range<usize>| prop::collection::vec(vector(1.0), n);
    prop_oneof![
        cloud(1..4).prop_map(Form::Points),
        cloud(4..12).prop_map(Form::Hull),
        vector(1.0).prop_map(|p| Form::Hull(vec![p, p, p])),
        (vector(1.0), vector(1.0)).prop_map(|(p, q)| Form::Hull(
            [0.0, 0.3, 1.0, 0.3, 0.7].map(|t| p + (q - p) * t).into()
        )),
        (cloud(3..8), vector(1.0)).prop_map(|(p, n)| {
            let n = n.normalize();
            Form::Hull(p.into_iter().map(|x| x - n * n.dot(&x)).collect())
        }),
        (vector(0.5), vector(1.0), 0.1..1.5f64)
            .prop_filter("axis", |r| r.1.norm() > 0.05)
            .prop_map(|(c, a, r)| Form::Ring(c, a, r)),
        (vector(0.5), vector(1.0), 0.1..1.5f64)
            .prop_filter("axis", |r| r.1.norm() > 0.05)
            .prop_map(|(c, a, r)| Form::Ring(c, a, r)),
    ]
}
