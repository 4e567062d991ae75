//! Random mass, mass centre and inertia together: the ten parameters of a body that nobody has weighed yet.

mod batch;
mod density;
#[cfg(test)]
mod density_tests;
mod inside;
mod law;
mod log_cholesky_ten;
mod lognormal;
mod maximum_entropy;
mod model;
mod moments;
mod naive;
mod pseudo_inertia_wishart;
#[cfg(test)]
mod rival_tests;
mod scores;
mod steps;
mod ten_moments;
mod ten_parameters;
mod ten_sums;
mod tensor;
#[cfg(test)]
mod tests;

pub use inside::RegionAcceptanceError;
pub use law::{JointScalar, MassPropertiesLaw, MassPropertiesLawError};
pub use log_cholesky_ten::{LogCholeskyTen, LogCholeskyTenError};
pub use maximum_entropy::{MaximumEntropy, MaximumEntropyError};
pub use model::MassPropertiesModel;
pub use naive::{NaiveBody, NaiveBodyError, NaiveRule};
pub use pseudo_inertia_wishart::{PseudoInertiaWishart, PseudoInertiaWishartError};
pub use ten_moments::TenMoments;
pub use ten_parameters::TenParameters;
pub use ten_sums::{TenSpread, TenSums};
pub use tensor::{TensorLaw, TensorLawError, TensorParts, following_factor};
