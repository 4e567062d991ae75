//! Order statistics of values that are read in passes, and sums of the deviations below them: exact, without sorting
//! or keeping the values.

use std::collections::{BTreeMap, BTreeSet};

use crate::centred::{Centred, UnitSum};

/// Values that are kept between two edges, at most.
const KEPT: usize = 8192;
/// Parts of a bracket whose values are kept, at most.
const KEPT_PARTS: f64 = 8.0;
/// Parts that a range of too many values is divided into.
const PARTS: u64 = 64;
/// Standard deviations of a rank in a random sample that its bracket reaches to either side.
const REACH: f64 = 4.0;

/// A number as an integer of the same order, −0 below 0.
#[inline]
pub(crate) fn key(x: f64) -> i64 {
    let bits = x.to_bits() as i64;
    bits ^ ((bits >> 63) as u64 >> 1) as i64
}

/// The number of a key.
pub(crate) fn number(key: i64) -> f64 {
    f64::from_bits((key ^ ((key >> 63) as u64 >> 1) as i64) as u64)
}

/// Order statistics that are wanted, and what is known of them.
#[derive(Clone, Debug)]
pub(crate) struct Selection {
    n: u64,
    centred: Option<Centred>,
    /// By ranks from 0: the value, and the sum of the deviations of all values of lower ranks.
    found: BTreeMap<u64, (f64, UnitSum)>,
    open: BTreeSet<u64>,
    /// Keys of the smallest and the largest value.
    ends: (i64, i64),
    /// What the next pass counts.
    next: Count,
}

/// How many values are between edges, and the values where they are few.
#[derive(Clone, Debug)]
pub(crate) struct Count {
    /// Increasing keys; part `i` is from edge `i − 1` on to below edge `i`.
    edges: Vec<i64>,
    parts: Vec<Part>,
}

/// The values between two edges.
#[derive(Clone, Debug, Default)]
struct Part {
    count: u64,
    /// Of their deviations.
    sum: UnitSum,
    /// As many as there is room for, if they are kept.
    kept: Option<Vec<i64>>,
}

impl Selection {
    /// Of `n` values from a smallest to a largest, all the same if there is no map to deviations; of them a sorted
    /// sample is known.
    pub(crate) fn new(
        n: u64,
        ranks: &BTreeSet<u64>,
        ends: (f64, f64),
        centred: Option<Centred>,
        sample: &[f64],
    ) -> Self {
        let mut selection = Self {
            n,
            centred,
            found: BTreeMap::new(),
            open: ranks.iter().copied().filter(|rank| *rank < n).collect(),
            ends: (key(ends.0), key(ends.1)),
            next: Count::default(),
        };
        if selection.ends.0 == selection.ends.1 {
            let same = |rank: &u64| (*rank, (ends.0, UnitSum::default()));
            selection.found = selection.open.iter().map(same).collect();
            selection.open.clear();
        } else if sample.len() as u64 == n {
            let mut below = UnitSum::default();
            let mut open = std::mem::take(&mut selection.open).into_iter().peekable();
            for (rank, x) in (0..).zip(sample) {
                if open.next_if_eq(&rank).is_some() {
                    selection.found.insert(rank, (*x, below));
                }
                below.add(centred.map_or(0.0, |centred| centred.map(*x)));
            }
        } else {
            let ranges = selection.open.iter().map(|rank| selection.bracket(*rank, sample));
            selection.next = Count::new(&ranges.collect::<Vec<_>>());
        }
        selection
    }

