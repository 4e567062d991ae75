//! An estimate of the ten parameters with its covariance, as an identification or a posterior gives it.

use gyradius_dispersion::{CovarianceError, TenParameters};
use gyradius_inertia::MassProperties;
use nalgebra::{Matrix3, Matrix4, SMatrix, SVector, Vector3};

use crate::rollup::symmetric::{ENTRIES, with_eigenvalues};

pub(super) type Ten = SVector<f64, 10>;
pub(super) type Matrix10 = SMatrix<f64, 10, 10>;

/// Rounding that an eigenvalue of the correlations may carry, and an entry of them.
const ROUNDING: f64 = 1e-7;
/// What the check of a covariance that has been checked may change, of a correlation.
#[cfg(feature = "serde")]
const WRITTEN: f64 = 1e-13;
/// The largest number, and the smallest scale, so that products of four do not leave the range of floats.
const MOST: f64 = 1e40;

/// Which ten numbers an estimate has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum TenForm {
    /// m, m c₁, m c₂, m c₃, I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃ about the origin, in which the equations of motion are linear.
    Linear,
    /// m, c₁, c₂, c₃, I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃ about the mass centre.
    Natural,
}

impl TenForm {
    /// The ten of a body.
    pub(super) fn of(self, body: TenParameters) -> Ten {
        match self {
            Self::Linear => body.linear(),
            Self::Natural => body.values().into(),
        }
    }

    /// Mass, mass centre and inertia about it, whether of a body or not; none where m c is given and the mass is not positive, or
    /// numbers leave the range.
    #[must_use]
    pub fn natural(self, ten: &SVector<f64, 10>) -> Option<TenParameters> {
        let mut values: [f64; 10] = (*ten).into();
        if self == Self::Linear {
            let m = values[0];
            if !(m > 0.0) {
                return None;
            }
            let h = Vector3::new(values[1], values[2], values[3]);
            let c = h / m;
            let added = Matrix3::identity() * h.dot(&c) - h * c.transpose();
            values[1..4].copy_from_slice(c.as_slice());
            for (value, entry) in values[4..].iter_mut().zip(ENTRIES) {
                *value -= added[entry];
            }
        }
        values[0].is_finite().then_some(())?;
        TenParameters::from_values(values).ok()
    }

    /// The body of ten numbers, if they are those of one.
    pub(super) fn body(self, ten: &Ten) -> Option<MassProperties> {
        MassProperties::try_from(self.natural(ten)?).ok()
    }

    /// The matrix that is positive semidefinite for a body and for nothing else: the pseudo-inertia, or the second moments about the
    /// mass centre beside the mass. It is linear in the ten.
    pub(super) fn cone(self, ten: &Ten) -> Matrix4<f64> {
        let inertia = Matrix3::from_fn(|i, j| {
            let entry = ENTRIES.iter().position(|&(a, b)| (a, b) == (i.min(j), i.max(j)));
            ten[4 + entry.unwrap_or(0)]
        });
        let second = Matrix3::identity() * (0.5 * inertia.trace()) - inertia;
        let mut cone = Matrix4::zeros();
        cone.fixed_view_mut::<3, 3>(0, 0).copy_from(&second);
        cone[(3, 3)] = ten[0];
        if self == Self::Linear {
            for i in 0..3 {
                cone[(i, 3)] = ten[1 + i];
                cone[(3, i)] = ten[1 + i];
            }
        }
        cone
    }

    /// What the ten are in SI if they are one in units of a mass and a length.
    pub(super) fn scales(self, mass: f64, length: f64) -> Ten {
        let first = match self {
            Self::Linear => mass * length,
            Self::Natural => length,
        };
        Ten::from_fn(|i, _| match i {
            0 => mass,
            1..=3 => first,
            _ => mass * length * length,
        })
    }
}

/// Ten parameters and their covariance: of an identification, of a Bayesian posterior. They may be those of no body, and the
/// covariance may be singular.
#[derive(Clone, Debug, PartialEq, getset::CopyGetters)]
pub struct TenEstimate {
    /// Which ten numbers it has.
    #[getset(get_copy = "pub")]
    form: TenForm,
    mean: Ten,
    covariance: Matrix10,
}

