//! Requirements of a scenario: checked, judged by the runs, and told first in the report.

mod figures;

use gyradius_campaign::{
    Bound, Column, Counting, FailedRuns, Judgement, Judging, Looks, Measured, Requirement,
    RunBeyond, Runs, Table, one_decimal, percent_beside, percent_or_less, percent_or_more, plain,
    rounded_down, stated_in_percent,
};
use gyradius_report::{PageCell, PageTable, Section, Text, Tone, significant};
use gyradius_statistics::Verdict;

use crate::{
    Ended, Fleet, ScenarioError, StudyError, alerts,
    head::{Head, Judged},
    subject::{Subject, Summarized},
    unit::{in_unit, unit_of},
    unusual::{UnusualInput, unusual, without_rounding},
    where_runs_fail::{self, Asked},
};

pub(crate) use figures::figure_names;

/// Requirements of a scenario, at most.
const MOST: usize = 100;

/// That what is to be kept, and what is required, are columns of the run tables, and requirements about models of the scenario.
pub(crate) fn check_columns<C: Subject>(scenario: &C) -> Result<(), ScenarioError> {
    let table = Table::new("", 0, scenario.run_columns())
        .map_err(|error| ScenarioError::field("columns", error))?;
    let known = scenario.kept().check(table.columns());
    known.map_err(|error| ScenarioError::field("columns", error))?;
    check(scenario, table.columns())
}

/// That requirements are about columns of numbers that the run tables have, and about models of the scenario.
fn check<C: Subject>(scenario: &C, columns: &[Column]) -> Result<(), ScenarioError> {
    let count = scenario.requirements().len();
    if count > MOST {
        let problem = format!("{count} of them: there must be at most {MOST}");
        return Err(ScenarioError::field("requirements", problem));
    }
    let known = |quantity| known(scenario, quantity, columns);
    if let Some(quantity) = scenario.until().and_then(|until| until.rule().quantity()) {
        known(quantity).map_err(|problem| ScenarioError::field("until.rule", problem))?;
    }
    for (i, requirement) in scenario.requirements().iter().enumerate() {
        let refused = |key: &str, problem: String| {
            ScenarioError::field(format!("requirements[{}].{key}", i + 1), problem)
        };
        let before = &scenario.requirements()[..i];
        name_problem(requirement, before)
            .map_or(Ok(()), |problem| Err(refused("name", problem)))?;
        known(requirement.quantity()).map_err(|problem| refused("quantity", problem))?;
        if let Some(model) = requirement.model().filter(|m| scenario.model_names().all(|n| n != *m))
        {
            let known: Vec<&str> = scenario.model_names().collect();
            let problem = format!("{model:?}: the scenario has {}", known.join(", "));
            return Err(refused("model", problem));
        }
    }
    Ok(())
}

/// Why the name of a requirement does not tell it from those before it, in a line of text.
fn name_problem(requirement: &Requirement, before: &[Requirement]) -> Option<String> {
    let name = requirement.name();
    if name.trim().is_empty() {
        return Some(format!(
            "{name:?}: a name must have letters; without the key it is the quantity and the bound"
        ));
    }
    if name.contains(|c: char| c.is_control() || matches!(c, '\u{2028}' | '\u{2029}')) {
        return Some(format!("{name:?}: a name must be one line without control characters"));
    }
    let shares_model = |other: &Requirement| match (requirement.model(), other.model()) {
        (Some(own), Some(other)) => own == other,
        (Some(_) | None, _) => true,
    };
    let place = before.iter().position(|other| other.name() == name && shares_model(other))?;
    Some(format!(
        "{name:?}: requirements[{}] has this name, too; each must have its own",
        place + 1
    ))
}

/// That a quantity is of columns of numbers that the run tables of a scenario have.
pub(crate) fn known<C: Subject>(
    scenario: &C,
    quantity: &Measured,
    columns: &[Column],
) -> Result<(), String> {
    // Which run it is, is nothing that comes of it. Without vehicles, columns may have their names.
    let places = scenario.fleet().map(|_| Fleet::columns());
    let is_place = |name: &str| {
        name == Column::RUN || places.iter().flatten().any(|column| column.name() == name)
    };
    let is_result = |column: &&Column| column.is_measured() && !is_place(column.name());
    for name in quantity.columns() {
        if !columns.iter().filter(is_result).any(|column| column.name() == name) {
            let known: Vec<&str> = columns.iter().filter(is_result).map(Column::name).collect();
            return Err(format!(
                "{name:?}: the run table has no such column of numbers; it has {}",
                known.join(", ")
            ));
        }
    }
    Ok(())
}

