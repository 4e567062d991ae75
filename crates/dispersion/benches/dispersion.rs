//! Draws of the paper's payload by each law, one by one and in columns, the density of its entries, and their moments
//! by quadrature. For comparison: Basilisk's `InertiaTensorDispersion` takes 63 to 91 µs a draw.
#![allow(missing_docs, reason = "criterion's macros make public items")]
#![allow(clippy::unwrap_used, reason = "a bench that cannot be set up has to stop")]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use gyradius_attitude::{MeanHalf, RadiallyConstrainedGaussian, UniformAttitude};
use gyradius_dispersion::{
    AnyBody, BasiliskDispersion, CorrelatedRoots, DispersionModel, EntryMoments, EntrywiseGaussian,
    InertiaLaw, JacobianTwice, MassPropertiesLaw, ModelKind, PrincipalDispersion, ScalarLaw,
    ScalarRoots, TensorLaw,
};
use gyradius_inertia::{Inertia, InertiaMatrix, MassProperties, Region};
use nalgebra::{Matrix3, Matrix4, Vector3, Vector4};
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use rand_distr::Distribution;
use std::hint::black_box;

/// Peck (2003), Table 1 and Eq. 30.
fn payload() -> (InertiaMatrix, ScalarRoots, RadiallyConstrainedGaussian) {
    let matrix = InertiaMatrix::from_entries([5e3, 4e3, 3e3], [20.0, 2.0, -50.0]).unwrap();
    let nominal = Inertia::try_from(matrix).unwrap();
    let roots = ScalarRoots::normal(nominal.second_moments().roots(), [0.125, 0.1, 0.075]).unwrap();
    let covariance = Matrix4::from_diagonal(&Vector4::new(2e-5, 6e-4, 6e-4, 0.6));
    let attitude = nominal.principal_axes().attitude();
    (matrix, roots, RadiallyConstrainedGaussian::new(attitude, covariance).unwrap())
}

/// Draws of a batch.
const BATCH: usize = 1024;

fn inertia(c: &mut Criterion) {
    let (nominal, roots, axes) = payload();
    let twice = PrincipalDispersion::new(roots.clone(), JacobianTwice::new(axes.clone()).unwrap());
    let principal = PrincipalDispersion::new(roots, axes);
    let entrywise = EntrywiseGaussian::new(nominal, EntryMoments::of(&principal).deviations());
    let entrywise = entrywise.unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(1);

    let mut group = c.benchmark_group("inertia");
    group.throughput(Throughput::Elements(1));
    group.bench_function("principal", |b| {
        b.iter(|| -> Inertia { black_box(&principal).sample(&mut rng) });
    });
    group.bench_function("jacobian-twice", |b| {
        b.iter(|| -> Inertia { black_box(&twice).sample(&mut rng) });
    });
    group.bench_function("entrywise", |b| b.iter(|| black_box(&entrywise).sample(&mut rng)));
    group.bench_function("entry-moments", |b| b.iter(|| EntryMoments::of(black_box(&principal))));
    let moments = EntryMoments::of(&principal);
    for kind in ModelKind::ALL {
        let model = DispersionModel::matched(kind, &moments).unwrap().into_model();
        group.bench_function(format!("model/{kind}"), |b| {
            b.iter(|| -> InertiaMatrix { black_box(&model).sample(&mut rng) });
        });
    }
    group.throughput(Throughput::Elements(BATCH as u64));
    let mut columns: [Vec<f64>; 6] = std::array::from_fn(|_| vec![0.0; BATCH]);
    group.bench_function("principal/columns", |b| {
        b.iter(|| {
            let columns = columns.each_mut().map(Vec::as_mut_slice);
            black_box(&principal).sample_columns(&mut rng, columns)
        });
    });
    group.finish();
}

