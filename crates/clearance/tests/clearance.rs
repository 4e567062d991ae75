//! Clearance against closed forms and against dense sampling.

use gyradius_clearance::{
    Approach, Clearance, ClearanceError, ClearanceSettings, Coast, FreeBody, Motion, MotionLimits,
    Outline, OutlineShape, RigidState,
};
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use proptest::prelude::*;

type V = Vector3<f64>;

fn body(moments: [f64; 3], position: V, velocity: V, angular_velocity: V) -> FreeBody {
    let state = RigidState { position, velocity, angular_velocity, ..RigidState::default() };
    FreeBody::new(state, Matrix3::from_diagonal(&moments.into())).unwrap()
}

fn ball(position: V, velocity: V, angular_velocity: V) -> FreeBody {
    body([1.0; 3], position, velocity, angular_velocity)
}

fn at_rest() -> FreeBody {
    ball(V::zeros(), V::zeros(), V::zeros())
}

pub(crate) fn cuboid(half: [f64; 3]) -> Outline {
    let corners: Vec<V> = (0..8_u32)
        .map(|i| V::from_fn(|k, _| if i >> k & 1 == 0 { -half[k] } else { half[k] }))
        .collect();
    OutlineShape::hull(&corners).unwrap().into()
}

pub(crate) fn ring(centre: V, axis: V, radius: f64) -> Outline {
    OutlineShape::ring(centre, axis, radius).unwrap().into()
}

pub(crate) fn points(p: &[V]) -> Outline {
    OutlineShape::points(p).unwrap().into()
}

fn coasting(
    payload: &Outline,
    stage: &Outline,
    bodies: [FreeBody; 2],
    horizon: f64,
    settings: &ClearanceSettings,
) -> Clearance {
    let mut coast = Coast::new(&bodies[0], &bodies[1], 0.0);
    Clearance::new(payload, stage, &mut coast, 0.0, horizon, settings).unwrap()
}

fn fine() -> ClearanceSettings {
    ClearanceSettings::new(1e-12, 1e-10, 1e-3).unwrap()
}

