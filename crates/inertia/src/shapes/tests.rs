//! Tests of the shapes against meshes, clouds of points and textbook moments.

use super::*;
use crate::mesh::tests::revolved;
use nalgebra::Vector3;
use proptest::prelude::*;
use std::f64::consts::PI;

/// Mass properties of unit mass as ten numbers: centre, Σ_c diagonal, and the products.
fn numbers(body: &MassProperties) -> [f64; 9] {
    let c = body.mass_centre_m();
    let sigma = body.inertia().as_inertia_matrix().second_moment_matrix();
    let [.., i12, i13, i23] = body.inertia().entries();
    [c.x, c.y, c.z, sigma[(0, 0)], sigma[(1, 1)], sigma[(2, 2)], i12, i13, i23]
}

fn assert_near(found: &MassProperties, expected: &MassProperties, tolerance: f64, name: &str) {
    for (a, b) in numbers(found).iter().zip(numbers(expected)) {
        assert!((a - b).abs() < tolerance, "{name}: {:?} {:?}", numbers(found), numbers(expected));
    }
}

/// A profile (radius, height) at `t` in [0, 1] and the direction that keeps the axis inside.
type Profile = fn(f64) -> [f64; 2];

const HALF: f64 = 0.5 * PI;

/// Solids of revolution against meshes of them, which are finer and finer and extrapolated.
#[test]
fn solids_are_what_their_meshes_converge_to() {
    // From the axis at the bottom to the axis at the top, with corners at multiples of a quarter.
    let cylinder: Profile =
        |t| corners(t, [[0.0, -1.0], [0.5, -1.0], [0.5, 0.0], [0.5, 1.0], [0.0, 1.0]]);
    let cone: Profile =
        |t| corners(t, [[0.0, 0.0], [0.6, 0.0], [0.4, 0.5], [0.2, 1.0], [0.0, 1.5]]);
    let frustum: Profile =
        |t| corners(t, [[0.0, 0.0], [0.4, 0.0], [0.55, 0.6], [0.7, 1.2], [0.0, 1.2]]);
    let sphere: Profile = |t| [0.8 * (PI * t).sin(), -0.8 * (PI * t).cos()];
    let half: Profile = |t| {
        if t < 0.25 {
            [3.2 * t, 0.0]
        } else {
            let a = HALF * (t - 0.25) / 0.75;
            [0.8 * a.cos(), 0.8 * a.sin()]
        }
    };
    let ellipsoid: Profile = |t| [0.8 * (PI * t).sin(), -1.1 * (PI * t).cos()];
    let cases: [(&str, Shape, Profile); 6] = [
        ("cylinder", Shape::cylinder(0.5, 2.0).unwrap(), cylinder),
        ("cone", Shape::cone(0.6, 1.5).unwrap(), cone),
        ("frustum", Shape::frustum(0.4, 0.7, 1.2).unwrap(), frustum),
        ("sphere", Shape::sphere(0.8).unwrap(), sphere),
        ("ellipsoid", Shape::ellipsoid([0.8, 0.8, 1.1]).unwrap(), ellipsoid),
        ("hemisphere", Shape::hemisphere(0.8).unwrap(), half),
    ];
    for (name, shape, profile) in cases {
        let mesh = |n: usize| {
            let points: Vec<[f64; 2]> = (1..n).map(|i| profile(i as f64 / n as f64)).collect();
            revolved(profile(0.0)[1], &points, profile(1.0)[1], n)
        };
        let [coarse, fine] = [48, 96].map(mesh);
        let exact = numbers(&shape.of_mass(1.0).unwrap());
        let (c, f) = (numbers(&coarse.of_mass(1.0).unwrap()), numbers(&fine.of_mass(1.0).unwrap()));
        for i in 0..9 {
            let extrapolated = f[i] + (f[i] - c[i]) / 3.0;
            assert!(
                (extrapolated - exact[i]).abs() < 2e-6,
                "{name} {i}: {extrapolated} {}",
                exact[i]
            );
            // Of second order: the finer mesh is four times as near.
            let (far, near) = ((c[i] - exact[i]).abs(), (f[i] - exact[i]).abs());
            assert!(far < 1e-6 || (3.8..4.2).contains(&(far / near)), "{name} {i}: {far} {near}");
        }
        let Measure::Volume(volume) = shape.measure() else { panic!("{name} is a solid") };
        let extrapolated = fine.volume_m3() + (fine.volume_m3() - coarse.volume_m3()) / 3.0;
        assert!((extrapolated / volume - 1.0).abs() < 1e-5, "{name}: {extrapolated} {volume}");
    }
}

