//! What is seen of the runs of a model: its columns, and the attitudes that were drawn.

use gyradius_campaign::{Column, FirstLook, Runs, RunsError, Surveys, Table};
use gyradius_statistics::{Confidence, Survey};
use nalgebra::UnitQuaternion;
use std::sync::Mutex;

use crate::{
    Fleet,
    alerts::near_boundary,
    backwards::backwards,
    body::{Body, Entry},
    column::attitudes,
    faults::{Faults, GivenFault},
    quantity::Quantity,
    scenario::Scenario,
    subject::LookAt,
};

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
    /// How many inertias of payload and stage are near the boundary of what is realizable, and how many there are.
    pub(crate) near_boundary: [[u64; 2]; 2],
    /// In how many runs the payload leaves the wrong way.
    pub(crate) backwards: u64,
    /// Attitudes of the payload, of some runs that are evenly spaced, in their order.
    pub(crate) attitudes: Vec<UnitQuaternion<f64>>,
    /// What happens given each fault.
    pub(crate) faults: Vec<GivenFault>,
}

/// What is seen of the runs of a model, block by block, while they are done.
#[derive(Debug)]
pub(crate) struct Looking<'a> {
    scenario: &'a Scenario,
    columns: FirstLook,
    faults: Faults<'a>,
    blocks: Mutex<Vec<Drawn>>,
}

/// The attitudes of a block.
#[derive(Debug)]
struct Drawn {
    first: u64,
    drawn: [u64; 2],
    far: [Option<u64>; 2],
    near_boundary: [[u64; 2]; 2],
    backwards: u64,
    kept: Vec<UnitQuaternion<f64>>,
}

impl<'a> Looking<'a> {
    /// At the runs of a model of a scenario, in these columns.
    pub(crate) fn new(scenario: &'a Scenario, model: &str, columns: &[Column]) -> Self {
        let (runs, confidence) = (scenario.runs(), Confidence::default());
        let columns = FirstLook::new(model, columns, runs, confidence)
            .in_groups_of(scenario.sharing().map_or(1, Fleet::flights));
        let faults = Faults::new(scenario, model);
        let columns = faults.watched_by(columns, runs, confidence);
        Self { scenario, columns, faults, blocks: Mutex::default() }
    }

    /// What is seen once all blocks have been looked at; they are read again.
    pub(crate) fn finish(self, runs: &Runs) -> Result<Seen, RunsError> {
        let surveys = self.columns.finish(runs)?;
        let mut blocks = self.blocks.into_inner().unwrap_or_default();
        blocks.sort_by_key(|drawn| drawn.first);
        let sum = |of: &dyn Fn(&Drawn) -> u64| blocks.iter().map(of).sum::<u64>();
        let drawn = [0, 1].map(|body: usize| sum(&|block| block.drawn[body]));
        let known = |body: usize| blocks.iter().all(|block| block.far[body].is_some());
        let far = [0, 1].map(|body: usize| {
            known(body).then(|| sum(&|block| block.far[body].unwrap_or_default()))
        });
        let near = |body: usize| [0, 1].map(|i: usize| sum(&|block| block.near_boundary[body][i]));
        let near_boundary = [near(0), near(1)];
        let backwards = sum(&|block| block.backwards);
        let attitudes = blocks.into_iter().flat_map(|block| block.kept).collect();
        let faults = self.faults.finish(&surveys, Confidence::default());
        Ok(Seen { surveys, drawn, far, near_boundary, backwards, attitudes, faults })
    }
}

impl LookAt for Looking<'_> {
    fn look(&self, block: &Table) {
        self.columns.look(block);
        self.faults.look(block);
        let stride = self.scenario.runs().div_ceil(ATTITUDES).max(1);
        let drawn = Drawn::new(self.scenario, block, stride);
        if let Ok(mut blocks) = self.blocks.lock() {
            blocks.push(drawn);
        }
    }
}

impl Seen {
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
            near_boundary: Body::BOTH.map(|body| {
                near_boundary(block, &Entry::ALL.map(|entry| Quantity::entry(body, entry).column()))
            }),
            backwards: backwards(scenario, block),
            kept: kept.filter(|(run, _)| run.is_multiple_of(stride)).map(|(_, q)| *q).collect(),
        }
    }
}
