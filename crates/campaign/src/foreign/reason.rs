//! Words in the column `status` of a run table that say nothing of why a run failed.

use super::written::number;
use crate::failure::OK;

/// Words by which other programs say that a run ended well.
const WELL: [&str; 16] = [
    OK,
    "okay",
    "success",
    "successful",
    "succeeded",
    "pass",
    "passed",
    "done",
    "complete",
    "completed",
    "finished",
    "converged",
    "nominal",
    "valid",
    "good",
    "no error",
];

/// Why a status that is not `ok` cannot be that of a run that failed, if it cannot: nothing stands there, or a number, or what other
/// programs write of a run that ended. No study writes any of them.
pub(super) fn no_reason(status: Option<&str>) -> Option<String> {
    let status = status.unwrap_or_default();
    let word = status.trim().trim_end_matches(['.', '!']).trim_end().to_lowercase();
    (number(&word).is_some() || WELL.contains(&word.as_str())).then(|| {
        format!(
            "{status:?}, which does not say whether the run ended: it must be {OK:?}, or words that say why the run failed; give the column another name if \
             it says something else"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reasons_are_told_from_words_that_are_none() {
        for word in [
            "", " ", "OK", "Ok ", "ok.", "0", "1", "-3.5", "true", "FALSE", "nan", "None", "-",
            "#N/A", "Success", "done!",
        ] {
            let told = no_reason(Some(word)).unwrap();
            assert!(told.starts_with(&format!("{word:?}, which does not say")), "{told}");
        }
        assert!(no_reason(None).is_some());
        for word in [
            "no contact",
            "failed",
            "spring 6 of the payload: not released",
            "simulator: 404",
            "not ok",
            "diverged",
            "error 3",
            "timeout",
        ] {
            assert_eq!(no_reason(Some(word)), None, "{word}");
        }
    }
}
