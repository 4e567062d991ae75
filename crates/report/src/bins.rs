//! From samples to counts on shared bins.

use gyradius_statistics::{BinEdges, Histogram, SortedSample};
use serde::{Deserialize, Serialize};
use std::ops::Range;

use crate::axis::Units;
use crate::data::Field;
use crate::samples::Series;

/// The histograms of one panel, in units that read well.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Binned {
    pub(crate) units: Units,
    /// Edges in these units, increasing.
    pub(crate) edges: Vec<f64>,
    /// Counts per series and bin; none for a series without a finite value.
    pub(crate) counts: Vec<Vec<u64>>,
    /// Finite values per series.
    pub(crate) finite: Vec<usize>,
    /// Values per series below and above the edges.
    pub(crate) below: Vec<Beyond>,
    pub(crate) above: Vec<Beyond>,
    /// The nominal value in these units, if it is near enough to be shown.
    pub(crate) nominal: Option<f64>,
    /// The range of the axis: the edges and the nominal value, with a margin, in which what lies beyond
    /// the edges has its place.
    pub(crate) range: (f64, f64),
}

/// The values of a series beyond an edge.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Beyond {
    pub(crate) count: usize,
    /// The farthest of them, in the unit of the panel's label.
    pub(crate) extreme: f64,
}

/// Share of the axis that is left free beyond its ends, and for what lies beyond an edge.
const MARGIN: f64 = 0.03;
const EDGE: f64 = 0.07;

impl Binned {
    /// Counts on shared Freedman-Diaconis bins, `most` at most; `None` without a finite value.
    pub(crate) fn new<'a>(
        series: impl Iterator<Item = &'a Series<'a>>,
        nominal: Option<f64>,
        most: usize,
    ) -> Option<Self> {
        let samples: Vec<Option<&SortedSample>> = series.map(Series::sample).collect();
        let fences = samples.iter().flatten().map(|sample| fence(sample));
        let (lower, upper) = fences.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))?;
        let inside = |x: f64| lower <= x && x <= upper;
        let within =
            samples.iter().flatten().flat_map(|sample| sample.values()).filter(|&&x| inside(x));
        let (least, largest) =
            within.fold((upper, lower), |(a, b), &x| (f64::min(a, x), f64::max(b, x)));
        let units = Units::for_range(least, largest);
        let kept: Vec<Option<SortedSample>> = samples
            .iter()
            .map(|sample| {
                let values = sample.as_ref()?.values().iter().filter(|&&x| inside(x));
                SortedSample::new(&values.map(|&x| units.of(x)).collect::<Vec<_>>()).ok()
            })
            .collect();
        let nominal = nominal.map(|x| units.of(x)).filter(|x| x.is_finite());
        let edges = edges(&kept.iter().flatten().collect::<Vec<_>>(), nominal, most)?;
        let bounds = (edges.values()[0], edges.values()[edges.bins()]);
        // Values are sorted: the farthest is the first or the last.
        let side = |outside: &dyn Fn(f64) -> bool, farthest: fn(&SortedSample) -> f64| {
            let of = |sample: &Option<&SortedSample>| {
                let Some(sample) = sample else { return Beyond::default() };
                let count = sample.values().iter().filter(|&&x| outside(x)).count();
                Beyond { count, extreme: farthest(sample) }
            };
            samples.iter().map(of).collect::<Vec<_>>()
        };
        let below = side(&|x| x < lower, SortedSample::minimum);
        let above = side(&|x| x > upper, SortedSample::maximum);
        let span = bounds.1 - bounds.0;
        let nominal = nominal.filter(|x| (bounds.0 - span..=bounds.1 + span).contains(x));
        let ends = nominal.map_or(bounds, |x| (bounds.0.min(x), bounds.1.max(x)));
        let margin = |beyond: &[Beyond]| {
            let share = if beyond.iter().any(|b| b.count > 0) { EDGE } else { MARGIN };
            share * (ends.1 - ends.0)
        };
        let range = (ends.0 - margin(&below), ends.1 + margin(&above));
        Some(Self {
            units,
            counts: kept.iter().map(|sample| counts(sample.as_ref(), &edges)).collect(),
            finite: samples.iter().map(|s| s.map_or(0, SortedSample::n)).collect(),
            below,
            above,
            nominal,
            range,
            edges: edges.values().to_vec(),
        })
    }

    /// The same of some of the series alone; none if they have no finite value.
    pub(crate) fn of_series(&self, series: Range<usize>) -> Option<Self> {
        let found = self.finite.get(series.clone())?.iter().any(|count| *count > 0);
        found.then(|| Self {
            counts: self.counts[series.clone()].to_vec(),
            finite: self.finite[series.clone()].to_vec(),
            below: self.below[series.clone()].to_vec(),
            above: self.above[series].to_vec(),
            edges: self.edges.clone(),
            ..*self
        })
    }

    /// The height of each bin of a series: counts, or density in the units of the axis.
    pub(crate) fn heights(&self, series: usize, density: bool) -> Vec<f64> {
        let widths = self.edges.windows(2).map(|pair| pair[1] - pair[0]);
        let heights = self.counts[series].iter().zip(widths);
        heights.map(|(&count, width)| self.height(series, count, width, density)).collect()
    }

    /// The heights of what lies below and above the edges: as if it were in the nearest bin.
    pub(crate) fn edge_heights(&self, series: usize, density: bool) -> [f64; 2] {
        let widths: Vec<f64> = self.edges.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let at = |beyond: &[Beyond], width: Option<&f64>| {
            let count = beyond[series].count as u64;
            width.map_or(0.0, |width| self.height(series, count, *width, density))
        };
        [at(&self.below, widths.first()), at(&self.above, widths.last())]
    }

    /// Bounds and counts of the bins, in the unit of the panel's label.
    pub(crate) fn rows(&self) -> Vec<Vec<Field>> {
        let step =
            self.edges.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
        let edge = |u: Option<&f64>| Field::Number(u.map(|u| self.units.back(*u, step)));
        let row = |from, to, counts: Vec<u64>| -> Vec<Field> {
            let counts = counts.into_iter().map(|count| Field::number(count as f64));
            [edge(from), edge(to)].into_iter().chain(counts).collect()
        };
        let beyond = |from, to, beyond: &[Beyond]| {
            let counts: Vec<u64> = beyond.iter().map(|beyond| beyond.count as u64).collect();
            counts.iter().any(|count| *count > 0).then(|| row(from, to, counts))
        };
        let count = |bin| self.counts.iter().map(|of| of.get(bin).copied().unwrap_or(0)).collect();
        let bins = self.edges.windows(2).enumerate();
        beyond(None, self.edges.first(), &self.below)
            .into_iter()
            .chain(bins.map(|(bin, pair)| row(Some(&pair[0]), Some(&pair[1]), count(bin))))
            .chain(beyond(self.edges.last(), None, &self.above))
            .collect()
    }

    fn height(&self, series: usize, count: u64, width: f64, density: bool) -> f64 {
        let n = self.finite[series] as f64;
        if density && count > 0 { count as f64 / n / width } else { count as f64 }
    }
}

