//! Campaigns of simulators as studies: how their runs are simulated, and what they amount to.

use gyradius_campaign::{
    Column, ExternalSimulation, Forecast, Kind, Progress, Runs, SampleSummary, Simulator,
    SimulatorFunction, Surveys, Unasked,
};
use gyradius_report::{
    Document, Overview, file_of, most_frequent, of_some, optional, resolved, with_unit,
};
use rayon::ThreadPool;
use serde::{Deserialize, Serialize};
use std::{
    fmt,
    path::Path,
    sync::{Arc, atomic::AtomicBool},
};

use super::{
    body::SimulatedBody, draws::SimulatorDraws, looking::Looking, scenario::SimulatorScenario,
};
use crate::{
    Notice, Options, ScenarioError, Study, StudyError,
    alerts::Alert,
    carry_out::carry_out,
    decisions, drivers,
    groups::{Drawing, Groups},
    head::Head,
    regions::{self, RegionSummary},
    report,
    rounding::Rounding,
    subject::{Grouped, Subject, Summarized, head_of},
    unusual::DrawnInput,
};

/// Every number that the report of a campaign of a simulator shows, and of what it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SimulatorSummary {
    /// Of what it is.
    #[serde(flatten)]
    pub head: Head,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    command: Vec<String>,
    /// Of the models whose draws are kept to regions, in their order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    regions: Vec<KeptSummary>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    function: Option<String>,
    /// What the runs amount to.
    pub overview: Overview,
}

/// What of the draws of a model the regions of its bodies keep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct KeptSummary {
    model: String,
    regions: Vec<RegionSummary>,
}

impl SimulatorScenario {
    /// Runs the scenario and writes its folder: the resolved scenario, run tables, summary, figures and report. Says what
    /// there is to say before it begins.
    ///
    /// # Errors
    /// The command cannot be started, or the function was not [given](Self::with_function); the folder holds another study and `force` is not set, or something cannot be
    /// written. What was there stays as it was.
    pub fn study(
        &self,
        options: &Options,
        progress: Progress<'_>,
        say: &dyn Fn(Notice),
    ) -> Result<Study<SimulatorSummary>, StudyError> {
        carry_out(self, options, progress, say)
    }

    /// What a reader should know first of the model in a place.
    fn alerts(
        &self,
        overview: &Overview,
        place: usize,
        (surveys, near): (&Surveys, &Vec<[u64; 2]>),
    ) -> Vec<Alert> {
        let name = surveys.model();
        let failed = Alert::failed(surveys).into_iter();
        let unmoved = self.dispersed().all.iter().filter_map(|dispersed| {
            let survey = surveys.column(&dispersed.column)?;
            Alert::unmoved(name, dispersed, survey, self.fleet())
        });
        let is_output = |column: &str| self.outputs().iter().any(|o| o.name() == column);
        let outputs = overview.quantities().filter(|(column, ..)| is_output(column));
        let outputs: Vec<(String, &SampleSummary)> = outputs
            .filter_map(|(column, _, samples)| Some((column.to_owned(), samples.get(place)?)))
            .collect();
        let heavy =
            outputs.iter().map(|(column, sample)| (column.clone(), (column.into(), ""), *sample));
        let told = outputs.iter().map(|(column, sample)| (column.clone(), sample.n));
        let (_, failures, runs) = overview.failed().nth(place).unwrap_or_default();
        let few = Alert::few_values(name, told, runs - failures);
        let near = self.bodies().iter().zip(near).filter_map(|(body, [near, drawn])| {
            Alert::near_boundary(name, &body.name, *near, *drawn)
        });
        failed
            .chain(few)
            .chain(unmoved)
            .chain(Alert::heavy_tails(name, heavy, self.rounding()))
            .chain(near)
            .collect()
    }

    /// What of the draws of each model the regions of the bodies keep.
    fn kept_to_regions(&self) -> Result<Vec<KeptSummary>, ScenarioError> {
        let mut all = Vec::new();
        for (place, model) in self.model_names().enumerate() {
            let mut regions = Vec::new();
            for (number, body) in self.bodies().iter().enumerate() {
                let kept = self.acceptance(place, number)?;
                regions.extend(kept.map(|kept| RegionSummary::new(body.name.clone(), kept)));
            }
            if !regions.is_empty() {
                all.push(KeptSummary { model: model.to_owned(), regions });
            }
        }
        Ok(all)
    }

    /// The runs of the model in a place that draw this.
    pub(super) fn simulation<'a>(
        &'a self,
        simulator: &'a Simulator,
        place: usize,
        drawing: Drawing,
    ) -> Result<ExternalSimulation<'a, SimulatorDraws<'a>>, ScenarioError> {
        let draws = SimulatorDraws::new(self, place)?.drawing(drawing);
        let name = self.model_names().nth(place).unwrap_or_default();
        Ok(ExternalSimulation::new(simulator, self.seed(), name, draws, self.outputs().to_vec()))
    }
}

impl Grouped for ExternalSimulation<'_, SimulatorDraws<'_>> {
    fn groups(&self) -> &Groups {
        self.inputs().groups()
    }

