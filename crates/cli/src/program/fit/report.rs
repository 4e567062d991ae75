//! The report of a fit as text.

use gyradius_dispersion::EntryMoments;
use gyradius_estimation::{Assessment, AxesFinding, PrincipalFit, RootEstimate};
use gyradius_inertia::InertiaMatrix;
use std::fmt::Write;

use super::{FitArgs, table::Table};
use crate::program::number::{probability, short, with_error};

/// Parameters with their errors, what to know of them, and the verdict.
pub(super) fn text(
    arguments: &FitArgs,
    table: &Table,
    fit: &PrincipalFit,
    moments: &EntryMoments,
    assessment: &Assessment,
) -> String {
    let mut out = String::new();
    // Writing to a string does not fail.
    let _ = write_text(&mut out, arguments, table, fit, moments, assessment);
    out
}

fn write_text(
    out: &mut String,
    arguments: &FitArgs,
    table: &Table,
    fit: &PrincipalFit,
    moments: &EntryMoments,
    assessment: &Assessment,
) -> std::fmt::Result {
    let file = arguments.table().file_name().unwrap_or_default().to_string_lossy();
    let mut first = format!(
        "Fitted by gyradius {} to {} samples of {file}",
        env!("CARGO_PKG_VERSION"),
        fit.count()
    );
    if table.aside > 0 {
        write!(first, "; {} set aside, which no body has", table.aside)?;
    }
    if table.rounded > 0 {
        write!(
            first,
            "; {} moved onto the boundary, off by the rounding of digits",
            table.rounded
        )?;
    }
    for line in wrapped(&first) {
        writeln!(out, "{line}")?;
    }
    if !table.unused.is_empty() {
        let columns = if table.unused.len() == 1 { "column" } else { "columns" };
        let said = format!("nothing was taken from the {columns} {}", table.unused.join(", "));
        for line in wrapped(&said) {
            writeln!(out, "{line}")?;
        }
    }
    for unread in &table.unread {
        for line in wrapped(unread) {
            writeln!(out, "{line}")?;
        }
    }
    let matching = fit.matching();
    writeln!(
        out,
        "principal axes matched: {} of them reordered, {} turned round, {} doubtful\n",
        matching.swapped, matching.flipped, matching.doubtful
    )?;

    writeln!(out, "root of second moment, √kg·m         mean            deviation        law")?;
    for (i, root) in fit.roots().iter().enumerate() {
        let errors = root.errors();
        let mean = with_error(root.mean(), errors.map(|e| e[0]));
        let deviation = match root.law() {
            RootEstimate::Constant => "0".to_owned(),
            _ => with_error(root.deviation(), errors.map(|e| e[1])),
        };
        writeln!(out, "  k{}{mean:>38}  {deviation:>19}        {}", i + 1, root.law())?;
    }
    writeln!(out, "\nturn of the principal axes, deg    mean error          deviation")?;
    let axes = fit.axes();
    for k in 0..3 {
        let variance = axes.turn_covariance()[(k, k)];
        let deviation = variance.max(0.0).sqrt();
        let error = axes.turn_errors().map(|e| 0.5 * e[(k, k)] / deviation);
        let mean = axes.mean_covariance().map(|c| c[(k, k)].max(0.0).sqrt().to_degrees());
        let turn = match axes.finding() {
            AxesFinding::Free => "uniform".to_owned(),
            _ => with_error(deviation.to_degrees(), error.map(f64::to_degrees)),
        };
        let mean = mean.map_or_else(|| "-".to_owned(), short);
        writeln!(out, "  about body axis {}{mean:>24}  {turn:>19}", k + 1)?;
    }
    writeln!(out, "\nkg·m²          nominal     deviation: samples        fit")?;
    let (nominal, found, law) =
        (fit.nominal().entries(), fit.sample_deviations(), moments.deviations());
    for (e, name) in InertiaMatrix::ENTRY_NAMES.iter().enumerate() {
        let [a, b, c] = [nominal[e], found[e], law[e]].map(short);
        writeln!(out, "  {name}  {a:>15}  {b:>20}  {c:>9}")?;
    }

    if !assessment.tests().is_empty() {
        writeln!(out, "\ndoes the model fit?                          p")?;
    } else {
        writeln!(out)?;
    }
    for test in assessment.tests() {
        let bound = test.resolution() > 0.0 && test.p_value() <= test.resolution();
        let p =
            if bound { format!("≤ {}", test.resolution()) } else { probability(test.p_value()) };
        writeln!(out, "  {:<42} {p}", test.aspect().to_string())?;
    }
    for line in wrapped(&format!("verdict: {assessment}")) {
        writeln!(out, "{line}")?;
    }
    for note in fit.notes() {
        for line in wrapped(&format!("note: {note}")) {
            writeln!(out, "{line}")?;
        }
    }
    Ok(())
}

/// Lines of at most 100 characters, those after the first indented.
pub(crate) fn wrapped(text: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let line = lines.last().map_or(0, |line| line.chars().count());
        if line + 1 + word.chars().count() > 98 {
            lines.push(format!("  {word}"));
        } else if let Some(last) = lines.last_mut() {
            if !last.is_empty() {
                last.push(' ');
            }
            last.push_str(word);
        }
    }
    lines
}
