//! The Gaussian in ten log-Cholesky coordinates with the moments of an estimate, or as nearly these as a search finds.

use gyradius_dispersion::{LogCholeskyTen, MassPropertiesModel};
use gyradius_inertia::{LogCholesky, MassProperties};
use nalgebra::DVector;

use super::distance::{Gaps, moments, residuals};
use super::ten_estimate::{Matrix10, Ten, TenEstimate, TenForm};
use crate::rollup::symmetric::with_eigenvalues;
use crate::statements::levenberg_marquardt::{Effort, Problem, Range, least_squares};

/// The largest deviation of ½ ln m and of the logarithms on the diagonal: a mass whose deviation is seven times its mean. Wider laws have
/// their moments from draws that nobody ever sees.
const MOST: f64 = 1.0;
/// The coordinates that are logarithms come first.
const LOGARITHMS: usize = 4;
/// Bounds of the coordinates, in units in which the ten are about one.
const MOST_LOGARITHM: f64 = 50.0;
const MOST_LENGTH: f64 = 1e6;
/// Deviations of a law that can be begun with anywhere, of logarithms and in lengths of the body.
const MODEST: f64 = 0.2;
/// Steps at most, and halvings of a step.
const STEPS: usize = 200;
const HALVINGS: usize = 8;
/// Fourths of fourths of a variance: the last is 4e-12.
const NARROWER: usize = 20;
/// Where nothing is left to gain, and from where on a law counts as the one sought.
const NOTHING: f64 = 1e-11;
const NEAR: f64 = 1e-8;

/// The law in the units of an estimate of numbers about one, from bodies inside the realizable set on, of which the first is the farthest
/// inside.
pub(super) fn matched(estimate: &TenEstimate, starts: &[MassProperties]) -> Option<LogCholeskyTen> {
    let means: Vec<Ten> = starts
        .iter()
        .filter_map(|body| LogCholesky::of(body).ok())
        .map(|coordinates| Ten::from(coordinates.values()))
        .collect();
    let first = means.first()?;
    let linear = linear(estimate, first);
    // As the derivatives say, and narrower where that is wide, as of a lognormal law the variance of the logarithm.
    let narrower =
        linear.map(|linear| with_eigenvalues(&linear, |x| 0.25 * libm::log1p(4.0 * x.max(0.0))));
    let mut best: Option<Found> = None;
    for covariance in [linear, narrower, Some(modest(first))].into_iter().flatten() {
        let Some(found) = newton(estimate, *first, allowed(&covariance)) else { continue };
        if best.as_ref().is_none_or(|best| found.off < best.off) {
            best = Some(found);
        }
        if best.as_ref().is_some_and(|best| best.off < NEAR) {
            return best.map(|found| found.law);
        }
    }
    // No law has the moments. Two valleys: laws about as wide as the estimate, whose means their width moves, and laws that keep the mean
    // and are narrower.
    let narrow =
        narrow(estimate, &means).and_then(|law| newton(estimate, law.mean, law.covariance));
    let nearest = best.into_iter().chain(narrow).map(|found| searched(estimate, found));
    nearest.min_by(|a, b| a.0.total_cmp(&b.0)).map(|nearest| nearest.1)
}

/// The nearest law downhill from one, and how far it is off.
fn searched(estimate: &TenEstimate, found: Found) -> (f64, LogCholeskyTen) {
    let own = (found.off, found.law);
    let Some(point) = factor_of(&found.covariance).map(|factor| Point { mean: found.mean, factor })
    else {
        return own;
    };
    let (point, cost) = least_squares(&Search { estimate }, point, Effort::FINE);
    match point.law() {
        Some(law) if cost.sqrt() < own.0 => (cost.sqrt(), law),
        _ => own,
    }
}

