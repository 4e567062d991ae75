//! How mass, mass centre and inertia of a body go together.

use gyradius_dispersion::{
    Correlation, JointScalar, MassPropertiesLaw, ModelDraw, ScalarLaw, following_factor,
};
use gyradius_inertia::{
    Containment, Inertia, InertiaMatrix, MassProperties, Region, RootSecondMoments,
};
use nalgebra::Vector3;

use super::{ScenarioError, UncertainBody, file::INSIDE, model_file::AxesFile as Axes};

/// How mass, mass centre and inertia of a body go together: where they stand among the numbers that are drawn, what of
/// the mass the inertia takes, and where the matter is.
#[derive(Clone, Debug)]
pub(crate) struct JointBody {
    pub(crate) mass: Quantity,
    pub(crate) centre: [Quantity; 3],
    /// The share of the mass's relative change that the inertia takes, and the mass at which its law holds, kg.
    pub(crate) share: f64,
    pub(crate) reference_kg: f64,
    /// Where the matter is, body axes.
    pub(crate) region: Option<Region>,
    /// The place of the first of three roots, where they are numbers of their own.
    pub(crate) roots: Option<usize>,
}

/// A number that is drawn or not.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Quantity {
    pub(crate) place: Option<usize>,
    pub(crate) nominal: f64,
}

impl Quantity {
    fn of(self, values: &[f64]) -> f64 {
        self.place.and_then(|place| values.get(place).copied()).unwrap_or(self.nominal)
    }
}

impl JointBody {
    /// The inertia of a run: of a draw of the law that holds at the reference mass, at the mass that was drawn, and where
    /// the roots are numbers of their own and the law is the `own` one of the body, with these roots.
    pub(crate) fn inertia(&self, values: &[f64], draw: &ModelDraw, own: bool) -> InertiaMatrix {
        let with_roots = |first: usize| {
            let roots = <[f64; 3]>::try_from(values.get(first..first + 3)?).ok()?;
            let squares = RootSecondMoments::new(roots).ok()?.squared();
            Inertia::from_second_moments(squares, &draw.axes?).ok()
        };
        let inertia = self.roots.filter(|_| own).and_then(with_roots);
        let inertia = inertia.map_or(draw.inertia, InertiaMatrix::from);
        following(inertia, self.mass.of(values) / self.reference_kg, self.share)
    }

    /// Whether matter where it may be can have the drawn mass, mass centre and inertia.
    pub(crate) fn holds(&self, values: &[f64], inertia: &InertiaMatrix) -> bool {
        let Some(region) = &self.region else { return true };
        let centre = Vector3::from(self.centre.map(|centre| centre.of(values)));
        let body = Inertia::try_from(*inertia)
            .ok()
            .and_then(|inertia| MassProperties::new(self.mass.of(values), centre, inertia).ok());
        body.is_some_and(|body| region.containment(&body) == Containment::Possible)
    }

    /// The joint law of the ten that all this is, with the axes read as a model wants them, and the laws of all numbers and
    /// how they are correlated. A mass that can be negative is
    /// that given that it is not.
    fn law(
        &self,
        body: &UncertainBody,
        axes: Axes,
        (laws, correlation): (&[&ScalarLaw], &Correlation),
    ) -> Result<MassPropertiesLaw, Box<dyn std::error::Error>> {
        let tensor = body.tensor(axes)?.with_follows(self.share, self.reference_kg)?;
        let law = |quantity: Quantity| match quantity.place.and_then(|place| laws.get(place)) {
            Some(law) => Ok((*law).clone()),
            None => ScalarLaw::normal(quantity.nominal, 0.0),
        };
        let [x, y, z] = self.centre.map(law);
        let law = MassPropertiesLaw::new(law(self.mass)?, [x?, y?, z?], tensor)?;
        let law = law.with_correlation(&self.pairs(correlation))?;
        Ok(match &self.region {
            Some(region) => law.inside(region.clone())?,
            None => law,
        })
    }

