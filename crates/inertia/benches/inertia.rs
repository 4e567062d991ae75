//! Judging a matrix, its principal axes, and building an inertia; nalgebra's eigen solver beside.
#![allow(missing_docs, reason = "criterion's macros make public items")]
#![allow(clippy::unwrap_used, reason = "a bench that cannot be set up has to stop")]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use gyradius_inertia::{Inertia, InertiaMatrix, SecondMoments};
use nalgebra::UnitQuaternion;
use std::hint::black_box;

fn inertia(c: &mut Criterion) {
    // Peck (2003), Table 1: the payload.
    let payload = InertiaMatrix::from_entries([5e3, 4e3, 3e3], [20.0, 2.0, -50.0]).unwrap();
    let moments = SecondMoments::new([1e3, 2e3, 3e3]).unwrap();
    let attitude = UnitQuaternion::from_euler_angles(0.3, -0.2, 1.0);

    let mut group = c.benchmark_group("inertia");
    group.throughput(Throughput::Elements(1));
    group.bench_function("is_realizable", |b| b.iter(|| black_box(&payload).is_realizable()));
    group.bench_function("principal_axes", |b| b.iter(|| black_box(&payload).principal_axes()));
    group.bench_function("nalgebra-symmetric_eigen", |b| {
        b.iter(|| black_box(payload.matrix()).symmetric_eigen());
    });
    group.bench_function("from_second_moments", |b| {
        b.iter(|| Inertia::from_second_moments(black_box(moments), black_box(&attitude)));
    });
    group.finish();
}

criterion_group!(benches, inertia);
criterion_main!(benches);
