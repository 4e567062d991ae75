//! Regions against distributions of matter that were made inside and outside of them.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use proptest::prelude::*;

use super::hull::directions;
use super::*;
use crate::mass_properties::tests::{any_attitude, any_body};
use crate::{Inertia, SecondMoments, Shape};

/// Point masses at given places.
fn points(masses: &[(f64, Vector3<f64>)]) -> MassProperties {
    let each = masses.iter().map(|(m, x)| MassProperties::point(*m, *x).unwrap());
    MassProperties::combined(each).unwrap()
}

fn any_sizes() -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-0.5..0.7f64).prop_map(|e| Vector3::from(e.map(|e| 10f64.powf(e))))
}

fn any_pose() -> impl Strategy<Value = Isometry3<f64>> {
    (any_attitude(), prop::array::uniform3(-9.0..9.0f64))
        .prop_map(|(q, t)| Isometry3::from_parts(Vector3::from(t).into(), q))
}

/// Masses and where they are.
type Masses = Vec<(f64, Vector3<f64>)>;

/// Masses on the unit cube.
fn any_masses() -> impl Strategy<Value = Masses> {
    let coordinate = prop_oneof![Just(-1.0), Just(1.0), -1.0..1.0f64];
    let place = prop::array::uniform3(coordinate).prop_map(Vector3::from);
    prop::collection::vec((0.1..3.0f64, place), 1..9)
}

