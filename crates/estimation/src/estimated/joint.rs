//! The joint law of mass, mass centre, gyration lengths and axes with the moments of an estimate, as nearly as it can.

use gyradius_dispersion::{
    AxesLaw, FixedAttitude, JointScalar, MassPropertiesLaw, ScalarLaw, TenParameters, TensorLaw,
};
use gyradius_inertia::{InertiaMatrix, MassProperties};
use nalgebra::{DMatrix, DVector, Matrix3, UnitQuaternion, Vector3};
use rand::{SeedableRng, rngs::Xoshiro256PlusPlus};
use rand_distr::Distribution;

use super::distance::{Gaps, moments, units};
use super::log_cholesky::narrower;
use super::ten_estimate::{Matrix10, Ten, TenEstimate, TenForm};
use crate::rollup::symmetric::with_eigenvalues;
use crate::statements::levenberg_marquardt::{Effort, Problem, Range, least_squares};
use crate::turns::{FIXED, law_of_turns_about};

/// Scalars come first: mass, mass centre, gyration lengths; then three rotations.
const SCALARS: usize = JointScalar::ALL.len();
/// Above this share of the mean, a normal length could be zero: it is lognormal.
const SAFE_LENGTH: f64 = 0.5;
/// Singular values of the derivatives below this share of the largest belong to what cannot be seen: the rotation of a rod about itself.
const SEEN: f64 = 1e-9;
/// Steps at most.
const STEPS: usize = 12;
/// What is nearer than this is not searched for, and what a factor needs on its diagonal.
const NEAR: f64 = 1e-9;
const RIDGE: f64 = 1e-9;
/// Bounds of the factor.
const MOST_FACTOR: f64 = 100.0;
/// Where nothing is left to gain.
const NOTHING: f64 = 1e-10;
/// A length whose square comes out below this share of what it was is zero.
const FLAT: f64 = 1e-3;
/// A length below this share of the longest is the rounding of a plate or a rod.
const ROUNDING: f64 = 1e-6;
/// Steps that bring nothing, after which the search ends.
const PATIENCE: usize = 2;
/// What varies by less than this does not.
const STILL: f64 = 1e-12;
/// Rotations by more than this, and lengths with a larger share of deviation, are not of first order.
const WIDE: f64 = 0.3;
/// The first and the last step of the refinement, as powers of two of a deviation, and what a step must bring: so they end.
const FIRST: f64 = 1.0;
const LAST: f64 = 0.1;
const BETTER: f64 = 3e-3;
/// Narrower laws that are looked at: the last one has an eighth of the deviations.
const NARROW: usize = 4;
/// The largest coefficient of correlation.
const MOST: f64 = 1.0 - 1e-9;

/// The means of mass, mass centre and lengths, the mean axes, and the covariance of these and of small rotations.
#[derive(Clone, Debug)]
pub(super) struct Joint {
    mean: Ten,
    axes: UnitQuaternion<f64>,
    spread: Matrix10,
}

/// The joint law as near to moments as its family allows, from a body on: the means, and by least squares the covariances. What the
/// family has not are the 21 covariances of scalars with rotations of the axes.
///
/// The covariance of the ten is D S Dᵀ to first order, linear in the covariance S of scalars and rotations: a convex problem. What the
/// law's own moments differ from that is added to what is sought, and so on.
///
/// First order is that of another body with the same axes, whose moments may differ more: across equal moments rotations would do nothing.
pub(super) fn matched(
    target: &TenEstimate,
    start: &MassProperties,
    other: &MassProperties,
) -> Option<Joint> {
    let form = target.form();
    let Means { mean, axes } = Means::of(start)?;
    let apart = Means::of(other)?.mean - mean;
    let units = units(target);
    let mut sought = *target.covariance();
    let spread = nearest(form, &(mean + apart), &axes, &sought, &units)?;
    let mut joint = Joint { mean, axes, spread };
    let mut best: Option<(f64, Joint)> = None;
    let mut vain = 0;
    for _ in 0..STEPS {
        let Some(gaps) = joint.law([1.0, 1.0]).and_then(|law| moments(&law, form)) else { break };
        let gaps = Gaps::of(target, &gaps);
        let off = gaps.off();
        let before = best.as_ref().map_or(f64::INFINITY, |best| best.0);
        if off < before {
            best = Some((off, joint.clone()));
        }
        if !(off < 0.9 * before) {
            vain += 1;
        }
        if vain > PATIENCE {
            break;
        }
        if off < NOTHING {
            break;
        }
        let derivative = derivative(form, &(joint.mean + apart), &joint.axes)?;
        let first_order = derivative * joint.spread * derivative.transpose();
        let law = target.covariance() - gaps.covariance;
        sought = target.covariance() + first_order - law;
        let Some((mean, axes)) = joint.moved(&(inverse(&derivative)? * gaps.mean)) else { break };
        let spread = nearest(form, &(mean + apart), &axes, &sought, &units)?;
        joint = Joint { mean, axes, spread };
    }
    best.map(|best| best.1)
}

