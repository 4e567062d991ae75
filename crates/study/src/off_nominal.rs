//! Laws whose means are far from the nominal values of the same scenario.

use gyradius_separation::BodyParameter;

use crate::{
    alerts::Alert,
    body::Body,
    scenario::{Scenario, Target, UncertainBody},
};

/// Standard deviations of a mass centre: one that a designer moved on purpose may be farther away.
const DEVIATIONS: f64 = 3.0;
/// A share of the size of a body, which is √(½ tr I ∕ m), the root mean square distance of its matter from the mass centre. A mass
/// centre that is told from another point is usually farther away than that.
const SHARE: f64 = 0.1;

/// Of numbers with their nominal values and the means of their laws, of the inertias that bodies have by their own laws, by the traces of
/// the matrices, and of mass centres.
pub(crate) fn off_nominal<'a>(
    scenario: &Scenario,
    numbers: impl Iterator<Item = (&'a str, f64, f64)>,
) -> Vec<Alert> {
    let numbers =
        numbers.filter_map(|(name, nominal, mean)| Alert::far_from_nominal(name, nominal, mean));
    let axes = scenario.models().iter().find_map(|model| model.law.own_axes());
    let traces = scenario.bodies().into_iter().filter_map(|(which, body)| {
        let mean = trace(body.expected_moments(axes?)?.mean());
        let nominal = trace(body.nominal().as_inertia_matrix().entries());
        Alert::far_from_nominal(
            &format!("trace of the inertia of the {}", which.name()),
            nominal,
            mean,
        )
    });
    let centres =
        scenario.bodies().into_iter().filter_map(|(which, body)| centre(scenario, which, body));
    numbers.chain(traces).chain(centres).collect()
}

fn trace(entries: [f64; 6]) -> f64 {
    entries[..3].iter().sum()
}

/// That the law of the mass centre of a body is far from the nominal mass centre, from which it is told.
fn centre(scenario: &Scenario, which: Body, body: &UncertainBody) -> Option<Alert> {
    // What an uncertain axis adds may be chance, and is no part of the distance.
    let (mut mean_m, mut beyond) = ([0.0; 3], [0.0; 3]);
    for dispersed in scenario.dispersions().all() {
        let Target::Body(of, BodyParameter::MassCentre, axis) = dispersed.target else { continue };
        if of != which {
            continue;
        }
        let (mean, deviation) = (dispersed.law.mean(), dispersed.law.deviation());
        mean_m[axis] = mean;
        if mean.abs() > DEVIATIONS * deviation {
            beyond[axis] = mean;
        }
    }
    let [x, y, z] = beyond;
    let size_m = (0.5 * trace(body.nominal().as_inertia_matrix().entries())
        / body.moving().body().mass_kg())
    .sqrt();
    let is_far = x.hypot(y).hypot(z) > SHARE * size_m;
    is_far.then(|| Alert::CentreOffNominal { body: which.name().to_owned(), mean_m })
}
