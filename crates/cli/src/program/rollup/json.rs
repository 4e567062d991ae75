//! A rollup as JSON.

use gyradius_dispersion::TenParameters;
use gyradius_estimation::{FirstOrder, PartFinding, TEN_UNITS};
use serde::Serialize;

use super::{LIKE_A_TOTAL, Shown};

/// Grows when a field changes its meaning or goes; new fields may come without it.
const SCHEMA: u32 = 1;

/// Ten numbers are in the order of `names`.
#[derive(Serialize)]
struct Document<'a> {
    schema: u32,
    version: &'static str,
    file: String,
    whole: &'a str,
    parts: usize,
    names: [&'static str; 10],
    units: [&'static str; 10],
    first_order: Nominal<'a>,
    /// Null where nothing was drawn.
    drawn: Option<Drawn>,
    contributions: Vec<Contribution<'a>>,
    assemblies: Vec<Nominal<'a>>,
    findings: Vec<Finding<'a>>,
    passed_over: &'a [String],
}

#[derive(Serialize)]
struct Nominal<'a> {
    name: &'a str,
    nominal: [f64; 10],
    deviation: [f64; 10],
    covariance: [[f64; 10]; 10],
}

/// Share of a part in the variances of the whole, to first order; null where a number does not vary.
#[derive(Serialize)]
struct Contribution<'a> {
    part: &'a str,
    share: [Option<f64>; 10],
}

impl<'a> Nominal<'a> {
    fn new(name: &'a str, moments: &FirstOrder) -> Self {
        let c = moments.covariance();
        Self {
            name,
            nominal: moments.values(),
            deviation: moments.deviations(),
            covariance: std::array::from_fn(|i| std::array::from_fn(|j| c[(i, j)])),
        }
    }
}

#[derive(Serialize)]
struct Drawn {
    seed: u64,
    draws: u64,
    failed: u64,
    impossible: u64,
    /// Null without a draw, and the others with fewer than two.
    mean: Option<[f64; 10]>,
    mean_error: Option<[f64; 10]>,
    deviation: Option<[f64; 10]>,
    deviation_error: Option<[f64; 10]>,
    correlation: Option<[[f64; 10]; 10]>,
    naive: Naive,
}

#[derive(Serialize)]
struct Naive {
    draws: u64,
    impossible_whole: u64,
    impossible_part: u64,
    parts: Vec<NaivePart>,
}

#[derive(Serialize)]
struct NaivePart {
    name: String,
    impossible: u64,
}

#[derive(Serialize)]
struct Finding<'a> {
    part: &'a str,
    /// Whether no body can have what is stated.
    impossible: bool,
    /// Entry, stated deviation and that of the draws, kg·m²; empty if the finding is another.
    moved: Vec<(&'static str, f64, f64)>,
    message: String,
}

/// One object, described in docs/rollup.md.
pub(super) fn text(shown: &Shown<'_>) -> serde_json::Result<String> {
    let assembly = shown.rollup.assembly();
    let findings = assembly.parts().flat_map(|(part, law)| {
        law.findings().iter().map(move |finding| Finding {
            part,
            impossible: finding.is_impossible(),
            moved: match finding {
                PartFinding::Moved { entries } => entries.clone(),
                _ => Vec::new(),
            },
            message: finding.to_string(),
        })
    });
    let totals = shown.table.like_totals();
    let totals = totals.iter().map(|row| Finding {
        part: row.name(),
        impossible: false,
        moved: Vec::new(),
        message: LIKE_A_TOTAL.to_owned(),
    });
    let drawn = shown.draws.map(|drawn| {
        let (m, naive) = (&drawn.moments, &drawn.naive);
        let spread = m.spread.as_ref();
        let part = |(name, impossible): &(String, u64)| NaivePart {
            name: name.clone(),
            impossible: *impossible,
        };
        Drawn {
            seed: shown.arguments.seed,
            draws: m.draws,
            failed: m.failed,
            impossible: m.impossible,
            mean: m.mean,
            mean_error: spread.map(|spread| spread.mean_error),
            deviation: spread.map(|spread| spread.deviation),
            // Of two draws, nothing tells how far the deviations may be off.
            deviation_error: spread.filter(|_| m.draws > 2).map(|spread| spread.deviation_error),
            correlation: spread.map(|spread| spread.correlation),
            naive: Naive {
                draws: naive.draws,
                impossible_whole: naive.whole,
                impossible_part: naive.any_part,
                parts: naive.parts.iter().map(part).collect(),
            },
        }
    });
    let inside = assembly.rows().filter(|(depth, _, is_part, _)| *depth > 0 && !is_part);
    let document = Document {
        schema: SCHEMA,
        version: env!("CARGO_PKG_VERSION"),
        file: shown.arguments.parts.display().to_string(),
        whole: assembly.name(),
        parts: assembly.parts().len(),
        names: TenParameters::COLUMNS,
        units: TEN_UNITS,
        first_order: Nominal::new(assembly.name(), assembly.first_order()),
        drawn,
        contributions: assembly
            .variance_shares()
            .map(|(part, share)| Contribution { part, share })
            .collect(),
        assemblies: inside.map(|(_, name, _, moments)| Nominal::new(name, moments)).collect(),
        findings: findings.chain(totals).collect(),
        passed_over: shown.table.passed_over(),
    };
    serde_json::to_string_pretty(&document)
}
