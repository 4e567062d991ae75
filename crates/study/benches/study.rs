//! What a study costs beside its simulations: the built-in study of 10,000 runs a model, from the scenario to the
//! report on the disk, on one thread and on two, and as many runs of the nominal bodies in a batch alone.
#![allow(missing_docs, reason = "criterion's macros make public items")]
#![allow(clippy::unwrap_used, reason = "a bench that cannot go on fails")]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use gyradius_separation::Batch;
use gyradius_study::{Options, Scenario, Study};
use std::{hint::black_box, time::Duration};

const RUNS: u64 = 10_000;

fn study(c: &mut Criterion) {
    let scenario = Scenario::peck_2003().unwrap().with_runs(RUNS).unwrap();
    let models = scenario.model_names().count() as u64;
    let mut group = c.benchmark_group("study");
    group.throughput(Throughput::Elements(RUNS * models));
    group.sample_size(10).measurement_time(Duration::from_secs(15));
    let mut batch = Batch::new(*scenario.settings());
    group.bench_function("simulations alone", |b| {
        b.iter(|| {
            let queue = std::iter::repeat_n(scenario.separation(), (RUNS * models) as usize);
            batch.run(queue, |_, outcome| {
                black_box(outcome.unwrap().spin_metrics(scenario.spin_axis()));
            });
        });
    });
    for threads in [1, 2] {
        group.bench_function(format!("peck-2003/{threads} threads"), |b| {
            b.iter(|| {
                let scratch = tempfile::tempdir().unwrap();
                let out = Some(scratch.path().join("study"));
                let options = Options { out, threads: Some(threads), ..Options::default() };
                Study::run(black_box(&scenario), &options, &|_| {}).unwrap()
            });
        });
    }
    group.finish();
}

criterion_group!(benches, study);
criterion_main!(benches);
