//! Lengths and roots whose laws lie below zero in part: only squares matter, so that this part is folded.

use serde::{Deserialize, Serialize};
use std::fmt;

/// A larger share below zero is told: that of a normal law whose mean is two standard deviations, where its absolute value has
/// a mean that is 0.4 % larger, and a standard deviation that is 3 % smaller.
const MANY: f64 = 0.0228;

/// A radius of gyration or a root of a body whose law is folded at zero, so that it has not the mean and deviation stated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FoldedRoot {
    /// The body.
    pub body: String,
    /// `gyration_length_1` or `root_1`, about principal axis 1, and so on.
    pub quantity: String,
    /// The share of its law that lies below zero.
    pub share: f64,
}

impl FoldedRoot {
    /// Those of a body of this name, from what its roots are called and the shares of their laws below zero.
    pub(crate) fn of(body: &str, quantity: &str, shares: [f64; 3]) -> Vec<Self> {
        let all = (1..).zip(shares).filter(|(_, share)| *share > MANY);
        all.map(|(axis, share)| Self {
            body: body.to_owned(),
            quantity: format!("{quantity}_{axis}"),
            share,
        })
        .collect()
    }
}

impl fmt::Display for FoldedRoot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}: {:.1} % of the law of {} lie below zero. Only its square matters, so that these draws are those of its \
             absolute value, whose mean and standard deviation are not the stated ones",
            self.body,
            100.0 * self.share,
            self.quantity
        )?;
        // No law that stays above zero has the mean 0, which is that of a plate.
        if self.share < 0.5 {
            f.write_str(": a lognormal or truncated normal law stays above zero")?;
        }
        Ok(())
    }
}
