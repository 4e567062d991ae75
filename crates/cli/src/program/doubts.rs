//! What there is to doubt in a scenario, told before anything is drawn of it.

use gyradius_study::AnyScenario;

use crate::program::output::say;

/// Tells it on standard error, in the words of whoever wrote the file.
pub(crate) fn tell_doubts(scenario: &AnyScenario, in_words: impl Fn(&str) -> String) {
    let doubts = scenario.off_nominal().into_iter().map(|law| law.to_string());
    let doubts = doubts.chain(scenario.folded().into_iter().map(|root| root.to_string()));
    let doubts = doubts.chain(scenario.unmatched().into_iter().map(|law| law.to_string()));
    for doubt in doubts {
        say(&format!("warning: {}", in_words(&doubt)));
    }
}
