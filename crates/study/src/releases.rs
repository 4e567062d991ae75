//! How springs let go in the runs of a model, and what comes of it: found in surveys.

use gyradius_campaign::{Share, Surveys};
use gyradius_statistics::{Confidence, StatisticsError, Survey};

use crate::{
    column::{RECOMPRESSED, RELEASE_ORDER},
    quantity::Quantity,
    summary::{ClearanceSummary, Order, Releases},
};

/// Orders of releases that are listed.
const ORDERS: usize = 12;

impl Releases {
    /// Of surveys of the runs of a model, whose outlines are watched or not.
    pub(crate) fn new(
        surveys: &Surveys,
        watched: bool,
        confidence: Confidence,
    ) -> Result<Self, StatisticsError> {
        let mut counts = surveys.texts(RELEASE_ORDER);
        let independent = surveys.independent();
        let orders_of = |surveys: &Surveys| total(&surveys.texts(RELEASE_ORDER));
        let (of, of_independent) = (orders_of(surveys), orders_of(independent));
        let share = |count: u64, of_those: u64| {
            Share::of_dependent(count, of, (of_those, of_independent), confidence)
        };
        let of_some = |count: &dyn Fn(&Surveys) -> u64| {
            (of > 0).then(|| share(count(surveys), count(independent))).transpose()
        };
        let recompressed = of_some(&|surveys| total(&surveys.texts(RECOMPRESSED)))?;
        let touching = |surveys: &Surveys| {
            surveys.column(&Quantity::RecontactTime.column()).map_or(0, Survey::n)
        };
        let recontact = if watched { of_some(&touching)? } else { None };
        let clearance = if watched { ClearanceSummary::new(surveys, confidence) } else { None };
        // Equal counts in the order of their names.
        counts.sort_by_key(|(order, count)| (std::cmp::Reverse(*count), *order));
        let first = independent.texts(RELEASE_ORDER);
        let orders = counts.into_iter().take(ORDERS).map(|(order, count)| {
            let of_those = first.iter().find(|(other, _)| *other == order).map_or(0, |(_, n)| *n);
            Ok(Order { order: order.to_owned(), share: share(count, of_those)? })
        });
        Ok(Self {
            orders: orders.collect::<Result<_, StatisticsError>>()?,
            recompressed,
            recontact,
            clearance,
        })
    }
}

/// How many texts there are of all kinds.
fn total(kinds: &[(&str, u64)]) -> u64 {
    kinds.iter().map(|(_, count)| count).sum()
}
