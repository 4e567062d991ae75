//! Numbers in messages.

use std::fmt;

/// A number for people: four decimals, or three digits and a power of ten where decimals would hide it or
/// say too much.
pub(crate) struct Short(pub(crate) f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        if size == 0.0 {
            write!(f, "0")
        } else if (0.01..1e7).contains(&size) {
            write!(f, "{:.4}", self.0)
        } else {
            write!(f, "{:.2e}", self.0)
        }
    }
}
