//! The paper's model fitted to samples of an inertia matrix.

mod axes;
mod entries;
mod goodness;
mod matching;
mod names;
mod notes;
mod order;
mod relabel;
mod root;
mod round;
mod simulated;
#[cfg(test)]
mod tests;
mod uniformity;

use gyradius_attitude::{FitError, RadiallyConstrainedGaussian};
use gyradius_dispersion::{PrincipalDispersion, ScalarRoots, ScalarRootsError};
use gyradius_inertia::{Inertia, RootSecondMoments, SecondMoments};
use nalgebra::{Matrix3, UnitQuaternion};

#[cfg(feature = "serde")]
use crate::read::belong;
use matching::{TIE, matched};
use names::Names;
use order::order;
use relabel::{Relabeling, Sample};
use round::{Roundness, straightened};

pub use axes::{AxesFinding, AxesFit};
pub use goodness::{Aspect, Assessment, FitTest};
pub(crate) use goodness::{anderson_darling, independence};
pub use notes::FitNote;
pub use root::{RootEstimate, RootFit};

/// The law of the axes alone has 13 parameters.
const NEEDED: usize = 13;
/// A second moment below this share of the trace is rounding, and the body a plate.
const ROUNDING: f64 = 1e-13;
/// A sample this many times as large as the median of all is no sample of the same body: g for kg is a thousand.
pub(crate) const LARGER: f64 = 500.0;
/// A root below this share of the size of the body is none, of a rod: with two of these there would be no axes, and no body
/// that turns. Second moments of 2.5e-9 stand for them.
const THIN: f64 = 5e-5;
/// A share of doubtful names that moves the fit and is worth a word.
const DOUBTFUL: f64 = 0.01;
/// How often doubtful names are drawn anew at most.
const ROUNDS: usize = 60;
/// How often they are drawn in vain, before the search ends: at least, and more where more names are in doubt.
const IN_VAIN: f64 = 2.0;
const IN_VAIN_IF_ALL: f64 = 10.0;
/// Laws that are likelier by less than this in the logarithm are as likely, to rounding: the first of them is kept.
const LIKELIER: f64 = 1e-6;
/// A turn smaller than this, rad, renames nothing: the least that does is a quarter turn.
const SAME: f64 = 1e-3;

/// Why samples have no [`PrincipalFit`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PrincipalFitError {
    /// Too few samples.
    #[error(
        "the number of samples is {count}: a fit needs at least {NEEDED}, one for each parameter of the axes"
    )]
    TooFew {
        /// How many were given.
        count: usize,
    },
    /// All moments are zero: there are no axes.
    #[error("sample {} is a point: all its moments of inertia are zero", index + 1)]
    Point {
        /// Its place, from 0.
        index: usize,
    },
    /// A sample is so large beside the others that the law of all would be about nothing but this one.
    #[error(
        "sample {}: the sum of its moments of inertia is {sum:.3e} kg·m², {:.1e} times the median of the samples; a \
         fit allows up to {LARGER} times: the sample has another unit, or a slip of the decimal point",
        index + 1, sum / median
    )]
    Large {
        /// Its place, from 0.
        index: usize,
        /// The sum of its moments of inertia, kg·m².
        sum: f64,
        /// The median of the sums of all samples, kg·m².
        median: f64,
    },
    /// The axes have no fit.
    #[error("axes: {0}")]
    Axes(FitError),
    /// The roots are out of range.
    #[error(transparent)]
    Roots(#[from] ScalarRootsError),
}

/// The place of a number that is so large beside the others that it must be in another unit, and their median.
pub(crate) fn far_larger(numbers: &[f64]) -> Option<(usize, f64)> {
    let mut sorted = numbers.to_vec();
    sorted.sort_by(f64::total_cmp);
    let median = *sorted.get(sorted.len() / 2)?;
    let index = numbers.iter().position(|number| !(number / median <= LARGER))?;
    Some((index, median))
}

impl From<FitError> for PrincipalFitError {
    fn from(error: FitError) -> Self {
        Self::Axes(error)
    }
}

impl PrincipalFitError {
    /// The place, from 0, of the sample that is refused, where it is one.
    #[must_use]
    pub fn sample(&self) -> Option<usize> {
        match self {
            Self::Point { index } | Self::Large { index, .. } => Some(*index),
            Self::TooFew { .. } | Self::Axes(_) | Self::Roots(_) => None,
        }
    }
}

/// How the principal axes of the samples were matched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Matching {
    /// Samples whose axes got another order than the nearest to the body axes.
    pub swapped: usize,
    /// Samples whose axes kept that order but not the signs.
    pub flipped: usize,
    /// Samples whose axes could be named otherwise, at odds below 20 : 1.
    pub doubtful: usize,
    /// Whether the names settled.
    pub converged: bool,
}

