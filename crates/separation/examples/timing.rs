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
    let mut best = f64::INFINITY;
    for _ in 0..200 {
        let t = std::time::Instant::now();
        for _ in 0..50 {
            let o = std::hint::black_box(&separation).run(&Settings::default())?;
            std::hint::black_box(o.spin_metrics(&Vector3::x_axis()));
        }
        best = best.min(t.elapsed().as_secs_f64() / 50.0);
    }
    let mut batch = gyradius_separation::Batch::new(Settings::default());
    let mut bb = f64::INFINITY;
    for _ in 0..200 {
        let t = std::time::Instant::now();
        batch.run(std::iter::repeat_n(&separation, 50), |_, o| {
            std::hint::black_box(o.unwrap().spin_metrics(&Vector3::x_axis()));
        });
        bb = bb.min(t.elapsed().as_secs_f64() / 50.0);
    }
    println!("batch {:.2} us", bb * 1e6);
    println!("{:.2} us, {} steps", best * 1e6, separation.run(&Settings::default())?.steps());
    Ok(())
}
