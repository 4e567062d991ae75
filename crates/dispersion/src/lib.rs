//! Random rigid-body inertia: the mass properties of a body that nobody has weighed yet.
//!
//! * [`PrincipalDispersion`]: second mass moments from the square of any law of their roots, axes
//!   from any law of attitudes (Peck 2003). Every draw is an [`Inertia`], a body that could be
//!   built, whatever the variances.
//! * [`EntrywiseGaussian`], [`CorrelatedEntries`]: six Gaussian entries, the common practice; draws are
//!   [`InertiaMatrix`]es, some of which no body has. [`RealizableOnly`] rejects those.
//! * [`LogCholeskyGaussian`], [`Wishart`]: Gaussian in unconstrained coordinates, and maximum entropy;
//!   every draw is an [`Inertia`].
//! * [`BasiliskDispersion`]: what a well-known simulator does.
//! * [`AnyBody`]: every shape, size and attitude, for property tests and domain randomisation.
//! * [`MassPropertiesLaw`]: mass, mass centre and inertia together, and its rivals [`LogCholeskyTen`], [`MaximumEntropy`],
//!   [`PseudoInertiaWishart`] and [`NaiveBody`]; all are [`MassPropertiesModel`]s.
//!
//! The others are [`Distribution`](rand_distr::Distribution)s and [`InertiaLaw`]s, as a law of your own can be;
//! [`DispersionModel`] is any of them, chosen at run time and matched to the moments of another. [`EntryMoments`] are the mean and covariance of the
//! six entries by quadrature or in closed form, not by sampling.
//! [`sample_columns`](PrincipalDispersion::sample_columns) draws in bulk.
//!
//! ```
//! use gyradius_attitude::RadiallyConstrainedGaussian;
//! use gyradius_dispersion::{ScalarRoots, PrincipalDispersion};
//! use gyradius_inertia::Inertia;
//! use nalgebra::{Matrix3, Matrix4, Vector4};
//! use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
//! use rand_distr::Distribution;
//!
//! let nominal = Inertia::new(Matrix3::new(
//!     5000.0, 20.0, 2.0, //
//!     20.0, 4000.0, -50.0, //
//!     2.0, -50.0, 3000.0,
//! ))?;
//! let axes = nominal.principal_axes();
//! let covariance = Matrix4::from_diagonal(&Vector4::new(2e-5, 6e-4, 6e-4, 0.6));
//! let law = PrincipalDispersion::new(
//!     ScalarRoots::normal(nominal.second_moments().roots(), [0.125, 0.1, 0.075])?,
//!     RadiallyConstrainedGaussian::new(axes.attitude(), covariance)?,
//! );
//! let body: Inertia = law.sample(&mut ChaCha8Rng::seed_from_u64(2003));
//! assert!(body.as_inertia_matrix().is_realizable());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`Inertia`]: gyradius_inertia::Inertia
//! [`InertiaMatrix`]: gyradius_inertia::InertiaMatrix

mod any_body;
mod any_of;
mod axes;
mod basilisk;
mod batch;
mod columns;
mod correlated_entries;
mod correlation;
#[cfg(test)]
mod density_checks;
mod density_of_entries;
mod entry_moments;
mod entrywise;
mod gauss_legendre;
mod gaussian_monomials;
mod incomplete_beta;
mod inertia_law;
mod known_moments;
mod ln_sum;
mod log_cholesky;
mod mass_properties;
mod matched;
mod matched_principal;
mod model;
mod model_parameters;
mod named_model;
mod normal;
#[cfg(test)]
mod pinned_values;
mod principal;
mod quartic;
mod realizable_only;
mod root_moments;
mod roots;
mod scalar;
mod scaled;
mod second_moment_matrix;
mod semidefinite;
mod truncated_draw;
mod truncated_normal;
mod wishart;
mod written;

pub use any_body::{AnyBody, AnyBodyError};
pub use axes::{AttitudeMoments, AxesLaw, FixedAttitude, JacobianTwice, JacobianTwiceError};
pub use basilisk::{BasiliskDispersion, BasiliskError};
pub use batch::{BatchAttitudes, BatchRoots};
pub use columns::ColumnsError;
pub use correlated_entries::CorrelatedEntries;
pub use correlation::{Correlation, CorrelationError, CorrelationProblem};
pub use entry_moments::{EntryMoments, EntryMomentsError};
pub use entrywise::{EntrywiseError, EntrywiseGaussian};
pub use inertia_law::{InertiaLaw, ModelDraw};
pub use known_moments::KnownMoments;
pub use log_cholesky::{LogCholeskyGaussian, LogCholeskyGaussianError};
pub use mass_properties::{
    JointScalar, LogCholeskyTen, LogCholeskyTenError, MassPropertiesLaw, MassPropertiesLawError,
    MassPropertiesModel, MaximumEntropy, MaximumEntropyError, NaiveBody, NaiveBodyError, NaiveRule,
    PseudoInertiaWishart, PseudoInertiaWishartError, RegionAcceptanceError, TenMoments,
    TenParameters, TenSpread, TenSums, TensorLaw, TensorLawError, TensorParts, following_factor,
};
pub use matched::{MatchError, Matched};
pub use model::{DispersionModel, ModelKind, UnknownModel};
pub use model_parameters::{ModelParameterError, ModelParameters};
pub use principal::{PrincipalDispersion, PrincipalDraw};
pub use realizable_only::{RealizableOnly, RealizableOnlyError};
pub use root_moments::{
    RootMoments, SecondMomentStatistics, SecondMomentStatisticsError, WithMoments,
};
pub use roots::{
    CorrelatedRoots, CorrelatedRootsError, EmpiricalRoots, EmpiricalRootsError, IndependentRoots,
    IndependentRootsError, RootLaw, ScalarRoots, ScalarRootsError,
};
pub use scalar::{LawUnit, ScalarLaw, ScalarLawError, ScalarLawForm, ScalarLawFormError};
pub use semidefinite::CovarianceError;
pub use wishart::{Wishart, WishartError};

// Part of the interface, in the version that it takes and gives.
pub use {nalgebra, rand, rand_distr};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