fn bisect(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if f(middle) > 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// A tipping cube over a deck: its lowest edge is at z₀ + vt − |cos ωt| − |sin ωt|.
#[test]
fn a_tipping_cube_strikes_the_deck() {
    let deck = cuboid([5.0, 5.0, 0.5]);
    let (rate, gap) = (0.5, 0.2);
    for (speed, strikes) in [(0.1, true), (0.15, true), (0.25, false), (0.45, false)] {
        let payload = ball(V::z() * (1.5 + gap), V::z() * speed, V::y() * rate);
        let clearance = coasting(&cuboid([1.0; 3]), &deck, [payload, at_rest()], 60.0, &fine());
        let height = |t: f64| {
            let a = rate * t;
            1.0 + gap + speed * t - a.cos().abs() - a.sin().abs()
        };
        let closest = clearance.closest().unwrap();
        let turn = std::f64::consts::FRAC_PI_4 / rate;
        if strikes {
            let exact = bisect(height, 0.0, turn);
            assert!((clearance.contact_s().unwrap() - exact).abs() < 1e-8, "{speed}");
            assert_eq!((closest.distance_m(), closest.at_least_m()), (0.0, 0.0));
            assert_eq!(closest.time_s(), clearance.contact_s().unwrap());
            // A corner strikes, not the middle of a face.
            let p = closest.payload_point_m();
            assert!((p.z + 1.0).abs() < 1e-12 && (p.x.abs() - 1.0).abs() < 1e-12);
        } else {
            // Stationary where v = ω (cos ωt − sin ωt).
            let slope = |t: f64| {
                let a = rate * t;
                rate * (a.cos() - a.sin()) - speed
            };
            let exact = bisect(slope, 0.0, turn);
            assert_eq!(clearance.contact_s(), None);
            let least = height(exact).min(gap);
            assert!((closest.distance_m() - least).abs() < 1e-11, "{}", closest.distance_m());
            assert!(closest.at_least_m() > least - 1e-11);
        }
    }
}

#[test]
fn passing_points_and_boxes() {
    // Points on a fly-by, 60 s long, whose dip lasts milliseconds.
    let start = V::new(-30.0, 1e-3, 0.0);
    let payload = ball(start, V::x(), V::zeros());
    let c = coasting(
        &points(&[V::zeros()]),
        &points(&[V::zeros()]),
        [payload, at_rest()],
        60.0,
        &ClearanceSettings::default(),
    );
    let closest = c.closest().unwrap();
    assert!((closest.distance_m() - 1e-3).abs() < 1e-9 && (closest.time_s() - 30.0).abs() < 2e-6);
    assert_eq!(c.contact_s(), None);
    assert!(c.looks() < 1000, "{}", c.looks());

    // A box that flies past face to face: the same distance for seconds.
    let payload = ball(V::new(-10.0, 2.5, 0.0), V::x(), V::zeros());
    let c = coasting(&cuboid([1.0; 3]), &cuboid([1.0; 3]), [payload, at_rest()], 20.0, &fine());
    assert!((c.closest().unwrap().distance_m() - 0.5).abs() < 1e-12);

    // Receding: smallest at the start, and cheap.
    let payload = ball(V::z() * 2.3, V::z() * 0.3, V::new(0.01, -0.02, 0.1));
    let c = coasting(
        &cuboid([1.0; 3]),
        &cuboid([1.0; 3]),
        [payload, at_rest()],
        600.0,
        &ClearanceSettings::default(),
    );
    let closest = c.closest().unwrap();
    assert!((closest.distance_m() - 0.3).abs() < 1e-12 && closest.time_s() == 0.0);
    assert!(c.looks() < 40, "{}", c.looks());
}

/// A tip at the end of an arm comes round once a turn: no dip is missed however long the coast.
#[test]
fn a_turning_arm_is_not_missed() {
    let tip = points(&[V::new(2.0, 0.0, 0.0)]);
    let (rate, drift) = (6.0, 0.01);
    // Receding from a post at distance 2.5 ahead: closest when the tip points there.
    let post = points(&[V::zeros()]);
    let payload = ball(V::new(0.0, -2.05, 0.0), V::new(0.0, -drift, 0.0), V::z() * rate);
    let c = coasting(&tip, &post, [payload, at_rest()], 30.0, &fine());
    let d = |t: f64| {
        let a = rate * t;
        (2.0 * a.cos()).hypot(-2.05 - drift * t + 2.0 * a.sin())
    };
    let least = (0..4_000_000).map(|i| d(1e-6 * f64::from(i))).fold(f64::INFINITY, f64::min);
    let closest = c.closest().unwrap();
    assert!((closest.distance_m() - least).abs() < 1e-10, "{} {least}", closest.distance_m());
    assert!(closest.time_s() > 0.2 && closest.time_s() < 0.3);
}

#[test]
fn a_nozzle_leaves_its_ring() {
    let (o, z) = (V::zeros(), V::z());
    // Coaxial: every angle is as near as every other, and the gap is that of the radii.
    for settings in [ClearanceSettings::default(), fine()] {
        let payload = ball(z * -1.0, z * 0.2, z * 0.3);
        let c =
            coasting(&ring(o, z, 0.55), &ring(o, z, 0.6), [payload, at_rest()], 60.0, &settings);
        let closest = c.closest().unwrap();
        let off = closest.distance_m() - 0.05;
        assert!(off.abs() < 2.0 * settings.tolerance_m(), "{off:e}");
        assert!((closest.time_s() - 5.0).abs() < 1e-2);
        assert!(c.looks() < 500, "{}", c.looks());
    }
    // With drift aside it strikes when the drift is the gap and the planes meet.
    let payload = ball(z * -1.0, V::new(0.01, 0.0, 0.2), V::zeros());
    let c = coasting(
        &ring(o, z, 0.55),
        &ring(o, z, 0.6),
        [payload, at_rest()],
        60.0,
        &ClearanceSettings::default(),
    );
    assert!((c.contact_s().unwrap() - 5.0).abs() < 1e-4);
    // The same against a solid: a wall that the ring's edge runs into.
    let wall: Outline = cuboid([0.5, 2.0, 2.0]);
    let payload = ball(V::new(-3.0, 0.0, 0.0), V::x() * 0.25, V::zeros());
    let c =
        coasting(&ring(o, V::new(0.0, 1.0, 1.0), 0.75), &wall, [payload, at_rest()], 60.0, &fine());
    assert!((c.contact_s().unwrap() - 7.0).abs() < 1e-8, "{:?}", c.contact_s());
    // And the other way round.
    let payload = ball(V::new(-3.0, 0.0, 0.0), V::x() * 0.25, V::zeros());
    let c =
        coasting(&wall, &ring(o, V::new(0.0, 1.0, 1.0), 0.75), [payload, at_rest()], 6.0, &fine());
    assert!((c.closest().unwrap().distance_m() - 0.25).abs() < 1e-11);
    assert!((c.closest().unwrap().time_s() - 6.0).abs() < 1e-10);
}

#[test]
fn rings_that_link_touch_on_the_way() {
    let o = V::zeros();
    let payload = ball(V::x() * 3.0, V::x() * -0.25, V::zeros());
    let c = coasting(
        &ring(o, V::y(), 1.0),
        &ring(o, V::z(), 1.0),
        [payload, at_rest()],
        30.0,
        &ClearanceSettings::default(),
    );
    assert!((c.contact_s().unwrap() - 4.0).abs() < 1e-5, "{:?}", c.contact_s());
}

/// A ring that passes one of eight times its size: the polynomial of the larger one's points is too flat to be
/// told from zero where it matters, and has to be that of the smaller one's.
#[test]
fn rings_of_unlike_sizes_pass() {
    let moving = |moments: [f64; 3], attitude: [f64; 4], position, velocity, rate| {
        let [a, b, c] = moments;
        let [p, q, r] = [0.040199, 0.03, -0.02];
        let [i, j, k, w] = attitude;
        let state = RigidState {
            position,
            velocity,
            attitude: UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k)),
            angular_velocity: rate,
        };
        FreeBody::new(state, Matrix3::new(a, p, q, p, b, r, q, r, c)).unwrap()
    };
    let small = moving(
        [1.66039, 2.687226, 1.66114],
        [0.797854, 0.432109, 0.407932, -0.101498],
        V::new(-20.092437, 131.198073, 153.825516),
        V::new(9.121931, -22.735331, -20.350009),
        V::new(2.872006, -5.067857, 2.410822),
    );
    let large = moving(
        [2.891959, 2.345368, 2.33712],
        [0.5169807, -0.833868665, -0.1933384802, -0.00377295],
        V::zeros(),
        V::zeros(),
        V::new(0.81657, -0.184909, 0.26166),
    );
    let rings = [
        ring(
            V::new(-17.640495, -6.309033, -3.101250),
            V::new(0.252853, -0.631976, 0.732579),
            8.892647,
        ),
        ring(V::zeros(), V::new(-0.732844, -0.566861, -0.376309), 72.000941),
    ];
    let settings = ClearanceSettings::default();
    let c = coasting(&rings[0], &rings[1], [small, large], 40.0, &settings);
    let closest = c.closest().unwrap();
    assert!(closest.distance_m() > 0.5 && closest.distance_m() < 1.5, "{closest:?}");
    assert!(closest.distance_m() - closest.at_least_m() < 1.1e-9);
    assert!(c.looks() < 5000, "{}", c.looks());
    // The other way round the same.
    let turned = coasting(&rings[1], &rings[0], [large, small], 40.0, &settings);
    let other = turned.closest().unwrap();
    assert!((other.distance_m() - closest.distance_m()).abs() < 2e-9);
    assert!(turned.looks() < 5000, "{}", turned.looks());
}

