//! A model of entries, conditioned on realizability.

use gyradius_inertia::{Inertia, InertiaMatrix};
use rand::{Rng, SeedableRng, rngs::Xoshiro256PlusPlus};
use rand_distr::Distribution;
use std::borrow::Cow;

use crate::named_model::{NamedModel, NoMatch};
use crate::{EntryMoments, InertiaLaw, ModelDraw, ModelParameterError, ModelParameters};

/// Trial draws, and how many of them must be bodies: fewer, and a draw costs more than a thousand.
const TRIALS: u32 = 20_000;
const ENOUGH: u32 = 20;

/// Why a law cannot be kept to realizable draws.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RealizableOnlyError {
    /// Next to no draw is a body.
    #[error(
        "{realizable} of {TRIALS} trial draws are realizable: rejection would take for ever, and at \
         least {ENOUGH} are needed; the mean is too far outside the realizable set or the spread too \
         wide"
    )]
    Hopeless {
        /// Trial draws that were realizable.
        realizable: u32,
    },
}

/// A law of matrices, conditioned on being realizable by rejection.
///
/// # Definition
/// The law `L` given that Σ = ½ tr(I)·1 − I ⪰ 0: density over the probability of that, inside the
/// realizable set; zero outside.
///
/// # Realizability
/// By construction: draws are [`Inertia`].
///
/// # Limits
/// Conditioning changes the law: means move away from the boundary and deviations shrink, the more the
/// smaller the [`acceptance`](Self::acceptance). No moments in closed form. Acceptance is
/// estimated from 20,000 trial draws with a fixed seed, fewer than 20 of which are refused.
///
/// ```
/// use gyradius_dispersion::{EntrywiseGaussian, RealizableOnly};
/// use gyradius_inertia::InertiaMatrix;
///
/// let slender = InertiaMatrix::from_entries([2000.0, 15000.0, 15500.0], [0.0; 3])?;
/// let law = RealizableOnly::new(EntrywiseGaussian::new(slender, [200.0, 1500.0, 1500.0, 0.0, 0.0, 0.0])?)?;
/// // A third of the draws of the law inside belongs to no body.
/// assert!(law.acceptance() > 0.6 && law.acceptance() < 0.7);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, getset::Getters)]
pub struct RealizableOnly<L> {
    /// The law before conditioning.
    #[getset(get = "pub")]
    law: L,
    realizable: u32,
}

impl<L: Distribution<InertiaMatrix>> RealizableOnly<L> {
    /// Conditions a law.
    ///
    /// # Errors
    /// Fewer than 20 of 20,000 trial draws are realizable.
    pub fn new(law: L) -> Result<Self, RealizableOnlyError> {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(0);
        let realizable = (0..TRIALS).map(|_| u32::from(law.sample(&mut rng).is_realizable())).sum();
        if realizable < ENOUGH {
            return Err(RealizableOnlyError::Hopeless { realizable });
        }
        Ok(Self { law, realizable })
    }
}

impl<L> RealizableOnly<L> {
    /// The estimated share of draws that are kept.
    #[must_use]
    pub fn acceptance(&self) -> f64 {
        f64::from(self.realizable) / f64::from(TRIALS)
    }

    /// The standard error of that estimate.
    #[must_use]
    pub fn acceptance_error(&self) -> f64 {
        let p = self.acceptance();
        (p * (1.0 - p) / f64::from(TRIALS)).sqrt()
    }

    /// The standard error of the logarithm of the density, which comes of the estimated acceptance alone and is the same
    /// for every inertia: it leaves ratios of densities under this law as they are.
    #[must_use]
    pub fn ln_density_error(&self) -> f64 {
        self.acceptance_error() / self.acceptance()
    }
}

impl<L: Distribution<InertiaMatrix>> Distribution<Inertia> for RealizableOnly<L> {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> Inertia {
        loop {
            if let Ok(inertia) = Inertia::try_from(self.law.sample(rng)) {
                return inertia;
            }
        }
    }
}

/// Of any law: impossible draws are drawn again.
impl<L: InertiaLaw + Distribution<InertiaMatrix>> InertiaLaw for RealizableOnly<L> {
    fn name(&self) -> Cow<'_, str> {
        format!("realizable-{}", self.law().name()).into()
    }

    fn draw(&self, rng: &mut dyn Rng) -> ModelDraw {
        let draw: Inertia = self.sample(rng);
        draw.into()
    }

    fn is_realizable_by_construction(&self) -> bool {
        true
    }

    fn expected_moments(&self) -> Option<EntryMoments> {
        None
    }

    fn acceptance(&self) -> Option<f64> {
        Some(self.acceptance())
    }

    /// That of the law inside over the acceptance, which is an estimate:
    /// [`ln_density_error`](Self::ln_density_error) says how good.
    fn ln_density(&self, inertia: &InertiaMatrix) -> Option<f64> {
        let inside = self.law.ln_density(inertia)?;
        let is_kept = Inertia::try_from(*inertia).is_ok();
        Some(if is_kept { inside - libm::log(self.acceptance()) } else { f64::NEG_INFINITY })
    }
}

