//! Mass-properties rollup of a list of parts: by first order, and by drawing.

mod draws;
mod sums;

use gyradius_campaign::{
    CampaignError, Extent, FormatError, Progress, Simulation, Table, TableFormat, stream, threads,
};
use gyradius_estimation::{
    Assembly, AssemblyError, AssemblyPart, AssemblyRow, PartError, PartStatement,
};
use gyradius_formats::{PartRow, PartsFile, PartsTable};
use rayon::prelude::*;
use std::{
    io::Write,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
};

use draws::{Draws, naive};
use sums::Sums;

pub use draws::NaiveShares;
pub use sums::DrawnMoments;

/// What the run table calls the draws.
const MODEL: &str = "rollup";
/// Most draws, so that the number of the last fits its column.
const MOST: u64 = 1_000_000_000_000;
/// Most naive draws that are counted.
const NAIVE: u64 = 20_000;

/// How parts are drawn.
#[derive(Clone, Debug)]
pub struct RollupOptions {
    /// How many draws of the whole; none leaves first order alone.
    pub draws: u64,
    /// Seed of all random numbers.
    pub seed: u64,
    /// How many threads; as many as the machine has if not given.
    pub threads: Option<usize>,
    /// Set from elsewhere to stop.
    pub stop: Option<Arc<AtomicBool>>,
}

impl Default for RollupOptions {
    fn default() -> Self {
        Self { draws: 100_000, seed: 2003, threads: None, stop: None }
    }
}

/// A list of parts, put together.
///
/// What a part draws depends on (seed, its name, number of the draw) alone: another part, or another order of the rows, changes
/// no draw of it.
///
/// ```
/// use gyradius_formats::PartsTable;
/// use gyradius_study::{Rollup, RollupOptions};
///
/// let list = "\
/// name,mass_kg,centre_x_m,centre_y_m,centre_z_m,shape,radius_m,mass_percent,centre_sigma_mm
/// tank,100,0,0,0,sphere,0.3,2,5
/// motor,20,0,0,-0.5,point,,1,1
/// ";
/// let rollup = Rollup::new(&PartsTable::read(list.as_bytes(), None)?)?;
/// let whole = rollup.assembly().first_order();
/// assert!((whole.deviations()[0] - 2_f64.hypot(0.2)).abs() < 1e-12);
/// let options = RollupOptions { draws: 2000, ..RollupOptions::default() };
/// let drawn = rollup.draw(&options, &|_done| {})?;
/// assert_eq!(drawn.moments.impossible, 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Rollup {
    assembly: Assembly,
}

/// What drawing comes to.
#[derive(Clone, Debug)]
pub struct RollupDraws {
    /// Of the draws.
    pub moments: DrawnMoments,
    /// Of Gaussian numbers in place of them.
    pub naive: NaiveShares,
}

impl Rollup {
    /// Puts the rows of a list together, on all threads of the pool from which it is called.
    ///
    /// # Errors
    /// A part is none, or the rows are no tree; the error names the line.
    pub fn new(table: &PartsTable) -> Result<Self, RollupError> {
        // A law of an inertia is found in milliseconds, one part beside the other. Of several errors, the first counts.
        let rows: Vec<Result<AssemblyRow, RollupError>> =
            table.rows().par_iter().map(row).collect();
        let rows: Result<Vec<AssemblyRow>, RollupError> = rows.into_iter().collect();
        let assembly = Assembly::new(rows?).map_err(|error| {
            // Of a name that stands twice, the second.
            let row = table.rows().iter().rfind(|row| error.row() == Some(row.name()));
            let is_circle = matches!(error, AssemblyError::Circle { .. });
            let place = row.map(|row| if is_circle { row.parent_place() } else { row.place() });
            RollupError::Tree { place, error }
        })?;
        Ok(Self { assembly })
    }

    /// The tree, with first order.
    #[must_use]
    pub fn assembly(&self) -> &Assembly {
        &self.assembly
    }

    /// Draws.
    ///
    /// # Errors
    /// Too many draws are asked for, the threads cannot be started, or it was told to stop.
    pub fn draw(
        &self,
        options: &RollupOptions,
        progress: Progress<'_>,
    ) -> Result<RollupDraws, RollupError> {
        self.drawn(options, progress, |_| Ok(()))
    }

