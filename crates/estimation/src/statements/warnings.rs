//! What statements contradict, and what they leave open.

use std::fmt;
use std::mem::discriminant;

use gyradius_inertia::InertiaMatrix;

use crate::short::Short;

/// The names of the entries.
const NAMES: [&str; 6] = InertiaMatrix::ENTRY_NAMES;

/// Contradictions among statements, and what they leave open. Written out by `Display`; deviations
/// are standard deviations, entries in the order 11, 22, 33, 12, 13, 23 from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum StatementWarning {
    /// The model cannot give an entry the deviation that is stated.
    Missed {
        /// The entry.
        entry: usize,
        /// As stated, kg·m².
        #[cfg_attr(feature = "serde", serde(rename = "stated_kg_m2"))]
        stated: f64,
        /// As it comes out, kg·m².
        #[cfg_attr(feature = "serde", serde(rename = "implied_kg_m2"))]
        implied: f64,
        /// Why.
        because: MissedBecause,
    },
    /// The inertia follows the mass in part only, for more would contradict what is stated of the moments.
    FollowsInPart {
        /// The share of the mass's relative change that the inertia takes.
        share: f64,
        /// The moment of which the whole would ask the most.
        entry: usize,
        /// What the whole would be, kg·m².
        #[cfg_attr(feature = "serde", serde(rename = "alone_kg_m2"))]
        alone: f64,
        /// What is stated of it, kg·m².
        #[cfg_attr(feature = "serde", serde(rename = "stated_kg_m2"))]
        stated: f64,
    },
    /// The second moments are correlated, for no independent ones were found that have the stated deviations.
    Correlated,
    /// Moments that scatter as stated would often be those of no body, if they were independent normal numbers beside the nominal
    /// products.
    Impossible {
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
    /// The mean of a moment whose nominal value is zero, or as good as zero beside the others, is not.
    Raised {
        /// The entry.
        entry: usize,
        /// Its mean, kg·m².
        #[cfg_attr(feature = "serde", serde(rename = "mean_kg_m2"))]
        mean: f64,
    },
    /// The mass centre alone moves an entry more than is stated of it.
    Alone {
        /// The entry.
        entry: usize,
        /// What it does alone, kg·m².
        #[cfg_attr(feature = "serde", serde(rename = "alone_kg_m2"))]
        alone: f64,
        /// What is stated, kg·m².
        #[cfg_attr(feature = "serde", serde(rename = "stated_kg_m2"))]
        stated: f64,
    },
    /// The mass centre alone moves a product more than the axes let it, as they are stated.
    CentreBesideAxes {
        /// The entry.
        entry: usize,
        /// What it does alone, kg·m².
        #[cfg_attr(feature = "serde", serde(rename = "alone_kg_m2"))]
        alone: f64,
        /// As it comes out, kg·m².
        #[cfg_attr(feature = "serde", serde(rename = "implied_kg_m2"))]
        implied: f64,
    },
    /// The mass centre would move an entry of which nothing is stated by more or less than comes out.
    CentreMissed {
        /// The entry.
        entry: usize,
        /// What it would be with the mass centre, kg·m².
        #[cfg_attr(feature = "serde", serde(rename = "wanted_kg_m2"))]
        wanted: f64,
        /// As it comes out, kg·m².
        #[cfg_attr(feature = "serde", serde(rename = "implied_kg_m2"))]
        implied: f64,
    },
    /// Axes and products limit the axes differently.
    AxesAndProducts {
        /// Turns about the principal axes by the one, rad.
        #[cfg_attr(feature = "serde", serde(rename = "axes_rad"))]
        axes: [f64; 3],
        /// By the other, rad; infinite where products say nothing.
        #[cfg_attr(
            feature = "serde",
            serde(rename = "products_rad", deserialize_with = "crate::read::or_infinite")
        )]
        products: [f64; 3],
        /// Those that come out, rad; infinite where they may be any.
        #[cfg_attr(
            feature = "serde",
            serde(rename = "turns_rad", deserialize_with = "crate::read::or_infinite")
        )]
        turns: [f64; 3],
    },
    /// Two principal moments that differ by less than they scatter.
    EqualMoments {
        /// The two axes, from 1.
        axes: [usize; 2],
    },
    /// Moments, products or axes are stated of a point, which has none.
    Point,
    /// Axes are stated of a body that these turns do not change: the moments that they mix are equal and do not scatter.
    AxesWithoutEffect,
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