/// Of narrower and narrower laws about a body the one nearest to an estimate, that still has some spread.
pub(super) fn narrow(estimate: &TenEstimate, body: &MassProperties) -> Option<Joint> {
    let units = units(estimate);
    let Means { mean, axes } = Means::of(body)?;
    let spread = nearest(estimate.form(), &mean, &axes, estimate.covariance(), &units)?;
    let mut best: Option<(f64, Joint)> = None;
    for share in narrower().take(NARROW) {
        let joint = Joint { mean, axes, spread: spread * share };
        let off = joint.off(estimate).unwrap_or(f64::INFINITY);
        match &best {
            // From there on, the spread that is missing costs more than the mean gains.
            Some((least, _)) if off.is_finite() && off > *least => break,
            _ => best = Some((off, joint)),
        }
    }
    best.map(|best| best.1)
}

/// The means of a law that is concentrated at a body.
struct Means {
    mean: Ten,
    axes: UnitQuaternion<f64>,
}

impl Means {
    fn of(body: &MassProperties) -> Option<Self> {
        let (m, c) = (body.mass_kg(), body.mass_centre_m());
        let lengths = body.radii_of_gyration().ok()?.values();
        let longest = lengths.into_iter().fold(0.0, f64::max);
        let lengths = lengths.map(|length| if length > ROUNDING * longest { length } else { 0.0 });
        let [x, y, z] = lengths;
        let mean = Ten::from([m, c.x, c.y, c.z, x, y, z, 0.0, 0.0, 0.0]);
        Some(Self { mean, axes: body.inertia().principal_axes().attitude() })
    }
}

/// The covariance S that the family has with D S Dᵀ nearest to a covariance, in units of deviations: least squares from
/// the solution without the covariances that are not there.
fn nearest(
    form: TenForm,
    mean: &Ten,
    axes: &UnitQuaternion<f64>,
    sought: &Matrix10,
    units: &Ten,
) -> Option<Matrix10> {
    let derivative = derivative(form, mean, axes)?;
    let inverse = inverse(&derivative)?;
    let start = possible(&(inverse * sought * inverse.transpose()));
    let size = start.diagonal().map(|v| v.max(0.0).sqrt());
    let map = Matrix10::from_fn(|i, j| derivative[(i, j)] * size[j] / units[i]);
    let right = Matrix10::from_fn(|i, j| sought[(i, j)] / units[i] / units[j]);
    let start = Matrix10::from_fn(|i, j| {
        let own = size[i] * size[j];
        if own > 0.0 { start[(i, j)] / own } else { f64::from(u8::from(i == j)) }
    });
    let task = Linear { map, right };
    let found = if task.gaps(&start).norm() > NEAR {
        let ridge = start * (1.0 - RIDGE) + Matrix10::identity() * RIDGE;
        let factor = ridge.cholesky()?.l();
        let (factor, _) = least_squares(&task, factor, Effort::FINE);
        let found = factor * factor.transpose();
        if task.gaps(&found).norm() < task.gaps(&start).norm() { found } else { start }
    } else {
        start
    };
    Some(Matrix10::from_fn(|i, j| found[(i, j)] * size[i] * size[j]))
}

