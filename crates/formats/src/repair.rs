//! Copies of files in which impossible inertias are possible: what changes, and how they are written.

use gyradius_inertia::{InertiaMatrix, Repair, RepairMethod};
use nalgebra::Matrix3;
use std::{
    collections::HashSet,
    ffi::OsString,
    fs::{self, Permissions},
    io,
    path::{Path, PathBuf},
};

use crate::{
    FileBody, InertiaFile, MassFault, TOLERANCE, WriteError,
    body::Reading,
    edit::{Edit, edited},
    judge::{judge, with_flipped_products},
    plain::write_file_as,
};

/// How far inside the boundary a repaired inertia lies, as a part of its trace: enough that
/// programs which compare exactly, or read fewer digits, accept it too.
const INSET: f64 = 1e-9;

/// Digits of a repaired number, which move it by less than [`INSET`].
const DIGITS: usize = 11;

/// What becomes of an inertia that no body has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Remedy {
    /// The nearest that a body has: the least change of the entries in the Frobenius norm.
    #[default]
    Nearest,
    /// The same with the signs of its products flipped, or the nearest to that: right where the file
    /// holds positive integrals in place of tensor entries.
    FlipProducts,
}

/// What a copy changes of one body.
#[derive(Clone, Debug)]
pub struct Change {
    name: String,
    line: usize,
    remedy: Remedy,
    before: Matrix3<f64>,
    after: Matrix3<f64>,
    edits: Vec<Edit>,
}

impl Change {
    /// Name of the body.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its line, from 1.
    #[must_use]
    pub fn line(&self) -> usize {
        self.line
    }

    /// How its inertia was changed.
    #[must_use]
    pub fn remedy(&self) -> Remedy {
        self.remedy
    }

    /// The inertia in the file, in kg·m², products as tensor entries.
    #[must_use]
    pub fn before(&self) -> &Matrix3<f64> {
        &self.before
    }

    /// The inertia in the copy, in kg·m², products as tensor entries.
    #[must_use]
    pub fn after(&self) -> &Matrix3<f64> {
        &self.after
    }

    /// The Frobenius norm of the difference, in kg·m².
    #[must_use]
    pub fn distance_kg_m2(&self) -> f64 {
        norm(&(self.after - self.before))
    }

    /// The same in percent of the norm of the inertia in the file.
    #[must_use]
    pub fn distance_percent(&self) -> f64 {
        100.0 * (self.distance_kg_m2() / norm(&self.before))
    }
}

/// The Frobenius norm, without squares that overflow or vanish.
fn norm(matrix: &Matrix3<f64>) -> f64 {
    let size = matrix.amax();
    if size > 0.0 { size * matrix.map(|x| x / size).norm() } else { size }
}

/// Why a file could not be repaired.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RepairError {
    /// A number that must change is not in the file.
    #[error(
        "line {line}: \"{name}\": an entry that must change is not written in the file, or not as a \
         plain number"
    )]
    NoPlace {
        /// The body.
        name: String,
        /// Its line.
        line: usize,
    },
    /// The inertia is beyond computing with.
    #[error("line {line}: \"{name}\": its inertia is too large or too small to be computed with")]
    OutOfRange {
        /// The body.
        name: String,
        /// Its line.
        line: usize,
    },
    /// Inertia on no mass, or on a negative one: the mass may be what is wrong.
    #[error("line {line}: \"{name}\": {fault}, and the mass may be what is wrong")]
    NoMass {
        /// The body.
        name: String,
        /// Its line.
        line: usize,
        /// What is wrong with the mass.
        fault: MassFault,
    },
    /// The nearest inertia is that of a point.
    #[error(
        "line {line}: \"{name}\": the nearest inertia that a body can have is 0, 0, 0, which is none"
    )]
    NothingLeft {
        /// The body.
        name: String,
        /// Its line.
        line: usize,
    },
    /// A copy is there already, and is another one.
    #[error("{} exists: --force replaces it", .0.display())]
    Exists(PathBuf),
    /// A folder, a link, a pipe or a device is there.
    #[error("{} is not a regular file, and is neither followed nor replaced", .0.display())]
    NoFile(PathBuf),
    /// The copy has the name of a file that is being checked.
    #[error("{} is itself being checked, and originals are never written over", .0.display())]
    Original(PathBuf),
    /// The copy reads back as something else than was meant.
    #[error("the copy does not read back: nothing was written")]
    ReadsBackWrong,
    /// The system does not take it.
    #[error("{} cannot be written: {error}", .path.display())]
    Io {
        /// The copy.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
}

