//! What a sample looks like, found in a few passes over its values: in flat memory, and exact.

use std::collections::BTreeSet;

use crate::centred::{Centred, Powers};
use crate::deviation::{self, trimmed};
use crate::groups::{GroupSums, Grouped};
use crate::quantile::{between, interval_ranks, type_7_place};
use crate::selection::{Count, Selection};
use crate::{Confidence, Deviation, ExactSum, Interval, Moments, SortedSample};

/// Values of a sample that are kept, at most: of every so manieth run.
const SAMPLE: u64 = 1 << 15;

/// What a sample of any size looks like, found in passes over its values.
///
/// The values come in parts, of any size and in any order, as often as [`pass`](Self::pass) asks for them. What
/// is found is what [`Moments`], [`Deviation`] and [`SortedSample`] find of the whole sample, to the bit: sums
/// are exact, quantiles are order statistics found by counting and selection. The memory does not grow with the
/// sample. Up to some ten thousands of values one pass is enough, up to millions two are.
///
/// ```
/// use gyradius_statistics::{Confidence, Moments, Survey};
///
/// let values: Vec<f64> = (0..200_000_u32).map(|i| f64::from(i * 7919 % 200_003)).collect();
/// let mut survey = Survey::new(values.len() as u64).quantiles([0.5, 0.95]);
/// while let Some(empty) = survey.pass() {
///     let mut whole = empty.clone();
///     for (i, part) in values.chunks(1000).enumerate() {
///         let mut pass = empty.clone();
///         pass.extend((i as u64 * 1000..).zip(part.iter().copied()));
///         whole.merge(pass);
///     }
///     survey.advance(whole);
/// }
/// assert_eq!(survey.moments(), Some(&Moments::new(&values)?));
/// assert!((survey.quantile(0.5).unwrap() - 1e5).abs() < 100.0);
/// # Ok::<(), gyradius_statistics::StatisticsError>(())
/// ```
#[derive(Clone, Debug, getset::CopyGetters)]
pub struct Survey {
    runs: u64,
    /// The values of every so manieth run are kept.
    #[getset(get_copy = "pub")]
    stride: u64,
    quantiles: Vec<f64>,
    intervals: Vec<(f64, Confidence)>,
    /// Of runs in groups whose values have something in common.
    groups: Option<Box<Groups>>,
    /// None until the first pass is done.
    known: Option<Known>,
}

/// Runs in groups.
#[derive(Clone, Debug)]
struct Groups {
    /// Runs of a group.
    size: u64,
    /// The first run of each group, by the number of the group: these are independent.
    first: Survey,
}

/// What is known after the first pass.
#[derive(Clone, Debug)]
struct Known {
    n: u64,
    /// The smallest and the largest value, each with the first run that has it; none if there is no value.
    range: Option<[(f64, u64); 2]>,
    /// How many values are kept, and the finite ones of them.
    sampled: u64,
    sample: Option<SortedSample>,
    /// None if there is no value or one that is not finite.
    finite: Option<Finite>,
}

#[derive(Clone, Debug)]
struct Finite {
    sum: ExactSum,
    /// None if all values are the same.
    centred: Option<Centred>,
    powers: Option<Powers>,
    selection: Selection,
    moments: Option<Moments>,
    deviation: Option<Deviation>,
    /// None until they are gathered, where there are any.
    grouped: Option<Grouped>,
}

/// What is gathered from all values of a sample in one go.
#[derive(Clone, Debug)]
pub struct Pass {
    /// None if all is known of all values.
    gathered: Option<Gathered>,
    /// Runs of a group, and what is gathered from the first run of each.
    first: Option<(u64, Box<Pass>)>,
}

#[derive(Clone, Debug)]
enum Gathered {
    First(Box<First>),
    Later(Box<Later>),
}

#[derive(Clone, Debug)]
struct First {
    stride: u64,
    n: u64,
    finite: u64,
    sum: ExactSum,
    range: Option<[(f64, u64); 2]>,
    sampled: u64,
    sample: Vec<f64>,
}

