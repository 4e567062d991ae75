//! `gyradius draw`: what is drawn for the runs of a scenario, for other programs; for robots see `draw_robot`.

use gyradius_formats::NewFile;
use gyradius_study::{
    AnyScenario, CampaignError, Draw, DrawError, DrawOptions, FormatError, LawFile,
};
use std::{
    error::Error,
    io::{self, IsTerminal, Write},
    path::Path,
    process::ExitCode,
};

use crate::program::{
    args::DrawArgs,
    doubts::tell_doubts,
    draw_output::{format, refuse_input},
    draw_robot::{draw_robot, is_robot},
    output::{complain, file_of},
    progress,
    signals::Signals,
    study::scenario,
};

/// Runs the verb.
pub(crate) fn draw(arguments: &DrawArgs) -> Result<ExitCode, Box<dyn Error>> {
    if let Some(robot) = arguments.scenario.as_deref().filter(|path| is_robot(path)) {
        return draw_robot(arguments, robot);
    }
    if arguments.stated.is_given() || !arguments.links.is_empty() || arguments.inside.is_some() {
        if arguments.scenario.as_deref() == Some(Path::new("-")) {
            return Err("-: a robot is not read from standard input: write it into a file first, as with `xacro arm.xacro -o arm.urdf`".into());
        }
        if let Some(path) =
            arguments.scenario.as_deref().filter(|path| path.exists() && !path.is_file())
        {
            let path = path.display();
            return Err(format!("{path}: it is not a regular file, and a robot is only read from one: write it into a file first").into());
        }
        return Err("--mass, --centre, --moments, --axes, --sigmas, --links and --inside are for robots (URDF, MJCF, SDF): a scenario \
                    says itself what is uncertain"
            .into());
    }
    let file = file_of(arguments.output.as_deref());
    let format = format(arguments, file)?;
    let input = input(arguments)?;
    let signals = Signals::watch()?;
    let options = DrawOptions {
        models: arguments.models.clone(),
        first: arguments.first,
        runs: arguments.runs,
        threads: arguments.threads,
        format,
        stop: Some(signals.stop()),
    };
    let draw = match &input {
        Input::Scenario(AnyScenario::Separation(scenario)) => Draw::new(scenario, &options)?,
        Input::Scenario(AnyScenario::Simulator(scenario)) => {
            Draw::of_simulator(scenario, &options)?
        }
        Input::Laws(laws) => Draw::of_laws(laws, &options)?,
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

/// What draws come from.
enum Input {
    Scenario(AnyScenario),
    Laws(Box<LawFile>),
}

/// Reads it, and says what there is to doubt in it.
fn input(arguments: &DrawArgs) -> Result<Input, Box<dyn Error>> {
    let path = arguments.scenario.as_deref();
    let Some(laws) = path.map(LawFile::read).transpose()?.flatten() else {
        let scenario = scenario(path, arguments.seed)?;
        tell_doubts(&scenario, scenario.off_nominal(), str::to_owned);
        return Ok(Input::Scenario(scenario));
    };
    if !arguments.models.is_empty() {
        return Err("--model is for scenarios: a file of laws alone has no models".into());
    }
    let laws = match arguments.seed {
        Some(seed) => laws.with_seed(seed)?,
        None => laws,
    };
    let scenario = AnyScenario::Simulator(Box::new(laws.scenario().clone()));
    tell_doubts(&scenario, laws.off_nominal(), |doubt| laws.in_its_words(doubt));
    Ok(Input::Laws(Box::new(laws)))
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
