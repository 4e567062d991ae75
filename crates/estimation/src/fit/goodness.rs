//! Whether samples look like draws of the model that was fitted to them.

use gyradius_statistics::tail;
use nalgebra::{DMatrix, Matrix3, Vector3};
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};
use std::fmt;

use crate::assessment::{Goodness, Test};

use super::{
    AxesFinding, PrincipalFit,
    matching::mean_attitude,
    relabel::Sample,
    root::{RootEstimate, RootFit},
    round::{direction, direction_near},
    simulated::Simulated,
};

/// A column that differs from a sum of others by less than this share of its length is that sum: two roots that are equal
/// to the digits of tables.
const SAME_COLUMN: f64 = 1e-4;
/// Simulated samples at most, and as few as suffice to see this many that look worse.
const SIMULATED: usize = 999;
const SIMULATED_IF_MANY: usize = 399;
const MANY: usize = 2000;
const WORSE: usize = 20;
/// From this many deviations on, a folded law is a Gaussian to any test.
const UNFOLDED: f64 = 4.0;
/// Turns that scatter less than this, rad, are not tested: laws of fixed axes scatter by as much.
const STILL: f64 = 2e-5;

/// What of the model a test looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Aspect {
    /// The distribution of one root.
    Root {
        /// Axis, from 1.
        axis: usize,
    },
    /// That the roots are independent of each other.
    Roots,
    /// The shape of the distribution of the axes.
    Axes,
    /// How far the axes turn from their mean.
    Turn,
    /// Where one turn of the axes is free: that the axis that stays tilts alike in all directions.
    Tilt,
    /// That roots and axes are independent.
    RootsAndAxes,
    /// Mean and covariance of the six entries.
    Entries,
}

impl fmt::Display for Aspect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Root { axis } => write!(f, "k{axis} is Gaussian"),
            Self::Roots => f.write_str("roots are independent of each other"),
            Self::Axes => f.write_str("axes scatter as the law says"),
            Self::Turn => f.write_str("axes turn as far as the law says"),
            Self::Tilt => f.write_str("the axis tilts alike in all directions"),
            Self::RootsAndAxes => f.write_str("roots and axes are independent"),
            Self::Entries => f.write_str("entries scatter as the law says"),
        }
    }
}

/// One test of the model of an inertia.
pub type FitTest = Test<Aspect>;

/// Whether samples look like draws of the fitted model of an inertia.
pub type Assessment = Goodness<Aspect>;

impl fmt::Display for Assessment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.tests().is_empty() {
            return f.write_str("nothing scatters, so there is nothing to test");
        }
        if self.fits() {
            return write!(
                f,
                "nothing speaks against the model (p = {:.2}: so often would samples of the model \
                 itself look worse)",
                self.p_value()
            );
        }
        f.write_str("the model does not fit:")?;
        for (i, test) in self.objections().enumerate() {
            f.write_str(if i == 0 { " " } else { "; " })?;
            match test.aspect() {
                Aspect::Root { axis } => write!(f, "k{axis} is not Gaussian")?,
                Aspect::Roots => f.write_str("the roots depend on each other")?,
                Aspect::Axes => f.write_str(
                    "the axes do not scatter as the law says (several groups, outliers, or turns that have a \
                     limit, for example)",
                )?,
                Aspect::Turn => f.write_str(
                    "the axes do not turn as far as the law says (tails heavier or lighter than its own, \
                     for example)",
                )?,
                Aspect::Tilt => f.write_str("the axis tilts more one way than another")?,
                Aspect::RootsAndAxes => f.write_str("the axes depend on the roots")?,
                Aspect::Entries => f.write_str(
                    "the entries of the samples do not have the mean and the covariance that the law gives them",
                )?,
            }
            let (p, least) = (test.p_value(), test.resolution());
            let below = if p <= least { "≤" } else { "=" };
            if p == 0.0 || (p < 1e-99 && least == 0.0) {
                write!(f, " (p < 1e-99)")?;
            } else if p < 1e-3 {
                write!(f, " (p {below} {p:.0e})")?;
            } else {
                write!(f, " (p {below} {p:.3})")?;
            }
        }
        Ok(())
    }
}