    fn steered(&self, runs: u64) -> Vec<Vec<f64>> {
        self.inputs().steered(runs)
    }

    /// A simulator tells all that it has, and takes longer than it takes to write that.
    fn wanted(self, _: &[String]) -> Self {
        self
    }
}

impl Subject for SimulatorScenario {
    /// Few, for a run of a simulator may take seconds.
    const BLOCK_RUNS: u64 = 1 << 8;
    const MAIN_OUTCOMES: &str = "each output";
    /// Machines that do a campaign together may have the simulator in different places.
    const IMMATERIAL: &[&str] = &[
        "runs",
        "vehicles",
        "rows",
        "columns",
        "requirements",
        "until",
        "drivers",
        "simulation.folder",
    ];

    type Prepared = Simulator;
    type Simulation<'a> = ExternalSimulation<'a, SimulatorDraws<'a>>;
    type Look<'a> = Looking;
    type Summary = SimulatorSummary;

    fn resolved(text: &str) -> Result<Self, ScenarioError> {
        Self::from_toml(text, Path::new("."))
    }

    fn prepare(&self, stop: Option<&Arc<AtomicBool>>) -> Result<Simulator, ScenarioError> {
        if let Some(name) = self.function_name() {
            let absent = || {
                let problem = not_given(name);
                SimulatorFunction::new(move |_| Err(problem.clone()))
            };
            return Ok(Simulator::function(self.function().cloned().unwrap_or_else(absent)));
        }
        let program = self.program()?;
        Ok(Simulator::new(match stop {
            Some(stop) => program.stopped_by(Arc::clone(stop)),
            None => program,
        }))
    }

    fn begin(&self, simulator: &Simulator) -> Result<(), ScenarioError> {
        if let Some(name) = self.function_name().filter(|_| self.function().is_none()) {
            let absent = ScenarioError::field("simulation.function", not_given(name));
            return Err(self.located(absent));
        }
        if simulator.program().is_some() {
            self.check_files(simulator).map_err(|error| self.located(error))?;
        }
        let started = simulator.check();
        started.map_err(|error| self.located(ScenarioError::field("simulation.command", error)))
    }

    fn function_name(&self) -> Option<&str> {
        self.function_name()
    }

    fn may_change(&self) -> bool {
        self.function().is_some()
    }

    fn unasked(&self, simulator: &Simulator) -> Option<Unasked> {
        simulator.unasked()
    }

    /// Nobody knows what a run costs, and one may take an hour.
    fn forecast(
        &self,
        _: &[(&str, Self::Simulation<'_>)],
        left: u64,
        threads: &ThreadPool,
    ) -> Result<Forecast, StudyError> {
        Ok(Forecast::untimed(left, self.columns().count(), threads.current_num_threads()))
    }

    fn drawing<'a>(
        &'a self,
        simulator: &'a Simulator,
        place: usize,
        drawing: Drawing,
    ) -> Result<Self::Simulation<'a>, ScenarioError> {
        self.simulation(simulator, place, drawing)
    }

    fn run_columns(&self) -> Vec<Column> {
        self.columns().collect()
    }

    fn outcomes(&self) -> Vec<String> {
        self.outputs().iter().map(|output| output.name().to_owned()).collect()
    }

    fn drawn_columns(&self) -> Vec<String> {
        self.inputs().map(|column| column.name().to_owned()).collect()
    }

    fn inertias(&self) -> Vec<[String; 6]> {
        self.bodies().iter().map(SimulatedBody::entries).collect()
    }

    fn main_outcomes(&self) -> Vec<String> {
        self.outcomes()
    }

    fn unit(&self, column: &str) -> Option<String> {
        let own = self.columns().find(|own| own.name() == column)?;
        own.unit().filter(|unit| *unit != "1").map(str::to_owned)
    }

    fn look(&self, model: &str, columns: &[Column]) -> Looking {
        Looking::new(self, model, columns)
    }

    fn judge(
        &self,
        _: &Simulator,
        looks: Vec<Looking>,
        runs: &[Runs],
    ) -> Result<SimulatorSummary, StudyError> {
        let seen = looks.into_iter().zip(runs).map(|(look, runs)| look.finish(runs));
        let seen = seen.collect::<Result<Vec<_>, _>>()?;
        let (surveys, near): (Vec<Surveys>, Vec<_>) = seen.into_iter().unzip();
        let columns = runs.first().map_or(&[][..], Runs::columns);
        // The answers before what was asked.
        let is_output = |column: &&Column| self.outputs().iter().any(|o| o.name() == column.name());
        let (outputs, inputs): (Vec<_>, Vec<_>) = columns.iter().partition(is_output);
        let shown: Vec<Column> = outputs.into_iter().chain(inputs).cloned().collect();
        let title = format!("gyradius campaign: {}", self.name());
        let overview = Overview::of_surveys(&title, &shown, &surveys)?;
        let alerts = surveys.iter().zip(&near).enumerate();
        let alerts = alerts.flat_map(|(place, seen)| self.alerts(&overview, place, seen));
        let alerts = alerts.chain(self.off_nominal().into_iter().map(Alert::OffNominal));
        let alerts = alerts.chain(self.folded().into_iter().map(Alert::Folded));
        let alerts = alerts.chain(self.unmatched().into_iter().map(Alert::Unmatched));
        let head = Head { alerts: alerts.collect(), ..head_of(self, columns) };
        let (command, regions) = (self.command().to_vec(), self.kept_to_regions()?);
        let function = self.function_name().map(str::to_owned);
        Ok(SimulatorSummary { head, command, function, regions, overview })
    }

