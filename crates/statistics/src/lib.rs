#![doc = include_str!("../README.md")]

mod acceptance;
#[cfg(test)]
mod binomial_sums;
mod centred;
mod confidence_sequence;
mod deviation;
mod edges;
mod error;
mod exact_sum;
mod fixed_width;
mod goodness;
mod groups;
mod histogram;
mod interval;
mod law;
mod mean;
mod mixture;
mod moments;
mod proportion;
mod quantile;
mod ratio;
mod selection;
mod sequential;
mod survey;
pub mod tail;
mod tolerance;
mod verdict;

pub use acceptance::Acceptance;
pub use confidence_sequence::ConfidenceSequence;
pub use deviation::Deviation;
pub use edges::BinEdges;
pub use error::StatisticsError;
pub use exact_sum::ExactSum;
pub use fixed_width::FixedWidth;
pub use goodness::GoodnessOfFit;
pub use histogram::Histogram;
pub use interval::{Confidence, Interval};
pub use moments::Moments;
pub use proportion::Proportion;
pub use quantile::SortedSample;
pub use sequential::SequentialAcceptance;
pub use survey::{Pass, Survey};
pub use tolerance::{Tolerance, ToleranceSide};
pub use verdict::Verdict;