/// The model of Peck (2003), Gaussian roots of the second moments about axes from a radially
/// constrained Gaussian, fitted to samples of an inertia matrix.
///
/// # Algorithm
/// 1. Each sample is taken apart into principal moments and axes, whose order and signs mean nothing.
///    *Matching*: each sample gets the one of its 24 namings that is likeliest under mean and
///    scatter of roots and attitudes, and these are taken anew, until no name changes
///    (classification EM; Celeux & Govaert 1992, doi:10.1016/0167-9473(92)90042-E). Nearness of the
///    axes and of the moments count together, each in units of its own scatter.
/// 2. *Roots*: [`RootFit`], each by itself.
/// 3. *Axes*: [`AxesFit`]. First whether they have a mean at all: two moments equal within their
///    scatter may leave a turn undetermined. Then [`RadiallyConstrainedGaussian::fit`]. Which of both is taken, the
///    likelihood says, whatever the axes are called.
/// 4. Where more than 1 % of the names are in doubt, they are drawn as they are likely under the law, and steps 2 and 3
///    are done again, until the likelihood grows no more.
/// 5. The nominal inertia is that of the mean roots about the mean axes, and names its axes as
///    [`Inertia::principal_axes`] does.
///
/// # Limits
/// At least 13 samples, no point among them and none 500 times as large as the median. Standard errors are those of
/// many samples, and suppose that the names are right.
///
/// ```
/// use gyradius_attitude::RadiallyConstrainedGaussian;
/// use gyradius_dispersion::{ScalarRoots, PrincipalDispersion};
/// use gyradius_estimation::PrincipalFit;
/// use gyradius_inertia::{Inertia, RootSecondMoments};
/// use nalgebra::{Matrix3, UnitQuaternion};
/// use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
/// use rand_distr::Distribution;
///
/// let truth = PrincipalDispersion::new(
///     ScalarRoots::normal(RootSecondMoments::new([30.0, 40.0, 50.0])?, [1.0, 2.0, 3.0])?,
///     RadiallyConstrainedGaussian::from_rotation_covariance(
///         UnitQuaternion::identity(),
///         Matrix3::identity() * 1e-3,
///         0.01,
///     )?,
/// );
/// let mut rng = ChaCha8Rng::seed_from_u64(1);
/// let samples: Vec<Inertia> = (0..500).map(|_| truth.sample(&mut rng)).collect();
///
/// let fit = PrincipalFit::new(&samples)?;
/// let root = fit.roots()[1];
/// assert!((root.mean() - 40.0).abs() < 4.0 * root.errors().unwrap()[0]);
/// assert!(fit.assess(&mut rng).fits());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, getset::CopyGetters, getset::Getters)]
pub struct PrincipalFit {
    samples: Vec<Sample>,
    /// The inertia of the mean roots about the mean axes. It is not the mean of the samples, which
    /// scatter moves: see [`EntryMoments`](gyradius_dispersion::EntryMoments).
    #[getset(get = "pub")]
    nominal: Inertia,
    /// The roots of the second moments, in the order of the principal axes of
    /// [`nominal`](Self::nominal).
    #[getset(get = "pub")]
    roots: [RootFit; 3],
    /// The axes.
    #[getset(get = "pub")]
    axes: AxesFit,
    /// How axes were matched.
    #[getset(get_copy = "pub")]
    matching: Matching,
    /// Standard deviations of the six entries of the samples, kg·m², in the order 11, 22, 33, 12, 13,
    /// 23: to be compared with those of the law, [`EntryMoments`](gyradius_dispersion::EntryMoments).
    #[getset(get_copy = "pub")]
    sample_deviations: [f64; 6],
    /// The fitted law.
    #[getset(get = "pub")]
    law: PrincipalDispersion<ScalarRoots, RadiallyConstrainedGaussian>,
}

impl PrincipalFit {
    /// Fits the model.
    ///
    /// # Errors
    /// Fewer than 13 samples, a point or a far larger one among them, or moments out of range.
    pub fn new(samples: &[Inertia]) -> Result<Self, PrincipalFitError> {
        Self::told_apart(samples, |_| [0.0; 4])
    }

