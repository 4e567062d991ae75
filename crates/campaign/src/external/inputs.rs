//! What a simulator is given for a run.

use serde::{Serialize, Serializer};

use crate::column::Column;

/// What a simulator is given for a run: its number, its model, the seed of its own random numbers, and what was drawn. Serialized, it is
/// what a process is sent.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct RunInputs<'a> {
    pub(super) run: u64,
    #[serde(flatten)]
    pub(super) place: Named<'a, i64>,
    pub(super) model: &'a str,
    pub(super) seed: u64,
    pub(super) inputs: Named<'a, f64>,
}

/// Numbers by the names of their columns.
#[derive(Clone, Copy, Debug)]
pub(super) struct Named<'a, T>(pub(super) &'a [Column], pub(super) &'a [Option<T>]);

impl<'a> RunInputs<'a> {
    /// The number of the run, from 0.
    #[must_use]
    pub fn run(&self) -> u64 {
        self.run
    }

    /// The name of the model.
    #[must_use]
    pub fn model(&self) -> &'a str {
        self.model
    }

    /// The seed of random numbers that the simulator draws itself: below 2⁵³, and of this run alone.
    #[must_use]
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Where the run belongs beside its number, such as its `vehicle` and its `flight`, each with its name; nothing if it belongs
    /// nowhere.
    pub fn place(&self) -> impl Iterator<Item = (&'a str, i64)> {
        self.place.present()
    }

    /// What was drawn, each number with its name, in the order of the columns; not what the run does not have.
    pub fn inputs(&self) -> impl Iterator<Item = (&'a str, f64)> {
        self.inputs.present()
    }

    /// What was drawn of a name; none if there is no such input, or the run does not have it.
    #[must_use]
    pub fn input(&self, name: &str) -> Option<f64> {
        self.inputs().find(|(other, _)| *other == name).map(|(_, number)| number)
    }
}

impl<'a, T: Copy> Named<'a, T> {
    fn present(self) -> impl Iterator<Item = (&'a str, T)> {
        let named = self.0.iter().zip(self.1);
        named.filter_map(|(column, number)| Some((column.name(), (*number)?)))
    }
}

impl<T: Copy + Serialize> Serialize for Named<'_, T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.present())
    }
}
