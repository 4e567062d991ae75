//! Why a run failed.

/// The status of a run that did not fail.
pub(crate) const OK: &str = "ok";

/// Why a run failed: told in `status`, and counted by its kind.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    kind: String,
    message: String,
}

impl Failure {
    /// A failure of a kind, which has no numbers, with its message. A kind `ok` or an empty one, which would be taken
    /// for a run that did not fail, is `failed`.
    pub fn new(kind: impl Into<String>, message: impl Into<String>) -> Self {
        let kind = Some(kind.into()).filter(|kind| !kind.is_empty() && kind != OK);
        Self { kind: kind.unwrap_or_else(|| "failed".to_owned()), message: message.into() }
    }

    /// What kind it is, without numbers, so that failures of a kind can be counted.
    #[must_use]
    pub fn kind(&self) -> &str {
        &self.kind
    }

    /// What went wrong.
    #[must_use]
    pub fn message(&self) -> &str {
        &self.message
    }
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.message)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_failure_looks_like_success() {
        for kind in [OK, ""] {
            let failure = Failure::new(kind, "spring 6");
            assert_eq!((failure.kind(), failure.message()), ("failed", "spring 6"));
        }
        assert_eq!(Failure::new("okay", "").kind(), "okay");
    }
}
