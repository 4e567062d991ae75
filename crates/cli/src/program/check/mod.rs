//! `gyradius check`: which files, what is said of them, and the exit code.

mod json;
mod report;
mod table;

use gyradius_formats::{Found, InertiaFile, Products, find};
use gyradius_study::restore_studies;
use std::{
    fs, io,
    path::{Path, PathBuf},
    process::ExitCode,
};

use crate::program::{
    REFUSED, STANDARD_INPUT,
    args::{CheckArgs, Form},
    output::{complain, print, print_json},
    progress,
};
use report::{Finding, Report, Status};

/// Runs the verb.
pub(crate) fn check(arguments: &CheckArgs) -> ExitCode {
    let (inputs, paths): (Vec<_>, Vec<_>) =
        arguments.paths.iter().cloned().partition(|path| path.as_os_str() == STANDARD_INPUT);
    if !inputs.is_empty() && arguments.repair.is_some() {
        complain("standard input: --repair writes beside a file, and there is none");
        return ExitCode::from(REFUSED);
    }
    // A study that was killed while it replaced another may have put files aside.
    for path in &paths {
        if let Err(error) = restore_studies(path) {
            complain(harmless(&error.to_string()));
            return ExitCode::from(REFUSED);
        }
    }
    let (mut found, errors) = find(&paths);
    let mut report = Report::default();
    errors.iter().for_each(|error| report.refuse(error));
    let mut originals: Vec<PathBuf> =
        found.iter().filter_map(|found| fs::canonicalize(&found.path).ok()).collect();
    originals.sort_unstable();
    // Once, however often it is named.
    found.extend(inputs.into_iter().take(1).map(|path| Found { path, named: true }));
    let products =
        if arguments.flip_products { Products::Integrals } else { Products::TensorEntries };
    progress::show(found.len() as u64, "files", |done| {
        for (count, found) in found.iter().enumerate() {
            let path = &found.path;
            let read = if path.as_os_str() == STANDARD_INPUT {
                InertiaFile::read_from(path, io::stdin().lock(), products)
            } else {
                InertiaFile::read(path, products)
            };
            report.add(found, read, arguments, &originals);
            done(count as u64 + 1);
        }
    });
    report.finish(&arguments.paths);
    let printed = text(&report, arguments).and_then(|text| match arguments.format {
        Form::Text => print(&text),
        Form::Json => print_json(&text),
    });
    if arguments.format == Form::Text {
        for refused in &report.refused {
            let at = refused
                .line
                .map_or(refused.path.display().to_string(), |line| place(&refused.path, line));
            complain(harmless(&format!("{at}: {}", refused.message)));
        }
        for (path, error) in &report.repair_errors {
            complain(harmless(&format!("{}: not repaired: {error}", path.display())));
        }
    }
    match printed {
        Err(error) => {
            complain(error);
            ExitCode::from(REFUSED)
        }
        Ok(()) => ExitCode::from(report.exit_code()),
    }
}

/// The report in the form that was asked for.
fn text(report: &Report, arguments: &CheckArgs) -> Result<String, String> {
    let mut out = Vec::new();
    match arguments.format {
        Form::Text => table::write(&mut out, report, arguments),
        Form::Json => json::write(&mut out, report, arguments),
    }
    .and_then(|()| String::from_utf8(out).map_err(io::Error::other))
    .map_err(|error| error.to_string())
}

/// The text without characters by which a file could command the terminal, in one line.
fn harmless(text: &str) -> String {
    gyradius_study::visible(text).replace(['\n', '\t'], "\u{fffd}")
}

fn place(path: &Path, line: usize) -> String {
    format!("{}:{line}", path.display())
}
