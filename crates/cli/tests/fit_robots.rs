//! Samples in robot files: links whose inertias stand in frames of their own.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use serde_json::Value;
use std::{fmt::Write, fs};

use crate::scratch::Scratch;

/// The same bodies as a table and as links, whose frames are turned.
struct Bodies {
    table: String,
    urdf: String,
    mjcf: String,
    sdf: String,
}

impl Bodies {
    /// Sixty bodies that scatter in everything, by fixed irrational steps.
    fn new() -> Self {
        let mut all = Self {
            table: "name,mass,cx,cy,cz,ixx,iyy,izz,ixy,ixz,iyz\n".to_owned(),
            urdf: String::new(),
            mjcf: String::new(),
            sdf: String::new(),
        };
        for i in 0..60 {
            // Between −1 and 1, as even as a sequence is.
            let step = |k: u32| {
                let place = f64::from(i + 1) * f64::from(k).sqrt();
                2.0 * (place - place.floor()) - 1.0
            };
            let mass = 2.0 + 0.1 * step(2);
            let c = Vector3::new(0.1 + 0.01 * step(3), 0.02 * step(5), -0.2 + 0.01 * step(6));
            let k =
                [1.0 + 0.05 * step(7), 1.4 + 0.05 * step(8), 1.7 + 0.05 * step(10)].map(|k| k * k);
            let moments = Vector3::new(k[1] + k[2], k[0] + k[2], k[0] + k[1]);
            let q =
                UnitQuaternion::from_scaled_axis(0.2 * Vector3::new(step(11), step(12), step(13)));
            let matrix = q.to_rotation_matrix().into_inner();
            let inertia = matrix * Matrix3::from_diagonal(&moments) * matrix.transpose();
            let entry = |(a, b)| inertia[(a, b)];
            let six = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].map(entry);
            let six = six.map(|x| format!("{x:?}")).join(",");
            let [x, y, z] = [c.x, c.y, c.z];
            let [a, b, d] = [moments.x, moments.y, moments.z];
            writeln!(all.table, "b{i},{mass:?},{x:?},{y:?},{z:?},{six}").unwrap();
            let (roll, pitch, yaw) = q.euler_angles();
            writeln!(
                all.urdf,
                "<link name=\"b{i}\"><inertial><origin xyz=\"{x:?} {y:?} {z:?}\" rpy=\"{roll:?} {pitch:?} {yaw:?}\"/><mass value=\"{mass:?}\"/>\
                 <inertia ixx=\"{a:?}\" iyy=\"{b:?}\" izz=\"{d:?}\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>"
            )
            .unwrap();
            let [w, i1, j1, k1] = [q.w, q.i, q.j, q.k];
            writeln!(
                all.mjcf,
                "<body name=\"b{i}\"><inertial mass=\"{mass:?}\" pos=\"{x:?} {y:?} {z:?}\" quat=\"{w:?} {i1:?} {j1:?} {k1:?}\" \
                 diaginertia=\"{a:?} {b:?} {d:?}\"/></body>"
            )
            .unwrap();
            writeln!(
                all.sdf,
                "<link name=\"b{i}\"><inertial><mass>{mass:?}</mass><pose>{x:?} {y:?} {z:?} {roll:?} {pitch:?} {yaw:?}</pose>\
                 <inertia><ixx>{a:?}</ixx><iyy>{b:?}</iyy><izz>{d:?}</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial></link>"
            )
            .unwrap();
        }
        all
    }
}

/// All numbers of a document, by their paths.
fn numbers(value: &Value, path: &str, found: &mut Vec<(String, f64)>) {
    match value {
        Value::Number(x) => found.push((path.to_owned(), x.as_f64().unwrap())),
        Value::Array(all) => {
            all.iter()
                .enumerate()
                .for_each(|(i, one)| numbers(one, &format!("{path}[{i}]"), found));
        }
        Value::Object(all) => {
            all.iter().for_each(|(key, one)| numbers(one, &format!("{path}.{key}"), found));
        }
        Value::Null | Value::Bool(_) | Value::String(_) => {}
    }
}

