//! Tables of numbers that other programs wrote, a row for each run: Parquet, a folder of Parquet files, or CSV.

mod labels;
mod models;
mod no_runs;
mod of_csv;
mod of_folder;
mod of_parquet;
mod parquet_cells;
mod reason;
mod row_at;
mod run_names;
mod texts;
mod twice;
mod written;

use std::{
    fs::{self, File},
    io::{self, Read},
    path::{Path, PathBuf},
    sync::Arc,
};

use models::Models;
pub use no_runs::NoRunError;
use of_csv::{CsvText, csv_columns, scan_csv};
use of_folder::{Folder, NOT_REGULAR, PARQUET, has_parquet_name};
use of_parquet::{parquet_columns, scan_parquet};
pub use run_names::RunNames;
pub use twice::TwiceError;

use crate::{column::Column, folder::RUNS, kept::Rows, origin::Origin, requirement::Counting};

/// Bytes of a table that is held in memory, at most.
const MOST_HELD: u64 = 1 << 30;

/// A table of numbers that another program wrote, a row for each run. It is read piece by piece, as often as it is scanned.
#[derive(Clone, Debug)]
pub struct ForeignTable {
    path: PathBuf,
    files: Vec<PathBuf>,
    /// What stands beside the files of a folder and may be a table, too.
    beside: Vec<PathBuf>,
    form: Form,
    columns: Vec<String>,
    /// What the folder of the campaign that wrote it says of it, if it is in one.
    origin: Option<Origin>,
    counting: Counting,
}

/// How files begin that hold tables in other forms, as draws are written.
const OTHER_FORMS: [(&[u8], &str); 9] = [
    (b"{\"", "JSON"),
    (b"\x93NUM", "an array of NumPy"),
    (b"PK\x03\x04", "a ZIP archive, as spreadsheets (.xlsx, .ods) and .npz are"),
    (b"\x89HDF", "HDF5"),
    (b"ARRO", "Arrow or Feather"),
    (b"\x1f\x8b", "compressed (gzip)"),
    (b"\x28\xb5\x2f\xfd", "compressed (zstd)"),
    (b"\x80\x04", "a pickle of Python"),
    (b"\x80\x05", "a pickle of Python"),
];

#[derive(Clone, Debug)]
enum Form {
    Parquet,
    Csv {
        /// What stands between the cells.
        separator: u8,
        text: CsvText,
    },
}

/// The numbers of some consecutive rows: of each column, one for each row, none where a cell is empty.
pub type Columns = [Vec<Option<f64>>];

/// The models of some consecutive rows, each as a number that stands for it in this scan; none where a cell is empty, or there is no column
/// `model`.
pub type OfModels = [Option<u64>];

impl ForeignTable {
    /// Opens a file, or a folder of Parquet files of the same columns, which are taken in the order of their names. What begins as Parquet does is
    /// Parquet; all else is CSV, whose first line has the names of the columns, with `,`, `;` or a tab between them.
    ///
    /// # Errors
    /// There is no such file, it is no regular file, its head cannot be read, or files of a folder have other columns than the first.
    pub fn open(path: &Path) -> Result<Self, ForeignError> {
        let failed = |problem: String| ForeignError::new(path, problem);
        let unread = |error: io::Error| failed(error.to_string());
        let found = fs::metadata(path);
        let found = found.map_err(|error| failed(Origin::why_none(path, error.to_string())))?;
        let origin = || Origin::of(path).map_err(unread);
        if found.is_dir() {
            let Folder { files, beside } = Folder::read(path)?;
            let none = || failed(Origin::why_none(path, without_tables(path)));
            let first = files.first().ok_or_else(none)?;
            let (columns, origin) = (parquet_columns(first)?, origin()?);
            // What a study says of its files tells any other from them.
            for file in files.iter().filter(|_| origin.is_none()) {
                let there = parquet_columns(file)?;
                if let Some(problem) = other_columns(&there, (first, &columns)) {
                    return Err(ForeignError::new(file, problem));
                }
            }
            let table = Self::new(path, files, (Form::Parquet, columns), origin);
            return Ok(Self { beside, ..table });
        }
        if !found.is_file() {
            // A pipe has an end only once, and is scanned more often.
            return Err(failed(NOT_REGULAR.to_owned()));
        }
        let files = vec![path.to_owned()];
        let mut start = [0; PARQUET.len()];
        let is_parquet = File::open(path).map_err(unread)?.read_exact(&mut start);
        if is_parquet.is_ok() && start == PARQUET {
            let columns = parquet_columns(path)?;
            return Ok(Self::new(path, files, (Form::Parquet, columns), origin()?));
        }
        for (sign, form) in OTHER_FORMS {
            if start.starts_with(sign) {
                return Err(failed(format!("it is {form}, and CSV and Parquet are read")));
            }
        }
        if has_parquet_name(path) {
            return Err(failed("it does not begin as a Parquet file does".to_owned()));
        }
        let text = CsvText::InFile;
        let (separator, columns) = csv_columns(path, &text)?;
        Ok(Self::new(path, files, (Form::Csv { separator, text }, columns), None))
    }

