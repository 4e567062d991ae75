//! Where runs fail, as the report tells it.

use gyradius_campaign::share_in_percent;
use gyradius_report::{
    PageCell, PageTable, Section, Text, first_names, interval, resolved, significant,
};
use gyradius_statistics::{Confidence, Estimate, Tenth};

use super::{Correlation, Failures, LEAST, OUTCOMES, Pair, RANKED, RUNS, Tenths, WhereRunsFail};

/// Adjusted p-values below this are shown.
const SHOWN_BELOW: f64 = 0.01;
/// Inputs and pairs of a requirement, and inputs of an outcome, that are shown at most.
const INPUTS: usize = 6;
const PAIRS: usize = 5;
const CORRELATIONS: usize = 10;
/// Outcomes that are named of those that are left out.
const NAMED: usize = 8;
const FIFTHS: [&str; 5] = ["lowest", "second", "middle", "fourth", "highest"];

/// Where runs fail, if a requirement has failures enough; and with which inputs outcomes rise and fall: those that the requirements of a
/// model are about, or, of a model without any, those that are called so.
pub(crate) fn sections(
    found: &[WhereRunsFail],
    vehicles: bool,
    required: impl Fn(&str) -> bool,
    main: &str,
) -> Vec<Section> {
    let correlations = correlations(found, vehicles, required, main);
    separating(found, vehicles).into_iter().chain(correlations).collect()
}

/// A requirement with the model whose runs fail it.
type Of<'a, T> = (&'a str, &'a Failures, &'a T);

fn separating(found: &[WhereRunsFail], vehicles: bool) -> Option<Section> {
    let all: Vec<(&str, &Failures)> = found
        .iter()
        .flat_map(|of| of.requirements.iter().map(move |failures| (of.model.as_str(), failures)))
        .collect();
    if all.is_empty() {
        return None;
    }
    let inputs: Vec<Of<'_, Tenths>> = all
        .iter()
        .flat_map(|(model, failures)| failures.shown_inputs().map(move |i| (*model, *failures, i)))
        .collect();
    let pairs: Vec<Of<'_, Pair>> = all
        .iter()
        .flat_map(|(model, failures)| failures.shown_pairs().map(move |p| (*model, *failures, p)))
        .collect();
    let nothing = all.iter().filter(|(_, failures)| {
        failures.shown_inputs().next().is_none() && failures.shown_pairs().next().is_none()
    });
    let nothing = nothing.map(|(model, failures)| {
        format!(
            "{}: neither an input nor a pair of inputs separates the failing runs from the others.",
            heading(model, failures)
        )
    });
    let reading = format!(
        "For each requirement that at least {LEAST} runs fail and at least {LEAST} runs keep: the runs are sorted by one input and cut \
         into ten parts of the same size, the tenths of the input. Runs with the same value stay in one part, so that an input that is the \
         same in many runs, as a start time that is 0 in most, has larger parts, and fewer; how many runs a part has stands in the \
         table. If an input has nothing to do with the failures, about the \
         same share of the runs fails in each tenth, and p says how often chance alone would make the shares differ so much. \
         Inputs are shown with p below {SHOWN_BELOW}, at most {INPUTS} of them. So many inputs are tested that some would stand out by \
         chance; every p is therefore raised so far (Holm’s correction) that all inputs of a requirement together have a probability of at \
         most 1 % to show even one that has nothing to do with the failures."
    );
    let caution = format!(
        "A difference between tenths shows that failures and an input go together, not that the input is the cause: inputs that depend on \
         each other, as the entries of an inertia matrix do, each show what the other one does. {} A run that \
         failed counts as a failure if it has the input, unless the requirement leaves such runs out.",
        which(RUNS, vehicles)
    );
    let mut section = Section::new("Where runs fail").paragraph(reading).paragraph(caution);
    if !inputs.is_empty() {
        section = section.table(table_of_inputs(&inputs));
    }
    if !pairs.is_empty() {
        let reading = format!(
            "Two inputs together can separate failing runs that neither of them separates alone: runs may fail only where both are high, \
             say. The runs are cut into the fifths of both inputs, as into the tenths of one, which makes 25 cells at most, and p says how often chance alone would make \
             the cells differ so much, if one of the two inputs added nothing to the other. It is corrected for the number of \
             pairs in the same way. It holds for inputs that are drawn independently of each other: of two that depend on each \
             other, one may seem to add to the other only because fifths are wide. At most {PAIRS} pairs are shown."
        );
        section = section.paragraph(reading).table(table_of_pairs(&pairs));
    }
    Some(section.list(nothing))
}