/// Why an entry does not have the deviation that is stated.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum MissedBecause {
    /// The scatter of the axes moves it more.
    Axes {
        /// What that does alone, kg·m².
        #[cfg_attr(feature = "serde", serde(rename = "alone_kg_m2"))]
        alone: f64,
    },
    /// The scatter of the moments moves it more, about tilted axes.
    Moments {
        /// What that does alone, kg·m².
        #[cfg_attr(feature = "serde", serde(rename = "alone_kg_m2"))]
        alone: f64,
    },
    /// The mass moves it more.
    Mass {
        /// What that does alone, kg·m².
        #[cfg_attr(feature = "serde", serde(rename = "alone_kg_m2"))]
        alone: f64,
    },
    /// All of these together move it more.
    Together,
    /// The moments of a body are tied together, and the others do not let it.
    Tied,
    /// The axes as they are stated do not let a product be so large.
    AxesLimit,
    /// The moments as they are stated do not.
    MomentsLimit,
    /// Rotations cannot move it so much beside the others, the moments that they mix being too near to each other or the
    /// axes lying as they do.
    Rotations,
}

impl StatementWarning {
    /// What is its own in a few words, where it has that: for a list of entries, axes and bodies that have the like.
    #[must_use]
    pub fn figure(&self) -> Option<String> {
        let beside = |entry: usize, is: f64, stated: f64| {
            Some(format!("{}: {} for {}", NAMES[entry], Short(is), Short(stated)))
        };
        match *self {
            Self::FollowsInPart { share, .. } => Some(format!("by {share:.3}")),
            Self::Missed { entry, stated, implied, .. } => beside(entry, implied, stated),
            Self::Shifted { entry, percent } => Some(format!("{} {percent:+.1} %", NAMES[entry])),
            Self::Raised { entry, mean } => Some(format!("{}: {}", NAMES[entry], Short(mean))),
            Self::Alone { entry, alone, stated } => beside(entry, alone, stated),
            Self::CentreBesideAxes { entry, alone, implied } => beside(entry, implied, alone),
            Self::CentreMissed { entry, wanted, implied } => beside(entry, implied, wanted),
            Self::Impossible { share } => Some(format!("{:.1} %", 100.0 * share)),
            Self::Flat { axis, ratio } => Some(format!("k{axis}: {ratio:.1} deviations")),
            Self::EqualMoments { axes: [a, b] } => Some(format!("moments {a} and {b}")),
            Self::Free { axis } => Some(format!("axis {axis}")),
            Self::Correlated
            | Self::AxesAndProducts { .. }
            | Self::Point
            | Self::AxesWithoutEffect
            | Self::FixedMoments
            | Self::FixedAxes => None,
        }
    }

    /// Whether another one says the like, of another entry, axis or body: the same words with another [`Self::figure`].
    #[must_use]
    pub fn is_like(&self, other: &Self) -> bool {
        let reason = |warning: &Self| {
            if let Self::Missed { stated, because, .. } = *warning {
                // This one has words of its own.
                let unstated = stated == 0.0 && because == MissedBecause::Tied;
                Some((discriminant(&because), unstated))
            } else {
                None
            }
        };
        discriminant(self) == discriminant(other) && reason(self) == reason(other)
    }
}

