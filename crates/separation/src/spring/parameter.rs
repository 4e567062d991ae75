//! What of a spring can be uncertain.

use super::Spring;
use crate::parameter::parameters;

parameters! {
    /// What of a spring can be uncertain.
    SpringParameter of Spring;
    /// Stiffness.
    Stiffness: "stiffness", "n_per_m", 1, Always(1e12), |spring| [spring.stiffness_n_per_m()];
    /// Stroke: the initial compression.
    Stroke: "stroke", "m", 1, Always(1e3), |spring| [spring.stroke_m()];
    /// Friction of its guide.
    Friction: "friction", "n", 1, OrZero(1e12), |spring| [spring.friction_n()];
    /// Rotation of its line about the stage point, about two axes across it.
    LineOfAction: "line_of_action", "deg", 2, Never, |_| [0.0; 2];
    /// Attachment on the payload.
    PayloadPoint: "payload_point", "m", 3, Always(1e4), |spring| spring.payload_point_m().into();
    /// Attachment on the stage.
    StagePoint: "stage_point", "m", 3, Always(1e4), |spring| spring.stage_point_m().into();
    /// When it is let off.
    Start: "start", "s", 1, OrZero(1e6), |spring| [spring.start_s().unwrap_or(0.0)];
}
