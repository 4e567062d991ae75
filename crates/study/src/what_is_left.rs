//! Doing what is left of a study, and putting together what is there then.

use gyradius_campaign::{
    Blocks, Counting, Doing, Folder, Identity, Kept, MANIFEST, Plan, Progress, Reduced, Runs,
    Table, go_on, run_again, run_missing, threads, told,
};
use gyradius_report::visible_json;
use rayon::ThreadPool;
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
    sync::OnceLock,
};

use crate::{
    Notice, Options, Study, StudyError,
    contents::{contents, identity},
    decisions,
    drivers::{self, Finding},
    ended::Ended,
    head::Missing,
    report,
    study::{
        empty_tables, foretell, lacks_drivers, looks, plan, same_as_before, to_be_done,
        whole_summary,
    },
    subject::{LookAt, Subject, Summarized},
};

/// Does the runs that are to be done, and puts together what is there then: the study, if nothing is missing, and else
/// summary and report of the runs that are there, which say what is missing.
pub(crate) fn do_what_is_left<C: Subject>(
    scenario: &C,
    options: &Options,
    (doing, ended): (Doing, Option<Ended>),
    progress: Progress<'_>,
    say: &dyn Fn(Notice),
) -> Result<Study<C::Summary>, StudyError> {
    let threads = threads(options.threads)?;
    let place = options.place(scenario.name());
    let models = scenario.prepare(options.stop.as_ref())?;
    let simulations = scenario.simulations(&models)?;
    let kept = kept(scenario, doing);
    let in_place = OnceLock::<BTreeSet<String>>::new();
    let contents =
        contents(scenario).keeping(|name| in_place.get().is_some_and(|all| all.contains(name)));
    let mut folder = Folder::prepare(&place, &contents, options.force)?;
    let text = scenario.to_toml();
    decisions::check_columns(scenario)?;
    let begun = (&identity(scenario), text.as_str());
    if let Some(there) = folder.reduced(begun.0)?
        && !options.force
    {
        return reduced(scenario, &there, (&folder, &text), options, &simulations, &threads);
    }
    let counting = decisions::counting(scenario, folder.counting(begun.0)?);
    let blocks = folder.blocks(begun, scenario.runs(), options.force, &threads)?;
    let what_is_left = WhatIsLeft {
        scenario,
        options,
        doing,
        models: &models,
        simulations: &simulations,
        blocks: &blocks,
        place: &place,
        identity: begun.0,
        text: &text,
        kept: &kept,
        counting,
        threads: &threads,
    };
    let keep = |names| drop(in_place.set(names));
    // Before others are let in.
    what_is_left.finish(&mut folder, ended, keep, progress, say).inspect_err(|_| blocks.abandon())
}

/// A study that is not whole yet, and what does the rest of it.
struct WhatIsLeft<'a, 's, C: Subject + 's> {
    scenario: &'a C,
    options: &'a Options,
    doing: Doing,
    models: &'a C::Prepared,
    simulations: &'a [(&'a str, C::Simulation<'s>)],
    blocks: &'a Blocks,
    place: &'a Path,
    identity: &'a Identity,
    /// The scenario as the folder has it.
    text: &'a str,
    kept: &'a Kept,
    counting: Counting,
    threads: &'a ThreadPool,
}

