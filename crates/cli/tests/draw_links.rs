//! What `gyradius draw` takes from the links of robots: defaults of a format, second inertias, geometry.

use gyradius_formats::RobotFile;
use gyradius_inertia::{Containment, Inertia, MassProperties, Region};
use nalgebra::Vector3;
use std::fs;

use crate::{
    draw_robots::{STATED, draw, refused, rows},
    scratch::Scratch,
};

/// What SDF leaves to its defaults is drawn in files as in the table, and both say so; a second inertia of a link is listed.
#[test]
fn defaults_and_second_inertias_are_told() {
    let shell = Scratch::new();
    let text = "<sdf version='1.9'><model name='m'><link name='a'><inertial><mass>2</mass></inertial></link>\n\
                <link name='b'><inertial><mass>2</mass><inertia><ixx>2</ixx><iyy>2</iyy><izz>2</izz></inertia></inertial>\
                <inertial/></link><link name='c'><inertial/></link></model></sdf>";
    fs::write(shell.path("a.sdf"), text).unwrap();
    let run = |more: &[&str]| {
        let output = shell.run(&[&["draw", "a.sdf", "-n", "3"], &STATED[..], more].concat());
        assert!(output.status.success(), "{output:?}");
        output
    };
    let table = run(&[]);
    let robots = run(&["-o", "robots"]);
    for told in [&table.stderr, &robots.stdout].map(|said| String::from_utf8_lossy(said)) {
        for line in [
            "note: a: the file does not state inertia: its draws are about the defaults of SDF, moments of inertia of 1 kg·m²",
            "note: c: the file does not state mass, inertia: its draws are about the defaults of SDF, a mass of 1 kg and moments \
             of inertia of 1 kg·m²",
            "left as it is: b: it is a second <inertial> of its link",
        ] {
            assert!(told.lines().any(|said| said.starts_with(line)), "{line}\n{told}");
        }
        assert!(!told.contains("note: b"), "{told}");
    }
    let drawn = rows(&table.stdout);
    assert_eq!(drawn.len(), 9);
    for number in 0..3 {
        let path = shell.path(&format!("robots/a-000{number}.sdf"));
        let robot = RobotFile::read(&path).unwrap();
        for link in robot.links().iter().filter(|link| link.numbers().is_ok()) {
            let found = link.numbers().unwrap();
            let row = drawn[&(link.name().to_owned(), number)];
            assert_eq!(found.mass_kg(), row[0]);
            assert_eq!(found.inertia().entries(), row[4..]);
            assert!(link.defaults().is_empty());
        }
    }
}

/// Within its own box, whatever is drawn; without it, some bodies have matter outside.
#[test]
fn matter_stays_inside_of_the_geometry() {
    let shell = Scratch::new();
    let solid = "<robot><link name='base'><inertial><origin xyz='0.1 0 0'/><mass value='2'/><inertia ixx='0.0108' \
                 ixy='0' ixz='0' iyy='0.0133' iyz='0' izz='0.0108'/></inertial><collision><origin xyz='0.1 0 0'/>\
                 <geometry><box size='0.3 0.2 0.3'/></geometry></collision></link></robot>";
    fs::write(shell.path("a.urdf"), solid).unwrap();
    let geoms = "<mujoco><default><geom type='box'/></default><worldbody><body name='base'><inertial pos='0.1 0 0' \
                 mass='2' diaginertia='0.0108 0.0133 0.0108'/><geom size='0.15 0.1 0.15' pos='0.1 0 0'/></body>\
                 </worldbody></mujoco>";
    fs::write(shell.path("a.xml"), geoms).unwrap();
    let stated = ["a.urdf", "-n", "300", "--mass", "10%", "--centre", "4cm", "--moments", "25%"];
    let region = Region::solid_box([0.1, 0.0, 0.0], [0.15, 0.1, 0.15]).unwrap();
    let outside = |table: &[u8]| {
        let is_out = |ten: &&[f64; 10]| {
            let [m, x, y, z, a, b, c, d, e, f] = **ten;
            let matrix = nalgebra::Matrix3::new(a, d, e, d, b, f, e, f, c);
            let inertia = Inertia::new(matrix).unwrap();
            let body = MassProperties::new(m, Vector3::new(x, y, z), inertia).unwrap();
            region.containment(&body) != Containment::Possible
        };
        rows(table).values().filter(is_out).count()
    };
    assert!(outside(&draw(&shell, &stated)) > 10);
    for inside in ["box", "mesh"] {
        let table = draw(&shell, &[&stated[..], &["--inside", inside]].concat());
        assert_eq!((rows(&table).len(), outside(&table)), (300, 0), "{inside}");
        // The same body in MJCF, of which a class says the shape.
        let of_geoms = draw(&shell, &[&["a.xml"], &stated[1..], &["--inside", inside]].concat());
        assert_eq!(table, of_geoms, "{inside}");
    }
    let table = draw(&shell, &[&stated[..], &["--inside", "ellipsoid"]].concat());
    assert_eq!(rows(&table).len(), 300);
    fs::write(shell.path("a.urdf"), solid.replace("0.3 0.2 0.3", "0.1 0.1 0.1")).unwrap();
    let message = refused(&shell, &[&stated[..], &["--inside", "box"]].concat());
    assert!(message.contains("its nominal numbers are not"), "{message}");
}

