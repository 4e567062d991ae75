//! The law of maximum entropy of mass, mass centre and inertia: a rival of the joint law.

use gyradius_inertia::{Inertia, MassProperties, Region};
use nalgebra::{SMatrix, SVector, Vector3};
use rand::{Rng, SeedableRng, rngs::Xoshiro256PlusPlus};
use rand_distr::{Distribution, Gamma, StandardNormal};
use std::f64::consts::PI;

use super::inside::{Inside, RegionAcceptanceError};
use super::model::draws_bodies;
use super::{MassPropertiesModel, TenMoments};
use crate::{KnownMoments, Wishart, WishartError};

/// The dispersion of a mass: its standard deviation over its mean.
const MASS_DELTA: [f64; 2] = [1e-7, 1.0];
/// Trial draws use this seed.
const SEED: u64 = 0;

/// Mass, mass centre and inertia, each with the largest entropy that what is known of it allows (Batou & Soize 2012,
/// doi:10.1007/s11044-011-9279-2).
///
/// # Definition
/// * The mass has given mean and a finite E ln m: a gamma law, of which δ_m is the deviation over the mean.
/// * The mass centre has given mean and deviations: a Gaussian; in a region, kept to it.
/// * The second moments per unit of mass Z = Σ_c/m have given mean and a finite E ln det Z: a Wishart law with the
///   dispersion δ ([`Wishart`]).
///
/// Each is independent of the others, so that the inertia follows the mass. With a region the law is this one given that
/// matter in the region can have the mass properties, which is the law of largest entropy on what is possible there, but
/// for means and deviations that are those before.
///
/// # Realizability
/// By construction.
///
/// ```
/// use gyradius_dispersion::{MassPropertiesModel, MaximumEntropy};
/// use gyradius_inertia::{Region, Shape};
/// use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
///
/// let body = Shape::ellipsoid([1.0, 0.5, 0.5])?.of_mass(5.0)?;
/// let law = MaximumEntropy::new(&body, 0.1, [0.05; 3], 0.2)?;
/// let law = law.inside(Region::ellipsoid([0.0; 3], [1.0, 0.5, 0.5])?)?;
/// assert!(law.draw(&mut ChaCha8Rng::seed_from_u64(1)).is_realizable());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, getset::Getters)]
pub struct MaximumEntropy {
    /// The mean body before draws are rejected.
    #[getset(get = "pub")]
    mean: MassProperties,
    mass_delta: f64,
    mass: Gamma<f64>,
    centre_deviations: Vector3<f64>,
    /// Of a body of one kilogram.
    unit: Wishart,
    inside: Option<Inside>,
}

impl MaximumEntropy {
    /// The mean body, the deviation of the mass over its mean, the deviations of the mass centre in m, and the dispersion
    /// of the second moments.
    ///
    /// # Errors
    /// The dispersion of the mass is not in [1e-7, 1], a deviation is negative or not finite, or the dispersion of the
    /// second moments is refused by [`Wishart`].
    pub fn new(
        mean: &MassProperties,
        mass_delta: f64,
        centre_deviations_m: [f64; 3],
        delta: f64,
    ) -> Result<Self, MaximumEntropyError> {
        let refused = MaximumEntropyError::MassDelta { value: mass_delta };
        if !(MASS_DELTA[0]..=MASS_DELTA[1]).contains(&mass_delta) {
            return Err(refused);
        }
        let bad = |sigma: &f64| !(0.0..=1e30).contains(sigma);
        if let Some(axis) = centre_deviations_m.iter().position(bad) {
            let value = centre_deviations_m[axis];
            return Err(MaximumEntropyError::CentreDeviation { axis: axis + 1, value });
        }
        let unit = mean.with_mass(1.0).map_err(|_| MaximumEntropyError::Mean)?;
        let unit = Wishart::new(*unit.inertia(), delta)?;
        let square = mass_delta * mass_delta;
        let mass = Gamma::new(1.0 / square, square * mean.mass_kg()).map_err(|_| refused)?;
        let centre_deviations = centre_deviations_m.into();
        let law = Self { mean: *mean, mass_delta, mass, centre_deviations, unit, inside: None };
        // Sizes at the ends of the range of floats.
        if law.propose(&mut Xoshiro256PlusPlus::seed_from_u64(SEED)).is_none() {
            return Err(MaximumEntropyError::Mean);
        }
        Ok(law)
    }

    /// The same given that matter in a region can have the mass properties, as
    /// [`MassPropertiesLaw::inside`](super::MassPropertiesLaw::inside).
    ///
    /// # Errors
    /// The law has a region already, or fewer than one in a thousand trial draws are possible in the region.
    pub fn inside(self, region: Region) -> Result<Self, RegionAcceptanceError> {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(SEED);
        let inside = Inside::new(self.inside.as_ref(), region, || self.sample(&mut rng))?;
        Ok(Self { inside: Some(inside), ..self })
    }

