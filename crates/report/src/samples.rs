//! Samples that are shown together.

use gyradius_statistics::{SortedSample, Survey};
use std::borrow::Cow;

/// One sample of one quantity under one model.
#[derive(Debug, Clone)]
pub struct Series<'a> {
    /// Name of the model, as in the legend; a name has the same colour in all panels.
    pub(crate) name: &'a str,
    /// The finite ones of the values.
    pub(crate) sample: Option<Cow<'a, SortedSample>>,
    /// How many values there are.
    pub(crate) values: usize,
    pub(crate) runs: usize,
}

impl<'a> Series<'a> {
    /// Of the values of the runs that have one, of so many runs, in the unit that the label of the panel names.
    /// Values that are not finite cannot be drawn, and are counted in a note, as are the runs without a value.
    #[must_use]
    pub fn new(name: &'a str, values: &[f64], runs: usize) -> Self {
        let finite: Vec<f64> = values.iter().copied().filter(|x| x.is_finite()).collect();
        let sample = SortedSample::new(&finite).ok().map(Cow::Owned);
        Self { name, sample, values: values.len(), runs }
    }

    /// Of a survey of the values of so many runs: those of the runs that it keeps; none if there is no survey.
    #[must_use]
    pub fn surveyed(name: &'a str, survey: Option<&'a Survey>, runs: u64) -> Self {
        let sample = survey.and_then(Survey::sample).map(Cow::Borrowed);
        let kept = |all: u64| survey.map_or(all, |survey| all.div_ceil(survey.stride())) as usize;
        Self { name, sample, values: survey.map_or(0, Survey::sampled) as usize, runs: kept(runs) }
    }

    /// The finite ones of the values.
    pub(crate) fn sample(&self) -> Option<&SortedSample> {
        self.sample.as_deref()
    }
}

/// Histograms of the same quantity under several models, on the same axes and bins.
#[derive(Debug, Clone)]
pub struct Panel<'a> {
    /// What is on the horizontal axis, with its unit: `wobble (deg)`, `I₁₂ (kg·m²)`.
    pub label: String,
    /// The samples, one per model.
    pub series: Vec<Series<'a>>,
    /// A value to mark, in the unit of the label.
    pub nominal: Option<f64>,
}
