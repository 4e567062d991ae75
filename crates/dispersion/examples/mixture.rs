//! A law of inertia of one's own: a body that is built in two variants, and nobody knows which will fly.

use std::borrow::Cow;

use gyradius_dispersion::{EntryMoments, EntryMomentsError, InertiaLaw, ModelDraw, Wishart};
use gyradius_inertia::{Inertia, InertiaMatrix};
use nalgebra::{SMatrix, SVector};
use rand::{Rng, RngExt};
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

/// One variant or the other, each with a law of its own.
#[derive(Debug)]
pub(crate) struct Mixture {
    /// The probability of the first.
    share: f64,
    variants: [Box<dyn InertiaLaw>; 2],
}

impl Mixture {
    /// Of two laws; none if the share of the first is no probability.
    pub(crate) fn new(share: f64, variants: [Box<dyn InertiaLaw>; 2]) -> Option<Self> {
        (0.0..=1.0).contains(&share).then_some(Self { share, variants })
    }

    /// E I = Σ w_v m_v and Cov I = Σ w_v (C_v + m_v m_vᵀ) − E I E Iᵀ, with the last two put together as the
    /// difference of the means, so that no digits are lost.
    fn moments(
        &self,
        a: &EntryMoments,
        b: &EntryMoments,
    ) -> Result<EntryMoments, EntryMomentsError> {
        let (p, q) = (self.share, 1.0 - self.share);
        let [m, n] = [a, b].map(|moments| SVector::<f64, 6>::from(moments.mean()));
        let apart: SMatrix<f64, 6, 6> = (m - n) * (m - n).transpose();
        let covariance = a.covariance() * p + b.covariance() * q + apart * (p * q);
        EntryMoments::new((m * p + n * q).into(), covariance)
    }
}

impl InertiaLaw for Mixture {
    fn name(&self) -> Cow<'_, str> {
        "mixture".into()
    }

    fn draw(&self, rng: &mut dyn Rng) -> ModelDraw {
        let first = rng.random::<f64>() < self.share;
        self.variants[usize::from(!first)].draw(rng)
    }

    fn is_realizable_by_construction(&self) -> bool {
        self.variants.iter().all(|law| law.is_realizable_by_construction())
    }

    fn expected_moments(&self) -> Option<EntryMoments> {
        let [a, b] = &self.variants;
        self.moments(&a.expected_moments()?, &b.expected_moments()?).ok()
    }
}

/// A satellite with full tanks, or one with half of the propellant.
pub(crate) fn satellite() -> Result<Mixture, Box<dyn std::error::Error>> {
    let variant = |moments, products| -> Result<Box<dyn InertiaLaw>, Box<dyn std::error::Error>> {
        let mean = InertiaMatrix::from_entries(moments, products)?;
        Ok(Box::new(Wishart::new(Inertia::try_from(mean)?, 0.05)?))
    };
    let full = variant([5000.0, 4000.0, 3000.0], [20.0, 2.0, -50.0])?;
    let half = variant([4600.0, 3500.0, 2900.0], [10.0, 2.0, -40.0])?;
    Mixture::new(0.7, [full, half]).ok_or_else(|| "no probability".into())
}

#[allow(dead_code, reason = "the test of this example has no use for it")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let law = satellite()?;
    let mut rng = ChaCha8Rng::seed_from_u64(2003);
    for _ in 0..5 {
        let [i11, i22, i33, ..] = law.draw(&mut rng).inertia.entries();
        println!("I11 {i11:6.0}  I22 {i22:6.0}  I33 {i33:6.0} kg·m²");
    }
    let moments = law.expected_moments().ok_or("the moments of a variant are not known")?;
    println!("mean        {:.0?} kg·m²", moments.mean());
    println!("deviations  {:.0?} kg·m²", moments.deviations());
    Ok(())
}
