//! What drives the outcome, as the report tells it.

use gyradius_report::{
    DrivenOutput, DrivingGroup, PageCell, PageTable, Section, Text, drivers_figure, estimate,
    first_names, with_unit,
};
use gyradius_statistics::{Estimate, SobolIndex};

use crate::{
    driven::{Driven, Drivers},
    head::Head,
};

/// Outputs in a figure, at most.
const DRAWN: usize = 6;
/// Groups that are told of an output in the table.
const TOLD: usize = 3;
/// Outputs that are named of those that are nearly always the same, and of those that are left out.
const NAMED: usize = 8;
/// The share of base runs that an index may leave out before that is told.
const LEFT_OUT: f64 = 0.01;
const FIGURE: &str = "drivers";

/// The figures that there may be, if drivers are asked for, by the names of the models.
pub(crate) fn figure_names<'a>(
    base_runs: Option<u64>,
    models: impl Iterator<Item = &'a str>,
) -> impl Iterator<Item = String> {
    models.filter(move |_| base_runs.is_some()).map(|model| format!("{FIGURE}-{model}"))
}

/// What drives the requirements, or, without any, the main outcomes of a run; nothing if it was not asked.
pub(crate) fn section(head: &Head, main: &[String]) -> Option<Section> {
    let base = head.drivers.first()?.base_runs;
    let reading = format!(
        "The inputs that are drawn independently of each other are groups. Of each of its outputs a figure shows which share of the \
         variance a group explains alone (the first-order Sobol’ index), and which share would be left if all other groups were \
         known (the total index): what a group has in all beyond what it has alone are its interactions. A total index near 0 \
         means that the group may as well be fixed. Found from {base} base runs, each done with two draws of all groups, and once \
         for each group with its second draw alone (pick and freeze), whatever the laws. Lines show intervals of 95 % each; a \
         number is that of the total index. No index is below 0 or above 1: what an estimate or its interval has there is drawn at 0 or 1, \
         and the table has it as it is. Of a requirement the output is whether a run fails it."
    );
    let mut section = Section::new("What drives the outcome").paragraph(reading);
    let fewer = |drivers: &Drivers| shown(head, drivers, main).count() < drivers.outputs.len();
    if head.drivers.iter().any(fewer) {
        section = section.paragraph(format!(
            "A figure has {DRAWN} outputs at most: of a model with requirements whether a run fails them, and what they are about, and \
             of another one the first outcomes. The tables have all outputs that vary."
        ));
    }
    for drivers in &head.drivers {
        if drivers.failed > 0 {
            let (failed, runs, model) = (drivers.failed, drivers.runs, &drivers.model);
            section = section.paragraph(Text::default().strong(model).plain(format!(
                ": {failed} of the {runs} runs failed. A number of a run is missing then, and the group leaves the base run out."
            )));
        }
        section = without_numbers(drivers).into_iter().fold(section, Section::paragraph);
        section = section.warnings(of_few(drivers));
        let shown: Vec<DrivenOutput> =
            shown(head, drivers, main).map(|driven| driven.drawn(drivers)).collect();
        if !shown.is_empty() {
            let caption = format!("What drives the outcome, {}", drivers.model);
            let name = format!("{FIGURE}-{}", drivers.model);
            section = section.figures([drivers_figure(&name, &caption, &shown)]);
        }
    }
    if head.drivers.iter().all(|drivers| drivers.outputs.is_empty()) {
        section = section.paragraph("Nothing drives anything here: every output is the same in all of these runs, or missing.");
    }
    Some(section.sections(head.drivers.iter().filter_map(all)))
}

/// A total index with its interval.
pub(crate) fn told(total: &Estimate) -> String {
    // Differences of rounding are none.
    if total.value().abs() < 1e-12 { "0".to_owned() } else { estimate(total, 2) }
}

/// Of which outputs of a model the indices are not known, because few runs carry them.
fn of_few(drivers: &Drivers) -> Option<Text> {
    let few: Vec<&Driven> = drivers.outputs.iter().filter(|d| d.indices.is_of_few()).collect();
    let named = few
        .iter()
        .map(|driven| format!("{} ({:.0})", driven.label(), driven.indices.effective_runs()));
    let named = first_names(named, NAMED);
    let (all, model) = (2 * drivers.base_runs, &drivers.model);
    let text = Text::default().strong(format!("{model}: too few runs count")).plain(format!(
        " in {named}: few runs lie far from the others, or bring out what two groups do together. In brackets is by how many of the {all} runs with a single draw of everything the variance is known. The indices may lie far beyond 0 and 1, and their intervals miss the truth far more often than they say. Take more base runs.",
    ));
    (!few.is_empty()).then_some(text)
}

