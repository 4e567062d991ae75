//! Where reports, fragments and messages go: the only way to the terminal.

use gyradius_formats::write_copy;
use gyradius_study::{Fragment, FragmentBody, visible, visible_json};
use std::{
    fmt::Display,
    fs,
    io::{self, Write},
    path::Path,
};

use crate::program::args::{BodyArg, Form, FragmentArgs};

impl From<BodyArg> for FragmentBody {
    fn from(body: BodyArg) -> Self {
        match body {
            BodyArg::Payload => Self::Payload,
            BodyArg::Stage => Self::Stage,
        }
    }
}

/// As TOML comments.
fn commented(text: &str) -> String {
    text.lines().map(|line| format!("# {line}").trim_end().to_owned() + "\n").collect()
}

/// The file that an output is written to; none if that is standard output, which `-` stands for.
pub(crate) fn file_of(output: Option<&Path>) -> Option<&Path> {
    output.filter(|path| *path != Path::new("-"))
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
    let file = file_of(arguments.output.as_deref());
    if let Some(path) = file {
        said = write_beside(path, &pasted, input, arguments.force)?;
    }
    match (arguments.format, file) {
        (Form::Json, _) => print_json(&json().map_err(|error| error.to_string())?),
        (Form::Text, Some(_)) => print(&format!("{report}{said}")),
        (Form::Text, None) => print(&pasted),
    }
}

/// Writes a text to a file that is not the one that was read, and says what became of it.
pub(crate) fn write_beside(
    path: &Path,
    text: &str,
    input: &Path,
    force: bool,
) -> Result<String, String> {
    let inputs: Vec<_> = fs::canonicalize(input).into_iter().collect();
    let written =
        write_copy(path, text.as_bytes(), &inputs, force).map_err(|error| match error {
            gyradius_formats::RepairError::Original(path) => {
                format!("{} is the file that was read: it is not written over", path.display())
            }
            other => other.to_string(),
        })?;
    let verb = if written { "wrote" } else { "unchanged:" };
    Ok(format!("\n{verb} {}\n", path.display()))
}

/// Text on standard output, whatever it holds. A reader that reads no further, as `head` does, has what
/// it wanted: that is no error.
pub(crate) fn print(text: &str) -> Result<(), String> {
    to_standard_output(&visible(text))
}

/// A JSON document on standard output.
pub(crate) fn print_json(text: &str) -> Result<(), String> {
    to_standard_output(&(visible_json(text.trim_end()) + "\n"))
}

/// A text of the program's own on standard output, as it is.
pub(crate) fn to_standard_output(text: &str) -> Result<(), String> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(format!("standard output: {error}"))
        }
        _ => Ok(()),
    }
}

/// A message on standard error.
pub(crate) fn complain(error: impl Display) {
    say(&format!("error: {error}"));
}

/// A line on standard error.
pub(crate) fn say(line: &str) {
    // Standard error may be closed, which is no reason to stop.
    let _ = writeln!(io::stderr(), "{}", visible(line));
}
