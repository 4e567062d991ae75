//! A simulation, and its runs on many threads.

use gyradius_statistics::StatisticsError;
use rayon::prelude::*;
use std::{
    env,
    num::NonZero,
    ops::Range,
    panic::resume_unwind,
    sync::atomic::{AtomicBool, AtomicU64, Ordering},
    thread,
};

use crate::{
    column::Column,
    folder::FolderError,
    runs_error::RunsError,
    stack::stack_size,
    stop::is_stopped,
    table::{Table, TableError},
};

/// Runs that a thread takes at a time if nothing is said: many for the lanes of a batch, few for other threads to be
/// idle at the end.
const TOGETHER: u64 = 64;
/// Most threads that may be asked for.
const MAX_THREADS: usize = 1024;
/// What says how many threads there are, where nobody asks for a number.
const NUMBER_OF_THREADS: &str = "RAYON_NUM_THREADS";

/// Anything that turns random draws into the columns of a run table.
///
/// What run i writes must depend on i alone, and on nothing that other runs do: take its random numbers from
/// [`Streams`](crate::Streams). Then results are the same bits on any number of threads, and every run can
/// be done again alone.
///
/// Runs are done on threads of rayon, unless they are to be done [apart](Self::apart).
pub trait Simulation: Sync {
    /// What a thread keeps from some runs to the next, such as a batch; `()` if nothing.
    type Worker: Send;

    /// The columns that a run fills, which follow `model`, `run` and `status`.
    fn columns(&self) -> Vec<Column>;

    /// A worker for a thread that begins.
    fn worker(&self) -> Self::Worker;

    /// How many runs a thread takes at a time, at least one; 64 if nothing is said. A simulation whose runs take long
    /// takes one: no thread is idle at the end then, and a campaign that is told to stop stops soon.
    fn together(&self) -> u64 {
        TOGETHER
    }

    /// Whether runs are done on threads that are not rayon's; not if nothing is said.
    ///
    /// A thread of rayon that waits for a loop of rayon does other work meanwhile, which here is another run, on the same stack
    /// and in the middle of the first. So runs are done apart if they compute with rayon and hold a lock meanwhile, or call a function
    /// of the user's own, which may do so. Their threads have the stack of a main thread ([`stack_size`]), for functions that work there.
    fn apart(&self) -> bool {
        false
    }

    /// Why the runs that were done do not count, though none of them is to blame: what does them has changed meanwhile, or something
    /// failed on this machine. It is asked after runs, before their rows are kept, and ends the campaign. Nothing if nothing is said.
    fn fault(&self) -> Option<String> {
        None
    }

    /// Does these runs and pushes a row for each of them, in their order. A run that fails is a row too, with
    /// what it has and its [`Failure`](crate::Failure). A panic is no such failure: it passes through [`run`] and
    /// [`run_missing`](crate::run_missing) to their caller and ends the campaign. Blocks that are finished by then stay in the folder,
    /// and the same call goes on after them.
    ///
    /// # Errors
    /// A row does not fit the columns.
    fn run(
        &self,
        runs: Range<u64>,
        worker: &mut Self::Worker,
        rows: &mut Table,
    ) -> Result<(), TableError>;
}

/// Told how many runs are done.
pub type Progress<'a> = &'a (dyn Fn(u64) + Sync);

/// Does the runs `0..runs` of a simulation on many threads. Rows come in run order.
///
/// # Errors
/// The columns are refused, or the simulation writes rows that do not fit them, or not one for each run.
pub fn run<S: Simulation>(
    simulation: &S,
    model: &str,
    runs: u64,
    threads: &rayon::ThreadPool,
    progress: Progress<'_>,
) -> Result<Table, CampaignError> {
    let empty = Table::new(model, 0, simulation.columns())?;
    let done = AtomicU64::new(0);
    let more = |runs| {
        progress(done.fetch_add(runs, Ordering::Relaxed) + runs);
        Ok(())
    };
    threads.install(|| run_range(simulation, &empty, 0..runs, &more))
}

