//! The ways in which mass properties are randomized in practice, of which most draw bodies that cannot be: rivals of the
//! joint law, so that they can be compared and counted.

use gyradius_inertia::{InertiaMatrix, MAX_ENTRY, MassProperties};
use nalgebra::{Matrix3, Vector3};
use rand::Rng;
use rand_distr::Distribution;
use std::borrow::Cow;

use super::{MassPropertiesModel, TenParameters};
use crate::ScalarLaw;
use crate::roots::FAR;

/// What a number may come to.
const MAX_NUMBER: f64 = 1e30;
/// What it may make of a mass or a moment, so that no entry is too large about other axes either.
const MAX_PRODUCT: f64 = MAX_ENTRY / 16.0;

/// How the inertia is changed. Each random number is drawn anew from the law of the rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum NaiveRule {
    /// Each diagonal entry times a number of its own; products of inertia stay.
    DiagonalFactors,
    /// Each of the six entries times a number of its own.
    EntryFactors,
    /// Each principal moment times a number of its own; the principal axes stay.
    PrincipalFactors,
    /// A number of its own, in kg·m², added to each of the six entries.
    EntryNoise,
    /// All entries times one number: no body becomes impossible.
    ScaleAll,
}

impl NaiveRule {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::DiagonalFactors,
        Self::EntryFactors,
        Self::PrincipalFactors,
        Self::EntryNoise,
        Self::ScaleAll,
    ];

    /// Its name, in kebab case.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::DiagonalFactors => "diagonal-factors",
            Self::EntryFactors => "entry-factors",
            Self::PrincipalFactors => "principal-factors",
            Self::EntryNoise => "entry-noise",
            Self::ScaleAll => "scale-all",
        }
    }
}

/// A body whose inertia is randomized without regard to what bodies there are.
///
/// # Realizability
/// Not by construction, but for [`NaiveRule::ScaleAll`] with positive factors.
/// [`unrealizable_share`](MassPropertiesModel::unrealizable_share) counts.
///
/// ```
/// use gyradius_dispersion::{MassPropertiesModel, NaiveBody, NaiveRule, ScalarLaw};
/// use gyradius_inertia::Shape;
/// use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
///
/// // A rule of many public training set-ups: three diagonal entries, each times its own number of U(0.5, 1.5).
/// let rod = Shape::cylinder(0.03, 0.5)?.of_mass(2.0)?;
/// let law = NaiveBody::new(rod, NaiveRule::DiagonalFactors, ScalarLaw::uniform(0.5, 1.5)?)?;
/// let share = law.unrealizable_share(&mut ChaCha8Rng::seed_from_u64(1), 10_000);
/// assert!(share > 0.9, "nearly no draw is a body");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, getset::CopyGetters, getset::Getters)]
pub struct NaiveBody {
    /// What is randomized.
    #[getset(get = "pub")]
    nominal: MassProperties,
    /// How.
    #[getset(get_copy = "pub")]
    rule: NaiveRule,
    law: ScalarLaw,
    mass_factor: Option<ScalarLaw>,
    centre_offset_m: Option<ScalarLaw>,
}

impl NaiveBody {
    /// A body, a rule and the law of the numbers that it draws. Mass and mass centre stay.
    ///
    /// # Errors
    /// The numbers could make entries that are too large.
    pub fn new(
        nominal: MassProperties,
        rule: NaiveRule,
        law: ScalarLaw,
    ) -> Result<Self, NaiveBodyError> {
        let largest = nominal.inertia().matrix().amax();
        let law = match rule {
            NaiveRule::EntryNoise => checked(law)?,
            NaiveRule::DiagonalFactors
            | NaiveRule::EntryFactors
            | NaiveRule::PrincipalFactors
            | NaiveRule::ScaleAll => factor(law, largest)?,
        };
        Ok(Self { nominal, rule, law, mass_factor: None, centre_offset_m: None })
    }

    /// The same with a mass that is multiplied by a number of its own, apart from the inertia.
    ///
    /// # Errors
    /// The numbers could be too large.
    pub fn with_mass_factor(self, law: ScalarLaw) -> Result<Self, NaiveBodyError> {
        Ok(Self { mass_factor: Some(factor(law, self.nominal.mass_kg())?), ..self })
    }

    /// The same with a mass centre that is moved along each body axis by a number of its own, in m.
    ///
    /// # Errors
    /// The numbers could be too large.
    pub fn with_centre_offset_m(self, law: ScalarLaw) -> Result<Self, NaiveBodyError> {
        Ok(Self { centre_offset_m: Some(checked(law)?), ..self })
    }

