//! The tests of the crate from outside, in one program, which is linked once.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[cfg(feature = "serde")]
mod read_back;
mod statements;
