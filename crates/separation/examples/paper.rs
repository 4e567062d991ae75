//! The nominal separation of Peck (2003), Table 1: `cargo run --release --example paper`.

use gyradius_inertia::InertiaMatrix;
use gyradius_separation::{Body, Separation, Settings, Spring};
use nalgebra::Vector3;

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
    let outcome = separation.run(&Settings::default())?;
    let metrics = outcome.spin_metrics(&Vector3::x_axis());
    let degrees = |angle: Option<f64>| angle.map_or(f64::NAN, f64::to_degrees);

    println!("springs let go at   {:.6?} s", outcome.release_times().flatten().collect::<Vec<_>>());
    println!("relative speed      {:.6} m/s", outcome.relative_speed());
    println!("spin rate           {:.4} °/s", metrics.spin_rate().to_degrees());
    println!("wobble              {:.4}°", metrics.wobble().to_degrees());
    println!("nutation            {:.4}°", degrees(metrics.nutation()));
    println!("cone                {:.4}°", degrees(metrics.cone()));
    println!("inertia ratio       {:.4}", metrics.inertia_ratio().unwrap_or(f64::NAN));
    println!("{} steps", outcome.steps());
    Ok(())
}