/// ln of the density of the six entries, at draws of the law.
fn density(c: &mut Criterion) {
    let (nominal, roots, axes) = payload();
    let nominal = Inertia::try_from(nominal).unwrap();
    let gaussian = Matrix3::from_diagonal(&Vector3::new(0.125, 0.1, 0.075));
    let joint = CorrelatedRoots::new(nominal.second_moments().roots(), gaussian).unwrap();
    let uniform = PrincipalDispersion::new(roots.clone(), UniformAttitude);
    let wide = ScalarRoots::normal(nominal.second_moments().roots(), [50.0; 3]).unwrap();
    let wide = PrincipalDispersion::new(wide, axes.clone());
    let half = PrincipalDispersion::new(roots.clone(), MeanHalf::new(axes.clone()));
    let principal = PrincipalDispersion::new(roots, axes.clone());
    let correlated = PrincipalDispersion::new(joint, axes);
    let moments = EntryMoments::of(&principal);
    let mut laws: Vec<(String, Box<dyn InertiaLaw>)> = vec![
        ("principal".into(), Box::new(principal)),
        ("principal/all-labels".into(), Box::new(wide)),
        ("principal/uniform-axes".into(), Box::new(uniform)),
        ("principal/mean-half".into(), Box::new(half)),
        ("principal/correlated-roots".into(), Box::new(correlated)),
        ("any-body".into(), Box::new(AnyBody::new(1e3, 1e5).unwrap())),
    ];
    for kind in ModelKind::ALL {
        let model = DispersionModel::matched(kind, &moments).unwrap().into_model();
        laws.push((format!("model/{kind}"), Box::new(model)));
    }
    let diagonal = InertiaMatrix::from_entries([5e3, 4e3, 3e3], [0.0; 3]).unwrap();
    let free = BasiliskDispersion::NO_BOUNDS;
    let basilisk = BasiliskDispersion::new(diagonal, 50.0, free, 0.05).unwrap();
    laws.push(("basilisk/diagonal".into(), Box::new(basilisk)));
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut group = c.benchmark_group("ln-density");
    group.throughput(Throughput::Elements(1));
    for (name, law) in laws {
        let draws: Vec<InertiaMatrix> = (0..BATCH).map(|_| law.draw(&mut rng).inertia).collect();
        let mut next = 0;
        group.bench_function(name, |b| {
            b.iter(|| {
                next = (next + 1) % BATCH;
                law.ln_density(black_box(&draws[next]))
            });
        });
    }
    group.finish();
}

/// Mass, mass centre and inertia together, one by one, in columns and in an ellipsoid.
fn mass_properties(c: &mut Criterion) {
    let (matrix, _, axes) = payload();
    let nominal = Inertia::try_from(matrix).unwrap();
    let lengths = nominal.second_moments().radii_of_gyration(1e4).unwrap().values();
    let normal = |mean: f64, sigma: f64| ScalarLaw::normal(mean, sigma).unwrap();
    let lengths = lengths.map(|rho| normal(rho, 0.01 * rho));
    let tensor = TensorLaw::gyration_lengths(lengths, axes);
    let centre = [0.0, 0.0, 0.0].map(|mean| normal(mean, 0.01));
    let law = MassPropertiesLaw::new(normal(1e4, 100.0), centre, tensor).unwrap();
    let inside = law.clone().inside(Region::ellipsoid([0.0; 3], [0.9, 1.2, 1.4]).unwrap()).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut group = c.benchmark_group("mass-properties");
    for (name, law) in [("joint", &law), ("joint-in-ellipsoid", &inside)] {
        group.throughput(Throughput::Elements(1));
        group.bench_function(name, |b| {
            b.iter(|| -> MassProperties { black_box(law).sample(&mut rng) });
        });
        let bodies: Vec<MassProperties> = (0..64).map(|_| law.sample(&mut rng)).collect();
        let mut next = bodies.iter().cycle();
        group.bench_function(format!("{name}/ln-density"), |b| {
            b.iter(|| black_box(law).ln_density(next.next().unwrap()));
        });
        group.throughput(Throughput::Elements(BATCH as u64));
        let mut columns: [Vec<f64>; 10] = std::array::from_fn(|_| vec![0.0; BATCH]);
        group.bench_function(format!("{name}/columns"), |b| {
            b.iter(|| {
                let columns = columns.each_mut().map(Vec::as_mut_slice);
                black_box(law).sample_columns(&mut rng, columns)
            });
        });
        let mut rows = vec![[0.0; 10]; BATCH];
        group.bench_function(format!("{name}/rows"), |b| {
            b.iter(|| black_box(law).sample_into(&mut rng, &mut rows));
        });
    }
    group.finish();
}

criterion_group!(benches, inertia, density, mass_properties);
criterion_main!(benches);