    /// The estimated share of draws that the region of the body at a place of the file keeps, and its standard error, if
    /// there is a region.
    ///
    /// # Errors
    /// Next to no draws are kept.
    pub(crate) fn acceptance(
        &self,
        place: &str,
        body: &UncertainBody,
        axes: Axes,
        numbers: (&[&ScalarLaw], &Correlation),
    ) -> Result<Option<(f64, f64)>, ScenarioError> {
        if self.region.is_none() {
            return Ok(None);
        }
        let law = self.law(body, axes, numbers);
        let law = law.map_err(|error| ScenarioError::field(region_key(place, body), error))?;
        Ok(Some(law.acceptance()))
    }

    /// The places of its scalars among all numbers, in the order of [`JointScalar::ALL`].
    fn places(&self) -> [Option<usize>; 7] {
        let [x, y, z] = self.centre.map(|centre| centre.place);
        let [a, b, c] = [0, 1, 2].map(|i| self.roots.map(|first| first + i));
        [self.mass.place, x, y, z, a, b, c]
    }

    /// Its scalars that are numbers of their own, by their places.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = usize> {
        self.places().into_iter().flatten()
    }

    /// Pairs of its numbers by which all hang together.
    pub(crate) fn together(&self) -> Vec<(usize, usize)> {
        self.numbers().zip(self.numbers().skip(1)).collect()
    }

    /// What a law that numbers its scalars as [`JointScalar`] does correlates, by their places.
    pub(crate) fn correlated_by(&self, law: &Correlation) -> Vec<(usize, usize, f64)> {
        let scalars = self.places().into_iter().enumerate();
        let drawn: Vec<_> = scalars.filter_map(|(scalar, place)| Some((scalar, place?))).collect();
        let pairs = pairs(&drawn).map(|((a, i), (b, j))| (i, j, coefficient(law, a, b)));
        pairs.filter(|(_, _, coefficient)| *coefficient != 0.0).collect()
    }

    /// How its scalars are correlated.
    pub(crate) fn pairs(&self, correlation: &Correlation) -> Vec<(JointScalar, JointScalar, f64)> {
        let scalars = JointScalar::ALL.into_iter().zip(self.places());
        let drawn: Vec<_> = scalars.filter_map(|(scalar, place)| Some((scalar, place?))).collect();
        let of = |i, j| coefficient(correlation, i, j);
        let pairs = pairs(&drawn).map(|((a, i), (b, j))| (a, b, of(i, j)));
        pairs.filter(|(_, _, coefficient)| *coefficient != 0.0).collect()
    }
}

/// The key of the region of a body at a place of the file.
pub(crate) fn region_key(place: &str, body: &UncertainBody) -> String {
    format!("{}.{INSIDE}", part(place, body))
}

/// Where the laws of the body at a place of the file stand.
pub(crate) fn part(place: &str, body: &UncertainBody) -> String {
    let of = if body.given_law().is_some() { "law" } else { "dispersion" };
    format!("{place}.{of}")
}

/// All pairs.
fn pairs<A: Copy>(all: &[A]) -> impl Iterator<Item = (A, A)> {
    all.iter().enumerate().flat_map(|(i, b)| all[..i].iter().map(move |a| (*a, *b)))
}

/// Kept from rounding.
fn coefficient(law: &Correlation, a: usize, b: usize) -> f64 {
    law.coefficient(a, b).clamp(-1.0, 1.0)
}

/// An inertia that takes a share of the relative change of a mass, which is so many times its nominal value.
fn following(inertia: InertiaMatrix, ratio: f64, share: f64) -> InertiaMatrix {
    // A mass that is none fails the run anyway.
    if !(ratio > 0.0) || share == 0.0 {
        return inertia;
    }
    InertiaMatrix::new(inertia.matrix() * following_factor(ratio, share)).unwrap_or(inertia)
}
