//! The axes of a fit: which of their angles the samples determine, and the law of those.

use gyradius_attitude::{Family, FitError, RadialVariance, RadiallyConstrainedGaussian};
use gyradius_statistics::tail;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::{
    LIKELIER,
    matching::{mean_attitude, vector_part},
    relabel::Sample,
    root::RootFit,
    round::{Roundness, direction, direction_near, mean_about},
    uniformity::undetermined,
};
use crate::turns::{FIXED, held_by_entries, law_of_turns, law_of_turns_about};

/// By how much the ln-likelihood of a law with one free turn must exceed that of uniform axes: half of what χ² exceeds at
/// 1 % with 5 degrees of freedom, as it is the largest over all directions of a tensor with 5 components.
const LESS_FREE: f64 = 7.543;
/// By how much that of a law without a free turn must exceed that of one with a free turn, of many samples: with the 10
/// parameters that it has more.
const DETERMINED: f64 = 11.605;
/// That is exceeded as rarely in few samples if it grows by this over their number: simulated, 30 to 300 of them.
const FEW: f64 = 20.0;
/// Below this radial variance there is no second lobe, and narrow laws are all the same.
const CONCENTRATED: f64 = 0.01;
/// Turns narrower than this, rad², say nothing of the radial variance unless there are two groups.
const NARROW: f64 = 0.1;
/// Mean squares of turns, rad², from which on they are told as they are.
const WIDE: f64 = 0.3;
/// Mean squares of half tilts below this have no cut at a right angle.
const NEAR: f64 = 0.005;
/// 1/(2σ²) of half tilts that are taken for any: the density differs by half of this from end to end.
const WIDEST: f64 = 1e-3;
/// By how much the ln-likelihood of narrow axes with a second lobe must exceed that without one, of many samples. Laws without one
/// exceed 9.75, at which a larger family is chosen, in about one table of 200, and this in one of 1,000: simulated, 13 to 1000
/// samples.
const LOBE: f64 = 13.0;
/// That is exceeded as rarely in few samples if it grows by this over their number.
const FEW_OF_LOBE: f64 = 4.0;
/// A second lobe that holds fewer samples than this holds none: rounded, less than one.
const LEAST_LOBE: f64 = 0.5;

/// What the samples say of the principal axes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum AxesFinding {
    /// All three angles have a mean and a scatter.
    Determined,
    /// The axes of all samples are the same, or turn about fewer than three directions, as those of bodies do that have two
    /// equal moments each: a turn about the third axis changes nothing.
    Still,
    /// One principal axis has a direction, the other two point anywhere about it: as for two equal
    /// moments.
    FreeTurn {
        /// The axis that has a direction, from 1.
        axis: usize,
    },
    /// The axes point anywhere: as for three equal moments.
    Free,
}

/// The law of the principal axes, fitted to attitudes of matched axes.
#[derive(Clone, Debug, PartialEq, getset::CopyGetters, getset::Getters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AxesFit {
    /// The law of the axes, q and −q alike.
    #[getset(get = "pub")]
    law: RadiallyConstrainedGaussian,
    /// What the samples say of the axes.
    #[getset(get_copy = "pub")]
    finding: AxesFinding,
    /// Covariance of turns about the mean, in rad², in body axes, without the free turns: of small ones the parameter of the
    /// law, from 0.3 rad² on that of the samples.
    #[cfg_attr(feature = "serde", serde(rename = "turn_covariance_rad2"))]
    #[getset(get_copy = "pub")]
    turn_covariance: Matrix3<f64>,
    /// Standard errors of the entries of [`turn_covariance`](Self::turn_covariance), rad².
    #[cfg_attr(feature = "serde", serde(rename = "turn_errors_rad2"))]
    #[getset(get_copy = "pub")]
    turn_errors: Option<Matrix3<f64>>,
    /// Covariance of the error of the mean attitude, as a rotation vector in body axes, rad²; without
    /// the free turns.
    #[cfg_attr(feature = "serde", serde(rename = "mean_covariance_rad2"))]
    #[getset(get_copy = "pub")]
    mean_covariance: Option<Matrix3<f64>>,
    /// What the samples say of the radial variance, where the axes are determined. Where it is not
    /// determined the law has a small one, with the same attitudes and no second lobe.
    #[getset(get_copy = "pub")]
    radial: Option<RadialVariance>,
    /// Whether the search for the maximum of the likelihood has reached it.
    #[getset(get_copy = "pub")]
    converged: bool,
    isotropy: Option<f64>,
    /// The share of the law beyond a right angle of the mean quaternion, where the attitudes determine
    /// the radial variance: narrow axes that fall into two groups or have outliers are held by a
    /// second lobe, about the inverse of the mean. None if that would hold less than one sample, to
    /// rounding.
    #[getset(get_copy = "pub")]
    second_lobe: Option<f64>,
}