impl<C: Subject> WhatIsLeft<'_, '_, C> {
    /// Does what is left; `keep` is told which files stay in their places.
    fn finish(
        &self,
        folder: &mut Folder<'_>,
        ended: Option<Ended>,
        keep: impl FnOnce(BTreeSet<String>),
        progress: Progress<'_>,
        say: &dyn Fn(Notice),
    ) -> Result<Study<C::Summary>, StudyError> {
        let Self { scenario, options, simulations, blocks, .. } = *self;
        let plan = plan(scenario, options, self.doing);
        let left = to_be_done(simulations, plan, (folder, blocks), say)?;
        let first_missing = self.gaps().iter().map(|missing| missing.range().start).min();
        let first_missing = first_missing.unwrap_or(scenario.runs());
        let ended = ended.map(|ended| ended.with_first_runs(first_missing));
        // What a rule ended was held against its runs, and retried, before the rule was asked.
        let is_interrupted = ended.as_ref().is_some_and(Ended::is_interrupted);
        let is_ended = ended.is_some() && !is_interrupted;
        if !is_ended {
            let there = (self.place, &blocks.finished_runs());
            same_as_before(scenario, simulations, there, self.threads)?;
        }
        let retries = options.retry_failed && !is_ended;
        let does_runs = self.doing == Doing::All;
        let again = does_runs && retries && blocks.any_failed();
        if again || does_runs && left > 0 {
            scenario.begin(self.models)?;
        }
        if again {
            let stop = options.stop.as_deref();
            let done = self.threads.install(|| run_again(simulations, blocks, stop))?;
            say(Notice::Again(done));
        }
        // A complete study that is being extended stays one until all of the runs are there: its blocks and what tells of them.
        let incomplete = self.doing == Doing::Nothing && (left > 0 || is_interrupted);
        let manifest = incomplete.then(|| MANIFEST.to_owned());
        let published = blocks.published().into_iter().chain(manifest);
        // What is not all kept is written anew.
        keep(published.filter(|_| incomplete || self.kept.is_all()).collect());
        if left == 0
            && let Some(study) = self.finished(folder, retries, say)?
        {
            return Ok(study);
        }
        let of = scenario.runs() * simulations.len() as u64;
        if does_runs && left > 0 {
            foretell(scenario, simulations, [left, of], options, self.threads, say)?;
        }
        let (runs, mut summary) = self.threads.install(|| self.run(plan, ended, progress))?;
        scenario.unasked(self.models).into_iter().for_each(|unasked| say(Notice::Unasked(unasked)));
        let complete = summary.head().is_complete();
        if complete && self.doing == Doing::Nothing && scenario.drivers().is_some() {
            say(Notice::DriversLeft);
        }
        if does_runs {
            let (models, threads, identity) = (self.models, self.threads, self.identity);
            let finding = Finding { scenario, models, options, folder, identity, threads };
            let before = || whole_summary::<C>(self.place);
            summary.head_mut().drivers = finding.find(before, &|runs| progress(of + runs))?;
        }
        let (place, summary) = self.write(folder, &summary)?;
        if complete {
            blocks.settle()?;
        }
        if does_runs {
            folder.clear_beside(drivers::BESIDE)?;
        }
        let runs = if self.kept.is_all() || !complete {
            runs.into_iter().map(|runs| blocks.in_place(runs)).collect()
        } else {
            empty_tables(simulations)?.into_iter().map(Runs::from).collect()
        };
        Ok(Study::of(place, runs, summary))
    }

    /// Does the runs that are missing, and judges all that are there.
    fn run(
        &self,
        plan: Plan<'_>,
        ended: Option<Ended>,
        progress: Progress<'_>,
    ) -> Result<(Vec<Runs>, C::Summary), StudyError> {
        let Self { scenario, simulations, blocks, .. } = *self;
        let looks = looks(scenario, simulations)?;
        let judging = decisions::judging(scenario, self.counting, ended.as_ref());
        let look = |place: usize, block: &Table| {
            looks[place].look(block);
            judging[place].look(block);
        };
        let runs = run_missing(simulations, blocks, plan, progress, Some(&look))?;
        if let Some(none) = runs.iter().find(|runs| runs.end() == 0) {
            let problem = format!("there are no runs of the model {:?} yet", none.model());
            return Err(StudyError::Absent { path: self.place.to_owned(), problem });
        }
        let mut summary = scenario.judge(self.models, looks, &runs)?;
        let head = summary.head_mut();
        (head.missing, head.done_again) = (self.gaps(), blocks.again());
        head.ended = ended;
        decisions::judged(scenario, &mut summary, judging, &runs)?;
        Ok((runs, summary))
    }

    /// The study, if all of it is there as it was written, what drives its outcome too if that is asked, which is found again
    /// where runs for it failed and those are to be done again.
    fn finished(
        &self,
        folder: &Folder<'_>,
        retries: bool,
        say: &dyn Fn(Notice),
    ) -> Result<Option<Study<C::Summary>>, StudyError> {
        if !(self.blocks.all_in_place() && folder.is_whole(self.text)?) {
            return Ok(None);
        }
        let Some(summary) = whole_summary::<C>(self.place) else { return Ok(None) };
        let there = &summary.head().drivers;
        // Who puts together what others did does no runs.
        let is_asked = self.doing == Doing::All && self.scenario.drivers().is_some();
        if is_asked && (there.is_empty() || there.iter().any(|one| one.is_stale(retries))) {
            return Ok(None);
        }
        let empty = empty_tables(self.simulations)?;
        let runs = empty.iter().map(|empty| self.blocks.runs(empty, Vec::new())).collect();
        self.blocks.settle()?;
        if self.options.force {
            say(Notice::Finished);
        }
        if !lacks_drivers(self.scenario, &summary) {
            // A command that was killed in between left them.
            folder.clear_beside(drivers::BESIDE)?;
        } else if self.doing == Doing::Nothing {
            say(Notice::DriversLeft);
        }
        Ok(Some(Study::of(self.place.to_owned(), runs, summary)))
    }

