//! Masses that hardly can be as uncertain as they are stated.

use super::*;

/// A mass that scatters by more than itself is most often a slip.
#[test]
fn masses_that_scatter_by_more_than_themselves_are_told() {
    for (deviation, is_told) in [(0.0, false), (10.0, false), (10.1, true), (99.0, true)] {
        let mut deviations = [0.0; 10];
        deviations[0] = deviation;
        let statement = PartStatement {
            mass_kg: 10.0,
            mass_centre_m: [0.0; 3],
            inertia: InertiaMatrix::from_entries([1.0; 3], [0.0; 3]).unwrap(),
            deviations,
            attitude: UnitQuaternion::identity(),
            inertia_follows_mass: false,
        };
        let part = AssemblyPart::new(statement).unwrap();
        let told = part.findings().iter().any(|f| matches!(f, PartFinding::Mass { .. }));
        assert_eq!(told, is_told, "{:?}", part.findings());
    }
}
