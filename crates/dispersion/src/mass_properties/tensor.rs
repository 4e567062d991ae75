//! The law of the inertia in a joint law: about the mass centre, and how it goes with the mass.

use crate::{AxesLaw, DispersionModel, InertiaLaw, ScalarLaw};

/// A law of the inertia about the mass centre, as a part of a [`MassPropertiesLaw`](super::MassPropertiesLaw).
///
/// # Definition
/// * [`gyration_lengths`](Self::gyration_lengths): ρ_k from three scalar laws in m, of any sign, and the principal axes
///   from a law of attitudes; K_k = m ρ_k². The lengths describe the shape and do not depend on the mass, so that the
///   inertia follows the mass.
/// * [`roots`](Self::roots): k_k from three scalar laws in √kg·m, K_k = k_k² (Peck 2003, Eq. 9). The inertia does not
///   follow the mass unless [`with_follows`](Self::with_follows) says so.
/// * [`model`](Self::model): any model whose draws are all realizable, independent of mass and mass centre but for
///   [`with_follows`](Self::with_follows).
///
/// ```
/// use gyradius_dispersion::{ScalarLaw, TensorLaw};
/// use gyradius_attitude::UniformAttitude;
///
/// // A rod of 1.2 m, of which nobody knows where it points.
/// let length = ScalarLaw::normal(1.2 / 12f64.sqrt(), 0.01)?;
/// let zero = ScalarLaw::normal(0.0, 0.0)?;
/// let rod = TensorLaw::gyration_lengths([zero.clone(), zero, length], UniformAttitude);
/// # Ok::<(), gyradius_dispersion::ScalarLawError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct TensorLaw {
    pub(super) of: Of,
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub(super) follows: Option<Follows>,
}

/// What a [`TensorLaw`] is a law of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TensorParts<'a> {
    /// Radii of gyration in m about principal axes.
    GyrationLengths {
        /// Of each length.
        laws: &'a [ScalarLaw; 3],
        /// Of the axes.
        axes: &'a AxesLaw,
    },
    /// Roots of the second moments in √kg·m about principal axes.
    Roots {
        /// Of each root.
        laws: &'a [ScalarLaw; 3],
        /// Of the axes.
        axes: &'a AxesLaw,
    },
    /// Any model.
    Model(&'a DispersionModel),
}

/// What it is a law of.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub(super) enum Of {
    /// Radii of gyration, m.
    GyrationLengths(Principal),
    /// Roots of the second moments, √kg·m.
    Roots(Principal),
    /// Any model.
    Model(DispersionModel),
}

/// Three numbers about axes.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub(super) struct Principal {
    pub(super) laws: [ScalarLaw; 3],
    pub(super) axes: AxesLaw,
}

/// The inertia drawn, times 1 + share · (m/m₀ − 1).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub(super) struct Follows {
    pub(super) share: f64,
    pub(super) nominal_mass_kg: f64,
}

impl Follows {
    /// What an inertia is multiplied with at a mass.
    pub(super) fn factor(&self, mass: f64) -> f64 {
        following_factor(mass / self.nominal_mass_kg, self.share)
    }
}

/// What an inertia is multiplied with that takes a share, from 0 to 1, of the relative change of a mass, which is so many
/// times its nominal value.
#[must_use]
pub fn following_factor(mass_ratio: f64, share: f64) -> f64 {
    // Of the whole change the ratio itself, to the bit.
    if share < 1.0 { 1.0 + share * (mass_ratio - 1.0) } else { mass_ratio }
}

impl TensorLaw {
    /// Radii of gyration in m about principal axes. The inertia follows the mass.
    pub fn gyration_lengths(laws: [ScalarLaw; 3], axes: impl Into<AxesLaw>) -> Self {
        Self { of: Of::GyrationLengths(Principal { laws, axes: axes.into() }), follows: None }
    }

