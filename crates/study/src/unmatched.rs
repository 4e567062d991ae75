//! Laws that have not the moments to which they were to be matched, since no law of their kind is found that has.

use gyradius_dispersion::EntryMoments;
use gyradius_report::{resolved, significant};
use serde::{Deserialize, Serialize};
use std::fmt;

/// A mean that is off by a smaller share of a standard deviation is not told, nor is a standard deviation that is off by a smaller
/// share of itself.
const TOLD: f64 = 1e-3;

/// The log-Cholesky law of a body that was to have mean and covariance of another law, which is so wide that no
/// log-Cholesky law with them is found: the law to first order is taken in its place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct UnmatchedLaw {
    /// The model.
    pub model: String,
    /// The model to whose moments it was to be matched.
    pub matched_to: String,
    /// The body.
    pub body: String,
    /// How far the mean of an entry of the inertia is off at most, in standard deviations of that entry.
    pub mean_off: f64,
    /// The standard deviation of an entry over the one asked for, of the entry of which it is farthest from one.
    pub deviation_ratio: f64,
}

impl UnmatchedLaw {
    /// That of a model and a body, from the moments that were asked for and those that came out; nothing if they are the
    /// same.
    pub(crate) fn of(
        [model, matched_to, body]: [&str; 3],
        asked: &EntryMoments,
        found: &EntryMoments,
    ) -> Option<Self> {
        let (means, others) = (asked.mean(), found.mean());
        let (asked, found) = (asked.deviations(), found.deviations());
        let largest = asked.into_iter().fold(0.0, f64::max);
        // Of an entry that is known exactly, deviations are rounding.
        let uncertain = || (0..6).filter(|e| asked[*e] > TOLD * TOLD * largest);
        let off = uncertain().map(|e| (others[e] - means[e]).abs() / asked[e]);
        let ratios = uncertain().map(|e| found[e] / asked[e]);
        let mean_off = off.fold(0.0, f64::max);
        let farther = |a: f64, b: f64| if b.ln().abs() > a.ln().abs() { b } else { a };
        let deviation_ratio = ratios.fold(1.0, farther);
        let is_off = mean_off > TOLD || (deviation_ratio - 1.0).abs() > TOLD;
        let [model, matched_to, body] = [model, matched_to, body].map(str::to_owned);
        is_off.then_some(Self { model, matched_to, body, mean_off, deviation_ratio })
    }
}

impl fmt::Display for UnmatchedLaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { model, matched_to, body, mean_off, deviation_ratio } = self;
        write!(
            f,
            "{model}: no log-cholesky law is found with the mean and covariance that {matched_to:?} has for the inertia of the {body}. \
             The law to first order is drawn in its place: a mean is off by up to {} standard deviations, and a standard \
             deviation is {} times what it should be",
            significant(*mean_off, 2),
            resolved(Some(*deviation_ratio), Some((deviation_ratio - 1.0).abs()), 3)
        )
    }
}
