//! Random principal moments about random principal axes.

use gyradius_inertia::{Inertia, InertiaMatrix, RootSecondMoments};
use nalgebra::UnitQuaternion;
use rand::Rng;
use rand_distr::Distribution;
use std::{borrow::Cow, fmt::Debug};

use crate::density_of_entries::{Bounded, ln_density_of_bounded};
use crate::{AttitudeMoments, EntryMoments, InertiaLaw, KnownMoments, ModelDraw, RootMoments};

/// What it is called.
pub(crate) const NAME: &str = "principal";

/// Random principal moments about random principal axes, independent of each other (Peck 2003).
///
/// # Definition
/// Roots k of the second mass moments from the law `K`, the attitude q that takes body components
/// to principal components from the law `A`; then K_k = k_k², I₁ = K₂ + K₃ and so on (Eq. 11), and
/// I_B = R(q)ᵀ I_P R(q).
///
/// # Realizability
/// By construction, for any laws: squares are not negative.
#[derive(Clone, Copy, Debug, PartialEq, getset::Getters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
#[getset(get = "pub")]
pub struct PrincipalDispersion<K, A> {
    /// The law of the roots.
    roots: K,
    /// The law of the axes.
    axes: A,
}

/// A draw with what it was made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrincipalDraw {
    /// The inertia in body axes.
    pub inertia: Inertia,
    /// Roots of the second mass moments.
    pub roots: RootSecondMoments,
    /// The attitude that takes body components to principal components, as drawn.
    pub axes: UnitQuaternion<f64>,
}

crate::written!(
    PrincipalDraw,
    |draw| {
        inertia: Inertia = draw.inertia,
        roots: RootSecondMoments = draw.roots,
        axes: [f64; 4] = draw.axes.coords.into(),
    },
    PrincipalDraw { inertia, roots, axes: crate::axes::unit(axes)? }
);

impl<K, A> PrincipalDispersion<K, A> {
    /// From a law of the roots and a law of the axes.
    pub fn new(roots: K, axes: A) -> Self {
        Self { roots, axes }
    }

    /// The law of the roots and the law of the axes.
    pub fn into_parts(self) -> (K, A) {
        (self.roots, self.axes)
    }
}

impl<K, A> Distribution<PrincipalDraw> for PrincipalDispersion<K, A>
where
    K: Distribution<RootSecondMoments>,
    A: Distribution<UnitQuaternion<f64>>,
{
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> PrincipalDraw {
        loop {
            let roots = self.roots.sample(rng);
            let axes = self.axes.sample(rng);
            // Refused only if the law of the axes yields something that is no attitude.
            if let Ok(inertia) = Inertia::from_second_moments(roots.squared(), &axes) {
                return PrincipalDraw { inertia, roots, axes };
            }
        }
    }
}

impl<K, A> Distribution<Inertia> for PrincipalDispersion<K, A>
where
    K: Distribution<RootSecondMoments>,
    A: Distribution<UnitQuaternion<f64>>,
{
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> Inertia {
        // The same draws, without the parts being written down.
        loop {
            let moments = self.roots.sample(rng).squared();
            let axes = self.axes.sample(rng);
            if let Ok(inertia) = Inertia::from_second_moments(moments, &axes) {
                return inertia;
            }
        }
    }
}

impl From<PrincipalDraw> for ModelDraw {
    fn from(draw: PrincipalDraw) -> Self {
        Self { inertia: draw.inertia.into(), axes: Some(draw.axes) }
    }
}