/// Does some runs of a simulation on the threads that this is called in. Rows come in run order; `more` is told of
/// runs that are done, and can end it.
pub(crate) fn run_range<S: Simulation>(
    simulation: &S,
    empty: &Table,
    runs: Range<u64>,
    more: &(dyn Fn(u64) -> Result<(), CampaignError> + Sync),
) -> Result<Table, CampaignError> {
    let asked = Asked { simulation, empty, together: simulation.together().max(1), runs, more };
    let parts = if simulation.apart() { asked.in_threads_apart()? } else { asked.in_groups()? };
    if let Some(problem) = simulation.fault() {
        return Err(CampaignError::Fault { problem });
    }
    let joined = parts.into_iter().reduce(|mut whole, part| {
        whole.append(part);
        whole
    });
    Ok(joined.unwrap_or_else(|| empty.from_run(asked.runs.start)))
}

/// Runs that were asked for, of which each thread does groups.
struct Asked<'a, S> {
    simulation: &'a S,
    empty: &'a Table,
    /// How many runs a group has; the last one may have fewer.
    together: u64,
    runs: Range<u64>,
    /// Is told of each group that is done, and may end it all.
    more: &'a (dyn Fn(u64) -> Result<(), CampaignError> + Sync),
}

impl<S: Simulation> Asked<'_, S> {
    /// The groups are rayon's to share out. Those that a thread does one after the other have one worker and
    /// one table.
    fn in_groups(&self) -> Result<Vec<Table>, CampaignError> {
        let number = (self.runs.end - self.runs.start).div_ceil(self.together);
        let groups =
            (0..number).into_par_iter().map(|group| self.runs.start + group * self.together);
        let begin = || Ok((self.simulation.worker(), None));
        let parts = groups.fold(begin, |part, first| {
            let (mut worker, rows) = part?;
            let mut rows = rows.unwrap_or_else(|| self.empty.from_run(first));
            self.do_group(first, &mut worker, &mut rows)?;
            Ok((worker, Some(rows)))
        });
        let parts = parts.map(|part| part.map(|(_, rows)| rows));
        Ok(parts.collect::<Result<Vec<_>, CampaignError>>()?.into_iter().flatten().collect())
    }

    /// Each thread of rayon's waits for one of ours, which takes the groups that are left one after the other:
    /// waking a thread for each group costs as much as some short runs.
    fn in_threads_apart(&self) -> Result<Vec<Table>, CampaignError> {
        let next = AtomicU64::new(self.runs.start);
        let threads = (0..rayon::current_num_threads()).into_par_iter().with_max_len(1);
        let parts = threads.map(|_| {
            let is_done = next.load(Ordering::Relaxed) >= self.runs.end;
            if is_done { Ok(Vec::new()) } else { aside(|| self.take_groups(&next))? }
        });
        let parts = parts.collect::<Result<Vec<_>, CampaignError>>()?;
        let mut parts: Vec<Table> = parts.into_iter().flatten().collect();
        parts.sort_by_key(Table::first);
        Ok(parts)
    }

    /// Takes groups until none is left. Those that follow each other are in one table.
    fn take_groups(&self, next: &AtomicU64) -> Result<Vec<Table>, CampaignError> {
        let take = || {
            next.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |first| {
                (first < self.runs.end).then(|| first.saturating_add(self.together))
            })
        };
        let (mut worker, mut parts) = (self.simulation.worker(), Vec::<Table>::new());
        while let Ok(first) = take() {
            let follows = |part: &Table| part.first() + part.len() as u64 == first;
            if !parts.last().is_some_and(follows) {
                parts.push(self.empty.from_run(first));
            }
            if let Some(part) = parts.last_mut() {
                // What others would still do counts for nothing then.
                let end = |_: &CampaignError| next.store(self.runs.end, Ordering::Relaxed);
                self.do_group(first, &mut worker, part).inspect_err(end)?;
            }
        }
        Ok(parts)
    }

    /// Does the group that begins with this run, and writes its rows.
    fn do_group(
        &self,
        first: u64,
        worker: &mut S::Worker,
        rows: &mut Table,
    ) -> Result<(), CampaignError> {
        let (last, before) = (first.saturating_add(self.together).min(self.runs.end), rows.len());
        self.simulation.run(first..last, worker, rows)?;
        if (rows.len() - before) as u64 != last - first {
            return Err(CampaignError::Rows { runs: first..last, rows: rows.len() - before });
        }
        (self.more)(last - first)
    }
}

