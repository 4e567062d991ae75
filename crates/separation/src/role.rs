//! Which of the two bodies.

/// One of the two bodies of a separation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Role {
    /// What is pushed off.
    Payload,
    /// What it sits on.
    Stage,
}

impl Role {
    /// Payload and stage.
    pub const BOTH: [Self; 2] = [Self::Payload, Self::Stage];

    /// `payload` or `stage`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Payload => "payload",
            Self::Stage => "stage",
        }
    }
}

impl std::fmt::Display for Role {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}
