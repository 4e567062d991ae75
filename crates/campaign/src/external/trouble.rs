//! What can go wrong between gyradius and a simulator in one run.

use std::{io, process::ExitStatus, time::Duration};

use super::tail::shown;
use crate::failure::Failure;

/// Characters of an answer, or of its error, that are told.
const TOLD: usize = 500;

/// What went wrong in one run.
#[derive(Debug)]
pub(super) enum Trouble {
    /// An input has no number that can be sent.
    Input { name: String, value: f64 },
    /// The command cannot be started.
    Start(io::Error),
    /// The temporary folder of a run cannot be made, written or read.
    Files(io::Error),
    /// Nothing came in time.
    Timeout { timeout: Duration, last_line: Option<String> },
    /// The campaign was told to stop before there was an answer.
    Stopped,
    /// The process ended by itself.
    Ended { status: ExitStatus, last_line: Option<String> },
    /// One that is started for each run ended otherwise than well.
    Status { status: ExitStatus, last_line: Option<String> },
    /// The process closed standard input or output and did not end.
    Closed { last_line: Option<String> },
    /// The answer has more bytes than a line may have.
    TooLong { limit: usize },
    /// There was something on standard output before the process read the run.
    Early { text: Vec<u8> },
    /// The answer is of another run.
    OutOfTurn { answered: u64, line: Vec<u8> },
    /// The process ended well and left no answer.
    NoFile,
    /// What stands in the place of the file with the answer is no regular file.
    NotAFile { what: &'static str },
    /// The answer cannot be read.
    NotJson { problem: String, line: Vec<u8> },
    /// The file with the answer cannot be read.
    NotJsonFile { problem: String, content: Vec<u8> },
    /// A declared output is not in the answer.
    Missing { output: String },
    /// An output is in the answer more than once.
    Repeated { output: String },
    /// An output is in the answer that is not declared.
    Unknown { output: String },
    /// An output is not a finite number.
    NotFinite { output: Option<String>, value: String },
    /// The answer has both outputs and an error, or neither.
    OutputsOrError,
    /// The simulator says that the run failed.
    Error { text: String },
    /// The simulator, a function, panicked.
    Panicked { text: Option<String> },
    /// Any of these, in an answer in which declared outputs are infinite: those of them, in their order. Nothing may leave such a run out.
    Beside { infinite: Vec<Option<f64>>, trouble: Box<Self> },
}

impl Trouble {
    /// Whether this is an answer to the run that was asked for, after which the process can be asked on.
    pub(super) fn is_an_answer(&self) -> bool {
        match self {
            Self::Missing { .. }
            | Self::Repeated { .. }
            | Self::Unknown { .. }
            | Self::NotFinite { .. }
            | Self::OutputsOrError
            | Self::Error { .. }
            | Self::Panicked { .. } => true,
            Self::Input { .. }
            | Self::Start(_)
            | Self::Files(_)
            | Self::Timeout { .. }
            | Self::Stopped
            | Self::Ended { .. }
            | Self::Status { .. }
            | Self::Closed { .. }
            | Self::TooLong { .. }
            | Self::Early { .. }
            | Self::OutOfTurn { .. }
            | Self::NoFile
            | Self::NotAFile { .. }
            | Self::NotJson { .. }
            | Self::NotJsonFile { .. } => false,
            Self::Beside { trouble, .. } => trouble.is_an_answer(),
        }
    }

    /// The same, in an answer with these of the declared outputs, in their order, that are infinite, as far as there are any.
    pub(super) fn beside(self, infinite: Vec<Option<f64>>) -> Self {
        match infinite.iter().any(Option::is_some) {
            true => Self::Beside { infinite, trouble: Box::new(self) },
            false => self,
        }
    }

    /// The same, with the outputs that are infinite in an answer in which there is other trouble, if there is any.
    pub(super) fn with_infinite_of(self, other: Option<Self>) -> Self {
        match other {
            Some(Self::Beside { infinite, .. }) => self.beside(infinite),
            Some(_) | None => self,
        }
    }

    /// The declared outputs, in their order, that the run has although it failed: those that are infinite. Empty if it has none at all.
    pub(super) fn infinite(&self) -> &[Option<f64>] {
        let Self::Beside { infinite, .. } = self else { return &[] };
        infinite
    }

