//! The realizable law of an estimate of the ten parameters: from an identification or a Bayesian posterior.

mod distance;
mod joint;
mod log_cholesky;
mod nearest;
mod ten_estimate;
#[cfg(test)]
mod tests;

use gyradius_dispersion::{LogCholeskyTen, MassPropertiesLaw, MassPropertiesModel, TenParameters};
use gyradius_inertia::{Inertia, LogCholesky, MassProperties};
use nalgebra::Matrix3;
use rand::{SeedableRng, rngs::Xoshiro256PlusPlus};
use rand_distr::Distribution;

use crate::mass_fit::{MassChoice, MassPropertiesFit};
use crate::rollup::symmetric::{second_moments_of_inertia, six};
use distance::moments;
use joint::Joint;
use ten_estimate::{Matrix10, Ten};

pub use distance::EstimateDistance;
pub use ten_estimate::{TenEstimate, TenEstimateError, TenForm};

/// Draws of which the joint law is fitted where its moments cannot be solved for.
const DRAWS: usize = 4000;
/// Moments of so many draws are about as far off by chance.
const DRAWN: f64 = 0.1;
/// What is farther off may have a better start: a law without any spread is at most so far from a mean that it has.
const POOR: f64 = 1.5;
/// What is farther off may be nearer where first order is taken of moments that are set apart.
const ROUGH: f64 = 1e-3;
/// A second moment that is set apart from others keeps at least this share.
const LEAST_APART: f64 = 0.1;
/// What is farther off, in deviations, is no law of the estimate.
const FAR: f64 = 1e3;
/// What a second moment and the mass are at least, as shares of their deviations, where searches for a law begin.
const INSIDE: [f64; 3] = [0.3, 0.03, 0.003];

/// The realizable laws whose mean and covariance of the ten are as nearly those of an estimate as their families have them, and how far
/// they had to move.
///
/// # Algorithm
/// 1. The nearest body in the metric of the covariance ([`moved`](Self::moved)): a convex problem.
/// 2. [`LogCholeskyTen`] has as many free numbers as there are moments, 10 + 55: Newton's steps on its moments, which are closed.
///    Where no such law has them, because the spread is too wide or the mean too near to the boundary, least squares
///    (Levenberg and Marquardt), with deviations of ½ ln m and of the logarithms of the diagonal of at most 1, from a law about as wide as
///    the estimate and from a narrow one about the nearest body: the nearer of the two.
/// 3. [`MassPropertiesLaw`], of mass, mass centre, gyration lengths and axes, has 44 free numbers: what it has not are the 21
///    covariances of mass, mass centre and lengths with rotations of the axes. Least squares on the moments of the law
///    of step 2; where the axes are not determined or lengths reach zero, a fit to 4,000 draws of it is taken if that
///    is nearer, and where all are far off, a narrow law about the nearest body. The nearest of these is then refined along each
///    mean and each deviation.
///
/// # Limits
/// The covariances are differences of products: deviations below 1e-6 of the numbers lose digits, and so do those of bodies that are far from the
/// origin beside their size.
///
/// ```
/// use gyradius_estimation::{EstimatedBody, TenEstimate, TenForm};
/// use nalgebra::{SMatrix, SVector};
///
/// // m, m c, I about the origin, each known to some percent; the inertia belongs to no body: 0.05 > 0.02 + 0.02.
/// let phi = SVector::from([2.0, 0.0, 0.0, 0.2, 0.02, 0.02, 0.05, 0.0, 0.0, 0.0]);
/// let deviations = SVector::from([0.1, 0.01, 0.01, 0.01, 0.004, 0.004, 0.004, 0.002, 0.002, 0.002]);
/// let covariance = SMatrix::from_diagonal(&deviations.component_mul(&deviations));
/// let estimate = TenEstimate::new(TenForm::Linear, phi, covariance)?;
///
/// let body = EstimatedBody::new(&estimate)?;
/// assert!(body.moved() > 1.0, "so many deviations to the nearest body");
/// assert!(body.joint().is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, getset::CopyGetters, getset::Getters)]
pub struct EstimatedBody {
    /// The body of the mean, or the one nearest to it in the metric of the covariance.
    #[getset(get = "pub")]
    nearest: MassProperties,
    /// How far the mean is from it: √(dᵀ C⁻¹ d), in standard deviations; 0 if the mean is that of a body. What does not vary counts as
    /// varying by 1e-6 of its size.
    #[getset(get_copy = "pub")]
    moved: f64,
    joint: Option<(MassPropertiesLaw, EstimateDistance)>,
    log_cholesky: Option<(LogCholeskyTen, EstimateDistance)>,
}