/// Does some work in a thread that is none of rayon's and has the stack of a main thread, and waits for it without doing anything else.
fn aside<T: Send>(work: impl FnOnce() -> T + Send) -> Result<T, CampaignError> {
    thread::scope(|scope| {
        let begun = thread::Builder::new().stack_size(stack_size()).spawn_scoped(scope, work);
        let begun = begun.map_err(|e| CampaignError::Threads { problem: e.to_string() })?;
        Ok(begun.join().unwrap_or_else(|panic| resume_unwind(panic)))
    })
}

/// Whether it goes on, or was told to stop.
///
/// # Errors
/// It was told to stop.
pub fn go_on(stop: Option<&AtomicBool>) -> Result<(), CampaignError> {
    if is_stopped(stop) { Err(CampaignError::Stopped) } else { Ok(()) }
}

/// So many threads; if no number is given, as many as `RAYON_NUM_THREADS` says, or as the machine has, but at most 1024.
///
/// # Errors
/// The number is not between 1 and 1024, or they cannot be started.
pub fn threads(number: Option<usize>) -> Result<rayon::ThreadPool, CampaignError> {
    if let Some(number) = number.filter(|number| !(1..=MAX_THREADS).contains(number)) {
        let problem = format!("{number}: it must be between 1 and {MAX_THREADS}");
        return Err(CampaignError::Threads { problem });
    }
    rayon::ThreadPoolBuilder::new()
        .num_threads(number.unwrap_or_else(|| unasked(env::var(NUMBER_OF_THREADS).ok().as_deref())))
        .build()
        .map_err(|e| CampaignError::Threads { problem: e.to_string() })
}

/// How many threads there are where nobody asks for a number: what the variable says, if it says a number, and otherwise one for each
/// core. A number that is not positive says nothing, as it does for rayon.
fn unasked(said: Option<&str>) -> usize {
    let said = said.and_then(|said| said.parse().ok()).filter(|number| *number > 0);
    let number = said.or_else(|| thread::available_parallelism().ok().map(NonZero::get));
    number.unwrap_or(1).min(MAX_THREADS)
}

/// Why a campaign cannot be done.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CampaignError {
    /// The columns or a row are refused.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The simulation wrote another number of rows than it was asked for.
    #[error("runs {} to {}: {rows} rows, and there must be one for each run", runs.start, runs.end - 1)]
    Rows {
        /// The runs asked for.
        runs: Range<u64>,
        /// How many rows it wrote.
        rows: usize,
    },
    /// Runs do not count, though none of them is to blame ([`Simulation::fault`]).
    #[error("{problem}")]
    Fault {
        /// What is wrong, and what of the runs is kept, if anything is.
        problem: String,
    },
    /// A block of runs that was there cannot be read.
    #[error(transparent)]
    Runs(RunsError),
    /// A block of runs cannot be written.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// There are more runs than can be judged.
    #[error("the runs cannot be judged: {0}")]
    Judged(StatisticsError),
    /// The campaign was told to stop. The blocks that were finished stay.
    #[error("stopped; the runs of the blocks that were finished are kept")]
    Stopped,
    /// The number of threads is out of range, or they cannot be started.
    #[error("threads: {problem}")]
    Threads {
        /// What is wrong.
        problem: String,
    },
}

impl CampaignError {
    /// The same, where runs are done in blocks, which stay.
    pub(crate) fn in_blocks(self) -> Self {
        match self {
            Self::Fault { problem } => Self::Fault {
                problem: format!(
                    "{problem}; the runs of the blocks that were finished before are kept"
                ),
            },
            other => other,
        }
    }
}

impl From<RunsError> for CampaignError {
    fn from(error: RunsError) -> Self {
        match error {
            RunsError::Stopped => Self::Stopped,
            block @ RunsError::Block { .. } => Self::Runs(block),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_variable_asks_for_more_threads_than_a_caller_may() {
        for (said, number) in [("1", 1), ("7", 7), ("1024", 1024), ("1025", 1024), ("99999", 1024)]
        {
            assert_eq!(unasked(Some(said)), number, "{said}");
        }
        let cores = unasked(None);
        assert!((1..=MAX_THREADS).contains(&cores));
        for said in ["", "0", "-1", "2.5", "many", "99999999999999999999999"] {
            assert_eq!(unasked(Some(said)), cores, "{said}");
        }
    }
}
