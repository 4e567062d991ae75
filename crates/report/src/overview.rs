//! What the runs of any simulation amount to, as data, and the page that shows it.

use gyradius_campaign::{Column, Kind, SampleSummary, Share, Surveys, Table, counted};
use gyradius_statistics::{Confidence, StatisticsError};
use serde::{Deserialize, Serialize};

use crate::{
    Document, Figure, HistogramGrid, PageCell, PageTable, Panel, Picture, Section, Series, Text,
    kinds::most_frequent,
    numbers::{interval, optional, resolved, with_unit},
    share::percent,
};

/// Panels in a figure at most; further numbers are in the table of the page and in the run tables.
const PANELS: usize = 24;
/// The name of the figure.
const FIGURE: &str = "quantities";

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
            let failures = table.failures().map(|(_, failure)| failure.kind().to_owned());
            let (runs, failures) = (table.len() as u64, counted(failures));
            let failed = failures.iter().map(|(_, count)| count).sum();
            Model::new(table.model(), runs, failures, (failed, runs), confidence)
        };
        let columns = tables.first().map_or(&[][..], Table::columns);
        let quantities = quantities(columns, |column| {
            tables.iter().map(|table| sample(table, column, confidence)).collect()
        });
        Ok(Self {
            title: title.to_owned(),
            confidence,
            models: tables.iter().map(model).collect::<Result<_, StatisticsError>>()?,
            figures: figure(tables, &quantities).into_iter().collect(),
            quantities,
        })
    }

    /// Of surveys of the runs of models, which have these columns: in flat memory, for any number of runs.
    ///
    /// # Errors
    /// None for runs that were surveyed: shares of what is counted exist.
    pub fn of_surveys(
        title: &str,
        columns: &[Column],
        surveys: &[Surveys],
    ) -> Result<Self, StatisticsError> {
        let confidence = Confidence::default();
        let model = |surveys: &Surveys| {
            let failures = surveys.failures().into_iter();
            let failures = failures.map(|(kind, count)| (kind.to_owned(), count)).collect();
            let independent = surveys.independent();
            let failed = independent.failures().into_iter().map(|(_, count)| count).sum();
            let (name, runs) = (surveys.model(), surveys.runs());
            Model::new(name, runs, failures, (failed, independent.runs()), confidence)
        };
        let quantities = quantities(columns, |column| {
            let survey = |surveys: &Surveys| match surveys.column(column) {
                Some(survey) => SampleSummary::of(survey, confidence),
                None => SampleSummary::new(&[], confidence),
            };
            surveys.iter().map(survey).collect()
        });
        let panel = |quantity: &Quantity| {
            let series = surveys.iter().map(|surveys| {
                Series::surveyed(surveys.model(), surveys.column(&quantity.column), surveys.runs())
            });
            Some(Panel { label: quantity.label(), series: series.collect(), nominal: None })
        };
        let panels: Vec<_> = shown(&quantities).map(panel).collect();
        Ok(Self {
            title: title.to_owned(),
            confidence,
            models: surveys.iter().map(model).collect::<Result<_, StatisticsError>>()?,
            figures: of_panels(&panels).into_iter().collect(),
            quantities,
        })
    }

    /// Of each model its name, how many of its runs failed, and how many there are.
    pub fn failed(&self) -> impl Iterator<Item = (&str, u64, u64)> {
        let count = |model: &Model| model.failed.map_or(0, |failed| failed.count);
        self.models.iter().map(move |model| (model.name.as_str(), count(model), model.runs))
    }

    /// Of each model its name, and the kinds of failure with how often.
    pub fn failures(&self) -> impl Iterator<Item = (&str, &[(String, u64)])> {
        self.models.iter().map(|model| (model.name.as_str(), &model.failures[..]))
    }

    /// Of each quantity its column, its unit, and its sample under each model.
    pub fn quantities(&self) -> impl Iterator<Item = (&str, &str, &[SampleSummary])> {
        self.quantities.iter().map(|q| (q.column.as_str(), q.unit.as_str(), &q.samples[..]))
    }

    /// The figures that such a page may have, by name.
    #[must_use]
    pub fn figure_names() -> &'static [&'static str] {
        &[FIGURE]
    }

    /// The page, which says which runs failed.
    #[must_use]
    pub fn document(&self) -> Document {
        self.warning_of(self.models.iter().filter_map(failures))
    }

    /// The page behind sections that say which runs failed.
    #[must_use]
    pub fn document_led_by(&self, sections: impl IntoIterator<Item = Section>) -> Document {
        self.warning_of([]).led_by(sections)
    }

    fn warning_of(&self, warnings: impl IntoIterator<Item = Text>) -> Document {
        let mut lead = Text::default();
        for (i, model) in self.models.iter().enumerate() {
            let runs = if model.runs == 1 { "run" } else { "runs" };
            let before = if i > 0 { "; " } else { "" };
            lead = lead.plain(format!("{before}{} {runs} of ", model.runs)).strong(&model.name);
        }
        let percent = 100.0 * self.confidence.level();
        let lead = lead.plain(format!(". Intervals have a confidence of {percent} %."));
        let mut table = PageTable::of(&self.quantities).words("quantity", |q| {
            let name = Text::default().code(&q.column).plain(with_unit("", &q.unit));
            PageCell::from(name).line(Text::default().quiet(&q.meaning))
        });
        for (i, model) in self.models.iter().enumerate() {
            table = table.numbers(model.name.as_str(), |q| spread(q.samples.get(i)));
        }
        let results = Section::new("Results")
            .warnings(warnings)
            .paragraph(
                "Mean ± standard deviation, and the range from the 5th to the 95th percentile.",
            )
            .table(table)
            .figures(self.figures.iter().map(Figure::drawn));
        Document::new(&self.title, &self.title, lead).section(results)
    }
}

