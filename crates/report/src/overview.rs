//! What the runs of any simulation amount to, as data, and the page that shows it.

use gyradius_campaign::{Column, Kind, SampleSummary, Share, Surveys, Table, counted};
use gyradius_statistics::{Confidence, StatisticsError};
use serde::{Deserialize, Serialize};

use crate::{
    Document, Figure, HistogramGrid, PageCell, PageTable, Panel, Picture, Section, Series, Text,
    kinds::most_frequent,
    naming::first_names,
    numbers::{interval, optional, resolved, with_unit},
    share::{of_some, percent},
};

/// Panels in a figure at most, five rows: as many as a sheet of paper has room for.
const PANELS: usize = 15;
/// Figures of a page at most; further numbers are in the table of the page and in the run tables.
const FIGURES: usize = 20;
/// The name of the first figure, behind which others have a number.
const FIGURE: &str = "quantities";
/// Quantities that are named of those that do not vary.
const NAMED: usize = 12;

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
            figures: figures(tables, &quantities),
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
        let panels: Vec<_> = drawn(&quantities).map(panel).collect();
        Ok(Self {
            title: title.to_owned(),
            confidence,
            models: surveys.iter().map(model).collect::<Result<_, StatisticsError>>()?,
            figures: of_panels(&panels),
            quantities,
        })
    }

    /// Of each model its name, how many of its runs failed, and how many there are.
    pub fn failed(&self) -> impl Iterator<Item = (&str, u64, u64)> {
        self.models.iter().map(|model| (model.name.as_str(), model.failures(), model.runs))
    }

    /// Of each model its name, and the kinds of failure with how often.
    pub fn failures(&self) -> impl Iterator<Item = (&str, &[(String, u64)])> {
        self.models.iter().map(|model| (model.name.as_str(), &model.failures[..]))
    }

    /// Of each quantity its column, its unit, and its sample under each model.
    pub fn quantities(&self) -> impl Iterator<Item = (&str, &str, &[SampleSummary])> {
        self.quantities.iter().map(|q| (q.column.as_str(), q.unit.as_str(), &q.samples[..]))
    }

    /// The figures that such a page of so many numbers may have, by name.
    pub fn figure_names(numbers: usize) -> impl Iterator<Item = String> {
        (0..numbers.div_ceil(PANELS).min(FIGURES)).map(name)
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

    /// Of which quantities there is nothing to draw, and why. Runs can have no value, and those that failed infinite ones, which are in no
    /// sample.
    fn constants(&self) -> impl Iterator<Item = String> {
        let [mut constant, mut infinite, mut without]: [Vec<String>; 3] = Default::default();
        for quantity in self.quantities.iter().filter(|quantity| !quantity.varies()) {
            let mut known = quantity.samples.iter().filter(|sample| sample.n > 0).peekable();
            let names = match (known.peek().is_some(), known.all(|sample| sample.minimum.is_some()))
            {
                (false, _) => &mut without,
                (true, true) => &mut constant,
                (true, false) => &mut infinite,
            };
            names.push(quantity.column.clone());
        }
        let told = [
            ("have the same value in all runs of each model that have a finite one", constant),
            ("have a value that is not finite", infinite),
            ("have no finite value in any run", without),
        ];
        let told = told.into_iter().filter(|(_, names)| !names.is_empty());
        told.map(|(why, names)| {
            let names = first_names(names, NAMED);
            format!("There is no figure of the following, which {why}: {names}.")
        })
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
            table =
                table.numbers(model.name.as_str(), |q| spread(q.samples.get(i), model.succeeded()));
        }
        let others: Vec<&str> =
            differing(&self.quantities).skip(FIGURES * PANELS).map(|q| q.column.as_str()).collect();
        let left_out = match others[..] {
            [] => None,
            [only] => Some(format!("{only} is in no figure, for there are many quantities.")),
            [first, .., last] => Some(format!(
                "The {} quantities from {first} to {last} in this table are in no figure, for there are many.",
                others.len()
            )),
        };
        let results = Section::new("Results")
            .warnings(warnings)
            .paragraph(
                "Mean ± standard deviation, and the range from the 5th to the 95th percentile.",
            )
            .table(table);
        let results = left_out
            .into_iter()
            .chain(self.constants())
            .fold(results, Section::paragraph)
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

    /// Runs that failed.
    fn failures(&self) -> u64 {
        self.failed.map_or(0, |failed| failed.count)
    }

    /// Runs that did not fail.
    fn succeeded(&self) -> u64 {
        self.runs.saturating_sub(self.failures())
    }
}

