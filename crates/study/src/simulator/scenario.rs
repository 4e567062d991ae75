//! A scenario of a simulator, checked: the command, what is uncertain, how often.

use gyradius_campaign::{Column, Kept, Program, ProgramError};
use gyradius_dispersion::{ModelKind, ScalarLaw};
use std::path::Path;

use super::{
    body::SimulatedBody,
    file::{File, SimulatedModelFile},
    number::{Number, check_column},
};
use crate::{
    ScenarioError,
    scenario::{Each, Joint, List, check_name, check_runs, check_seed, parse_toml, refused},
};

/// Most bodies, quantities or outputs.
const MOST: usize = 300;

/// A campaign of a simulator of the user's own: its command, the bodies and the quantities that are drawn for each run,
/// the outputs that it answers with, how many runs from which seed. Everything has been checked.
#[derive(Clone, Debug)]
pub struct SimulatorScenario {
    file: File,
    bodies: Vec<SimulatedBody>,
    quantities: Vec<Number>,
    /// What is dispersed of all numbers, by their places: those of the bodies, and then the quantities.
    dispersed: Joint<usize>,
    outputs: Vec<Column>,
}

impl SimulatorScenario {
    /// Whether the text of a scenario file is of a simulator: whether it has a table `[simulation]`.
    #[must_use]
    pub fn is_one(text: &str) -> bool {
        parse_toml::<toml::Table>(text).is_ok_and(|table| table.contains_key("simulation"))
    }

