//! Importance sampling: normal scores of runs are drawn from a law under which the event is less rare.

use gyradius_statistics::{
    Confidence, ImportanceSampling, ScoreSearch, StatisticsError, SteeredEstimate, SteeredSampling,
};

use super::{failed::Failures, runs::EventRuns};
use crate::{ScenarioError, StudyError, groups::Drawing, steering::Steering, subject::Subject};

/// Runs of the sample that are in memory at once.
const AT_ONCE: u64 = 10_000;
/// Fewest and most runs of a sample.
const FEWEST: u64 = 100;
const MOST: u64 = 1_000_000_000;

/// With so many runs of a level and of the sample, down to this probability; and whether anything was steered, which it is not for an
/// event that is not rare. Counts runs that fail.
pub(super) fn find<C: Subject>(
    runs: &EventRuns<'_, C>,
    seed: u64,
    (per_level, sample, least): (usize, u64, f64),
    failures: &mut Failures,
) -> Result<(SteeredEstimate, bool), StudyError> {
    if runs.groups().scored().is_empty() {
        return Err(ScenarioError::field("method", nothing_to_steer(runs)).into());
    }
    if !(FEWEST..=MOST).contains(&sample) {
        let problem = format!("{sample} runs: there must be {FEWEST} to {MOST}");
        return Err(ScenarioError::field("sample", problem).into());
    }
    let steering = Steering::new(seed, runs.model(), runs.groups().scored());
    let refused = |field: &str, error: StatisticsError| ScenarioError::field(field, error);
    let search = ScoreSearch::new(steering.scores(), per_level)
        .and_then(|search| search.with_events(runs.groups().events()))
        .map_err(|error| refused("per-level", error))?;
    let mut search = search.with_least(least).map_err(|error| refused("least", error))?;
    runs.begin()?;
    // Every run has a number of its own, so that what is found and the sample are independent.
    let mut first = 0;
    while !search.is_done() {
        let count = search.asks() as u64;
        let drawing = Drawing::Steered(steering.with(search.law(), first).into());
        let scores = runs.scores(drawing.clone(), count)?;
        let outcomes = runs.outcomes(drawing, count)?;
        if search.law().is_own() {
            failures.plain.add(&outcomes.failed);
        } else {
            let mut level = ImportanceSampling::new();
            for (scores, failed) in scores.iter().zip(&outcomes.failed) {
                level.push(search.law().log_weight(scores), *failed)?;
            }
            failures.weighted.push(level);
            failures.nearer.add(&outcomes.failed);
        }
        search.tell(&scores.into_iter().zip(outcomes.excesses).collect::<Vec<_>>())?;
        first += count;
    }
    let mut sampling = SteeredSampling::new(&search)?;
    let mut weighted = ImportanceSampling::new();
    let last = first + sample;
    while first < last {
        let count = AT_ONCE.min(last - first);
        let drawing = Drawing::Steered(steering.with(sampling.law(), first).into());
        let all_scores = runs.scores(drawing.clone(), count)?;
        let outcomes = runs.outcomes(drawing, count)?;
        failures.nearer.add(&outcomes.failed);
        let told = outcomes.excesses.into_iter().zip(outcomes.failed);
        for (scores, (excess, failed)) in all_scores.iter().zip(told) {
            weighted.push(sampling.push(scores, excess)?, failed)?;
        }
        first += count;
    }
    failures.weighted.push(weighted);
    Ok((sampling.finish(Confidence::default())?, !search.law().is_own()))
}

/// Why no run can be drawn nearer to the event: what is drawn, all of which keeps its own law.
fn nothing_to_steer<C: Subject>(runs: &EventRuns<'_, C>) -> String {
    let [_, own] = runs.groups().by_scores();
    let of_region = if runs.groups().kept().is_empty() {
        ""
    } else {
        ". Of a body that has `inside`, all is drawn again until its matter is in the region, so that none of it can be steered"
    };
    format!(
        "importance: the model {} draws nothing that can be steered by a normal score: {} keep their own laws{of_region}; method \"subset\" \
         serves any law",
        runs.model(),
        own.join("; ")
    )
}
