//! Any law of roots, chosen at run time.

use gyradius_inertia::RootSecondMoments;
use rand::Rng;
use rand_distr::Distribution;

use crate::any_of::any_of;
use crate::{
    CorrelatedRoots, EmpiricalRoots, RootMoments, ScalarLaw, ScalarRoots, SecondMomentStatistics,
};

/// Any of the laws of roots that this crate has, chosen at run time.
///
/// Draws are those of the law inside, bit for bit.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "law", rename_all = "kebab-case"))]
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

impl RootLaw {
    /// How often each root comes out negative. Its square alone matters, so that this share of its law is folded about zero,
    /// and the root's absolute value has another mean and deviation than were stated.
    ///
    /// ```
    /// use gyradius_dispersion::{RootLaw, ScalarLaw, ScalarRoots};
    ///
    /// let [thick, thin] = [ScalarLaw::normal(3.0, 0.1)?, ScalarLaw::uniform(-0.1, 0.3)?];
    /// let law = RootLaw::from(ScalarRoots::new([thick.clone(), thick, thin])?);
    /// let [a, b, c] = law.folded_shares();
    /// assert!(a < 1e-9 && b < 1e-9 && (c - 0.25).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn folded_shares(&self) -> [f64; 3] {
        match self {
            Self::Independent(law) => law.laws().each_ref().map(ScalarLaw::share_below_zero),
            Self::CorrelatedGaussian(law) => {
                let (mean, covariance) = (law.mean().values(), law.covariance());
                std::array::from_fn(|i| {
                    let normal = ScalarLaw::normal(mean[i], covariance[(i, i)].max(0.0).sqrt());
                    normal.map_or(0.0, |law| law.share_below_zero())
                })
            }
            Self::Empirical(law) => {
                let samples = law.samples();
                let below = |i: usize| samples.iter().filter(|k| k.values()[i] < 0.0).count();
                std::array::from_fn(|i| below(i) as f64 / samples.len().max(1) as f64)
            }
        }
    }
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

any_of!(
    RootLaw:
    Independent(ScalarRoots),
    CorrelatedGaussian(CorrelatedRoots),
    Empirical(EmpiricalRoots),
);

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

    /// Those of the draws: what is negative of them is folded.
    #[test]
    fn folded_shares_are_those_of_the_draws() {
        let scalars = [
            ScalarLaw::normal(1.0, 0.8).unwrap(),
            ScalarLaw::normal(0.0, 0.0).unwrap(),
            ScalarLaw::uniform(-1.0, 3.0).unwrap(),
            ScalarLaw::lognormal(1.0, 2.0).unwrap(),
            ScalarLaw::triangular(-2.0, 0.5, 1.0).unwrap(),
            ScalarLaw::samples(&[-1.0, 0.0, 2.0, -3.0]).unwrap(),
        ];
        let covariance = nalgebra::Matrix3::new(1.0, 0.3, 0.0, 0.3, 4.0, 0.1, 0.0, 0.1, 0.2);
        let mean = RootSecondMoments::new([0.5, 2.0, -1.0]).unwrap();
        let correlated = CorrelatedRoots::new(mean, covariance).unwrap();
        let triples = [[1.0, -1.0, 2.0], [-2.0, -0.0, 3.0], [0.5, -4.0, 1.0]];
        let mut laws: Vec<RootLaw> =
            vec![correlated.into(), EmpiricalRoots::from_values(&triples).unwrap().into()];
        for i in 0..scalars.len() {
            let of = |k: usize| scalars[(i + k) % scalars.len()].clone();
            laws.push(ScalarRoots::new([of(0), of(1), of(2)]).unwrap().into());
        }
        let n = 20_000;
        for (seed, law) in laws.into_iter().enumerate() {
            let mut rng = ChaCha8Rng::seed_from_u64(seed as u64);
            let draws: Vec<[f64; 3]> = (0..n).map(|_| law.sample(&mut rng).values()).collect();
            for (i, share) in law.folded_shares().into_iter().enumerate() {
                let found = draws.iter().filter(|k| k[i] < 0.0).count() as f64 / f64::from(n);
                let error = (share * (1.0 - share) / f64::from(n)).sqrt();
                assert!((found - share).abs() <= 4.5 * error, "{law:?} {i}: {found} {share}");
            }
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
