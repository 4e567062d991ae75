//! The most likely law of attitudes, within a family that is chosen or given.

mod blocks;
#[cfg(test)]
mod census;
mod centered;
mod climb;
mod intervals;
mod likelihood;
mod lobes;
mod means;
mod point;
mod rounding;
mod search;
#[cfg(test)]
mod tests;

use nalgebra::{Matrix3, Quaternion, UnitQuaternion};
use std::fmt;

#[cfg(feature = "serde")]
use crate::read::{covariance, or_infinite};
use crate::{RadiallyConstrainedGaussian, fisher_bingham::left_multiplication};
use centered::Centered;
use climb::Climb;
pub use intervals::NoIntervals;
use likelihood::Sample;
use point::{PARAMETERS, PRECISION, Point, SLOPE, Square, TRIANGLE};
use search::{Search, moved};

/// Fewer attitudes than parameters of the law are not fitted.
const NEEDED: usize = PARAMETERS;
/// Likelihood ratios that 1 % of samples of Bingham's law exceed: aligned against Bingham (χ² with
/// one degree of freedom), general against aligned, general against Bingham. The last two are not
/// χ²: b and −b are the same, so that the likelihood has no slope at b = 0. They were simulated:
/// between 17 and 20 for 50 to 3,000 attitudes, concentrated or not, 300 to 1,000 samples each.
const ALIGNED_TO_BINGHAM: f64 = 6.634_896_601_021_214;
const GENERAL_TO_ALIGNED: f64 = 17.5;
const GENERAL_TO_BINGHAM: f64 = 19.5;
/// The law's own limit on a variance.
const SMALLEST_VARIANCE: f64 = 1e-14;

/// Why attitudes have no [`Fit`].
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// Too few attitudes.
    #[error("{count} attitudes: a fit needs at least {needed}")]
    TooFew {
        /// How many were given.
        count: usize,
        /// How many are needed.
        needed: usize,
    },
    /// An attitude is not a unit quaternion.
    #[error("attitude {} is a quaternion of norm {norm:?}: it must have norm 1", index + 1)]
    Norm {
        /// Its place, from 0.
        index: usize,
        /// Its norm.
        norm: f64,
    },
    /// The attitudes do not fill all directions: the likelihood grows without bound.
    #[error(
        "attitudes that lie within {spread:e} of a sphere of lower dimension (all the same, or all \
         turns about one axis, for example): the likelihood has no maximum"
    )]
    Degenerate {
        /// Root mean square distance of the quaternions from that sphere.
        spread: f64,
    },
    /// The radial variance that was asked for is out of range.
    #[error("radial variance {value:e}: it must be between 1e-14 and 1e14, or infinite")]
    RadialVariance {
        /// The value.
        value: f64,
    },
}

/// Which laws a fit chooses among. Each contains those before it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Family {
    /// The smallest of [`Bingham`](Self::Bingham), [`Aligned`](Self::Aligned) and
    /// [`General`](Self::General) that the likelihood ratio does not reject against a larger one
    /// at 1 %. Its law is the most likely of that family; the most likely general law has a
    /// ln-likelihood that is up to 9.75 greater.
    #[default]
    Chosen,
    /// Bingham's law, 9 parameters: q and −q are equally likely and the radial variance is infinite.
    Bingham,
    /// The mean is a principal axis of the covariance and the radial variance is given,
    /// 9 parameters.
    AlignedWith {
        /// The radial variance, from 1e-14 to 1e14, or infinite, which is Bingham's law.
        #[cfg_attr(feature = "serde", serde(deserialize_with = "or_infinite"))]
        radial_variance: f64,
    },
    /// The mean is a principal axis of the covariance, 10 parameters.
    Aligned,
    /// Every radially constrained Gaussian, 13 parameters.
    General,
}

