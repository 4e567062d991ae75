//! The models of inertia uncertainty, chosen at run time.

use gyradius_inertia::InertiaMatrix;
use nalgebra::UnitQuaternion;
use rand::Rng;
use rand_distr::Distribution;
use std::fmt;
use std::str::FromStr;

use crate::{
    AxesLaw, BasiliskDispersion, CorrelatedEntries, EntrywiseGaussian, LogCholeskyGaussian,
    PrincipalDispersion, PrincipalDraw, RealizableOnly, RootLaw, Wishart,
};

/// The models of inertia uncertainty, by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum ModelKind {
    /// Second moments and axes (Peck 2003).
    Principal,
    /// Six independent Gaussian entries.
    Entrywise,
    /// Six jointly Gaussian entries.
    CorrelatedEntries,
    /// Independent entries given that they are a body's.
    RealizableEntrywise,
    /// Jointly Gaussian entries given that they are a body's.
    RealizableCorrelatedEntries,
    /// Gaussian in log-Cholesky coordinates.
    LogCholesky,
    /// Maximum entropy (Wishart) second moments.
    Wishart,
    /// The diagonal moved, then turned, as Basilisk does.
    Basilisk,
}

impl ModelKind {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Principal,
        Self::Entrywise,
        Self::CorrelatedEntries,
        Self::RealizableEntrywise,
        Self::RealizableCorrelatedEntries,
        Self::LogCholesky,
        Self::Wishart,
        Self::Basilisk,
    ];

    /// Its name, in kebab case: what scenario files and the command line take.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Principal => "principal",
            Self::Entrywise => "entrywise",
            Self::CorrelatedEntries => "correlated-entries",
            Self::RealizableEntrywise => "realizable-entrywise",
            Self::RealizableCorrelatedEntries => "realizable-correlated-entries",
            Self::LogCholesky => "log-cholesky",
            Self::Wishart => "wishart",
            Self::Basilisk => "basilisk",
        }
    }

    /// What it is, in a line.
    #[must_use]
    pub fn description(self) -> &'static str {
        match self {
            Self::Principal => "squared roots of second moments about random principal axes",
            Self::Entrywise => "six independent Gaussian entries",
            Self::CorrelatedEntries => "six jointly Gaussian entries",
            Self::RealizableEntrywise => {
                "six independent Gaussian entries, impossible draws rejected"
            }
            Self::RealizableCorrelatedEntries => {
                "six jointly Gaussian entries, impossible draws rejected"
            }
            Self::LogCholesky => "Gaussian log-Cholesky coordinates of the second moments",
            Self::Wishart => "maximum-entropy (Wishart) second moments",
            Self::Basilisk => "Gaussian diagonal, then three Gaussian Euler angles",
        }
    }

    /// Whether no draw can be unrealizable, whatever the parameters.
    #[must_use]
    pub fn is_realizable_by_construction(self) -> bool {
        match self {
            Self::Principal
            | Self::RealizableEntrywise
            | Self::RealizableCorrelatedEntries
            | Self::LogCholesky
            | Self::Wishart => true,
            Self::Entrywise | Self::CorrelatedEntries | Self::Basilisk => false,
        }
    }
}

impl fmt::Display for ModelKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// No model has this name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{name:?}: it must be one of {}", ModelKind::ALL.map(ModelKind::name).join(", "))]
pub struct UnknownModel {
    /// The name.
    pub name: String,
}

impl FromStr for ModelKind {
    type Err = UnknownModel;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        Self::ALL
            .into_iter()
            .find(|kind| kind.name() == name)
            .ok_or_else(|| UnknownModel { name: name.to_owned() })
    }
}