/// Least squares over the factor of a covariance in which scalars and rotations are apart.
struct Linear {
    map: Matrix10,
    right: Matrix10,
}

impl Linear {
    /// Half the relative differences of variances, and the differences of correlations of each pair.
    fn gaps(&self, covariance: &Matrix10) -> DVector<f64> {
        let gap = self.map * covariance * self.map.transpose() - self.right;
        let pairs = (0..10).flat_map(|i| (0..=i).map(move |j| (i, j)));
        DVector::from_iterator(55, pairs.map(|(i, j)| gap[(i, j)] * if i == j { 0.5 } else { 1.0 }))
    }
}

/// Row and column of the entries of the factor that are not zero.
fn places() -> impl Iterator<Item = (usize, usize)> {
    let below =
        |from: usize, to: usize| (from..to).flat_map(move |i| (from..=i).map(move |j| (i, j)));
    below(0, SCALARS).chain(below(SCALARS, 10))
}

impl Problem for Linear {
    type Point = Matrix10;

    fn values(&self, point: &Matrix10) -> DVector<f64> {
        let values: Vec<f64> = places().map(|place| point[place]).collect();
        DVector::from_vec(values)
    }

    fn at(&self, values: DVector<f64>, _: &Matrix10) -> Matrix10 {
        let mut factor = Matrix10::zeros();
        for (place, value) in places().zip(values.iter()) {
            factor[place] = *value;
        }
        factor
    }

    fn residuals(&self, point: &Matrix10) -> DVector<f64> {
        self.gaps(&(point * point.transpose()))
    }

    fn range(&self, _: &Matrix10, _: usize) -> Range {
        // In deviations of the solution without the covariances that are not there.
        Range { least: -MOST_FACTOR, most: MOST_FACTOR, unit: 1.0 }
    }
}

impl Joint {
    /// How far its moments are from those of an estimate.
    pub(super) fn off(&self, estimate: &TenEstimate) -> Option<f64> {
        self.off_about(self.axes_law()?, estimate)
    }

    fn off_about(&self, axes: AxesLaw, estimate: &TenEstimate) -> Option<f64> {
        let law = self.law_about(axes, [1.0, 1.0])?;
        Some(Gaps::of(estimate, &moments(&law, estimate.form())?).off())
    }

    /// The nearest to an estimate that steps along one mean or one deviation after the other lead to. Where first order leads nowhere, or all
    /// deviations were made small together, each of them by itself may still be better.
    pub(super) fn refined(mut self, estimate: &TenEstimate) -> Option<Self> {
        // The law of the axes takes most of the time, and most steps leave it as it is. Its copies have the sampler that the first draw
        // sets up.
        let with_sampler = |axes: AxesLaw| {
            let _: UnitQuaternion<f64> = axes.sample(&mut Xoshiro256PlusPlus::seed_from_u64(0));
            axes
        };
        let mut axes = with_sampler(self.axes_law()?);
        let mut off = self.off_about(axes.clone(), estimate)?;
        let mut step = FIRST;
        while step > LAST {
            let mut is_better = false;
            for (i, is_mean) in (0..=SCALARS).flat_map(|i| [(i, true), (i, false)]) {
                for sign in [1.0, -1.0] {
                    let other = if is_mean {
                        self.with_mean(i, sign * step)
                    } else {
                        self.with_deviation(i, libm::exp2(sign * step))
                    };
                    let Some(other) = other else { continue };
                    let about = if i < SCALARS {
                        Some(axes.clone())
                    } else {
                        other.axes_law().map(with_sampler)
                    };
                    let Some(about) = about else { continue };
                    match other.off_about(about.clone(), estimate) {
                        Some(found) if found < (1.0 - BETTER) * off => {
                            (self, axes, off, is_better) = (other, about, found, true);
                            break;
                        }
                        Some(_) | None => {}
                    }
                }
            }
            if !is_better {
                step *= 0.5;
            }
        }
        Some(self)
    }