/// The requirements that are about a model.
pub(crate) fn requirements_of<C: Subject>(scenario: &C, model: &str) -> Vec<Requirement> {
    let all = scenario.requirements().iter();
    all.filter(|own| own.is_of(model)).cloned().collect()
}

/// What looks at the requirements of each model, whose runs a rule may have looked at.
pub(crate) fn judging<C: Subject>(
    scenario: &C,
    counting: Counting,
    ended: Option<&Ended>,
) -> Vec<Judging> {
    let looks = ended.map(Ended::looks).unwrap_or_default();
    let of_model = |name: &str| {
        let requirements = requirements_of(scenario, name);
        let judging = Judging::new(requirements, scenario.runs(), counting.group());
        judging.looked_at(counting.looks()).looked_after(&looks)
    };
    scenario.model_names().map(of_model).collect()
}

/// How verdicts count the runs, of which the folder says so much before. Runs that a rule looked at are not as if nobody had, whoever asks
/// later.
pub(crate) fn counting<C: Subject>(scenario: &C, before: Counting) -> Counting {
    let looks = if scenario.until().is_some() { Looks::Often } else { before.looks() };
    Counting::new(looks, group(scenario))
}

/// Verdicts count runs that are independent of each other: the first of so many.
pub(crate) fn group<C: Subject>(scenario: &C) -> u64 {
    let fleet = scenario.independent_runs().and_then(|_| scenario.fleet());
    fleet.map_or(1, Fleet::flights)
}

/// Tells in a summary what the runs of each model say of its requirements. Blocks of the worst runs are read again.
pub(crate) fn judged<C: Subject>(
    scenario: &C,
    summary: &mut C::Summary,
    judging: Vec<Judging>,
    runs: &[Runs],
) -> Result<(), StudyError> {
    let (mut all, mut where_they_fail) = (Vec::new(), Vec::new());
    let (inputs, main, group) =
        (scenario.drawn_columns(), scenario.main_outcomes(), group(scenario));
    let rounding = scenario.rounding();
    for (judging, runs) in judging.into_iter().zip(runs) {
        let model = runs.model();
        let judged = judging.finish(runs)?;
        let worst = judged.iter().flat_map(named).map(|(run, _)| run).collect();
        let drawn = scenario.drawn_inputs(summary, model);
        let (drawn, unmoved) = without_rounding(drawn, &scenario.inertias());
        let moves = |column: &&String| !unmoved.iter().any(|input| input.column == **column);
        let inputs: Vec<String> = inputs.iter().filter(moves).cloned().collect();
        let found = unusual(&drawn, &worst, runs)?;
        all.extend(judged.into_iter().map(|judgement| {
            let of_run = |run: u64| found.iter().find(|unusual| unusual.run == run).cloned();
            let unusual = named(&judgement).filter_map(|(run, _)| of_run(run)).collect();
            Judged { model: model.to_owned(), judgement, unusual }
        }));
        let requirements = requirements_of(scenario, model);
        let asked =
            Asked { requirements: &requirements, inputs: &inputs, main: &main, group, rounding };
        where_they_fail.extend(where_runs_fail::found(runs, asked)?);
    }
    let head = summary.head_mut();
    (head.requirements, head.where_runs_fail) = (all, where_they_fail);
    Ok(())
}

/// The answers before everything else, what a reader should know before relying on them directly behind, and then what they rest on.
pub(crate) fn sections(scenario: &impl Subject, head: &Head) -> Vec<Section> {
    let alerts = alerts::section(&head.alerts).into_iter();
    if head.requirements.is_empty() {
        let of = |ended: &Ended| {
            let text = format!("{ended} {}.", ended.until.rule().reason());
            Section::new("What ended the runs").paragraph(text)
        };
        return alerts.chain(head.ended.iter().map(of)).collect();
    }
    let parts = [
        Some(figures::distributions(scenario, head)),
        worst(scenario, head),
        Some(figures::convergence(scenario, head)),
    ];
    let details = Section::new("The requirements in detail").sections(parts.into_iter().flatten());
    [answers(scenario, head)].into_iter().chain(alerts).chain([details]).collect()
}