/// Any of the models of inertia uncertainty, chosen at run time.
///
/// Draws are those of the law inside, bit for bit. Built by its constructor and `into()`, or by name
/// and matched to given moments: [`matched`](Self::matched).
#[derive(Clone, Debug)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(tag = "model", rename_all = "kebab-case")
)]
pub enum DispersionModel {
    /// Second moments and axes (Peck 2003).
    Principal(Box<PrincipalDispersion<RootLaw, AxesLaw>>),
    /// Six independent Gaussian entries.
    Entrywise(EntrywiseGaussian),
    /// Six jointly Gaussian entries.
    CorrelatedEntries(Box<CorrelatedEntries>),
    /// Independent entries given that they are a body's.
    RealizableEntrywise(RealizableOnly<EntrywiseGaussian>),
    /// Jointly Gaussian entries given that they are a body's.
    RealizableCorrelatedEntries(Box<RealizableOnly<CorrelatedEntries>>),
    /// Gaussian in log-Cholesky coordinates.
    LogCholesky(Box<LogCholeskyGaussian>),
    /// Maximum entropy (Wishart) second moments.
    Wishart(Box<Wishart>),
    /// The diagonal moved, then turned, as Basilisk does.
    Basilisk(BasiliskDispersion),
}

/// A draw, and the attitude of the principal axes where the model draws one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelDraw {
    /// The inertia in body axes.
    pub inertia: InertiaMatrix,
    /// The attitude that takes body components to principal components, as drawn.
    pub axes: Option<UnitQuaternion<f64>>,
}

impl DispersionModel {
    /// Which one.
    #[must_use]
    pub fn kind(&self) -> ModelKind {
        match self {
            Self::Principal(_) => ModelKind::Principal,
            Self::Entrywise(_) => ModelKind::Entrywise,
            Self::CorrelatedEntries(_) => ModelKind::CorrelatedEntries,
            Self::RealizableEntrywise(_) => ModelKind::RealizableEntrywise,
            Self::RealizableCorrelatedEntries(_) => ModelKind::RealizableCorrelatedEntries,
            Self::LogCholesky(_) => ModelKind::LogCholesky,
            Self::Wishart(_) => ModelKind::Wishart,
            Self::Basilisk(_) => ModelKind::Basilisk,
        }
    }
}

impl Distribution<ModelDraw> for DispersionModel {
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> ModelDraw {
        match self {
            Self::Principal(law) => Distribution::<PrincipalDraw>::sample(&**law, rng).into(),
            Self::Entrywise(law) => law.sample(rng).into(),
            Self::CorrelatedEntries(law) => law.sample(rng).into(),
            Self::RealizableEntrywise(law) => law.sample(rng).into(),
            Self::RealizableCorrelatedEntries(law) => law.sample(rng).into(),
            Self::LogCholesky(law) => law.sample(rng).into(),
            Self::Wishart(law) => law.sample(rng).into(),
            Self::Basilisk(law) => law.sample(rng).into(),
        }
    }
}

impl Distribution<InertiaMatrix> for DispersionModel {
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> InertiaMatrix {
        let draw: ModelDraw = self.sample(rng);
        draw.inertia
    }
}

impl<K: Into<RootLaw>, A: Into<AxesLaw>> From<PrincipalDispersion<K, A>> for DispersionModel {
    fn from(law: PrincipalDispersion<K, A>) -> Self {
        let (roots, axes) = law.into_parts();
        Self::Principal(Box::new(PrincipalDispersion::new(roots.into(), axes.into())))
    }
}

macro_rules! from {
    ($($variant:ident($law:ty)),*) => {$(
        impl From<$law> for DispersionModel {
            fn from(law: $law) -> Self {
                Self::$variant(law.into())
            }
        }
    )*};
}
from!(
    Entrywise(EntrywiseGaussian),
    CorrelatedEntries(CorrelatedEntries),
    RealizableEntrywise(RealizableOnly<EntrywiseGaussian>),
    RealizableCorrelatedEntries(RealizableOnly<CorrelatedEntries>),
    LogCholesky(LogCholeskyGaussian),
    Wishart(Wishart),
    Basilisk(BasiliskDispersion)
);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_read_back() {
        for kind in ModelKind::ALL {
            assert_eq!(kind.name().parse::<ModelKind>(), Ok(kind));
            assert_eq!(kind.to_string(), kind.name());
            assert!(!kind.description().is_empty());
        }
        let error = "naive".parse::<ModelKind>().unwrap_err().to_string();
        assert!(error.contains("\"naive\"") && error.contains("log-cholesky"), "{error}");
    }

    #[cfg(feature = "serde")]
    #[test]
    fn serialized_names_are_the_names() {
        for kind in ModelKind::ALL {
            let json = serde_json::to_string(&kind).unwrap();
            assert_eq!(json, format!("{:?}", kind.name()));
        }
    }
}
