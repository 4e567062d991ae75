//! Every command of the README's page of the program, as a reader types it.

use std::fs;

use crate::scratch::Scratch;

const README: &str = include_str!("../../../README.md");

const REQUIREMENTS: &str = include_str!("../../../docs/requirements.md");

const ROBOT: &str = r#"<robot name="arm">
  <link name="forearm"><inertial><origin xyz="0.15 0.01 -0.02"/><mass value="2.4"/>
    <inertia ixx="0.004" ixy="0.0003" ixz="-0.0002" iyy="0.021" iyz="0.0001" izz="0.022"/></inertial></link>
</robot>
"#;

/// What stands in the fenced block of a language after a heading.
fn block<'a>(page: &'a str, heading: &str, language: &str) -> &'a str {
    let section = page.split_once(heading).expect("a heading of this name").1;
    let fence = format!("```{language}\n");
    section.split_once(&fence).and_then(|(_, rest)| rest.split_once("```")).expect("a block").0
}

/// The words of a command, of which those in quotes are one.
fn words(line: &str) -> Vec<&str> {
    let mut words = Vec::new();
    for (i, part) in line.split('"').enumerate() {
        if i % 2 == 1 {
            words.push(part);
        } else {
            words.extend(part.split_whitespace());
        }
    }
    words
}

/// The page, whose verdict is held against the program, has it too.
#[test]
fn the_verdict_of_the_readme_is_that_of_the_page() {
    assert!(REQUIREMENTS.contains(block(README, "## Is the requirement met?", "text")));
}

#[test]
fn every_command_of_the_readme_works() {
    let shell = Scratch::new();
    let vehicle = include_str!("../../study/src/scenario/peck-2003.toml");
    let runs: String =
        (0..3000).map(|i| format!("{}\n", 0.3 * f64::from(i % 100) / 100.0)).collect();
    for (name, text) in [
        ("robot.urdf", ROBOT),
        ("payload.toml", include_str!("tables/payload.toml")),
        ("variants.csv", include_str!("tables/variants.csv")),
        ("parts.csv", include_str!("tables/sawe-3360.csv")),
        ("my-vehicle.toml", vehicle),
        ("runs.csv", &format!("tip_off_deg_per_s\n{runs}")),
    ] {
        fs::write(shell.path(name), text).unwrap();
    }
    let commands = block(README, "## On the command line", "sh");
    let mut count = 0;
    for line in commands.lines() {
        let command = line.split(" # ").next().unwrap_or(line);
        let [program, arguments @ ..] = &words(command)[..] else { continue };
        assert_eq!(*program, "gyradius", "{line}");
        shell.done(arguments, 0);
        count += 1;
    }
    assert_eq!(count, 10);
}
