//! Log-Cholesky coordinates of mass properties.

use nalgebra::Matrix3;

use crate::mass_properties::{INERTIA, check_lost};
use crate::second_moment_matrix::{inertia_of, nearest};
use crate::{MassProperties, MassPropertiesError, RELATIVE_TOLERANCE};

/// Names of the coordinates, in order.
const NAMES: [&str; 10] = ["alpha", "d1", "d2", "d3", "s12", "s23", "s13", "t1", "t2", "t3"];

/// Why there is no body with given log-Cholesky coordinates, or no coordinates of a body.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LogCholeskyError {
    /// A coordinate is NaN or infinite.
    #[error("log-Cholesky coordinate {name} = {value:?}: it must be finite")]
    Coordinate {
        /// Its name.
        name: &'static str,
        /// The value.
        value: f64,
    },
    /// Rods, plates and points lie at infinity.
    #[error(
        "second moments {:?}, {:?} and {:?} kg·m²: all must be positive, because a rod, a plate or a \
         point has no log-Cholesky coordinates", .second_moments[0], .second_moments[1],
        .second_moments[2]
    )]
    Singular {
        /// K_k about the principal axes, kg·m².
        second_moments: [f64; 3],
    },
    /// The exponentials leave the range of mass properties.
    #[error(transparent)]
    MassProperties(#[from] MassPropertiesError),
}

/// Log-Cholesky coordinates of a body: ten numbers without constraints, in the order
/// (α, d₁, d₂, d₃, s₁₂, s₂₃, s₁₃, t₁, t₂, t₃) of Rucker & Wensing (2022),
/// doi:10.1109/LRA.2022.3144517. The pseudo-inertia is J = U Uᵀ with
///
/// ```text
/// U = exp(α) | exp(d₁)  s₁₂      s₁₃      t₁ |
///            | 0        exp(d₂)  s₂₃      t₂ |
///            | 0        0        exp(d₃)  t₃ |
///            | 0        0        0        1  |
/// ```
///
/// so that m = exp(2α), t is the mass centre (m), and Σ_c/m = V Vᵀ about it with V the upper left
/// block over exp(α). Every finite choice is a body with J ≻ 0, as far as exponentials do not
/// overflow, and every such body has one choice: optimisers and samplers need no constraints.
/// Lengths are in m: exp(d_k), s and t scale with the unit.
///
/// ```
/// use gyradius_inertia::{LogCholesky, Shape};
///
/// let body = Shape::solid_box([1.0, 2.0, 3.0])?.of_mass(12.0)?;
/// let mut coordinates = LogCholesky::of(&body)?.values();
/// coordinates[0] += 0.5 * 2f64.ln();
/// let twice_as_dense = LogCholesky::new(coordinates)?.mass_properties()?;
/// assert!((twice_as_dense.mass_kg() - 24.0).abs() < 1e-13);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "[f64; 10]", into = "[f64; 10]"))]
pub struct LogCholesky([f64; 10]);

impl LogCholesky {
    /// Takes α, d₁, d₂, d₃, s₁₂, s₂₃, s₁₃, t₁, t₂, t₃.
    ///
    /// # Errors
    /// A coordinate is not finite.
    pub fn new(values: [f64; 10]) -> Result<Self, LogCholeskyError> {
        match values.iter().position(|x| !x.is_finite()) {
            Some(i) => Err(LogCholeskyError::Coordinate { name: NAMES[i], value: values[i] }),
            None => Ok(Self(values)),
        }
    }

    /// The coordinates of a body.
    ///
    /// # Errors
    /// The body is a rod, a plate or a point: a K_k is zero, or not above
    /// [`RELATIVE_TOLERANCE`] of the largest.
    pub fn of(body: &MassProperties) -> Result<Self, LogCholeskyError> {
        let second_moments = body.inertia().second_moments().values();
        let singular = LogCholeskyError::Singular { second_moments };
        let size = second_moments.into_iter().fold(0.0, f64::max);
        if !second_moments.iter().all(|&k| k > RELATIVE_TOLERANCE * size) {
            return Err(singular);
        }
        // V Vᵀ = Σ_c/m with V upper triangular, from the last row up; in units of √(size/m).
        let s = body.inertia().as_inertia_matrix().second_moment_matrix().map(|x| x / size);
        let v33 = s[(2, 2)].sqrt();
        let (v23, v13) = (s[(1, 2)] / v33, s[(0, 2)] / v33);
        let v22 = (s[(1, 1)] - v23 * v23).sqrt();
        let v12 = (s[(0, 1)] - v13 * v23) / v22;
        let v11 = (s[(0, 0)] - v12 * v12 - v13 * v13).sqrt();
        if !(v11 > 0.0 && v22 > 0.0 && v33 > 0.0) {
            return Err(singular);
        }
        let (mass, t) = (body.mass_kg(), body.mass_centre_m());
        let length = size.sqrt() / mass.sqrt();
        let alpha = 0.5 * libm::log(mass);
        let ln_length = 0.5 * libm::log(size) - alpha;
        let d = [v11, v22, v33].map(|v| libm::log(v) + ln_length);
        Self::new([
            alpha,
            d[0],
            d[1],
            d[2],
            v12 * length,
            v23 * length,
            v13 * length,
            t.x,
            t.y,
            t.z,
        ])
    }

