//! The tests of the crate from outside, in one program, which is linked once.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod another_campaign;
mod blocks;
mod bounds;
mod campaign;
#[cfg(unix)]
mod external;
mod formats;
mod infinite;
mod judged_tables;
mod kept;
mod no_runs;
mod requirement;
mod row_at;
mod row_order;
mod scratch;
mod several_models;
mod tables_of_others;
mod together;
