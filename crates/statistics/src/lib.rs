#![doc = include_str!("../README.md")]

mod centred;
mod deviation;
mod edges;
mod error;
mod exact_sum;
mod goodness;
mod groups;
mod histogram;
mod interval;
mod law;
mod mean;
mod moments;
mod proportion;
mod quantile;
mod ratio;
mod selection;
mod survey;
pub mod tail;

pub use deviation::Deviation;
pub use edges::BinEdges;
pub use error::StatisticsError;
pub use exact_sum::ExactSum;
pub use goodness::GoodnessOfFit;
pub use histogram::Histogram;
pub use interval::{Confidence, Interval};
pub use moments::Moments;
pub use proportion::Proportion;
pub use quantile::SortedSample;
pub use survey::{Pass, Survey};
