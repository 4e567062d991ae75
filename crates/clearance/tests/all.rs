//! The tests of the crate from outside, in one program, which is linked once.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod brute;
mod clearance;
mod following;
mod forms;
mod pairs;
mod rings;
mod surrounded;
