//! `gyradius compare`: options in, tables out.

use gyradius_study::{CompareOptions, ModelComparison, Reference, Scenario, ScenarioError};

use crate::program::{
    args::{CompareArgs, CompareForm, ReferenceName},
    output::{print, print_json},
    progress,
};

/// Runs the verb; an error is what is said of it.
pub(crate) fn compare(arguments: &CompareArgs) -> Result<(), String> {
    let options = options(arguments).map_err(|e| e.to_string())?;
    let total = options.cells().map_err(|e| e.to_string())?;
    let comparison =
        progress::show(total, "models and levels", |report| ModelComparison::run(&options, report))
            .map_err(|e| e.to_string())?;
    match arguments.format {
        CompareForm::Text => {
            let page = comparison.folder().map_or_else(String::new, |folder| {
                format!("\npage: {}\n", folder.join("compare.html").display())
            });
            print(&format!("{comparison}{page}"))
        }
        CompareForm::Json => print_json(&comparison.to_json().map_err(|e| e.to_string())?),
        CompareForm::Csv => print(&comparison.to_csv()),
    }
}

fn options(arguments: &CompareArgs) -> Result<CompareOptions, ScenarioError> {
    let scenario = arguments.scenario.as_deref().map(Scenario::read).transpose()?;
    let default = CompareOptions::default();
    Ok(CompareOptions {
        scenario,
        bodies: arguments.bodies.clone(),
        reference: match arguments.reference {
            ReferenceName::Principal => Reference::Principal,
            ReferenceName::Entries => Reference::Entries,
        },
        levels_percent: arguments.levels.clone(),
        models: arguments.models.clone(),
        draws: arguments.draws,
        separations: arguments.separations.unwrap_or(default.separations.min(arguments.draws)),
        seed: arguments.seed,
        threads: arguments.threads,
        out: arguments.out.clone(),
        force: arguments.force,
    })
}
