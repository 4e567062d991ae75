//! What is seen of the runs of a model in one look at every block: its columns, and the attitudes that were drawn.

use gyradius_campaign::{Runs, RunsError, Surveys, Table};
use gyradius_statistics::{Confidence, Survey};
use nalgebra::UnitQuaternion;

use crate::{body::Body, column::attitudes, quantity::Quantity, scenario::Scenario};

/// Attitudes that are kept, at most: of every so manieth run.
const ATTITUDES: u64 = 1 << 16;

/// What is seen of the runs of a model.
#[derive(Clone, Debug)]
pub(crate) struct Seen {
    pub(crate) surveys: Surveys,
    /// How many attitudes were drawn for payload and stage.
    pub(crate) drawn: [u64; 2],
    /// How many of them are in the half sphere away from the mean, where that is known.
    pub(crate) far: [Option<u64>; 2],
    /// Attitudes of the payload, of some runs that are evenly spaced, in their order.
    pub(crate) attitudes: Vec<UnitQuaternion<f64>>,
}

/// The attitudes of a block.
struct Drawn {
    first: u64,
    drawn: [u64; 2],
    far: [Option<u64>; 2],
    kept: Vec<UnitQuaternion<f64>>,
}

impl Seen {
    /// What is seen of some runs; intervals of quantiles have this confidence.
    pub(crate) fn new(
        scenario: &Scenario,
        runs: &Runs,
        confidence: Confidence,
    ) -> Result<Self, RunsError> {
        let stride = runs.end().div_ceil(ATTITUDES).max(1);
        let mut blocks = Vec::new();
        let look = |block: &Table| Drawn::new(scenario, block, stride);
        let surveys = Surveys::with(runs, confidence, look, |drawn| blocks.push(drawn))?;
        blocks.sort_by_key(|drawn| drawn.first);
        let sum = |of: &dyn Fn(&Drawn) -> u64| blocks.iter().map(of).sum::<u64>();
        let drawn = [0, 1].map(|body: usize| sum(&|block| block.drawn[body]));
        let known = |body: usize| blocks.iter().all(|block| block.far[body].is_some());
        let far = [0, 1].map(|body: usize| {
            known(body).then(|| sum(&|block| block.far[body].unwrap_or_default()))
        });
        let attitudes = blocks.into_iter().flat_map(|block| block.kept).collect();
        Ok(Self { surveys, drawn, far, attitudes })
    }

    pub(crate) fn model(&self) -> &str {
        self.surveys.model()
    }

    pub(crate) fn runs(&self) -> u64 {
        self.surveys.runs()
    }

    /// What a quantity looks like.
    pub(crate) fn quantity(&self, quantity: Quantity) -> Option<&Survey> {
        self.surveys.column(&quantity.column())
    }
}

impl Drawn {
    fn new(scenario: &Scenario, block: &Table, stride: u64) -> Self {
        let all = Body::BOTH.map(|body| attitudes(block, body));
        let laws = [scenario.payload().gaussian_axes(), scenario.stage().gaussian_axes()];
        let of = |body: usize| all[body].iter().map(|(_, attitude)| attitude);
        let far = [0, 1].map(|body: usize| {
            let law = laws[body]?;
            Some(of(body).filter(|q| !law.in_mean_half(q)).count() as u64)
        });
        let kept = all[Body::Payload as usize].iter();
        Self {
            first: block.first(),
            drawn: [0, 1].map(|body: usize| all[body].len() as u64),
            far,
            kept: kept.filter(|(run, _)| run.is_multiple_of(stride)).map(|(_, q)| *q).collect(),
        }
    }
}
