//! Requirements: that a number of a run keeps a bound in at least a share of all runs, at a confidence.

mod convergence;
mod counting;
mod deciding;
mod distribution;
mod event;
mod gathering;
mod groups;
mod judgement;
mod judgement_error;
mod judging;
mod measured;
mod numbering;
mod of_table;
mod rounding;
mod text;
mod words;

use gyradius_statistics::{Acceptance, Confidence, SequentialAcceptance, StatisticsError};
use serde::{Deserialize, Serialize};
use std::{fmt, str::FromStr};

use crate::{number::plain, table::Table};

pub use convergence::ConvergencePoint;
pub use counting::Counting;
pub use deciding::Looks;
pub use distribution::{Distribution, DistributionPoint};
pub use event::Event;
pub use gathering::RunBeyond;
pub(crate) use gathering::Tally;
pub use judgement::{Judgement, VehiclesKeeping};
pub use judgement_error::JudgementError;
pub use judging::Judging;
pub use measured::Measured;
pub use rounding::{
    one_decimal, percent_beside, percent_or_less, percent_or_more, rounded_down, share_in_percent,
    stated_in_percent,
};
pub(crate) use words::Words;

/// That a number of a run keeps a bound in at least a share of all runs, at a confidence: a requirement.
///
/// A line of text is one, and the same stands in a scenario as a table with the keys `name`, `quantity`, one of `at_most`,
/// `at_least` and `between`, `probability`, `confidence` and `failed_runs`. A line has itself for its name, in the form in which
/// it is written: lines that differ in their spaces alone are the same requirement.
/// ```
/// use gyradius_campaign::Requirement;
///
/// let requirement: Requirement = "abs(rate_deg_per_s) <= 1 in 99.73 % at 90 %".parse()?;
/// assert!(requirement.is_kept(&[Some(-0.7)]));
/// assert!(!requirement.is_kept(&[Some(-1.7)]));
/// // A run that failed has no rate, and keeps no bound.
/// assert!(!requirement.is_kept(&[None]));
/// assert_eq!(requirement.probability(), 0.9973);
/// assert_eq!(requirement.to_string(), "abs(rate_deg_per_s) <= 1 in 99.73 % at 90 %");
/// # Ok::<(), gyradius_campaign::RequirementError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "RequirementForm", into = "RequirementForm")]
pub struct Requirement {
    name: String,
    quantity: Measured,
    bound: Bound,
    probability: f64,
    confidence: Confidence,
    failed_runs: FailedRuns,
    /// The model whose runs are judged, if not those of all.
    model: Option<String>,
}

/// What a number has to keep.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Bound {
    /// It is at most this.
    AtMost(f64),
    /// It is at least this.
    AtLeast(f64),
    /// It is between these, or one of them.
    Between(f64, f64),
}

/// What becomes of runs that failed, or have no number for another reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FailedRuns {
    /// They count against the requirement.
    #[default]
    Against,
    /// They are left out, as if they had not been done.
    LeftOut,
}

impl FailedRuns {
    /// Of which runs the shares of a requirement are, in words.
    #[must_use]
    pub fn of_which(self) -> &'static str {
        match self {
            Self::Against => "all runs",
            Self::LeftOut => "the runs that have a number",
        }
    }
}

/// A requirement as it stands in a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RequirementForm {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    quantity: Measured,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    at_most: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    at_least: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    between: Option<[f64; 2]>,
    probability: f64,
    confidence: f64,
    #[serde(default)]
    failed_runs: FailedRuns,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    model: Option<String>,
}

/// A confidence with which a requirement cannot be met and not met at once.
fn deciding(value: f64) -> Result<Confidence, RequirementError> {
    let confidence = Confidence::new(value).ok().filter(|own| own.level() >= 0.5);
    confidence.ok_or(RequirementError::Confidence { value })
}

/// That a requirement can ask for such a share of the runs, with any confidence that decides.
fn possible(value: f64) -> Result<(), RequirementError> {
    let asked = Acceptance::new(value, Confidence::default());
    asked.map(drop).map_err(|_| RequirementError::Probability { value })
}

impl Requirement {
    /// That a quantity keeps a bound in at least the share `probability` of all runs, with this confidence. Runs that failed count
    /// against it.
    ///
    /// # Errors
    /// A limit is not finite, the lower one is above the upper one, the probability is not between 1e-9 and 1 − 1e-9, or the
    /// confidence is below one half, with which a requirement could be met and not met at once, or not below 1.
    pub fn new(
        name: &str,
        quantity: Measured,
        bound: Bound,
        probability: f64,
        confidence: f64,
    ) -> Result<Self, RequirementError> {
        bound.check()?;
        let confidence = deciding(confidence)?;
        possible(probability)?;
        let (name, failed_runs) = (name.to_owned(), FailedRuns::default());
        Ok(Self { name, quantity, bound, probability, confidence, failed_runs, model: None })
    }

