//! Intervals for values that come in groups, whose members have something in common.

use std::{collections::BTreeMap, mem};

use crate::centred::{Centred, UnitSum};
use crate::{Confidence, Interval, law};

/// Sums over groups of consecutive runs, as squares of deviations from the mean are added up: exact, and so the same
/// in whatever parts the runs come.
#[derive(Clone, Debug)]
pub(crate) struct GroupSums {
    /// Runs of a group.
    size: u64,
    /// Groups at the ends of the parts, of which others may hold more.
    open: BTreeMap<u64, Group>,
    whole: Totals,
}

#[derive(Clone, Copy, Debug, Default)]
struct Group {
    n: u64,
    deviations: UnitSum,
    squares: UnitSum,
}

/// Sums over groups, of sums that are divided by the size of a group.
#[derive(Clone, Debug, Default)]
struct Totals {
    groups: u64,
    n: u64,
    squares: UnitSum,
    deviations_squared: UnitSum,
    squares_squared: UnitSum,
    squares_by_number: UnitSum,
    number_squared: UnitSum,
}

impl GroupSums {
    /// Of groups of so many runs.
    pub(crate) fn new(size: u64) -> Self {
        Self { size, open: BTreeMap::new(), whole: Totals::default() }
    }

    /// Takes up deviations of consecutive runs, in their order. Some runs may have none.
    pub(crate) fn part(&mut self, runs: impl IntoIterator<Item = (u64, f64)>) {
        let (mut at, mut group, mut first) = (None, Group::default(), true);
        for (run, deviation) in runs {
            let place = run / self.size;
            if at != Some(place) {
                if let Some(at) = at {
                    let group = mem::take(&mut group);
                    // Only what lies between two others is sure to be whole.
                    if mem::take(&mut first) {
                        self.open.entry(at).or_default().merge(&group);
                    } else {
                        self.whole.add(&group, self.size);
                    }
                }
                at = Some(place);
            }
            group.n += 1;
            group.deviations.add(deviation);
            group.squares.add(deviation * deviation);
        }
        if let Some(at) = at {
            self.open.entry(at).or_default().merge(&group);
        }
    }

    pub(crate) fn merge(&mut self, other: Self) {
        self.whole.merge(&other.whole);
        for (at, group) in other.open {
            self.open.entry(at).or_default().merge(&group);
        }
    }

    /// What all values have shown.
    pub(crate) fn close(mut self, centred: &Centred) -> Grouped {
        for group in mem::take(&mut self.open).values() {
            self.whole.add(group, self.size);
        }
        let (size, sums) = (self.size as f64, &self.whole);
        let (groups, n) = (sums.groups as f64, sums.n as f64);
        let per_group = groups / (groups - 1.0);
        // All in the unit of the deviations, at first.
        let variance = size * sums.squares.value() / n;
        let error = size * (per_group * sums.deviations_squared.value()).sqrt() / n;
        // Of the sums of squares of groups about what their number of values lets expect.
        let scatter = sums.squares_squared.value()
            - 2.0 * variance * sums.squares_by_number.value()
            + variance * variance * sums.number_squared.value();
        let of_variance = size * (per_group * scatter.max(0.0)).sqrt() / n;
        Grouped {
            groups: sums.groups,
            mean_error: centred.length(error),
            standard_deviation: centred.length((variance + error * error).sqrt()),
            log_variance_error: of_variance / variance,
        }
    }
}

impl Group {
    fn merge(&mut self, other: &Self) {
        self.n += other.n;
        self.deviations.merge(&other.deviations);
        self.squares.merge(&other.squares);
    }
}

impl Totals {
    fn add(&mut self, group: &Group, size: u64) {
        let of = |sum: f64| sum / size as f64;
        let (deviations, squares) = (of(group.deviations.value()), of(group.squares.value()));
        let number = of(group.n as f64);
        self.groups += 1;
        self.n += group.n;
        self.squares.add(squares);
        self.deviations_squared.add(deviations * deviations);
        self.squares_squared.add(squares * squares);
        self.squares_by_number.add(squares * number);
        self.number_squared.add(number * number);
    }

