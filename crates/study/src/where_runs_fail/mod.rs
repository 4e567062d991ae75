//! Where runs fail: which inputs, and which pairs of inputs, separate the runs that fail a requirement from those that keep it;
//! and with which inputs outcomes rise or fall. From the run table alone.

mod rows;
mod section;
#[cfg(test)]
mod tests;

use gyradius_campaign::{Column, Measured, Requirement, Runs, RunsError};
use gyradius_statistics::{
    Confidence, PairSeparation, QuantileCells, RankCorrelation, Ranks, SuccessByDecile, holm,
    log_likelihood_ratio,
};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::rounding::Rounding;
use rows::FirstRuns;

pub(crate) use section::sections;

/// Independent runs of a model that are looked at, at most: the first ones.
const RUNS: u64 = 100_000;
/// Runs of which ranks are correlated, at most: enough to tell 0.02 from 0, and quick beside the runs.
const RANKED: usize = 10_000;
/// A requirement is asked if at least so many of them fail it, and at least so many keep it.
const LEAST: u64 = 10;
/// Inputs that are held in memory at once, and of which all pairs are tested.
const INPUTS: usize = 40;
/// Outcomes whose ranks are correlated without requirements, at most: the first ones.
const OUTCOMES: usize = 40;
/// Pairs that are kept.
const PAIRS: usize = 20;
/// Parts of each input of a pair.
const FIFTHS: usize = 5;

/// Where the runs of a model fail its requirements.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct WhereRunsFail {
    model: String,
    /// Runs that were looked at, which are independent of each other.
    runs: u64,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    requirements: Vec<Failures>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    rank_correlations: Vec<Outcome>,
    /// Outcomes whose ranks are not correlated, for there are too many.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    outcomes_left_out: Vec<String>,
}

/// Where runs fail a requirement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Failures {
    requirement: String,
    /// Runs that count, and those of them that fail it.
    runs: u64,
    failures: u64,
    /// All inputs that differ between runs, in the order of the run table.
    inputs: Vec<Tenths>,
    /// The pairs that separate best, and how many were tested.
    pairs: Vec<Pair>,
    pairs_tested: usize,
}

/// Failures in each tenth of an input.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Tenths {
    input: String,
    /// Of all inputs together (Holm).
    adjusted_p_value: f64,
    #[serde(flatten)]
    shares: SuccessByDecile,
}

/// How two inputs separate failing runs together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Pair {
    inputs: [String; 2],
    /// Of all pairs together (Holm).
    adjusted_p_value: f64,
    #[serde(flatten)]
    separation: PairSeparation,
    clearest_excess: Corner,
}

/// Runs with one input in one of its fifths and another one in one of its own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct Corner {
    /// From 0, that of the lowest values; 4 is that of the highest.
    fifths: [u16; 2],
    runs: u64,
    failures: u64,
}

/// How an outcome goes with the inputs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Outcome {
    outcome: String,
    inputs: Vec<Correlation>,
}

/// How an outcome goes with an input.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Correlation {
    input: String,
    #[serde(flatten)]
    rank: RankCorrelation,
}

/// What is asked of the runs of a model.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Asked<'a> {
    /// The requirements of the model.
    pub(crate) requirements: &'a [Requirement],
    /// Columns of numbers that are drawn.
    pub(crate) inputs: &'a [String],
    /// Columns of the outcomes that are told of without requirements.
    pub(crate) main: &'a [String],
    /// Runs that have something in common come in groups of so many, of which the first run is taken.
    pub(crate) group: u64,
    /// Of the outcomes.
    pub(crate) rounding: Rounding,
}