    /// With the mean of a scalar moved by so many of its deviations; none of what does not vary or is no scalar, or where it would change
    /// its sign.
    fn with_mean(&self, i: usize, by: f64) -> Option<Self> {
        let mut mean = self.mean;
        let deviation = self.spread[(i, i)].max(0.0).sqrt();
        mean[i] += by * deviation;
        let is_positive = (1..4).contains(&i) || (mean[i] > 0.0 && self.mean[i] > 0.0);
        (i < SCALARS && deviation > 0.0 && is_positive).then(|| Self { mean, ..self.clone() })
    }

    /// With the deviation of a scalar multiplied by a factor, or beyond these those of the rotations together.
    fn with_deviation(&self, i: usize, factor: f64) -> Option<Self> {
        let mut joint = self.clone();
        let end = if i < SCALARS { i + 1 } else { 10 };
        for own in i..end {
            joint.spread.row_mut(own).scale_mut(factor);
            joint.spread.column_mut(own).scale_mut(factor);
        }
        (joint.spread != self.spread).then_some(joint)
    }

    /// Means and axes after a step.
    fn moved(&self, shift: &Ten) -> Option<(Ten, UnitQuaternion<f64>)> {
        let mut mean = self.mean + shift;
        // In squares, in which the ten are linear: a plate whose axes scatter has a mean that is none.
        for k in 4..7 {
            let square = self.mean[k] * (self.mean[k] + 2.0 * shift[k]);
            mean[k] = if square > FLAT * self.mean[k] * self.mean[k] { square.sqrt() } else { 0.0 };
        }
        let by = Vector3::new(mean[7], mean[8], mean[9]);
        if !(mean[0] > 0.0 && by.norm() < 1.0 && mean.iter().all(|x| x.is_finite())) {
            return None;
        }
        mean.fixed_rows_mut::<3>(7).fill(0.0);
        Some((mean, self.axes * UnitQuaternion::from_scaled_axis(by)))
    }

    /// Whether lengths or axes vary so widely that first order says little.
    pub(super) fn is_wide(&self) -> bool {
        let wide = |i: usize| self.spread[(i, i)] > (WIDE * self.mean[i]).powi(2);
        (4..7).any(wide) || (7..10).any(|i| self.spread[(i, i)] > WIDE * WIDE)
    }

    /// The law, in units of a mass and a length that are so much in SI.
    pub(super) fn law(&self, units: [f64; 2]) -> Option<MassPropertiesLaw> {
        self.law_about(self.axes_law()?, units)
    }

    fn law_about(&self, axes: AxesLaw, [mass, length]: [f64; 2]) -> Option<MassPropertiesLaw> {
        let deviation = |i: usize| self.spread[(i, i)].max(0.0).sqrt();
        let mass = ScalarLaw::positive(self.mean[0] * mass, deviation(0) * mass).ok()?;
        let of_length = |i: usize| {
            let (mean, deviation) = (self.mean[i] * length, deviation(i) * length);
            if mean == 0.0 {
                ScalarLaw::normal(0.0, 0.0)
            } else if deviation > SAFE_LENGTH * mean {
                ScalarLaw::lognormal(mean, deviation)
            } else {
                ScalarLaw::normal(mean, deviation)
            }
            .ok()
        };
        let centre =
            |i: usize| ScalarLaw::normal(self.mean[i] * length, deviation(i) * length).ok();
        let lengths = [of_length(4)?, of_length(5)?, of_length(6)?];
        let tensor = TensorLaw::gyration_lengths(lengths, axes);
        let centre = [centre(1)?, centre(2)?, centre(3)?];
        let law = MassPropertiesLaw::new(mass, centre, tensor).ok()?;
        let mut pairs = Vec::new();
        for i in 0..SCALARS {
            for j in 0..i {
                let size = deviation(i) * deviation(j);
                let coefficient = if size > 0.0 { self.spread[(i, j)] / size * MOST } else { 0.0 };
                let varies = [i, j].into_iter().all(|i| self.mean[i] != 0.0 || i < 4);
                if varies && coefficient.abs() > STILL {
                    pairs.push((
                        JointScalar::ALL[i],
                        JointScalar::ALL[j],
                        coefficient.clamp(-MOST, MOST),
                    ));
                }
            }
        }
        law.with_correlation(&pairs).ok()
    }