    fn merge(&mut self, other: &Self) {
        self.groups += other.groups;
        self.n += other.n;
        for (sum, more) in [
            (&mut self.squares, &other.squares),
            (&mut self.deviations_squared, &other.deviations_squared),
            (&mut self.squares_squared, &other.squares_squared),
            (&mut self.squares_by_number, &other.squares_by_number),
            (&mut self.number_squared, &other.number_squared),
        ] {
            sum.merge(more);
        }
    }
}

/// What groups of values show of their mean and their standard deviation, if groups are independent and values of a
/// group are not.
///
/// With group sums `A = Σ(x − x̄)` and `B = Σ((x − x̄)² − m₂)` over each of `G` groups of `n` values in all, the
/// variance of the mean is `G/(G−1) · ΣA²/n²`, and that of `m₂`, `G/(G−1) · ΣB²/n²` (the linearised variances of
/// sampling by clusters, Cochran 1977, *Sampling Techniques*, §9A). For groups of equal size the first is that of the mean of the
/// group means. Because `m₂` is smaller than the variance by that of the mean, the variance is taken as `m₂` plus that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Grouped {
    groups: u64,
    mean_error: f64,
    standard_deviation: f64,
    log_variance_error: f64,
}

impl Grouped {
    /// Of so many groups whose values are all the same.
    pub(crate) fn constant(groups: u64) -> Self {
        Self { groups, mean_error: 0.0, standard_deviation: 0.0, log_variance_error: 0.0 }
    }

    /// The mean of all values and Student's t with `G − 1` degrees of freedom; none of a single group.
    pub(crate) fn mean_interval(&self, mean: f64, confidence: Confidence) -> Option<Interval> {
        let t = law::students_t(confidence.tail(), self.freedom()?);
        Some(Interval::around(mean, t * self.mean_error, confidence))
    }

    /// The same of the difference of two means, whose values are independent of each other, by Welch's degrees of
    /// freedom.
    pub(crate) fn mean_difference_interval(
        &self,
        other: &Self,
        difference: f64,
        confidence: Confidence,
    ) -> Option<Interval> {
        let error = self.mean_error.hypot(other.mean_error);
        let t = self.welch(other, [self.mean_error, other.mean_error], confidence)?;
        Some(Interval::around(difference, t * error, confidence))
    }

    /// On the logarithmic scale, with Student's t; none of a single group.
    pub(crate) fn deviation_interval(&self, confidence: Confidence) -> Option<Interval> {
        let t = law::students_t(confidence.tail(), self.freedom()?);
        let half = 0.5 * t * self.log_variance_error;
        Some(Interval::around_log(self.standard_deviation, half, confidence))
    }

    /// The same of the ratio of two standard deviations, whose values are independent of each other.
    pub(crate) fn ratio_interval(&self, other: &Self, confidence: Confidence) -> Option<Interval> {
        let errors = [self.log_variance_error, other.log_variance_error];
        let t = self.welch(other, errors, confidence)?;
        let ratio = self.standard_deviation / other.standard_deviation;
        let half = 0.5 * t * errors[0].hypot(errors[1]);
        Some(Interval::around_log(ratio, half, confidence))
    }

    fn freedom(&self) -> Option<f64> {
        (self.groups > 1).then_some(self.groups as f64 - 1.0)
    }

    /// Student's t with the degrees of freedom of Welch for two errors.
    fn welch(&self, other: &Self, errors: [f64; 2], confidence: Confidence) -> Option<f64> {
        let (a, b) = (self.freedom()?, other.freedom()?);
        let error = errors[0].hypot(errors[1]);
        if error == 0.0 {
            return Some(0.0);
        }
        let [share, rest] = errors.map(|e| (e / error).powi(2));
        Some(law::students_t(confidence.tail(), 1.0 / (share * share / a + rest * rest / b)))
    }
}
