//! A scenario of a simulator as it stands in a TOML file.

use gyradius_campaign::{Requirement, Until};
use gyradius_dispersion::{MassPropertiesLaw, ModelKind, ModelParameters};
use serde::{
    Deserialize, Deserializer, Serialize,
    de::{SeqAccess, Visitor, value::SeqAccessDeserializer},
};
use std::{collections::BTreeMap, fmt, path::PathBuf};

use crate::{
    ScenarioError,
    scenario::{
        AsGiven, AxesLawFile, BodyFile, CorrelationFile, DispersionFile, ModelFile, ModelLaw,
        Owner, RootsFile, ScalarLawFile, framed_file,
    },
};

framed_file! {
    /// A scenario of a simulator, defaults filled in. Units are in the names.
    File, LOOK_EVERY, {
        pub(super) simulation: SimulationFile,
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        pub(super) bodies: Vec<SimulatedBodyFile>,
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        pub(super) quantities: Vec<QuantityFile>,
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        pub(super) correlations: Vec<CorrelationFile>,
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        pub(super) requirements: Vec<Requirement>,
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        pub(super) models: Vec<ModelFile<BodyName>>,
    }
}

/// Seconds that a run of a command may take, if nothing is said.
const TIMEOUT_S: f64 = 60.0;
/// Longest text that says which function it is.
const MOST_CHARACTERS: usize = 200;
/// Runs between looks, if nothing is said: a block.
const LOOK_EVERY: u64 = 256;

/// How the simulator is started, or which function of a program it is, and what it answers with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SimulationFile {
    /// In the place of a command: which function of the calling program it is, in words.
    pub(super) function: Option<String>,
    #[serde(default, deserialize_with = "command")]
    pub(super) command: Option<Vec<String>>,
    /// Filled in for a command.
    pub(super) per_run: Option<bool>,
    pub(super) timeout_s: Option<f64>,
    /// Where the command belongs; the folder of the scenario if not given.
    pub(super) folder: Option<PathBuf>,
    /// SHA-256 of each file that the command names, by its word, so that runs of another simulator are not mixed with these; in
    /// what is resolved.
    pub(super) files_sha256: Option<BTreeMap<String, String>>,
    #[serde(default)]
    pub(super) outputs: Vec<OutputFile>,
}

/// The words of a command. Whoever writes it as in a shell is shown how it is written here.
fn command<'de, D: Deserializer<'de>>(value: D) -> Result<Option<Vec<String>>, D::Error> {
    struct Command;

    impl<'de> Visitor<'de> for Command {
        type Value = Option<Vec<String>>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str(
                "a list of the program and its arguments, such as [\"python3\", \"simulator.py\"]",
            )
        }

        fn visit_seq<A: SeqAccess<'de>>(self, words: A) -> Result<Self::Value, A::Error> {
            Deserialize::deserialize(SeqAccessDeserializer::new(words)).map(Some)
        }

        fn visit_unit<E>(self) -> Result<Self::Value, E> {
            Ok(None)
        }
    }

    value.deserialize_any(Command)
}

impl SimulationFile {
    /// That it is either a command or a function, and has no key of the other; what is not said of a command is filled in.
    pub(super) fn fill(&mut self) -> Result<(), ScenarioError> {
        let refused = |key: &str, problem: &str| {
            Err(ScenarioError::field(format!("simulation.{key}"), problem))
        };
        let Some(function) = &self.function else {
            if self.command.is_none() {
                let problem = "missing: it says which program simulates; `function` in its place says that the calling program \
                               gives a function";
                return refused("command", problem);
            }
            self.per_run.get_or_insert_default();
            self.timeout_s.get_or_insert(TIMEOUT_S);
            return Ok(());
        };
        let of_commands = [
            ("command", self.command.is_some()),
            ("per_run", self.per_run.is_some()),
            ("timeout_s", self.timeout_s.is_some()),
            ("folder", self.folder.is_some()),
            ("files_sha256", self.files_sha256.is_some()),
        ];
        if let Some((key, _)) = of_commands.into_iter().find(|(_, given)| *given) {
            return refused(key, "the simulation is a function, for which no command is started");
        }
        if function.trim().is_empty() || function.chars().count() > MOST_CHARACTERS {
            let problem =
                format!("it must say in 1 to {MOST_CHARACTERS} characters which function it is");
            return refused("function", &problem);
        }
        Ok(())
    }
}

