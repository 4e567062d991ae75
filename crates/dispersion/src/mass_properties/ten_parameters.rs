//! The ten numbers of a body, which may be those of none.

use gyradius_inertia::{Inertia, InertiaMatrix, MassProperties, MassPropertiesError};
use nalgebra::{SVector, Vector3};

/// Mass, mass centre and inertia about it: ten numbers, such as the common practice draws them, of which some belong
/// to no body.
///
/// Those of a body are its [`MassProperties`]: `MassProperties::try_from(ten)` says why others are not.
///
/// ```
/// use gyradius_dispersion::TenParameters;
/// use gyradius_inertia::MassProperties;
///
/// let ten = TenParameters::from_values([2.0, 0.0, 0.0, 0.1, 1.0, 1.0, 2.5, 0.0, 0.0, 0.0])?;
/// assert!(MassProperties::try_from(ten).is_err(), "2.5 > 1 + 1");
/// # Ok::<(), gyradius_inertia::MassPropertiesError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct TenParameters {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Mass centre in body axes, m.
    pub mass_centre_m: Vector3<f64>,
    /// Inertia about the mass centre in body axes, kg·m².
    pub inertia: InertiaMatrix,
}

impl TenParameters {
    /// What the ten columns are called, in their order; the last six are in kg·m².
    pub const COLUMNS: [&'static str; 10] = [
        "mass_kg",
        "mass_centre_1_m",
        "mass_centre_2_m",
        "mass_centre_3_m",
        "i11",
        "i22",
        "i33",
        "i12",
        "i13",
        "i23",
    ];

    /// From m, c₁, c₂, c₃, I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃, the last six about the mass centre and the products tensor
    /// entries.
    ///
    /// # Errors
    /// An entry of the inertia is not finite or too large.
    pub fn from_values(values: [f64; 10]) -> Result<Self, MassPropertiesError> {
        let [mass_kg, x, y, z, i11, i22, i33, i12, i13, i23] = values;
        let inertia = InertiaMatrix::from_entries([i11, i22, i33], [i12, i13, i23])?;
        Ok(Self { mass_kg, mass_centre_m: Vector3::new(x, y, z), inertia })
    }

    /// m, c₁, c₂, c₃, I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃ in kg, m and kg·m².
    #[must_use]
    pub fn values(&self) -> [f64; 10] {
        let [x, y, z] = self.mass_centre_m.into();
        let [i11, i22, i33, i12, i13, i23] = self.inertia.entries();
        [self.mass_kg, x, y, z, i11, i22, i33, i12, i13, i23]
    }

    /// The ten in which the equations of motion are linear: m, the first moments m c, and the inertia about the origin
    /// of the body axes, I + m (cᵀc·1 − c cᵀ), in the same order and as tensor entries (Atkeson, An & Hollerbach 1986,
    /// doi:10.1177/027836498600500306).
    #[must_use]
    pub fn linear(&self) -> SVector<f64, 10> {
        let (m, c) = (self.mass_kg, self.mass_centre_m);
        let h = c * m;
        let [i11, i22, i33, i12, i13, i23] = self.inertia.entries();
        SVector::from([
            m,
            h.x,
            h.y,
            h.z,
            i11 + (h.y * c.y + h.z * c.z),
            i22 + (h.x * c.x + h.z * c.z),
            i33 + (h.x * c.x + h.y * c.y),
            i12 - h.x * c.y,
            i13 - h.x * c.z,
            i23 - h.y * c.z,
        ])
    }

    /// Whether some body has these numbers.
    #[must_use]
    pub fn is_realizable(&self) -> bool {
        MassProperties::try_from(*self).is_ok()
    }
}

impl From<MassProperties> for TenParameters {
    fn from(body: MassProperties) -> Self {
        let inertia = *body.inertia().as_inertia_matrix();
        Self { mass_kg: body.mass_kg(), mass_centre_m: body.mass_centre_m(), inertia }
    }
}

/// Whose numbers these are.
impl TryFrom<TenParameters> for MassProperties {
    type Error = MassPropertiesError;

    fn try_from(ten: TenParameters) -> Result<Self, MassPropertiesError> {
        Self::new(ten.mass_kg, ten.mass_centre_m, Inertia::try_from(ten.inertia)?)
    }
}