/// Looks at the runs of a model, in passes that hold some inputs of them each; nothing if there is nothing to tell.
pub(crate) fn found(runs: &Runs, asked: Asked<'_>) -> Result<Option<WhereRunsFail>, RunsError> {
    let most = if asked.requirements.is_empty() { RANKED as u64 } else { RUNS };
    let rows = FirstRuns::new(runs, asked.group, most);
    let (there, fails) = rows.failing(asked.requirements)?;
    let judged: Vec<Counted> = fails.iter().map(|fails| Counted::new(fails)).collect();
    let (outcomes, outcomes_left_out) = outcomes(asked);
    let numbers = rows.numbers(&outcomes)?;
    let moves =
        |(outcome, numbers): &(Measured, Vec<f64>)| varying(runs, outcome, numbers, asked.rounding);
    let (outcomes, of_outcomes): (Vec<_>, Vec<_>) =
        outcomes.into_iter().zip(numbers).filter(moves).unzip();
    let ranked: Vec<Ranked<'_>> = of_outcomes.par_iter().map(|y| Ranked::new(y)).collect();

    let mut tenths: Vec<Vec<Tenths>> = vec![Vec::new(); judged.len()];
    let mut correlations: Vec<Vec<Correlation>> = vec![Vec::new(); outcomes.len()];
    let mut held = Held::default();
    for names in asked.inputs.chunks(INPUTS) {
        held = Held::new(&rows, names)?;
        for (counted, all) in judged.iter().zip(&mut tenths).filter(|(c, _)| c.is_enough()) {
            all.par_extend(held.each().filter_map(|(input, x)| counted.tenths(input, x)));
        }
        if ranked.is_empty() {
            continue;
        }
        let of_inputs: Vec<_> = held.each().map(|(input, x)| (input, Ranked::new(x))).collect();
        for (outcome, all) in ranked.iter().zip(&mut correlations) {
            let of = of_inputs.par_iter();
            all.par_extend(of.filter_map(|(input, x)| Correlation::new(input, x, outcome)));
        }
    }

    let mut requirements = Vec::new();
    for ((requirement, counted), mut inputs) in asked.requirements.iter().zip(&judged).zip(tenths) {
        // As of a requirement that too few runs fail or keep.
        if inputs.is_empty() {
            continue;
        }
        let p_values: Vec<f64> = inputs.iter().map(Tenths::p_value).collect();
        for (input, adjusted) in inputs.iter_mut().zip(adjusted(&p_values)) {
            input.adjusted_p_value = adjusted;
        }
        let names = of_pairs(&inputs);
        if !names.iter().all(|name| held.has(name)) {
            held = Held::new(&rows, &names)?;
        }
        let (pairs, pairs_tested) = counted.pairs(&names, &held);
        requirements.push(Failures {
            requirement: requirement.name().to_owned(),
            runs: counted.rows.len() as u64,
            failures: counted.failures(),
            inputs,
            pairs,
            pairs_tested,
        });
    }
    let told = outcomes.iter().zip(correlations).filter(|(_, inputs)| !inputs.is_empty());
    let told = told.map(|(outcome, inputs)| Outcome { outcome: outcome.to_string(), inputs });
    let rank_correlations: Vec<Outcome> = told.collect();
    let nothing = requirements.is_empty() && rank_correlations.is_empty();
    let model = runs.model().to_owned();
    let found =
        WhereRunsFail { model, runs: there, requirements, rank_correlations, outcomes_left_out };
    Ok((!nothing).then_some(found))
}

/// Whether an outcome differs between runs by more than rounding.
fn varying(runs: &Runs, outcome: &Measured, numbers: &[f64], rounding: Rounding) -> bool {
    let of = |name: &String| runs.columns().iter().find(|column| column.name() == name);
    let unit = |name: &String| of(name).and_then(Column::unit).unwrap_or_default();
    let finite = || numbers.iter().copied().filter(|x| x.is_finite());
    let range = finite().reduce(f64::min).zip(finite().reduce(f64::max));
    range.is_some_and(|(least, most)| {
        let exceeds = |name: &String| rounding.is_exceeded(least, most, (name, unit(name)));
        outcome.columns().iter().all(exceeds)
    })
}

/// The quantities of the requirements, each once, or the main outcomes without any, and those of them that are left out.
fn outcomes(asked: Asked<'_>) -> (Vec<Measured>, Vec<String>) {
    let mut outcomes: Vec<Measured> = Vec::new();
    for requirement in asked.requirements {
        if !outcomes.contains(requirement.quantity()) {
            outcomes.push(requirement.quantity().clone());
        }
    }
    if !outcomes.is_empty() {
        return (outcomes, Vec::new());
    }
    let (told, left_out) = asked.main.split_at(asked.main.len().min(OUTCOMES));
    (told.iter().map(|column| Measured::column(column)).collect(), left_out.to_vec())
}