#[test]
fn a_point_on_the_axis_of_a_ring() {
    // All of the ring is as near: no angle is singled out.
    let payload = ball(V::z() * -2.0, V::z() * 0.5, V::zeros());
    let c = coasting(
        &points(&[V::zeros()]),
        &ring(V::zeros(), V::z(), 0.4),
        [payload, at_rest()],
        20.0,
        &ClearanceSettings::default(),
    );
    assert!((c.closest().unwrap().distance_m() - 0.4).abs() < 2e-9);
    assert!((c.closest().unwrap().time_s() - 4.0).abs() < 1e-3);
}

/// Up and down again along z, z = vt − ½at², the stage turning the while.
pub(crate) struct Thrown {
    pub(crate) speed: f64,
    pub(crate) deceleration: f64,
}

impl Motion for Thrown {
    fn states(&mut self, t: f64) -> Option<[RigidState; 2]> {
        let position = V::z() * (self.speed * t - 0.5 * self.deceleration * t * t);
        let velocity = V::z() * (self.speed - self.deceleration * t);
        Some([RigidState { position, velocity, ..RigidState::default() }, RigidState::default()])
    }

    fn limits(&mut self, from: f64, to: f64) -> MotionLimits {
        let at = |t: f64| (self.speed - self.deceleration * t).abs();
        MotionLimits {
            speed: at(from).max(at(to)),
            acceleration: self.deceleration,
            ..MotionLimits::default()
        }
    }
}

