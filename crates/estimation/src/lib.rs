//! The law of an uncertain rigid-body inertia, from samples of it or from plain statements.
//!
//! * [`PrincipalFit`] takes samples of an inertia matrix, for example of CAD variants or of a product line. It
//!   matches their principal axes, fits the model of Peck (2003) by maximum likelihood, with standard
//!   errors, and [assesses](PrincipalFit::assess) whether the samples look like draws of that model.
//! * [`Statements`] are what engineers know before there are samples, such as "moments ±10 % (1σ)" or "axes
//!   within 2°". They make a [`StatedModel`], which warns when statements contradict each other, or when
//!   no physical body can satisfy them.
//!
//! Both give a [`PrincipalDispersion`](gyradius_dispersion::PrincipalDispersion), whose draws are bodies that
//! could be built.
//!
//! ```
//! use gyradius_estimation::{Amount, AxesStatement, MomentsStatement, PrincipalFit, Statements};
//! use gyradius_inertia::{Inertia, InertiaMatrix};
//! use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
//! use rand_distr::Distribution;
//!
//! let matrix = InertiaMatrix::from_entries([900.0, 1000.0, 1100.0], [0.0; 3])?;
//! let statements = Statements {
//!     moments: Some(MomentsStatement::new(Amount::Percent([2.0; 3]), 1.0)?),
//!     axes: Some(AxesStatement::each([3.0; 3], 1.0)?),
//!     ..Statements::default()
//! };
//! let model = statements.model(&Inertia::try_from(matrix)?, None)?;
//! let [i11, ..] = model.implied().deviations();
//! assert!((i11 / 18.0 - 1.0).abs() < 0.01);
//!
//! let mut rng = ChaCha8Rng::seed_from_u64(1);
//! let samples: Vec<Inertia> = (0..300).map(|_| model.law().sample(&mut rng)).collect();
//! let fit = PrincipalFit::new(&samples)?;
//! let rotation = fit.axes().turn_covariance()[(0, 0)].sqrt().to_degrees();
//! assert!((rotation - 3.0).abs() < 0.5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod assessment;
mod estimated;
mod fit;
mod mass_fit;
#[cfg(feature = "serde")]
mod read;
mod rollup;
mod short;
mod stated_body;
mod statements;
mod turns;

pub use assessment::{Goodness, Test};
pub use estimated::{
    EstimateDistance, EstimatedBody, EstimatedBodyError, TenEstimate, TenEstimateError, TenForm,
};
pub use fit::{
    Aspect, Assessment, AxesFinding, AxesFit, FitNote, FitTest, Matching, PrincipalFit,
    PrincipalFitError, RootEstimate, RootFit,
};
pub use mass_fit::{
    MassAspect, MassAssessment, MassChoice, MassPropertiesFit, MassPropertiesFitError, MassTest,
    MassTies, ScalarEstimate, ScalarFit, Tie,
};
pub use rollup::{
    Assembly, AssemblyError, AssemblyPart, AssemblyRow, FirstOrder, PartError, PartFinding,
    PartStatement, TEN_UNITS,
};
pub use stated_body::StatedBody;
pub use statements::{
    Amount, AmountProblem, AxesStatement, CentreStatement, MassStatement, MissedBecause,
    MomentsStatement, Part, ProductsStatement, StatedAmount, StatedAmountError, StatedMass,
    StatedModel, StatementError, StatementWarning, Statements,
};

// Part of the interface, in the version that it takes and gives.
pub use {nalgebra, rand, rand_distr};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