fn corners(t: f64, points: [[f64; 2]; 5]) -> [f64; 2] {
    let i = ((4.0 * t) as usize).min(3);
    let s = 4.0 * t - i as f64;
    std::array::from_fn(|k| points[i][k] * (1.0 - s) + points[i + 1][k] * s)
}

/// Thin walls of revolution against clouds of points, weighted by area.
#[test]
fn shells_are_what_clouds_of_points_converge_to() {
    let cylinder: Profile = |t| [0.5, 2.0 * t - 1.0];
    let cone: Profile = |t| [0.6 * (1.0 - t), 1.5 * t];
    let frustum: Profile = |t| [0.4 + 0.3 * t, 1.2 * t];
    let sphere: Profile = |t| [0.8 * (PI * t).sin(), -0.8 * (PI * t).cos()];
    let half: Profile = |t| [0.8 * (HALF * t).cos(), 0.8 * (HALF * t).sin()];
    let disc: Profile = |t| [0.7 * t, 0.0];
    let cases: [(&str, Shape, Profile); 6] = [
        ("cylinder_shell", Shape::cylinder_shell(0.5, 2.0).unwrap(), cylinder),
        ("cone_shell", Shape::cone_shell(0.6, 1.5).unwrap(), cone),
        ("frustum_shell", Shape::frustum_shell(0.4, 0.7, 1.2).unwrap(), frustum),
        ("sphere_shell", Shape::sphere_shell(0.8).unwrap(), sphere),
        ("hemisphere_shell", Shape::hemisphere_shell(0.8).unwrap(), half),
        ("disc", Shape::disc(0.7).unwrap(), disc),
    ];
    for (name, shape, profile) in cases {
        let n = 2000;
        let mut points = Vec::new();
        for i in 0..n {
            let [a, b] = [profile(i as f64 / n as f64), profile((i + 1) as f64 / n as f64)];
            let [r, z] = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
            let area = 2.0 * PI * r * libm::hypot(b[0] - a[0], b[1] - a[1]);
            // Four points a quarter turn apart have the second moments of a hoop.
            for (x, y) in [(r, 0.0), (0.0, r), (-r, 0.0), (0.0, -r)] {
                points.push((0.25 * area, [x, y, z]));
            }
        }
        let cloud = MassProperties::from_points(points).unwrap();
        let Measure::Area(area) = shape.measure() else { panic!("{name} is thin") };
        assert!((cloud.mass_kg() / area - 1.0).abs() < 2e-6, "{name}: {} {area}", cloud.mass_kg());
        let exact = shape.of_density(1.0).unwrap();
        assert_near(&cloud, &exact, 2e-6, name);
    }
}

/// A torus against slices of it across its axis, which are tubes.
#[test]
fn a_torus_is_what_slices_converge_to() {
    let n = 2000;
    let height = 2.0 * 0.4 / f64::from(n);
    let slices = (0..n).map(|i| {
        let z = -0.4 + (f64::from(i) + 0.5) * height;
        let half = (0.16 - z * z).sqrt();
        let tube = Shape::tube(1.5 - half, 1.5 + half, height).unwrap();
        tube.of_density(1.0).unwrap().translated([0.0, 0.0, z]).unwrap()
    });
    let sum = MassProperties::combined(slices).unwrap();
    let exact = Shape::torus(1.5, 0.4).unwrap().of_density(1.0).unwrap();
    assert!((sum.mass_kg() / exact.mass_kg() - 1.0).abs() < 1e-5);
    assert_near(&sum.with_mass(1.0).unwrap(), &exact.with_mass(1.0).unwrap(), 1e-5, "torus");
}

