//! The runs of a campaign that its own runs end.

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
}

/// Does the planned runs of some simulations that are in no block yet, until there is enough evidence, looked at as `until` says. To
/// be called in the threads that are to do it; `evidence` has seen nothing. `begin` is called before the first run that is done, and
/// not if all that are looked at are there.
///
/// # Errors
/// As [`run_missing`]; there are more runs than can be judged; or that of `begin`.
pub fn run_until<S: Simulation, E: From<CampaignError>>(
    simulations: &[(&str, S)],
    blocks: &Blocks,
    plan: Plan<'_>,
    progress: Progress<'_>,
    until: &Until,
    mut evidence: Evidence,
    begin: impl Fn() -> Result<(), E>,
) -> Result<End, E> {
    let (mut end, mut begun) = (End { runs: 0, enough: false }, false);
    for look in until.looks() {
        let plan = Plan { runs: look, ..plan };
        let mut models = simulations.iter().enumerate();
        if !begun && models.any(|(at, (name, _))| !plan.missing(blocks, at, name).is_empty()) {
            begin()?;
            begun = true;
        }
        let all = run_missing(simulations, blocks, plan, progress, None)?;
        let new = end.runs..look;
        for (place, runs) in all.into_iter().enumerate() {
            runs.stopped_by(plan.stop.cloned())
                .in_order(new.clone(), |block| evidence.look(place, block, new.clone()))
                .map_err(CampaignError::from)?;
        }
        end = End { runs: look, enough: evidence.is_enough().map_err(CampaignError::Judged)? };
        if end.enough {
            break;
        }
    }
    Ok(end)
}
