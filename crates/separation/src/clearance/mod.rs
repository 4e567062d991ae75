//! How near the bodies come to each other, and whether they touch.

mod arc;
mod circle;
mod coast;
mod convex;
mod motion;
mod outline;
mod part;
mod report;
mod search;
mod trigonometric;

pub use coast::Coast;
pub use motion::{Motion, MotionLimits};
pub use outline::{Outline, OutlineError, Shape};
pub use report::{
    Approach, Clearance, ClearanceError, ClearanceSettings, ClearanceSettingsError, ShapeClearance,
};
