//! Which numbers of a link change, and what they become.

use gyradius_inertia::{InertiaMatrix, MassProperties, RELATIVE_TOLERANCE};
use nalgebra::{Matrix3, UnitQuaternion};

use crate::{
    LinkProblem,
    body::{ENTRIES, NAMES, Place, Reading},
    edit::Edit,
    frame::{Diagonal, Frame, InertiaSpot, Spot},
};

/// What must change for a link to have these mass properties in its own frame; `before` is its inertia there.
pub(crate) fn edits(
    reading: &Reading,
    frame: &Frame,
    before: &Matrix3<f64>,
    after: &MassProperties,
) -> Result<Vec<Edit>, LinkProblem> {
    let mut edits = Vec::new();
    if reading.mass_kg != Some(after.mass_kg()) {
        let spot = reading.mass_place.map(|place| Spot::Numbers(vec![place]));
        write(&mut edits, spot.as_ref().unwrap_or(&frame.mass_spot), &[after.mass_kg()], "mass")?;
    }
    let centre: [f64; 3] = frame.written_centre(after.mass_centre_m()).into();
    if frame.centre != after.mass_centre_m() {
        write(&mut edits, &frame.centre_spot, &centre, "mass centre")?;
    }
    if before == after.inertia().matrix() {
        return Ok(opened(edits, &frame.closed));
    }
    let inertia = after
        .inertia()
        .as_inertia_matrix()
        .rotated(&frame.rotation.inverse())
        .map_err(|_| LinkProblem::OutOfRange)?;
    match &frame.diagonal {
        Some(diagonal) if !is_diagonal(&inertia) => {
            turned(&mut edits, reading, diagonal, frame, &inertia)?
        }
        Some(_) | None => match &frame.inertia_spot {
            Some(spot) => whole(&mut edits, spot, &inertia),
            None => entries(&mut edits, reading, frame, &inertia)?,
        },
    }
    Ok(opened(edits, &frame.closed))
}

/// An inertia of which nothing is in the file.
fn whole(edits: &mut Vec<Edit>, spot: &InertiaSpot, inertia: &InertiaMatrix) {
    let InertiaSpot { at, prefix, in_attributes } = spot;
    let values = NAMES.iter().zip(inertia.entries());
    let element = if *in_attributes {
        let entries: String = values.map(|(name, x)| format!(" {name}=\"{}\"", text(x))).collect();
        format!("<{prefix}inertia{entries}/>")
    } else {
        let entries: String = values
            .map(|(name, x)| format!("<{prefix}{name}>{}</{prefix}{name}>", text(x)))
            .collect();
        format!("<{prefix}inertia>{entries}</{prefix}inertia>")
    };
    edits.push((Place { start: *at, end: *at }, element));
}

/// The edits with an end tag for every element that has got something in it and ended by `/>`.
fn opened(mut edits: Vec<Edit>, closed: &[(usize, String)]) -> Vec<Edit> {
    for (at, end) in closed {
        if edits.iter().any(|(place, _)| place.start == *at) {
            // Of the same place, what comes first in the list comes first in the copy.
            edits.insert(0, (Place { start: *at, end: *at }, ">".to_owned()));
            edits.push((Place { start: *at, end: at + 2 }, end.clone()));
        }
    }
    edits
}

/// Whether all products are those of rounding.
fn is_diagonal(inertia: &InertiaMatrix) -> bool {
    let m = inertia.matrix();
    let products = m[(0, 1)].abs().max(m[(0, 2)].abs()).max(m[(1, 2)].abs());
    products <= 0.25 * RELATIVE_TOLERANCE * m.amax()
}

/// The shortest text that reads back to the bit.
fn text(number: f64) -> String {
    format!("{number:?}")
}

fn texts(numbers: &[f64]) -> String {
    numbers.iter().map(|number| text(*number)).collect::<Vec<_>>().join(" ")
}

fn write(
    edits: &mut Vec<Edit>,
    spot: &Spot,
    numbers: &[f64],
    field: &'static str,
) -> Result<(), LinkProblem> {
    match spot {
        Spot::Numbers(places) => {
            edits.extend(places.iter().zip(numbers).map(|(place, x)| (*place, text(*x))));
        }
        Spot::Missing { at, before, after } => {
            let place = Place { start: *at, end: *at };
            edits.push((place, format!("{before}{}{after}", texts(numbers))));
        }
        Spot::Nowhere => return Err(LinkProblem::NoPlace { field }),
    }
    Ok(())
}

/// The entries that differ, in their places.
fn entries(
    edits: &mut Vec<Edit>,
    reading: &Reading,
    frame: &Frame,
    inertia: &InertiaMatrix,
) -> Result<(), LinkProblem> {
    // What turning the axes there and back has rounded is no change.
    let is_turned = frame.rotation != UnitQuaternion::identity();
    let rounding =
        if is_turned { 0.25 * RELATIVE_TOLERANCE * inertia.matrix().amax() } else { 0.0 };
    for (e, (i, j)) in ENTRIES.into_iter().enumerate() {
        let value = inertia.matrix()[(i, j)];
        let same = (value - reading.matrix[(i, j)]).abs() <= rounding;
        if same || (frame.diagonal.is_some() && i != j) {
            continue;
        }
        let spot = reading.places[i][j].map(|place| Spot::Numbers(vec![place]));
        let spot = spot.as_ref().or_else(|| frame.entry_spots.get(e)).unwrap_or(&Spot::Nowhere);
        write(edits, spot, &[value], "inertia")?;
    }
    Ok(())
}

/// MJCF's principal moments about other axes: moments and quaternion where the file says an orientation, and otherwise
/// the six entries in place of the three moments.
fn turned(
    edits: &mut Vec<Edit>,
    reading: &Reading,
    diagonal: &Diagonal,
    frame: &Frame,
    inertia: &InertiaMatrix,
) -> Result<(), LinkProblem> {
    let Some(orientation) = diagonal.orientation else {
        edits.push((diagonal.moments, format!("fullinertia=\"{}\"", texts(&inertia.entries()))));
        return Ok(());
    };
    let axes = inertia.principal_axes();
    let places: Option<Vec<Place>> = (0..3).map(|i| reading.places[i][i]).collect();
    let spot = places.map_or(Spot::Nowhere, Spot::Numbers);
    write(edits, &spot, &axes.moments(), "inertia")?;
    let rotation = frame.written_axes(frame.rotation * axes.attitude().inverse());
    let quaternion = [rotation.w, rotation.i, rotation.j, rotation.k];
    match &diagonal.quaternion {
        Some(places) => write(edits, &Spot::Numbers(places.clone()), &quaternion, "quat"),
        None => {
            edits.push((orientation, format!("quat=\"{}\"", texts(&quaternion))));
            Ok(())
        }
    }
}
