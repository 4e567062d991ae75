//! What drives the outcome: Sobol' indices of the groups of inputs that are drawn independently of each other.

mod section;
#[cfg(test)]
mod tests;

use gyradius_campaign::{
    Column, Doing, Folder, Identity, Output, Plan, Progress, Simulation, run_missing, sha256,
};
use gyradius_statistics::{Confidence, SobolIndices};
use rayon::ThreadPool;

use crate::{
    Options, StudyError,
    decisions::requirements_of,
    driven::{Driven, Drivers},
    groups::Drawing,
    head::Head,
    subject::{Grouped, Subject, Summarized},
};

use section::fails;
pub(crate) use section::{figure_names, section, told};

/// Where their runs are until what they amount to is written.
pub(crate) const BESIDE: &str = "drivers";

/// The runs that the drivers of all models take.
pub(crate) fn runs<C: Subject>(scenario: &C) -> Result<u64, StudyError> {
    let Some(base) = scenario.drivers() else { return Ok(0) };
    let models = scenario.prepare(None)?;
    let simulations = scenario.simulations(&models)?;
    Ok(simulations.iter().map(|(_, simulation)| simulation.groups().designs().runs(base)).sum())
}

/// What drives the outcome of each model, if the scenario asks for that: as it was found before, or from runs of their own
/// that are put nowhere.
pub(crate) struct Finding<'a, 'f, C: Subject> {
    pub(crate) scenario: &'a C,
    pub(crate) models: &'a C::Prepared,
    pub(crate) options: &'a Options,
    pub(crate) folder: &'a Folder<'f>,
    pub(crate) identity: &'a Identity,
    pub(crate) threads: &'a ThreadPool,
}

impl<C: Subject> Finding<'_, '_, C> {
    /// Finds them; `before` reads the summary that is there already, and `progress` is told of runs.
    pub(crate) fn find(
        &self,
        before: impl FnOnce() -> Option<C::Summary>,
        progress: Progress<'_>,
    ) -> Result<Vec<Drivers>, StudyError> {
        let Some(base) = self.scenario.drivers() else { return Ok(Vec::new()) };
        let requirements = self.scenario.requirements();
        let outcomes = self.scenario.outcomes();
        let identity = sha256(serde_json::to_string(&(self.identity, requirements, &outcomes))?);
        let names: Vec<&str> = self.scenario.model_names().collect();
        let again = self.options.retry_failed;
        let known = |head: &Head| {
            let same = |drivers: &Drivers| {
                let is_stale = drivers.is_stale(again);
                drivers.identity == identity && drivers.base_runs == base && !is_stale
            };
            head.drivers.len() == names.len() && head.drivers.iter().all(same)
        };
        if let Some(there) = before().filter(|there| known(there.head())) {
            return Ok(there.head().drivers.clone());
        }
        self.scenario.begin(self.models)?;
        let exchanging = |place| self.scenario.drawing(self.models, place, Drawing::Exchanging);
        let simulations = (0..names.len()).map(exchanging).collect::<Result<Vec<_>, _>>()?;
        let runs = simulations.iter().map(|simulation| simulation.groups().designs().runs(base));
        let most = runs.max().unwrap_or(0);
        // What was begun otherwise is of no use to anybody.
        let (mark, force) = (self.scenario.to_toml(), true);
        let blocks =
            self.folder.blocks_beside(BESIDE, (self.identity, &mark), most, force, self.threads)?;
        let (mut all, mut done, rounding) = (Vec::new(), 0, self.scenario.rounding());
        for (model, simulation) in names.into_iter().zip(simulations) {
            let groups = simulation.groups().names().to_vec();
            let designs = simulation.groups().designs();
            let simulation = [(model, simulation)];
            let plan = Plan {
                runs: designs.runs(base),
                block_runs: C::BLOCK_RUNS,
                doing: Doing::All,
                stop: self.options.stop.as_ref(),
            };
            let more = |runs| progress(done + runs);
            let runs =
                self.threads.install(|| run_missing(&simulation, &blocks, plan, &more, None))?;
            done += plan.runs;
            let columns = simulation[0].1.columns();
            let asked = requirements_of(self.scenario, model);
            let failing = asked.iter().map(|r| Output::Fails(Box::new(r.clone())));
            // What a requirement is about may be drawn.
            let about: Vec<&String> =
                asked.iter().flat_map(|required| required.quantity().columns()).collect();
            let is_asked = |column: &&Column| {
                let name = column.name();
                outcomes.iter().chain(about.iter().copied()).any(|other| other == name)
            };
            let outcomes: Vec<&Column> = columns.iter().filter(is_asked).collect();
            let numbers = outcomes.iter().map(|column| Output::Column(column.name().to_owned()));
            let outputs: Vec<Output> = failing.chain(numbers).collect();
            let runs = &runs[0];
            let confidence = Confidence::default();
            let indices =
                self.threads.install(|| designs.indices(base, runs, &outputs, confidence))?;
            let names = asked.iter().map(|r| (r.name().to_owned(), None));
            let names = names.chain(outcomes.iter().map(|column| {
                // A flag has no unit.
                (column.name().to_owned(), Some(column.unit().unwrap_or("1").to_owned()))
            }));
            let (mut driven, mut left_out) = (Vec::new(), Vec::new());
            for ((output, unit), indices) in names.zip(indices) {
                let moves = |indices: &SobolIndices| {
                    let unit = unit.as_deref().unwrap_or_default();
                    let size = rounding.size(indices.mean(), (&output, unit));
                    rounding.is_exceeded_by(indices.standard_deviation(), size)
                };
                match indices.filter(moves) {
                    Some(indices) => driven.push(Driven { output, unit, indices }),
                    None if unit.is_none() => left_out.push(fails(&output)),
                    None => left_out.push(output),
                }
            }
            all.push(Drivers {
                model: model.to_owned(),
                base_runs: base,
                runs: plan.runs,
                failed: blocks.failed(model),
                groups,
                outputs: driven,
                left_out,
                identity: identity.clone(),
            });
        }
        Ok(all)
    }
}
