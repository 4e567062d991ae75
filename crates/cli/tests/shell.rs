//! Completions and manual pages: they name every verb and flag, and shells read them.

use std::{
    io::Write,
    process::{Command, Output, Stdio},
};

const SHELLS: [&str; 5] = ["bash", "elvish", "fish", "powershell", "zsh"];

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_gyradius")).args(arguments).output().unwrap()
}

#[track_caller]
fn printed(arguments: &[&str]) -> String {
    let output = run(arguments);
    assert!(output.status.success() && output.stderr.is_empty(), "{arguments:?}: {output:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// What the help lists after a heading: the first word of each line that is indented as the first.
fn listed(help: &str, heading: &str) -> Vec<String> {
    let lines = help.lines().skip_while(|line| *line != heading).skip(1);
    let lines = lines.take_while(|line| line.is_empty() || line.starts_with(' '));
    let word = |line: &str| line.split([' ', ',', '[']).find(|w| !w.is_empty()).map(str::to_owned);
    lines
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "))
        .filter_map(word)
        .collect()
}

fn verbs() -> Vec<String> {
    let verbs = listed(&printed(&["--help"]), "Commands:");
    verbs.into_iter().filter(|verb| verb != "help").collect()
}

/// The long flags of a verb.
fn flags(verb: &str) -> Vec<String> {
    let help = printed(&[verb, "--help"]);
    let words = help.lines().filter(|line| line.trim_start().starts_with('-')).flat_map(|line| {
        line.split([' ', ',', '=', '[']).filter(|word| word.starts_with("--") && word.len() > 2)
    });
    words.map(str::to_owned).collect()
}

/// The page of the package has a row for each verb, and none for another.
#[test]
fn the_readme_has_every_verb() {
    let rows = include_str!("../README.md").lines();
    let rows = rows.filter_map(|line| line.strip_prefix("| `gyradius ")?.split('`').next());
    let mut rows: Vec<&str> = rows.collect();
    let mut verbs = verbs();
    rows.sort_unstable();
    verbs.sort_unstable();
    assert_eq!(rows, verbs);
}

#[test]
fn completions_name_every_verb_and_flag() {
    let verbs = verbs();
    assert!(verbs.len() >= 9 && verbs.iter().any(|verb| verb == "completions"), "{verbs:?}");
    for shell in SHELLS {
        let script = printed(&["completions", shell]);
        for verb in &verbs {
            assert!(script.contains(verb.as_str()), "{shell}: no {verb}");
            let flags = flags(verb);
            assert!(flags.iter().any(|flag| flag == "--help"), "{verb}: {flags:?}");
            for flag in flags {
                // Fish writes flags without their dashes.
                let flag = if shell == "fish" { flag.trim_start_matches('-') } else { &flag };
                assert!(script.contains(flag), "{shell}: no {flag} of {verb}");
            }
        }
        assert!(!script.contains("frobnicate"));
    }
}

/// With the shells that the machine has: a script that is cut off is told apart.
#[test]
fn shells_read_their_completions() {
    for shell in ["bash", "zsh", "fish"] {
        let reads = |script: &str| {
            let mut child = Command::new(shell)
                .arg("-n")
                .stdin(Stdio::piped())
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .spawn()
                .ok()?;
            // A shell that has seen enough reads no further.
            let _ = child.stdin.take().unwrap().write_all(script.as_bytes());
            Some(child.wait().unwrap().success())
        };
        let script = printed(&["completions", shell]);
        let Some(read) = reads(&script) else { continue };
        assert!(read, "{shell} does not read its completions");
        assert_eq!(reads(&format!("{script}\nif")), Some(false), "{shell}");
    }
}

#[test]
fn manual_pages_name_every_verb_and_flag() {
    // Roff writes a dash with a backslash.
    let plain = |page: String| page.replace("\\-", "-").replace("\\fB", "").replace("\\fR", "");
    let page = plain(printed(&["man"]));
    assert!(page.contains(".TH gyradius 1"), "{page}");
    for verb in verbs() {
        assert!(page.contains(&format!("gyradius-{verb}(1)")), "no {verb}: {page}");
        let of_verb = plain(printed(&["man", &verb]));
        let version = env!("CARGO_PKG_VERSION");
        let title = format!(".TH gyradius-{verb} 1  \"gyradius {version}\"");
        assert!(of_verb.contains(&title), "no {title}: {of_verb}");
        for flag in flags(&verb) {
            assert!(of_verb.contains(&flag), "no {flag} of {verb}: {of_verb}");
        }
    }
}

/// A line that is to be copied stands whole in the page, between the requests that keep it from being filled.
#[test]
fn manual_pages_have_examples_line_by_line() {
    let plain = |text: &str| text.replace("\\-", "-").replace("\\*(Aq", "'");
    for verb in verbs() {
        let page = plain(&printed(&["man", &verb]));
        let mut is_kept = false;
        let kept: Vec<&str> = page
            .lines()
            .filter(|line| {
                is_kept = *line != ".fi" && (is_kept || *line == ".nf");
                is_kept && *line != ".nf"
            })
            .collect();
        let help = printed(&[&verb, "--help"]);
        let examples = help.lines().skip_while(|line| *line != "Examples:").skip(1);
        let examples: Vec<&str> = examples.filter(|line| line.starts_with("  ")).collect();
        assert!(examples.len() > 1, "{verb}: {help}");
        // Help is wrapped, and the page is not.
        let words =
            |lines: &[&str]| lines.join(" ").split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(words(&kept).contains(&words(&examples)), "{verb}: {page}");
        let commands =
            |lines: &[&str]| lines.iter().filter(|line| line.starts_with("  gyradius")).count();
        assert_eq!(commands(&kept), commands(&examples), "{verb}: {page}");
        let usage = help.lines().find_map(|line| line.strip_prefix("Usage: ")).unwrap();
        assert!(page.contains(&format!(".SH SYNOPSIS\n{usage}\n")), "no {usage}: {page}");
        for title in ["EXAMPLES", "EXIT STATUS"] {
            let heads = page.lines().filter(|line| line.starts_with(".SH") && line.contains(title));
            assert_eq!(heads.count(), 1, "{verb}: {page}");
        }
    }
}

#[test]
fn what_does_not_exist_is_refused_by_name() {
    for (arguments, told) in [
        (["completions", "csh"], "bash"),
        (["man", "frobnicate"], "there is no verb frobnicate: there are study, report"),
    ] {
        let output = run(&arguments);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(output.stdout.is_empty() && message.contains(told), "{message}");
    }
}
