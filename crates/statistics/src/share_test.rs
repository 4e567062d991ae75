//! Whether the share of failed runs differs between cells, exactly where failures are few; and many such tests at once.

use crate::error::probability;
use crate::{StatisticsError, tail};

/// Up to this many failures (or successes, if they are fewer) in every stratum all cells are dealt exactly.
const EXACT: u64 = 60;
/// Expected failures of a cell from which χ² is trusted.
const EXPECTED: f64 = 10.0;
/// The probability below which numbers of failures in a cell are left out, where cells are too many to deal them all.
const NEGLIGIBLE: f64 = 1e-30;
/// Steps of the exact test's statistic: so many for 1, and in all about so many.
const STEPS: f64 = 16.0;
const ALL_STEPS: f64 = 1600.0;

/// Whether the share of failed runs is the same in all cells.
///
/// The statistic is Pearson's `X² = Σ (k − e)²/(e (1 − f/n))` of the failures k of the cells, where e is what is expected if the n
/// runs with f failures are dealt to the cells at random.
///
/// With up to 60 failures (or successes, if these are fewer) the p-value is exact, whatever the sizes of the cells: the
/// share of all ways to deal the failures that have such a statistic or a larger one (Freeman & Halton 1951,
/// doi:10.1093/biomet/38.1-2.141, with X² in the place of the probability). X² is rounded to 1/16, or to 1/1600 of
/// what was found if that is larger, which moves ties and leaves the test exact.
///
/// Above, only cells that expect fewer than ten failures are dealt so, against all others together. Of the others, X² from
/// their own share is taken to be of χ². The p-value is that of both sums together, and is given as 10⁻³⁰ at least. A rare cell, say of
/// eleven runs that all failed, is found by this however many others failed.
#[derive(Clone, Copy, Debug, PartialEq, getset::CopyGetters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(remote = "Self"))]
#[getset(get_copy = "pub")]
pub struct ShareTest {
    /// The probability of cells at least as different, if all have the same share: 1 without a failure, without a success,
    /// and with one cell.
    p_value: f64,
    /// Whether it is exact, and not of χ².
    exact: bool,
}

crate::checked::checked!(ShareTest, |read| crate::error::belong(
    (0.0..=1.0).contains(&read.p_value),
    "test"
));

impl ShareTest {
    /// Of cells in strata: within each stratum the failures are dealt at random.
    pub(crate) fn new(strata: &[Vec<Cell>]) -> Self {
        let mut strata: Vec<Stratum> =
            strata.iter().filter_map(|cells| Stratum::new(cells)).collect();
        if strata.iter().any(|stratum| stratum.failures > EXACT) {
            strata.iter_mut().for_each(Stratum::split);
        }
        let freedom: usize =
            strata.iter().map(|stratum| stratum.large.len().saturating_sub(1)).sum();
        Self { p_value: p_value(&strata, freedom), exact: freedom == 0 }
    }
}

/// How many runs, and how many of them failed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Cell {
    pub(crate) runs: u64,
    pub(crate) failures: u64,
}

impl Cell {
    pub(crate) fn add(&mut self, failed: bool) {
        self.runs += 1;
        self.failures += u64::from(failed);
    }

    pub(crate) fn sum(cells: impl IntoIterator<Item = impl std::borrow::Borrow<Self>>) -> Self {
        cells.into_iter().fold(Self::default(), |all, cell| {
            let cell = cell.borrow();
            Self { runs: all.runs + cell.runs, failures: all.failures + cell.failures }
        })
    }
}

/// Two cells or more, none of them empty, with failures and successes, of which failures are no more.
struct Stratum {
    /// The cells to which failures are dealt one by one.
    cells: Vec<Cell>,
    /// The others: to deal, they are one cell.
    large: Vec<Cell>,
    runs: u64,
    failures: u64,
}

impl Stratum {
    fn new(cells: &[Cell]) -> Option<Self> {
        let mut cells: Vec<Cell> = cells.iter().copied().filter(|cell| cell.runs > 0).collect();
        let all = Cell::sum(&cells);
        if 2 * all.failures > all.runs {
            cells.iter_mut().for_each(|cell| cell.failures = cell.runs - cell.failures);
        }
        let failures = all.failures.min(all.runs - all.failures);
        let large = Vec::new();
        (cells.len() > 1 && failures > 0).then_some(Self { cells, large, runs: all.runs, failures })
    }