impl TenEstimate {
    /// From the mean and the covariance of ten numbers, in kg, m (or kg·m) and kg·m², products as tensor entries.
    ///
    /// # Errors
    /// A number is not finite or beyond 1e40, the covariance is not symmetric or has a negative eigenvalue, what has no variance has a
    /// covariance, or there is neither a mass nor a deviation of it.
    pub fn new(
        form: TenForm,
        mean: SVector<f64, 10>,
        covariance: SMatrix<f64, 10, 10>,
    ) -> Result<Self, TenEstimateError> {
        if let Some(i) = mean.iter().position(|x| !(x.abs() <= MOST)) {
            return Err(TenEstimateError::Mean { parameter: i + 1, value: mean[i] });
        }
        for row in 0..10 {
            for column in 0..10 {
                let value = covariance[(row, column)];
                if !(value.abs() <= MOST * MOST) || (row == column && value < 0.0) {
                    let (row, column, max) = (row + 1, column + 1, MOST * MOST);
                    return Err(CovarianceError::Entry { row, column, value, max }.into());
                }
            }
        }
        let deviations = covariance.diagonal().map(f64::sqrt);
        let mut correlation = Matrix10::identity();
        for row in 0..10 {
            for column in 0..row {
                let (lower, upper) = (covariance[(row, column)], covariance[(column, row)]);
                let size = deviations[row] * deviations[column];
                if !((lower - upper).abs() <= ROUNDING * size) {
                    let (row, column) = (column + 1, row + 1);
                    return Err(CovarianceError::NotSymmetric { row, column, upper, lower }.into());
                }
                if size > 0.0 {
                    let value = 0.5 * (lower / deviations[row] + upper / deviations[row])
                        / deviations[column];
                    correlation[(row, column)] = value;
                    correlation[(column, row)] = value;
                } else if lower != 0.0 {
                    let fixed = if deviations[column] == 0.0 { column } else { row } + 1;
                    let (row, column) = (column + 1, row + 1);
                    return Err(TenEstimateError::Fixed { row, column, value: lower, fixed });
                }
            }
        }
        let mut least = f64::INFINITY;
        let seen = std::cell::Cell::new(least);
        let clipped = with_eigenvalues(&correlation, |x| {
            seen.set(seen.get().min(x));
            x.max(0.0)
        });
        least = least.min(seen.get());
        if !(least >= -ROUNDING) {
            return Err(TenEstimateError::Indefinite { eigenvalue: least });
        }
        if !(mean[0] > 0.0 || deviations[0] > 0.0) {
            return Err(TenEstimateError::NoMass { value: mean[0] });
        }
        // What rounding made negative is zero, the deviations being kept.
        let kept = if least < 0.0 { clipped } else { correlation };
        let covariance = Matrix10::from_fn(|i, j| {
            let own = kept[(i, j)] / (kept[(i, i)] * kept[(j, j)]).sqrt();
            deviations[i] * deviations[j] * if i == j { 1.0 } else { own }
        });
        Ok(Self { form, mean, covariance })
    }

    /// The mean.
    #[must_use]
    pub fn mean(&self) -> &SVector<f64, 10> {
        &self.mean
    }

    /// The covariance.
    #[must_use]
    pub fn covariance(&self) -> &SMatrix<f64, 10, 10> {
        &self.covariance
    }

    /// The standard deviations.
    #[must_use]
    pub fn deviations(&self) -> [f64; 10] {
        self.covariance.diagonal().map(f64::sqrt).into()
    }

    /// In the ten numbers about the mass centre, to first order: c = h/m, I_c = I − m (cᵀc·1 − c cᵀ) of the means, and G C Gᵀ of the
    /// covariance with the derivatives G of these at the mean. Where the mass varies by 10 % that leaves away terms of the
    /// order of 1 %: an estimate is better given as it is. None if the mass is not positive.
    #[must_use]
    pub fn to_natural(&self) -> Option<Self> {
        let Self { form, mean, covariance } = self.to_natural_with_rounding()?;
        // Covariances with what does not vary are rounding.
        let varies = |i: usize| covariance[(i, i)] > 0.0;
        let exact = |i, j| if varies(i) && varies(j) { covariance[(i, j)] } else { 0.0 };
        Self::new(form, mean, Matrix10::from_fn(exact)).ok()
    }