/// Which runs are looked at.
fn which(most: u64, vehicles: bool) -> String {
    let of = if vehicles { ", the first flight of each vehicle alone" } else { "" };
    let runs = most / 1000;
    format!(
        "Counted are the runs of each model in the order of their numbers, at most the first {runs},000{of}."
    )
}

fn heading(model: &str, failures: &Failures) -> String {
    let Failures { requirement, runs, failures, .. } = failures;
    format!("{requirement}, {model} ({failures} of {runs} runs fail it)")
}

fn table_of_inputs(inputs: &[Of<'_, Tenths>]) -> PageTable {
    PageTable::of(inputs)
        .words("input", |(.., input)| Text::default().code(&input.input))
        .groups(|(model, failures, _)| heading(model, failures))
        .numbers_of("share of the runs that fails", "in the lowest tenth", |(.., input)| {
            share_of(input.shares.tenths().first())
        })
        .numbers_of("share of the runs that fails", "in the middle ones", |(.., input)| {
            let tenths = input.shares.tenths();
            share_of(tenths.get(1..tenths.len().saturating_sub(1)).unwrap_or_default())
        })
        .numbers_of("share of the runs that fails", "in the highest tenth", |(.., input)| {
            share_of(input.shares.tenths().last())
        })
        .words("most failures", |(.., input)| most(input))
        .numbers("p", |(.., input)| p(input.adjusted_p_value))
        .into()
}

/// The share of runs that fails in some tenths.
fn share_of<'a>(tenths: impl IntoIterator<Item = &'a Tenth>) -> PageCell {
    let add = |[runs, failures]: [u64; 2], tenth: &Tenth| {
        [runs + tenth.runs(), failures + tenth.failures()]
    };
    match tenths.into_iter().fold([0, 0], add) {
        [0, _] => "–".into(),
        [runs, failures] => share(failures, runs),
    }
}

fn share(failures: u64, runs: u64) -> PageCell {
    let share = share_in_percent(failures as f64 / runs as f64);
    PageCell::from(share).line(Text::default().quiet(format!("{failures} of {runs}")))
}

/// The tenth of which the largest share fails.
fn most(input: &Tenths) -> PageCell {
    let share = |tenth: &Tenth| tenth.failures() as f64 / tenth.runs() as f64;
    let tenths = input.shares.tenths().iter();
    let most = tenths.reduce(|a, b| if share(b) > share(a) { b } else { a });
    most.map_or_else(
        || "–".into(),
        |tenth| {
            let [from, to] = [tenth.least(), tenth.greatest()].map(|x| significant(x, 4));
            let values = if from == to { from } else { format!("{from} to {to}") };
            let [lower, upper] =
                [tenth.interval().lower(), tenth.interval().upper()].map(share_in_percent);
            let (failures, runs, of) = (tenth.failures(), tenth.runs(), share(tenth));
            PageCell::from(values).line(Text::default().quiet(format!(
                "{} ({lower} … {upper}), {failures} of {runs}",
                share_in_percent(of)
            )))
        },
    )
}

