//! Laws of the principal axes, and the moments of inertia entries under them.

mod fixed;
mod half_sphere;
mod jacobian_twice;
mod law;
mod moments;

pub use fixed::FixedAttitude;
pub use jacobian_twice::{JacobianTwice, JacobianTwiceError};
pub use law::AxesLaw;
pub use moments::AttitudeMoments;
