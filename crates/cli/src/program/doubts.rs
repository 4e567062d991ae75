//! What there is to doubt in a scenario, told before anything is drawn of it.

use gyradius_study::{AnyScenario, OffNominal};

use crate::program::output::say;

/// Tells it on standard error, with the laws that are far from nominal values, in the words of whoever wrote the file.
pub(crate) fn tell_doubts(
    scenario: &AnyScenario,
    off_nominal: Vec<OffNominal>,
    in_words: impl Fn(&str) -> String,
) {
    let doubts = off_nominal.into_iter().map(|law| law.to_string());
    let doubts = doubts.chain(scenario.folded().into_iter().map(|root| root.to_string()));
    let doubts = doubts.chain(scenario.unmatched().into_iter().map(|law| law.to_string()));
    for doubt in doubts {
        say(&format!("warning: {}", in_words(&doubt)));
    }
}