impl<K, A> InertiaLaw for PrincipalDispersion<K, A>
where
    K: RootMoments + Distribution<RootSecondMoments> + Debug + Send + Sync,
    A: AttitudeMoments + Distribution<UnitQuaternion<f64>> + Debug + Send + Sync,
{
    fn name(&self) -> Cow<'_, str> {
        NAME.into()
    }

    fn draw(&self, rng: &mut dyn Rng) -> ModelDraw {
        let draw: PrincipalDraw = self.sample(rng);
        draw.into()
    }

    fn is_realizable_by_construction(&self) -> bool {
        true
    }

    fn has_independent_axes(&self) -> bool {
        true
    }

    fn expected_moments(&self) -> Option<EntryMoments> {
        Some(EntryMoments::of(self))
    }

    fn ln_density(&self, inertia: &InertiaMatrix) -> Option<f64> {
        self.ln_density(inertia)
    }
}

impl<K: RootMoments, A: AttitudeMoments> PrincipalDispersion<K, A> {
    /// The logarithm of the density of the entries I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃ in kg·m². None where the roots or the
    /// axes have no density; −∞ of a matrix that no body has.
    ///
    /// An inertia does not say which axis is which: the density is the sum over the 24 ways to name and point its
    /// principal axes, over the product of the differences of its second moments. It is infinite where two of them are
    /// equal and their laws not zero there, and loses as many digits as their difference has lost.
    #[must_use]
    pub fn ln_density(&self, inertia: &InertiaMatrix) -> Option<f64> {
        // Whether there are densities does not depend on where.
        self.axes.ln_density_of_attitude(&UnitQuaternion::identity())?;
        let Ok(body) = Inertia::try_from(*inertia) else {
            return self.roots.ln_densities_in_orders([1.0; 3]).map(|_| f64::NEG_INFINITY);
        };
        let mut known = true;
        let found = ln_density_of_bounded(
            &body,
            |k| {
                let densities = self.roots.ln_densities_in_orders(k);
                known = densities.is_some();
                densities.unwrap_or([f64::NEG_INFINITY; 6])
            },
            Bounded {
                density: |q: &_| self.axes.ln_density_of_attitude(q).unwrap_or(f64::NEG_INFINITY),
                at_most: self.axes.ln_density_at_most(),
            },
        );
        known.then_some(found)
    }
}

impl EntryMoments {
    /// Of any roots with known moments about axes from any law with known moments, by quadrature.
    #[must_use]
    pub fn of<K: RootMoments, A: AttitudeMoments>(law: &PrincipalDispersion<K, A>) -> Self {
        law.axes().entry_moments(&law.roots().second_moment_statistics())
    }
}

impl<K: RootMoments, A: AttitudeMoments> KnownMoments for PrincipalDispersion<K, A> {
    fn entry_moments(&self) -> EntryMoments {
        EntryMoments::of(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ScalarRoots;
    use gyradius_attitude::UniformAttitude;
    use proptest::prelude::*;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    proptest! {
        #[test]
        fn no_draw_is_unrealizable(
            k in prop::array::uniform3(0.0..100.0f64),
            variances in prop::array::uniform3(0.0..1e4f64),
            seed in 0..u64::MAX,
        ) {
            let roots = ScalarRoots::normal(RootSecondMoments::new(k).unwrap(), variances).unwrap();
            let law = PrincipalDispersion::new(roots, UniformAttitude);
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            for _ in 0..100 {
                let body: Inertia = law.sample(&mut rng);
                prop_assert!(body.as_inertia_matrix().is_realizable());
            }
        }
    }

    #[test]
    fn a_draw_is_made_of_its_parts() {
        let roots = ScalarRoots::normal(RootSecondMoments::new([1.0, 2.0, 3.0]).unwrap(), [0.1; 3])
            .unwrap();
        let law = PrincipalDispersion::new(roots, UniformAttitude);
        let draw: PrincipalDraw = law.sample(&mut ChaCha8Rng::seed_from_u64(1));
        let again =
            Inertia::from_principal_moments(draw.roots.squared().principal_moments(), &draw.axes);
        assert!((draw.inertia.matrix() - again.unwrap().matrix()).amax() < 1e-13);
        let alone: Inertia = law.sample(&mut ChaCha8Rng::seed_from_u64(1));
        assert_eq!(alone, draw.inertia);
    }
}
