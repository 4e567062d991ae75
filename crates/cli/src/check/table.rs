use gyradius_formats::{Fault, Judgement, Note, RELATIVE_TOLERANCE, RealizabilityReport};
use std::io::{self, Write};

use super::{Finding, Report, Status, harmless, place};
use crate::{args::CheckArgs, number::short};

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
                && let Some(note) = finding.judgement.as_ref().and_then(Judgement::note)
            {
                writeln!(out, "{:>10}  {note}", "")?;
            }
        }
        writeln!(out)?;
    }
    summary(out, report, arguments)
}

fn count(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}

fn summary(out: &mut impl Write, report: &Report, arguments: &CheckArgs) -> io::Result<()> {
    for repair in &report.repairs {
        let verb = if repair.written { "wrote" } else { "unchanged:" };
        let copy = harmless(&repair.copy.display().to_string());
        writeln!(
            out,
            "{verb} {copy} ({})",
            count(repair.bodies, "body repaired", "bodies repaired")
        )?;
    }
    let mut words = vec![format!(
        "{}, {}: {} impossible",
        count(report.files, "file", "files"),
        count(report.bodies, "body", "bodies"),
        report.impossible
    )];
    if report.no_mass > 0 {
        words.push(format!("{} with no mass or a negative one", report.no_mass));
    }
    if report.unread > 0 {
        words.push(format!("{} unread", report.unread));
    }
    if !report.file_errors.is_empty() {
        words.push(count(report.file_errors.len(), "file unreadable", "files unreadable"));
    }
    writeln!(out, "{} (tolerance {:e})", words.join(", "), arguments.tolerance)
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