impl PrincipalFit {
    /// Tests whether the samples look like draws of the model.
    ///
    /// # Algorithm
    /// * Each root: Anderson and Darling's A² with both parameters estimated (D'Agostino &
    ///   Stephens 1986); where the mean is within four deviations of zero, against the folded
    ///   normal law by parametric bootstrap, refitted each time.
    /// * The roots among themselves, and the roots against the turns: Bartlett's likelihood ratio
    ///   of correlations, χ².
    /// * The turns from their mean: Mardia's (1970, doi:10.1093/biomet/57.3.519) skewness and
    ///   kurtosis in one number, by parametric bootstrap from the fitted law, so that no normal
    ///   approximation enters. Bootstraps stop as soon as
    ///   20 simulations look worse (Besag & Clifford 1991, doi:10.1093/biomet/78.2.301).
    /// * How far the axes turn: the density of the fitted law at each attitude, against the same of draws
    ///   of that law, by Anderson and Darling's A². For one narrow lobe the density tells the
    ///   Mahalanobis distance from the mean; for any law it tells whether the quantiles of the turns
    ///   are those of the law. The law is taken as given, though it was fitted: p is too large
    ///   rather than too small. A light second lobe, which any outlier can have made, moves the quantiles
    ///   of the others by next to nothing.
    /// * The six entries: their mean and covariance against those of the law, which are exact, as far as the fit has not
    ///   made them agree (Neyman's C(α), 1959), by draws of the law.
    /// * What does not scatter is not tested, nor are turns that are free.
    ///
    /// # Limits
    /// Tests see what they look at: dependence that leaves no correlation passes.
    pub fn assess<R: Rng + ?Sized>(&self, rng: &mut R) -> Assessment {
        self.assess_with(rng, &|_| {})
    }

    /// The same, and reports how many samples it has simulated, of
    /// [`simulations`](Self::simulations) at most.
    pub fn assess_with<R: Rng + ?Sized>(&self, rng: &mut R, progress: &dyn Fn(u64)) -> Assessment {
        let mut done = 0;
        let mut tick = || {
            done += 1;
            progress(done);
        };
        let mut tests = Vec::new();
        let n = self.samples.len();
        let scatters: Vec<usize> =
            (0..3).filter(|k| self.roots[*k].law() != RootEstimate::Constant).collect();
        for &k in &scatters {
            let values: Vec<f64> = self.samples.iter().map(|s| s.roots[k]).collect();
            let (p_value, least) = root_p_value(&self.roots[k], values, rng, &mut tick);
            tests.push(FitTest::new(Aspect::Root { axis: k + 1 }, p_value, least));
        }
        let roots: Vec<Vec<f64>> =
            scatters.iter().map(|&k| self.samples.iter().map(|s| s.roots[k]).collect()).collect();
        if roots.len() > 1 {
            let p_value = independence(&roots, &[], n);
            tests.push(FitTest::new(Aspect::Roots, p_value, 0.0));
        }
        let turns = self.turns();
        let simulated = Simulated::of(self);
        if let Some(observed) = omnibus(&turns) {
            let mut densities = Vec::new();
            let (p_value, least) = bootstrap(observed, n, &mut tick, || {
                let samples: Vec<Sample> = (0..n).map(|_| simulated.draw(rng)).collect();
                if densities.len() < WORSE * n {
                    densities.extend(self.ln_densities(&samples));
                }
                omnibus(&self.turns_of(&samples)).unwrap_or(0.0)
            });
            tests.push(FitTest::new(Aspect::Axes, p_value, least));
            if self.axes.finding() == AxesFinding::Determined {
                let statistic = anderson_darling_of(self.ln_densities(&self.samples), densities);
                let p_value = tail::anderson_darling(statistic);
                tests.push(FitTest::new(Aspect::Turn, p_value, 0.0));
            }
        }
        if let Some(p_value) = self.axes.isotropy() {
            tests.push(FitTest::new(Aspect::Tilt, p_value, 0.0));
        }
        if !turns.is_empty() && !roots.is_empty() {
            let p_value = independence(&roots, &turns, n);
            tests.push(FitTest::new(Aspect::RootsAndAxes, p_value, 0.0));
        }
        if let Some((p_value, least)) = self.entries_p_value(&simulated, rng, &mut tick) {
            tests.push(FitTest::new(Aspect::Entries, p_value, least));
        }
        Assessment::new(tests)
    }

    /// How many samples [`assess_with`](Self::assess_with) simulates at most.
    #[must_use]
    pub fn simulations(&self) -> u64 {
        let folded = self.roots.iter().filter(|r| is_folded(r)).count() as u64;
        (folded + 2) * most(self.samples.len()) as u64
    }

