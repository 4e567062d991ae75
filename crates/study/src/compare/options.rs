//! What to compare, and how many times.

use gyradius_dispersion::ModelKind;
use std::path::PathBuf;

use super::{Reference, body::NominalBody};
use crate::scenario::{Scenario, ScenarioError, check_seed};

/// What levels are refused beyond: the reference's roots have no larger deviation.
const MAX_LEVEL_PERCENT: f64 = 100.0;
/// Most draws of a model at a level, for they are kept until they are summarised.
const MAX_DRAWS: u64 = 1_000_000;
/// Most levels and bodies.
const MAX_LEVELS: usize = 100;

/// What to compare, and how.
#[derive(Clone, Debug)]
pub struct CompareOptions {
    /// The scenario whose separation the bodies go through in place of its payload, and whose payload
    /// and stage are the bodies; the paper's and the built-in bodies if not given.
    pub scenario: Option<Scenario>,
    /// Names of built-in bodies (of the scenario's: `payload`, `stage`), or their inertia in kg·m² as
    /// `I11,I22,I33` or `I11,I22,I33,I12,I13,I23`; all by name if empty.
    pub bodies: Vec<String>,
    /// What the models are matched to.
    pub reference: Reference,
    /// Uncertainty in percent of the largest moment, each in (0, 100].
    pub levels_percent: Vec<f64>,
    /// The models; all if empty.
    pub models: Vec<ModelKind>,
    /// Draws of each model about each body at each level.
    pub draws: u64,
    /// How many of the draws are separated.
    pub separations: u64,
    /// Seed of all random streams.
    pub seed: u64,
    /// How many threads; as many as the machine has if not given.
    pub threads: Option<usize>,
    /// Folder to write page, tables and figures to, if any.
    pub out: Option<PathBuf>,
    /// Replace another comparison in the folder.
    pub force: bool,
}

impl Default for CompareOptions {
    fn default() -> Self {
        Self {
            scenario: None,
            bodies: Vec::new(),
            reference: Reference::default(),
            levels_percent: vec![1.0, 2.0, 5.0, 10.0, 20.0, 50.0],
            models: Vec::new(),
            draws: 10_000,
            separations: 150,
            seed: 2003,
            threads: None,
            out: None,
            force: false,
        }
    }
}

/// The same, checked and complete.
#[derive(Debug)]
pub(crate) struct Plan {
    pub(crate) scenario: Scenario,
    pub(crate) bodies: Vec<NominalBody>,
    pub(crate) reference: Reference,
    /// Ascending.
    pub(crate) levels_percent: Vec<f64>,
    pub(crate) models: Vec<ModelKind>,
    pub(crate) size: Size,
}

/// How much is drawn, from which seed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Size {
    pub(crate) draws: u64,
    pub(crate) separations: u64,
    pub(crate) seed: u64,
}

impl Plan {
    pub(crate) fn new(options: &CompareOptions) -> Result<Self, ScenarioError> {
        let known = NominalBody::known(options.scenario.as_ref())?;
        let mut bodies: Vec<NominalBody> = Vec::new();
        for text in &options.bodies {
            let body = NominalBody::read(text, &known)?;
            if bodies.iter().any(|b| b.name() == body.name()) {
                return Err(ScenarioError::field("body", format!("{text:?}: it is there twice")));
            }
            bodies.push(body);
        }
        if bodies.len() > MAX_LEVELS {
            let problem = format!("{}: at most {MAX_LEVELS}", bodies.len());
            return Err(ScenarioError::field("bodies", problem));
        }
        if bodies.is_empty() {
            bodies = known;
        }
        let mut models: Vec<ModelKind> = Vec::new();
        for kind in &options.models {
            if models.contains(kind) {
                let problem = format!("{kind}: it is there twice");
                return Err(ScenarioError::field("models", problem));
            }
            models.push(*kind);
        }
        if models.is_empty() {
            models = ModelKind::ALL.to_vec();
        }
        let scenario = match &options.scenario {
            Some(scenario) => scenario.clone(),
            None => Scenario::peck_2003()?,
        };
        Ok(Self {
            scenario,
            bodies,
            reference: options.reference,
            levels_percent: levels(&options.levels_percent)?,
            models,
            size: Size::new(options.draws, options.separations, options.seed)?,
        })
    }

