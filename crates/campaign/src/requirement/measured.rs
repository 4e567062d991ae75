//! What a requirement is about: a column of numbers, its absolute value, or the length of a vector of columns.

use serde::{Deserialize, Serialize};
use std::{fmt, str::FromStr};

use super::{RequirementError, words::Words};
use crate::table::Table;

/// What a requirement is about. Written, it is `x`, `abs(x)` or `norm(x, y, z)` with names of columns, in quotation marks if they
/// have more than letters, digits, `_`, `.`, `[` and `]`.
///
/// ```
/// use gyradius_campaign::Measured;
///
/// let tip_off: Measured = "norm(w1, w2, w3)".parse()?;
/// assert_eq!(tip_off.of(&[Some(2.0), Some(-3.0), Some(6.0)]), Some(7.0));
/// // A run without one of them has no length.
/// assert_eq!(tip_off.of(&[Some(2.0), None, Some(6.0)]), None);
/// assert_eq!(tip_off.to_string(), "norm(w1, w2, w3)");
/// # Ok::<(), gyradius_campaign::RequirementError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Measured {
    how: How,
    columns: Vec<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum How {
    Itself,
    Absolute,
    Length,
}

impl How {
    const ALL: [Self; 3] = [Self::Itself, Self::Absolute, Self::Length];

    /// The function in front of the columns.
    fn name(self) -> &'static str {
        match self {
            Self::Itself => "",
            Self::Absolute => "abs",
            Self::Length => "norm",
        }
    }
}

impl Measured {
    /// A column itself.
    #[must_use]
    pub fn column(name: &str) -> Self {
        Self { how: How::Itself, columns: vec![name.to_owned()] }
    }

    /// The columns that it is made of.
    #[must_use]
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// The number of a run that has these in its [`columns`](Self::columns), in their order; none if it lacks one. It may be infinite, and
    /// keeps no bound then. A length is infinite if one of them is, whatever the others are.
    #[must_use]
    pub fn of(&self, numbers: &[Option<f64>]) -> Option<f64> {
        let first = || numbers.first().copied().flatten();
        let number = match self.how {
            How::Itself => first(),
            How::Absolute => first().map(f64::abs),
            How::Length if numbers.iter().flatten().any(|x| x.is_infinite()) => Some(f64::INFINITY),
            // Without overflow: a length of 1e300 is one.
            How::Length => numbers.iter().try_fold(0.0, |sum, x| Some(libm::hypot(sum, (*x)?))),
        };
        number.filter(|x| !x.is_nan())
    }

    /// What the runs of a block have of it, as [`of`](Self::of) says.
    #[must_use]
    pub fn numbers(&self, block: &Table) -> Vec<Option<f64>> {
        let columns: Vec<_> = self.columns.iter().map(|name| block.measured(name)).collect();
        let mut of_run = Vec::with_capacity(columns.len());
        let number = |place: usize| {
            of_run.clear();
            of_run.extend(columns.iter().map(|column| column(place)));
            self.of(&of_run)
        };
        (0..block.len()).map(number).collect()
    }

    /// The same of runs whose number is finite.
    #[must_use]
    pub fn finite_numbers(&self, block: &Table) -> Vec<Option<f64>> {
        let numbers = self.numbers(block).into_iter();
        numbers.map(|number| number.filter(|x| x.is_finite())).collect()
    }

    pub(crate) fn parse(words: &mut Words<'_>) -> Result<Self, RequirementError> {
        let name = words.name()?;
        let how = How::ALL.into_iter().find(|how| *how != How::Itself && how.name() == name);
        let Some(how) = how.filter(|_| words.take("(")) else { return Ok(Self::column(&name)) };
        let mut columns = vec![words.name()?];
        while words.take(",") {
            columns.push(words.name()?);
        }
        words.expect(")")?;
        if how == How::Absolute && columns.len() > 1 {
            return Err(words.wrong("abs is of one column, and norm of several"));
        }
        Ok(Self { how, columns })
    }
}

impl FromStr for Measured {
    type Err = RequirementError;

    fn from_str(text: &str) -> Result<Self, RequirementError> {
        let mut words = Words::new(text);
        let measured = Self::parse(&mut words)?;
        words.end()?;
        Ok(measured)
    }
}

impl TryFrom<String> for Measured {
    type Error = RequirementError;

    fn try_from(text: String) -> Result<Self, RequirementError> {
        text.parse()
    }
}

impl From<Measured> for String {
    fn from(measured: Measured) -> Self {
        measured.to_string()
    }
}

impl fmt::Display for Measured {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<String> = self.columns.iter().map(|name| Words::quoted(name)).collect();
        let names = names.join(", ");
        match self.how {
            How::Itself => f.write_str(&names),
            How::Absolute | How::Length => write!(f, "{}({names})", self.how.name()),
        }
    }
}
