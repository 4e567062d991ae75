//! What of a spring can be uncertain.

use super::Spring;
use crate::Parameter;

/// What of a spring can be uncertain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpringParameter {
    /// Stiffness.
    Stiffness,
    /// Stroke: the initial compression.
    Stroke,
    /// Friction of its guide.
    Friction,
    /// Rotation of its line about the stage point, about two axes across it.
    LineOfAction,
    /// Attachment on the payload.
    PayloadPoint,
    /// Attachment on the stage.
    StagePoint,
    /// When it is let off.
    Start,
}

impl Parameter for SpringParameter {
    type Of = Spring;
    const ALL: &'static [Self] = &[
        Self::Stiffness,
        Self::Stroke,
        Self::Friction,
        Self::LineOfAction,
        Self::PayloadPoint,
        Self::StagePoint,
        Self::Start,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Stiffness => "stiffness",
            Self::Stroke => "stroke",
            Self::Friction => "friction",
            Self::LineOfAction => "line_of_action",
            Self::PayloadPoint => "payload_point",
            Self::StagePoint => "stage_point",
            Self::Start => "start",
        }
    }

    fn unit(self) -> &'static str {
        match self {
            Self::Stiffness => "n_per_m",
            Self::Friction => "n",
            Self::LineOfAction => "deg",
            Self::Stroke | Self::PayloadPoint | Self::StagePoint => "m",
            Self::Start => "s",
        }
    }

    fn nominal(self, spring: &Spring) -> Vec<f64> {
        match self {
            Self::Stiffness => vec![spring.stiffness_n_per_m()],
            Self::Stroke => vec![spring.stroke_m()],
            Self::Friction => vec![spring.friction_n()],
            Self::LineOfAction => vec![0.0; 2],
            Self::PayloadPoint => spring.payload_point_m().as_slice().to_vec(),
            Self::StagePoint => spring.stage_point_m().as_slice().to_vec(),
            Self::Start => vec![spring.start_s().unwrap_or(0.0)],
        }
    }
}
