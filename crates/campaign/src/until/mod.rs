//! When a campaign ends: after a number of runs that its own runs decide, by a rule that is asked after every look.

mod evidence;
mod work;

use gyradius_statistics::{Confidence, FixedWidth};
use serde::{Deserialize, Serialize};
use std::{fmt, str::FromStr};

use crate::{
    number::{of_percent, plain},
    requirement::{Measured, Words},
};

pub use evidence::Evidence;
pub use work::{End, run_until};

/// Until when a campaign goes on, looked at how often, and how many runs it may have at most.
///
/// The runs are looked at after the first `look_every`, and then after each `look_every` more, or a tenth more in whole
/// `look_every`, if that is more.
/// In a file it is a table with the keys `rule`, `look_every` and `most_runs`, and `first_look` if that is said.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Form", into = "Form")]
pub struct Until {
    rule: StoppingRule,
    /// After how many runs the first look is, if there were more runs than the rule asks for before it was asked: `most_runs` at most.
    first_look: Option<u64>,
    look_every: u64,
    most_runs: u64,
}

/// What ends a campaign.
///
/// A line of text is one.
/// ```
/// use gyradius_campaign::StoppingRule;
///
/// for line in ["decided", "share within 0.1 %", "mean(abs(rate_deg_per_s)) within 0.02"] {
///     let rule: StoppingRule = line.parse()?;
///     assert_eq!(rule.to_string(), line);
/// }
/// # Ok::<(), gyradius_campaign::UntilError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum StoppingRule {
    /// Each requirement is met or not met, by the rule that keeps its risk however often it is asked.
    Decided,
    /// The share of the runs that fail is known to ± this for each requirement: its interval is no wider than twice this, by
    /// intervals that hold together at all looks.
    Share(f64),
    /// The mean of a number is known to ± this, with a confidence of 95 %.
    Mean(Measured, f64),
}

/// As it stands in a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Form {
    rule: StoppingRule,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    first_look: Option<u64>,
    look_every: u64,
    most_runs: u64,
}

impl Until {
    /// That a rule is asked after each `look_every` runs at first, up to so many runs at most.
    ///
    /// # Errors
    /// A number is 0.
    pub fn new(rule: StoppingRule, look_every: u64, most_runs: u64) -> Result<Self, UntilError> {
        for (field, number) in [("look_every", look_every), ("most_runs", most_runs)] {
            positive(field, number)?;
        }
        Ok(Self { rule, first_look: None, look_every, most_runs })
    }

    /// The same with another greatest number of runs, at least one.
    #[must_use]
    pub fn with_most_runs(self, runs: u64) -> Self {
        let first_look = self.first_look;
        Self { most_runs: runs.max(1), ..self }.looked_at_from(first_look)
    }

    /// What ends it.
    #[must_use]
    pub fn rule(&self) -> &StoppingRule {
        &self.rule
    }

    /// After how many runs it is looked at first.
    #[must_use]
    pub fn look_every(&self) -> u64 {
        self.look_every
    }

    /// How many runs there may be.
    #[must_use]
    pub fn most_runs(&self) -> u64 {
        self.most_runs
    }

    /// The same, with no look before so many runs, or before the greatest number if that is less.
    ///
    /// # Errors
    /// The number is 0.
    pub fn with_first_look(self, runs: Option<u64>) -> Result<Self, UntilError> {
        runs.map_or(Ok(()), |runs| positive("first_look", runs))?;
        Ok(self.looked_at_from(runs))
    }

    fn looked_at_from(self, runs: Option<u64>) -> Self {
        Self { first_look: runs.map(|runs| runs.min(self.most_runs)), ..self }
    }

    /// After how many runs the first look is, if that is said.
    #[must_use]
    pub fn first_look(&self) -> Option<u64> {
        self.first_look
    }

    /// After how many runs the looks are.
    pub fn looks(&self) -> impl Iterator<Item = u64> {
        let (every, most) = (self.look_every, self.most_runs);
        let next = move |look: &u64| {
            let more = (look / 10 / every).max(1).saturating_mul(every);
            (*look < most).then(|| look.saturating_add(more).min(most))
        };
        std::iter::successors(Some(self.first_look.unwrap_or(every).min(most)), next)
    }
}

