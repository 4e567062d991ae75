//! The report of a study: what it says of separations and of the paper.

mod releases;

use gyradius_campaign::{Rows, SampleSummary};
use gyradius_report::{
    Document, Drawing, Figure, PageCell, PageTable, Section, Text, Tone, direction, file_of,
    interval, of_some, optional, percent, resolved, significant, spread,
};
use gyradius_statistics::Interval;
use nalgebra::{Unit, Vector3};
use rayon::prelude::*;

use crate::{
    body::{Body, Entry},
    claim::Verdict,
    claims::{CONSIDERABLE, IDENTICAL, LESS, ONE_SIDED, RARE},
    configuration::sketch,
    decisions, drivers, far_lobe, faults, figures_of_study,
    head::Head,
    quantity::Quantity,
    regions,
    scenario::{Comparison, Each, Scenario},
    subject::Subject,
    summary::{LateSummary, ModelSummary, Summary},
};

/// Its pages are called so.
pub(crate) const NAME: &str = "report";

/// What may be written of the report of a study, as files and folders.
pub(crate) fn files(scenario: &Scenario) -> impl Iterator<Item = String> {
    let figures = figures_of_study::names(scenario).into_iter().map(|name| file_of(&name));
    figures.chain(Document::pages(NAME)).chain(["figures/".to_owned()])
}

const DEPENDENT: &str = "The flights of a vehicle share what is drawn once for it, so that runs are not independent. \
                         Intervals of means and standard deviations therefore take the vehicles for what is independent, \
                         and those of percentiles and shares are of the first flight of each vehicle alone, so that the \
                         number itself, which is of all runs, can lie beside its interval.";

/// The report, made from results that were read back.
pub(crate) fn report(scenario: &Scenario, summary: &Summary) -> Document {
    let models: Vec<&str> = summary.models.iter().map(|m| m.name.as_str()).collect();
    let vehicles = summary.head.fleet.map_or_else(String::new, |fleet| format!("{fleet}, "));
    let lead = Text::from("Scenario ").strong(&summary.head.scenario).plain(format!(
        ": {vehicles}{} {} of {} {}, seed {}. Intervals have a confidence of {} %; p95 is the 95th \
         percentile.",
        summary.head.runs_per_model,
        if summary.head.runs_per_model == 1 { "run" } else { "runs" },
        if models.len() == 1 { "the model" } else { "each of the models" },
        models.join(", "),
        summary.head.seed,
        100.0 * summary.head.confidence
    ));
    let lead = lead.plain(dependence(&summary.head));
    let drawn: Vec<_> = summary.figures.par_iter().map(Figure::drawn).collect();
    let title = format!("gyradius study: {}", summary.head.scenario);
    let document = Document::new(title, "Separation under inertia uncertainty", lead);
    noting_what_is_missing(document, &summary.head)
        .sections(summary.head.about.section())
        .sections(decisions::sections(scenario, &summary.head))
        .section(results(scenario, summary))
        .section(parting(scenario, summary))
        .sections(drivers::section(&summary.head, &scenario.main_outcomes()))
        .sections(decisions::where_runs_fail::<Scenario>(&summary.head))
        .sections(faults(summary))
        .sections(scenario.source().map(|_| claims(summary)))
        .sections(ratios(summary))
        .sections(deviations(scenario, summary))
        .sections(far_lobe::section(summary))
        .sections(dispersed(summary))
        .sections(regions::section(summary.models.iter().map(|m| (&*m.name, &*m.regions))))
        .sections(summary.every_model.section())
        .section(Section::new("Figures").figures(drawn))
        .section(inputs(scenario, &summary.head, Some(sketch(scenario))))
}

