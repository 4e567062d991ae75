//! `gyradius draw` of robots: in files and in a table, for random robots in every format.

use gyradius_formats::{RobotFile, is_same_but_numbers};
use gyradius_inertia::{Inertia, SecondMoments};
use nalgebra::{Quaternion, UnitQuaternion};
use std::{
    collections::{BTreeMap, HashMap},
    fmt::Write as _,
    fs,
    path::Path,
    process::Command,
};

use crate::scratch::{Scratch, files};

/// What most tests state.
pub(crate) const STATED: [&str; 8] =
    ["--mass", "10%", "--centre", "5mm", "--moments", "15%", "--axes", "5deg"];

const FORMATS: [&str; 3] = ["urdf", "xml", "sdf"];

/// Numbers between 0 and 1 by SplitMix64.
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / 2_f64.powi(53)
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    fn of<T: Copy>(&mut self, some: &[T]) -> T {
        some[(self.next() * some.len() as f64) as usize]
    }
}

/// The element of a random inertia: thick bodies, plates, rods and balls, about any axes, in turned frames or not.
fn inertial(chance: &mut Chance, format: &str) -> String {
    let size = 10_f64.powf(chance.between(-5.0, 1.0));
    let second =
        chance.of(&[[1.0, 2.0, 3.0], [0.0, 1.0, 2.0], [0.0, 0.0, 1.0], [1.0; 3], [2.0, 2.0, 0.5]]);
    let axes = chance.of(&[[1.0, 0.0, 0.0, 0.0], [0.8, 0.1, -0.3, 0.2], [0.5, 0.5, 0.5, 0.5]]);
    let [w, x, y, z] = axes;
    let attitude = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
    let second = SecondMoments::new(second.map(|k| k * size)).unwrap();
    let inertia = Inertia::from_second_moments(second, &attitude).unwrap();
    let six = inertia.entries();
    // Files of six digits have plates that are impossible by rounding.
    let text = |x: f64| if size > 1e-2 { format!("{x:.6e}") } else { format!("{x}") };
    let [xx, yy, zz, xy, xz, yz] = six.map(text);
    let mass = chance.between(0.1, 20.0);
    let [cx, cy, cz] = [(); 3].map(|()| format!("{:.3}", chance.between(-0.5, 0.5)));
    let turned = chance.of(&[false, true]);
    let [r, p, q] = [(); 3].map(|()| if turned { chance.between(-3.0, 3.0) } else { 0.0 });
    match format {
        "urdf" => format!(
            "<inertial><origin xyz='{cx} {cy} {cz}' rpy='{r} {p} {q}'/><mass value='{mass}'/>\n\
             <inertia ixx='{xx}' ixy='{xy}' ixz='{xz}' iyy='{yy}' iyz='{yz}' izz='{zz}'/></inertial>"
        ),
        "sdf" => format!(
            "<inertial><pose>{cx} {cy} {cz} {r} {p} {q}</pose><mass>{mass}</mass><inertia><ixx>{xx}</ixx>\n\
             <ixy>{xy}</ixy><ixz>{xz}</ixz><iyy>{yy}</iyy><iyz>{yz}</iyz><izz>{zz}</izz></inertia></inertial>"
        ),
        _ if turned => {
            // The moments about principal axes that are turned.
            let [a, b, c] = inertia.principal_axes().moments();
            format!(
                "<inertial pos='{cx} {cy} {cz}' quat='0.8 {r} {p} {q}' mass='{mass}' \
                 diaginertia='{a:e} {b:e} {c:e}'/>"
            )
        }
        _ => format!(
            "<inertial pos='{cx} {cy} {cz}' mass='{mass}' fullinertia='{xx} {yy} {zz} {xy} {xz} {yz}'/>"
        ),
    }
}

/// A link of a name, whose inertia depends on the name.
fn link(name: &str, format: &str) -> String {
    let seed = name.bytes().fold(7_u64, |sum, b| sum.wrapping_mul(31) + u64::from(b));
    inertial(&mut Chance(seed), format)
}

