//! The joint law of mass, mass centre and inertia, of which every draw is a body.

use gyradius_inertia::{Inertia, MAX_LENGTH, MassProperties, Region, SecondMoments};
use nalgebra::{UnitQuaternion, Vector3};
use rand::{Rng, SeedableRng, rngs::Xoshiro256PlusPlus};
use rand_distr::{Distribution, StandardNormal};

use super::inside::{Inside, RegionAcceptanceError};
use super::model::draws_bodies;
use super::tensor::{Follows, Of, Principal};
use super::{MassPropertiesModel, TenMoments, TensorLaw, TensorLawError};
use crate::columns::ColumnsError;
use crate::roots::FAR;
use crate::scalar::NEVER;
use crate::{Correlation, CorrelationProblem, InertiaLaw, ScalarLaw, ScalarLawError};

/// What mass times the square of a length may come to at most, so that squares of it do not overflow.
const MAX_MOMENT: f64 = 1e150;
/// Trial draws of a constructor.
const TRIALS: usize = 64;

/// The joint law of mass, mass centre and inertia.
///
/// # Definition
/// The mass m and the coordinates of the mass centre c from scalar laws, in kg and m; the inertia about the mass centre
/// from a [`TensorLaw`], of which gyration lengths make K_k = m ρ_k². Scalars may be correlated by a Gaussian copula
/// ([`Correlation`]); the axes are independent of everything else. A normal law of the mass is the law given that the
/// mass is positive.
///
/// # Realizability
/// By construction. Ten numbers are those of a body if and only if m > 0 and the second moments about the mass centre,
/// Σ_c, are positive semidefinite: a mass or a mass centre alone never makes a body impossible.
///
/// ```
/// use gyradius_attitude::UniformAttitude;
/// use gyradius_dispersion::{MassPropertiesLaw, ScalarLaw, TensorLaw};
/// use gyradius_inertia::MassProperties;
/// use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
/// use rand_distr::Distribution;
///
/// let lengths = [0.2, 0.3, 0.5].map(|rho| ScalarLaw::normal(rho, 0.05 * rho));
/// let [a, b, c] = lengths;
/// let law = MassPropertiesLaw::new(
///     ScalarLaw::normal(12.0, 0.6)?,
///     [ScalarLaw::normal(0.0, 0.005)?, ScalarLaw::normal(0.0, 0.005)?, ScalarLaw::normal(0.1, 0.005)?],
///     TensorLaw::gyration_lengths([a?, b?, c?], UniformAttitude),
/// )?;
/// let body: MassProperties = law.sample(&mut ChaCha8Rng::seed_from_u64(7));
/// assert!(body.mass_kg() > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, getset::Getters)]
#[getset(get = "pub")]
pub struct MassPropertiesLaw {
    /// The law of the mass, kg.
    mass: ScalarLaw,
    /// The laws of the mass centre, m.
    centre: [ScalarLaw; 3],
    /// The law of the inertia about the mass centre.
    tensor: TensorLaw,
    /// How the scalars are correlated.
    correlation: Correlation,
    /// As given, for files.
    #[getset(skip)]
    pairs: Vec<(JointScalar, JointScalar, f64)>,
    #[getset(skip)]
    inside: Option<Inside>,
}

/// A scalar of a joint law that can be correlated with others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum JointScalar {
    /// The mass.
    Mass,
    /// Coordinate 1 of the mass centre.
    Centre1,
    /// Coordinate 2 of the mass centre.
    Centre2,
    /// Coordinate 3 of the mass centre.
    Centre3,
    /// The first gyration length, or the first root.
    Shape1,
    /// The second.
    Shape2,
    /// The third.
    Shape3,
}

impl JointScalar {
    /// All of them, in the order in which they are drawn.
    pub const ALL: [Self; 7] = [
        Self::Mass,
        Self::Centre1,
        Self::Centre2,
        Self::Centre3,
        Self::Shape1,
        Self::Shape2,
        Self::Shape3,
    ];
}

/// As files write it: `mass`, `centre1`, `shape3`.
impl std::fmt::Display for JointScalar {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&format!("{self:?}").to_lowercase())
    }
}

