//! What every scenario says and can be asked, of separations or of a simulator: its name, how many runs from which seed, until
//! when, and what is kept of them.

use gyradius_campaign::{Kept, Requirement, Until};

use super::ScenarioError;
use crate::{about::About, fleet::Fleet};

/// What every scenario can be asked.
pub(crate) trait Framed: Sized {
    /// Its name.
    fn name(&self) -> &str;
    /// What it says of itself.
    fn about(&self) -> About;
    /// Seed of all random streams.
    fn seed(&self) -> u64;
    /// Runs of each model.
    fn runs(&self) -> u64;
    /// The vehicles whose flights the runs are, if there are vehicles.
    fn fleet(&self) -> Option<Fleet>;
    /// How many of the runs are independent of each other, if not all are.
    fn independent_runs(&self) -> Option<u64>;
    /// What is kept of the run tables once all runs are done.
    fn kept(&self) -> Kept;
    /// What the runs are to show.
    fn requirements(&self) -> &[Requirement];
    /// Until when its runs go on, if not to their number.
    fn until(&self) -> Option<&Until>;
    /// The same, whose runs ended after so many, looked at as this says by its own rule.
    fn ended_after(&self, runs: u64, until: &Until) -> Result<Self, ScenarioError>;
    /// Base runs by which it is found what drives the outcome, if that is asked.
    fn drivers(&self) -> Option<u64>;
    /// Names of the models, in order.
    fn model_names(&self) -> impl Iterator<Item = &str>;
    /// The resolved scenario.
    fn to_toml(&self) -> String;

    /// So many runs, and those that are left of the last vehicle, if there are vehicles.
    fn whole_vehicles(&self, runs: u64) -> u64 {
        runs.next_multiple_of(self.fleet().map_or(1, Fleet::flights))
    }

    /// The place of the model that is asked for by its name; of the first if none is.
    fn place_of(&self, model: Option<&str>) -> Result<usize, ScenarioError> {
        let mut names = self.model_names();
        let place = names.position(|name| model.is_none_or(|model| name == model));
        place.ok_or_else(|| {
            let (model, known) =
                (model.unwrap_or_default(), self.model_names().collect::<Vec<_>>());
            let problem = format!("{model:?}: the scenario has {}", known.join(", "));
            ScenarioError::field("model", problem)
        })
    }
}

/// Declares a scenario as it stands in a TOML file, defaults filled in: what every scenario says, and then what it says of its own.
/// If nothing is said, there are so many runs between looks.
macro_rules! framed_file {
    ($(#[$meta:meta])* $file:ident, $look_every:expr, { $($own:tt)* }) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub(crate) struct $file {
            pub(crate) name: String,
            /// What it is about, in words of the user.
            pub(crate) vehicle: Option<String>,
            pub(crate) question: Option<String>,
            pub(crate) author: Option<String>,
            pub(crate) date: Option<String>,
            /// Filled in unless there are vehicles and flights.
            #[serde(default, deserialize_with = "crate::scenario::some_whole")]
            pub(crate) runs: Option<u64>,
            #[serde(default, deserialize_with = "crate::scenario::some_whole")]
            pub(crate) vehicles: Option<u64>,
            #[serde(default, deserialize_with = "crate::scenario::some_whole")]
            pub(crate) flights: Option<u64>,
            #[serde(default = "crate::scenario::default_seed", deserialize_with = "crate::scenario::whole")]
            pub(crate) seed: u64,
            /// Which rows of the run tables are kept, and which columns, if not all.
            #[serde(default, skip_serializing_if = "gyradius_campaign::Rows::is_all")]
            pub(crate) rows: gyradius_campaign::Rows,
            pub(crate) columns: Option<Vec<String>>,
            /// Base runs by which it is found what drives the outcome.
            #[serde(default, deserialize_with = "crate::scenario::some_whole")]
            pub(crate) drivers: Option<u64>,
            /// Until when the runs go on, if not to their number.
            pub(crate) until: Option<$crate::scenario::UntilFile>,
            $($own)*
        }

        impl $file {
            /// Checks what every scenario says, and fills in how many runs there are, and until when.
            pub(crate) fn check_frame(&mut self) -> Result<($crate::scenario::Size, Option<Until>), ScenarioError> {
                $crate::scenario::check_name("name", &self.name)?;
                let said = self.about().check();
                said.map_err(|(key, problem)| ScenarioError::field(key, problem))?;
                let keys = [self.runs, self.vehicles, self.flights];
                let keys = $crate::scenario::UntilFile::runs(self.until.as_ref(), keys);
                let size = $crate::scenario::Size::of(keys)?;
                [self.runs, self.vehicles, self.flights] = size.keys();
                let until = self.until(size)?;
                $crate::scenario::base_runs(self.drivers)?;
                $crate::scenario::check_seed(self.seed)?;
                Ok((size, until))
            }

            /// Until when the runs go on, all of it filled in.
            pub(crate) fn until(&mut self, size: $crate::scenario::Size) -> Result<Option<Until>, ScenarioError> {
                let requirements = self.requirements.len();
                self.until.as_mut().map(|until| until.fill(size, $look_every, requirements)).transpose()
            }

            /// What it says of itself.
            pub(crate) fn about(&self) -> $crate::about::About {
                let Self { vehicle, question, author, date, .. } = self.clone();
                $crate::about::About { vehicle, question, author, date }
            }
        }
    };
}
pub(crate) use framed_file;

