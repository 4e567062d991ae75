//! A table of samples as inertias.

use gyradius_dispersion::TenParameters;
use gyradius_estimation::TenForm;
use gyradius_formats::{
    FileBody, FileBodyError, FileError, Format, GapKind, InertiaFile, LinkProblem, Products,
    RobotError, RobotFile, TOLERANCE, TenCentre, TenRow, TenTable, TenTableError, judge,
};
use gyradius_inertia::{Inertia, InertiaMatrix, MassProperties, Repair, RepairMethod};
use nalgebra::Matrix3;
use std::{
    collections::{BTreeMap, HashMap},
    error::Error,
    path::Path,
};

/// Parts of a file that were not read, of which an error names no more.
const NAMED: usize = 10;

/// Why a table is not fitted.
#[derive(Debug, thiserror::Error)]
pub(super) enum TableError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Robot(#[from] RobotError),
    #[error("{place}: {error}")]
    Row { place: String, error: FileBodyError },
    #[error(
        "{place}: {reason}\n(sample {index}; {more}--skip-impossible sets such samples aside, \
         `gyradius check` lists them)"
    )]
    Impossible { place: String, index: usize, reason: String, more: String },
    #[error(
        "{place}: the row says {label:?}, and one that sums up others is no sample: it must be left out of the table"
    )]
    Summary { place: String, label: String },
    #[error(
        "{place}: the rows name {count} bodies, and several of them more than once, as {name:?} in {rows} rows: a fit is of samples of one body, \
         so that the rows of one must stand in a table of their own, or, if all rows are of one body, the column of the names have another heading, \
         as \"note\""
    )]
    Bodies { place: String, count: usize, name: String, rows: usize },
    #[error("{place}: {name}: {problem}")]
    Link { place: String, name: String, problem: LinkProblem },
    #[error("{place}: {error}")]
    Ten { place: String, error: TenTableError },
    #[error(
        "{place}: there are no columns of mass and {centre}: a CSV with {names} in its header has them"
    )]
    NoTen { place: String, centre: &'static str, names: String },
    #[error(
        "{place}: its columns are those of a mass centre, and --parameters linear is of first moments m c: \
         the option must be left out, or be natural"
    )]
    NotLinear { place: String },
    #[error(
        "{place}: it has columns of first moments m c: --parameters linear must say that the inertia is \
         about the origin, where they are taken"
    )]
    FirstMoments { place: String },
}

/// The samples of a file.
#[derive(Debug)]
pub(super) struct Table {
    pub(super) samples: Vec<Inertia>,
    /// Where in the file each of them stands, from 1.
    lines: Vec<usize>,
    /// Samples that no body has, set aside.
    pub(super) aside: usize,
    /// Samples moved onto the boundary, which they had left by the rounding of their digits.
    pub(super) rounded: usize,
    /// The same samples with mass and mass centre, if the table has them.
    pub(super) bodies: Option<Vec<MassProperties>>,
    /// The headings of columns of which nothing was taken.
    pub(super) unused: Vec<String>,
    /// What else of the file was not read, though it may hold samples.
    pub(super) unread: Vec<String>,
}

impl Table {
    /// Why the samples are refused: with the line of the sample, where an error is of one, or else with what of the file was left out, for
    /// that may be the samples that are missing.
    pub(super) fn refused(&self, path: &Path, sample: Option<usize>, error: &dyn Error) -> String {
        let file = path.display();
        if let Some(line) = sample.and_then(|index| self.lines.get(index)) {
            return format!("{file}:{line}: {error}");
        }
        let aside = (self.aside > 0).then(|| format!("samples that no body has: {}", self.aside));
        let left_out: Vec<&String> = aside.iter().chain(&self.unread).collect();
        let mut message = format!("{file}: {error}");
        if !left_out.is_empty() {
            message += "; of the file was left out:";
        }
        for one in left_out.iter().take(NAMED) {
            message += &format!("\n  {one}");
        }
        match left_out.len().saturating_sub(NAMED) {
            0 => message,
            more => format!("{message}\n  and {more} more"),
        }
    }
}