impl fmt::Display for StatementWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Missed { entry, stated: 0.0, implied, because: MissedBecause::Tied } => write!(
                f,
                "{}: a deviation of 0 kg·m² is stated, and {} comes out: the moments of a body are tied together, each being the sum of \
                 two second moments, and the roots of these cannot hold it wholly while the other moments scatter",
                NAMES[entry],
                Short(implied)
            ),
            Self::Missed { entry, stated, implied, because } => {
                let (name, stated, implied) = (NAMES[entry], Short(stated), Short(implied));
                write!(
                    f,
                    "{name}: a deviation of {stated} kg·m² is stated, and {implied} comes out: \
                     {because}"
                )
            }
            Self::FollowsInPart { share, entry, alone, stated } => {
                let more = alone > stated;
                let (name, alone, stated) = (NAMES[entry], Short(alone), Short(stated));
                write!(
                    f,
                    "the inertia follows the mass only in part, by {share:.3} of its relative change: if it \
                     followed wholly, the mass alone would move {name} by {alone} kg·m², and \
                     {stated} are stated of it in all"
                )?;
                if !more {
                    f.write_str(", which the other moments could not have beside it")?;
                }
                Ok(())
            }
            Self::Correlated => f.write_str(
                "the second moments are correlated: no independent ones were found that have the deviations \
                 that follow from what is stated",
            ),
            Self::Impossible { share } => write!(
                f,
                "the moments as stated contradict realizability: scattered independently, as normal numbers \
                 beside the nominal products, {:.1} % of the bodies would break the triangle inequality; the \
                 model has none of these",
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
            Self::Raised { entry, mean } => write!(
                f,
                "{}: its nominal value is zero, and its mean {} kg·m², for scatter moves it",
                NAMES[entry],
                Short(mean)
            ),
            Self::Alone { entry, alone, stated } => {
                let (name, alone, stated) = (NAMES[entry], Short(alone), Short(stated));
                write!(
                    f,
                    "the mass centre alone would move {name} by {alone} kg·m², which is more than the \
                     {stated} stated of it: the statement on {name} is taken"
                )
            }
            Self::CentreBesideAxes { entry, alone, implied } => {
                let (name, alone, implied) = (NAMES[entry], Short(alone), Short(implied));
                write!(
                    f,
                    "the mass centre alone would move {name} by {alone} kg·m², and {implied} comes out: it \
                     would turn the axes farther than is stated of them, and the statement on the axes is taken"
                )
            }
            Self::CentreMissed { entry, wanted, implied } => {
                let (name, wanted, implied) = (NAMES[entry], Short(wanted), Short(implied));
                write!(
                    f,
                    "{name}: with what the mass centre adds, its deviation would be {wanted} kg·m², and \
                     {implied} comes out: scatter of the second moments and turns of the axes cannot \
                     bring it nearer beside the other entries"
                )
            }
            Self::AxesAndProducts { axes, products, turns } => {
                f.write_str(
                    "axes and products disagree on the turns about principal axes 1, 2, 3: the axes \
                     allow",
                )?;
                degrees(f, axes)?;
                f.write_str(", the products")?;
                degrees(f, products)?;
                f.write_str(" (1σ); the model turns by")?;
                degrees(f, turns)
            }
            Self::EqualMoments { axes: [a, b] } => write!(
                f,
                "principal moments {a} and {b} differ by less than they scatter: which way the nominal \
                 body has these two axes means little"
            ),
            Self::Point => f.write_str(
                "the inertia is zero, as that of a point: what is stated of moments, products and axes has no effect",
            ),
            Self::AxesWithoutEffect => f.write_str(
                "the principal moments that these turns mix are equal and do not scatter: what is stated of the axes has no effect",
            ),
            Self::FixedMoments => {
                f.write_str("nothing is said of the moments: the second moments do not scatter")
            }
            Self::FixedAxes => f.write_str(
                "nothing is said of products or axes: the principal axes do not scatter",
            ),
            Self::Free { axis } => write!(
                f,
                "the turn about principal axis {axis} is taken to be uniform: what is stated allows any"
            ),
        }
    }
}

impl fmt::Display for MissedBecause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Axes { alone } => {
                write!(f, "the scatter of the axes alone moves it by {} kg·m²", Short(*alone))
            }
            Self::Moments { alone } => write!(
                f,
                "the scatter of the moments, about axes that are tilted, alone moves it by {} \
                 kg·m²",
                Short(*alone)
            ),
            Self::Mass { alone } => write!(
                f,
                "the mass, with which the inertia grows, alone moves it by {} kg·m²",
                Short(*alone)
            ),
            Self::Together => f.write_str("what else is stated moves it more"),
            Self::Tied => f.write_str(
                "the moments of a body are tied together, each being the sum of two second moments, \
                 and beside what else is stated this one cannot come nearer",
            ),
            Self::MomentsLimit => f.write_str(
                "turns that moved it so far would move the moments by more than is stated of them",
            ),
            Self::AxesLimit => {
                f.write_str("the axes, as they are stated, do not turn far enough for more")
            }
            Self::Rotations => f.write_str(
                "rotations of the principal axes cannot move this product so much beside the others: the moments that they \
                 mix are too near to each other, or what turns this product turns others further than is stated of them",
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