    /// α, d₁, d₂, d₃, s₁₂, s₂₃, s₁₃, t₁, t₂, t₃.
    #[must_use]
    pub fn values(&self) -> [f64; 10] {
        self.0
    }

    /// The body with these coordinates.
    ///
    /// # Errors
    /// The mass over- or underflows (|α| above some 350), so does the inertia
    /// ([`Lost`](MassPropertiesError::Lost)), or the mass centre is too far.
    pub fn mass_properties(&self) -> Result<MassProperties, LogCholeskyError> {
        let [alpha, d1, d2, d3, s12, s23, s13, t1, t2, t3] = self.0;
        let point = MassProperties::point(libm::exp(2.0 * alpha), [t1, t2, t3])?;
        // √m V, so that squares are second moments.
        let root = libm::exp(alpha);
        let [v11, v22, v33] = [d1, d2, d3].map(|d| libm::exp(alpha + d));
        let [v12, v23, v13] = [s12, s23, s13].map(|s| root * s);
        let (s12, s13, s23) = (v12 * v22 + v13 * v23, v13 * v33, v23 * v33);
        let s11 = v11 * v11 + v12 * v12 + v13 * v13;
        let s22 = v22 * v22 + v23 * v23;
        let sigma = Matrix3::new(s11, s12, s13, s12, s22, s23, s13, s23, v33 * v33);
        check_lost("mass, kg", point.mass_kg())?;
        // No coordinates are those of a point.
        check_lost(INERTIA, inertia_of(&sigma).amax())?;
        let inertia = nearest(inertia_of(&sigma)).map_err(MassPropertiesError::from)?;
        Ok(MassProperties::new(point.mass_kg(), point.mass_centre_m(), inertia)?)
    }
}