    /// The same of samples of which more is known: numbers of the order of one, which tell those apart that have the same inertia.
    pub(crate) fn told_apart(
        samples: &[Inertia],
        others: impl Fn(usize) -> [f64; 4],
    ) -> Result<Self, PrincipalFitError> {
        if samples.len() < NEEDED {
            return Err(PrincipalFitError::TooFew { count: samples.len() });
        }
        if let Some(index) = samples.iter().position(|s| !(s.matrix().trace() > 0.0)) {
            return Err(PrincipalFitError::Point { index });
        }
        let sums: Vec<f64> = samples.iter().map(|s| s.matrix().trace()).collect();
        if let Some((index, median)) = far_larger(&sums) {
            return Err(PrincipalFitError::Large { index, sum: sums[index], median });
        }
        // In an order of their own, so that the same samples have the same fit in any order.
        let order = order(samples, others);
        let sorted: Vec<Inertia> = order.iter().map(|row| samples[*row]).collect();
        let apart: Vec<Sample> = sorted.iter().map(take_apart).collect();
        let matched = matched(&apart, &mean_axes(&sorted));
        let mut fitted = renamed(fit(matched.samples)?);
        // The fitted mean may be named otherwise than the first guess of it.
        for _ in 0..3 {
            let axes = fitted.nominal.principal_axes().attitude();
            let g = nearest(&fitted.axes.law().mean(), &axes);
            if g.turn.angle() > SAME {
                fitted = fit(fitted.samples.iter().map(|sample| sample.relabeled(g)).collect())?;
            } else {
                // Rounding, or two moments that are equal to it: a turn of the axes that nothing depends on.
                fitted.axes = fitted.axes.at(axes);
                break;
            }
        }
        let doubtful = Names::of(&fitted.roots, fitted.axes.law()).doubtful(&fitted.samples);
        let Fitted { samples: named, nominal, roots, axes, .. } = fitted;
        // Two axes have changed their names for nothing if the body is round about the third.
        let round = Roundness::of(&named);
        let for_nothing = |a: usize, b: usize| a == b || round.is_about(3 - a - b);
        let (mut swapped, mut flipped) = (0, 0);
        for (sample, before) in named.iter().zip(&apart) {
            let g = nearest(&before.attitude, &sample.attitude);
            let swaps = !(0..3).all(|k| for_nothing(k, g.order[k]));
            swapped += usize::from(swaps);
            flipped += usize::from(!swaps && g.turn.angle() > SAME && round == Roundness::No);
        }
        let sample_deviations = deviations(&sorted);
        let mut rows: Vec<(usize, Sample)> = order.into_iter().zip(named).collect();
        rows.sort_by_key(|(row, _)| *row);
        let mean = RootSecondMoments::new(mean_roots(&roots))
            .map_err(|_| ScalarRootsError::Reach { axis: 1 })?;
        let gaussian = ScalarRoots::normal(mean, roots.map(|r| r.deviation() * r.deviation()))?;
        let law = PrincipalDispersion::new(gaussian, axes.law().clone());
        let matching = Matching { swapped, flipped, doubtful, converged: matched.converged };
        Ok(Self {
            samples: rows.into_iter().map(|(_, sample)| sample).collect(),
            nominal,
            roots,
            axes,
            matching,
            sample_deviations,
            law,
        })
    }

    /// How many samples were fitted.
    #[must_use]
    pub fn count(&self) -> usize {
        self.samples.len()
    }

    fn names(&self) -> Names<'_> {
        Names::of(&self.roots, self.axes.law())
    }

    /// The root about principal axis `k` of each sample, as its axes were named.
    pub(crate) fn sample_roots(&self, k: usize) -> Vec<f64> {
        self.samples.iter().map(|sample| sample.roots[k]).collect()
    }
}

gyradius_dispersion::written!(
    PrincipalFit,
    |fit| {
        nominal_kg_m2: Inertia = fit.nominal,
        roots: [RootFit; 3] = fit.roots,
        axes: AxesFit = fit.axes.clone(),
        matching: Matching = fit.matching,
        entry_deviation_kg_m2: [f64; 6] = fit.sample_deviations,
        law: PrincipalDispersion<ScalarRoots, RadiallyConstrainedGaussian> = fit.law.clone(),
        samples: Vec<Sample> = fit.samples.clone(),
    },
    {
        let fit = PrincipalFit {
            samples,
            nominal: nominal_kg_m2,
            roots,
            axes,
            matching,
            sample_deviations: entry_deviation_kg_m2,
            law,
        };
        belong(
            fit.count() >= NEEDED
                && fit.matching.swapped <= fit.count()
                && fit.law.axes() == fit.axes.law()
                && fit.sample_deviations.iter().all(|deviation| *deviation >= 0.0),
            "fit of inertias",
        )?;
        fit
    }
);