impl StoppingRule {
    /// The number whose mean is to be known, if one is.
    #[must_use]
    pub fn quantity(&self) -> Option<&Measured> {
        match self {
            Self::Decided | Self::Share(_) => None,
            Self::Mean(quantity, _) => Some(quantity),
        }
    }

    /// Whether it asks about requirements, so that there must be some.
    #[must_use]
    pub fn needs_requirements(&self) -> bool {
        match self {
            Self::Decided | Self::Share(_) => true,
            Self::Mean(..) => false,
        }
    }

    /// What makes that it keeps its risk, in words.
    #[must_use]
    pub fn reason(&self) -> &'static str {
        match self {
            Self::Decided => {
                "The rule is a sequential test by a mixture of likelihoods (Robbins 1970), which keeps the stated risk however often \
                 the runs are looked at"
            }
            Self::Share(_) => {
                "The intervals are a confidence sequence (Robbins 1970), which holds at all looks together with the stated confidence"
            }
            Self::Mean(..) => {
                "A mean is taken once its 95 % interval is narrow enough (Chow & Robbins 1965), which covers the true mean as often \
                 as it says if the runs are many"
            }
        }
    }
}

impl fmt::Display for StoppingRule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Decided => f.write_str(DECIDED),
            // By the digits, so that 0.001 is 0.1 % and reads back to the bit.
            Self::Share(within) => match format!("{within}e2").parse::<f64>() {
                Ok(percent) if of_percent(percent) == *within => {
                    write!(f, "{SHARE} {WITHIN} {percent} %")
                }
                Ok(_) | Err(_) => write!(f, "{SHARE} {WITHIN} {within}"),
            },
            Self::Mean(quantity, within) => {
                write!(f, "{MEAN}({quantity}) {WITHIN} {}", plain(*within))
            }
        }
    }
}

const DECIDED: &str = "decided";
const SHARE: &str = "share";
const MEAN: &str = "mean";
const WITHIN: &str = "within";

impl FromStr for StoppingRule {
    type Err = UntilError;

    fn from_str(text: &str) -> Result<Self, UntilError> {
        let refused = || UntilError::Rule { text: text.to_owned() };
        let mut words = Words::new(text);
        let rule = if words.take(DECIDED) {
            Self::Decided
        } else if words.take(MEAN) {
            if !words.take("(") {
                return Err(refused());
            }
            let quantity = Measured::parse(&mut words).map_err(|_| refused())?;
            if !(words.take(")") && words.take(WITHIN)) {
                return Err(refused());
            }
            let within = words.number().ok_or_else(refused)?;
            FixedWidth::new(within, Confidence::default()).map_err(|_| refused())?;
            Self::Mean(quantity, within)
        } else if words.take(SHARE) && words.take(WITHIN) {
            let within = words.share().map_err(|_| refused())?;
            if !(within > 0.0 && within < 0.5) {
                return Err(refused());
            }
            Self::Share(within)
        } else {
            return Err(refused());
        };
        words.end().map_err(|_| refused())?;
        Ok(rule)
    }
}

impl TryFrom<String> for StoppingRule {
    type Error = UntilError;

    fn try_from(text: String) -> Result<Self, UntilError> {
        text.parse()
    }
}

impl From<StoppingRule> for String {
    fn from(rule: StoppingRule) -> Self {
        rule.to_string()
    }
}

impl TryFrom<Form> for Until {
    type Error = UntilError;

    fn try_from(form: Form) -> Result<Self, UntilError> {
        let Form { rule, first_look, look_every, most_runs } = form;
        Self::new(rule, look_every, most_runs)?.with_first_look(first_look)
    }
}

impl From<Until> for Form {
    fn from(until: Until) -> Self {
        let Until { rule, first_look, look_every, most_runs } = until;
        Self { rule, first_look, look_every, most_runs }
    }
}

fn positive(field: &'static str, runs: u64) -> Result<(), UntilError> {
    if runs == 0 { Err(UntilError::None { field }) } else { Ok(()) }
}

/// Why a rule is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum UntilError {
    /// The line is none.
    #[error(
        "“{text}”: it must be “decided”, “share within 0.1 %” with a share between 0 and 50 %, or “mean(x) within 0.02” with the \
         name of a column for x and a positive number"
    )]
    Rule {
        /// The line.
        text: String,
    },
    /// A number of runs is 0.
    #[error("{field} = 0: it must be at least 1")]
    None {
        /// Which.
        field: &'static str,
    },
}

#[cfg(test)]
mod tests;
