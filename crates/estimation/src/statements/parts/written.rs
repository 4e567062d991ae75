//! What follows a ±, as it was written.

use super::{MOST_SIGMAS, Part, StatementError};

/// The largest standard deviation that is taken, in the unit of a key: beyond it nobody means what is
/// written, and no model comes of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Unit {
    /// The key.
    key: &'static str,
    most: f64,
    name: &'static str,
}

impl Unit {
    /// Of the nominal moments.
    pub(super) const PERCENT: Self = Self { key: "percent", most: 1000.0, name: "%" };
    /// Of the nominal mass, which more than one standard deviation keeps positive.
    pub(super) const PERCENT_OF_MASS: Self = Self { key: "percent", most: 100.0, name: "%" };
    /// What the body allows is asked later, by [`Statements::check`](super::super::Statements::check).
    pub(super) const KG_M2: Self = Self { key: "kg_m2", most: 1e60, name: "kg·m²" };
    pub(super) const KG: Self = Self { key: "kg", most: 1e30, name: "kg" };
    /// Beyond 45°, any axes do.
    pub(super) const DEG: Self = Self { key: "deg", most: 45.0, name: "°" };
    /// Of the whole rotation: as far on each axis.
    pub(super) const DEG_IN_ALL: Self = Self { key: "deg", most: 75.0, name: "°" };
    #[cfg(feature = "serde")]
    pub(super) const MM: Self = Self { key: "mm", most: 1e7, name: "mm" };
    pub(super) const M: Self = Self { key: "m", most: 1e4, name: "m" };
}

/// Numbers that stand for so many standard deviations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Written {
    pub(super) part: Part,
    pub(super) unit: Unit,
    pub(super) values: [f64; 3],
    /// Whether there is a number for each, or one for all.
    pub(super) each: bool,
    pub(super) sigmas: f64,
}

impl Written {
    /// One standard deviation of each, in the unit.
    pub(super) fn deviations(&self) -> Result<[f64; 3], StatementError> {
        self.scaled(1.0)
    }

    /// One standard deviation of each in another unit, of which one is so many.
    pub(super) fn scaled(&self, factor: f64) -> Result<[f64; 3], StatementError> {
        let Self { part, unit, values, sigmas, .. } = *self;
        if !(0.1..=MOST_SIGMAS).contains(&sigmas) {
            return Err(StatementError::Sigmas { part, value: sigmas });
        }
        for (i, value) in values.into_iter().enumerate() {
            let key = || {
                let index = if self.each { format!("[{}]", i + 1) } else { String::new() };
                format!("{part}.{}{index}", unit.key)
            };
            if !(value >= 0.0 && value.is_finite()) {
                return Err(StatementError::Amount { key: key(), value });
            }
            if value / sigmas > unit.most {
                let (most, unit) = (unit.most, unit.name);
                return Err(StatementError::TooLarge { key: key(), value, sigmas, most, unit });
            }
        }
        Ok(values.map(|value| factor * value / sigmas))
    }
}
