//! The Fisher-Bingham law on the sphere S³: densities, normaliser, moments, draws.

use nalgebra::{Complex, Matrix3, Matrix4, Quaternion, UnitQuaternion, Vector4};
use rand::{Rng, RngExt};
use rand_distr::Distribution;
use std::sync::OnceLock;

use crate::{
    CentralMoments, UniformAttitude, cells::Cells, chart::Chart, contour::Contour, jacobi,
};

/// Largest spread of the eigenvalues of P, max − min, that is served to full accuracy.
const MAX_SPREAD: f64 = 1e14;

/// ln π², the measure of the attitudes on half of S³.
pub(crate) const LN_PI_SQUARED: f64 = 2.289_459_771_698_800_3;

/// ln of a share that nothing is seen of beside one.
const NEGLIGIBLE: f64 = -40.0;

/// Why a matrix and a vector are not the parameters of a [`FisherBingham`] law.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FisherBinghamError {
    /// An entry of P is NaN, infinite or too large.
    #[error(
        "P{row}{column} = {value:?}: it must be finite and at most {MAX_SPREAD:e} in magnitude"
    )]
    Precision {
        /// Row, from 1.
        row: usize,
        /// Column, from 1.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// An entry of b is NaN, infinite or too large.
    #[error("b{row} = {value:?}: it must be finite and at most {MAX_SPREAD:e} in magnitude")]
    Linear {
        /// Row, from 1.
        row: usize,
        /// The entry.
        value: f64,
    },
    /// P is not symmetric.
    #[error(
        "P{row}{column} = {upper:?} but P{column}{row} = {lower:?}: the matrix must be symmetric"
    )]
    NotSymmetric {
        /// Row of the upper entry, from 1.
        row: usize,
        /// Column of the upper entry, from 1.
        column: usize,
        /// The entry above the diagonal.
        upper: f64,
        /// The entry below the diagonal.
        lower: f64,
    },
}

/// How a law is sampled; chosen at construction by the known shares of accepted proposals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Method {
    /// Gaussian proposals in a chart of the sphere, three coordinates at a time.
    Chart,
    /// A table of cells of the sphere, bounded one by one.
    Cells,
    /// Uniform proposals.
    Uniform,
}

/// The Fisher-Bingham law on S³.
///
/// # Definition
/// Density ∝ exp(−½ xᵀPx + bᵀx) with respect to surface measure on |x| = 1, for any symmetric P and
/// any b. P and P + μ·1 give the same law. With P = Σ⁻¹ and b = Σ⁻¹m it is a Gaussian N(m, Σ)
/// conditioned on unit length: see [`RadiallyConstrainedGaussian`](crate::RadiallyConstrainedGaussian).
/// With b = 0 it is Bingham's law, with P = 0 von Mises-Fisher's.
///
/// # Algorithm
/// Rejection, exact and independent, from one of three proposals ([`Method`]), more than half of which
/// are accepted: [`acceptance`](Self::acceptance) says how many. The proposals are set up when the law
/// is first drawn from: in microseconds, for [`Method::Cells`] in some milliseconds. Normaliser and
/// moments by a contour integral, to about 1e-13 of the largest of |b|, the entries of P and one.
///
/// # Limits
/// Entries up to 1e14.
#[derive(Clone, Debug, getset::CopyGetters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Parameters", into = "Parameters"))]
pub struct FisherBingham {
    /// P and b, if the law was made of them.
    given: Option<Box<(Matrix4<f64>, Vector4<f64>)>>,
    /// x = V y.
    axes: Matrix4<f64>,
    /// The density in y is ∝ exp(−½ Σ λ(y − c)²), |c| ≤ 1, λ > 0.
    lambda: [f64; 4],
    centre: [f64; 4],
    contour: Box<Contour>,
    /// ln of exp(−½xᵀPx + bᵀx) over exp(−½ Σ λ(y − c)²).
    ln_offset: f64,
    /// The mean E x of the four coordinates, a vector inside the unit ball.
    #[getset(get_copy = "pub")]
    mean_vector: Vector4<f64>,
    /// The second moment E xxᵀ, of trace one.
    #[getset(get_copy = "pub")]
    second_moment: Matrix4<f64>,
    /// Of y about its mean.
    covariance: Matrix4<f64>,
    /// Set up at the first need: many laws are made for their moments only.
    sampler: OnceLock<Sampler>,
}

