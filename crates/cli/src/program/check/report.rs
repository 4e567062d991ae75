//! What is said of all files: bodies, what was not read, what was repaired, and the exit code.

use gyradius_formats::{
    Bearing, BodyJudgement, Change, FileBody, FileError, FileProblem, Format, Found, Gap,
    InertiaFile, Note, RealizabilityReport, Remedy, RepairError, copy_path, included_file, judge,
    write_copy_of,
};
use std::{
    cmp::Ordering,
    collections::HashSet,
    fs,
    path::{Path, PathBuf},
};

use crate::program::{
    REFUSED,
    args::{CheckArgs, RepairArg},
};

/// What the program returns when it has found bodies that cannot exist.
const FOUND: u8 = 1;

/// A body, where it stands, and what is to be said of it.
#[derive(Debug)]
pub(super) struct Finding {
    pub(super) path: PathBuf,
    pub(super) format: Format,
    pub(super) body: FileBody,
    pub(super) judgement: Option<BodyJudgement>,
}

/// What a body is counted as, the worst first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Status {
    Impossible,
    NoMass,
    Unread,
    Possible,
}

impl Finding {
    pub(super) fn status(&self) -> Status {
        match &self.judgement {
            None => Status::Unread,
            Some(judgement) if !judgement.report().is_realizable() => Status::Impossible,
            Some(judgement) if judgement.mass_fault().is_some() => Status::NoMass,
            Some(_) => Status::Possible,
        }
    }

    pub(super) fn report(&self) -> Option<&RealizabilityReport> {
        self.judgement.as_ref().map(BodyJudgement::report)
    }

    /// Whether a body could have its inertia with the signs of its products flipped.
    pub(super) fn is_flipped(&self) -> bool {
        self.judgement.as_ref().and_then(BodyJudgement::note) == Some(Note::FlippedProducts)
    }

    /// The worst first; otherwise in the order of the files.
    pub(super) fn order(&self, other: &Self) -> Ordering {
        // Matrices that cannot be computed with are beyond any percentage.
        let excess = |finding: &Self| {
            finding.report().map_or(0.0, |report| report.excess_percent().unwrap_or(f64::INFINITY))
        };
        self.status().cmp(&other.status()).then(excess(other).total_cmp(&excess(self)))
    }
}

/// What was done to one body, and what flipping the signs of its products would do, if that serves
/// and was not done.
#[derive(Debug)]
pub(super) struct Repaired {
    pub(super) change: Change,
    pub(super) proposal: Option<Change>,
}

/// A repaired copy, written or not.
#[derive(Debug)]
pub(super) struct Repair {
    pub(super) original: PathBuf,
    pub(super) copy: PathBuf,
    pub(super) bodies: Vec<Repaired>,
    /// False if the same copy was there already.
    pub(super) written: bool,
}

/// A file that could not be read, as a whole or in a part, though it should have been.
#[derive(Debug)]
pub(super) struct Refused {
    pub(super) path: PathBuf,
    pub(super) line: Option<usize>,
    pub(super) message: String,
    /// False where there was nothing to read.
    pub(super) is_file: bool,
}

/// A file that was not read, as a whole or in a part, and is no error.
#[derive(Debug)]
pub(super) struct Passed {
    pub(super) path: PathBuf,
    pub(super) line: Option<usize>,
    pub(super) reason: String,
    /// Whether there may be bodies in what was not read.
    pub(super) may_hold: bool,
}

/// Keys of a file that mean nothing here.
#[derive(Debug)]
pub(super) struct UnreadKeys {
    pub(super) path: PathBuf,
    /// Of the first.
    pub(super) line: usize,
    pub(super) keys: Vec<String>,
    /// What is said of them.
    pub(super) text: String,
}

/// What is said of all files.
#[derive(Debug, Default)]
pub(super) struct Report {
    /// Files that were read.
    pub(super) files: usize,
    pub(super) bodies: usize,
    pub(super) impossible: usize,
    /// Those of the impossible that are possible with flipped products.
    pub(super) flipped: usize,
    pub(super) no_mass: usize,
    pub(super) unread: usize,
    pub(super) findings: Vec<Finding>,
    pub(super) refused: Vec<Refused>,
    pub(super) passed: Vec<Passed>,
    pub(super) unread_keys: Vec<UnreadKeys>,
    pub(super) repairs: Vec<Repair>,
    pub(super) repair_errors: Vec<(PathBuf, RepairError)>,
}

impl Report {
    /// Adds what became of a file. `originals` are the canonical paths of all files, sorted.
    pub(super) fn add(
        &mut self,
        found: &Found,
        read: Result<InertiaFile, FileError>,
        arguments: &CheckArgs,
        originals: &[PathBuf],
    ) {
        match read {
            Ok(file) => self.add_file(&file, arguments, originals),
            Err(error) if !found.named && error.bearing() != Bearing::Holds => {
                self.passed.push(Passed {
                    path: error.path().to_owned(),
                    line: error.line(),
                    reason: error.problem().to_string(),
                    may_hold: error.bearing() == Bearing::MayHold,
                });
            }
            Err(error) => self.refuse(&error),
        }
    }

