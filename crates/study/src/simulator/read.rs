//! Scenarios of simulators, read from files.

use gyradius_campaign::folder_of;
use std::path::Path;

use super::{draws::SimulatorDraws, scenario::SimulatorScenario};
use crate::{
    ResultsError, ScenarioError, results,
    scenario::{scenario_file, scenario_text},
    unfinished::unfinished,
};

impl SimulatorScenario {
    /// Reads a scenario file; of the folder of a study, its `scenario.toml`.
    ///
    /// # Errors
    /// The file cannot be read, is not TOML, has an unknown key, or a value that is not allowed.
    pub fn read(path: &Path) -> Result<Self, ScenarioError> {
        let file = scenario_file(path);
        let text = scenario_text(&file)?;
        let folder = folder_of(&file);
        let scenario = Self::from_toml(&text, folder).map_err(|error| error.in_file(&file))?;
        Ok(scenario.read_from(&file))
    }

    /// The scenario of the study in a folder, also if it is not put together yet; or of a scenario file.
    ///
    /// # Errors
    /// As [`read`](Self::read); the study in the folder is by another version, or was changed after it was written.
    pub fn of_study(path: &Path) -> Result<Self, ResultsError> {
        if !path.is_dir() {
            return Ok(Self::read(path)?);
        }
        match unfinished(path)? {
            Some(scenario) => Ok(scenario),
            None => Ok(results::read::<Self>(path)?.into_parts().0),
        }
    }

    /// Reads a scenario from the text of a file that is in a folder.
    ///
    /// # Errors
    /// It is not TOML, has an unknown key, or a value that is not allowed.
    pub fn from_toml(text: &str, folder: &Path) -> Result<Self, ScenarioError> {
        let scenario = Self::parse(text, folder)?;
        // What a model needs of the bodies is found by making it.
        for place in 0..scenario.model_names().len() {
            SimulatorDraws::new(&scenario, place)?;
        }
        Ok(scenario)
    }
}
