//! A scenario of a simulator, checked: the command, what is uncertain, how often.

use gyradius_campaign::{
    Column, Kept, Program, ProgramError, Requirement, Simulator, SimulatorFunction, StoppingRule,
    Table, Until,
};
use gyradius_dispersion::{InertiaLaw, ModelKind, ScalarLaw};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::Arc,
};

use super::{
    body::{Number, SimulatedBody, check_column},
    file::{BodyName, File, OutputFile},
};
use crate::{
    Fleet, FoldedRoot, OffNominal, ScenarioError, UnmatchedLaw,
    model::Modelled,
    scenario::{
        Axes, Joint, List, ModelFile, ModelLaw, ModelSpec, Size, UncertainBody, check_models,
        framed, parse_toml, place, refused,
    },
};

/// Most bodies, quantities or outputs.
const MOST: usize = 300;

/// A campaign of a simulator of the user's own: its command or its function, the bodies and the quantities that are drawn for each run,
/// the outputs that it answers with, how many runs from which seed. Everything has been checked.
#[derive(Clone, Debug)]
pub struct SimulatorScenario {
    file: File,
    size: Size,
    until: Option<Until>,
    bodies: Vec<SimulatedBody>,
    quantities: Vec<Number>,
    /// What is dispersed of all numbers, by their places: those of the bodies, and then the quantities.
    dispersed: Joint<usize>,
    outputs: Vec<Column>,
    models: Vec<ModelSpec>,
    /// The file that it was read from.
    path: Option<PathBuf>,
    /// The function that simulates, once the program gave it.
    function: Option<SimulatorFunction>,
}

framed!(SimulatorScenario, File);

impl SimulatorScenario {
    /// Of the text of a file that is in a folder; what models need of the bodies is not checked yet.
    pub(super) fn parse(text: &str, folder: &Path) -> Result<Self, ScenarioError> {
        let mut file = parse_toml::<File>(text)
            .map_err(|error| ScenarioError::Parse { path: None, message: error.to_string() })?;
        let (size, until) = file.check_frame()?;
        file.simulation.fill()?;
        let is_function = file.simulation.function.is_some();
        let lists = [
            ("bodies", file.bodies.len(), 0),
            ("quantities", file.quantities.len(), 0),
            ("simulation.outputs", file.simulation.outputs.len(), usize::from(!is_function)),
        ];
        for (field, count, least) in lists {
            if !(least..=MOST).contains(&count) {
                let problem = format!("{count} of them: there must be {least} to {MOST}");
                return Err(ScenarioError::field(field, problem));
            }
        }
        // What was resolved stays as it is: the files may be elsewhere, and nothing may be left to be run.
        if !is_function && file.simulation.files_sha256.is_none() {
            let given = file.simulation.folder.take();
            let given = given.map_or_else(|| folder.to_owned(), |given| folder.join(given));
            file.simulation.folder = Some(std::path::absolute(&given).unwrap_or(given));
            let program = program(&file)?;
            let files = program.files_sha256();
            file.simulation.files_sha256 = Some(by_words(&file, files));
        }
        file.bodies.iter_mut().for_each(|body| body.dispersion.fill(body.law.as_ref()));
        let mut list = List::of(size.fleet());
        let (mut bodies, mut count) = (Vec::<SimulatedBody>::new(), 0);
        let drawn = file.draws_roots_and_axes();
        for body in &file.bodies {
            let body = SimulatedBody::new(body, drawn, &bodies, count, &mut list)?;
            count += body.numbers.len();
            bodies.push(body);
        }
        let mut quantities = Vec::new();
        for (i, quantity) in file.quantities.iter().enumerate() {
            let field = format!("quantities[{}]", i + 1);
            check_column(&format!("{field}.name"), &quantity.name)?;
            let law = ScalarLaw::try_from(quantity.law.form.clone())
                .map_err(|error| refused(&format!("{field}.law"), &error))?;
            let each = list.each(&format!("{field}.law"), quantity.law.drawn)?;
            let nominal = law.mean();
            let (unit, meaning) = (quantity.unit.clone(), quantity.meaning.clone());
            let column = Column::number(quantity.name.clone(), unit, meaning);
            list.named(&quantity.name, format!("{field}.law"), nominal, (law, each), count + i);
            quantities.push(Number { column, nominal });
        }
        let dispersed = list.correlate(
            &file.correlations,
            "the dispersion of the bodies and [[quantities]] name",
        )?;
        let outputs = file.simulation.outputs.iter().enumerate().map(|(i, output)| {
            check_column(&format!("simulation.outputs[{}].name", i + 1), &output.name)?;
            let [name, unit, meaning] = [&output.name, &output.unit, &output.meaning];
            Ok(Column::number(name.clone(), unit.clone(), meaning.clone()))
        });
        let outputs = outputs.collect::<Result<Vec<_>, ScenarioError>>()?;
        for (i, body) in bodies.iter_mut().enumerate() {
            dispersed.correlate_roots(i, &mut body.uncertain);
        }
        let models = models(&mut file, &bodies)?;
        let (path, function) = (None, None);
        let scenario = Self {
            file,
            size,
            until,
            bodies,
            quantities,
            dispersed,
            outputs,
            models,
            path,
            function,
        };
        scenario.check_columns()?;
        Ok(scenario)
    }