/// What the attitudes say of the radial variance s = mᵀΣm, the variance of the Gaussian in ℝ⁴ along
/// its mean.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum RadialVariance {
    /// It has an estimate, and a finite interval of values that the attitudes allow.
    Determined {
        /// The most likely value.
        #[cfg_attr(feature = "serde", serde(deserialize_with = "or_infinite"))]
        value: f64,
        /// Lower end of the 95 % interval.
        #[cfg_attr(feature = "serde", serde(deserialize_with = "or_infinite"))]
        low: f64,
        /// Upper end of the 95 % interval.
        #[cfg_attr(feature = "serde", serde(deserialize_with = "or_infinite"))]
        high: f64,
    },
    /// Every value from `low` on fits the attitudes, infinity included.
    Undetermined {
        /// Lower end of the 95 % interval.
        #[cfg_attr(feature = "serde", serde(deserialize_with = "or_infinite"))]
        low: f64,
    },
    /// It has an estimate, infinite perhaps, but no interval: [`Fit::no_intervals`] says why.
    Estimated {
        /// The most likely value.
        #[cfg_attr(feature = "serde", serde(deserialize_with = "or_infinite"))]
        value: f64,
    },
    /// It was given.
    Given(#[cfg_attr(feature = "serde", serde(deserialize_with = "or_infinite"))] f64),
}

impl fmt::Display for RadialVariance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Determined { value, low, high } => write!(
                f,
                "the radial variance is {value:.3e}; the attitudes allow {low:.1e} to {high:.1e} \
                 (95 %)"
            ),
            Self::Undetermined { low } => write!(
                f,
                "the attitudes do not determine the radial variance: every value from {low:.1e} \
                 up, infinity included, fits them (95 %)"
            ),
            Self::Estimated { value } => {
                write!(
                    f,
                    "the radial variance is about {value:.3e}, without an interval that holds"
                )
            }
            Self::Given(value) => write!(f, "the radial variance was given as {value:e}"),
        }
    }
}

/// How the search for the maximum has ended.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Convergence {
    /// Whether a maximum was reached.
    pub converged: bool,
    /// Newton steps from the start that led to the maximum.
    pub iterations: usize,
    /// What the last step promised to add to the ln-likelihood (half the squared Newton decrement), infinite where there is no
    /// such step.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "or_infinite"))]
    pub last_gain: f64,
}

/// A law fitted to attitudes: see [`RadiallyConstrainedGaussian::fit`].
#[derive(Clone, Debug, PartialEq, getset::CopyGetters, getset::Getters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Fit {
    /// The fitted law.
    #[getset(get = "pub")]
    law: RadiallyConstrainedGaussian,
    /// The family of the law: the one asked for, or the one chosen.
    #[getset(get_copy = "pub")]
    family: Family,
    /// What the attitudes say of the radial variance.
    #[getset(get_copy = "pub")]
    radial: RadialVariance,
    /// ln-likelihood of the attitudes with respect to Haar measure of total one: that of the
    /// uniform law is 0.
    #[getset(get_copy = "pub")]
    ln_likelihood: f64,
    bingham_ln_likelihood: f64,
    /// Covariance of small turns of the body about the mean, in rad², in body axes: four times the
    /// inverse of the tangent block of Σ⁻¹. It is the P of
    /// [`from_rotation_covariance`](RadiallyConstrainedGaussian::from_rotation_covariance).
    #[cfg_attr(
        feature = "serde",
        serde(rename = "turn_covariance_rad2", deserialize_with = "covariance")
    )]
    #[getset(get_copy = "pub")]
    turn_covariance: Matrix3<f64>,
    errors: Result<Errors, NoIntervals>,
    /// How the search has ended.
    #[getset(get_copy = "pub")]
    convergence: Convergence,
}

#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Errors {
    #[cfg_attr(
        feature = "serde",
        serde(rename = "mean_covariance_rad2", deserialize_with = "covariance")
    )]
    mean: Matrix3<f64>,
    #[cfg_attr(feature = "serde", serde(rename = "turn_errors_rad2"))]
    turns: Matrix3<f64>,
}

