//! Why a link has no inertia of which a file says the numbers that count.

use std::fmt;

/// Why a link has no inertia of which a file says the numbers that count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum WithoutInertia {
    /// The file has none for it.
    NotStated,
    /// The simulator computes it from the shapes (`auto="true"` in SDF), whatever numbers stand there.
    Computed,
}

impl fmt::Display for WithoutInertia {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotStated => "no inertia in the file",
            Self::Computed => {
                "its inertia is computed from shapes by the simulator (auto=\"true\")"
            }
        })
    }
}
