//! What a user of a fit should know.

use std::fmt;

use super::{AxesFinding, DOUBTFUL, PrincipalFit, root::RootEstimate, round::Roundness};

/// Moments nearer than this, in deviations of their difference, count as equal within their scatter.
const EQUAL: f64 = 2.0;
/// Fewer samples than this are few: of intervals of ± 1.96 stated errors fewer than 94 % hold the truth.
const FEW: usize = 50;
/// Deviation of a turn, rad, beyond which signs and names run into each other: 20°.
const WIDE: f64 = 0.35;

/// What a reader of a fit should know before using it. Written out by `Display`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum FitNote {
    /// Two principal moments are equal within their scatter, and what the axes do about it.
    EqualMoments {
        /// The two axes, from 1.
        axes: [usize; 2],
        /// Whether the turn about the third axis is undetermined.
        free: bool,
        /// Deviation of that turn otherwise, rad.
        #[cfg_attr(feature = "serde", serde(rename = "turn_rad"))]
        turn: f64,
    },
    /// Two principal moments are equal in every sample, or all three: a turn changes nothing.
    Round {
        /// The third axis, from 1; none if all moments are equal.
        axis: Option<usize>,
    },
    /// One turn of the axes is undetermined though no two moments are equal.
    FreeTurn {
        /// The axis that has a direction, from 1.
        axis: usize,
    },
    /// The axes point anywhere.
    Free,
    /// The axes turn about fewer than three directions.
    Still {
        /// Whether they do not turn at all.
        fixed: bool,
    },
    /// Axes in two groups or with outliers, held by a second lobe.
    SecondLobe {
        /// Its share.
        share: f64,
        /// How many samples that is, rounded.
        samples: usize,
    },
    /// Mean and deviation of a root cannot be told apart.
    Unidentified {
        /// Axis, from 1.
        axis: usize,
    },
    /// A root that has lost its sign.
    Folded {
        /// Axis, from 1.
        axis: usize,
    },
    /// Many samples could be matched otherwise.
    Doubtful {
        /// How many.
        count: usize,
    },
    /// Few samples: errors are too small.
    Few {
        /// How many.
        count: usize,
    },
    /// Matching did not settle, or the search for the law of the axes did not arrive.
    NotConverged,
}

impl fmt::Display for FitNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::EqualMoments { axes: [a, b], free: true, .. } => {
                let third = 6 - a - b;
                write!(
                    f,
                    "principal moments {a} and {b} are equal within their scatter, and the samples do \
                     not determine the turn about axis {third}: the law has it uniform"
                )
            }
            Self::EqualMoments { axes: [a, b], turn, .. } => {
                let third = 6 - a - b;
                let degrees = turn.to_degrees();
                write!(f, "principal moments {a} and {b} are equal within their scatter; ")?;
                if *turn > WIDE {
                    write!(
                        f,
                        "the turn about axis {third} scatters by {degrees:.0}°, so wide that names run \
                         into each other"
                    )?;
                } else {
                    write!(
                        f,
                        "the turn about axis {third} is known all the same, with a scatter of \
                         {degrees:.2}°"
                    )?;
                }
                Ok(())
            }
            Self::Round { axis: Some(axis) } => {
                let [a, b] = others(*axis);
                write!(
                    f,
                    "principal moments {a} and {b} are equal in every sample: a turn about axis {axis} changes nothing, and \
                     the samples say nothing of it"
                )
            }
            Self::Round { axis: None } => f.write_str(
                "the three principal moments are equal in every sample: a turn changes nothing, and the samples say \
                 nothing of the axes",
            ),
            Self::FreeTurn { axis } => write!(
                f,
                "the samples do not determine the turn about principal axis {axis}: the law has it \
                 uniform"
            ),
            Self::Free => f.write_str(
                "the principal axes point anywhere, as those of a body with three equal moments do: \
                 the law has them uniform",
            ),
            Self::Still { fixed: true } => {
                f.write_str("the principal axes do not scatter: the law has them fixed to 1e-4°")
            }
            Self::Still { fixed: false } => f.write_str(
                "the principal axes turn about fewer than three directions: the law has the others \
                 fixed to 1e-4°",
            ),
            Self::SecondLobe { share, samples } => {
                let percent = 100.0 * share;
                write!(
                    f,
                    "the axes lie in two groups or have outliers: the law holds them by a second lobe \
                     about the inverse of the mean, of {percent:.2} %, "
                )?;
                match samples {
                    0 | 1 => f.write_str("which is one sample and may as well be an outlier")?,
                    _ => write!(f, "which is {samples} samples")?,
                }
                f.write_str("; the deviations of turns are those about the mean, without that lobe")
            }
            Self::Unidentified { axis } => write!(
                f,
                "k{axis} is nearer to zero than its deviation: samples of its square do not tell mean \
                 and deviation apart, only mean² + deviation²; a body nearly flat across axis {axis}"
            ),
            Self::Folded { axis } => write!(
                f,
                "k{axis} comes near zero, where its sign is lost: fitted as a folded Gaussian"
            ),
            Self::Doubtful { count } => write!(
                f,
                "{count} samples could be matched otherwise, at odds below 20 : 1: how they are matched was drawn \
                 as it is likely, and errors, which suppose it right, are too small"
            ),
            Self::Few { count } => write!(
                f,
                "{count} samples are few: errors are those of many samples, and too small here. Of intervals of \
                 ± 1.96 errors about nine in ten hold the truth at 13 to 20 samples, 93 to 94 % at 50"
            ),
            Self::NotConverged => f.write_str("the search for the best fit did not arrive"),
        }
    }
}