impl MassPropertiesLaw {
    /// From the laws of the mass in kg, of the mass centre in m along the body axes, and of the inertia about it.
    ///
    /// # Errors
    /// The mass is not positive with a probability above Φ(−8) = 6.2e-16 (of a normal law the mean must be positive, and the deviation
    /// not larger), or something can come out too large.
    pub fn new(
        mass: ScalarLaw,
        centre: [ScalarLaw; 3],
        tensor: TensorLaw,
    ) -> Result<Self, MassPropertiesLawError> {
        tensor.check()?;
        let mass = positive(mass)?;
        let (correlation, pairs) = (Correlation::default(), Vec::new());
        let law = Self { mass, centre, tensor, correlation, pairs, inside: None };
        law.check_reach()?;
        law.check_draws()?;
        Ok(law)
    }

    /// The same with scalars that are correlated, by the coefficients of their normal scores.
    ///
    /// # Errors
    /// The coefficients do not belong together, one is of a scalar that does not vary, or one is of the shape and the
    /// inertia is drawn by a model that has no three scalar laws.
    pub fn with_correlation(
        self,
        pairs: &[(JointScalar, JointScalar, f64)],
    ) -> Result<Self, MassPropertiesLawError> {
        let laws: Vec<&ScalarLaw> = self.scalar_laws().collect();
        let at: Vec<(usize, usize, f64)> =
            pairs.iter().map(|&(a, b, value)| (a as usize, b as usize, value)).collect();
        let mut members = pairs.iter().flat_map(|&(a, b, _)| [(a, [a, b]), (b, [a, b])]);
        let law = |scalar: JointScalar| laws.get(scalar as usize);
        if let Some((scalar, _)) = members.clone().find(|(scalar, _)| law(*scalar).is_none()) {
            return Err(MassPropertiesLawError::NoShape { scalar });
        }
        let is_still = |scalar| law(scalar).is_some_and(|law| !(law.deviation() > 0.0));
        if let Some((scalar, scalars)) = members.find(|(scalar, _)| is_still(*scalar)) {
            return Err(MassPropertiesLawError::Still { scalars, scalar });
        }
        let correlation = Correlation::new(&at).map_err(|error| {
            let (a, b, _) = pairs[error.pair];
            MassPropertiesLawError::Correlation { scalars: [a, b], problem: error.problem }
        })?;
        let law = Self { correlation, pairs: pairs.to_vec(), inside: None, ..self.clone() };
        match self.inside {
            Some(inside) => law.inside(inside.into_region()),
            None => Ok(law),
        }
    }

    /// The same given that matter inside a region can have the mass properties, by rejection: draws of which
    /// [`Region::containment`] does not show that are drawn again. How many are is estimated from trial draws with a
    /// fixed seed, 20,000 for an ellipsoid and 4,000 for a box or a hull.
    ///
    /// # Errors
    /// The law has a region already, or fewer than one in a thousand trial draws are possible in the region.
    pub fn inside(self, region: Region) -> Result<Self, MassPropertiesLawError> {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(0);
        let inside = Inside::new(self.inside.as_ref(), region, || self.sample(&mut rng))?;
        Ok(Self { inside: Some(inside), ..self })
    }

    /// The region that holds the matter of every draw.
    #[must_use]
    pub fn region(&self) -> Option<&Region> {
        self.inside.as_ref().map(Inside::region)
    }

    /// The estimated share of proposals that are possible in the region, and its standard error; 1 and 0 without one.
    #[must_use]
    pub fn acceptance(&self) -> (f64, f64) {
        self.inside.as_ref().map_or((1.0, 0.0), Inside::acceptance)
    }

    /// Mass, mass centre, and lengths or roots where there are such.
    pub(super) fn scalar_laws(&self) -> impl Iterator<Item = &ScalarLaw> {
        let shape = self.tensor.scalar_laws().into_iter().flatten();
        std::iter::once(&self.mass).chain(&self.centre).chain(shape)
    }

    /// What draws are kept to by rejection, so that the laws of the parts are not those of the whole.
    pub(super) fn kept_to(&self) -> Option<&Inside> {
        self.inside.as_ref()
    }

    /// Whether the region, if there is one, holds a body.
    #[inline]
    pub(super) fn holds(&self, body: &MassProperties) -> bool {
        self.inside.as_ref().is_none_or(|inside| inside.holds(body))
    }

    /// Whether scalars are correlated.
    pub(super) fn is_correlated(&self) -> bool {
        !self.pairs.is_empty()
    }

