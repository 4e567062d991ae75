//! Roots and gyration lengths of bodies beside the nominal ones, axis by axis.

use gyradius_dispersion::{RootLaw, RootMoments};
use gyradius_inertia::PrincipalAxes;

use crate::scenario::UncertainBody;

/// Standard deviations: what is nearer to the nominal value may be it, as zero may be the root of a plate.
const DEVIATIONS: f64 = 3.0;
/// A share of the sum of the second moments: what an inertia that is written with six digits has beside it.
const ROUNDING: f64 = 1e-6;

/// The root or gyration length of a body about an axis: what it is called, its nominal value, and the mean of its law, if that is
/// another.
pub(crate) type OfAxis = (String, f64, f64);

/// Those of a body of this name whose laws are not about the nominal values.
pub(crate) fn off_nominal_roots(name: &str, body: &UncertainBody) -> Vec<OfAxis> {
    let Some((roots, [called, unit])) = body.roots() else { return Vec::new() };
    let one = if unit == "m" { body.moving().body().mass_kg().sqrt() } else { 1.0 };
    let laws = means(roots);
    let nominal = body.nominal().second_moments().roots().values();
    let nominal = if body.given_law().is_some() {
        paired(nominal, laws.map(|[mean, _]| mean))
    } else {
        nominal
    };
    let least = ROUNDING * nominal.iter().map(|root| root * root).sum::<f64>();
    let all = (1..).zip(nominal).zip(laws);
    let is_other = |(_, nominal): &(u8, f64), [mean, deviation]: &[f64; 2]| {
        (mean - nominal).abs() > DEVIATIONS * deviation
            && (mean * mean - nominal * nominal).abs() > least
    };
    all.filter(|(axis, law)| is_other(axis, law))
        .map(|((axis, nominal), [mean, _])| {
            (format!("{name}_{called}_{axis}_{unit}"), nominal / one, mean / one)
        })
        .collect()
}

/// Mean and deviation of each root; of roots that have no laws of their own the root mean square.
fn means(roots: &RootLaw) -> [[f64; 2]; 3] {
    match roots {
        RootLaw::Independent(roots) => {
            roots.laws().each_ref().map(|law| [law.mean(), law.deviation()])
        }
        RootLaw::CorrelatedGaussian(_) | RootLaw::Empirical(_) => {
            let squares = roots.second_moment_statistics();
            [0, 1, 2].map(|i| {
                let root = squares.mean()[i].sqrt();
                let deviation = squares.covariance()[(i, i)].sqrt();
                [root, if root > 0.0 { 0.5 * deviation / root } else { 0.0 }]
            })
        }
    }
}

/// Nominal values in the order of the axes of a law of its own, which may name them otherwise: the order in which they are nearest to the
/// means. The difference over the sum does not grow with a value that is far away anyhow, so that one such leaves the others where they belong.
fn paired(nominal: [f64; 3], means: [f64; 3]) -> [f64; 3] {
    let apart = |a: f64, b: f64| if a == b { 0.0 } else { (a - b).abs() / (a + b) };
    let orders = PrincipalAxes::ORDERS.map(|(order, _)| order.map(|i| nominal[i]));
    let off = |order: &[f64; 3]| (0..3).map(|i| apart(order[i], means[i])).sum::<f64>();
    orders.into_iter().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(nominal)
}
