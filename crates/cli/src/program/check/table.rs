//! The report as a table, a list of what was passed over, what was repaired, and a summary.

use gyradius_formats::{
    BodyJudgement, Change, Fault, Note, RELATIVE_TOLERANCE, RealizabilityReport, Remedy,
};
use nalgebra::Matrix3;
use std::{
    collections::HashSet,
    io::{self, Write},
};

use super::{
    Finding, Report, Status, harmless, place,
    report::{Repair, Repaired},
};
use crate::program::{args::CheckArgs, number::short};

/// Widest name, and widest reason, that are not shortened or moved.
const NAME: usize = 24;

fn shortfall(finding: &Finding) -> String {
    let Some(report) = finding.report() else { return "unread".to_owned() };
    match (finding.status(), report.excess_percent()) {
        (Status::Possible, _) => "ok".to_owned(),
        (Status::NoMass, _) => "no mass".to_owned(),
        (_, None) => "too large".to_owned(),
        (_, Some(0.0)) => "asymmetric".to_owned(),
        (_, Some(percent)) if percent.is_finite() => {
            if (0.1..1e5).contains(&percent) {
                format!("{percent:.1} %")
            } else {
                format!("{percent:.0e} %")
            }
        }
        _ if ascending(report).is_some_and(|[a, ..]| a < 0.0) => "negative".to_owned(),
        _ => "infinite".to_owned(),
    }
}

/// The principal moments for the eye: the smallest first, and what is rounding beside the largest
/// is zero.
fn ascending(report: &RealizabilityReport) -> Option<[f64; 3]> {
    let mut moments = report.principal_moments()?;
    let size = moments.iter().fold(0.0, |size: f64, m| size.max(m.abs()));
    moments.sort_by(f64::total_cmp);
    Some(moments.map(|m| if m.abs() <= RELATIVE_TOLERANCE * size { 0.0 } else { m }))
}

/// The principal moments, as the inequality that they break.
fn moments(report: &RealizabilityReport) -> Option<String> {
    let [a, b, c] = ascending(report)?;
    let (a_text, b_text, mut c_text) = (short(a), short(b), short(c));
    if !(report.excess_percent()? > 0.0) || a < 0.0 || report.is_realizable() {
        // A negative one says it all, and better than the inequality does.
        return Some(format!("{a_text}, {b_text}, {c_text}"));
    }
    if c_text == short(a + b) {
        c_text = format!("{c:.7e}");
    }
    Some(format!("{c_text} > {b_text} + {a_text}"))
}

/// The principal moments and what else there is to say, in a few words.
fn reason(finding: &Finding) -> String {
    let judgement = match (&finding.judgement, finding.body.inertia()) {
        (Some(judgement), _) => judgement,
        (None, Err(error)) => return harmless(&error.to_string()),
        (None, Ok(_)) => return String::new(),
    };
    match judgement.note() {
        Some(Note::Massless) => return "0, 0, 0: no mass, a frame".to_owned(),
        Some(Note::PointMass) => return "0, 0, 0: a point mass".to_owned(),
        _ => {}
    }
    let report = judgement.report();
    let mut words = Vec::new();
    if judgement.mass_fault().is_none() || !report.is_realizable() {
        words.extend(moments(report));
    }
    // The other faults are in the moments; one is enough for a line.
    let besides =
        |fault: &&Fault| matches!(fault, Fault::NotFinite { .. } | Fault::NotSymmetric { .. });
    words.extend(report.faults().iter().find(besides).map(ToString::to_string));
    words.extend(judgement.mass_fault().map(|fault| fault.to_string()));
    words.join("; ")
}

fn fit(name: &str) -> String {
    let name = harmless(name);
    if name.is_empty() {
        return "(no name)".to_owned();
    }
    if name.chars().count() <= NAME {
        return name;
    }
    name.chars().take(NAME - 1).chain(['…']).collect()
}

/// One line a body, the worst first, and a summary.
pub(super) fn write(
    out: &mut impl Write,
    report: &Report,
    arguments: &CheckArgs,
) -> io::Result<()> {
    if !report.findings.is_empty() {
        let lines: Vec<[String; 4]> = report
            .findings
            .iter()
            .map(|finding| {
                [
                    shortfall(finding),
                    fit(finding.body.name()),
                    reason(finding),
                    harmless(&place(&finding.path, finding.body.line())),
                ]
            })
            .collect();
        let width = |column: usize, least: usize, most: usize| {
            let widths = lines.iter().map(|line| line[column].chars().count());
            widths.filter(|w| *w <= most).max().unwrap_or(0).max(least)
        };
        let (name, words) = (width(1, 4, NAME), width(2, 17, 42));
        writeln!(
            out,
            "{:>10}  {:name$}  {:words$}  file",
            "shortfall", "body", "principal moments"
        )?;
        for ([percent, body, reason, file], finding) in lines.iter().zip(&report.findings) {
            writeln!(out, "{percent:>10}  {body:name$}  {reason:words$}  {file}")?;
            if finding.status() == Status::Impossible
                && let Some(note) = finding.judgement.as_ref().and_then(BodyJudgement::note)
            {
                writeln!(out, "{:>10}  {note}", "")?;
            }
        }
        writeln!(out)?;
    }
    passed_over(out, report, arguments)?;
    unread_keys(out, report, arguments)?;
    for repair in &report.repairs {
        repairs(out, repair)?;
    }
    summary(out, report, arguments)
}

/// Most lines of files that were passed over.
const PASSED: usize = 20;

