//! The links of robot files.

use gyradius_dispersion::TenParameters;
use gyradius_formats::{RobotFile, RobotLink};
use pyo3::{PyResult, Python, pyfunction};
use std::path::PathBuf;

use crate::error::refused;

/// Of a link: its name, its ten numbers where it has them, and otherwise why not.
type Link = (String, Option<[f64; 10]>, Option<String>);

/// The links of a robot, in the order of the file: name, and ten numbers or why there are none.
#[pyfunction]
pub(crate) fn load_robot(py: Python<'_>, path: PathBuf) -> PyResult<Vec<Link>> {
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
        Ok(robot.links().iter().map(of).chain(without).collect())
    })
}
