//! Independent roots of the second mass moments, of any laws.

use gyradius_inertia::RootSecondMoments;
use rand::{Rng, SeedableRng, rngs::Xoshiro256PlusPlus};
use rand_distr::Distribution;

/// Why laws are refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IndependentRootsError {
    /// Most trial draws are no roots.
    #[error(
        "law of k_{axis}: {bad} of {TRIALS} trial draws are NaN, infinite or beyond 1e150 √kg·m, \
         {example:?} for one; at least half must be roots"
    )]
    Law {
        /// Axis, from 1.
        axis: usize,
        /// How many draws.
        bad: usize,
        /// The first of them.
        example: f64,
    },
}

const TRIALS: usize = 64;

/// Independent roots k_k = √K_k from any laws of real numbers.
///
/// # Definition
/// k₁, k₂, k₃ from three laws, in √kg·m, of any sign; only their squares matter. Draws that are no
/// roots (NaN, infinite, or with a square that overflows) are drawn again, all three.
///
/// # Limits
/// This crate does not know the moments of the squares: where
/// [`EntryMoments`](crate::EntryMoments) are wanted, attach them by
/// [`WithMoments`](crate::WithMoments). A law that turns from roots to none after construction would be
/// drawn for ever.
///
/// ```
/// use gyradius_dispersion::{IndependentRoots, PrincipalDispersion};
/// use gyradius_attitude::UniformAttitude;
/// use gyradius_inertia::Inertia;
/// use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
/// use rand_distr::{Distribution, Triangular};
///
/// let law = |low, high, mode| Triangular::new(low, high, mode);
/// let roots = IndependentRoots::new([law(9.0, 12.0, 10.0)?, law(8.0, 9.0, 8.5)?, law(1.0, 2.0, 1.1)?])?;
/// let law = PrincipalDispersion::new(roots, UniformAttitude);
/// let body: Inertia = law.sample(&mut ChaCha8Rng::seed_from_u64(1));
/// assert!(body.second_moments().values()[0] <= 144.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, getset::Getters)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "[L; 3]", into = "[L; 3]"),
    serde(bound(serialize = "L: Clone + serde::Serialize")),
    serde(bound(deserialize = "L: Distribution<f64> + serde::Deserialize<'de>"))
)]
#[getset(get = "pub")]
pub struct IndependentRoots<L> {
    /// The three laws.
    laws: [L; 3],
}

impl<L: Distribution<f64>> IndependentRoots<L> {
    /// From the laws of k₁, k₂ and k₃ in √kg·m. For laws of different types use an enum.
    ///
    /// # Errors
    /// More than half of 64 trial draws of a law are no roots.
    pub fn new(laws: [L; 3]) -> Result<Self, IndependentRootsError> {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(0);
        for (i, law) in laws.iter().enumerate() {
            let bad: Vec<f64> = (0..TRIALS)
                .map(|_| law.sample(&mut rng))
                .filter(|k| RootSecondMoments::new([*k, 0.0, 0.0]).is_err())
                .collect();
            if let Some(&example) = bad.first()
                && 2 * bad.len() > TRIALS
            {
                return Err(IndependentRootsError::Law { axis: i + 1, bad: bad.len(), example });
            }
        }
        Ok(Self { laws })
    }
}

impl<L: Distribution<f64>> TryFrom<[L; 3]> for IndependentRoots<L> {
    type Error = IndependentRootsError;

    fn try_from(laws: [L; 3]) -> Result<Self, Self::Error> {
        Self::new(laws)
    }
}

impl<L> From<IndependentRoots<L>> for [L; 3] {
    fn from(roots: IndependentRoots<L>) -> Self {
        roots.laws
    }
}

impl<L: Distribution<f64>> Distribution<RootSecondMoments> for IndependentRoots<L> {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> RootSecondMoments {
        loop {
            let draw = std::array::from_fn(|i| self.laws[i].sample(rng));
            if let Ok(roots) = RootSecondMoments::new(draw) {
                return roots;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{RootMoments, ScalarRoots, WithMoments, root_moments::tests::check_moments};
    use rand_distr::Normal;

    #[test]
    fn a_users_law_is_as_good_as_ours() {
        let normal = |mean, deviation| Normal::new(mean, deviation).unwrap();
        let roots =
            IndependentRoots::new([normal(3.0, 0.5), normal(1.0, 1.0), normal(0.0, 2.0)]).unwrap();
        let mean = RootSecondMoments::new([3.0, 1.0, 0.0]).unwrap();
        let ours = ScalarRoots::normal(mean, [0.25, 1.0, 4.0]).unwrap();
        check_moments(&WithMoments::new(roots, ours.second_moment_statistics()), 51);
    }

    #[test]
    fn laws_that_yield_no_roots_are_refused() {
        struct Constant(f64);
        impl Distribution<f64> for Constant {
            fn sample<R: Rng + ?Sized>(&self, _: &mut R) -> f64 {
                self.0
            }
        }
        for bad in [f64::NAN, f64::INFINITY, -1e200] {
            let laws = [Constant(1.0), Constant(bad), Constant(1.0)];
            let error = IndependentRoots::new(laws).err().unwrap();
            assert!(error.to_string().contains("k_2"), "{error}");
        }
    }

    /// A fair share of bad draws is drawn again.
    #[test]
    fn now_and_then_a_bad_draw_does_no_harm() {
        let heavy = rand_distr::Cauchy::new(0.0, 1e151).unwrap();
        let law = IndependentRoots::new([heavy; 3]).unwrap();
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
        for _ in 0..1000 {
            assert!(law.sample(&mut rng).squared().values().iter().all(|k| k.is_finite()));
        }
    }
}