impl Quantity {
    fn label(&self) -> String {
        with_unit(&self.column, &self.unit)
    }

    /// Whether the runs of a model differ in it.
    fn varies(&self) -> bool {
        self.samples.iter().any(|sample| sample.minimum < sample.maximum)
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
fn differing(quantities: &[Quantity]) -> impl Iterator<Item = &Quantity> {
    quantities.iter().filter(|quantity| quantity.varies())
}

/// Those that have a panel.
fn drawn(quantities: &[Quantity]) -> impl Iterator<Item = &Quantity> {
    differing(quantities).take(FIGURES * PANELS)
}

fn figures(tables: &[Table], quantities: &[Quantity]) -> Vec<Figure> {
    let values: Vec<Vec<Vec<f64>>> = drawn(quantities)
        .map(|q| tables.iter().map(|t| t.values(&q.column).unwrap_or_default()).collect())
        .collect();
    let mut panels = Vec::new();
    for (quantity, values) in drawn(quantities).zip(&values) {
        let series = tables.iter().zip(values);
        let series = series.map(|(table, values)| Series::new(table.model(), values, table.len()));
        let (label, series) = (quantity.label(), series.collect());
        panels.push(Some(Panel { label, series, nominal: None }));
    }
    of_panels(&panels)
}

/// The name of the figure in a place.
fn name(place: usize) -> String {
    if place == 0 { FIGURE.to_owned() } else { format!("{FIGURE}-{}", place + 1) }
}

fn of_panels(panels: &[Option<Panel<'_>>]) -> Vec<Figure> {
    let all = panels.len().div_ceil(PANELS);
    let figure = |(place, panels): (usize, &[Option<Panel<'_>>])| {
        let part = if all > 1 { format!(", {} of {all}", place + 1) } else { String::new() };
        Figure {
            name: name(place),
            caption: format!("How the quantities are distributed over the runs{part}"),
            picture: Picture::Histograms(HistogramGrid::new(
                &format!("Quantities{part}"),
                panels,
                3,
            )),
        }
    };
    panels.chunks(PANELS).enumerate().map(figure).collect()
}

fn failures(model: &Model) -> Option<Text> {
    let failed = model.failed.filter(|failed| failed.count > 0)?;
    let kinds = most_frequent(&model.failures).join("; ");
    let share = format!("{}: {} of the runs failed", model.name, percent(&failed));
    Some(Text::default().strong(share).plain(format!(" and have no results: {kinds}.")))
}

/// Mean ± standard deviation, and below it the range from the 5th to the 95th percentile; the intervals of mean,
/// deviation and 95th percentile are told where the pointer rests on them. Of how many of so many runs they are is said where
/// others have no value.
#[must_use]
pub fn spread(sample: Option<&SampleSummary>, runs: u64) -> PageCell {
    let Some(s) = sample.filter(|s| s.n > 0) else { return PageCell::from("–") };
    let told = |x| resolved(x, s.deviation, 4);
    let line = Text::from(told(s.mean)).tip(interval(s.mean_interval, 4)).plain(" ± ");
    let line = line.plain(optional(s.deviation, 3)).tip(interval(s.deviation_interval, 4));
    let range = format!("{} … {}", told(s.p05), told(s.p95));
    PageCell::from(line)
        .line(Text::default().quiet(range).tip(interval(s.p95_interval, 4)))
        .noting(of_some(s.n, runs))
}

#[cfg(test)]
mod tests;
