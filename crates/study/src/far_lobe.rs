//! The section of the report on the second lobe of the attitudes that were drawn.

use gyradius_campaign::Share;
use gyradius_report::{Section, Text, percent};

use crate::{body::Body, summary::Summary};

/// How many of the draws of each body lie about the inverse of the mean attitude; nothing where none do.
pub(crate) fn section(summary: &Summary) -> Option<Section> {
    let lobes = || summary.models.iter().filter_map(|m| Some((&m.name, m.far_half?)));
    let reading = Text::from(
        "A quaternion and its negative are one attitude, but the radially constrained Gaussian does not know it: \
         where its covariance is wide along the mean, a second lobe of draws lies in the half sphere away from \
         the mean. As attitudes these lie about the ",
    )
    .emphasis("inverse")
    .plain(" of the mean attitude. Axes of “mean-half” leave them out.");
    let items = lobes().map(|(name, shares)| {
        let of = |(body, share): (Body, Option<Share>)| {
            Some(format!("{} of the draws of the {}", percent(&share?), body.name()))
        };
        let shares: Vec<String> = Body::BOTH.into_iter().zip(shares).filter_map(of).collect();
        Text::default().strong(name).plain(format!(": {}.", shares.join(", ")))
    });
    lobes()
        .any(|(_, far)| far.iter().flatten().any(|s| s.count > 0))
        .then(|| Section::new("The second lobe").paragraph(reading).list(items))
}
