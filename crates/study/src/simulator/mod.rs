//! Campaigns of a simulator of the user's own: the scenario, what is drawn and sent, and one run again.

mod body;
mod draws;
mod file;
mod replay;
mod scenario;
mod summary;
#[cfg(all(test, unix))]
mod tests;

pub(crate) use draws::SimulatorDraws;
pub use replay::SimulatorReplay;
pub use scenario::SimulatorScenario;
pub use summary::SimulatorSummary;
