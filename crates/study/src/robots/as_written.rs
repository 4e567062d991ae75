//! Bodies as files of robots have them: what numbers rounded to a few digits mean, and draws that other programs take.

use gyradius_formats::{TOLERANCE, judge};
use gyradius_inertia::{Inertia, InertiaMatrix, MassProperties, Repair, RepairMethod};
use nalgebra::Matrix3;

/// How far inside of what a body can have the inertia of a drawn link lies, as a part of its trace.
const INSET: f64 = 1e-9;

/// What was drawn of a body, moved a little inside of what a body can have, by 1e-9 of the trace of its inertia, as the robots that are
/// written have it: programs that compare without tolerance, or read fewer digits, take flat plates and thin rods too then.
#[must_use]
pub fn inset(drawn: MassProperties) -> MassProperties {
    let moved = off_boundary(drawn.inertia()).and_then(|inertia| {
        MassProperties::new(drawn.mass_kg(), drawn.mass_centre_m(), inertia).ok()
    });
    moved.unwrap_or(drawn)
}

/// The inertia that a file means by these numbers: themselves, or the nearest that a body can have where rounding to six digits has
/// made them impossible, as it does with flat plates and thin rods. None where more than rounding has.
#[must_use]
pub fn as_written(numbers: &InertiaMatrix) -> Option<Inertia> {
    Inertia::try_from(*numbers).ok().or_else(|| {
        let within = judge(numbers.matrix(), None, TOLERANCE).report().is_realizable();
        let near = within.then(|| Repair::new(numbers, RepairMethod::Nearest).ok())?;
        near.map(|near| *near.inertia())
    })
}

/// The inertia moved inside by as much as it lies nearer to the boundary than [`INSET`]; nothing if it need not move.
fn off_boundary(inertia: &Inertia) -> Option<Inertia> {
    let trace = inertia.matrix().trace();
    let least = inertia.principal_axes().second_moments().into_iter().fold(f64::INFINITY, f64::min);
    let short = INSET * trace - least;
    if !(short > 0.0) {
        return None;
    }
    // Each second moment grows by half of what the moments do.
    Inertia::new(inertia.matrix() + Matrix3::from_diagonal_element(2.0 * short)).ok()
}
