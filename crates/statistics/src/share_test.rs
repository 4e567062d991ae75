//! Whether the share of failed runs differs between cells, exactly where failures are few; and many such tests at once.

use crate::error::probability;
use crate::{StatisticsError, tail};

/// Up to this many failures (or successes, if they are fewer) in a stratum the test is exact.
const EXACT: u64 = 60;
/// Expected failures of a cell from which χ² is trusted.
const EXPECTED: f64 = 5.0;
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
/// what was found if that is larger, which moves ties and leaves the test exact. Above, it is the tail of χ², after neighbouring cells
/// have been put together until each expects five failures and five successes.
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
        let strata: Vec<Stratum> = strata.iter().filter_map(|cells| Stratum::new(cells)).collect();
        if strata.iter().all(|stratum| stratum.failures <= EXACT) {
            return Self { p_value: exact(&strata), exact: true };
        }
        let (mut statistic, mut freedom) = (0.0, 0);
        for merged in strata.iter().map(Stratum::merged) {
            statistic += merged.statistic();
            freedom += merged.cells.len() - 1;
        }
        let p_value = if freedom == 0 { 1.0 } else { tail::chi_squared(statistic, freedom as f64) };
        Self { p_value, exact: false }
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

    pub(crate) fn and(self, other: Self) -> Self {
        Self { runs: self.runs + other.runs, failures: self.failures + other.failures }
    }
}

/// Two cells or more, none of them empty, with failures and successes, of which failures are no more.
struct Stratum {
    cells: Vec<Cell>,
    runs: u64,
    failures: u64,
}

impl Stratum {
    fn new(cells: &[Cell]) -> Option<Self> {
        let mut cells: Vec<Cell> = cells.iter().copied().filter(|cell| cell.runs > 0).collect();
        let all = cells.iter().copied().fold(Cell::default(), Cell::and);
        if 2 * all.failures > all.runs {
            cells.iter_mut().for_each(|cell| cell.failures = cell.runs - cell.failures);
        }
        let failures = all.failures.min(all.runs - all.failures);
        (cells.len() > 1 && failures > 0).then_some(Self { cells, runs: all.runs, failures })
    }

    /// What a cell of so many runs expects.
    fn expected(&self, runs: u64) -> f64 {
        runs as f64 * (self.failures as f64 / self.runs as f64)
    }

    /// What so many failures in a cell of so many runs add to the statistic.
    fn term(&self, runs: u64, failures: u64) -> f64 {
        let expected = self.expected(runs);
        let share = self.failures as f64 / self.runs as f64;
        (failures as f64 - expected).powi(2) / (expected * (1.0 - share))
    }

    fn statistic(&self) -> f64 {
        self.cells.iter().map(|cell| self.term(cell.runs, cell.failures)).sum()
    }

    /// With neighbours put together until each expects enough; failures are no more than successes, so these do too.
    fn merged(&self) -> Self {
        let mut cells: Vec<Cell> = Vec::new();
        let mut open = Cell::default();
        for cell in &self.cells {
            open = open.and(*cell);
            if self.expected(open.runs) >= EXPECTED {
                cells.push(std::mem::take(&mut open));
            }
        }
        match cells.last_mut() {
            Some(last) => *last = last.and(open),
            None => cells.push(open),
        }
        Self { cells, runs: self.runs, failures: self.failures }
    }

    /// The probabilities of a statistic of 0, 1… steps, the last of that or more.
    fn distribution(&self, steps: &dyn Fn(f64) -> usize, last: usize) -> Vec<f64> {
        let all = self.failures as usize;
        // By failures dealt so far.
        let mut dealt = vec![vec![0.0; last + 1]; all + 1];
        dealt[0][0] = 1.0;
        let odds = self.failures as f64 / (self.runs - self.failures) as f64;
        let (mut here, mut later) = (0, self.runs);
        for cell in &self.cells {
            let mut next = vec![vec![0.0; last + 1]; all + 1];
            let mut weight = 1.0;
            later -= cell.runs;
            // Most that can have been dealt before, and least with this cell, as later ones take no more than their runs.
            let (most, least) = (here.min(all), (all as u64).saturating_sub(later) as usize);
            let own = all.min(usize::try_from(cell.runs).unwrap_or(usize::MAX));
            here = most + own;
            for failures in 0..=own {
                let term = steps(self.term(cell.runs, failures as u64)).min(last);
                for before in least.saturating_sub(failures)..=most.min(all - failures) {
                    add_shifted(&mut next[before + failures], &dealt[before], term, weight);
                }
                // (n choose k + 1) of (n choose k).
                weight *= (cell.runs as f64 - failures as f64) / (failures as f64 + 1.0) * odds;
            }
            dealt = next;
        }
        let mut found = std::mem::take(&mut dealt[all]);
        let total: f64 = found.iter().sum();
        found.iter_mut().for_each(|mass| *mass /= total);
        found
    }
}

/// The probability of such a sum of the strata's statistics or a larger one.
fn exact(strata: &[Stratum]) -> f64 {
    let found: f64 = strata.iter().map(Stratum::statistic).sum();
    let scale = STEPS.min(ALL_STEPS / found);
    let steps = |x: f64| libm::round(x * scale) as usize;
    let of_cell = |stratum: &Stratum| -> usize {
        stratum.cells.iter().map(|cell| steps(stratum.term(cell.runs, cell.failures))).sum()
    };
    let last = strata.iter().map(of_cell).sum();
    let mut all = vec![0.0; last + 1];
    all[0] = 1.0;
    for stratum in strata {
        let own = stratum.distribution(&steps, last);
        let mut next = vec![0.0; last + 1];
        for (at, mass) in own.iter().enumerate().filter(|(_, mass)| **mass > 0.0) {
            add_shifted(&mut next, &all, at, *mass);
        }
        all = next;
    }
    // From 0 steps on is all there is.
    if last == 0 { 1.0 } else { all[last].min(1.0) }
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
