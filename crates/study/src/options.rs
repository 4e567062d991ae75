//! How a study is carried out, and what it says meanwhile.

use gyradius_campaign::{Again, Forecast, Unasked};
use std::{
    path::{Path, PathBuf},
    sync::{Arc, atomic::AtomicBool},
};

/// How to carry out a study.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Where to; `target/study/<scenario name>` if not given.
    pub out: Option<PathBuf>,
    /// How many threads; as many as the machine has if not given.
    pub threads: Option<usize>,
    /// Replace another study in the folder.
    pub force: bool,
    /// Begin even if the disk has no room for the run tables, or the memory for the study.
    pub even_if_full: bool,
    /// Do runs again that failed.
    pub retry_failed: bool,
    /// Set from elsewhere to stop: blocks of runs that are finished stay, and the same study goes on.
    pub stop: Option<Arc<AtomicBool>>,
}

/// What a study says before its runs, and of how they were done.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Notice {
    /// What the runs will take that are to be done.
    Forecast(Forecast),
    /// So many runs of all models are there already.
    GoesOn {
        /// Runs that are there.
        done: u64,
        /// Runs of all models.
        of: u64,
    },
    /// A block of runs is not as it was written.
    Damaged {
        /// The block, and what is wrong.
        block: String,
        /// Whether its runs are done again now.
        again: bool,
    },
    /// The study is finished already, and was not replaced.
    Finished,
    /// Runs that had failed were done again.
    Again(Again),
    /// The simulator wrote to standard output what it was not asked for.
    Unasked(Unasked),
    /// What drives the outcome is asked for, and not found by who puts together what shards did.
    DriversLeft,
    /// Another study was begun in the folder to replace this one, in words.
    Replacement(String),
}

impl Options {
    /// Into a folder, and else as usual.
    #[must_use]
    pub fn to(folder: impl Into<PathBuf>) -> Self {
        Self { out: Some(folder.into()), ..Self::default() }
    }

    /// The folder that a study of a scenario with a name goes to.
    pub(crate) fn place(&self, name: &str) -> PathBuf {
        let default = || Path::new("target/study").join(name);
        self.out.clone().unwrap_or_else(default)
    }
}
