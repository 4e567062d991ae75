//! What is said of all pairs of shapes together, against dense sampling of every pair: contacts of any two,
//! also of mated shapes, are clearance zero at the first of them in time.

use gyradius_clearance::{
    Clearance, ClearanceSettings, Coast, Motion, Outline, OutlineShape, ShapeClearance,
};
use proptest::prelude::*;

use crate::forms::{Form, V, at_rest, body, nearest, vector};

/// Distance of two shapes at an instant: from points of a ring, or from all pieces, to the other shape.
fn apart(forms: [&Form; 2], coast: &mut Coast, time: f64) -> f64 {
    let states = coast.states(time).unwrap();
    // A point of one body in the axes of the other.
    let across = |from: usize, x: V| {
        let (a, b) = (&states[from], &states[1 - from]);
        b.attitude.inverse() * (a.position + a.attitude * x - b.position)
    };
    let ring = (0..2).find(|k| matches!(forms[*k], Form::Ring(..)));
    if let Some(k) = ring {
        let at = |turns: f64| forms[1 - k].off(&across(k, forms[k].on_ring(turns)));
        const COUNT: u32 = 40;
        let places = (0..COUNT).map(|i| f64::from(i) / f64::from(COUNT));
        let mut found: Vec<(f64, f64)> = places.map(|turns| (at(turns), turns)).collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let lowest = |(mut best, mut turns): (f64, f64)| {
            let mut step = 1.0 / f64::from(COUNT);
            while step > 1e-9 {
                step *= 0.5;
                for next in [turns - step, turns + step] {
                    let d = at(next);
                    if d < best {
                        (best, turns) = (d, next);
                    }
                }
            }
            best
        };
        return found[..4].iter().map(|start| lowest(*start)).fold(f64::INFINITY, f64::min);
    }
    let pieces = |k: usize| match forms[k] {
        Form::Points(p) => p.iter().map(|x| vec![*x]).collect(),
        Form::Hull(p) => vec![p.clone()],
        Form::Ring(..) => Vec::<Vec<V>>::new(),
    };
    let mut best = f64::INFINITY;
    for a in pieces(0) {
        for b in pieces(1) {
            let pairs = a.iter().flat_map(|x| b.iter().map(|y| across(0, *x) - y));
            best = best.min(nearest(&pairs.collect::<Vec<_>>()));
        }
    }
    best
}

/// A minimum of a sampled distance, brought down.
fn dip(
    mut at: impl FnMut(f64) -> f64,
    mut time: f64,
    mut width: f64,
    range: [f64; 2],
) -> (f64, f64) {
    let mut best = at(time);
    while width > 1e-10 {
        for next in [time - width, time + width] {
            if (range[0]..=range[1]).contains(&next) {
                let d = at(next);
                if d < best {
                    (best, time) = (d, next);
                }
            }
        }
        width *= 0.6;
    }
    (best, time)
}

/// Rings on each other where the bodies touch, points, rods, plates and other rings.
fn shapes() -> impl Strategy<Value = (Vec<Form>, Vec<Form>)> {
    let other = || {
        prop_oneof![
            3 => prop::collection::vec(vector(1.5), 1..4).prop_map(Form::Points),
            1 => prop::collection::vec(vector(1.0), 2..6).prop_map(Form::Hull),
            1 => (vector(0.5), 0.2..1.0f64).prop_map(|(c, r)| Form::Ring(c, V::z(), r)),
        ]
    };
    let interface = (0.3..1.2f64, prop_oneof![3 => Just(1), 1 => Just(0)]);
    let others = || prop::collection::vec(other(), 0..3);
    (interface, others(), others()).prop_map(|((radius, mated), mut payload, mut stage)| {
        if mated > 0 {
            // In either order, so that contacts come in an order other than that of the shapes.
            payload.push(Form::Ring(V::z() * -1.0, V::z(), radius));
            stage.insert(0, Form::Ring(V::z() * 1.0, V::z(), radius));
        }
        if payload.is_empty() {
            payload.push(Form::Points(vec![V::x()]));
        }
        if stage.is_empty() {
            stage.push(Form::Points(vec![V::y()]));
        }
        (payload, stage)
    })
}

/// What was found reads back to the bit, and a distance that is none is refused.
#[cfg(feature = "serde")]
fn reads_back(clearance: &Clearance) {
    let mut json = serde_json::to_value(clearance).unwrap();
    assert_eq!(serde_json::from_str::<Clearance>(&json.to_string()).unwrap(), *clearance);
    let near = json["shapes"].as_array().unwrap().iter().position(|s| !s["closest"].is_null());
    if let Some(near) = near {
        json["shapes"][near]["closest"]["distance_m"] = (-1.0).into();
        let refused = serde_json::from_value::<Clearance>(json).unwrap_err().to_string();
        assert!(refused.contains("not negative"), "{refused}");
    }
}