/// What a type of scenarios can be asked, and the methods by which something else is said; it has the fields `file`, `size`, `until`,
/// `models` and `path`.
macro_rules! framed {
    ($scenario:ty, $file:ident) => {
        impl $scenario {
            /// Its name.
            #[must_use]
            pub fn name(&self) -> &str {
                &self.file.name
            }

            /// Runs of each model: the flights of all vehicles, if it has vehicles.
            #[must_use]
            pub fn runs(&self) -> u64 {
                self.size.runs()
            }

            /// The same, which was read from a file: what is found wrong later is told with it.
            pub(crate) fn read_from(self, path: &Path) -> Self {
                Self { path: Some(path.to_owned()), ..self }
            }

            /// What is found wrong with it after it was read, with the file that it was read from.
            pub(crate) fn located(&self, error: ScenarioError) -> ScenarioError {
                match &self.path {
                    Some(path) => error.in_file(path),
                    None => error,
                }
            }

            /// How many runs of each model there are, and of which vehicles.
            pub(crate) fn size(&self) -> $crate::scenario::Size {
                self.size
            }

            /// Its vehicles and how often each flies, if it has both.
            #[must_use]
            pub fn fleet(&self) -> Option<Fleet> {
                self.size.fleet()
            }

            /// Seed of all random streams.
            #[must_use]
            pub fn seed(&self) -> u64 {
                self.file.seed
            }

            /// Names of the models, in order.
            pub fn model_names(&self) -> impl ExactSizeIterator<Item = &str> {
                self.models.iter().map(|model| model.name.as_str())
            }

            /// The resolved scenario as a TOML file, defaults filled in: enough to run it again. Keys that it leaves out
            /// mean what `docs/scenario.md` says of keys that are left out.
            #[must_use]
            pub fn to_toml(&self) -> String {
                // Numbers, strings and tables of them always serialize.
                toml::to_string(&self.file).unwrap_or_default()
            }

            /// The same scenario with another number of runs for each model.
            ///
            /// # Errors
            /// The number is zero or beyond a thousand million, or the scenario has vehicles.
            pub fn with_runs(self, runs: u64) -> Result<Self, ScenarioError> {
                let size = self.size.with_runs(runs)?;
                Ok(self.sized(size))
            }

            /// The same scenario with another number of vehicles, each with as many flights.
            ///
            /// # Errors
            /// The number is zero, or there are more than a thousand million runs then, or the scenario has no vehicles.
            pub fn with_vehicles(self, vehicles: u64) -> Result<Self, ScenarioError> {
                let size = self.size.with_vehicles(vehicles)?;
                Ok(self.sized(size))
            }

            /// As many as there may be, if its runs end by a rule.
            fn sized(self, size: $crate::scenario::Size) -> Self {
                let most = |until: $crate::scenario::UntilFile| until.with_most_runs(size.runs());
                let file = $file { until: self.file.until.map(most), ..self.file };
                let until = self.until.map(|until| until.with_most_runs(size.runs()));
                Self { file, until, ..self }.ended(size)
            }

            fn ended(self, size: $crate::scenario::Size) -> Self {
                let [runs, vehicles, flights] = size.keys();
                Self { file: $file { runs, vehicles, flights, ..self.file }, size, ..self }
            }

            /// The same scenario from another seed.
            ///
            /// # Errors
            /// The seed does not fit into a TOML integer.
            pub fn with_seed(self, seed: u64) -> Result<Self, ScenarioError> {
                $crate::scenario::check_seed(seed)?;
                Ok(Self { file: $file { seed, ..self.file }, ..self })
            }

            /// The same scenario, which keeps so much of its run tables.
            #[must_use]
            pub fn with_kept(self, kept: &Kept) -> Self {
                let (rows, columns) = (kept.rows(), kept.columns().map(<[_]>::to_vec));
                Self { file: $file { rows, columns, ..self.file }, ..self }
            }

            /// The same scenario, whose runs go on until a rule ends them, and are as many at most as they would be. They are
            /// looked at after `look_every` first. What of the two is not said is as the scenario has it.
            ///
            /// # Errors
            /// There is no rule; it is about requirements, and there are none; `look_every` is zero, or not a whole number of
            /// vehicles.
            pub fn with_until(
                self,
                rule: Option<StoppingRule>,
                look_every: Option<u64>,
            ) -> Result<Self, ScenarioError> {
                let own = self.file.until.as_ref();
                let until = Some($crate::scenario::UntilFile::again(own, rule, look_every)?);
                let mut file = $file { until, ..self.file };
                let until = file.until(self.size)?;
                Ok(Self { file, until, ..self })
            }

            /// The same scenario, of which it is found what drives the outcome, by so many base runs: each of them is done once for
            /// each group of inputs and twice more.
            ///
            /// # Errors
            /// There are fewer than 100, or more than ten million.
            pub fn with_drivers(self, base_runs: u64) -> Result<Self, ScenarioError> {
                let drivers = Some(base_runs);
                $crate::scenario::base_runs(drivers)?;
                Ok(Self { file: $file { drivers, ..self.file }, ..self })
            }

            /// Base runs by which it is found what drives the outcome, if that is asked.
            #[must_use]
            pub fn drivers(&self) -> Option<u64> {
                self.file.drivers
            }

            /// Until when its runs go on, if not to their number.
            #[must_use]
            pub fn until(&self) -> Option<&Until> {
                self.until.as_ref()
            }

            /// What its runs are to show.
            #[must_use]
            pub fn requirements(&self) -> &[Requirement] {
                &self.file.requirements
            }

            /// What is kept of its run tables once all runs are done.
            #[must_use]
            pub fn kept(&self) -> Kept {
                // Which runs are of one vehicle is needed to judge them.
                let own = self.size.fleet().map(|_| Fleet::columns());
                let own = own.into_iter().flatten().map(|column| column.name().to_owned());
                let columns = self.file.columns.clone();
                Kept::new(
                    self.file.rows,
                    columns.map(|named| named.into_iter().chain(own).collect()),
                )
            }
        }

        impl $crate::scenario::Framed for $scenario {
            fn name(&self) -> &str {
                self.name()
            }

            fn about(&self) -> $crate::about::About {
                self.file.about()
            }

            fn seed(&self) -> u64 {
                self.seed()
            }

            fn runs(&self) -> u64 {
                self.runs()
            }

            fn fleet(&self) -> Option<Fleet> {
                self.fleet()
            }

            fn independent_runs(&self) -> Option<u64> {
                self.sharing().map(Fleet::vehicles)
            }

            fn kept(&self) -> Kept {
                self.kept()
            }

            fn requirements(&self) -> &[Requirement] {
                self.requirements()
            }

            fn until(&self) -> Option<&Until> {
                self.until()
            }

            fn ended_after(&self, runs: u64, until: &Until) -> Result<Self, ScenarioError> {
                let mut ended = self.clone().ended(self.size.of_all(runs)?);
                let first_look = until.first_look();
                ended.file.until = ended.file.until.map(|own| own.with_first_look(first_look));
                ended.until = ended.until.map(|_| until.clone());
                Ok(ended)
            }

            fn drivers(&self) -> Option<u64> {
                self.drivers()
            }

            fn model_names(&self) -> impl Iterator<Item = &str> {
                self.model_names()
            }

            fn to_toml(&self) -> String {
                self.to_toml()
            }
        }
    };
}
pub(crate) use framed;