fn counts(sample: Option<&SortedSample>, edges: &BinEdges) -> Vec<u64> {
    sample.map_or_else(Vec::new, |s| Histogram::new(s, edges).counts().to_vec())
}

/// The range worth showing: all of it, unless a few extreme values would squeeze the rest.
///
/// It ends at the last values within whiskers from an upper and a lower quantile, a quarter as long
/// as these are apart, if that gains at least a third of the range. The quantiles are those of ½ %,
/// or of 1 or 2 % if the middle half of the sample is otherwise too narrow to be seen.
fn fence(sample: &SortedSample) -> (f64, f64) {
    let quantile = |p: f64| sample.quantile(p).unwrap_or(f64::NAN);
    let cut = |p: f64| {
        let (a, b) = (quantile(p), quantile(1.0 - p));
        let whisker = b / 4.0 - a / 4.0;
        let values = sample.values().iter().copied();
        let all = (sample.minimum(), sample.maximum());
        let lower = values.clone().find(|&x| x >= a - whisker).unwrap_or(all.0);
        let upper = values.rev().find(|&x| x <= b + whisker).unwrap_or(all.1);
        let gains = upper / 2.0 - lower / 2.0 <= (all.1 / 2.0 - all.0 / 2.0) / 1.5;
        if gains { (lower, upper) } else { all }
    };
    let middle = quantile(0.75) / 2.0 - quantile(0.25) / 2.0;
    let visible = |&(a, b): &(f64, f64)| middle >= 0.03 * (b / 2.0 - a / 2.0);
    [0.005, 0.01, 0.02].map(cut).into_iter().find(visible).unwrap_or_else(|| cut(0.005))
}

