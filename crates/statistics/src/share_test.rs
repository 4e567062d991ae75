//! Whether the share of failed runs differs between cells, exactly where failures are few; and many such tests at once.

use crate::error::probability;
use crate::{StatisticsError, tail};

/// Failures to a cell are dealt one by one if it expects fewer than this.
const EXPECTED: f64 = 8.0;
/// Those to the smallest cell too, if it can have no more numbers of them than this.
const NUMBERS: usize = 1500;
/// The probability below which numbers of failures of a cell are left out.
const NEGLIGIBLE: f64 = 1e-20;
/// Steps of the statistic: so many for 1, and in all about so many.
const STEPS: f64 = 8.0;
const ALL_STEPS: f64 = 800.0;

/// Whether the share of failed runs is the same in all cells.
///
/// The statistic is Pearson's `X² = Σ (k − e)²/(e (1 − f/n))` of the failures k of the cells, where e is what is expected if the n
/// runs with f failures are dealt to the cells at random.
///
/// The p-value is the share of all ways to deal the failures that have such a statistic or a larger one (Freeman & Halton
/// 1951, doi:10.1093/biomet/38.1-2.141, with X² in the place of the probability). X² is rounded to 1/8, or to 1/800 of
/// what was found if that is larger, which moves ties and leaves the test exact. Two cells are dealt so up to some
/// thousand failures, and more cells where failures are few.
///
/// With many failures only the smaller cells are dealt so, one by one against all larger ones together: at least those that expect
/// fewer than eight failures (or successes, if these are fewer). Of the larger ones, X² from their own share is taken to be of χ²,
/// and the p-value is that of both sums together. So a rare cell, say of eleven runs that all failed, is found however
/// many others failed. A p-value is 10⁻²⁰ at least, which stands for all below.
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
        let freedom = strata.iter().map(|stratum| stratum.large.len() - 1).sum();
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

    fn share(self) -> f64 {
        self.failures as f64 / self.runs as f64
    }

    /// The odds of a failure.
    fn odds(self) -> f64 {
        self.failures as f64 / (self.runs - self.failures) as f64
    }

    /// What so many of these runs expect.
    fn expected(self, runs: u64) -> f64 {
        runs as f64 * self.share()
    }

    /// What a part of these runs adds to the statistic: (k N − n f)²/(n f (N − f)). Whole numbers, so that ties stay ties and failures
    /// may be called successes.
    fn term(self, part: Self) -> f64 {
        let [n, k, all, f] = [part.runs, part.failures, self.runs, self.failures].map(u128::from);
        let off = (k * all).abs_diff(n * f) as f64;
        off * off / (n as f64 * f as f64 * (all - f) as f64)
    }
}

/// Two cells or more, none of them empty, with failures and successes, of which failures are no more.
struct Stratum {
    /// The smaller cells, to which failures are dealt one by one, with how many each can have.
    dealt: Vec<(Cell, Numbers)>,
    /// The others, one at least: to deal, they are one cell.
    large: Vec<Cell>,
    all: Cell,
}

/// Numbers of failures from the first one on, and their weights.
struct Numbers {
    first: u64,
    weights: Vec<f64>,
}

impl Stratum {
    fn new(cells: &[Cell]) -> Option<Self> {
        let mut cells: Vec<Cell> = cells.iter().copied().filter(|cell| cell.runs > 0).collect();
        let mut all = Cell::sum(&cells);
        if 2 * all.failures > all.runs {
            let swap = |cell: &mut Cell| cell.failures = cell.runs - cell.failures;
            cells.iter_mut().chain([&mut all]).for_each(swap);
        }
        if cells.len() < 2 || all.failures == 0 {
            return None;
        }
        cells.sort_by_key(|cell| cell.runs);
        let mut stratum = Self { dealt: Vec::new(), large: Vec::new(), all };
        for (i, cell) in cells.iter().enumerate() {
            let numbers = stratum.numbers(cell.runs);
            let smallest = i == 0 && numbers.weights.len() <= NUMBERS;
            let is_dealt = smallest || all.expected(cell.runs) < EXPECTED;
            if !is_dealt || i + 1 == cells.len() {
                stratum.large = cells.split_off(i);
                break;
            }
            stratum.dealt.push((*cell, numbers));
        }
        Some(stratum)
    }

