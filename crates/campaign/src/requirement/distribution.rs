//! The distribution of what a requirement is about: order statistics from tail to tail, with a band that holds all of it at once.

use gyradius_statistics::{Confidence, Proportion, StatisticsError, tail};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Ranks that are shown of many runs.
const SHOWN: u64 = 61;

/// The empirical distribution function of what a requirement is about, at some of its order statistics, with a band that holds
/// the whole distribution function of all runs at once with a confidence, whatever the distribution, with steps too.
///
/// The ranks are evenly spaced on the probability axis of a normal law, so that the extreme runs of both tails are among them;
/// of few runs they are all. At each rank k of K the distribution function lies between the quantiles of the beta law of k and
/// n − k + 1 that leave out (1 − c)/K in all: Clopper and Pearson's bounds with the confidence 1 − (1 − c)/K. So it lies between
/// them at all K with the confidence c (Bonferroni), and as no distribution function decreases, it lies between the ranks below
/// the upper bound of the next rank and above the lower bound of the one before.
///
/// Shares are of all runs that count. A run without a number that counts against the requirement stands beyond the limit: below all
/// numbers if they must be at least something, and else above all.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Distribution {
    /// Of the whole band.
    confidence: Confidence,
    points: Vec<DistributionPoint>,
}

/// An order statistic, and where the distribution function passes it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DistributionPoint {
    /// The rank among the runs that count, from 1 at the least.
    pub rank: u64,
    /// The number.
    pub value: f64,
    /// Where it is drawn: the share (rank − ½)/n, which is neither none nor all for the extreme runs.
    pub share: f64,
    /// The share of all runs that are at most the value is this at least.
    pub lower: f64,
    /// The share of all runs that are less than the value is this at most.
    pub upper: f64,
}

/// Runs that count in their order: those without a number that are below all numbers, the numbers, and those above all.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ranks {
    /// Of all three.
    pub(super) runs: u64,
    pub(super) below: u64,
    pub(super) values: u64,
}

impl Ranks {
    /// The ranks that are shown, from 1 at the first run that counts: those of the grid that have a number, the least and the greatest.
    fn shown(self, grid: &BTreeSet<u64>) -> BTreeSet<u64> {
        if self.values == 0 {
            return BTreeSet::new();
        }
        let (first, last) = (self.below + 1, self.below + self.values);
        grid.range(first..=last).copied().chain([first, last]).collect()
    }

    /// The same among the numbers, from 0 at the least: what is to be selected of them.
    pub(super) fn selected(self) -> impl Iterator<Item = u64> {
        self.shown(&grid(self.runs)).into_iter().map(move |rank| rank - self.below - 1)
    }
}

impl Distribution {
    /// Of runs whose numbers are known by their ranks, from 0; none if there are none.
    pub(super) fn new(
        ranks: Ranks,
        number: impl Fn(u64) -> Option<f64>,
        confidence: Confidence,
    ) -> Result<Option<Self>, StatisticsError> {
        let n = ranks.runs;
        let grid = grid(n);
        // Of so many that one would be certain there is no band.
        let each = 1.0 - (1.0 - confidence.level()) / grid.len().max(1) as f64;
        let Ok(each) = Confidence::new(each) else { return Ok(None) };
        let lower = |rank: u64| Ok(Proportion::new(rank, n)?.interval(each).lower());
        let upper = |rank: u64| Ok(Proportion::new(rank - 1, n)?.interval(each).upper());
        let mut points = Vec::new();
        for rank in ranks.shown(&grid) {
            let Some(value) = number(rank - ranks.below - 1) else { continue };
            let before = grid.range(..=rank).next_back().copied();
            let after = grid.range(rank..).next().copied();
            points.push(DistributionPoint {
                rank,
                value,
                share: (rank as f64 - 0.5) / n as f64,
                lower: before.map_or(Ok(0.0), lower)?,
                upper: after.map_or(Ok(1.0), upper)?,
            });
        }
        Ok((!points.is_empty()).then_some(Self { confidence, points }))
    }

    /// The confidence of the whole band.
    #[must_use]
    pub fn confidence(&self) -> Confidence {
        self.confidence
    }

    /// The order statistics, the least first.
    #[must_use]
    pub fn points(&self) -> &[DistributionPoint] {
        &self.points
    }

    /// Where the share of all runs that are at most a value lies, with the confidence of the band for all values at once.
    #[must_use]
    pub fn at(&self, value: f64) -> [f64; 2] {
        let before = self.points.iter().rev().find(|point| point.value <= value);
        let after = self.points.iter().find(|point| point.value > value);
        [before.map_or(0.0, |point| point.lower), after.map_or(1.0, |point| point.upper)]
    }
}

