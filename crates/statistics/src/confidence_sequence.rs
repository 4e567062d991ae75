//! Where a share lies, known after every run.

use crate::mixture::Mixture;
use crate::verdict::MAX_PLANNED;
use crate::{Confidence, Interval, StatisticsError, error, law};

/// Intervals of a share, one after each run, **all** of which hold the true share with the confidence stated.
///
/// The interval of [`Proportion`](crate::Proportion) holds at a number of runs that was chosen beforehand. Who looks
/// often enough sees it miss: with probability one, in the end. Intervals of a confidence sequence may be looked at
/// after any run and as often as one likes, and runs may be stopped or continued for any reason, also because an
/// interval is narrow enough.
///
/// The interval after n runs with k events is what `∫ uᵏ(1−u)ⁿ⁻ᵏ dπ(u) < θᵏ(1−θ)ⁿ⁻ᵏ/(1 − c)` leaves of the shares θ
/// (Robbins 1970, doi:10.1214/aoms/1177696786; Howard, Ramdas, McAuliffe & Sekhon 2021,
/// doi:10.1214/20-AOS1991). The law π of the mixture is a beta law with the mean of [`about`](Self::about), worth half
/// an event; by default Beta(½, ½). Which π it is changes widths, not the confidence: intervals are narrowest if about as many
/// events are seen as expected.
///
/// Such intervals are wider than those of one look: at 95 %, if about as many events are seen as expected, 1.4 times
/// with 5 events, 1.6 times with 50, 2.0 times with 5,000; the same width takes 1.9, 2.9 and 4.4 times the runs.
/// The interval of one look, stopped at a width and at nothing else, loses little: in 20,000 campaigns each, with nine pairs of
/// share and width, it held the share 89.6 % to 96.8 % of the time at a nominal 90 %. But nothing guarantees that, and where a bound
/// itself stops the runs it fails.
///
/// Bounds have a relative error of 1e-9 at most, of a share near 1 an absolute one of 1e-15.
///
/// ```
/// use gyradius_statistics::{Confidence, ConfidenceSequence, Proportion};
///
/// let confidence = Confidence::default();
/// let interval = ConfidenceSequence::about(0.001, confidence)?.interval(3, 4000)?;
/// let one_look = Proportion::new(3, 4000)?.interval(confidence);
/// assert!(interval.lower() < one_look.lower() && one_look.upper() < interval.upper());
/// # Ok::<(), gyradius_statistics::StatisticsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, getset::CopyGetters)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, remote = "Self")
)]
pub struct ConfidenceSequence {
    about: f64,
    /// The confidence with which all intervals hold together.
    #[getset(get_copy = "pub")]
    confidence: Confidence,
}

crate::checked::checked!(ConfidenceSequence, |read| ConfidenceSequence::about(
    read.about,
    read.confidence
)
.map(drop));

impl ConfidenceSequence {
    /// Of a share of which nothing is known.
    pub fn new(confidence: Confidence) -> Self {
        Self { about: 0.5, confidence }
    }

    /// Of a share that is expected to be about this one, stated before the first run.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Share`] unless it is between 1e-9 and 1 − 1e-9.
    pub fn about(share: f64, confidence: Confidence) -> Result<Self, StatisticsError> {
        Ok(Self { about: error::share(share)?, confidence })
    }

    /// Where the share lies after so many events in so many runs; from 0 to 1 before the first.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Failures`] if there are more events than runs, or more than 10⁹ runs.
    pub fn interval(&self, events: u64, runs: u64) -> Result<Interval, StatisticsError> {
        error::failures(events, runs)?;
        let [lower, upper] = self.bounds(events as f64, runs as f64);
        Ok(Interval::ordered(lower, upper, self.confidence))
    }

    /// A number of runs after which the interval is at most so wide, if so large a share of them are events; none if
    /// 10¹⁵ runs do not do.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Probability`] unless share and width are between 0 and 1.
    pub fn runs_for_width(&self, share: f64, width: f64) -> Result<Option<u64>, StatisticsError> {
        let (share, width) = (error::probability(share)?, error::probability(width)?);
        let runs = law::first(0, MAX_PLANNED, |runs| {
            let [lower, upper] = self.bounds(share * runs as f64, runs as f64);
            upper - lower <= width
        });
        Ok((runs <= MAX_PLANNED).then_some(runs))
    }

    fn bounds(&self, events: f64, runs: f64) -> [f64; 2] {
        let mixture = Mixture::about(self.about);
        let enough = -libm::log(1.0 - self.confidence.level());
        let refuted = |share: f64| mixture.against([share, 1.0 - share], events, runs) >= enough;
        // What is seen is most likely at the share that is seen, against which there is no evidence.
        let seen = events / runs;
        [
            if events > 0.0 { law::bisect(0.0, seen, refuted) } else { 0.0 },
            if events < runs { law::bisect(seen, 1.0, |share| !refuted(share)) } else { 1.0 },
        ]
    }
}

#[cfg(test)]
mod tests;
