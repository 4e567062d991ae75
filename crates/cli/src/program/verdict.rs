//! `gyradius verdict`: whether the runs in a table of anybody's meet requirements.

use gyradius_campaign::threads;
use gyradius_study::{FailedRuns, Fleet, ForeignTable, Judgement, Looks, Requirement, Verdict};
use serde_json::json;
use std::{
    error::Error,
    fmt::Write,
    io,
    path::{Path, PathBuf},
    process::ExitCode,
};

use crate::program::{
    STANDARD_INPUT,
    args::VerdictArgs,
    output::{print, print_json, say},
};

/// What the program returns if a requirement is not met, or not decided.
const NOT_MET: u8 = 1;

/// Files that are not judged and are named at most.
const TOLD: usize = 10;

/// Runs the verb.
pub(crate) fn verdict(arguments: &VerdictArgs) -> Result<ExitCode, Box<dyn Error>> {
    let (name, table) = if arguments.table.as_os_str() == STANDARD_INPUT {
        let name = Path::new("standard input");
        (name, ForeignTable::read_csv(name, io::stdin().lock())?)
    } else {
        (arguments.table.as_path(), ForeignTable::open(&arguments.table)?)
    };
    let (table, unknown) = Fleet::first_flights(table)?;
    if let Some(unknown) = unknown {
        say(&format!("warning: {unknown}"));
    }
    let failed = if arguments.leave_out_failed { FailedRuns::LeftOut } else { FailedRuns::Against };
    let requirements: Vec<Requirement> =
        arguments.require.iter().map(|r| r.clone().with_failed_runs(failed)).collect();
    let judgements = threads(None)?.install(|| Judgement::of_table(&requirements, &table))?;
    if arguments.json {
        let not_judged: Vec<_> =
            table.beside().iter().map(|file| file.display().to_string()).collect();
        let judged = json!({ "table": arguments.table, "not_judged": not_judged, "requirements": judgements });
        print_json(&serde_json::to_string_pretty(&judged)?)?;
    } else {
        print(&text(name, &table, &judgements))?;
    }
    let met = judgements.iter().all(|judgement| judgement.verdict() == Verdict::Met);
    Ok(if met { ExitCode::SUCCESS } else { ExitCode::from(NOT_MET) })
}

fn text(name: &Path, table: &ForeignTable, judgements: &[Judgement]) -> String {
    let runs = judgements.first().map_or(0, Judgement::runs);
    let unit = judgements.first().map_or("runs", |judgement| judgement.unit(runs));
    let mut text = format!("{}: {runs} {unit}\n", name.display());
    // Writing to a string does not fail.
    if let Some((told, more)) = table.beside().split_at_checked(table.beside().len().min(TOLD)) {
        let name = |file: &PathBuf| file.file_name().unwrap_or_default().display().to_string();
        let names: Vec<String> = told.iter().map(name).collect();
        let more =
            if more.is_empty() { String::new() } else { format!(" and {} more", more.len()) };
        if !names.is_empty() {
            let _ = writeln!(
                text,
                "Not judged, though there may be runs in it: {}{more}. Of a folder Parquet files are judged.",
                names.join(", ")
            );
        }
    }
    if let (Looks::Often, Some(campaign)) = (table.counting().looks(), table.campaign()) {
        let _ = writeln!(
            text,
            "A rule that could end the runs looked at them while they were done, says {}: the verdict holds for any number of looks.",
            campaign.display()
        );
    }
    let flights = table.counting().group();
    if flights > 1 {
        let _ = writeln!(
            text,
            "Of each vehicle the first of {flights} flights is judged: flights of the same vehicle need not be independent."
        );
    }
    for judgement in judgements {
        let _ = write!(text, "\n{}\n{judgement}", judgement.requirement().name());
    }
    text
}
