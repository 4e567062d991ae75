//! Second mass moments, their roots, and radii of gyration.

use crate::MAX_ENTRY;

/// Largest second moment, so that moments of inertia, which are sums of two, stay within
/// [`MAX_ENTRY`].
pub const MAX_SECOND_MOMENT: f64 = 0.25 * MAX_ENTRY;

/// Why three numbers are not second moments, their roots, or radii of gyration.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SecondMomentsError {
    /// A second moment is negative, NaN or too large.
    #[error(
        "second moment K_{axis} = {value:e} kg·m²: it must lie in [0, {MAX_SECOND_MOMENT:.1e}]"
    )]
    SecondMoment {
        /// Axis, from 1.
        axis: usize,
        /// The value, kg·m².
        value: f64,
    },
    /// A root is NaN or its square too large.
    #[error(
        "root second moment k_{axis} = {value:e} √kg·m: its square must not exceed {MAX_SECOND_MOMENT:.1e}"
    )]
    Root {
        /// Axis, from 1.
        axis: usize,
        /// The value, √kg·m.
        value: f64,
    },
    /// Mass times radius squared is not zero and falls below the range in which floats keep digits.
    #[error(
        "largest second moment = {value:e} kg·m²: below {:e} floats lose their digits",
        f64::MIN_POSITIVE
    )]
    Lost {
        /// What is left of it, kg·m².
        value: f64,
    },
    /// A radius of gyration is negative, NaN or too large.
    #[error("radius of gyration {axis} = {value:e} m: it must be finite and not negative")]
    Radius {
        /// Axis, from 1.
        axis: usize,
        /// The value, m.
        value: f64,
    },
    /// The mass is not positive and finite.
    #[error("mass = {value:e} kg: it must be positive and finite")]
    Mass {
        /// The value, kg.
        value: f64,
    },
}

/// Second mass moments K_k = ∫ x_k² dm ≥ 0 about the mass centre, in kg·m² (Peck 2003, Eq. 9).
///
/// The natural coordinates of a principal inertia: any three non-negative numbers are second
/// moments of some body, and I₁ = K₂ + K₃ and so on (Eq. 7) obeys the triangle inequality.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "[f64; 3]", into = "[f64; 3]"))]
pub struct SecondMoments([f64; 3]);

impl SecondMoments {
    /// Takes K₁, K₂, K₃.
    ///
    /// # Errors
    /// A value is negative, NaN or larger than [`MAX_SECOND_MOMENT`].
    pub fn new(values: [f64; 3]) -> Result<Self, SecondMomentsError> {
        match values.iter().position(|k| !(0.0..=MAX_SECOND_MOMENT).contains(k)) {
            Some(i) => Err(SecondMomentsError::SecondMoment { axis: i + 1, value: values[i] }),
            None => Ok(Self(values)),
        }
    }

    /// For values known to be finite, in range and negative by rounding only.
    pub(crate) fn clamped(values: [f64; 3]) -> Self {
        Self(values.map(|k| k.max(0.0)))
    }

    /// K₁, K₂, K₃ in kg·m².
    #[must_use]
    pub fn values(&self) -> [f64; 3] {
        self.0
    }

    /// Principal moments of inertia (Eq. 7): I₁ = K₂ + K₃, I₂ = K₁ + K₃, I₃ = K₁ + K₂, in kg·m².
    #[must_use]
    pub fn principal_moments(&self) -> [f64; 3] {
        let [k1, k2, k3] = self.0;
        [k2 + k3, k1 + k3, k1 + k2]
    }

    /// k_k = √K_k, all non-negative, in √kg·m.
    #[must_use]
    pub fn roots(&self) -> RootSecondMoments {
        RootSecondMoments(self.0.map(f64::sqrt))
    }

    /// √(K_k / m), in m.
    ///
    /// # Errors
    /// The mass is not positive and finite, or a radius overflows.
    pub fn radii_of_gyration(&self, mass_kg: f64) -> Result<RadiiOfGyration, SecondMomentsError> {
        check_mass(mass_kg)?;
        // Rooting first keeps K/m from overflowing or underflowing.
        RadiiOfGyration::new(self.0.map(|k| k.sqrt() / mass_kg.sqrt()))
    }
}

