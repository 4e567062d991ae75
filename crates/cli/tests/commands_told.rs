//! Commands that pages and messages tell: they can be typed as they stand, whatever models and folders are called.

use gyradius_study::visible;
use std::{fs, path::Path, process::Command};

use crate::{
    scratch::{Scratch, done},
    simulator::{SCENARIO, scratch},
};

/// A command that is told, typed into a shell in a folder.
fn typed(command: &str, folder: &Path) -> Command {
    let mut shell = Command::new("bash");
    let program = Path::new(env!("CARGO_BIN_EXE_gyradius")).parent().unwrap();
    let path = std::env::var("PATH").unwrap_or_default();
    shell.current_dir(folder).env("PATH", format!("{}:{path}", program.display()));
    shell.args(["-c", command]);
    shell
}

/// The page tells how to do the worst runs again, of models whose names are any that are allowed.
#[test]
fn the_worst_runs_are_done_again_as_the_page_says() {
    let scratch = scratch();
    for model in ["plain", "-x", "--run", "-", "--", "--help", "_", "0"] {
        let text = SCENARIO.replace("runs = 4000", "runs = 20")
            + &format!(
                "\n[[models]]\nname = {model:?}\nlaw = \"principal\"\n[[requirements]]\nquantity = \"y\"\nat_most = 0.5\n\
             probability = 0.1\nconfidence = 0.5\n"
            );
        fs::write(scratch.path("s.toml"), text).unwrap();
        let study = ["study", "--scenario", "s.toml", "--out", "it", "--force"];
        assert!(scratch.run(&study).status.code().unwrap() < 2, "{model}");
        let page = fs::read_to_string(scratch.path("it/report.md")).unwrap();
        let told = page.split('`').filter(|code| code.starts_with("gyradius replay"));
        let told: Vec<&str> = told.collect();
        assert_eq!(told.len(), 10, "{page}");
        for command in told {
            let said = done(typed(command, &scratch.path("it")), 0);
            assert!(said.starts_with(&format!("{model}, run ")), "{command}: {said}");
        }
    }
}

/// The status tells how to put a study together, in a folder of any name.
#[test]
fn a_study_is_put_together_as_the_status_says() {
    let scratch = scratch();
    fs::write(scratch.path("s.toml"), SCENARIO.replace("4000", "20")).unwrap();
    for folder in
        ["plain", "with a space", "it's", "-x", "$HOME", "a/b c", "größe", "a`b", "a\"b\\"]
    {
        let out = format!("--out={folder}");
        scratch.done(&["study", "--scenario", "s.toml", "--shard", "1/1", &out], 0);
        let said = scratch.done(&["status", "--", folder], 1);
        let (_, told) = said.split_once("All runs are done. `").unwrap();
        let (command, _) = told.split_once("` puts them together.").unwrap();
        done(typed(command, scratch.folder()), 0);
        assert!(scratch.path(folder).join("report.html").exists(), "{command}");
    }
}

/// What a simulator writes commands no terminal, and reorders nothing, in any text that a study leaves or prints.
#[test]
fn nothing_that_is_written_reorders_text() {
    let scratch = Scratch::new();
    let script = "while read -r line; do printf '{\"error\":\"a\\342\\200\\256b \\302\\233c \\\\u001b[2J\"}\\n'; done\n";
    fs::write(scratch.path("answer.sh"), script).unwrap();
    fs::write(scratch.path("s.toml"), SCENARIO.replace("4000", "20")).unwrap();
    let study = scratch.done(&["study", "--scenario", "s.toml", "--out", "it", "--json"], 1);
    let status = scratch.done(&["status", "it", "--json"], 0);
    for name in ["summary.json", "campaign.json", "report.md", "report.html"] {
        let text = fs::read_to_string(scratch.path("it").join(name)).unwrap();
        assert_eq!(visible(&text), text, "{name}");
    }
    for text in [study, status] {
        assert_eq!(visible(&text), text);
    }
    // The summary has what was written.
    let text = fs::read_to_string(scratch.path("it/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert!(summary.to_string().contains("a\u{202e}b "), "{text}");
}
