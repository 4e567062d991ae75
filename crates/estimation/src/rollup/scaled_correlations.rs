//! Second moments of which the diagonal and the correlations scatter apart: for products that are wider than the moments.

use nalgebra::{Matrix3, Vector3};
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

use super::correlation_law::CorrelationLaw;
use super::symmetric::{ENTRIES, Matrix6, Six, with_eigenvalues};

/// Largest variance of a logarithm: a deviation of three times the mean.
const MOST: f64 = std::f64::consts::LN_10;
/// Least 1 + covariance in means: products of positive numbers have a positive mean.
const LEAST: f64 = 1e-3;

/// Σᵢᵢ = e^{uᵢ}, jointly lognormal, and Σᵢⱼ = √(Σᵢᵢ Σⱼⱼ) Cᵢⱼ with correlations C drawn apart.
///
/// The diagonal, and with it the moments of inertia, has any mean and nearly any covariance, whatever the products do.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ScaledCorrelations {
    logarithms: Vector3<f64>,
    spread: Matrix3<f64>,
    root: Matrix3<f64>,
    correlations: CorrelationLaw,
}

impl ScaledCorrelations {
    /// Of a mean and a covariance of Σ₁₁, Σ₂₂, Σ₃₃, Σ₁₂, Σ₁₃, Σ₂₃, where covariances of the diagonal with the products are left
    /// away; none if none has this mean.
    pub(super) fn new(mean: &Six, covariance: &Matrix6) -> Option<Self> {
        let logarithm = |i: usize, j: usize| {
            libm::log((1.0 + covariance[(i, j)] / (mean[i] * mean[j])).max(LEAST))
        };
        let spread = Matrix3::from_fn(logarithm);
        let spread = with_eigenvalues(&spread, |x| x.clamp(0.0, MOST));
        if !spread.iter().all(|x| x.is_finite()) {
            return None;
        }
        let root = with_eigenvalues(&spread, |x| x.max(0.0).sqrt());
        let logarithms = Vector3::from_fn(|i, _| libm::log(mean[i]) - 0.5 * spread[(i, i)]);
        let scales = Scales { logarithms: &logarithms, spread: &spread };
        let target = Vector3::from_fn(|a, _| mean[3 + a] / scales.mean(&scales.of(3 + a)));
        let squares = Matrix3::from_fn(|a, b| {
            let product = mean[3 + a] * mean[3 + b] + covariance[(3 + a, 3 + b)];
            product / scales.mean(&(scales.of(3 + a) + scales.of(3 + b)))
        });
        let correlations = CorrelationLaw::new(&target, &squares)?;
        Some(Self { logarithms, spread, root, correlations })
    }

    /// Covariance of the six entries.
    pub(super) fn covariance(&self) -> Matrix6 {
        let scales = Scales { logarithms: &self.logarithms, spread: &self.spread };
        let (first, second) = self.correlations.moments();
        let mean = |e: usize| if e < 3 { 1.0 } else { first[e - 3] };
        Matrix6::from_fn(|e, f| {
            let both = match (e < 3, f < 3) {
                (true, _) => mean(f),
                (_, true) => mean(e),
                (false, false) => second[(e - 3, f - 3)],
            };
            let (a, b) = (scales.of(e), scales.of(f));
            scales.mean(&(a + b)) * both - scales.mean(&a) * mean(e) * scales.mean(&b) * mean(f)
        })
    }
}

impl Distribution<Matrix3<f64>> for ScaledCorrelations {
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> Matrix3<f64> {
        let mut normal = || Vector3::from_fn(|_, _| StandardNormal.sample(rng));
        let lengths = (self.logarithms + self.root * normal()).map(|u| libm::exp(0.5 * u));
        let c = self.correlations.at(&normal());
        let c = Matrix3::new(1.0, c.x, c.y, c.x, 1.0, c.z, c.y, c.z, 1.0);
        Matrix3::from_fn(|i, j| lengths[i] * lengths[j] * c[(i, j)])
    }
}

/// Means of e^{aᵀu}.
struct Scales<'a> {
    logarithms: &'a Vector3<f64>,
    spread: &'a Matrix3<f64>,
}

impl Scales<'_> {
    /// The a of an entry: √(Σᵢᵢ Σⱼⱼ) = e^{(uᵢ + uⱼ)/2}.
    fn of(&self, entry: usize) -> Vector3<f64> {
        let (i, j) = ENTRIES[entry];
        Vector3::ith(i, 0.5) + Vector3::ith(j, 0.5)
    }

    fn mean(&self, a: &Vector3<f64>) -> f64 {
        libm::exp(a.dot(self.logarithms) + 0.5 * a.dot(&(self.spread * a)))
    }
}
