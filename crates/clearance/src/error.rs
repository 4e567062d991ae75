//! Why there is no clearance to tell.

/// Why there is no clearance to report.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ClearanceError {
    /// The span is none.
    #[error(
        "clearance from {from:?} s to {to:?} s: both must be finite, and the end not before the start"
    )]
    Span {
        /// Start, s.
        from: f64,
        /// End, s.
        to: f64,
    },
    /// The motion is not known, or not finite.
    #[error("clearance at {time} s: where the bodies are then is not known or not finite")]
    Motion {
        /// When, s.
        time: f64,
    },
    /// Bounds on speeds are negative or not finite.
    #[error("clearance from {time} s on: the speeds of the bodies have no finite bound")]
    Limits {
        /// From when on, s.
        time: f64,
    },
}
