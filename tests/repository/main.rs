//! What a program can see of the rules of the repository, held against its files.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod arrows;
mod circles;
mod equations;
mod facade;
mod files;
mod layout;
mod pages;
mod tokens;
