//! Random mass, mass centre and inertia together: the ten parameters of a body that nobody has weighed yet.

mod density;
#[cfg(test)]
mod density_tests;
mod law;
mod model;
mod moments;
mod scores;
mod ten_moments;
mod ten_parameters;
mod tensor;
#[cfg(test)]
mod tests;

pub use law::{JointScalar, MassPropertiesLaw, MassPropertiesLawError};
pub use model::MassPropertiesModel;
pub use ten_moments::TenMoments;
pub use ten_parameters::TenParameters;
pub use tensor::{TensorLaw, TensorLawError};