    /// Sets apart the cells that expect enough failures for χ²; failures are no more than successes, so these are enough too.
    fn split(&mut self) {
        let cells = std::mem::take(&mut self.cells);
        (self.large, self.cells) =
            cells.into_iter().partition(|cell| self.expected(cell.runs) >= EXPECTED);
    }

    /// What a cell of so many runs expects.
    fn expected(&self, runs: u64) -> f64 {
        runs as f64 * (self.failures as f64 / self.runs as f64)
    }

    /// What so many failures in a cell of so many runs add to the statistic.
    fn term(&self, runs: u64, failures: u64) -> f64 {
        if runs == 0 {
            return 0.0;
        }
        let expected = self.expected(runs);
        let share = self.failures as f64 / self.runs as f64;
        (failures as f64 - expected).powi(2) / (expected * (1.0 - share))
    }

    /// The terms of the cells to which failures are dealt, of which the last are all large ones.
    fn terms(&self) -> impl Iterator<Item = f64> {
        let large = Cell::sum(&self.large);
        self.cells.iter().copied().chain([large]).map(|cell| self.term(cell.runs, cell.failures))
    }

    /// The statistic of the large cells from their own share.
    fn among_large(&self) -> f64 {
        Self::new(&self.large).map_or(0.0, |large| large.terms().sum())
    }

    /// The odds of a failure.
    fn odds(&self) -> f64 {
        self.failures as f64 / (self.runs - self.failures) as f64
    }

    /// In how many ways a cell of so many runs can have 0, 1… failures, of all: their probabilities but for the others' ways.
    fn weights(&self, runs: u64) -> Vec<f64> {
        let odds = self.odds();
        let most = runs.min(self.failures);
        let mut weights = vec![1.0];
        let mut sum = 1.0;
        for failures in 0..most {
            // (n choose k + 1) of (n choose k).
            let ratio = (runs - failures) as f64 / (failures as f64 + 1.0) * odds;
            let next = weights[weights.len() - 1] * ratio;
            if !self.large.is_empty() && ratio < 1.0 && next < NEGLIGIBLE * sum {
                break;
            }
            weights.push(next);
            sum += next;
        }
        weights.iter_mut().for_each(|weight| *weight /= sum);
        weights
    }

    /// In how many ways, up to a factor, the large cells take what is left if so many failures are dealt before.
    fn ways_of_large(&self, most: usize) -> Vec<f64> {
        let (runs, all) = (Cell::sum(&self.large).runs, self.failures);
        let least = all.saturating_sub(runs);
        let mut ways = vec![0.0; most + 1];
        let mut weight = 1.0;
        for dealt in least..=all.min(most as u64) {
            ways[dealt as usize] = weight;
            let left = all - dealt;
            weight *= left as f64 / (runs - left + 1) as f64 / self.odds();
        }
        ways
    }

    /// The probabilities of a statistic of 0, 1… steps, the last of that or more.
    fn distribution(&self, steps: &dyn Fn(f64) -> usize, last: usize) -> Vec<f64> {
        let all = self.failures as usize;
        let weights: Vec<Vec<f64>> =
            self.cells.iter().map(|cell| self.weights(cell.runs)).collect();
        let most_dealt = weights.iter().map(|weights| weights.len() - 1).sum::<usize>().min(all);
        // By failures dealt so far.
        let mut dealt = vec![vec![0.0; last + 1]; most_dealt + 1];
        dealt[0][0] = 1.0;
        let (mut most, mut later) = (0, self.runs);
        for (cell, weights) in self.cells.iter().zip(&weights) {
            let mut next = vec![vec![0.0; last + 1]; most_dealt + 1];
            later -= cell.runs;
            // The least with this cell, as later ones take no more than their runs.
            let least = (all as u64).saturating_sub(later) as usize;
            for (failures, weight) in weights.iter().enumerate() {
                let term = steps(self.term(cell.runs, failures as u64)).min(last);
                let before = least.saturating_sub(failures)..=most.min(most_dealt - failures);
                for before in before {
                    add_shifted(&mut next[before + failures], &dealt[before], term, *weight);
                }
            }
            most = (most + weights.len() - 1).min(most_dealt);
            dealt = next;
        }
        let (large, mut found) = (Cell::sum(&self.large), vec![0.0; last + 1]);
        for (before, ways) in self.ways_of_large(most_dealt).iter().enumerate() {
            let term = self.term(large.runs, (all - before) as u64);
            add_shifted(&mut found, &dealt[before], steps(term).min(last), *ways);
        }
        let total: f64 = found.iter().sum();
        found.iter_mut().for_each(|mass| *mass /= total);
        found
    }
}