    /// Writes the study and puts it in place; returns where that is, and the summary as it was written.
    fn write(
        &self,
        folder: &mut Folder<'_>,
        summary: &C::Summary,
    ) -> Result<(PathBuf, C::Summary), StudyError> {
        let stop = self.options.stop.as_deref();
        if summary.head().is_complete() {
            let empty = empty_tables(self.simulations)?;
            folder.adopt(self.blocks, &empty, (self.kept, self.counting), self.threads, stop)?;
        }
        folder.write("scenario.toml", self.text)?;
        let written = visible_json(&serde_json::to_string_pretty(summary)?) + "\n";
        folder.write("summary.json", &written)?;
        // The report is made from what a reader of the folder has.
        let summary: C::Summary = serde_json::from_str(&written)?;
        let report = self.threads.install(|| self.scenario.report(&summary));
        for (name, content) in report.files(report::NAME) {
            folder.write(&name, &content)?;
        }
        go_on(stop)?;
        Ok((folder.publish()?, summary))
    }

    /// The runs of each model that are missing, where any are.
    fn gaps(&self) -> Vec<Missing> {
        let of_model = |model: &str| {
            let ranges = self.blocks.missing(model, self.scenario.runs(), u64::MAX);
            ranges.into_iter().map(|runs| Missing::new(model, runs)).collect::<Vec<_>>()
        };
        self.scenario.model_names().flat_map(of_model).collect()
    }
}

/// Puts together what is there of a study whose runs are not all done, in its folder, which holds this scenario.
pub(crate) fn put_together<C: Subject>(
    scenario: &C,
    folder: &Path,
    options: &Options,
    say: &dyn Fn(Notice),
) -> Result<Study<C::Summary>, StudyError> {
    let options = Options { out: Some(folder.to_owned()), ..options.clone() };
    let Some(until) = scenario.until() else {
        return do_what_is_left(scenario, &options, (Doing::Nothing, None), &|_| {}, say);
    };
    // Of runs that a rule is to end, the last one that is there is the last that there is to be so far, of whole vehicles.
    let blocks = told(folder, &contents(scenario), &identity(scenario))?;
    let end = blocks.iter().map(|block| block.range().end).max().unwrap_or(scenario.runs());
    let end = scenario.whole_vehicles(end).min(until.most_runs());
    let so_far = Ended::not_yet(until);
    let scenario = scenario.ended_after(end, until)?;
    do_what_is_left(&scenario, &options, (Doing::Nothing, Some(so_far)), &|_| {}, say)
}

/// What is kept of the runs. Who puts together what shards did finds no drivers, and what finds them afterwards needs the runs: until
/// then, all is kept.
fn kept(scenario: &impl Subject, doing: Doing) -> Kept {
    match doing {
        Doing::Nothing if scenario.drivers().is_some() => Kept::default(),
        Doing::Nothing | Doing::All | Doing::Shard(_) => scenario.kept(),
    }
}

/// The study in a folder, not everything of which was kept, which must be this one and as it was written.
fn reduced<C: Subject>(
    scenario: &C,
    there: &Reduced,
    (folder, text): (&Folder<'_>, &str),
    options: &Options,
    simulations: &[(&str, C::Simulation<'_>)],
    threads: &ThreadPool,
) -> Result<Study<C::Summary>, StudyError> {
    let damaged = threads.install(|| there.damaged())?;
    let same = there.runs() == scenario.runs() && *there.kept() == scenario.kept();
    let whole = same && !options.retry_failed && damaged.is_empty() && folder.is_whole(text)?;
    let place = folder.place().to_owned();
    match whole.then(|| whole_summary::<C>(&place)).flatten() {
        Some(summary) => {
            same_as_before(scenario, simulations, (&place, &there.finished_runs()), threads)?;
            there.settle(&identity(scenario))?;
            let runs = empty_tables(simulations)?.into_iter().map(Runs::from).collect();
            Ok(Study::of(place, runs, summary))
        }
        None => Err(StudyError::Reduced {
            path: place,
            kept: there.kept().clone(),
            damaged: damaged.into_iter().next(),
        }),
    }
}