    /// The terms of the cells to which failures are dealt, of which the last are all large ones.
    fn terms(&self) -> impl Iterator<Item = f64> {
        let cells = self.dealt.iter().map(|(cell, _)| *cell).chain([Cell::sum(&self.large)]);
        cells.map(|cell| self.all.term(cell))
    }

    /// The statistic of the large cells from their own share.
    fn among_large(&self) -> f64 {
        let all = Cell::sum(&self.large);
        if all.failures == 0 || all.failures == all.runs {
            return 0.0;
        }
        self.large.iter().map(|cell| all.term(*cell)).sum()
    }

    /// How many failures a cell of so many runs can have: the share of its own ways, `C(n, k) (f/(N − f))^k`, but for the
    /// negligible ones.
    fn numbers(&self, runs: u64) -> Numbers {
        let odds = self.all.odds();
        // C(n, k + 1) of C(n, k).
        let ratio = |k: u64| (runs - k) as f64 / (k + 1) as f64 * odds;
        Numbers::around(self.all.expected(runs) as u64, 0..=runs.min(self.all.failures), ratio)
    }

    /// The same of the large cells together, by how many are dealt to the others, of these numbers:
    /// `C(n, f − k) ((N − f)/f)^k`.
    fn numbers_beside(&self, dealt: std::ops::RangeInclusive<u64>) -> Numbers {
        let (runs, failures) = (Cell::sum(&self.large).runs, self.all.failures);
        let odds = self.all.odds();
        let ratio = |k: u64| (failures - k) as f64 / (runs + k + 1 - failures) as f64 / odds;
        let least = failures.saturating_sub(runs).max(*dealt.start());
        let most = failures.min(*dealt.end());
        Numbers::around(self.all.expected(self.all.runs - runs) as u64, least..=most, ratio)
    }

    /// The probabilities of a statistic of 0, 1… steps, the last of that or more.
    fn distribution(&self, steps: &dyn Fn(f64) -> usize, last: usize) -> Vec<f64> {
        // By failures dealt so far, from the first number on.
        let mut first = 0;
        let mut dealt = vec![Masses::certain(last)];
        for (cell, numbers) in &self.dealt {
            let term = |failures| steps(self.all.term(Cell { runs: cell.runs, failures }));
            let ways: Vec<(usize, f64)> =
                numbers.all().map(|(failures, weight)| (term(failures), weight)).collect();
            let sum = |number: usize| {
                let least = (number + 1).saturating_sub(dealt.len());
                let ways = ways.iter().enumerate().take(number + 1).skip(least);
                Masses::sum(last, ways.map(|(i, way)| (&dealt[number - i], way.0, way.1)))
            };
            let next = (0..dealt.len() + ways.len() - 1).map(sum).collect();
            first += numbers.first;
            dealt = next;
        }
        let runs = Cell::sum(&self.large).runs;
        let beside = self.numbers_beside(first..=first + dealt.len() as u64 - 1);
        let ways = beside.all().map(|(before, weight)| {
            let failures = self.all.failures - before;
            let term = steps(self.all.term(Cell { runs, failures }));
            (&dealt[(before - first) as usize], term, weight)
        });
        let mut found = Masses::sum(last, ways).masses;
        let total: f64 = found.iter().sum();
        found.iter_mut().for_each(|mass| *mass /= total);
        found
    }
}

