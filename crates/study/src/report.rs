//! The report: one page of HTML that needs nothing but itself.

use gyradius_report::{Figure, interval, optional, page, percent, significant};
use gyradius_statistics::Interval;
use maud::{Markup, PreEscaped, html};
use nalgebra::{Unit, Vector3};

use crate::{
    body::{Body, Entry},
    claim::{Claim, Verdict},
    claims::{CONSIDERABLE, IDENTICAL, LESS, ONE_SIDED},
    quantity::Quantity,
    scenario::{Comparison, Scenario},
    summary::{ClearanceSummary, ComparisonSummary, ModelSummary, Summary},
};

/// The page, with the figures of the summary as they are drawn, in their order.
pub(crate) fn html<'a>(
    scenario: &Scenario,
    summary: &Summary,
    drawn: impl Iterator<Item = &'a str>,
) -> String {
    let content = html! {
        (head(summary))
        (results(summary))
        (parting(scenario, summary))
        (claims(summary))
        (ratios(summary))
        (deviations(scenario, summary))
        (far_lobe(summary))
        (dispersed(summary))
        (summary.every_model.markup())
        (all_figures(&summary.figures, drawn))
        (inputs(scenario, summary))
    };
    page(&format!("gyradius study: {}", summary.scenario), "", &content)
}

fn head(summary: &Summary) -> Markup {
    let models: Vec<&str> = summary.models.iter().map(|m| m.name.as_str()).collect();
    html! {
        h1 { "Separation under inertia uncertainty" }
        p.lead {
            "Scenario " strong { (summary.scenario) } ": " (summary.runs_per_model)
            " runs of each of the models " (models.join(", ")) ", seed " (summary.seed) ". "
            "Intervals have a confidence of " (100.0 * summary.confidence) " %; p95 is the 95th percentile."
        }
    }
}

fn results(summary: &Summary) -> Markup {
    html! {
        h2 { "What the payload does" }
        div.wide { table.results {
            thead {
                tr {
                    th rowspan="2" { "model" }
                    th rowspan="2" { "unrealizable draws" }
                    @for q in Quantity::behaviour() { th.group colspan="3" { (q.label()) (unit(q)) } }
                }
                tr {
                    @for _ in Quantity::behaviour() { th { "mean" } th { "sd" } th { "p95" } }
                }
            }
            tbody {
                @for model in &summary.models {
                    tr {
                        th scope="row" { (model.name) }
                        td { (percent(&model.unrealizable)) }
                        @for q in Quantity::behaviour() {
                            @let s = model.quantity(q);
                            td.group { (optional(s.and_then(|s| s.sample.mean), 4)) }
                            td title=[tip(s.and_then(|s| s.sample.deviation_interval), 4)] {
                                (optional(s.and_then(|s| s.sample.deviation), 3))
                            }
                            td title=[tip(s.and_then(|s| s.sample.p95_interval), 4)] {
                                (optional(s.and_then(|s| s.sample.p95), 4))
                            }
                        }
                    }
                }
                tr.nominal {
                    th scope="row" { "nominal bodies" }
                    td { "–" }
                    @for q in Quantity::behaviour() {
                        td.group { (optional(summary.nominal_value(q), 4)) }
                        td {} td {}
                    }
                }
            }
        } }
        @for model in summary.models.iter().filter(|m| m.failed > 0) {
            p.warning {
                strong { (model.name) ": " (model.failed) " of " (summary.runs_per_model) " runs failed" }
                " and are left out: "
                @for (reason, count) in model.failures.iter().take(5) { (count) " × " (reason) "; " }
                "see " code { "status" } " in the run table."
            }
        }
    }
}

