//! What the words of a stream cost: few of many streams, and many of one.
#![allow(missing_docs, reason = "criterion's macros make public items")]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use gyradius_attitude::UniformAttitude;
use gyradius_campaign::{StreamRng, Streams};
use nalgebra::UnitQuaternion;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::hint::black_box;

/// Streams that are opened in an iteration.
const STREAMS: u64 = 1024;
/// The bytes of a slice that is filled.
const BYTES: usize = 16 << 10;
/// Attitudes of a batch.
const ATTITUDES: usize = 1024;

/// Opens a stream and takes one `u64`, as a normal number does, or eleven, as a body with mass and mass centre does.
fn open(c: &mut Criterion) {
    let streams = Streams::new(1, "bench", "open");
    let library = ChaCha8Rng::seed_from_u64(1);
    let mut group = c.benchmark_group("open");
    group.throughput(Throughput::Elements(STREAMS));
    for words in [1, 11] {
        let take = |rng: &mut dyn FnMut() -> u64| (0..words).fold(0, |sum, _| sum ^ rng());
        group.bench_function(format!("{words}/run"), |b| {
            b.iter(|| {
                for run in 0..STREAMS {
                    let mut rng = streams.run(run);
                    black_box(take(&mut || rng.next_u64()));
                }
            });
        });
        group.bench_function(format!("{words}/each"), |b| {
            b.iter(|| {
                Streams::each((0..STREAMS).map(|run| (&streams, run)), words, |rng| {
                    black_box(take(&mut || rng.next_u64()));
                });
            });
        });
        group.bench_function(format!("{words}/rand_chacha"), |b| {
            b.iter(|| {
                for run in 0..STREAMS {
                    let mut rng = black_box(&library).clone();
                    rng.set_stream(run);
                    black_box(take(&mut || rng.next_u64()));
                }
            });
        });
    }
    group.finish();
}

/// Many words of one stream: one by one, in a slice, and made into uniform attitudes.
fn long(c: &mut Criterion) {
    fn of<R: Rng + SeedableRng>(c: &mut Criterion, name: &str) {
        let mut rng = R::seed_from_u64(1);
        let mut group = c.benchmark_group("long");
        group.throughput(Throughput::Elements(STREAMS));
        group.bench_function(format!("u64/{name}"), |b| {
            b.iter(|| (0..STREAMS).fold(0, |sum, _| sum ^ rng.next_u64()));
        });
        group.throughput(Throughput::Bytes(BYTES as u64));
        let mut bytes = vec![0; BYTES];
        group.bench_function(format!("slice/{name}"), |b| {
            b.iter(|| rng.fill_bytes(black_box(&mut bytes)));
        });
        group.throughput(Throughput::Elements(ATTITUDES as u64));
        let mut attitudes = vec![UnitQuaternion::identity(); ATTITUDES];
        group.bench_function(format!("uniform attitudes/{name}"), |b| {
            b.iter(|| UniformAttitude.sample_into(&mut rng, black_box(&mut attitudes)));
        });
        group.finish();
    }
    of::<StreamRng>(c, "StreamRng");
    of::<ChaCha8Rng>(c, "rand_chacha");
}

criterion_group!(benches, open, long);
criterion_main!(benches);
