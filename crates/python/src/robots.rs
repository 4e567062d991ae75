//! The links of robot files.

use gyradius_dispersion::TenParameters;
use gyradius_formats::{
    CompilerDoubt, FileProblem, Gap, GapKind, LinkProblem, RobotError, RobotFile, RobotLink,
};
use pyo3::{PyErr, PyResult, Python, pyfunction};
use std::path::{Path, PathBuf};

use crate::error::{refused, unreadable};

/// Of a link: its name, its ten numbers where it has them, otherwise why not, and whether it has some that cannot be read.
type Link = (String, Option<[f64; 10]>, Option<String>, bool);

/// The links of a robot, in the order of the file: name, and ten numbers or why there are none. And what of the file was not read, in which
/// there may be more.
#[pyfunction]
pub(crate) fn load_robot(py: Python<'_>, path: PathBuf) -> PyResult<(Vec<Link>, Vec<String>)> {
    py.detach(|| {
        let robot = RobotFile::read(&path).map_err(|error| told(&path, &error))?;
        let of = |link: &RobotLink| match link.numbers() {
            Ok(numbers) => {
                let ten = TenParameters {
                    mass_kg: numbers.mass_kg(),
                    mass_centre_m: numbers.mass_centre_m(),
                    inertia: *numbers.inertia(),
                };
                (link.name().to_owned(), Some(ten.values()), None, false)
            }
            // A second element of a link is read by nobody.
            Err(problem) => {
                (link.name().to_owned(), None, Some(problem.to_string()), !problem.is_beside())
            }
        };
        // Its link is not left out because of it.
        let is_for_gazebo =
            |link: &&RobotLink| link.numbers().is_err_and(|why| *why == LinkProblem::Gazebo);
        let for_gazebo = robot.links().iter().filter(is_for_gazebo);
        let for_gazebo = for_gazebo.map(|link| format!("{}: {}", link.name(), LinkProblem::Gazebo));
        let without = robot.links_without_inertia().iter();
        let why = |name: &str| Some(robot.why_without(name).to_string());
        let without = without.map(|name| (name.clone(), None, why(name), false));
        let links = robot.links().iter().filter(|link| !is_for_gazebo(link));
        let links = links.map(of).chain(without).collect();
        let overridden = robot.overridden_by().map(|told| {
            format!("its compiler says {told}: MuJoCo takes other numbers than those of its links")
        });
        // Files that are not read are told below.
        let doubts =
            robot.compiler_doubts().iter().filter(|doubt| **doubt != CompilerDoubt::Included);
        let doubts = doubts.map(ToString::to_string);
        let unread = robot.gaps().iter().filter_map(unread);
        Ok((links, overridden.into_iter().chain(doubts).chain(unread).chain(for_gazebo).collect()))
    })
}

/// Why a robot has no links: an `OSError` if the system does not hand out its file, otherwise a refusal.
fn told(path: &Path, error: &RobotError) -> PyErr {
    if let RobotError::File(file) = error
        && let FileProblem::Io(problem) = file.problem()
    {
        return unreadable(path, problem);
    }
    refused(error)
}

/// What is to be said of links that are not among those that were read.
fn unread(gap: &Gap) -> Option<String> {
    match gap.kind() {
        GapKind::Macros => {
            let text = "macros or expressions are not expanded: expand the file first, with `xacro file.xacro -o file.urdf`";
            Some(text.to_owned())
        }
        GapKind::Entities | GapKind::Included | GapKind::Misplaced => Some(gap.to_string()),
        // Links of which the simulator computes the inertia are among those without.
        GapKind::Computed => None,
        // The enum may grow.
        _ => Some(gap.to_string()),
    }
}
