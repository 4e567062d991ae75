//! The models of inertia uncertainty, chosen at run time.

use gyradius_inertia::{Inertia, InertiaMatrix};
use rand::Rng;
use rand_distr::Distribution;
use std::{borrow::Cow, fmt, str::FromStr};

use crate::named_model::{NamedModel, NoMatch};
use crate::{
    AxesLaw, BasiliskDispersion, ColumnsError, CorrelatedEntries, EntryMoments, EntrywiseGaussian,
    InertiaLaw, LogCholeskyGaussian, ModelDraw, ModelParameterError, ModelParameters,
    PrincipalDispersion, RealizableOnly, RootLaw, Wishart,
};

/// The kinds of models of inertia uncertainty.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "String", into = "&'static str"))]
pub enum ModelKind {
    /// Second moments and axes (Peck 2003).
    Principal,
    /// Six Gaussian entries.
    Entries {
        /// Whether they are jointly Gaussian, or else independent.
        correlated: bool,
        /// Whether they are conditioned on being a body's: draws that no body has are rejected.
        realizable_only: bool,
    },
    /// Gaussian in log-Cholesky coordinates.
    LogCholesky,
    /// Maximum entropy (Wishart) second moments.
    Wishart,
    /// The diagonal moved, then turned, as Basilisk does.
    Basilisk,
}

/// The model of a law, unless that is written by hand.
macro_rules! from_law {
    ($variant:ident($law:ty)) => {
        impl From<$law> for DispersionModel {
            fn from(law: $law) -> Self {
                Self::$variant(Box::new(law))
            }
        }
    };
    ($variant:ident($law:ty) by_hand) => {};
}

/// Every model, once: the name of its variant, its law and its kind. Names, descriptions, parameters and the rest are
/// what the law says of itself as a [`NamedModel`].
macro_rules! models {
    ($($(#[$doc:meta])* $variant:ident($law:ty) is ($($kind:tt)*) $($by_hand:ident)?;)*) => {
        /// Any of the models of inertia uncertainty, chosen at run time.
        ///
        /// Draws are those of the law inside, bit for bit. Built by its constructor and `into()`, or by name: with
        /// given parameters, [`about`](Self::about), or matched to given moments, [`matched`](Self::matched).
        #[derive(Clone, Debug, PartialEq)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[cfg_attr(feature = "serde", serde(tag = "model", rename_all = "kebab-case"))]
        pub enum DispersionModel {
            $($(#[$doc])* $variant(Box<$law>),)*
        }

        $(from_law!($variant($law) $($by_hand)?);)*

        impl ModelKind {
            /// All of them.
            pub const ALL: [Self; [$(stringify!($variant)),*].len()] = [$(Self::$($kind)*),*];

            /// Its name, in kebab case: what scenario files and the command line take.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$($kind)* => <$law>::NAME,)*
                }
            }

            /// What it is, in a line.
            #[must_use]
            pub fn description(self) -> &'static str {
                match self {
                    $(Self::$($kind)* => <$law>::DESCRIPTION,)*
                }
            }

            /// Whether no draw can be unrealizable, whatever the parameters.
            #[must_use]
            pub fn is_realizable_by_construction(self) -> bool {
                match self {
                    $(Self::$($kind)* => <$law>::IS_REALIZABLE,)*
                }
            }

            /// The keys of the parameters without which [`DispersionModel::about`] makes none.
            #[must_use]
            pub fn needs(self) -> &'static [&'static str] {
                match self {
                    $(Self::$($kind)* => <$law>::NEEDS,)*
                }
            }

            /// The parameters that [`DispersionModel::about`] takes besides, as they are if they are not given.
            #[must_use]
            pub fn defaults(self) -> ModelParameters {
                match self {
                    $(Self::$($kind)* => <$law>::defaults(),)*
                }
            }
        }

        impl DispersionModel {
            /// Which one.
            #[must_use]
            pub fn kind(&self) -> ModelKind {
                match self {
                    $(Self::$variant(_) => ModelKind::$($kind)*,)*
                }
            }

            /// The law inside.
            #[must_use]
            pub fn law(&self) -> &dyn InertiaLaw {
                match self {
                    $(Self::$variant(law) => &**law,)*
                }
            }

            /// The model of a kind about a nominal body, with the parameters that the kind [`needs`](ModelKind::needs)
            /// and may have, [`defaults`](ModelKind::defaults). A principal model has none: it is made by
            /// [`PrincipalDispersion::new`].
            ///
            /// # Errors
            /// A parameter is missing or not allowed, or the kind does not take it.
            pub fn about(
                kind: ModelKind,
                nominal: &Inertia,
                given: &ModelParameters,
            ) -> Result<Self, ModelParameterError> {
                kind.refuse_others(given)?;
                Ok(match kind {
                    $(ModelKind::$($kind)* => {
                        <$law as NamedModel>::about(nominal, given)?.into()
                    })*
                })
            }

            /// The model of a kind with this mean and these moments, and what of them it has.
            pub(crate) fn of_kind(
                kind: ModelKind,
                mean: InertiaMatrix,
                moments: &EntryMoments,
            ) -> Result<(Self, &'static str), NoMatch> {
                Ok(match kind {
                    $(ModelKind::$($kind)* => {
                        let (law, what) = <$law as NamedModel>::matched(mean, moments)?;
                        (law.into(), what)
                    })*
                })
            }
        }
    };
}
models! {
    /// Second moments and axes (Peck 2003).
    Principal(PrincipalDispersion<RootLaw, AxesLaw>) is (Principal) by_hand;
    /// Six independent Gaussian entries.
    Entrywise(EntrywiseGaussian) is (Entries { correlated: false, realizable_only: false });
    /// Six jointly Gaussian entries.
    CorrelatedEntries(CorrelatedEntries) is (Entries { correlated: true, realizable_only: false });
    /// Independent entries given that they are a body's.
    RealizableEntrywise(RealizableOnly<EntrywiseGaussian>)
        is (Entries { correlated: false, realizable_only: true });
    /// Jointly Gaussian entries given that they are a body's.
    RealizableCorrelatedEntries(RealizableOnly<CorrelatedEntries>)
        is (Entries { correlated: true, realizable_only: true });
    /// Gaussian in log-Cholesky coordinates.
    LogCholesky(LogCholeskyGaussian) is (LogCholesky);
    /// Maximum entropy (Wishart) second moments.
    Wishart(Wishart) is (Wishart);
    /// The diagonal moved, then turned, as Basilisk does.
    Basilisk(BasiliskDispersion) is (Basilisk);
}