impl OutputFile {
    /// Of which nothing is known but the name.
    pub(super) fn named(name: String) -> Self {
        Self { name, unit: default_unit(), meaning: default_output_meaning() }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OutputFile {
    pub(super) name: String,
    #[serde(default = "default_unit")]
    pub(super) unit: String,
    #[serde(default = "default_output_meaning")]
    pub(super) meaning: String,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SimulatedBodyFile {
    pub(super) name: String,
    pub(super) mass_kg: f64,
    pub(super) mass_centre_m: Option<[f64; 3]>,
    pub(super) inertia_kg_m2: [[f64; 3]; 3],
    #[serde(default, skip_serializing_if = "says_nothing")]
    pub(super) dispersion: DispersionFile,
    /// Of mass, mass centre and inertia, in the place of what the dispersion says of them.
    pub(super) law: Option<AsGiven<MassPropertiesLaw>>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct QuantityFile {
    pub(super) name: String,
    #[serde(default = "default_unit")]
    pub(super) unit: String,
    #[serde(default = "default_meaning")]
    pub(super) meaning: String,
    /// Of the quantity itself.
    pub(super) law: ScalarLawFile,
}

/// The name of a body, with which the keys of its parameters in models begin.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct BodyName(pub(super) String);

impl Owner for BodyName {
    fn name(&self) -> &str {
        &self.0
    }

    /// Of parameters of which one ends in the other, the longer.
    fn of(key: &str) -> Option<(Self, &'static str)> {
        let of = |parameter: &&'static str| {
            let name = key.strip_suffix(*parameter)?.strip_suffix('_')?;
            (!name.is_empty()).then(|| (Self(name.to_owned()), *parameter))
        };
        let fits = ModelParameters::KEYS.iter().filter_map(of);
        fits.max_by_key(|(_, parameter)| parameter.len())
    }

    fn keys() -> impl Iterator<Item = String> {
        ModelParameters::KEYS.iter().map(|parameter| format!("<body>_{parameter}"))
    }
}

impl File {
    /// Whether a model draws the roots and the axes of bodies: one that is principal, to which any other may be matched. It is
    /// filled in where there is none.
    pub(super) fn draws_roots_and_axes(&self) -> bool {
        let principal = ModelLaw::Kind(ModelKind::Principal);
        self.models.is_empty() || self.models.iter().any(|model| model.law == principal)
    }
}

impl SimulatedBodyFile {
    /// As a body of a separation that rests where it is. Where no model draws roots and axes, they may be left out, and do not
    /// scatter.
    pub(super) fn at_rest(&self, draws_roots_and_axes: bool) -> BodyFile {
        let mut dispersion = self.dispersion.clone();
        if !draws_roots_and_axes && self.law.is_none() {
            if dispersion.roots == Some(RootsFile::Gaussian) {
                dispersion.root_second_moment_variance_kg_m2.get_or_insert([0.0; 3]);
            }
            if dispersion.axes == Some(AxesLawFile::RadiallyConstrainedGaussian)
                && dispersion.axes_covariance.is_none()
            {
                dispersion.axes = Some(AxesLawFile::Fixed);
            }
        }
        BodyFile {
            mass_kg: self.mass_kg,
            inertia_kg_m2: self.inertia_kg_m2,
            position_m: [0.0; 3],
            velocity_m_per_s: [0.0; 3],
            body_to_inertial: [0.0, 0.0, 0.0, 1.0],
            angular_velocity_rad_per_s: [0.0; 3],
            dispersion,
            law: self.law.clone(),
        }
    }
}

fn says_nothing(dispersion: &DispersionFile) -> bool {
    let mut nothing = DispersionFile::default();
    *dispersion == nothing || {
        nothing.fill(None);
        *dispersion == nothing
    }
}

fn default_unit() -> String {
    "1".to_owned()
}

fn default_meaning() -> String {
    "As drawn.".to_owned()
}

fn default_output_meaning() -> String {
    "As the simulator answers.".to_owned()
}