/// Of the same exponent in the same coordinates, from which all else follows.
impl PartialEq for FisherBingham {
    fn eq(&self, other: &Self) -> bool {
        let parts = |law: &Self| (law.axes, law.lambda, law.centre, law.ln_offset);
        parts(self) == parts(other)
    }
}

#[derive(Clone, Debug)]
enum Sampler {
    Chart(Box<Chart>),
    Cells(Cells),
    /// With the acceptance, and the exponent that no point of the sphere exceeds.
    Uniform {
        acceptance: f64,
        ln_bound: f64,
    },
}

impl FisherBingham {
    /// The law with density ∝ exp(−½ xᵀPx + bᵀx), x scalar last.
    ///
    /// # Errors
    /// An entry is not finite or larger than 1e14, or P is not symmetric to rounding.
    pub fn new(precision: Matrix4<f64>, linear: Vector4<f64>) -> Result<Self, FisherBinghamError> {
        for row in 0..4 {
            for column in 0..4 {
                let value = precision[(row, column)];
                if !(value.abs() <= MAX_SPREAD) {
                    let (row, column) = (row + 1, column + 1);
                    return Err(FisherBinghamError::Precision { row, column, value });
                }
            }
            let value = linear[row];
            if !(value.abs() <= MAX_SPREAD) {
                return Err(FisherBinghamError::Linear { row: row + 1, value });
            }
        }
        let size = precision.amax();
        let precision = symmetric_part(&precision, |_, _| size).map_err(|[row, column]| {
            FisherBinghamError::NotSymmetric {
                row: row + 1,
                column: column + 1,
                upper: precision[(row, column)],
                lower: precision[(column, row)],
            }
        })?;
        let (eigenvalues, axes) = jacobi::eigen(&precision);
        let b: [f64; 4] = (axes.transpose() * linear).into();
        let shift = centring_shift(eigenvalues, b);
        let lambda = eigenvalues.map(|p| p + shift);
        let centre: [f64; 4] = std::array::from_fn(|j| b[j] / lambda[j]);
        let square: f64 = (0..4).map(|j| b[j] * centre[j]).sum();
        let slack = 1.0 - centre.iter().map(|c| c * c).sum::<f64>();
        let law = Self::centred(axes, lambda, centre, slack, 0.5 * (square + shift));
        Ok(Self { given: Some(Box::new((precision, linear))), ..law })
    }

    /// From x = V y and the density ∝ exp(−½ Σ λ(y − c)²), with λ > 0, |c| ≤ 1 and `slack` = 1 − |c|².
    pub(crate) fn centred(
        mut axes: Matrix4<f64>,
        lambda: [f64; 4],
        mut centre: [f64; 4],
        slack: f64,
        ln_offset: f64,
    ) -> Self {
        align(&mut axes, lambda, &mut centre);
        let contour = Box::new(Contour::new(lambda, centre, slack));
        let (mean, covariance) = contour.moments();
        Self {
            given: None,
            axes,
            lambda,
            centre,
            ln_offset,
            mean_vector: axes * mean,
            second_moment: axes * (covariance + mean * mean.transpose()) * axes.transpose(),
            covariance,
            contour,
            sampler: OnceLock::new(),
        }
    }

    /// The logarithm of the density with respect to surface measure on S³.
    #[must_use]
    pub fn ln_density(&self, q: &UnitQuaternion<f64>) -> f64 {
        let y = self.axes.tr_mul(&q.coords);
        let square: f64 = (0..4).map(|j| self.lambda[j] * (y[j] - self.centre[j]).powi(2)).sum();
        -0.5 * square - self.contour.ln_integral()
    }

