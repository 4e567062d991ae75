//! Numbers that are sent to a simulator, and the names that they may have.

use gyradius_campaign::Column;

use crate::ScenarioError;

/// A number that is sent, and what it is where nothing is drawn.
#[derive(Clone, Debug)]
pub(super) struct Number {
    pub(super) column: Column,
    pub(super) nominal: f64,
}

/// Names of bodies, quantities and outputs are keys in JSON and columns.
pub(super) fn check_column(field: &str, name: &str) -> Result<(), ScenarioError> {
    let letters = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let begins = name.starts_with(|c: char| c.is_ascii_alphabetic());
    if begins && name.len() <= 64 && name.chars().all(letters) {
        return Ok(());
    }
    let problem = format!(
        "{name:?}: it must be 1 to 64 letters, digits and underscores, and begin with a letter, for it names a column"
    );
    Err(ScenarioError::field(field, problem))
}