impl AxesFit {
    /// `ln_likelihood` is that of the samples under a law of the axes, whatever their axes are called.
    pub(super) fn of(
        samples: &[Sample],
        roots: &[RootFit; 3],
        ln_likelihood: impl Fn(&RadiallyConstrainedGaussian) -> f64,
    ) -> Result<(Self, f64, RadiallyConstrainedGaussian), FitError> {
        let mean = mean_attitude(samples.iter().map(|s| &s.attitude));
        let determined = Self::determined(samples, mean)?;
        let asked = DETERMINED * (1.0 + FEW / samples.len() as f64);
        let told = ln_likelihood(&determined.law) - LESS_FREE - asked;
        let round = Roundness::of(samples);
        let (any, about) = undetermined(samples, roots, &mean, round);
        let any = any.then(|| Self::plain(mean, [f64::INFINITY; 3], AxesFinding::Free));
        let about =
            (0..3).filter(|axis| about[*axis]).map(|axis| Self::about(samples, &mean, axis));
        let free = any.into_iter().map(|fit| (fit, 0.0)).chain(about.map(|fit| (fit, LESS_FREE)));
        let free = free.map(|(fit, less_free)| {
            let height = ln_likelihood(&fit.law) - less_free;
            (fit, height)
        });
        let free = free.reduce(|best, next| if next.1 > best.1 + LIKELIER { next } else { best });
        let Some((free, height)) = free else {
            let widest = determined.law.clone();
            return Ok((determined, told, widest));
        };
        // Samples with two equal moments have no turn about the third axis: only their tilts have a law, which those of a
        // free turn hold where they are wide.
        if round != Roundness::No {
            let fit = if determined.turn_covariance.trace() < NARROW { determined } else { free };
            let widest = fit.law.clone();
            return Ok((fit, height, widest));
        }
        let widest = determined.law.clone();
        let (best, height) = if told > height { (determined, told) } else { (free, height) };
        Ok((best, height, widest))
    }

    /// The same law where the nominal body has the axes `mean`, which differ from those of the fit by
    /// a turn that the law does not see.
    pub(super) fn at(self, mean: UnitQuaternion<f64>) -> Self {
        let local = self.principal_turns();
        match self.finding {
            AxesFinding::Free | AxesFinding::FreeTurn { .. } => {
                let turns = Self::plain(mean, local, self.finding);
                Self { law: turns.law, turn_covariance: turns.turn_covariance, ..self }
            }
            AxesFinding::Still => {
                let turns = Self::still(self.turn_covariance, mean);
                Self { law: turns.law, turn_covariance: turns.turn_covariance, ..self }
            }
            AxesFinding::Determined => self,
        }
    }

    pub(super) fn plain(mean: UnitQuaternion<f64>, local: [f64; 3], finding: AxesFinding) -> Self {
        Self::turning(mean, mean.to_rotation_matrix().matrix(), local, finding)
    }