impl RepairError {
    /// Line of the body, from 1, if it is one that cannot be repaired.
    #[must_use]
    pub fn line(&self) -> Option<usize> {
        match self {
            Self::NoPlace { line, .. }
            | Self::OutOfRange { line, .. }
            | Self::NoMass { line, .. }
            | Self::NothingLeft { line, .. } => Some(*line),
            Self::Exists(_)
            | Self::NoFile(_)
            | Self::Original(_)
            | Self::ReadsBackWrong
            | Self::Io { .. } => None,
        }
    }
}

/// The nearest realizable inertia, a little inside the boundary and in few digits.
fn repaired(matrix: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    let symmetric = matrix.zip_map(&matrix.transpose(), |a, b| 0.5 * a + 0.5 * b);
    // Where only entries across the diagonal differ, nothing else need change.
    if is_realizable(&symmetric) {
        return Some(symmetric);
    }
    let symmetric = InertiaMatrix::new(symmetric).ok()?;
    let near = *Repair::new(&symmetric, RepairMethod::Nearest).ok()?.inertia().matrix();
    let inset = near + Matrix3::from_diagonal_element(2.0 * INSET * near.trace());
    let rounded = inset.map(|x| format!("{x:.*e}", DIGITS - 1).parse().unwrap_or(x));
    [rounded, inset, near].into_iter().find(is_realizable)
}

fn is_realizable(matrix: &Matrix3<f64>) -> bool {
    InertiaMatrix::new(*matrix).is_ok_and(|matrix| matrix.is_realizable())
}

impl InertiaFile {
    /// What a copy would change of the body of this index: nothing if it can have its inertia, or
    /// if that could not be read.
    ///
    /// # Errors
    /// A number that must change is not in the file, or out of range, or nothing would be left, or the body has no mass.
    pub fn change(&self, index: usize, remedy: Remedy) -> Result<Option<Change>, RepairError> {
        let Some(body) = self.bodies().get(index) else { return Ok(None) };
        body.reading().map(|reading| change(body, reading, remedy)).transpose()
    }

    /// The bytes of a copy in which the bodies of these indices have a realizable inertia, and
    /// everything else is as it was.
    ///
    /// # Errors
    /// As [`change`](Self::change), or the copy does not read back.
    pub fn repaired(&self, bodies: &[(usize, Remedy)]) -> Result<Vec<u8>, RepairError> {
        let mut edits: Vec<Edit> = Vec::new();
        for (index, remedy) in bodies {
            edits.extend(self.change(*index, *remedy)?.into_iter().flat_map(|change| change.edits));
        }
        let copy = edited(&self.bytes, &self.offsets, edits).ok_or(RepairError::ReadsBackWrong)?;
        self.reads_back(&copy, bodies)?;
        Ok(copy)
    }

    /// Whether a copy holds the same bodies, those of these indices realizable.
    fn reads_back(&self, copy: &[u8], bodies: &[(usize, Remedy)]) -> Result<(), RepairError> {
        let indices: HashSet<usize> = bodies.iter().map(|(index, _)| *index).collect();
        let again = self.reread(copy.to_vec()).map_err(|_| RepairError::ReadsBackWrong)?;
        let same = again.bodies().len() == self.bodies().len()
            && self.bodies().iter().zip(again.bodies()).enumerate().all(|(i, (before, after))| {
                if indices.contains(&i) {
                    after.inertia().is_ok_and(is_realizable) && before.name() == after.name()
                } else {
                    before == after || before.inertia() == after.inertia()
                }
            });
        if same { Ok(()) } else { Err(RepairError::ReadsBackWrong) }
    }
}

