//! What a separation cannot change, over bodies drawn from the paper's law.

use gyradius_dispersion::PrincipalDispersion;
use gyradius_inertia::Inertia;
use gyradius_separation::{MovingBody, Settings};
use gyradius_tests::{PaperBody, paper_separation};
use nalgebra::Vector3;
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use rand_distr::Distribution;

#[test]
fn momentum_angular_momentum_and_energy() {
    let (payload, stage) = (PaperBody::payload(), PaperBody::stage());
    let payload = PrincipalDispersion::new(payload.roots, payload.axes);
    let stage = PrincipalDispersion::new(stage.roots, stage.axes);
    let nominal = paper_separation();
    assert!((nominal.stored_energy() - 1300.0).abs() < 1e-9);

    let mut rng = ChaCha8Rng::seed_from_u64(1300);
    for run in 0..500 {
        let (p, s): (Inertia, Inertia) = (payload.sample(&mut rng), stage.sample(&mut rng));
        let separation = nominal.with_inertias(p, s).unwrap();
        let outcome = separation.run(&Settings::default()).unwrap();
        let both = [outcome.payload(), outcome.stage()];

        // Nothing moves at the start: what the two bodies have, they have from each other.
        let cancels = |of: fn(&MovingBody) -> Vector3<f64>| {
            let [a, b] = both.map(of);
            (a + b).norm() / a.norm()
        };
        assert!(cancels(MovingBody::momentum) < 1e-10, "run {run}");
        assert!(cancels(MovingBody::angular_momentum) < 1e-10, "run {run}");
        let energy: f64 = both.iter().map(|b| b.kinetic_energy()).sum();
        assert!((energy / 1300.0 - 1.0).abs() < 1e-10, "run {run}: {energy} J");
    }
}
