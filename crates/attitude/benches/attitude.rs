//! Draws of attitudes, one at a time, and the construction of a law.
#![allow(missing_docs, reason = "criterion's macros make public items")]
#![allow(clippy::unwrap_used, reason = "a bench that cannot be set up has to stop")]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use gyradius_attitude::{Method, RadiallyConstrainedGaussian, UniformAttitude};
use nalgebra::{Matrix4, Quaternion, UnitQuaternion, Vector4};
use rand::{Rng, SeedableRng, rngs::Xoshiro256PlusPlus};
use rand_chacha::ChaCha8Rng;
use rand_distr::Distribution;
use std::hint::black_box;

/// Mean and variances, scalar last.
type Parameters = ([f64; 4], [f64; 4]);

/// Peck (2003), Eq. 27 and 30.
const PAPER: Parameters = ([0.0249, 0.0005, -0.0100, 0.9996], [2e-5, 6e-4, 6e-4, 0.6]);
const ISOTROPIC: Parameters = ([0.0, 0.0, 0.0, 1.0], [1.0; 4]);
/// Four scales, none of them along the mean: neither a chart nor uniform proposals serve it.
const FOUR_SCALES: Parameters = ([0.5, -0.5, 0.5, -0.5], [1e-6, 1e-4, 1e-2, 1.0]);
const DIFFUSE: Parameters = ([1.0, 2.0, 3.0, 4.0], [0.1, 0.2, 0.3, 0.4]);
/// One milliradian about every axis.
const NARROW: Parameters = ([0.0, 0.0, 0.0, 1.0], [2.5e-7, 2.5e-7, 2.5e-7, 1e-2]);

fn law((mean, variances): Parameters) -> RadiallyConstrainedGaussian {
    let mean = UnitQuaternion::from_quaternion(Quaternion::from(Vector4::from(mean)));
    RadiallyConstrainedGaussian::new(mean, Matrix4::from_diagonal(&variances.into())).unwrap()
}

/// As many attitudes as fit into a first-level cache.
const BATCH: usize = 1024;

fn batch_of_attitudes() -> Vec<UnitQuaternion<f64>> {
    vec![UnitQuaternion::identity(); BATCH]
}

fn uniform(c: &mut Criterion) {
    fn draw<R: Rng + SeedableRng>(b: &mut criterion::Bencher<'_>) {
        let mut rng = R::seed_from_u64(1);
        b.iter(|| UniformAttitude.sample(&mut rng));
    }
    fn batch<R: Rng + SeedableRng>(b: &mut criterion::Bencher<'_>) {
        let (mut rng, mut out) = (R::seed_from_u64(1), batch_of_attitudes());
        b.iter(|| UniformAttitude.sample_into(&mut rng, black_box(&mut out)));
    }
    let mut group = c.benchmark_group("uniform");
    group.throughput(Throughput::Elements(1));
    group.bench_function("chacha8", draw::<ChaCha8Rng>);
    group.bench_function("xoshiro256++", draw::<Xoshiro256PlusPlus>);
    group.throughput(Throughput::Elements(BATCH as u64));
    group.bench_function("batch/chacha8", batch::<ChaCha8Rng>);
    group.bench_function("batch/xoshiro256++", batch::<Xoshiro256PlusPlus>);
    group.finish();
}

fn rcg(c: &mut Criterion) {
    fn draw<R: Rng + SeedableRng>(
        b: &mut criterion::Bencher<'_>,
        law: &RadiallyConstrainedGaussian,
    ) {
        let mut rng = R::seed_from_u64(1);
        b.iter(|| black_box(law).sample(&mut rng));
    }
    fn batch<R: Rng + SeedableRng>(
        b: &mut criterion::Bencher<'_>,
        law: &RadiallyConstrainedGaussian,
    ) {
        let (mut rng, mut out) = (R::seed_from_u64(1), batch_of_attitudes());
        b.iter(|| law.sample_into(&mut rng, black_box(&mut out)));
    }
    let mut group = c.benchmark_group("rcg");
    for (name, parameters, method) in [
        ("peck-2003", PAPER, Method::Chart),
        ("isotropic", ISOTROPIC, Method::Cells),
        ("four-scales", FOUR_SCALES, Method::Cells),
    ] {
        let law = law(parameters);
        assert_eq!(law.method(), method, "{name}");
        group.throughput(Throughput::Elements(1));
        let id = |kind: &str| format!("{name}/{kind}");
        group.bench_with_input(id("chacha8"), &law, draw::<ChaCha8Rng>);
        group.bench_with_input(id("xoshiro256++"), &law, draw::<Xoshiro256PlusPlus>);
        if method == Method::Chart {
            group.throughput(Throughput::Elements(BATCH as u64));
            group.bench_with_input(id("batch/chacha8"), &law, batch::<ChaCha8Rng>);
            group.bench_with_input(id("batch/xoshiro256++"), &law, batch::<Xoshiro256PlusPlus>);
        }
    }
    group.finish();
}

/// Construction: the normaliser, the moments and the set-up of the sampler.
fn normaliser(c: &mut Criterion) {
    let mut group = c.benchmark_group("normaliser");
    group.throughput(Throughput::Elements(1));
    for (name, parameters) in [("peck-2003", PAPER), ("four-scales", FOUR_SCALES)] {
        group.bench_function(name, |b| b.iter(|| law(black_box(parameters)).ln_normaliser()));
        group.bench_function(format!("{name}/with-sampler"), |b| {
            b.iter(|| law(black_box(parameters)).acceptance());
        });
    }
    group.finish();
}

/// The same by quadrature over the angles, from a mild law to one with a single narrow coordinate.
fn quadrature(c: &mut Criterion) {
    let mut group = c.benchmark_group("quadrature");
    for (name, parameters) in [
        ("isotropic", ISOTROPIC),
        ("peck-2003", PAPER),
        ("four-scales", FOUR_SCALES),
        ("one-narrow", ([0.2, 0.4, 0.5, 0.7], [1e-8, 1.0, 1.0, 1.0])),
    ] {
        let law = law(parameters);
        group.bench_function(name, |b| b.iter(|| black_box(&law).by_quadrature().ln_normaliser()));
    }
    group.finish();
}

/// Maximum likelihood from 1,000 attitudes.
fn fit(c: &mut Criterion) {
    let mut group = c.benchmark_group("fit");
    group.throughput(Throughput::Elements(1000));
    group.sample_size(20);
    for (name, parameters) in [("peck-2003", PAPER), ("diffuse", DIFFUSE), ("narrow", NARROW)] {
        let law = law(parameters);
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let attitudes: Vec<_> = (0..1000).map(|_| law.sample(&mut rng)).collect();
        group.bench_function(name, |b| {
            b.iter(|| RadiallyConstrainedGaussian::fit(black_box(&attitudes)).unwrap());
        });
    }
    group.finish();
}

criterion_group!(benches, uniform, rcg, normaliser, quadrature, fit);
criterion_main!(benches);
