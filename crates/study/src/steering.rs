//! Scores of runs that are drawn from another law than their own.

use gyradius_campaign::Streams;
use gyradius_statistics::ScoreLaw;
use rand_distr::{Distribution, StandardUniform};
use std::sync::Arc;

/// What the random stream is called that chooses the part of a law.
const CHOICE: &str = "importance sampling";

/// Runs whose scores are drawn from another law than their own, and so weighted.
#[derive(Clone, Debug)]
pub(crate) struct Steering {
    law: Arc<ScoreLaw>,
    /// The place, among all numbers that are dispersed, of each score of the law.
    places: Arc<[usize]>,
    choices: Streams,
    first: u64,
}

impl Steering {
    /// Of a model that has this seed and name, whose numbers in these places are steered: as plain runs, from the first on.
    pub(crate) fn new(seed: u64, model: &str, places: &[usize]) -> Self {
        let law = Arc::new(ScoreLaw::own(places.len()));
        Self { law, places: places.into(), choices: Streams::new(seed, model, CHOICE), first: 0 }
    }

    /// The same with another law, from a run of this number on.
    pub(crate) fn with(&self, law: &ScoreLaw, first: u64) -> Self {
        Self { law: Arc::new(law.clone()), first, ..self.clone() }
    }

    /// How many scores are steered.
    pub(crate) fn scores(&self) -> usize {
        self.places.len()
    }

    /// The number of the first run.
    pub(crate) fn first(&self) -> u64 {
        self.first
    }

    /// The number between 0 and 1 by which a run chooses the part of the law.
    fn choice(&self, run: u64) -> f64 {
        StandardUniform.sample(&mut self.choices.run(run))
    }

    /// Makes the scores that a plain run has, which are independent, those of this law.
    pub(crate) fn steer(&self, run: u64, scores: &mut [f64]) {
        let mut own = self.of(scores);
        self.law.draw(self.choice(run), &mut own);
        for (place, score) in self.places.iter().zip(own) {
            if let Some(steered) = scores.get_mut(*place) {
                *steered = score;
            }
        }
    }

    /// Those of all scores that are steered.
    pub(crate) fn of(&self, scores: &[f64]) -> Vec<f64> {
        self.places.iter().filter_map(|place| scores.get(*place).copied()).collect()
    }
}