#[test]
fn mated_shapes_count_from_parting_and_recontact_is_found() {
    let mated = [
        (ring(V::zeros(), V::z(), 0.6), ring(V::zeros(), V::z(), 0.6)),
        (cuboid([0.5; 3]), {
            let deck = [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]];
            OutlineShape::hull(&deck.map(|[x, y]| V::new(x, y, -0.5))).unwrap().into()
        }),
        (points(&[V::x(), V::y()]), points(&[V::x(), V::y()])),
    ];
    for (payload, stage) in &mated {
        let settings = ClearanceSettings::default();
        let mut up = Thrown { speed: 0.4, deceleration: 0.1 };
        let run = |motion: &mut Thrown, to| {
            Clearance::new(payload, stage, motion, 0.0, to, &settings).unwrap()
        };
        let c = run(&mut up, 60.0);
        let [pair] = c.shapes() else { panic!() };
        assert!(pair.is_mated());
        let parted = bisect(|t| 1e-3 - (0.4 * t - 0.05 * t * t), 0.0, 1.0);
        assert!((pair.counts_from_s().unwrap() - parted).abs() < 3e-6);
        assert!((c.contact_s().unwrap() - 8.0).abs() < 1e-5, "{:?}", c.contact_s());
        assert_eq!(c.closest().unwrap().distance_m(), 0.0);
        // Before it falls back there is no contact, only the distance of parting, which is no clearance.
        let c = run(&mut up, 7.0);
        assert_eq!((c.closest(), c.contact_s()), (None, None));
        assert!((c.shapes()[0].closest().unwrap().distance_m() - 1e-3).abs() < 1e-6);
        // What never parts never counts.
        let c = run(&mut Thrown { speed: 0.0, deceleration: 0.0 }, 60.0);
        assert_eq!((c.closest(), c.contact_s()), (None, None));
        assert_eq!(c.shapes()[0].counts_from_s(), None);
    }
}

