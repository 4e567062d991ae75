//! The scenario of a study that was begun in a folder, and whose runs are not all done, or not put together.

use gyradius_campaign::{Identity, Manifest, begun, restore};
use std::path::Path;

use crate::{ResultsError, contents::identity, subject::Subject};

/// The scenario, if such a study is there. Beside a complete study that is another one, it is not the study of the folder yet.
///
/// # Errors
/// The scenario cannot be read, or its runs were begun by another version.
pub(crate) fn unfinished<C: Subject>(folder: &Path) -> Result<Option<C>, ResultsError> {
    restore(folder)?;
    let (Some(there), Some(text)) = (Identity::begun(folder), begun(folder)) else {
        return Ok(None);
    };
    if Manifest::read(folder).is_ok_and(|all| all.identity().difference(&there).is_some()) {
        return Ok(None);
    }
    let scenario = C::resolved(&text)?;
    match identity(&scenario).difference(&there) {
        None => Ok(Some(scenario)),
        Some(difference) => Err(ResultsError::Study {
            path: folder.to_owned(),
            problem: format!(
                "its runs, which are not put together yet, were begun otherwise than this program would: {difference}"
            ),
        }),
    }
}
