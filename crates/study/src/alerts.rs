//! What a reader should know before relying on the results: only what is so.

use gyradius_campaign::{SampleSummary, Surveys, Table};
use gyradius_report::{Section, Text, direction, most_frequent, significant};
use gyradius_separation::MovingBody;
use gyradius_statistics::Survey;
use nalgebra::{Unit, Vector3};
use serde::{Deserialize, Serialize};
use std::{borrow::Cow, mem::discriminant};

use crate::{
    Fleet, folded::FoldedRoot, off_nominal::OffNominal, rounding::Rounding, scenario::Dispersed,
    unmatched::UnmatchedLaw,
};

/// A kurtosis above which tails are heavy: intervals of standard deviations then cover less often than they say.
pub(crate) const HEAVY: f64 = 10.0;
/// A share of the trace: the margin of a body that is near the boundary of what is realizable.
pub(crate) const NEAR: f64 = 0.01;
/// A share of the drawn bodies: more of them must be near the boundary, that it is told.
const MANY: f64 = 0.001;
/// Degrees between the angular momentum at the start and the spin axis: from here on, another principal axis may be nearer.
const OFF_AXIS_DEG: f64 = 45.0;

/// What a reader should know before relying on the results. Each is told only if it is so.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "alert")]
pub(crate) enum Alert {
    /// Runs failed.
    Failed {
        model: String,
        failed: u64,
        runs: u64,
        /// Kinds of failure, with how often.
        kinds: Vec<(String, u64)>,
        /// The first run that failed, and all that its row says of why, where that is more than the kind.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        first: Option<(u64, String)>,
    },
    /// The run without any dispersion failed.
    NominalFailed { why: String },
    /// What is declared as dispersed is the same in all runs.
    Unmoved {
        model: String,
        column: String,
        value: f64,
        runs: u64,
        /// How many vehicles drew it, if each draws it once for all of its flights.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        vehicles: Option<u64>,
        /// The probability of what is dispersed, if it is an event.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        probability: Option<f64>,
    },
    /// Less than half of the runs have a value of outcomes.
    FewValues {
        model: String,
        /// Labels of outcomes, with how many runs have a value.
        outcomes: Vec<(String, u64)>,
        /// Runs that did not fail.
        runs: u64,
    },
    /// In runs the payload leaves by more than 90° away from where it is to go, as the stage stands.
    Backwards {
        model: String,
        backwards: u64,
        runs: u64,
        /// Whether the bodies have outlines, which tell whether they touch.
        #[serde(default)]
        outlines: bool,
    },
    /// The angular momentum of the payload at the start is far from the axis that it is to spin about.
    OffAxis { angle_deg: f64, spin_axis: [f64; 3] },
    /// The mean of a law is far from the nominal value that the same scenario states.
    OffNominal(OffNominal),
    /// The fourth moment of outcomes is large.
    HeavyTails {
        model: String,
        /// Labels of outcomes, with their kurtosis.
        outcomes: Vec<(String, f64)>,
    },
    /// Many of the bodies that were drawn are hardly realizable, or not.
    NearBoundary { model: String, body: String, near: u64, drawn: u64, margin: f64 },
    /// A length or root of a body lies below zero in part.
    Folded(FoldedRoot),
    /// A law has not the moments to which it was to be matched.
    Unmatched(UnmatchedLaw),
}

impl Alert {
    /// That runs of a model failed, if any did.
    pub(crate) fn failed(surveys: &Surveys) -> Option<Self> {
        let kinds = surveys.failures().into_iter().map(|(kind, count)| (kind.to_owned(), count));
        let kinds: Vec<(String, u64)> = kinds.collect();
        let failed = kinds.iter().map(|(_, count)| count).sum();
        let (model, runs) = (surveys.model().to_owned(), surveys.runs());
        let first = surveys.first_failure().map(|(run, why)| (run, why.to_owned()));
        let first = first.filter(|(_, why)| kinds.iter().all(|(kind, _)| kind != why));
        (failed > 0).then_some(Self::Failed { model, failed, runs, kinds, first })
    }

    /// Why the first run of a model failed, where there is more to say than the kind.
    pub(crate) fn first_failure(&self, of: &str) -> Option<String> {
        let Self::Failed { model, first: Some((run, why)), .. } = self else { return None };
        (model == of).then(|| format!("the first, run {run}: {why}"))
    }

