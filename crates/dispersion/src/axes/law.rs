//! A law of principal axes that is chosen at run time.

use gyradius_attitude::{
    AboutAxis, FisherBingham, MeanHalf, RadiallyConstrainedGaussian, UniformAttitude,
};
use nalgebra::UnitQuaternion;
use rand::Rng;
use rand_distr::Distribution;

use crate::any_of::any_of;
use crate::{AttitudeMoments, EntryMoments, FixedAttitude, JacobianTwice, SecondMomentStatistics};

/// Any of the laws of principal axes with known moments, chosen at run time.
///
/// Draws are those of the law inside, bit for bit.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "law", rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum AxesLaw {
    /// A radially constrained Gaussian on the whole sphere, both lobes.
    WholeSphere(RadiallyConstrainedGaussian),
    /// The same kept to the half sphere around its mean.
    MeanHalf(MeanHalf),
    /// The law behind Table 2 of Peck (2003).
    JacobianTwice(Box<JacobianTwice>),
    /// Every attitude equally likely.
    Uniform(UniformAttitude),
    /// One attitude.
    Fixed(FixedAttitude),
    /// A Fisher-Bingham law, whatever its form is.
    FisherBingham(Box<FisherBingham>),
    /// Every turn about a known axis equally likely.
    AboutAxis(AboutAxis),
}

macro_rules! each {
    ($self:expr, $law:ident => $body:expr) => {
        match $self {
            AxesLaw::WholeSphere($law) => $body,
            AxesLaw::MeanHalf($law) => $body,
            AxesLaw::JacobianTwice($law) => $body,
            AxesLaw::Uniform($law) => $body,
            AxesLaw::Fixed($law) => $body,
            AxesLaw::FisherBingham($law) => $body,
            AxesLaw::AboutAxis($law) => $body,
        }
    };
}

impl AttitudeMoments for AxesLaw {
    fn entry_moments(&self, k: &SecondMomentStatistics) -> EntryMoments {
        each!(self, law => law.entry_moments(k))
    }

    fn expected_forms(&self) -> [[f64; 6]; 3] {
        each!(self, law => law.expected_forms())
    }

    fn ln_density_of_attitude(&self, attitude: &UnitQuaternion<f64>) -> Option<f64> {
        each!(self, law => law.ln_density_of_attitude(attitude))
    }

    fn ln_density_at_most(&self) -> f64 {
        each!(self, law => law.ln_density_at_most())
    }
}

impl Distribution<UnitQuaternion<f64>> for AxesLaw {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> UnitQuaternion<f64> {
        each!(self, law => law.sample(rng))
    }
}

any_of!(
    AxesLaw:
    WholeSphere(RadiallyConstrainedGaussian),
    MeanHalf(MeanHalf),
    JacobianTwice(JacobianTwice),
    Uniform(UniformAttitude),
    Fixed(FixedAttitude),
    FisherBingham(FisherBingham),
    AboutAxis(AboutAxis),
);