/// Reads a table; with mass and mass centre where it has them, or where a form says that it has.
pub(super) fn read(
    path: &Path,
    products: Products,
    form: Option<TenForm>,
    skip: bool,
) -> Result<Table, TableError> {
    let file = InertiaFile::read(path, products)?;
    let place = path.display().to_string();
    // Of which columns nothing was taken is told apart, for a fit reads more of them.
    let is_column = |kind| matches!(kind, GapKind::Things | GapKind::Columns { .. });
    let gaps = file.gaps().iter().filter(|gap| !is_column(gap.kind()));
    let gaps: Vec<String> = gaps.map(|gap| format!("line {}: {gap}", gap.line())).collect();
    let given = match file.format() {
        Format::Urdf | Format::Mjcf | Format::Sdf => of_links(file, &place, form)?,
        Format::Csv | Format::Toml | Format::Json => of_rows(&file, &place, form)?,
    };
    let Given { rows, whole, unused, unread } = given;
    let mut table = Table {
        samples: Vec::with_capacity(rows.len()),
        lines: Vec::with_capacity(rows.len()),
        aside: 0,
        rounded: 0,
        bodies: whole.then(Vec::new),
        unused,
        unread: [gaps, unread].concat(),
    };
    let mut refused: Option<(usize, usize, String)> = None;
    for (index, Row { line, matrix, ten }) in rows.into_iter().enumerate() {
        if let Some(Err(mass)) = ten {
            table.aside += 1;
            refused.get_or_insert((index + 1, line, format!("mass = {mass} kg")));
            continue;
        }
        let of = ten.and_then(Result::ok);
        if let Some(fault) = judge(&matrix, None, TOLERANCE).report().faults().first() {
            table.aside += 1;
            refused.get_or_insert((index + 1, line, fault.to_string()));
            continue;
        }
        let (inertia, moved) = match Inertia::new(matrix) {
            Ok(inertia) => (Some(inertia), 0),
            Err(_) => {
                let nearest = InertiaMatrix::new(matrix)
                    .ok()
                    .and_then(|matrix| Repair::new(&matrix, RepairMethod::Nearest).ok());
                (nearest.map(|repair| *repair.inertia()), 1)
            }
        };
        let whole = |inertia: Inertia| match &of {
            Some(ten) => {
                MassProperties::new(ten.mass_kg, ten.mass_centre_m, inertia).ok().map(Some)
            }
            None => Some(None),
        };
        let Some((inertia, whole)) = inertia.and_then(|inertia| Some((inertia, whole(inertia)?)))
        else {
            table.aside += 1;
            refused.get_or_insert((index + 1, line, "out of range".to_owned()));
            continue;
        };
        table.samples.push(inertia);
        table.lines.push(line);
        table.rounded += moved;
        if let (Some(bodies), Some(whole)) = (&mut table.bodies, whole) {
            bodies.push(whole);
        }
    }
    match refused {
        Some((index, line, reason)) if !skip => {
            let more = match table.aside {
                1 => String::new(),
                n => format!("and {} more; ", n - 1),
            };
            let what =
                if table.bodies.is_some() { "these mass properties" } else { "this inertia" };
            let reason = format!("no body has {what}: {reason}");
            Err(TableError::Impossible { place: format!("{place}:{line}"), index, reason, more })
        }
        _ => Ok(table),
    }
}

/// A sample as a file has it.
#[derive(Clone, Copy, Debug)]
struct Row {
    line: usize,
    /// About the mass centre.
    matrix: Matrix3<f64>,
    /// With mass and mass centre, if the file has them, or the mass that none has.
    ten: Option<Result<TenParameters, f64>>,
}

/// The samples of a file.
#[derive(Debug)]
struct Given {
    rows: Vec<Row>,
    /// Whether each has a mass and a mass centre.
    whole: bool,
    unused: Vec<String>,
    /// Beside the gaps of the file.
    unread: Vec<String>,
}

/// The links of a robot, in their own axes, to which the frames of their inertias are turned.
fn of_links(file: InertiaFile, place: &str, form: Option<TenForm>) -> Result<Given, TableError> {
    if form == Some(TenForm::Linear) {
        return Err(TableError::NotLinear { place: place.to_owned() });
    }
    let robot = RobotFile::try_from(file)?;
    let (mut rows, mut unread) = (Vec::with_capacity(robot.links().len()), Vec::new());
    for link in robot.links() {
        let line = link.line();
        match link.numbers() {
            Ok(numbers) => {
                let inertia = *numbers.inertia();
                let (mass_kg, mass_centre_m) = (numbers.mass_kg(), numbers.mass_centre_m());
                let ten = TenParameters { mass_kg, mass_centre_m, inertia };
                let ten = if mass_kg > 0.0 { Ok(ten) } else { Err(mass_kg) };
                rows.push(Row { line, matrix: *inertia.matrix(), ten: Some(ten) });
            }
            Err(LinkProblem::Body(error)) => {
                return Err(row_error(format!("{place}:{line}"), error));
            }
            // As `gyradius draw`: what nobody means is not passed over.
            Err(problem) if problem.is_a_slip() => {
                let (place, name) = (format!("{place}:{line}"), link.name().to_owned());
                return Err(TableError::Link { place, name, problem: problem.clone() });
            }
            Err(problem) => unread.push(format!("line {line}: {}: {problem}", link.name())),
        }
    }
    let without = robot.links_without_inertia().iter();
    unread.extend(without.map(|name| format!("{name}: {}", robot.why_without(name))));
    unread.extend(robot.overridden_by().map(|told| {
        format!("the compiler says {told}: MuJoCo takes other numbers than those of the bodies")
    }));
    unread.extend(robot.compiler_doubts().iter().map(ToString::to_string));
    Ok(Given { rows, whole: true, unused: Vec::new(), unread })
}

