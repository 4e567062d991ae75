//! `gyradius draw`: what is drawn for the runs of a scenario, for other programs.

use gyradius_formats::NewFile;
use gyradius_study::{
    AnyScenario, CampaignError, Draw, DrawError, DrawOptions, FormatError, TableFormat,
};
use std::{
    error::Error,
    fs,
    io::{self, IsTerminal, Write},
    path::Path,
    process::ExitCode,
};

use crate::program::{
    args::DrawArgs, output::complain, progress, signals::Signals, study::scenario,
};

/// Runs the verb.
pub(crate) fn draw(arguments: &DrawArgs) -> Result<ExitCode, Box<dyn Error>> {
    let file = arguments.output.as_deref().filter(|path| *path != Path::new("-"));
    let format = format(arguments, file)?;
    let scenario = scenario(arguments.scenario.as_deref(), arguments.seed)?;
    let signals = Signals::watch()?;
    let options = DrawOptions {
        models: arguments.models.clone(),
        first: arguments.first,
        runs: arguments.runs,
        threads: arguments.threads,
        format,
        stop: Some(signals.stop()),
    };
    let draw = match &scenario {
        AnyScenario::Separation(scenario) => Draw::new(scenario, &options)?,
        AnyScenario::Simulator(scenario) => Draw::of_simulator(scenario, &options)?,
    };
    let written = match file {
        Some(path) => {
            if let Some(input) = &arguments.scenario {
                refuse_input(path, input)?;
            }
            to_file(&draw, path, arguments.force)
        }
        None => to_standard_output(&draw),
    };
    match written {
        Err(error) if is_stopped(error.as_ref()) => {
            complain("stopped");
            Ok(signals.code())
        }
        other => other.map(|()| ExitCode::SUCCESS),
    }
}

/// The form that was asked for, or that of the extension of the file.
fn format(arguments: &DrawArgs, file: Option<&Path>) -> Result<TableFormat, String> {
    let format = match (arguments.format, file) {
        (Some(format), _) => format,
        (None, None) => TableFormat::default(),
        (None, Some(path)) => TableFormat::of_path(path).ok_or_else(|| {
            let known = TableFormat::ALL.iter().flat_map(|format| format.extensions());
            let known: Vec<String> = known.map(|extension| format!(".{extension}")).collect();
            format!(
                "{}: the extension tells no format, as {} do: --format says it",
                path.display(),
                known.join(", ")
            )
        })?,
    };
    if file.is_none() && !format.is_text() && io::stdout().is_terminal() {
        return Err(format!(
            "{} is not for the screen: -o names a file, or a pipe leads to another program",
            format.name()
        ));
    }
    Ok(format)
}

/// The scenario is not written over, whatever is forced.
pub(crate) fn refuse_input(path: &Path, scenario: &Path) -> Result<(), String> {
    match (fs::canonicalize(path), fs::canonicalize(scenario)) {
        (Ok(output), Ok(input)) if output == input => {
            Err(format!("{} is the scenario: it is not written over", path.display()))
        }
        _ => Ok(()),
    }
}

fn to_file(draw: &Draw<'_>, path: &Path, force: bool) -> Result<(), Box<dyn Error>> {
    let mut file = NewFile::create(path, force)?;
    let written = progress::show(draw.steps(), "runs", |report| draw.write(&mut file, report));
    written.map_err(|error| match error {
        DrawError::Output(error) => format!("cannot write {}: {error}", path.display()).into(),
        other => Box::<dyn Error>::from(other),
    })?;
    Ok(file.finish()?)
}

/// A reader that reads no further, as `head` does, has what it wanted.
fn to_standard_output(draw: &Draw<'_>) -> Result<(), Box<dyn Error>> {
    let mut out = io::stdout();
    let written = if out.is_terminal() {
        // A bar would stand between the lines.
        draw.write(&mut out, &|_| {})
    } else {
        progress::show(draw.steps(), "runs", |report| draw.write(&mut out, report))
    };
    let written = written.and_then(|()| Ok(out.flush().map_err(FormatError::from)?));
    match written {
        Err(DrawError::Output(FormatError::Io(error)))
            if error.kind() == io::ErrorKind::BrokenPipe =>
        {
            Ok(())
        }
        Err(DrawError::Output(error)) => Err(format!("standard output: {error}").into()),
        other => Ok(other?),
    }
}

/// Whether a signal ended it.
fn is_stopped(error: &(dyn Error + 'static)) -> bool {
    matches!(error.downcast_ref::<DrawError>(), Some(DrawError::Campaign(CampaignError::Stopped)))
}
