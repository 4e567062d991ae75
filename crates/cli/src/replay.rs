//! `gyradius replay`: one run of a study again.

use gyradius_study::{Replay, ReplayError};
use std::{
    io::{self, Write},
    path::Path,
};

use crate::{args::ReplayArgs, output::harmless};

/// Where `gyradius study` writes if nothing else is said.
const DEFAULT: &str = "target/study/peck-2003";

/// Runs the verb.
pub(crate) fn replay(arguments: &ReplayArgs) -> Result<(), ReplayError> {
    let path = arguments.study.as_deref().unwrap_or(Path::new(DEFAULT));
    let model = arguments.model.as_deref();
    let replay = Replay::open(path, model, arguments.run, arguments.coast)?;
    let folder = arguments.out.clone().unwrap_or_else(|| replay.default_folder());
    let files = replay.write(&folder, arguments.force)?;
    let mut text = format!("{replay}\n");
    for file in &files {
        text.push_str(&format!("{}\n", file.display()));
    }
    if files.is_empty() {
        text.push_str("no history: there was no motion\n");
    }
    // Who reads no further, as `head` does, has what they wanted; the files are there.
    let _ = io::stdout().lock().write_all(harmless(&text).as_bytes());
    Ok(())
}