#[derive(Clone, Debug)]
struct Later {
    /// None if all values are the same.
    centred: Option<Centred>,
    powers: Option<Powers>,
    count: Option<Count>,
    groups: Option<GroupSums>,
}

impl Survey {
    /// Of a sample to which at most so many runs contribute, numbered from 0.
    #[must_use]
    pub fn new(runs: u64) -> Self {
        let stride = runs.div_ceil(SAMPLE).max(1).next_power_of_two();
        Self {
            runs,
            stride,
            quantiles: Vec::new(),
            intervals: Vec::new(),
            groups: None,
            known: None,
        }
    }

    /// The same for runs that come in groups of so many, of which those of a group have something in common: intervals
    /// take account of it, if it is said last. Of one run each, groups are nothing.
    ///
    /// The intervals of mean and deviation take groups for what is independent. Those of quantiles are of the first run of
    /// each group alone, and so as exact as any. Each call of [`Pass::extend`] must be of consecutive runs in their order.
    #[must_use]
    pub fn in_groups_of(mut self, size: u64) -> Self {
        if size > 1 {
            let intervals = self.intervals.clone();
            let first = Self { intervals, ..Self::new(self.runs.div_ceil(size)) };
            self.groups = Some(Box::new(Groups { size, first }));
        }
        self
    }

    /// The runs that are independent of each other, as far as is known: the first of each group, by the number of
    /// the group, or all if there are no groups.
    #[must_use]
    pub fn independent(&self) -> &Self {
        self.groups.as_ref().map_or(self, |groups| &groups.first)
    }

    /// With the quantiles of these probabilities; those that are no probabilities are not found.
    #[must_use]
    pub fn quantiles(mut self, probabilities: impl IntoIterator<Item = f64>) -> Self {
        self.quantiles.extend(probabilities.into_iter().filter(|p| (0.0..=1.0).contains(p)));
        self
    }

    /// With an interval for the quantile of a probability.
    #[must_use]
    pub fn quantile_interval_at(mut self, probability: f64, confidence: Confidence) -> Self {
        self.intervals
            .extend((0.0..=1.0).contains(&probability).then_some((probability, confidence)));
        self
    }

    /// What is to be gathered from all values next, empty; none if all is known.
    #[must_use]
    pub fn pass(&self) -> Option<Pass> {
        let gathered = self.own_pass();
        let of_first = |groups: &Groups| Some((groups.size, Box::new(groups.first.pass()?)));
        let first = self.groups.as_deref().and_then(of_first);
        (gathered.is_some() || first.is_some()).then_some(Pass { gathered, first })
    }

    fn own_pass(&self) -> Option<Gathered> {
        let Some(known) = &self.known else {
            let first = First {
                stride: self.stride,
                n: 0,
                finite: 0,
                sum: ExactSum::new(),
                range: None,
                sampled: 0,
                sample: Vec::new(),
            };
            return Some(Gathered::First(Box::new(first)));
        };
        let finite = known.finite.as_ref()?;
        let centred = finite.centred;
        let powers = (centred.is_some() && finite.powers.is_none()).then(Powers::default);
        let count = finite.selection.pass().cloned();
        let missing = centred.is_some() && finite.grouped.is_none();
        let groups = self.groups.as_ref().filter(|_| missing);
        let groups = groups.map(|groups| GroupSums::new(groups.size));
        let waits = powers.is_some() || count.is_some() || groups.is_some();
        waits.then(|| Gathered::Later(Box::new(Later { centred, powers, count, groups })))
    }

    /// Takes up what was gathered from all values.
    pub fn advance(&mut self, pass: Pass) {
        self.advance_selecting(pass, []);
    }