/// The inputs of which pairs are tested, in the order of the run table: those that separate best alone, if there are many.
fn of_pairs(inputs: &[Tenths]) -> Vec<String> {
    let mut places: Vec<usize> = (0..inputs.len()).collect();
    places.sort_by(|&i, &j| inputs[i].p_value().total_cmp(&inputs[j].p_value()));
    places.truncate(INPUTS);
    places.sort_unstable();
    places.into_iter().map(|i| inputs[i].input.clone()).collect()
}

/// P-values that may each be held against a risk for all together.
fn adjusted(p_values: &[f64]) -> Vec<f64> {
    holm(p_values).unwrap_or_else(|_| vec![1.0; p_values.len()])
}

/// Some inputs in memory: a number of each run that was looked at, NaN where it has none.
#[derive(Default)]
struct Held {
    names: Vec<String>,
    numbers: Vec<Vec<f64>>,
}

impl Held {
    fn new(rows: &FirstRuns<'_>, names: &[String]) -> Result<Self, RunsError> {
        Ok(Self { names: names.to_vec(), numbers: rows.drawn(names)? })
    }

    fn has(&self, name: &String) -> bool {
        self.names.contains(name)
    }

    fn of(&self, name: &String) -> &[f64] {
        let place = self.names.iter().position(|own| own == name);
        place.map_or(&[], |place| &self.numbers[place])
    }

    fn each(&self) -> impl ParallelIterator<Item = (&String, &[f64])> {
        self.names.par_iter().zip(self.numbers.par_iter().map(Vec::as_slice))
    }
}

/// The runs that count for a requirement, by their places, and whether each fails it.
struct Counted {
    rows: Vec<usize>,
    failed: Vec<bool>,
}

impl Counted {
    fn new(fails: &[Option<bool>]) -> Self {
        let counted = fails.iter().enumerate().filter_map(|(row, fails)| Some((row, (*fails)?)));
        let (rows, failed) = counted.unzip();
        Self { rows, failed }
    }

    fn failures(&self) -> u64 {
        self.failed.iter().filter(|failed| **failed).count() as u64
    }

    fn is_enough(&self) -> bool {
        let failures = self.failures();
        failures >= LEAST && self.rows.len() as u64 - failures >= LEAST
    }

    /// Those of the runs that have all of these inputs.
    fn with(&self, inputs: &[&[f64]]) -> Self {
        let has = |row: usize| inputs.iter().all(|x| x.get(row).is_some_and(|x| x.is_finite()));
        let own = self.rows.iter().zip(&self.failed).filter(|(row, _)| has(**row));
        let (rows, failed) = own.unzip();
        Self { rows, failed }
    }

    fn values(&self, input: &[f64]) -> Vec<f64> {
        self.rows.iter().map(|row| input[*row]).collect()
    }

    fn fifths(&self, input: &[f64]) -> Option<QuantileCells> {
        QuantileCells::new(&self.values(input), FIFTHS).ok()
    }

    /// Failures in each tenth of an input; nothing of an input that is the same in all runs.
    fn tenths(&self, input: &str, x: &[f64]) -> Option<Tenths> {
        let own = self.with(&[x]);
        let values = own.values(x);
        let first = values.first()?;
        if values.iter().all(|value| value == first) {
            return None;
        }
        let shares = SuccessByDecile::new(&values, &own.failed, Confidence::default()).ok()?;
        Some(Tenths { input: input.to_owned(), adjusted_p_value: 1.0, shares })
    }

    /// The pairs of some inputs that separate failing runs best, and how many there are.
    fn pairs(&self, names: &[String], held: &Held) -> (Vec<Pair>, usize) {
        let inputs: Vec<&[f64]> = names.iter().map(|name| held.of(name)).collect();
        // Of the inputs that all runs have.
        let of_all: Vec<Option<QuantileCells>> = inputs
            .par_iter()
            .map(|x| (self.with(&[x]).rows.len() == self.rows.len()).then(|| self.fifths(x))?)
            .collect();
        let places: Vec<[usize; 2]> =
            (0..names.len()).flat_map(|i| (i + 1..names.len()).map(move |j| [i, j])).collect();
        let pair = |&[i, j]: &[usize; 2]| {
            let inputs = [inputs[i], inputs[j]];
            let names = [i, j].map(|place| names[place].clone());
            if let (Some(x), Some(y)) = (&of_all[i], &of_all[j]) {
                return Pair::new(names, [x, y], &self.failed);
            }
            let own = self.with(&inputs);
            let (x, y) = own.fifths(inputs[0]).zip(own.fifths(inputs[1]))?;
            Pair::new(names, [&x, &y], &own.failed)
        };
        let mut pairs: Vec<Pair> = places.par_iter().filter_map(pair).collect();
        let p_values: Vec<f64> = pairs.iter().map(Pair::p_value).collect();
        for (pair, adjusted) in pairs.iter_mut().zip(adjusted(&p_values)) {
            pair.adjusted_p_value = adjusted;
        }
        let tested = pairs.len();
        pairs.sort_by(|a, b| {
            let by_gain = || b.separation.gain().total_cmp(&a.separation.gain());
            a.p_value().total_cmp(&b.p_value()).then_with(by_gain)
        });
        pairs.truncate(PAIRS);
        (pairs, tested)
    }
}

