//! The program as its users meet it, one file for each side of it.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod check;
mod command_line;
#[cfg(unix)]
mod commands_told;
mod compare;
#[cfg(target_os = "linux")]
mod disk;
mod draw;
mod draw_again;
mod draw_laws;
mod draw_links;
mod draw_robots;
mod drivers;
mod fit;
mod fit_joint;
mod fit_robots;
mod fleet;
mod for_robots;
mod kept;
#[cfg(unix)]
mod killed;
#[cfg(unix)]
mod output;
#[cfg(unix)]
mod permissions;
mod rare;
mod readme;
mod report;
mod requirements;
mod rollup;
mod scratch;
#[cfg(unix)]
mod shards;
mod shell;
#[cfg(unix)]
mod simulator;
mod slips;
#[cfg(unix)]
mod slurm;
#[cfg(unix)]
mod tampered;
mod until;
mod verdict;