/// The covariance of the coordinates as the derivatives at their mean say.
fn linear(estimate: &TenEstimate, mean: &Ten) -> Option<Matrix10> {
    let inverse = derivative(estimate.form(), mean)?.try_inverse()?;
    let covariance = inverse * estimate.covariance() * inverse.transpose();
    Some((covariance + covariance.transpose()) * 0.5)
}

/// A covariance that a law can have anywhere.
fn modest(mean: &Ten) -> Matrix10 {
    let length = mean.rows(1, 3).map(libm::exp).max();
    let modest = Ten::from_fn(|i, _| MODEST * if i < LOGARITHMS { 1.0 } else { length });
    Matrix10::from_diagonal(&modest.component_mul(&modest))
}

/// Of ever narrower laws about bodies the one nearest to the estimate.
fn narrow(estimate: &TenEstimate, means: &[Ten]) -> Option<Found> {
    let about = |mean: &Ten| {
        let wide = [linear(estimate, mean), Some(modest(mean))];
        let mean = *mean;
        wide.into_iter().flatten().flat_map(move |wide| {
            narrower().filter_map(move |share| Found::new(estimate, mean, allowed(&wide) * share))
        })
    };
    means.iter().flat_map(about).min_by(|a, b| a.off.total_cmp(&b.off))
}

/// Shares of a variance, down to nothing worth mentioning.
pub(super) fn narrower() -> impl Iterator<Item = f64> {
    (0..NARROWER).scan(1.0, |share, _| Some(std::mem::replace(share, *share * 0.25)))
}

/// A law and how far it is off.
struct Found {
    law: LogCholeskyTen,
    mean: Ten,
    covariance: Matrix10,
    gaps: Gaps,
    off: f64,
}

impl Found {
    fn new(estimate: &TenEstimate, mean: Ten, covariance: Matrix10) -> Option<Self> {
        let law = LogCholeskyTen::new(LogCholesky::new(mean.into()).ok()?, covariance).ok()?;
        let gaps = Gaps::of(estimate, &moments(&law, estimate.form())?);
        let off = gaps.off();
        off.is_finite().then_some(Self { law, mean, covariance, gaps, off })
    }
}

/// Newton's steps with the derivative of the linearised map, each halved until the law is nearer.
fn newton(estimate: &TenEstimate, mean: Ten, covariance: Matrix10) -> Option<Found> {
    let mut found = Found::new(estimate, mean, covariance)?;
    for _ in 0..STEPS {
        if found.off < NOTHING {
            break;
        }
        let inverse = derivative(estimate.form(), &found.mean)?.try_inverse()?;
        let shift = inverse * found.gaps.mean;
        let wider = inverse * found.gaps.covariance * inverse.transpose();
        let wider = (wider + wider.transpose()) * 0.5;
        let mut step = 1.0;
        let next = (0..HALVINGS).find_map(|_| {
            let covariance = allowed(&(found.covariance + wider * step));
            let next = Found::new(estimate, found.mean + shift * step, covariance);
            step *= 0.5;
            next.filter(|next| next.off < found.off * (1.0 - 1e-4))
        });
        let Some(next) = next else { break };
        found = next;
    }
    Some(found)
}

/// The nearest matrix without negative eigenvalues, in correlations, and without logarithms that scatter too widely.
fn allowed(covariance: &Matrix10) -> Matrix10 {
    let deviations = covariance.diagonal().map(|v| v.max(0.0).sqrt());
    let scale = |i: usize| if deviations[i] > 0.0 { deviations[i] } else { 1.0 };
    let correlation = Matrix10::from_fn(|i, j| covariance[(i, j)] / scale(i) / scale(j));
    let clipped = with_eigenvalues(&correlation, |x| x.max(0.0));
    let kept = |i: usize| {
        let own = deviations[i] * clipped[(i, i)].max(0.0).sqrt();
        if i < LOGARITHMS && own > MOST { MOST / own } else { 1.0 }
    };
    Matrix10::from_fn(|i, j| {
        let still = deviations[i] == 0.0 || deviations[j] == 0.0;
        if still { 0.0 } else { clipped[(i, j)] * scale(i) * scale(j) * kept(i) * kept(j) }
    })
}

