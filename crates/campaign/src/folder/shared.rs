//! A folder that several processes fill with blocks of runs at the same time, each with its share.

use std::{
    path::{Path, PathBuf},
    thread,
    time::Duration,
};

use super::{Contents, Folder, FolderError, Problem, hidden::Hidden};

/// How often and how long others are waited for that hold the folder alone for a moment.
const TRIES: u32 = 500;
const WAIT: Duration = Duration::from_millis(20);

/// A folder whose lock is shared with other processes that fill it. Those who put a campaign together want it alone, and
/// are refused meanwhile.
#[derive(Debug)]
pub struct Shared {
    pub(super) what: &'static str,
    pub(super) place: PathBuf,
    pub(super) hidden: Hidden,
}

impl Shared {
    /// Checks that the campaign may go to `place` and can be written there, and shares the folder with others who do the
    /// same.
    ///
    /// # Errors
    /// The folder holds something else, cannot be written, or somebody has it alone.
    pub fn open(place: &Path, contents: &Contents<'_>) -> Result<Self, FolderError> {
        // Alone if nobody else is there.
        match Folder::prepare(place, contents, false) {
            Ok(folder) => folder.leave(),
            Err(FolderError { problem: Problem::Busy, .. }) => {}
            Err(error) => return Err(error),
        }
        let failed = |problem: Problem| FolderError { path: place.to_owned(), problem };
        for _ in 0..TRIES {
            super::make_folder(place).map_err(failed)?;
            match Hidden::share(place) {
                Err(Problem::Busy) => thread::sleep(WAIT),
                Err(problem) => return Err(failed(problem)),
                Ok(hidden) => {
                    // Asked again: who was there meanwhile may have put something else in place.
                    let still = hidden.record(contents.what).and_then(|(record, _)| {
                        super::check(hidden.place(), contents, &record, false)
                    });
                    still.map_err(failed)?;
                    let (what, place) = (contents.what, place.to_owned());
                    return Ok(Self { what, place, hidden });
                }
            }
        }
        Err(failed(Problem::Busy))
    }
}
