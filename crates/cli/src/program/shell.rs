//! What shells and `man` are told about the program, made from its verbs and flags.

use clap::CommandFactory;

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
    let command = match &arguments.verb {
        None => program,
        Some(verb) => program.find_subcommand(verb).cloned().ok_or_else(|| {
            let verbs: Vec<_> = program.get_subcommands().map(clap::Command::get_name).collect();
            format!("there is no verb {verb}: there are {}", verbs.join(", "))
        })?,
    };
    let mut page = Vec::new();
    let source = concat!("gyradius ", env!("CARGO_PKG_VERSION"));
    let rendered = clap_mangen::Man::new(command).source(source).render(&mut page);
    rendered.map_err(|error| error.to_string())?;
    print(page)
}

fn print(bytes: Vec<u8>) -> Result<(), String> {
    to_standard_output(&String::from_utf8(bytes).map_err(|error| error.to_string())?)
}
