//! What the columns of a run table look like: found in passes over its blocks, in flat memory.

use gyradius_statistics::{Confidence, Pass, Survey};
use rayon::prelude::*;
use std::{collections::BTreeMap, mem, sync::Mutex};

use crate::{
    column::{Column, Kind},
    runs::Runs,
    runs_error::RunsError,
    sample::surveyed,
    subset::Subset,
    table::Table,
};

/// What the columns of the runs of a model look like.
///
/// The blocks are read a few times, on all threads. What is found is the same to the bit whatever their size and
/// order.
#[derive(Clone, Debug)]
pub struct Surveys {
    model: String,
    numbers: Vec<Numbered>,
    /// Runs of which some columns are surveyed apart.
    subsets: Vec<Subset>,
    counts: Counts,
    /// Of the runs that are independent, if not all are.
    independent: Option<Box<Surveys>>,
}

/// A column that is surveyed.
#[derive(Clone, Debug)]
struct Numbered {
    column: String,
    /// Place among the subsets, if not all runs are looked at.
    subset: Option<usize>,
    survey: Survey,
}

/// How often there is a text of each kind, and in which run first.
#[derive(Clone, Debug, Default)]
struct Tally(BTreeMap<String, (u64, u64)>);

/// What is counted beside the numbers.
#[derive(Clone, Debug, Default)]
struct Counts {
    runs: u64,
    texts: BTreeMap<String, Tally>,
    flags: BTreeMap<String, [u64; 2]>,
    failures: Tally,
    /// The first run that failed, and why.
    first_failure: Option<(u64, String)>,
    /// Runs of each subset, and those of them that failed.
    of_subsets: Vec<[u64; 2]>,
}

/// Surveys whose first look at the runs is under way.
#[derive(Debug)]
pub struct FirstLook {
    surveys: Surveys,
    /// Runs of a group.
    size: u64,
    empty: Vec<Option<Pass>>,
    gathered: Mutex<Gathered>,
}

/// What is gathered of all columns.
#[derive(Debug)]
struct Gathered {
    passes: Vec<Option<Pass>>,
    counts: Counts,
    /// Of the first run of each group.
    of_first: Counts,
}

impl FirstLook {
    /// Of the runs of a model, at most so many, in these columns; intervals of quantiles have this confidence.
    #[must_use]
    pub fn new(model: &str, columns: &[Column], runs: u64, confidence: Confidence) -> Self {
        let of_numbers = columns.iter().filter(|column| column.kind() == Kind::Number);
        let surveys = Surveys {
            model: model.to_owned(),
            numbers: of_numbers
                .map(|column| Numbered {
                    column: column.name().to_owned(),
                    subset: None,
                    survey: surveyed(runs, confidence),
                })
                .collect(),
            subsets: Vec::new(),
            counts: Counts::default(),
            independent: None,
        };
        Self::of(surveys, 1)
    }

    fn of(surveys: Surveys, size: u64) -> Self {
        let empty = surveys.passes();
        let (passes, counts) = (empty.clone(), Counts::default());
        let gathered = Gathered { passes, of_first: counts.clone(), counts };
        Self { surveys, size, gathered: Mutex::new(gathered), empty }
    }

    /// The same for runs that come in groups of so many, of which those of a group have something in common: see
    /// [`Survey::in_groups_of`].
    #[must_use]
    pub fn in_groups_of(self, size: u64) -> Self {
        let mut surveys = self.surveys;
        let numbers = mem::take(&mut surveys.numbers).into_iter();
        surveys.numbers = numbers
            .map(|numbered| Numbered { survey: numbered.survey.in_groups_of(size), ..numbered })
            .collect();
        Self::of(surveys, size.max(1))
    }

    /// The same, which looks at some columns of some runs apart too: at those of all runs of each subset, at most so many, in the same
    /// groups.
    #[must_use]
    pub fn given(
        self,
        subsets: impl IntoIterator<Item = (Subset, Vec<String>)>,
        runs: u64,
        confidence: Confidence,
    ) -> Self {
        let mut surveys = self.surveys;
        for (subset, columns) in subsets {
            let place = surveys.subsets.len();
            surveys.numbers.extend(columns.into_iter().map(|column| Numbered {
                column,
                subset: Some(place),
                survey: surveyed(runs, confidence).in_groups_of(self.size),
            }));
            surveys.subsets.push(subset);
        }
        Self::of(surveys, self.size)
    }

    /// Looks at a block, once at each and in any order.
    pub fn look(&self, block: &Table) {
        let passes = self.surveys.gather(&self.empty, block);
        let mut counts = Counts::of(block, |_| true);
        counts.of_subsets =
            self.surveys.subsets.iter().map(|subset| counted(subset, block)).collect();
        let of_first =
            (self.size > 1).then(|| Counts::of(block, |run| run.is_multiple_of(self.size)));
        // Nobody panics with the lock in hand.
        if let Ok(mut gathered) = self.gathered.lock() {
            take_up(&mut gathered.passes, passes);
            gathered.counts.merge(counts);
            of_first.into_iter().for_each(|counts| gathered.of_first.merge(counts));
        }
    }