    /// The same of independent turns about the rows of `about`, in body axes.
    fn turning(
        mean: UnitQuaternion<f64>,
        about: &Matrix3<f64>,
        local: [f64; 3],
        finding: AxesFinding,
    ) -> Self {
        // Infinite variances have no matrix: the finding tells them.
        let finite = local.map(|v| if v.is_finite() { v } else { 0.0 });
        let turns = Matrix3::from_diagonal(&Vector3::from(finite));
        // Turning back leaves rounding where there was nothing.
        let rounding = f64::EPSILON * turns.amax();
        let turned = about.tr_mul(&(turns * about));
        let turn_covariance = turned.map(|x| if x.abs() > 8.0 * rounding { x } else { 0.0 });
        // Refused only for means that are no attitudes.
        let law = law_of_turns_about(mean, about, local)
            .or_else(|_| law_of_turns(UnitQuaternion::identity(), local))
            .unwrap_or_else(|_| unreachable!("variances are clamped"));
        Self {
            law,
            finding,
            turn_covariance,
            turn_errors: None,
            mean_covariance: None,
            radial: None,
            converged: true,
            isotropy: None,
            second_lobe: None,
        }
    }

    /// Turns about principal axes, rad²; infinite where free.
    fn principal_turns(&self) -> [f64; 3] {
        let r = *self.law.mean().to_rotation_matrix().matrix();
        let local = r * self.turn_covariance * r.transpose();
        std::array::from_fn(|k| match self.finding {
            AxesFinding::Free => f64::INFINITY,
            AxesFinding::FreeTurn { axis } if axis == k + 1 => f64::INFINITY,
            _ => local[(k, k)],
        })
    }

    /// One axis has a direction. With its tilt t = (t_a, t_b), half turns, and the free angle taken
    /// out, |t|² has the density ∝ exp(−|t|²/(2σ²)) on [0, 1].
    fn about(samples: &[Sample], mean: &UnitQuaternion<f64>, axis: usize) -> Self {
        let n = samples.len() as f64;
        let mean = mean_about(samples, mean, axis);
        let mean_axis = direction(&mean, axis);
        // |t|² = sin² of half the tilt, up to a right angle: which end of the axis is which, nobody knows.
        let squares: Vec<f64> = samples
            .iter()
            .map(|s| 0.5 * (1.0 - direction(&s.attitude, axis).dot(&mean_axis).abs()).max(0.0))
            .collect();
        let variance = tilt_variance(&squares);
        let mut local = [4.0 * variance; 3];
        local[axis] = f64::INFINITY;
        let mut fit = Self::plain(mean, local, AxesFinding::FreeTurn { axis: axis + 1 });
        let r = *mean.to_rotation_matrix().matrix();
        let across = Matrix3::identity() - mean_axis * mean_axis.transpose();
        fit.mean_covariance = Some(across * (4.0 * variance / n));
        // |t|² is exponential, to first order.
        fit.turn_errors = Some(across.map(f64::abs) * (4.0 * variance / n.sqrt()));
        // The tilts in the body, along the other two axes of the mean.
        let (mut aa, mut ab, mut bb) = (0.0, 0.0, 0.0);
        for s in samples {
            let p = r * direction_near(&mean_axis, &s.attitude, axis);
            let (x, y) = (p[(axis + 1) % 3], p[(axis + 2) % 3]);
            aa += x * x;
            ab += x * y;
            bb += y * y;
        }
        let round = 4.0 * (aa * bb - ab * ab) / ((aa + bb) * (aa + bb));
        if round.is_finite() && variance > FIXED * FIXED {
            fit.isotropy = Some(tail::chi_squared(-n * libm::log(round.clamp(1e-300, 1.0)), 2.0));
        }
        fit
    }

