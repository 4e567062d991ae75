//! The scenario of a study that was begun in a folder, and whose runs are not all done, or not put together.

use gyradius_campaign::{FolderError, Identity, begun, replacing, restore};
use std::path::Path;

use crate::{ResultsError, contents::identity, subject::Subject};

/// The text of the scenario, if such a study is there. Beside a complete study that it is to replace, it is not the study of the folder
/// yet.
///
/// # Errors
/// Whether there is one cannot be read.
pub fn begun_study(folder: &Path) -> Result<Option<String>, FolderError> {
    Ok(if replacing(folder)?.is_none() { begun(folder)? } else { None })
}

/// What there is to say of a study that was begun in a folder to replace the one that is there, if there are two.
///
/// # Errors
/// Whether there are two cannot be read.
pub fn replacement(folder: &Path) -> Result<Option<String>, FolderError> {
    let replacing = replacing(folder)?;
    Ok(replacing.map(|difference| {
        format!(
            "the folder also holds runs of another study, which is to replace this one once they are all done: {difference}. To go on \
             with the other study, run it again and pass --force; to drop its runs, run this one and pass --force"
        )
    }))
}

/// The scenario, if such a study is there.
///
/// # Errors
/// The scenario cannot be read, or its runs were begun by another version.
pub(crate) fn unfinished<C: Subject>(folder: &Path) -> Result<Option<C>, ResultsError> {
    restore(folder)?;
    let (Some(there), Some(text)) = (Identity::begun(folder)?, begun_study(folder)?) else {
        return Ok(None);
    };
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
