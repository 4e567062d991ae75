//! What is for robots alone has no meaning for a scenario: `gyradius draw` refuses it, whatever it is and however it is said.

use std::process::{Command, Output};

fn draw(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_gyradius")).arg("draw").args(arguments).output().unwrap()
}

/// The options that the help has under the heading of robots, each with values of its own, among which is any default.
fn for_robots() -> Vec<(String, &'static [&'static str])> {
    let help = String::from_utf8(draw(&["--help"]).stdout).unwrap();
    let below = help.lines().skip_while(|line| !line.starts_with("Of robots")).skip(1);
    let below = below.take_while(|line| line.is_empty() || line.starts_with(' '));
    let names = below.filter_map(|line| line.trim_start().strip_prefix("--")?.split(' ').next());
    names
        .map(|name| {
            let values: &[&str] = match name {
                "mass" => &["5%", "0.1kg"],
                "centre" => &["5mm", "5mm,5mm,20mm"],
                "moments" => &["15%", "5%,10%,15%"],
                "axes" => &["5deg", "0.1rad"],
                "sigmas" => &["1", "1.0", "3"],
                "links" => &["*", "arm,leg"],
                "inside" => &["mesh", "box", "ellipsoid"],
                other => panic!("--{other} has no value here"),
            };
            (format!("--{name}"), values)
        })
        .collect()
}

#[test]
fn scenarios_take_no_option_of_robots() {
    let options = for_robots();
    assert_eq!(options.len(), 7, "{options:?}");
    for (option, values) in options {
        for value in values {
            let said = [option.as_str(), value];
            for rest in [&["-n", "1"][..], &["-n", "1", "--model", "proposed"], &[]] {
                let output = draw(&[rest, &said].concat());
                let message = String::from_utf8(output.stderr).unwrap();
                assert!(output.status.code() == Some(2) && output.stdout.is_empty(), "{said:?}");
                assert!(
                    message.contains("are for robots") && message.contains(&option),
                    "{message}"
                );
            }
        }
    }
}
