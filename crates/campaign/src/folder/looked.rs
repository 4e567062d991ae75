//! Whether a rule looked at the runs of a campaign: whoever goes on with them counts all looks.

use super::{Folder, FolderError, Problem, area::Area, blocks::Blocks, told::manifest};
use crate::{
    identity::Identity,
    requirement::{Counting, Looks},
};

impl Blocks {
    /// Tells that a rule looks at the runs while they are done, before it does: verdicts on them count all looks from then on.
    ///
    /// # Errors
    /// That cannot be written.
    pub fn looked_at(&self) -> Result<(), FolderError> {
        let told = self.area.tell_looked();
        told.map_err(|problem| FolderError { path: self.place.clone(), problem })
    }

    /// Tells those who go on with the campaign, in the text from which they do, what was only found out after it was begun.
    ///
    /// # Errors
    /// That cannot be written.
    pub fn begun_as(&self, mark: &str) -> Result<(), FolderError> {
        let told = self.area.tell(mark, None);
        told.map_err(|problem| FolderError { path: self.place.clone(), problem })
    }
}

impl Folder<'_> {
    /// How verdicts count the runs of the campaign of an identity that is in the folder, complete or not; as those that nobody has looked
    /// at, if there is none.
    ///
    /// # Errors
    /// The folder cannot be read.
    pub fn counting(&self, identity: &Identity) -> Result<Counting, FolderError> {
        let there = || -> Result<Counting, Problem> {
            let (place, record) = (self.hidden.place(), self.hidden.record(self.contents.what)?.0);
            let complete = manifest(place, &record, identity)?;
            let complete = complete.map(|manifest| manifest.counting()).unwrap_or_default();
            let area = Area::of(place);
            let is_same =
                area.identity()?.is_some_and(|there| identity.difference(&there).is_none());
            let is_looked_at = is_same && area.is_looked_at();
            Ok(if is_looked_at { complete.looked_at(Looks::Often) } else { complete })
        };
        there().map_err(|problem| self.failed(problem))
    }
}
