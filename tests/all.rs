//! The tests of the whole system, in one program, which is linked once.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod browser;
mod conservation;
mod dispersions;
mod documents;
mod failures;
mod paper;
mod python_vectors;
mod read_back;
mod replay;
mod repository;
mod reproducibility;
mod reproduction;
mod statements;
