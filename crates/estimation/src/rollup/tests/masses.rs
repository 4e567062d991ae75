//! Masses that hardly can be as uncertain as they are stated.

use super::*;

/// A mass that scatters by more than itself is most often a slip.
#[test]
fn masses_that_scatter_by_more_than_themselves_are_told() {
    for (deviation, is_told) in [(0.0, false), (10.0, false), (10.1, true), (99.0, true)] {
        let (mut ten, mut deviations) = ([0.0; 10], [0.0; 10]);
        ten[4..7].fill(1.0);
        (ten[0], deviations[0]) = (10.0, deviation);
        let part = AssemblyPart::new(statement(ten, deviations)).unwrap();
        let told = part.findings().iter().any(|f| matches!(f, PartFinding::Mass { .. }));
        assert_eq!(told, is_told, "{:?}", part.findings());
    }
}
