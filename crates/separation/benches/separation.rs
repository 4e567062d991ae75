//! Separations of the paper's scenario, to the last release and its spin metrics, alone and in a batch,
//! beside the same through the crate `differential-equations`.
#![allow(missing_docs, reason = "criterion's macros make public items")]
#![allow(clippy::unwrap_used, reason = "a bench that cannot go on fails")]

mod peer;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use gyradius_inertia::InertiaMatrix;
use gyradius_separation::{Batch, Body, MovingBody, Separation, Settings, Spring};
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
    let axis = Vector3::x_axis();
    let outcome = separation.run(&settings).unwrap();
    let rate = outcome.payload().state().angular_velocity;
    for tolerance in [1e-9, 1e-13] {
        let (theirs, time) = peer::separate(&separation, tolerance);
        println!(
            "differential-equations at {tolerance:e}: off by {:.1e} rad/s and {:.1e} s",
            (theirs - rate).norm(),
            (time - outcome.release_time()).abs()
        );
        assert!((theirs - rate).norm() < 1e-5);
    }

    let mut group = c.benchmark_group("separation");
    group.throughput(Throughput::Elements(1));
    group.bench_function("peck-2003", |b| {
        b.iter(|| black_box(&separation).run(&settings).unwrap().spin_metrics(&axis));
    });
    for tolerance in [1e-9, 1e-13] {
        group.bench_function(format!("differential-equations/{tolerance:e}"), |b| {
            b.iter(|| peer::separate(black_box(&separation), tolerance));
        });
    }
    // As many runs as a thread of a study takes at a time.
    const RUNS: usize = 256;
    group.throughput(Throughput::Elements(RUNS as u64));
    let mut batch = Batch::new(settings);
    group.bench_function(format!("peck-2003/batch of {RUNS}"), |b| {
        b.iter(|| {
            batch.run(std::iter::repeat_n(black_box(&separation), RUNS), |_, outcome| {
                black_box(outcome.unwrap().spin_metrics(&axis));
            });
        });
    });
    // Inertias up to 10 % apart, evenly: runs whose releases come at different steps.
    let apart: Vec<_> = (0..RUNS)
        .map(|i| {
            let share = |ratio: f64| 0.9 + 0.2 * (ratio * i as f64).fract();
            let scaled = |body: &Body, by: f64| InertiaMatrix::new(body.inertia().matrix() * by);
            let [payload, stage] = [separation.payload(), separation.stage()].map(MovingBody::body);
            let payload = scaled(payload, share(0.754_877_666_246_692_7)).unwrap();
            let stage = scaled(stage, share(0.569_840_290_998_053_2)).unwrap();
            separation.with_inertias(payload, stage).unwrap()
        })
        .collect();
    group.bench_function(format!("peck-2003/batch of {RUNS}, apart"), |b| {
        b.iter(|| {
            batch.run(black_box(&apart), |_, outcome| {
                black_box(outcome.unwrap().spin_metrics(&axis));
            });
        });
    });
    group.finish();
}

criterion_group!(benches, separation);
criterion_main!(benches);