/// Hollow bodies are differences, boxes are sums of plates, and walls are thin limits.
#[test]
fn shapes_agree_with_one_another() {
    let of = |shape: Result<Shape, ShapeError>| shape.unwrap().of_density(1.0).unwrap();
    let tube = of(Shape::cylinder(0.5, 2.0)).without(&of(Shape::cylinder(0.3, 2.0))).unwrap();
    assert_near(&of(Shape::tube(0.3, 0.5, 2.0)), &tube, 1e-14, "tube");
    let hollow = of(Shape::sphere(0.5)).without(&of(Shape::sphere(0.4))).unwrap();
    assert_near(&of(Shape::hollow_sphere(0.4, 0.5)), &hollow, 1e-15, "hollow sphere");
    assert!((of(Shape::hollow_sphere(0.4, 0.5)).mass_kg() - hollow.mass_kg()).abs() < 1e-15);
    let tip = of(Shape::cone(0.2, 0.5)).translated([0.0, 0.0, 1.0]).unwrap();
    let frustum = of(Shape::cone(0.6, 1.5)).without(&tip).unwrap();
    assert_near(&of(Shape::frustum(0.6, 0.2, 1.0)), &frustum, 1e-15, "frustum");

    let quarter = nalgebra::UnitQuaternion::from_axis_angle(&Vector3::y_axis(), HALF);
    let mut faces = Vec::new();
    for side in [-0.5, 0.5] {
        faces.push(of(Shape::plate([1.0, 2.0])).translated([0.0, 0.0, 3.0 * side]).unwrap());
        // Side 3 along axis 3, side 2 along axis 2: a plate turned about axis 2.
        let across = of(Shape::plate([3.0, 2.0])).rotated(&quarter).unwrap();
        faces.push(across.translated([side, 0.0, 0.0]).unwrap());
        let turn = nalgebra::UnitQuaternion::from_axis_angle(&Vector3::x_axis(), HALF);
        let across = of(Shape::plate([1.0, 3.0])).rotated(&turn).unwrap();
        faces.push(across.translated([0.0, 2.0 * side, 0.0]).unwrap());
    }
    let shell = MassProperties::combined(faces).unwrap();
    assert!((of(Shape::box_shell([1.0, 2.0, 3.0])).mass_kg() - shell.mass_kg()).abs() < 1e-14);
    assert_near(&of(Shape::box_shell([1.0, 2.0, 3.0])), &shell, 1e-13, "box shell");

    let of = |shape: Result<Shape, ShapeError>| shape.unwrap().of_mass(3.0).unwrap();
    let same = |a, b, name| assert_near(&of(a), &of(b), 1e-15, name);
    same(Shape::hollow_sphere(0.7, 0.7), Shape::sphere_shell(0.7), "thinnest wall");
    same(Shape::tube(0.7, 0.7, 2.0), Shape::cylinder_shell(0.7, 2.0), "thinnest tube");
    same(Shape::tube(0.0, 0.7, 2.0), Shape::cylinder(0.7, 2.0), "no hole");
    same(Shape::cylinder(0.7, 0.0), Shape::disc(0.7), "no height");
    same(Shape::cylinder(0.0, 2.0), Shape::rod(2.0), "no radius");
    same(Shape::solid_box([1.0, 2.0, 0.0]), Shape::plate([1.0, 2.0]), "a flat box");
    same(Shape::box_shell([1.0, 2.0, 0.0]), Shape::plate([1.0, 2.0]), "a flat box of faces");
    same(Shape::box_shell([0.0, 0.0, 2.0]), Shape::rod(2.0), "a box of faces without any");
    same(Shape::ellipsoid([0.7; 3]), Shape::sphere(0.7), "a round ellipsoid");
    same(Shape::frustum(0.6, 0.0, 1.5), Shape::cone(0.6, 1.5), "a pointed frustum");
    same(Shape::frustum_shell(0.6, 0.0, 1.5), Shape::cone_shell(0.6, 1.5), "a pointed wall");
}

