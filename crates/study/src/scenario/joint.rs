//! Numbers that every run draws, how they are correlated, and how those of a body go together.

use gyradius_dispersion::{Correlation, LawUnit, ScalarLaw, ScalarLawForm};
use gyradius_separation::{BodyParameter, LoadParameter, StackParameter};

use super::{
    ScenarioError, body::UncertainBody, each::Each, joint_body::JointBody,
    model_file::AxesFile as Axes,
};
use crate::body::Body;

/// Numbers that every run draws, and how they are correlated.
#[derive(Clone, Debug)]
pub(crate) struct Joint<T> {
    pub(crate) all: Vec<Dispersed<T>>,
    /// Roots of bodies that are correlated, each with the place of its body: numbers after all others, which have no
    /// columns of their own.
    pub(crate) roots: Vec<Dispersed<usize>>,
    pub(crate) correlation: Correlation,
    /// How mass, mass centre and inertia of each body go together.
    pub(crate) bodies: Vec<JointBody>,
}

/// What there is to say of any number that is drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Number<'a> {
    pub(crate) column: &'a str,
    pub(crate) part_of: &'a str,
    pub(crate) given: &'a str,
    pub(crate) law: &'a ScalarLaw,
    pub(crate) each: Each,
}

impl<T> Dispersed<T> {
    pub(super) fn number(&self) -> Number<'_> {
        let Self { column, part_of, given, law, each, .. } = self;
        Number { column, part_of, given, law, each: *each }
    }
}

/// A number that every run draws.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Dispersed<T = Target> {
    /// Its name in correlations and in the run table, and of its random stream.
    pub(crate) column: String,
    /// What it is part of, in words: its parameter, without the component.
    pub(crate) part_of: String,
    /// Where its law stands in the file.
    pub(crate) given: String,
    pub(crate) nominal: f64,
    pub(crate) law: ScalarLaw,
    /// For what it is drawn.
    pub(crate) each: Each,
    pub(crate) target: T,
    /// What the file says of its change from the nominal value; none where it says a law of the value itself.
    pub(crate) change: Option<Change>,
}

/// A law of a change as a file says it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Change {
    pub(crate) form: ScalarLawForm,
    pub(crate) unit: LawUnit,
}

/// What a number is of: a component, from 0, of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Target {
    Body(Body, BodyParameter, usize),
    Stack(StackParameter, usize),
    /// Loads by their places, from 0.
    Load(usize, LoadParameter, usize),
    /// Whether a load starts late, and what then says when.
    Late(usize, LoadParameter),
    /// Whether it never acts.
    Fails(usize),
}

impl<T> Joint<T> {
    /// For what each of them is drawn.
    pub(crate) fn drawn_for(&self) -> impl Iterator<Item = Each> {
        self.numbers().map(|number| number.each)
    }

    /// All numbers that are drawn: those with columns, and then roots.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = Number<'_>> {
        self.all.iter().map(Dispersed::number).chain(self.roots.iter().map(Dispersed::number))
    }

    /// The estimated share of draws of a body that its region keeps, and its standard error, if it has a region; the body
    /// stands at a place of the file, and its axes are read as a model wants them.
    pub(crate) fn acceptance(
        &self,
        number: usize,
        place: &str,
        body: &UncertainBody,
        axes: Axes,
    ) -> Result<Option<(f64, f64)>, ScenarioError> {
        let laws: Vec<&ScalarLaw> = self.numbers().map(|number| number.law).collect();
        let joint = self.bodies.get(number);
        let of =
            |joint: &JointBody| joint.acceptance(place, body, axes, (&laws, &self.correlation));
        joint.map_or(Ok(None), of)
    }

    /// Of a body, as it is correlated here.
    pub(crate) fn correlate_roots(&self, number: usize, body: &mut UncertainBody) {
        let pairs = self.bodies.get(number).map(|own| own.pairs(&self.correlation));
        body.correlate_roots(&pairs.unwrap_or_default());
    }

    /// The body whose root a number is.
    pub(crate) fn root_of(&self, place: usize) -> Option<usize> {
        self.roots.get(place.checked_sub(self.all.len())?).map(|root| root.target)
    }

    /// Which numbers depend on each other, by the first of each such set; pairs of others that belong together, and
    /// what is none of the numbers, may be given.
    pub(crate) fn sets(
        &self,
        count: usize,
        pairs: impl IntoIterator<Item = (usize, usize)>,
    ) -> Vec<usize> {
        let mut leader: Vec<usize> = (0..count).collect();
        for (a, b) in pairs.into_iter().chain(self.correlation.related()) {
            let (a, b) = (leader[a], leader[b]);
            leader.iter_mut().filter(|of| **of == a.max(b)).for_each(|of| *of = a.min(b));
        }
        leader
    }
}

impl<T> Default for Joint<T> {
    fn default() -> Self {
        let (all, roots, bodies) = (Vec::new(), Vec::new(), Vec::new());
        Self { all, roots, correlation: Correlation::default(), bodies }
    }
}

#[cfg(test)]
mod tests;
