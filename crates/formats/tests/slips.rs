//! Slips in files: numbers that are broken or malformed, masses that are none, matrices that are not symmetric.

use gyradius_formats::{InertiaFile, Products, Remedy, RepairError, RobotFile};
use std::path::Path;

fn parse(name: &str, text: &str) -> InertiaFile {
    InertiaFile::parse(Path::new(name), text.as_bytes().to_vec(), Products::TensorEntries).unwrap()
}

/// All of what stands there was not quoted: `1<!-- a -->.9` was called "1", and a reference nothing.
#[test]
fn a_number_that_is_broken_is_quoted_as_it_is_written() {
    for content in [
        "1<!-- a -->.9",
        "1.<!-- a --><!-- b -->9",
        "&#51;",
        "1&#46;9",
        "&#49;.9",
        "1<b/>.9",
        "1<![CDATA[.9]]>",
        "1&amp;9",
    ] {
        for (before, after) in [("", ""), (" ", "\n"), ("", " ")] {
            let text = format!(
                "<sdf version='1.9'><model name='m'><link name='a'><inertial><mass>1</mass><inertia><ixx>1</ixx>\
                 <iyy>1</iyy><izz>{before}{content}{after}</izz ></inertia></inertial></link></model></sdf>"
            );
            let error = parse("a.sdf", &text).bodies()[0].inertia().unwrap_err().to_string();
            let expected = format!("izz = \"{content}\" is not a plain number: ");
            assert!(error.starts_with(&expected), "{error}");
        }
    }
}

/// A matrix that is possible but for rounding across the diagonal: the entries on it moved by 6e-9.
#[test]
fn a_repair_of_a_matrix_that_is_not_symmetric_moves_nothing_else() {
    for diagonal in [[1.0, 2.0, 2.5], [0.31, 0.42, 0.55], [1e-7, 1.5e-7, 1.2e-7]] {
        for asymmetric in 1..8_u8 {
            let [a, b, c] = diagonal;
            let off = |bit: u8| if asymmetric >> bit & 1 == 1 { 0.02 * a } else { 0.0 };
            let [x, y, z] = [0.05 * a, -0.03 * a, 0.0];
            let matrix = [[a, x, y], [x + off(0), b, z], [y + off(1), z + off(2), c]];
            let text = format!("{{\"bodies\": [{{\"inertia_kg_m2\": {matrix:?}}}]}}");
            let file = parse("a.json", &text);
            let change = file.change(0, Remedy::Nearest).unwrap().unwrap();
            let copy = file.repaired(&[(0, Remedy::Nearest)]).unwrap();
            let copy = parse("a.json", std::str::from_utf8(&copy).unwrap());
            let after = copy.bodies()[0].inertia().unwrap();
            for i in 0..3 {
                assert_eq!(after[(i, i)], diagonal[i], "{text}");
                for j in 0..3 {
                    let mean = 0.5 * (matrix[i][j] + matrix[j][i]);
                    assert!((after[(i, j)] - mean).abs() <= 1e-15 * c, "{text} {after}");
                    assert_eq!(change.after()[(i, j)], after[(i, j)]);
                }
            }
        }
    }
}

/// Whatever is wrong with the inertia on it, nothing is written of a body whose mass is none.
#[test]
fn inertia_on_no_mass_is_not_repaired() {
    for (mass, why) in [
        ("0", "inertia on a mass of 0 kg"),
        ("-0.0", "inertia on a mass of 0 kg"),
        ("-2", "mass = -2 kg"),
    ] {
        for izz in ["3", "-1"] {
            let text = format!(
                "<robot name='r'>\n<link name='a'><inertial><mass value='{mass}'/><inertia ixx='1' ixy='0' ixz='0' \
                 iyy='1' iyz='0' izz='{izz}'/></inertial></link></robot>"
            );
            let file = parse("a.urdf", &text);
            for remedy in [Remedy::Nearest, Remedy::FlipProducts] {
                let error = file.change(0, remedy).unwrap_err();
                let message = error.to_string();
                assert!(message.starts_with(&format!("line 2: \"a\": {why}")), "{message}");
                assert!(matches!(error, RepairError::NoMass { .. }) && error.line() == Some(2));
                assert!(file.repaired(&[(0, remedy)]).is_err());
            }
            let heavy = text.replace(&format!("'{mass}'"), "'2'");
            assert!(parse("a.urdf", &heavy).change(0, Remedy::Nearest).is_ok());
        }
    }
}

fn problem(name: &str, text: &str) -> (String, bool) {
    let robot = RobotFile::parse(Path::new(name), text.into()).unwrap();
    let problem = robot.links()[0].numbers().unwrap_err();
    (problem.to_string(), problem.is_a_slip())
}

