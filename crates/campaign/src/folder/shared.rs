//! A folder that several processes fill with blocks of runs at the same time, each with its share.

use std::{
    fs, io,
    path::{Path, PathBuf},
    thread,
    time::Duration,
};

use super::{Contents, Folder, FolderError, Problem, area::Area, hidden::Hidden};

/// How often and how long others are waited for that hold the folder alone for a moment.
const TRIES: u32 = 500;
const WAIT: Duration = Duration::from_millis(20);
/// How often a folder is made again that others remove.
const PASSING: u32 = 50;

/// A folder whose lock is shared with other processes that fill it. Those who put a campaign together want it alone, and
/// are refused meanwhile.
#[derive(Debug)]
pub struct Shared {
    pub(super) what: &'static str,
    pub(super) place: PathBuf,
    pub(super) hidden: Hidden,
    /// Whether the folder did not exist before, and whether no campaign was in it.
    is_made: bool,
    is_new: bool,
}

impl Shared {
    /// Checks that the campaign may go to `place` and can be written there, and shares the folder with others who do the
    /// same.
    ///
    /// # Errors
    /// The folder holds something else, cannot be written, or somebody has it alone.
    pub fn open(place: &Path, contents: &Contents<'_>) -> Result<Self, FolderError> {
        let failed = |problem: Problem| FolderError { path: place.to_owned(), problem };
        let is_new = !Hidden::is_in(place).map_err(|refusal| failed(refusal.into()))?;
        let is_made = !place.exists();
        // Alone if nobody else is there.
        match Folder::prepare(place, contents, false) {
            Ok(folder) => folder.leave(),
            Err(FolderError { problem: Problem::Busy, .. }) => {}
            Err(error) if is_passing(&error.problem, place) => {}
            Err(error) => return Err(error),
        }
        // Asked again with the lock: who was there meanwhile may have put something else in place.
        let share = || {
            super::make_folder(place)?;
            let hidden = Hidden::share(place)?;
            let (record, _) = hidden.record(contents.what)?;
            super::check(hidden.place(), contents, &record, false)?;
            Ok(hidden)
        };
        for tries in 0..TRIES {
            match share() {
                Err(Problem::Busy) => thread::sleep(WAIT),
                Err(problem) if tries < PASSING && is_passing(&problem, place) => {
                    thread::sleep(WAIT);
                }
                Err(problem) => return Err(failed(problem)),
                Ok(hidden) => {
                    let (what, place) = (contents.what, place.to_owned());
                    return Ok(Self { what, place, hidden, is_made, is_new });
                }
            }
        }
        Err(failed(Problem::Busy))
    }
}

/// If nobody else is at work there and no block was finished, nobody is bound to a campaign that was refused, or of which this share
/// had no runs: no trace of it stays.
impl Drop for Shared {
    fn drop(&mut self) {
        self.hidden.unlock();
        let Ok(hidden) = Hidden::lock(&self.place) else { return };
        let area = Area::of(&self.place);
        if area.recorded().is_ok_and(|blocks| blocks.is_empty()) && area.clear().is_ok() {
            let hidden = if self.is_new { hidden.made_anew() } else { hidden };
            super::abandon(&hidden, self.is_made);
        }
    }
}

/// Whether a folder that is missing may only have been removed in this moment, by who had done nothing in it.
fn is_passing(problem: &Problem, place: &Path) -> bool {
    use io::ErrorKind::{AlreadyExists, NotFound};
    let is_missing = matches!(problem, Problem::NoFolder)
        || matches!(problem, Problem::Refused(e) if matches!(e.kind(), NotFound | AlreadyExists));
    // Asked once: between two questions it may come and go.
    let may_come = match fs::symlink_metadata(place) {
        Ok(there) => there.is_dir() || there.is_symlink() && place.is_dir(),
        Err(error) => error.kind() == NotFound,
    };
    is_missing && may_come
}