    /// The logarithm of the density of the *attitude*, at q and −q together, with respect to
    /// surface measure on the half of S³ that represents every attitude once (total π²).
    #[must_use]
    pub fn ln_attitude_density(&self, q: &UnitQuaternion<f64>) -> f64 {
        let y = self.axes.tr_mul(&q.coords);
        let product: f64 = (0..4).map(|j| self.lambda[j] * y[j] * self.centre[j]).sum();
        // Of q and −q the one with the larger density, and the share of the other in it.
        let sign = 1.0_f64.copysign(product);
        let square: f64 =
            (0..4).map(|j| self.lambda[j] * (sign * y[j] - self.centre[j]).powi(2)).sum();
        let gap = -2.0 * product.abs();
        let other = if gap > NEGLIGIBLE { libm::log1p(libm::exp(gap)) } else { 0.0 };
        other - 0.5 * square - self.contour.ln_integral()
    }

    /// The logarithm of the density of the attitude with respect to Haar measure on SO(3),
    /// normalised to one: 0 everywhere for the uniform law.
    #[must_use]
    pub fn ln_haar_density(&self, q: &UnitQuaternion<f64>) -> f64 {
        self.ln_attitude_density(q) + LN_PI_SQUARED
    }

    /// ln ∫ exp(−½ xᵀPx + bᵀx) dS over S³.
    #[must_use]
    pub fn ln_normaliser(&self) -> f64 {
        self.contour.ln_integral() + self.ln_offset
    }

    /// ln ∫ exp(−½ Σ λ(y − c)²) dS, which is what a law with a mean calls its normaliser.
    pub(crate) fn ln_centred_normaliser(&self) -> f64 {
        self.contour.ln_integral()
    }

    #[cfg(test)]
    pub(crate) fn contour(&self) -> &Contour {
        &self.contour
    }

    /// V, λ, c and the logarithm that exp(−½ Σ λ(y − c)²), x = V y, is to be offset by.
    pub(crate) fn eigenform(&self) -> (&Matrix4<f64>, [f64; 4], [f64; 4], f64) {
        (&self.axes, self.lambda, self.centre, self.ln_offset)
    }

    /// A matrix P of the law: of all P + μ·1, which are the same law, the one that [`new`](Self::new) was
    /// given.
    #[must_use]
    pub fn precision(&self) -> Matrix4<f64> {
        if let Some(given) = &self.given {
            return given.0;
        }
        let square: f64 = (0..4).map(|j| self.lambda[j] * self.centre[j].powi(2)).sum();
        let shift = 2.0 * self.ln_offset - square;
        let own = Vector4::from(self.lambda.map(|lambda| lambda - shift));
        self.axes * Matrix4::from_diagonal(&own) * self.axes.transpose()
    }

    /// The vector b of the law.
    #[must_use]
    pub fn linear(&self) -> Vector4<f64> {
        if let Some(given) = &self.given {
            return given.1;
        }
        let own: [f64; 4] = std::array::from_fn(|j| self.lambda[j] * self.centre[j]);
        self.axes * Vector4::from(own)
    }

    /// The mean attitude: the quaternion m̄ for which E (x·m̄)² is largest, the eigenvector of E xxᵀ with
    /// the largest eigenvalue (Markley et al. 2007, doi:10.2514/1.28949). q and −q count alike. Of its
    /// two signs the one nearer to E x, or where that is zero the one with a positive scalar part.
    ///
    /// Where the two largest eigenvalues are equal, as for the uniform law, it is one of many.
    #[must_use]
    pub fn mean_attitude(&self) -> UnitQuaternion<f64> {
        let (values, vectors) = jacobi::eigen(&self.second_moment);
        let largest = (0..4).fold(0, |best, j| if values[j] > values[best] { j } else { best });
        let axis: Vector4<f64> = vectors.column(largest).normalize();
        let side = axis.dot(&self.mean_vector);
        let negative = if side.abs() > 1e-12 { side < 0.0 } else { axis.w < 0.0 };
        UnitQuaternion::new_unchecked(Quaternion::from(if negative { -axis } else { axis }))
    }

