//! The runs of a campaign that its own runs end.

use std::{
    cell::Cell,
    sync::{Arc, atomic::AtomicBool},
};

use super::{Evidence, Until};
use crate::{
    campaign::{Plan, run_missing},
    folder::Blocks,
    runs::Runs,
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
/// in the threads that are to do it; `evidence` makes what has seen nothing. `begin` is called before the first run that is done,
/// and not if all that are looked at are there.
///
/// # Errors
/// As [`run_missing`]; there are more runs than can be judged; or that of `begin`.
pub fn run_until<S: Simulation, E: From<CampaignError>>(
    simulations: &[(&str, S)],
    blocks: &Blocks,
    plan: Plan<'_>,
    progress: Progress<'_>,
    until: &Until,
    evidence: impl Fn() -> Evidence,
    begin: impl Fn() -> Result<(), E>,
) -> Result<End, E> {
    let there = simulations.iter().filter_map(|(model, _)| blocks.end(model)).max().unwrap_or(0);
    let begun = Cell::new(false);
    let ended = |until: &Until| {
        let run_to = |look| {
            let plan = Plan { runs: look, ..plan };
            let mut models = simulations.iter().enumerate();
            if !begun.get()
                && models.any(|(at, (name, _))| !plan.missing(blocks, at, name).is_empty())
            {
                begin()?;
                begun.set(true);
            }
            Ok::<_, E>(run_missing(simulations, blocks, plan, progress, None)?)
        };
        ended(run_to, plan.stop, until, evidence())
    };
    let end = ended(until)?;
    if !end.enough || there <= end.runs {
        return Ok(end);
    }
    ended(&until.clone().with_first_look(Some(there)))
}

/// `run_to` gives the runs of each model to a number.
fn ended<E: From<CampaignError>>(
    run_to: impl Fn(u64) -> Result<Vec<Runs>, E>,
    stop: Option<&Arc<AtomicBool>>,
    until: &Until,
    mut evidence: Evidence,
) -> Result<End, E> {
    let (mut seen, mut end) = (0, End { runs: 0, enough: false, first_look: until.first_look() });
    for look in until.looks() {
        let all = run_to(look)?;
        for (place, runs) in all.into_iter().enumerate() {
            runs.stopped_by(stop.map(Arc::clone))
                .in_order(seen..look, |block| evidence.look(place, block, seen..look))
                .map_err(CampaignError::from)?;
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