impl EstimatedBody {
    /// Finds the laws. The first moves nothing that it need not.
    ///
    /// # Errors
    /// Numbers leave the range of floats, or neither family has a law near to the estimate.
    pub fn new(estimate: &TenEstimate) -> Result<Self, EstimatedBodyError> {
        let (unitless, units) = estimate.unitless();
        let (ten, moved) = match unitless.form().body(unitless.mean()) {
            Some(_) => (*unitless.mean(), 0.0),
            None => {
                let nearest = nearest::nearest(&unitless).ok_or(EstimatedBodyError::Range)?;
                (nearest.ten, nearest.squared_distance.sqrt())
            }
        };
        let body = unitless.form().body(&ten).ok_or(EstimatedBodyError::Range)?;
        let at = unitless.at(ten);
        let mut starts: Vec<_> =
            INSIDE.iter().filter_map(|&share| inside(&at, &body, share)).collect();
        starts.push(body);
        let start = starts[0];
        let log = log_cholesky::matched(&unitless, &starts);
        let exists = log.as_ref().and_then(|law| moments(law, unitless.form()));
        let own = joint::matched(&at, &start, &start);
        let wide = own.as_ref().is_none_or(Joint::is_wide);
        let off = own.as_ref().and_then(|own| own.off(&unitless)).unwrap_or(f64::INFINITY);
        // Where the moments are far from those of any law of the family, those of a law that exists may be nearer, or a narrow law.
        let other = exists.filter(|_| moved > 0.0 || wide || off > POOR).and_then(|moments| {
            let target = at.with(moments.mean(), moments.covariance());
            let start = unitless.form().body(target.mean()).unwrap_or(start);
            joint::matched(&target, &start, &start)
        });
        let mut own: Vec<Joint> = [own, other].into_iter().flatten().collect();
        let apart = if off > ROUGH { apart(&at, &start) } else { None };
        own.extend(apart.and_then(|apart| joint::matched(&at, &start, &apart)));
        let nearest = |laws: Vec<Joint>| {
            let by_off = laws.into_iter().filter_map(|law| Some((law.off(&unitless)?, law)));
            by_off.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, law)| law)
        };
        let mut own = nearest(own);
        if off > POOR {
            // The nearest of all may have no spread, and then no step leads from it.
            let narrow = starts.iter().filter_map(|start| joint::narrow(&unitless, start));
            let both = [own, nearest(narrow.collect())].into_iter().flatten();
            own = nearest(both.filter_map(|law| law.refined(&unitless)).collect());
        }
        let own = own.and_then(|joint| {
            let distance = distance_of(&unitless, &joint.law([1.0, 1.0])?)?;
            Some((joint.law(units)?, distance))
        });
        let is_near = own.as_ref().is_some_and(|own| own.1.total() < DRAWN);
        let si = log.as_ref().and_then(|law| in_units(law, units));
        let drawn = si.as_ref().filter(|_| wide && !is_near);
        let fitted = drawn.and_then(|law| fitted(law, estimate));
        let both = own.into_iter().chain(fitted);
        let joint = both.min_by(|a, b| a.1.total().total_cmp(&b.1.total()));
        let log_cholesky: Option<(LogCholeskyTen, EstimateDistance)> = log.and_then(|law| {
            let distance = distance_of(&unitless, &law)?;
            Some((si?, distance))
        });
        let joint = joint.filter(|law| law.1.total() < FAR);
        let log_cholesky = log_cholesky.filter(|law| law.1.total() < FAR);
        if joint.is_none() && log_cholesky.is_none() {
            return Err(EstimatedBodyError::NoLaw { moved });
        }
        let [mass, length] = units;
        let scales = unitless.form().scales(mass, length);
        let nearest =
            unitless.form().body(&ten.component_mul(&scales)).or_else(|| scaled(&body, units));
        let nearest = nearest.ok_or(EstimatedBodyError::Range)?;
        Ok(Self { nearest, moved, joint, log_cholesky })
    }

    /// The law of mass, mass centre, gyration lengths and axes, and how far its moments are from those of the estimate.
    #[must_use]
    pub fn joint(&self) -> Option<&(MassPropertiesLaw, EstimateDistance)> {
        self.joint.as_ref()
    }

    /// The Gaussian in log-Cholesky coordinates, and how far its moments are from those of the estimate; none of plates and rods,
    /// which have no such coordinates.
    #[must_use]
    pub fn log_cholesky(&self) -> Option<&(LogCholeskyTen, EstimateDistance)> {
        self.log_cholesky.as_ref()
    }
}

