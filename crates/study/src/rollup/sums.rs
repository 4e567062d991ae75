//! What draws of a whole come to.

use gyradius_campaign::Table;
use gyradius_dispersion::{TenParameters, TenSpread, TenSums};
use gyradius_estimation::FirstOrder;

/// What draws of the ten come to.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnMoments {
    /// How many there are.
    pub draws: u64,
    /// How many sums left the range of floats.
    pub failed: u64,
    /// How many are no body's: none.
    pub impossible: u64,
    /// Means; none without a draw.
    pub mean: Option<[f64; 10]>,
    /// How they scatter; nothing of fewer than two draws.
    pub spread: Option<TenSpread>,
}

/// Sums over draws, in their order, about the nominal in deviations by first order.
#[derive(Clone, Debug)]
pub(super) struct Sums {
    of: TenSums,
    failed: u64,
    impossible: u64,
}

impl Sums {
    pub(super) fn new(moments: &FirstOrder) -> Self {
        let of = TenSums::about(moments.values(), moments.deviations());
        Self { of, failed: 0, impossible: 0 }
    }

    pub(super) fn add(&mut self, table: &Table) {
        for row in table.rows() {
            let ten = TenParameters::COLUMNS.map(|name| row.number(name));
            if ten.iter().any(Option::is_none) {
                self.failed += 1;
                continue;
            }
            let ten = ten.map(Option::unwrap_or_default);
            let parameters = TenParameters::from_values(ten);
            let possible = parameters.is_ok_and(|ten| ten.is_realizable());
            self.impossible += u64::from(!possible);
            self.of.add(ten);
        }
    }

    pub(super) fn moments(&self) -> DrawnMoments {
        DrawnMoments {
            draws: self.of.count(),
            failed: self.failed,
            impossible: self.impossible,
            mean: self.of.mean(),
            spread: self.of.spread(),
        }
    }
}