/// What is there and is malformed is a slip, in every format and of every field; what is not there is none.
#[test]
fn malformed_numbers_of_links_are_all_slips() {
    let urdf = "<robot name='r'><link name='a'><inertial><origin xyz='0 0 0' rpy='0 0 0'/><mass value='1'/><inertia \
                ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link></robot>";
    let sdf = "<sdf version='1.9'><model name='m'><link name='a'><inertial><pose>0 0 0 0 0 0</pose><mass>1</mass>\
               <inertia><ixx>1</ixx></inertia></inertial></link></model></sdf>";
    let mjcf = "<mujoco><worldbody><body name='a'><inertial pos='0 0 0' quat='1 0 0 0' mass='1' \
                diaginertia='1 1 1'/></body></worldbody></mujoco>";
    let malformed = |numbers: &str| {
        let words: Vec<&str> = numbers.split(' ').collect();
        let fewer = words[..words.len() - 1].join(" ");
        [
            fewer,
            format!("{numbers} 0"),
            numbers.replacen(words[0], "nan", 1),
            format!("x {numbers}"),
        ]
    };
    for (name, text, fields) in [
        (
            "a.urdf",
            urdf,
            &[("xyz='", "0 0 0"), ("rpy='", "0 0 0"), ("value='", "1"), ("ixx='", "1")][..],
        ),
        ("a.sdf", sdf, &[("pose>", "0 0 0 0 0 0"), ("mass>", "1"), ("ixx>", "1")]),
        (
            "a.xml",
            mjcf,
            &[
                ("pos='", "0 0 0"),
                ("quat='", "1 0 0 0"),
                ("mass='", "1"),
                ("diaginertia='", "1 1 1"),
            ],
        ),
    ] {
        for (field, numbers) in fields {
            for wrong in malformed(numbers).into_iter().filter(|wrong| !wrong.is_empty()) {
                let text =
                    text.replacen(&format!("{field}{numbers}"), &format!("{field}{wrong}"), 1);
                let (message, is_slip) = problem(name, &text);
                assert!(is_slip, "{text}: {message}");
            }
        }
    }
    let (message, is_slip) = problem("a.xml", &mjcf.replace("quat=", "euler='0 0 0' quat="));
    assert!(is_slip && message.starts_with("both quat and euler are given"), "{message}");
    for (without, text) in [("<mass value='1'/>", urdf), ("mass='1'", mjcf)] {
        let name = if text == urdf { "a.urdf" } else { "a.xml" };
        let (message, is_slip) = problem(name, &text.replace(without, ""));
        assert!(!is_slip && message == "mass is missing", "{message}");
    }
}

/// A compiler that says what is no unit was said to be in another file.
#[test]
fn a_unit_of_angles_that_is_none_is_named() {
    let with = |compiler: &str| {
        format!(
            "<mujoco>{compiler}<worldbody><body name='a'><inertial pos='0 0 0' euler='0 0 1' mass='1' \
             diaginertia='1 1 1'/></body></worldbody></mujoco>"
        )
    };
    for word in ["foo", "", "Degree", "radians"] {
        let (message, is_slip) = problem("a.xml", &with(&format!("<compiler angle='{word}'/>")));
        let expected = format!("the compiler has angle=\"{word}\": it must be degree or radian");
        assert!(is_slip && message.contains(&expected), "{message}");
    }
    let (message, is_slip) = problem("a.xml", &with("<include file='b.xml'/>"));
    assert!(!is_slip && message.contains("may be said in another file"), "{message}");
}

fn sdf(version: &str, inertial: &str) -> String {
    format!(
        "<sdf{version}><model name='m'><link name='a'><inertial{inertial}<inertia><ixx>1</ixx><iyy>2</iyy><izz>2.5</izz>\
         <ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial></link></model></sdf>"
    )
}

/// `True` was false, and a pose in degrees one in radians.
#[test]
fn truth_values_of_sdf_are_read_in_letters_of_any_size_and_no_others_are() {
    for (word, truth) in [
        ("true", Some(true)),
        ("True", Some(true)),
        ("TRUE", Some(true)),
        (" tRuE ", Some(true)),
        ("1", Some(true)),
        ("false", Some(false)),
        ("False", Some(false)),
        ("0", Some(false)),
        ("yes", None),
        ("t", None),
        ("", None),
        ("2", None),
    ] {
        let pose = format!("><mass>2</mass><pose degrees='{word}'>1 2 3 0 0 90</pose>");
        let robot =
            RobotFile::parse(Path::new("a.sdf"), sdf(" version='1.9'", &pose).into()).unwrap();
        match (robot.links()[0].numbers(), truth) {
            (Ok(numbers), Some(truth)) => {
                let turned: f64 = if truth { 90_f64.to_radians() } else { 90.0 };
                let expected = turned.cos().powi(2) + 2.0 * turned.sin().powi(2);
                assert!((numbers.inertia().entries()[0] - expected).abs() < 1e-12, "{word}");
            }
            (Err(problem), None) => {
                let expected = format!("degrees = \"{word}\": it must be true or false");
                assert!(problem.is_a_slip() && problem.to_string() == expected, "{problem}");
            }
            (found, _) => panic!("{word}: {found:?}"),
        }
        let file =
            parse("a.sdf", &sdf(" version='1.9'", &format!(" auto='{word}'><mass>2</mass>")));
        match truth {
            Some(true) => assert!(file.bodies().is_empty() && file.gaps().len() == 1, "{word}"),
            Some(false) => assert!(file.bodies()[0].inertia().is_ok(), "{word}"),
            None => {
                let error = file.bodies()[0].inertia().unwrap_err().to_string();
                assert_eq!(error, "auto: there must be true or false in it", "{word}");
            }
        }
    }
}