fn results(scenario: &Scenario, summary: &Summary) -> Section {
    // None for the nominal bodies.
    let rows: Vec<Option<&ModelSummary>> = summary.models.iter().map(Some).chain([None]).collect();
    let mut table = PageTable::of(&rows)
        .words("model", |model| model.map_or("nominal bodies", |m| m.name.as_str()))
        .numbers("unrealizable draws", |model| {
            model.map_or_else(|| "–".to_owned(), |m| percent(&m.unrealizable))
        })
        .quiet(Option::is_none);
    for q in Quantity::behaviour() {
        let of = |cell: fn(&SampleSummary) -> Text| {
            move |model: &Option<&ModelSummary>| match model.map(|m| sample(m, q)) {
                Some(Some(sample)) => cell(sample),
                Some(None) => "–".into(),
                None => Text::default(),
            }
        };
        let heading = q.label_with_unit();
        table = table
            .numbers_of(&heading, "mean", |model| {
                let Some(model) = model else {
                    return PageCell::from(optional(summary.nominal_value(q), 4));
                };
                let mean = optional(sample(model, q).and_then(|s| s.mean), 4);
                PageCell::from(mean).noting(of_some_runs(model, q))
            })
            .numbers_of(
                &heading,
                "sd",
                of(|s| number(s.deviation, 3, interval(s.deviation_interval, 4))),
            )
            .numbers_of(&heading, "p95", of(|s| number(s.p95, 4, interval(s.p95_interval, 4))));
    }
    let terms = Text::default()
        .strong("Wobble")
        .plain(
            format!(
                ": the angle between the axis that the payload is meant to spin about, {} in its body axes, and its nearest \
                 principal axis of inertia. It follows from the inertia alone. ",
                direction((*scenario.spin_axis().as_ref()).into())
            ),
        )
        .strong("Nutation")
        .plain(
            ": the angle between that principal axis and the angular momentum after the last release, about which the body \
             moves like a top. ",
        )
        .strong("Cone")
        .plain(
            ": the angle between the intended spin axis and the angular momentum, about which the spin axis then sweeps a \
             cone: wobble and nutation together. ",
        )
        .strong("Inertia ratio")
        .plain(": of the moment about the spin axis to those about the other two, above 1 where it is the largest of the three.");
    Section::new("What the payload does").paragraph(terms).table(table)
}

fn faults(summary: &Summary) -> Option<Section> {
    let models = summary.models.iter();
    let models: Vec<_> = models.map(|m| (m.name.as_str(), m.faults.as_slice())).collect();
    faults::section(&models)
}

fn sample(model: &ModelSummary, quantity: Quantity) -> Option<&SampleSummary> {
    model.quantity(quantity).map(|q| &q.sample)
}

/// Of how many runs of a model the statistics of a quantity are, where not all of those that did not fail have a value.
fn of_some_runs(model: &ModelSummary, quantity: Quantity) -> Option<String> {
    let n = sample(model, quantity).map(|sample| sample.n).filter(|n| *n > 0)?;
    of_some(n, model.succeeded())
}

/// A number, with its interval where the pointer rests on it.
fn number(x: Option<f64>, digits: usize, interval: String) -> Text {
    Text::from(optional(x, digits)).tip(interval)
}