/// A robot of links of these names, in a chain of joints; a name that begins with `frame` has no inertia.
fn robot(names: &[&str], format: &str) -> String {
    let mut text = String::new();
    let inside =
        |name: &&str| if name.starts_with("frame") { String::new() } else { link(name, format) };
    match format {
        "xml" => {
            text += "<mujoco>\n<!-- from CAD 1.5 -->\n<worldbody>\n";
            for name in names {
                let joint = "<joint type='hinge' axis='0 0 1'/>";
                let inside = inside(name);
                let moving = if inside.is_empty() { "" } else { joint };
                writeln!(text, "<body name='{name}'>{moving}{inside}<geom size='.01'/>").unwrap();
            }
            text + &"</body>".repeat(names.len()) + "\n</worldbody></mujoco>\n"
        }
        "sdf" => {
            text += "<sdf version='1.9'><model name='m'>\n<!-- from CAD 1.5 -->\n";
            for name in names {
                writeln!(text, "<link name='{name}'>{}</link>", inside(name)).unwrap();
            }
            text + "</model></sdf>\n"
        }
        _ => {
            text += "<robot name='r'>\r\n<!-- from CAD 1.5 -->\r\n<link name='root'/>\r\n";
            let mut parent = "root";
            for name in names {
                write!(
                    text,
                    "<link name='{name}'>{}</link>\r\n<joint name='j_{name}' type='continuous'>\
                     <parent link='{parent}'/><child link='{name}'/><axis xyz='0 0 1'/></joint>\r\n",
                    inside(name)
                )
                .unwrap();
                parent = name;
            }
            text + "</robot>\r\n"
        }
    }
}

/// The ten of each link and draw, as they stand in a CSV table.
pub(crate) fn rows(csv: &[u8]) -> BTreeMap<(String, u64), [f64; 10]> {
    let mut lines = csv::Reader::from_reader(csv);
    let head: Vec<String> = lines.headers().unwrap().iter().map(str::to_owned).collect();
    assert_eq!(
        head.join(","),
        "link,draw,mass_kg,mass_centre_1_m,mass_centre_2_m,mass_centre_3_m,i11,i22,i33,i12,i13,i23"
    );
    let row = |line: csv::StringRecord| {
        let ten = std::array::from_fn(|i| line[2 + i].parse().unwrap());
        ((line[0].to_owned(), line[1].parse().unwrap()), ten)
    };
    lines.records().map(|line| row(line.unwrap())).collect()
}

/// The ten of each link in a file.
fn ten(path: &Path) -> HashMap<String, [f64; 10]> {
    let robot = RobotFile::read(path).unwrap();
    let links = robot.links().iter().map(|link| {
        let numbers = link.numbers().unwrap();
        let [x, y, z]: [f64; 3] = numbers.mass_centre_m().into();
        let [a, b, c, d, e, f] = numbers.inertia().entries();
        (link.name().to_owned(), [numbers.mass_kg(), x, y, z, a, b, c, d, e, f])
    });
    links.collect()
}

pub(crate) fn draw(shell: &Scratch, arguments: &[&str]) -> Vec<u8> {
    let output = shell.run(&[&["draw"], arguments].concat());
    let message = String::from_utf8_lossy(&output.stderr);
    // Beside a table on standard output stands what there is to say of it, and nothing else.
    let told = ["left as", "not drawn", "warning: ", "         also for "];
    // With --inside these are the deviations, too.
    let is_told = arguments.contains(&"--inside")
        && message.contains("standard deviations of the draws")
        || message.lines().all(|line| told.iter().any(|words| line.starts_with(words)));
    assert!(output.status.success() && is_told, "{arguments:?}: {message}");
    output.stdout
}

pub(crate) fn refused(shell: &Scratch, arguments: &[&str]) -> String {
    let output = shell.run(&[&["draw"], arguments].concat());
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
    message
}

const NAMES: [&str; 9] =
    ["base", "arm_1", "frame_a", "arm_2", "wrist", "finger_l", "finger_r", "eye", "frame_b"];