    /// Reads a CSV table that a source hands out once, such as standard input, and holds it in memory: up to 1 GiB. `name` is what it is
    /// called in messages.
    ///
    /// # Errors
    /// The source cannot be read, hands out more, or a Parquet file, or its first line cannot be read.
    pub fn read_csv(name: &Path, source: impl Read) -> Result<Self, ForeignError> {
        let failed = |problem: String| ForeignError::new(name, problem);
        let mut bytes = Vec::new();
        let read = source.take(MOST_HELD + 1).read_to_end(&mut bytes);
        read.map_err(|error| failed(error.to_string()))?;
        if bytes.len() as u64 > MOST_HELD {
            let problem = "it has more than 1 GiB, which is the most that is held in memory: write the table to a file, and name the file";
            return Err(failed(problem.to_owned()));
        }
        if bytes.starts_with(PARQUET) {
            let problem = "it is a Parquet file, and a table without a name must be CSV: write it to a file, and name the file";
            return Err(failed(problem.to_owned()));
        }
        let text = CsvText::Held(Arc::new(bytes));
        let (separator, columns) = csv_columns(name, &text)?;
        let files = vec![name.to_owned()];
        Ok(Self::new(name, files, (Form::Csv { separator, text }, columns), None))
    }

    fn new(
        path: &Path,
        files: Vec<PathBuf>,
        (form, columns): (Form, Vec<String>),
        origin: Option<Origin>,
    ) -> Self {
        let counting = origin.as_ref().map(|origin| origin.counting).unwrap_or_default();
        let (path, beside) = (path.to_owned(), Vec::new());
        Self { path, files, beside, form, columns, origin, counting }
    }

    /// Files beside those of a folder that may be tables, too, and are not read: CSV, JSON Lines, spreadsheets and the like.
    #[must_use]
    pub fn beside(&self) -> &[PathBuf] {
        &self.beside
    }

    /// That it holds the rows of all runs, as they were written, as far as it is known.
    pub(crate) fn check_rows(&self) -> Result<(), RowsError> {
        self.check(|origin| {
            if !origin.rows.is_all() {
                return Some(RowsProblem::Kept { rows: origin.rows });
            }
            match origin.damaged() {
                Ok(damaged) => damaged.first().map(|first| RowsProblem::Damaged {
                    first: first.clone(),
                    count: damaged.len(),
                    of: origin.blocks.len(),
                }),
                Err(unread) => Some(RowsProblem::Unread { problem: unread.to_string() }),
            }
        })
    }

    /// That it has no other rows than those of the study whose folder it is in.
    pub(crate) fn check_files(&self) -> Result<(), RowsError> {
        self.check(|origin| {
            let other = self.files.iter().find(|file| !origin.has(file));
            other.map(|file| RowsProblem::Unknown { file: file.clone() })
        })
    }

    fn check(&self, problem: impl FnOnce(&Origin) -> Option<RowsProblem>) -> Result<(), RowsError> {
        match self.origin.as_ref().and_then(|origin| Some((origin, problem(origin)?))) {
            Some((origin, problem)) => {
                let (path, campaign) = (self.path.clone(), origin.manifest.clone());
                Err(RowsError { path, campaign, problem })
            }
            None => Ok(()),
        }
    }

    /// Why nothing can be said of a table without rows.
    pub(crate) fn without_rows(&self) -> ForeignError {
        let problem = match self.counting.group() {
            1 => "it has no rows: a row must be a run".to_owned(),
            group => format!(
                "it has no row that counts: of every {group} runs, which have something in common, the first is judged"
            ),
        };
        self.refused(&problem)
    }

    /// Why it cannot be judged.
    #[must_use]
    pub fn refused(&self, problem: &str) -> ForeignError {
        ForeignError::new(&self.path, problem)
    }

    /// How verdicts count its runs, as the folder of the campaign says that it is in; as independent runs that are looked at once, if it is in
    /// none and nothing else was said.
    #[must_use]
    pub fn counting(&self) -> Counting {
        self.counting
    }

