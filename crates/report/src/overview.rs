//! What the runs of any simulation amount to, as data, and the page that shows it.

use gyradius_campaign::{Kind, SampleSummary, Share, Table, counted};
use gyradius_statistics::{Confidence, StatisticsError};
use maud::{Markup, PreEscaped, html};
use serde::{Deserialize, Serialize};

use crate::{
    Figure, HistogramGrid, Panel, Picture, Series,
    numbers::{interval, optional},
    page::page,
    share::percent,
};

/// Panels in a figure at most; further numbers are in the table of the page and in the run tables.
const PANELS: usize = 24;

/// What the runs of a simulation under one or several models amount to: every number that its page shows.
///
/// It is written to a file, reads back, and its page is the same to the byte.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Overview {
    title: String,
    confidence: Confidence,
    models: Vec<Model>,
    quantities: Vec<Quantity>,
    figures: Vec<Figure>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Model {
    name: String,
    runs: u64,
    failed: Option<Share>,
    /// Kinds of failure, with how often.
    failures: Vec<(String, u64)>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Quantity {
    column: String,
    unit: String,
    meaning: String,
    /// One of each model.
    samples: Vec<SampleSummary>,
}

impl Overview {
    /// Of the run tables of models, which have the same columns.
    ///
    /// # Errors
    /// None for tables that runs have filled: shares of what is counted exist.
    pub fn new(title: &str, tables: &[Table]) -> Result<Self, StatisticsError> {
        let confidence = Confidence::default();
        let model = |table: &Table| {
            let failed = table.failures().len() as u64;
            let runs = table.len() as u64;
            Ok(Model {
                name: table.model().to_owned(),
                runs,
                failed: if runs == 0 { None } else { Some(Share::new(failed, runs, confidence)?) },
                failures: counted(table.failures().map(|(_, failure)| failure.kind().to_owned())),
            })
        };
        let numbers = tables.first().into_iter().flat_map(Table::columns);
        let numbers = numbers.filter(|column| column.kind() == Kind::Number);
        let quantities: Vec<Quantity> = numbers
            .map(|column| Quantity {
                column: column.name().to_owned(),
                unit: column.unit().unwrap_or("1").to_owned(),
                meaning: column.meaning().to_owned(),
                samples: tables
                    .iter()
                    .map(|table| sample(table, column.name(), confidence))
                    .collect(),
            })
            .collect();
        Ok(Self {
            title: title.to_owned(),
            confidence,
            models: tables.iter().map(model).collect::<Result<_, StatisticsError>>()?,
            figures: figure(tables, &quantities).into_iter().collect(),
            quantities,
        })
    }

    /// Its figures.
    #[must_use]
    pub fn figures(&self) -> &[Figure] {
        &self.figures
    }

    /// The page, of HTML that needs nothing but itself.
    #[must_use]
    pub fn page(&self) -> String {
        let models: Vec<&str> = self.models.iter().map(|model| model.name.as_str()).collect();
        let content = html! {
            h1 { (self.title) }
            p.lead {
                @for (i, model) in self.models.iter().enumerate() {
                    @if i > 0 { "; " }
                    (model.runs) @if model.runs == 1 { " run" } @else { " runs" } " of " strong { (model.name) }
                }
                ". Intervals have a confidence of " (100.0 * self.confidence.level()) " %."
            }
            @for model in &self.models { (failures(model)) }
            h2 { "Results" }
            p { "Mean ± standard deviation, and the range from the 5th to the 95th percentile." }
            div.wide { table.results {
                thead { tr { th { "quantity" } @for name in models { th { (name) } } } }
                tbody { @for quantity in &self.quantities { (row(quantity)) } }
            } }
            @for figure in &self.figures {
                figure id=(figure.name) {
                    // Made by this program, every text in it escaped.
                    (PreEscaped(figure.svg()))
                    figcaption { (figure.caption) "." }
                }
            }
        };
        page(&self.title, "", &content)
    }
}

fn sample(table: &Table, column: &str, confidence: Confidence) -> SampleSummary {
    SampleSummary::new(&table.values(column).unwrap_or_default(), confidence)
}

/// Every number whose runs differ.
fn figure(tables: &[Table], quantities: &[Quantity]) -> Option<Figure> {
    let differ = |quantity: &&Quantity| {
        quantity.samples.iter().any(|sample| sample.minimum < sample.maximum)
    };
    let shown: Vec<&Quantity> = quantities.iter().filter(differ).take(PANELS).collect();
    let values: Vec<Vec<Vec<f64>>> = shown
        .iter()
        .map(|q| tables.iter().map(|t| t.values(&q.column).unwrap_or_default()).collect())
        .collect();
    let mut panels = Vec::new();
    for (quantity, values) in shown.iter().zip(&values) {
        let series = tables.iter().zip(values);
        let series = series.map(|(table, values)| Series::new(table.model(), values, table.len()));
        let (label, series) = (label(quantity), series.collect());
        panels.push(Some(Panel { label, series, nominal: None }));
    }
    (!panels.is_empty()).then(|| Figure {
        name: "quantities".to_owned(),
        caption: "How the quantities are distributed over the runs".to_owned(),
        picture: Picture::Histograms(HistogramGrid::new("Quantities", &panels, 3)),
    })
}

fn label(quantity: &Quantity) -> String {
    match quantity.unit.as_str() {
        "1" => quantity.column.clone(),
        unit => format!("{} ({unit})", quantity.column),
    }
}

fn failures(model: &Model) -> Markup {
    html! {
        @if let Some(failed) = model.failed.filter(|failed| failed.count > 0) {
            p.warning {
                strong { (model.name) ": " (percent(&failed)) " of the runs failed" }
                " and have no results: "
                @for (i, (kind, count)) in model.failures.iter().take(5).enumerate() {
                    @if i > 0 { "; " }
                    (count) " × " (kind)
                }
                "."
            }
        }
    }
}

fn row(quantity: &Quantity) -> Markup {
    html! {
        tr {
            th scope="row" title=(quantity.meaning) { (label(quantity)) }
            @for sample in &quantity.samples {
                td {
                    span title=[tip(interval(sample.mean_interval, 4))] { (optional(sample.mean, 4)) }
                    " ± "
                    span title=[tip(interval(sample.deviation_interval, 4))] {
                        (optional(sample.deviation, 3))
                    }
                    br;
                    small title=[tip(interval(sample.p95_interval, 4))] {
                        (optional(sample.p05, 4)) " … " (optional(sample.p95, 4))
                    }
                }
            }
        }
    }
}

fn tip(text: String) -> Option<String> {
    Some(text).filter(|text| !text.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;
    use gyradius_campaign::{Cell, Column, Failure};
    use proptest::prelude::*;

    fn number() -> impl Strategy<Value = Option<f64>> {
        prop_oneof![
            3 => (-5.0..5.0).prop_map(Some),
            1 => Just(None),
            1 => prop::sample::select(vec![f64::NAN, f64::INFINITY, 1e300, -1e300, 0.0]).prop_map(Some),
        ]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Any tables, names that are markup, failures: the page from what was written is the same.
        #[test]
        fn what_reads_back_gives_the_same_page(
            runs in prop::collection::vec((number(), number(), any::<bool>()), 0..40),
            models in 1_usize..4,
        ) {
            let columns = || vec![
                Column::number("x_<m>", "m", "A \"number\"."),
                Column::number("y", "1", "Another."),
                Column::new("text", Kind::Text, "No number."),
            ];
            let tables: Vec<Table> = (0..models)
                .map(|model| {
                    let mut table = Table::new(&format!("<model & {model}>"), 0, columns()).unwrap();
                    for (x, y, failed) in &runs {
                        let failure = failed.then(|| Failure::new("<kind>", "<message>"));
                        table.push(failure, [(*x).into(), (*y).into(), Cell::Null]).unwrap();
                    }
                    table
                })
                .collect();
            let overview = Overview::new("a <title>", &tables).unwrap();
            let text = serde_json::to_string(&overview).unwrap();
            let read: Overview = serde_json::from_str(&text).unwrap();
            // Infinite means are null in JSON; whoever writes a page makes it from what is read.
            let again: Overview = serde_json::from_str(&serde_json::to_string(&read).unwrap()).unwrap();
            prop_assert_eq!(again.page(), read.page());
            let page = read.page();
            prop_assert!(!page.contains("<model &") && page.contains("&lt;model &amp; 0&gt;"));
            let failed = runs.iter().filter(|run| run.2).count();
            prop_assert_eq!(page.contains("of the runs failed"), failed > 0);
        }
    }
}