/// The roots k_k = √K_k of second mass moments, in √kg·m; the paper's "radii of gyration"
/// (Peck 2003, Eq. 10), which lack the division by mass that makes a radius: see
/// [`RadiiOfGyration`].
///
/// Either sign is allowed, because a Gaussian k̄ + w may come out negative; only the square
/// matters.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "[f64; 3]", into = "[f64; 3]"))]
pub struct RootSecondMoments([f64; 3]);

impl RootSecondMoments {
    /// Takes k₁, k₂, k₃, of either sign.
    ///
    /// # Errors
    /// A value is NaN or its square is larger than [`MAX_SECOND_MOMENT`].
    pub fn new(values: [f64; 3]) -> Result<Self, SecondMomentsError> {
        match values.iter().position(|k| !(k * k <= MAX_SECOND_MOMENT)) {
            Some(i) => Err(SecondMomentsError::Root { axis: i + 1, value: values[i] }),
            None => Ok(Self(values)),
        }
    }

    /// k₁, k₂, k₃ in √kg·m.
    #[must_use]
    pub fn values(&self) -> [f64; 3] {
        self.0
    }

    /// K_k = k_k², rounded once: within half a unit in the last place where |k_k| ≥ 1.5e-154 or k_k = 0. Smaller
    /// roots have squares below the normal range of `f64`: such a K_k is within 2.5e-324 kg·m² of k_k², and 0
    /// for |k_k| < 1.5e-162. It is never an error: to any other second moment of a body, it is nothing.
    #[must_use]
    pub fn squared(&self) -> SecondMoments {
        SecondMoments(self.0.map(|k| k * k))
    }
}

/// Radii of gyration √(K_k / m), in m: the distance at which all the mass would have the same
/// second moment.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "[f64; 3]", into = "[f64; 3]"))]
pub struct RadiiOfGyration([f64; 3]);

impl RadiiOfGyration {
    /// Takes the three radii, in m.
    ///
    /// # Errors
    /// A value is negative, NaN or infinite.
    pub fn new(values: [f64; 3]) -> Result<Self, SecondMomentsError> {
        match values.iter().position(|r| !(*r >= 0.0 && r.is_finite())) {
            Some(i) => Err(SecondMomentsError::Radius { axis: i + 1, value: values[i] }),
            None => Ok(Self(values)),
        }
    }

    /// The three radii, in m.
    #[must_use]
    pub fn values(&self) -> [f64; 3] {
        self.0
    }

    /// K_k = m r_k².
    ///
    /// # Errors
    /// The mass is not positive and finite, or a second moment overflows, or all that are not zero
    /// underflow.
    pub fn second_moments(&self, mass_kg: f64) -> Result<SecondMoments, SecondMomentsError> {
        check_mass(mass_kg)?;
        let moments = SecondMoments::new(self.0.map(|r| (mass_kg * r) * r))?;
        let largest = moments.0.into_iter().fold(0.0, f64::max);
        if largest < f64::MIN_POSITIVE && self.0.iter().any(|r| *r > 0.0) {
            return Err(SecondMomentsError::Lost { value: largest });
        }
        Ok(moments)
    }
}

fn check_mass(value: f64) -> Result<(), SecondMomentsError> {
    if value > 0.0 && value.is_finite() { Ok(()) } else { Err(SecondMomentsError::Mass { value }) }
}

