//! `gyradius`: uncertain rigid-body inertia from the command line.

use std::process::ExitCode;

fn main() -> ExitCode {
    gyradius_cli::run(std::env::args_os())
}