impl ModelKind {
    /// Six independent Gaussian entries.
    pub const ENTRYWISE: Self = Self::Entries { correlated: false, realizable_only: false };
    /// Six jointly Gaussian entries.
    pub const CORRELATED_ENTRIES: Self = Self::Entries { correlated: true, realizable_only: false };

    /// Refuses the first parameter that this kind does not take.
    fn refuse_others(self, given: &ModelParameters) -> Result<(), ModelParameterError> {
        let defaults = self.defaults();
        let taken: Vec<&str> = self.needs().iter().copied().chain(defaults.given()).collect();
        let Some(key) = given.given().find(|key| !taken.contains(key)) else { return Ok(()) };
        let allowed = if taken.is_empty() { "no parameters".to_owned() } else { taken.join(", ") };
        let problem = format!("a model {:?} takes {allowed}", self.name());
        Err(ModelParameterError::new(key, &problem))
    }
}

impl<K: Into<RootLaw>, A: Into<AxesLaw>> From<PrincipalDispersion<K, A>> for DispersionModel {
    fn from(law: PrincipalDispersion<K, A>) -> Self {
        let (roots, axes) = law.into_parts();
        Self::Principal(Box::new(PrincipalDispersion::new(roots.into(), axes.into())))
    }
}

impl DispersionModel {
    /// Mean and covariance of the entries, where they are known: not for a law conditioned by rejection.
    #[must_use]
    pub fn entry_moments(&self) -> Option<EntryMoments> {
        self.law().expected_moments()
    }

    /// The estimated share of draws that rejection keeps, where the model is one by rejection.
    #[must_use]
    pub fn acceptance(&self) -> Option<f64> {
        self.law().acceptance()
    }
}

impl Distribution<ModelDraw> for DispersionModel {
    fn sample<R: Rng + ?Sized>(&self, mut rng: &mut R) -> ModelDraw {
        self.law().draw(&mut rng)
    }
}

