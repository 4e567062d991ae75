//! `gyradius`: uncertain rigid-body inertia from the command line.

use std::process::ExitCode;

fn main() -> ExitCode {
    gyradius::run(std::env::args_os())
}