/// What may hold bodies and was not read, each with its reason; what has nothing to do with
/// inertias is only counted, but with `--all`.
fn passed_over(out: &mut impl Write, report: &Report, arguments: &CheckArgs) -> io::Result<()> {
    let named: Vec<_> =
        report.passed.iter().filter(|passed| passed.may_hold || arguments.all).collect();
    if named.is_empty() {
        return Ok(());
    }
    let most = if arguments.all { named.len() } else { PASSED };
    writeln!(out, "passed over:")?;
    for passed in named.iter().take(most) {
        let at = match passed.line {
            Some(line) => place(&passed.path, line),
            None => passed.path.display().to_string(),
        };
        writeln!(out, "  {}: {}", harmless(&at), harmless(&passed.reason))?;
    }
    if named.len() > most {
        writeln!(out, "  and {} more, which --all lists", named.len() - most)?;
    }
    writeln!(out)
}

/// Keys that mean nothing here, a line for each file.
fn unread_keys(out: &mut impl Write, report: &Report, arguments: &CheckArgs) -> io::Result<()> {
    let unread = &report.unread_keys;
    let most = if arguments.all { unread.len() } else { PASSED };
    for unread in unread.iter().take(most) {
        let at = place(&unread.path, unread.line);
        writeln!(out, "note: {}: {}", harmless(&at), harmless(&unread.text))?;
    }
    if unread.len() > most {
        let more = unread.len() - most;
        writeln!(out, "note: and of {}, which --all lists", count(more, "file", "files"))?;
    }
    if unread.is_empty() { Ok(()) } else { writeln!(out) }
}

/// A copy, and what is changed in it: of each body the entries that are others, and how far it is moved.
fn repairs(out: &mut impl Write, repair: &Repair) -> io::Result<()> {
    let verb = if repair.written { "wrote" } else { "unchanged:" };
    let copy = harmless(&repair.copy.display().to_string());
    let bodies = count(repair.bodies.len(), "body repaired", "bodies repaired");
    writeln!(out, "{verb} {copy} ({bodies})")?;
    for Repaired { change, proposal } in &repair.bodies {
        writeln!(out, "  {}, line {}:", fit(change.name()), change.line())?;
        if let Some(proposal) = proposal {
            writeln!(
                out,
                "    first see whether the signs of its products are those of the other convention; \
                 --repair=flip writes"
            )?;
            writeln!(out, "      {} ({})", entries(proposal), distance(proposal))?;
            writeln!(out, "    written, the nearest:")?;
        }
        let indent = if proposal.is_some() { "      " } else { "    " };
        writeln!(out, "{indent}{} ({})", entries(change), distance(change))?;
    }
    writeln!(out)
}

/// The entries that change: `ixx 1 -> 1.333`.
fn entries(change: &Change) -> String {
    const AXES: [char; 3] = ['x', 'y', 'z'];
    let (before, after) = (change.before(), change.after());
    let is_symmetric = |m: &Matrix3<f64>| *m == m.transpose();
    let both = is_symmetric(before) && is_symmetric(after);
    let places = (0..3).flat_map(|i| (0..3).map(move |j| (i, j)));
    let changed = places.filter(|(i, j)| before[(*i, *j)] != after[(*i, *j)] && (!both || i <= j));
    let words = changed.map(|(i, j)| {
        let (old, new) = (before[(i, j)], after[(i, j)]);
        let (mut old_text, mut new_text) = (short(old), short(new));
        if old_text == new_text {
            (old_text, new_text) = (format!("{old:.10e}"), format!("{new:.10e}"));
        }
        format!("i{}{} {old_text} -> {new_text}", AXES[i], AXES[j])
    });
    words.collect::<Vec<_>>().join(", ")
}

/// How far an inertia is moved: the Frobenius norm, and its share of the inertia.
fn distance(change: &Change) -> String {
    let (far, percent) = (short(change.distance_kg_m2()), short(change.distance_percent()));
    let how = match change.remedy() {
        Remedy::Nearest => "moved by",
        Remedy::FlipProducts => "products flipped, moved by",
    };
    format!("{how} {far} kg·m², {percent} %")
}

fn count(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}

fn summary(out: &mut impl Write, report: &Report, arguments: &CheckArgs) -> io::Result<()> {
    let mut words = vec![format!(
        "{}, {}: {} impossible",
        count(report.files, "file", "files"),
        count(report.bodies, "body", "bodies"),
        report.impossible
    )];
    if report.flipped > 0 {
        words.push(format!("{} of them possible with flipped products", report.flipped));
    }
    if report.no_mass > 0 {
        words.push(format!("{} with no mass or a negative one", report.no_mass));
    }
    if report.unread > 0 {
        words.push(format!("{} unread", report.unread));
    }
    let refused = report.refused.iter().filter(|refused| refused.is_file);
    let unreadable: HashSet<_> = refused.map(|refused| &refused.path).collect();
    if !unreadable.is_empty() {
        words.push(count(unreadable.len(), "file unreadable", "files unreadable"));
    }
    let (may_hold, others) = (report.files_passed(true), report.files_passed(false));
    if may_hold > 0 {
        words.push(count(may_hold, "file passed over", "files passed over"));
    }
    if others > 0 {
        words.push(count(others, "file without inertias", "files without inertias"));
    }
    writeln!(out, "{} (tolerance {:?})", words.join(", "), arguments.tolerance)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_do_not_reach_the_terminal() {
        assert_eq!(harmless("a\u{1b}[2Jb"), "a\u{fffd}[2Jb");
        assert_eq!(fit(&"x".repeat(100)).chars().count(), NAME);
        assert_eq!(fit(""), "(no name)");
    }
}