    /// The covariance of the attitude in body axes, rad²: 4 E vvᵀ, with v the vector part of
    /// m̄⁻¹ ⊗ x about the [mean attitude](Self::mean_attitude) m̄.
    ///
    /// 2v is the rotation vector of the turn from the mean to first order, and never longer: for a
    /// turn of φ it is 2 sin(φ/2) long, 4 % short of φ for 1 rad. Exact for any law in terms of 2v; for
    /// the rotation vector itself take [`AngularQuadrature::expect`](crate::AngularQuadrature::expect).
    ///
    /// ```
    /// use gyradius_attitude::RadiallyConstrainedGaussian;
    /// use nalgebra::{Matrix3, UnitQuaternion};
    ///
    /// let given = Matrix3::new(4e-6, 1e-6, 0.0, 1e-6, 2e-6, 0.0, 0.0, 0.0, 1e-6);
    /// let mean = UnitQuaternion::from_euler_angles(0.3, -1.0, 2.0);
    /// let law = RadiallyConstrainedGaussian::from_rotation_covariance(mean, given, 0.01)?;
    /// assert!((law.rotation_covariance() - given).amax() < 1e-10);
    /// # Ok::<(), gyradius_attitude::RcgError>(())
    /// ```
    #[must_use]
    pub fn rotation_covariance(&self) -> Matrix3<f64> {
        let across = left_multiplication(&self.mean_attitude()).fixed_columns::<3>(0).into_owned();
        let offset = across.tr_mul(&self.mean_vector);
        let local = self.axes.tr_mul(&across);
        (local.tr_mul(&self.covariance) * local + offset * offset.transpose()) * 4.0
    }

    /// Expectations of `N` polynomials in x, of degree at most 9, to machine precision.
    ///
    /// The polynomials are evaluated at complex points, at which |x| = 1 does *not* hold: write
    /// them in the form that is meant, and use nothing but sums and products.
    ///
    /// ```
    /// use gyradius_attitude::FisherBingham;
    /// use nalgebra::{Matrix4, Vector4};
    ///
    /// let law = FisherBingham::new(Matrix4::identity(), Vector4::new(0.0, 0.0, 0.0, 2.0))?;
    /// let [fourth] = law.expect(|x| [x[3] * x[3] * x[3] * x[3]]);
    /// assert!(fourth > law.second_moment()[(3, 3)].powi(2));
    /// # Ok::<(), gyradius_attitude::FisherBinghamError>(())
    /// ```
    pub fn expect<const N: usize>(
        &self,
        polynomials: impl Fn(&[Complex<f64>; 4]) -> [Complex<f64>; N],
    ) -> [f64; N] {
        self.contour.expect(|y| {
            let x = std::array::from_fn(|i| {
                (0..4).map(|j| y[j] * self.axes[(i, j)]).sum::<Complex<f64>>()
            });
            polynomials(&x)
        })
    }

    /// Expectations of all monomials of x − E x of degree up to 8, to machine precision.
    #[must_use]
    pub fn central_moments(&self) -> CentralMoments {
        CentralMoments::new(self.axes, self.centre, &self.contour)
    }

    /// The share of proposals that the sampler accepts.
    #[must_use]
    pub fn acceptance(&self) -> f64 {
        self.sampler().acceptance()
    }

    /// How the law is sampled.
    #[must_use]
    pub fn method(&self) -> Method {
        self.sampler().method()
    }