    /// The logarithm of the density with respect to dm d³c dI₁₁ dI₂₂ dI₃₃ dI₁₂ dI₁₃ dI₂₃. None where the mass centre or
    /// the second moments do not vary.
    #[must_use]
    pub fn ln_density(&self, body: &MassProperties) -> Option<f64> {
        if self.centre_deviations.min() == 0.0 {
            return None;
        }
        let mass = body.mass_kg();
        let unit = gyradius_inertia::InertiaMatrix::new(body.inertia().matrix() / mass).ok()?;
        let of_inertia = self.unit.ln_density(&unit)? - 6.0 * libm::log(mass);
        if self.inside.as_ref().is_some_and(|inside| !inside.holds(body)) {
            return Some(f64::NEG_INFINITY);
        }
        let shape = 1.0 / (self.mass_delta * self.mass_delta);
        let x = shape * (mass / self.mean.mass_kg());
        // x^{k−1} e^{−x}/Γ(k), of m = x m̄/k.
        let of_mass = (shape - 1.0) * libm::log(x) - x - libm::lgamma(shape)
            + libm::log(shape / self.mean.mass_kg());
        let z = (body.mass_centre_m() - self.mean.mass_centre_m())
            .component_div(&self.centre_deviations);
        let of_centre = -0.5 * z.norm_squared()
            - 1.5 * libm::log(2.0 * PI)
            - self.centre_deviations.map(libm::log).sum();
        let share = self.inside.as_ref().map_or(0.0, |inside| libm::log(inside.acceptance().0));
        Some(of_mass + of_centre + of_inertia - share)
    }

    fn propose<R: Rng + ?Sized>(&self, rng: &mut R) -> Option<MassProperties> {
        let mass = self.mass.sample(rng);
        let z = Vector3::from_fn(|_, _| StandardNormal.sample(rng));
        let centre = self.mean.mass_centre_m() + self.centre_deviations.component_mul(&z);
        let unit: Inertia = self.unit.sample(rng);
        let unit = MassProperties::new(1.0, centre, unit).ok()?;
        unit.with_mass(mass).ok()
    }
}

crate::written!(
    MaximumEntropy,
    |law| {
        mean: MassProperties = law.mean,
        mass_delta: f64 = law.mass_delta,
        centre_deviations_m: [f64; 3] = law.centre_deviations.into(),
        delta: f64 = law.unit.delta(),
        #[serde(default, skip_serializing_if = "Option::is_none")]
        inside: Option<Region> = law.inside.clone().map(Inside::into_region),
    },
    {
        let law = MaximumEntropy::new(&mean, mass_delta, centre_deviations_m, delta)?;
        match inside {
            Some(region) => law.inside(region)?,
            None => law,
        }
    }
);

impl Distribution<MassProperties> for MaximumEntropy {
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> MassProperties {
        loop {
            if let Some(body) = self.propose(rng)
                && self.inside.as_ref().is_none_or(|inside| inside.holds(&body))
            {
                return body;
            }
        }
    }
}

impl MassPropertiesModel for MaximumEntropy {
    draws_bodies!("maximum-entropy");

    fn ln_density(&self, body: &MassProperties) -> Option<f64> {
        self.ln_density(body)
    }

    /// In closed form: m and Z are independent, so that I = m Z covaries with m by Var(m) Z̄.
    fn moments(&self) -> Option<TenMoments> {
        if self.inside.is_some() {
            return None;
        }
        let mass = self.mean.mass_kg();
        let variance = (mass * self.mass_delta).powi(2);
        let own = self.unit.entry_moments();
        let unit = SVector::<f64, 6>::from(own.mean());
        let mut mean = SVector::<f64, 10>::zeros();
        mean[0] = mass;
        mean.fixed_rows_mut::<3>(1).copy_from(&self.mean.mass_centre_m());
        mean.fixed_rows_mut::<6>(4).copy_from(&(unit * mass));
        let mut covariance = SMatrix::<f64, 10, 10>::zeros();
        covariance[(0, 0)] = variance;
        for i in 0..3 {
            covariance[(1 + i, 1 + i)] = self.centre_deviations[i] * self.centre_deviations[i];
        }
        let with_mass = unit * variance;
        let six = own.covariance() * (mass * mass + variance) + unit * unit.transpose() * variance;
        covariance.fixed_view_mut::<6, 6>(4, 4).copy_from(&six);
        covariance.fixed_view_mut::<6, 1>(4, 0).copy_from(&with_mass);
        covariance.fixed_view_mut::<1, 6>(0, 4).copy_from(&with_mass.transpose());
        Some(TenMoments::unchecked(mean, covariance))
    }

    fn acceptance(&self) -> Option<f64> {
        self.inside.as_ref().map(|inside| inside.acceptance().0)
    }
}

/// Why numbers are no law of maximum entropy.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MaximumEntropyError {
    /// The dispersion of the mass is out of range.
    #[error(
        "deviation of the mass over its mean = {value:?}: it must lie in [{:e}, {:?}]",
        MASS_DELTA[0],
        MASS_DELTA[1]
    )]
    MassDelta {
        /// The value.
        value: f64,
    },
    /// A deviation of the mass centre is none.
    #[error(
        "deviation of the mass centre along axis {axis} = {value:?} m: it must lie in [0, 1e30]"
    )]
    CentreDeviation {
        /// Axis, from 1.
        axis: usize,
        /// The value, m.
        value: f64,
    },
    /// The dispersion of the second moments is refused.
    #[error(transparent)]
    Wishart(#[from] WishartError),
    /// The mean body is too large or too small.
    #[error("the mean body is at the end of the range of floats")]
    Mean,
}