    fn determined(samples: &[Sample], mean: UnitQuaternion<f64>) -> Result<Self, FitError> {
        let attitudes: Vec<_> = samples.iter().map(|s| s.attitude).collect();
        let mut fit = match RadiallyConstrainedGaussian::fit(&attitudes) {
            Err(FitError::Degenerate { .. }) => {
                let r = *mean.to_rotation_matrix().matrix();
                let covariance = r.tr_mul(&(products_of_turns(samples, &mean) * r));
                let mut fit = Self::still(covariance, mean);
                let c = fit.turn_covariance;
                if c.amax() > 0.0 {
                    fit.mean_covariance = Some(c / samples.len() as f64);
                    fit.turn_errors = Some(errors_of(&c, samples.len()));
                }
                return Ok(fit);
            }
            other => other?,
        };
        let radial = fit.radial();
        let given = if let RadialVariance::Undetermined { low } = radial {
            // Any value fits: a small one keeps the covariance readable, and has no second lobe.
            Some((10.0 * low).clamp(CONCENTRATED, 1e4))
        } else if let RadialVariance::Determined { value, .. } | RadialVariance::Estimated { value } =
            radial
            && value < CONCENTRATED
            && squared_turns(samples, &fit.law().mean()).iter().sum::<f64>() < NARROW
        {
            // It says how flat the top of the law is, and P would not be the covariance of the turns.
            Some(CONCENTRATED)
        } else {
            None
        };
        if let Some(radial_variance) = given {
            let family = Family::AlignedWith { radial_variance };
            fit = RadiallyConstrainedGaussian::fit_family(&attitudes, family)?;
        }
        let n = samples.len() as f64;
        let is_said =
            matches!(radial, RadialVariance::Determined { .. } | RadialVariance::Estimated { .. });
        let may_have_lobe = is_said && fit.turn_covariance().trace() < NARROW;
        let mut second_lobe = may_have_lobe
            .then(|| fit.law().far_half_share())
            .filter(|share| share * n >= LEAST_LOBE);
        if second_lobe.is_some() {
            let family = Family::AlignedWith { radial_variance: CONCENTRATED };
            let without = RadiallyConstrainedGaussian::fit_family(&attitudes, family)?;
            let gain = fit.ln_likelihood() - without.ln_likelihood();
            if gain < LOBE * (1.0 + FEW_OF_LOBE / n) {
                (fit, second_lobe) = (without, None);
            }
        }
        let parameter = fit.turn_covariance();
        // The parameter of a law of wide turns is no deviation of them, and may be any: the turns of the samples are told.
        let (turn_covariance, turn_errors) = if parameter.trace() < WIDE {
            (parameter, fit.turn_covariance_errors())
        } else {
            let turns = attitudes.iter().map(|q| (fit.law().mean().inverse() * q).scaled_axis());
            let c = turns.map(|t| t * t.transpose()).sum::<Matrix3<f64>>() / n;
            (c, Some(errors_of(&c, samples.len())))
        };
        // q and −q are one attitude: the mean on the side of the samples' mean.
        Ok(Self {
            law: held_by_entries(fit.law()),
            finding: AxesFinding::Determined,
            turn_covariance,
            turn_errors,
            mean_covariance: fit.mean_covariance(),
            radial: Some(radial),
            converged: fit.convergence().converged,
            isotropy: None,
            second_lobe,
        })
    }

    /// Attitudes on a sphere of lower dimension: turns about the directions in which there are any, whatever these are.
    /// The covariance is that of small turns in body axes.
    fn still(covariance: Matrix3<f64>, mean: UnitQuaternion<f64>) -> Self {
        let eigen = covariance.symmetric_eigen();
        let about = eigen.eigenvectors.transpose();
        let local = eigen.eigenvalues.map(|v| if v > FIXED * FIXED { v } else { 0.0 });
        Self::turning(mean, &about, local.into(), AxesFinding::Still)
    }

    /// p-value of equal tilt in all directions, which is all that the law can hold where one turn
    /// is free.
    pub(super) fn isotropy(&self) -> Option<f64> {
        self.isotropy
    }
}

/// Standard errors of the covariance of so many samples of a normal law.
fn errors_of(c: &Matrix3<f64>, count: usize) -> Matrix3<f64> {
    let square = |i, j| c[(i, i)] * c[(j, j)] + c[(i, j)] * c[(i, j)];
    Matrix3::from_fn(|i, j| (square(i, j) / count as f64).sqrt())
}

/// Mean squares of the turns about the principal axes of a mean, rad², where they are small.
fn squared_turns(samples: &[Sample], mean: &UnitQuaternion<f64>) -> [f64; 3] {
    products_of_turns(samples, mean).diagonal().into()
}

/// The same of all products of two.
fn products_of_turns(samples: &[Sample], mean: &UnitQuaternion<f64>) -> Matrix3<f64> {
    let turns = samples.iter().map(|s| vector_part(mean, &s.attitude) * 2.0);
    turns.map(|t| t * t.transpose()).sum::<Matrix3<f64>>() / samples.len() as f64
}