    pub(super) fn shares(&self) -> Shares {
        Shares(self.tensor.follows)
    }

    fn check_reach(&self) -> Result<(), MassPropertiesLawError> {
        let mass = self.mass.reach(FAR);
        if !(mass <= MAX_MOMENT) {
            return Err(MassPropertiesLawError::Reach { what: "mass", value: mass });
        }
        for law in &self.centre {
            let value = law.reach(FAR);
            if !(value <= MAX_LENGTH && mass * value * value <= MAX_MOMENT) {
                return Err(MassPropertiesLawError::Reach { what: "mass centre", value });
            }
        }
        let (what, factor) = match &self.tensor.of {
            Of::GyrationLengths(_) => ("gyration lengths", mass),
            Of::Roots(_) => ("roots", self.shares().factor(mass)),
            Of::Model(_) => return Ok(()),
        };
        for law in self.tensor.scalar_laws().into_iter().flatten() {
            let value = law.reach(FAR);
            if !(value * value * factor <= MAX_MOMENT) {
                return Err(MassPropertiesLawError::Reach { what, value });
            }
        }
        Ok(())
    }

    fn check_draws(&self) -> Result<(), MassPropertiesLawError> {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(0);
        let bodies = (0..TRIALS).filter(|_| self.propose(&mut rng).is_some()).count();
        if 2 * bodies < TRIALS { Err(MassPropertiesLawError::NoBodies { bodies }) } else { Ok(()) }
    }

    /// A draw, unless the mass or a size is none.
    #[inline]
    fn propose<R: Rng + ?Sized>(&self, rng: &mut R) -> Option<MassProperties> {
        let (mass, centre, shape) = self.scalars(rng);
        if !(mass > 0.0) {
            return None;
        }
        let principal = |factor: f64, axes: &UnitQuaternion<f64>| {
            let moments = SecondMoments::new(shape.map(|size| size * size * factor)).ok()?;
            Inertia::from_second_moments(moments, axes).ok()
        };
        let inertia = match &self.tensor.of {
            Of::GyrationLengths(Principal { axes, .. }) => principal(mass, &axes.sample(rng))?,
            Of::Roots(Principal { axes, .. }) => {
                principal(self.shares().factor(mass), &axes.sample(rng))?
            }
            Of::Model(model) => {
                let mut rng = rng;
                let drawn = model.draw(&mut rng).inertia;
                let factor = self.shares().factor(mass);
                let inertia = Inertia::try_from(drawn).ok()?;
                if factor == 1.0 {
                    inertia
                } else {
                    Inertia::new(inertia.matrix() * factor).ok()?
                }
            }
        };
        MassProperties::new(mass, centre, inertia).ok()
    }

    /// Mass, mass centre, and lengths or roots where there are such.
    #[inline]
    fn scalars<R: Rng + ?Sized>(&self, rng: &mut R) -> (f64, Vector3<f64>, [f64; 3]) {
        // As many scores whatever the laws are, so that another law of one changes no other.
        let z: [f64; 4] = std::array::from_fn(|_| StandardNormal.sample(rng));
        let shape = self.tensor.scalar_laws();
        let mut scores = [z[0], z[1], z[2], z[3], 0.0, 0.0, 0.0];
        if shape.is_some() {
            scores[4..].fill_with(|| StandardNormal.sample(rng));
        }
        if self.is_correlated() {
            self.correlation.mix(&mut scores);
        }
        let mass = self.mass.at_score(scores[0]);
        let centre = [0, 1, 2].map(|i| self.centre[i].at_score(scores[1 + i]));
        let sizes =
            shape.map_or([0.0; 3], |laws| [0, 1, 2].map(|i| laws[i].at_score(scores[4 + i])));
        (mass, centre.into(), sizes)
    }
}

/// What the inertia is multiplied with at a mass.
#[derive(Clone, Copy)]
pub(super) struct Shares(Option<Follows>);

impl Shares {
    pub(super) fn factor(self, mass: f64) -> f64 {
        self.0.map_or(1.0, |follows| follows.factor(mass))
    }
}