/// A law is fitted to the bodies in the axes of their links, with mass and mass centre, whatever frames their inertias stand in.
#[test]
fn links_are_samples_in_their_own_axes() {
    let bodies = Bodies::new();
    let scratch = Scratch::new();
    let fitted = |name: &str, text: &str| {
        fs::write(scratch.path(name), text).unwrap();
        let output = scratch.run(&["fit", name, "--format", "json"]);
        let document: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(document["samples"], 60, "{name}");
        assert!(document["joint"].is_object(), "{name}");
        document
    };
    let expected = fitted("b.csv", &bodies.table);
    assert!(expected["roots"][0]["deviation_sqrt_kg_m"].as_f64().unwrap() > 0.02);
    let urdf = |links: &str| format!("<robot name=\"r\">{links}</robot>");
    let mjcf = |links: &str| format!("<mujoco><worldbody>{links}</worldbody></mujoco>");
    let sdf = |links: &str| format!("<sdf version=\"1.9\"><model name=\"m\">{links}</model></sdf>");
    for (name, text) in
        [("b.urdf", urdf(&bodies.urdf)), ("b.xml", mjcf(&bodies.mjcf)), ("b.sdf", sdf(&bodies.sdf))]
    {
        let found = fitted(name, &text);
        assert_eq!(found["unread"].as_array().unwrap().len(), 0, "{name}: {}", found["unread"]);
        let (mut wanted, mut given) = (Vec::new(), Vec::new());
        for key in ["roots", "axes", "nominal_inertia_kg_m2", "entry_deviation_kg_m2", "joint"] {
            let before = wanted.len();
            numbers(&expected[key], key, &mut wanted);
            numbers(&found[key], key, &mut given);
            assert!(wanted.len() > before, "{key}");
        }
        assert_eq!(wanted.len(), given.len(), "{name}");
        for ((path, a), (_, b)) in wanted.iter().zip(&given) {
            // Probabilities are found by simulation, of which rounding may turn a few.
            let close = if path.ends_with("p_value") || path.ends_with(".p") { 0.02 } else { 1e-6 };
            assert!((a - b).abs() <= close * a.abs().max(1.0), "{name}: {path}: {a} {b}");
        }
    }
    // What is no link's own is no sample, and is named.
    let block = "<gazebo reference=\"b0\"><inertial><mass value=\"1\"/><inertia ixx=\"9\" iyy=\"9\" izz=\"9\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/>\
                 </inertial></gazebo><link name=\"empty\"/>";
    let found = fitted("g.urdf", &urdf(&(bodies.urdf.clone() + block)));
    let unread = found["unread"].to_string();
    assert!(unread.contains("Gazebo") && unread.contains("empty"), "{unread}");
    let computed = format!(
        "<mujoco><compiler inertiafromgeom=\"true\"/><worldbody>{}</worldbody></mujoco>",
        bodies.mjcf
    );
    let unread = fitted("c.xml", &computed)["unread"].to_string();
    assert!(unread.contains("inertiafromgeom"), "{unread}");
    fs::write(scratch.path("l.urdf"), urdf(&bodies.urdf)).unwrap();
    let refused = scratch.run(&["fit", "l.urdf", "--parameters", "linear"]);
    assert_eq!(refused.status.code(), Some(2));
}

