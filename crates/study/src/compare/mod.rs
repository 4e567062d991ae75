//! The models of inertia uncertainty head to head: about the same nominal bodies, with the same mean
//! and covariance of the entries as far as each can, over a growing uncertainty.

mod answer;
mod body;
mod contest;
mod figures_of_models;
mod fit;
mod measure;
mod options;
mod page;
mod reference;
mod section;
mod table;
#[cfg(test)]
mod tests;
mod text;

use gyradius_campaign::{Contents, Folder, Progress, Streams, threads};
use gyradius_dispersion::ModelKind;
use gyradius_report::{Document, file_of};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::{
    borrow::Cow,
    path::{Path, PathBuf},
    sync::atomic::{AtomicU64, Ordering},
};

pub use options::CompareOptions;
pub use reference::Reference;

pub(crate) use section::{EVERY_MODEL, Section};

use crate::{StudyError, scenario::Scenario};
use body::NominalBody;
use contest::{Cell, GoOn, measures, nutations};
use measure::Measure;
use options::{Plan, Size};
use reference::Target;

/// Models of inertia uncertainty compared.
///
/// Every draw depends on (seed, model, body, level, number of the draw) alone: results are the same
/// bits on any number of threads, and more draws leave the first ones alone.
#[derive(Clone, Debug, Serialize)]
pub struct ModelComparison {
    gyradius_version: &'static str,
    settings: Settings,
    /// Of every interval.
    confidence: f64,
    bodies: Vec<BodyResult>,
    /// Where it was written to, if it was.
    #[serde(skip)]
    folder: Option<PathBuf>,
}

/// What makes a comparison the same as another.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Settings {
    scenario: String,
    scenario_fingerprint: String,
    reference: Reference,
    reference_meaning: &'static str,
    bodies: Vec<(String, [f64; 6])>,
    levels_percent: Vec<f64>,
    models: Vec<ModelKind>,
    draws: u64,
    separations: u64,
    seed: u64,
}

/// All models about one body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct BodyResult {
    name: String,
    /// I11, I22, I33, I12, I13, I23.
    inertia_kg_m2: [f64; 6],
    /// In the order of [`Measure::ALL`]; none for a nutation that does not exist.
    nominal: Vec<NominalValue>,
    levels: Vec<LevelResult>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct NominalValue {
    measure: Measure,
    unit: Cow<'static, str>,
    value: Option<f64>,
}

/// All models at one level.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct LevelResult {
    /// None for a body's own uncertainty, which no percentage says.
    level_percent: Option<f64>,
    reference: Option<ReferenceResult>,
    /// Why there is no reference.
    problem: Option<String>,
    models: Vec<Cell>,
}

/// What the models were to have at a level.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct ReferenceResult {
    mean_kg_m2: [f64; 6],
    deviations_kg_m2: [f64; 6],
    /// That no law of bodies has these moments, where it can be shown.
    impossible: Option<String>,
}

impl ModelComparison {
    /// Draws from every model and writes the folder, if one is asked for. `progress` is told how many
    /// of [`CompareOptions::cells`] are done.
    ///
    /// # Errors
    /// An option is refused, or the folder holds something else and `force` is not set, or something
    /// cannot be written. What was there stays as it was.
    pub fn run(options: &CompareOptions, progress: Progress<'_>) -> Result<Self, StudyError> {
        let plan = Plan::new(options)?;
        let threads = threads(options.threads)?;
        let settings = Settings::new(&plan);
        let wanted = serde_json::to_value(&settings)?;
        let certain = ["compare.csv", "compare.json", "figures/"].map(str::to_owned);
        let figures = figures_of_models::names().into_iter().map(|name| file_of(&name));
        let certain = certain.into_iter().chain(Document::pages(page::NAME)).chain(figures);
        let contents = Contents::new("comparison", "compare.json", certain, |text: &str, _| {
            serde_json::from_str::<serde_json::Value>(text)
                .is_ok_and(|found| found.get("settings") == Some(&wanted))
        });
        let folder = match &options.out {
            Some(place) => Some(Folder::prepare(place, &contents, options.force)?),
            None => None,
        };
        let bodies = threads.install(|| bodies(&plan, progress))?;
        let mut comparison = Self {
            gyradius_version: env!("CARGO_PKG_VERSION"),
            settings,
            confidence: gyradius_statistics::Confidence::default().level(),
            bodies,
            folder: None,
        };
        if let Some(folder) = folder {
            comparison.folder = Some(comparison.write(folder)?);
        }
        Ok(comparison)
    }