impl Model {
    /// `independent` says of how many runs that are independent how many failed.
    fn new(
        name: &str,
        runs: u64,
        failures: Vec<(String, u64)>,
        independent: (u64, u64),
        confidence: Confidence,
    ) -> Result<Self, StatisticsError> {
        let failed = failures.iter().map(|(_, count)| count).sum();
        let share = || Share::of_dependent(failed, runs, independent, confidence);
        let failed = if runs == 0 { None } else { Some(share()?) };
        Ok(Self { name: name.to_owned(), runs, failed, failures })
    }
}

impl Quantity {
    fn label(&self) -> String {
        with_unit(&self.column, &self.unit)
    }
}

fn sample(table: &Table, column: &str, confidence: Confidence) -> SampleSummary {
    SampleSummary::new(&table.values(column).unwrap_or_default(), confidence)
}

/// The numbers in columns, with the samples of each.
fn quantities(columns: &[Column], samples: impl Fn(&str) -> Vec<SampleSummary>) -> Vec<Quantity> {
    let numbers = columns.iter().filter(|column| column.kind() == Kind::Number);
    let quantity = |column: &Column| Quantity {
        column: column.name().to_owned(),
        unit: column.unit().unwrap_or("1").to_owned(),
        meaning: column.meaning().to_owned(),
        samples: samples(column.name()),
    };
    numbers.map(quantity).collect()
}

/// Every number whose runs differ.
fn shown(quantities: &[Quantity]) -> impl Iterator<Item = &Quantity> {
    let differ = |quantity: &&Quantity| {
        quantity.samples.iter().any(|sample| sample.minimum < sample.maximum)
    };
    quantities.iter().filter(differ).take(PANELS)
}

fn figure(tables: &[Table], quantities: &[Quantity]) -> Option<Figure> {
    let values: Vec<Vec<Vec<f64>>> = shown(quantities)
        .map(|q| tables.iter().map(|t| t.values(&q.column).unwrap_or_default()).collect())
        .collect();
    let mut panels = Vec::new();
    for (quantity, values) in shown(quantities).zip(&values) {
        let series = tables.iter().zip(values);
        let series = series.map(|(table, values)| Series::new(table.model(), values, table.len()));
        let (label, series) = (quantity.label(), series.collect());
        panels.push(Some(Panel { label, series, nominal: None }));
    }
    of_panels(&panels)
}

fn of_panels(panels: &[Option<Panel<'_>>]) -> Option<Figure> {
    (!panels.is_empty()).then(|| Figure {
        name: FIGURE.to_owned(),
        caption: "How the quantities are distributed over the runs".to_owned(),
        picture: Picture::Histograms(HistogramGrid::new("Quantities", panels, 3)),
    })
}

fn failures(model: &Model) -> Option<Text> {
    let failed = model.failed.filter(|failed| failed.count > 0)?;
    let kinds = most_frequent(&model.failures).join("; ");
    let share = format!("{}: {} of the runs failed", model.name, percent(&failed));
    Some(Text::default().strong(share).plain(format!(" and have no results: {kinds}.")))
}

/// Mean ± standard deviation, and below it the range from the 5th to the 95th percentile; the intervals of mean,
/// deviation and 95th percentile are told where the pointer rests on them.
#[must_use]
pub fn spread(sample: Option<&SampleSummary>) -> PageCell {
    let Some(s) = sample.filter(|s| s.n > 0) else { return PageCell::from("–") };
    let told = |x| resolved(x, s.deviation, 4);
    let line = Text::from(told(s.mean)).tip(interval(s.mean_interval, 4)).plain(" ± ");
    let line = line.plain(optional(s.deviation, 3)).tip(interval(s.deviation_interval, 4));
    let range = format!("{} … {}", told(s.p05), told(s.p95));
    PageCell::from(line).line(Text::default().quiet(range).tip(interval(s.p95_interval, 4)))
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
            prop_assert_eq!(again.document(), read.document());
            let page = read.document().html();
            prop_assert!(!page.contains("<model &") && page.contains("&lt;model &amp; 0&gt;"));
            let failed = runs.iter().filter(|run| run.2).count();
            prop_assert_eq!(page.contains("of the runs failed"), failed > 0);
        }
    }
}
