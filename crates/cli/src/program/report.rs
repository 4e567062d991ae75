//! `gyradius report`: the report of a study made again, or of one whose runs are put together now.

use gyradius_study::{Options, Results, Study, is_begun};
use std::{
    error::Error,
    path::{Path, PathBuf},
    process::ExitCode,
};

use crate::program::{
    args::ReportArgs,
    output::print,
    replay::DEFAULT,
    status::UNFINISHED,
    study::{answer, notice},
};

/// Runs the verb.
pub(crate) fn report(arguments: &ReportArgs) -> Result<ExitCode, Box<dyn Error>> {
    let folder = arguments.study.as_deref().unwrap_or(Path::new(DEFAULT));
    if !is_begun(folder) {
        let written = write(folder, arguments)?;
        print(&format!("report: {}\n", written.join("report.html").display()))?;
        return Ok(ExitCode::SUCCESS);
    }
    let study = Study::put_together(folder, &Options::default(), &notice)?;
    if arguments.out.is_some() {
        write(folder, arguments)?;
    }
    print(&answer(&study))?;
    let complete = study.summary().missing().is_empty();
    Ok(if complete { ExitCode::SUCCESS } else { ExitCode::from(UNFINISHED) })
}

fn write(folder: &Path, arguments: &ReportArgs) -> Result<PathBuf, Box<dyn Error>> {
    Ok(Results::read(folder)?.write_report(arguments.out.as_deref(), arguments.force)?)
}