/// For robots of every format and any statements: files and table have the same numbers, only numbers differ, and every
/// body is possible, without tolerance.
#[test]
fn robots_and_table_agree_and_every_body_is_possible() {
    for format in FORMATS {
        for stated in
            [&STATED[..], &STATED[..2], &STATED[2..4], &STATED[4..6], &STATED[6..], &STATED[..4]]
        {
            let shell = Scratch::new();
            let name = format!("bot.{format}");
            let original = robot(&NAMES, format);
            fs::write(shell.path(&name), &original).unwrap();
            let same = [&[name.as_str(), "-n", "12", "--seed", "7"], stated].concat();
            let table = rows(&draw(&shell, &same));
            let said = draw(&shell, &[&same[..], &["-o", "out"]].concat());
            let said = String::from_utf8(said).unwrap();
            assert!(said.contains("wrote 12 robots, out/bot-0000."), "{said}");
            assert!(said.contains("left as it is: frame_a: no inertia in the file"), "{said}");
            assert_eq!(table.len(), 12 * 7);
            let before = ten(&shell.path(&name));
            for draw in 0..12 {
                let path = shell.path(&format!("out/bot-{draw:04}.{format}"));
                for (link, read) in ten(&path) {
                    let drawn = table[&(link.clone(), draw)];
                    let size = drawn[4..7].iter().fold(0.0, |a: f64, b| a.max(*b));
                    for i in 0..10 {
                        let allowed = if i < 4 { 0.0 } else { 1e-14 * size };
                        assert!((read[i] - drawn[i]).abs() <= allowed, "{link} {draw}: {i}");
                    }
                    assert_ne!(before[&link], read, "{link} is drawn");
                }
                let copy = fs::read(&path).unwrap();
                let copy_text = String::from_utf8_lossy(&copy);
                assert!(is_same_but_numbers(original.as_bytes(), &copy), "{copy_text}");
                assert!(copy_text.contains("<!-- from CAD 1.5 -->"));
            }
            shell.done(&["check", "--tolerance", "0", "out"], 0);
        }
    }
}

/// Links that come, go or change places change no other; the draws of a batch are those of the whole; any number of
/// threads writes the same bytes, in every form.
#[test]
fn draws_depend_on_seed_name_and_number_alone() {
    for format in FORMATS {
        let shell = Scratch::new();
        let names = [&NAMES[..], &["other", "base", "eye", "wrist", "new"], &["arm_2"]];
        for (i, names) in names.iter().enumerate() {
            fs::write(shell.path(&format!("{i}.{format}")), robot(names, format)).unwrap();
        }
        let file = |i: usize| format!("{i}.{format}");
        let table = |i: usize, more: &[&str]| {
            let file = file(i);
            rows(&draw(&shell, &[&[file.as_str(), "-n", "20"], &STATED[..], more].concat()))
        };
        let whole = table(0, &[]);
        let mut common = 0;
        for other in [table(1, &[]), table(2, &[])] {
            for (key, ten) in other {
                if let Some(same) = whole.get(&key) {
                    assert_eq!(same.map(f64::to_bits), ten.map(f64::to_bits), "{key:?}");
                    common += 1;
                }
            }
        }
        assert_eq!(common, 4 * 20);
        let picked = table(0, &["--links", "*_?,base"]);
        assert_eq!(picked.len(), 5 * 20);
        assert!(picked.iter().all(|(key, ten)| whole[key] == *ten));
        let later = table(0, &["--first", "15"]);
        assert!((15..20).all(|draw| {
            let key = ("eye".to_owned(), draw);
            later[&key] == whole[&key]
        }));
        let other_seed = table(0, &["--seed", "1"]);
        assert!(whole.iter().all(|(key, ten)| other_seed[key] != *ten));
        for form in ["csv", "jsonl", "npy", "parquet"] {
            let mut written = Vec::new();
            for threads in ["1", "8"] {
                let out = format!("{threads}.{form}");
                let file = file(0);
                let arguments =
                    [&[file.as_str(), "-n", "300", "--threads", threads, "-o", &out], &STATED[..]];
                draw(&shell, &arguments.concat());
                written.push(fs::read(shell.path(&out)).unwrap());
            }
            assert_eq!(written[0], written[1], "{form}");
        }
        for threads in ["1", "8"] {
            let file = file(0);
            let arguments =
                [&[file.as_str(), "-n", "9", "--threads", threads, "-o", threads], &STATED[..]];
            draw(&shell, &arguments.concat());
        }
        assert_eq!(files(&shell.path("1")), files(&shell.path("8")));
    }
}

