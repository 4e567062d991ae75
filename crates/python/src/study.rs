//! Studies: a scenario, a function that simulates it where no command does, and what the folder of the study has.

mod called;
mod given;
mod kept;
mod watched;
mod words;

use gyradius_campaign::{Kept, Rows, StoppingRule, Verdict, folder_of};
use gyradius_study::{
    AnyScenario, Judged, Notice, Options, Replay, SimulatorReplay, StudyOutcome, Which, begun_study,
};
use pyo3::{
    Bound, Py, PyAny, PyResult, Python, exceptions::PyOSError, pyclass, pymethods, types::PyDict,
};
use std::{
    path::{Path, PathBuf},
    sync::Mutex,
};

use crate::error::refused;
use called::Called;
use watched::Watched;

pub(crate) use watched::end_all;

/// A scenario, as it is to be run.
#[pyclass(frozen, module = "gyradius._core")]
pub(crate) struct ScenarioCore {
    scenario: AnyScenario,
}

/// A study that was carried out.
#[pyclass(frozen, module = "gyradius._core")]
pub(crate) struct StudyCore {
    scenario: AnyScenario,
    outcome: StudyOutcome,
    called: Option<Called>,
    /// What there was to warn of.
    warnings: Vec<String>,
}

/// A requirement, the model, the verdict in a word, and what there is to say of it.
type Verdict4 = (String, String, &'static str, String);

#[pymethods]
impl ScenarioCore {
    /// Of a file, or of the folder of a study, complete or not; `function` and `outputs`, if given, stand in its table `simulation`.
    #[staticmethod]
    fn read(
        path: PathBuf,
        function: Option<String>,
        outputs: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let is_folder = path.is_dir();
        let folder = if is_folder { path.clone() } else { folder_of(&path).to_owned() };
        let file = if is_folder { path.join("scenario.toml") } else { path };
        let begun = if is_folder { begun_study(&folder) } else { Ok(None) };
        let begun = begun.map_err(|error| PyOSError::new_err(error.to_string()))?;
        let scenario = if begun.is_none() && function.is_none() && outputs.is_none() {
            AnyScenario::read(&file).map_err(given::unread)?
        } else {
            let table = match begun {
                Some(text) => given::parse(&text, &folder)?,
                None => given::read(&file)?,
            };
            given::scenario(table, &folder, function, outputs)?
        };
        Ok(Self { scenario })
    }

    /// Of a dictionary with the keys of a file that is in the working directory.
    #[staticmethod]
    fn of(
        given: &Bound<'_, PyAny>,
        function: Option<String>,
        outputs: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let table = given::table(given)?;
        Ok(Self { scenario: given::scenario(table, Path::new("."), function, outputs)? })
    }

    /// The same with something else.
    #[pyo3(signature = (*, runs, vehicles, seed, until, look_every, rows, columns, drivers))]
    #[allow(clippy::too_many_arguments, reason = "as many as a command has options")]
    fn changed(
        &self,
        runs: Option<u64>,
        vehicles: Option<u64>,
        seed: Option<u64>,
        until: Option<&str>,
        look_every: Option<u64>,
        rows: Option<&str>,
        columns: Option<Vec<String>>,
        drivers: Option<u64>,
    ) -> PyResult<Self> {
        let mut scenario = self.scenario.clone();
        if let Some(runs) = runs {
            scenario = scenario.with_runs(runs).map_err(refused)?;
        }
        if let Some(vehicles) = vehicles {
            scenario = scenario.with_vehicles(vehicles).map_err(refused)?;
        }
        if let Some(seed) = seed {
            scenario = scenario.with_seed(seed).map_err(refused)?;
        }
        if until.is_some() || look_every.is_some() {
            let rule: Option<StoppingRule> = until.map(str::parse).transpose().map_err(refused)?;
            scenario = scenario.with_until(rule, look_every).map_err(refused)?;
        }
        if rows.is_some() || columns.is_some() {
            let kept = scenario.kept();
            let rows = rows.map_or(Ok(kept.rows()), named_rows)?;
            let columns = columns.or_else(|| kept.columns().map(<[_]>::to_vec));
            scenario = scenario.with_kept(&Kept::new(rows, columns));
        }
        if let Some(drivers) = drivers {
            scenario = scenario.with_drivers(drivers).map_err(refused)?;
        }
        Ok(Self { scenario })
    }

    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        self.scenario.name()
    }

    /// What it says of the function that simulates; none if it names a command, or is of separations.
    #[getter]
    fn function(&self) -> Option<&str> {
        match &self.scenario {
            AnyScenario::Simulator(scenario) => scenario.function_name(),
            AnyScenario::Separation(_) => None,
        }
    }

    /// Whether its runs are flights of vehicles.
    #[getter]
    fn has_vehicles(&self) -> bool {
        self.scenario.fleet().is_some()
    }

    /// Carries it out. `simulation` is called as [`Called`] says; `progress` with how many runs are done, of how many.
    #[pyo3(signature = (*, simulation, out, threads, force, retry_failed, even_if_full, progress))]
    #[allow(clippy::too_many_arguments, reason = "as many as a command has options")]
    fn run(
        &self,
        py: Python<'_>,
        simulation: Option<Py<PyAny>>,
        out: PathBuf,
        threads: Option<usize>,
        force: bool,
        retry_failed: bool,
        even_if_full: bool,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<StudyCore> {
        let watched = Watched::new(progress);
        let called = simulation.map(|function| Called::new(function, watched.stop()));
        let scenario = self.scenario.clone();
        let stop = Some(watched.stop());
        let options = Options { out: Some(out), threads, force, even_if_full, retry_failed, stop };
        let done = watched.run(py, called.as_ref(), |more| {
            let scenario = match &called {
                Some(called) => scenario.with_function(called.function())?,
                None => scenario,
            };
            let models = scenario.planned_runs(None);
            let total = models + scenario.driver_runs()?;
            let warnings = Mutex::new(Vec::new());
            let say = |notice: Notice| {
                let warning = match notice {
                    Notice::Damaged { block, .. } => format!("{block}: its runs were done again"),
                    Notice::Unasked(unasked) => unasked.to_string(),
                    Notice::Replacement(told) => words::translated(&told),
                    // The enum may grow.
                    _ => return,
                };
                if let Ok(mut all) = warnings.lock() {
                    all.push(warning);
                }
            };
            let outcome = scenario.run(&options, &|done| more(done, total), &say)?;
            Ok((scenario, outcome, warnings.into_inner().unwrap_or_default()))
        })?;
        let (scenario, outcome, warnings) = done;
        Ok(StudyCore { scenario, outcome, called, warnings })
    }
}

#[pymethods]
impl StudyCore {
    /// The one in a folder, as its files tell.
    #[staticmethod]
    fn read(py: Python<'_>, folder: PathBuf) -> PyResult<Self> {
        let (scenario, outcome) = py.detach(|| StudyOutcome::read(&folder)).map_err(refused)?;
        Ok(Self { scenario, outcome, called: None, warnings: Vec::new() })
    }

    /// Where it is.
    #[getter]
    fn folder(&self) -> &Path {
        self.outcome.folder()
    }

    /// The name of the scenario.
    #[getter]
    fn name(&self) -> &str {
        self.scenario.name()
    }

    /// What there was to warn of.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    /// The resolved scenario, as a TOML file.
    #[getter]
    fn scenario(&self) -> String {
        match &self.scenario {
            AnyScenario::Separation(scenario) => scenario.to_toml(),
            AnyScenario::Simulator(scenario) => scenario.to_toml(),
        }
    }

    /// Each model with how many of its runs failed, and how many there are.
    #[getter]
    fn failed(&self) -> Vec<(String, u64, u64)> {
        let failed = self.outcome.failed();
        failed.map(|(model, failed, runs)| (model.to_owned(), failed, runs)).collect()
    }

    /// What the runs say of the requirements, model by model.
    #[getter]
    fn verdicts(&self) -> Vec<Verdict4> {
        let of = |judged: &Judged| {
            let judgement = judged.judgement();
            let verdict = match judgement.verdict() {
                Verdict::Met => "met",
                Verdict::NotMet => "not met",
                Verdict::Undecided { .. } => "undecided",
            };
            let name = judgement.requirement().name().to_owned();
            (name, judged.model().to_owned(), verdict, judgement.to_string())
        };
        self.outcome.requirements().iter().map(of).collect()
    }

    /// What there is to say on a terminal.
    fn __str__(&self) -> String {
        self.outcome.to_string()
    }

    /// The columns of the runs of a model that were kept: name, unit, meaning, and what stands in them.
    fn columns<'py>(&self, py: Python<'py>, model: &str) -> PyResult<Vec<kept::Column<'py>>> {
        kept::columns(py, self.present()?, model)
    }

    /// One run again, held against its row: model, run, what stands in the columns of its row, what was sent as JSON if something was, and
    /// what there is to say.
    #[pyo3(signature = (*, run, vehicle, flight, model))]
    fn replay<'py>(
        &self,
        py: Python<'py>,
        run: Option<u64>,
        vehicle: Option<u64>,
        flight: Option<u64>,
        model: Option<&str>,
    ) -> PyResult<(Bound<'py, PyDict>, Option<String>, String)> {
        let which = match (run, vehicle, flight) {
            (Some(run), None, None) => Which::Run(run),
            (None, Some(vehicle), Some(flight)) => Which::Flight { vehicle, flight },
            _ => {
                return Err(refused(
                    "a run is said by `run`, or by `vehicle` and `flight` together",
                ));
            }
        };
        let folder = self.present()?;
        let done: PyResult<_> = py.detach(|| match &self.scenario {
            AnyScenario::Simulator(scenario) => {
                let mut replay = SimulatorReplay::new(scenario, model, which).map_err(refused)?;
                replay.hold_against(folder).map_err(refused)?;
                let request = replay.told().request.clone();
                let row = replay.table().row(0).map(|row| kept::cells(&row)).unwrap_or_default();
                Ok((row, request, replay.to_string()))
            }
            AnyScenario::Separation(_) => {
                let replay = Replay::open(folder, model, which, COAST_S).map_err(refused)?;
                Ok((kept::cells(&replay.row()), None, replay.to_string()))
            }
        });
        // An interrupt is told before what came of it.
        if let Some(interrupt) = self.called.as_ref().and_then(Called::interrupt) {
            return Err(interrupt);
        }
        let (row, request, text) = done?;
        Ok((kept::row(py, row)?, request, text))
    }
}

impl StudyCore {
    /// The folder, which somebody may have removed.
    fn present(&self) -> PyResult<&Path> {
        let folder = self.outcome.folder();
        if folder.is_dir() {
            return Ok(folder);
        }
        let path = folder.display();
        Err(refused(format_args!("{path}: the folder of the study is not there any more")))
    }
}

/// Seconds after the last release for which the history of a separation goes on.
const COAST_S: f64 = 10.0;

/// Rows by their name.
fn named_rows(name: &str) -> PyResult<Rows> {
    let found = Rows::ALL.into_iter().find(|rows| rows.name() == name);
    found.ok_or_else(|| {
        let known: Vec<_> = Rows::ALL.iter().map(|rows| format!("{:?}", rows.name())).collect();
        refused(format_args!("rows: {name:?}: it must be {}", known.join(", ")))
    })
}