    /// The surveys of the runs whose blocks have all been looked at, which are read again.
    ///
    /// # Errors
    /// A block cannot be read.
    pub fn finish(self, runs: &Runs) -> Result<Surveys, RunsError> {
        let mut surveys = self.surveys;
        let mut of_first = Counts::default();
        if let Ok(gathered) = self.gathered.into_inner() {
            surveys.advance(gathered.passes);
            (surveys.counts, of_first) = (gathered.counts, gathered.of_first);
        }
        loop {
            let passes = surveys.passes();
            if passes.iter().all(Option::is_none) {
                if self.size > 1 {
                    surveys.independent = Some(Box::new(surveys.of_independent(of_first)));
                }
                return Ok(surveys);
            }
            let whole = Mutex::new(passes.clone());
            runs.scan(|block| {
                let part = surveys.gather(&passes, block);
                if let Ok(mut whole) = whole.lock() {
                    take_up(&mut whole, part);
                }
            })?;
            if let Ok(whole) = whole.into_inner() {
                surveys.advance(whole);
            }
        }
    }
}

impl Surveys {
    /// Of some runs; intervals of quantiles have this confidence.
    ///
    /// # Errors
    /// A block cannot be read.
    pub fn new(runs: &Runs, confidence: Confidence) -> Result<Self, RunsError> {
        let first = FirstLook::new(runs.model(), runs.columns(), runs.end(), confidence);
        runs.scan(|block| first.look(block))?;
        first.finish(runs)
    }

    /// The runs that are independent, of which these are the counts.
    fn of_independent(&self, counts: Counts) -> Self {
        let numbers = self.numbers.iter().filter(|numbered| numbered.subset.is_none());
        let numbers = numbers.map(|numbered| Numbered {
            survey: numbered.survey.independent().clone(),
            ..numbered.clone()
        });
        let (numbers, subsets) = (numbers.collect(), Vec::new());
        Self { model: self.model.clone(), numbers, subsets, counts, independent: None }
    }

    /// Of the runs that are independent of each other, as far as is known: the first of each group, or all runs if there
    /// are no groups.
    #[must_use]
    pub fn independent(&self) -> &Self {
        self.independent.as_deref().unwrap_or(self)
    }

    /// What is to be gathered next of each column of numbers.
    fn passes(&self) -> Vec<Option<Pass>> {
        self.numbers.iter().map(|numbered| numbered.survey.pass()).collect()
    }

    /// What the passes gather of a block.
    fn gather(&self, passes: &[Option<Pass>], block: &Table) -> Vec<Option<Pass>> {
        let columns = self.numbers.par_iter().zip(passes);
        let masks: Vec<Vec<bool>> = self.subsets.iter().map(|subset| subset.of(block)).collect();
        let gather = |(numbered, empty): (&Numbered, &Option<Pass>)| {
            let mut pass = empty.clone()?;
            let first = block.first();
            // A run that failed has its draws there, but none that is infinite is among the numbers of the others.
            let is_of = |(run, x): &(u64, f64)| {
                x.is_finite() || !block.failures.contains_key(&((run - first) as usize))
            };
            let numbers = block.numbers(&numbered.column)?.of_runs(first).filter(is_of);
            match numbered.subset.map(|place| &masks[place]) {
                None => pass.extend(numbers),
                Some(mask) => pass.extend(numbers.filter(|(run, _)| mask[(run - first) as usize])),
            }
            Some(pass)
        };
        columns.map(gather).collect()
    }

    fn advance(&mut self, gathered: Vec<Option<Pass>>) {
        self.numbers.par_iter_mut().zip(gathered).for_each(|(numbered, pass)| {
            if let Some(pass) = pass {
                numbered.survey.advance(pass);
            }
        });
    }

    /// Name of the model.
    #[must_use]
    pub fn model(&self) -> &str {
        &self.model
    }

    /// How many runs there are, those that failed too.
    #[must_use]
    pub fn runs(&self) -> u64 {
        self.counts.runs
    }

    /// What a column of numbers looks like; none if there is no such column.
    #[must_use]
    pub fn column(&self, column: &str) -> Option<&Survey> {
        self.survey(column, None)
    }

    /// What a column of numbers looks like in the runs of a subset; none if it was not looked at.
    #[must_use]
    pub fn column_given(&self, subset: &Subset, column: &str) -> Option<&Survey> {
        self.survey(column, Some(self.place(subset)?))
    }

    /// How many runs a subset has, and how many of them failed; none if it was not looked at.
    #[must_use]
    pub fn runs_given(&self, subset: &Subset) -> [u64; 2] {
        let counts = self.place(subset).and_then(|place| self.counts.of_subsets.get(place));
        counts.copied().unwrap_or_default()
    }