const UNTIL: f64 = 30.0;
const SAMPLES: u32 = 150;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn all_pairs_agree_with_dense_sampling(
        (payload, stage) in shapes(),
        speed in 0.01..0.3f64,
        aside in vector(0.02),
        rates in prop::array::uniform2(vector(0.3)),
        approach in prop_oneof![3 => Just(false), 1 => Just(true)],
    ) {
        // The origin of the payload is 2 m above that of the stage: the rings touch. Or it comes from afar.
        let (start, velocity) = if approach {
            (V::new(3.0, 1.0, 2.0), V::new(-0.2, 0.0, -0.1) + aside * 3.0)
        } else {
            (V::z() * 2.0, V::z() * speed + aside)
        };
        let moving = body([2.0, 2.5, 3.0], start, velocity, rates[0]);
        let turning = body([3.0, 2.5, 2.0], V::zeros(), V::zeros(), rates[1]);
        let settings = ClearanceSettings::default();
        let outline = |forms: &[Form]| Outline::new(forms.iter().map(Form::shape).collect::<Vec<OutlineShape>>());
        let (p, s) = (outline(&payload).unwrap(), outline(&stage).unwrap());
        let mut coast = Coast::new(&moving, &turning, 0.0);
        let c = Clearance::new(&p, &s, &mut coast, 0.0, UNTIL, &settings).unwrap();
        prop_assert_eq!(c.undecided_from_s(), None);
        #[cfg(feature = "serde")]
        reads_back(&c);

        // What dense sampling finds: the first contact of all, and the least distance of those apart.
        let (mut first, mut least, mut all_mated) = (f64::INFINITY, f64::INFINITY, true);
        for pair in c.shapes() {
            let forms = [&payload[pair.payload_shape()], &stage[pair.stage_shape()]];
            let mut at = |t: f64| apart(forms, &mut coast, t);
            let mated = at(0.0) <= settings.touch_m();
            all_mated &= mated;
            let time = |i: u32| UNTIL * f64::from(i) / f64::from(SAMPLES);
            let samples: Vec<f64> = (0..=SAMPLES).map(|i| at(time(i))).collect();
            // Mated shapes count from when they have parted by a millimetre.
            let mut from = Some(0);
            if mated {
                from = (0..=SAMPLES).find(|i| samples[*i as usize] > settings.parted_m());
            }
            let Some(from) = from else { continue };
            for i in from..=SAMPLES {
                let d = samples[i as usize];
                let lower = |j: u32| samples.get(j as usize).is_none_or(|other| d <= *other);
                if (i == from || lower(i - 1)) && lower(i + 1) {
                    let range = [time(from), UNTIL];
                    let (d, t) = dip(&mut at, time(i), time(1), range);
                    if d < 0.9 * settings.touch_m() {
                        first = first.min(t);
                    }
                    if !mated {
                        least = least.min(d);
                    }
                }
            }
        }
        match (c.closest(), c.contact_s()) {
            (Some(closest), Some(contact)) => {
                prop_assert_eq!((closest.distance_m(), closest.time_s()), (0.0, contact));
                let times = c.shapes().iter().filter_map(ShapeClearance::contact_s);
                prop_assert_eq!(contact, times.fold(f64::INFINITY, f64::min));
                // No sampled contact is earlier, and the points do meet.
                prop_assert!(contact <= first + 1e-6, "{} {}", contact, first);
                let [a, b] = coast.states(contact).unwrap();
                let gap = a.position + a.attitude * closest.payload_point_m()
                    - b.position - b.attitude * closest.stage_point_m();
                prop_assert!(gap.norm() < 1.01 * settings.touch_m());
            }
            (closest, None) => {
                prop_assert_eq!(first, f64::INFINITY);
                prop_assert_eq!(closest.is_none(), all_mated);
                if let Some(closest) = closest {
                    prop_assert!((closest.distance_m() - least).abs() < 1e-7, "{:?} {}", closest, least);
                }
            }
            (None, Some(_)) => prop_assert!(false, "a contact without an approach"),
        }
    }
}

/// A motion that turns beyond what is followed: a contact before the end of that is found, what cannot
/// matter is decided, and what could is said to be undecided.
#[test]
fn fast_turning_is_followed_as_far_as_it_goes() {
    let settings = ClearanceSettings::default();
    let point = |x: V| Outline::from(OutlineShape::points(&[x]).unwrap());
    let rate = V::z() * 12.0;
    for (speed, until, undecided, touches) in [
        // 600 s at 12 rad/s; 0.5 m/s takes the tip out of reach of the other before long.
        (0.5, 600.0, false, false),
        (5e-3, 600.0, false, false),
        (-1e-3, 2000.0, true, false),
        // The plate is met while the motion is known.
        (-1e-2, 2000.0, false, true),
    ] {
        let moving = body([1.0, 1.0, 1.5], V::z() * 2.0, V::z() * speed, rate);
        let mut coast = Coast::new(&moving, &at_rest(), 0.0);
        let corners = [V::new(-0.5, -0.5, 0.0), V::new(0.5, -0.5, 0.0), V::y() * 0.5];
        let plate = OutlineShape::hull(&corners).unwrap();
        let (arm, plate) = (point(V::x() * 0.2), Outline::from(plate));
        let c = Clearance::new(&arm, &plate, &mut coast, 0.0, until, &settings).unwrap();
        assert_eq!(c.undecided_from_s().is_some(), undecided, "{speed}");
        assert_eq!(c.contact_s().is_some(), touches, "{speed}");
        if let Some(from) = c.undecided_from_s() {
            assert!((500.0..700.0).contains(&from), "{from}");
            let height = 2.0 + speed * from;
            assert!((c.closest().unwrap().distance_m() - height).abs() < 1e-3);
        }
    }
}
