//! A region that holds the matter of every draw of a law, by rejection.

use gyradius_inertia::{Containment, MassProperties, Region};

/// Trial draws that tell how many are possible in an ellipsoid, and in other regions.
const EXACT_TRIALS: u32 = 20_000;
const REGION_TRIALS: u32 = 4_000;
/// A smaller share of them, and a draw costs more than a thousand.
const LEAST_SHARE: f64 = 1e-3;

/// A region, and how many trial draws of a law were possible in it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Inside {
    region: Region,
    possible: u32,
    trials: u32,
}

impl Inside {
    /// Of a law that gives these draws.
    pub(super) fn new(
        region: Region,
        mut draw: impl FnMut() -> MassProperties,
    ) -> Result<Self, RegionAcceptanceError> {
        let trials = if region.is_exact() { EXACT_TRIALS } else { REGION_TRIALS };
        let mut inside = Self { region, possible: 0, trials };
        for _ in 0..trials {
            inside.possible += u32::from(inside.holds(&draw()));
        }
        let possible = inside.possible;
        if f64::from(possible) < LEAST_SHARE * f64::from(trials) {
            return Err(RegionAcceptanceError { possible, trials });
        }
        Ok(inside)
    }

    pub(super) fn region(&self) -> &Region {
        &self.region
    }

    pub(super) fn into_region(self) -> Region {
        self.region
    }

    /// Whether matter in the region was shown to have these mass properties.
    #[inline]
    pub(super) fn holds(&self, body: &MassProperties) -> bool {
        self.region.containment(body) == Containment::Possible
    }

    /// The estimated share of draws that are possible, and its standard error.
    pub(super) fn acceptance(&self) -> (f64, f64) {
        let n = f64::from(self.trials);
        let p = f64::from(self.possible) / n;
        (p, (p * (1.0 - p) / n).sqrt())
    }
}

/// Next to no trial draw is possible in the region.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "region: {possible} of {trials} trial draws were possible in it; at least one in a thousand must be, or a draw costs \
     more than a thousand"
)]
pub struct RegionAcceptanceError {
    /// How many were.
    pub possible: u32,
    /// Of how many.
    pub trials: u32,
}