/// The probability of such a sum of the strata's statistics or a larger one, with so many degrees of freedom of large cells.
fn p_value(strata: &[Stratum], freedom: usize) -> f64 {
    let large: f64 = strata.iter().map(Stratum::among_large).sum();
    let scale =
        STEPS.min(ALL_STEPS / (large + strata.iter().flat_map(Stratum::terms).sum::<f64>()));
    let steps = |x: f64| libm::round(x * scale) as usize;
    let found: usize = strata.iter().flat_map(Stratum::terms).map(steps).sum();
    // With so many steps the cells to which failures are dealt need nothing of the large ones.
    let last = found + libm::ceil(large * scale) as usize;
    let mut all = vec![0.0; last + 1];
    all[0] = 1.0;
    for stratum in strata.iter().filter(|stratum| !stratum.cells.is_empty()) {
        let own = stratum.distribution(&steps, last);
        let mut next = vec![0.0; last + 1];
        for (at, mass) in own.iter().enumerate().filter(|(_, mass)| **mass > 0.0) {
            add_shifted(&mut next, &all, at, *mass);
        }
        all = next;
    }
    // By what the large cells must add.
    let tail = |missing: f64| match freedom {
        _ if missing <= 0.0 => 1.0,
        0 => 0.0,
        freedom => tail::chi_squared(missing, freedom as f64),
    };
    let beyond =
        |(at, mass): (usize, &f64)| mass * tail(large + (found as f64 - at as f64) / scale);
    let p_value: f64 = all.iter().enumerate().map(beyond).sum();
    let least =
        if strata.iter().all(|stratum| stratum.large.is_empty()) { 0.0 } else { NEGLIGIBLE };
    p_value.clamp(least, 1.0)
}

/// Adds probabilities times a weight so many places further on; what would stand beyond the last place stands there.
fn add_shifted(to: &mut [f64], of: &[f64], places: usize, weight: f64) {
    let inside = of.len() - 1 - places;
    to[places..].iter_mut().zip(&of[..inside]).for_each(|(to, of)| *to += of * weight);
    to[of.len() - 1] += of[inside..].iter().sum::<f64>() * weight;
}

/// The p-values of many tests, adjusted so that each may be held against a risk for all together (Holm 1979, Scand. J.
/// Statist. 6, 65–70): at most that risk of one false finding or more, however the tests depend on each other.
///
/// In the order in which they were given.
///
/// ```
/// assert_eq!(gyradius_statistics::holm(&[0.5, 0.01, 0.25])?, [0.5, 0.03, 0.5]);
/// # Ok::<(), gyradius_statistics::StatisticsError>(())
/// ```
///
/// # Errors
///
/// [`StatisticsError::Probability`] for a number that is no probability.
pub fn holm(p_values: &[f64]) -> Result<Vec<f64>, StatisticsError> {
    for p in p_values {
        probability(*p)?;
    }
    let mut order: Vec<usize> = (0..p_values.len()).collect();
    order.sort_by(|&i, &j| p_values[i].total_cmp(&p_values[j]));
    let mut adjusted = vec![0.0; p_values.len()];
    let mut least = 0.0_f64;
    for (left, &i) in (1..=p_values.len()).rev().zip(&order) {
        least = least.max(p_values[i] * left as f64).min(1.0);
        adjusted[i] = least;
    }
    Ok(adjusted)
}

#[cfg(test)]
mod tests;
