//! What of the draws of a model the regions of the bodies keep.

use gyradius_report::{Section, Text, significant};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// What of the draws of a body is kept, for matter in its region can have them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct RegionSummary {
    pub(crate) body: Cow<'static, str>,
    /// The estimated share of draws that is kept; the others were drawn again.
    pub(crate) acceptance: f64,
    pub(crate) standard_error: f64,
}

impl RegionSummary {
    /// Of a body by its name, from the share that is kept and its standard error.
    pub(crate) fn new(
        body: impl Into<Cow<'static, str>>,
        (acceptance, standard_error): (f64, f64),
    ) -> Self {
        Self { body: body.into(), acceptance, standard_error }
    }
}

/// What of the draws of models with these names the regions keep; none without regions.
pub(crate) fn section<'a>(
    models: impl Iterator<Item = (&'a str, &'a [RegionSummary])>,
) -> Option<Section> {
    let items: Vec<Text> = models
        .filter(|(_, regions)| !regions.is_empty())
        .map(|(name, regions)| {
            let kept = regions.iter().map(|region| {
                let RegionSummary { body, acceptance, standard_error } = region;
                let [share, error] =
                    [acceptance, standard_error].map(|x| significant(100.0 * x, 3));
                format!("{share} % ± {error} % of the {body}'s draws")
            });
            let kept = kept.collect::<Vec<_>>().join(", ");
            Text::default().strong(name).plain(format!(": {kept}."))
        })
        .collect();
    let reading = "Mass, mass centre and inertia of a body that is kept to a region are drawn together again until matter \
                   in the region can have them. Shares of draws that were kept, by trial draws, with their standard \
                   errors. Models that draw the inertia by another law than the body's own are not kept to its region.";
    (!items.is_empty()).then(|| Section::new("Regions of matter").paragraph(reading).list(items))
}
