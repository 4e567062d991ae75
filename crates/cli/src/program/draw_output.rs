//! Where `gyradius draw` writes a table, and in which form.

use gyradius_formats::is_same_file;
use gyradius_study::TableFormat;
use std::{
    io::{self, IsTerminal},
    path::Path,
};

use crate::program::args::DrawArgs;

/// The form that was asked for, or that of the extension of the file.
pub(crate) fn format(arguments: &DrawArgs, file: Option<&Path>) -> Result<TableFormat, String> {
    let format = match (arguments.format, file) {
        (Some(format), _) => format,
        (None, None) => TableFormat::default(),
        (None, Some(path)) => {
            format_of(path).map_err(|error| format!("{error}: --format says it"))?
        }
    };
    if file.is_none() && !format.is_text() && io::stdout().is_terminal() {
        return Err(format!(
            "{} is not for the screen: -o names a file, or a pipe leads to another program",
            format.name()
        ));
    }
    Ok(format)
}

/// The form that the extension of a file tells.
pub(crate) fn format_of(path: &Path) -> Result<TableFormat, String> {
    TableFormat::of_path(path).ok_or_else(|| {
        let known = TableFormat::ALL.iter().flat_map(|format| format.extensions());
        let known: Vec<String> = known.map(|extension| format!(".{extension}")).collect();
        format!("{}: the extension tells no format, as {} do", path.display(), known.join(", "))
    })
}

/// What was read is not written over, whatever is forced.
pub(crate) fn refuse_input(path: &Path, input: &Path) -> Result<(), String> {
    if is_same_file(path, input) {
        return Err(format!("{} is what was read: it is not written over", path.display()));
    }
    Ok(())
}
