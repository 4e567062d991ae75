//! How much a scenario may ask for: enough for every vehicle, and little enough to come to an end.

use gyradius_separation::{AnyLoad, BodyParameter, Parameter};

use std::ops::RangeInclusive;

use super::{
    ScenarioError,
    file::{ScenarioFile, ShapeFile},
    load,
};

/// Bytes of the largest file that is read: a hundred thousand samples of roots.
pub(super) const BYTES: u64 = 16 << 20;

/// Most loads of a kind: each is a release in every run and a column of the run table.
const LOADS: usize = 300;

/// Most models.
const MODELS: usize = 100;

/// Longest distance of a part of an outline from the nominal mass centre, m: the farther it is, the
/// shorter are the steps in which its motion can be followed.
const REACH: f64 = 1e4;

/// Longest coast, s.
pub(super) const COAST: f64 = 1e6;

/// Base runs by which it is found what drives the outcome: fewer tell nothing.
const BASE_RUNS: RangeInclusive<u64> = 100..=10_000_000;

/// That so many base runs can be done.
pub(crate) fn base_runs(given: Option<u64>) -> Result<(), ScenarioError> {
    match given.filter(|runs| !BASE_RUNS.contains(runs)) {
        None => Ok(()),
        Some(runs) => {
            let (least, most) = BASE_RUNS.into_inner();
            let problem = format!("{runs} base runs: there must be {least} to {most}");
            Err(ScenarioError::field("drivers", problem))
        }
    }
}

/// That a scenario does not ask for more.
pub(super) fn check(file: &ScenarioFile) -> Result<(), ScenarioError> {
    for kind in AnyLoad::KINDS {
        let count = file.loads().filter(|(load, _)| load.kind == *kind).count();
        at_most(kind.plural(), count, LOADS)?;
    }
    at_most("models", file.models.len(), MODELS)?;
    for (name, body) in [("payload", &file.payload), ("stage", &file.stage)] {
        let numbers: [(BodyParameter, &[f64]); 4] = [
            (BodyParameter::Mass, &[body.mass_kg]),
            (BodyParameter::Position, &body.position_m),
            (BodyParameter::Velocity, &body.velocity_m_per_s),
            (BodyParameter::AngularVelocity, &body.angular_velocity_rad_per_s),
        ];
        for (parameter, values) in numbers {
            within(name, parameter, values)?;
        }
    }
    for (load, given) in file.loads() {
        for (key, values, most) in given.sizes() {
            size(&load::key(load), &key, &values, most)?;
        }
    }
    if let Some(clearance) = &file.clearance {
        for (body, shapes) in [("payload", &clearance.payload), ("stage", &clearance.stage)] {
            for (i, shape) in shapes.iter().enumerate() {
                let (key, reach) = reach(shape);
                // Numbers that are not finite are refused with the shape itself.
                if reach.is_finite() && reach > REACH {
                    let problem = format!(
                        "{reach:?} m from the mass centre: it must be at most {REACH:?} m, for \
                         motion farther out cannot be followed in a reasonable time"
                    );
                    let field = format!("clearance.{body}[{}].{key}", i + 1);
                    return Err(ScenarioError::field(field, problem));
                }
            }
        }
    }
    Ok(())
}

/// That what a file states of a body is not beyond its limit, if it has one.
fn within(body: &str, parameter: BodyParameter, values: &[f64]) -> Result<(), ScenarioError> {
    let most = parameter.given().most();
    most.map_or(Ok(()), |most| size(body, &parameter.key(), values, most))
}

/// That the mass of a body, which need not be one that separates, is not beyond its limit.
pub(crate) fn largest_mass(body: &str, mass_kg: f64) -> Result<(), ScenarioError> {
    within(body, BodyParameter::Mass, &[mass_kg])
}

/// That numbers are not beyond their limit. What is no number is refused where it is used.
fn size(place: &str, key: &str, values: &[f64], most: f64) -> Result<(), ScenarioError> {
    if let Some(i) = values.iter().position(|x| x.abs() > most) {
        let index = if values.len() > 1 { format!("[{}]", i + 1) } else { String::new() };
        let problem = format!("{:?}: it must be at most {most:e} in magnitude", values[i]);
        return Err(ScenarioError::field(format!("{place}.{key}{index}"), problem));
    }
    Ok(())
}

fn at_most(field: &str, count: usize, most: usize) -> Result<(), ScenarioError> {
    if count <= most {
        return Ok(());
    }
    Err(ScenarioError::field(field, format!("{count} of them: at most {most} are allowed")))
}

/// How far out a shape is, m, and the key that says most of it.
fn reach(shape: &ShapeFile) -> (String, f64) {
    // Not the norm, which overflows.
    let largest = |p: &[f64; 3]| p.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let of_all = |key: &str, points: &[[f64; 3]]| {
        let points = (1..).zip(points).map(|(i, p)| (i, largest(p)));
        let (i, reach) = points.fold((1, 0.0), |far, p| if p.1 > far.1 { p } else { far });
        (format!("{key}[{i}]"), reach)
    };
    match shape {
        ShapeFile::PointsM(p) => of_all("points_m", p),
        ShapeFile::HullM(p) => of_all("hull_m", p),
        ShapeFile::Ring { centre_m, radius_m, .. } => {
            let (centre, radius) = (largest(centre_m), radius_m.abs());
            let key = if centre > radius { "ring.centre_m" } else { "ring.radius_m" };
            (key.to_owned(), centre + radius)
        }
    }
}
