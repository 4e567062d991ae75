//! How to integrate.

/// Why settings are refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SettingsError {
    /// The tolerance is out of range.
    #[error("relative tolerance = {value:e}: it must lie in [1e-14, 1e-3]")]
    Tolerance {
        /// The tolerance.
        value: f64,
    },
    /// The horizon is not positive and finite.
    #[error("horizon = {value:?} s: it must be positive and finite")]
    Horizon {
        /// The horizon, s.
        value: f64,
    },
}

/// How to integrate.
///
/// ```
/// use gyradius_separation::Settings;
///
/// let quick = Settings::new(1e-9, 10.0)?;
/// assert!(quick.relative_tolerance() > Settings::default().relative_tolerance());
/// assert!(Settings::new(0.0, 10.0).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "Fields", into = "Fields")
)]
pub struct Settings {
    relative_tolerance: f64,
    horizon: f64,
}

impl Settings {
    /// Tolerance of one step, relative to the motion that the springs can bring about, and the time
    /// in s by which the last spring must have let go.
    ///
    /// # Errors
    /// The tolerance is outside [1e-14, 1e-3], or the horizon not positive and finite.
    pub fn new(relative_tolerance: f64, horizon_s: f64) -> Result<Self, SettingsError> {
        if !(1e-14..=1e-3).contains(&relative_tolerance) {
            return Err(SettingsError::Tolerance { value: relative_tolerance });
        }
        if !(horizon_s > 0.0 && horizon_s.is_finite()) {
            return Err(SettingsError::Horizon { value: horizon_s });
        }
        Ok(Self { relative_tolerance, horizon: horizon_s })
    }

    /// Tolerance of one step.
    #[must_use]
    pub fn relative_tolerance(&self) -> f64 {
        self.relative_tolerance
    }

    /// Latest release of the last spring, s.
    #[must_use]
    pub fn horizon_s(&self) -> f64 {
        self.horizon
    }
}

impl Default for Settings {
    /// Tolerance 1e-13, with which outcomes are within 1e-11 of those at the tightest; horizon 60 s.
    fn default() -> Self {
        Self { relative_tolerance: 1e-13, horizon: 60.0 }
    }
}

/// The serialized form.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Fields {
    relative_tolerance: f64,
    horizon_s: f64,
}

#[cfg(feature = "serde")]
impl TryFrom<Fields> for Settings {
    type Error = SettingsError;

    fn try_from(f: Fields) -> Result<Self, SettingsError> {
        Self::new(f.relative_tolerance, f.horizon_s)
    }
}

#[cfg(feature = "serde")]
impl From<Settings> for Fields {
    fn from(settings: Settings) -> Self {
        Self { relative_tolerance: settings.relative_tolerance, horizon_s: settings.horizon }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_checked() {
        for bad in [0.0, -1.0, 1e-15, 0.1, f64::NAN] {
            assert!(matches!(Settings::new(bad, 1.0), Err(SettingsError::Tolerance { .. })));
        }
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(Settings::new(1e-9, bad), Err(SettingsError::Horizon { .. })));
        }
        assert_eq!(Settings::new(1e-13, 60.0).unwrap(), Settings::default());
    }
}