    /// The same, and lets what is gathered next find the order statistics of these ranks too, from 0. Ranks count after the first pass
    /// alone, by when the number of values is known.
    pub fn advance_selecting(&mut self, pass: Pass, ranks: impl IntoIterator<Item = u64>) {
        if let (Some(groups), Some((_, first))) = (&mut self.groups, pass.first) {
            groups.first.advance(*first);
        }
        let Some(gathered) = pass.gathered else { return };
        match (gathered, &mut self.known) {
            (Gathered::First(first), known) => {
                *known = Some(first.known(|n| {
                    let cut = trimmed(n);
                    let ends =
                        if n < deviation::FEWEST as u64 { vec![] } else { vec![cut, n - cut - 1] };
                    let places = self.quantiles.iter().map(|p| type_7_place(n, *p).0);
                    let places = places.flat_map(|place| [place, place + 1]);
                    let bounds = self.intervals.iter().flat_map(|(p, confidence)| {
                        let (lower, upper) = interval_ranks(n, *p, *confidence);
                        [lower, upper].into_iter().flatten()
                    });
                    places.chain(bounds).chain(ends).chain(ranks).collect()
                }));
            }
            (
                Gathered::Later(later),
                Some(Known { n, range: Some(range), finite: Some(finite), .. }),
            ) => {
                finite.advance(*later, *n, range.map(|(x, _)| x));
            }
            (Gathered::Later(_), _) => {}
        }
    }

    /// Number of values, finite or not.
    #[must_use]
    pub fn n(&self) -> u64 {
        self.known.as_ref().map_or(0, |known| known.n)
    }

    /// The smallest value and the first run that has it; none if there is no value, or one that is not finite.
    #[must_use]
    pub fn minimum(&self) -> Option<(f64, u64)> {
        let known = self.known.as_ref()?;
        known.finite.as_ref().and(known.range).map(|[minimum, _]| minimum)
    }

    /// The largest value and the first run that has it; none if there is no value, or one that is not finite.
    #[must_use]
    pub fn maximum(&self) -> Option<(f64, u64)> {
        let known = self.known.as_ref()?;
        known.finite.as_ref().and(known.range).map(|[_, maximum]| maximum)
    }

    /// The mean, of one value too; none if there is no value, or one that is not finite.
    #[must_use]
    pub fn mean(&self) -> Option<f64> {
        let finite = self.finite().filter(|_| self.n() > 0)?;
        let of_sum = || finite.sum.mean(self.n());
        Some(finite.moments.as_ref().map_or_else(of_sum, Moments::mean))
    }

    /// The moments, where [`Moments::new`] has them.
    #[must_use]
    pub fn moments(&self) -> Option<&Moments> {
        self.finite()?.moments.as_ref()
    }

    /// The standard deviation with its kurtosis, where [`Deviation::new`] has them.
    #[must_use]
    pub fn deviation(&self) -> Option<&Deviation> {
        self.finite()?.deviation.as_ref()
    }

    /// A quantile that was asked for by [`quantiles`](Self::quantiles), as [`SortedSample::quantile`] has it; none of any other.
    #[must_use]
    pub fn quantile(&self, p: f64) -> Option<f64> {
        if !self.quantiles.contains(&p) {
            return None;
        }
        let n = self.n();
        let (place, share) = type_7_place(n, p);
        let below = self.at(place)?;
        Some(if place + 1 < n { between(below, self.at(place + 1)?, share) } else { below })
    }

    /// An interval that was asked for by [`quantile_interval_at`](Self::quantile_interval_at), as
    /// [`SortedSample::quantile_interval`] has it; of groups, that of the first run of each. None of any other.
    #[must_use]
    pub fn quantile_interval(&self, p: f64, confidence: Confidence) -> Option<Interval> {
        if let Some(groups) = &self.groups {
            return groups.first.quantile_interval(p, confidence);
        }
        if !self.intervals.contains(&(p, confidence)) {
            return None;
        }
        self.finite()?;
        let (lower, upper) = interval_ranks(self.n(), p, confidence);
        let at = |rank: Option<u64>, none: f64| rank.map_or(Some(none), |rank| self.at(rank));
        let (lower, upper) = (at(lower, f64::NEG_INFINITY)?, at(upper, f64::INFINITY)?);
        Some(Interval::ordered(lower, upper, confidence))
    }

    /// The finite values of some runs that are evenly spaced, of all runs if these are few.
    #[must_use]
    pub fn sample(&self) -> Option<&SortedSample> {
        self.known.as_ref()?.sample.as_ref()
    }

