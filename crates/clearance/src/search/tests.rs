//! Searches that are given up, against those that are not.

use super::*;
use crate::{Coast, FreeBody, RigidState};
use nalgebra::{Matrix3, UnitQuaternion};
use proptest::prelude::*;

type V = Vector3<f64>;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    /// A search that is given up says so, and what it has then is a distance that there is and a bound that holds; one that is not
    /// finds no less.
    #[test]
    fn a_search_that_is_given_up_says_so(
        most_nodes in 1..400_usize,
        turn in prop::array::uniform3(-1.0..1.0f64),
        rates in prop::array::uniform2(prop::array::uniform3(-2.0..2.0f64)),
        place in prop::array::uniform3(-1.0..1.0f64),
        aside in 0.0..1.5f64,
    ) {
        let [payload, stage] = [(place, rates[0]), ([0.0; 3], rates[1])].map(|(place, rate)| {
            let state = RigidState {
                position: V::from(place),
                velocity: V::from(place) * 0.3,
                attitude: UnitQuaternion::from_scaled_axis(V::from(turn)),
                angular_velocity: V::from(rate),
            };
            FreeBody::new(state, Matrix3::identity()).unwrap()
        });
        let corners = [[0, 0], [0, 1], [1, 0], [1, 1]].map(|xy| xy.map(f64::from));
        let hull: Vec<V> = corners.iter().flat_map(|[x, y]| [0.0, 1.0].map(|z| V::new(aside + x, *y, z))).collect();
        let shapes = [OutlineShape::hull(&hull).unwrap(), OutlineShape::ring(V::zeros(), V::z(), 0.7).unwrap()];
        let settings = ClearanceSettings::default();
        let search = |most: usize| {
            let mut coast = Coast::new(&payload, &stage, 0.0);
            let mut search = Search::new(&mut coast, &shapes[0], &shapes[1], &settings);
            search.most_nodes = most;
            let first = search.begin(0.0, 3.0).unwrap();
            let found = search.finish(first).unwrap();
            let touches = found.seen.distance <= search.touch();
            let contact = touches.then(|| search.first_contact(0.0, found.seen).unwrap().time);
            (found, contact, search.is_stopped())
        };
        let (all, first, is_stopped) = search(MOST_NODES);
        prop_assert!(!is_stopped);
        let (found, contact, is_stopped) = search(most_nodes);
        if !is_stopped {
            prop_assert_eq!((all.seen.distance, first), (found.seen.distance, contact));
        }
        prop_assert!(found.at_least <= all.seen.distance && found.seen.distance >= all.at_least);
        if let (Some(contact), Some(first)) = (contact, first) {
            prop_assert!(contact >= first, "{contact} {first}");
        }
        prop_assert!(is_stopped || contact.is_some() == first.is_some());
    }
}
