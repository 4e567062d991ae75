//! The columns of a run table: what they are called, what they hold, what they mean.

use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Whole numbers below this are exact as numbers with a fraction, 2⁵³.
const MOST_EXACT: f64 = 9_007_199_254_740_992.0;

/// A column of a [`Table`](crate::Table).
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    name: Cow<'static, str>,
    kind: Kind,
    unit: Option<Cow<'static, str>>,
    meaning: Cow<'static, str>,
    optional: bool,
    kinds: bool,
}

/// What is told of a column in a file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ColumnSummary {
    /// Its name in the table.
    pub column: String,
    /// Its unit, of numbers that have one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// What it means, in a sentence.
    pub meaning: String,
}

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Numbers, stored bit for bit.
    Number,
    /// Whole numbers.
    Integer,
    /// Text.
    Text,
    /// Yes or no.
    Flag,
}

impl Column {
    /// The run that a number in the column [`RUN`](Self::RUN) names, if it names one.
    #[must_use]
    pub fn run_named(number: f64) -> Option<u64> {
        (number.fract() == 0.0 && (0.0..MOST_EXACT).contains(&number)).then_some(number as u64)
    }

    /// The column of the name of the model, in every table.
    pub const MODEL: &str = "model";

    /// The column of the number of the run, in every table.
    pub const RUN: &str = "run";

    /// Numbers in a unit, `1` if they have none.
    pub fn number(
        name: impl Into<Cow<'static, str>>,
        unit: impl Into<Cow<'static, str>>,
        meaning: impl Into<Cow<'static, str>>,
    ) -> Self {
        Self { unit: Some(unit.into()), ..Self::new(name, Kind::Number, meaning) }
    }

    /// A column without a unit, which some runs may have nothing in.
    pub fn new(
        name: impl Into<Cow<'static, str>>,
        kind: Kind,
        meaning: impl Into<Cow<'static, str>>,
    ) -> Self {
        Self {
            name: name.into(),
            kind,
            unit: None,
            meaning: meaning.into(),
            optional: true,
            kinds: false,
        }
    }

    /// The same, which every run has something in.
    #[must_use]
    pub fn required(self) -> Self {
        Self { optional: false, ..self }
    }

    /// The same, of texts that are of kinds: the table gets another column that tells them.
    #[must_use]
    pub fn with_kinds(self) -> Self {
        Self { kinds: self.kind == Kind::Text, ..self }
    }

    pub(crate) fn has_kinds(&self) -> bool {
        self.kinds
    }

    /// The column that tells the kinds of the texts in this one.
    pub(crate) fn kinds(&self) -> Self {
        let meaning = format!("Of which kind `{}` is, without numbers.", self.name);
        let column = Self::new(format!("{}_kind", self.name), Kind::Text, meaning);
        if self.optional { column } else { column.required() }
    }

    /// The column that tells the kinds of failures.
    pub(crate) fn status_kind() -> Self {
        let [_, _, status] = Self::first();
        let meaning = "`ok`, or the kind of the failure, without numbers.".into();
        Self { meaning, ..status.kinds() }
    }

    /// What is told of it.
    #[must_use]
    pub fn summary(&self) -> ColumnSummary {
        ColumnSummary {
            column: self.name.to_string(),
            unit: self.unit.as_deref().map(str::to_owned),
            meaning: self.meaning.to_string(),
        }
    }

    /// Its name in the table.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What it holds.
    #[must_use]
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// Whether a requirement can be about it: it holds numbers, whole numbers or flags.
    #[must_use]
    pub fn is_measured(&self) -> bool {
        match self.kind {
            Kind::Number | Kind::Integer | Kind::Flag => true,
            Kind::Text => false,
        }
    }

    /// Its unit, of numbers that have one.
    #[must_use]
    pub fn unit(&self) -> Option<&str> {
        self.unit.as_deref()
    }

    /// What it means, in a sentence.
    #[must_use]
    pub fn meaning(&self) -> &str {
        &self.meaning
    }

    /// Whether some runs have nothing in it.
    #[must_use]
    pub fn is_optional(&self) -> bool {
        self.optional
    }

    /// The columns that every table begins with.
    pub(crate) fn first() -> [Self; 3] {
        [
            Self::new(Self::MODEL, Kind::Text, "Name of the model.").required(),
            Self::new(Self::RUN, Kind::Integer, "Number of the run, from 0.").required(),
            Self::new("status", Kind::Text, "`ok`, or the reason why the run failed.").required(),
        ]
    }
}
