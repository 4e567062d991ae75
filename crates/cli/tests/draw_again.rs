//! `gyradius draw` of robots into a folder that holds some already: of other options, and the input itself.

use gyradius_formats::RobotFile;
use gyradius_inertia::Inertia;
use std::fs;

use crate::draw_robots::{draw, refused};
use crate::scratch::{Scratch, files};

/// Robots of which the file leaves as much as it can to the defaults, and such as say all of it: name and text.
const ROBOTS: [(&str, &str); 6] = [
    (
        "a.urdf",
        "<robot name='r'><link name='a'><inertial><!-- of 2 kg --><mass value='2'/><inertia ixx='.02' ixy='0' \
         ixz='0' iyy='.03' iyz='0' izz='.04'/></inertial></link></robot>",
    ),
    (
        "b.urdf",
        "<robot name='r'><link name='a'><inertial><origin xyz='0 .1 0' rpy='.1 .2 .3'/><mass value='2'/><inertia \
         ixx='.02' ixy='.001' ixz='0' iyy='.03' iyz='0' izz='.04'/></inertial></link><link name='b'/></robot>",
    ),
    (
        "c.xml",
        "<mujoco><worldbody><body name='a'><inertial pos='0 0 .1' mass='2' diaginertia='.02 .03 .04'/></body>\
         </worldbody></mujoco>",
    ),
    (
        "d.xml",
        "<mujoco><worldbody><body name='a'><inertial pos='0 0 0' euler='10 20 30' mass='2' diaginertia='.02 .03 .04'/>\
         </body></worldbody></mujoco>",
    ),
    (
        "e.sdf",
        "<sdf version='1.9'><model name='m'><link name='a'><inertial/></link><link name='b'><inertial><inertia>\
         <ixx>.9</ixx><iyz>.01</iyz></inertia></inertial></link></model></sdf>",
    ),
    (
        "f.sdf",
        "<sdf version='1.9'><model name='m'><link name='a'><inertial><pose>0 0 .1 0 0 1</pose><mass>2</mass><inertia>\
         <ixx>.02</ixx><iyy>.03</iyy><izz>.04</izz></inertia></inertial></link></model></sdf>",
    ),
];

const STATED: [&[&str]; 5] = [
    &["--mass", "10%"],
    &["--mass", "10%", "--centre", "5mm"],
    &["--moments", "5%"],
    &["--axes", "5deg"],
    &["--mass", "1%", "--centre", "1mm", "--moments", "5%", "--axes", "1deg"],
];

/// Robots of a draw with fewer or more options were called another robot, for elements come and go.
#[test]
fn robots_of_any_other_draw_are_replaced_by_force() {
    for (name, text) in ROBOTS {
        let shell = Scratch::new();
        fs::write(shell.path(name), text).unwrap();
        let with = |stated: &[&str], out: &str, force: bool| {
            let force: &[&str] = if force { &["--force"] } else { &[] };
            let all = [&[name, "-n", "2", "-o", out], stated, force].concat();
            draw(&shell, &all);
            files(&shell.path(out))
        };
        for (i, first) in STATED.iter().enumerate() {
            for (j, second) in STATED.iter().enumerate() {
                let (fresh, out) = (format!("fresh{j}"), format!("out{i}{j}"));
                let expected = with(second, &fresh, false);
                with(first, &out, false);
                assert_eq!(with(second, &out, true), expected, "{name} {first:?} {second:?}");
            }
        }
        // What somebody has changed beside the numbers, a comment too, is not replaced.
        let first = fs::read_dir(shell.path("fresh0")).unwrap().next().unwrap().unwrap().path();
        let drawn = fs::read_to_string(&first).unwrap();
        for own in [
            drawn.replace("name='a'", "name='mine'"),
            drawn.replacen("<inertial", "<!-- mine --><inertial", 1),
            drawn.replace("of 2 kg", "of some kg"),
            drawn.replace("</inertial>", "<!-- mine --></inertial>"),
        ] {
            if own == drawn {
                continue;
            }
            fs::write(&first, &own).unwrap();
            let all = [&[name, "-n", "2", "-o", "fresh0", "--force"], STATED[1]].concat();
            let message = refused(&shell, &all);
            assert!(message.contains("is not this robot with other numbers"), "{message}");
            assert_eq!(fs::read_to_string(&first).unwrap(), own);
        }
    }
}

