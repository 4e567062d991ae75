//! How closely clearance is found, and what touching and parting mean.

/// How closely clearance is found, and what touching and parting mean.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "Fields", into = "Fields")
)]
pub struct ClearanceSettings {
    tolerance: f64,
    relative: f64,
    touch: f64,
    parted: f64,
}

impl Default for ClearanceSettings {
    /// Distances to 1e-9 m; nearer than 1e-6 m is touching; a millimetre is parted.
    fn default() -> Self {
        Self { tolerance: 1e-9, relative: 0.0, touch: 1e-6, parted: 1e-3 }
    }
}

impl ClearanceSettings {
    /// Tolerance of the smallest distance; distance up to which shapes touch; distance from which
    /// shapes that touched at the start have parted. All in m.
    ///
    /// # Errors
    /// The tolerance is not in 1e-12 to 1e-2, the touch below a hundred tolerances, the parting not
    /// above twice the touch.
    pub fn new(
        tolerance_m: f64,
        touch_m: f64,
        parted_m: f64,
    ) -> Result<Self, ClearanceSettingsError> {
        if !(1e-12..=1e-2).contains(&tolerance_m) {
            return Err(ClearanceSettingsError::Tolerance { value: tolerance_m });
        }
        // Decimal inputs such as 1e-9 and 1e-7 are to pass.
        let least = 100.0 * tolerance_m;
        if !(touch_m >= least * (1.0 - 1e-12) && touch_m.is_finite()) {
            return Err(ClearanceSettingsError::Touch { value: touch_m, least });
        }
        if !(parted_m > 2.0 * touch_m && parted_m.is_finite()) {
            return Err(ClearanceSettingsError::Parted { value: parted_m, touch: touch_m });
        }
        Ok(Self { tolerance: tolerance_m, relative: 0.0, touch: touch_m, parted: parted_m })
    }

    /// With a tolerance of the smallest distance that is at least this share of the distance: who wants to know how near
    /// bodies come only roughly, but whether they touch to the last micrometre, takes a hundredth, and half of the looks.
    ///
    /// # Errors
    /// The share is not in 0 to 0.1.
    pub fn with_relative_tolerance(self, share: f64) -> Result<Self, ClearanceSettingsError> {
        if !(0.0..=0.1).contains(&share) {
            return Err(ClearanceSettingsError::Relative { value: share });
        }
        Ok(Self { relative: share, ..self })
    }

    /// Tolerance of the smallest distance as a share of it, where that is more than [`tolerance_m`](Self::tolerance_m).
    #[must_use]
    pub fn relative_tolerance(&self) -> f64 {
        self.relative
    }

    /// Tolerance of the smallest distance, m.
    #[must_use]
    pub fn tolerance_m(&self) -> f64 {
        self.tolerance
    }

    /// Distance up to which shapes touch, m.
    #[must_use]
    pub fn touch_m(&self) -> f64 {
        self.touch
    }

    /// Distance from which shapes that touched at the start have parted, m.
    #[must_use]
    pub fn parted_m(&self) -> f64 {
        self.parted
    }
}

/// The serialized form.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Fields {
    tolerance_m: f64,
    #[serde(default)]
    relative_tolerance: f64,
    touch_m: f64,
    parted_m: f64,
}

#[cfg(feature = "serde")]
impl TryFrom<Fields> for ClearanceSettings {
    type Error = ClearanceSettingsError;

    fn try_from(f: Fields) -> Result<Self, ClearanceSettingsError> {
        Self::new(f.tolerance_m, f.touch_m, f.parted_m)?
            .with_relative_tolerance(f.relative_tolerance)
    }
}

#[cfg(feature = "serde")]
impl From<ClearanceSettings> for Fields {
    fn from(settings: ClearanceSettings) -> Self {
        Self {
            tolerance_m: settings.tolerance,
            relative_tolerance: settings.relative,
            touch_m: settings.touch,
            parted_m: settings.parted,
        }
    }
}

/// Why clearance settings are refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ClearanceSettingsError {
    /// The tolerance is out of range.
    #[error("tolerance = {value:?} m: it must be between 1e-12 and 1e-2 m")]
    Tolerance {
        /// The tolerance, m.
        value: f64,
    },
    /// The relative tolerance is out of range.
    #[error("relative tolerance = {value:?}: it must be between 0 and 0.1")]
    Relative {
        /// The share.
        value: f64,
    },
    /// The distance of touching is out of range.
    #[error("touch = {value:?} m: it must be at least 100 tolerances ({least:e} m) and finite")]
    Touch {
        /// The distance, m.
        value: f64,
        /// What it must be at least, m.
        least: f64,
    },
    /// The distance of having parted is out of range.
    #[error("parted = {value:?} m: it must be finite and more than twice the touch ({touch:e} m)")]
    Parted {
        /// The distance, m.
        value: f64,
        /// The distance of touching, m.
        touch: f64,
    },
}

#[cfg(all(test, feature = "serde"))]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// To the bit, and through the constructors: each number wrong by itself is refused.
        #[test]
        fn settings_are_read_as_they_were_written(
            tolerance in -12.0..-2.0_f64,
            touch in 0.0..3.0_f64,
            parted in 0.31..4.0_f64,
            relative in 0.0..0.1_f64,
        ) {
            let tolerance = 10_f64.powf(tolerance);
            let touch = 100.0 * tolerance * 10_f64.powf(touch);
            let settings = ClearanceSettings::new(tolerance, touch, touch * 10_f64.powf(parted)).unwrap();
            let settings = settings.with_relative_tolerance(relative).unwrap();
            let json = serde_json::to_value(settings).unwrap();
            prop_assert_eq!(serde_json::from_str::<ClearanceSettings>(&json.to_string()).unwrap(), settings);
            for (key, wrong) in [
                ("tolerance_m", 0.02),
                ("touch_m", 99.0 * tolerance),
                ("parted_m", 2.0 * touch),
                ("relative_tolerance", 0.2),
                ("other", 1.0),
            ] {
                let mut bad = json.clone();
                bad[key] = wrong.into();
                prop_assert!(serde_json::from_value::<ClearanceSettings>(bad).is_err(), "{}", key);
            }
        }
    }
}