    /// Edges between which a value of a rank is expected, and whether there are few enough values to keep.
    fn bracket(&self, rank: u64, sample: &[f64]) -> Range {
        let m = sample.len() as f64;
        let share = rank as f64 / self.n as f64;
        let reach = REACH * (m * share * (1.0 - share)).sqrt() + REACH;
        let (first, last) = (share * m - reach, share * m + reach);
        // Twice as many as are expected find room.
        let step = (KEPT as f64 / 2.0 / (self.n as f64 / m)).max(1.0);
        let parts = ((last - first) / step).ceil().max(1.0);
        let at = |place: f64| match place {
            low if low < 0.0 => self.ends.0,
            high if high as usize >= sample.len() => self.ends.1 + 1,
            place => key(sample[place as usize]),
        };
        let edges = (0..=parts as u64).map(|i| at(first + (last - first) * i as f64 / parts));
        let mut edges: Vec<i64> = edges.collect();
        if let Some(last) = edges.last_mut() {
            *last = last.saturating_add(1).min(self.ends.1 + 1);
        }
        Range { edges, keeps: parts <= KEPT_PARTS }
    }

    /// What is to be counted next; none if all is known.
    pub(crate) fn pass(&self) -> Option<&Count> {
        (!self.open.is_empty()).then_some(&self.next)
    }

    /// Takes up what was counted of all values.
    pub(crate) fn advance(&mut self, count: &Count) {
        let (mut below, mut sum) = (0, UnitSum::default());
        let mut ranges = Vec::new();
        for (place, part) in count.parts.iter().enumerate() {
            let ranks = self.open.range(below..below + part.count);
            let ranks: Vec<u64> = ranks.copied().collect();
            if !ranks.is_empty() {
                let before = place.checked_sub(1).map(|i| count.edges[i]);
                let edges = (
                    before.unwrap_or(self.ends.0),
                    count.edges.get(place).copied().unwrap_or(self.ends.1 + 1),
                );
                if let Some(values) = part.values(edges) {
                    let (mut lower, mut added) = (sum, 0);
                    for rank in ranks {
                        for (value, times) in values.between(added, rank - below) {
                            lower.add_times(self.deviation(value), times);
                        }
                        added = rank - below;
                        self.found.insert(rank, (number(values.at(added)), lower));
                        self.open.remove(&rank);
                    }
                } else {
                    ranges.push(Range::of(edges, part.count));
                }
            }
            below += part.count;
            sum.merge(&part.sum);
        }
        self.next = Count::new(&ranges);
    }

    fn deviation(&self, key: i64) -> f64 {
        self.centred.map_or(0.0, |centred| centred.map(number(key)))
    }

    /// The value of a rank from 0, if it was wanted and is known.
    pub(crate) fn value(&self, rank: u64) -> Option<f64> {
        self.found.get(&rank).map(|(value, _)| *value)
    }

    /// The sum of the deviations of the values from one rank to another, if both were wanted and are known.
    pub(crate) fn deviations(&self, first: u64, last: u64) -> Option<f64> {
        let (_, before) = self.found.get(&first)?;
        let (value, up_to) = self.found.get(&last)?;
        let mut sum = *up_to;
        sum.add(self.deviation(key(*value)));
        sum.subtract(before);
        Some(sum.value())
    }
}

/// Edges that are counted between, and whether values are kept.
struct Range {
    edges: Vec<i64>,
    keeps: bool,
}

impl Range {
    /// So many values from an edge on to below another.
    fn of((first, last): (i64, i64), inside: u64) -> Self {
        if inside <= KEPT as u64 {
            return Self { edges: vec![first, last], keeps: true };
        }
        // Of 2⁶⁴ keys.
        let width = last.abs_diff(first).div_ceil(PARTS).max(1);
        let edges = (0..=PARTS).map(|i| {
            let beyond = u128::from(width) * u128::from(i);
            (i128::from(first) + beyond as i128).min(i128::from(last)) as i64
        });
        Self { edges: edges.collect(), keeps: false }
    }
}

impl Default for Count {
    fn default() -> Self {
        Self::new(&[])
    }
}