    /// How many values there are of those runs, finite or not.
    #[must_use]
    pub fn sampled(&self) -> u64 {
        self.known.as_ref().map_or(0, |known| known.sampled)
    }

    /// The value of a rank, from 0 at the smallest, if it was [selected](Self::advance_selecting) or is that of a quantile; all of
    /// them if all values are the same.
    #[must_use]
    pub fn order_statistic(&self, rank: u64) -> Option<f64> {
        self.at(rank)
    }

    fn finite(&self) -> Option<&Finite> {
        self.known.as_ref()?.finite.as_ref()
    }

    fn at(&self, rank: u64) -> Option<f64> {
        self.finite()?.selection.value(rank)
    }
}

impl First {
    fn add(&mut self, run: u64, x: f64) {
        self.n += 1;
        let kept = run.is_multiple_of(self.stride);
        self.sampled += u64::from(kept);
        if !x.is_finite() {
            return;
        }
        self.finite += 1;
        self.sum.add(x);
        self.stretch([(x, run); 2]);
        if kept {
            self.sample.push(x);
        }
    }

    /// Takes up a range. The order of the values tells −0 from 0, and the first of equal ones counts.
    fn stretch(&mut self, [least, most]: [(f64, u64); 2]) {
        let Some([low, high]) = &mut self.range else {
            self.range = Some([least, most]);
            return;
        };
        if least.0.total_cmp(&low.0).then(least.1.cmp(&low.1)).is_lt() {
            *low = least;
        }
        if high.0.total_cmp(&most.0).then(most.1.cmp(&high.1)).is_lt() {
            *high = most;
        }
    }

    fn known(self, ranks: impl FnOnce(u64) -> BTreeSet<u64>) -> Known {
        let Self { n, finite, sum, range, sampled, sample, .. } = self;
        let sample = SortedSample::new(&sample).ok();
        let mut known = Known { n, range, sampled, sample, finite: None };
        let Some([(minimum, _), (maximum, _)]) = range.filter(|_| finite == n) else {
            return known;
        };
        let values = known.sample.as_ref().map_or(&[][..], SortedSample::values);
        let centred = (minimum < maximum).then(|| Centred::new(&sum, n, minimum, maximum));
        let selection = Selection::new(n, &ranks(n), (minimum, maximum), centred, values);
        let constant = centred.is_none() && n > 1;
        let moments = constant.then(|| Moments::constant(n, minimum));
        let mut finite = Finite {
            sum,
            centred,
            powers: None,
            selection,
            moments,
            deviation: None,
            grouped: None,
        };
        if values.len() as u64 == n
            && let Some(centred) = centred
        {
            // The whole sample is here.
            let mut powers = Powers::default();
            values.iter().for_each(|x| powers.add(centred.map(*x)));
            finite.powers = Some(powers);
            finite.conclude(n, [minimum, maximum]);
        }
        known.finite = Some(finite);
        known
    }
}

impl Finite {
    fn advance(&mut self, later: Later, n: u64, range: [f64; 2]) {
        if let Some(powers) = later.powers {
            self.powers = Some(powers);
        }
        if let Some(count) = later.count {
            self.selection.advance(&count);
        }
        if let (Some(groups), Some(centred)) = (later.groups, &self.centred) {
            self.grouped = Some(groups.close(centred));
        }
        self.conclude(n, range);
    }

    /// What follows from what is known.
    fn conclude(&mut self, n: u64, [minimum, maximum]: [f64; 2]) {
        let (Some(centred), Some(powers)) = (&self.centred, &self.powers) else { return };
        let number = (n, self.sum.mean(n));
        self.moments = Moments::of_powers(number, (minimum, maximum), centred, powers).ok();
        // The deviations of the values that a trimmed mean keeps.
        let cut = (n >= deviation::FEWEST as u64).then(|| trimmed(n));
        let middle = cut.and_then(|cut| self.selection.deviations(cut, n - cut - 1));
        if let (Some(moments), Some(middle)) = (&self.moments, middle) {
            self.deviation = Deviation::of_powers(moments, powers, middle).ok();
        }
    }
}

mod gathering;
mod intervals;
#[cfg(test)]
mod tests;
