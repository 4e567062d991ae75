//! Inertias in URDF, MJCF, SDF, CSV, TOML and JSON files: read, judged, repaired.
//!
//! [`InertiaFile::read`] gives every body of a file with its line and its inertia as a matrix about
//! the mass centre, products as tensor entries (I₁₂ = −∫ x₁x₂ dm) whatever the file's convention.
//! [`InertiaFile::gaps`] says what of the file was not read.
//! [`judge`] says whether any body can have it, and by how much not. [`InertiaFile::repaired`]
//! gives a copy of the file in which only the offending numbers differ.
//!
//! ```
//! use gyradius_formats::{InertiaFile, Products, Remedy, judge};
//! use std::path::Path;
//!
//! let urdf = r#"<robot name="cart"><link name="wheel"><inertial>
//!   <mass value="1"/> <!-- from CAD -->
//!   <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.3"/>
//! </inertial></link></robot>"#;
//! let file = InertiaFile::parse(Path::new("cart.urdf"), urdf.into(), Products::TensorEntries)?;
//!
//! let wheel = &file.bodies()[0];
//! let judgement = judge(wheel.inertia()?, wheel.mass_kg(), gyradius_formats::TOLERANCE);
//! assert!((judgement.report().excess_percent().unwrap() - 50.0).abs() < 1e-9);
//!
//! let copy = String::from_utf8(file.repaired(&[(0, Remedy::Nearest)])?)?;
//! assert!(copy.contains("<!-- from CAD -->") && copy.contains("iyz=\"0\""));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod body;
mod compiler;
mod copy;
mod csv;
mod data;
mod data_bodies;
mod data_item;
mod data_keys;
mod edit;
mod encoding;
mod entities;
mod error;
mod file;
mod frame;
mod gap;
mod geometry;
mod heading_sign;
mod holder;
mod judge;
mod kind;
mod located;
mod mesh_file;
mod mjcf_geoms;
mod new_file;
mod orientation;
mod parts;
mod plain;
mod product_heading;
mod products_comment;
mod products_implied;
mod products_said;
mod products_words;
mod references;
mod repair;
mod robot;
mod robot_error;
mod robots;
mod rows;
mod same_robot;
mod sdf_words;
mod spread;
mod table_header;
mod table_terms;
mod ten_heading;
mod ten_moments;
mod ten_table;
mod text;
mod title_factors;
mod title_point;
mod title_units;
mod title_words;
mod unit_words;
mod units;
mod walk;
mod without;
mod xml;

/// What a [`BodyJudgement`] says of an inertia.
pub use gyradius_inertia::{Fault, RELATIVE_TOLERANCE, RealizabilityReport};

pub use body::{FileBody, Products};
pub use compiler::CompilerDoubt;
pub use edit::is_same_but_numbers;
pub use error::{Bearing, FileBodyError, FileError, FileProblem};
pub use file::InertiaFile;
pub use gap::{Gap, GapKind};
pub use geometry::GeometryProblem;
pub use judge::{BodyJudgement, MassFault, Note, judge};
pub use kind::Format;
pub use located::included_file;
pub use mesh_file::MeshFileError;
pub use new_file::{NewFile, WriteError};
pub use parts::{PartNumbers, PartRow, PartsError, PartsFile, PartsProblem, PartsTable};
pub use plain::{is_same_file, must_write, read_text, write_file, write_file_as};
pub use repair::{Change, Remedy, RepairError, copy_path, is_copy, write_copy, write_copy_of};
pub use robot::{LinkNumbers, RobotFile, RobotLink};
pub use robot_error::{LinkProblem, RobotError};
pub use same_robot::is_same_robot;
pub use ten_heading::TenCentre;
pub use ten_moments::{TenMomentsError, TenMomentsFile};
pub use ten_table::{TenRow, TenTable, TenTableError};
pub use units::{UnitError, UnitProblem};
pub use walk::{Found, find};
pub use without::WithoutInertia;

/// Tolerance that suits files: they carry about six digits, and a plate or a rod written with six
/// digits lies on the boundary to within that, but for one rod in 36 and fewer plates, which lie up to 2.3e-6 beyond.
pub const TOLERANCE: f64 = 1e-6;

/// Bytes of the largest file that is read.
pub const MAX_BYTES: usize = 64 << 20;

/// Bytes of the largest TOML file that is read: its parser takes up to eighty times as much memory.
pub const MAX_TOML_BYTES: usize = 8 << 20;

/// Levels of the deepest nesting that is read.
pub const MAX_DEPTH: usize = 256;

/// Most bodies of one file that are read.
pub const MAX_BODIES: usize = 1_000_000;

/// Most attributes of one XML element that are read.
pub const MAX_ATTRIBUTES: usize = 256;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