/// The rows of a table, or the bodies of a document.
fn of_rows(file: &InertiaFile, place: &str, form: Option<TenForm>) -> Result<Given, TableError> {
    let (ten, unused) = ten(file, place, form)?;
    let row = |body: &FileBody| {
        let at = || format!("{place}:{}", body.line());
        if let Some(label) = body.summary() {
            return Err(TableError::Summary { place: at(), label: label.to_owned() });
        }
        let mut row = Row {
            line: body.line(),
            matrix: *body.inertia().map_err(|error| row_error(at(), &error))?,
            ten: None,
        };
        if let Some((ten, form)) = &ten {
            let values = ten
                .get(&body.line())
                .ok_or_else(|| row_error(at(), &FileBodyError::Missing { field: "mass" }))?;
            let values = values.as_ref().map_err(|error| row_error(at(), error))?;
            let natural = natural(*values, *form);
            if let (Some(values), TenForm::Linear) = (&natural, form) {
                row.matrix = *values.inertia.matrix();
            }
            row.ten = Some(natural.ok_or(values[0]));
        }
        Ok(row)
    };
    let rows = file.bodies().iter().map(row).collect::<Result<_, _>>()?;
    one_body(file, place)?;
    // Of a CSV, the column is among those of which nothing was taken.
    let has_mass = |body: &&FileBody| file.format() != Format::Csv && body.mass_kg().is_some();
    let unread = file.bodies().iter().find(has_mass).map(|body| {
        let line = body.line();
        format!(
            "line {line}: nothing was taken from mass_kg: masses are fitted with mass centres, which only a CSV or a robot has"
        )
    });
    let unread = unread.into_iter().collect();
    Ok(Given { rows, whole: ten.is_some(), unused, unread })
}

/// That the rows are of one body, or each of another, as a series has them: with names that stand more than once, they are samples of several.
fn one_body(file: &InertiaFile, place: &str) -> Result<(), TableError> {
    let mut rows: BTreeMap<&str, usize> = BTreeMap::new();
    for body in file.bodies().iter().filter(|body| !body.name().is_empty()) {
        *rows.entry(body.name()).or_default() += 1;
    }
    let mut repeated = rows.iter().filter(|(_, rows)| **rows > 1);
    match (repeated.next(), repeated.next()) {
        (Some((name, of_one)), Some(_)) => {
            let (place, count) = (place.to_owned(), rows.len());
            Err(TableError::Bodies { place, count, name: (*name).to_owned(), rows: *of_one })
        }
        (None, _) | (Some(_), None) => Ok(()),
    }
}

fn row_error(place: String, error: &FileBodyError) -> TableError {
    TableError::Row { place, error: error.clone() }
}

/// The ten numbers of each line, and what they are.
type Lines = (HashMap<usize, Result<[f64; 10], FileBodyError>>, TenForm);

/// The lines of a table that has more than inertias, and the columns of it that are not used.
fn ten(
    file: &InertiaFile,
    place: &str,
    form: Option<TenForm>,
) -> Result<(Option<Lines>, Vec<String>), TableError> {
    let place = place.to_owned();
    let table =
        TenTable::of(file).map_err(|error| TableError::Ten { place: place.clone(), error })?;
    let form = match (table.centre(), form) {
        (Some(TenCentre::MassCentre), Some(TenForm::Linear)) => {
            return Err(TableError::NotLinear { place });
        }
        (Some(TenCentre::FirstMoments), None | Some(TenForm::Natural)) => {
            return Err(TableError::FirstMoments { place });
        }
        (Some(TenCentre::MassCentre), _) => Some(TenForm::Natural),
        (Some(TenCentre::FirstMoments), Some(TenForm::Linear)) => Some(TenForm::Linear),
        (None, None) => None,
        (None, Some(form)) => {
            let centre = match form {
                TenForm::Linear => "first moments",
                TenForm::Natural => "mass centre",
            };
            let names = form.columns()[..4].join(",");
            return Err(TableError::NoTen { place, centre, names });
        }
    };
    let of = |row: &TenRow| (row.line(), row.values().copied().map_err(Clone::clone));
    let lines = form.map(|form| (table.rows().iter().map(of).collect(), form));
    Ok((lines, table.unused().to_vec()))
}

/// Mass, mass centre and inertia about it; none of a mass that is not positive.
fn natural(values: [f64; 10], form: TenForm) -> Option<TenParameters> {
    let positive = values[0] > 0.0;
    form.natural(&values.into()).filter(|_| positive)
}