    /// Fills a slice with independent draws, where the sampler is a chart by the machine's vector
    /// units.
    ///
    /// The values are others than those of [`sample`](Distribution::sample), and the same on every
    /// machine; the first of a longer slice are those of a shorter one. Vectors take their normals
    /// from Box and Muller's formula with 52 bits, so that deviations end at 8.5.
    pub fn sample_into<R: Rng + ?Sized>(&self, rng: &mut R, out: &mut [UnitQuaternion<f64>]) {
        match self.sampler() {
            Sampler::Chart(chart) => chart.sample_into(rng, out),
            _ => out.fill_with(|| self.sample(rng)),
        }
    }

    #[inline]
    fn sampler(&self) -> &Sampler {
        self.sampler.get_or_init(|| Sampler::choose(self))
    }
}

impl Distribution<UnitQuaternion<f64>> for FisherBingham {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> UnitQuaternion<f64> {
        let x = match self.sampler() {
            Sampler::Chart(chart) => chart.sample(rng),
            Sampler::Cells(cells) => self.axes * Vector4::from(cells.sample(rng)),
            Sampler::Uniform { ln_bound, .. } => loop {
                // A uniform attitude is uniform in the eigenbasis as well.
                let q: UnitQuaternion<f64> = UniformAttitude.sample(rng);
                let y = q.coords;
                let square: f64 =
                    (0..4).map(|j| self.lambda[j] * (y[j] - self.centre[j]).powi(2)).sum();
                if rng.random::<f64>() < libm::exp(-0.5 * square - ln_bound) {
                    break self.axes * y;
                }
            },
        };
        UnitQuaternion::new_unchecked(Quaternion::from(x))
    }
}

impl Sampler {
    fn choose(law: &FisherBingham) -> Self {
        /// Proposals this good are not worth improving on.
        const GOOD: f64 = 0.6;
        let (lambda, centre, ln_integral) = (law.lambda, law.centre, law.contour.ln_integral());
        // Σ λ(y − c)² ≥ min λ·(1 − |c|)² on the sphere.
        let lowest = lambda.into_iter().fold(f64::INFINITY, f64::min);
        let gap = (1.0 - Vector4::from(centre).norm()).max(0.0);
        let ln_bound = -0.5 * lowest * gap * gap;
        let acceptance = libm::exp(ln_integral + UniformAttitude::LN_DENSITY - ln_bound).min(1.0);
        if acceptance > GOOD {
            return Self::Uniform { acceptance, ln_bound };
        }
        let chart = Chart::new(&law.axes, lambda, centre, ln_integral, law.contour.shift());
        if let Some(chart) = chart.filter(|c| c.acceptance() > GOOD) {
            return Self::Chart(Box::new(chart));
        }
        Self::Cells(Cells::new(lambda, centre, ln_integral))
    }

    fn acceptance(&self) -> f64 {
        match self {
            Self::Chart(chart) => chart.acceptance(),
            Self::Cells(cells) => cells.acceptance(),
            Self::Uniform { acceptance, .. } => *acceptance,
        }
    }

    fn method(&self) -> Method {
        match self {
            Self::Chart(_) => Method::Chart,
            Self::Cells(_) => Method::Cells,
            Self::Uniform { .. } => Method::Uniform,
        }
    }
}

/// Turns the axes of equal eigenvalues until one of them carries all of the mean that lies in their
/// span: which axes those are is free, and samplers do best where they are aligned.
fn align(axes: &mut Matrix4<f64>, lambda: [f64; 4], centre: &mut [f64; 4]) {
    for (i, j) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
        let length = libm::hypot(centre[i], centre[j]);
        let equal = (lambda[i] - lambda[j]).abs() <= 4.0 * f64::EPSILON * lambda[i].max(lambda[j]);
        if !equal || centre[j] == 0.0 || length == 0.0 {
            continue;
        }
        let (c, s) = (centre[i] / length, centre[j] / length);
        let (a, b): (Vector4<f64>, Vector4<f64>) = (axes.column(i).into(), axes.column(j).into());
        axes.set_column(i, &(a * c + b * s));
        axes.set_column(j, &(b * c - a * s));
        (centre[i], centre[j]) = (length, 0.0);
    }
}

