//! What is kept of run tables once a campaign is complete.

use serde::{Deserialize, Serialize};
use std::{collections::BTreeSet, fmt};

use crate::{
    column::Column,
    table::{Source, Table},
};

/// Which rows of run tables are kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Rows {
    /// All.
    #[default]
    All,
    /// Those of runs that failed.
    Failed,
    /// None.
    None,
}

impl Rows {
    /// All choices.
    pub const ALL: [Self; 3] = [Self::All, Self::Failed, Self::None];

    /// What it is called in files and flags.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::Failed => "failed",
            Self::None => "none",
        }
    }

    /// What it means, in a few words.
    #[must_use]
    pub fn meaning(self) -> &'static str {
        match self {
            Self::All => "One row a run",
            Self::Failed => "Rows of the runs that failed",
            Self::None => "No rows: summary, figures and report alone",
        }
    }

    /// Whether it is `all`.
    #[must_use]
    #[allow(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
    pub fn is_all(&self) -> bool {
        *self == Self::All
    }
}

/// What is kept of run tables once a campaign is complete. Until then every row is on the disk whole: what the runs amount to is
/// found in several passes over them.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Kept {
    rows: Rows,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    columns: Option<Vec<String>>,
}

impl Kept {
    /// These rows, in these columns or in all. The columns that say which run a row is and how it ended are always kept.
    #[must_use]
    pub fn new(rows: Rows, columns: Option<Vec<String>>) -> Self {
        let [model, run, status] = Column::first();
        let own = [model, run, status, Column::status_kind()];
        let is_own = |name: &String| own.iter().any(|column| column.name() == name);
        // In a form that does not depend on how they were named.
        let columns = columns.map(|names| {
            let others = names.into_iter().filter(|name| !is_own(name));
            others.collect::<BTreeSet<_>>().into_iter().collect()
        });
        Self { rows, columns }
    }

    /// Whether everything is kept.
    #[must_use]
    pub fn is_all(&self) -> bool {
        self.rows.is_all() && self.columns.is_none()
    }

    /// Which rows.
    #[must_use]
    pub fn rows(&self) -> Rows {
        self.rows
    }

    /// Which columns, if not all.
    #[must_use]
    pub fn columns(&self) -> Option<&[String]> {
        self.columns.as_deref()
    }

    /// That all columns that are named are columns of a run table, which has these.
    ///
    /// # Errors
    /// One is not.
    pub fn check(&self, columns: &[Column]) -> Result<(), KeptError> {
        let is_known = |name: &&String| columns.iter().any(|column| column.name() == name.as_str());
        match self.columns.iter().flatten().find(|name| !is_known(name)) {
            None => Ok(()),
            Some(name) => Err(KeptError {
                column: name.clone(),
                known: columns.iter().map(|column| column.name().to_owned()).collect(),
            }),
        }
    }

    /// The columns of a table that are kept.
    #[must_use]
    pub fn kept_columns<'t>(&self, table: &'t Table) -> Vec<&'t Column> {
        self.columns_of(table).into_iter().map(|(column, _)| column).collect()
    }

    /// The columns of a table that are kept, with what they are filled from.
    pub(crate) fn columns_of<'t>(&self, table: &'t Table) -> Vec<(&'t Column, Source)> {
        let all = table.sources();
        let named = |name: &str| match &self.columns {
            None => true,
            Some(columns) => columns.iter().any(|column| column == name),
        };
        let stays = |column: &Column, source: Source| match source {
            Source::Model | Source::Run | Source::Status | Source::StatusKind => true,
            Source::Value(_) => named(column.name()),
            // Kinds go with their texts, and may be named alone.
            Source::Kind(place) => {
                named(column.name()) || named(table.of_simulation()[place].name())
            }
        };
        all.filter(|(column, source)| stays(column, *source)).collect()
    }

    /// The places of the runs of a table that are kept.
    pub(crate) fn places_of(&self, table: &Table) -> Vec<usize> {
        match self.rows {
            Rows::All => (0..table.len()).collect(),
            Rows::Failed => table.failures.keys().copied().collect(),
            Rows::None => Vec::new(),
        }
    }
}

/// As in a scenario, in one line.
impl fmt::Display for Kept {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "rows: {}", self.rows.name())?;
        match &self.columns {
            Some(columns) => write!(f, ", columns: {}", columns.join(", ")),
            None => Ok(()),
        }
    }
}

/// A column that is to be kept and that no run table has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{column:?}: the run table has no such column; its columns are {}", known.join(", "))]
pub struct KeptError {
    column: String,
    known: Vec<String>,
}
