//! What the folder of a campaign says of a run table in it.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use crate::{
    folder::{Block, MANIFEST, Manifest, RUNS, damaged},
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
    /// The folder of the campaign.
    folder: PathBuf,
    /// The blocks of the table, as it says.
    pub(crate) blocks: Vec<Block>,
}

impl Origin {
    /// The files of the table that are gone or not as they were written.
    pub(crate) fn damaged(&self) -> io::Result<Vec<PathBuf>> {
        Ok(damaged(&self.folder, &self.blocks)?.iter().map(|name| self.folder.join(name)).collect())
    }

    /// Whether a file of the table is one that it tells of.
    pub(crate) fn has(&self, file: &Path) -> bool {
        self.blocks.iter().any(|block| Path::new(&block.name()).file_name() == file.file_name())
    }

    /// Why there is no run table at a place: what was found, and, where a study that it is in kept no rows, or few, that.
    pub(crate) fn why_none(table: &Path, found: String) -> String {
        let mut folders = table.ancestors().filter(|folder| !folder.as_os_str().is_empty()).take(4);
        let study =
            folders.find_map(|folder| Some((folder, Manifest::read(folder).ok()?.kept().rows())));
        match study {
            Some((folder, rows)) if !rows.is_all() => format!(
                "{found}; the study in {} kept rows = \"{}\" of its run tables, and its report and summary.json hold its verdicts",
                folder.display(),
                rows.name()
            ),
            Some(_) | None => found,
        }
    }

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
        // Of one that cannot be looked at, what it says is not known.
        if fs::symlink_metadata(&manifest).is_err_and(|e| e.kind() == io::ErrorKind::NotFound) {
            return Ok(None);
        }
        let read = match Manifest::read(folder) {
            Err(_) if is_of_another(&manifest) => return Ok(None),
            Err(error) => {
                let manifest = manifest.display();
                let problem = format!("{manifest}, which says how its runs are judged: {error}");
                return Err(io::Error::other(problem));
            }
            Ok(read) => read,
        };
        let (counting, rows) = (read.counting(), read.kept().rows());
        // The table is the folder of a model, or one file in it.
        let end = |up: usize| whole.ancestors().nth(up).and_then(Path::file_name);
        let model = end(up - 1).and_then(|name| name.to_str()).unwrap_or_default();
        let of_table = |block: &&Block| {
            block.has_file() && (up == 1 || Path::new(&block.name()).file_name() == end(0))
        };
        let blocks = read.blocks_of(model).into_iter().filter(of_table).cloned().collect();
        Ok(Some(Self { manifest, counting, rows, folder: folder.to_owned(), blocks }))
    }
}

/// Whether a file that is called as that of a campaign is another program's: JSON that says something, and no version of gyradius.
fn is_of_another(manifest: &Path) -> bool {
    let told = fs::read(manifest).ok().and_then(|text| serde_json::from_slice(&text).ok());
    told.is_some_and(|told: serde_json::Value| {
        told.get("gyradius_version").is_none() && told != serde_json::json!({})
    })
}
