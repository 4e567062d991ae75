use std::fmt;

use super::{Part, StatedModel};
use crate::{RootMoments, fit::tail};

/// Stated and implied deviations that differ by no more are the same.
const AGREE: f64 = 0.1;
/// A share of impossible bodies that is worth a word.
const IMPOSSIBLE: f64 = 1e-3;
/// Roots nearer to zero than this many deviations.
const FLAT: f64 = 2.0;
/// A shift of a moment, as a share of it, that is worth a word.
const SHIFT: f64 = 0.01;

const NAMES: [&str; 6] = ["I11", "I22", "I33", "I12", "I13", "I23"];

/// Contradictions among statements, and what they leave open. Written out by `Display`; deviations
/// are standard deviations, entries in the order 11, 22, 33, 12, 13, 23 from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum StatementWarning {
    /// The model cannot give an entry the deviation that is stated.
    Missed {
        /// The entry.
        entry: usize,
        /// As stated, kg·m².
        stated: f64,
        /// As it comes out, kg·m².
        implied: f64,
    },
    /// Moments that scatter as stated and independently would often be those of no body.
    Impossible {
        /// The principal axis whose second moment would be negative, from 1.
        axis: usize,
        /// How often.
        share: f64,
    },
    /// A second moment within two deviations of zero, where it is skewed.
    Flat {
        /// The principal axis, from 1.
        axis: usize,
        /// Its root over the deviation of the root.
        ratio: f64,
    },
    /// The mean of a moment is not its nominal value.
    Shifted {
        /// The entry.
        entry: usize,
        /// Mean less nominal, percent.
        percent: f64,
    },
    /// Mass or centre alone move an entry more than is stated of it.
    Alone {
        /// Which.
        part: Part,
        /// The entry.
        entry: usize,
        /// What it does alone, kg·m².
        alone: f64,
        /// What is stated, kg·m².
        stated: f64,
    },
    /// Axes and products limit the axes differently.
    AxesAndProducts {
        /// Turns about the principal axes by the one, rad.
        axes: [f64; 3],
        /// By the other, rad; infinite where products say nothing.
        products: [f64; 3],
    },
    /// Two principal moments that differ by less than they scatter.
    EqualMoments {
        /// The two axes, from 1.
        axes: [usize; 2],
    },
    /// Nothing is said of the moments.
    FixedMoments,
    /// Nothing is said of the axes.
    FixedAxes,
    /// The turn about a principal axis is uniform.
    Free {
        /// The axis, from 1.
        axis: usize,
    },
}

impl StatementWarning {
    /// What the outcome gives rise to.
    pub(super) fn of_outcome(model: &StatedModel, products_limited: bool) -> Vec<Self> {
        let StatedModel { nominal, stated, implied, .. } = model;
        let trace = nominal.matrix().trace();
        let mut warnings = model.warnings.clone();
        let deviations = implied.deviations();
        for (entry, (stated, implied)) in stated.iter().zip(deviations).enumerate() {
            let within = entry >= 3 && products_limited && stated.is_some_and(|s| implied < s);
            if let Some(stated) = stated
                && !within
                && !((implied - stated).abs() <= AGREE * stated + 1e-8 * trace)
            {
                warnings.push(Self::Missed { entry, stated: *stated, implied });
            }
        }
        if let [Some(a), Some(b), Some(c), ..] = *stated {
            // K = (I_a + I_b − I_c)/2 in the principal axes, whose moments scatter about alike.
            let scatter = 0.5 * (a * a + b * b + c * c).sqrt();
            for (axis, k) in (1..).zip(nominal.second_moments().values()) {
                let share = if scatter > 0.0 { tail::normal(k / scatter) } else { 0.0 };
                if share > IMPOSSIBLE {
                    warnings.push(Self::Impossible { axis, share });
                }
            }
        }
        for axis in 0..3 {
            let root = nominal.second_moments().roots().values()[axis];
            let ratio = root / model.root_deviations[axis];
            if ratio < FLAT {
                warnings.push(Self::Flat { axis: axis + 1, ratio });
            }
        }
        let k = nominal.second_moments().values();
        let moments = model.law.roots().second_moment_statistics();
        let (scatter, c) = (moments.variances(), moments.covariance());
        for [m, n] in [[0, 1], [0, 2], [1, 2]] {
            if (k[m] - k[n]).abs() < (scatter[m] + scatter[n] - 2.0 * c[(m, n)]).sqrt() {
                warnings.push(Self::EqualMoments { axes: [m + 1, n + 1] });
            }
        }
        for entry in 0..3 {
            let x = nominal.entries()[entry];
            let shift = (implied.mean()[entry] - x) / x;
            if shift.abs() > SHIFT {
                warnings.push(Self::Shifted { entry, percent: 100.0 * shift });
            }
        }
        warnings
    }
}

