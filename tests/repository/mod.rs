//! What a program can see of the rules of the repository, held against its files.

mod arrows;
mod circles;
mod equations;
mod errors;
mod facade;
mod files;
mod layout;
mod names;
mod pages;
mod tokens;
