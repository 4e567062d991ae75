//! What the folder of a campaign says of a run table in it.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use crate::{
    folder::{MANIFEST, Manifest, RUNS},
    kept::Rows,
    requirement::Counting,
};

/// What the folder of a campaign says of a run table in it.
#[derive(Clone, Debug)]
pub(crate) struct Origin {
    /// The file that says it.
    pub(crate) manifest: PathBuf,
    pub(crate) counting: Counting,
    /// The rows that were kept of the runs.
    pub(crate) rows: Rows,
}

impl Origin {
    /// Of a file in `runs/MODEL` of a campaign's folder, or of that folder of the model; none elsewhere.
    pub(crate) fn of(table: &Path) -> io::Result<Option<Self>> {
        let whole = fs::canonicalize(table)?;
        // From the table up to `runs`.
        let up = if whole.is_dir() { 1 } else { 2 };
        let runs = whole.ancestors().nth(up);
        if runs.and_then(Path::file_name).is_none_or(|name| name != RUNS) {
            return Ok(None);
        }
        let Some(folder) = whole.ancestors().nth(up + 1) else { return Ok(None) };
        // As the user calls it, where that names the same folder.
        let named = table.ancestors().nth(up + 1).filter(|named| !named.as_os_str().is_empty());
        let is_same = |named: &&Path| fs::canonicalize(named).is_ok_and(|named| named == folder);
        let folder = named.filter(is_same).unwrap_or(folder);
        let manifest = folder.join(MANIFEST);
        if !manifest.exists() {
            return Ok(None);
        }
        let read = Manifest::read(folder).map_err(|error| {
            io::Error::other(format!(
                "{}, which says how its runs are judged: {error}",
                manifest.display()
            ))
        })?;
        Ok(Some(Self { manifest, counting: read.counting(), rows: read.kept().rows() }))
    }
}
