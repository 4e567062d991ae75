//! A law of positive definite matrices of mean one with a covariance as near to a given one as a search finds.

use gyradius_dispersion::{EntryMoments, KnownMoments, LogCholeskyGaussian};
use nalgebra::Matrix3;

use super::symmetric::{
    Matrix6, Six, congruence, inertia_of_second_moments, mapped, matrix, second_moments_of_inertia,
    six, with_eigenvalues,
};

/// Largest variance of a matrix of norm one in units of its mean: three times the mean. Beyond, hardly any draw would show
/// the variance.
const MOST_VARIANCE: f64 = 9.0;
/// Largest variance of a coordinate of the law.
const MOST_COORDINATE: f64 = 1.0;
/// Steps of the search, and halvings of a step.
const STEPS: usize = 100;
const HALVINGS: usize = 8;

/// A Gaussian in log-Cholesky coordinates of S, and the congruence that makes its mean one.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct NearestLaw {
    pub(super) law: LogCholeskyGaussian,
    /// A of S ↦ A S Aᵀ.
    pub(super) scale: Matrix3<f64>,
    /// Covariance of A S Aᵀ.
    pub(super) covariance: Matrix6,
}

impl NearestLaw {
    /// Nearest to mean one and this covariance of S₁₁, S₂₂, S₃₃, S₁₂, S₁₃, S₂₃; none if the numbers leave the range.
    pub(super) fn new(covariance: &Matrix6) -> Option<Self> {
        let target = clipped(covariance);
        Self::exact(&target).or_else(|| Self::of(search(&target)?))
    }

    /// With mean one and this covariance to rounding, where such a law is found.
    pub(super) fn exact(covariance: &Matrix6) -> Option<Self> {
        let mean = six(&(Matrix3::identity() * 2.0));
        let inertia = mapped(&inertia_of_second_moments(), covariance);
        let moments = EntryMoments::new(mean.into(), inertia).ok()?;
        Self::of(polished(LogCholeskyGaussian::matched(&moments).ok()?, covariance))
    }

    fn of(law: LogCholeskyGaussian) -> Option<Self> {
        let (mean, covariance) = moments(&law);
        let mean = matrix(&mean);
        if !(mean.iter().all(|x| x.is_finite())) {
            return None;
        }
        let scale = with_eigenvalues(&mean, |x| 1.0 / x.max(f64::MIN_POSITIVE).sqrt());
        Some(Self { law, scale, covariance: mapped(&congruence(&scale), &covariance) })
    }
}

/// The covariance without what is wider than draws show.
fn clipped(covariance: &Matrix6) -> Matrix6 {
    let root2 = std::f64::consts::SQRT_2;
    let weights = Matrix6::from_diagonal(&Six::new(1.0, 1.0, 1.0, root2, root2, root2));
    let unweighted = Matrix6::from_diagonal(&weights.diagonal().map(|w| 1.0 / w));
    let weighted = mapped(&weights, covariance);
    mapped(&unweighted, &with_eigenvalues(&weighted, |x| x.clamp(0.0, MOST_VARIANCE)))
}

/// Mean and covariance of the entries of S.
fn moments(law: &LogCholeskyGaussian) -> (Six, Matrix6) {
    let found = law.entry_moments();
    let map = second_moments_of_inertia();
    (map * Six::from(found.mean()), mapped(&map, found.covariance()))
}

/// Coordinates d₁, d₂, d₃, s₁₂, s₂₃, s₁₃ by the entries of S, about S = 1.
fn coordinates_by_entries() -> Matrix6 {
    let mut map = Matrix6::zeros();
    for (row, column, value) in
        [(0, 0, 0.5), (1, 1, 0.5), (2, 2, 0.5), (3, 3, 1.0), (4, 5, 1.0), (5, 4, 1.0)]
    {
        map[(row, column)] = value;
    }
    map
}

/// A matched law after more steps, as long as they bring the smallest deviations nearer: the largest are near already.
fn polished(mut law: LogCholeskyGaussian, target: &Matrix6) -> LogCholeskyGaussian {
    let map = coordinates_by_entries();
    let gaps = |law: &LogCholeskyGaussian| {
        let (found, spread) = moments(law);
        let gaps = (six(&Matrix3::identity()) - found, target - spread);
        let relative = |e: usize| gaps.1[(e, e)].abs() / target[(e, e)].max(f64::MIN_POSITIVE);
        let off = (0..6).filter(|e| target[(*e, *e)] > 0.0).map(relative).fold(0.0, f64::max);
        (gaps, off)
    };
    let (mut now, mut off) = gaps(&law);
    for _ in 0..STEPS {
        let mean = Six::from(law.mean()) + map * now.0;
        let covariance = law.covariance() + mapped(&map, &now.1);
        let Ok(next) = LogCholeskyGaussian::new(mean.into(), covariance) else { break };
        let found = gaps(&next);
        if !(found.1 < 0.9 * off) {
            break;
        }
        (law, now, off) = (next, found.0, found.1);
    }
    law
}

/// Steps as [`LogCholeskyGaussian::matched`] takes, where it finds none: each projected onto covariances, and halved until
/// it brings the law nearer.
fn search(target: &Matrix6) -> Option<LogCholeskyGaussian> {
    let map = coordinates_by_entries();
    let allowed =
        |covariance: &Matrix6| with_eigenvalues(covariance, |x| x.clamp(0.0, MOST_COORDINATE));
    // Of a lognormal, the variance of the logarithm.
    let mut covariance =
        with_eigenvalues(&mapped(&map, target), |x| 0.25 * libm::log1p(4.0 * x.max(0.0)));
    covariance = allowed(&covariance);
    let mut mean = Six::from_fn(|i, _| if i < 3 { -covariance[(i, i)] } else { 0.0 });
    let judge = |mean: &Six, covariance: &Matrix6| {
        let law = LogCholeskyGaussian::new((*mean).into(), *covariance).ok()?;
        let (found, spread) = moments(&law);
        let gaps = (six(&Matrix3::identity()) - found, target - spread);
        let off = gaps.0.norm_squared() + gaps.1.norm_squared();
        off.is_finite().then_some((law, gaps, off))
    };
    let (mut best, mut gaps, mut off) = judge(&mean, &covariance)?;
    for _ in 0..STEPS {
        let (shift, widening) = (map * gaps.0, mapped(&map, &gaps.1));
        let mut step = 1.0;
        let nearer = (0..HALVINGS).find_map(|_| {
            let next = (mean + shift * step, allowed(&(covariance + widening * step)));
            step *= 0.5;
            judge(&next.0, &next.1).filter(|found| found.2 < off * (1.0 - 1e-6)).map(|f| (next, f))
        });
        let Some((next, found)) = nearer else { break };
        (mean, covariance) = next;
        (best, gaps, off) = found;
    }
    Some(best)
}