    fn place(&self, subset: &Subset) -> Option<usize> {
        self.subsets.iter().position(|own| own == subset)
    }

    fn survey(&self, column: &str, subset: Option<usize>) -> Option<&Survey> {
        let is_it = |numbered: &&Numbered| numbered.column == column && numbered.subset == subset;
        self.numbers.iter().find(is_it).map(|numbered| &numbered.survey)
    }

    /// The kinds of texts in a column with how often each is there, in the order of the first runs that have
    /// them.
    #[must_use]
    pub fn texts(&self, column: &str) -> Vec<(&str, u64)> {
        self.counts.texts.get(column).map_or_else(Vec::new, Tally::in_order)
    }

    /// How many runs have `false` in a column of flags, and how many `true`.
    #[must_use]
    pub fn flags(&self, column: &str) -> [u64; 2] {
        self.counts.flags.get(column).copied().unwrap_or_default()
    }

    /// The kinds of failures with how often each is there, in the order of the first runs that have them.
    #[must_use]
    pub fn failures(&self) -> Vec<(&str, u64)> {
        self.counts.failures.in_order()
    }

    /// The first run that failed, and why, as its row says.
    #[must_use]
    pub fn first_failure(&self) -> Option<(u64, &str)> {
        self.counts.first_failure.as_ref().map(|(run, why)| (*run, why.as_str()))
    }
}

/// Runs of a block that are of a subset, and those of them that failed.
fn counted(subset: &Subset, block: &Table) -> [u64; 2] {
    let mask = subset.of(block);
    let failures = block.failures().filter(|(run, _)| mask[(run - block.first()) as usize]);
    [mask.iter().filter(|is_one| **is_one).count() as u64, failures.count() as u64]
}

fn take_up(whole: &mut [Option<Pass>], part: Vec<Option<Pass>>) {
    for (whole, part) in whole.iter_mut().zip(part) {
        if let (Some(whole), Some(part)) = (whole, part) {
            whole.merge(part);
        }
    }
}

impl Counts {
    /// Of some runs of a block.
    fn of(block: &Table, which: impl Fn(u64) -> bool + Copy) -> Self {
        let runs = || block.first()..block.first() + block.len() as u64;
        let mut counts =
            Self { runs: runs().filter(|run| which(*run)).count() as u64, ..Self::default() };
        for (run, failure) in block.failures().filter(|(run, _)| which(*run)) {
            counts.failures.add(failure.kind(), run, 1);
            counts.first_failure.get_or_insert_with(|| (run, failure.to_string()));
        }
        for column in block.columns() {
            match column.kind() {
                Kind::Text => {
                    let mut tally = Tally::default();
                    for (kind, first, count) in block.kinds(column.name(), which) {
                        tally.add(kind, first, count);
                    }
                    counts.texts.insert(column.name().to_owned(), tally);
                }
                Kind::Flag => {
                    let mut flags = [0; 2];
                    let of_runs = runs().zip(block.flags(column.name()));
                    for (_, flag) in of_runs.filter(|(run, _)| which(*run)) {
                        if let Some(flag) = flag {
                            flags[usize::from(*flag)] += 1;
                        }
                    }
                    counts.flags.insert(column.name().to_owned(), flags);
                }
                Kind::Number | Kind::Integer => {}
            }
        }
        counts
    }

    fn merge(&mut self, other: Self) {
        self.runs += other.runs;
        self.failures.merge(&other.failures);
        let both = [self.first_failure.take(), other.first_failure];
        self.first_failure = both.into_iter().flatten().min_by_key(|(run, _)| *run);
        self.of_subsets.resize(self.of_subsets.len().max(other.of_subsets.len()), [0; 2]);
        for (own, more) in self.of_subsets.iter_mut().zip(&other.of_subsets) {
            *own = [own[0] + more[0], own[1] + more[1]];
        }
        for (column, tally) in &other.texts {
            self.texts.entry(column.clone()).or_default().merge(tally);
        }
        for (column, flags) in other.flags {
            let own = self.flags.entry(column).or_default();
            *own = [own[0] + flags[0], own[1] + flags[1]];
        }
    }
}

impl Tally {
    fn add(&mut self, kind: &str, run: u64, count: u64) {
        match self.0.get_mut(kind) {
            Some((first, known)) => (*first, *known) = (run.min(*first), *known + count),
            None => {
                self.0.insert(kind.to_owned(), (run, count));
            }
        }
    }

    fn merge(&mut self, other: &Self) {
        for (kind, (first, count)) in &other.0 {
            self.add(kind, *first, *count);
        }
    }

    fn in_order(&self) -> Vec<(&str, u64)> {
        let mut kinds: Vec<_> = self.0.iter().collect();
        kinds.sort_by_key(|(_, (first, _))| *first);
        kinds.into_iter().map(|(kind, (_, count))| (kind.as_str(), *count)).collect()
    }
}