/// A plate is written a little thicker than nothing, for programs that compare exactly: in a mesh without thickness no draw is
/// possible, and the search for one never ended.
#[test]
fn no_plate_is_searched_for_in_a_flat_mesh() {
    let shell = Scratch::new();
    fs::write(shell.path("flat.obj"), "v 1 1 0\nv -1 1 0\nv -1 -1 0\nv 1 -1 0\n").unwrap();
    let plate = "<robot><link name='panel'><inertial><mass value='12'/><inertia ixx='1' ixy='0' ixz='0' iyy='1.5' iyz='0' \
                 izz='2.5'/></inertial><collision><geometry><mesh filename='flat.obj'/></geometry></collision></link></robot>";
    fs::write(shell.path("a.urdf"), plate).unwrap();
    let stated = ["a.urdf", "-n", "2", "--mass", "2%", "--moments", "2%", "--inside", "mesh"];
    let message = refused(&shell, &stated);
    assert!(message.contains("of 400 draws 0 are possible"), "{message}");
    assert!(message.contains("its nominal numbers are not"), "{message}");
    // In a thickness of a millimetre they are.
    let thick = |z: f64| format!("v 1 1 {z}\nv -1 1 {z}\nv -1 -1 {z}\nv 1 -1 {z}\n");
    fs::write(shell.path("flat.obj"), thick(5e-4) + &thick(-5e-4)).unwrap();
    assert_eq!(rows(&draw(&shell, &stated)).len(), 2);
}

/// Of each link every warning is told, not the first of its kind alone: here of three moments.
#[test]
fn no_warning_of_a_link_is_left_out() {
    let shell = Scratch::new();
    let link = |name: &str, [a, b, c]: [&str; 3]| {
        format!(
            "<link name='{name}'><inertial><mass value='1'/><inertia ixx='{a}' ixy='0' ixz='0' iyy='{b}' iyz='0' izz='{c}'/>\
             </inertial></link>"
        )
    };
    let [a, b] = [["0.01", "0.02", "0.025"], ["0.0101", "0.025", "0.02"]];
    let robot = format!("<robot name='a'>{}{}</robot>", link("a", a), link("b", b));
    fs::write(shell.path("a.urdf"), robot).unwrap();
    let output = shell.run(&["draw", "a.urdf", "-n", "2", "--moments", "25%", "--axes", "0deg"]);
    let told = String::from_utf8(output.stderr).unwrap();
    for entry in ["I11", "I22", "I33"] {
        let in_full = format!("warning: a: {entry}: its mean lies ");
        assert!(told.lines().any(|line| line.starts_with(&in_full)), "{told}");
    }
    let others = |line: &str| {
        line.starts_with("         also for b (I11 ")
            && line.contains("; I22 ")
            && line.contains("; I33 ")
    };
    assert!(told.lines().any(others), "{told}");
}

/// What a robot has of inertias where its format has none, and of two shapes where it has one.
#[test]
fn what_is_not_drawn_and_what_is_twice_is_told() {
    let shell = Scratch::new();
    let inertial = "<inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>";
    let shapes = "<box size='9 9 9'/><sphere radius='9'/>";
    let robot = |of_link: &str| {
        let link = format!(
            "<link name='a'>{of_link}<collision><geometry>{shapes}</geometry></collision></link>"
        );
        format!("<robot name='a'>\n{link}\n<sensor>{inertial}</sensor></robot>")
    };
    fs::write(shell.path("a.urdf"), robot(inertial)).unwrap();
    let stated = ["draw", "a.urdf", "-n", "2", "--mass", "5%"];
    let table = shell.run(&stated);
    let robots = shell.run(&[&stated[..], &["-o", "robots"]].concat());
    for told in [&table.stderr, &robots.stdout].map(|said| String::from_utf8_lossy(said)) {
        let line = "not drawn: a.urdf:3: 1 inertia stands where this format has none";
        assert!(told.lines().any(|said| said == line), "{told}");
    }
    let message = refused(&shell, &[&stated[1..], &["--inside", "box"]].concat());
    assert!(message.contains("holds a <box> and a <sphere>: there must be one shape"), "{message}");
    fs::write(shell.path("a.urdf"), robot("")).unwrap();
    let message = refused(&shell, &stated[1..]);
    assert!(message.contains("line 3: 1 inertia stands where this format has none"), "{message}");
}