/// A model of entries that has a name of its own when it is conditioned.
pub(crate) trait Conditionable: NamedModel + Distribution<InertiaMatrix> {
    /// Its name then, in kebab case.
    const CONDITIONED_NAME: &'static str;
    /// What it is then, in a line.
    const CONDITIONED_DESCRIPTION: &'static str;
    /// Which of given moments it has before draws are rejected.
    const BEFORE_REJECTION: &'static str;
}

/// The model inside in everything but its name and what becomes of draws that no body has.
impl<L: Conditionable> NamedModel for RealizableOnly<L> {
    const NAME: &'static str = L::CONDITIONED_NAME;
    const DESCRIPTION: &'static str = L::CONDITIONED_DESCRIPTION;
    const IS_REALIZABLE: bool = true;
    const NEEDS: &'static [&'static str] = L::NEEDS;

    fn defaults() -> ModelParameters {
        L::defaults()
    }

    fn about(nominal: &Inertia, given: &ModelParameters) -> Result<Self, ModelParameterError> {
        let spread = L::NEEDS.first().copied().unwrap_or("law");
        Self::new(L::about(nominal, given)?).map_err(|e| ModelParameterError::new(spread, &e))
    }

    fn matched(
        mean: InertiaMatrix,
        moments: &EntryMoments,
    ) -> Result<(Self, &'static str), NoMatch> {
        Ok((Self::new(L::matched(mean, moments)?.0)?, L::BEFORE_REJECTION))
    }
}

#[cfg(feature = "serde")]
mod form {
    use super::{Distribution, InertiaMatrix, RealizableOnly};
    use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

    impl<L: Serialize> Serialize for RealizableOnly<L> {
        fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
            self.law.serialize(to)
        }
    }

    impl<'de, L: Deserialize<'de> + Distribution<InertiaMatrix>> Deserialize<'de>
        for RealizableOnly<L>
    {
        fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
            Self::new(L::deserialize(from)?).map_err(D::Error::custom)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::EntrywiseGaussian;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    fn slender(deviation: f64) -> EntrywiseGaussian {
        let mean = InertiaMatrix::from_entries([2.0, 15.0, 15.5], [0.0; 3]).unwrap();
        EntrywiseGaussian::new(mean, [deviation; 6]).unwrap()
    }

    #[test]
    fn it_is_the_law_given_that_draws_are_bodies() {
        const N: usize = 50_000;
        let law = RealizableOnly::new(slender(0.5)).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(91);
        let mean = |draws: &[[f64; 6]]| {
            let n = draws.len() as f64;
            let mean = draws.iter().map(|d| d[0]).sum::<f64>() / n;
            let variance = draws.iter().map(|d| (d[0] - mean).powi(2)).sum::<f64>() / n;
            (mean, variance / n)
        };
        let kept: Vec<[f64; 6]> = (0..N)
            .map(|_| law.sample(&mut rng))
            .inspect(|body| assert!(body.as_inertia_matrix().is_realizable()))
            .map(|body| body.entries())
            .collect();
        let all: Vec<InertiaMatrix> = (0..N).map(|_| law.law().sample(&mut rng)).collect();
        let sieved: Vec<[f64; 6]> =
            all.iter().filter(|m| m.is_realizable()).map(InertiaMatrix::entries).collect();
        let ((a, va), (b, vb)) = (mean(&kept), mean(&sieved));
        assert!(((a - b) / (va + vb).sqrt()).abs() < 4.0, "{a} {b}");
        // Negative control: conditioning has moved the mean from 2.
        assert!(a - 2.0 > 20.0 * va.sqrt(), "{a}");

        let share = sieved.len() as f64 / N as f64;
        let error = law.acceptance_error() * (1.0 + 20_000.0 / N as f64).sqrt();
        assert!(((share - law.acceptance()) / error).abs() < 4.0, "{share}");
    }

    #[test]
    fn hopeless_laws_are_refused() {
        let mean = InertiaMatrix::from_entries([1.0, 1.0, 9.0], [0.0; 3]).unwrap();
        let law = EntrywiseGaussian::new(mean, [0.1; 6]).unwrap();
        let error = RealizableOnly::new(law).unwrap_err();
        assert!(error.to_string().contains("0 of 20000"), "{error}");
    }
}
