//! The tests of the crate from outside, in one program, which is linked once.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod doubts;
mod dressings;
mod edges;
mod encodings;
mod entities;
mod halves;
mod headings;
mod keys;
mod macros;
mod mjcf_geoms;
mod names;
mod not_known;
mod places;
mod prefixes;
mod quotes;
mod robots;
mod row_units;
mod samples;
mod several;
mod slips;
mod ten;
mod titles;
mod units;
mod unread;
