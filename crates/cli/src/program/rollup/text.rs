//! A rollup as text.

use gyradius_dispersion::{TenParameters, TenSpread};
use std::fmt::{self, Write};

use super::{LIKE_A_TOTAL, Shown};
use crate::program::{
    fit::wrapped,
    number::{short, with_error},
};

/// The table, the correlations, and what to know of the parts.
pub(super) fn text(shown: &Shown<'_>) -> String {
    let mut out = String::new();
    // Writing to a string does not fail.
    let _ = write_text(&mut out, shown);
    out
}

fn write_text(out: &mut String, shown: &Shown<'_>) -> fmt::Result {
    let assembly = shown.rollup.assembly();
    let file = shown.arguments.parts.file_name().unwrap_or_default().to_string_lossy();
    let count = assembly.parts().len();
    let parts = if count == 1 { "1 part".to_owned() } else { format!("{count} parts") };
    let head = format!("Rolled up by gyradius {}: {parts} of {file}", env!("CARGO_PKG_VERSION"));
    writeln!(out, "{head}, together {}\n", assembly.name())?;
    numbers(out, shown)?;
    correlations(out, shown)?;
    contributions(out, shown)?;
    assemblies(out, shown)?;
    notes(out, shown)
}

fn numbers(out: &mut String, shown: &Shown<'_>) -> fmt::Result {
    let first = shown.rollup.assembly().first_order();
    let (values, deviations) = (first.values(), first.deviations());
    write!(out, "{:<16}{:>14}{:>14}", "kg, m, kg·m²", "nominal", "first order σ")?;
    if let Some(drawn) = shown.draws {
        let head = format!("{}: mean", draws(drawn.moments.draws));
        write!(out, "{head:>28}{:>24}", "drawn σ")?;
    }
    writeln!(out)?;
    for i in 0..10 {
        let name = TenParameters::COLUMNS[i];
        write!(out, "{name:<16} {:>13} {:>13}", digits(values[i], 7), digits(deviations[i], 5))?;
        if let Some(drawn) = shown.draws {
            let m = &drawn.moments;
            let spread = m.spread.as_ref();
            let mean = m.mean.map(|mean| with_error(mean[i], spread.map(|s| s.mean_error[i])));
            // Of two draws, nothing tells how far the deviation may be off.
            let error = |s: &TenSpread| (m.draws > 2).then(|| s.deviation_error[i]);
            let deviation = spread.map(|s| with_error(s.deviation[i], error(s)));
            let absent = || "-".to_owned();
            let (mean, deviation) = (mean.unwrap_or_else(absent), deviation.unwrap_or_else(absent));
            write!(out, " {mean:>27} {deviation:>23}")?;
        }
        writeln!(out)?;
    }
    Ok(())
}

fn correlations(out: &mut String, shown: &Shown<'_>) -> fmt::Result {
    let first_order = shown.rollup.assembly().first_order();
    let first = first_order.correlations();
    let drawn = shown.draws.and_then(|drawn| drawn.moments.spread.as_ref());
    let of = |i: usize, j: usize| match drawn {
        Some(spread) => spread.correlation[i][j],
        None => first[(i, j)],
    };
    let deviations = drawn.map_or_else(|| first_order.deviations(), |spread| spread.deviation);
    let by = if drawn.is_some() { "drawing" } else { "first order" };
    writeln!(out, "\ncorrelations by {by}")?;
    for i in 1..10 {
        write!(out, "  {:<16}", TenParameters::COLUMNS[i])?;
        for j in 0..i {
            // What is constant correlates with nothing.
            if deviations[i] > 0.0 && deviations[j] > 0.0 {
                write!(out, "{:>7.2}", of(i, j) + 0.0)?;
            } else {
                write!(out, "{:>7}", "-")?;
            }
        }
        writeln!(out)?;
    }
    if drawn.is_some() {
        let gap = |(i, j): (usize, usize)| (of(i, j) - first[(i, j)]).abs();
        let pairs = (0..10).flat_map(|i| (0..i).map(move |j| (i, j)));
        let most = pairs.map(gap).fold(0.0, f64::max);
        writeln!(out, "the correlations by first order differ from these by up to {most:.2}")?;
    }
    Ok(())
}