    fn drawn_inputs(&self, summary: &SimulatorSummary, model: &str) -> Vec<DrawnInput> {
        let overview = &summary.overview;
        let Some(place) = overview.failed().position(|(name, ..)| name == model) else {
            return Vec::new();
        };
        // Not the components of attitudes, which are no scores.
        let dispersed = self.dispersed().all.iter().map(|dispersed| dispersed.column.clone());
        let inputs: Vec<String> = dispersed.chain(self.inertias().into_iter().flatten()).collect();
        let drawn = overview.quantities();
        let drawn = drawn.filter(|(name, ..)| inputs.iter().any(|column| column == name));
        let input = |(name, _, samples): (&str, &str, &[SampleSummary])| {
            let sample = samples.get(place)?;
            DrawnInput::new(name, sample.mean, sample.deviation)
        };
        drawn.filter_map(input).collect()
    }

    fn rounding(&self) -> Rounding {
        Rounding::OF_LAST_PLACES
    }

    fn report_files(&self) -> Vec<String> {
        let numbers = self.columns().filter(|column| column.kind() == Kind::Number).count();
        let figures = Overview::figure_names(numbers).map(|name| file_of(&name));
        let required = decisions::figure_names(self.requirements()).map(|name| file_of(&name));
        let driven = drivers::figure_names(self.drivers(), self.model_names());
        figures
            .chain(required)
            .chain(driven.map(|name| file_of(&name)))
            .chain(Document::pages(report::NAME))
            .chain(["figures/".to_owned()])
            .collect()
    }

    fn report(&self, summary: &SimulatorSummary) -> Document {
        let first = summary.head.about.section().into_iter();
        let first = first.chain(decisions::sections(self, &summary.head));
        let driven = drivers::section(&summary.head, &self.main_outcomes());
        let document = summary.overview.document_led_by(first).sections(driven);
        let document = document.sections(decisions::where_runs_fail::<Self>(&summary.head));
        let kept = summary.regions.iter().map(|kept| (&*kept.model, &*kept.regions));
        let document = document.sections(regions::section(kept));
        let document = report::noting_vehicles(document, &summary.head);
        let inputs = report::inputs(self, &summary.head, None);
        report::noting_what_is_missing(document, &summary.head).section(inputs)
    }
}

/// That runs need a function that the program did not give.
fn not_given(name: &str) -> String {
    format!(
        "{name:?} is a function of the program that made the study, and no file holds it: runs need that program, which gives it \
         by `SimulatorScenario::with_function` in Rust, or by `gyradius.study(..., simulation=...)` in Python; status and report need the \
         folder alone"
    )
}

impl Summarized for SimulatorSummary {
    fn head(&self) -> &Head {
        &self.head
    }

    fn head_mut(&mut self) -> &mut Head {
        &mut self.head
    }

    fn failed(&self) -> Vec<(String, u64, u64)> {
        let failed = self.overview.failed();
        failed.map(|(model, failed, runs)| (model.to_owned(), failed, runs)).collect()
    }
}

/// A table of the quantities and of the failures, for a terminal.
impl fmt::Display for SimulatorSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let overview = &self.overview;
        let labels = overview.quantities().map(|(column, unit, _)| with_unit(column, unit));
        let width = labels.map(|label| label.chars().count()).max().unwrap_or(0);
        for (place, ((model, failed, runs), (_, kinds))) in
            overview.failed().zip(overview.failures()).enumerate()
        {
            let blank = if place > 0 { "\n" } else { "" };
            let s = if runs == 1 { "" } else { "s" };
            writeln!(f, "{blank}{model}: {runs} run{s}, {failed} failed")?;
            for kind in most_frequent(kinds) {
                writeln!(f, "  {kind}")?;
            }
            let first = self.head.alerts.iter().find_map(|alert| alert.first_failure(model));
            first.map_or(Ok(()), |first| writeln!(f, "  {first}"))?;
            write!(f, "  {:width$}", "")?;
            for heading in ["mean", "deviation", "p05", "p95"] {
                write!(f, " {heading:>12}")?;
            }
            writeln!(f)?;
            for (column, unit, samples) in overview.quantities() {
                let Some(s) = samples.get(place).filter(|sample| sample.n > 0) else { continue };
                write!(f, "  {:width$}", with_unit(column, unit))?;
                let told = |x| resolved(x, s.deviation, 4);
                for number in [told(s.mean), optional(s.deviation, 4), told(s.p05), told(s.p95)] {
                    write!(f, " {number:>12}")?;
                }
                let of_some = of_some(s.n, runs - failed).map(|of_some| format!("  {of_some}"));
                writeln!(f, "{}", of_some.unwrap_or_default())?;
            }
        }
        Ok(())
    }
}
