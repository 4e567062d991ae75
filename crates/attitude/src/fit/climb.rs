//! Newton's method with Levenberg and Marquardt's damping: every step that is taken climbs.

use nalgebra::{SMatrix, SVector};

/// Where the gain that the next step promises, in ln-likelihood of the whole sample, is below
/// this, parameters are within 1e-4 of a standard error, and that step is still taken.
const GAIN: f64 = 1e-9;
/// A climb that ends with more to gain than this has not converged.
const ENOUGH: f64 = 1e-6;
const ITERATIONS: usize = 200;
/// Maxima that differ by less in ln-likelihood of the whole sample are worth the same.
pub(super) const SAME: f64 = 1e-3;
/// A climb ends higher than it is by no more than this many times what its next step promises.
const HOPE: f64 = 30.0;
/// Every so many steps a climb is given up that has gained less than that, or too little to come to
/// what is known in five times as many.
const STRETCH: usize = 15;
const LEAST_DAMPING: f64 = 1e-9;
const MOST_DAMPING: f64 = 1e12;

/// A function of up to N coordinates on a space that may be curved.
pub(crate) trait Hill<const N: usize> {
    type Place: Clone;
    /// Mean ln-likelihood and its derivatives along the local coordinates.
    fn survey(&self, place: &Self::Place) -> Evaluation<N>;
    /// The place at local coordinates `step`, if there is one.
    fn walk(&self, place: &Self::Place, step: &SVector<f64, N>) -> Option<Self::Place>;
}

/// Mean ln-likelihood an attitude, with respect to Haar measure of total one, and its derivatives.
#[derive(Clone, Debug)]
pub(crate) struct Evaluation<const N: usize> {
    pub(crate) value: f64,
    pub(crate) gradient: SVector<f64, N>,
    pub(crate) hessian: SMatrix<f64, N, N>,
    /// Covariance of the sufficient statistics under the law.
    pub(crate) information: SMatrix<f64, N, N>,
}

/// Where a climb has ended.
#[derive(Clone, Debug)]
pub(crate) struct Climb<P> {
    pub(crate) place: P,
    pub(crate) height: f64,
    pub(crate) converged: bool,
    pub(crate) iterations: usize,
    /// Gain in ln-likelihood of the whole sample that one more step promises.
    pub(crate) gain: f64,
}

/// Climbs from `place` along the coordinates that are `free`; `n` is the size of the sample.
pub(crate) fn climb<const N: usize, H: Hill<N>>(
    hill: &H,
    place: H::Place,
    free: [bool; N],
    n: f64,
) -> Climb<H::Place> {
    climb_above(hill, place, free, n, f64::NEG_INFINITY)
}

/// The same, but given up where it is about to end no higher than `known`.
pub(crate) fn climb_above<const N: usize, H: Hill<N>>(
    hill: &H,
    mut place: H::Place,
    free: [bool; N],
    n: f64,
    known: f64,
) -> Climb<H::Place> {
    let mut damping = 1e-3;
    let mut survey = restrict(hill.survey(&place), free);
    let mut iterations = 0;
    let mut milestone = survey.value;
    while iterations < ITERATIONS && damping < MOST_DAMPING {
        let Some((step, promised)) = propose(&survey, damping) else {
            damping = (8.0 * damping).max(LEAST_DAMPING);
            continue;
        };
        iterations += 1;
        let left = HOPE * promised;
        let mut hopeless = damping < 0.1 && survey.value + left < known + SAME / n;
        if iterations % STRETCH == 0 {
            let rise = survey.value - milestone;
            milestone = survey.value;
            hopeless |= n * rise < SAME || survey.value + 5.0 * rise < known;
        }
        let last = hopeless || n * promised < GAIN && damping < 0.1;
        let noise = 1e-14 * (1.0 + survey.value.abs());
        let next = hill.walk(&place, &step).map(|p| (restrict(hill.survey(&p), free), p));
        let rise = next.as_ref().map_or(f64::NEG_INFINITY, |(s, _)| s.value - survey.value);
        if let Some(next) = next.filter(|_| rise > -noise && rise > 1e-4 * promised - noise) {
            (survey, place) = next;
            if rise > 0.7 * promised {
                damping = if damping < LEAST_DAMPING { 0.0 } else { damping * 0.1 };
            } else if rise < 0.2 * promised {
                damping = (4.0 * damping).max(LEAST_DAMPING);
            }
        } else if promised < noise {
            // Below rounding there is nothing left to gain.
            break;
        } else {
            damping = (8.0 * damping).max(LEAST_DAMPING);
        }
        if last {
            break;
        }
    }
    // Judged with next to no damping, which would promise little anywhere.
    let gain = propose(&survey, LEAST_DAMPING).map_or(f64::INFINITY, |(_, gain)| n * gain);
    Climb { place, height: survey.value, converged: gain < ENOUGH, iterations, gain }
}

/// Coordinates that are held do not move.
pub(crate) fn restrict<const N: usize>(
    mut survey: Evaluation<N>,
    free: [bool; N],
) -> Evaluation<N> {
    for k in (0..N).filter(|&k| !free[k]) {
        survey.gradient[k] = 0.0;
        for m in [&mut survey.hessian, &mut survey.information] {
            m.row_mut(k).fill(0.0);
            m.column_mut(k).fill(0.0);
        }
        survey.hessian[(k, k)] = -1.0;
        survey.information[(k, k)] = 1.0;
    }
    survey
}

/// The damped step and the rise that the quadratic model promises; none where the damped Hessian is
/// not negative definite.
fn propose<const N: usize>(survey: &Evaluation<N>, damping: f64) -> Option<(SVector<f64, N>, f64)> {
    let scale = SVector::<f64, N>::from_fn(|k, _| {
        let own = survey.information[(k, k)];
        if own > 0.0 { 1.0 / own.sqrt() } else { 1.0 }
    });
    let curvature = SMatrix::<f64, N, N>::from_fn(|i, j| {
        let damping = if i == j { damping } else { 0.0 };
        -survey.hessian[(i, j)] * scale[i] * scale[j] + damping
    });
    let gradient = survey.gradient.component_mul(&scale);
    let step = curvature.cholesky()?.solve(&gradient);
    let promised =
        gradient.dot(&step) - 0.5 * (step.dot(&(curvature * step)) - damping * step.norm_squared());
    (step.iter().all(|x| x.is_finite()) && promised.is_finite())
        .then(|| (step.component_mul(&scale), promised.max(0.0)))
}