    fn write(&self, mut folder: Folder<'_>) -> Result<PathBuf, StudyError> {
        for (name, content) in self.document().files(page::NAME) {
            folder.write(&name, &content)?;
        }
        folder.write("compare.csv", &self.to_csv())?;
        folder.write("compare.json", &self.to_json()?)?;
        Ok(folder.publish()?)
    }

    /// The folder that was written, if one was asked for.
    #[must_use]
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// Every number, described in docs/compare.md.
    ///
    /// # Errors
    /// None for what this program computes: numbers that JSON does not know are null.
    pub fn to_json(&self) -> Result<String, StudyError> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }
}

impl Settings {
    fn new(plan: &Plan) -> Self {
        Self {
            scenario: plan.scenario.name().to_owned(),
            scenario_fingerprint: plan.scenario.fingerprint(),
            reference: plan.reference,
            reference_meaning: plan.reference.meaning(),
            bodies: plan
                .bodies
                .iter()
                .map(|b| (b.name().to_owned(), b.inertia().entries()))
                .collect(),
            levels_percent: plan.levels_percent.clone(),
            models: plan.models.clone(),
            draws: plan.size.draws,
            separations: plan.size.separations,
            seed: plan.size.seed,
        }
    }
}

/// Everything at once: the cells are independent of each other.
fn bodies(plan: &Plan, progress: Progress<'_>) -> Result<Vec<BodyResult>, StudyError> {
    let done = AtomicU64::new(0);
    plan.bodies
        .par_iter()
        .map(|body| {
            let levels = plan.levels_percent.par_iter().map(|percent| {
                let target = plan.reference.at(body, percent / 100.0);
                let target = target.map_err(|e| e.to_string());
                let label = format!("{} at {percent:?} %, {}", body.name(), plan.reference.name());
                level(
                    Some(*percent),
                    &label,
                    target,
                    &plan.models,
                    &plan.scenario,
                    plan.size,
                    (&|| progress(done.fetch_add(1, Ordering::Relaxed) + 1), &|| Ok(())),
                )
            });
            Ok(BodyResult::new(body, &plan.scenario, levels.collect::<Result<_, _>>()?))
        })
        .collect()
}

/// All models at a level. `label` tells its random streams from others.
fn level(
    level_percent: Option<f64>,
    label: &str,
    target: Result<Target, String>,
    models: &[ModelKind],
    scenario: &Scenario,
    size: Size,
    (done, go_on): (&(dyn Fn() + Sync), GoOn<'_>),
) -> Result<LevelResult, StudyError> {
    let target = match target.and_then(Target::uncertain) {
        Ok(target) => target,
        Err(problem) => {
            models.iter().for_each(|_| done());
            let problem = Some(problem);
            return Ok(LevelResult { level_percent, reference: None, problem, models: Vec::new() });
        }
    };
    let cells: Result<Vec<Cell>, StudyError> = models
        .par_iter()
        .map(|kind| {
            let streams = Streams::new(size.seed, kind.name(), &format!("compare {label}"));
            let cell = Cell::new(*kind, &target, scenario, &streams, size, go_on);
            done();
            cell
        })
        .collect();
    let reference = ReferenceResult {
        mean_kg_m2: target.moments().mean(),
        deviations_kg_m2: target.moments().deviations(),
        impossible: target.impossible(),
    };
    Ok(LevelResult { level_percent, reference: Some(reference), problem: None, models: cells? })
}

impl BodyResult {
    fn new(body: &NominalBody, scenario: &Scenario, levels: Vec<LevelResult>) -> Self {
        let matrix = *body.inertia().as_inertia_matrix();
        let nutation = nutations([matrix].into_iter(), scenario, &|| Ok(()));
        let nutation = nutation.ok().and_then(|mut of_one| of_one.pop()?.ok()?);
        let values = measures(&matrix, scenario).into_iter().chain([nutation]);
        Self {
            name: body.name().to_owned(),
            inertia_kg_m2: body.inertia().entries(),
            nominal: Measure::ALL
                .into_iter()
                .zip(values)
                .map(|(measure, value)| NominalValue {
                    measure,
                    unit: measure.unit().into(),
                    value: value.filter(|x| x.is_finite()),
                })
                .collect(),
            levels,
        }
    }

    fn nominal(&self, measure: Measure) -> Option<f64> {
        self.nominal.iter().find(|n| n.measure == measure)?.value
    }
}

impl LevelResult {
    fn cell(&self, kind: ModelKind) -> Option<&Cell> {
        self.models.iter().find(|cell| cell.model == kind)
    }
}