fn corners(half: &Vector3<f64>, pose: &Isometry3<f64>) -> Vec<[f64; 3]> {
    let corner = |i: usize| {
        let sign = |k: usize| if i & (1 << k) == 0 { -1.0 } else { 1.0 };
        let x = Vector3::new(sign(0), sign(1), sign(2)).component_mul(half);
        (pose.rotation * x + pose.translation.vector).into()
    };
    (0..8).map(corner).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// Matter in an ellipsoid is possible, and on its surface only just.
    #[test]
    fn ellipsoids_are_exact(sizes in any_sizes(), pose in any_pose(), masses in any_masses(), by in 1e-9..0.5f64) {
        let region = Region::ellipsoid([0.0; 3], sizes).unwrap().transformed(&pose).unwrap();
        let at = |x: &Vector3<f64>, scale: f64| {
            pose * nalgebra::Point3::from(x.component_mul(&sizes) * scale)
        };
        let on = |scale: f64| -> MassProperties {
            let on = masses.iter().filter(|(_, x)| x.norm() > 1e-3);
            let on = on.map(|(m, x)| (*m, at(&x.normalize(), scale).coords));
            points(&on.collect::<Vec<_>>())
        };
        prop_assume!(masses.iter().any(|(_, x)| x.norm() > 1e-3));
        // Rounding of a place far from the origin, relative to the least semi-axis.
        let rounding = 1e-14 * (1.0 + (pose.translation.vector.norm() + sizes.max()) / sizes.min());
        let tight = on(1.0);
        prop_assert!(region.room(&tight).abs() < rounding.max(1e-12), "{}", region.room(&tight));
        let by = by.max(10.0 * rounding);
        prop_assert_eq!(region.containment(&on(1.0 - by)), Containment::Possible);
        prop_assert_eq!(region.containment(&on(1.0 + by)), Containment::Impossible);
    }

    /// Where the condition of an ellipsoid holds there is such matter: masses on the surface of a like, smaller one.
    #[test]
    fn ellipsoids_hold_what_they_say(
        (k, q, c) in (prop::array::uniform3(1.0..9.0f64), any_attitude(), prop::array::uniform3(-1.0..1.0f64)),
        sizes in any_sizes(),
    ) {
        let inertia = Inertia::from_second_moments(SecondMoments::new(k).unwrap(), &q).unwrap();
        let body = MassProperties::new(2.0, c, inertia).unwrap();
        // So large that there is room.
        let needed = (1.0 - Region::ellipsoid([0.0; 3], sizes).unwrap().room(&body)).sqrt();
        let sizes = sizes * (needed / 0.85);
        let region = Region::ellipsoid([0.0; 3], sizes).unwrap();
        prop_assert!(region.room(&body) > 0.2);
        let unit = Isometry3::identity();
        let local = Local::of(&body, &unit);
        let radii = [1.0, 0.9, 0.7, 0.5, 0.3, 0.0];
        let spiral = directions().flat_map(|n| [n, -n]).flat_map(|n| radii.map(|r| n * r));
        let places = spiral.map(|n| n.component_mul(&sizes));
        // In the units of the ellipsoid, on the principal axes that the body has there.
        let spread = local.spread.component_div(&(sizes * sizes.transpose()));
        let eigen = spread.symmetric_eigen();
        let scaled = Local {
            centre: local.centre.component_div(&sizes),
            spread,
            axes: eigen.eigenvectors,
            radii: eigen.eigenvalues.map(f64::sqrt),
        };
        let inside = |x: &Vector3<f64>| x.norm() <= 1.0;
        let exit = |n: &Vector3<f64>| {
            let along = scaled.centre.dot(n);
            (along * along + 1.0 - scaled.centre.norm_squared()).sqrt() - along
        };
        let own = scaled.on_own_axes(inside, exit);
        let places = places.map(|x| x.component_div(&sizes)).chain(own);
        prop_assert_eq!(scaled.decide(places, 1.0, &Widths::same()), Containment::Possible);
    }

    /// Matter in a region far from the origin, its surface among it, is never called impossible.
    #[test]
    fn matter_far_away_is_never_impossible(half in any_sizes(), pose in any_pose(), masses in any_masses(), power in 0.0..6.0f64) {
        let far = Isometry3 { translation: (pose.translation.vector * 10f64.powf(power)).into(), ..pose };
        let solid = Region::solid_box([0.0; 3], half).unwrap().transformed(&far).unwrap();
        let round = Region::ellipsoid([0.0; 3], half).unwrap().transformed(&far).unwrap();
        let hull = Region::hull(&corners(&half, &far)).unwrap();
        for (region, is_round) in [(solid, false), (hull, false), (round, true)] {
            let inside = masses.iter().map(|(m, x)| {
                let x = if is_round { x / x.norm().max(1.0) } else { *x };
                (*m, (far * nalgebra::Point3::from(x.component_mul(&half))).coords)
            });
            let body = points(&inside.collect::<Vec<_>>());
            prop_assert_ne!(region.containment(&body), Containment::Impossible, "{}", region.room(&body));
        }
    }

    /// Matter in a box or a hull is never called impossible, and is mostly found.
    #[test]
    fn matter_inside_is_never_impossible(half in any_sizes(), pose in any_pose(), masses in any_masses(), scale in 0.1..1.0f64) {
        let solid = Region::solid_box([0.0; 3], half).unwrap().transformed(&pose).unwrap();
        let hull = Region::hull(&corners(&half, &pose)).unwrap();
        let inside: Vec<_> = masses
            .iter()
            .map(|(m, x)| (*m, (pose * nalgebra::Point3::from(x.component_mul(&half) * scale)).coords))
            .collect();
        let body = points(&inside);
        prop_assert_ne!(solid.containment(&body), Containment::Impossible);
        prop_assert_ne!(hull.containment(&body), Containment::Impossible);
        if scale < 0.5 {
            prop_assert_eq!(solid.containment(&body), Containment::Possible);
            prop_assert_eq!(hull.containment(&body), Containment::Possible);
        }
    }

    /// Whatever the mass properties, a box and the hull of its corners do not contradict each other.
    #[test]
    fn a_box_is_the_hull_of_its_corners(body in any_body(), half in any_sizes(), pose in any_pose()) {
        use Containment::{Impossible, Possible};
        let solid = Region::solid_box([0.0; 3], half).unwrap().transformed(&pose).unwrap();
        let hull = Region::hull(&corners(&half, &pose)).unwrap();
        let both = [solid.containment(&body), hull.containment(&body)];
        prop_assert!(both != [Possible, Impossible] && both != [Impossible, Possible], "{both:?}");
        // What is in the box is in the ball about it.
        let ball = Region::ellipsoid(pose.translation.vector, Vector3::repeat(half.norm())).unwrap();
        if ball.containment(&body) == Impossible {
            prop_assert!(!both.contains(&Possible));
        }
    }

    /// A small body well inside of the hull of a few boxes, as near its corners as they are sharp.
    #[test]
    fn all_corners_of_few_points_count(
        boxes in prop::collection::vec((any_sizes(), any_pose()), 1..5),
        towards in prop::collection::vec(1e-3..1.0f64, 40),
    ) {
        // About one middle, of which the thinnest box holds a ball.
        let thinnest = boxes.iter().map(|(half, _)| half.min()).fold(f64::INFINITY, f64::min);
        let middle = boxes[0].1.translation;
        let points: Vec<[f64; 3]> = boxes
            .iter()
            .flat_map(|(half, pose)| corners(half, &Isometry3::from_parts(middle, pose.rotation)))
            .collect();
        let weights: Vec<f64> = points.iter().zip(&towards).map(|(_, w)| w.powi(12)).collect();
        let total: f64 = weights.iter().sum();
        let mean: Vector3<f64> =
            points.iter().zip(&weights).map(|(p, w)| Vector3::from(*p) * (w / total)).sum();
        let centre = middle.vector + (mean - middle.vector) * 0.99;
        let ball = Shape::sphere_shell(1e-3 * thinnest).unwrap().of_mass(2.0).unwrap();
        let body = ball.transformed(&Translation3::from(centre).into()).unwrap();
        prop_assert_eq!(Region::hull(&points).unwrap().containment(&body), Containment::Possible);
    }

    #[test]
    fn nothing_panics(x in prop::array::uniform9(prop::num::f64::ANY), body in any_body()) {
        let [a, b, c, d, e, f, g, h, i] = x;
        for region in [Region::ellipsoid([a, b, c], [d, e, f]), Region::solid_box([a, b, c], [d, e, f])] {
            let _ = region.map(|region| region.containment(&body));
        }
        let _ = Region::hull(&[[a, b, c], [d, e, f], [g, h, i]]).map(|region| region.containment(&body));
    }
}

