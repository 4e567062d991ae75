//! A span in two parts, with shapes that touch when the first begins: the contacts of the whole.

use gyradius_clearance::{Clearance, ClearanceSettings};
use nalgebra::Vector3;

use crate::clearance::{Thrown, cuboid, points, ring};

type V = Vector3<f64>;

/// Thrown up from where they touch, by less than a millimetre and by more, and cut in two anywhere: before they have parted and
/// after.
#[test]
fn shapes_that_have_not_parted_are_mated_in_the_next_span() {
    let settings = ClearanceSettings::default();
    let unit = || ring(V::zeros(), V::z(), 0.6);
    let corners = || points(&[V::x(), V::y(), -V::x()]);
    let deck = cuboid([1.0; 3]).about(V::z()).unwrap();
    let pairs = [
        (unit(), unit()),
        (corners(), corners()),
        (cuboid([1.0; 3]).about(-V::z()).unwrap(), deck),
    ];
    let (mut cut_before, mut cut_after, mut never) = (0, 0, 0);
    for (payload, stage) in &pairs {
        for peak in [2e-5_f64, 2e-4, 9e-4, 1.1e-3, 0.02, 0.3] {
            let speed = 0.02;
            let mut up = Thrown { speed, deceleration: speed * speed / (2.0 * peak) };
            let back = 4.0 * peak / speed;
            let end = 1.2 * back;
            let whole = Clearance::new(payload, stage, &mut up, 0.0, end, &settings).unwrap();
            assert_eq!(whole.contact_s().is_some(), peak > 1e-3, "{peak}");
            for share in [0.0, 0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.97] {
                let cut = share * back;
                let before = Clearance::new(payload, stage, &mut up, 0.0, cut, &settings).unwrap();
                let outlines = (payload, stage);
                let after = Clearance::following(
                    &before,
                    outlines.0,
                    outlines.1,
                    &mut up,
                    [cut, end],
                    &settings,
                )
                .unwrap();
                let ([whole_pair], [pair]) = (whole.shapes(), after.shapes()) else { panic!() };
                let near = |a: Option<f64>, b: Option<f64>| match (a, b) {
                    (Some(a), Some(b)) => (a - b).abs() < 1e-3 * back,
                    (a, b) => a == b,
                };
                assert!(near(after.contact_s(), whole.contact_s()), "{peak} {share} {after:?}");
                if before.shapes()[0].counts_from_s().is_none() {
                    assert!(pair.is_mated());
                    assert!(
                        near(pair.counts_from_s(), whole_pair.counts_from_s()),
                        "{peak} {share}"
                    );
                    cut_before += 1;
                } else {
                    assert!(!pair.is_mated());
                    cut_after += 1;
                }
                // Told nothing of the span before, the same shapes count from its end on, and touch.
                let height = speed * cut - 0.5 * up.deceleration * cut * cut;
                if peak < 1e-3 && height > 2e-6 {
                    let alone =
                        Clearance::new(payload, stage, &mut up, cut, end, &settings).unwrap();
                    assert!(
                        alone.contact_s().is_some() && after.closest().is_none(),
                        "{peak} {share} {alone:?} {after:?}"
                    );
                    never += 1;
                }
            }
        }
    }
    assert!(cut_before > 20 && cut_after > 20 && never > 20, "{cut_before} {cut_after} {never}");
}
