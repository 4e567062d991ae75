//! The smallest distance of two rigid bodies in motion, with proof, and their first contact.
//!
#![doc = include_str!("../README.md")]

mod arc;
mod circle;
mod clearance;
mod coast;
mod convex;
mod error;
mod free_body;
mod motion;
mod outline;
mod part;
mod search;
mod settings;
mod state;
mod surrounding;
mod trigonometric;

pub use clearance::{Approach, Clearance, ShapeClearance};
pub use coast::Coast;
pub use error::ClearanceError;
pub use free_body::{FreeBody, FreeBodyError};
pub use motion::{Motion, MotionLimits};
pub use outline::{Outline, OutlineError, OutlineShape};
pub use settings::{ClearanceSettings, ClearanceSettingsError};
pub use state::RigidState;

// Part of the interface, in the version that it takes and gives.
pub use nalgebra;