    pub(crate) fn turns(&self) -> Vec<Vec<f64>> {
        self.turns_of(&self.samples)
    }

    /// ln of the density of the fitted law at the attitudes.
    fn ln_densities(&self, samples: &[Sample]) -> Vec<f64> {
        samples.iter().map(|s| self.law.axes().ln_attitude_density(&s.attitude)).collect()
    }

    /// Coordinates of the turns from their own mean that scatter, one list each.
    fn turns_of(&self, samples: &[Sample]) -> Vec<Vec<f64>> {
        let mean = match self.axes.finding() {
            AxesFinding::Free => return Vec::new(),
            AxesFinding::FreeTurn { .. } => self.axes.law().mean(),
            _ => mean_attitude(samples.iter().map(|s| &s.attitude)),
        };
        let all: Vec<Vector3<f64>> = match self.axes.finding() {
            // The tilt of the axis that has a direction, in the body.
            AxesFinding::FreeTurn { axis } => {
                let k = axis - 1;
                let centre = direction(&mean, k);
                let tilt = |s: &Sample| {
                    let p = mean * direction_near(&centre, &s.attitude, k);
                    Vector3::new(p[(k + 1) % 3], p[(k + 2) % 3], 0.0)
                };
                samples.iter().map(tilt).collect()
            }
            _ => {
                let inverse = mean.inverse();
                samples.iter().map(|s| (inverse * s.attitude).scaled_axis()).collect()
            }
        };
        // Directions that do not scatter are left out: those of the covariance, or all.
        let n = all.len() as f64;
        let centre = all.iter().sum::<Vector3<f64>>() / n;
        let scatter: Matrix3<f64> =
            all.iter().map(|t| (t - centre) * (t - centre).transpose()).sum::<Matrix3<f64>>() / n;
        let eigen = scatter.symmetric_eigen();
        let largest = eigen.eigenvalues.max();
        (0..3)
            .filter(|i| eigen.eigenvalues[*i] > (1e-9 * largest).max(STILL * STILL))
            .map(|i| all.iter().map(|t| (t - centre).dot(&eigen.eigenvectors.column(i))).collect())
            .collect()
    }
}

fn is_folded(root: &RootFit) -> bool {
    root.law() == RootEstimate::Folded && root.mean() < UNFOLDED * root.deviation()
}

fn most(n: usize) -> usize {
    if n > MANY { SIMULATED_IF_MANY } else { SIMULATED }
}

/// Share of simulated statistics at least as large as the observed, and the least it can be.
pub(super) fn bootstrap(
    observed: f64,
    n: usize,
    tick: &mut dyn FnMut(),
    mut simulate: impl FnMut() -> f64,
) -> (f64, f64) {
    let most = most(n);
    let least = 1.0 / (most as f64 + 1.0);
    let mut worse = 0;
    for i in 0..most {
        worse += usize::from(simulate() >= observed);
        tick();
        if worse == WORSE {
            return (WORSE as f64 / (i as f64 + 1.0), least);
        }
    }
    ((worse as f64 + 1.0) * least, least)
}

fn root_p_value<R: Rng + ?Sized>(
    fit: &RootFit,
    mut values: Vec<f64>,
    rng: &mut R,
    tick: &mut dyn FnMut(),
) -> (f64, f64) {
    let n = values.len();
    values.sort_by(f64::total_cmp);
    let statistic =
        |fit: &RootFit, sorted: &[f64]| anderson_darling(sorted.iter().map(|k| fit.below(*k)));
    let observed = statistic(fit, &values);
    if !is_folded(fit) {
        return (tail::anderson_darling_normal(observed, n as f64), 0.0);
    }
    bootstrap(observed, n, tick, || {
        let mut drawn: Vec<f64> = (0..n)
            .map(|_| {
                let z: f64 = StandardNormal.sample(rng);
                (fit.mean() + fit.deviation() * z).abs()
            })
            .collect();
        let again = RootFit::of(&drawn, 0.0);
        drawn.sort_by(f64::total_cmp);
        statistic(&again, &drawn)
    })
}

/// A² of probabilities in ascending order.
pub(crate) fn anderson_darling(below: impl Iterator<Item = f64>) -> f64 {
    let below: Vec<f64> = below.collect();
    let n = below.len();
    let ln = |p: f64| libm::log(p.max(1e-300));
    let sum: f64 =
        (0..n).map(|i| (2 * i + 1) as f64 * (ln(below[i]) + ln(1.0 - below[n - 1 - i]))).sum();
    -(n as f64) - sum / n as f64
}

