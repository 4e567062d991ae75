//! Rigid-body inertia that cannot be unphysical.
//!
//! Two types carry the difference that matters. An [`InertiaMatrix`] is finite and symmetric and
//! may still belong to no body at all; an [`Inertia`] is *realizable*: some distribution of
//! non-negative mass has it. Between them stands one question, asked in one place: are the second
//! mass moments K_k = ∫ x_k² dm, the eigenvalues of Σ = ½ tr(I)·1 − I, all non-negative
//! (Peck 2003, Eq. 7-9)?
//!
//! [`MassProperties`] add the mass and the mass centre, and with them addition, removal and motion of
//! bodies; [`Shape`] and [`TriangleMesh`] are where they come from, [`PseudoInertia`] and
//! [`LogCholesky`] other coordinates of them.
//!
//! # Conventions
//! * Inertia is about the mass centre, in body axes, in kg·m².
//! * Products of inertia are tensor entries, I₁₂ = −∫ x₁x₂ dm (Peck 2003, Eq. 4). Some CAD and
//!   URDF-adjacent tools flip that sign: convert before you construct.
//! * An attitude q takes body components to principal components: I_B = R(q)ᵀ I_P R(q).
//!
//! ```
//! use gyradius_inertia::{Inertia, InertiaMatrix};
//!
//! let payload = InertiaMatrix::from_entries([5000.0, 4000.0, 3000.0], [20.0, 2.0, -50.0])?;
//! let payload = Inertia::try_from(payload)?;
//! let axes = payload.principal_axes();
//! assert!((axes.moments()[0] - 5000.400340853638).abs() < 1e-9);
//!
//! // Triangle inequality: the sum of any two moments is at least the third.
//! let impossible = InertiaMatrix::from_entries([5000.0, 1000.0, 3000.0], [0.0; 3])?;
//! assert!(!impossible.is_realizable());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod array_form;
mod assembly;
mod double;
mod eigen;
mod equivalents;
mod inertia;
mod log_cholesky;
mod mass_properties;
mod matrix;
mod mesh;
mod polyhedron;
mod principal;
mod pseudo_inertia;
#[cfg(feature = "serde")]
mod read;
mod region;
mod repair;
mod report;
mod second_moment_matrix;
mod second_moments;
mod shapes;

pub use equivalents::EquivalentSolid;
pub use inertia::{Inertia, RealizabilityError};
pub use log_cholesky::{LogCholesky, LogCholeskyError};
pub use mass_properties::{MAX_LENGTH, MassProperties, MassPropertiesError};
pub use matrix::{InertiaMatrix, InertiaMatrixError};
pub use mesh::{MeshError, TriangleMesh};
pub use principal::PrincipalAxes;
pub use pseudo_inertia::{PseudoInertia, PseudoInertiaError};
pub use region::{Containment, Region, RegionError};
pub use repair::{Repair, RepairMethod};
pub use report::{Axes, Fault, RealizabilityReport};
pub use second_moments::{
    MAX_SECOND_MOMENT, RadiiOfGyration, RootSecondMoments, SecondMoments, SecondMomentsError,
};
pub use shapes::{Measure, Shape, ShapeError};

/// Relative tolerance of every comparison in this crate: 64 units in the last place of 1.
///
/// Rotating a matrix into another frame costs a few units in the last place of its largest entry;
/// sixty-four leave room for a short chain of such operations, and none for a modelling error.
/// Always a share of the trace or the largest entry of the matrix, so that neither units nor
/// scale matter.
pub const RELATIVE_TOLERANCE: f64 = 64.0 * f64::EPSILON;

/// Largest magnitude of an entry, so that no sum, rotation or trace of entries overflows.
pub const MAX_ENTRY: f64 = f64::MAX / 64.0;

// Part of the interface, in the version that it takes and gives.
pub use nalgebra;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
