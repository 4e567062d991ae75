//! One separation of the paper's scenario, to the last release and its spin metrics.
#![allow(missing_docs, reason = "criterion's macros make public items")]
#![allow(clippy::unwrap_used, reason = "a bench that cannot go on fails")]

use criterion::{Criterion, criterion_group, criterion_main};
use gyradius_inertia::InertiaMatrix;
use gyradius_separation::{Body, Separation, Settings, Spring};
use nalgebra::Vector3;
use std::hint::black_box;

/// Peck (2003), Table 1.
fn nominal() -> Separation {
    let payload = InertiaMatrix::from_entries([5e3, 4e3, 3e3], [20.0, 2.0, -50.0]).unwrap();
    let stage = InertiaMatrix::from_entries([6.7e3, 6.7e3, 2e3], [0.0, 20.0, -20.0]).unwrap();
    let spring = |k: f64, x: f64, y: f64| {
        Spring::new(k, 0.1, Vector3::new(x, y, -0.9), Vector3::new(x, y, 0.9)).unwrap()
    };
    Separation::new(
        Body::new(1e4, payload).unwrap().at(Vector3::z()),
        Body::new(4e3, stage).unwrap().at(-Vector3::z()),
        &[
            spring(1e5, 1.0, 1.0),
            spring(1e5, -1.0, 1.0),
            spring(3e4, 1.0, -1.0),
            spring(3e4, -1.0, -1.0),
        ],
    )
    .unwrap()
}

fn separation(c: &mut Criterion) {
    let separation = nominal();
    let settings = Settings::default();
    let mut group = c.benchmark_group("separation");
    group.bench_function("peck-2003", |b| {
        b.iter(|| {
            let outcome = black_box(&separation).run(&settings).unwrap();
            outcome.spin_metrics(&Vector3::x_axis())
        });
    });
    group.finish();
}

criterion_group!(benches, separation);
criterion_main!(benches);
