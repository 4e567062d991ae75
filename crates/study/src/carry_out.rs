//! A scenario carried out: its runs to their number, or until they have shown enough, and what comes of them.

use gyradius_campaign::{Doing, End, Evidence, Folder, Progress, run_again, run_until, threads};

use crate::{
    Notice, Options, Scenario, Study, StudyError,
    contents::{contents, identity},
    decisions::{check_columns, group, requirements_of},
    ended::Ended,
    read_only::complete_study,
    study::{do_what_is_left, plan, same_as_before, to_be_done},
    subject::Subject,
    unfinished::replacement,
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
    let scenario = &scenario.ended_after(until.most_runs(), until.first_look())?;
    let threads = threads(options.threads)?;
    let models = scenario.prepare(options.stop.as_ref())?;
    let simulations = scenario.simulations(&models)?;
    let contents = contents(scenario);
    let folder = Folder::prepare(&options.place(scenario.name()), &contents, options.force)?;
    check_columns(scenario)?;
    let ended = |End { runs, enough, first_look }: End| {
        let until = until.clone().with_first_look(first_look);
        let ended = Ended::new(&until, runs, enough);
        Ok(Some((scenario.ended_after(runs, first_look)?, ended)))
    };
    let begun = (&identity(scenario), scenario.to_toml());
    if let Some(there) = folder.reduced(begun.0)?
        && !options.force
    {
        // Nothing can be added to it, whatever it shows.
        let first_look = until.first_look();
        return ended(End { runs: there.runs(), enough: true, first_look });
    }
    let blocks = folder.blocks((begun.0, &begun.1), scenario.runs(), options.force, &threads)?;
    let plan = plan(scenario, options, Doing::All);
    to_be_done(&simulations, plan, (&folder, &blocks), say)?;
    same_as_before(scenario, &simulations, (folder.place(), &blocks.finished_runs()), &threads)
        .inspect_err(|_| blocks.abandon())?;
    let evidence = || {
        let own = scenario.model_names().map(|model| requirements_of(scenario, model)).collect();
        Evidence::new(until.rule().clone(), own, group(scenario))
    };
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
        let begin = || if again { Ok(()) } else { Ok(scenario.begin(&models)?) };
        threads.install(|| run_until(&simulations, &blocks, plan, progress, until, evidence, begin))
    })();
    scenario.unasked(&models).into_iter().for_each(|unasked| say(Notice::Unasked(unasked)));
    ended(done.inspect_err(|_: &StudyError| blocks.abandon())?)
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