impl fmt::Display for StatementWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Missed { entry, stated, implied } => {
                let name = NAMES[entry];
                write!(
                    f,
                    "{name}: a deviation of {stated:.4} kg·m² is stated, and {implied:.4} comes out: "
                )?;
                f.write_str(match (entry, implied > stated) {
                    (0..3, true) => {
                        "the moments of a body are tied together (each is the sum of two independent \
                         second moments), and the other statements ask for more"
                    }
                    (0..3, false) => {
                        "the moments of a body are tied together (each is the sum of two independent \
                         second moments), and this one cannot scatter so much beside the others"
                    }
                    (_, true) => {
                        "moments that scatter about tilted axes, or the axes as stated, already move \
                         the product more"
                    }
                    (_, false) => {
                        "turning the axes cannot move the product so much, the two moments being too \
                         near to each other"
                    }
                })
            }
            Self::Impossible { axis, share } => write!(
                f,
                "the moments as stated contradict realizability: scattered independently, {:.1} % of \
                 the bodies would break the triangle inequality (K{axis} < 0); the model has none of \
                 these",
                100.0 * share
            ),
            Self::Flat { axis, ratio } => write!(
                f,
                "the body is nearly flat across principal axis {axis}: k{axis} is {ratio:.1} deviations \
                 from zero, so that K{axis} = k{axis}² is skewed, and larger on average than the \
                 nominal"
            ),
            Self::Shifted { entry, percent } => write!(
                f,
                "{}: its mean lies {percent:+.1} % from the nominal value, for scatter moves it",
                NAMES[entry]
            ),
            Self::Alone { part, entry, alone, stated } => {
                let name = NAMES[entry];
                write!(
                    f,
                    "the {} alone moves {name} by {alone:.4} kg·m², more than the {stated:.4} stated of \
                     it: the statement on {name} is taken",
                    if part == Part::Mass { "mass" } else { "mass centre" }
                )
            }
            Self::AxesAndProducts { axes, products } => {
                f.write_str(
                    "axes and products disagree on the turns about principal axes 1, 2, 3: the axes \
                     allow",
                )?;
                degrees(f, axes)?;
                f.write_str(", the products")?;
                degrees(f, products)?;
                f.write_str(" (1σ): about each axis the tighter one is taken")
            }
            Self::EqualMoments { axes: [a, b] } => write!(
                f,
                "principal moments {a} and {b} differ by less than they scatter: which way the nominal \
                 body has these two axes means little, and the model keeps them there"
            ),
            Self::FixedMoments => {
                f.write_str("nothing is said of the moments: the second moments do not scatter")
            }
            Self::FixedAxes => f.write_str(
                "nothing is said of products or axes: the principal axes do not scatter",
            ),
            Self::Free { axis } => write!(
                f,
                "the turn about principal axis {axis} is taken to be uniform: the products stated allow \
                 any"
            ),
        }
    }
}

fn degrees(f: &mut fmt::Formatter<'_>, turns: [f64; 3]) -> fmt::Result {
    for (i, turn) in turns.iter().enumerate() {
        f.write_str(if i == 0 { " " } else { ", " })?;
        if turn.is_finite() {
            write!(f, "{:.2}°", turn.to_degrees())?
        } else {
            f.write_str("any")?
        }
    }
    Ok(())
}