    /// That the run table can have its columns.
    fn check_columns(&self) -> Result<(), ScenarioError> {
        let given = &self.file.simulation.outputs;
        let outputs =
            given.iter().enumerate().map(|(i, output)| ("simulation.outputs", i, &output.name));
        let given = &self.file.quantities;
        let quantities =
            given.iter().enumerate().map(|(i, quantity)| ("quantities", i, &quantity.name));
        for (list, i, name) in outputs.chain(quantities) {
            if self.own().iter().any(|column| column.name() == name) {
                let problem =
                    format!("{name:?}: a scenario with vehicles has a column of this name");
                return Err(ScenarioError::field(format!("{list}[{}].name", i + 1), problem));
            }
        }
        let columns: Vec<Column> = self.columns().collect();
        let refused = |count: &usize| Table::new("", 0, columns[..*count].to_vec()).err();
        if refused(&columns.len()).is_none() {
            return Ok(());
        }
        // The first that is refused is the one that is to blame.
        let (all, outputs) = (columns.len(), self.outputs.len());
        let place = (1..all).find(|count| refused(count).is_some()).unwrap_or(all) - 1;
        let drawn = all - outputs - self.quantities.len();
        let field = |place: usize| match place.checked_sub(drawn) {
            None => "bodies".to_owned(),
            Some(i) if i < self.quantities.len() => format!("quantities[{}].name", i + 1),
            Some(i) => format!("simulation.outputs[{}].name", i - self.quantities.len() + 1),
        };
        let name = columns[place].name();
        let by = match columns[..place].iter().position(|column| column.name() == name) {
            Some(first) => field(first),
            None => "a column that every run table has".to_owned(),
        };
        let problem = format!("{name:?}: the name is taken, by {by}");
        Err(ScenarioError::field(field(place), problem))
    }

    /// The fleet, if flights of a vehicle have something in common, so that runs are not independent.
    pub(super) fn sharing(&self) -> Option<Fleet> {
        let inertias = self.bodies.iter().map(|body| body.inertia_drawn);
        self.size.sharing(inertias.chain(self.dispersed.drawn_for()))
    }

    /// The words of the command of the simulator; none if it is a function.
    #[must_use]
    pub fn command(&self) -> &[String] {
        self.file.simulation.command.as_deref().unwrap_or_default()
    }

    /// Which function of the calling program simulates, in words; none if a command does.
    #[must_use]
    pub fn function_name(&self) -> Option<&str> {
        self.file.simulation.function.as_deref()
    }

    /// The function that simulates, if the program gave it.
    pub(super) fn function(&self) -> Option<&SimulatorFunction> {
        self.function.as_ref()
    }