/// What is there is left alone if it is the same, replaced by force if it is this robot, and never otherwise.
#[test]
fn nothing_else_is_written_over() {
    let shell = Scratch::new();
    let original = robot(&["base", "arm"], "urdf");
    fs::write(shell.path("bot.urdf"), &original).unwrap();
    let with = |more: &[&'static str]| {
        [&["bot.urdf", "-n", "4", "--mass", "5%", "-o", "out"], more].concat()
    };
    draw(&shell, &with(&[]));
    let first = files(&shell.path("out"));
    let again = String::from_utf8(draw(&shell, &with(&[]))).unwrap();
    assert!(again.contains("wrote 0 robots") && again.contains("4 were there already"), "{again}");
    // An interruption has left some.
    fs::remove_file(shell.path("out/bot-0002.urdf")).unwrap();
    draw(&shell, &with(&[]));
    assert_eq!(files(&shell.path("out")), first);
    // Another draw.
    let message = refused(&shell, &with(&["--seed", "1"]));
    assert!(message.contains("exists: --force replaces it"), "{message}");
    assert_eq!(files(&shell.path("out")), first);
    draw(&shell, &with(&["--seed", "1", "--force"]));
    assert_ne!(files(&shell.path("out")), first);
    // Somebody's own robot of such a name, the last of them: none is written.
    let second = files(&shell.path("out"));
    let own = original.replace("'arm'", "'leg'");
    fs::write(shell.path("out/bot-0003.urdf"), &own).unwrap();
    let message = refused(&shell, &with(&["--force"]));
    assert!(message.contains("bot-0003.urdf is not this robot with other numbers"), "{message}");
    let mut expected = second;
    expected.insert("bot-0003.urdf".to_owned(), own.into_bytes());
    assert_eq!(files(&shell.path("out")), expected);
    // The original is not.
    let message = refused(
        &shell,
        &["bot.urdf", "-n", "4", "--mass", "5%", "-o", "bot.urdf", "--format", "csv", "--force"],
    );
    assert!(message.contains("not written over"), "{message}");
    assert_eq!(fs::read_to_string(shell.path("bot.urdf")).unwrap(), original);
}

