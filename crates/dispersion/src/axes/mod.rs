//! Laws of the principal axes, and the moments of inertia entries under them.

mod fixed;
mod half_sphere;
mod jacobian_twice;
mod law;
mod moments;
mod weighted_half;
mod whole_sphere;

use gyradius_attitude::UniformAttitude;
use std::f64::consts::LN_2;

pub use fixed::FixedAttitude;
#[cfg(feature = "serde")]
pub(crate) use fixed::unit;
pub use jacobian_twice::{JacobianTwice, JacobianTwiceError};
pub use law::AxesLaw;
pub use moments::AttitudeMoments;

/// ln π², the surface of the half of S³ that has every attitude once.
const LN_PI_SQUARED: f64 = -UniformAttitude::LN_DENSITY - LN_2;
