//! What follows from a drawn inertia.

use gyradius_statistics::{Confidence, Deviation, ExactSum, Interval, Moments, SortedSample};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// What follows from a drawn inertia.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Measure {
    LargestMoment,
    MiddleMoment,
    SmallestMoment,
    InertiaRatio,
    Wobble,
    Nutation,
}

impl Measure {
    pub(crate) const ALL: [Self; 6] = [
        Self::LargestMoment,
        Self::MiddleMoment,
        Self::SmallestMoment,
        Self::InertiaRatio,
        Self::Wobble,
        Self::Nutation,
    ];
    /// Those that need no separation.
    pub(crate) const OF_DRAWS: usize = 5;

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::LargestMoment => "largest_moment",
            Self::MiddleMoment => "middle_moment",
            Self::SmallestMoment => "smallest_moment",
            Self::InertiaRatio => "inertia_ratio",
            Self::Wobble => "wobble",
            Self::Nutation => "nutation",
        }
    }

    pub(crate) fn label(self) -> String {
        self.name().replace('_', " ")
    }

    pub(crate) fn unit(self) -> &'static str {
        match self {
            Self::LargestMoment | Self::MiddleMoment | Self::SmallestMoment => "kg·m²",
            Self::InertiaRatio => "1",
            Self::Wobble | Self::Nutation => "deg",
        }
    }

    /// What is told of it first: angles are never negative and pile up near zero, so their upper end
    /// says how wide they spread.
    pub(crate) fn headline(self) -> (&'static str, fn(&Spread) -> Option<f64>) {
        match self {
            Self::Wobble | Self::Nutation => ("95th percentile", |s| s.p95),
            _ => ("width of the middle 90 %", Spread::width),
        }
    }

    /// The same with measure and unit.
    pub(crate) fn title(self) -> String {
        format!("{}: {}{}", self.label(), self.headline().0, self.comma_unit())
    }

    /// A comma and its unit, if it has one.
    pub(crate) fn comma_unit(self) -> String {
        if self.unit() == "1" { String::new() } else { format!(", {}", self.unit()) }
    }
}

/// How a measure is distributed. What the sample cannot tell is null.
///
/// Quantiles say more here than deviations: a body that cannot exist can have an inertia ratio as
/// large as one likes, and one such draw makes the deviation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Spread {
    pub(crate) measure: Measure,
    pub(crate) unit: Cow<'static, str>,
    pub(crate) n: u64,
    /// Draws for which it is infinite or not defined.
    pub(crate) undefined: u64,
    pub(crate) mean: Option<f64>,
    pub(crate) deviation: Option<f64>,
    pub(crate) deviation_interval: Option<Interval>,
    pub(crate) p05: Option<f64>,
    pub(crate) median: Option<f64>,
    pub(crate) p95: Option<f64>,
}

impl Spread {
    pub(crate) fn new(measure: Measure, values: impl Iterator<Item = Option<f64>>) -> Self {
        let mut undefined = 0;
        let mut kept: Vec<f64> = Vec::new();
        for value in values {
            match value.filter(|x| x.is_finite()) {
                Some(value) => kept.push(value),
                None => undefined += 1,
            }
        }
        let moments = Moments::new(&kept).ok();
        let robust = Deviation::new(&kept).ok();
        let sorted = SortedSample::new(&kept).ok();
        let quantile = |p| sorted.as_ref().and_then(|s| s.quantile(p).ok());
        let finite = |i: &Interval| i.lower().is_finite() && i.upper().is_finite();
        Self {
            measure,
            unit: measure.unit().into(),
            n: kept.len() as u64,
            undefined,
            mean: (!kept.is_empty())
                .then(|| kept.iter().copied().collect::<ExactSum>().mean(kept.len() as u64)),
            deviation: moments.map(|m| m.standard_deviation()),
            deviation_interval: robust
                .and_then(|d| d.interval(Confidence::default()).ok())
                .filter(finite),
            p05: quantile(0.05),
            median: quantile(0.5),
            p95: quantile(0.95),
        }
    }

    /// From the 5th to the 95th percentile.
    pub(crate) fn width(&self) -> Option<f64> {
        Some(self.p95? - self.p05?)
    }

    pub(crate) fn headline(&self) -> Option<f64> {
        self.measure.headline().1(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_finite_is_counted_and_left_out() {
        let values = (0..=100).map(|i| Some(f64::from(i)));
        let odd = [None, Some(f64::NAN), Some(f64::INFINITY)];
        let spread = Spread::new(Measure::InertiaRatio, values.chain(odd));
        assert_eq!((spread.n, spread.undefined), (101, 3));
        assert_eq!((spread.p05, spread.median, spread.p95), (Some(5.0), Some(50.0), Some(95.0)));
        assert_eq!(spread.headline(), Some(90.0));
        let none = Spread::new(Measure::Wobble, std::iter::empty());
        assert_eq!((none.n, none.headline(), none.mean), (0, None, None));
        let one = Spread::new(Measure::Wobble, [Some(0.1)].into_iter());
        assert_eq!((one.n, one.mean, one.median, one.deviation), (1, Some(0.1), Some(0.1), None));
    }
}