/// What the runs say of each requirement.
fn answers(scenario: &impl Subject, head: &Head) -> Section {
    let of_share = PageCell::from("share of the runs that keep it")
        .line(Text::default().quiet("interval with the confidence of the requirement"));
    let unit = |judged: &Judged| unit_of(scenario, judged.judgement.requirement().quantity());
    let mut table = PageTable::of(&head.requirements)
        .words("requirement", |judged| {
            let requirement = judged.judgement.requirement();
            let bound = in_unit(requirement.bound().to_string(), unit(judged).as_deref());
            let text = format!(
                "{} {bound}, in {} of {}, with {} confidence",
                requirement.quantity(),
                stated_in_percent(requirement.probability()),
                requirement.failed_runs().of_which(),
                stated_in_percent(requirement.confidence().level())
            );
            PageCell::from(Text::default().strong(requirement.name()))
                .line(Text::default().quiet(text))
        })
        .words("model", |judged| judged.model.as_str())
        .words("verdict", verdict)
        .numbers("runs that fail it", |judged| {
            let judgement = &judged.judgement;
            let may = judgement.allowed_failures().map_or_else(
                || "none allowed with so few runs".to_owned(),
                |allowed| format!("{allowed} allowed"),
            );
            let failures = format!("{} of {}", judgement.failures(), judgement.counted());
            let cell = PageCell::from(Text::from(failures)).line(Text::default().quiet(may));
            apart(judgement).fold(cell, |cell, words| cell.line(Text::default().quiet(words)))
        })
        .numbers("bound that the share keeps", |judged| {
            let limits = judged.judgement.requirement().bound();
            let told = judged.judgement.tolerance().map(|own| bound(own, limits));
            told.map_or_else(|| "–".to_owned(), |told| in_unit(told, unit(judged).as_deref()))
        })
        .numbers("margin", |judged| {
            let judgement = &judged.judgement;
            let Some(margin) = judgement.margin() else { return PageCell::from("–") };
            let deviations = judgement.margin_deviations().map(|d| format!("{} σ", one_decimal(d)));
            let margin = significant(rounded_down(margin, 4), 4);
            let cell = PageCell::from(Text::from(in_unit(margin, unit(judged).as_deref())));
            deviations.into_iter().fold(cell, |cell, d| cell.line(Text::default().quiet(d)))
        })
        .numbers(of_share, |judged| {
            let (share, interval) = (judged.judgement.share(), judged.judgement.share_interval());
            let Some((share, interval)) = share.zip(interval) else { return PageCell::from("–") };
            let required = judged.judgement.requirement().probability();
            let (lower, upper) =
                (percent_or_less(interval.lower()), percent_or_more(interval.upper()));
            PageCell::from(Text::from(percent_beside(share, required)))
                .line(Text::default().quiet(format!("{lower} … {upper}")))
        })
        .numbers("share to pass 9 times in 10", |judged| {
            judged.judgement.success_to_pass().map_or_else(|| "–".to_owned(), percent_or_more)
        });
    let of_vehicles = |judged: &Judged| judged.judgement.vehicles();
    if head.requirements.iter().any(|judged| of_vehicles(judged).is_some()) {
        let heading = "vehicles that keep it in the required share of their flights";
        table = table.numbers(heading, |judged| {
            let Some(of) = of_vehicles(judged) else { return PageCell::from("–") };
            let interval = of.share_interval.map(|interval| {
                let (lower, upper) =
                    (percent_or_less(interval.lower()), percent_or_more(interval.upper()));
                format!("{lower} … {upper}")
            });
            PageCell::from(format!("{} of {}", of.keeping, of.vehicles)).noting(interval)
        });
    }
    let rests = "A requirement is met if so few runs fail it that a vehicle which is just not good enough would pass with the \
                 probability 1 − confidence at most (the consumer's risk), and not met if a vehicle which is just good enough \
                 would fail with that probability at most. The bound is an order statistic that the required share of all runs \
                 keeps with the confidence, whatever the distribution (Wilks); the margin is its distance to the limit, also in \
                 standard deviations σ of the quantity. The share to pass is the producer's side: in which share of all runs a \
                 vehicle must keep the requirement, to pass nine times in ten with as many runs.";
    let mut notes = vec![Text::from(rests)];
    if head.requirements.iter().any(|judged| judged.judgement.runs_without_number() > 0) {
        notes.push(Text::from(
            "A run has no number if it failed without an infinite one, or if it has no value of the quantity, as there is no time of \
             a contact that does not happen. Such runs count against a requirement, unless the scenario leaves them out of it: shares are then of the \
             runs that have a number.",
        ));
    }
    if let Some(ended) = &head.ended {
        notes.push(Text::from(format!(
            "{ended} {}. Verdicts, bounds and intervals of the requirements are those of a rule that may be asked after any number of \
             looks.",
            ended.until.rule().reason()
        )));
    }
    let is_often = |judged: &Judged| judged.judgement.looks() == Looks::Often;
    if head.ended.is_none() && head.requirements.iter().any(is_often) {
        notes.push(Text::from(
            "A rule that could have ended these runs looked at them before, in this folder. Verdicts, bounds and intervals of the \
             requirements are therefore those of a rule that may be asked after any number of looks.",
        ));
    }
    if head.independent_runs_per_model.is_some() {
        notes.push(Text::from(
            "Flights of a vehicle have something in common. Verdicts are of the first flight of each vehicle, which are \
             independent of each other.",
        ));
    }
    let seen = "See the alerts below, “Before you rely on the results”.";
    let alerted = (!head.alerts.is_empty()).then_some(seen);
    let section = Section::new("Requirements").table(table);
    let section = alerted.into_iter().fold(section, Section::paragraph);
    notes.into_iter().fold(section, Section::paragraph)
}

