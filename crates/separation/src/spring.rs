use nalgebra::Vector3;

/// Why a spring is none.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpringError {
    /// The stiffness is not positive and finite.
    #[error("stiffness = {value:?} N/m: it must be positive and finite")]
    Stiffness {
        /// The stiffness, N/m.
        value: f64,
    },
    /// The stroke is not positive and finite.
    #[error("stroke = {value:?} m: it must be positive and finite")]
    Stroke {
        /// The stroke, m.
        value: f64,
    },
    /// An attachment point is not finite.
    #[error("{body} attachment point has entry {value}: it must be finite")]
    Point {
        /// `payload` or `stage`.
        body: &'static str,
        /// The entry, m.
        value: f64,
    },
}

/// A massless linear spring between a point of the payload and a point of the stage, compressed at
/// the start by its stroke.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "Fields", into = "Fields")
)]
pub struct Spring {
    stiffness: f64,
    stroke: f64,
    payload_point: Vector3<f64>,
    stage_point: Vector3<f64>,
}

impl Spring {
    /// Stiffness k in N/m, stroke δ (initial compression) in m, and the two points, each from its
    /// body's mass centre in body axes, in m.
    ///
    /// # Errors
    /// Stiffness or stroke is not positive and finite, or a point is not finite.
    pub fn new(
        stiffness_n_per_m: f64,
        stroke_m: f64,
        payload_point_m: Vector3<f64>,
        stage_point_m: Vector3<f64>,
    ) -> Result<Self, SpringError> {
        let positive = |x: f64| x > 0.0 && x.is_finite();
        if !positive(stiffness_n_per_m) {
            return Err(SpringError::Stiffness { value: stiffness_n_per_m });
        }
        if !positive(stroke_m) {
            return Err(SpringError::Stroke { value: stroke_m });
        }
        for (body, point) in [("payload", payload_point_m), ("stage", stage_point_m)] {
            if let Some(&value) = point.iter().find(|x| !x.is_finite()) {
                return Err(SpringError::Point { body, value });
            }
        }
        Ok(Self {
            stiffness: stiffness_n_per_m,
            stroke: stroke_m,
            payload_point: payload_point_m,
            stage_point: stage_point_m,
        })
    }

    /// Stiffness k, N/m.
    #[must_use]
    pub fn stiffness_n_per_m(&self) -> f64 {
        self.stiffness
    }

    /// Stroke δ, m.
    #[must_use]
    pub fn stroke_m(&self) -> f64 {
        self.stroke
    }

    /// Attachment on the payload, from its mass centre, body axes, m.
    #[must_use]
    pub fn payload_point_m(&self) -> Vector3<f64> {
        self.payload_point
    }

    /// Attachment on the stage, from its mass centre, body axes, m.
    #[must_use]
    pub fn stage_point_m(&self) -> Vector3<f64> {
        self.stage_point
    }

    /// Energy stored at the start, ½kδ², J.
    #[must_use]
    pub fn stored_energy(&self) -> f64 {
        0.5 * self.stiffness * self.stroke * self.stroke
    }
}

/// The serialized form.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Fields {
    stiffness_n_per_m: f64,
    stroke_m: f64,
    payload_point_m: [f64; 3],
    stage_point_m: [f64; 3],
}

#[cfg(feature = "serde")]
impl TryFrom<Fields> for Spring {
    type Error = SpringError;

    fn try_from(f: Fields) -> Result<Self, SpringError> {
        let (payload, stage) = (f.payload_point_m.into(), f.stage_point_m.into());
        Self::new(f.stiffness_n_per_m, f.stroke_m, payload, stage)
    }
}

#[cfg(feature = "serde")]
impl From<Spring> for Fields {
    fn from(spring: Spring) -> Self {
        Self {
            stiffness_n_per_m: spring.stiffness,
            stroke_m: spring.stroke,
            payload_point_m: spring.payload_point.into(),
            stage_point_m: spring.stage_point.into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_springs_are_refused() {
        let o = Vector3::zeros();
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(Spring::new(bad, 1.0, o, o), Err(SpringError::Stiffness { .. })));
            assert!(matches!(Spring::new(1.0, bad, o, o), Err(SpringError::Stroke { .. })));
        }
        let nan = Vector3::new(0.0, f64::NAN, 0.0);
        let error = Spring::new(1.0, 1.0, o, nan).unwrap_err();
        assert!(matches!(error, SpringError::Point { body: "stage", .. }));
        assert_eq!(Spring::new(2.0, 3.0, o, o).unwrap().stored_energy(), 9.0);
    }

    #[cfg(feature = "serde")]
    #[test]
    fn serde_goes_through_the_constructor() {
        let spring = Spring::new(2.0, 3.0, Vector3::x(), Vector3::y()).unwrap();
        let json = serde_json::to_string(&spring).unwrap();
        assert_eq!(serde_json::from_str::<Spring>(&json).unwrap(), spring);
        assert!(serde_json::from_str::<Spring>(&json.replace("2.0", "-2.0")).is_err());
    }
}
