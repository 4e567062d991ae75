//! The runs of a campaign that its own runs end.

use std::sync::Arc;

use super::{Evidence, Until};
use crate::{
    campaign::{Plan, run_missing},
    folder::Blocks,
    simulation::{CampaignError, Progress, Simulation},
};

/// How a campaign ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct End {
    /// Runs of each simulation.
    pub runs: u64,
    /// Whether they were enough, and not the greatest number.
    pub enough: bool,
    /// After how many runs the first look that counts was, if there were more before than the rule would have asked for.
    pub first_look: Option<u64>,
}

/// Does the planned runs of some simulations that are in no block yet, until there is enough evidence. If there are more runs
/// already than were enough, none is dropped: all of them are looked at first, and the rule goes on from there. To be called
/// in the threads that are to do it; `evidence` makes what has seen nothing.
///
/// # Errors
/// As [`run_missing`]; or there are more runs than can be judged.
pub fn run_until<S: Simulation>(
    simulations: &[(&str, S)],
    blocks: &Blocks,
    plan: Plan<'_>,
    progress: Progress<'_>,
    until: &Until,
    evidence: impl Fn() -> Evidence,
) -> Result<End, CampaignError> {
    let there = simulations.iter().filter_map(|(model, _)| blocks.end(model)).max().unwrap_or(0);
    let end = ended(simulations, blocks, plan, progress, until, evidence())?;
    if !end.enough || there <= end.runs {
        return Ok(end);
    }
    let late = until.clone().with_first_look(Some(there));
    ended(simulations, blocks, plan, progress, &late, evidence())
}

fn ended<S: Simulation>(
    simulations: &[(&str, S)],
    blocks: &Blocks,
    plan: Plan<'_>,
    progress: Progress<'_>,
    until: &Until,
    mut evidence: Evidence,
) -> Result<End, CampaignError> {
    let (mut seen, mut end) = (0, End { runs: 0, enough: false, first_look: until.first_look() });
    for look in until.looks() {
        let all = run_missing(simulations, blocks, Plan { runs: look, ..plan }, progress, None)?;
        for (place, runs) in all.into_iter().enumerate() {
            runs.stopped_by(plan.stop.map(Arc::clone))
                .in_order(seen..look, |block| evidence.look(place, block, seen..look))?;
        }
        let enough = evidence.is_enough().map_err(CampaignError::Judged)?;
        end = End { runs: look, enough, ..end };
        if enough {
            break;
        }
        seen = look;
    }
    Ok(end)
}