/// Points in the unit cube, a pose and half sides of which one at least is no less than 1: rods, plates, and slabs and needles of any
/// thickness, far away and near, turned and not, and places in their hull.
fn any_thin() -> impl Strategy<Value = (Vector3<f64>, Isometry3<f64>, Vec<Vector3<f64>>, Masses)> {
    let thin = prop_oneof![Just(0.0), Just(1.0), (-16.0..0.0f64).prop_map(|e| 10f64.powf(e))];
    let half =
        (prop::array::uniform2(thin), 1.0..3.0f64, 0..3usize).prop_map(|([a, b], wide, first)| {
            let mut half = [wide, a, b];
            half.rotate_right(first);
            Vector3::from(half)
        });
    let turn = prop_oneof![Just(UnitQuaternion::identity()), any_attitude()];
    let far = prop_oneof![Just(0.0), (-3.0..6.0f64).prop_map(|e| 10f64.powf(e))];
    let pose = (turn, prop::array::uniform3(-1.0..1.0f64), far)
        .prop_map(|(q, t, far)| Isometry3::from_parts((Vector3::from(t) * far).into(), q));
    let coordinate = || prop_oneof![Just(-1.0), Just(1.0), -1.0..1.0f64];
    let place = prop::array::uniform3(coordinate()).prop_map(Vector3::from);
    let shares = prop::collection::vec(prop_oneof![Just(0.0), 1e-3..1.0f64], 9);
    let masses = prop::collection::vec((0.1..3.0f64, shares, any::<prop::sample::Index>()), 1..6);
    (half, pose, prop::collection::vec(place, 2..9), masses).prop_map(
        |(half, pose, corners, masses)| {
            let inside = masses.iter().map(|(mass, shares, alone)| {
                let total: f64 = shares[..corners.len()].iter().sum();
                let mean = corners.iter().zip(shares).map(|(x, w)| x * (w / total)).sum();
                (*mass, if total > 0.0 { mean } else { *alone.get(&corners) })
            });
            let inside = inside.collect();
            (half, pose, corners, inside)
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Matter in a rod, a plate or a slab is never called impossible, however thin, far away and tilted it is, and matter that lies off
    /// it by more than rounding always is.
    #[test]
    fn thin_hulls_hold_their_own_matter_alone(
        (half, pose, corners, masses) in any_thin(),
        (by, axis) in (-5.0..1.0f64, 0..3usize),
    ) {
        let at = |x: &Vector3<f64>| (pose * nalgebra::Point3::from(x.component_mul(&half))).coords;
        let region = Region::hull(&corners.iter().map(|x| at(x).into()).collect::<Vec<_>>()).unwrap();
        let inside: Vec<_> = masses.iter().map(|(m, x)| (*m, at(x))).collect();
        let body = points(&inside);
        let room = region.room(&body);
        prop_assert!(region.containment(&body) != Containment::Impossible && room > -1e-13, "{room}");
        // All of it off to one side, and as far to both sides.
        let mut off = Vector3::zeros();
        off[axis] = 10f64.powf(by) * half.max() + 3.0 * half[axis] + 1e-9 * pose.translation.vector.norm();
        let off = pose.rotation * off;
        let aside: Vec<_> = inside.iter().map(|(m, x)| (*m, x + off)).collect();
        let sides = inside.iter().flat_map(|(m, x)| [(*m, x + off), (*m, x - off)]).collect::<Vec<_>>();
        for outside in [aside, sides] {
            let body = points(&outside);
            prop_assert_eq!(region.containment(&body), Containment::Impossible, "{}", region.room(&body));
        }
    }
}

/// Random numbers between 0 and 1.
fn uniform() -> impl FnMut() -> f64 {
    let mut state = 1u64;
    move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A few masses at random places in the hulls of a few random points, of which docs/models/mass-properties.md tells the shares.
#[test]
fn few_bodies_stay_undecided_in_hulls() {
    let mut uniform = uniform();
    for (corners, most) in [(4, 160), (5, 16), (6, 16), (8, 16)] {
        let (mut undecided, all) = (0, 1600);
        for body in 0..all {
            let hull: Vec<[f64; 3]> = (0..corners).map(|_| [0; 3].map(|_| uniform())).collect();
            let mut place = || {
                let weights: Vec<f64> = hull.iter().map(|_| -uniform().ln()).collect();
                let total: f64 = weights.iter().sum();
                let each = hull.iter().zip(&weights).map(|(p, w)| Vector3::from(*p) * (w / total));
                each.sum::<Vector3<f64>>()
            };
            let count = [3, 4, 5, 8][body % 4];
            let masses: Vec<_> = (0..count).map(|i| (1.0 + 0.1 * f64::from(i), place())).collect();
            match Region::hull(&hull).unwrap().containment(&points(&masses)) {
                Containment::Possible => {}
                Containment::Undecided => undecided += 1,
                Containment::Impossible => panic!("{hull:?} {masses:?}"),
            }
        }
        assert!(undecided < most, "{corners}: {undecided} of {all}");
    }
}

/// A plate in its own plane and a rod on its own line are possible, whatever the last bits of their moments are.
#[test]
fn the_last_bit_of_a_plate_does_not_decide() {
    let mut uniform = uniform();
    let mut thick = 0;
    for i in 0..200 {
        let digits = |x: f64| (x * 1e4).round() / 1e4;
        let (a, b) = (digits(0.3 + uniform()), digits(if i % 4 == 0 { 0.0 } else { uniform() }));
        let moments = Vector3::new(b, a, digits(a + b));
        let Ok(inertia) = Inertia::new(Matrix3::from_diagonal(&moments)) else { continue };
        let of_rounding = |k: &f64| *k > 0.0 && *k < 1e-12;
        thick += inertia.second_moments().values().iter().filter(|k| of_rounding(k)).count();
        let body = MassProperties::new(12.0, Vector3::new(0.01, 0.0, 0.0), inertia).unwrap();
        let [x, y] = [a, b].map(|k| 2.0 * (k / 12.0_f64).sqrt() + if k > 0.0 { 0.02 } else { 0.0 });
        let flat = [[x, y, 0.0], [-x, y, 0.0], [-x, -y, 0.0], [x, -y, 0.0]];
        let region = Region::hull(&flat).unwrap();
        assert_eq!(region.containment(&body), Containment::Possible, "{moments}");
    }
    assert!(thick > 5, "{thick}");
}

/// How many bodies with matter in a box stay undecided: few.
#[test]
fn few_bodies_stay_undecided() {
    let region = Region::solid_box([0.0; 3], [1.0, 0.5, 0.25]).unwrap();
    let mut uniform = uniform();
    let half = Vector3::new(1.0, 0.5, 0.25);
    let (mut undecided, all) = (0, 2000);
    for _ in 0..all {
        let count = 2 + (8.0 * uniform()) as usize;
        let masses: Vec<_> = (0..count)
            .map(|_| {
                let x = Vector3::new(uniform(), uniform(), uniform()) * 2.0 - Vector3::repeat(1.0);
                (0.1 + uniform(), x.component_mul(&half))
            })
            .collect();
        match region.containment(&points(&masses)) {
            Containment::Possible => {}
            Containment::Undecided => undecided += 1,
            Containment::Impossible => panic!("{masses:?}"),
        }
    }
    assert!(undecided < all / 50, "{undecided} of {all}");
}

#[test]
fn shapes_fit_in_what_bounds_them() {
    let half = [0.5, 0.6, 0.7];
    let solid = Region::solid_box([0.0; 3], half).unwrap();
    let full = half.map(|x| 2.0 * x);
    for shape in
        [Shape::solid_box(full), Shape::box_shell(full), Shape::rod(1.4), Shape::sphere(0.5)]
    {
        let body = shape.unwrap().of_mass(2.0).unwrap();
        assert_eq!(solid.containment(&body), Containment::Possible);
        let far = body.translated([0.0, 0.0, 3.0]).unwrap();
        assert_eq!(solid.containment(&far), Containment::Impossible);
    }
    // All the mass at the ends of the longest diagonal, and a hair beyond.
    let ends = |scale: f64| {
        let end = Vector3::from(half) * scale;
        points(&[(1.0, end), (1.0, -end)])
    };
    assert_eq!(solid.containment(&ends(1.0)), Containment::Possible);
    assert_eq!(solid.containment(&ends(1.0 + 1e-9)), Containment::Impossible);
    let ellipsoid = Region::ellipsoid([0.0; 3], half).unwrap();
    let body = Shape::ellipsoid(half).unwrap().of_mass(2.0).unwrap();
    assert_eq!(ellipsoid.containment(&body), Containment::Possible);
    // Three fifths of ∫ (1 − r²) r² dr / ∫ r² dr.
    assert!((ellipsoid.room(&body) - 0.4).abs() < 1e-14);
    // A hull of one point holds a point there, and nothing else.
    let dot = Region::hull(&[[1.0, 2.0, 3.0]]).unwrap();
    let there = MassProperties::point(1.0, [1.0, 2.0, 3.0]).unwrap();
    assert_eq!(dot.containment(&there), Containment::Possible);
    assert_ne!(dot.containment(&body), Containment::Possible);
    // A flat hull holds a plate.
    let flat =
        Region::hull(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]]).unwrap();
    let plate = Shape::plate([1.0, 1.0]).unwrap().of_mass(1.0).unwrap();
    assert_eq!(
        flat.containment(&plate.translated([0.5, 0.5, 0.0]).unwrap()),
        Containment::Possible
    );
    assert_eq!(flat.containment(&plate), Containment::Impossible);
}

#[test]
fn what_is_no_region_is_refused_by_name() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e200] {
        let error = Region::ellipsoid([0.0; 3], [1.0, bad, 1.0]).unwrap_err();
        assert!(error.to_string().starts_with("semi-axis 2 = "), "{error}");
        assert!(Region::solid_box([0.0; 3], [1.0, 1.0, bad]).is_err());
    }
    assert!(Region::ellipsoid([f64::NAN, 0.0, 0.0], [1.0; 3]).is_err());
    assert_eq!(Region::hull(&[]), Err(RegionError::Empty));
    let error = Region::hull(&[[0.0; 3], [f64::NAN; 3]]).unwrap_err();
    assert!(error.to_string().starts_with("point 1: "), "{error}");
    let long = UnitQuaternion::new_unchecked(Quaternion::new(2.0, 0.0, 0.0, 0.0));
    let by = Isometry3::from_parts(Vector3::zeros().into(), long);
    assert!(Region::ellipsoid([0.0; 3], [1.0; 3]).unwrap().transformed(&by).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// A hull of points that lie in a plane but for the last digits of their coordinates, as a file of single precision has them:
    /// matter at the points is possible, at one place or at several, and outside of their outline it is not.
    #[test]
    fn points_that_are_nearly_in_a_plane_decide(
        count in 3..30usize,
        long in 0.1..1.0f64,
        size in -3.0..3.0f64,
        noise in -17.0..-2.0f64,
        offs in prop::collection::vec(-1.0..1.0f64, 30),
        shares in prop::collection::vec(0.0..1.0f64, 30),
        pose in any_pose(),
    ) {
        let size = 10f64.powf(size);
        let about = |i: usize| {
            let (sin, cos) = (std::f64::consts::TAU * i as f64 / count as f64).sin_cos();
            Vector3::new(cos, long * sin, 10f64.powf(noise) * offs[i])
        };
        let at = |x: Vector3<f64>| (pose.rotation * x + 0.1 * pose.translation.vector) * size;
        let rim: Vec<Vector3<f64>> = (0..count).map(|i| at(about(i))).collect();
        let region = Region::hull(&rim.iter().map(|x| (*x).into()).collect::<Vec<_>>()).unwrap();
        let all = shares[..count].iter().sum::<f64>().max(1e-3);
        let mean: Vector3<f64> = rim.iter().zip(&shares).map(|(x, share)| x * (share / all)).sum();
        prop_assert_eq!(region.containment(&points(&[(2.0, mean)])), Containment::Possible);
        let heavy = |(share, x): (&f64, &Vector3<f64>)| (share + 1e-3, *x);
        let several: Masses = shares.iter().zip(&rim).map(heavy).collect();
        prop_assert_eq!(region.containment(&points(&several)), Containment::Possible);
        let middle = rim.iter().sum::<Vector3<f64>>() / count as f64;
        for beyond in [1e-4, 0.1] {
            let outside = rim[0] + (rim[0] - middle) * beyond;
            let found = region.containment(&points(&[(2.0, outside)]));
            prop_assert!(found != Containment::Possible, "{}", beyond);
        }
        let across = middle + pose.rotation * Vector3::z() * (size * (1e-4 + 2.0 * 10f64.powf(noise)));
        prop_assert!(region.containment(&points(&[(2.0, across)])) != Containment::Possible);
    }
}