    pub(super) fn refuse(&mut self, error: &FileError) {
        self.refused.push(Refused {
            path: error.path().to_owned(),
            line: error.line(),
            message: error.problem().to_string(),
            is_file: !matches!(error.problem(), FileProblem::EmptyFolder),
        });
    }

    /// Says of each path that was given that there is no body in it, if nothing else is said.
    pub(super) fn finish(&mut self, paths: &[PathBuf]) {
        if self.bodies == 0 && self.refused.is_empty() {
            self.refused.extend(paths.iter().map(|path| Refused {
                path: path.clone(),
                line: None,
                message: "no inertia of a body was found".to_owned(),
                is_file: false,
            }));
        }
        self.findings.sort_by(Finding::order);
    }

    fn add_file(&mut self, file: &InertiaFile, arguments: &CheckArgs, originals: &[PathBuf]) {
        self.files += 1;
        self.add_gaps(file, originals);
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
                    self.flipped += usize::from(finding.is_flipped());
                    impossible.push((index, finding.is_flipped()));
                }
                Status::NoMass => self.no_mass += 1,
                Status::Unread => self.unread += 1,
                Status::Possible => {}
            }
            if arguments.all || finding.status() != Status::Possible {
                self.findings.push(finding);
            }
        }
        if let Some(how) = arguments.repair {
            self.repair(file, &impossible, how, originals, arguments.force);
        }
    }

    fn add_gaps(&mut self, file: &InertiaFile, originals: &[PathBuf]) {
        let path = || file.path().to_owned();
        // Included files that are checked themselves are not passed over.
        let is_checked = |name: &String| {
            let found =
                included_file(name, file.path()).and_then(|path| fs::canonicalize(path).ok());
            found.is_some_and(|path| originals.binary_search(&path).is_ok())
        };
        let is_open =
            |gap: &&Gap| gap.files().len() < gap.count() || !gap.files().iter().all(is_checked);
        let open: Vec<&Gap> = file.gaps().iter().filter(is_open).collect();
        if file.bodies().is_empty() && open.is_empty() {
            let reason = "there is no inertia in it".to_owned();
            self.passed.push(Passed { path: path(), line: None, reason, may_hold: false });
        }
        for gap in open {
            let line = Some(gap.line());
            if gap.is_error() {
                let message = gap.to_string();
                self.refused.push(Refused { path: path(), line, message, is_file: true });
            } else if !gap.may_hold_bodies() {
                let (line, keys, text) = (gap.line(), gap.keys().to_vec(), gap.to_string());
                self.unread_keys.push(UnreadKeys { path: path(), line, keys, text });
            } else {
                let reason = gap.to_string();
                self.passed.push(Passed { path: path(), line, reason, may_hold: true });
            }
        }
    }

    /// Repairs what can be; the rest is as it was, and an error each.
    fn repair(
        &mut self,
        file: &InertiaFile,
        impossible: &[(usize, bool)],
        how: RepairArg,
        originals: &[PathBuf],
        force: bool,
    ) {
        let original = file.path().to_owned();
        let (mut remedies, mut bodies) = (Vec::new(), Vec::new());
        for &(index, is_flipped) in impossible {
            let remedy = match how {
                RepairArg::Flip if is_flipped => Remedy::FlipProducts,
                RepairArg::Flip | RepairArg::Nearest => Remedy::Nearest,
            };
            match file.change(index, remedy) {
                Ok(Some(change)) => {
                    remedies.push((index, remedy));
                    let proposal = (is_flipped && remedy == Remedy::Nearest)
                        .then(|| file.change(index, Remedy::FlipProducts));
                    let proposal = proposal.and_then(Result::ok).flatten();
                    bodies.push(Repaired { change, proposal });
                }
                Ok(None) => {}
                Err(error) => self.repair_errors.push((original.clone(), error)),
            }
        }
        if bodies.is_empty() {
            return;
        }
        let copy = copy_path(&original);
        match write(file, &remedies, &copy, originals, force) {
            Ok(written) => self.repairs.push(Repair { original, copy, bodies, written }),
            Err(error) => self.repair_errors.push((original, error)),
        }
    }

    /// How many files were passed over, in whole or in part: those that may hold bodies, or the others.
    pub(super) fn files_passed(&self, may_hold: bool) -> usize {
        let passed = self.passed.iter().filter(|passed| passed.may_hold == may_hold);
        passed.map(|passed| &passed.path).collect::<HashSet<_>>().len()
    }

    /// 2 if what was asked could not be written; 1 if bodies are impossible, whatever else could not be
    /// read; 2 if something could not be read, or nothing was.
    pub(super) fn exit_code(&self) -> u8 {
        if !self.repair_errors.is_empty() {
            REFUSED
        } else if self.impossible > 0 || self.no_mass > 0 {
            FOUND
        } else if self.unread > 0 || !self.refused.is_empty() {
            REFUSED
        } else {
            0
        }
    }
}

fn write(
    file: &InertiaFile,
    remedies: &[(usize, Remedy)],
    copy: &Path,
    originals: &[PathBuf],
    force: bool,
) -> Result<bool, RepairError> {
    let bytes = file.repaired(remedies)?;
    write_copy_of(file.path(), copy, &bytes, originals, force)
}