/// Springs that failed: bodies that turn as one, or slide on each other, and never part.
#[test]
fn mated_shapes_that_turn_and_stay_never_count() {
    let deck = cuboid([1.5, 1.5, 1.0]).about(V::z()).unwrap();
    let corners = points(&[V::x(), V::y(), -V::x(), -V::y()]);
    let unit = || ring(V::zeros(), V::z(), 1.0);
    let pairs = [
        (unit(), unit()),
        (cuboid([1.0; 3]).about(-V::z()).unwrap(), cuboid([1.0; 3]).about(V::z()).unwrap()),
        (unit(), deck.clone()),
        (corners.clone(), deck),
        (corners, unit()),
        (cuboid([0.3; 3]), cuboid([1.0; 3])),
    ];
    let moments = [1.0, 1.5, 2.0];
    let turning = |velocity: V, rate: V| body(moments, V::zeros(), velocity, rate);
    for (payload, stage) in &pairs {
        for rate in [V::z(), V::new(0.01, 0.02, 1.0), V::x()] {
            let alike = turning(V::zeros(), rate);
            let settings = ClearanceSettings::default();
            let c = coasting(payload, stage, [alike, alike], 300.0, &settings);
            assert_eq!((c.closest(), c.contact_s()), (None, None));
            assert_eq!(c.shapes()[0].counts_from_s(), None);
            // Some thousand steps of eight arcs each at most.
            assert!(c.looks() < 200_000, "{}", c.looks());
        }
    }
    // Sliding fast: too many steps for all of them to be short.
    for (payload, stage) in &pairs[..3] {
        let bodies = [turning(V::zeros(), V::z() * 20.0), at_rest()];
        let c = coasting(payload, stage, bodies, 60.0, &ClearanceSettings::default());
        assert_eq!(c.shapes()[0].counts_from_s(), None);
    }
    // Turning fast as one, and drifting apart at 1 mm/s: parted after 1 s.
    for (payload, stage) in &pairs[..3] {
        let rate = V::z() * 20.0;
        let bodies = [turning(V::z() * 1e-3, rate), turning(V::zeros(), rate)];
        let c = coasting(payload, stage, bodies, 5.0, &ClearanceSettings::default());
        let parted = c.shapes()[0].counts_from_s().unwrap();
        assert!((parted - 1.0).abs() < 6e-4, "{parted}");
        assert_eq!(c.contact_s(), None);
    }
}

#[test]
fn mated_shapes_do_not_hide_the_others() {
    // Interface rings on each other, and a nozzle 5 cm from the wall of its well.
    let shape = |c: V, r: f64| OutlineShape::ring(c, V::z(), r).unwrap();
    let payload = Outline::new([shape(V::zeros(), 0.8), shape(V::z() * -0.5, 0.3)]).unwrap();
    let stage = Outline::new([shape(V::zeros(), 0.8), shape(V::z() * -0.2, 0.35)]).unwrap();
    let moving = ball(V::zeros(), V::z() * 0.3, V::zeros());
    let c = coasting(&payload, &stage, [moving, at_rest()], 60.0, &ClearanceSettings::default());
    assert_eq!(c.shapes().len(), 4);
    assert!(c.shapes()[0].is_mated() && !c.shapes()[3].is_mated());
    assert_eq!(c.contact_s(), None);
    let closest = c.closest().unwrap();
    assert!((closest.distance_m() - 0.05).abs() < 2e-9 && (closest.time_s() - 1.0).abs() < 1e-3);
}

#[test]
fn bad_spans_and_motions_are_refused() {
    let (p, s) = (cuboid([1.0; 3]), cuboid([1.0; 3]));
    let settings = ClearanceSettings::default();
    let mut coast = Coast::new(&ball(V::z() * 3.0, V::z(), V::x()), &at_rest(), 1.0);
    for (from, to) in [(f64::NAN, 1.0), (1.0, f64::INFINITY), (2.0, 1.0)] {
        let error = Clearance::new(&p, &s, &mut coast, from, to, &settings).unwrap_err();
        assert!(matches!(error, ClearanceError::Span { .. }));
    }
    // Before its start a coast is not known.
    let error = Clearance::new(&p, &s, &mut coast, 0.0, 2.0, &settings).unwrap_err();
    assert_eq!(error, ClearanceError::Motion { time: 0.0 });
    for (position, rate) in
        [(1e300, 1.0), (f64::NAN, 0.0), (3.0, 1e300), (3.0, f64::NAN), (1e-300, 1e-300)]
    {
        let mut coast =
            Coast::new(&ball(V::z() * position, V::z(), V::x() * rate), &at_rest(), 0.0);
        let result = Clearance::new(&p, &s, &mut coast, 0.0, 60.0, &settings);
        assert!(result.is_err() || position == 1e-300, "{position} {rate} {result:?}");
    }
    for (a, b, c) in [
        (0.0, 1.0, 2.0),
        (f64::NAN, 1.0, 2.0),
        (1e-9, 1e-8, 1.0),
        (1e-9, 1e-6, 1e-6),
        (1e-9, f64::NAN, 1.0),
        (1e-9, 1e-6, f64::INFINITY),
    ] {
        assert!(ClearanceSettings::new(a, b, c).is_err());
    }
    assert_eq!(ClearanceSettings::new(1e-9, 1e-6, 1e-3).unwrap(), settings);
}