fn deviations(samples: &[Inertia]) -> [f64; 6] {
    let rows: Vec<[f64; 6]> = samples.iter().map(Inertia::entries).collect();
    let n = rows.len() as f64;
    std::array::from_fn(|e| {
        let mean = rows.iter().map(|r| r[e] / n).sum::<f64>();
        (rows.iter().map(|r| (r[e] - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt()
    })
}

#[derive(Clone)]
struct Fitted {
    samples: Vec<Sample>,
    nominal: Inertia,
    roots: [RootFit; 3],
    axes: AxesFit,
    /// The ln-likelihood, whatever the axes are called, less what less free axes cost.
    height: f64,
    /// The law of the axes if no turn is free.
    determined: RadiallyConstrainedGaussian,
}

fn fit(samples: Vec<Sample>) -> Result<Fitted, PrincipalFitError> {
    let samples = straightened(samples);
    let columns = [0, 1, 2].map(|k| samples.iter().map(|s| s.roots[k]).collect::<Vec<f64>>());
    let n = samples.len() as f64;
    let sizes = columns.each_ref().map(|c| (c.iter().map(|k| k * k).sum::<f64>() / n).sqrt());
    let size = sizes.into_iter().fold(0.0, f64::max);
    let roots = columns.each_ref().map(|c| RootFit::of(c, size));
    let ln_likelihood = |axes: &_| Names::of(&roots, axes).ln_likelihood(&samples);
    let (axes, height, determined) = AxesFit::of(&samples, &roots, ln_likelihood)?;
    let out_of_range = |_| ScalarRootsError::Reach { axis: 1 };
    let mean = SecondMoments::new(mean_roots(&roots).map(|k| k * k)).map_err(out_of_range)?;
    let nominal = Inertia::from_second_moments(mean, &axes.law().mean())
        .map_err(|_| ScalarRootsError::Reach { axis: 1 })?;
    Ok(Fitted { samples, nominal, roots, axes, height, determined })
}

/// The mean roots, of which no two are next to nothing.
fn mean_roots(roots: &[RootFit; 3]) -> [f64; 3] {
    let means = roots.map(|root| root.mean());
    let size = roots.iter().map(|root| root.mean().hypot(root.deviation())).fold(0.0, f64::max);
    let mut thin: Vec<usize> = (0..3).filter(|k| means[*k] < THIN * size).collect();
    if thin.len() < 2 {
        return means;
    }
    thin.sort_by(|a, b| means[*a].total_cmp(&means[*b]));
    let mut raised = means;
    for (rank, k) in thin.into_iter().enumerate() {
        raised[k] = THIN * size * (1.0 + 0.5 * rank as f64);
    }
    raised
}

/// Where many names are in doubt, the likeliest are too orderly: all scatter that they allow goes out of the fit. So
/// names are drawn as they are likely under the law so far, the law is taken anew, and the likeliest of these laws
/// is kept, with the names of which it is made: stochastic EM (Celeux & Diebolt 1985, Computational Statistics
/// Quarterly 2, 73).
fn renamed(mut last: Fitted) -> Fitted {
    let mut best: Option<Fitted> = None;
    let mut in_vain = 0;
    for round in 0..ROUNDS {
        let start = 2.0_f64.sqrt() * round as f64;
        let names = Names::of(&last.roots, &last.determined);
        let (samples, changed) = names.drawn(&last.samples, start);
        let share = changed as f64 / samples.len() as f64;
        if best.is_none() && !(share > DOUBTFUL) {
            break;
        }
        let Ok(next) = fit(samples) else { break };
        last = next;
        if best.as_ref().is_none_or(|best| last.height > best.height + LIKELIER) {
            best = Some(last.clone());
            in_vain = 0;
        } else {
            in_vain += 1;
            if f64::from(in_vain) >= IN_VAIN + share * IN_VAIN_IF_ALL {
                break;
            }
        }
    }
    best.unwrap_or(last)
}

fn take_apart(inertia: &Inertia) -> Sample {
    let rounding = ROUNDING * inertia.matrix().trace();
    let k = inertia.second_moments().values();
    Sample {
        roots: k.map(|k| if k > rounding { k.sqrt() } else { 0.0 }),
        attitude: inertia.principal_axes().attitude(),
    }
}

/// The axes of the mean matrix, each sample scaled to trace one.
fn mean_axes(samples: &[Inertia]) -> UnitQuaternion<f64> {
    let sum: Matrix3<f64> = samples.iter().map(|s| s.matrix() / s.matrix().trace()).sum();
    // A sum of bodies is a body.
    Inertia::new((sum + sum.transpose()) * 0.5)
        .map_or_else(|_| UnitQuaternion::identity(), |mean| mean.principal_axes().attitude())
}

/// The naming g for which g ⊗ `from` is nearest to `to`, the first of those that are as near.
fn nearest(from: &UnitQuaternion<f64>, to: &UnitQuaternion<f64>) -> &'static Relabeling {
    let score = |g: &Relabeling| (g.turn * from).coords.dot(&to.coords).abs();
    let [first, others @ ..] = Relabeling::all();
    others.iter().fold(first, |best, g| if score(g) > score(best) + TIE { g } else { best })
}
