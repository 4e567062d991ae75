//! `gyradius status`: what of a study is there.

use gyradius_study::Status;
use std::{error::Error, fmt::Write, path::Path, process::ExitCode};

use crate::program::{
    args::StatusArgs,
    output::{print, print_json},
    quote::quote_path,
    replay::DEFAULT,
};

/// What the program returns while runs are missing.
pub(crate) const UNFINISHED: u8 = 1;
/// Ranges of missing runs that are told of a study; the rest is counted.
const MOST: usize = 20;

/// Runs the verb.
pub(crate) fn status(arguments: &StatusArgs) -> Result<ExitCode, Box<dyn Error>> {
    let folder = arguments.study.as_deref().unwrap_or(Path::new(DEFAULT));
    let status = Status::read(folder)?;
    if arguments.json {
        print_json(&serde_json::to_string_pretty(&status)?)?;
    } else {
        print(&text(&status, folder))?;
    }
    Ok(if status.complete { ExitCode::SUCCESS } else { ExitCode::from(UNFINISHED) })
}

fn text(status: &Status, folder: &Path) -> String {
    let of = status.runs_per_model;
    let widest = status.models.iter().map(|model| model.model.chars().count());
    let width = widest.max().unwrap_or(0).max("model".len());
    let mut text = format!("{}: {of} runs a model\n\n", status.scenario);
    // Writing to a string does not fail.
    let _ =
        writeln!(text, "{:width$}  {:>12}  {:>12}  {:>12}", "model", "done", "missing", "failed");
    for model in &status.models {
        let (name, done, failed) = (&model.model, model.finished, model.failed);
        let missing = of.saturating_sub(done);
        let _ = writeln!(text, "{name:width$}  {done:>12}  {missing:>12}  {failed:>12}");
    }
    text.push('\n');
    let missing = &status.missing;
    if status.complete {
        text.push_str("All runs are done and put together.\n");
        if status.drivers_left {
            text.push_str(
                "What drives the outcome is not found yet: `gyradius study` with the scenario finds it in this folder.\n",
            );
        }
    } else if let Some(changed) = &status.changed {
        let _ = writeln!(text, "The study is not complete: {changed}.");
    } else if missing.is_empty() {
        let _ = writeln!(
            text,
            "All runs are done. `gyradius report {}` puts them together.",
            quote_path(folder)
        );
    } else {
        text.push_str("These runs are missing:\n");
        for runs in missing.iter().take(MOST) {
            let _ = writeln!(text, "  {runs}");
        }
        if missing.len() > MOST {
            let _ = writeln!(text, "  and {} more ranges", missing.len() - MOST);
        }
    }
    if let Some(replacement) = &status.replacement {
        let _ = writeln!(text, "Note: {replacement}.");
    }
    text
}