    /// Roots of the second moments in √kg·m about principal axes.
    pub fn roots(laws: [ScalarLaw; 3], axes: impl Into<AxesLaw>) -> Self {
        Self { of: Of::Roots(Principal { laws, axes: axes.into() }), follows: None }
    }

    /// Any model of inertia whose draws are all realizable.
    ///
    /// # Errors
    /// The model draws matrices of no body.
    pub fn model(model: impl Into<DispersionModel>) -> Result<Self, TensorLawError> {
        let model = model.into();
        if !model.is_realizable_by_construction() {
            return Err(TensorLawError::Unrealizable { model: model.kind().name() });
        }
        Ok(Self { of: Of::Model(model), follows: None })
    }

    /// The inertia takes this share of the mass's relative change: what was drawn times 1 + share · (m/m₀ − 1).
    ///
    /// # Errors
    /// The share is not between 0 and 1, the nominal mass m₀ is not positive and finite, or the law is one of gyration
    /// lengths, which follows the mass anyway.
    pub fn with_follows(self, share: f64, nominal_mass_kg: f64) -> Result<Self, TensorLawError> {
        if !(0.0..=1.0).contains(&share) {
            return Err(TensorLawError::Share { value: share });
        }
        if !(nominal_mass_kg > 0.0 && nominal_mass_kg.is_finite()) {
            return Err(TensorLawError::NominalMass { value: nominal_mass_kg });
        }
        if matches!(self.of, Of::GyrationLengths(_)) {
            return Err(TensorLawError::FollowsAnyway);
        }
        Ok(Self { follows: (share > 0.0).then_some(Follows { share, nominal_mass_kg }), ..self })
    }

    /// What it is a law of.
    #[must_use]
    pub fn parts(&self) -> TensorParts<'_> {
        match &self.of {
            Of::GyrationLengths(Principal { laws, axes }) => {
                TensorParts::GyrationLengths { laws, axes }
            }
            Of::Roots(Principal { laws, axes }) => TensorParts::Roots { laws, axes },
            Of::Model(model) => TensorParts::Model(model),
        }
    }

    /// The share of the mass's relative change that the inertia takes, and the nominal mass in kg, where
    /// [`with_follows`](Self::with_follows) said so.
    #[must_use]
    pub fn follows(&self) -> Option<(f64, f64)> {
        self.follows.map(|follows| (follows.share, follows.nominal_mass_kg))
    }

    /// Whether the law of lengths and that of roots, which have three scalar laws, can be correlated with mass and mass
    /// centre.
    pub(super) fn scalar_laws(&self) -> Option<&[ScalarLaw; 3]> {
        match &self.of {
            Of::GyrationLengths(principal) | Of::Roots(principal) => Some(&principal.laws),
            Of::Model(_) => None,
        }
    }

    /// What was said after the constructor, checked again where it comes from a file.
    pub(super) fn check(&self) -> Result<(), TensorLawError> {
        let unchecked = Self { of: self.of.clone(), follows: None };
        if let Of::Model(model) = &self.of {
            Self::model(model.clone())?;
        }
        match self.follows {
            Some(Follows { share, nominal_mass_kg }) => {
                unchecked.with_follows(share, nominal_mass_kg).map(|_| ())
            }
            None => Ok(()),
        }
    }
}

/// Why a law of the inertia is refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TensorLawError {
    /// The model draws matrices of no body.
    #[error(
        "model = {model:?}: some of its draws belong to no body, and a law of mass properties takes realizable \
         ones only; conditioned on realizability it can be taken"
    )]
    Unrealizable {
        /// The model.
        model: &'static str,
    },
    /// The share is none.
    #[error("share = {value:?} of the mass's relative change: it must lie in [0, 1]")]
    Share {
        /// The value.
        value: f64,
    },
    /// The nominal mass is none.
    #[error("nominal mass = {value:?} kg: it must be positive and finite")]
    NominalMass {
        /// The value.
        value: f64,
    },
    /// A law of gyration lengths follows the mass anyway.
    #[error("an inertia from gyration lengths follows the mass wholly: it takes no share")]
    FollowsAnyway,
}