    /// That what is declared as dispersed is the same in all of several runs, of these vehicles if there are any.
    pub(crate) fn unmoved<T>(
        model: &str,
        dispersed: &Dispersed<T>,
        survey: &Survey,
        fleet: Option<Fleet>,
    ) -> Option<Self> {
        let (value, runs) = (survey.minimum()?.0, survey.n());
        let is_constant = runs > 1 && survey.maximum()?.0 == value;
        let (model, column) = (model.to_owned(), dispersed.column.clone());
        let vehicles = fleet.filter(|_| !dispersed.each.is_flight());
        let vehicles = vehicles.map(|fleet| runs.div_ceil(fleet.flights()));
        let probability = dispersed.law.as_bernoulli();
        is_constant.then_some(Self::Unmoved { model, column, value, runs, vehicles, probability })
    }

    /// That less than half of so many runs, which did not fail, have a value of outcomes, given by their labels with how many runs have
    /// one. Of an outcome that no run has there are no statistics to mistake.
    pub(crate) fn few_values(
        model: &str,
        outcomes: impl IntoIterator<Item = (String, u64)>,
        runs: u64,
    ) -> Option<Self> {
        let few = |(_, n): &(String, u64)| *n > 0 && 2 * *n < runs;
        let outcomes: Vec<(String, u64)> = outcomes.into_iter().filter(few).collect();
        let model = model.to_owned();
        (!outcomes.is_empty()).then_some(Self::FewValues { model, outcomes, runs })
    }

    /// That in so many runs, of those in which the bodies part, the payload leaves by more than 90° away from where it is to
    /// go, as the stage stands, if it does in any.
    pub(crate) fn backwards(
        model: &str,
        backwards: u64,
        runs: u64,
        outlines: bool,
    ) -> Option<Self> {
        let model = model.to_owned();
        (backwards > 0).then_some(Self::Backwards { model, backwards, runs, outlines })
    }

    /// That the payload without any dispersion starts with an angular momentum that is far from its spin axis.
    pub(crate) fn off_axis(payload: &MovingBody, spin_axis: &Unit<Vector3<f64>>) -> Option<Self> {
        let angle_deg = payload.spin_metrics(spin_axis).cone()?.to_degrees();
        let spin_axis = (*spin_axis.as_ref()).into();
        (angle_deg > OFF_AXIS_DEG).then_some(Self::OffAxis { angle_deg, spin_axis })
    }