gyradius_dispersion::written!(
    EstimatedBody,
    |body| {
        nearest: MassProperties = body.nearest,
        moved: f64 = body.moved,
        joint: Option<(MassPropertiesLaw, EstimateDistance)> = body.joint.clone(),
        log_cholesky: Option<(LogCholeskyTen, EstimateDistance)> = body.log_cholesky.clone(),
    },
    {
        crate::read::belong(moved >= 0.0 && (joint.is_some() || log_cholesky.is_some()), "body")?;
        EstimatedBody { nearest, moved, joint, log_cholesky }
    }
);

fn distance_of(estimate: &TenEstimate, law: &dyn MassPropertiesModel) -> Option<EstimateDistance> {
    EstimateDistance::of(estimate, &moments(law, estimate.form())?)
}

/// The body with second moments, and the mass, that are no smaller than a share of their deviations; none where one is zero and does
/// not vary.
fn inside(estimate: &TenEstimate, body: &MassProperties, share: f64) -> Option<MassProperties> {
    let mass = body.mass_kg().max(share * estimate.deviations()[0]);
    let scatter = scatter(estimate, body)?;
    let mut moments = body.inertia().second_moments().values();
    for (k, moment) in moments.iter_mut().enumerate() {
        *moment = moment.max(share * scatter[(k, k)].max(0.0).sqrt());
    }
    with_moments(body, mass, moments)
}

/// The covariance of the second moments about the principal axes of a body, to first order.
fn scatter(estimate: &TenEstimate, body: &MassProperties) -> Option<Matrix3<f64>> {
    let natural = estimate.to_natural_with_rounding()?;
    let second = second_moments_of_inertia();
    let entries = natural.covariance().fixed_view::<6, 6>(4, 4).into_owned();
    let spread = second * entries * second.transpose();
    let rotation = *body.inertia().principal_axes().attitude().to_rotation_matrix().matrix();
    let forms = [0, 1, 2].map(|k| {
        // nᵀ Σ n as a linear form of the six entries.
        let n = rotation.row(k).transpose();
        let mut form = six(&(n * n.transpose()));
        form.iter_mut().skip(3).for_each(|x| *x *= 2.0);
        form
    });
    Some(Matrix3::from_fn(|i, j| forms[i].dot(&(spread * forms[j]))))
}

/// The body with other second moments about its axes, and another mass.
fn with_moments(body: &MassProperties, mass: f64, moments: [f64; 3]) -> Option<MassProperties> {
    let moments = gyradius_inertia::SecondMoments::new(moments).ok()?;
    let axes = body.inertia().principal_axes().attitude();
    let inertia = Inertia::from_second_moments(moments, &axes).ok()?;
    MassProperties::new(mass, body.mass_centre_m(), inertia).ok()
}

