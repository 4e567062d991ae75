//! The two bodies, and the entries of their inertia matrices.

/// One of the two bodies.
pub(crate) use gyradius_separation::Role as Body;

/// An entry of a symmetric matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names are the entries")]
pub enum Entry {
    I11,
    I22,
    I33,
    I12,
    I13,
    I23,
}

impl Entry {
    /// All six, in the order of the run table.
    pub const ALL: [Self; 6] = [Self::I11, Self::I22, Self::I33, Self::I12, Self::I13, Self::I23];
}