    /// What was written that is no answer to the run, if something was.
    pub(super) fn into_unasked(self) -> Option<Vec<u8>> {
        let (Self::Early { text: written }
        | Self::NotJson { line: written, .. }
        | Self::OutOfTurn { line: written, .. }) = self.alone()
        else {
            return None;
        };
        Some(written)
    }

    /// The same, without what is infinite beside it.
    pub(super) fn alone(self) -> Self {
        match self {
            Self::Beside { trouble, .. } => *trouble,
            other => other,
        }
    }

    /// The same, of an answer that stands in a file.
    pub(super) fn in_a_file(self) -> Self {
        match self {
            Self::NotJson { problem, line } => Self::NotJsonFile { problem, content: line },
            Self::Beside { infinite, trouble } => trouble.in_a_file().beside(infinite),
            other => other,
        }
    }

    /// The kind, which has no numbers, and the message of the failed run.
    pub(super) fn failure(self) -> Failure {
        let after = |last_line: Option<String>| {
            last_line
                .map(|line| format!("; its last line on standard error: {line}"))
                .unwrap_or_default()
        };
        let (kind, message) = match self {
            Self::Input { name, value } => (
                "an input is not finite",
                format!("the input `{name}` is {value}, which is not sent"),
            ),
            Self::Start(error) => (
                "the simulator cannot be started",
                format!("the simulator cannot be started: {error}"),
            ),
            Self::Files(error) => (
                "the folder of a run",
                format!("the temporary folder of the run cannot be used: {error}"),
            ),
            Self::Timeout { timeout, last_line } => (
                "no answer in time",
                format!("no answer within {} s{}", timeout.as_secs_f64(), after(last_line)),
            ),
            Self::Stopped => ("stopped", "stopped before the simulator answered".to_owned()),
            Self::Ended { status, last_line } => (
                "the simulator ended",
                format!("the simulator ended with {status} before it answered{}", after(last_line)),
            ),
            Self::Status { status, last_line } => (
                "the simulator ended",
                format!("the simulator ended with {status}{}", after(last_line)),
            ),
            Self::Closed { last_line } => (
                "the simulator closed its pipes",
                format!(
                    "the simulator closed standard input or output before it answered{}",
                    after(last_line)
                ),
            ),
            Self::TooLong { limit } => {
                ("the answer is too long", format!("the answer has more than {limit} bytes"))
            }
            Self::Early { text } => (
                "output before the run was read",
                format!(
                    "before the simulator read the run, it wrote to standard output: `{}`; messages belong on standard error",
                    shown(&text, 80)
                ),
            ),
            Self::OutOfTurn { answered, .. } => {
                ("an answer out of turn", format!("the answer is that of run {answered}"))
            }
            Self::NoFile => (
                "no `output.json`",
                "the simulator ended without an error and left no file `output.json`".to_owned(),
            ),
            Self::NotAFile { what } => (
                "`output.json` is no file",
                format!(
                    "the simulator left {what} called `output.json`, which must be a regular file"
                ),
            ),
            Self::NotJsonFile { content, .. } if content.trim_ascii().is_empty() => {
                ("the answer is not as agreed", "`output.json` is empty".to_owned())
            }
            Self::NotJsonFile { problem, content } => (
                "the answer is not as agreed",
                format!(
                    "`output.json` does not hold a JSON object as agreed: {problem}: `{}`",
                    shown(&content, 80)
                ),
            ),
            Self::NotJson { problem, line } => (
                "the answer is not as agreed",
                format!(
                    "the answer is not a JSON object as agreed: {problem}: `{}`; messages belong on standard error",
                    shown(&line, 80)
                ),
            ),
            Self::Missing { output } => {
                ("an output is missing", format!("the output `{output}` is not in the answer"))
            }
            Self::Repeated { output } => (
                "an output is repeated",
                format!("the output `{output}` is in the answer more than once"),
            ),
            Self::Unknown { output } => (
                "an output is not declared",
                format!(
                    "the answer has an output `{}`, which is not declared",
                    shown(output.as_bytes(), 80)
                ),
            ),
            Self::NotFinite { output, value } => {
                let of = output
                    .map_or("an output".to_owned(), |output| format!("the output `{output}`"));
                (
                    "an output is not a finite number",
                    format!("{of} is not a finite number: {value}"),
                )
            }
            Self::OutputsOrError => (
                "neither outputs nor an error",
                "the answer must have either `outputs` or `error`".to_owned(),
            ),
            Self::Beside { trouble, .. } => return trouble.failure(),
            Self::Panicked { text } => {
                let text = text.map(|text| format!(": {}", shown(text.as_bytes(), TOLD)));
                let panicked = "the simulator panicked";
                (panicked, format!("{panicked}{}", text.unwrap_or_default()))
            }
            Self::Error { text } => {
                let text = match text.trim() {
                    "" => "it gives no reason".to_owned(),
                    _ => shown(text.as_bytes(), TOLD),
                };
                return Failure::new(
                    format!("simulator: {}", without_numbers(&text)),
                    format!("simulator: {text}"),
                );
            }
        };
        Failure::new(kind, message)
    }
}

/// A text with `#` for every number in it, so that texts that differ in numbers alone are counted together; an address in memory, such as
/// `0x7f3a`, is one.
fn without_numbers(text: &str) -> String {
    let mut kind = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(start) = rest.find(|c: char| c.is_ascii_digit()) {
        // The sign and the point before a number belong to it, if no word ends there.
        let head = rest[..start].trim_end_matches(['-', '+', '.']);
        let own = head.is_empty() || head.ends_with(|c: char| !c.is_alphanumeric());
        kind.push_str(if own { head } else { &rest[..start] });
        kind.push('#');
        rest = &rest[start..];
        let hex = rest.strip_prefix("0x").or_else(|| rest.strip_prefix("0X"));
        if let Some(hex) = hex.filter(|hex| hex.starts_with(|c: char| c.is_ascii_hexdigit())) {
            rest = hex.trim_start_matches(|c: char| c.is_ascii_hexdigit());
            continue;
        }
        let digits =
            |text: &str| text.len() - text.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        rest = &rest[digits(rest)..];
        if let Some(after) = rest.strip_prefix('.').filter(|after| digits(after) > 0) {
            rest = &after[digits(after)..];
        }
        if let Some(after) = rest.strip_prefix(['e', 'E']) {
            let after = after.strip_prefix(['-', '+']).unwrap_or(after);
            if digits(after) > 0 {
                rest = &after[digits(after)..];
            }
        }
    }
    kind + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Whatever the numbers in a text are, its kind is the same and has none.
        #[test]
        fn kinds_have_no_numbers(
            words in prop::collection::vec("[a-df-z ]{1,8}: ", 1..5),
            numbers in prop::collection::vec((any::<f64>(), any::<f64>()), 5),
        ) {
            let text = |pick: fn(&(f64, f64)) -> f64, exponent: bool| {
                let parts = words.iter().zip(&numbers).map(|(word, pair)| {
                    let number = Some(pick(pair)).filter(|x| x.is_finite()).unwrap_or(-1.5);
                    if exponent { format!("{word}{number:e} ") } else { format!("{word}{number:.3} ") }
                });
                without_numbers(&parts.collect::<String>())
            };
            let kind = text(|pair| pair.0, false);
            prop_assert!(!kind.contains(|c: char| c.is_ascii_digit()));
            prop_assert_eq!(&kind, &text(|pair| pair.1, false));
            prop_assert_eq!(&kind, &text(|pair| pair.1, true));
        }

        /// Addresses in memory are numbers, wherever they stand and however they are written.
        #[test]
        fn kinds_have_no_addresses(words in prop::collection::vec("[g-wyz <>]{1,6}", 2..5), all in prop::array::uniform2(any::<u64>())) {
            let text = |written: fn(u64) -> String, address: u64| without_numbers(&words.join(&written(address)));
            let kind = words.join("#");
            for address in all {
                prop_assert_eq!(text(|x| format!("{x:#x}"), address), kind.as_str());
                prop_assert_eq!(text(|x| format!("0X{x:016X}"), address), kind.as_str());
            }
        }

        #[test]
        fn any_text_has_a_kind(text in any::<String>()) {
            prop_assert!(!without_numbers(&text).contains(|c: char| c.is_ascii_digit()));
        }
    }
}