crate::array_form::array_form!(
    SecondMoments as [f64; 3], refused by SecondMomentsError,
    |values| Self::new(values),
    |own| own.0
);
crate::array_form::array_form!(
    RootSecondMoments as [f64; 3], refused by SecondMomentsError,
    |values| Self::new(values),
    |own| own.0
);
crate::array_form::array_form!(
    RadiiOfGyration as [f64; 3], refused by SecondMomentsError,
    |values| Self::new(values),
    |own| own.0
);

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Roots of every size: squares are rounded once, below the normal range to its smallest steps.
    #[test]
    fn squares_of_roots_of_every_size_are_as_exact_as_stated() {
        let (up, step) = (2_f64.powi(600), 2_f64.powi(-1074));
        for exponent in -1074..=400 {
            for digits in [1.0, 1.0 + 1e-9, 1.234_567_89, 1.999_999_9] {
                let k = digits * 2_f64.powi(exponent / 2) * 2_f64.powi(exponent - exponent / 2);
                let [squared, ..] =
                    RootSecondMoments::new([k, 0.0, 0.0]).unwrap().squared().values();
                if k >= 1.5e-154 {
                    assert!(k.mul_add(k, -squared).abs() <= 0.5 * f64::EPSILON * squared, "{k:e}");
                } else {
                    // 2^1200 times as large, where nothing underflows but what is far below a step.
                    let exact = (k * up) * (k * up);
                    let off = (squared * up * up - exact).abs();
                    assert!(off <= 0.501 * step * up * up, "{k:e}: {squared:e}");
                    assert!(k >= 1.5e-162 || squared == 0.0, "{k:e}: {squared:e}");
                }
            }
        }
    }

    #[test]
    fn bad_values_are_named() {
        for bad in [-1.0, f64::NAN, f64::INFINITY, -f64::MIN_POSITIVE, 1e308] {
            let error = SecondMoments::new([1.0, bad, 1.0]).unwrap_err();
            assert!(error.to_string().contains("K_2"), "{error}");
        }
        for bad in [f64::NAN, f64::INFINITY, 1e160] {
            assert!(RootSecondMoments::new([bad, 0.0, 0.0]).is_err());
        }
        for bad in [-1.0, f64::NAN, f64::INFINITY] {
            assert!(RadiiOfGyration::new([0.0, 0.0, bad]).is_err());
        }
        let k = SecondMoments::new([1.0; 3]).unwrap();
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(k.radii_of_gyration(bad).is_err());
        }
    }

    #[test]
    fn a_solid_box_has_the_textbook_values() {
        // m = 12 kg, sides 1, 2, 3 m: K = m a²/12, r = a/√12.
        let k = SecondMoments::new([1.0, 4.0, 9.0]).unwrap();
        assert_eq!(k.principal_moments(), [13.0, 10.0, 5.0]);
        assert_eq!(k.roots().values(), [1.0, 2.0, 3.0]);
        let radii = k.radii_of_gyration(12.0).unwrap().values();
        for (r, side) in radii.iter().zip([1.0, 2.0, 3.0]) {
            assert!((r - side / 12f64.sqrt()).abs() < 1e-15);
        }
    }

    proptest! {
        #[test]
        fn radii_round_trip(k in prop::array::uniform3(0.0..1e6f64), mass in 1e-6..1e6f64) {
            let k = SecondMoments::new(k).unwrap();
            let back = k.radii_of_gyration(mass).unwrap().second_moments(mass).unwrap();
            for (a, b) in k.values().iter().zip(back.values()) {
                prop_assert!((a - b).abs() <= 4.0 * f64::EPSILON * a);
            }
        }

        #[test]
        fn radii_of_a_body_never_become_those_of_a_point(
            (mass, radius) in (-1074..1024i32, -1074..1024i32),
        ) {
            let power = |e: i32| 2f64.powi(e / 2) * 2f64.powi(e - e / 2);
            let radii = RadiiOfGyration::new([0.0, power(radius), 0.0]).unwrap();
            let exponent = mass + 2 * radius;
            match radii.second_moments(power(mass)) {
                Ok(k) => {
                    prop_assert_eq!(k.values(), [0.0, power(exponent), 0.0]);
                    prop_assert!(exponent >= -1022);
                }
                Err(SecondMomentsError::Lost { .. }) => prop_assert!(exponent < -1022),
                // m r overflows before r² brings it back only where both do.
                Err(error) => prop_assert!(exponent > 1015, "{}", error),
            }
        }

        #[test]
        fn squares_undo_roots(k in prop::array::uniform3(0.0..1e300f64)) {
            let k = SecondMoments::new(k).unwrap();
            for (a, b) in k.values().iter().zip(k.roots().squared().values()) {
                prop_assert!((a - b).abs() <= 4.0 * f64::EPSILON * a);
            }
        }
    }
}
