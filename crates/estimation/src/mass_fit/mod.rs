//! The joint law of mass, mass centre and inertia, fitted to samples of bodies.

mod goodness;
mod scalar;
#[cfg(test)]
mod tests;
mod ties;

use gyradius_dispersion::{
    JointScalar, MassPropertiesLaw, MassPropertiesLawError, ScalarLaw, ScalarLawError, TensorLaw,
};
use gyradius_inertia::{Inertia, MassProperties, MassPropertiesError};
use nalgebra::SMatrix;

use crate::fit::{AxesFinding, LARGER, PrincipalFit, PrincipalFitError, RootEstimate, far_larger};

pub use goodness::{MassAspect, MassAssessment, MassTest};
pub use scalar::{ScalarEstimate, ScalarFit};
pub use ties::{MassTies, Tie};

/// How many scalars a joint law has.
const SCALARS: usize = JointScalar::ALL.len();
/// Nearer to zero than this many deviations a length has lost its sign in too many samples for a correlation.
const SIGN_LOST: f64 = 3.0;
/// The largest coefficient of correlation that is taken.
const MOST: f64 = 1.0 - 1e-9;

/// A [`MassPropertiesLaw`] fitted to samples of bodies: CAD variants, a product line, draws of a posterior.
///
/// # Algorithm
/// * Mass: normal or lognormal, by maximum likelihood ([`MassChoice`]).
/// * Mass centre: three normal laws.
/// * Inertia: [`PrincipalFit`] of the inertia of one kilogram, I/m, so that its roots are gyration lengths in m, with
///   matched axes.
/// * Correlations: of the seven scalars in each sample, each in the coordinate in which its law is normal, the logarithm
///   of a lognormal mass. None with a length within three deviations of zero, which has lost its sign.
/// * [`MassTies`]: whether the inertia follows the mass, with intervals.
///
/// # Limits
/// Those of [`PrincipalFit`]. Axes that go with mass, mass centre or lengths are found by the tests, and no
/// part of the law.
///
/// ```
/// use gyradius_attitude::UniformAttitude;
/// use gyradius_dispersion::{MassPropertiesLaw, ScalarLaw, TensorLaw};
/// use gyradius_estimation::{MassChoice, MassPropertiesFit};
/// use gyradius_inertia::MassProperties;
/// use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
/// use rand_distr::Distribution;
///
/// let normal = |mean: f64, deviation: f64| ScalarLaw::normal(mean, deviation);
/// let truth = MassPropertiesLaw::new(
///     normal(12.0, 0.6)?,
///     [normal(0.0, 0.005)?, normal(0.0, 0.005)?, normal(0.1, 0.005)?],
///     TensorLaw::gyration_lengths([normal(0.2, 0.01)?, normal(0.3, 0.01)?, normal(0.5, 0.01)?], UniformAttitude),
/// )?;
/// let mut rng = ChaCha8Rng::seed_from_u64(7);
/// let bodies: Vec<MassProperties> = (0..300).map(|_| truth.sample(&mut rng)).collect();
///
/// let fit = MassPropertiesFit::new(&bodies, MassChoice::default())?;
/// assert!((fit.mass().mean() - 12.0).abs() < 0.15);
/// // The inertia follows the mass: it goes with its first power.
/// let power = fit.ties().unwrap().power();
/// assert!(power.low() < 1.0 && 1.0 < power.high());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, getset::Getters)]
#[getset(get = "pub")]
pub struct MassPropertiesFit {
    /// The mass, kg.
    mass: ScalarFit,
    /// The mass centre, m.
    centre: [ScalarFit; 3],
    /// The inertia of one kilogram: its roots are gyration lengths in m.
    lengths: PrincipalFit,
    #[getset(skip)]
    ties: Option<MassTies>,
    /// The fitted law.
    law: MassPropertiesLaw,
    /// Of the seven scalars that vary, in the coordinates in which their laws are normal.
    #[getset(skip)]
    scores: [Option<Vec<f64>>; SCALARS],
}

