//! What is wrong with the stated deviations of a part, and how far its law had to move.

use gyradius_inertia::InertiaMatrix;
use std::fmt;

use crate::short::Short;

/// What a user should know of the law of a part's inertia.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum PartFinding {
    /// The mass scatters by more than itself, which most often is a slip. Its law is lognormal and very skewed then: of some thousand draws
    /// the deviation comes out too small.
    Mass {
        /// Its standard deviation as a share of the mass.
        relative: f64,
    },
    /// The nominal inertia was impossible by no more than rounding, and was moved to the nearest possible one.
    Rounded {
        /// ‖I′ − I‖/‖I‖.
        relative_distance: f64,
    },
    /// The nominal inertia is a plate's, a rod's or a point's, and the stated deviations are not: whatever is drawn with
    /// this mean lies in the same plane or line.
    Flat {
        /// How many second moments are not zero: 2 of a plate, 1 of a rod, 0 of a point.
        dimensions: usize,
    },
    /// No body, whatever its law, has a product that scatters this much beside these moments.
    ///
    /// Σ₁₂² ≤ Σ₁₁Σ₂₂ in every body, and E Σ₁₁Σ₂₂ = E Σ₁₁ E Σ₂₂ + ¼ (Var I₃₃ − Var(I₂₂ − I₁₁)), where the last variance is at least
    /// (σ₂₂ − σ₁₁)², however the moments are correlated.
    Product {
        /// I12, I13 or I23.
        entry: &'static str,
        /// Its stated deviation, kg·m².
        stated: f64,
        /// The largest that any law can have, kg·m².
        most: f64,
    },
    /// The law that draws come from deviates from what is stated by more than one percent, in these entries.
    Moved {
        /// Entry, stated deviation and deviation of the law, kg·m².
        entries: Vec<(&'static str, f64, f64)>,
    },
    /// Two entries go together in the draws, though they are stated as independent. In axes of another direction than the
    /// part's own, deviations are then others than independent entries would have.
    Correlated {
        /// The two that do so the most.
        entries: [&'static str; 2],
        /// Their correlation.
        correlation: f64,
    },
}

impl PartFinding {
    /// Whether no law of bodies can have what is stated, rather than only the law that was found.
    #[must_use]
    pub fn is_impossible(&self) -> bool {
        match self {
            Self::Flat { .. } | Self::Product { .. } => true,
            Self::Mass { .. }
            | Self::Rounded { .. }
            | Self::Moved { .. }
            | Self::Correlated { .. } => false,
        }
    }
}

impl fmt::Display for PartFinding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mass { relative } => write!(
                f,
                "the standard deviation of its mass is {} % of the mass, which may be a slip. Its law is very skewed then, and \
                 thousands of draws show too small a standard deviation",
                Short(100.0 * relative)
            ),
            Self::Rounded { relative_distance } => write!(
                f,
                "its inertia belongs to no body, by rounding: it was moved by {relative_distance:.2e} of \
                 itself"
            ),
            Self::Flat { dimensions } => {
                let what = ["a point", "a rod", "a plate"][(*dimensions).min(2)];
                write!(
                    f,
                    "its nominal inertia is that of {what}, and every body with this mean is one too: no \
                     body has the stated deviations of its inertia"
                )
            }
            Self::Product { entry, stated, most } => write!(
                f,
                "the product {entry} cannot have a standard deviation of {} kg·m² beside these moments and \
                 their deviations, whatever bodies are drawn: it can be {} kg·m² at most",
                Short(*stated),
                Short(*most)
            ),
            Self::Moved { entries } => {
                f.write_str(
                    "the standard deviations of the draws are not those stated, in kg·m²:",
                )?;
                for (i, (entry, stated, law)) in entries.iter().enumerate() {
                    let comma = if i == 0 { "" } else { "," };
                    let (law, stated) = (Short(*law), Short(*stated));
                    write!(f, "{comma} {entry} {law} in place of {stated}")?;
                }
                Ok(())
            }
            Self::Correlated { entries: [one, other], correlation } => write!(
                f,
                "its entries are stated as independent, and no law of bodies was found that has them so: {one} and {other} \
                 have a correlation of {correlation:.2} in the draws"
            ),
        }
    }
}

/// Findings on products that are wider than any law allows beside the moments.
pub(super) fn products(inertia: &InertiaMatrix, deviations: &[f64; 6]) -> Vec<PartFinding> {
    let sigma = inertia.second_moment_matrix();
    [(3, 0, 1, 2), (4, 0, 2, 1), (5, 1, 2, 0)]
        .into_iter()
        .filter_map(|(entry, i, j, k)| {
            let mean = inertia.entries()[entry];
            let apart = deviations[i] - deviations[j];
            let covariance = 0.25 * (deviations[k] * deviations[k] - apart * apart);
            let square = sigma[(i, i)].max(0.0) * sigma[(j, j)].max(0.0) + covariance;
            let most = (square - mean * mean).max(0.0).sqrt();
            let stated = deviations[entry];
            let entry = InertiaMatrix::ENTRY_NAMES[entry];
            (stated > most * (1.0 + 1e-9)).then_some(PartFinding::Product { entry, stated, most })
        })
        .collect()
}