/// Where too few links are left for a fit, the error says of each why it was left out.
#[test]
fn links_that_are_left_out_are_told_where_the_rest_are_too_few() {
    let bodies = Bodies::new();
    let scratch = Scratch::new();
    for kept in [0, 1, 3] {
        for left_out in [1, 4, 30] {
            // A pose that stands in the frame of something else, or no inertia at all.
            let moved = |line: &str| line.replace("<pose>", "<pose relative_to=\"elsewhere\">");
            let empty = |line: &str| {
                let (start, _) = line.split_once("<inertial").unwrap();
                format!("{start}</{}>", &start[1..5])
            };
            let of = |links: &str, change: &dyn Fn(&str) -> String| {
                let change = |(i, line)| if i < kept { str::to_owned(line) } else { change(line) };
                links.lines().take(kept + left_out).enumerate().map(change).collect::<String>()
            };
            let model = |links: &str| {
                format!("<sdf version=\"1.9\"><model name=\"m\">{links}</model></sdf>")
            };
            for (name, text) in [
                ("moved.sdf", model(&of(&bodies.sdf, &moved))),
                ("empty.urdf", format!("<robot name=\"r\">{}</robot>", of(&bodies.urdf, &empty))),
                (
                    "empty.xml",
                    format!("<mujoco><worldbody>{}</worldbody></mujoco>", of(&bodies.mjcf, &empty)),
                ),
            ] {
                fs::write(scratch.path(name), text).unwrap();
                let output = scratch.run(&["fit", name]);
                let message = String::from_utf8(output.stderr).unwrap();
                assert_eq!(output.status.code(), Some(2), "{name}: {message}");
                let told = |i: usize| message.contains(&format!(" b{}: ", kept + i));
                assert!(
                    message.contains(&format!("the number of samples is {kept}: ")),
                    "{message}"
                );
                assert!((0..left_out.min(10)).all(told), "{name}: {message}");
                let more = format!("and {} more", left_out.saturating_sub(10));
                assert_eq!(message.contains(&more), left_out > 10, "{name}: {message}");
            }
        }
    }
}

/// What is wrong in one link, which nobody means, is refused by `fit` as it is by `draw`; what is said in another way is left out by both.
#[test]
fn slips_in_links_are_refused_as_draw_refuses_them() {
    let bodies = Bodies::new();
    let scratch = Scratch::new();
    let sdf = format!("<sdf version=\"1.9\"><model name=\"m\">{}</model></sdf>", bodies.sdf);
    let urdf = format!("<robot name=\"r\">{}</robot>", bodies.urdf);
    let mjcf = format!("<mujoco><worldbody>{}</worldbody></mujoco>", bodies.mjcf);
    let mut refused = 0;
    for (name, text, from, to) in [
        ("a.sdf", &sdf, "<pose>", "<pose rotation_format=\"quat\">"),
        ("b.sdf", &sdf, "<pose>", "<pose rotation_format=\"quaternion\">"),
        ("c.sdf", &sdf, "<pose>", "<pose degrees=\"yes\">"),
        ("d.sdf", &sdf, "<pose>", "<pose degrees=\"false\">"),
        ("e.sdf", &sdf, "<pose>", "<pose relative_to=\"elsewhere\">"),
        ("f.sdf", &sdf, "<pose>", "<pose>1 2 3</pose><pose>"),
        ("g.urdf", &urdf, "rpy=\"", "rpy=\"1 "),
        ("h.urdf", &urdf, "xyz=\"", "xyz=\"nan "),
        ("i.urdf", &urdf, " rpy=", " quat_xyzw=\"0 0 0 1\" rpy="),
        ("j.xml", &mjcf, "quat=\"", "quat=\"1 "),
        ("k.xml", &mjcf, "quat=", "euler=\"0 0 0\" quat="),
        ("l.xml", &mjcf, "diaginertia=", "fullinertia=\"1 1 1 0 0 0\" diaginertia="),
        ("m.xml", &mjcf, "pos=\"", "pos=\"x "),
    ] {
        let wrong = text.replacen(from, to, 1);
        assert_ne!(&wrong, text);
        fs::write(scratch.path(name), wrong).unwrap();
        let draw = ["draw", name, "-n", "1", "--mass", "1%", "-o", "drawn.csv", "--force"];
        let codes = [&["fit", name][..], &draw].map(|said| scratch.run(said).status.code());
        let [fit, draw] = codes.map(|code| code == Some(2));
        assert_eq!(fit, draw, "{name}: {to}");
        refused += usize::from(fit);
    }
    assert!((5..13).contains(&refused), "{refused}");
}