crate::array_form::array_form!(
    LogCholesky as [f64; 10], refused by LogCholeskyError,
    |values| Self::new(values),
    |coordinates| coordinates.0
);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mass_properties::tests::{any_body, distance};
    use crate::{PseudoInertia, Shape};
    use nalgebra::Matrix4;
    use proptest::prelude::*;

    #[test]
    fn bodies_at_the_boundary_have_no_coordinates() {
        let flat = [Shape::rod(1.0), Shape::plate([1.0, 2.0]), Shape::sphere(0.0)];
        for shape in flat {
            let body = shape.unwrap().of_mass(2.0).unwrap();
            let error = LogCholesky::of(&body).unwrap_err();
            assert!(matches!(error, LogCholeskyError::Singular { .. }));
            assert!(error.to_string().contains("a rod, a plate or a point"), "{error}");
            let turned = body.rotated(&nalgebra::UnitQuaternion::from_euler_angles(0.3, 0.7, 2.0));
            assert!(LogCholesky::of(&turned.unwrap()).is_err(), "in any frame");
        }
    }

    #[test]
    fn what_no_exponential_can_hold_is_refused() {
        let with = |i: usize, x: f64| {
            let mut values = [0.0; 10];
            values[i] = x;
            LogCholesky::new(values).and_then(|c| c.mass_properties())
        };
        assert_eq!(
            with(6, f64::NAN).unwrap_err().to_string(),
            "log-Cholesky coordinate s13 = NaN: it must be finite"
        );
        for (i, x) in [(0, 400.0), (0, -400.0), (1, 400.0), (4, 1e200), (9, 1e300)] {
            assert!(matches!(with(i, x), Err(LogCholeskyError::MassProperties(_))), "{i} {x}");
        }
        // exp(−800) = 0: a plate, which is a body.
        assert!(with(3, -800.0).is_ok());
    }

    /// Sizes from 1e-30 to 1e30 m, masses from 1e-60 to 1e60 kg.
    fn any_coordinates() -> impl Strategy<Value = [f64; 10]> {
        let free = prop::array::uniform9(-1.0..1.0f64);
        (free, -69.0..69.0f64, -69.0..69.0f64).prop_map(
            |([a, b, c, d, e, f, g, h, i], mass, size)| {
                let l = size.exp();
                [mass, size + a, size + b, size + c, l * d, l * e, l * f, l * g, l * h, l * i]
            },
        )
    }

    proptest! {
        #[test]
        fn coordinates_come_back_at_any_scale(values in any_coordinates()) {
            let body = LogCholesky::new(values).unwrap().mass_properties().unwrap();
            let back = LogCholesky::of(&body).unwrap().values();
            let length = (values[1].max(values[2]).max(values[3])).exp();
            for (i, (a, b)) in values.iter().zip(back).enumerate() {
                let unit = if i < 4 { 1.0 } else { length };
                prop_assert!((a - b).abs() < 1e-12 * unit, "{} {a} {b}", NAMES[i]);
            }
        }

        /// The definition, as a product of 4×4 matrices.
        #[test]
        fn the_factor_times_its_transpose_is_the_pseudo_inertia(
            x in prop::array::uniform10(-1.0..1.0f64),
        ) {
            let [a, d1, d2, d3, s12, s23, s13, t1, t2, t3] = x;
            let u = a.exp() * Matrix4::new(
                d1.exp(), s12, s13, t1,
                0.0, d2.exp(), s23, t2,
                0.0, 0.0, d3.exp(), t3,
                0.0, 0.0, 0.0, 1.0,
            );
            let body = LogCholesky::new(x).unwrap().mass_properties().unwrap();
            let pseudo = PseudoInertia::of(&body).unwrap();
            prop_assert!((u * u.transpose() - pseudo.matrix()).amax() < 1e-13 * pseudo.matrix().amax());
        }

        /// To the ends of the exponential: what comes out has the coordinates that went in.
        #[test]
        fn coordinates_come_back_or_are_refused(
            (alpha, length) in (-400.0..400.0f64, -400.0..400.0f64),
            free in prop::array::uniform3(-1.0..1.0f64),
        ) {
            let d = free.map(|x| length + x);
            let values = [alpha, d[0], d[1], d[2], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
            // ln of the mass and of the largest second moment, which the range of floats bounds.
            let mass = 2.0 * alpha;
            let largest = mass + 2.0 * d.into_iter().fold(f64::MIN, f64::max);
            match LogCholesky::new(values).unwrap().mass_properties() {
                Ok(body) => {
                    prop_assert!(mass > -708.5 && largest > -709.5 && largest < 708.0);
                    let back = LogCholesky::of(&body).unwrap().values();
                    for (i, (a, b)) in values.iter().zip(back).enumerate().take(4) {
                        prop_assert!((a - b).abs() < 1e-11, "{} {} {}", NAMES[i], a, b);
                    }
                }
                Err(error) => prop_assert!(
                    mass.abs() > 707.0 || !(-707.0..704.0).contains(&largest),
                    "{} {} {}", error, mass, largest
                ),
            }
        }

        #[test]
        fn bodies_come_back(body in any_body()) {
            if let Ok(coordinates) = LogCholesky::of(&body) {
                let back = coordinates.mass_properties().unwrap();
                prop_assert!(distance(&back, &body) < 1e-12);
            } else {
                let k = body.inertia().second_moments().values();
                prop_assert!(k.iter().any(|k| *k < 1e-12));
            }
        }

        #[test]
        fn no_input_panics(values in prop::array::uniform10(prop::num::f64::ANY)) {
            let _ = LogCholesky::new(values).and_then(|c| c.mass_properties());
        }
    }

    #[cfg(feature = "serde")]
    #[test]
    fn serde_goes_through_the_constructor() {
        let json = "[0.0,1.0,1.0,1.0,0.0,0.0,0.0,0.5,0.0,0.0]";
        let coordinates: LogCholesky = serde_json::from_str(json).unwrap();
        assert_eq!(serde_json::to_string(&coordinates).unwrap(), json);
        assert!(serde_json::from_str::<LogCholesky>("[0.0,1.0]").is_err());
    }
}
