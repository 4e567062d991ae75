//! What the draws of the links have come to.

use gyradius_campaign::Streams;
use gyradius_estimation::StatementWarning;
use gyradius_inertia::InertiaMatrix;
use gyradius_statistics::Moments;
use rand_distr::{Distribution, StandardNormal};

use super::{RobotDraw, drawn_link::DrawnLink};

/// Draws that are looked at, at most.
const LOOKED_AT: u64 = 2000;
/// What keys the streams of the common practice.
const NAIVE: &str = "robot, entry by entry";

/// The standard deviations of the draws of a link, the first two thousand of them.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkSummary {
    /// Its name.
    pub name: String,
    /// Of the mass, in percent of the nominal one.
    pub mass_percent: f64,
    /// Of the mass centre along the axes of the link, m.
    pub centre_m: [f64; 3],
    /// Of I₁₁, I₂₂, I₃₃, in percent of the nominal ones; not a number where these are zero.
    pub moments_percent: [f64; 3],
    /// How many draws would be of no body if I₁₁, I₂₂, I₃₃ were each multiplied by a factor of its own, with the
    /// standard deviations stated for the moments, and how many were tried.
    pub naive_impossible: Option<(u64, u64)>,
    /// Contradictions in what is stated, and what has been left open.
    pub warnings: Vec<StatementWarning>,
}

impl RobotDraw<'_> {
    /// How many draws the summaries are of: the first ones, where there are more.
    #[must_use]
    pub fn summarized(&self) -> u64 {
        self.options.draws.min(LOOKED_AT)
    }

    /// Whether there are more.
    #[must_use]
    pub fn has_more(&self) -> bool {
        self.options.draws > LOOKED_AT
    }

    /// What the draws of each link have come to.
    #[must_use]
    pub fn summaries(&self) -> Vec<LinkSummary> {
        let end = self.options.first + self.summarized();
        self.links.iter().map(|link| self.summary(link, end)).collect()
    }

    fn summary(&self, link: &DrawnLink, end: u64) -> LinkSummary {
        let nominal = link.law.nominal();
        let mut columns: [Vec<f64>; 7] = Default::default();
        for draw in self.options.first..end {
            let body = link.body(draw);
            let [x, y, z]: [f64; 3] = body.mass_centre_m().into();
            let [i11, i22, i33, ..] = body.inertia().entries();
            let values = [body.mass_kg(), x, y, z, i11, i22, i33];
            columns.iter_mut().zip(values).for_each(|(column, value)| column.push(value));
        }
        let [mass, x, y, z, i11, i22, i33] = columns.map(|column| {
            Moments::new(&column).map_or(0.0, |moments| moments.standard_deviation())
        });
        let [n11, n22, n33, ..] = nominal.inertia().entries();
        LinkSummary {
            name: link.name.clone(),
            mass_percent: 100.0 * mass / nominal.mass_kg(),
            centre_m: [x, y, z],
            moments_percent: [i11 / n11, i22 / n22, i33 / n33].map(|share| 100.0 * share),
            naive_impossible: self.naive(link, end),
            warnings: link.law.warnings().to_vec(),
        }
    }

    fn naive(&self, link: &DrawnLink, end: u64) -> Option<(u64, u64)> {
        let [i11, i22, i33, i12, i13, i23] = link.law.nominal().inertia().entries();
        let deviations = self.options.statements.moments?.deviations([i11, i22, i33]);
        if i11 + i22 + i33 == 0.0 {
            return None;
        }
        let streams = Streams::new(self.options.seed, NAIVE, &link.name);
        let is_impossible = |draw: &u64| {
            let mut rng = streams.run(*draw);
            let mut moment = |nominal: f64, deviation: f64| {
                let score: f64 = StandardNormal.sample(&mut rng);
                nominal + deviation * score
            };
            let moments = [
                moment(i11, deviations[0]),
                moment(i22, deviations[1]),
                moment(i33, deviations[2]),
            ];
            let matrix = InertiaMatrix::from_entries(moments, [i12, i13, i23]);
            matrix.is_ok_and(|matrix| !matrix.is_realizable())
        };
        let draws = self.options.first..end;
        let tried = draws.end - draws.start;
        Some((draws.filter(is_impossible).count() as u64, tried))
    }
}