    /// The same, which a function simulates.
    pub(super) fn given(self, function: SimulatorFunction) -> Self {
        Self { function: Some(function), ..self }
    }

    /// The same, which answers with outputs of which only the names are known.
    pub(super) fn declaring(&self, outputs: Vec<String>) -> Result<Self, ScenarioError> {
        let mut declaring = self.clone();
        declaring.file.simulation.outputs = outputs.into_iter().map(OutputFile::named).collect();
        let scenario = Self::parse(&declaring.to_toml(), Path::new("."))?;
        Ok(Self { function: declaring.function, path: declaring.path, ..scenario })
    }

    /// The command, ready to be started.
    pub(super) fn program(&self) -> Result<Program, ScenarioError> {
        program(&self.file)
    }

    /// That the files that the command names are those that runs were done with.
    pub(super) fn check_files(&self, simulator: &Simulator) -> Result<(), ScenarioError> {
        let files = simulator.files_sha256();
        let now = by_words(&self.file, files.map(|(place, sha256)| (place, sha256.to_owned())));
        let before = self.file.simulation.files_sha256.clone().unwrap_or_default();
        let words = before.keys().chain(now.keys());
        let Some(word) = words.into_iter().find(|word| before.get(*word) != now.get(*word)) else {
            return Ok(());
        };
        let what = match (before.get(word), now.get(word)) {
            (Some(_), None) => "is not there any more: it was there when",
            (None, _) => "is there now: it was not there when",
            (Some(_), Some(_)) => "was changed after",
        };
        let problem = format!(
            "the file {word:?}, which the command names, {what} the scenario was resolved, and its runs would not go with those \
             that are there"
        );
        Err(ScenarioError::field("simulation.files_sha256", problem))
    }

    /// What it answers with.
    #[must_use]
    pub fn outputs(&self) -> &[Column] {
        &self.outputs
    }

    /// Lengths and roots of the bodies whose laws lie below zero by more than 2.28 %, as a normal law does whose mean is less
    /// than two standard deviations.
    #[must_use]
    pub fn folded(&self) -> Vec<FoldedRoot> {
        self.bodies.iter().flat_map(|body| body.uncertain.folded(&body.name)).collect()
    }

    /// Laws whose means are far from the nominal values beside them.
    #[must_use]
    pub fn off_nominal(&self) -> Vec<OffNominal> {
        let bodies: Vec<(&str, &UncertainBody)> =
            self.bodies.iter().map(|body| (body.name.as_str(), &body.uncertain)).collect();
        let axes = self.models.iter().find_map(|model| model.law.own_axes());
        OffNominal::all(self.dispersed.all.iter(), &self.dispersed, &bodies, axes)
    }

    /// Laws of the bodies that have not the moments to which they were to be matched, since no law of their kind has.
    #[must_use]
    pub fn unmatched(&self) -> Vec<UnmatchedLaw> {
        let of_model = |spec| {
            let bodies = self.bodies.iter().enumerate();
            bodies.filter_map(move |(place, body)| self.modelled(place).unmatched(spec, &body.name))
        };
        self.models.iter().flat_map(of_model).collect()
    }

