//! Campaigns of a simulator of the user's own: the scenario, what is drawn and sent, and one run again.

mod body;
mod draws;
#[cfg(unix)]
#[cfg(test)]
mod examples;
mod file;
mod function;
mod looking;
mod read;
mod replay;
mod scenario;
mod summary;
#[cfg(unix)]
#[cfg(test)]
mod tests;

pub(crate) use draws::SimulatorDraws;
pub use replay::SimulatorReplay;
pub use scenario::SimulatorScenario;
pub use summary::SimulatorSummary;
