use gyradius_formats::{Judgement, RealizabilityReport};
use serde::Serialize;
use std::io::{self, Write};

use super::{Finding, Report, Status};
use crate::args::CheckArgs;

/// Grows when a field changes its meaning or goes; new fields may come without it.
const SCHEMA: u32 = 1;

#[derive(Serialize)]
struct Document<'a> {
    schema: u32,
    version: &'a str,
    tolerance: f64,
    summary: Summary,
    bodies: Vec<BodyJson<'a>>,
    errors: Vec<ErrorJson>,
    repairs: Vec<RepairJson>,
}

#[derive(Serialize)]
struct Summary {
    files: usize,
    bodies: usize,
    impossible: usize,
    no_mass: usize,
    unread: usize,
    errors: usize,
}

#[derive(Serialize)]
struct BodyJson<'a> {
    file: String,
    line: usize,
    format: String,
    name: &'a str,
    status: &'static str,
    mass_kg: Option<f64>,
    inertia_kg_m2: Option<[[f64; 3]; 3]>,
    principal_moments_kg_m2: Option<[f64; 3]>,
    second_moments_kg_m2: Option<[f64; 3]>,
    margin: Option<f64>,
    shortfall_percent: Option<f64>,
    reasons: Vec<String>,
    note: Option<String>,
}

#[derive(Serialize)]
struct ErrorJson {
    file: String,
    line: Option<usize>,
    message: String,
}

#[derive(Serialize)]
struct RepairJson {
    file: String,
    copy: String,
    bodies: usize,
    written: bool,
}

fn body(finding: &Finding) -> BodyJson<'_> {
    let judgement = finding.judgement.as_ref();
    let report = finding.report();
    let inertia = finding.body.inertia();
    BodyJson {
        file: finding.path.display().to_string(),
        line: finding.body.line(),
        format: finding.format.to_string(),
        name: finding.body.name(),
        status: match finding.status() {
            Status::Impossible => "impossible",
            Status::NoMass => "no mass",
            Status::Unread => "unread",
            Status::Possible => "possible",
        },
        mass_kg: finding.body.mass_kg(),
        inertia_kg_m2: inertia
            .as_ref()
            .ok()
            .map(|m| std::array::from_fn(|i| std::array::from_fn(|j| m[(i, j)]))),
        principal_moments_kg_m2: report.and_then(RealizabilityReport::principal_moments),
        second_moments_kg_m2: report.and_then(RealizabilityReport::second_moments),
        margin: report.and_then(RealizabilityReport::margin).filter(|m| m.is_finite()),
        shortfall_percent: report
            .and_then(RealizabilityReport::excess_percent)
            .filter(|p| p.is_finite()),
        reasons: match (judgement, &inertia) {
            (Some(judgement), _) => judgement.reasons().collect(),
            (None, Err(error)) => vec![error.to_string()],
            (None, Ok(_)) => Vec::new(),
        },
        note: judgement.and_then(Judgement::note).map(|note| note.to_string()),
    }
}

/// One object, described in docs/check.md.
pub(super) fn write(
    out: &mut impl Write,
    report: &Report,
    arguments: &CheckArgs,
) -> io::Result<()> {
    let files = report.file_errors.iter().map(|error| ErrorJson {
        file: error.path().display().to_string(),
        line: error.line(),
        message: error.problem().to_string(),
    });
    let repairs = report.repair_errors.iter().map(|(path, error)| ErrorJson {
        file: path.display().to_string(),
        line: None,
        message: format!("not repaired: {error}"),
    });
    let errors: Vec<ErrorJson> = files.chain(repairs).collect();
    let document = Document {
        schema: SCHEMA,
        version: env!("CARGO_PKG_VERSION"),
        tolerance: arguments.tolerance,
        summary: Summary {
            files: report.files,
            bodies: report.bodies,
            impossible: report.impossible,
            no_mass: report.no_mass,
            unread: report.unread,
            errors: errors.len(),
        },
        bodies: report.findings.iter().map(body).collect(),
        errors,
        repairs: report
            .repairs
            .iter()
            .map(|repair| RepairJson {
                file: repair.original.display().to_string(),
                copy: repair.copy.display().to_string(),
                bodies: repair.bodies,
                written: repair.written,
            })
            .collect(),
    };
    serde_json::to_writer_pretty(&mut *out, &document)?;
    writeln!(out)
}