    /// The same, with this said of runs that failed.
    #[must_use]
    pub fn with_failed_runs(self, failed_runs: FailedRuns) -> Self {
        Self { failed_runs, ..self }
    }

    /// The same, of the runs of one model alone.
    #[must_use]
    pub fn of_model(self, model: &str) -> Self {
        Self { model: Some(model.to_owned()), ..self }
    }

    /// The model whose runs are judged, if not those of all models.
    #[must_use]
    pub fn model(&self) -> Option<&str> {
        self.model.as_deref()
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What it is about.
    #[must_use]
    pub fn quantity(&self) -> &Measured {
        &self.quantity
    }

    /// What has to be kept.
    #[must_use]
    pub fn bound(&self) -> Bound {
        self.bound
    }

    /// In which share of all runs, at least.
    #[must_use]
    pub fn probability(&self) -> f64 {
        self.probability
    }

    /// How certain that has to be.
    #[must_use]
    pub fn confidence(&self) -> Confidence {
        self.confidence
    }

    /// What becomes of runs that failed.
    #[must_use]
    pub fn failed_runs(&self) -> FailedRuns {
        self.failed_runs
    }

    /// When so many runs decide it.
    pub(crate) fn acceptance(&self) -> Result<Acceptance, StatisticsError> {
        Acceptance::new(self.probability, self.confidence)
    }

    /// The same, if the runs are looked at as often as one likes.
    pub(crate) fn sequential(&self) -> Result<SequentialAcceptance, StatisticsError> {
        self.acceptance().map(SequentialAcceptance::new)
    }

    /// Whether a run keeps it that has these numbers in the columns of the quantity.
    #[must_use]
    pub fn is_kept(&self, numbers: &[Option<f64>]) -> bool {
        self.quantity.of(numbers).is_some_and(|x| self.bound.is_kept(x))
    }

    /// Whether a run with this number fails it; none if it is left out, for it has no number.
    #[must_use]
    pub fn fails(&self, number: Option<f64>) -> Option<bool> {
        match (number, self.failed_runs) {
            (Some(x), _) => Some(!self.bound.is_kept(x)),
            (None, FailedRuns::Against) => Some(true),
            (None, FailedRuns::LeftOut) => None,
        }
    }

    /// Whether each run of a block fails it; none of those that are left out.
    #[must_use]
    pub fn failing(&self, block: &Table) -> Vec<Option<bool>> {
        self.quantity.numbers(block).into_iter().map(|number| self.fails(number)).collect()
    }

    /// Whether the runs of a model are judged.
    #[must_use]
    pub fn is_of(&self, model: &str) -> bool {
        self.model().is_none_or(|own| own == model)
    }
}

impl Bound {
    /// Whether a number keeps it. One that is infinite keeps none, whatever its sign.
    #[must_use]
    pub fn is_kept(self, x: f64) -> bool {
        x.is_finite() && self.excess(x) <= 0.0
    }

    /// How far a number is beyond it; negative if it is within.
    #[must_use]
    pub fn excess(self, x: f64) -> f64 {
        match self {
            Self::AtMost(limit) => difference(x, limit),
            Self::AtLeast(limit) => difference(limit, x),
            Self::Between(lower, upper) => difference(lower, x).max(difference(x, upper)),
        }
    }

    /// The same kind of bound, wider by so much.
    #[must_use]
    pub fn wider(self, by: f64) -> Self {
        match self {
            Self::AtMost(limit) => Self::AtMost(difference(limit, -by)),
            Self::AtLeast(limit) => Self::AtLeast(difference(limit, by)),
            Self::Between(lower, upper) => {
                Self::Between(difference(lower, by), difference(upper, -by))
            }
        }
    }

    /// The narrowest bound of the same kind that a number keeps.
    pub(crate) fn at(self, x: f64) -> Self {
        match self {
            Self::AtMost(_) => Self::AtMost(x),
            Self::AtLeast(_) => Self::AtLeast(x),
            Self::Between(..) => self.wider(self.excess(x)),
        }
    }

