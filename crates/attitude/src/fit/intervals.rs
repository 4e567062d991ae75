//! The covariance of the estimates, and where they have none that can be trusted.

use nalgebra::SMatrix;
use std::{f64::consts::PI, fmt};

use super::{
    Family,
    climb::{Climb, Hill, restrict},
    likelihood::Sample,
    point::{PRECISION, Point, SLOPE, Square, TAU, TRIANGLE},
    search::{ALIGNED, ALL},
};

/// A pivot of the scaled information below this is rounding.
const FLAT: f64 = 1e-10;
/// A factor of Λ below this is at the edge of the family: half turns of 1e5 rad.
const EDGE: f64 = 1e-5;
/// Deviance at the edge of a region twice as wide as the joint 95 % region of all estimates, which ends
/// at the quantile of χ² with 13 degrees of freedom. With the region itself, samples whose estimates
/// seem more certain than they are would pass: their intervals held the truth in 85 to 90 %.
const REGION: f64 = 4.0 * 22.362_032_494_826_934;

/// Why a [`Fit`](super::Fit) has no standard errors, and of the general family no interval of the
/// radial variance either. Errors from the information suppose that the likelihood is nearly
/// Gaussian about the estimates: on all of a region twice as wide as the joint 95 % region.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum NoIntervals {
    /// The search has not reached a maximum.
    NotConverged,
    /// The observed information is singular: some direction is not determined at all.
    Flat,
    /// Bingham's law, b = 0, is in that region: there b and −b are the same, the information is singular,
    /// and neither the mean nor the radial variance is defined.
    NearBingham {
        /// Twice the ln-likelihood that the law is ahead of Bingham's.
        ratio: f64,
    },
    /// The law, or one in that region, is such that turns about some axis have no finite covariance.
    UnboundedTurns,
    /// That region reaches half a turn from the mean attitude.
    AnyMean {
        /// Largest standard deviation of the mean attitude, in rad.
        deviation_rad: f64,
    },
}

impl fmt::Display for NoIntervals {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotConverged => write!(f, "the search has not reached a maximum"),
            Self::Flat => write!(f, "the attitudes do not determine all parameters of the law"),
            Self::NearBingham { ratio } => write!(
                f,
                "the attitudes hardly tell this law from Bingham's: the likelihood ratio is \
                 {ratio:.1}, and intervals need more than {REGION:.1}"
            ),
            Self::UnboundedTurns => write!(
                f,
                "the attitudes do not exclude laws under which turns about some axis have no finite \
                 covariance: a region twice as wide as the joint 95 % region reaches them"
            ),
            Self::AnyMean { deviation_rad } => write!(
                f,
                "the standard deviation of the mean attitude is {deviation_rad:.2} rad: twice its \
                 joint 95 % region reaches half a turn"
            ),
        }
    }
}

/// Covariance of the mean, Λ, k and τ of the point, zero for those that are held: the inverse of the
/// observed information. `bingham` is the height of Bingham's law.
pub(super) fn covariance(
    sample: &Sample,
    best: &Climb<Point>,
    family: Family,
    bingham: f64,
) -> Result<Square, NoIntervals> {
    if !best.converged {
        return Err(NoIntervals::NotConverged);
    }
    // At the edge of the family Λ is singular to rounding.
    if !best.place.precision.cholesky().is_some_and(|c| c.l_dirty().diagonal().min() > EDGE) {
        return Err(NoIntervals::UnboundedTurns);
    }
    let covariance = inverse_information(sample, &best.place, family).ok_or(NoIntervals::Flat)?;
    if family != Family::General {
        return Ok(covariance);
    }
    let ratio = 2.0 * sample.len() * (best.height - bingham);
    if !(ratio > REGION) {
        return Err(NoIntervals::NearBingham { ratio });
    }
    let deviation_rad =
        2.0 * covariance.fixed_view::<3, 3>(0, 0).symmetric_eigenvalues().max().sqrt();
    if !(deviation_rad * REGION.sqrt() < PI) {
        return Err(NoIntervals::AnyMean { deviation_rad });
    }
    if !precision_stays_definite(&best.place, &covariance) {
        return Err(NoIntervals::UnboundedTurns);
    }
    Ok(covariance)
}

/// Whether Λ is positive definite on all of the region. With Λ = LLᵀ and Λ + δΛ = L(1 + D)Lᵀ
/// it is where no combination of D, as a vector of unit metric, varies by one.
fn precision_stays_definite(place: &Point, covariance: &Square) -> bool {
    const ENTRIES: usize = SLOPE - PRECISION;
    let Some(inverse) = place.precision.cholesky().and_then(|c| c.l().try_inverse()) else {
        return false;
    };
    let mut slopes = SMatrix::<f64, ENTRIES, ENTRIES>::zeros();
    for (k, &(i, j)) in TRIANGLE.iter().enumerate() {
        let half = inverse.column(i) * inverse.column(j).transpose();
        let d = if i == j { half } else { half + half.transpose() };
        for (row, &(a, b)) in TRIANGLE.iter().enumerate() {
            slopes[(row, k)] = if a == b { d[(a, a)] } else { 2.0_f64.sqrt() * d[(a, b)] };
        }
    }
    let own = covariance.fixed_view::<ENTRIES, ENTRIES>(PRECISION, PRECISION);
    let relative = slopes * own * slopes.transpose();
    (SMatrix::<f64, ENTRIES, ENTRIES>::identity() - relative * REGION).cholesky().is_some()
}

fn inverse_information(sample: &Sample, place: &Point, family: Family) -> Option<Square> {
    let mut free = if family == Family::General { ALL } else { ALIGNED };
    free[TAU] |= family == Family::Aligned && place.tau > 0.0;
    let survey = restrict(sample.survey(place), free);
    let scale = survey.information.diagonal().map(|d| 1.0 / d.abs().sqrt());
    let information = Square::from_fn(|i, j| -survey.hessian[(i, j)] * scale[i] * scale[j]);
    let factor = information.cholesky()?;
    if !factor.l_dirty().diagonal().iter().all(|pivot| pivot * pivot > FLAT) {
        return None;
    }
    let inverse = factor.inverse();
    let own = Square::from_fn(|i, j| {
        if free[i] && free[j] { inverse[(i, j)] * scale[i] * scale[j] / sample.len() } else { 0.0 }
    });
    // From the factor of Λ to Λ.
    let mut slopes = Square::identity();
    for (l, factor) in place.factors().iter().enumerate() {
        for (k, &(i, j)) in TRIANGLE.iter().enumerate() {
            slopes[(PRECISION + k, PRECISION + l)] = factor[(i, j)];
        }
    }
    Some(slopes * own * slopes.transpose())
}