    /// The same, with eigenvalues that rounding may have made negative.
    pub(super) fn to_natural_with_rounding(&self) -> Option<Self> {
        let mean = TenForm::Natural.of(self.form.natural(&self.mean)?);
        if self.form == TenForm::Natural {
            return Some(self.clone());
        }
        // By the inverse of the derivatives of the linear ten, which are simpler.
        let (m, c) = (mean[0], Vector3::new(mean[1], mean[2], mean[3]));
        let mut by = Matrix10::identity();
        let lever = |a: &Vector3<f64>, b: &Vector3<f64>| {
            Matrix3::identity() * (2.0 * a.dot(b)) - a * b.transpose() - b * a.transpose()
        };
        let own = lever(&c, &c) * 0.5;
        for (e, entry) in ENTRIES.into_iter().enumerate() {
            by[(4 + e, 0)] = own[entry];
            for k in 0..3 {
                by[(4 + e, 1 + k)] = m * lever(&c, &Vector3::ith(k, 1.0))[entry];
            }
        }
        for k in 0..3 {
            by[(1 + k, 0)] = c[k];
            by[(1 + k, 1 + k)] = m;
        }
        let back = by.try_inverse()?;
        let covariance = back * self.covariance * back.transpose();
        let covariance = (covariance + covariance.transpose()) * 0.5;
        Some(Self { form: TenForm::Natural, mean, covariance })
    }

    /// The same covariance about another mean.
    pub(super) fn at(&self, mean: Ten) -> Self {
        Self { mean, ..self.clone() }
    }

    /// Other moments in the same form.
    pub(super) fn with(&self, mean: &Ten, covariance: &Matrix10) -> Self {
        Self { form: self.form, mean: *mean, covariance: *covariance }
    }

    /// The same in units in which the ten are about one, and these units: kg and m.
    pub(super) fn unitless(&self) -> (Self, [f64; 2]) {
        let size = |i: usize| self.mean[i].abs().max(self.covariance[(i, i)].sqrt());
        let largest = |range: std::ops::Range<usize>| range.map(size).fold(0.0, f64::max);
        let mass = size(0);
        let gyration = (largest(4..10) / mass).sqrt();
        let lever = match self.form {
            TenForm::Linear => largest(1..4) / mass,
            TenForm::Natural => largest(1..4),
        };
        let length = [gyration, lever, 1.0].into_iter().find(|x| *x > 0.0 && x.is_finite());
        let length = length.unwrap_or(1.0);
        let scales = self.form.scales(mass, length);
        let mean = self.mean.component_div(&scales);
        let covariance = Matrix10::from_fn(|i, j| self.covariance[(i, j)] / scales[i] / scales[j]);
        (Self { form: self.form, mean, covariance }, [mass, length])
    }
}

gyradius_dispersion::written!(
    TenEstimate,
    |estimate| {
        form: TenForm = estimate.form,
        mean: [f64; 10] = estimate.mean.into(),
        covariance: [[f64; 10]; 10] = estimate.covariance.transpose().into(),
    },
    {
        let covariance = Matrix10::from(covariance).transpose();
        let checked = TenEstimate::new(form, mean.into(), covariance)?;
        // What was written of an estimate is as it was: to be checked again would round it again.
        let size = |i: usize| covariance[(i, i)].sqrt();
        let is_written = covariance == covariance.transpose()
            && (0..100).map(|k| (k / 10, k % 10)).all(|(i, j)| {
                let change = covariance[(i, j)] - checked.covariance[(i, j)];
                change.abs() <= WRITTEN * size(i) * size(j)
            });
        if is_written { TenEstimate { covariance, ..checked } } else { checked }
    }
);

/// Why numbers are no [`TenEstimate`].
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TenEstimateError {
    /// A mean.
    #[error("parameter {parameter} = {value:?}: it must be finite and at most {MOST:e}")]
    Mean {
        /// Which, from 1.
        parameter: usize,
        /// The value.
        value: f64,
    },
    /// An entry of the covariance, or two that are not the same.
    #[error(transparent)]
    Covariance(#[from] CovarianceError),
    /// A covariance with a parameter that does not vary.
    #[error(
        "covariance entry ({row}, {column}) = {value:?}: it must be 0, for the variance of parameter {fixed} is 0"
    )]
    Fixed {
        /// Row of the entry above the diagonal, from 1.
        row: usize,
        /// Its column, from 1.
        column: usize,
        /// The entry.
        value: f64,
        /// The parameter that does not vary, from 1.
        fixed: usize,
    },
    /// Some combination would have a negative variance.
    #[error("the correlations have an eigenvalue of {eigenvalue:.3e}: none may be negative")]
    Indefinite {
        /// The smallest eigenvalue.
        eigenvalue: f64,
    },
    /// There is no mass.
    #[error("mass = {value:?} kg without a deviation: it must be positive, or vary")]
    NoMass {
        /// The value.
        value: f64,
    },
}
