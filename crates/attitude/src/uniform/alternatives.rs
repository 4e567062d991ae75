//! Other ways to draw the uniform law: two discs, and rejection from a box.

use nalgebra::{Quaternion, UnitQuaternion};
use rand::{Rng, RngExt};
use rand_distr::Distribution;
use std::f64::consts::TAU;

/// The uniform law by two discs.
///
/// # Algorithm
/// Two uniform points of the unit disc, the second stretched to what the first leaves of unit
/// length (Marsaglia 1972, doi:10.1214/aoms/1177692644). No elementary functions; uses a varying
/// number of uniforms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MarsagliaUniform;

/// The uniform law by two angles.
///
/// # Algorithm
/// Subgroup algorithm: the squared radius of a plane is uniform, and so are the angles in it and in
/// its complement (Shoemake, “Uniform random rotations”, *Graphics Gems III*, 1992). Uses exactly
/// three uniforms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ShoemakeUniform;

/// The uniform law by rejection in a box.
///
/// # Algorithm
/// Points of the cube [−1, 1]⁴, those outside the unit ball refused, the others divided by their
/// norm (Shuster 2001, AAS 01-124). Accepts π²/32, about 31 %, of its points; kept for comparison.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BoxUniform;

/// A uniform number in [−1, 1).
fn centred<R: Rng + ?Sized>(rng: &mut R) -> f64 {
    2.0 * rng.random::<f64>() - 1.0
}

fn quaternion(x: f64, y: f64, z: f64, w: f64) -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z))
}

impl Distribution<UnitQuaternion<f64>> for MarsagliaUniform {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> UnitQuaternion<f64> {
        let mut disc = || loop {
            let (x, y) = (centred(rng), centred(rng));
            let square = x * x + y * y;
            // The centre would be divided by.
            if square < 1.0 && square > 1e-30 {
                return (x, y, square);
            }
        };
        let (x, y, first) = disc();
        let (z, w, second) = disc();
        let stretch = ((1.0 - first) / second).sqrt();
        quaternion(x, y, z * stretch, w * stretch)
    }
}

impl Distribution<UnitQuaternion<f64>> for ShoemakeUniform {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> UnitQuaternion<f64> {
        let square: f64 = rng.random();
        let (sin_a, cos_a) = libm::sincos(TAU * rng.random::<f64>());
        let (sin_b, cos_b) = libm::sincos(TAU * rng.random::<f64>());
        let (a, b) = ((1.0 - square).sqrt(), square.sqrt());
        quaternion(a * sin_a, a * cos_a, b * sin_b, b * cos_b)
    }
}

impl Distribution<UnitQuaternion<f64>> for BoxUniform {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> UnitQuaternion<f64> {
        loop {
            let (x, y, z, w) = (centred(rng), centred(rng), centred(rng), centred(rng));
            let square = x * x + y * y + z * z + w * w;
            if square <= 1.0 && square > 1e-16 {
                let scale = 1.0 / square.sqrt();
                return quaternion(x * scale, y * scale, z * scale, w * scale);
            }
        }
    }
}