/// The numbers of a body that must change, and what they become.
fn change(body: &FileBody, reading: &Reading, remedy: Remedy) -> Result<Change, RepairError> {
    let (name, line) = (body.name().to_owned(), body.line());
    if let Some(fault) = judge(&reading.matrix, reading.mass_kg, TOLERANCE).mass_fault() {
        return Err(RepairError::NoMass { name, line, fault });
    }
    // In the units of the file, so that what is written has few digits.
    let old = &reading.matrix.map(|x| x / reading.unit);
    let start = match remedy {
        Remedy::Nearest => *old,
        Remedy::FlipProducts => with_flipped_products(old),
    };
    let target = if is_realizable(&start) {
        start
    } else {
        let Some(new) = repaired(&start) else {
            return Err(RepairError::OutOfRange { name, line });
        };
        // Entries that are right to rounding stay as they are written, if the whole then is right.
        let rounding = 0.1 * INSET * new.amax();
        let kept =
            new.zip_map(&start, |new, old| if (new - old).abs() <= rounding { old } else { new });
        if is_realizable(&kept) { kept } else { new }
    };
    if target == Matrix3::zeros() && *old != target {
        return Err(RepairError::NothingLeft { name, line });
    }
    let mut edits: Vec<Edit> = Vec::new();
    for i in 0..3 {
        for j in 0..3 {
            let value = target[(i, j)];
            if value == old[(i, j)] {
                continue;
            }
            let Some(place) = reading.places[i][j] else {
                return Err(RepairError::NoPlace { name, line });
            };
            let written = if i == j { value } else { reading.products.sign() * value };
            // Both halves of a matrix of which the file holds one.
            if edits.iter().all(|(other, _)| other.start != place.start) {
                edits.push((place, format!("{written:?}")));
            }
        }
    }
    let after = target * reading.unit;
    Ok(Change { name, line, remedy, before: reading.matrix, after, edits })
}

/// Where the repaired copy of a file goes: `robot.urdf` becomes `robot.repaired.urdf`.
#[must_use]
pub fn copy_path(path: &Path) -> PathBuf {
    let mut name = path.file_stem().map(OsString::from).unwrap_or_default();
    name.push(".repaired");
    if let Some(extension) = path.extension() {
        name.push(".");
        name.push(extension);
    }
    path.with_file_name(name)
}

/// Whether a file has the name of a repaired copy.
#[must_use]
pub fn is_copy(path: &Path) -> bool {
    path.file_stem()
        .is_some_and(|stem| Path::new(stem).extension().is_some_and(|e| e == "repaired"))
}

/// Writes a repaired copy, whole or not at all. What is there is replaced with `force` only, and
/// never a file of `originals`; a link is neither followed nor replaced. Returns whether anything
/// had to be written.
///
/// # Errors
/// Something else is there, or the system refuses.
pub fn write_copy(
    copy: &Path,
    bytes: &[u8],
    originals: &[PathBuf],
    force: bool,
) -> Result<bool, RepairError> {
    write(copy, bytes, originals, force, None)
}

/// As [`write_copy`], of the file `original`: who may read and write it may the copy.
///
/// # Errors
/// As there, and the original is gone.
pub fn write_copy_of(
    original: &Path,
    copy: &Path,
    bytes: &[u8],
    originals: &[PathBuf],
    force: bool,
) -> Result<bool, RepairError> {
    let metadata =
        fs::metadata(original).map_err(|error| RepairError::Io { path: copy.to_owned(), error })?;
    write(copy, bytes, originals, force, Some(metadata.permissions()))
}

fn write(
    copy: &Path,
    bytes: &[u8],
    originals: &[PathBuf],
    force: bool,
    permissions: Option<Permissions>,
) -> Result<bool, RepairError> {
    if let Ok(canonical) = fs::canonicalize(copy)
        && originals.contains(&canonical)
    {
        return Err(RepairError::Original(copy.to_owned()));
    }
    write_file_as(copy, bytes, force, permissions).map_err(|error| match error {
        WriteError::Exists(path) => RepairError::Exists(path),
        WriteError::NoFile(path) => RepairError::NoFile(path),
        WriteError::Io { path, error } => RepairError::Io { path, error },
    })
}
