//! Laws of the roots k_k = √K_k of the second mass moments.

mod correlated;
mod empirical;
mod independent;
mod law;
mod scalar;

use crate::ln_sum::ln_product;

pub use correlated::{CorrelatedRoots, CorrelatedRootsError};
pub use empirical::{EmpiricalRoots, EmpiricalRootsError};
pub use independent::{IndependentRoots, IndependentRootsError};
pub use law::RootLaw;
pub use scalar::{ScalarRoots, ScalarRootsError};

/// Draws farther out than this many deviations have probability 1e-349.
pub(crate) const FAR: f64 = 40.0;

/// Draws stay below this, so that fourth powers, which variances of K are made of, do not overflow.
const MAX_ROOT: f64 = 1e75;

/// ln of what takes a density of roots of either sign to one of their squares, Π 1/(2√K), at the roots √K.
fn ln_of_squares(roots: [f64; 3]) -> f64 {
    const LN_8: f64 = 3.0 * std::f64::consts::LN_2;
    -LN_8 - ln_product(&roots)
}