/// The deviations that are told are those of two thousand draws at most, and it is said where there are more.
#[test]
fn deviations_of_the_first_draws_are_told_to_be_theirs() {
    let shell = Scratch::new();
    let text = "<robot name='m'><link name='a'><inertial><mass value='2'/><inertia ixx='2' iyy='2' izz='2' ixy='0' ixz='0' iyz='0'/>\
                </inertial></link></robot>";
    fs::write(shell.path("a.urdf"), text).unwrap();
    let told = ["2000", "2001", "5000"].map(|draws| {
        let output = shell.run(&[
            "draw",
            "a.urdf",
            "-n",
            draws,
            "--mass",
            "10%",
            "-o",
            "a.parquet",
            "--force",
        ]);
        let told = String::from_utf8_lossy(&output.stdout).into_owned();
        told.split_once("standard deviations of ").unwrap().1.to_owned()
    });
    assert!(told[0].starts_with("the draws\n"), "{}", told[0]);
    assert!(told[1].starts_with("the first 2000 draws\n"), "{}", told[1]);
    assert_eq!(told[1], told[2]);
}

/// A block for Gazebo, wherever it stands, changes neither what is drawn of a link nor which link a name means.
#[test]
fn blocks_for_gazebo_change_no_link() {
    let shell = Scratch::new();
    let link = |name: &str| {
        format!(
            "<link name='{name}'><inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='2' iyz='0' izz='2.5'/>\
             </inertial></link>"
        )
    };
    let inertial = "<inertial><mass>3</mass></inertial>";
    let blocks = [
        String::new(),
        format!("<gazebo reference='a'>{inertial}</gazebo>"),
        format!("<gazebo><link name='a'>{inertial}</link></gazebo>"),
        "<gazebo><link name='a'/></gazebo>".to_owned(),
    ];
    let mut first = None;
    for (i, block) in blocks.iter().enumerate() {
        for place in 0..3 {
            let mut parts = vec![link("a"), link("b")];
            parts.insert(place, block.clone());
            let name = format!("{i}-{place}.urdf");
            fs::write(shell.path(&name), format!("<robot name='r'>{}</robot>", parts.concat()))
                .unwrap();
            for picked in [&[][..], &["--links", "a"], &["--links", "a,b"]] {
                let drawn = shell.run(&[&["draw", &name, "-n", "3"], &STATED[..], picked].concat());
                let told = String::from_utf8(drawn.stderr).unwrap();
                assert!(drawn.status.success(), "{name} {picked:?}: {told}");
                let table = String::from_utf8(drawn.stdout).unwrap();
                let of_a: Vec<String> = table
                    .lines()
                    .filter(|line| line.starts_with("a,"))
                    .map(str::to_owned)
                    .collect();
                assert_eq!(of_a.len(), 3, "{table}");
                assert_eq!(first.get_or_insert(of_a.clone()), &of_a, "{name} {picked:?}");
                let listed = told.matches("left as it is: a:").count();
                assert_eq!(listed, usize::from(block.contains("inertial")), "{name}: {told}");
            }
        }
    }
    // Alone, it is no link.
    fs::write(shell.path("alone.urdf"), format!("<robot>{}{}</robot>", blocks[2], link("b")))
        .unwrap();
    let alone = ["alone.urdf", "-n", "1", "--mass", "5%", "--links", "a"];
    assert!(refused(&shell, &alone).contains("the links with inertia are b"));
}

/// A file without links that can be drawn, which includes others by any of the ways: they are named as `check` names them, whether there
/// are links without an inertia or not.
#[test]
fn files_that_only_include_others_name_them() {
    let shell = Scratch::new();
    let scene = |ways: &str, link: &str| {
        format!("<mujoco><asset/>{ways}<worldbody>{link}</worldbody></mujoco>")
    };
    let world = |ways: &str, link: &str| {
        format!(
            "<sdf version='1.9'><world name='w'>{ways}<model name='m'>{link}</model></world></sdf>"
        )
    };
    let uri = |name: &str| format!("<include><uri>model://{name}</uri></include>");
    let include = |name: &str| format!("<include file='{name}'/>");
    for link in [false, true] {
        let [body, of_model] =
            ["<body name='floor'/>", "<link name='floor'/>"].map(|of| if link { of } else { "" });
        for count in 1..4 {
            let names: Vec<String> = (0..count).map(|i| format!("arm{i}.xml")).collect();
            let all = |way: &dyn Fn(&str) -> String| {
                names.iter().map(|name| way(name)).collect::<Vec<_>>().join("\n")
            };
            for (file, text) in [
                ("scene.xml", scene(&all(&include), body)),
                ("world.sdf", world(&all(&uri), of_model)),
            ] {
                fs::write(shell.path(file), text).unwrap();
                let output = shell.run(&["draw", file, "-n", "1", "--mass", "5%"]);
                let message = String::from_utf8(output.stderr).unwrap();
                let told = if count == 1 {
                    "1 included file is".to_owned()
                } else {
                    format!("{count} included files are")
                };
                let told = format!("{told} not followed: ");
                let found = message.find(&told).map(|at| &message[at..]);
                assert!(
                    output.status.code() == Some(2) && message.contains("line 1: "),
                    "{message}"
                );
                assert!(
                    found.is_some_and(|found| found.contains("arm0.xml; what is")
                        || found.contains("arm0.xml and others; what is")),
                    "{message}"
                );
                let check = shell.run(&["check", file]);
                let all = String::from_utf8([check.stdout, check.stderr].concat()).unwrap();
                assert!(all.contains(&told), "{all}");
            }
        }
    }
}