    /// The same table, whose runs are counted so.
    #[must_use]
    pub fn counted(self, counting: Counting) -> Self {
        Self { counting, ..self }
    }

    /// What it calls a column of run tables, as the file spells it, in any letters: none if it has no such column, or several of which none is
    /// spelled as there.
    #[must_use]
    pub fn spelled(&self, own: &str) -> Option<&String> {
        let mut alike = self.alike(own);
        let exact = self.alike(own).find(|name| *name == own);
        exact.or_else(|| alike.next().filter(|_| alike.next().is_none()))
    }

    /// The columns that are called as one of run tables is, in any letters.
    pub fn alike(&self, own: &str) -> impl Iterator<Item = &String> {
        self.columns.iter().filter(move |name| is_alike(name, own))
    }

    /// Whether it is a run table of a campaign, which has the columns `model`, `run` and `status`.
    #[must_use]
    pub fn is_run_table(&self) -> bool {
        status(&self.columns).is_some()
    }

    /// The file of the campaign's folder that it is in that says how verdicts count its runs, if it is in one.
    #[must_use]
    pub fn campaign(&self) -> Option<&Path> {
        self.origin.as_ref().map(|origin| origin.manifest.as_path())
    }

    /// Why a row of which nobody knows which run it is cannot be counted.
    pub(crate) fn without_run(&self) -> ForeignError {
        let problem = "runs have something in common here, so that the column \"run\" must say which run each row is, with whole numbers from 0";
        self.refused(problem)
    }

    /// The names of its columns.
    #[must_use]
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// Looks at the numbers in some columns, all rows in their order, some at a time. Flags are 1 and 0. In a run table of a study, which
    /// has the columns `model`, `run` and `status`, runs that failed have no numbers but those that are infinite, not even those that were
    /// drawn.
    ///
    /// # Errors
    /// It has no such column, a cell in it is no number, a status is neither `ok` nor a reason, or a file cannot be read.
    pub fn scan(&self, columns: &[String], look: impl FnMut(&Columns)) -> Result<(), ForeignError> {
        self.scan_beside(columns, &[], look)
    }

    /// The same, and behind them some columns as they are written, also of runs that failed: of whatever type they are, with no number where a cell is
    /// none.
    ///
    /// # Errors
    /// As [`scan`](Self::scan).
    pub fn scan_beside(
        &self,
        measured: &[String],
        written: &[String],
        mut look: impl FnMut(&Columns),
    ) -> Result<(), ForeignError> {
        self.scan_all((measured, written), None, |numbers, _| look(numbers))
    }

    /// The same, and the model that each row is of, as its column `model` says, in any letters.
    ///
    /// # Errors
    /// As [`scan`](Self::scan).
    pub fn scan_of_models(
        &self,
        measured: &[String],
        written: &[String],
        look: impl FnMut(&Columns, &OfModels),
    ) -> Result<(), ForeignError> {
        self.scan_all((measured, written), Some(Models::default()), look)
    }

    fn scan_all(
        &self,
        columns: (&[String], &[String]),
        mut models: Option<Models>,
        mut look: impl FnMut(&Columns, &OfModels),
    ) -> Result<(), ForeignError> {
        // A study may call the reason why a run failed by any words.
        let of_study = self.origin.is_some();
        for file in &self.files {
            match &self.form {
                Form::Parquet => scan_parquet(file, columns, of_study, models.as_mut(), &mut look)?,
                Form::Csv { separator, text } => {
                    let form = (*separator, self.columns.len());
                    scan_csv(file, text, form, columns, models.as_mut(), &mut look)?;
                }
            }
        }
        Ok(())
    }
}

/// What to say of a folder without Parquet files: of that of a study, which tables it has.
fn without_tables(path: &Path) -> String {
    let found = fs::read_dir(path.join(RUNS)).into_iter().flatten().flatten();
    let mut tables: Vec<PathBuf> = found.map(|entry| entry.path()).filter(|p| p.is_dir()).collect();
    tables.sort();
    let names: Vec<String> = tables.iter().map(|table| table.display().to_string()).collect();
    if names.is_empty() {
        return "it has no .parquet file; the run tables of a study are in runs/ below its folder, a folder for each model".to_owned();
    }
    format!(
        "it has no .parquet file, and below it are the tables of its runs: name {}",
        names.join(" or ")
    )
}

