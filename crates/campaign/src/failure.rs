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
    /// A failure of a kind, which has no numbers, with its message. Neither may be `ok` or empty, with or without blanks
    /// around it, because whoever reads the table would take the run for one that did not fail: such a kind is `failed`,
    /// and such a message is the kind.
    pub fn new(kind: impl Into<String>, message: impl Into<String>) -> Self {
        let told = |text: &String| !matches!(text.trim(), "" | OK);
        let kind = Some(kind.into()).filter(told).unwrap_or_else(|| "failed".to_owned());
        let message = Some(message.into()).filter(told).unwrap_or_else(|| kind.clone());
        Self { kind, message }
    }

    /// Whether a number in the row of a run that failed is taken for what the run came to. An infinite one is, so that it is not left out
    /// with the runs that came to nothing. Any other may be a draw, or what was reached before the failure.
    pub(crate) fn has_number(number: f64) -> bool {
        number.is_infinite()
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
        for nothing in [OK, "", " ", " ok", "ok\t", "\nok\r\n"] {
            let failure = Failure::new(nothing, "spring 6");
            assert_eq!((failure.kind(), failure.message()), ("failed", "spring 6"));
            let failure = Failure::new("low", nothing);
            assert_eq!((failure.kind(), failure.message()), ("low", "low"));
            let failure = Failure::new(nothing, nothing);
            assert_eq!((failure.kind(), failure.message()), ("failed", "failed"));
        }
        for told in ["okay", "OK", "not ok", " o k "] {
            let failure = Failure::new(told, told);
            assert_eq!((failure.kind(), failure.message()), (told, told));
        }
    }
}