/// The most likely σ² of half tilts t with |t|² = u or 1 − u, of which `squares` holds the smaller: u has the density
/// ∝ cosh((½ − u)/(2σ²)) on [0, ½], so (½ − u) tanh((½ − u)/(2σ²)) is on average ½ coth(1/(4σ²)) − 2σ². Infinite if the
/// axis points anywhere.
fn tilt_variance(squares: &[f64]) -> f64 {
    let n = squares.len() as f64;
    // In λ = 1/(2σ²): where it is large, 1/λ is the mean of u. Positive below the solution, negative above it.
    let excess = |lambda: f64| {
        let mean = squares.iter().map(|u| (0.5 - u) * libm::tanh((0.5 - u) * lambda)).sum::<f64>();
        mean / n - (0.5 / libm::tanh(0.5 * lambda) - 1.0 / lambda)
    };
    let share = squares.iter().sum::<f64>() / n;
    if share < NEAR {
        return 0.5 * share;
    }
    let (mut low, mut high) = (WIDEST, 1.0 / share);
    if !(excess(low) > 0.0) {
        return f64::INFINITY;
    }
    while high - low > 1e-9 * high {
        let middle = 0.5 * (low + high);
        if excess(middle) > 0.0 { low = middle } else { high = middle }
    }
    0.5 / low
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::RngExt;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    /// Turns with an upper limit, as of a tolerance, have lighter tails than the law of the axes. The deviations told are
    /// those of the samples all the same.
    #[test]
    fn deviations_of_bounded_turns_are_those_of_the_samples() {
        for seed in 0..20 {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let limits: [f64; 3] =
                std::array::from_fn(|_| 10_f64.powf(rng.random_range(-3.0..-1.0)));
            let turns: Vec<_> = (0..500)
                .map(|_| Vector3::from(limits.map(|limit| rng.random_range(-limit..limit))))
                .collect();
            let attitude = |turn: &Vector3<f64>| UnitQuaternion::from_scaled_axis(*turn);
            let samples: Vec<_> =
                turns.iter().map(|t| Sample { roots: [1.0; 3], attitude: attitude(t) }).collect();
            let fit = AxesFit::determined(&samples, UnitQuaternion::identity()).unwrap();
            for k in 0..3 {
                let own = turns.iter().map(|turn| turn[k] * turn[k]).sum::<f64>() / 500.0;
                let ratio = (fit.turn_covariance()[(k, k)] / own).sqrt();
                assert!((ratio - 1.0).abs() < 0.05, "{seed}: {limits:?}, axis {k}: {ratio}");
            }
        }
    }

    /// Tilts drawn from the law ∝ exp(−|t|²/(2σ²)) with either end of the axis: the estimate is likelier than its neighbours,
    /// and near the truth.
    #[test]
    fn tilts_come_back_whichever_end_is_which() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        for variance in [1e-6, 0.004, 0.02, 0.1, 0.3_f64] {
            let theta = 2.0 * variance;
            const N: usize = 20_000;
            let squares: Vec<f64> = (0..N)
                .map(|_| {
                    let cut = -(-1.0 / theta).exp_m1();
                    let u = -theta * (-rng.random::<f64>() * cut).ln_1p();
                    u.min(1.0 - u)
                })
                .collect();
            let ln_likelihood = |variance: f64| -> f64 {
                let lambda = 0.5 / variance;
                let of = |u: &f64| (-lambda * u).exp() + (-lambda * (1.0 - u)).exp();
                squares.iter().map(|u| of(u).ln()).sum::<f64>()
                    + N as f64 * (lambda.ln() - (-(-lambda).exp_m1()).ln())
            };
            let found = tilt_variance(&squares);
            for other in [0.98, 1.02] {
                assert!(ln_likelihood(found) > ln_likelihood(other * found), "{variance}: {found}");
            }
            // The information on ln σ² falls from one a sample to little where the tilt is wide.
            let error = if variance > 0.05 { 0.2 } else { 0.03 };
            assert!((found / variance - 1.0).abs() < error, "{variance}: {found}");
        }
        let any: Vec<f64> = (0..1000).map(|i| (f64::from(i) + 0.5) / 2000.0).collect();
        assert_eq!(tilt_variance(&any), f64::INFINITY);
    }
}
