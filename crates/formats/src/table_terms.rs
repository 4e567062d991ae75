//! What holds for all rows of a table, which a cell may say again but not change.

/// What the columns of a table say of all its rows.
#[derive(Debug, Default)]
pub(crate) struct TableTerms {
    /// What the inertia is about.
    pub(crate) point: InertiaPoint,
}

/// The point that the inertia of a row is about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum InertiaPoint {
    /// The mass centre of the row.
    #[default]
    MassCentre,
    /// The origin, as beside first moments.
    Origin,
}
