//! What is seen of the runs of a simulator, block by block, while they are done.

use gyradius_campaign::{Column, FirstLook, Runs, RunsError, Surveys, Table};
use gyradius_statistics::Confidence;
use std::sync::Mutex;

use super::{body::SimulatedBody, scenario::SimulatorScenario};
use crate::{Fleet, alerts::near_boundary, subject::LookAt};

/// A look at the runs of a model.
#[derive(Debug)]
pub(crate) struct Looking {
    columns: FirstLook,
    /// The columns of the inertia of each body.
    entries: Vec<[String; 6]>,
    /// Of each body how many inertias are near the boundary of what a body can have or beyond it, and how many there are.
    near: Mutex<Vec<[u64; 2]>>,
}

impl Looking {
    pub(super) fn new(scenario: &SimulatorScenario, model: &str, columns: &[Column]) -> Self {
        let columns = FirstLook::new(model, columns, scenario.runs(), Confidence::default())
            .in_groups_of(scenario.sharing().map_or(1, Fleet::flights));
        let entries: Vec<_> = scenario.bodies().iter().map(SimulatedBody::entries).collect();
        let near = Mutex::new(vec![[0; 2]; entries.len()]);
        Self { columns, entries, near }
    }

    /// What is seen once all blocks have been looked at; they are read again.
    pub(super) fn finish(self, runs: &Runs) -> Result<(Surveys, Vec<[u64; 2]>), RunsError> {
        Ok((self.columns.finish(runs)?, self.near.into_inner().unwrap_or_default()))
    }
}

impl LookAt for Looking {
    fn look(&self, block: &Table) {
        self.columns.look(block);
        let of_block: Vec<[u64; 2]> =
            self.entries.iter().map(|entries| near_boundary(block, entries)).collect();
        if let Ok(mut near) = self.near.lock() {
            for (sum, counts) in near.iter_mut().zip(of_block) {
                *sum = [sum[0] + counts[0], sum[1] + counts[1]];
            }
        }
    }
}
