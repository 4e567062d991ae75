//! What statements contradict, and what they leave open.

use nalgebra::Matrix3;
use std::fmt;

use super::{
    Stated, StatedModel,
    body::{Body, Scatter},
    law::Scattered,
};
use crate::{RootLaw, RootMoments, entry_moments::NAMES, fit::tail};

/// Stated and implied deviations that differ by no more than this share are the same.
const AGREE: f64 = 0.03;
/// And by no more than this share of the largest one stated.
const SMALL: f64 = 2e-3;
/// A share of impossible bodies that is worth a word.
const IMPOSSIBLE: f64 = 1e-3;
/// Roots nearer to zero than this many deviations.
const FLAT: f64 = 2.0;
/// A shift of a moment, as a share of it, that is worth a word.
const SHIFT: f64 = 0.01;

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
        alone: f64,
        /// What is stated of it, kg·m².
        stated: f64,
    },
    /// The second moments are correlated, for independent ones do not have the stated deviations.
    Correlated,
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
    /// The mass centre alone moves an entry more than is stated of it.
    Alone {
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

/// Why an entry does not have the deviation that is stated.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum MissedBecause {
    /// The scatter of the axes moves it more.
    Axes {
        /// What that does alone, kg·m².
        alone: f64,
    },
    /// The scatter of the moments moves it more, about tilted axes.
    Moments {
        /// What that does alone, kg·m².
        alone: f64,
    },
    /// The mass moves it more.
    Mass {
        /// What that does alone, kg·m².
        alone: f64,
    },
    /// All of these together move it more.
    Together,
    /// The moments of a body are tied together, and the others do not let it.
    Tied,
    /// Rotations cannot move it so much, the moments that they mix being too near to each other or the
    /// axes lying as they do.
    Rotations,
}

impl StatementWarning {
    /// What a model of statements gives rise to. `unlimited`: the rotations that the products alone would allow,
    /// if the axes are stated as well.
    pub(super) fn of(
        model: &StatedModel,
        body: &Body,
        stated: &Stated,
        unlimited: Option<[f64; 3]>,
    ) -> Vec<Self> {
        let mut warnings = said_nothing_of(model, stated);
        warnings.extend(follows_in_part(model, stated));
        if matches!(model.law_at_nominal_mass().roots(), RootLaw::CorrelatedGaussian(_)) {
            warnings.push(Self::Correlated);
        }
        warnings.extend(centre_alone(model, stated));
        if let (Some(axes), Some(products)) = (stated.axes, unlimited) {
            let gaps = body.gaps(&Matrix3::zeros());
            let differ = |a: f64, b: f64| !((a - b).abs() <= 0.1 * a.max(b));
            if (0..3).any(|j| gaps[(j, j)] > 0.0 && differ(axes[j], products[j])) {
                warnings.push(Self::AxesAndProducts { axes, products });
            }
        }
        for (axis, turn) in (1..).zip(model.turns()) {
            if !turn.is_finite() {
                warnings.push(Self::Free { axis });
            }
        }
        warnings.extend(missed(model, body, stated));
        warnings.extend(of_outcome(model));
        warnings
    }
}

/// What the statements leave open.
fn said_nothing_of(model: &StatedModel, stated: &Stated) -> Vec<StatementWarning> {
    let mut warnings = Vec::new();
    if stated.moments.is_none() && stated.centre.is_none() && model.mass().is_none() {
        warnings.push(StatementWarning::FixedMoments);
    }
    if stated.products.is_none() && stated.axes.is_none() && stated.centre.is_none() {
        warnings.push(StatementWarning::FixedAxes);
    }
    warnings
}

/// Where the inertia cannot wholly follow the mass, the moment that would be moved most beyond what is
/// stated of it.
fn follows_in_part(model: &StatedModel, stated: &Stated) -> Option<StatementWarning> {
    let mass = model.mass().filter(|mass| mass.inertia_follows() < 1.0)?;
    let (moments, entries) = (stated.moments?, model.nominal().entries());
    let alone = |e: usize| mass.relative_deviation() * entries[e].abs();
    let entry =
        (0..3).max_by(|&a, &b| (alone(a) * moments[b]).total_cmp(&(alone(b) * moments[a])))?;
    Some(StatementWarning::FollowsInPart {
        share: mass.inertia_follows(),
        entry,
        alone: alone(entry),
        stated: moments[entry],
    })
}

/// What the mass centre alone does may not exceed what is stated of the whole.
fn centre_alone(model: &StatedModel, stated: &Stated) -> Vec<StatementWarning> {
    let Some(centre) = stated.centre else { return Vec::new() };
    let entries = model.stated().into_iter().zip(centre).enumerate();
    entries
        .filter_map(|(entry, (stated, variance))| {
            let (stated, alone) = (stated?, variance.sqrt());
            let more = alone > stated * (1.0 + 1e-9);
            more.then_some(StatementWarning::Alone { entry, alone, stated })
        })
        .collect()
}