    /// Draws, and writes a table of the draws: run, status and the ten.
    ///
    /// # Errors
    /// As [`draw`](Self::draw), or the output refuses.
    pub fn draw_to(
        &self,
        options: &RollupOptions,
        format: TableFormat,
        output: impl Write + Send,
        progress: Progress<'_>,
    ) -> Result<RollupDraws, RollupError> {
        let draws = Draws::new(&self.assembly, options.seed);
        let pool = threads(options.threads)?;
        let mut extent = Extent::default();
        if format.needs_extent() {
            // Nothing is failed or named in a table of draws but what this finds.
            pool.install(|| {
                each(&draws, options, &|_| {}, |table| {
                    extent.add(table);
                    Ok(())
                })
            })?;
        }
        let empty = Table::new(MODEL, 0, draws.columns()).map_err(CampaignError::from)?;
        let mut writer = format.writer(&empty, &extent, output)?;
        let found = self.drawn(options, progress, |table| Ok(writer.write(table)?))?;
        writer.finish()?;
        Ok(found)
    }

    fn drawn(
        &self,
        options: &RollupOptions,
        progress: Progress<'_>,
        mut take: impl FnMut(&Table) -> Result<(), RollupError> + Send,
    ) -> Result<RollupDraws, RollupError> {
        if options.draws > MOST {
            return Err(RollupError::Draws { draws: options.draws });
        }
        let draws = Draws::new(&self.assembly, options.seed);
        let mut sums = Sums::new(self.assembly.first_order());
        let done = AtomicU64::new(0);
        let more = |runs| progress(done.fetch_add(runs, Ordering::Relaxed) + runs);
        let naive = threads(options.threads)?.install(|| {
            each(&draws, options, &more, |table| {
                sums.add(table);
                take(table)
            })?;
            let (most, stop) = (options.draws.min(NAIVE), options.stop.as_deref());
            Ok::<_, RollupError>(naive(&self.assembly, options.seed, most, stop)?)
        })?;
        Ok(RollupDraws { moments: sums.moments(), naive })
    }
}

/// Draws everything and hands it on, in the order of the runs.
fn each(
    draws: &Draws<'_>,
    options: &RollupOptions,
    more: &(dyn Fn(u64) + Sync),
    take: impl FnMut(&Table) -> Result<(), RollupError>,
) -> Result<(), RollupError> {
    stream(draws, MODEL, 0..options.draws, options.stop.as_deref(), more, take)
}

/// A row of a list as a row of a tree.
fn row(row: &PartRow) -> Result<AssemblyRow, RollupError> {
    let ((_, line), name) = (row.place(), row.name().to_owned());
    let part = row.numbers().map(|numbers| {
        AssemblyPart::new(PartStatement {
            mass_kg: numbers.mass_kg(),
            mass_centre_m: numbers.mass_centre_m(),
            inertia: *numbers.inertia(),
            attitude: numbers.attitude(),
            deviations: numbers.deviations(),
            inertia_follows_mass: numbers.inertia_follows_mass(),
        })
    });
    let part = part.transpose();
    let part = part.map_err(|error| RollupError::Part { line, name: name.clone(), error })?;
    Ok(AssemblyRow { name, parent: row.parent().map(str::to_owned), part })
}

/// Why a list cannot be rolled up.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RollupError {
    /// A part is none.
    #[error("line {line}: {name}: {error}")]
    Part {
        /// Line, from 1.
        line: usize,
        /// Its name.
        name: String,
        /// Why.
        error: PartError,
    },
    /// The rows are no tree.
    #[error("{}{error}", place.map(|(_, line)| format!("line {line}: ")).unwrap_or_default())]
    Tree {
        /// Table and line, from 1, if one is to blame.
        place: Option<(PartsFile, usize)>,
        /// Why.
        error: AssemblyError,
    },
    /// Too many draws.
    #[error("{draws} draws: there may be {MOST} at most")]
    Draws {
        /// How many were asked for.
        draws: u64,
    },
    /// The threads cannot be started, or it was told to stop.
    #[error(transparent)]
    Campaign(#[from] CampaignError),
    /// The output refuses.
    #[error(transparent)]
    Output(#[from] FormatError),
}

impl RollupError {
    /// The table of the list in which it is.
    #[must_use]
    pub fn file(&self) -> PartsFile {
        match self {
            Self::Tree { place: Some((file, _)), .. } => *file,
            Self::Tree { place: None, .. }
            | Self::Part { .. }
            | Self::Draws { .. }
            | Self::Campaign(_)
            | Self::Output(_) => PartsFile::Parts,
        }
    }
}

#[cfg(test)]
mod tests;
