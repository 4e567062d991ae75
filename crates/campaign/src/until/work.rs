//! The runs of a campaign that its own runs end.

use std::sync::Arc;

use super::{Evidence, Until};
use crate::{
    campaign::{Plan, run_missing},
    folder::Blocks,
    simulation::{CampaignError, Progress, Simulation},
};

/// Does the planned runs of some simulations that are in no block yet, until there is enough evidence; returns how many
/// runs each of them has then, and whether it was enough. What is there already is looked at as it is: first after all
/// runs that there are. To be called in the threads that are to do it.
///
/// # Errors
/// As [`run_missing`]; or there are more runs than can be judged.
pub fn run_until<S: Simulation>(
    simulations: &[(&str, S)],
    blocks: &Blocks,
    plan: Plan<'_>,
    progress: Progress<'_>,
    until: &Until,
    mut evidence: Evidence,
) -> Result<(u64, bool), CampaignError> {
    let there = simulations.iter().filter_map(|(model, _)| blocks.end(model)).max().unwrap_or(0);
    let mut look = until.first_look(there);
    let mut seen = 0;
    loop {
        let all = run_missing(simulations, blocks, Plan { runs: look, ..plan }, progress, None)?;
        for (place, runs) in all.into_iter().enumerate() {
            runs.stopped_by(plan.stop.map(Arc::clone))
                .in_order(seen, |block| evidence.look(place, block))?;
        }
        let enough = evidence.is_enough().map_err(CampaignError::Judged)?;
        match until.next_look(look).filter(|_| !enough) {
            None => return Ok((look, enough)),
            Some(next) => (seen, look) = (look, next),
        }
    }
}
