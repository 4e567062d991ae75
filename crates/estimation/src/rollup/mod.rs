//! Mass-properties rollup: the law of a whole from a tree of its parts, by first order and by drawing.
//!
//! Each [`AssemblyPart`] states mass, mass centre and inertia with ten standard deviations. [`Assembly`] is the tree;
//! [`FirstOrder`] is the ten numbers of a whole with their covariance to first order, and every `AssemblyPart` is a law of
//! [`MassProperties`](gyradius_inertia::MassProperties) to draw from.

mod correlation_law;
mod finding;
mod first_order;
mod free_correlations;
mod nearest_law;
mod part;
mod scaled_correlations;
mod second_moment_law;
pub(crate) mod symmetric;
#[cfg(test)]
mod tests;
mod tree;

pub use finding::PartFinding;
pub use first_order::{FirstOrder, TEN_UNITS};
pub use part::{AssemblyPart, PartError, PartStatement};
pub use tree::{Assembly, AssemblyError, AssemblyRow};