/// Why a file of a folder is not a part of one table with the first one, if it is none.
fn other_columns(there: &[String], (first, columns): (&Path, &[String])) -> Option<String> {
    let most = there.len().max(columns.len());
    let at = (0..most).find(|at| there.get(*at) != columns.get(*at))?;
    let told = |columns: &[String]| match columns.get(at) {
        Some(name) => format!("{name:?} as its column {}", at + 1),
        None => format!("no column {}", at + 1),
    };
    Some(format!(
        "it has {}, and {} has {}: the files of a folder are one table, and must have the same columns in the same order. Judge other tables in a folder \
         of their own",
        told(there),
        first.display(),
        told(columns)
    ))
}

/// Where columns are among those that there are.
fn places<'a>(
    path: &Path,
    there: &[String],
    columns: impl Iterator<Item = &'a String>,
) -> Result<Vec<usize>, ForeignError> {
    let place = |name: &String| {
        let mut found = there.iter().enumerate().filter(|(_, other)| *other == name);
        match (found.next(), found.next()) {
            (Some((place, _)), None) => Ok(place),
            (Some(_), Some(_)) => Err(format!("two columns are called {name:?}")),
            (None, _) => {
                let mut problem =
                    format!("it has no column {name:?}; its columns are {}", there.join(", "));
                if there.iter().all(|name| name.parse::<f64>().is_ok()) {
                    problem += ", which are numbers: names must stand in the first line that does not begin with #, as np.savetxt writes \
                                them with comments=''";
                }
                Err(problem)
            }
        }
    };
    let places = columns.map(place).collect::<Result<_, String>>();
    places.map_err(|problem| ForeignError::new(path, problem))
}

/// Where the status of a run is, in the run table of a study: a table that has `model`, `run` and `status`, in whatever order a copy
/// has them and whatever else stands before.
fn status(columns: &[String]) -> Option<usize> {
    let [model, run, status] = Column::first();
    let of_run = place_of(columns, &model).and(place_of(columns, &run));
    of_run.and(place_of(columns, &status))
}

/// Where a column of the run tables of studies is, which a copy may have in other letters: the first of several.
fn place_of(columns: &[String], own: &Column) -> Option<usize> {
    let exact = columns.iter().position(|name| name == own.name());
    exact.or_else(|| columns.iter().position(|name| is_alike(name, own.name())))
}

/// The same of a column that there is once.
fn only_place(columns: &[String], own: &Column) -> Option<usize> {
    let place = place_of(columns, own)?;
    let is_again = |name: &&String| **name == columns[place];
    (columns.iter().filter(is_again).count() == 1).then_some(place)
}

/// Whether a heading is that of a run table's column, in any letters.
fn is_alike(heading: &str, own: &str) -> bool {
    heading.trim().eq_ignore_ascii_case(own)
}

/// Why a table cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}: {problem}", path.display())]
pub struct ForeignError {
    path: PathBuf,
    problem: String,
}

impl ForeignError {
    fn new(path: &Path, problem: impl Into<String>) -> Self {
        Self { path: path.to_owned(), problem: problem.into() }
    }

    /// What a column is or has.
    fn of_column(path: &Path, name: &str, problem: &str) -> Self {
        Self::new(path, format!("the column {name:?} {problem}"))
    }
}

/// A run table of a study that does not hold the rows of all runs as they were written, so that it cannot tell how many keep
/// a requirement.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}: {} says that {problem}", path.display(), campaign.display())]
pub struct RowsError {
    path: PathBuf,
    campaign: PathBuf,
    problem: RowsProblem,
}

/// What the folder of a study says against a table in it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
enum RowsProblem {
    /// Rows that were not chosen by chance.
    #[error(
        "the study kept rows = \"{}\" of its run tables, so that this one cannot tell how many of all runs keep a requirement: \
         the report and summary.json of the study hold its verdicts, and a table of a study that keeps all rows can be judged",
        rows.name()
    )]
    Kept { rows: Rows },
    /// Blocks that are gone, or whose content is another.
    #[error(
        "{count} of its {of} files {} gone or not as {} written, {}{}: the command that made the study does these runs again",
        if *count == 1 { "is" } else { "are" },
        if *count == 1 { "it was" } else { "they were" },
        if *count == 1 { "" } else { "the first being " },
        first.display()
    )]
    Damaged { first: PathBuf, count: usize, of: usize },
    /// A file that is none of the study's.
    #[error("{} is none of its files: move it elsewhere", file.display())]
    Unknown { file: PathBuf },
    #[error("its runs are in files of which one cannot be read: {problem}")]
    Unread { problem: String },
}