    /// Draws and separations that are to be made, for a display of progress.
    pub(crate) fn total(&self) -> u64 {
        (self.bodies.len() * self.levels_percent.len() * self.models.len()) as u64
    }
}

impl CompareOptions {
    /// How many cells the comparison has: what progress counts to.
    ///
    /// # Errors
    /// Something is refused.
    pub fn cells(&self) -> Result<u64, ScenarioError> {
        Ok(Plan::new(self)?.total())
    }
}

impl Size {
    fn new(draws: u64, separations: u64, seed: u64) -> Result<Self, ScenarioError> {
        if !(2..=MAX_DRAWS).contains(&draws) {
            let problem = format!("{draws}: it must be between 2 and {MAX_DRAWS}");
            return Err(ScenarioError::field("draws", problem));
        }
        if separations > draws {
            let problem = format!("{separations}: it must be between 0 and the {draws} draws");
            return Err(ScenarioError::field("separations", problem));
        }
        check_seed(seed)?;
        Ok(Self { draws, separations, seed })
    }
}

fn levels(percent: &[f64]) -> Result<Vec<f64>, ScenarioError> {
    let refuse = |problem: String| Err(ScenarioError::field("levels", problem));
    if percent.is_empty() || percent.len() > MAX_LEVELS {
        return refuse(format!("{} of them: from 1 to {MAX_LEVELS}", percent.len()));
    }
    if let Some(bad) = percent.iter().find(|p| !(**p >= 1e-3 && **p <= MAX_LEVEL_PERCENT)) {
        return refuse(format!("{bad} %: it must be between 0.001 and {MAX_LEVEL_PERCENT} %"));
    }
    let mut levels = percent.to_vec();
    levels.sort_by(f64::total_cmp);
    match levels.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => refuse(format!("{} %: it is there twice", pair[0])),
        None => Ok(levels),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_options_are_named() {
        let base = CompareOptions::default;
        let plan = Plan::new(&base()).unwrap();
        assert_eq!((plan.bodies.len(), plan.models.len(), plan.levels_percent.len()), (4, 8, 6));
        let levels = |levels_percent| CompareOptions { levels_percent, ..base() };
        // One after the other: all of them at once do not fit on the stack of a test.
        let refused = |options: CompareOptions, words: &str| {
            let error = Plan::new(&options).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        };
        refused(levels(vec![]), "levels: 0 of them");
        refused(levels(vec![0.0]), "levels: 0 %: it must be between");
        refused(levels(vec![1.0, f64::NAN]), "levels: NaN %");
        refused(levels(vec![f64::INFINITY]), "levels: inf %");
        refused(levels(vec![100.1]), "levels: 100.1 %");
        refused(levels(vec![5.0, 2.0, 5.0]), "levels: 5 %: it is there twice");
        refused(levels(vec![1.0; 1000]), "levels: 1000 of them");
        refused(CompareOptions { draws: 1, ..base() }, "draws: 1: it must be between 2");
        refused(CompareOptions { draws: u64::MAX, ..base() }, "draws: 18446744073709551615");
        refused(CompareOptions { separations: 10_001, ..base() }, "separations: 10001");
        refused(CompareOptions { seed: u64::MAX, ..base() }, "seed: 184467");
        refused(
            CompareOptions { models: vec![ModelKind::Wishart; 2], ..base() },
            "models: wishart: it is there twice",
        );
        refused(CompareOptions { bodies: vec!["bus".into(); 2], ..base() }, "body: \"bus\": it is");
    }
}