    fn inertia(&self, rng: &mut dyn Rng) -> Option<InertiaMatrix> {
        let mut rng = rng;
        let mut number = || self.law.sample(&mut rng);
        let entries = self.nominal.inertia().entries();
        let drawn = match self.rule {
            NaiveRule::DiagonalFactors => {
                let [a, b, c, rest @ ..] = entries;
                let [a, b, c] = [a * number(), b * number(), c * number()];
                let [d, e, f] = rest;
                [a, b, c, d, e, f]
            }
            NaiveRule::EntryFactors => entries.map(|entry| entry * number()),
            NaiveRule::EntryNoise => entries.map(|entry| entry + number()),
            NaiveRule::ScaleAll => {
                let factor = number();
                entries.map(|entry| entry * factor)
            }
            NaiveRule::PrincipalFactors => {
                let axes = self.nominal.inertia().principal_axes();
                let turn = axes.attitude().to_rotation_matrix();
                let moments = Vector3::from(axes.moments().map(|moment| moment * number()));
                let turned =
                    turn.matrix().transpose() * Matrix3::from_diagonal(&moments) * turn.matrix();
                return InertiaMatrix::new((turned + turned.transpose()) * 0.5).ok();
            }
        };
        let [i11, i22, i33, i12, i13, i23] = drawn;
        InertiaMatrix::from_entries([i11, i22, i33], [i12, i13, i23]).ok()
    }
}

crate::written!(
    NaiveBody,
    |body| {
        nominal: MassProperties = body.nominal,
        rule: NaiveRule = body.rule,
        law: ScalarLaw = body.law.clone(),
        #[serde(default, skip_serializing_if = "Option::is_none")]
        mass_factor: Option<ScalarLaw> = body.mass_factor.clone(),
        #[serde(default, skip_serializing_if = "Option::is_none")]
        centre_offset_m: Option<ScalarLaw> = body.centre_offset_m.clone(),
    },
    NaiveBody {
        mass_factor: mass_factor.map(|law| factor(law, nominal.mass_kg())).transpose()?,
        centre_offset_m: centre_offset_m.map(checked).transpose()?,
        ..NaiveBody::new(nominal, rule, law)?
    }
);

fn checked(law: ScalarLaw) -> Result<ScalarLaw, NaiveBodyError> {
    at_most(law, MAX_NUMBER)
}

/// Of numbers by which something of a size is multiplied.
fn factor(law: ScalarLaw, size: f64) -> Result<ScalarLaw, NaiveBodyError> {
    at_most(law, MAX_NUMBER.min(MAX_PRODUCT / size))
}

fn at_most(law: ScalarLaw, most: f64) -> Result<ScalarLaw, NaiveBodyError> {
    let value = law.reach(FAR);
    if value <= most { Ok(law) } else { Err(NaiveBodyError::Reach { value, most }) }
}

impl MassPropertiesModel for NaiveBody {
    fn name(&self) -> Cow<'_, str> {
        self.rule.name().into()
    }

    fn draw(&self, rng: &mut dyn Rng) -> TenParameters {
        let inertia = self.inertia(rng);
        let mut rng = rng;
        let factor = self.mass_factor.as_ref().map_or(1.0, |law| law.sample(&mut rng));
        let mut ten = TenParameters::from(self.nominal);
        ten.mass_kg *= factor;
        if let Some(law) = &self.centre_offset_m {
            ten.mass_centre_m += Vector3::from_fn(|_, _| law.sample(&mut rng));
        }
        // Always: the numbers are in range.
        ten.inertia = inertia.unwrap_or(ten.inertia);
        ten
    }

    fn is_realizable_by_construction(&self) -> bool {
        false
    }
}

/// Why a law is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NaiveBodyError {
    /// Numbers could come out too large.
    #[error("numbers of up to {value:e}: they must be at most {most:e}")]
    Reach {
        /// How large.
        value: f64,
        /// What is allowed, which is less where the body is very large or heavy.
        most: f64,
    },
}

#[cfg(test)]
mod tests {
    use super::*;
    use gyradius_inertia::Inertia;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    /// Whatever the sizes: a law is refused, or all that it draws are numbers, and not the nominal body again.
    #[test]
    fn no_draw_is_too_large() {
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        let mut taken = 0;
        for power in (-280..=300).step_by(20) {
            let size = 10_f64.powi(power);
            let moments = [1.0, 0.9, 0.8].map(|k| k * size);
            let inertia = InertiaMatrix::from_entries(moments, [0.0; 3]).unwrap();
            let inertia = Inertia::try_from(inertia).unwrap();
            let body = MassProperties::new(size, [0.0; 3], inertia).unwrap();
            for rule in NaiveRule::ALL {
                for most in [2.0, 1e10, 1e29] {
                    let law = ScalarLaw::uniform(0.5 * most, most).unwrap();
                    let heavy = NaiveBody::new(body, rule, ScalarLaw::normal(1.0, 0.0).unwrap())
                        .unwrap()
                        .with_mass_factor(law.clone());
                    let drawn = heavy.map(|law| law.draw(&mut rng));
                    assert!(drawn.is_ok_and(|ten| ten.mass_kg.is_finite()) || power > 260);
                    let Ok(law) = NaiveBody::new(body, rule, law) else {
                        assert!(power > 260, "{size:e} {most:e}");
                        continue;
                    };
                    taken += 1;
                    let ten = law.draw(&mut rng);
                    let moved = ten.inertia.matrix() - body.inertia().matrix();
                    let noise = rule == NaiveRule::EntryNoise && power > 0;
                    assert!(noise || moved.amax() > 1e-3 * size, "{rule:?} {size:e} {most:e}");
                }
            }
        }
        assert!(taken > 300, "{taken}");
    }
}
