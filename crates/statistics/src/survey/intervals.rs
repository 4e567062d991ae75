//! Where mean and standard deviation of what a survey has seen lie, of runs in groups too.

use super::Survey;
use crate::groups::Grouped;
use crate::{Confidence, Interval};

impl Survey {
    /// Where the true mean lies, as [`Moments::mean_interval`](crate::Moments::mean_interval) has it; of groups, where theirs are known to lie.
    #[must_use]
    pub fn mean_interval(&self, confidence: Confidence) -> Option<Interval> {
        let moments = self.moments()?;
        match self.grouped() {
            Some(grouped) => grouped.mean_interval(moments.mean(), confidence),
            None => Some(moments.mean_interval(confidence)),
        }
    }

    /// Where the true mean less that of another law lies, as [`Moments::mean_difference_interval`](crate::Moments::mean_difference_interval) has it.
    #[must_use]
    pub fn mean_difference_interval(
        &self,
        other: &Self,
        confidence: Confidence,
    ) -> Option<Interval> {
        let (own, of_other) = (self.moments()?, other.moments()?);
        match (self.grouped(), other.grouped()) {
            (Some(grouped), Some(others)) => {
                let difference = own.mean() - of_other.mean();
                grouped.mean_difference_interval(&others, difference, confidence)
            }
            (None, None) => Some(own.mean_difference_interval(of_other, confidence)),
            (Some(_), None) | (None, Some(_)) => None,
        }
    }

    /// Where the true standard deviation lies, as [`Deviation::interval`](crate::Deviation::interval) has it; of groups, where that of all of
    /// them lies.
    ///
    /// Of groups, coverage at 95 % is 0.92 to 0.95 from 50 groups on for normal and uniform laws, whatever groups have in
    /// common; for exponential laws it is 0.94 of 50 groups that have nothing in common and 0.86 of 50, 0.91 of 200 groups of
    /// one value each.
    #[must_use]
    pub fn deviation_interval(&self, confidence: Confidence) -> Option<Interval> {
        match self.grouped() {
            Some(grouped) => self.deviation().and_then(|_| grouped.deviation_interval(confidence)),
            None => self.deviation()?.interval(confidence).ok(),
        }
    }

    /// Where the ratio of the true standard deviation to another lies, as [`Deviation::ratio_interval`](crate::Deviation::ratio_interval) has it.
    #[must_use]
    pub fn deviation_ratio_interval(
        &self,
        other: &Self,
        confidence: Confidence,
    ) -> Option<Interval> {
        let (own, of_other) = (self.deviation()?, other.deviation()?);
        match (self.grouped(), other.grouped()) {
            (Some(grouped), Some(others)) => grouped.ratio_interval(&others, confidence),
            (None, None) => own.ratio_interval(of_other, confidence).ok(),
            (Some(_), None) | (None, Some(_)) => None,
        }
    }

    /// What groups show, if there are any.
    fn grouped(&self) -> Option<Grouped> {
        let groups = self.groups.as_ref()?;
        // Of equal values nothing was gathered; those of one group alone tell nothing of others.
        let constant = || Grouped::constant(groups.first.n());
        Some(self.finite()?.grouped.unwrap_or_else(constant))
    }
}
