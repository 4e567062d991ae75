//! Any law of roots, chosen at run time.

use gyradius_inertia::RootSecondMoments;
use rand::Rng;
use rand_distr::Distribution;

use crate::{CorrelatedRoots, EmpiricalRoots, RootMoments, ScalarRoots, SecondMomentStatistics};

/// Any of the laws of roots that this crate has, chosen at run time.
///
/// Draws are those of the law inside, bit for bit.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(tag = "law", rename_all = "kebab-case")
)]
pub enum RootLaw {
    /// Independent, each with a scalar law.
    Independent(ScalarRoots),
    /// Jointly Gaussian.
    CorrelatedGaussian(CorrelatedRoots),
    /// Observed triples.
    Empirical(EmpiricalRoots),
}

macro_rules! each {
    ($self:expr, $law:ident => $body:expr) => {
        match $self {
            RootLaw::Independent($law) => $body,
            RootLaw::CorrelatedGaussian($law) => $body,
            RootLaw::Empirical($law) => $body,
        }
    };
}

impl RootMoments for RootLaw {
    fn second_moment_statistics(&self) -> SecondMomentStatistics {
        each!(self, law => law.second_moment_statistics())
    }

    fn ln_density_of_squares(&self, second_moments: [f64; 3]) -> Option<f64> {
        each!(self, law => law.ln_density_of_squares(second_moments))
    }

    fn ln_densities_in_orders(&self, second_moments: [f64; 3]) -> Option<[f64; 6]> {
        each!(self, law => law.ln_densities_in_orders(second_moments))
    }
}

impl Distribution<RootSecondMoments> for RootLaw {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> RootSecondMoments {
        each!(self, law => law.sample(rng))
    }
}

macro_rules! from {
    ($($variant:ident($law:ty)),*) => {$(
        impl From<$law> for RootLaw {
            fn from(law: $law) -> Self {
                Self::$variant(law)
            }
        }
    )*};
}
from!(Independent(ScalarRoots), CorrelatedGaussian(CorrelatedRoots), Empirical(EmpiricalRoots));

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    #[test]
    fn draws_are_those_of_the_law_inside() {
        let mean = RootSecondMoments::new([1.0, 2.0, 3.0]).unwrap();
        let inside = ScalarRoots::normal(mean, [0.1; 3]).unwrap();
        let law = RootLaw::from(inside.clone());
        let mut rngs = [1, 1].map(ChaCha8Rng::seed_from_u64);
        for _ in 0..100 {
            assert_eq!(law.sample(&mut rngs[0]), inside.sample(&mut rngs[1]));
        }
    }

    #[cfg(feature = "serde")]
    #[test]
    fn serde_keeps_the_law_and_its_name() {
        let mean = RootSecondMoments::new([1.0, 2.0, 3.0]).unwrap();
        let law = RootLaw::from(ScalarRoots::uniform(mean, [0.1; 3]).unwrap());
        let json = serde_json::to_string(&law).unwrap();
        assert!(json.contains(r#""law":"independent""#), "{json}");
        assert_eq!(serde_json::from_str::<RootLaw>(&json).unwrap(), law);
    }
}