    fn check(self) -> Result<(), RequirementError> {
        let limits = match self {
            Self::AtMost(limit) | Self::AtLeast(limit) => [limit, limit],
            Self::Between(lower, upper) => [lower, upper],
        };
        if limits.iter().all(|limit| limit.is_finite()) && limits[0] <= limits[1] {
            return Ok(());
        }
        Err(RequirementError::Limits { lower: limits[0], upper: limits[1] })
    }
}

/// A number less another one; of finite numbers the largest or least that is finite where the difference is beyond.
fn difference(a: f64, b: f64) -> f64 {
    let difference = a - b;
    if a.is_finite() && b.is_finite() { difference.clamp(-f64::MAX, f64::MAX) } else { difference }
}

/// In words, after the quantity.
impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::AtMost(limit) => write!(f, "at most {}", plain(limit)),
            Self::AtLeast(limit) => write!(f, "at least {}", plain(limit)),
            Self::Between(lower, upper) => {
                write!(f, "between {} and {}", plain(lower), plain(upper))
            }
        }
    }
}

impl FromStr for Requirement {
    type Err = RequirementError;

    fn from_str(text: &str) -> Result<Self, RequirementError> {
        text::parse(text)
    }
}

/// The line that says it, with neither its name, nor what becomes of failed runs, nor the model.
impl fmt::Display for Requirement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        text::write_bounded(f, &self.quantity, self.bound)?;
        let [probability, confidence] =
            [self.probability, self.confidence.level()].map(text::share);
        write!(f, " in {probability} at {confidence}")
    }
}

impl TryFrom<RequirementForm> for Requirement {
    type Error = RequirementError;

    fn try_from(form: RequirementForm) -> Result<Self, RequirementError> {
        let bound = match (form.at_most, form.at_least, form.between) {
            (Some(limit), None, None) => Bound::AtMost(limit),
            (None, Some(limit), None) => Bound::AtLeast(limit),
            (None, None, Some([lower, upper])) => Bound::Between(lower, upper),
            _ => return Err(RequirementError::OneBound),
        };
        let name = form.name.unwrap_or_else(|| format!("{} {bound}", form.quantity));
        let requirement =
            Self::new(&name, form.quantity, bound, form.probability, form.confidence)?;
        let model = form.model;
        Ok(Self { model, ..requirement.with_failed_runs(form.failed_runs) })
    }
}

impl From<Requirement> for RequirementForm {
    fn from(requirement: Requirement) -> Self {
        let Requirement { name, quantity, bound, probability, confidence, failed_runs, model } =
            requirement;
        let (at_most, at_least, between) = match bound {
            Bound::AtMost(limit) => (Some(limit), None, None),
            Bound::AtLeast(limit) => (None, Some(limit), None),
            Bound::Between(lower, upper) => (None, None, Some([lower, upper])),
        };
        let (name, confidence) = (Some(name), confidence.level());
        Self {
            name,
            quantity,
            at_most,
            at_least,
            between,
            probability,
            confidence,
            failed_runs,
            model,
        }
    }
}

/// What is wrong with two limits, or with the only one.
fn limits(lower: f64, upper: f64) -> String {
    if lower.total_cmp(&upper).is_eq() {
        return format!("the limit is {}: it must be finite", plain(lower));
    }
    let [lower, upper] = [lower, upper].map(plain);
    format!("the limits are {lower} and {upper}: they must be finite, and the lower one first")
}

/// Why a requirement is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RequirementError {
    /// The line cannot be read.
    #[error(
        "“{text}”, at {at}: {problem}; it is written as “abs(x) <= 1 in 99.73 % at 90 %”, with the name of a column for x"
    )]
    Text {
        /// The line.
        text: String,
        /// Where.
        at: String,
        /// What is wrong there.
        problem: String,
    },
    /// The line of an event cannot be read.
    #[error(
        "“{text}”, at {at}: {problem}; it is written as “abs(x) >= 1”, with the name of a column for x"
    )]
    Event {
        /// The line.
        text: String,
        /// Where.
        at: String,
        /// What is wrong there.
        problem: String,
    },
    /// There is no bound, or more than one.
    #[error("there must be one of at_most, at_least and between")]
    OneBound,
    /// The limits are not finite, or in the wrong order.
    #[error("{}", limits(*lower, *upper))]
    Limits {
        /// The lower one, or the one that there is.
        lower: f64,
        /// The upper one.
        upper: f64,
    },
    /// The share of the runs is too near to 0 or 1, or is none.
    #[error(
        "probability = {}: it must lie between 1e-9 and 1 - 1e-9, as 0.9973, or as 99.73 % in a line",
        plain(*value)
    )]
    Probability {
        /// The share.
        value: f64,
    },
    /// The confidence is below one half, or is none.
    #[error(
        "confidence = {}: it must be at least 0.5 and below 1, as 0.9, or as 90 % in a line",
        plain(*value)
    )]
    Confidence {
        /// The confidence.
        value: f64,
    },
}

impl RequirementError {
    /// The same of the line of an event.
    fn of_event(self) -> Self {
        match self {
            Self::Text { text, at, problem } => Self::Event { text, at, problem },
            other => other,
        }
    }
}