#[test]
fn what_cannot_be_drawn_is_said() {
    let shell = Scratch::new();
    fs::write(shell.path("a.urdf"), robot(&["base", "arm", "frame"], "urdf")).unwrap();
    let bad = "<robot><link name='bad'><inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' \
               iyz='0' izz='3'/></inertial></link></robot>";
    fs::write(shell.path("bad.urdf"), bad).unwrap();
    let ignored = "<mujoco><compiler inertiafromgeom='true'/><body name='b'><inertial pos='0 0 0' mass='1' \
                   diaginertia='1 1 1'/></body></mujoco>";
    fs::write(shell.path("ignored.xml"), ignored).unwrap();
    let scaled = ignored.replace("inertiafromgeom='true'", "settotalmass='5'");
    fs::write(shell.path("scaled.xml"), scaled).unwrap();
    fs::write(shell.path("none.urdf"), robot(&["frame"], "urdf")).unwrap();
    let sdf = |collision: &str| {
        format!(
            "<sdf version='1.9'><model name='m'><link name='b'><inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz>\
             </inertia></inertial><collision name='c'>{collision}</collision></link></model></sdf>"
        )
    };
    let part = sdf(
        "<geometry><mesh><uri>two.obj</uri><submesh><name>body</name></submesh></mesh></geometry>",
    );
    fs::write(shell.path("part.sdf"), part).unwrap();
    fs::write(shell.path("empty.sdf"), sdf("")).unwrap();
    let far = bad.replace("<mass", "<origin xyz='0 0 1e155'/><mass").replace("izz='3'", "izz='2'");
    fs::write(shell.path("far.urdf"), far).unwrap();
    for (arguments, expected) in [
        (&["far.urdf", "-n", "1", "--mass", "5%"][..], "\"bad\": mass centre, axis 3 = 1e155 m"),
        (&["a.urdf", "-n", "1"][..], "nothing is stated"),
        (&["a.urdf", "--mass", "5%"], "-n says"),
        (&["a.urdf", "-n", "1", "--mass", "5"], "a number and its unit"),
        (&["a.urdf", "-n", "1", "--mass", "500%"], "mass"),
        (&["a.urdf", "-n", "1", "--mass", "5%", "--sigmas", "0"], "sigmas"),
        (
            &["a.urdf", "-n", "1", "--mass", "-10%"],
            "'-10%' for '--mass <AMOUNT>': it must be finite and not negative",
        ),
        (&["a.urdf", "-n", "1", "--centre", "-5mm"], "'--centre <AMOUNT>'"),
        (
            &["part.sdf", "-n", "1", "--mass", "5%", "--inside", "box"],
            "its mesh \"two.obj\" has a <submesh>, which is not read",
        ),
        (
            &["empty.sdf", "-n", "1", "--mass", "5%", "--inside", "box"],
            "its <collision> holds no shape",
        ),
        (&["a.urdf", "-n", "1", "--mass", "5%", "--model", "naive"], "--links"),
        (
            &["a.urdf", "-n", "1", "--mass", "5%", "--links", "leg"],
            "the links with inertia are base, arm",
        ),
        (
            &["a.urdf", "-n", "1", "--mass", "5%", "--links", "fr*"],
            "--links fr*: \"frame\": no inertia in the file",
        ),
        (&["a.urdf", "-n", "1", "--mass", "5%", "--inside", "box"], "neither collision nor visual"),
        (&["bad.urdf", "-n", "1", "--mass", "5%"], "inertia of bad: `gyradius check`"),
        (&["ignored.xml", "-n", "1", "--mass", "5%"], "inertiafromgeom"),
        (&["scaled.xml", "-n", "1", "--mass", "5%"], "settotalmass=\"5\""),
        (&["none.urdf", "-n", "1", "--mass", "5%"], "no link of this URDF file"),
        (&["gone.urdf", "-n", "1", "--mass", "5%"], "cannot be read"),
        (&["-n", "1", "--mass", "5%"], "are for robots"),
        (
            &["a.urdf", "-n", "1", "--mass", "5%", "-o", "a.xlsx"],
            "a folder of this name must be written as a.xlsx/",
        ),
    ] {
        let message = refused(&shell, arguments);
        assert!(message.contains(expected), "{arguments:?}: {message}");
    }
    // What is drawn all the same.
    let raised = ignored.replace("inertiafromgeom='true'", "boundmass='5'");
    fs::write(shell.path("raised.xml"), raised).unwrap();
    for output in [&["-o", "raised"][..], &[]] {
        let same = ["draw", "raised.xml", "-n", "1", "--mass", "5%"];
        let output = shell.run(&[&same[..], output].concat());
        let all = [output.stdout, output.stderr].concat();
        let told = String::from_utf8(all).unwrap();
        assert!(
            output.status.success() && told.contains("warning: the file has boundmass"),
            "{told}"
        );
    }
    // Meshes that lead nowhere from the folder.
    let mesh = robot(&["base"], "urdf")
        .replace("<link name='root'/>", "<link name='root'><mesh filename='m.stl'/></link>");
    fs::write(shell.path("mesh.urdf"), mesh).unwrap();
    fs::write(shell.path("m.stl"), "").unwrap();
    for (folder, warned) in [("elsewhere", true), (".", false)] {
        let output = shell.run(&["draw", "mesh.urdf", "-n", "1", "--mass", "5%", "-o", folder]);
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success() && message.contains("m.stl") == warned, "{message}");
    }
}