/// Where runs fail the requirements, and with which inputs outcomes rise and fall.
pub(crate) fn where_runs_fail<C: Subject>(head: &Head) -> Vec<Section> {
    let vehicles = head.independent_runs_per_model.is_some();
    let required = |model: &str| head.requirements.iter().any(|judged| judged.model == model);
    where_runs_fail::sections(&head.where_runs_fail, vehicles, required, C::MAIN_OUTCOMES)
}

/// The worst runs, each with the command, or the call, that does it again.
fn worst(scenario: &impl Subject, head: &Head) -> Option<Section> {
    let all: Vec<(&Judged, u64, Option<&RunBeyond>)> = head
        .requirements
        .iter()
        .flat_map(|judged| named(&judged.judgement).map(move |(run, beyond)| (judged, run, beyond)))
        .collect();
    type Again = fn(&str, u64) -> String;
    let (to_see_it, again): (_, Again) = match scenario.function_name() {
        Some(_) => ("to see it, in the program that has the function", |model, run| {
            format!("study.replay({run}, model={model:?})")
        }),
        None => ("to see it, in the folder of the study", |model, run| {
            // A name may begin with a hyphen.
            format!("gyradius replay . --model={model} --run {run}")
        }),
    };
    let unit = |judged: &Judged| unit_of(scenario, judged.judgement.requirement().quantity());
    let table = PageTable::of(&all)
        .groups(|(judged, ..)| {
            format!("{}, {}", judged.judgement.requirement().name(), judged.model)
        })
        .numbers("run", |(_, run, _)| run.to_string())
        .numbers("value", |(judged, _, beyond)| {
            let limits = judged.judgement.requirement().bound();
            let told = beyond.map(|run| beside(run.value, 6, limits));
            told.map_or_else(
                || "infinite".to_owned(),
                |told| in_unit(told, unit(judged).as_deref()),
            )
        })
        .numbers("beyond the limit by", |(judged, _, beyond)| {
            let told = beyond.map(|run| significant(run.excess, 4));
            told.map_or_else(|| "–".to_owned(), |told| in_unit(told, unit(judged).as_deref()))
        })
        .words("unusual in what it drew", |(judged, run, _)| told_unusual(judged, *run))
        .words(to_see_it, |(judged, run, _)| Text::default().code(again(&judged.model, *run)));
    let reading = "Unusual is what lies at least two standard deviations from the mean of all runs of the model, in brackets by \
                   how many: the three most unusual numbers of what the run drew, which need not be the reason.";
    let first_flights = "Only first flights are judged: these are the worst of the first flights of the vehicles, and a later flight may be worse.";
    let of_vehicles = head.independent_runs_per_model.map(|_| first_flights);
    let section = of_vehicles
        .into_iter()
        .fold(Section::folded("The worst runs"), Section::paragraph)
        .paragraph(reading)
        .table(table);
    // Where no run has a number, none is the worst.
    (!all.is_empty()).then_some(section)
}

