//! `gyradius report`: the report of a study made again, or of one whose runs are put together now.

use gyradius_campaign::threads;
use gyradius_study::{Notice, Options, Status, is_begun, put_together, replacement, write_report};
use std::{
    error::Error,
    path::{Path, PathBuf},
    process::ExitCode,
};

use crate::program::{
    args::ReportArgs, output::print, replay::DEFAULT, status::UNFINISHED, study::notice,
};

/// Runs the verb.
pub(crate) fn report(arguments: &ReportArgs) -> Result<ExitCode, Box<dyn Error>> {
    let folder = arguments.study.as_deref().unwrap_or(Path::new(DEFAULT));
    if let Some(replacement) = replacement(folder)? {
        notice(Notice::Replacement(replacement));
    }
    if !is_begun(folder)? {
        let written = write(folder, arguments)?;
        if Status::read(folder).is_ok_and(|status| status.drivers_left) {
            notice(Notice::DriversLeft);
        }
        print(&format!("report: {}\n", written.join("report.html").display()))?;
        return Ok(ExitCode::SUCCESS);
    }
    let study = put_together(folder, &Options::default(), &notice)?;
    if arguments.out.is_some() {
        write(folder, arguments)?;
    }
    print(&study.to_string())?;
    Ok(if study.is_complete() { ExitCode::SUCCESS } else { ExitCode::from(UNFINISHED) })
}

fn write(folder: &Path, arguments: &ReportArgs) -> Result<PathBuf, Box<dyn Error>> {
    let out = arguments.out.as_deref();
    Ok(threads(None)?.install(|| write_report(folder, out, arguments.force))?)
}
