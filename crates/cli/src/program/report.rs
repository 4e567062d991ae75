//! `gyradius report`: the report of a study made again.

use gyradius_study::Results;
use std::{error::Error, path::Path};

use crate::program::{args::ReportArgs, output::print, replay::DEFAULT};

/// Runs the verb.
pub(crate) fn report(arguments: &ReportArgs) -> Result<(), Box<dyn Error>> {
    let study = arguments.study.as_deref().unwrap_or(Path::new(DEFAULT));
    let folder = Results::read(study)?.write_report(arguments.out.as_deref(), arguments.force)?;
    Ok(print(&format!("report: {}\n", folder.join("report.html").display()))?)
}