    /// The body in a place, under the models.
    fn modelled(&self, place: usize) -> Modelled<'_> {
        let body = &self.bodies[place].uncertain;
        Modelled { place, body, models: &self.models, outside: &|_| None }
    }

    /// The law of a body under a model, both by their places, and whether it is the body's own.
    pub(super) fn law(
        &self,
        model: usize,
        body: usize,
    ) -> Result<(Arc<dyn InertiaLaw>, bool), ScenarioError> {
        let (spec, body_of) = (&self.models[model], &self.bodies[body]);
        let (law, _) = self.modelled(body).law(spec).map_err(|error| {
            let problem = format!("the body {}: {error}", body_of.name);
            ScenarioError::field(place(model) + spec.law.key(), problem)
        })?;
        // That enough draws are kept.
        self.acceptance(model, body)?;
        Ok((law, spec.law.own_axes().is_some()))
    }

    /// The estimated share of draws that the region of a body keeps under a model, both by their places, and its standard
    /// error; nothing without a region, and of a model that draws by another law than the body's own.
    pub(super) fn acceptance(
        &self,
        model: usize,
        body: usize,
    ) -> Result<Option<(f64, f64)>, ScenarioError> {
        let uncertain = &self.bodies[body].uncertain;
        let place = format!("bodies[{}]", body + 1);
        let of = |axes| self.dispersed.acceptance(body, &place, uncertain, axes);
        self.models[model].law.own_axes().map_or(Ok(None), of)
    }

    pub(super) fn bodies(&self) -> &[SimulatedBody] {
        &self.bodies
    }

    pub(super) fn quantities(&self) -> &[Number] {
        &self.quantities
    }

    pub(super) fn dispersed(&self) -> &Joint<usize> {
        &self.dispersed
    }

    /// The columns of vehicle and flight, if there are vehicles.
    pub(super) fn own(&self) -> Vec<Column> {
        self.fleet().map_or_else(Vec::new, |_| Fleet::columns().into())
    }

    /// All columns of the run table after model, run and status.
    pub(super) fn columns(&self) -> impl Iterator<Item = Column> {
        self.own().into_iter().chain(self.inputs()).chain(self.outputs.iter().cloned())
    }

    /// The columns of what is drawn and sent, in their order.
    pub(super) fn inputs(&self) -> impl Iterator<Item = Column> {
        let bodies = self.bodies.iter().flat_map(SimulatedBody::columns);
        bodies.chain(self.quantities.iter().map(|quantity| quantity.column.clone()))
    }
}

/// The SHA-256 of the files that a command names, by its words instead of their places.
fn by_words(file: &File, files: impl Iterator<Item = (usize, String)>) -> BTreeMap<String, String> {
    let words = file.simulation.command.as_deref().unwrap_or_default();
    files.filter_map(|(place, sha256)| Some((words.get(place)?.clone(), sha256))).collect()
}

/// The command in its folder.
fn program(file: &File) -> Result<Program, ScenarioError> {
    let simulation = &file.simulation;
    let folder = simulation.folder.as_deref().unwrap_or(Path::new("."));
    let command = simulation.command.as_deref().unwrap_or_default();
    let program = Program::new(command, folder)
        .and_then(|program| match simulation.timeout_s {
            Some(timeout_s) => program.with_timeout(timeout_s),
            None => Ok(program),
        })
        .map_err(|error| {
            let key = match error {
                ProgramError::Folder { .. } | ProgramError::NoFolder { .. } => "folder",
                ProgramError::Timeout { .. } => "timeout_s",
                _ => "command",
            };
            ScenarioError::field(format!("simulation.{key}"), error)
        })?;
    Ok(if simulation.per_run == Some(true) { program.per_run() } else { program })
}

/// The models of a file; one is filled in where there is none.
fn models(file: &mut File, bodies: &[SimulatedBody]) -> Result<Vec<ModelSpec>, ScenarioError> {
    if file.models.is_empty() {
        // Nothing distinguishes models without bodies.
        let (name, axes) =
            if bodies.is_empty() { ("all", None) } else { ("principal", Some(Axes::WholeSphere)) };
        let (name, law) = (name.to_owned(), ModelLaw::Kind(ModelKind::Principal));
        file.models.push(ModelFile { name, law, axes, ..ModelFile::default() });
    }
    if let Some(i) = file.models.iter().position(|model| model.law == ModelLaw::Outside) {
        let problem = "\"outside\": a program gives such laws to separations only";
        return Err(ScenarioError::field(place(i) + ".law", problem));
    }
    let name = |body: &SimulatedBody| BodyName(body.name.clone());
    let names: Vec<BodyName> = bodies.iter().map(name).collect();
    file.models.iter_mut().for_each(|model| model.fill(&names));
    let uncertain = bodies.iter().map(|body| &body.uncertain);
    check_models(&file.models, &names.into_iter().zip(uncertain).collect::<Vec<_>>())
}