/// The seed if nothing is said.
pub(crate) fn default_seed() -> u64 {
    1
}

pub(crate) fn check_seed(seed: u64) -> Result<(), ScenarioError> {
    if i64::try_from(seed).is_ok() {
        Ok(())
    } else {
        let problem = format!("{seed}: it must be between 0 and {}", i64::MAX);
        Err(ScenarioError::field("seed", problem))
    }
}

/// Names become names of folders.
pub(crate) fn check_name(field: &str, name: &str) -> Result<(), ScenarioError> {
    let allowed = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    // What Windows takes for devices.
    let lower = name.to_ascii_lowercase();
    let port = lower.strip_prefix("com").or_else(|| lower.strip_prefix("lpt"));
    let device = ["con", "prn", "aux", "nul"].contains(&lower.as_str())
        || port.is_some_and(|number| matches!(number.as_bytes(), [b'0'..=b'9']));
    if !name.is_empty() && name.len() <= 64 && name.chars().all(allowed) && !device {
        return Ok(());
    }
    let problem = if device {
        format!(
            "{name:?}: it names a folder, and Windows reserves this name for a device: choose another one"
        )
    } else {
        format!(
            "{name:?}: it must be 1 to 64 letters, digits, hyphens and underscores, for it names a folder"
        )
    };
    Err(ScenarioError::field(field, problem))
}