/// L(m) with m ⊗ x = L(m) x, scalar last.
pub(crate) fn left_multiplication(m: &UnitQuaternion<f64>) -> Matrix4<f64> {
    let (x, y, z, w) = (m.i, m.j, m.k, m.w);
    Matrix4::new(w, -z, y, x, z, w, -x, y, -y, x, w, z, -x, -y, -z, w)
}

/// The symmetric part of a matrix that is symmetric to rounding, or where it is not. `size` is what
/// an entry is measured against.
pub(crate) fn symmetric_part(
    m: &Matrix4<f64>,
    size: impl Fn(usize, usize) -> f64,
) -> Result<Matrix4<f64>, [usize; 2]> {
    for row in 0..4 {
        for column in row + 1..4 {
            let difference = m[(row, column)] - m[(column, row)];
            if difference.abs() > 64.0 * f64::EPSILON * size(row, column) {
                return Err([row, column]);
            }
        }
    }
    Ok((m + m.transpose()) * 0.5)
}

/// μ that makes P + μ·1 positive definite and |(P + μ·1)⁻¹b| ≤ 1, equal to 1 where it can be: then
/// the normaliser's exponent has no large terms to cancel.
pub(crate) fn centring_shift<const N: usize>(eigenvalues: [f64; N], b: [f64; N]) -> f64 {
    let floor = eigenvalues.into_iter().fold(f64::INFINITY, f64::min);
    // In d = μ + min P > 0.
    let square =
        |d: f64| -> f64 { (0..N).map(|j| (b[j] / ((eigenvalues[j] - floor) + d)).powi(2)).sum() };
    let (mut low, mut high) = (1.0, 2.0);
    if square(low) <= 1.0 {
        return low - floor;
    }
    while square(high) > 1.0 {
        low = high;
        high *= 2.0;
    }
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if square(middle) > 1.0 { low = middle } else { high = middle }
    }
    high - floor
}

/// The serialized form: P by rows, and b.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Parameters {
    precision: [[f64; 4]; 4],
    linear: [f64; 4],
}

#[cfg(feature = "serde")]
impl TryFrom<Parameters> for FisherBingham {
    type Error = FisherBinghamError;

    fn try_from(p: Parameters) -> Result<Self, FisherBinghamError> {
        Self::new(Matrix4::from(p.precision).transpose(), p.linear.into())
    }
}

