//! What shells and `man` are told about the program, made from its verbs and flags.

use clap::CommandFactory;
use clap_mangen::{
    Man,
    roff::{Roff, roman},
};

use crate::program::{
    args::{Cli, CompletionsArgs, ManArgs},
    output::to_standard_output,
};

/// The script of completions for a shell, on standard output.
pub(crate) fn completions(arguments: &CompletionsArgs) -> Result<(), String> {
    let mut script = Vec::new();
    let mut program = Cli::command();
    let name = program.get_name().to_owned();
    clap_complete::generate(arguments.shell, &mut program, name, &mut script);
    print(script)
}

/// The manual page of the program or of a verb, in roff, on standard output.
pub(crate) fn man(arguments: &ManArgs) -> Result<(), String> {
    let mut program = Cli::command().disable_help_subcommand(true);
    // Names such as gyradius-study come with it.
    program.build();
    let mut command = match &arguments.verb {
        None => program,
        Some(verb) => program.find_subcommand(verb).cloned().ok_or_else(|| {
            let verbs: Vec<_> = program.get_subcommands().map(clap::Command::get_name).collect();
            format!("there is no verb {verb}: there are {}", verbs.join(", "))
        })?,
    };
    print(page(&mut command).map_err(|error| error.to_string())?)
}

/// The sections of a page. Those with examples and the usage are made here: as `clap_mangen` makes them, examples are filled and
/// hyphenated like sentences, and options that must be given have no values.
fn page(command: &mut clap::Command) -> std::io::Result<Vec<u8>> {
    let usage = command.render_usage().to_string();
    let more = command.get_after_help().map(ToString::to_string).unwrap_or_default();
    let man = Man::new(command.clone()).source(concat!("gyradius ", env!("CARGO_PKG_VERSION")));
    let mut page = Vec::new();
    man.render_title(&mut page)?;
    man.render_name_section(&mut page)?;
    let mut synopsis = Roff::new();
    synopsis.control("SH", ["SYNOPSIS"]);
    synopsis.text([roman(usage.trim_start_matches("Usage:").trim())]);
    synopsis.to_writer(&mut page)?;
    man.render_description_section(&mut page)?;
    man.render_options_section(&mut page)?;
    if command.has_subcommands() {
        man.render_subcommands_section(&mut page)?;
    }
    after_options(&more).to_writer(&mut page)?;
    Ok(page)
}

/// What stands behind the options, of which each paragraph that is indented below its title is a section, with its lines as they
/// stand.
fn after_options(text: &str) -> Roff {
    let mut roff = Roff::new();
    let is_indented = |line: &&str| line.starts_with(' ');
    for paragraph in text.split("\n\n") {
        let lines: Vec<&str> = paragraph.lines().collect();
        match &lines[..] {
            [title, rest @ ..] if !rest.is_empty() && rest.iter().all(is_indented) => {
                if !is_indented(title) {
                    roff.control("SH", [&*title.trim_end_matches(':').to_uppercase()]);
                }
                let from = usize::from(!is_indented(title));
                verbatim(&mut roff, &lines[from..]);
            }
            _ => match paragraph.strip_prefix("Exit code: ") {
                Some(codes) => {
                    roff.control("SH", ["EXIT STATUS"]);
                    roff.text([roman(codes)]);
                }
                None => {
                    roff.control("PP", []);
                    roff.text([roman(paragraph)]);
                }
            },
        }
    }
    roff
}

/// Lines that are neither filled nor hyphenated.
fn verbatim(roff: &mut Roff, lines: &[&str]) {
    roff.control("PP", []);
    roff.control("nf", []);
    for line in lines {
        roff.text([roman(*line)]);
    }
    roff.control("fi", []);
}

fn print(bytes: Vec<u8>) -> Result<(), String> {
    to_standard_output(&String::from_utf8(bytes).map_err(|error| error.to_string())?)
}