/// The entries that do not have the stated deviation, and why.
fn missed(model: &StatedModel, body: &Body, stated: &Stated) -> Vec<StatementWarning> {
    let trace = model.nominal().matrix().trace();
    let deviations_of = |scatter: Scatter| {
        let roots = model.nominal().second_moments().roots();
        let alone = Scattered::new(body, roots, &scatter).map(|alone| alone.moments());
        alone.map_or([0.0; 6], |moments| moments.deviations())
    };
    let still = Matrix3::zeros();
    let scatter = *model.scatter();
    let by_moments = deviations_of(Scatter { mixing: still, ..scatter });
    let by_axes = deviations_of(Scatter { moments: still, ..scatter });
    let by_mass = model.mass().map_or(0.0, |mass| mass.factor_deviation());
    let deviations = model.implied().deviations();
    let mut warnings = Vec::new();
    for (first, three) in [(0, stated.moments), (3, stated.products)] {
        let Some(three) = three else { continue };
        let small = SMALL * three.into_iter().fold(0.0, f64::max) + 1e-8 * trace;
        for (entry, stated_here) in (first..).zip(three) {
            let implied = deviations[entry];
            if (implied - stated_here).abs() <= AGREE * stated_here + small {
                continue;
            }
            let because = if implied > stated_here {
                let nearly = 0.9 * stated_here;
                let mass = by_mass * model.nominal().entries()[entry].abs();
                if by_axes[entry] > nearly {
                    MissedBecause::Axes { alone: by_axes[entry] }
                } else if by_moments[entry] > nearly {
                    MissedBecause::Moments { alone: by_moments[entry] }
                } else if mass > nearly {
                    MissedBecause::Mass { alone: mass }
                } else {
                    MissedBecause::Together
                }
            } else if entry < 3 {
                MissedBecause::Tied
            } else if stated.axes.is_some() {
                // “Within” is a limit: products that stated axes keep smaller are within it.
                continue;
            } else {
                MissedBecause::Rotations
            };
            let stated = stated_here;
            warnings.push(StatementWarning::Missed { entry, stated, implied, because });
        }
    }
    warnings
}

/// What the law itself has of note.
fn of_outcome(model: &StatedModel) -> Vec<StatementWarning> {
    let (nominal, implied) = (model.nominal(), model.implied());
    let mut warnings = Vec::new();
    if let [Some(a), Some(b), Some(c), ..] = model.stated() {
        // K = (I_a + I_b − I_c)/2 in the principal axes, whose moments scatter about alike.
        let scatter = 0.5 * (a * a + b * b + c * c).sqrt();
        for (axis, k) in (1..).zip(nominal.second_moments().values()) {
            let share = if scatter > 0.0 { tail::normal(k / scatter) } else { 0.0 };
            if share > IMPOSSIBLE {
                warnings.push(StatementWarning::Impossible { axis, share });
            }
        }
    }
    let roots = nominal.second_moments().roots().values();
    for (axis, (root, deviation)) in (1..).zip(roots.into_iter().zip(model.root_deviations())) {
        let ratio = root / deviation;
        if ratio < FLAT {
            warnings.push(StatementWarning::Flat { axis, ratio });
        }
    }
    let k = nominal.second_moments().values();
    let moments = model.law().roots().second_moment_statistics();
    let (scatter, c) = (moments.variances(), moments.covariance());
    for [m, n] in [[0, 1], [0, 2], [1, 2]] {
        if (k[m] - k[n]).abs() < (scatter[m] + scatter[n] - 2.0 * c[(m, n)]).max(0.0).sqrt() {
            warnings.push(StatementWarning::EqualMoments { axes: [m + 1, n + 1] });
        }
    }
    for entry in 0..3 {
        let x = nominal.entries()[entry];
        let shift = (implied.mean()[entry] - x) / x;
        if shift.abs() > SHIFT {
            warnings.push(StatementWarning::Shifted { entry, percent: 100.0 * shift });
        }
    }
    warnings
}

impl fmt::Display for StatementWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Missed { entry, stated, implied, because } => {
                let name = NAMES[entry];
                write!(
                    f,
                    "{name}: a deviation of {stated:.4} kg·m² is stated, and {implied:.4} comes out: \
                     {because}"
                )
            }
            Self::FollowsInPart { share, entry, alone, stated } => {
                let name = NAMES[entry];
                write!(
                    f,
                    "the inertia follows the mass only in part, by {share:.3} of its relative change: if it \
                     followed wholly, the mass alone would move {name} by {alone:.4} kg·m², and \
                     {stated:.4} are stated of it in all"
                )?;
                if alone <= stated {
                    f.write_str(", which the other moments could not have beside it")?;
                }
                Ok(())
            }
            Self::Correlated => f.write_str(
                "the second moments are correlated: independent ones cannot have the deviations that \
                 are stated",
            ),
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
            Self::Alone { entry, alone, stated } => {
                let name = NAMES[entry];
                write!(
                    f,
                    "the mass centre alone would move {name} by {alone:.4} kg·m², which is more than the \
                     {stated:.4} stated of it: the statement on {name} is taken"
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

impl fmt::Display for MissedBecause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Axes { alone } => {
                write!(f, "the scatter of the axes alone moves it by {alone:.4} kg·m²")
            }
            Self::Moments { alone } => write!(
                f,
                "the scatter of the moments, about axes that are tilted, alone moves it by {alone:.4} \
                 kg·m²"
            ),
            Self::Mass { alone } => {
                write!(f, "the mass, with which the inertia grows, alone moves it by {alone:.4} kg·m²")
            }
            Self::Together => f.write_str("what else is stated moves it more"),
            Self::Tied => f.write_str(
                "the moments of a body are tied together, each being the sum of two second moments, \
                 and this one cannot scatter so much beside the others",
            ),
            Self::Rotations => f.write_str(
                "rotations of the principal axes cannot move this product so much: the moments that \
                 they mix are too near to each other",
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