/// How the bodies separate, a quantity a row.
fn parting(scenario: &Scenario, summary: &Summary) -> Section {
    let said = |of: Option<&Unit<Vector3<f64>>>| match of {
        Some(of) => direction((*of.as_ref()).into()),
        None => "none, for the springs' forces cancel".to_owned(),
    };
    let clearance = scenario.outlines().map_or_else(String::new, |outlines| {
        format!(
            "Clearance: the smallest distance of the outlines in the {} s after the last release, 0 where any \
             two of them touch, before it too. Outlines that touch when the clamp opens are mated: those \
             that have parted by the last release count from then on, and the others only if they touch again after \
             they have parted. ",
            outlines.coast_s()
        )
    });
    let reading = format!(
        "Velocity of the mass centres from each other, and its angle to the intended direction {}; tip-off: change \
         of the angular velocity, body axes; greatest nutation of the free motion that follows; angle of the \
         payload's angular momentum to the intended direction {}. Directions are in inertial axes, and the same \
         for all runs; where the scenario does not state them they are those of the undispersed bodies. Inertia \
         ratio and nutation: I₁ is the moment about the principal axis nearest to the spin axis, I₂ and I₃ those \
         about the next two in cyclic order, each principal axis having the number of the body axis that it is \
         matched to; a nutation above 90° is of a backward spin. Angles of a payload whose angular momentum is no \
         more than rounding are not told. {clearance}Mean ± standard deviation, and the range from the 5th to the \
         95th percentile.",
        said(scenario.separation_direction()),
        said(Some(scenario.momentum_direction())),
    );
    // What no run has is not asked.
    let has = |q: &Quantity| summary.models.iter().any(|m| sample(m, *q).is_some_and(|s| s.n > 0));
    let parting: Vec<Quantity> = Quantity::parting().into_iter().filter(has).collect();
    let mut table = PageTable::of(&parting).words("quantity", |q| q.label_with_unit());
    for model in &summary.models {
        table = table.numbers(&model.name, |q| spread(sample(model, *q), model.succeeded()));
    }
    let table = table.numbers("nominal bodies", |q| optional(summary.nominal_value(*q), 4));
    let releases: Vec<Text> = summary.models.iter().filter_map(releases::told).collect();
    let springs =
        (!releases.is_empty()).then(|| Section::new("Springs and contact").list(releases));
    let section = Section::new("Separation");
    if parting.is_empty() {
        return section.paragraph("No run has an outcome: every run failed.");
    }
    section.paragraph(reading).table(table).sections(springs)
}

fn claims(summary: &Summary) -> Section {
    let reading = format!(
        "Peck (2003) claims the following of physically realizable models and of independent Gaussian entries. \
         “Considerably more” is taken as a deviation larger by at least {:.0} %, “less” as a mean lower by at \
         least {} %, “the same” as within {} %, “one-sided” as a skewness beyond {}. That something happens is refuted if it surely happens in \
         less than {} % of the runs. A claim holds in a \
         comparison if the whole interval is on its side of that line, and does not if the whole interval is on \
         the other; otherwise it is undecided, and more runs are needed. What holds in one comparison and not, or not surely, in another \
         holds in part.",
        100.0 * (CONSIDERABLE - 1.0),
        100.0 * LESS,
        100.0 * IDENTICAL,
        significant(ONE_SIDED, 1),
        100.0 * RARE
    );
    let table = PageTable::of(&summary.claims)
        .words("claim", |c| c.claim.as_str())
        .words("what this study finds", |c| -> PageCell {
            c.findings.iter().map(Text::from).collect()
        })
        .words("verdict", |c| Text::default().badge(tone(c.verdict), c.verdict.words()));
    Section::new("The paper's claims").paragraph(reading).table(table)
}

fn tone(verdict: Verdict) -> Tone {
    match verdict {
        Verdict::Holds => Tone::Good,
        Verdict::HoldsInPart => Tone::Part,
        Verdict::DoesNotHold => Tone::Bad,
        Verdict::NotTested => Tone::Open,
    }
}

fn ratios(summary: &Summary) -> Option<Section> {
    let mut table = PageTable::of(&summary.comparisons).words("comparison", |c| {
        PageCell::from(&c.title)
            .line(Text::default().quiet(format!("{} over {}", c.naive, c.physical)))
    });
    for q in Quantity::behaviour() {
        table = table.numbers(q.label(), |c| {
            let ratio = c.ratio(q);
            let cell = estimate(
                ratio.and_then(|r| r.deviation_ratio),
                ratio.and_then(|r| r.deviation_ratio_interval),
            );
            [&c.naive, &c.physical].into_iter().fold(cell, |cell, name| {
                let of_some = summary.model(name).and_then(|model| of_some_runs(model, q));
                cell.noting(of_some.map(|of_some| format!("{name}: {of_some}")))
            })
        });
    }
    let section = Section::new("Variation under the naive models").paragraph(
        "Deviation under the naive model over deviation under the physical one. The interval holds for \
         distributions of any shape whose kurtosis the runs show; where the tails are heavy, which is told before \
         the results, it covers the true ratio less often than it says.",
    );
    (!summary.comparisons.is_empty()).then(|| section.table(table))
}