impl Distribution<InertiaMatrix> for DispersionModel {
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> InertiaMatrix {
        let draw: ModelDraw = self.sample(rng);
        draw.inertia
    }
}

/// The law inside, which draws many at a time by the vector units where it is the principal one.
impl InertiaLaw for DispersionModel {
    fn name(&self) -> Cow<'_, str> {
        self.law().name()
    }

    fn draw(&self, rng: &mut dyn Rng) -> ModelDraw {
        self.law().draw(rng)
    }

    fn is_realizable_by_construction(&self) -> bool {
        self.law().is_realizable_by_construction()
    }

    fn expected_moments(&self) -> Option<EntryMoments> {
        self.law().expected_moments()
    }

    fn acceptance(&self) -> Option<f64> {
        self.law().acceptance()
    }

    fn ln_density(&self, inertia: &InertiaMatrix) -> Option<f64> {
        self.law().ln_density(inertia)
    }

    fn has_independent_axes(&self) -> bool {
        self.law().has_independent_axes()
    }

    fn draw_columns(
        &self,
        rng: &mut dyn Rng,
        columns: [&mut [f64]; 6],
    ) -> Result<(), ColumnsError> {
        if let Self::Principal(law) = self {
            law.sample_columns(rng, columns)
        } else {
            self.law().draw_columns(rng, columns)
        }
    }
}

impl fmt::Display for ModelKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl From<ModelKind> for &'static str {
    fn from(kind: ModelKind) -> Self {
        kind.name()
    }
}

impl TryFrom<String> for ModelKind {
    type Error = UnknownModel;

