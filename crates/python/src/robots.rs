//! The links of robot files.

use gyradius_dispersion::TenParameters;
use gyradius_formats::{Gap, GapKind, RobotFile, RobotLink};
use pyo3::{PyResult, Python, pyfunction};
use std::path::PathBuf;

use crate::error::refused;

/// Of a link: its name, its ten numbers where it has them, and otherwise why not.
type Link = (String, Option<[f64; 10]>, Option<String>);

/// The links of a robot, in the order of the file: name, and ten numbers or why there are none. And what of the file was not read, in which
/// there may be more.
#[pyfunction]
pub(crate) fn load_robot(py: Python<'_>, path: PathBuf) -> PyResult<(Vec<Link>, Vec<String>)> {
    py.detach(|| {
        let robot = RobotFile::read(&path).map_err(refused)?;
        let of = |link: &RobotLink| match link.numbers() {
            Ok(numbers) => {
                let ten = TenParameters {
                    mass_kg: numbers.mass_kg(),
                    mass_centre_m: numbers.mass_centre_m(),
                    inertia: *numbers.inertia(),
                };
                (link.name().to_owned(), Some(ten.values()), None)
            }
            Err(problem) => (link.name().to_owned(), None, Some(problem.to_string())),
        };
        let without = robot.links_without_inertia().iter();
        let without =
            without.map(|name| (name.clone(), None, Some("no inertia in the file".to_owned())));
        let links = robot.links().iter().map(of).chain(without).collect();
        Ok((links, robot.gaps().iter().filter_map(unread).collect()))
    })
}

/// What is to be said of links that are not among those that were read.
fn unread(gap: &Gap) -> Option<String> {
    match gap.kind() {
        GapKind::Macros => {
            let text = "macros or expressions are not expanded: expand the file first, with `xacro file.xacro -o file.urdf`";
            Some(text.to_owned())
        }
        GapKind::Entities | GapKind::Included => Some(gap.to_string()),
        // Links of which the simulator computes the inertia are among those without.
        GapKind::Computed | GapKind::Misplaced => None,
        // The enum may grow.
        _ => Some(gap.to_string()),
    }
}