/// Which law the mass has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum MassChoice {
    /// Normal, unless the deviation is more than an eighth of the mean, where a normal law would reach zero, or the
    /// lognormal law is likelier at odds of 20 : 1.
    #[default]
    Likelier,
    /// Normal, given that it is positive.
    Normal,
    /// Lognormal.
    Lognormal,
}

impl MassPropertiesFit {
    /// Fits the law to bodies.
    ///
    /// # Errors
    /// As [`PrincipalFit::new`]: at least 13 bodies, none a point; or numbers out of range.
    pub fn new(
        bodies: &[MassProperties],
        choice: MassChoice,
    ) -> Result<Self, MassPropertiesFitError> {
        let one = |(index, body): (usize, &MassProperties)| {
            let one = body.with_mass(1.0);
            one.map(|one| *one.inertia())
                .map_err(|error| MassPropertiesFitError::Body { index, error })
        };
        let inertias = bodies.iter().enumerate().map(one).collect::<Result<Vec<Inertia>, _>>()?;
        let masses: Vec<f64> = bodies.iter().map(MassProperties::mass_kg).collect();
        let count = bodies.len() as f64;
        let mean_mass: f64 = masses.iter().map(|mass| mass / count).sum();
        let length = inertias.iter().map(|i| i.matrix().trace() / count).sum::<f64>().sqrt();
        let lengths = PrincipalFit::told_apart(&inertias, |row| {
            let [x, y, z] = bodies[row].mass_centre_m().into();
            [masses[row] / mean_mass, x / length, y / length, z / length]
        })?;
        // Of one kilogram each, bodies in another unit of mass are like all others.
        if let Some((index, median)) = far_larger(&masses) {
            return Err(MassPropertiesFitError::Large { index, mass_kg: masses[index], median });
        }
        let sums: Vec<f64> = bodies.iter().map(|body| body.inertia().matrix().trace()).collect();
        if let Some((index, median)) = far_larger(&sums) {
            return Err(PrincipalFitError::Large { index, sum: sums[index], median }.into());
        }
        let size = lengths.nominal().second_moments().values().iter().sum::<f64>().sqrt();
        let mass = ScalarFit::of_mass(&masses, choice);
        let columns: [Vec<f64>; 3] =
            std::array::from_fn(|i| bodies.iter().map(|b| b.mass_centre_m()[i]).collect());
        let centre = columns.each_ref().map(|column| ScalarFit::normal(column, size));
        let mut scores: [Option<Vec<f64>>; SCALARS] = std::array::from_fn(|_| None);
        scores[0] = mass.scores(&masses);
        for (i, column) in columns.iter().enumerate() {
            scores[1 + i] = centre[i].scores(column);
        }
        for (k, root) in lengths.roots().iter().enumerate() {
            if root.law() != RootEstimate::Constant && root.mean() >= SIGN_LOST * root.deviation() {
                let score = |x: f64| (x - root.mean()) / root.deviation();
                scores[4 + k] = Some(lengths.sample_roots(k).into_iter().map(score).collect());
            }
        }
        let law = law(&mass, &centre, &lengths, &correlations(&scores))?;
        let ties = MassTies::of(&masses, &inertias, &lengths);
        Ok(Self { mass, centre, lengths, ties, law, scores })
    }

    /// How many bodies were fitted.
    #[must_use]
    pub fn count(&self) -> usize {
        self.lengths.count()
    }

    /// How the inertia goes with the mass; none if the mass does not vary, or the lengths.
    #[must_use]
    pub fn ties(&self) -> Option<&MassTies> {
        self.ties.as_ref()
    }

    /// What was fitted of the axes.
    fn has_free_axes(&self) -> bool {
        self.lengths.axes().finding() == AxesFinding::Free
    }

    /// The scores of mass and mass centre, where these vary.
    fn place_scores(&self) -> Vec<Vec<f64>> {
        self.scores[..4].iter().flatten().cloned().collect()
    }
}