/// Beer & Johnston, *Vector Mechanics for Engineers*, back cover; the torus and half spheres from
/// Meriam & Kraige, *Dynamics*, Table D/4.
#[test]
fn textbook_moments() {
    let moments = |shape: Result<Shape, ShapeError>| {
        let [a, b, c, ..] = shape.unwrap().of_mass(60.0).unwrap().inertia().entries();
        [a, b, c]
    };
    let cases = [
        (moments(Shape::solid_box([1.0, 2.0, 3.0])), [65.0, 50.0, 25.0]),
        (moments(Shape::cylinder(1.0, 2.0)), [35.0, 35.0, 30.0]),
        (moments(Shape::rod(2.0)), [20.0, 20.0, 0.0]),
        (moments(Shape::disc(1.0)), [15.0, 15.0, 30.0]),
        (moments(Shape::sphere(1.0)), [24.0; 3]),
        (moments(Shape::sphere_shell(1.0)), [40.0; 3]),
        (moments(Shape::ellipsoid([1.0, 2.0, 3.0])), [156.0, 120.0, 60.0]),
        // About the mass centre: 3/5 m h² + 3/20 m r² about the tip, less 9/16 m h².
        (moments(Shape::cone(1.0, 2.0)), [18.0, 18.0, 18.0]),
        (moments(Shape::hemisphere(1.0)), [83.0 / 320.0 * 60.0, 83.0 / 320.0 * 60.0, 24.0]),
        (moments(Shape::hemisphere_shell(1.0)), [25.0, 25.0, 40.0]),
        // m (R² + ¾ r²) and m (½ R² + ⅝ r²).
        (moments(Shape::torus(2.0, 1.0)), [157.5, 157.5, 285.0]),
        (moments(Shape::torus(2.0, 0.0)), [120.0, 120.0, 240.0]),
    ];
    for (i, (found, expected)) in cases.iter().enumerate() {
        for (a, b) in found.iter().zip(expected) {
            assert!((a - b).abs() < 2e-13, "{i}: {found:?} {expected:?}");
        }
    }
}

#[test]
fn bad_sizes_are_named() {
    for bad in [-1.0, f64::NAN, f64::INFINITY, 1e101, -f64::MIN_POSITIVE] {
        let error = Shape::cylinder(1.0, bad).unwrap_err();
        assert!(error.to_string().starts_with("height_m = "), "{error}");
        assert!(Shape::solid_box([1.0, bad, 1.0]).is_err() && Shape::ellipsoid([bad; 3]).is_err());
        assert!(Shape::frustum(bad, 1.0, 1.0).is_err() && Shape::tube(0.0, 1.0, bad).is_err());
        assert!(Shape::torus(1.0, bad).is_err() && Shape::rod(bad).is_err());
    }
    let error = Shape::tube(2.0, 1.0, 1.0).unwrap_err();
    assert_eq!(
        error.to_string(),
        "inner_radius_m = 2.0 m: it must be at most outer_radius_m = 1.0 m"
    );
    assert!(Shape::torus(1.0, 1.1).is_err());
    assert_eq!(Shape::frustum(0.0, 0.0, 1.0), Err(ShapeError::NoRadius));
    let flat = Shape::solid_box([1.0, 1.0, 0.0]).unwrap();
    assert!(flat.of_mass(1.0).is_ok());
    let error = flat.of_density(1.0).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the body has no volume, and a density gives it no mass: give the mass"
    );
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = Shape::disc(1.0).unwrap().of_density(bad).unwrap_err();
        assert!(error.to_string().contains("kg/m²"), "{error}");
        assert!(Shape::disc(1.0).unwrap().of_mass(bad).is_err());
    }
    let huge = Shape::sphere(1e100).unwrap();
    assert!(huge.of_density(1e10).is_err() && huge.of_mass(1e300).is_err());
}