/// The body whose second moments differ by what their difference has as root mean square: rotations across them move products by that, and
/// across nearly equal ones by next to nothing to first order. None if no moments differ by less than twice what their difference scatters by.
fn apart(estimate: &TenEstimate, body: &MassProperties) -> Option<MassProperties> {
    let scatter = scatter(estimate, body)?;
    let own = body.inertia().second_moments().values();
    let mut order = [0, 1, 2];
    order.sort_by(|a, b| own[*a].total_cmp(&own[*b]));
    let gaps = [0, 1].map(|pair| {
        let (m, n) = (order[pair], order[pair + 1]);
        let variance = scatter[(m, m)] + scatter[(n, n)] - 2.0 * scatter[(m, n)];
        [own[n] - own[m], variance.max(0.0).sqrt()]
    });
    if gaps.iter().all(|[gap, deviation]| *gap > 2.0 * deviation) {
        return None;
    }
    let [first, second] = gaps.map(|[gap, deviation]| gap.hypot(deviation) - gap);
    let mut moments = own;
    // About the same mean.
    for (k, by) in
        order.into_iter().zip([-2.0 * first - second, first - second, first + 2.0 * second])
    {
        moments[k] = (own[k] + by / 3.0).max(LEAST_APART * own[k]);
    }
    with_moments(body, body.mass_kg(), moments)
}

/// The joint law fitted to draws of another.
fn fitted(
    law: &LogCholeskyTen,
    estimate: &TenEstimate,
) -> Option<(MassPropertiesLaw, EstimateDistance)> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(0);
    let bodies: Vec<MassProperties> = (0..DRAWS).map(|_| law.sample(&mut rng)).collect();
    let fit = MassPropertiesFit::new(&bodies, MassChoice::default()).ok()?;
    let distance = distance_of(estimate, fit.law())?;
    Some((fit.law().clone(), distance))
}

/// A body in SI whose numbers are in units of a mass and a length.
fn scaled(body: &MassProperties, [mass, length]: [f64; 2]) -> Option<MassProperties> {
    let inertia = Inertia::new(body.inertia().matrix() * (mass * length * length)).ok()?;
    MassProperties::new(body.mass_kg() * mass, body.mass_centre_m() * length, inertia).ok()
}

/// The law of such bodies in SI.
fn in_units(law: &LogCholeskyTen, [mass, length]: [f64; 2]) -> Option<LogCholeskyTen> {
    let factor = |i: usize| if i < 4 { 1.0 } else { length };
    let mut mean = Ten::from(law.mean());
    mean[0] += 0.5 * libm::log(mass);
    for i in 1..10 {
        mean[i] = if i < 4 { mean[i] + libm::log(length) } else { mean[i] * length };
    }
    let covariance = Matrix10::from_fn(|i, j| law.covariance()[(i, j)] * factor(i) * factor(j));
    LogCholeskyTen::new(LogCholesky::new(mean.into()).ok()?, covariance).ok()
}

/// How messages and files call the ten of a form.
impl TenForm {
    /// The names of the ten numbers with their units.
    #[must_use]
    pub fn columns(self) -> [&'static str; 10] {
        let mut names = TenParameters::COLUMNS;
        if self == Self::Linear {
            names[1..4].copy_from_slice(&[
                "first_moment_1_kg_m",
                "first_moment_2_kg_m",
                "first_moment_3_kg_m",
            ]);
        }
        names
    }
}

/// Why an estimate has no law.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EstimatedBodyError {
    /// No body with such numbers can be held in floats.
    #[error("the estimate leaves the range of numbers: no body near to it can be worked with")]
    Range,
    /// Neither family has a law.
    #[error(
        "no law was found with moments like these: the mean is {moved:.3} standard deviations from the nearest body"
    )]
    NoLaw {
        /// The distance of the mean from the nearest body, in standard deviations.
        moved: f64,
    },
}