impl Tenths {
    fn p_value(&self) -> f64 {
        self.shares.test().p_value()
    }
}

impl Pair {
    fn new(inputs: [String; 2], cells: [&QuantileCells; 2], failed: &[bool]) -> Option<Self> {
        let separation = PairSeparation::new(cells[0], cells[1], failed).ok()?;
        let clearest_excess = Corner::with_clearest_excess(cells, failed);
        Some(Self { inputs, adjusted_p_value: 1.0, separation, clearest_excess })
    }

    fn p_value(&self) -> f64 {
        self.separation.p_value()
    }
}

impl Corner {
    /// The one whose excess of failures over what is expected has the largest deviance, and not one that has most failures because it has most runs. In standard deviations a single failure among
    /// few runs, where a thousandth of one is expected, would exceed fifty among a hundred.
    fn with_clearest_excess([x, y]: [&QuantileCells; 2], failed: &[bool]) -> Self {
        let mut all = [[Self::default(); FIFTHS]; FIFTHS];
        for ((x, y), failed) in x.of_values().iter().zip(y.of_values()).zip(failed) {
            let own = &mut all[usize::from(*x)][usize::from(*y)];
            own.fifths = [*x, *y];
            own.runs += 1;
            own.failures += u64::from(*failed);
        }
        let share = failed.iter().filter(|failed| **failed).count() as f64 / failed.len() as f64;
        let excess = |cell: &Self| {
            let deviance = log_likelihood_ratio(cell.runs, cell.failures, share);
            let is_more = cell.failures as f64 > cell.runs as f64 * share;
            if is_more { deviance } else { -deviance }
        };
        let filled = all.iter().flatten().filter(|cell| cell.runs > 0);
        let clearest = filled.reduce(|a, b| if excess(b) > excess(a) { b } else { a });
        let mut corner = clearest.copied().unwrap_or_default();
        // Of few values, the lowest may stand in the middle by its rank.
        for (fifth, cells) in corner.fifths.iter_mut().zip([x, y]) {
            let of_values = cells.of_values().iter();
            if of_values.clone().all(|other| other >= fifth) {
                *fifth = 0;
            } else if of_values.clone().all(|other| other <= fifth) {
                *fifth = FIFTHS as u16 - 1;
            }
        }
        corner
    }
}

/// The first numbers of a column, with their ranks if none is missing.
struct Ranked<'a> {
    numbers: &'a [f64],
    ranks: Option<Ranks>,
}

impl<'a> Ranked<'a> {
    fn new(column: &'a [f64]) -> Self {
        let numbers = &column[..column.len().min(RANKED)];
        Self { numbers, ranks: Ranks::new(numbers).ok() }
    }
}

impl Correlation {
    /// None of too few runs that have both, and where either is the same in all of them.
    fn new(input: &str, x: &Ranked<'_>, outcome: &Ranked<'_>) -> Option<Self> {
        let rank = if let (Some(x), Some(y)) = (&x.ranks, &outcome.ranks) {
            RankCorrelation::of_ranks(x, y)
        } else {
            let both = x.numbers.iter().zip(outcome.numbers);
            let (x, y): (Vec<f64>, Vec<f64>) =
                both.filter(|(x, y)| x.is_finite() && y.is_finite()).unzip();
            RankCorrelation::new(&x, &y)
        };
        Some(Self { input: input.to_owned(), rank: rank.ok()? })
    }
}