/// Ranks of so many runs, from 1: evenly spaced on the probability axis of a normal law, the first and the last too.
fn grid(n: u64) -> BTreeSet<u64> {
    if n <= SHOWN {
        return (1..=n).collect();
    }
    let (mut low, mut high) = (0.0, 40.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        *if n as f64 * tail::normal(middle) > 0.5 { &mut low } else { &mut high } = middle;
    }
    let half = (SHOWN - 1) / 2;
    let of_tail = |i: u64| {
        let share = tail::normal(low * i as f64 / half as f64);
        ((n as f64 * share + 0.5).round() as u64).clamp(1, n)
    };
    (0..=half).map(of_tail).flat_map(|rank| [rank, n + 1 - rank]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn of(
        mut numbers: Vec<f64>,
        [below, above]: [u64; 2],
        confidence: f64,
    ) -> Option<Distribution> {
        numbers.sort_by(f64::total_cmp);
        let values = numbers.len() as u64;
        let ranks = Ranks { runs: below + values + above, below, values };
        let number = |rank: u64| numbers.get(rank as usize).copied();
        Distribution::new(ranks, number, Confidence::new(confidence).unwrap()).unwrap()
    }

    proptest! {
        /// From few runs to a thousand million: both ends, and no gap on the axis of a normal law that is much wider than another.
        #[test]
        fn the_grid_reaches_from_end_to_end(n in prop_oneof![1..100_u64, 1..1_000_000_000_u64]) {
            let grid: Vec<u64> = grid(n).into_iter().collect();
            prop_assert_eq!((grid[0], grid[grid.len() - 1]), (1, n));
            // An even number has two in the middle.
            prop_assert!(grid.len() as u64 <= (SHOWN + 1).min(n));
            if n > 1000 {
                // The extreme runs of either tail are near each other there, and both tails are alike.
                prop_assert!(grid[1] <= 3 && grid[2] <= 9);
                prop_assert!(grid.iter().zip(grid.iter().rev()).all(|(a, b)| a + b == n + 1));
            }
        }
    }

    /// The band holds the distribution function at every value, also with steps, in more samples than its confidence says.
    #[test]
    fn the_band_holds_the_distribution_as_often_as_it_says() {
        for (n, steps, failing, confidence) in [
            (5_u64, 0.0, 0.0, 0.6),
            (40, 4.0, 0.1, 0.5),
            (700, 0.0, 0.02, 0.5),
            (700, 30.0, 0.0, 0.9),
        ] {
            let mut rng = ChaCha8Rng::seed_from_u64(n + steps as u64);
            let (mut held, mut narrow) = (0, 0);
            const SAMPLES: u32 = 600;
            for _ in 0..SAMPLES {
                let mut numbers = Vec::new();
                for _ in 0..n {
                    let u: f64 = rng.random();
                    // Some runs have no number and stand above all.
                    if rng.random::<f64>() >= failing {
                        numbers.push(if steps > 0.0 { (u * steps).floor() / steps } else { u });
                    }
                }
                let above = n - numbers.len() as u64;
                let band = of(numbers, [0, above], confidence).unwrap();
                let truth = |x: f64| {
                    let share = if steps > 0.0 { ((x * steps).floor() + 1.0) / steps } else { x };
                    (1.0 - failing) * share.clamp(0.0, 1.0)
                };
                // Where the function may leave the band: at each value, and just before it.
                let mut places: Vec<f64> = band.points().iter().map(|p| p.value).collect();
                places.extend((0..=400).map(|i| f64::from(i) / 400.0));
                let around = places.iter().flat_map(|x| [*x, x.next_down()]);
                let holds = |x: f64| {
                    let [lower, upper] = band.at(x);
                    (lower..=upper).contains(&truth(x))
                };
                held += u32::from(around.filter(|x| (0.0..1.0).contains(x)).all(holds));
                let [lower, upper] = band.at(0.5);
                narrow += u32::from(upper - lower < 0.4);
            }
            // Three standard deviations of the number of samples.
            let least =
                confidence - 3.0 * (confidence * (1.0 - confidence) / f64::from(SAMPLES)).sqrt();
            assert!(f64::from(held) >= least * f64::from(SAMPLES), "{n} {steps}: {held}");
            // And it is no band that holds everything.
            assert!(n < 100 || narrow == SAMPLES, "{n} {steps}: {narrow}");
        }
    }

    #[test]
    fn runs_without_numbers_stand_beyond_the_limit() {
        let above = of(vec![1.0, 2.0], [0, 2], 0.9).unwrap();
        let shares: Vec<f64> = above.points().iter().map(|p| p.share).collect();
        assert_eq!(shares, [0.125, 0.375]);
        let below = of(vec![1.0, 2.0], [2, 0], 0.9).unwrap();
        let shares: Vec<f64> = below.points().iter().map(|p| p.share).collect();
        assert_eq!(shares, [0.625, 0.875]);
        assert_eq!(of(vec![], [0, 3], 0.9), None);
        // The quantiles of the beta law of one run: (1 − c)/2 and its complement.
        let one = of(vec![7.0], [0, 0], 0.9).unwrap();
        let DistributionPoint { rank, value, share, lower, upper } = one.points()[0];
        assert_eq!((rank, value, share), (1, 7.0, 0.5));
        assert!((lower - 0.05).abs() < 1e-12 && (upper - 0.95).abs() < 1e-12);
    }
}