proptest! {
    #[test]
    fn twice_as_large_is_four_times_the_inertia(
        [a, b, c] in prop::array::uniform3(0.01..10.0f64),
        scale in prop::num::f64::POSITIVE,
    ) {
        let scale = scale.clamp(1e-90, 1e90);
        let of = |f: f64| {
            let (small, large) = (f * a.min(b), f * a.max(b));
            [
                Shape::solid_box([f * a, f * b, f * c]),
                Shape::box_shell([f * a, f * b, f * c]),
                Shape::tube(small, large, f * c),
                Shape::hollow_sphere(small, large),
                Shape::frustum(f * a, f * b, f * c),
                Shape::frustum_shell(f * a, f * b, f * c),
                Shape::torus(large, small),
            ].map(|shape| shape.unwrap().of_mass(2.0).unwrap())
        };
        for (one, scaled) in of(1.0).iter().zip(of(scale)) {
            let back = scaled.inertia().matrix().map(|x| x / scale / scale);
            let size = one.inertia().matrix().amax();
            prop_assert!((back - one.inertia().matrix()).amax() < 1e-13 * size);
            let back = scaled.mass_centre_m() / scale;
            prop_assert!((back - one.mass_centre_m()).amax() < 1e-14 * (a + b + c));
        }
    }

    #[test]
    fn no_input_panics([a, b, c] in prop::array::uniform3(prop::num::f64::ANY), small in 0.0..1e-300f64) {
        for [a, b, c] in [[a, b, c], [a.abs(), b.abs(), c.abs()], [small, small * 0.5, small]] {
            let shapes = [
                Shape::solid_box([a, b, c]), Shape::box_shell([a, b, c]), Shape::plate([a, b]),
                Shape::rod(a), Shape::cylinder(a, b), Shape::tube(a, b, c),
                Shape::cylinder_shell(a, b), Shape::disc(a), Shape::sphere(a),
                Shape::hollow_sphere(a, b), Shape::sphere_shell(a), Shape::hemisphere(a),
                Shape::hemisphere_shell(a), Shape::ellipsoid([a, b, c]), Shape::cone(a, b),
                Shape::cone_shell(a, b), Shape::frustum(a, b, c), Shape::frustum_shell(a, b, c),
                Shape::torus(a, b),
            ];
            for shape in shapes.into_iter().flatten() {
                prop_assert!(shape.measure().value() >= 0.0);
                // Of sizes that have squares, there is a body of 1 kg.
                let body = shape.of_mass(1.0);
                let lost = matches!(body, Err(MassPropertiesError::Lost { .. }));
                let tiny = [a, b, c].into_iter().any(|x| 0.0 < x && x < 1e-150);
                prop_assert!(body.is_ok() || (lost && tiny), "{shape:?}");
                let _ = (shape.of_density(c), shape.of_density(1.0), shape.of_mass(c));
            }
        }
    }
}

#[cfg(feature = "serde")]
#[test]
fn serde_goes_through_the_constructor() {
    let json = r#"{"shape":"tube","inner_radius_m":0.5,"outer_radius_m":1.0,"height_m":2.0}"#;
    let tube: Shape = serde_json::from_str(json).unwrap();
    assert_eq!(tube, Shape::tube(0.5, 1.0, 2.0).unwrap());
    assert_eq!(serde_json::to_string(&tube).unwrap(), json);
    for (from, to) in [("0.5", "1.5"), ("tube", "cube"), ("height_m", "length_m"), ("2.0", "-2.0")]
    {
        assert!(serde_json::from_str::<Shape>(&json.replace(from, to)).is_err(), "{to}");
    }
    let extra = json.replace("}", r#","colour":1}"#);
    assert!(serde_json::from_str::<Shape>(&extra).is_err(), "deny_unknown_fields");
}
