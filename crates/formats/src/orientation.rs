//! Which way the axes of an inertia are turned in those of its link, in the ways of URDF, SDF and MJCF.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::{FileBodyError, LinkProblem, xml::Node};

/// What MJCF may say of an orientation, of which one may be given.
pub(crate) const ATTRIBUTES: [&str; 5] = ["quat", "axisangle", "euler", "xyaxes", "zaxis"];

/// How the angles of an MJCF file are meant.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Angles {
    /// Radians of one unit, or why that is not known.
    pub(crate) unit: Result<f64, LinkProblem>,
    /// Axes of `euler`, in small letters where they turn with the body, or why they are not known.
    pub(crate) sequence: Result<String, LinkProblem>,
}

/// The rotation by an angle about an axis of unit length.
fn about(axis: Vector3<f64>, angle: f64) -> UnitQuaternion<f64> {
    let (sin, cos) = libm::sincos(0.5 * angle);
    let v = axis * sin;
    UnitQuaternion::new_normalize(Quaternion::new(cos, v.x, v.y, v.z))
}

/// Roll, pitch and yaw about fixed axes, rad: R = R₃(yaw) R₂(pitch) R₁(roll).
pub(crate) fn of_roll_pitch_yaw([roll, pitch, yaw]: [f64; 3]) -> UnitQuaternion<f64> {
    about(Vector3::z(), yaw) * about(Vector3::y(), pitch) * about(Vector3::x(), roll)
}

/// A quaternion, scalar first, of any length but zero.
pub(crate) fn of_quaternion(wxyz: [f64; 4]) -> Option<UnitQuaternion<f64>> {
    let [w, x, y, z] = wxyz;
    let size = wxyz.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
    (size > 0.0).then(|| {
        UnitQuaternion::new_normalize(Quaternion::new(w / size, x / size, y / size, z / size))
    })
}

/// The orientation that an MJCF element says, none being that of its parent.
pub(crate) fn of_mjcf(
    node: Node<'_, '_>,
    angles: &Angles,
) -> Result<UnitQuaternion<f64>, LinkProblem> {
    let mut given = ATTRIBUTES.into_iter().filter(|name| node.attribute(name).is_some());
    let Some(name) = given.next() else { return Ok(UnitQuaternion::identity()) };
    if let Some(second) = given.next() {
        return Err(FileBodyError::Both { first: name, second }.into());
    }
    let list = |allowed| -> Result<Vec<f64>, LinkProblem> {
        let numbers = node.numbers(name, allowed).unwrap_or(Ok(Vec::new()))?;
        Ok(numbers.iter().map(|number| number.value).collect())
    };
    let unit = || angles.unit.clone();
    let axis = |x: &[f64]| direction(Vector3::from_column_slice(x));
    let turned = match name {
        "quat" => list(4)?.try_into().ok().and_then(of_quaternion),
        "axisangle" => {
            let numbers = list(4)?;
            let unit = unit()?;
            axis(&numbers[..3]).map(|axis| about(axis, numbers[3] * unit))
        }
        "euler" => of_euler(&list(3)?, unit()?, angles.sequence.as_ref().map_err(Clone::clone)?),
        "xyaxes" => {
            let numbers = list(6)?;
            axis(&numbers[..3]).and_then(|x| {
                let y = Vector3::from_column_slice(&numbers[3..]);
                let y = axis((y - x * x.dot(&y)).as_slice())?;
                let columns = nalgebra::Matrix3::from_columns(&[x, y, x.cross(&y)]);
                let rotation = nalgebra::Rotation3::from_matrix_unchecked(columns);
                Some(UnitQuaternion::from_rotation_matrix(&rotation))
            })
        }
        _ => from_third_axis(Vector3::from_column_slice(&list(3)?)),
    };
    turned.ok_or(LinkProblem::Orientation { field: name })
}

/// The shortest rotation that takes the third axis to the direction of a vector; none of no length.
pub(crate) fn from_third_axis(along: Vector3<f64>) -> Option<UnitQuaternion<f64>> {
    let z = direction(along)?;
    let across = Vector3::z().cross(&z);
    let sine = across.norm();
    let about_axis = if sine > 0.0 { across / sine } else { Vector3::x() };
    Some(about(about_axis, libm::atan2(sine, z.z)))
}

fn direction(v: Vector3<f64>) -> Option<Vector3<f64>> {
    let size = v.amax();
    (size > 0.0).then(|| (v / size).normalize())
}

fn of_euler(three: &[f64], unit: f64, sequence: &str) -> Option<UnitQuaternion<f64>> {
    let mut whole = UnitQuaternion::identity();
    if sequence.chars().count() != 3 {
        return None;
    }
    for (axis, angle) in sequence.chars().zip(three) {
        let direction = match axis.to_ascii_lowercase() {
            'x' => Vector3::x(),
            'y' => Vector3::y(),
            'z' => Vector3::z(),
            _ => return None,
        };
        let turn = about(direction, angle * unit);
        whole = if axis.is_ascii_lowercase() { whole * turn } else { turn * whole };
    }
    Some(whole)
}
