//! Where reports and fragments go.

use gyradius_formats::write_copy;
use gyradius_study::{Fragment, FragmentBody};
use std::{
    fmt::Display,
    fs,
    io::{self, Write},
    path::Path,
};

use crate::args::{BodyArg, Form, FragmentArgs};

impl From<BodyArg> for FragmentBody {
    fn from(body: BodyArg) -> Self {
        match body {
            BodyArg::Payload => Self::Payload,
            BodyArg::Stage => Self::Stage,
        }
    }
}

/// The text without control characters, which a file could use to command the terminal.
pub(crate) fn harmless(text: &str) -> String {
    text.chars().map(|c| if c.is_control() && c != '\n' { '\u{fffd}' } else { c }).collect()
}

/// As TOML comments.
fn commented(text: &str) -> String {
    let lines = harmless(text);
    lines.lines().map(|line| format!("# {line}").trim_end().to_owned() + "\n").collect()
}

/// Writes fragment and report: both to standard output, the report as comments, so that the whole
/// can be pasted; or the fragment to a file and the report to standard output.
pub(crate) fn write(
    arguments: &FragmentArgs,
    input: &Path,
    report: &str,
    json: &dyn Fn() -> serde_json::Result<String>,
    fragment: &Fragment,
) -> Result<(), String> {
    let pasted = format!("{}\n{fragment}", commented(report));
    let mut said = String::new();
    if let Some(path) = &arguments.output {
        let inputs: Vec<_> = fs::canonicalize(input).into_iter().collect();
        let written =
            write_copy(path, pasted.as_bytes(), &inputs, arguments.force).map_err(|error| {
                match error {
                    gyradius_formats::RepairError::Original(path) => {
                        format!(
                            "{} is the file that was read: it is not written over",
                            path.display()
                        )
                    }
                    other => other.to_string(),
                }
            })?;
        let verb = if written { "wrote" } else { "unchanged:" };
        said = format!("\n{verb} {}\n", harmless(&path.display().to_string()));
    }
    let text = match (arguments.format, &arguments.output) {
        (Form::Json, _) => json().map_err(|error| error.to_string())? + "\n",
        (Form::Text, Some(_)) => harmless(report) + &said,
        (Form::Text, None) => pasted,
    };
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        // Who reads no further, as `head` does, has what they wanted.
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(format!("standard output: {error}"))
        }
        _ => Ok(()),
    }
}

/// A message on standard error.
pub(crate) fn complain(error: impl Display) {
    // Standard error may be closed, which is no reason to stop.
    let _ = writeln!(io::stderr(), "error: {}", harmless(&error.to_string()));
}