fn outline() -> impl Strategy<Value = Outline> {
    let cloud = |n: std::ops::Range<usize>| {
        prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), n)
            .prop_map(|p| p.into_iter().map(V::from).collect::<Vec<_>>())
    };
    let ring =
        (prop::array::uniform3(-0.5..0.5f64), prop::array::uniform3(-1.0..1.0f64), 0.1..1.5f64);
    prop_oneof![
        cloud(1..8).prop_map(|p| OutlineShape::points(&p).unwrap()),
        cloud(1..14).prop_map(|p| OutlineShape::hull(&p).unwrap()),
        ring.prop_filter("axis", |r| V::from(r.1).norm() > 0.05)
            .prop_map(|(c, a, r)| OutlineShape::ring(c.into(), a.into(), r).unwrap()),
    ]
    .prop_map(Outline::from)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]
    /// No sampled instant is nearer than the smallest distance, which is attained where it says, or
    /// than the touch before the first contact.
    #[test]
    fn nothing_sampled_is_nearer(
        outlines in (outline(), outline()),
        moments in prop::array::uniform2(prop::array::uniform3(2.0..3.9f64)),
        start in prop::array::uniform3(-3.0..3.0f64),
        aim in prop::array::uniform3(-1.5..1.5f64),
        rates in prop::array::uniform2(prop::array::uniform3(-1.5..1.5f64)),
        duration in 4.0..20.0f64,
    ) {
        let (payload, stage) = outlines;
        let position = V::from(start);
        // Passing near the other body half-way.
        let velocity = (V::from(aim) - position) / (0.5 * duration);
        let bodies = [
            body(moments[0], position, velocity, rates[0].into()),
            body(moments[1], V::zeros(), V::zeros(), rates[1].into()),
        ];
        let settings = ClearanceSettings::default();
        let c = coasting(&payload, &stage, bodies, duration, &settings);
        let mut coast = Coast::new(&bodies[0], &bodies[1], 0.0);
        let pair = &c.shapes()[0];
        let Some(from) = pair.counts_from_s() else { return Ok(()) };
        let closest = pair.closest().unwrap();
        let [p, s] = coast.states(closest.time_s()).unwrap();
        let gap = p.position + p.attitude * closest.payload_point_m()
            - s.position - s.attitude * closest.stage_point_m();
        let touch = settings.touch_m();
        if c.contact_s().is_none() {
            prop_assert!((gap.norm() - closest.distance_m()).abs() < 1e-12);
            prop_assert!(closest.distance_m() > touch);
            prop_assert!(closest.at_least_m() >= closest.distance_m() - 1.01e-9,
                "{} {}", closest.at_least_m(), closest.distance_m());
        } else {
            prop_assert!(gap.norm() <= touch * 1.01, "{}", gap.norm());
        }
        let until = c.contact_s().unwrap_or(duration);
        let least = if c.contact_s().is_some() { touch } else { closest.distance_m() };
        for i in 0..400 {
            let t = from + (until - from) * f64::from(i) / 400.0;
            let at = Clearance::new(&payload, &stage, &mut coast, t, t, &settings).unwrap();
            // At an instant in contact nothing counts.
            let d = at.closest().map_or(0.0, Approach::distance_m);
            prop_assert!(d >= least - 2e-9, "{d} at {t}, {closest:?}");
        }
    }
}