/// A² of a sample against the law of a larger one.
fn anderson_darling_of(mut sample: Vec<f64>, mut law: Vec<f64>) -> f64 {
    sample.sort_by(f64::total_cmp);
    law.sort_by(f64::total_cmp);
    let of = law.len() as f64 + 1.0;
    anderson_darling(sample.iter().map(|x| (law.partition_point(|y| y < x) as f64 + 0.5) / of))
}

/// Mardia's skewness n·b₁/6 plus the square of his standardised kurtosis, of centred coordinates that
/// are uncorrelated; none if there are no coordinates. It is not changed by linear maps.
fn omnibus(coordinates: &[Vec<f64>]) -> Option<f64> {
    let p = coordinates.len();
    let n = coordinates.first()?.len();
    let count = n as f64;
    let scale: Vec<f64> =
        coordinates.iter().map(|c| (count / c.iter().map(|x| x * x).sum::<f64>()).sqrt()).collect();
    let mut third = [0.0; 27];
    let mut fourth = 0.0;
    for i in 0..n {
        let mut z = [0.0; 3];
        for (z, (c, s)) in z.iter_mut().zip(coordinates.iter().zip(&scale)) {
            *z = c[i] * s;
        }
        let square = z[0] * z[0] + z[1] * z[1] + z[2] * z[2];
        fourth += square * square;
        for (k, sum) in third.iter_mut().enumerate() {
            *sum += z[k / 9] * z[k / 3 % 3] * z[k % 3];
        }
    }
    let skewness = third.iter().map(|s| (s / count) * (s / count)).sum::<f64>() * count / 6.0;
    let p = p as f64;
    let kurtosis = (fourth / count - p * (p + 2.0)) / (8.0 * p * (p + 2.0) / count).sqrt();
    Some(skewness + kurtosis * kurtosis)
}

/// Those of the columns, of mean zero and length one, that are no sums of those before.
fn of_full_rank(columns: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let (mut kept, mut directions) = (Vec::new(), Vec::<Vec<f64>>::new());
    for column in columns {
        let mut rest = column.clone();
        for direction in &directions {
            let along: f64 = rest.iter().zip(direction).map(|(x, y)| x * y).sum();
            rest.iter_mut().zip(direction).for_each(|(x, y)| *x -= along * y);
        }
        let norm = rest.iter().map(|x| x * x).sum::<f64>().sqrt();
        if norm > SAME_COLUMN {
            rest.iter_mut().for_each(|x| *x /= norm);
            directions.push(rest);
            kept.push(column);
        }
    }
    kept
}

/// p-value of no correlation: within `a` if `b` is empty, else between `a` and `b` (Bartlett).
pub(crate) fn independence(a: &[Vec<f64>], b: &[Vec<f64>], n: usize) -> f64 {
    let count = n as f64;
    let standard = |x: &Vec<f64>| -> Vec<f64> {
        let mean = x.iter().sum::<f64>() / count;
        let norm = x.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>().sqrt();
        x.iter().map(|v| (v - mean) / norm).collect()
    };
    let [a, b] = [a, b].map(|columns| columns.iter().map(standard).collect::<Vec<_>>());
    // What follows from others tells no more of what these depend on.
    let a = if b.is_empty() { a } else { of_full_rank(a) };
    let b = of_full_rank(b);
    let (p, q) = (a.len(), b.len());
    let standard: Vec<&Vec<f64>> = a.iter().chain(&b).collect();
    let correlation = DMatrix::from_fn(p + q, p + q, |i, j| {
        if i == j { 1.0 } else { standard[i].iter().zip(standard[j]).map(|(x, y)| x * y).sum() }
    });
    let whole = correlation.determinant().max(1e-300);
    if p == 0 {
        return 1.0;
    }
    let size = (p + q) as f64;
    let (ratio, factor, freedom) = if b.is_empty() {
        (whole, count - 1.0 - (2.0 * size + 5.0) / 6.0, p * (p - 1) / 2)
    } else {
        let first = correlation.view((0, 0), (p, p)).into_owned().determinant();
        let second = correlation.view((p, p), (q, q)).into_owned().determinant();
        ((whole / (first * second)).max(1e-300), count - 1.0 - 0.5 * (size + 1.0), p * q)
    };
    tail::chi_squared(-factor * libm::log(ratio.min(1.0)), freedom as f64)
}
