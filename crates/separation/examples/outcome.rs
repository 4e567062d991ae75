//! The outcome of the paper's separation with all digits, and what a run takes: for
//! `scripts/scipy_dop853.py`, which solves the same.

use gyradius_inertia::InertiaMatrix;
use gyradius_separation::{Body, Separation, Settings, Spring};
use nalgebra::Vector3;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let payload = InertiaMatrix::from_entries([5e3, 4e3, 3e3], [20.0, 2.0, -50.0])?;
    let stage = InertiaMatrix::from_entries([6.7e3, 6.7e3, 2e3], [0.0, 20.0, -20.0])?;
    let spring = |stiffness, x, y| {
        Spring::new(stiffness, 0.1, Vector3::new(x, y, -0.9), Vector3::new(x, y, 0.9))
    };
    let separation = Separation::new(
        Body::new(1e4, payload)?.at(Vector3::z()),
        Body::new(4e3, stage)?.at(-Vector3::z()),
        &[
            spring(1e5, 1.0, 1.0)?,
            spring(1e5, -1.0, 1.0)?,
            spring(3e4, 1.0, -1.0)?,
            spring(3e4, -1.0, -1.0)?,
        ],
    )?;
    let settings = Settings::default();
    let outcome = separation.run(&settings)?;
    let list = |x: &[f64]| {
        let numbers: Vec<_> = x.iter().map(|x| format!("{x:e}")).collect();
        format!("[{}]", numbers.join(", "))
    };
    let times: Vec<_> = outcome.release_times().flatten().collect();
    let (p, l) = (outcome.payload().state(), outcome.stage().state());
    let mut best = f64::INFINITY;
    for _ in 0..2000 {
        let start = Instant::now();
        std::hint::black_box(std::hint::black_box(&separation).run(&settings)?);
        best = best.min(start.elapsed().as_secs_f64());
    }
    println!("{{");
    println!("  \"release_times_s\": {},", list(&times));
    println!("  \"relative_velocity\": {},", list(outcome.relative_velocity().as_slice()));
    println!("  \"payload_rate\": {},", list(p.angular_velocity.as_slice()));
    println!("  \"stage_rate\": {},", list(l.angular_velocity.as_slice()));
    println!("  \"payload_attitude\": {},", list(p.attitude.coords.as_slice()));
    println!("  \"stage_attitude\": {},", list(l.attitude.coords.as_slice()));
    println!("  \"seconds\": {best:e}");
    println!("}}");
    Ok(())
}