impl Numbers {
    /// Of a range, from the ratios of the weight of each number to the one before it, which fall: outwards from a number
    /// near the heaviest, as far as weights are not negligible.
    fn around(
        middle: u64,
        range: std::ops::RangeInclusive<u64>,
        ratio: impl Fn(u64) -> f64,
    ) -> Self {
        let (least, most) = range.into_inner();
        let middle = middle.min(most).max(least);
        let upwards = (middle..most).scan(1.0, |weight, k| {
            *weight *= ratio(k);
            Some(*weight)
        });
        let downwards = (least..middle).rev().scan(1.0, |weight, k| {
            *weight /= ratio(k);
            Some(*weight)
        });
        let kept = |weight: &f64| *weight >= NEGLIGIBLE;
        let mut weights: Vec<f64> = downwards.take_while(kept).collect();
        let first = middle - weights.len() as u64;
        weights.reverse();
        weights.push(1.0);
        weights.extend(upwards.take_while(kept));
        let sum: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|weight| *weight /= sum);
        Self { first, weights }
    }

    fn all(&self) -> impl Iterator<Item = (u64, f64)> {
        (self.first..).zip(self.weights.iter().copied())
    }
}

/// The probability of such a sum of the strata's statistics or a larger one, with so many degrees of freedom of large cells.
fn p_value(strata: &[Stratum], freedom: usize) -> f64 {
    let large: f64 = strata.iter().map(Stratum::among_large).sum();
    let statistic = strata.iter().flat_map(Stratum::terms).sum::<f64>();
    let scale = STEPS.min(ALL_STEPS / (large + statistic));
    let steps = |x: f64| libm::round(x * scale) as usize;
    let found: usize = strata.iter().flat_map(Stratum::terms).map(steps).sum();
    // With so many steps the cells to which failures are dealt need nothing of the large ones.
    let last = found + libm::ceil(large * scale) as usize;
    let mut all = Masses::certain(last);
    for stratum in strata {
        let own = stratum.distribution(&steps, last);
        let own = own.iter().enumerate().filter(|(_, mass)| **mass > 0.0);
        all = Masses::sum(last, own.map(|(at, mass)| (&all, at, *mass)));
    }
    // By what the large cells must add.
    let tail = |missing: f64| match freedom {
        _ if missing <= 0.0 => 1.0,
        0 => 0.0,
        freedom => tail::chi_squared(missing, freedom as f64),
    };
    let beyond =
        |(at, mass): (usize, &f64)| mass * tail(large + (found as f64 - at as f64) / scale);
    all.masses.iter().enumerate().map(beyond).sum::<f64>().clamp(NEGLIGIBLE, 1.0)
}

/// The probabilities of 0, 1… steps, of which the last place is for that or more.
struct Masses {
    masses: Vec<f64>,
    /// Where the first of them is that is not zero, or the last place.
    first: usize,
    /// From there on, the probability of so many steps or more. Behind these, there is nothing but in the last place: until several
    /// cells are dealt to, most places are empty.
    beyond: Vec<f64>,
}

impl Masses {
    /// All in the first place.
    fn certain(last: usize) -> Self {
        let mut masses = vec![0.0; last + 1];
        masses[0] = 1.0;
        Self { masses, first: 0, beyond: vec![1.0; 1.min(last)] }
    }

    /// The sum of others, each so many places further on and times a weight; what would stand beyond the last place stands there.
    fn sum<'a>(last: usize, of: impl Iterator<Item = (&'a Self, usize, f64)>) -> Self {
        let mut masses = vec![0.0; last + 1];
        let (mut first, mut end) = (last, 0);
        for (other, places, weight) in of {
            let room = last.saturating_sub(places);
            let inside = other.first..(other.first + other.beyond.len()).min(room);
            if inside.start < inside.end {
                let to = inside.start + places..inside.end + places;
                let pairs = masses[to.clone()].iter_mut().zip(&other.masses[inside]);
                pairs.for_each(|(to, of)| *to += of * weight);
                (first, end) = (first.min(to.start), end.max(to.end));
            }
            masses[last] += other.beyond(room) * weight;
        }
        let mut sum = masses[last];
        let mut beyond = masses[first..end.max(first)].to_vec();
        for mass in beyond.iter_mut().rev() {
            sum += *mass;
            *mass = sum;
        }
        Self { masses, first, beyond }
    }

    /// The probability of so many steps or more.
    fn beyond(&self, steps: usize) -> f64 {
        let place = steps.saturating_sub(self.first);
        self.beyond.get(place).copied().unwrap_or(self.masses[self.masses.len() - 1])
    }
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
