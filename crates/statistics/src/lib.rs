#![doc = include_str!("../README.md")]

mod deviation;
mod edges;
mod error;
mod goodness;
mod histogram;
mod interval;
mod law;
mod mean;
mod moments;
mod proportion;
mod quantile;
mod ratio;
pub mod tail;

pub use deviation::Deviation;
pub use edges::BinEdges;
pub use error::StatisticsError;
pub use goodness::GoodnessOfFit;
pub use histogram::Histogram;
pub use interval::{Confidence, Interval};
pub use moments::Moments;
pub use proportion::Proportion;
pub use quantile::SortedSample;