/// Checked with the SDFormat of Drake 1.51.1, which refuses degrees of a quaternion, of an empty pose too.
#[test]
fn degrees_of_a_quaternion_are_refused() {
    for (degrees, is_true) in
        [("", false), (" degrees='true'", true), (" degrees='1'", true), (" degrees='0'", false)]
    {
        for (form, four, is_quaternion) in [
            ("", "0 0 0", false),
            (" rotation_format='euler_rpy'", "0 0 0", false),
            (" rotation_format='quat_xyzw'", "0 0 0.6 0.8", true),
        ] {
            for inside in [format!("1 2 3 {four}"), String::new()] {
                let pose = format!("><mass>2</mass><pose{degrees}{form}>{inside}</pose>");
                let text = sdf(" version='1.9'", &pose);
                let robot = RobotFile::parse(Path::new("a.sdf"), text.clone().into()).unwrap();
                let found = robot.links()[0].numbers().err().map(ToString::to_string);
                let expected = (is_true && is_quaternion).then(|| {
                    "both degrees=\"true\" and rotation_format=\"quat_xyzw\" are given: there must be one of them".to_owned()
                });
                assert_eq!(found, expected, "{text}");
            }
        }
    }
}

#[test]
fn a_form_of_rotations_that_sdf_does_not_know_is_refused() {
    for (form, numbers) in [
        ("euler_rpy", "0 0 1"),
        ("quat_xyzw", "0 0 0 1"),
        ("quat", "0 0 1"),
        ("quat", "0 0 0 1"),
        ("Euler_rpy", "0 0 1"),
        ("", "0 0 1"),
    ] {
        let pose = format!("><pose rotation_format='{form}'>1 2 3 {numbers}</pose>");
        let robot =
            RobotFile::parse(Path::new("a.sdf"), sdf(" version='1.9'", &pose).into()).unwrap();
        let found = robot.links()[0].numbers();
        if ["euler_rpy", "quat_xyzw"].contains(&form) {
            assert!(found.is_ok(), "{form}");
        } else {
            let problem = found.unwrap_err();
            let expected =
                format!("rotation_format = \"{form}\": it must be euler_rpy or quat_xyzw");
            assert!(problem.is_a_slip() && problem.to_string() == expected, "{problem}");
        }
    }
}

/// Readers of later versions take no notice of it.
#[test]
fn an_origin_is_a_pose_in_the_first_version_of_sdf_alone() {
    for version in ["", " version='1.0'", " version='1.2'", " version='1.5'", " version='1.9'"] {
        let text = sdf(version, "><origin pose='1 2 3 0 0 0'/>");
        let robot = RobotFile::parse(Path::new("a.sdf"), text.into()).unwrap();
        match robot.links()[0].numbers() {
            Ok(numbers) => {
                assert_eq!(numbers.mass_centre_m().as_slice(), [1.0, 2.0, 3.0]);
                assert!(["", " version='1.0'"].contains(&version), "{version}");
            }
            Err(problem) => {
                let message = problem.to_string();
                assert!(
                    problem.is_a_slip() && message.starts_with("pose of origin is"),
                    "{message}"
                );
                assert!(!["", " version='1.0'"].contains(&version), "{version}");
            }
        }
    }
}

/// Of 33 hexadecimal digits on, an integer was 0.
#[test]
fn an_integer_that_is_too_long_is_refused() {
    let body = |mass: &str, entry: &str| {
        let text = format!(
            "[a]\nmass_kg = {mass}\ninertia_kg_m2 = [[{entry}, 0, 0], [0, 1, 0], [0, 0, 1]]\n"
        );
        parse("a.toml", &text).bodies()[0].clone()
    };
    for (prefix, base, digit) in [("0x", 16_f64, "1"), ("0o", 8.0, "1"), ("0b", 2.0, "1")] {
        for zeros in [0, 1, 7, 20, 31, 32, 40, 60, 130, 300] {
            let written = format!("{prefix}{digit}{}", "0".repeat(zeros));
            let expected = base.powi(i32::try_from(zeros).unwrap());
            let fits = expected < 2_f64.powi(127);
            for (body, field) in
                [(body(&written, "1"), "mass_kg"), (body("1", &written), "inertia_kg_m2")]
            {
                match body.inertia() {
                    Ok(inertia) => {
                        assert!(fits, "{written}");
                        let found = if field == "mass_kg" {
                            body.mass_kg().unwrap()
                        } else {
                            inertia[(0, 0)]
                        };
                        assert_eq!(found, expected, "{written}");
                    }
                    Err(error) => {
                        let error = error.to_string();
                        assert!(
                            !fits && error.starts_with(&format!("{field} = \"{prefix}1")),
                            "{error}"
                        );
                        assert!(error.ends_with("it must have decimal digits"), "{error}");
                    }
                }
            }
        }
    }
    assert_eq!(body("0xf_f", "1").mass_kg(), Some(255.0));
}