/// How the bodies part, a quantity a row.
fn parting(scenario: &Scenario, summary: &Summary) -> Markup {
    let said = |direction: Option<&Unit<Vector3<f64>>>| {
        let entries = |d: &Unit<Vector3<f64>>| {
            let entries: Vec<_> =
                d.iter().map(|x| format!("{}", (1e3 * x).round() / 1e3 + 0.0)).collect();
            format!("({})", entries.join(", "))
        };
        direction.map_or_else(|| "none, for the springs' forces cancel".to_owned(), entries)
    };
    // What no run has is not asked.
    let has = |q: &Quantity| {
        summary.models.iter().any(|m| m.quantity(*q).is_some_and(|q| q.sample.n > 0))
    };
    let parting = Quantity::parting().into_iter().filter(has);
    html! {
        h2 { "How they part" }
        p {
            "Velocity of the mass centres from each other, and its angle to the intended direction "
            (said(scenario.separation_direction())) "; tip-off: change of the angular velocity, body axes; "
            "greatest nutation of the free motion that follows; angle of the payload's angular momentum "
            "to the intended direction " (said(Some(scenario.momentum_direction())))
            ". Directions are in inertial axes, and the same for all runs; where the scenario does not "
            "state them they are those of the undispersed bodies. Inertia ratio and nutation: I₁ is the "
            "moment about the principal axis nearest to the spin axis, I₂ and I₃ those about the next two "
            "in cyclic order, each principal axis having the number of the body axis that it is matched to; "
            "a nutation above 90° is of a backward spin. Angles of a payload whose angular momentum is no more "
            "than rounding are not told. "
            @if let Some(outlines) = scenario.outlines() {
                "Clearance: the smallest distance of the outlines in the " (outlines.coast_s())
                " s after the last release, 0 where any two of them touch. Outlines that touch at the last "
                "release are mated: they count only if they touch again after they have parted. "
            }
            "Mean ± standard deviation, and the range from the 5th to the 95th "
            "percentile."
        }
        div.wide { table.results {
            thead {
                tr {
                    th { "quantity" }
                    @for model in &summary.models { th { (model.name) } }
                    th { "nominal bodies" }
                }
            }
            tbody {
                @for q in parting {
                    tr {
                        th scope="row" { (q.label()) (unit(q)) }
                        @for model in &summary.models {
                            @let s = model.quantity(q);
                            td {
                                span title=[tip(s.and_then(|s| s.sample.mean_interval), 4)] {
                                    (optional(s.and_then(|s| s.sample.mean), 4))
                                }
                                " ± "
                                span title=[tip(s.and_then(|s| s.sample.deviation_interval), 4)] {
                                    (optional(s.and_then(|s| s.sample.deviation), 3))
                                }
                                br;
                                small title=[tip(s.and_then(|s| s.sample.p95_interval), 4)] {
                                    (optional(s.and_then(|s| s.sample.p05), 4)) " … "
                                    (optional(s.and_then(|s| s.sample.p95), 4))
                                }
                            }
                        }
                        td { (optional(summary.nominal_value(q), 4)) }
                    }
                }
            }
        } }
        @if summary.models.iter().any(|m| m.releases.recompressed.is_some()) {
            h3 { "Springs and contact" }
            ul {
                @for model in &summary.models { @if let Some(pressed) = model.releases.recompressed {
                    li {
                        strong { (model.name) } ": let go in the order "
                        @for (i, order) in model.releases.orders.iter().take(3).enumerate() {
                            @if i > 0 { "; " }
                            code { (order.order) } " in " (percent(&order.share)) " of the runs"
                        }
                        @if model.releases.orders.len() > 3 { "; others" }
                        ". " (energy(model))
                        @if let Some(clearance) = &model.releases.clearance { " " (nearest(clearance)) }
                        @if let Some(touch) = model.releases.recontact {
                            " The bodies touch again in " (percent(&touch)) " of the runs."
                        }
                        @if pressed.count > 0 {
                            " A spring was pressed again after its release in "
                            (percent(&pressed)) " of the runs."
                        }
                    }
                } }
            }
        }
    }
}

/// How near the bodies come.
fn nearest(clearance: &ClearanceSummary) -> Markup {
    html! {
        @if let (Some(least), Some(run)) = (clearance.least_m, clearance.run) {
            "They come as near as " (significant(least, 4)) " m (run " (run) ")"
            @if let Some(p01) = clearance.p01_m {
                "; 99 % of the runs keep " (significant(p01, 4)) " m"
                @if clearance.p01_interval_m.is_some() { " " (interval(clearance.p01_interval_m, 4)) }
            }
            @if let Some(p05) = clearance.p05_m { ", 95 % " (significant(p05, 4)) " m" }
            "."
        } @else {
            "No run has a clearance."
        }
        @for (note, count) in &clearance.notes {
            " In " (count) @if *count == 1 { " run " } @else { " runs " } (note) "."
        }
    }
}

/// Where the energy of the springs goes, on the average.
fn energy(model: &ModelSummary) -> String {
    let mean = |q| model.quantity(q).and_then(|s| s.sample.mean);
    let Some(whole) = mean(Quantity::SpringEnergy).filter(|whole| *whole > 0.0) else {
        return String::new();
    };
    let percent = |q| optional(mean(q).map(|part| 100.0 * part / whole), 3);
    format!(
        "Of {} J in the springs {} % go into translation and {} % into rotation of the payload, {} % \
         and {} % of the stage.",
        significant(whole, 4),
        percent(Quantity::PayloadTranslation),
        percent(Quantity::PayloadRotation),
        percent(Quantity::StageTranslation),
        percent(Quantity::StageRotation)
    )
}

