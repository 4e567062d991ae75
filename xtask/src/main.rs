//! `cargo xtask study [flags]`: the program `gyradius`, built optimised and run in this process.

use std::process::ExitCode;

fn main() -> ExitCode {
    gyradius::run(std::env::args_os())
}
