//! The report as one JSON object.

use gyradius_formats::{BodyJudgement, Change, RealizabilityReport, Remedy};
use nalgebra::Matrix3;
use serde::Serialize;
use std::io::{self, Write};

use super::{Finding, Report, Status, report::Repaired};
use crate::program::args::CheckArgs;

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
    passed_over: Vec<PassedJson<'a>>,
    unread_keys: Vec<KeysJson<'a>>,
    repairs: Vec<RepairJson<'a>>,
}

#[derive(Serialize)]
struct Summary {
    files: usize,
    bodies: usize,
    impossible: usize,
    possible_with_flipped_products: usize,
    no_mass: usize,
    unread: usize,
    errors: usize,
    passed_over: usize,
    without_inertia: usize,
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
    possible_with_flipped_products: bool,
}

#[derive(Serialize)]
struct ErrorJson {
    file: String,
    line: Option<usize>,
    message: String,
}

#[derive(Serialize)]
struct PassedJson<'a> {
    file: String,
    line: Option<usize>,
    reason: &'a str,
    may_hold_bodies: bool,
}

#[derive(Serialize)]
struct KeysJson<'a> {
    file: String,
    line: usize,
    keys: &'a [String],
}

#[derive(Serialize)]
struct RepairJson<'a> {
    file: String,
    copy: String,
    bodies: usize,
    written: bool,
    changes: Vec<ChangeJson<'a>>,
}

#[derive(Serialize)]
struct ChangeJson<'a> {
    name: &'a str,
    line: usize,
    remedy: &'static str,
    before_kg_m2: [[f64; 3]; 3],
    after_kg_m2: [[f64; 3]; 3],
    distance_kg_m2: Option<f64>,
    distance_percent: Option<f64>,
    /// What else would do, and comes first: the signs of the products flipped.
    proposal: Option<Box<ChangeJson<'a>>>,
}

fn rows(matrix: &Matrix3<f64>) -> [[f64; 3]; 3] {
    std::array::from_fn(|i| std::array::from_fn(|j| matrix[(i, j)]))
}

fn change(change: &Change) -> ChangeJson<'_> {
    let finite = |x: f64| Some(x).filter(|x| x.is_finite());
    ChangeJson {
        name: change.name(),
        line: change.line(),
        remedy: match change.remedy() {
            Remedy::Nearest => "nearest",
            Remedy::FlipProducts => "flip",
        },
        before_kg_m2: rows(change.before()),
        after_kg_m2: rows(change.after()),
        distance_kg_m2: finite(change.distance_kg_m2()),
        distance_percent: finite(change.distance_percent()),
        proposal: None,
    }
}

fn repaired(body: &Repaired) -> ChangeJson<'_> {
    let proposal = body.proposal.as_ref().map(|proposal| Box::new(change(proposal)));
    ChangeJson { proposal, ..change(&body.change) }
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
        inertia_kg_m2: inertia.as_ref().ok().map(|matrix| rows(matrix)),
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
        note: judgement.and_then(BodyJudgement::note).map(|note| note.to_string()),
        possible_with_flipped_products: finding.is_flipped(),
    }
}

/// One object, described in docs/check.md.
pub(super) fn write(
    out: &mut impl Write,
    report: &Report,
    arguments: &CheckArgs,
) -> io::Result<()> {
    let files = report.refused.iter().map(|refused| ErrorJson {
        file: refused.path.display().to_string(),
        line: refused.line,
        message: refused.message.clone(),
    });
    let repairs = report.repair_errors.iter().map(|(path, error)| ErrorJson {
        file: path.display().to_string(),
        line: error.line(),
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
            possible_with_flipped_products: report.flipped,
            no_mass: report.no_mass,
            unread: report.unread,
            errors: errors.len(),
            passed_over: report.files_passed(true),
            without_inertia: report.files_passed(false),
        },
        bodies: report.findings.iter().map(body).collect(),
        errors,
        passed_over: report
            .passed
            .iter()
            .map(|passed| PassedJson {
                file: passed.path.display().to_string(),
                line: passed.line,
                reason: &passed.reason,
                may_hold_bodies: passed.may_hold,
            })
            .collect(),
        unread_keys: report
            .unread_keys
            .iter()
            .map(|unread| KeysJson {
                file: unread.path.display().to_string(),
                line: unread.line,
                keys: &unread.keys,
            })
            .collect(),
        repairs: report
            .repairs
            .iter()
            .map(|repair| RepairJson {
                file: repair.original.display().to_string(),
                copy: repair.copy.display().to_string(),
                bodies: repair.bodies.len(),
                written: repair.written,
                changes: repair.bodies.iter().map(repaired).collect(),
            })
            .collect(),
    };
    serde_json::to_writer_pretty(&mut *out, &document)?;
    writeln!(out)
}