    fn try_from(name: String) -> Result<Self, UnknownModel> {
        name.parse()
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{KnownMoments, ScalarRoots};
    use gyradius_attitude::UniformAttitude;
    use gyradius_inertia::RootSecondMoments;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

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

    /// A value under every key, one at a time.
    fn parameters() -> [ModelParameters; 7] {
        let none = ModelParameters::default;
        let small =
            std::array::from_fn(|i| std::array::from_fn(|j| if i == j { 1e-3 } else { 0.0 }));
        [
            ModelParameters::of_deviations([30.0, 20.0, 10.0, 1.0, 2.0, 3.0]),
            ModelParameters { covariance_kg2_m4: Some(small), ..none() },
            ModelParameters { log_cholesky_covariance: Some(small), ..none() },
            ModelParameters { delta: Some(0.1), ..none() },
            ModelParameters { diagonal_deviation_kg_m2: Some(5.0), ..none() },
            ModelParameters { diagonal_bounds_kg_m2: Some([-1.0, 2.0]), ..none() },
            ModelParameters { angle_deviation_rad: Some(0.01), ..none() },
        ]
    }

    /// Of every kind, with every subset of all parameters: it is made if what it needs is there and nothing that it does not
    /// take, and else the error names what is not, or is. What it does take, each changes the draws.
    #[test]
    fn models_are_made_of_what_they_need_and_take() {
        let nominal = InertiaMatrix::from_entries([5e3, 4e3, 3e3], [20.0, 2.0, -50.0]).unwrap();
        let nominal = Inertia::try_from(nominal).unwrap();
        let all = parameters();
        let keys: Vec<&str> = all.iter().flat_map(ModelParameters::given).collect();
        assert_eq!(keys, ModelParameters::KEYS);
        for kind in ModelKind::ALL.into_iter().filter(|kind| *kind != ModelKind::Principal) {
            let defaults = kind.defaults();
            let mut draws = std::collections::BTreeMap::new();
            for subset in 0..1 << all.len() {
                let chosen = |i: &usize| subset & (1 << i) != 0;
                let given = (0..all.len()).filter(chosen).map(|i| &all[i]);
                let given = given.fold(ModelParameters::default(), |sum, more| sum.or(more));
                let there = |key: &str| given.given().any(|other| other == key);
                let is_taken = |key: &str| {
                    kind.needs().contains(&key) || defaults.given().any(|other| other == key)
                };
                let other = given.given().find(|key| !is_taken(key));
                match DispersionModel::about(kind, &nominal, &given) {
                    Ok(model) => {
                        assert!(kind.needs().iter().all(|key| there(key)), "{kind}: {given:?}");
                        assert_eq!(other, None, "{kind}: {given:?}");
                        assert_eq!(model.kind(), kind);
                        let draw: InertiaMatrix = model.sample(&mut ChaCha8Rng::seed_from_u64(7));
                        let taken: Vec<bool> = defaults.given().map(there).collect();
                        let draw = format!("{draw:?}");
                        assert_eq!(*draws.entry(taken).or_insert(draw.clone()), draw, "{kind}");
                    }
                    Err(error) if other.is_some() => {
                        assert_eq!(other, Some(error.key), "{kind}");
                        let said = format!("a model \"{kind}\" takes {}", kind.needs().join(", "));
                        assert!(error.problem.starts_with(&said), "{error}");
                    }
                    Err(error) => {
                        assert!(kind.needs().contains(&error.key) && !there(error.key), "{error}");
                        assert_eq!(error.problem, "missing");
                    }
                }
            }
            let mut different: Vec<&String> = draws.values().collect();
            different.dedup();
            assert_eq!(different.len(), 1 << defaults.given().count(), "{kind}");
        }
        let refused =
            DispersionModel::about(ModelKind::Principal, &nominal, &ModelParameters::default());
        assert!(refused.unwrap_err().to_string().starts_with("principal: "));
        let given = ModelParameters { delta: Some(0.1), ..ModelParameters::default() };
        let refused = DispersionModel::about(ModelKind::Principal, &nominal, &given).unwrap_err();
        assert_eq!(refused.to_string(), "delta: a model \"principal\" takes no parameters");
    }

    /// Of every kind of model: name, promise, moments and draws are those of the kind and of the law inside.
    #[test]
    fn every_model_is_a_law() {
        let mean = InertiaMatrix::from_entries([5e3, 4e3, 3e3], [20.0, 2.0, -50.0]).unwrap();
        let mean = Inertia::try_from(mean).unwrap();
        let moments = KnownMoments::entry_moments(&Wishart::new(mean, 0.05).unwrap());
        for kind in ModelKind::ALL {
            let model = DispersionModel::matched(kind, &moments).unwrap().into_model();
            let law: Box<dyn InertiaLaw> = Box::new(model.clone());
            assert_eq!(law.name(), kind.name());
            assert_eq!(law.is_realizable_by_construction(), kind.is_realizable_by_construction());
            assert_eq!(law.acceptance().is_some(), law.expected_moments().is_none(), "{kind}");
            let mut rngs = [5, 5].map(ChaCha8Rng::seed_from_u64);
            for _ in 0..50 {
                let expected: ModelDraw = model.sample(&mut rngs[0]);
                assert_eq!(law.draw(&mut rngs[1]), expected, "{kind}");
                let sound = expected.inertia.is_realizable();
                assert!(sound || !law.is_realizable_by_construction(), "{kind}");
            }
        }
    }

    /// Columns are the draws one by one, and unequal ones are refused before anything is drawn.
    #[test]
    fn columns_are_draws() {
        let roots = RootSecondMoments::new([1.0, 2.0, 3.0]).unwrap();
        let roots = ScalarRoots::normal(roots, [0.1; 3]).unwrap();
        let law: &dyn InertiaLaw = &PrincipalDispersion::new(roots, UniformAttitude);
        let mut columns: [[f64; 40]; 6] = [[0.0; 40]; 6];
        let mut rngs = [6, 6].map(ChaCha8Rng::seed_from_u64);
        law.draw_columns(&mut rngs[0], columns.each_mut().map(AsMut::as_mut)).unwrap();
        for row in 0..40 {
            assert_eq!(law.draw(&mut rngs[1]).inertia.entries(), columns.map(|c| c[row]));
        }
        let [a, b, c, d, e, f] = columns.each_mut().map(AsMut::as_mut);
        let f: &mut [f64] = f;
        let unequal: [&mut [f64]; 6] = [a, b, c, d, e, &mut f[..39]];
        assert_eq!(law.draw_columns(&mut rngs[0], unequal).unwrap_err().lengths, [40, 39]);
        assert_eq!(law.draw(&mut rngs[0]), law.draw(&mut rngs[1]));
    }
}