/// Whether Python is there with a module.
fn has(module: &str) -> bool {
    let python = Command::new("python3").args(["-c", &format!("import {module}")]).output();
    let is_there = python.is_ok_and(|output| output.status.success());
    if !is_there {
        // Seen with --nocapture.
        println!("skipped: python3 has no {module}");
    }
    is_there
}

fn python(shell: &Scratch, script: &str) {
    let mut python = Command::new("python3");
    let said = python.args(["-c", script]).current_dir(shell.folder()).output().unwrap();
    assert!(said.status.success(), "{}", String::from_utf8_lossy(&said.stderr));
}

/// The ten in the table are what MuJoCo and Pinocchio find in the copies, which they take.
#[test]
fn mujoco_and_pinocchio_take_the_copies() {
    const READ: &str = r#"
import csv, numpy as np
rows = {(r["link"], int(r["draw"])): [float(x) for x in list(r.values())[2:]] for r in csv.DictReader(open("t.csv"))}
names = ["base", "arm_1", "arm_2", "wrist", "finger_l", "finger_r", "eye"]
def same(name, draw, mass, centre, inertia):
    ten = rows[name, draw]
    a, b, c, d, e, f = ten[4:]
    matrix = np.array([[a, d, e], [d, b, f], [e, f, c]])
    assert abs(mass / ten[0] - 1) < 1e-12, (name, draw)
    assert np.allclose(centre, ten[1:4], rtol=0, atol=1e-12), (name, draw)
    assert np.abs(inertia - matrix).max() < 1e-7 * np.abs(matrix).max(), (name, draw, inertia, matrix)
"#;
    const MUJOCO: &str = r#"
import mujoco
for draw in range(40):
    model = mujoco.MjModel.from_xml_path(f"out/bot-{draw:04}.xml")
    for name in names:
        body = model.body(name)
        turn = np.zeros(9)
        mujoco.mju_quat2Mat(turn, body.iquat)
        turn = turn.reshape(3, 3)
        same(name, draw, body.mass[0], body.ipos, turn @ np.diag(body.inertia) @ turn.T)
    mujoco.mj_step(model, mujoco.MjData(model))
"#;
    const PINOCCHIO: &str = r#"
import pinocchio
for draw in range(40):
    model = pinocchio.buildModelFromUrdf(f"out/bot-{draw:04}.urdf")
    for name in names:
        body = model.inertias[model.getJointId("j_" + name)]
        same(name, draw, body.mass, body.lever, body.inertia)
    assert np.linalg.eigvalsh(pinocchio.crba(model, model.createData(), pinocchio.neutral(model)))[0] > 0
"#;
    for (module, format, script) in [("mujoco", "xml", MUJOCO), ("pinocchio", "urdf", PINOCCHIO)] {
        if !has("numpy") || !has(module) {
            continue;
        }
        let shell = Scratch::new();
        let name = format!("bot.{format}");
        // No frames between, to which MuJoCo and Pinocchio would add.
        let names: Vec<&str> =
            NAMES.into_iter().filter(|name| !name.starts_with("frame")).collect();
        fs::write(shell.path(&name), robot(&names, format)).unwrap();
        for output in ["out", "t.csv"] {
            draw(&shell, &[&[name.as_str(), "-n", "40", "-o", output], &STATED[..]].concat());
        }
        python(&shell, &format!("{READ}{script}"));
    }
    // Rows are ordered, so that a table is an array of links, draws and ten.
    if has("numpy") {
        let shell = Scratch::new();
        fs::write(shell.path("bot.sdf"), robot(&NAMES, "sdf")).unwrap();
        for output in ["t.npy", "t.csv"] {
            draw(&shell, &[&["bot.sdf", "-n", "40", "-o", output], &STATED[..]].concat());
        }
        let reshape = r#"
table = np.load("t.npy")
ten = np.stack([table[name] for name in table.dtype.names[2:]], axis=-1).reshape(-1, 40, 10)
assert ten.shape == (7, 40, 10) and list(table["link"][::40]) == names
assert all((ten[names.index(link), draw] == row).all() for (link, draw), row in rows.items())
"#;
        python(&shell, &format!("{READ}{reshape}"));
    }
}