/// A number and its interval below it.
fn estimate(x: Option<f64>, of: Option<Interval>) -> PageCell {
    PageCell::from(optional(x, 4)).line(Text::default().quiet(interval(of, 4)))
}

/// Table 2: the deviations that a naive model was given beside those of the physical one.
fn deviations(scenario: &Scenario, summary: &Summary) -> Vec<Section> {
    let names: Vec<&str> = scenario.model_names().collect();
    let table = scenario.source().map_or("", |_| " (Table 2)");
    let section = |comparison: &Comparison| {
        let physical = summary.model(names[comparison.physical])?;
        let naive = summary.model(names[comparison.naive])?;
        let given = naive.given_deviations_kg_m2?;
        let reading = Text::from("Standard deviations in kg·m²: those of the runs of ")
            .strong(&physical.name)
            .plain(", and those that ")
            .strong(&naive.name)
            .plain(" was given.");
        let heading = format!("Deviations of the entries{table}: {}", comparison.title);
        let table = deviation_table(physical, naive, given);
        Some(Section::new(heading).paragraph(reading).table(table))
    };
    scenario.comparisons().iter().filter_map(section).collect()
}

fn deviation_table(
    physical: &ModelSummary,
    naive: &ModelSummary,
    given: [[f64; 6]; 2],
) -> PageTable {
    #[derive(Clone, Copy)]
    enum Row {
        Found,
        Given,
        Ratio,
    }
    let rows: Vec<(Body, Row)> = Body::BOTH
        .into_iter()
        .flat_map(|body| [Row::Found, Row::Given, Row::Ratio].map(|row| (body, row)))
        .collect();
    let mut table = PageTable::of(&rows)
        .words("deviation", |(_, row)| match row {
            Row::Found => physical.name.clone(),
            Row::Given => format!("{}, given", naive.name),
            Row::Ratio => "given over found".to_owned(),
        })
        .groups(|(body, _)| body.name().to_owned());
    for (i, entry) in Entry::ALL.into_iter().enumerate() {
        table = table.numbers(Quantity::entry(Body::Payload, entry).label(), |(body, row)| {
            let found = sample(physical, Quantity::entry(*body, entry));
            let deviation = found.and_then(|s| s.deviation);
            let given = given[*body as usize][i];
            match row {
                Row::Found => estimate(deviation, found.and_then(|s| s.deviation_interval)),
                Row::Given => significant(given, 4).into(),
                Row::Ratio => optional(deviation.filter(|d| *d > 0.0).map(|d| given / d), 3).into(),
            }
        });
    }
    table.into()
}

