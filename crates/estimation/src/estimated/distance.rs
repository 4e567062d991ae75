//! How far the moments of a law are from those of an estimate.

use gyradius_dispersion::{MassPropertiesModel, TenMoments};
use nalgebra::DVector;

use super::nearest::metric;
use super::ten_estimate::{Matrix10, Ten, TenEstimate, TenForm};

/// Below this the moments are those of the estimate.
const EXACT: f64 = 1e-5;

/// How far the mean and covariance of a law are from those of the estimate that it was made of, in the ten numbers of the estimate.
#[derive(Clone, Copy, Debug, PartialEq, getset::CopyGetters, getset::Getters)]
pub struct EstimateDistance {
    /// The mean of each of the ten less that of the estimate, in its standard deviations; none of what does not vary.
    #[getset(get = "pub")]
    means: [Option<f64>; 10],
    /// By how many percent the standard deviation of each of the ten is larger than that of the estimate; none of what does not vary.
    #[getset(get = "pub")]
    deviation_percents: [Option<f64>; 10],
    /// The Mahalanobis distance of the means: √(dᵀ C⁻¹ d) with the covariance of the estimate, in which what does not vary counts as
    /// varying by 1e-6 of its size.
    #[getset(get_copy = "pub")]
    mahalanobis: f64,
    /// The largest difference of a correlation.
    #[getset(get_copy = "pub")]
    correlation: f64,
    /// What laws are made to have as small as they can: the root of the sum of the squares of the differences of means in deviations,
    /// of half the relative differences of variances, and of covariances over the stated deviations (of each pair once). For small
    /// differences the last two are the relative differences of deviations and the differences of correlations.
    #[getset(get_copy = "pub")]
    total: f64,
}

gyradius_dispersion::written!(
    EstimateDistance,
    |distance| {
        means: [Option<f64>; 10] = distance.means,
        deviations: [Option<f64>; 10] = distance.deviation_percents,
        mahalanobis: f64 = distance.mahalanobis,
        correlation: f64 = distance.correlation,
        total: f64 = distance.total,
    },
    {
        crate::read::belong(mahalanobis >= 0.0 && correlation >= 0.0 && total >= 0.0, "distance")?;
        EstimateDistance { means, deviation_percents: deviations, mahalanobis, correlation, total }
    }
);

impl EstimateDistance {
    /// Of moments in the units of the estimate.
    pub(super) fn of(estimate: &TenEstimate, moments: &TenMoments) -> Option<Self> {
        let stated = estimate.deviations();
        let found = moments.deviations();
        let gap = moments.mean() - estimate.mean();
        let varies = |i: usize| stated[i] > 0.0;
        let correlation = |c: &Matrix10, s: &[f64; 10], i: usize, j: usize| {
            let size = s[i] * s[j];
            if size > 0.0 { c[(i, j)] / size } else { 0.0 }
        };
        let mut largest = 0f64;
        for i in 0..10 {
            for j in 0..i {
                if varies(i) && varies(j) {
                    let own = correlation(moments.covariance(), &found, i, j);
                    let known = correlation(estimate.covariance(), &stated, i, j);
                    largest = largest.max((own - known).abs());
                }
            }
        }
        let square = gap.dot(&(metric(estimate)? * gap));
        Some(Self {
            means: std::array::from_fn(|i| varies(i).then(|| gap[i] / stated[i])),
            deviation_percents: std::array::from_fn(|i| {
                varies(i).then(|| 100.0 * (found[i] / stated[i] - 1.0))
            }),
            mahalanobis: square.max(0.0).sqrt(),
            correlation: largest,
            total: Gaps::of(estimate, moments).off(),
        })
    }

    /// Whether mean and covariance are those of the estimate, to 1e-5 of the deviations.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.total < EXACT
    }
}

/// Mean and covariance of a law in the form of an estimate.
pub(super) fn moments(law: &dyn MassPropertiesModel, form: TenForm) -> Option<TenMoments> {
    match form {
        TenForm::Linear => law.linear_moments(),
        TenForm::Natural => law.moments(),
    }
}

/// What a search for a law makes small: the [residuals](Gaps::residuals) of its moments. What has no moments, or such as overflow, is far off.
pub(super) fn residuals(
    estimate: &TenEstimate,
    law: Option<&dyn MassPropertiesModel>,
) -> DVector<f64> {
    const FAR: f64 = 1e100;
    let Some(moments) = law.and_then(|law| moments(law, estimate.form())) else {
        return DVector::from_element(65, FAR);
    };
    let residuals = Gaps::of(estimate, &moments).residuals();
    DVector::from_vec(residuals).map(|x| if x.is_finite() { x } else { FAR })
}

/// Differences of means and covariances in units of the stated deviations.
pub(super) struct Gaps {
    pub(super) mean: Ten,
    pub(super) covariance: Matrix10,
    /// The deviations, those of what does not vary some tiny numbers.
    units: Ten,
}

impl Gaps {
    pub(super) fn of(estimate: &TenEstimate, moments: &TenMoments) -> Self {
        let units = units(estimate);
        let mean = estimate.mean() - moments.mean();
        let covariance = estimate.covariance() - moments.covariance();
        Self { mean, covariance, units }
    }

    /// Of means, of deviations relative, of correlations: 65 numbers.
    pub(super) fn residuals(&self) -> Vec<f64> {
        let mut residuals: Vec<f64> = (0..10).map(|i| self.mean[i] / self.units[i]).collect();
        for i in 0..10 {
            for j in 0..=i {
                let gap = self.covariance[(i, j)] / self.units[i] / self.units[j];
                residuals.push(if i == j { 0.5 * gap } else { gap });
            }
        }
        residuals
    }

    pub(super) fn off(&self) -> f64 {
        self.residuals().iter().map(|x| x * x).sum::<f64>().sqrt()
    }
}

/// The stated deviations, and 1e-6 of the size for what does not vary.
pub(super) fn units(estimate: &TenEstimate) -> Ten {
    const STILL: f64 = 1e-6;
    let (_, [mass, length]) = estimate.unitless();
    let scales = estimate.form().scales(mass, length);
    let deviations = estimate.deviations();
    Ten::from_fn(|i, _| if deviations[i] > 0.0 { deviations[i] } else { STILL * scales[i] })
}