impl RadiallyConstrainedGaussian {
    /// The maximum likelihood law of attitudes, q and −q being the same attitude: the family is
    /// [chosen](Family::Chosen), as few data determine all of Σ.
    ///
    /// # Definition
    /// The likelihood of an attitude is f(q) + f(−q). m and −m have the same; the scalar part of
    /// the fitted mean is not negative (if it is zero, the third coordinate is not, and so on).
    ///
    /// # Radial variance
    /// Attitudes in one narrow cluster say next to nothing of the radial variance:
    /// [`Fit::radial`] says which values they allow. Where it is undetermined the
    /// law is Bingham's as a rule, which has no parameter for it; its radial variance is then 1e14,
    /// which stands for infinity. Its draws lie about m and −m, half of them each; as attitudes
    /// they are the same. To have them on one side use [`MeanHalf`](crate::MeanHalf), or give a
    /// radial variance with [`Family::AlignedWith`].
    ///
    /// # Algorithm
    /// Newton's method with exact derivatives and damping, each step uphill, in coordinates in which the
    /// law that has been reached has unit variance, so that lobes of 1e-6 rad are as easy as wide ones;
    /// Hessian from the fourth moments of the law (Isserlis at each node of the contour integral). The
    /// likelihood can have several maxima, and the highest that is found is taken. Starts are the best
    /// aligned law, one with little radial variance, a Gaussian for every way to divide the attitudes'
    /// quaternions in two opposite halves whose mean is locally the longest, in coordinates of unit
    /// variance (the L1 principal components of Kwak 2008, doi:10.1109/TPAMI.2008.114, from 24
    /// directions), the likeliest of 24 Gaussians whose means cover all directions, and the likeliest
    /// laws of two lobes, found as two clusters of one covariance of which the light one may hold a
    /// single attitude. The mean of Bingham's law is the principal axis of the second moment of the
    /// sample (Markley et al. 2007, doi:10.2514/1.28949).
    ///
    /// # Limits
    /// At least 13 attitudes. Their quaternions must have root mean square distances from every great
    /// sphere, and from every small one that is ten times nearer, of more than 1e-7 (turns of 2e-7 rad).
    /// Order and signs do not matter. Standard errors and intervals are those of many attitudes: a few hundred where
    /// there are lobes to see or nothing radial to estimate, five thousand or more for a diffuse general law;
    /// [`Fit::no_intervals`] says where there are none.
    ///
    /// A law that is chosen is the most likely one of its own family, not of the general family: its
    /// ln-likelihood may be below that of the most likely general law, and so below that of the law
    /// that the attitudes were drawn from, by what the likelihood ratio tolerates, at most 9.75. Where
    /// nothing may be lost, ask for [`Family::General`]. Some 10 to 30 ms for 1,000 attitudes.
    ///
    /// # Errors
    /// Too few attitudes, one that is not a unit quaternion, or a likelihood without maximum.
    ///
    /// ```
    /// use gyradius_attitude::{RadialVariance, RadiallyConstrainedGaussian};
    /// use nalgebra::{Matrix3, UnitQuaternion};
    /// use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
    /// use rand_distr::Distribution;
    ///
    /// // 200 attitudes, one degree about each axis.
    /// let truth = RadiallyConstrainedGaussian::from_rotation_covariance(
    ///     UnitQuaternion::from_euler_angles(0.3, -0.2, 1.0),
    ///     Matrix3::from_diagonal_element(1_f64.to_radians().powi(2)),
    ///     0.01,
    /// )?;
    /// let mut rng = ChaCha8Rng::seed_from_u64(1);
    /// let attitudes: Vec<_> = (0..200).map(|_| truth.sample(&mut rng)).collect();
    ///
    /// let fit = RadiallyConstrainedGaussian::fit(&attitudes)?;
    /// assert!(fit.law().mean().angle_to(&truth.mean()) < 0.3_f64.to_radians());
    /// let deviation = fit.turn_covariance()[(0, 0)].sqrt().to_degrees();
    /// assert!((0.85..1.15).contains(&deviation));
    /// // One degree is too little to know the radial variance.
    /// assert!(matches!(fit.radial(), RadialVariance::Undetermined { .. }), "{}", fit.radial());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn fit(attitudes: &[UnitQuaternion<f64>]) -> Result<Fit, FitError> {
        Self::fit_family(attitudes, Family::Chosen)
    }

    /// The maximum likelihood law of a family: see [`fit`](Self::fit).
    ///
    /// # Errors
    /// As [`fit`](Self::fit), or the radial variance given is out of range.
    pub fn fit_family(attitudes: &[UnitQuaternion<f64>], family: Family) -> Result<Fit, FitError> {
        let count = attitudes.len();
        if count < NEEDED {
            return Err(FitError::TooFew { count, needed: NEEDED });
        }
        for (index, q) in attitudes.iter().enumerate() {
            let norm = q.norm();
            if !((norm - 1.0).abs() < 1e-9) {
                return Err(FitError::Norm { index, norm });
            }
        }
        let sample = Sample::new(attitudes);
        let spread = sample.scale[0];
        if !(spread * spread > SMALLEST_VARIANCE) {
            return Err(FitError::Degenerate { spread });
        }
        let search = Search::new(&sample);
        let n = sample.len();
        let bingham = search.bingham();
        let bingham_ln_likelihood = n * bingham.height;
        let report_law = |best: &Climb<Point>, law: &Centered, family, radial| {
            Fit::new(&sample, best, law, family, radial, bingham_ln_likelihood)
        };
        let report = |best: &Climb<Point>, family, radial| {
            report_law(best, &best.place.law(), family, radial)
        };
        let report_general = |top: &Climb<Centered>| {
            let best = moved(top, Point::of(&top.place));
            let radial = search.interval(&best, search::GENERAL);
            report_law(&best, &top.place, Family::General, radial)
        };
        match family {
            Family::AlignedWith { radial_variance: value } => {
                let finite = SMALLEST_VARIANCE..=1.0 / SMALLEST_VARIANCE;
                if !(finite.contains(&value) || value == f64::INFINITY) {
                    return Err(FitError::RadialVariance { value });
                }
                let best = if value == f64::INFINITY {
                    bingham.clone()
                } else {
                    search.aligned_at(&bingham, 1.0 / value)
                };
                report(&best, family, RadialVariance::Given(value))
            }
            Family::Bingham => {
                let aligned = search.aligned(&bingham);
                let low = search.lowest(&aligned, search::ALIGNED);
                report(&bingham, family, RadialVariance::Undetermined { low })
            }
            Family::Aligned => {
                let aligned = search.aligned(&bingham);
                let radial = search.interval(&aligned, search::ALIGNED);
                report(&aligned, family, radial)
            }
            Family::General => {
                let aligned = search.aligned(&bingham);
                report_general(&search.general(&bingham, &aligned)?)
            }
            Family::Chosen => {
                let aligned = search.aligned(&bingham);
                let general = search.general(&bingham, &aligned)?;
                let ratio =
                    |larger: f64, smaller: &Climb<Point>| 2.0 * n * (larger - smaller.height);
                if ratio(general.height, &bingham) <= GENERAL_TO_BINGHAM
                    && ratio(aligned.height, &bingham) <= ALIGNED_TO_BINGHAM
                {
                    let low = search.lowest(&aligned, search::ALIGNED);
                    report(&bingham, Family::Bingham, RadialVariance::Undetermined { low })
                } else if ratio(general.height, &aligned) <= GENERAL_TO_ALIGNED {
                    let radial = search.interval(&aligned, search::ALIGNED);
                    report(&aligned, Family::Aligned, radial)
                } else {
                    report_general(&general)
                }
            }
        }
    }
}

