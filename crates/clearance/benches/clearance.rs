//! One clearance query over a coast of 60 s.
#![allow(missing_docs, reason = "criterion's macros make public items")]
#![allow(clippy::unwrap_used, reason = "a bench that cannot go on fails")]

use criterion::{Criterion, criterion_group, criterion_main};
use gyradius_clearance::{
    Clearance, ClearanceSettings, Coast, FreeBody, Outline, OutlineShape, RigidState,
};
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use std::hint::black_box;

type V = Vector3<f64>;

fn free(state: RigidState, [a, b, c]: [f64; 3], [p, q, r]: [f64; 3]) -> FreeBody {
    FreeBody::new(state, Matrix3::new(a, p, q, p, b, r, q, r, c)).unwrap()
}

fn moving(moments: [f64; 3], position: V, velocity: V, angular_velocity: V) -> FreeBody {
    let state = RigidState { position, velocity, angular_velocity, ..RigidState::default() };
    free(state, moments, [20.0, 10.0, -20.0])
}

/// A prism of `sides` sides about z.
fn prism(sides: u32, radius: f64, bottom: f64, top: f64) -> Outline {
    let corner = |i: u32, z: f64| {
        let (s, c) = (f64::from(i) * std::f64::consts::TAU / f64::from(sides)).sin_cos();
        V::new(radius * c, radius * s, z)
    };
    let points: Vec<V> = (0..sides).flat_map(|i| [corner(i, bottom), corner(i, top)]).collect();
    OutlineShape::hull(&points).unwrap().into()
}

fn ring(z: f64, radius: f64) -> Outline {
    OutlineShape::ring(V::z() * z, V::z(), radius).unwrap().into()
}

/// The last release of the separation of Peck (2003), Table 1, as `gyradius-separation` integrates it.
fn paper() -> [FreeBody; 2] {
    let state = |position: [f64; 3], velocity: [f64; 3], [i, j, k, w]: [f64; 4], rate: [f64; 3]| {
        RigidState {
            position: position.into(),
            velocity: velocity.into(),
            attitude: UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k)),
            angular_velocity: rate.into(),
        }
    };
    let payload = state(
        [4.391377e-6, 2.2446779e-4, 1.0469084],
        [1.8137802e-5, 1.7523087e-3, 0.26113116],
        [1.887411e-2, -7.628484e-5, -4.709204e-5, 0.9998219],
        [0.15930837, -4.1853007e-4, -6.2946844e-4],
    );
    let stage = state(
        [-1.0978443e-5, -5.6116946e-4, -1.117271],
        [-4.5344504e-5, -4.3807717e-3, -0.6528279],
        [-1.3745084e-2, -1.461533e-5, 1.8189134e-4, 0.9999055],
        [-0.11353697, -2.3887004e-4, 1.8046013e-3],
    );
    [
        free(payload, [5e3, 4e3, 3e3], [20.0, 2.0, -50.0]),
        free(stage, [6.7e3, 6.7e3, 2e3], [0.0, 20.0, -20.0]),
    ]
}

fn both(a: &Outline, b: &Outline) -> Outline {
    Outline::new([a.shapes(), b.shapes()].concat()).unwrap()
}

fn clearance(c: &mut Criterion) {
    let parted = paper();
    let spacecraft = both(&prism(16, 1.2, -0.85, 1.5), &ring(-0.95, 0.6));
    let nozzle = prism(16, 0.35, -1.6, -0.85);
    // After a separation with tip-off, spinning and at rest.
    let tip_off = [
        moving([5e3, 4e3, 3e3], V::z(), V::z() * 0.3, V::new(0.05, -0.02, 0.01)),
        moving([6.7e3, 6.7e3, 2e3], -V::z(), V::z() * -0.6, V::new(-0.02, 0.04, 0.0)),
    ];
    // Slow and tumbling: comes near again before it is clear.
    let tumbling = [
        moving([5e3, 4e3, 3e3], V::z() * 1.1, V::z() * 0.06, V::new(0.15, 0.05, 0.0)),
        moving([6.7e3, 6.7e3, 2e3], -V::z(), V::zeros(), V::zeros()),
    ];
    let cases: [(&str, &[FreeBody; 2], Outline, Outline); 11] = [
        ("paper: spacecraft and adapter ring", &parted, spacecraft.clone(), ring(0.95, 0.6)),
        (
            "paper: spacecraft and stage",
            &parted,
            spacecraft,
            both(&prism(16, 1.3, -2.5, 0.7), &ring(0.95, 0.6)),
        ),
        ("paper: nozzle leaves the adapter ring", &parted, nozzle.clone(), ring(0.95, 0.6)),
        ("paper: nozzle strikes its well", &parted, nozzle, ring(0.7, 0.4)),
        ("hulls of 8", &tip_off, prism(4, 1.0, -0.9, 1.5), prism(4, 1.0, -2.0, 0.9)),
        ("hulls of 30", &tip_off, prism(15, 1.0, -0.9, 1.5), prism(15, 1.0, -2.0, 0.9)),
        ("hulls of 8, near again", &tumbling, prism(4, 1.0, -0.9, 1.5), prism(4, 1.0, -2.0, 0.9)),
        (
            "hulls of 30, near again",
            &tumbling,
            prism(15, 1.0, -0.9, 1.5),
            prism(15, 1.0, -2.0, 0.9),
        ),
        ("rings", &tip_off, ring(-0.95, 0.6), ring(0.95, 0.6)),
        ("ring from a well", &tip_off, ring(-1.4, 0.5), ring(0.9, 0.6)),
        ("ring and hull of 30", &tip_off, ring(-0.95, 0.6), prism(15, 1.0, -2.0, 0.9)),
    ];
    let settings = ClearanceSettings::default();
    let mut group = c.benchmark_group("clearance");
    for (name, bodies, payload, stage) in &cases {
        let query = || {
            let [p, s] = black_box(*bodies);
            let mut coast = Coast::new(p, s, 0.0);
            Clearance::new(payload, stage, &mut coast, 0.0, 60.0, &settings).unwrap()
        };
        let found = query();
        let closest = found.closest().unwrap();
        eprintln!(
            "{name}: {:.6} m at {:.3} s, contact {:?}, {} looks",
            closest.distance_m(),
            closest.time_s(),
            found.contact_s(),
            found.looks()
        );
        group.bench_function(*name, |b| b.iter(query));
    }
    group.finish();
}

criterion_group!(benches, clearance);
criterion_main!(benches);