/// The input may be one of the files that would be written, by its own name or by a link of either kind.
#[cfg(unix)]
#[test]
fn the_robot_that_was_read_is_never_replaced() {
    use std::os::unix::fs::symlink;

    for (name, text) in ROBOTS {
        let (stem, extension) = name.split_once('.').unwrap();
        for (kind, place) in (0..4).flat_map(|kind| [0, 3].map(|place| (kind, place))) {
            let shell = Scratch::new();
            fs::create_dir(shell.path("out")).unwrap();
            let inside = format!("out/{stem}-000{place}.{extension}");
            fs::write(shell.path(&inside), text).unwrap();
            let input = format!("out/{name}");
            match kind {
                0 => symlink(format!("{stem}-000{place}.{extension}"), shell.path(&input)).unwrap(),
                1 => fs::hard_link(shell.path(&inside), shell.path(&input)).unwrap(),
                2 => {
                    symlink(&inside, shell.path("x")).unwrap();
                    symlink("../x", shell.path(&input)).unwrap();
                }
                _ => {
                    fs::hard_link(shell.path(&inside), shell.path("x")).unwrap();
                    symlink("../x", shell.path(&input)).unwrap();
                }
            }
            let before = files(&shell.path("out"));
            for folder in ["out", "out/../out"] {
                for force in [&[][..], &["--force"]] {
                    let all =
                        [&[&*input, "-n", "4", "--mass", "10%", "-o", folder], force].concat();
                    let message = refused(&shell, &all);
                    assert!(
                        message.contains("is what was read: it is not written over"),
                        "{message}"
                    );
                    assert_eq!(files(&shell.path("out")), before, "{kind} {place}");
                }
            }
            let all = [&*input, "-n", "4", "--mass", "10%", "-o", "out/table.csv"];
            draw(&shell, &all);
            fs::remove_file(shell.path("out/table.csv")).unwrap();
            fs::hard_link(shell.path(&inside), shell.path("out/table.csv")).unwrap();
            let message = refused(&shell, &[&all[..], &["--force"]].concat());
            assert!(message.contains("is what was read"), "{message}");
        }
    }
}

/// Copies of a plate are thicker whatever is stated, and have its permissions, in a folder that may be called like a table; a robot
/// that is no file, or has to be expanded first, is told as what it is.
#[cfg(unix)]
#[test]
fn copies_are_as_the_robot_and_what_is_none_is_told() {
    use std::os::unix::fs::PermissionsExt;
    let scratch = Scratch::new();
    let robot = |inertial: &str| {
        format!("<robot name=\"a\"><link name=\"base\"/><link name=\"b\">{inertial}</link></robot>")
    };
    let plate = "<inertial><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"2\" iyz=\"0\" izz=\"3\"/></inertial>";
    fs::write(scratch.path("plate.urdf"), robot(plate)).unwrap();
    fs::set_permissions(scratch.path("plate.urdf"), fs::Permissions::from_mode(0o600)).unwrap();
    for (stated, amount) in [("--centre", "1cm"), ("--mass", "0%"), ("--axes", "1deg")] {
        let out = format!("{}.csv/", &stated[2..]);
        scratch.done(&["draw", "plate.urdf", "-n", "1", stated, amount, "-o", &out], 0);
        let copy = scratch.path(&out).join("plate-0000.urdf");
        assert_eq!(fs::metadata(&copy).unwrap().permissions().mode() & 0o777, 0o600);
        let copies = RobotFile::read(&copy).unwrap();
        let numbers = copies.links()[0].numbers().unwrap();
        let inertia = Inertia::try_from(*numbers.inertia()).unwrap();
        let least = inertia.second_moments().values().into_iter().fold(f64::INFINITY, f64::min);
        assert!((least / 6e-9 - 1.0).abs() < 1e-6, "{stated}: {least:e}");
    }
    fs::write(scratch.path("arm.urdf.xacro"), robot(&plate.replace("\"3\"", "\"${m}\""))).unwrap();
    for (file, why) in
        [("arm.urdf.xacro", "expand the file first"), (".", "it is not a regular file")]
    {
        let told = refused(&scratch, &[file, "-n", "1", "--mass", "10%"]);
        assert!(told.contains(why), "{told}");
    }
}
