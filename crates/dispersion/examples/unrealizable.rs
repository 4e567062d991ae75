//! How many draws belong to no body: six independent Gaussians against the principal dispersion
//! with the same six deviations, for a slender body.
//! `cargo run --release -p gyradius-dispersion --example unrealizable`

use gyradius_attitude::RadiallyConstrainedGaussian;
use gyradius_dispersion::{EntryMoments, EntrywiseGaussian, PrincipalDispersion, ScalarRoots};
use gyradius_inertia::{Inertia, InertiaMatrix};
use nalgebra::{Matrix4, UnitQuaternion};
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use rand_distr::Distribution;

const DRAWS: usize = 200_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let axes = UnitQuaternion::identity();
    let nominal = Inertia::from_principal_moments([2000.0, 15000.0, 15500.0], &axes)?;
    let roots = nominal.second_moments().roots();
    // Axes known to 1° about each: a vector part is half an angle.
    let tilt = 0.5 * 1.0_f64.to_radians();
    let tilts = RadiallyConstrainedGaussian::new(axes, Matrix4::identity() * (tilt * tilt))?;

    println!("deviation     deviations, kg·m²                               unrealizable, %");
    println!("of K, %     I11     I22     I33     I12     I13     I23   entrywise   principal");
    for percent in [1.0, 2.0, 5.0, 10.0] {
        // K = k²: a root spread by half as much.
        let variances = roots.values().map(|k| (0.5e-2 * percent * k).powi(2));
        let principal =
            PrincipalDispersion::new(ScalarRoots::normal(roots, variances)?, tilts.clone());
        let deviations = EntryMoments::of(&principal).deviations();
        let entrywise = EntrywiseGaussian::new(nominal, deviations)?;

        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let share = |draw: &mut dyn FnMut() -> InertiaMatrix| {
            let bad = (0..DRAWS).filter(|_| !draw().is_realizable()).count();
            100.0 * bad as f64 / DRAWS as f64
        };
        let six = share(&mut || entrywise.sample(&mut rng));
        let peck = share(&mut || Distribution::<Inertia>::sample(&principal, &mut rng).into());
        let row: String = deviations.iter().map(|d| format!("{d:8.1}")).collect();
        println!("{percent:5} {row}{six:12.2}{peck:12.2}");
    }
    Ok(())
}
