//! The body nearest to an estimate in the metric of its covariance.

use nalgebra::{Matrix4, SMatrix};

use super::ten_estimate::{Matrix10, Ten, TenEstimate, TenForm};

/// The deviation that a parameter is given at least, in units in which the ten are about one, so that what does not vary can
/// move where no body has it.
const LEAST: f64 = 1e-6;
/// From this weight of the distance against the barrier to that, in steps of this factor.
const FIRST: f64 = 1e-3;
const LAST: f64 = 1e13;
const FACTOR: f64 = 8.0;
/// Newton steps at each weight at most, and halvings of each.
const STEPS: usize = 60;
const HALVINGS: usize = 50;

/// A point and its squared distance from the estimate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    pub(super) ten: Ten,
    pub(super) squared_distance: f64,
}

/// The inverse of the covariance, what does not vary counted as varying by [`LEAST`].
pub(super) fn metric(estimate: &TenEstimate) -> Option<Matrix10> {
    let deviations = Ten::from(estimate.deviations()).map(|s| s.hypot(LEAST));
    let correlation = Matrix10::from_fn(|i, j| {
        let own = if i == j { LEAST * LEAST } else { 0.0 };
        (estimate.covariance()[(i, j)] + own) / deviations[i] / deviations[j]
    });
    let ridge = Matrix10::identity() * (LEAST * LEAST);
    let inverse = (correlation + ridge).cholesky()?.inverse();
    Some(Matrix10::from_fn(|i, j| inverse[(i, j)] / deviations[i] / deviations[j]))
}

/// The nearest point of the cone: least dᵀ C⁻¹ d with a matrix that is positive semidefinite, which is a convex problem, by
/// Newton's steps with a logarithmic barrier (Nesterov & Nemirovskii 1994, doi:10.1137/1.9781611970791). It comes out inside by a
/// hair. None if the numbers leave the range.
pub(super) fn nearest(estimate: &TenEstimate) -> Option<Nearest> {
    let (form, mean) = (estimate.form(), estimate.mean());
    let metric = metric(estimate)?;
    let basis: Vec<Matrix4<f64>> =
        (0..10).map(|i| form.cone(&Ten::from_fn(|j, _| f64::from(u8::from(i == j))))).collect();
    let mut ten = inside(form, mean)?;
    let mut weight = FIRST;
    while weight < LAST {
        for _ in 0..STEPS {
            let inverse = form.cone(&ten).cholesky()?.inverse();
            let slopes: Vec<Matrix4<f64>> = basis.iter().map(|a| inverse * a).collect();
            let gap = ten - mean;
            let gradient = metric * gap * weight - Ten::from_fn(|i, _| slopes[i].trace());
            let curvature = SMatrix::<f64, 10, 10>::from_fn(|i, j| {
                weight * metric[(i, j)] + (slopes[i] * slopes[j]).trace()
            });
            let curvature = (curvature + curvature.transpose()) * 0.5;
            let step = curvature.cholesky()?.solve(&gradient) * -1.0;
            let decrement = -gradient.dot(&step);
            let cost = |ten: &Ten| {
                let factor = form.cone(ten).cholesky()?;
                let gap = ten - mean;
                let barrier: f64 = factor.l_dirty().diagonal().iter().map(|x| libm::log(*x)).sum();
                Some(0.5 * weight * gap.dot(&(metric * gap)) - 2.0 * barrier)
            };
            let here = cost(&ten)?;
            let mut share = 1.0;
            let next = (0..HALVINGS).find_map(|_| {
                let next = ten + step * share;
                share *= 0.5;
                cost(&next).is_some_and(|there| there < here).then_some(next)
            });
            let Some(next) = next else { break };
            ten = next;
            if !(decrement > 1e-10) {
                break;
            }
        }
        weight *= FACTOR;
    }
    let gap = ten - mean;
    Some(Nearest { ten, squared_distance: gap.dot(&(metric * gap)).max(0.0) })
}

/// Somewhere inside the cone.
fn inside(form: TenForm, mean: &Ten) -> Option<Ten> {
    let mut ten = *mean;
    ten[0] = ten[0].max(1.0);
    let mut size = 1.0;
    for _ in 0..200 {
        if form.cone(&ten).cholesky().is_some() {
            return Some(ten);
        }
        for k in 4..7 {
            ten[k] = mean[k].abs() + size;
        }
        size *= 2.0;
    }
    None
}