    fn axes_law(&self) -> Option<AxesLaw> {
        let covariance = self.spread.fixed_view::<3, 3>(7, 7).into_owned();
        if !(covariance.trace() > FIXED * FIXED) {
            return Some(FixedAttitude::new(self.axes).into());
        }
        let eigen = covariance.symmetric_eigen();
        let variances = eigen.eigenvalues.map(|v| v.max(0.0)).into();
        let law = law_of_turns_about(self.axes, &eigen.eigenvectors.transpose(), variances).ok()?;
        Some(law.into())
    }
}

/// Nothing between scalars and rotations.
fn free(spread: &mut Matrix10) {
    for i in 0..SCALARS {
        for j in SCALARS..10 {
            spread[(i, j)] = 0.0;
            spread[(j, i)] = 0.0;
        }
    }
}

/// The nearest covariance that the family has, in correlations.
fn possible(spread: &Matrix10) -> Matrix10 {
    let mut spread = (spread + spread.transpose()) * 0.5;
    free(&mut spread);
    let deviations = spread.diagonal().map(|v| v.max(0.0).sqrt());
    let scale = |i: usize| if deviations[i] > STILL { deviations[i] } else { 1.0 };
    let still = |i: usize| deviations[i] <= STILL;
    let correlation = Matrix10::from_fn(|i, j| {
        if still(i) || still(j) { 0.0 } else { spread[(i, j)] / scale(i) / scale(j) }
    });
    let clipped = with_eigenvalues(&correlation, |x| x.max(0.0));
    Matrix10::from_fn(|i, j| clipped[(i, j)] * scale(i) * scale(j))
}

/// The ten of mass, mass centre, lengths, and axes rotated by a small vector in body axes.
fn ten(form: TenForm, y: &Ten, axes: &UnitQuaternion<f64>) -> Option<Ten> {
    let by = UnitQuaternion::from_scaled_axis(Vector3::new(y[7], y[8], y[9]));
    let rotation = *(axes * by).to_rotation_matrix().matrix();
    let squares = Vector3::new(y[4] * y[4], y[5] * y[5], y[6] * y[6]) * y[0];
    let second = rotation.tr_mul(&(Matrix3::from_diagonal(&squares) * rotation));
    let inertia = Matrix3::identity() * second.trace() - second;
    let inertia = InertiaMatrix::new((inertia + inertia.transpose()) * 0.5).ok()?;
    let mass_centre_m = Vector3::new(y[1], y[2], y[3]);
    Some(form.of(TenParameters { mass_kg: y[0], mass_centre_m, inertia }))
}

/// The derivatives of the ten by mass, mass centre, lengths and rotations.
fn derivative(form: TenForm, mean: &Ten, axes: &UnitQuaternion<f64>) -> Option<Matrix10> {
    const STEP: f64 = 1e-5;
    let mut derivative = Matrix10::zeros();
    for i in 0..10 {
        let at = |by: f64| {
            let mut there = *mean;
            there[i] += by;
            ten(form, &there, axes)
        };
        derivative.set_column(i, &((at(STEP)? - at(-STEP)?) / (2.0 * STEP)));
    }
    Some(derivative)
}

/// Its inverse, zero for what cannot be seen in the ten.
fn inverse(derivative: &Matrix10) -> Option<Matrix10> {
    let svd = DMatrix::from_fn(10, 10, |i, j| derivative[(i, j)]).svd(true, true);
    let least = SEEN * svd.singular_values.max();
    let inverse = svd.pseudo_inverse(least).ok()?;
    Some(Matrix10::from_fn(|i, j| inverse[(i, j)]))
}
