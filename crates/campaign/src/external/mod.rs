//! A simulator of the user's own, a command in any language or a function, as a simulation.

mod answer;
#[cfg(unix)]
mod child;
#[cfg(not(unix))]
#[path = "elsewhere.rs"]
mod child;
mod function;
mod inputs;
mod named_file;
mod patience;
mod processes;
mod program;
mod simulation;
mod simulator;
mod tail;
mod trouble;

pub use function::{Outputs, SimulatorFunction};
pub use inputs::RunInputs;
pub use processes::Unasked;
pub use program::{Program, ProgramError};
pub use simulation::{ExternalSimulation, Inputs, Told};
pub use simulator::Simulator;

/// Most bytes of an answer: 1 MiB.
const LIMIT: usize = 1 << 20;
