//! How closely clearance is found, and what touching and parting mean.

/// How closely clearance is found, and what touching and parting mean.
#[derive(Clone, Copy, Debug, PartialEq)]
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