impl Count {
    fn new(ranges: &[Range]) -> Self {
        let edges: BTreeSet<i64> = ranges.iter().flat_map(|range| range.edges.clone()).collect();
        let edges: Vec<i64> = edges.into_iter().collect();
        let mut parts = vec![Part::default(); edges.len() + 1];
        for range in ranges.iter().filter(|range| range.keeps) {
            for pair in range.edges.windows(2) {
                let kept = edges.partition_point(|edge| *edge <= pair[0])
                    ..edges.partition_point(|edge| *edge < pair[1]) + 1;
                parts[kept].iter_mut().for_each(|part| part.kept = Some(Vec::new()));
            }
        }
        Self { edges, parts }
    }

    /// Counts a value with its deviation.
    #[inline]
    pub(crate) fn add(&mut self, x: f64, deviation: f64) {
        let key = key(x);
        let part = &mut self.parts[self.edges.partition_point(|edge| *edge <= key)];
        part.count += 1;
        part.sum.add(deviation);
        if let Some(kept) = &mut part.kept
            && kept.len() < KEPT
        {
            kept.push(key);
        }
    }

    pub(crate) fn merge(&mut self, other: &Self) {
        for (part, more) in self.parts.iter_mut().zip(&other.parts) {
            part.count += more.count;
            part.sum.merge(&more.sum);
            if let (Some(kept), Some(more)) = (&mut part.kept, &more.kept) {
                let room = KEPT - kept.len();
                kept.extend(more.iter().take(room));
            }
        }
    }
}

/// Keys of the values of a part in order.
enum Values {
    /// All the same.
    Same(i64),
    Kept(Vec<i64>),
}

impl Part {
    /// Its values, if all are known.
    fn values(&self, (first, last): (i64, i64)) -> Option<Values> {
        if last.abs_diff(first) == 1 {
            return Some(Values::Same(first));
        }
        let kept = self.kept.as_ref().filter(|kept| kept.len() as u64 == self.count)?;
        let mut values = kept.clone();
        values.sort_unstable();
        Some(Values::Kept(values))
    }
}

impl Values {
    fn at(&self, place: u64) -> i64 {
        match self {
            Self::Same(value) => *value,
            Self::Kept(values) => values[place as usize],
        }
    }

