//! Why a separation could not be followed to its end.

use crate::{LoadId, load::named};

/// Why a separation could not be followed to its end.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// Loads still act at the horizon.
    #[error(
        "{} had not let go after {horizon:?} s: {} {}is {:?} m short of its release length and grows by {:?} m/s",
        named(.loads), .loads[0], unstarted(*.start), three_digits(*.compression), three_digits(*.rate)
    )]
    NotReleased {
        /// The loads.
        loads: Vec<LoadId>,
        /// The horizon, s.
        horizon: f64,
        /// How far the first of them is from its end, m.
        compression: f64,
        /// How fast it grows, m/s.
        rate: f64,
        /// When it would start, s, if that is not before the horizon.
        start: Option<f64>,
    },
    /// The two points of a load have come together, and its force has lost its direction.
    #[error(
        "{load}: its points meet at {time:?} s, closing at {:?} m/s: the line between them is \
         the direction of the force",
        three_digits(*.speed)
    )]
    PadsMeet {
        /// The load.
        load: LoadId,
        /// When, s.
        time: f64,
        /// How fast they come together then, m/s.
        speed: f64,
    },
    /// Steps have become too small to go on.
    #[error("the step at {time:?} s would be {:?} s, too small to go on", three_digits(*.step))]
    StepUnderflow {
        /// When, s.
        time: f64,
        /// The step, s.
        step: f64,
    },
    /// So many steps that the motion must be far faster than the springs are.
    #[error(
        "{steps} steps have led to {time:?} s only, at a relative tolerance of {relative_tolerance:e}: \
         the bodies turn too fast to be followed for so long"
    )]
    TooManySteps {
        /// Steps.
        steps: u32,
        /// When, s.
        time: f64,
        /// The tolerance asked for.
        relative_tolerance: f64,
    },
    /// The coast asked for is none.
    #[error("coast = {value:?} s: it must be zero or positive, and finite")]
    Coast {
        /// The coast, s.
        value: f64,
    },
    /// A number has overflowed.
    #[error("the motion at {time:?} s is beyond the range of numbers")]
    NotFinite {
        /// When, s.
        time: f64,
    },
}

/// That a load has not started yet.
fn unstarted(start: Option<f64>) -> String {
    start.map_or_else(String::new, |start| format!("starts at {start:?} s only, "))
}

/// Rounded to three digits, which a message needs; `{:?}` writes it short whatever its size.
fn three_digits(x: f64) -> f64 {
    // The largest numbers round to infinity.
    format!("{x:.2e}").parse().ok().filter(|rounded: &f64| rounded.is_finite()).unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_of_any_size() {
        let numbers = [9.999999999999998e-2, 0.0, -1.2345e-9, 98765.4, f64::MAX, f64::MIN_POSITIVE];
        let told = numbers.map(|x| format!("{:?}", three_digits(x)));
        assert_eq!(
            told,
            ["0.1", "0.0", "-1.23e-9", "98800.0", "1.7976931348623157e308", "2.23e-308"]
        );
    }
}
