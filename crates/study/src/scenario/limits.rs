//! How much a scenario may ask for: enough for every vehicle, and little enough to come to an end.

use super::{
    ScenarioError,
    file::{ScenarioFile, ShapeFile},
};

/// Bytes of the largest file that is read: a hundred thousand samples of roots.
pub(super) const BYTES: u64 = 16 << 20;

/// Most runs of a model: what fits into memory.
pub(super) const RUNS: u64 = 10_000_000;

/// Most springs: each is a release in every run and a column of the run table.
const SPRINGS: usize = 300;

/// Most models.
const MODELS: usize = 100;

/// Longest distance of a part of an outline from the nominal mass centre, m: the farther it is, the
/// shorter are the steps in which its motion can be followed.
const REACH: f64 = 1e4;

/// Longest coast, s.
pub(super) const COAST: f64 = 1e6;

/// That a scenario does not ask for more.
pub(super) fn check(file: &ScenarioFile) -> Result<(), ScenarioError> {
    at_most("springs", file.springs.len(), SPRINGS)?;
    at_most("models", file.models.len(), MODELS)?;
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

fn at_most(field: &str, count: usize, most: usize) -> Result<(), ScenarioError> {
    if count <= most {
        return Ok(());
    }
    Err(ScenarioError::field(field, format!("{count} of them: at most {most} are allowed")))
}

/// The key of a shape and how far out it is, m.
fn reach(shape: &ShapeFile) -> (&'static str, f64) {
    // Not the norm, which overflows.
    let largest = |p: &[f64; 3]| p.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    match shape {
        ShapeFile::PointsM(p) => ("points_m", p.iter().map(largest).fold(0.0, f64::max)),
        ShapeFile::HullM(p) => ("hull_m", p.iter().map(largest).fold(0.0, f64::max)),
        ShapeFile::Ring { centre_m, radius_m, .. } => ("ring", largest(centre_m) + radius_m.abs()),
    }
}
