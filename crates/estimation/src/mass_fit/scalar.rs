//! A mass or a coordinate of the mass centre fitted: normal, lognormal or constant.

use gyradius_dispersion::{ScalarLaw, ScalarLawError};
use gyradius_statistics::tail;
use std::fmt;

use super::MassChoice;
use crate::fit::anderson_darling;
#[cfg(feature = "serde")]
use crate::read::{belong, scatter};

/// What scatters by less than this share of its size does not.
const STILL: f64 = 1e-9;
/// Above this share of the mean, the deviation of a normal mass makes a negative one possible.
const SAFE: f64 = 0.125;
/// Odds in favour of a lognormal law from which it is taken.
const ODDS: f64 = 20.0;

/// How a scalar was fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum ScalarEstimate {
    /// Mean and deviation of the samples.
    Normal,
    /// Mean and deviation of the logarithms.
    Lognormal,
    /// All samples have the same value to nine digits.
    Constant,
}

/// The maximum likelihood law of a mass in kg or of a coordinate of the mass centre in m.
#[derive(Clone, Copy, Debug, PartialEq, getset::CopyGetters)]
#[getset(get_copy = "pub")]
pub struct ScalarFit {
    /// The mean.
    mean: f64,
    /// The standard deviation; maximum likelihood, so the sum of squares is divided by n.
    deviation: f64,
    /// Standard errors of mean and deviation; none where nothing scatters.
    errors: Option<[f64; 2]>,
    #[getset(skip)]
    law: ScalarEstimate,
    #[getset(skip)]
    p_value: Option<f64>,
}

impl ScalarFit {
    /// Normal, of something that is compared with `size`.
    pub(super) fn normal(samples: &[f64], size: f64) -> Self {
        let (mean, deviation) = mean_and_deviation(samples);
        if !(deviation > STILL * (mean.abs() + size)) {
            return Self::constant(mean);
        }
        let n = samples.len() as f64;
        let errors = Some([deviation / n.sqrt(), deviation / (2.0 * n).sqrt()]);
        let p_value = Some(p_value(samples.to_vec(), mean, deviation));
        Self { mean, deviation, errors, law: ScalarEstimate::Normal, p_value }
    }

    pub(super) fn of_mass(samples: &[f64], choice: MassChoice) -> Self {
        let normal = Self::normal(samples, 0.0);
        if normal.law == ScalarEstimate::Constant {
            return normal;
        }
        let lognormal = Self::lognormal(samples);
        match choice {
            MassChoice::Normal => normal,
            MassChoice::Lognormal => lognormal,
            MassChoice::Likelier => {
                let n = samples.len() as f64;
                let logarithms: f64 = samples.iter().map(|m| libm::log(*m)).sum();
                // The maximum of ln L is −n ln σ, and of the lognormal law −n ln s − Σ ln m beside the same constants.
                let gain = n * (libm::log(normal.deviation) - libm::log(lognormal.log_deviation()))
                    - logarithms;
                if normal.deviation > SAFE * normal.mean || gain > libm::log(ODDS) {
                    lognormal
                } else {
                    normal
                }
            }
        }
    }

    fn lognormal(samples: &[f64]) -> Self {
        let logarithms: Vec<f64> = samples.iter().map(|m| libm::log(*m)).collect();
        let (centre, s) = mean_and_deviation(&logarithms);
        let (n, v) = (samples.len() as f64, s * s);
        let mean = libm::exp(centre + 0.5 * v);
        let ratio = libm::expm1(v).sqrt();
        let deviation = mean * ratio;
        // By the derivatives by centre (variance v/n) and s (variance v/2n).
        let by_s = deviation * s + mean * s * libm::exp(v) / ratio;
        let error = |by_centre: f64, by_s: f64| {
            (v / n * by_centre * by_centre + v / (2.0 * n) * by_s * by_s).sqrt()
        };
        let errors = Some([error(mean, mean * s), error(deviation, by_s)]);
        let p_value = Some(p_value(logarithms, centre, s));
        Self { mean, deviation, errors, law: ScalarEstimate::Lognormal, p_value }
    }

    fn constant(mean: f64) -> Self {
        let law = ScalarEstimate::Constant;
        Self { mean, deviation: 0.0, errors: None, law, p_value: None }
    }

    /// Which law was fitted.
    #[must_use]
    pub fn kind(&self) -> ScalarEstimate {
        self.law
    }

    /// How often samples of the law would look worse, by Anderson and Darling's test with estimated parameters.
    pub(super) fn p_value(&self) -> Option<f64> {
        self.p_value
    }

    /// The law.
    ///
    /// # Errors
    /// Mean or deviation are out of range.
    pub fn law(&self) -> Result<ScalarLaw, ScalarLawError> {
        match self.law {
            ScalarEstimate::Normal | ScalarEstimate::Constant => {
                ScalarLaw::normal(self.mean, self.deviation)
            }
            ScalarEstimate::Lognormal => ScalarLaw::lognormal(self.mean, self.deviation),
        }
    }

    /// The samples in the coordinate in which the law is normal; none where nothing varies.
    pub(super) fn scores(&self, samples: &[f64]) -> Option<Vec<f64>> {
        match self.law {
            ScalarEstimate::Constant => None,
            ScalarEstimate::Normal => {
                Some(samples.iter().map(|x| (x - self.mean) / self.deviation).collect())
            }
            ScalarEstimate::Lognormal => {
                let s = self.log_deviation();
                let centre = libm::log(self.mean) - 0.5 * s * s;
                Some(samples.iter().map(|x| (libm::log(*x) - centre) / s).collect())
            }
        }
    }

    /// The deviation of the logarithm of a lognormal law.
    fn log_deviation(&self) -> f64 {
        libm::log1p((self.deviation / self.mean).powi(2)).sqrt()
    }
}

gyradius_dispersion::written!(
    ScalarFit,
    |fit| {
        mean: f64 = fit.mean,
        deviation: f64 = fit.deviation,
        errors: Option<[f64; 2]> = fit.errors,
        law: ScalarEstimate = fit.law,
        p_value: Option<f64> = fit.p_value,
    },
    {
        let is_still = law == ScalarEstimate::Constant;
        let fit = ScalarFit { mean, deviation, errors, law, p_value };
        scatter(deviation, errors, is_still)?;
        belong(p_value.is_some() != is_still, "fit of a scalar")?;
        fit.law()?;
        fit
    }
);

impl fmt::Display for ScalarEstimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Normal => "normal",
            Self::Lognormal => "lognormal",
            Self::Constant => "constant",
        })
    }
}

fn mean_and_deviation(samples: &[f64]) -> (f64, f64) {
    let n = samples.len() as f64;
    let mean = samples.iter().map(|x| x / n).sum::<f64>();
    let variance = samples.iter().map(|x| (x - mean) * (x - mean) / n).sum::<f64>();
    (mean, variance.sqrt())
}

fn p_value(mut samples: Vec<f64>, mean: f64, deviation: f64) -> f64 {
    samples.sort_by(f64::total_cmp);
    let below = samples.iter().map(|x| tail::normal((mean - x) / deviation));
    tail::anderson_darling_normal(anderson_darling(below), samples.len() as f64)
}
