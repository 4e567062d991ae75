//! `gyradius check`: which files, what is said of them, and the exit code.

mod json;
mod table;

use gyradius_formats::{
    Body, FileError, Found, InertiaFile, Judgement, Products, RealizabilityReport, RepairError,
    copy_path, find, judge, write_copy,
};
use std::{
    cmp::Ordering,
    fmt::Display,
    fs,
    io::{self, Write},
    path::{Path, PathBuf},
    process::ExitCode,
};

use crate::{
    REFUSED,
    args::{CheckArgs, Form},
    progress,
};

/// What the program returns when it has found bodies that cannot exist.
const FOUND: u8 = 1;

/// A body, where it stands, and what is to be said of it.
#[derive(Debug)]
struct Finding {
    path: PathBuf,
    format: gyradius_formats::Format,
    body: Body,
    judgement: Option<Judgement>,
}

/// What a body is counted as, the worst first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Status {
    Impossible,
    NoMass,
    Unread,
    Possible,
}

impl Finding {
    fn status(&self) -> Status {
        match &self.judgement {
            None => Status::Unread,
            Some(judgement) if !judgement.report().is_realizable() => Status::Impossible,
            Some(judgement) if judgement.mass_fault().is_some() => Status::NoMass,
            Some(_) => Status::Possible,
        }
    }

    fn report(&self) -> Option<&RealizabilityReport> {
        self.judgement.as_ref().map(Judgement::report)
    }

    /// The worst first; otherwise in the order of the files.
    fn order(&self, other: &Self) -> Ordering {
        // Matrices that cannot be computed with are beyond any percentage.
        let excess = |finding: &Self| {
            finding.report().map_or(0.0, |report| report.excess_percent().unwrap_or(f64::INFINITY))
        };
        self.status().cmp(&other.status()).then(excess(other).total_cmp(&excess(self)))
    }
}

/// A repaired copy, written or not.
#[derive(Debug)]
struct Repair {
    original: PathBuf,
    copy: PathBuf,
    bodies: usize,
    /// False if the same copy was there already.
    written: bool,
}

#[derive(Debug, Default)]
struct Report {
    files: usize,
    bodies: usize,
    impossible: usize,
    no_mass: usize,
    unread: usize,
    findings: Vec<Finding>,
    file_errors: Vec<FileError>,
    repairs: Vec<Repair>,
    repair_errors: Vec<(PathBuf, RepairError)>,
}

impl Report {
    fn add(&mut self, file: &InertiaFile, arguments: &CheckArgs, originals: &[PathBuf]) {
        self.files += 1;
        let mut impossible = Vec::new();
        for (index, body) in file.bodies().iter().enumerate() {
            let judgement = body
                .inertia()
                .ok()
                .map(|inertia| judge(inertia, body.mass_kg(), arguments.tolerance));
            let finding = Finding {
                path: file.path().to_owned(),
                format: file.format(),
                body: body.clone(),
                judgement,
            };
            self.bodies += 1;
            match finding.status() {
                Status::Impossible => {
                    self.impossible += 1;
                    impossible.push(index);
                }
                Status::NoMass => self.no_mass += 1,
                Status::Unread => self.unread += 1,
                Status::Possible => {}
            }
            if arguments.all || finding.status() != Status::Possible {
                self.findings.push(finding);
            }
        }
        if arguments.repair {
            self.repair(file, &impossible, originals, arguments.force);
        }
    }

    /// Repairs what can be; the rest is as it was, and an error each.
    fn repair(&mut self, file: &InertiaFile, bodies: &[usize], originals: &[PathBuf], force: bool) {
        let original = file.path().to_owned();
        let mut repairable = Vec::new();
        for &index in bodies {
            match file.repairable(index) {
                Ok(()) => repairable.push(index),
                Err(error) => self.repair_errors.push((original.clone(), error)),
            }
        }
        if repairable.is_empty() {
            return;
        }
        let copy = copy_path(&original);
        let written = file
            .repaired(&repairable)
            .and_then(|bytes| write_copy(&copy, &bytes, originals, force));
        match written {
            Ok(written) => {
                self.repairs.push(Repair { original, copy, bodies: repairable.len(), written });
            }
            Err(error) => self.repair_errors.push((original, error)),
        }
    }

    fn exit_code(&self) -> u8 {
        if self.unread > 0 || !self.file_errors.is_empty() || !self.repair_errors.is_empty() {
            REFUSED
        } else if self.impossible > 0 || self.no_mass > 0 {
            FOUND
        } else {
            0
        }
    }
}

/// Runs the verb.
pub(crate) fn check(arguments: &CheckArgs) -> ExitCode {
    let (found, errors) = find(&arguments.paths);
    let mut report = Report { file_errors: errors, ..Report::default() };
    let originals: Vec<PathBuf> =
        found.iter().filter_map(|found| fs::canonicalize(&found.path).ok()).collect();
    let products =
        if arguments.flip_products { Products::Integrals } else { Products::TensorEntries };
    progress::show(found.len() as u64, "files", |done| {
        for (count, Found { path, named }) in found.iter().enumerate() {
            match InertiaFile::read(path, products) {
                Ok(file) => report.add(&file, arguments, &originals),
                Err(error) if error.is_foreign() && !named => {}
                Err(error) => report.file_errors.push(error),
            }
            done(count as u64 + 1);
        }
    });
    report.findings.sort_by(Finding::order);
    let mut out = io::BufWriter::new(io::stdout().lock());
    let written = match arguments.format {
        Form::Text => table::write(&mut out, &report, arguments),
        Form::Json => json::write(&mut out, &report, arguments),
    };
    if arguments.format == Form::Text {
        for error in &report.file_errors {
            complain(error);
        }
        for (path, error) in &report.repair_errors {
            complain(format_args!("{}: not repaired: {error}", path.display()));
        }
    }
    match written.and_then(|()| out.flush()) {
        // Who reads no further, as `head` does, has what they wanted.
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            eprintln!("error: standard output: {error}");
            ExitCode::from(REFUSED)
        }
        _ => ExitCode::from(report.exit_code()),
    }
}

fn complain(error: impl Display) {
    // Standard error may be closed, which is no reason to stop.
    let _ = writeln!(io::stderr(), "error: {}", harmless(&error.to_string()));
}

/// The text without control characters, which a file could use to command the terminal.
fn harmless(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect()
}

fn place(path: &Path, line: usize) -> String {
    format!("{}:{line}", path.display())
}
