//! The ten mass properties of a body with their covariance, and those of many bodies together to first order.

use gyradius_dispersion::TenParameters;
use gyradius_inertia::{MassProperties, MassPropertiesError};
use nalgebra::{Matrix3, SMatrix, Vector3};

use super::symmetric::{Six, six};

/// Units of the ten, in the order of [`TenParameters::COLUMNS`].
pub const TEN_UNITS: [&str; 10] =
    ["kg", "m", "m", "m", "kg·m²", "kg·m²", "kg·m²", "kg·m²", "kg·m²", "kg·m²"];

/// Nominal mass properties and the covariance of the ten numbers: mass (kg), mass centre (m), I₁₁, I₂₂, I₃₃, I₁₂, I₁₃,
/// I₂₃ (kg·m², tensor entries about the mass centre).
#[derive(Clone, Debug, PartialEq, getset::Getters)]
#[getset(get = "pub")]
pub struct FirstOrder {
    /// The nominal body.
    nominal: MassProperties,
    /// Covariance of the ten, in products of their units.
    covariance: SMatrix<f64, 10, 10>,
}

impl FirstOrder {
    pub(super) fn new(nominal: MassProperties, covariance: SMatrix<f64, 10, 10>) -> Self {
        Self { nominal, covariance }
    }

    /// Independent bodies, all described in one frame, as one, to first order.
    ///
    /// The nominal whole is [`MassProperties::combined`]; the covariance is Σᵢ Jᵢ Cᵢ Jᵢᵀ with the exact derivatives Jᵢ of the
    /// ten numbers of the whole by the ten of body i. With d = cᵢ − c from the common mass centre,
    ///
    /// ```text
    /// ∂m/∂mᵢ = 1        ∂c/∂mᵢ = d/m        ∂I/∂mᵢ = |d|²·1 − d dᵀ
    ///                   ∂c/∂cᵢ = mᵢ/m       ∂I/∂cᵢ·δ = mᵢ (2 (d·δ)·1 − d δᵀ − δ dᵀ)        ∂I/∂Iᵢ = 1,
    /// ```
    ///
    /// for the motion of the common mass centre changes I in second order only. Of a diagonal Cᵢ, the diagonal of the
    /// result is that of SAWE paper 3360 (Zimmerman & Nakai 2005). The correlations are what a rollup in several steps
    /// needs: with them, subassemblies give the same whole as the parts at once.
    ///
    /// # Errors
    /// There is no body, or a sum overflows.
    pub fn combined<'a>(
        bodies: impl IntoIterator<Item = &'a Self>,
    ) -> Result<Self, MassPropertiesError> {
        let bodies: Vec<&Self> = bodies.into_iter().collect();
        let whole = MassProperties::combined(bodies.iter().map(|body| body.nominal))?;
        let mut covariance = SMatrix::zeros();
        for body in bodies {
            covariance += body.carried_to(&whole);
        }
        Ok(Self::new(whole, (covariance + covariance.transpose()) * 0.5))
    }

    /// What this body, as one of the independent bodies of a nominal whole, adds to the covariance of the ten of the whole:
    /// J C Jᵀ.
    fn carried_to(&self, whole: &MassProperties) -> SMatrix<f64, 10, 10> {
        let derivative = derivative(whole, &self.nominal);
        derivative * self.covariance * derivative.transpose()
    }

    /// What this body, as one of the independent bodies of a nominal whole, adds to the variances of the ten of the whole,
    /// in squares of their units. Those of all its bodies sum to the variances of [`combined`](Self::combined).
    #[must_use]
    pub fn variances_in(&self, whole: &MassProperties) -> [f64; 10] {
        let added = self.carried_to(whole);
        std::array::from_fn(|i| added[(i, i)].max(0.0))
    }

    /// The ten nominal numbers, as [`TenParameters::COLUMNS`].
    #[must_use]
    pub fn values(&self) -> [f64; 10] {
        TenParameters::from(self.nominal).values()
    }

    /// Standard deviations of the ten.
    #[must_use]
    pub fn deviations(&self) -> [f64; 10] {
        std::array::from_fn(|i| self.covariance[(i, i)].max(0.0).sqrt())
    }

    /// Correlations of the ten; zero where one of two does not vary.
    #[must_use]
    pub fn correlations(&self) -> SMatrix<f64, 10, 10> {
        let deviations = self.deviations();
        SMatrix::from_fn(|i, j| {
            let scale = deviations[i] * deviations[j];
            match (scale > 0.0, i == j) {
                (true, true) => 1.0,
                (true, false) => (self.covariance[(i, j)] / scale).clamp(-1.0, 1.0),
                (false, _) => 0.0,
            }
        })
    }
}

gyradius_dispersion::written!(
    FirstOrder,
    |body| {
        nominal: MassProperties = body.nominal,
        covariance: [[f64; 10]; 10] = body.covariance.transpose().into(),
    },
    {
        let covariance = SMatrix::<f64, 10, 10>::from(covariance).transpose();
        let sound = covariance.iter().all(|x| x.is_finite()) && covariance.diagonal().min() >= 0.0;
        crate::read::belong(sound && covariance == covariance.transpose(), "covariance")?;
        FirstOrder { nominal, covariance }
    }
);

/// The ten numbers of a whole by those of one of its bodies.
fn derivative(whole: &MassProperties, body: &MassProperties) -> SMatrix<f64, 10, 10> {
    let (mass, total) = (body.mass_kg(), whole.mass_kg());
    let d = body.mass_centre_m() - whole.mass_centre_m();
    let lever = |a: &Vector3<f64>, b: &Vector3<f64>| -> Matrix3<f64> {
        Matrix3::identity() * (2.0 * a.dot(b)) - a * b.transpose() - b * a.transpose()
    };
    let mut derivative = SMatrix::<f64, 10, 10>::identity();
    derivative.fixed_view_mut::<3, 1>(1, 0).copy_from(&(d / total));
    let by_mass: Six = six(&(lever(&d, &d) * 0.5));
    derivative.fixed_view_mut::<6, 1>(4, 0).copy_from(&by_mass);
    for axis in 0..3 {
        derivative[(1 + axis, 1 + axis)] = mass / total;
        let by_centre: Six = six(&(lever(&d, &Vector3::ith(axis, 1.0)) * mass));
        derivative.fixed_view_mut::<6, 1>(4, 1 + axis).copy_from(&by_centre);
    }
    derivative
}