    /// The values from one place to before another, each with how many times it counts.
    fn between(&self, first: u64, end: u64) -> Vec<(i64, u64)> {
        match self {
            Self::Same(value) => vec![(*value, end - first)],
            Self::Kept(values) => {
                values[first as usize..end as usize].iter().map(|value| (*value, 1)).collect()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    use crate::ExactSum;

    /// What selection finds, in how many passes, of values in parts.
    fn select(values: &[f64], ranks: &BTreeSet<u64>, sample: &[f64]) -> (Selection, u32) {
        let mut sample = sample.to_vec();
        sample.sort_by(f64::total_cmp);
        let order = |a: &f64, b: &f64| a.total_cmp(b);
        let ends = (
            values.iter().copied().min_by(order).unwrap_or(f64::NAN),
            values.iter().copied().max_by(order).unwrap_or(f64::NAN),
        );
        let n = values.len() as u64;
        let centred = centred(values, ends);
        let mut selection = Selection::new(n, ranks, ends, centred, &sample);
        let mut passes = 0;
        while let Some(empty) = selection.pass() {
            let mut whole = empty.clone();
            for part in values.chunks(1000).rev() {
                let mut count = empty.clone();
                let deviation = |x: f64| centred.map_or(0.0, |centred| centred.map(x));
                part.iter().for_each(|x| count.add(*x, deviation(*x)));
                whole.merge(&count);
            }
            selection.advance(&whole);
            passes += 1;
            assert!(passes < 16);
        }
        (selection, passes)
    }

    fn centred(values: &[f64], (minimum, maximum): (f64, f64)) -> Option<Centred> {
        let sum: ExactSum = values.iter().copied().collect();
        (minimum < maximum).then(|| Centred::new(&sum, values.len() as u64, minimum, maximum))
    }

    fn found(selection: &Selection, ranks: &BTreeSet<u64>) -> Vec<Option<f64>> {
        ranks.iter().map(|rank| selection.value(*rank)).collect()
    }

    fn expected(values: &[f64], ranks: &BTreeSet<u64>) -> Vec<Option<f64>> {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        ranks.iter().map(|rank| sorted.get(*rank as usize).copied()).collect()
    }

    fn bits(values: &[Option<f64>]) -> Vec<Option<u64>> {
        values.iter().map(|x| x.map(f64::to_bits)).collect()
    }

    proptest! {
        #[test]
        fn keys_keep_the_order(a in any::<f64>(), b in any::<f64>()) {
            prop_assert_eq!(key(a).cmp(&key(b)), a.total_cmp(&b));
            prop_assert_eq!(number(key(a)).to_bits(), a.to_bits());
        }

        /// Of values of every kind, with samples that are good, bad or none, against sorting.
        #[test]
        fn every_rank_is_that_of_the_sorted_values(
            kind in 0..6_usize,
            n in 1..30_000_u32,
            seed in any::<u32>(),
            wanted in prop::collection::btree_set(any::<u64>(), 1..10),
            thinning in 1..200_usize,
            sampling in 0..3_usize,
        ) {
            let uniform = |i: u32| f64::from(i.wrapping_mul(2_654_435_761).wrapping_add(seed)) / 2f64.powi(32);
            let value = |i: u32| match kind {
                0 => uniform(i),
                1 => (uniform(i) * 5.0).floor() - 2.0,
                2 => 1.0 / (uniform(i) - 0.5),
                3 => if i == 0 { 1e300 } else { 1.0 + uniform(i) * 1e-12 },
                4 => (uniform(i) - 0.5) * 5e-322,
                _ => if uniform(i) < 0.6 { -0.0 } else { uniform(i) },
            };
            let values: Vec<f64> = (0..n).map(value).filter(|x| x.is_finite()).collect();
            let ranks: BTreeSet<u64> = wanted.iter().map(|share| share % (values.len() as u64 + 2)).collect();
            let sample: Vec<f64> = match sampling {
                0 => values.iter().copied().step_by(thinning).collect(),
                // The worst: all of one end.
                1 => {
                    let mut sorted = values.clone();
                    sorted.sort_by(f64::total_cmp);
                    sorted.truncate(values.len() / thinning);
                    sorted
                }
                _ => Vec::new(),
            };
            let (selection, _) = select(&values, &ranks, &sample);
            prop_assert_eq!(bits(&found(&selection, &ranks)), bits(&expected(&values, &ranks)));
            // The deviations between any two of the ranks, against adding those of the sorted values.
            let mut sorted = values.clone();
            sorted.sort_by(f64::total_cmp);
            let within = ranks.iter().copied().filter(|rank| *rank < sorted.len() as u64);
            let (first, last) = (within.clone().min(), within.max());
            if let (Some(first), Some(last)) = (first, last) {
                let mut sum = UnitSum::default();
                if let Some(centred) = centred(&values, (sorted[0], sorted[sorted.len() - 1])) {
                    sorted[first as usize..=last as usize].iter().for_each(|x| sum.add(centred.map(*x)));
                }
                prop_assert_eq!(selection.deviations(first, last), Some(sum.value()));
            }
        }
    }

    /// A sample of a million values finds its ranks in one pass.
    #[test]
    fn few_passes_are_made() {
        let values: Vec<f64> = (0..1_000_000_u32)
            .map(|i| f64::from(i.wrapping_mul(2_654_435_761)) / 2f64.powi(32))
            .map(|u| -(1.0 - u).ln())
            .collect();
        let ranks: BTreeSet<u64> =
            [50_000, 50_001, 500_000, 950_000, 949_500, 950_500, 999_999].into_iter().collect();
        let sample: Vec<f64> = values.iter().copied().step_by(16).collect();
        let (selection, passes) = select(&values, &ranks, &sample);
        assert_eq!(found(&selection, &ranks), expected(&values, &ranks));
        assert!(passes <= 1, "{passes}");
    }
}