fn table_of_pairs(pairs: &[Of<'_, Pair>]) -> PageTable {
    PageTable::of(pairs)
        .words("pair of inputs", |(.., pair)| {
            let [x, y] = &pair.inputs;
            Text::default().code(x).plain(" and ").code(y)
        })
        .groups(|(model, failures, _)| heading(model, failures))
        .words("fifths of both with the clearest excess of failures", |(.., pair)| {
            let named = pair.clearest_excess.fifths.map(|fifth| {
                FIFTHS.get(usize::from(fifth)).map_or_else(String::new, |name| (*name).to_owned())
            });
            named.join(" and ")
        })
        .numbers("share that fails there", |(.., pair)| {
            share(pair.clearest_excess.failures, pair.clearest_excess.runs.max(1))
        })
        .numbers("p", |(.., pair)| p(pair.adjusted_p_value))
        .into()
}

/// A p-value that is below what is shown.
fn p(p: f64) -> String {
    if p < 1e-6 { "below 10⁻⁶".to_owned() } else { significant(p, 2) }
}

/// With which inputs outcomes rise and fall.
fn correlations(
    found: &[WhereRunsFail],
    vehicles: bool,
    required: impl Fn(&str) -> bool,
    main: &str,
) -> Option<Section> {
    let mut rows: Vec<(String, &str, Estimate)> = Vec::new();
    for of in found {
        for outcome in &of.rank_correlations {
            let shown = shown(&outcome.inputs).into_iter();
            let heading = format!("{}, {}", outcome.outcome, of.model);
            rows.extend(shown.map(|(input, estimate)| (heading.clone(), input, estimate)));
        }
    }
    // With requirements, what these are about is all that is asked.
    let models = || found.iter().filter(|of| !of.rank_correlations.is_empty());
    let are = |asked: bool| models().any(|of| required(&of.model) == asked);
    let of_requirements = "each quantity that the requirements of the model are about";
    let outcomes = match [are(true), are(false)] {
        [true, false] => of_requirements.to_owned(),
        [true, true] => format!("{of_requirements}, and for a model without requirements {main},"),
        [false, _] => main.to_owned(),
    };
    let reading = format!(
        "The rank correlation (Spearman) of an input and an outcome is 1 if the outcome always rises with the input, −1 if it always falls, \
         and near 0 if it does neither: also if the outcome is lowest for middle values of the input, although the input matters \
         then. For {outcomes} the inputs are shown whose interval of 95 % leaves out 0, at most {CORRELATIONS}, the strongest first. \
         About one in twenty inputs without any effect is shown by chance. {} Runs without the outcome, as those that failed, are \
         left out.",
        which(RANKED as u64, vehicles)
    );
    let table = PageTable::of(&rows)
        .words("input", |(_, input, _)| Text::default().code(*input))
        .groups(|(heading, ..)| heading.clone())
        .numbers("rank correlation", |(.., estimate)| {
            let interval = estimate.interval();
            resolved(Some(estimate.value()), Some(interval.upper() - interval.lower()), 2)
        })
        .numbers("interval", |(.., estimate)| interval(Some(estimate.interval()), 2));
    let section = Section::folded("Rank correlations of inputs and outcomes");
    // The same of all models without requirements.
    let left_out = models().map(|of| &of.outcomes_left_out).find(|names| !names.is_empty());
    let left_out = left_out.map(|names| {
        let names = first_names(names.iter().cloned(), NAMED);
        format!("Left out are the outcomes after the first {OUTCOMES}: {names}.")
    });
    let section = section.paragraph(reading);
    let section = left_out.into_iter().fold(section, Section::paragraph);
    (!rows.is_empty()).then(|| section.table(table))
}

/// The correlations whose interval leaves out 0, the strongest first.
fn shown(inputs: &[Correlation]) -> Vec<(&str, Estimate)> {
    let estimates =
        inputs.iter().map(|of| (of.input.as_str(), of.rank.estimate(Confidence::default())));
    let mut shown: Vec<_> = estimates.filter(|(_, e)| !e.interval().contains(0.0)).collect();
    shown.sort_by(|a, b| b.1.value().abs().total_cmp(&a.1.value().abs()));
    shown.truncate(CORRELATIONS);
    shown
}

impl Failures {
    /// The inputs that are shown, the most significant first.
    pub(super) fn shown_inputs(&self) -> impl Iterator<Item = &Tenths> {
        let mut shown: Vec<&Tenths> =
            self.inputs.iter().filter(|input| input.adjusted_p_value < SHOWN_BELOW).collect();
        shown.sort_by(|a, b| a.p_value().total_cmp(&b.p_value()));
        shown.into_iter().take(INPUTS)
    }

    /// The pairs that are shown, the most significant first.
    pub(super) fn shown_pairs(&self) -> impl Iterator<Item = &Pair> {
        self.pairs.iter().filter(|pair| pair.adjusted_p_value < SHOWN_BELOW).take(PAIRS)
    }
}