gyradius_dispersion::written!(
    MassPropertiesFit,
    |fit| {
        mass: ScalarFit = fit.mass,
        centre: [ScalarFit; 3] = fit.centre,
        lengths: PrincipalFit = fit.lengths.clone(),
        ties: Option<MassTies> = fit.ties,
        law: MassPropertiesLaw = fit.law.clone(),
        scores: [Option<Vec<f64>>; SCALARS] = fit.scores.clone(),
    },
    {
        let count = lengths.count();
        let of_all = scores.iter().flatten().all(|scores| scores.len() == count);
        let varies = mass.errors().is_some();
        crate::read::belong(of_all && scores[0].is_some() == varies, "fit of bodies")?;
        MassPropertiesFit { mass, centre, lengths, ties, law, scores }
    }
);

/// Correlations of scores; zero where there are none.
fn correlations(scores: &[Option<Vec<f64>>; SCALARS]) -> SMatrix<f64, SCALARS, SCALARS> {
    let standard = |x: &Vec<f64>| -> Vec<f64> {
        let mean = x.iter().sum::<f64>() / x.len() as f64;
        let norm = x.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>().sqrt();
        x.iter().map(|v| (v - mean) / norm).collect()
    };
    let standard: Vec<Option<Vec<f64>>> = scores.iter().map(|x| x.as_ref().map(standard)).collect();
    SMatrix::from_fn(|i, j| match (&standard[i], &standard[j]) {
        (Some(x), Some(y)) => {
            let product: f64 = x.iter().zip(y).map(|(x, y)| x * y).sum();
            if i == j { 1.0 } else { product.clamp(-MOST, MOST) }
        }
        _ => f64::from(u8::from(i == j)),
    })
}

fn law(
    mass: &ScalarFit,
    centre: &[ScalarFit; 3],
    lengths: &PrincipalFit,
    correlations: &SMatrix<f64, SCALARS, SCALARS>,
) -> Result<MassPropertiesLaw, MassPropertiesFitError> {
    let [x, y, z] = centre.each_ref().map(ScalarFit::law);
    let [a, b, c] = lengths.roots().map(|root| ScalarLaw::normal(root.mean(), root.deviation()));
    let tensor = TensorLaw::gyration_lengths([a?, b?, c?], lengths.axes().law().clone());
    let law = MassPropertiesLaw::new(mass.law()?, [x?, y?, z?], tensor)?;
    let pairs: Vec<(JointScalar, JointScalar, f64)> = (0..SCALARS)
        .flat_map(|i| (0..i).map(move |j| (i, j)))
        .map(|(i, j)| (JointScalar::ALL[i], JointScalar::ALL[j], correlations[(i, j)]))
        .filter(|(.., coefficient)| *coefficient != 0.0)
        .collect();
    Ok(law.with_correlation(&pairs)?)
}

impl MassPropertiesFitError {
    /// The place, from 0, of the body that is refused, where it is one.
    #[must_use]
    pub fn body(&self) -> Option<usize> {
        match self {
            Self::Body { index, .. } | Self::Large { index, .. } => Some(*index),
            Self::Principal(error) => error.sample(),
            Self::Scalar(_) | Self::Law(_) => None,
        }
    }
}

/// Why bodies have no [`MassPropertiesFit`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MassPropertiesFitError {
    /// A body of one kilogram is out of range.
    #[error("body {} of one kilogram: {error}", index + 1)]
    Body {
        /// Its place, from 0.
        index: usize,
        /// Why.
        error: MassPropertiesError,
    },
    /// A body is so heavy beside the others that the law of all would be about nothing but this one.
    #[error(
        "body {}: its mass is {mass_kg:.3e} kg, {:.1e} times the median of the bodies; a fit allows up to {LARGER} times: the \
         body has another unit, or a slip of the decimal point",
        index + 1, mass_kg / median
    )]
    Large {
        /// Its place, from 0.
        index: usize,
        /// Its mass, kg.
        mass_kg: f64,
        /// The median of the masses of all bodies, kg.
        median: f64,
    },
    /// The inertias have no fit.
    #[error(transparent)]
    Principal(#[from] PrincipalFitError),
    /// A scalar has no law.
    #[error(transparent)]
    Scalar(#[from] ScalarLawError),
    /// The parts make no joint law.
    #[error(transparent)]
    Law(#[from] MassPropertiesLawError),
}
