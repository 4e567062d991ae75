//! The tests of the crate from outside, in one program, which is linked once.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod accuracy;
mod closed_forms;
mod common;
mod imperfect_springs;
mod outcome;
mod reference;
mod spin_measures;
mod torque_free;