impl Fit {
    fn new(
        sample: &Sample,
        best: &Climb<Point>,
        law: &Centered,
        family: Family,
        radial: RadialVariance,
        bingham_ln_likelihood: f64,
    ) -> Result<Self, FitError> {
        let Climb { place, height, converged, iterations, gain } = *best;
        let mut frame = sample.frame * place.frame;
        let variances = law.gaussian().0.map(|l| if l > 0.0 { 1.0 / l } else { f64::INFINITY });
        let axes = sample.frame * law.axes;
        let mean = frame.column(3).normalize();
        // The last coordinate that is not zero is positive.
        if (0..4).rev().map(|i| mean[i]).find(|x| *x != 0.0).is_some_and(|x| x < 0.0) {
            frame = -frame;
        }
        let mean = UnitQuaternion::new_normalize(Quaternion::from(frame.column(3).into_owned()));
        let law = RadiallyConstrainedGaussian::from_principal(mean, axes, variances)
            .map_err(|_| FitError::Degenerate { spread: sample.scale[0] })?;

        // Half turns of the body are m ⊗ (h, 0): from tangents of the fit to those.
        let body =
            (left_multiplication(&mean).tr_mul(&frame)).fixed_view::<3, 3>(0, 0).into_owned();
        let across = across(&place.precision);
        let turn_covariance = body * across * body.transpose() * 4.0;
        let bingham = bingham_ln_likelihood / sample.len();
        let errors = intervals::covariance(sample, best, family, bingham)
            .map(|covariance| Errors::new(&covariance, &body, &across, &turn_covariance));
        let radial = match radial {
            RadialVariance::Determined { .. } | RadialVariance::Undetermined { .. }
                if family == Family::General && errors.is_err() =>
            {
                RadialVariance::Estimated { value: 1.0 / place.tau }
            }
            RadialVariance::Determined { .. }
            | RadialVariance::Undetermined { .. }
            | RadialVariance::Estimated { .. }
            | RadialVariance::Given(_) => radial,
        };
        Ok(Self {
            law,
            family,
            radial,
            ln_likelihood: sample.len() * height,
            bingham_ln_likelihood,
            turn_covariance,
            errors,
            convergence: Convergence { converged, iterations, last_gain: gain },
        })
    }

