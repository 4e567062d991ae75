//! The comparison as one page of HTML that needs nothing but itself.

use maud::{Markup, PreEscaped, html};

use super::{
    BodyResult, ModelComparison,
    measure::Measure,
    text::{Block, heading, is_poor, kinds, matched, remarks},
};
use gyradius_report::{Figure, optional, page, percent};

const BLOCKS: [Block; 9] = [
    Block::Unrealizable,
    Block::Spread(Measure::InertiaRatio),
    Block::Spread(Measure::Wobble),
    Block::Spread(Measure::Nutation),
    Block::Spread(Measure::LargestMoment),
    Block::Spread(Measure::MiddleMoment),
    Block::Spread(Measure::SmallestMoment),
    Block::MeanOff,
    Block::CovarianceOff,
];

/// The heading of a block stands apart from the block before.
const STYLE: &str = ".block th { padding-top: 1.2em; border-bottom: 1px solid var(--ink); }\n";

impl ModelComparison {
    pub(super) fn page(&self, figures: &[Figure]) -> String {
        let s = &self.settings;
        let content = html! {
            h1 { "Models of inertia uncertainty, head to head" }
            p.lead {
                (s.draws) " draws of each model about each body at each level, "
                (s.separations) " of them separated in the scenario " strong { (s.scenario) }
                " in place of its payload; seed " (s.seed) ". Intervals have a confidence of "
                (100.0 * self.confidence) " %."
            }
            (reading(s.reference_meaning))
            h2 { "Figures" }
            @for figure in figures {
                figure id=(figure.name) {
                    (PreEscaped(figure.svg()))
                    figcaption { (figure.caption) ". " code { (figure.file()) } }
                }
            }
            @for body in &self.bodies { (body_tables(body)) }
            p {
                "Every number of this page, and more, is in " code { "compare.json" } " and "
                code { "compare.csv" } ". Made by gyradius " (self.gyradius_version)
                "; the scenario's SHA-256 is " code.hash { (s.scenario_fingerprint) } "."
            }
        };
        page("gyradius: models of inertia uncertainty compared", STYLE, &content)
    }
}

fn reading(meaning: &str) -> Markup {
    html! {
        h2 { "How to read this" }
        p { (meaning) }
        p {
            "Not every kind of model can have every covariance. How far each is off is in the tables: "
            "the distance of its mean from the reference's over the reference's deviation, and the "
            "distance of the covariances over the size of the reference's, both for the whole matrix. "
            "Where the covariance is further off than that of a body known exactly (100 %), points are "
            "hollow and numbers in brackets: there the comparison is not of like with like."
        }
        p {
            "Spreads are given by quantiles: a matrix that no body has can have an inertia ratio as "
            "large as one likes, and a single such draw would make the standard deviation, which is in "
            "the files. Where none of the draws was unrealizable an upper bound is given; 0 is by construction."
        }
    }
}

fn body_tables(body: &BodyResult) -> Markup {
    let [i11, i22, i33, i12, i13, i23] = body.inertia_kg_m2;
    html! {
        h2 { (body.name) }
        p {
            "I₁₁, I₂₂, I₃₃ = " (i11) ", " (i22) ", " (i33) " and I₁₂, I₁₃, I₂₃ = " (i12) ", " (i13)
            ", " (i23) " kg·m². Nominal inertia ratio "
            (optional(body.nominal(Measure::InertiaRatio), 4)) ", wobble "
            (optional(body.nominal(Measure::Wobble), 3)) "°, nutation "
            (optional(body.nominal(Measure::Nutation), 3)) "°."
        }
        div.wide { table {
            thead { tr {
                th { "model" }
                @for level in &body.levels { th { (heading(level)) } }
            } }
            @for block in BLOCKS { (block_rows(body, block)) }
        } }
        @let remarks = remarks(body);
        @if !remarks.is_empty() {
            ul { @for remark in remarks { li { (remark) } } }
        }
        details {
            summary { "What was matched" }
            div.wide { table.claims { tbody {
                @for kind in kinds(body) {
                    tr { th scope="row" { (kind) } td { (matched(body, kind)) } }
                }
            } } }
        }
    }
}

/// Models by levels, as part of a larger table.
fn block_rows(body: &BodyResult, block: Block) -> Markup {
    html! {
        tbody {
            tr.block { th colspan=(body.levels.len() + 1) scope="rowgroup" { (block.title()) } }
            @for kind in kinds(body) {
                tr {
                    th scope="row" { (kind) }
                    @for level in &body.levels {
                        @let cell = level.cell(kind);
                        td title=[interval(cell)] {
                            @if is_poor(cell) { "(" (block.cell(cell)) ")" }
                            @else { (block.cell(cell)) }
                        }
                    }
                }
            }
        }
    }
}

/// The share of unrealizable draws with its interval; nothing if there is no such model.
fn interval(cell: Option<&super::contest::Cell>) -> Option<String> {
    let results = cell.and_then(|cell| cell.results.as_ref());
    results.map(|r| format!("unrealizable: {}", percent(&r.unrealizable)))
}