    /// That outcomes, by their labels and with columns and units, have heavy tails: they vary by more than this rounding.
    pub(crate) fn heavy_tails<'a>(
        model: &str,
        outcomes: impl IntoIterator<Item = (String, (Cow<'a, str>, &'a str), &'a SampleSummary)>,
        rounding: Rounding,
    ) -> Option<Self> {
        let heavy =
            |(label, (column, unit), sample): (String, (Cow<'_, str>, &str), &SampleSummary)| {
                let kurtosis = sample.kurtosis.filter(|kurtosis| *kurtosis > HEAVY)?;
                let varies =
                    rounding.is_exceeded(sample.minimum?, sample.maximum?, (&column, unit));
                varies.then_some((label, kurtosis))
            };
        let outcomes: Vec<(String, f64)> = outcomes.into_iter().filter_map(heavy).collect();
        let model = model.to_owned();
        (!outcomes.is_empty()).then_some(Self::HeavyTails { model, outcomes })
    }

    /// That so many of the drawn bodies are near the boundary of what is realizable, if these are many.
    pub(crate) fn near_boundary(model: &str, body: &str, near: u64, drawn: u64) -> Option<Self> {
        let (model, body) = (model.to_owned(), body.to_owned());
        (near as f64 > MANY * drawn as f64).then_some(Self::NearBoundary {
            model,
            body,
            near,
            drawn,
            margin: NEAR,
        })
    }

    /// What is said of it. Alerts of several models or columns that say the same of each are told together, where the first of them stands.
    fn text(&self, all: &[Self]) -> Option<Text> {
        let same_kind = |other: &&Self| discriminant(*other) == discriminant(self);
        let is_first = || all.iter().find(same_kind).is_some_and(|first| std::ptr::eq(first, self));
        Some(match self {
            Self::Failed { model, failed, runs, kinds, .. } => {
                let mut kinds = most_frequent(kinds).join("; ");
                if let Some(first) = self.first_failure(model) {
                    kinds += &format!("; {first}");
                }
                Text::default()
                    .strong(format!("{model}: {failed} of {runs} runs failed"))
                    .plain(format!(" and are left out of means, deviations and percentiles of the outcomes, not of what was drawn: {kinds}; see "))
                    .code("status")
                    .plain(" in the run table.")
            }
            Self::NominalFailed { why } => Text::default()
                .strong("The separation without any dispersion fails")
                .plain(format!(
                    ": {why}. So there are no outcomes of the nominal bodies but the wobble and the inertia ratio, which follow from \
                     the inertia alone."
                )),
            Self::Unmoved { .. } => return is_first().then(|| together::unmoved(all)),
            Self::FewValues { .. } => return is_first().then(|| together::few_values(all)),
            Self::Backwards { model, backwards, runs, outlines } => {
                let text = Text::default()
                    .strong(format!("{model}: the payload leaves the wrong way in {backwards} of {runs} runs"))
                    .plain(", more than 90° away from the intended direction, which is turned here with the stage as it stands when the clamp opens. ");
                if *outlines {
                    text.plain("Below is told in how many runs the outlines of the bodies touch.")
                } else {
                    text.plain("It may have gone through the stage, which no spring hinders: outlines of the bodies, under ")
                        .code("[clearance]")
                        .plain(" in the scenario, would tell.")
                }
            }
            Self::OffAxis { angle_deg, spin_axis } => Text::default()
                .strong("The payload does not spin about its spin axis at the start")
                .plain(format!(": without dispersion, its angular momentum is {}° from ", significant(*angle_deg, 3)))
                .code("spin_axis")
                .plain(format!(
                    " = {}, which is body axis 1 where the scenario does not state it. Nutation, cone and wobble are about \
                     that axis.",
                    direction(*spin_axis)
                )),
            Self::OffNominal(law) => {
                let (text, said) = (Text::default().strong(law.title()), format!(": {law}"));
                // What is to be written keeps its hyphens, which are minus signs in words.
                match law.instead().and_then(|instead| Some((said.strip_suffix(instead)?, instead))) {
                    Some((words, instead)) => text.plain(words).code(instead),
                    None => text.plain(said),
                }
            }
            Self::HeavyTails { .. } => return is_first().then(|| together::heavy_tails(all)),
            Self::NearBoundary { model, body, near, drawn, margin } => {
                let share = significant(100.0 * *near as f64 / *drawn as f64, 3);
                Text::default()
                    .strong(format!("{model}: {share} % of the drawn inertias of the {body} are near the boundary"))
                    .plain(format!(
                        " of what a body can have, or beyond it: their smallest second moment is less than {} % of the \
                         trace of the inertia matrix ({near} of {drawn}). Is the {body} so nearly a plate, or is its \
                         uncertainty too large?",
                        100.0 * margin
                    ))
            }
            Self::Unmatched(law) => {
                Text::default().strong("A model has not the moments that it is matched to").plain(format!("; {law}."))
            }
            Self::Folded(root) => Text::default().strong("A law is folded at zero").plain(format!(": {root}.")),
        })
    }
}

/// What a reader should know before relying on the results, if there is anything.
pub(crate) fn section(alerts: &[Alert]) -> Option<Section> {
    let texts: Vec<Text> = alerts.iter().filter_map(|alert| alert.text(alerts)).collect();
    (!alerts.is_empty()).then(|| Section::new("Before you rely on the results").warnings(texts))
}

/// How many of the inertias of a body in a run table have a margin below [`NEAR`], and how many there are. The margin is the smallest
/// second moment over the trace, and every margin is above a number if ½ tr(I)·1 − I less that share of the trace is positive definite.
pub(crate) fn near_boundary(table: &Table, entries: &[impl AsRef<str>; 6]) -> [u64; 2] {
    let columns = entries.each_ref().map(|entry| table.numbers(entry.as_ref()));
    let inertia = |place: usize| {
        let mut of_run = [0.0; 6];
        for (entry, numbers) in of_run.iter_mut().zip(&columns) {
            *entry = (*numbers)?.get(place)?;
        }
        Some(of_run)
    };
    let mut counts = [0; 2];
    for [i11, i22, i33, i12, i13, i23] in (0..table.len()).filter_map(inertia) {
        let trace = i11 + i22 + i33;
        let most = (0.5 - NEAR) * trace;
        let [a, b, c] = [most - i11, most - i22, most - i33];
        let minor = a * b - i12 * i12;
        let determinant = c * minor - a * i23 * i23 - b * i13 * i13 - 2.0 * i12 * i13 * i23;
        let is_far = a > 0.0 && minor > 0.0 && determinant > 0.0;
        counts = [counts[0] + u64::from(!is_far), counts[1] + 1];
    }
    counts
}

mod together;

#[cfg(test)]
mod nominal_tests;
#[cfg(test)]
mod root_tests;
#[cfg(test)]
mod rounding_tests;
#[cfg(test)]
mod some_runs_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod vehicle_tests;
#[cfg(test)]
mod whole_value_tests;