fn edges(samples: &[&SortedSample], nominal: Option<f64>, most: usize) -> Option<BinEdges> {
    let lower = samples.iter().map(|s| s.minimum()).reduce(f64::min)?;
    let upper = samples.iter().map(|s| s.maximum()).reduce(f64::max)?;
    if lower < upper {
        let edges = BinEdges::freedman_diaconis(samples).ok()?;
        if edges.bins() <= most { Some(edges) } else { BinEdges::uniform(lower, upper, most).ok() }
    } else {
        // One value: a spike amid a range of the order of the value, or up to the nominal.
        let size = if lower == 0.0 { 1.0 } else { lower.abs() };
        let off = nominal.map_or(0.0, |x| (x - lower).abs());
        let reach = if (1e-4 * size..=10.0 * size).contains(&off) { off } else { 0.1 * size };
        BinEdges::uniform(lower - 1.25 * reach, lower + 1.25 * reach, 41).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn binned(samples: &[&[f64]], nominal: Option<f64>) -> Option<Binned> {
        let series: Vec<Series<'_>> =
            samples.iter().map(|values| Series::new("", values, values.len())).collect();
        Binned::new(series.iter(), nominal, 50)
    }

    /// Quantiles of the Cauchy law.
    fn heavy() -> Vec<f64> {
        (1..2000).map(|i| (std::f64::consts::PI * (f64::from(i) / 2000.0 - 0.5)).tan()).collect()
    }

    #[test]
    fn every_value_is_counted_once() {
        let (a, b) = (heavy(), [1e300, -3.0, f64::NAN, 0.0, f64::INFINITY]);
        let binned = binned(&[&a, &b, &[]], None).unwrap();
        assert_eq!(binned.finite, [1999, 3, 0]);
        for i in 0..3 {
            let inside = binned.counts[i].iter().sum::<u64>() as usize;
            let beyond = binned.below[i].count + binned.above[i].count;
            assert_eq!(inside + beyond, binned.finite[i]);
        }
        assert_eq!(binned.edges.len(), 51);
    }

    #[test]
    fn few_extremes_are_left_out_and_the_rest_is_not() {
        let values = heavy();
        let tails = binned(&[&values], None).unwrap();
        assert_eq!(tails.below[0].count, tails.above[0].count);
        assert!((1..40).contains(&tails.below[0].count), "{:?}", tails.below);
        assert_eq!((tails.below[0].extreme, tails.above[0].extreme), (values[0], values[1998]));
        // A second mode of 3 % is no outlier, however far.
        let modes: Vec<f64> =
            (0..2000).map(|i| f64::from(i % 7) + if i % 33 == 0 { 1e4 } else { 0.0 }).collect();
        let modes = binned(&[&modes], None).unwrap();
        assert_eq!((modes.below[0].count, modes.above[0].count), (0, 0));
    }

    #[test]
    fn density_is_of_all_finite_values() {
        let values = heavy();
        let binned = binned(&[&values], None).unwrap();
        let width = binned.edges[1] - binned.edges[0];
        let share = binned.heights(0, true).iter().sum::<f64>() * width;
        let outside = (binned.below[0].count + binned.above[0].count) as f64 / 1999.0;
        assert!((share + outside - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_constant_is_a_spike_with_room_around() {
        for value in [0.0, -2.5, 1e300, f64::MAX, 5e-324] {
            let binned = binned(&[&[value; 9]], Some(value)).unwrap();
            assert_eq!(binned.counts[0].iter().filter(|&&n| n > 0).count(), 1, "{value}");
            assert!(binned.counts[0][20] == 9 && binned.nominal.is_some(), "{value}");
        }
    }

    #[test]
    fn a_near_nominal_extends_the_axis_and_a_far_one_does_not() {
        let near = binned(&[&[1.0, 2.0, 3.0]], Some(4.5)).unwrap();
        assert!(near.nominal == Some(4.5) && near.range.1 > 4.5);
        let far = binned(&[&[1.0, 2.0, 3.0]], Some(1e9)).unwrap();
        assert!(far.nominal.is_none() && far.range.1 < 4.0);
        assert!(binned(&[&[f64::NAN], &[]], Some(1.0)).is_none());
    }
}