    /// How probable it is that uniform attitudes seem as far from uniform as these do: the
    /// likelihood ratio of Bingham's law and the uniform, which is χ² with 9 degrees of freedom for
    /// many attitudes (Wilks 1938).
    #[must_use]
    pub fn uniform_p_value(&self) -> f64 {
        let half = self.bingham_ln_likelihood.max(0.0);
        // Q(9/2, x), by the recurrence of DLMF 8.8.6 from Q(1/2, x) = erfc √x.
        let mut sum = libm::erfc(half.sqrt());
        let mut term = libm::exp(-half) / (std::f64::consts::PI * half).sqrt();
        for k in 0..4 {
            term *= half / (f64::from(k) + 0.5);
            if half > 0.0 {
                sum += term;
            }
        }
        sum.min(1.0)
    }

    /// Standard errors of the entries of [`turn_covariance`](Self::turn_covariance), in rad²; none
    /// where [`no_intervals`](Self::no_intervals) says why.
    #[must_use]
    pub fn turn_covariance_errors(&self) -> Option<Matrix3<f64>> {
        self.errors.ok().map(|e| e.turns)
    }

    /// Covariance of the error of the mean attitude, as a rotation vector in body axes, in rad²;
    /// none where [`no_intervals`](Self::no_intervals) says why. From the observed information, as
    /// all errors here.
    #[must_use]
    pub fn mean_covariance(&self) -> Option<Matrix3<f64>> {
        self.errors.ok().map(|e| e.mean)
    }

    /// Why the estimates have no standard errors, where they have none.
    #[must_use]
    pub fn no_intervals(&self) -> Option<NoIntervals> {
        self.errors.err()
    }
}

/// The inverse of a precision. At the edge of the family a turn is free: as far as a law can say so.
fn across(precision: &Matrix3<f64>) -> Matrix3<f64> {
    let definite = precision + Matrix3::from_diagonal_element(SMALLEST_VARIANCE);
    definite.cholesky().map(|factor| factor.inverse()).unwrap_or_else(|| {
        // The least of them is rounding beside the others.
        let found = definite.symmetric_eigen();
        let variances = found.eigenvalues.map(|value| 1.0 / value.max(SMALLEST_VARIANCE));
        found.eigenvectors * Matrix3::from_diagonal(&variances) * found.eigenvectors.transpose()
    })
}

impl Errors {
    /// From the covariance of the estimates about the mean; `body` takes tangents to half turns.
    fn new(
        covariance: &Square,
        body: &Matrix3<f64>,
        across: &Matrix3<f64>,
        turns: &Matrix3<f64>,
    ) -> Self {
        let mean = body * covariance.fixed_view::<3, 3>(0, 0) * body.transpose() * 4.0;
        let mut slopes = [Matrix3::zeros(); SLOPE];
        for (slope, tangent) in slopes.iter_mut().zip(body.column_iter()) {
            // Body axes turn with the mean, and by half of it against parallel transport.
            let half_turn = tangent.cross_matrix();
            *slope = turns * half_turn - half_turn * turns;
        }
        for (k, &(i, j)) in TRIANGLE.iter().enumerate() {
            let mut entry = Matrix3::zeros();
            entry[(i, j)] = 1.0;
            entry[(j, i)] = 1.0;
            let step = body * across;
            slopes[PRECISION + k] = -step * entry * step.transpose() * 4.0;
        }
        let turns = Matrix3::from_fn(|i, j| {
            let mut variance = 0.0;
            for (k, a) in slopes.iter().enumerate() {
                for (l, b) in slopes.iter().enumerate() {
                    variance += a[(i, j)] * covariance[(k, l)] * b[(i, j)];
                }
            }
            variance.max(0.0).sqrt()
        });
        Self { mean, turns }
    }
}