/// What is told of a number where the pointer rests on it.
fn tip(of: Option<Interval>, digits: usize) -> Option<String> {
    of.is_some().then(|| interval(of, digits))
}

fn unit(quantity: Quantity) -> String {
    match quantity.unit() {
        "1" => String::new(),
        unit => format!(" ({unit})"),
    }
}

fn claims(summary: &Summary) -> Markup {
    html! {
        h2 { "The paper's claims" }
        p {
            "Peck (2003) claims the following of physically realizable models and of independent "
            "Gaussian entries. “Considerably more” is taken as a deviation larger by at least "
            (format!("{:.0}", 100.0 * (CONSIDERABLE - 1.0))) " %, “less” as a mean lower by at least "
            (100.0 * LESS) " %, “the same” as within " (100.0 * IDENTICAL)
            " %, “one-sided” as a skewness beyond " (significant(ONE_SIDED, 1))
            ". A claim holds in a comparison if the whole interval is on its side of that line, and "
            "does not if the whole interval is on the other; else these runs cannot tell. What holds "
            "in one comparison and not, or not surely, in another holds in part."
        }
        div.wide { table.claims {
            thead { tr { th { "claim" } th { "what this study finds" } th { "verdict" } } }
            tbody { @for claim in &summary.claims { (claim_row(claim)) } }
        } }
    }
}

fn claim_row(claim: &Claim) -> Markup {
    let class = match claim.verdict {
        Verdict::Holds => "holds",
        Verdict::HoldsInPart => "in-part",
        Verdict::DoesNotHold => "fails",
        Verdict::NotTested => "untested",
    };
    html! {
        tr {
            td { (claim.claim) }
            td { @for finding in &claim.findings { p { (finding) } } }
            td { span class={ "verdict " (class) } { (claim.verdict.words()) } }
        }
    }
}

fn ratios(summary: &Summary) -> Markup {
    html! {
        @if !summary.comparisons.is_empty() {
            h2 { "Variation under the naive models" }
            p {
                "Deviation under the naive model over deviation under the physical one. The interval "
                "holds for distributions of any shape whose kurtosis the runs show; where the kurtosis "
                "is above 10 it covers the true ratio less often than it says."
            }
            div.wide { table {
                thead {
                    tr {
                        th { "comparison" }
                        @for q in Quantity::behaviour() { th { (q.label()) } }
                    }
                }
                tbody {
                    @for c in &summary.comparisons {
                        tr {
                            th scope="row" { (c.title) br; small { (c.naive) " over " (c.physical) } }
                            @for q in Quantity::behaviour() { td { (ratio(c, q)) } }
                        }
                    }
                }
            } }
        }
    }
}

fn ratio(comparison: &ComparisonSummary, quantity: Quantity) -> Markup {
    let ratio = comparison.ratio(quantity);
    html! {
        (optional(ratio.and_then(|r| r.deviation_ratio), 4)) br;
        small { (interval(ratio.and_then(|r| r.deviation_ratio_interval), 4)) }
    }
}

/// Table 2: the deviations that a naive model was given beside those of the physical one.
fn deviations(scenario: &Scenario, summary: &Summary) -> Markup {
    html! {
        @for comparison in scenario.comparisons() {
            @let names: Vec<&str> = scenario.model_names().collect();
            @if let (Some(physical), Some(naive)) = (
                summary.model(names[comparison.physical]),
                summary.model(names[comparison.naive]),
            ) {
                @if let Some(given) = naive.given_deviations_kg_m2 {
                    @let table = scenario.source().map_or("", |_| " (Table 2)");
                    (deviation_table(table, comparison, physical, naive, given))
                }
            }
        }
    }
}