/// A law of the mass that is next to never negative: a draw that is so all the same is drawn again. A normal law that scatters
/// more is that given that the mass is positive.
fn positive(mass: ScalarLaw) -> Result<ScalarLaw, MassPropertiesLawError> {
    // A law that begins at zero is at zero with probability zero.
    let probability = mass.cdf(0.0);
    if probability <= NEVER {
        return Ok(mass);
    }
    match mass.as_normal() {
        Some([mean, variance]) if mean > 0.0 && variance <= mean * mean => {
            Ok(ScalarLaw::truncated_normal(mean, variance.sqrt(), 0.0, f64::INFINITY)?)
        }
        Some(_) | None => Err(MassPropertiesLawError::Mass { probability, mean: mass.mean() }),
    }
}

impl Distribution<MassProperties> for MassPropertiesLaw {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> MassProperties {
        loop {
            if let Some(body) = self.propose(rng)
                && self.holds(&body)
            {
                return body;
            }
        }
    }
}

impl MassPropertiesModel for MassPropertiesLaw {
    draws_bodies!("joint");

    fn ln_density(&self, body: &MassProperties) -> Option<f64> {
        self.ln_density(body)
    }

    fn moments(&self) -> Option<TenMoments> {
        self.moments()
    }

    fn linear_moments(&self) -> Option<TenMoments> {
        self.linear_moments()
    }

    /// By [`sample_columns`](Self::sample_columns): other values than one by one.
    fn draw_columns(
        &self,
        rng: &mut dyn Rng,
        columns: [&mut [f64]; 10],
    ) -> Result<(), ColumnsError> {
        self.sample_columns(rng, columns)
    }

    fn acceptance(&self) -> Option<f64> {
        self.inside.as_ref().map(|_| self.acceptance().0)
    }
}

crate::written!(
    MassPropertiesLaw,
    |law| {
        mass_kg: ScalarLaw = law.mass.clone(),
        mass_centre_m: [ScalarLaw; 3] = law.centre.clone(),
        inertia: TensorLaw = law.tensor.clone(),
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        correlations: Vec<(JointScalar, JointScalar, f64)> = law.pairs.clone(),
        #[serde(default, skip_serializing_if = "Option::is_none")]
        inside: Option<Region> = law.inside.clone().map(Inside::into_region),
    },
    {
        let law = MassPropertiesLaw::new(mass_kg, mass_centre_m, inertia)?;
        let law = law.with_correlation(&correlations)?;
        match inside {
            Some(region) => law.inside(region)?,
            None => law,
        }
    }
);

/// Why laws do not make a joint one.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MassPropertiesLawError {
    /// The mass is negative or zero too often.
    #[error(
        "mass with the mean {mean:?} kg, not positive with probability {probability:.3e}: it must be positive"
    )]
    Mass {
        /// How often.
        probability: f64,
        /// The mean, kg.
        mean: f64,
    },
    /// The law of a scalar.
    #[error(transparent)]
    Scalar(#[from] ScalarLawError),
    /// The law of the inertia.
    #[error(transparent)]
    Tensor(#[from] TensorLawError),
    /// The coefficients of correlation.
    #[error("correlation of {} and {}: {problem}", scalars[0], scalars[1])]
    Correlation {
        /// The two scalars.
        scalars: [JointScalar; 2],
        /// What is wrong with their coefficient.
        problem: CorrelationProblem,
    },
    /// A coefficient is of a scalar that does not vary, on which it would have no effect.
    #[error(
        "correlation of {} and {}: {scalar} does not vary, as its law has no deviation: give it one, or leave the pair away",
        scalars[0], scalars[1]
    )]
    Still {
        /// The two scalars.
        scalars: [JointScalar; 2],
        /// The one that does not vary.
        scalar: JointScalar,
    },
    /// A coefficient is of the shape, and the inertia is drawn by a model.
    #[error(
        "correlation with {scalar:?}: the inertia is drawn by a model that has no three scalar laws"
    )]
    NoShape {
        /// The scalar.
        scalar: JointScalar,
    },
    /// Something can come out too large.
    #[error(
        "{what} of up to {value:e}: mass times the square of a length must not come out beyond {MAX_MOMENT:e} kg·m²"
    )]
    Reach {
        /// What.
        what: &'static str,
        /// How large, in SI units.
        value: f64,
    },
    /// The region.
    #[error(transparent)]
    Region(#[from] RegionAcceptanceError),
    /// Most trial draws are no bodies.
    #[error("{bodies} of {TRIALS} trial draws are bodies: sizes so small that floats lose them")]
    NoBodies {
        /// How many are.
        bodies: usize,
    },
}
