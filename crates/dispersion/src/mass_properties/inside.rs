//! A region that holds the matter of every draw of a law, by rejection.

use gyradius_inertia::{Containment, MassProperties, Region};

use super::{ten_parameters::TenParameters, ten_sums::TenSums};

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
    /// Of the draws that were.
    sums: Box<TenSums>,
}

impl Inside {
    /// Of a law that gives these draws, which may be kept to no region yet.
    pub(super) fn new(
        before: Option<&Self>,
        region: Region,
        mut draw: impl FnMut() -> MassProperties,
    ) -> Result<Self, RegionAcceptanceError> {
        if before.is_some() {
            return Err(RegionAcceptanceError::Second);
        }
        let trials = if region.is_exact() { EXACT_TRIALS } else { REGION_TRIALS };
        let mut held = None;
        let mut possible = 0;
        for _ in 0..trials {
            let body = draw();
            if is_held(&region, &body) {
                possible += 1;
                held.get_or_insert_with(|| about(&body)).add(TenParameters::from(body).values());
            }
        }
        if f64::from(possible) < LEAST_SHARE * f64::from(trials) {
            return Err(RegionAcceptanceError::Rare { possible, trials });
        }
        let sums = held.ok_or(RegionAcceptanceError::Rare { possible, trials })?;
        Ok(Self { region, possible, trials, sums: Box::new(sums) })
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
        is_held(&self.region, body)
    }

    /// Sums over the trial draws that were possible.
    pub(super) fn sums(&self) -> &TenSums {
        &self.sums
    }

    /// The estimated share of draws that are possible, and its standard error.
    pub(super) fn acceptance(&self) -> (f64, f64) {
        let n = f64::from(self.trials);
        let p = f64::from(self.possible) / n;
        (p, (p * (1.0 - p) / n).sqrt())
    }
}

/// Whether matter in a region was shown to have these mass properties.
#[inline]
fn is_held(region: &Region, body: &MassProperties) -> bool {
    region.containment(body) == Containment::Possible
}

/// Sums about a draw.
fn about(body: &MassProperties) -> TenSums {
    let trace = body.inertia().matrix().trace();
    let length = (trace / body.mass_kg()).sqrt().max(body.mass_centre_m().amax());
    let scale = std::array::from_fn(|i| match i {
        0 => body.mass_kg(),
        1..=3 => length,
        _ => trace,
    });
    TenSums::about(TenParameters::from(*body).values(), scale)
}

/// Why draws are not kept to a region.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RegionAcceptanceError {
    /// Next to no trial draw is possible in the region.
    #[error(
        "region: {possible} of {trials} trial draws were bodies that fit into it, and at least one in a thousand must be: each draw \
         is tried again until it fits, which would take too long"
    )]
    Rare {
        /// How many were.
        possible: u32,
        /// Of how many.
        trials: u32,
    },
    /// The draws are kept to another region already.
    #[error("region: the draws are kept to another one already, and only one is allowed")]
    Second,
}