/// The derivatives of the ten by the coordinates.
fn derivative(form: TenForm, coordinates: &Ten) -> Option<Matrix10> {
    const STEP: f64 = 1e-5;
    let mut derivative = Matrix10::zeros();
    for i in 0..10 {
        let step = STEP * if i < LOGARITHMS { 1.0 } else { coordinates.amax().clamp(1e-3, 1.0) };
        let at = |by: f64| {
            let mut there = *coordinates;
            there[i] += by;
            ten(form, &there)
        };
        derivative.set_column(i, &((at(step)? - at(-step)?) / (2.0 * step)));
    }
    Some(derivative)
}

fn ten(form: TenForm, coordinates: &Ten) -> Option<Ten> {
    let body = LogCholesky::new((*coordinates).into()).ok()?.mass_properties().ok()?;
    Some(form.of(body.into()))
}

/// Least squares over the ten means and the 55 entries of the factor of the covariance.
struct Search<'a> {
    estimate: &'a TenEstimate,
}

#[derive(Clone)]
struct Point {
    mean: Ten,
    factor: Matrix10,
}

impl Point {
    fn law(&self) -> Option<LogCholeskyTen> {
        let covariance = self.factor * self.factor.transpose();
        LogCholeskyTen::new(LogCholesky::new(self.mean.into()).ok()?, covariance).ok()
    }

    fn deviation(&self, coordinate: usize) -> f64 {
        self.factor.row(coordinate).norm()
    }
}

/// The lower triangular factor of a covariance, of a hair more where it has none.
fn factor_of(covariance: &Matrix10) -> Option<Matrix10> {
    let deviations = covariance.diagonal().map(|v| v.max(0.0).sqrt().max(1e-9));
    let correlation = Matrix10::from_fn(|i, j| {
        let own = covariance[(i, j)] / deviations[i] / deviations[j];
        if i == j { 1.0 + 1e-9 } else { own * (1.0 - 1e-9) }
    });
    let factor = correlation.cholesky()?.l();
    Some(Matrix10::from_fn(|i, j| factor[(i, j)] * deviations[i]))
}

/// Row and column of an entry of the factor among the unknowns, which follow the ten means.
fn place(unknown: usize) -> (usize, usize) {
    let mut rest = unknown - 10;
    let mut row = 0;
    while rest > row {
        row += 1;
        rest -= row;
    }
    (row, rest)
}

impl Problem for Search<'_> {
    type Point = Point;

    fn values(&self, point: &Point) -> DVector<f64> {
        DVector::from_fn(65, |i, _| if i < 10 { point.mean[i] } else { point.factor[place(i)] })
    }

    fn at(&self, values: DVector<f64>, _: &Point) -> Point {
        let mean = Ten::from_fn(|i, _| values[i]);
        let mut factor = Matrix10::zeros();
        for i in 10..65 {
            factor[place(i)] = values[i];
        }
        for i in 0..LOGARITHMS {
            let own = factor.row(i).norm();
            if own > MOST {
                factor.row_mut(i).scale_mut(MOST / own);
            }
        }
        Point { mean, factor }
    }

    fn residuals(&self, point: &Point) -> DVector<f64> {
        let law = point.law();
        residuals(self.estimate, law.as_ref().map(|law| law as &dyn MassPropertiesModel))
    }

    fn range(&self, point: &Point, unknown: usize) -> Range {
        let coordinate = if unknown < 10 { unknown } else { place(unknown).0 };
        let most = match (unknown < 10, coordinate < LOGARITHMS) {
            (true, true) => MOST_LOGARITHM,
            (false, true) => MOST,
            (_, false) => MOST_LENGTH,
        };
        Range { least: -most, most, unit: point.deviation(coordinate).max(1e-6) }
    }
}