    /// Of the text of a file that is in a folder; what models need of the bodies is not checked yet.
    pub(super) fn parse(text: &str, folder: &Path) -> Result<Self, ScenarioError> {
        let mut file = parse_toml::<File>(text)
            .map_err(|message| ScenarioError::Parse { path: None, message })?;
        check_name("name", &file.name)?;
        check_runs(file.runs)?;
        check_seed(file.seed)?;
        let lists = [
            ("bodies", file.bodies.len(), 0),
            ("quantities", file.quantities.len(), 0),
            ("simulation.outputs", file.simulation.outputs.len(), 1),
        ];
        for (field, count, least) in lists {
            if !(least..=MOST).contains(&count) {
                let problem = format!("{count} of them: there must be {least} to {MOST}");
                return Err(ScenarioError::field(field, problem));
            }
        }
        // What was resolved stays as it is: the files may be elsewhere, and nothing may be left to be run.
        if file.simulation.files_sha256.is_none() {
            let given = file.simulation.folder.clone().unwrap_or_else(|| folder.to_owned());
            file.simulation.folder = Some(std::path::absolute(&given).unwrap_or(given));
            file.simulation.files_sha256 = Some(program(&file)?.files_sha256());
        }
        let mut list = List::default();
        let (mut bodies, mut count) = (Vec::new(), 0);
        for (i, body) in file.bodies.iter().enumerate() {
            let body = SimulatedBody::new(i, body, count, &mut list)?;
            count += body.numbers.len();
            bodies.push(body);
        }
        let mut quantities = Vec::new();
        for (i, quantity) in file.quantities.iter().enumerate() {
            let field = format!("quantities[{}]", i + 1);
            check_column(&format!("{field}.name"), &quantity.name)?;
            let law = ScalarLaw::try_from(quantity.law.clone())
                .map_err(|error| refused(&format!("{field}.law"), &error))?;
            let nominal = law.mean();
            let (unit, meaning) = (quantity.unit.clone(), quantity.meaning.clone());
            let column = Column::number(quantity.name.clone(), unit, meaning);
            list.push(&quantity.name, "", nominal, (law, Each::Flight), count + i);
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
        check_models(&mut file)?;
        Ok(Self { file, bodies, quantities, dispersed, outputs })
    }

    /// The same scenario with another number of runs for each model.
    ///
    /// # Errors
    /// The number is out of range.
    pub fn with_runs(self, runs: u64) -> Result<Self, ScenarioError> {
        check_runs(runs)?;
        Ok(Self { file: File { runs, ..self.file }, ..self })
    }

    /// The same scenario from another seed.
    ///
    /// # Errors
    /// The seed does not fit into a TOML integer.
    pub fn with_seed(self, seed: u64) -> Result<Self, ScenarioError> {
        check_seed(seed)?;
        Ok(Self { file: File { seed, ..self.file }, ..self })
    }

    /// The same scenario, which keeps so much of its run tables.
    #[must_use]
    pub fn with_kept(self, kept: &Kept) -> Self {
        let (rows, columns) = (kept.rows(), kept.columns().map(<[_]>::to_vec));
        Self { file: File { rows, columns, ..self.file }, ..self }
    }

    /// What is kept of its run tables once all runs are done.
    #[must_use]
    pub fn kept(&self) -> Kept {
        Kept::new(self.file.rows, self.file.columns.clone())
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.file.name
    }

    /// Runs of each model.
    #[must_use]
    pub fn runs(&self) -> u64 {
        self.file.runs
    }

    /// Seed of all random streams.
    #[must_use]
    pub fn seed(&self) -> u64 {
        self.file.seed
    }

    /// Names of the models, in order.
    pub fn model_names(&self) -> impl ExactSizeIterator<Item = &str> {
        self.file.models.iter().map(|model| model.name.as_str())
    }

    /// The resolved scenario as a TOML file, every default spelled out: enough to run it again.
    #[must_use]
    pub fn to_toml(&self) -> String {
        // Numbers, strings and tables of them always serialize.
        toml::to_string(&self.file).unwrap_or_default()
    }

    /// The words of the command of the simulator.
    #[must_use]
    pub fn command(&self) -> &[String] {
        &self.file.simulation.command
    }

    /// The command, ready to be started.
    pub(super) fn program(&self) -> Result<Program, ScenarioError> {
        program(&self.file)
    }

    /// That the files that the command names are those that runs were done with.
    pub(super) fn check_files(&self, program: &Program) -> Result<(), ScenarioError> {
        if self.file.simulation.files_sha256.as_ref() == Some(&program.files_sha256()) {
            return Ok(());
        }
        let problem = "a file that the command names was changed after the scenario was resolved, and its runs would not \
                       go with those that are there";
        Err(ScenarioError::field("simulation.files_sha256", problem))
    }

    /// What it answers with.
    #[must_use]
    pub fn outputs(&self) -> &[Column] {
        &self.outputs
    }

    pub(super) fn models(&self) -> &[SimulatedModelFile] {
        &self.file.models
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

    /// The columns of what is drawn and sent, in their order.
    pub(super) fn inputs(&self) -> impl Iterator<Item = Column> {
        let bodies = self.bodies.iter().flat_map(SimulatedBody::columns);
        bodies.chain(self.quantities.iter().map(|quantity| quantity.column.clone()))
    }
}

/// The command in its folder.
fn program(file: &File) -> Result<Program, ScenarioError> {
    let simulation = &file.simulation;
    let folder = simulation.folder.as_deref().unwrap_or(Path::new("."));
    let program = Program::new(&simulation.command, folder)
        .and_then(|program| program.with_timeout(simulation.timeout_s))
        .map_err(|error| {
            let key = match error {
                ProgramError::Folder { .. } => "folder",
                ProgramError::Timeout { .. } => "timeout_s",
                _ => "command",
            };
            ScenarioError::field(format!("simulation.{key}"), error)
        })?;
    Ok(if simulation.per_run { program.per_run() } else { program })
}

fn check_models(file: &mut File) -> Result<(), ScenarioError> {
    if file.bodies.is_empty() && file.models.is_empty() {
        // Nothing distinguishes models without bodies.
        let law = ModelKind::Principal;
        file.models.push(SimulatedModelFile {
            name: "all".to_owned(),
            law,
            axes: None,
            matched_to: None,
        });
        return Ok(());
    }
    if file.models.is_empty() {
        return Err(ScenarioError::field("models", "none: there must be at least one"));
    }
    for (i, model) in file.models.iter().enumerate() {
        let field = format!("models[{}]", i + 1);
        check_name(&format!("{field}.name"), &model.name)?;
        if file.models[..i].iter().any(|other| other.name.eq_ignore_ascii_case(&model.name)) {
            let problem =
                format!("two are named {:?}: names must differ in more than case", model.name);
            return Err(ScenarioError::field(format!("{field}.name"), problem));
        }
    }
    Ok(())
}