/// Which parts the variance of each number comes from, where there are several.
fn contributions(out: &mut String, shown: &Shown<'_>) -> fmt::Result {
    let parts: Vec<(&str, [Option<f64>; 10])> = shown.rollup.assembly().variance_shares().collect();
    if parts.len() < 2 || parts.iter().all(|(_, shares)| shares.iter().all(Option::is_none)) {
        return Ok(());
    }
    writeln!(out, "\nwhich parts the variance (σ²) by first order comes from")?;
    for i in 0..10 {
        let mut of: Vec<(f64, &str)> =
            parts.iter().filter_map(|(name, shares)| Some((shares[i]?, *name))).collect();
        // The order of the names where shares are the same.
        of.sort_by(|a, b| b.0.total_cmp(&a.0));
        let rest = of.split_off(of.partition_point(|(share, _)| *share >= 0.01).min(3));
        let total: f64 = rest.iter().map(|(share, _)| share).sum();
        let others = rest.iter().filter(|(share, _)| *share > 0.0).count();
        let percent = |name: &str, share: f64| format!("{name} {:.0} %", 100.0 * share);
        let mut texts: Vec<String> = of.iter().map(|(share, name)| percent(name, *share)).collect();
        match others {
            _ if total < 0.005 => {}
            1 => texts.push(percent(rest[0].1, total)),
            _ => texts.push(percent(&format!("{others} others"), total)),
        }
        if !texts.is_empty() {
            writeln!(out, "  {:<16} {}", TenParameters::COLUMNS[i], texts.join(", "))?;
        }
    }
    Ok(())
}

/// Every assembly, where there are some inside the whole.
fn assemblies(out: &mut String, shown: &Shown<'_>) -> fmt::Result {
    let assembly = shown.rollup.assembly();
    if !assembly.rows().any(|(depth, _, is_part, _)| depth > 0 && !is_part) {
        return Ok(());
    }
    writeln!(out, "\nassemblies, to first order: mass, kg; mass centre, m")?;
    for (depth, name, _, moments) in assembly.rows().filter(|(_, _, is_part, _)| !is_part) {
        let (values, deviations) = (moments.values(), moments.deviations());
        let pair = |i: usize| format!("{} ± {}", short(values[i]), short(deviations[i]));
        let indent = "  ".repeat(depth.min(20));
        let [mass, x, y, z] = [0, 1, 2, 3].map(pair);
        writeln!(out, "  {indent}{name}: {mass}; {x}, {y}, {z}")?;
    }
    Ok(())
}

fn notes(out: &mut String, shown: &Shown<'_>) -> fmt::Result {
    writeln!(out)?;
    let mut notes = Vec::new();
    if let Some(drawn) = shown.draws.filter(|drawn| drawn.moments.draws > 0) {
        notes.push(naive(drawn));
        if drawn.moments.failed > 0 {
            notes.push(format!("warning: {} sums left the range of numbers", drawn.moments.failed));
        }
    }
    for (name, part) in shown.rollup.assembly().parts() {
        notes.extend(part.findings().iter().map(|finding| format!("warning: {name}: {finding}")));
    }
    let totals = shown.table.like_totals();
    notes.extend(totals.iter().map(|row| format!("warning: {}: {LIKE_A_TOTAL}", row.name())));
    if !shown.table.passed_over().is_empty() {
        let names = shown.table.passed_over().join(", ");
        notes.push(format!("columns that mean nothing here: {names}"));
    }
    if let (Some(path), Some(drawn)) = (&shown.arguments.output, shown.draws) {
        notes.push(format!("wrote {} to {}", draws(drawn.moments.draws), path.display()));
    }
    notes.iter().flat_map(|note| wrapped(note)).try_for_each(|line| writeln!(out, "{line}"))
}

/// So many draws, in words.
fn draws(count: u64) -> String {
    if count == 1 { "1 draw".to_owned() } else { format!("{count} draws") }
}

/// What ten Gaussian numbers would have been instead.
fn naive(drawn: &gyradius_study::RollupDraws) -> String {
    let naive = &drawn.naive;
    let share =
        |count: u64| format!("{} %", short(100.0 * count as f64 / naive.draws.max(1) as f64));
    let worst: Vec<String> = naive
        .parts
        .iter()
        .take(3)
        .map(|(name, count)| format!("{name} {}", share(*count)))
        .collect();
    let worst = match (naive.parts.len(), worst.is_empty()) {
        (_, true) => String::new(),
        (4.., _) => format!(" ({}, …)", worst.join(", ")),
        _ => format!(" ({})", worst.join(", ")),
    };
    format!(
        "{} of these draws are impossible bodies. If the ten numbers of each part were drawn independently from \
         Gaussian laws instead, {} of the draws would have an impossible part{worst}; if those of the whole were \
         drawn from the Gaussian law that first order gives, {} of them would be impossible.",
        drawn.moments.impossible,
        share(naive.any_part),
        share(naive.whole)
    )
}

/// So many significant digits, without zeros at the end.
fn digits(x: f64, count: i32) -> String {
    if x == 0.0 || !(1e-6..1e9).contains(&x.abs()) {
        return short(x);
    }
    let decimals = (count - 1 - x.abs().log10().floor() as i32).max(0) as usize;
    let text = format!("{x:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}
