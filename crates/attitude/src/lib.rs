//! Probability laws on attitudes, as unit quaternions on the sphere S³.
//!
//! * [`UniformAttitude`]: every attitude equally likely (Haar measure); [`MarsagliaUniform`],
//!   [`ShoemakeUniform`] and [`BoxUniform`] draw it in other ways, [`super_fibonacci`] is an even grid.
//! * [`RadiallyConstrainedGaussian`] (RCG): a Gaussian in ℝ⁴ conditioned on unit length (Nicewarner
//!   & Sanderson 1994; Peck 2003, Eq. 20-26), the Fisher-Bingham law on S³ with a mean attitude.
//! * [`MeanHalf`]: the same, kept to the half sphere around its mean.
//! * [`FisherBingham`]: the general member of that family, density ∝ exp(−½ xᵀPx + bᵀx).
//!
//! Draws are exact and independent (no Markov chain), for any covariance; the normaliser and the
//! moments are computed to machine precision by a contour integral, and for checking by
//! quadrature over the angles ([`AngularQuadrature`]).
//!
//! # Conventions
//! Quaternions are Hamilton's, written scalar last, x = (x₁, x₂, x₃, x₄), which is the order of
//! `nalgebra`'s coordinates. Densities are with respect to surface measure on S³ (total 2π²)
//! unless another measure is named. q and −q are the same attitude: a law on S³ need not treat
//! them alike, the density of an *attitude* adds both.
//!
//! ```
//! use gyradius_attitude::RadiallyConstrainedGaussian;
//! use nalgebra::{Matrix4, Quaternion, UnitQuaternion, Vector4};
//! use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
//! use rand_distr::Distribution;
//!
//! // The example of Peck (2003), Eq. 27.
//! let mean = UnitQuaternion::from_quaternion(Quaternion::new(0.9996, 0.0249, 0.0005, -0.0100));
//! let covariance = Matrix4::from_diagonal(&Vector4::new(2e-5, 6e-4, 6e-4, 0.6));
//! let law = RadiallyConstrainedGaussian::new(mean, covariance)?;
//!
//! let mut rng = ChaCha8Rng::seed_from_u64(2003);
//! let q = law.sample(&mut rng);
//! assert!(law.ln_density(&q).is_finite());
//! assert!(law.acceptance() > 0.999);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod about_axis;
mod cells;
mod central_moments;
mod chart;
mod contour;
mod far_half;
mod fisher_bingham;
mod fit;
mod hyperspherical;
mod jacobi;
mod mean_half;
mod quadrature;
mod rcg;
#[cfg(feature = "serde")]
mod read;
mod uniform;
mod vector;
mod ways_in;

pub use about_axis::AboutAxis;
pub use central_moments::CentralMoments;
pub use fisher_bingham::{FisherBingham, FisherBinghamError, Method};
pub use fit::{Convergence, Family, Fit, FitError, NoIntervals, RadialVariance};
pub use hyperspherical::{HypersphericalAngles, HypersphericalError};
pub use mean_half::MeanHalf;
pub use quadrature::AngularQuadrature;
pub use rcg::{RadiallyConstrainedGaussian, RcgError};
pub use uniform::{
    BoxUniform, MarsagliaUniform, ShoemakeUniform, UniformAttitude, super_fibonacci,
};

// Part of the interface, in the version that it takes and gives.
pub use {nalgebra, rand, rand_distr};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
