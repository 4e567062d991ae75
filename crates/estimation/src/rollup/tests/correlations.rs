//! Correlations of the entries of a part in the draws.

use super::*;
use gyradius_attitude::UniformAttitude;
use rand::RngExt;

/// Solids with deviations of up to half of the moments: the draws have the correlation that is told, and none of more than
/// 0.2 that is not. A law of independent entries is taken where one comes near.
#[test]
fn correlations_of_the_draws_are_told() {
    let n = 20_000_u64;
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    let mut told = 0;
    for _ in 0..24 {
        let k = [0; 3].map(|_| rng.random_range(1.0..4.0));
        let attitude = UniformAttitude.sample(&mut rng);
        let mut stated = statement([9.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0], [0.0; 10]);
        stated.inertia = inertia(k, &attitude);
        let share = rng.random_range(0.01..0.5);
        let size = stated.inertia.entries()[0] * share;
        for e in 4..10 {
            stated.deviations[e] = size * rng.random_range(0.3..1.0);
        }
        let part = AssemblyPart::new(stated).unwrap();
        let (_, covariance) = sampled(&draws(&flat(std::slice::from_ref(&part)), n));
        let correlation = |e: usize, f: usize| {
            covariance[(e, f)] / (covariance[(e, e)] * covariance[(f, f)]).sqrt()
        };
        let pairs = (4..10).flat_map(|e| (4..e).map(move |f| (f, e)));
        let strongest = pairs.map(|(e, f)| correlation(e, f).abs()).fold(0.0, f64::max);
        let found = part.findings().iter().find_map(|finding| match finding {
            PartFinding::Correlated { entries, correlation } => Some((*entries, *correlation)),
            _ => None,
        });
        match found {
            None => assert!(strongest < 0.25, "{share}: {strongest}"),
            Some((entries, told_correlation)) => {
                told += 1;
                let [e, f] = entries.map(|name| {
                    4 + InertiaMatrix::ENTRY_NAMES.iter().position(|entry| *entry == name).unwrap()
                });
                assert!(
                    (correlation(e, f) - told_correlation).abs() < 0.05,
                    "{share}: {entries:?}"
                );
                assert!(strongest > 0.15, "{share}: {strongest}");
            }
        }
    }
    assert!((3..=21).contains(&told), "{told}");
}