/// The two other axes, in ascending order, all from 1.
fn others(axis: usize) -> [usize; 2] {
    match axis {
        1 => [2, 3],
        2 => [1, 3],
        _ => [1, 2],
    }
}

impl PrincipalFit {
    /// What a reader should know: equal moments, undetermined turns, lost signs, doubtful matches.
    #[must_use]
    pub fn notes(&self) -> Vec<FitNote> {
        let mut notes = Vec::new();
        let finding = self.axes.finding();
        let mut told = false;
        let round = Roundness::of(&self.samples);
        match round {
            Roundness::No => {}
            Roundness::About(axis) => notes.push(FitNote::Round { axis: Some(axis + 1) }),
            Roundness::Ball => notes.push(FitNote::Round { axis: None }),
        }
        for axis in (0..3).filter(|axis| !round.is_about(*axis)) {
            let (a, b) = (self.roots[(axis + 1) % 3], self.roots[(axis + 2) % 3]);
            let scatter = a.deviation().hypot(b.deviation());
            if !((a.mean() - b.mean()).abs() < EQUAL * scatter) {
                continue;
            }
            let free = finding == AxesFinding::FreeTurn { axis: axis + 1 };
            told |= free;
            let r = *self.axes.law().mean().to_rotation_matrix().matrix();
            let turn = (r * self.axes.turn_covariance() * r.transpose())[(axis, axis)];
            let axes = others(axis + 1);
            if finding != AxesFinding::Free {
                notes.push(FitNote::EqualMoments { axes, free, turn: turn.max(0.0).sqrt() });
            }
        }
        match finding {
            // Told above.
            _ if round != Roundness::No => {}
            AxesFinding::FreeTurn { axis } if !told => notes.push(FitNote::FreeTurn { axis }),
            AxesFinding::Free => notes.push(FitNote::Free),
            AxesFinding::Still => {
                let fixed = self.axes.turn_covariance().amax() == 0.0;
                notes.push(FitNote::Still { fixed });
            }
            _ => {}
        }
        if let Some(share) = self.axes.second_lobe() {
            let samples = (share * self.count() as f64).round() as usize;
            notes.push(FitNote::SecondLobe { share, samples });
        }
        for (axis, root) in (1..).zip(&self.roots) {
            if !root.is_identified() {
                notes.push(FitNote::Unidentified { axis });
            } else if root.law() == RootEstimate::Folded {
                notes.push(FitNote::Folded { axis });
            }
        }
        let count = self.matching.doubtful;
        let settled = matches!(finding, AxesFinding::Determined | AxesFinding::Still);
        if settled && count as f64 > DOUBTFUL * self.count() as f64 {
            notes.push(FitNote::Doubtful { count });
        }
        if self.count() < FEW {
            notes.push(FitNote::Few { count: self.count() });
        }
        if !(self.matching.converged && self.axes.converged()) {
            notes.push(FitNote::NotConverged);
        }
        notes
    }
}
