//! Tables of bodies of which many have the same numbers, in other units and another order.

use super::*;
use gyradius_inertia::Inertia;
use rand::RngExt;

/// Bodies in two digits, so that many numbers stand in several rows, and ratios of them are equal but for rounding: of roots next to one
/// another about wide axes, whose names are in doubt.
fn short_table(seed: u64) -> Vec<MassProperties> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let roots = [0.2, rng.random_range(0.2..0.24), rng.random_range(0.2..0.3)];
    let lengths = roots.map(|root| normal(root, 0.02));
    let axes = narrow([0; 3].map(|_| rng.random_range(-2.0..2.0)), rng.random_range(0.1..0.8));
    let tensor = TensorLaw::gyration_lengths(lengths, axes);
    let centre = CENTRE.map(|(mean, deviation)| normal(mean, deviation));
    let mass = normal(12.0, rng.random_range(0.1..1.0));
    let law = MassPropertiesLaw::new(mass, centre, tensor).unwrap();
    let count = rng.random_range(40..200);
    let mut bodies = Vec::new();
    while bodies.len() < count {
        let body = law.sample(&mut rng);
        let short = |x: f64| format!("{x:.1e}").parse::<f64>().unwrap();
        let matrix = body.inertia().matrix().map(short);
        if let Ok(inertia) = Inertia::new(matrix) {
            let centre = body.mass_centre_m().map(short);
            let mass = short(body.mass_kg());
            bodies.push(MassProperties::new(mass, centre, inertia).unwrap());
        }
    }
    bodies
}

/// The same bodies as they are read from a table in other units of mass and length, in another order.
fn in_units(bodies: &[MassProperties], mass: f64, length: f64, seed: u64) -> Vec<MassProperties> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let one = |body: &MassProperties| {
        let unit = mass * length * length;
        let inertia = Inertia::new(body.inertia().matrix().map(|x| x / unit * unit)).unwrap();
        let centre = body.mass_centre_m().map(|x| x / length * length);
        MassProperties::new(body.mass_kg() / mass * mass, centre, inertia).unwrap()
    };
    let mut others: Vec<MassProperties> = bodies.iter().map(one).collect();
    for last in (1..others.len()).rev() {
        others.swap(last, rng.random_range(0..=last));
    }
    others
}

#[test]
fn a_table_has_one_fit() {
    const TABLES: u64 = 60;
    let (mut others, mut doubtful) = (Vec::new(), 0);
    for seed in 0..TABLES {
        let bodies = short_table(seed);
        let told = |bodies: &[MassProperties]| {
            let fit = MassPropertiesFit::new(bodies, MassChoice::default()).unwrap();
            let roots = fit.lengths().roots().map(|root| [root.mean(), root.deviation()]);
            let axes = fit.lengths().axes().law().covariance();
            let axes = axes / axes.amax();
            let correlation = fit.law().correlation();
            let pairs = (0..SCALARS).flat_map(|i| (0..i).map(move |j| (i, j)));
            let pairs: Vec<f64> = pairs.map(|(i, j)| correlation.coefficient(i, j)).collect();
            let numbers = roots.into_iter().flatten().chain(axes.iter().copied()).chain(pairs);
            (numbers.collect::<Vec<f64>>(), fit.lengths().matching())
        };
        let one = told(&bodies);
        doubtful += one.1.doubtful;
        for (mass, length) in [(1.0, 1.0), (0.45359237, 0.0254), (14.593902937206364, 0.3048)] {
            let other = told(&in_units(&bodies, mass, length, seed));
            let is_same = one.0.len() == other.0.len()
                && one.0.iter().zip(&other.0).all(|(a, b)| (a - b).abs() < 1e-6)
                && one.1 == other.1;
            if !is_same {
                others.push((seed, mass));
            }
        }
    }
    assert!(doubtful > 400, "the test must have something to doubt: {doubtful}");
    assert!(others.is_empty(), "{others:?}");
}
