//! Inertia models of a program's own, beside those that a scenario file describes.

use gyradius_dispersion::InertiaLaw;
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use sha2::{Digest, Sha256};
use std::{collections::BTreeMap, sync::Arc};

use super::{
    Scenario, ScenarioError, limits,
    model::{ModelSpec, place},
    model_file::{ModelFile, ModelLaw, OutsideFile},
};
use crate::body::Body;

/// The laws of payload and stage, by the name of their model.
pub(super) type OutsideLaws = BTreeMap<String, [Arc<dyn InertiaLaw>; 2]>;

/// Draws of a law that go into its digest: laws that differ in fewer than one draw in a thousand may pass as one.
const DRAWS: usize = 1000;

impl Scenario {
    /// The same scenario with one more model, whose laws of the inertia of payload and stage are a program's own.
    ///
    /// The model goes through the study as every other does: its draws come from the random streams of its name, the
    /// masses and mass centres are drawn as the scenario says, and comparisons and `matched_to` may name it. No file
    /// can hold such a law. [`to_toml`](Self::to_toml) says `law = "outside"`, with the names of the two laws,
    /// whether they are realizable by construction, and a digest of a thousand draws of each. From this file, reports
    /// are made again, but studies and replays are refused until this function has given the same laws again: it
    /// gives them to the model of the name, which keeps its place, if the file says `law = "outside"`.
    ///
    /// # Errors
    /// The name is not allowed in scenario files, or another model has it; the file was written with other laws;
    /// there are too many models; a comparison needs a law that is realizable by construction, and it is not.
    pub fn with_model(
        self,
        name: &str,
        payload: Arc<dyn InertiaLaw>,
        stage: Arc<dyn InertiaLaw>,
    ) -> Result<Self, ScenarioError> {
        let Self { mut file, mut outside, .. } = self;
        let laws = [payload, stage];
        let said = describe(&laws);
        let waits = |m: &ModelFile| {
            m.name == name && m.law == ModelLaw::Outside && !outside.contains_key(name)
        };
        if let Some(index) = file.models.iter().position(waits) {
            let written = file.models[index].outside.get_or_insert_with(|| said.clone());
            if *written != said {
                let field = format!("{}.outside", place(index));
                return Err(ScenarioError::field(field, other_laws(written, &said)));
            }
        } else {
            let (name, outside) = (name.to_owned(), Some(said));
            file.models.push(ModelFile { name, outside, ..ModelFile::default() });
        }
        limits::check(&file)?;
        outside.insert(name.to_owned(), laws);
        Ok(Self { outside, ..Self::check(file)? })
    }

    /// The law of a body under a model from outside, if a program gave it.
    pub(crate) fn outside_law(
        &self,
        model: &ModelSpec,
        which: Body,
    ) -> Option<&Arc<dyn InertiaLaw>> {
        let [payload, stage] = self.outside.get(&model.name)?;
        Some(match which {
            Body::Payload => payload,
            Body::Stage => stage,
        })
    }
}

/// What a file can say of two laws.
fn describe(laws: &[Arc<dyn InertiaLaw>; 2]) -> OutsideFile {
    let [payload, stage] = laws.each_ref().map(|law| law.name().into_owned());
    let mut digest = Sha256::new();
    for law in laws {
        let mut rng = ChaCha8Rng::seed_from_u64(0);
        for draw in (0..DRAWS).map(|_| law.draw(&mut rng)) {
            let axes = draw.axes.iter().flat_map(|axes| axes.coords.iter().copied());
            for number in draw.inertia.entries().into_iter().chain(axes) {
                digest.update(number.to_le_bytes());
            }
        }
    }
    OutsideFile {
        payload,
        stage,
        realizable_by_construction: laws.iter().all(|law| law.is_realizable_by_construction()),
        draws_sha256: digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect(),
    }
}

/// That laws are not those which the file was written with.
fn other_laws(written: &OutsideFile, given: &OutsideFile) -> String {
    let of = |laws: &OutsideFile| {
        let OutsideFile { payload, stage, realizable_by_construction, draws_sha256 } = laws;
        let by_construction = if *realizable_by_construction { "" } else { "not " };
        format!(
            "{payload:?} and {stage:?}, {by_construction}realizable by construction, with draws of the digest {draws_sha256:.12}"
        )
    };
    format!("the laws were {}; those given now are {}", of(written), of(given))
}