fn deviation_table(
    table: &str,
    comparison: &Comparison,
    physical: &ModelSummary,
    naive: &ModelSummary,
    given: [[f64; 6]; 2],
) -> Markup {
    html! {
        h2 { "Deviations of the entries" (table) ": " (comparison.title) }
        p {
            "Standard deviations in kg·m²: those of the runs of " strong { (physical.name) }
            ", and those that " strong { (naive.name) } " was given."
        }
        div.wide { table {
            thead { tr {
                th { "body" } th {}
                @for entry in Entry::ALL { th { (Quantity::entry(Body::Payload, entry).label()) } }
            } }
            tbody {
                @for (body, given) in Body::BOTH.into_iter().zip(given) {
                    tr.first {
                        th rowspan="3" scope="rowgroup" { (body.name()) }
                        th scope="row" { (physical.name) }
                        @for entry in Entry::ALL {
                            @let q = physical.quantity(Quantity::entry(body, entry));
                            td {
                                (optional(q.and_then(|q| q.sample.deviation), 4)) br;
                                small { (interval(q.and_then(|q| q.sample.deviation_interval), 4)) }
                            }
                        }
                    }
                    tr {
                        th scope="row" { (naive.name) ", given" }
                        @for value in given { td { (significant(value, 4)) } }
                    }
                    tr {
                        th scope="row" { "given over found" }
                        @for (entry, value) in Entry::ALL.into_iter().zip(given) {
                            @let found = physical.quantity(Quantity::entry(body, entry)).and_then(|q| q.sample.deviation);
                            td { (optional(found.filter(|f| *f > 0.0).map(|f| value / f), 3)) }
                        }
                    }
                }
            }
        } }
    }
}

fn far_lobe(summary: &Summary) -> Markup {
    let lobes: Vec<_> =
        summary.models.iter().filter_map(|m| Some((&m.name, m.far_half?))).collect();
    html! {
        @if lobes.iter().any(|(_, far)| far.iter().any(|s| s.count > 0)) {
            h2 { "The second lobe" }
            p {
                "A quaternion and its negative are one attitude, but the radially constrained Gaussian "
                "does not know it: where its covariance is wide along the mean, a second lobe of draws "
                "lies in the half sphere away from the mean. As attitudes these lie about the "
                em { "inverse" } " of the mean attitude. Axes of “mean-half” leave them out."
            }
            ul {
                @for (name, [payload, stage]) in &lobes {
                    li {
                        strong { (name) } ": "
                        (percent(payload)) " of the payload's draws, " (percent(stage)) " of the stage's."
                    }
                }
            }
        }
    }
}

/// What is uncertain besides the inertias.
fn dispersed(summary: &Summary) -> Markup {
    html! {
        @if let Some(given) = summary.models.first().map(|m| &m.dispersed).filter(|d| !d.is_empty()) {
            h2 { "What else was dispersed" }
            p {
                "Mean and standard deviation of the law of each quantity, and of what each model drew, in "
                "the unit of its name. Every draw is in the run table."
            }
            div.wide { table {
                thead { tr {
                    th { "quantity" } th { "law" } th { "nominal" } th { "mean" } th { "sd" }
                    @for model in &summary.models { th { "drawn by " (model.name) } }
                } }
                tbody {
                    @for (i, d) in given.iter().enumerate() {
                        tr {
                            th scope="row" { code { (d.quantity) } }
                            td { (d.law) }
                            @for value in [d.nominal, d.law_mean, d.law_deviation] {
                                td { (significant(value, 5)) }
                            }
                            @for model in &summary.models {
                                @let drawn = model.dispersed.get(i);
                                td {
                                    (optional(drawn.and_then(|d| d.mean), 5)) " ± "
                                    (optional(drawn.and_then(|d| d.deviation), 4))
                                }
                            }
                        }
                    }
                }
            } }
        }
    }
}

fn all_figures<'a>(figures: &[Figure], drawn: impl Iterator<Item = &'a str>) -> Markup {
    html! {
        h2 { "Figures" }
        @for (figure, svg) in figures.iter().zip(drawn) {
            figure id=(figure.name) {
                // Made by this program, every text in it escaped.
                (PreEscaped(svg))
                figcaption { (figure.caption) ". " code { (figure.file()) } }
            }
        }
    }
}

fn inputs(scenario: &Scenario, summary: &Summary) -> Markup {
    html! {
        h2 { "What went in" }
        p {
            "Run by gyradius " (summary.gyradius_version) " from the scenario below, every default "
            "spelled out; its SHA-256 is " code.hash { (summary.fingerprint) } ". "
            "The same scenario gives the same numbers on any number of threads: "
            code { "gyradius study --scenario scenario.toml" } "."
        }
        p {
            "Every run is a row of " code { "runs/<model>/" }
            ", every number of this page is in " code { "summary.json" } "."
        }
        details { summary { "scenario.toml" } pre { (scenario.to_toml()) } }
    }
}
