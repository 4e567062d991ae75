//! A scenario carried out: its runs to their number, or until they have shown enough, and what comes of them.

use gyradius_campaign::{
    Doing, End, Evidence, Folder, Progress, Until, begun, run_again, run_until, threads,
};
use std::path::Path;

use crate::{
    Notice, Options, Scenario, ScenarioError, Study, StudyError,
    contents::{contents, identity},
    decisions::{check_columns, group, requirements_of},
    ended::Ended,
    read_only::complete_study,
    scenario::scenario_text,
    study::{plan, same_as_before, to_be_done},
    subject::Subject,
    unfinished::replacement,
    what_is_left::do_what_is_left,
};

/// Does the runs of a scenario until they have shown enough, in blocks that are not put together. Returns the scenario with
/// as many runs as there are then, and what ended them; none if its runs go to their number, or if all of them are put
/// together already and not all of them kept.
fn run_to_the_end<C: Subject>(
    scenario: &C,
    options: &Options,
    progress: Progress<'_>,
    say: &dyn Fn(Notice),
) -> Result<Option<(C, Ended)>, StudyError> {
    let Some(until) = scenario.until() else { return Ok(None) };
    let most = until.most_runs();
    let scenario = &scenario.ended_after(most, until)?;
    let threads = threads(options.threads)?;
    let models = scenario.prepare(options.stop.as_ref())?;
    let simulations = scenario.simulations(&models)?;
    let contents = contents(scenario);
    let folder = Folder::prepare(&options.place(scenario.name()), &contents, options.force)?;
    check_columns(scenario)?;
    let from = |first_look: Option<u64>| {
        let until = until.clone().with_first_look(first_look);
        until.map_err(|error| ScenarioError::field("until", error))
    };
    let until = from(first_look(scenario, until, folder.place())?)?;
    let ended = |(until, End { runs, enough }): (Until, End)| {
        Ok(Some((scenario.ended_after(runs, &until)?, Ended::new(&until, runs, enough))))
    };
    let told = |until: &Until| Ok::<_, StudyError>(scenario.ended_after(most, until)?.to_toml());
    let begun = (&identity(scenario), told(&until)?);
    if let Some(there) = folder.reduced(begun.0)?
        && !options.force
    {
        // Nothing can be added to it, whatever it shows.
        return ended((until, End { runs: there.runs(), enough: true }));
    }
    let blocks = folder.blocks((begun.0, &begun.1), scenario.runs(), options.force, &threads)?;
    let plan = plan(scenario, options, Doing::All);
    to_be_done(&simulations, plan, (&folder, &blocks), say)?;
    same_as_before(scenario, &simulations, (folder.place(), &blocks.finished_runs()), &threads)
        .inspect_err(|_| blocks.abandon())?;
    let again = options.retry_failed && blocks.any_failed();
    let done = (|| {
        if again {
            scenario.begin(&models)?;
            // Before the rule is asked, which these runs may change.
            let stop = options.stop.as_deref();
            let done = threads.install(|| run_again(&simulations, &blocks, stop))?;
            say(Notice::Again(done));
        }
        blocks.looked_at()?;
        // Nobody knows how many runs there will be: nothing is foretold, and nothing refused for want of room.
        let begin = || if again { Ok(()) } else { Ok::<_, StudyError>(scenario.begin(&models)?) };
        let run = |until: &Until| {
            let own = scenario.model_names().map(|model| requirements_of(scenario, model));
            let evidence = Evidence::new(until.rule().clone(), own.collect(), group(scenario));
            threads.install(|| {
                run_until(&simulations, &blocks, plan, progress, until, evidence, begin)
            })
        };
        let there = scenario.whole_vehicles(blocks.end());
        let end = run(&until)?;
        if !end.enough || there <= end.runs {
            return Ok((until, end));
        }
        // None is dropped. Whoever goes on after an interruption looks first where this command does, however many there are by then.
        let until = from(Some(there))?;
        blocks.begun_as(&told(&until)?)?;
        let end = run(&until)?;
        Ok((until, end))
    })();
    scenario.unasked(&models).into_iter().for_each(|unasked| say(Notice::Unasked(unasked)));
    ended(done.inspect_err(|_: &StudyError| blocks.abandon())?)
}

/// After how many runs the first look that counts is, if that is said: by the scenario, or in the folder, where the same rule began or
/// ended the same study.
fn first_look<C: Subject>(
    scenario: &C,
    until: &Until,
    place: &Path,
) -> Result<Option<u64>, StudyError> {
    let texts = [begun(place)?, scenario_text(&place.join("scenario.toml")).ok()];
    let there = texts.into_iter().flatten().filter_map(|text| C::resolved(&text).ok());
    let same = there.filter(|there| identity(there).difference(&identity(scenario)).is_none());
    let first = |there: C| {
        let there = there.until().filter(|there| there.rule() == until.rule())?;
        // Where there are to be fewer runs than that, others were dropped.
        there.first_look().filter(|first| *first <= until.most_runs())
    };
    Ok(same.filter_map(first).chain(until.first_look()).max())
}

impl Study {
    /// Runs a scenario and writes its folder: the resolved scenario, run tables, summary, figures
    /// and report.
    ///
    /// # Errors
    /// The folder holds another study and `force` is not set, or something cannot be written. What
    /// was there stays as it was.
    pub fn run(
        scenario: &Scenario,
        options: &Options,
        progress: Progress<'_>,
    ) -> Result<Self, StudyError> {
        carry_out(scenario, options, progress, &|_| {})
    }
}

/// Does the runs that are to be done, to their number or until a rule ends them, and puts together what is there then.
pub(crate) fn carry_out<C: Subject>(
    scenario: &C,
    options: &Options,
    progress: Progress<'_>,
    say: &dyn Fn(Notice),
) -> Result<Study<C::Summary>, StudyError> {
    let done = match run_to_the_end(scenario, options, progress, say) {
        Ok(Some((scenario, ended))) => {
            let doing = (Doing::All, Some(ended));
            do_what_is_left(&scenario, options, doing, progress, &|_| {})
        }
        Ok(None) => do_what_is_left(scenario, options, (Doing::All, None), progress, say),
        Err(error) => Err(error),
    };
    let place = options.place(scenario.name());
    let is_only_read = |error: &StudyError| {
        matches!(error, StudyError::ReadOnly { .. }) || matches!(replacement(&place), Ok(Some(_)))
    };
    match done {
        // There may be nothing to be written.
        Err(error) if !options.force && !options.retry_failed && is_only_read(&error) => {
            let study = complete_study(scenario, options)?.ok_or(error)?;
            replacement(&place)?.into_iter().for_each(|told| say(Notice::Replacement(told)));
            Ok(study)
        }
        done => done,
    }
}
