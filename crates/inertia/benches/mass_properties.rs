//! Assembling bodies, integrating a mesh, and the ten log-Cholesky coordinates.
#![allow(missing_docs, reason = "criterion's macros make public items")]
#![allow(clippy::unwrap_used, reason = "a bench that cannot be set up has to stop")]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use gyradius_inertia::{LogCholesky, MassProperties, Shape, TriangleMesh};
use nalgebra::{Isometry3, Vector3};
use std::hint::black_box;

fn bodies(c: &mut Criterion) {
    let part = Shape::solid_box([1.0, 2.0, 3.0]).unwrap().of_mass(12.0).unwrap();
    let parts: Vec<MassProperties> = (0..8)
        .map(|i| {
            let at = Vector3::new(f64::from(i), 1.0, -2.0);
            part.transformed(&Isometry3::new(at, at * 0.1)).unwrap()
        })
        .collect();
    let whole = MassProperties::combined(&parts).unwrap();
    let coordinates = LogCholesky::of(&whole).unwrap();

    let mut group = c.benchmark_group("mass-properties");
    group.throughput(Throughput::Elements(1));
    group.bench_function("combined-8", |b| b.iter(|| MassProperties::combined(black_box(&parts))));
    group.bench_function("without", |b| b.iter(|| black_box(&whole).without(&parts[0])));
    group.bench_function("log-cholesky-of", |b| b.iter(|| LogCholesky::of(black_box(&whole))));
    group.bench_function("log-cholesky-to", |b| {
        b.iter(|| black_box(&coordinates).mass_properties());
    });
    group.finish();
}

/// A torus of n × n quadrilaterals.
fn torus(n: usize) -> (Vec<[f64; 3]>, Vec<[usize; 3]>) {
    let angle = |i: usize| std::f64::consts::TAU * i as f64 / n as f64;
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..n {
        for j in 0..n {
            let r = 2.0 + angle(j).cos();
            vertices.push([r * angle(i).cos(), r * angle(i).sin(), angle(j).sin()]);
            let at = |i: usize, j: usize| i % n * n + j % n;
            triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    (vertices, triangles)
}

fn mesh(c: &mut Criterion) {
    let (vertices, triangles) = torus(224);
    let mut group = c.benchmark_group("mesh");
    group.throughput(Throughput::Elements(triangles.len() as u64));
    group.sample_size(20);
    group.bench_function("torus-100352", |b| {
        b.iter(|| TriangleMesh::new(black_box(&vertices), black_box(&triangles)).unwrap());
    });
    group.finish();
}

criterion_group!(benches, bodies, mesh);
criterion_main!(benches);
