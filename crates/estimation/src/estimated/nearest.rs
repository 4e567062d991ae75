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
/// Where the weighted square of the distance is so many times what the barrier changes, the search ends.
const FINEST: f64 = 1e12;
/// What is added to the curvature, as shares of its diagonal, until it has a factor.
const DAMPED: [f64; 6] = [0.0, 1e-14, 1e-12, 1e-10, 1e-8, 1e-6];
/// Newton steps at each weight at most, and halvings of each.
const STEPS: usize = 60;
const HALVINGS: usize = 50;

/// A point and its squared distance from the estimate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    pub(super) ten: Ten,
    pub(super) squared_distance: f64,
}

/// S with covariance S Sᵀ, what does not vary counted as varying by [`LEAST`].
fn root(estimate: &TenEstimate) -> Option<Matrix10> {
    let deviations = Ten::from(estimate.deviations()).map(|s| s.hypot(LEAST));
    let correlation = Matrix10::from_fn(|i, j| {
        let own = if i == j { LEAST * LEAST } else { 0.0 };
        (estimate.covariance()[(i, j)] + own) / deviations[i] / deviations[j]
    });
    let ridge = Matrix10::identity() * (LEAST * LEAST);
    Some(Matrix10::from_diagonal(&deviations) * (correlation + ridge).cholesky()?.unpack())
}

/// The inverse of the same covariance.
pub(super) fn metric(estimate: &TenEstimate) -> Option<Matrix10> {
    let inverse = root(estimate)?.solve_lower_triangular(&Matrix10::identity())?;
    Some(inverse.transpose() * inverse)
}

/// The nearest point of the cone: least dᵀ C⁻¹ d with a matrix that is positive semidefinite, which is a convex problem, by
/// Newton's steps with a logarithmic barrier (Nesterov & Nemirovskii 1994, doi:10.1137/1.9781611970791). It comes out inside by a
/// hair. None if the numbers leave the range.
pub(super) fn nearest(estimate: &TenEstimate) -> Option<Nearest> {
    let (form, mean) = (estimate.form(), estimate.mean());
    // In coordinates in which the covariance is one: where some combinations of the ten are known a million times as well as
    // others, nothing is lost of either.
    let root = root(estimate)?;
    let basis: Vec<Matrix4<f64>> =
        (0..10).map(|i| form.cone(&root.column(i).into_owned())).collect();
    let at = |off: &Ten| mean + root * off;
    let mut off = root.solve_lower_triangular(&(inside(form, mean)? - mean))?;
    let mut weight = FIRST;
    while weight < LAST {
        for _ in 0..STEPS {
            let inverse = form.cone(&at(&off)).cholesky()?.inverse();
            let slopes: Vec<Matrix4<f64>> = basis.iter().map(|a| inverse * a).collect();
            let gradient = off * weight - Ten::from_fn(|i, _| slopes[i].trace());
            let curvature = SMatrix::<f64, 10, 10>::from_fn(|i, j| {
                let own = if i == j { weight } else { 0.0 };
                own + (slopes[i] * slopes[j]).trace()
            });
            let curvature = (curvature + curvature.transpose()) * 0.5;
            let step = downhill(&curvature, &gradient)?;
            let decrement = -gradient.dot(&step);
            let cost = |off: &Ten| {
                let factor = form.cone(&at(off)).cholesky()?;
                let barrier: f64 = factor.l_dirty().diagonal().iter().map(|x| libm::log(*x)).sum();
                Some(0.5 * weight * off.norm_squared() - 2.0 * barrier)
            };
            let here = cost(&off)?;
            let mut share = 1.0;
            let next = (0..HALVINGS).find_map(|_| {
                let next = off + step * share;
                share *= 0.5;
                cost(&next).is_some_and(|there| there < here).then_some(next)
            });
            let Some(next) = next else { break };
            off = next;
            if !(decrement > 1e-10) {
                break;
            }
        }
        weight *= FACTOR;
        // Nearer than this share of the distance nobody asks for, and floats do not tell.
        if weight * off.norm_squared() > FINEST {
            break;
        }
    }
    Some(Nearest { ten: at(&off), squared_distance: off.norm_squared() })
}

/// Newton's step, or one that is shortened where rounding has left the curvature without a factor.
fn downhill(curvature: &Matrix10, gradient: &Ten) -> Option<Ten> {
    let damped = |share: &f64| {
        let own = Matrix10::from_diagonal(&(curvature.diagonal() * *share));
        Some((curvature + own).cholesky()?.solve(gradient) * -1.0)
    };
    DAMPED.iter().find_map(damped)
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
