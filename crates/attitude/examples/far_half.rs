//! The radially constrained Gaussian of Peck (2003), Eq. 27 and 30, and its second lobe:
//! `cargo run --release -p gyradius-attitude --example far_half`.

use gyradius_attitude::{MeanHalf, RadiallyConstrainedGaussian};
use nalgebra::{Matrix4, Quaternion, UnitQuaternion, Vector4};
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use rand_distr::Distribution;

const DRAWS: usize = 1_000_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // nalgebra's constructor takes the scalar first; the covariance is in the order x₁ x₂ x₃ x₄.
    let mean = UnitQuaternion::from_quaternion(Quaternion::new(0.9996, 0.0249, 0.0005, -0.0100));
    let covariance = Matrix4::from_diagonal(&Vector4::new(2e-5, 6e-4, 6e-4, 0.6));
    let law = RadiallyConstrainedGaussian::new(mean, covariance)?;
    println!("sampler             {:?}, accepts {:.6}", law.method(), law.acceptance());
    println!("ln C                {:.12}", law.ln_normaliser());
    println!("E[x]                {:.6?}", law.mean_vector().as_slice());

    let mut rng = ChaCha8Rng::seed_from_u64(2003);
    let mut attitudes = vec![UnitQuaternion::identity(); DRAWS];
    law.sample_into(&mut rng, &mut attitudes);
    let far = attitudes.iter().filter(|q| !law.in_mean_half(q)).count();
    let share = far as f64 / DRAWS as f64;
    let error = (share * (1.0 - share) / DRAWS as f64).sqrt();
    println!("share of far half   {:.9}", law.far_half_share());
    println!("  of {DRAWS} draws  {share:.6} ± {error:.6}");

    // As attitudes, draws of the far half lie about the inverse of the mean.
    let turn = |q: UnitQuaternion<f64>| mean.angle_to(&q).to_degrees();
    let whole = (0..DRAWS).map(|_| turn(law.sample(&mut rng))).sum::<f64>() / DRAWS as f64;
    let half = MeanHalf::new(law);
    let near = (0..DRAWS).map(|_| turn(half.sample(&mut rng))).sum::<f64>() / DRAWS as f64;
    println!("mean angle to m     {whole:.4}°, of the near half alone {near:.4}°");
    Ok(())
}