/// Of which outputs of a model indices leave out base runs, whether these failed or not.
fn without_numbers(drivers: &Drivers) -> Option<Text> {
    let share = |driven: &Driven| {
        let left_out = driven.indices.groups().iter().map(SobolIndex::left_out);
        left_out.max().unwrap_or(0) as f64 / driven.indices.runs() as f64
    };
    let shares = drivers.outputs.iter().map(|driven| (share(driven), driven));
    let mut named: Vec<(f64, &Driven)> = shares.filter(|(share, _)| *share > LEFT_OUT).collect();
    named.sort_by(|a, b| b.0.total_cmp(&a.0));
    let names = named.iter().map(|(share, d)| format!("{} ({:.0} %)", d.label(), 100.0 * share));
    let (model, most) = (&drivers.model, 100.0 * LEFT_OUT);
    let text = Text::default().strong(model).plain(format!(
        ": more than {most} % of the base runs are left out of an index of these outputs, because one of the runs that it is made of has no number of the \
         output. The indices are those of the other base runs. In brackets is the share that is left out of the index of a group, at most: {}.",
        first_names(names, NAMED)
    ));
    (!named.is_empty()).then_some(text)
}

/// What the figure of a model shows: the requirements and what they are about, or the main outcomes.
fn shown<'a>(
    head: &'a Head,
    drivers: &'a Drivers,
    main: &'a [String],
) -> impl Iterator<Item = &'a Driven> {
    let about = |driven: &Driven| {
        head.requirements.iter().any(|judged| {
            let columns = judged.judgement.requirement().quantity().columns();
            judged.model == drivers.model && columns.contains(&driven.output)
        })
    };
    let required = drivers.outputs.iter().any(|driven| driven.unit.is_none() || about(driven));
    let is_shown = move |driven: &&Driven| match required {
        true => driven.unit.is_none() || about(driven),
        false => main.contains(&driven.output),
    };
    drivers.outputs.iter().filter(is_shown).take(DRAWN)
}

/// A row of each output of a model, with the groups that drive most of it.
fn all(drivers: &Drivers) -> Option<Section> {
    if drivers.outputs.is_empty() {
        return None;
    }
    let mut table = PageTable::of(&drivers.outputs).words("output", Driven::label);
    for place in 0..TOLD.min(drivers.groups.len()) {
        let heading = ["most of it", "then", "and then"][place];
        table = table.words(heading, |driven| {
            let ranked = driven.ranked(&drivers.groups);
            let Some((group, index)) = ranked.get(place) else { return PageCell::from("–") };
            let Some(total) = index.total() else { return PageCell::from("–") };
            PageCell::from(Text::from(*group)).line(Text::default().quiet(told(total)))
        });
    }
    let heading = format!("All outputs: {}", drivers.model);
    let section =
        Section::folded(heading).paragraph("Groups by their total index, with its interval.");
    Some(left_out(drivers).into_iter().fold(section, Section::paragraph).table(table))
}

/// Which outputs of a model nothing drives.
fn left_out(drivers: &Drivers) -> Option<String> {
    let names = &drivers.left_out;
    let text = format!(
        "Left out are outputs that are the same in all of these runs but for rounding, or missing: {}.",
        first_names(names.iter().cloned(), NAMED)
    );
    (!names.is_empty()).then_some(text)
}

/// The output that is whether a run fails a requirement of this name.
pub(super) fn fails(requirement: &str) -> String {
    format!("fails: {requirement}")
}

impl Driven {
    /// The output with its unit, or the requirement that is not kept.
    fn label(&self) -> String {
        match &self.unit {
            Some(unit) => with_unit(&self.output, unit),
            None => fails(&self.output),
        }
    }

    fn drawn(&self, drivers: &Drivers) -> DrivenOutput {
        let share = |estimate: Option<&Estimate>| {
            let estimate = estimate?;
            let interval = estimate.interval();
            Some([interval.lower(), estimate.value(), interval.upper()])
        };
        let group = |(name, index): (&String, &SobolIndex)| DrivingGroup {
            name: name.clone(),
            first: share(index.first()),
            total: share(index.total()),
        };
        let groups = drivers.groups.iter().zip(self.indices.groups()).map(group).collect();
        // The bars say nothing then.
        let few = if self.indices.is_of_few() { ", too few runs count" } else { "" };
        DrivenOutput { label: format!("{}{few}", self.label()), groups }
    }
}