#[cfg(feature = "serde")]
impl From<FisherBingham> for Parameters {
    fn from(law: FisherBingham) -> Self {
        Self { precision: law.precision().transpose().into(), linear: law.linear().into() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    /// Laws that between them use every method.
    fn zoo() -> Vec<(&'static str, [f64; 4], [f64; 4])> {
        vec![
            ("flat", [0.1, 0.2, 0.3, 0.0], [0.1, 0.0, 0.2, 0.0]),
            ("bingham", [5e4, 1.6e3, 30.0, 0.0], [0.0; 4]),
            ("girdle", [1e8, 1e8, 0.0, 0.0], [0.0, 0.0, 1.0, -0.5]),
            ("disc", [1e8, 3.0, 1.0, 0.0], [1e7, 0.0, 1.0, 0.5]),
            ("equator", [1e6, 1e4, 1e2, 0.0], [8e5, 1e3, -30.0, 0.0]),
            ("cap", [1e6, 1e6, 1e6, 1e6], [6e5, 0.0, 0.0, 8e5]),
            ("ridge", [1e8, 1e4, 1.0, 0.0], [0.0; 4]),
            ("fisher", [0.0; 4], [1.0, 2.0, 3.0, 4.0]),
            ("needle", [1e8, 1e8, 1e8, 0.0], [1e8, 0.0, 0.0, 0.0]),
        ]
    }

    fn law(p: [f64; 4], b: [f64; 4]) -> FisherBingham {
        FisherBingham::new(Matrix4::from_diagonal(&p.into()), b.into()).unwrap()
    }

    /// Any P and b, also far apart in size: those given come back, and they are the same law again.
    #[test]
    fn the_parameters_come_back() {
        let mut runner = proptest::test_runner::TestRunner::deterministic();
        let number = || (-1.0..1.0_f64, -3..6_i32).prop_map(|(x, order)| x * 10_f64.powi(order));
        let entries = prop::collection::vec(number(), 14);
        runner
            .run(&entries, |x| {
                let mut p = Matrix4::from_fn(|i, j| {
                    x[4 * i.min(j) + i.max(j) - i.min(j) * (i.min(j) + 1) / 2]
                });
                p = 0.5 * (p + p.transpose());
                let b = Vector4::new(x[10], x[11], x[12], x[13]);
                let law = FisherBingham::new(p, b).unwrap();
                let size = p.amax().max(b.amax()).max(1.0);
                prop_assert!(
                    (law.precision() - p).amax() < 1e-13 * size,
                    "{p} {}",
                    law.precision()
                );
                prop_assert!((law.linear() - b).amax() < 1e-13 * size);
                let again = FisherBingham::new(law.precision(), law.linear()).unwrap();
                let q = UnitQuaternion::from_euler_angles(x[0], x[3], x[7]);
                let (one, other) = (law.ln_density(&q), again.ln_density(&q));
                prop_assert!((one - other).abs() < 1e-11 * size, "{one} {other}");
                Ok(())
            })
            .unwrap();
    }

    /// Every first and second moment of 200,000 draws against the contour, |z| < 4.5 over 126
    /// comparisons: once in a thousand suites for a right sampler.
    #[test]
    fn draws_have_the_moments_of_the_contour() {
        const N: usize = 200_000;
        for (name, p, b) in zoo() {
            let law = law(p, b);
            assert!(law.acceptance() > 0.3, "{name}: {} by {:?}", law.acceptance(), law.method());
            let mut rng = ChaCha8Rng::seed_from_u64(7);
            let (mut sum, mut squares) = ([0.0; 14], [0.0; 14]);
            for _ in 0..N {
                let x = law.sample(&mut rng).coords;
                assert!((x.norm() - 1.0).abs() < 4.0 * f64::EPSILON, "{name}");
                for (k, value) in statistics(&x).into_iter().enumerate() {
                    sum[k] += value;
                    squares[k] += value * value;
                }
            }
            let second = law.second_moment();
            let expected = statistics_of_moments(&law.mean_vector(), &second);
            for k in 0..14 {
                let mean = sum[k] / N as f64;
                let variance = (squares[k] / N as f64 - mean * mean).max(1e-30);
                let z = (mean - expected[k]) / (variance / N as f64).sqrt();
                // Rounding dominates where a coordinate hardly moves.
                let rounding = (mean - expected[k]).abs() < 1e-13;
                assert!(z.abs() < 4.5 || rounding, "{name} moment {k}: z = {z}");
            }
        }
    }

    fn statistics(x: &Vector4<f64>) -> [f64; 14] {
        statistics_of_moments(x, &(x * x.transpose()))
    }

    fn statistics_of_moments(x: &Vector4<f64>, xx: &Matrix4<f64>) -> [f64; 14] {
        let mut all = [0.0; 14];
        let mut k = 4;
        for i in 0..4 {
            all[i] = x[i];
            for j in 0..=i {
                all[k] = xx[(i, j)];
                k += 1;
            }
        }
        all
    }

    /// The share of accepted proposals is what was promised: uniform numbers used are counted.
    #[test]
    fn methods_are_all_in_use() {
        let methods: Vec<Method> = zoo().iter().map(|(_, p, b)| law(*p, *b).method()).collect();
        for method in [Method::Chart, Method::Cells, Method::Uniform] {
            assert!(methods.contains(&method), "{method:?} unused in {methods:?}");
        }
    }

    #[test]
    fn adding_a_multiple_of_the_identity_changes_the_normaliser_and_nothing_else() {
        let (a, b) = ([3.0, 2.0, 1.0, 0.5], [0.4, -0.3, 0.2, 1.0]);
        let base = law(a, b);
        let shifted = law(a.map(|x| x + 10.0), b);
        assert!((base.ln_normaliser() - shifted.ln_normaliser() - 5.0).abs() < 1e-13);
        assert!((base.mean_vector() - shifted.mean_vector()).amax() < 1e-14);
    }

    /// Where |c| comes out a hair off one, that hair is real: E x₁ in 45 digits (mpmath).
    #[test]
    fn a_centre_near_the_sphere_is_not_taken_to_be_on_it() {
        let law = law(
            [
                -16_136.289_772_996_175,
                10.701_160_054_680_146,
                -0.028_980_682_689_154_29,
                -7.558_101_882_755_457,
            ],
            [-1.109_201_425_856_134_7, 0.0, 0.0, 0.0],
        );
        assert!((law.mean_vector()[0] + 0.803_668_713_345_047_4).abs() < 1e-14);
    }

    /// However sure the sign is: the sum over both, without what underflows.
    #[test]
    fn densities_of_attitudes_add_both_signs() {
        for scale in [1e-6, 0.3, 20.0, 1e5] {
            let law = law([1.0, -0.5, 0.2, 0.7].map(|p| p * scale), [0.3, 0.2, -1.0, 0.5]);
            let mut rng = ChaCha8Rng::seed_from_u64(77);
            for _ in 0..200 {
                let q = UniformAttitude.sample(&mut rng);
                let opposite = UnitQuaternion::new_unchecked(-q.into_inner());
                let (a, b) = (law.ln_density(&q), law.ln_density(&opposite));
                let sum = a.max(b) + (-(a - b).abs()).exp().ln_1p();
                let found = law.ln_attitude_density(&q);
                assert!((found - sum).abs() < 1e-12 * (1.0 + sum.abs()), "{found} {sum}");
                assert_eq!(found, law.ln_attitude_density(&opposite));
                assert_eq!(law.ln_haar_density(&q), found + LN_PI_SQUARED);
            }
        }
    }

    #[test]
    fn bad_parameters_are_refused() {
        let one = Matrix4::<f64>::identity();
        for bad in [f64::NAN, f64::INFINITY, 1e300] {
            assert!(FisherBingham::new(one * bad, Vector4::zeros()).is_err());
            assert!(FisherBingham::new(one, Vector4::new(0.0, bad, 0.0, 0.0)).is_err());
        }
        let mut skew = one;
        skew[(0, 3)] = 0.5;
        let error = FisherBingham::new(skew, Vector4::zeros()).unwrap_err();
        assert!(error.to_string().contains("P14"), "{error}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        /// Turning the parameters turns the law.
        #[test]
        fn equivariance(
            x in prop::array::uniform16(-1.0..1.0f64),
            p in prop::array::uniform4(0.0..50.0f64),
            b in prop::array::uniform4(-20.0..20.0f64),
            q in prop::array::uniform4(-1.0..1.0f64),
        ) {
            let turn = Matrix4::from_row_slice(&x).qr().q();
            let plain = law(p, b);
            let matrix = turn * Matrix4::from_diagonal(&p.into()) * turn.transpose();
            let turned = FisherBingham::new((matrix + matrix.transpose()) * 0.5, turn * Vector4::from(b)).unwrap();
            let q = UnitQuaternion::from_quaternion(Quaternion::from(Vector4::from(q)));
            let image = UnitQuaternion::from_quaternion(Quaternion::from(turn * q.coords));
            prop_assert!((plain.ln_density(&q) - turned.ln_density(&image)).abs() < 1e-10);
            prop_assert!((turn * plain.mean_vector() - turned.mean_vector()).amax() < 1e-12);
        }
    }
}