/// What is uncertain besides the inertias.
fn dispersed(summary: &Summary) -> Option<Section> {
    let given = summary.models.first().map(|m| &m.dispersed).filter(|d| !d.is_empty())?;
    let rows: Vec<_> = given.iter().enumerate().collect();
    let mut table = PageTable::of(&rows)
        .words("quantity", |(_, d)| Text::default().code(&d.quantity))
        .words("law", |(_, d)| d.law.as_ref());
    if summary.head.fleet.is_some() {
        table = table.words("drawn", |(_, d)| match d.drawn {
            Each::Vehicle => "for each vehicle",
            Each::Flight => "for each flight",
        });
    }
    let mut table = table
        .numbers("nominal", |(_, d)| significant(d.nominal, 5))
        .numbers("mean", |(_, d)| significant(d.law_mean, 5))
        .numbers("sd", |(_, d)| significant(d.law_deviation, 5));
    for model in &summary.models {
        table = table.numbers(format!("drawn by {}", model.name), |(i, _)| {
            let Some(drawn) = model.dispersed.get(*i) else { return PageCell::from("–") };
            let told = |mean: Option<f64>, deviation: Option<f64>| {
                PageCell::from(format!(
                    "{} ± {}",
                    resolved(mean, deviation, 5),
                    optional(deviation, 4)
                ))
            };
            match drawn.late {
                Some(LateSummary { runs: 0, .. }) => {
                    PageCell::from("–").line(Text::default().quiet("late in no run"))
                }
                Some(LateSummary { runs, mean, deviation }) => told(mean, deviation)
                    .line(Text::default().quiet(format!("late in {runs} runs"))),
                None => told(drawn.mean, drawn.deviation),
            }
        });
    }
    let reading = "Mean and standard deviation of the law of each quantity, and of what each model drew, in the \
                   unit of its name. Every draw is in the run table.";
    let may_be_late = given.iter().any(|d| d.late.is_some());
    let of_late = " A law of when a late spring starts is that of the runs in which it is late, and is held against these alone.";
    let reading = format!("{reading}{}", if may_be_late { of_late } else { "" });
    Some(Section::new("What else was dispersed").paragraph(reading).table(table))
}

/// What intervals stand for, if runs are not independent.
fn dependence(head: &Head) -> String {
    head.independent_runs_per_model.map_or_else(String::new, |_| format!(" {DEPENDENT}"))
}

/// Says on a page which vehicles the runs are flights of, if there are vehicles.
pub(crate) fn noting_vehicles(document: Document, head: &Head) -> Document {
    match head.fleet {
        Some(fleet) => document.noting(format!(" {fleet}."), dependence(head)),
        None => document,
    }
}

/// Says on a page which runs are missing, if any are, and how many were done again.
pub(crate) fn noting_what_is_missing(mut document: Document, head: &Head) -> Document {
    if head.done_again > 0 {
        let again = match head.done_again {
            1 => " 1 run that had failed was done again.".to_owned(),
            runs => format!(" {runs} runs that had failed were done again."),
        };
        document = document.noting("", again);
    }
    if head.is_interrupted() {
        document = document.noting(" A rule has not ended the runs yet.", String::new());
    }
    if head.missing.is_empty() {
        return document;
    }
    let runs: Vec<String> = head.missing.iter().map(ToString::to_string).collect();
    document.noting(" Not all runs are done.", format!(" These are missing: {}.", runs.join(", ")))
}

/// The resolved scenario, and where what is.
pub(crate) fn inputs(scenario: &impl Subject, head: &Head, sketch: Option<Drawing>) -> Section {
    let (kept, toml) = (scenario.kept(), scenario.to_toml());
    let version = &head.gyradius_version;
    let origin = Text::from(format!(
        "Run by gyradius {version} from the scenario below, defaults filled in; its SHA-256 is "
    ))
    .code(&head.fingerprint)
    .plain(". The same scenario gives the same numbers on any number of threads");
    let origin = match scenario.function_name() {
        Some(name) => origin.plain(", in the program that has the function ").code(name).plain("."),
        None => origin.plain(": ").code("gyradius study --scenario scenario.toml").plain("."),
    };
    let rows = |which: &str| Text::from(format!("{which} is a row of ")).code("runs/<model>/");
    let files = match kept.rows() {
        Rows::All => rows("Every run"),
        Rows::Failed => {
            rows("Every run that failed").plain(" (the rows of the others were not kept)")
        }
        Rows::None => Text::from("The rows of the runs were not kept"),
    };
    let some = kept.columns().map_or("", |_| " Not all columns of the run tables were kept.");
    let files = files
        .plain(", every number of this page is in ")
        .code("summary.json")
        .plain(".")
        .plain(some);
    let text = Section::folded("scenario.toml").file("toml", toml);
    let section = Section::new("Inputs").figures(sketch);
    section.paragraph(origin).paragraph(files).sections([text])
}