/// What is unusual in what a run drew, a line each.
fn told_unusual(judged: &Judged, run: u64) -> PageCell {
    let found = judged.unusual.iter().find(|unusual| unusual.run == run);
    let line = |input: &UnusualInput| {
        let sign = if input.score < 0.0 { "−" } else { "+" };
        let score = significant(input.score.abs(), 2);
        // Events are whole numbers.
        let value = match input.value {
            whole if whole.fract() == 0.0 && whole.abs() < 1e6 => whole.to_string(),
            other => significant(other, 4),
        };
        Text::default().code(&input.column).plain(format!(" {value} ({sign}{score} σ)"))
    };
    let lines: Vec<Text> = found.iter().flat_map(|unusual| &unusual.inputs).map(line).collect();
    if lines.is_empty() { "–".into() } else { lines.into_iter().collect() }
}

fn verdict(judged: &Judged) -> PageCell {
    let judgement = &judged.judgement;
    match judgement.verdict() {
        Verdict::Met => PageCell::from(Text::default().badge(Tone::Good, "met")),
        Verdict::NotMet => PageCell::from(Text::default().badge(Tone::Bad, "not met")),
        Verdict::Undecided { if_no_more_fail, at_this_rate } => {
            let cell = PageCell::from(Text::default().badge(Tone::Open, "not decided"));
            let more = |runs: u64, how: &str| {
                Text::default().quiet(format!("{runs} more {} {how}", judgement.unit_of_more(runs)))
            };
            let all = if_no_more_fail.map(|runs| more(runs, "if all keep it"));
            let if_so = match judgement.leaves_runs_out() {
                true => "if failures and runs that are left out go on at this rate",
                false => "if failures go on at this rate",
            };
            let rate = at_this_rate.map(|runs| more(runs, if_so));
            let again = judgement.asks_for_another_look().then(|| {
                let said = "judging a second time adds a risk of its own; [until] of the scenario counts all looks";
                Text::default().quiet(said)
            });
            all.into_iter().chain(rate).chain(again).fold(cell, PageCell::line)
        }
    }
}

/// What becomes of the runs without a number, and of those whose number is infinite, as far as there are any.
fn apart(judgement: &Judgement) -> impl Iterator<Item = String> {
    const AGAINST: &str = "counted against it";
    let fate = match judgement.requirement().failed_runs() {
        FailedRuns::Against => AGAINST,
        FailedRuns::LeftOut => "left out",
    };
    let without = (judgement.runs_without_number(), "no number", fate);
    let infinite = (judgement.runs_infinite(), "an infinite number", AGAINST);
    let runs = judgement.runs();
    let there = [without, infinite].into_iter().filter(|(number, ..)| *number > 0);
    there.map(move |(number, what, fate)| format!("{number} of {runs} have {what}: {fate}"))
}

/// The runs that are named one by one, the worst first: those whose number is infinite, and others by how far they are beyond the bound.
fn named(judgement: &Judgement) -> impl Iterator<Item = (u64, Option<&RunBeyond>)> {
    let infinite = judgement.first_infinite().iter().map(|run| (*run, None));
    infinite.chain(judgement.worst().iter().map(|run| (run.run, Some(run))))
}

/// The bound that a share keeps, rounded outwards, in the digits that tell it from the limits.
fn bound(bound: Bound, limits: Bound) -> String {
    match bound.outwards(limits, 5) {
        Bound::AtMost(limit) => format!("≤ {}", plain(limit)),
        Bound::AtLeast(limit) => format!("≥ {}", plain(limit)),
        Bound::Between(lower, upper) => format!("{} … {}", plain(lower), plain(upper)),
    }
}

/// A number in at least so many digits, and as many as tell it from the limits.
fn beside(x: f64, digits: usize, limits: Bound) -> String {
    significant(x, limits.digits_beside(x, digits))
}

#[cfg(test)]
mod tests;
