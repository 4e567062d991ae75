//! `gyradius rollup`: a list of parts, and what they are together.

mod json;
mod text;

use gyradius_campaign::threads;
use gyradius_formats::{MAX_BYTES, NewFile, PartsFile, PartsTable, read_text};
use gyradius_study::{CampaignError, Rollup, RollupDraws, RollupError, RollupOptions, TableFormat};
use std::{error::Error, path::Path, process::ExitCode};

use crate::program::{
    args::{Form, RollupArgs},
    draw_output::{format_of, refuse_input},
    output::{complain, print, print_json},
    progress,
    signals::Signals,
};

/// What is said of a part that may be a total.
const LIKE_A_TOTAL: &str = "it has the mass and the mass centre of other rows together; if it is their total, it is counted \
                            twice, and must be left out";

/// What there is to show.
struct Shown<'a> {
    arguments: &'a RollupArgs,
    table: &'a PartsTable,
    rollup: &'a Rollup,
    draws: Option<&'a RollupDraws>,
}

/// Runs the verb.
pub(crate) fn rollup(arguments: &RollupArgs) -> Result<ExitCode, Box<dyn Error>> {
    let format = arguments.output.as_deref().map(format_of).transpose()?;
    let table = read(arguments)?;
    let rollup = threads(arguments.threads)?.install(|| Rollup::new(&table));
    let rollup = rollup.map_err(|error| named(arguments, error.file(), &error))?;
    let signals = Signals::watch()?;
    let options = RollupOptions {
        draws: arguments.draws,
        seed: arguments.seed,
        threads: arguments.threads,
        stop: Some(signals.stop()),
    };
    let drawn = match (&arguments.output, format) {
        (Some(path), Some(format)) => to_file(&rollup, &options, path, format, arguments).map(Some),
        _ if arguments.draws == 0 => Ok(None),
        _ => progress::show(arguments.draws, "draws", |report| rollup.draw(&options, report))
            .map(Some)
            .map_err(Into::into),
    };
    let drawn = match drawn {
        Err(error) if is_stopped(error.as_ref()) => {
            complain("stopped");
            return Ok(signals.code());
        }
        other => other?,
    };
    let shown = Shown { arguments, table: &table, rollup: &rollup, draws: drawn.as_ref() };
    match arguments.format {
        Form::Text => print(&text::text(&shown))?,
        Form::Json => print_json(&json::text(&shown)?)?,
    }
    Ok(ExitCode::SUCCESS)
}

fn read(arguments: &RollupArgs) -> Result<PartsTable, String> {
    let text = |path: &Path| {
        read_text(path, MAX_BYTES as u64).map_err(|error| format!("{}: {error}", path.display()))
    };
    let (path, products) = (&arguments.parts, arguments.products.map(Into::into));
    let parts = text(path)?;
    let table = match &arguments.edges {
        None => PartsTable::read(parts.as_bytes(), products),
        Some(edges) => PartsTable::with_edges(parts.as_bytes(), text(edges)?.as_bytes(), products),
    };
    table.map_err(|error| named(arguments, error.file(), &error))
}

/// An error with the file that it is in.
fn named(arguments: &RollupArgs, file: PartsFile, error: &dyn Error) -> String {
    let path = match (file, &arguments.edges) {
        (PartsFile::Edges, Some(edges)) => edges,
        (PartsFile::Parts | PartsFile::Edges, _) => &arguments.parts,
    };
    format!("{}: {error}", path.display())
}

fn to_file(
    rollup: &Rollup,
    options: &RollupOptions,
    path: &Path,
    format: TableFormat,
    arguments: &RollupArgs,
) -> Result<RollupDraws, Box<dyn Error>> {
    let inputs = [Some(&arguments.parts), arguments.edges.as_ref()];
    for input in inputs.into_iter().flatten() {
        refuse_input(path, input)?;
    }
    let mut file = NewFile::create(path, arguments.force)?;
    let written = progress::show(options.draws, "draws", |report| {
        rollup.draw_to(options, format, &mut file, report)
    });
    let drawn = written.map_err(|error| match error {
        RollupError::Output(error) => format!("cannot write {}: {error}", path.display()).into(),
        other => Box::<dyn Error>::from(other),
    })?;
    file.finish()?;
    Ok(drawn)
}

/// Whether a signal ended it.
fn is_stopped(error: &(dyn Error + 'static)) -> bool {
    matches!(
        error.downcast_ref::<RollupError>(),
        Some(RollupError::Campaign(CampaignError::Stopped))
    )
}
