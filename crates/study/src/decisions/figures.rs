//! The figures of requirements: the distribution of each quantity, and how the share that fails comes to rest.

use gyradius_campaign::{Looks, Requirement};
use gyradius_report::{Drawing, JudgedModel, Section, convergence_figure, distribution_figure};

use crate::{
    head::{Head, Judged},
    subject::Subject,
    unit::unit_of,
};

/// Figures of a requirement, whose number follows.
const DISTRIBUTION: &str = "distribution";
const CONVERGENCE: &str = "convergence";

/// The figures that requirements may have, by name: known before the runs.
pub(crate) fn figure_names(requirements: &[Requirement]) -> impl Iterator<Item = String> {
    (1..=requirements.len())
        .flat_map(|number| [DISTRIBUTION, CONVERGENCE].map(|of| of_requirement(of, number)))
}

fn of_requirement(figure: &str, number: usize) -> String {
    format!("{figure}-{number}")
}

/// A figure of each requirement, numbered from 1, of what the runs of each model say. A requirement can be about one model alone, and
/// this has the colour that it has in all other figures of the scenario.
fn figures(
    scenario: &impl Subject,
    head: &Head,
    draw: impl Fn(usize, &Requirement, &[JudgedModel<'_>]) -> Drawing,
) -> Vec<Drawing> {
    let mut of: Vec<(&Requirement, Vec<JudgedModel<'_>>)> = Vec::new();
    for Judged { model: name, judgement, .. } in &head.requirements {
        let requirement = judgement.requirement();
        let colour = scenario.model_names().position(|other| other == name).unwrap_or_default();
        let model = JudgedModel { name, colour, judgement };
        match of.iter_mut().find(|(known, _)| *known == requirement) {
            Some((_, models)) => models.push(model),
            None => of.push((requirement, vec![model])),
        }
    }
    let numbered = of.iter().zip(1..);
    numbered.map(|((requirement, models), number)| draw(number, requirement, models)).collect()
}

/// How often the runs were looked at; the same for all requirements of a study.
fn looks(head: &Head) -> Looks {
    head.requirements.first().map(|judged| judged.judgement.looks()).unwrap_or_default()
}

/// What the quantities of the requirements look like, to the extreme runs.
pub(super) fn distributions(scenario: &impl Subject, head: &Head) -> Section {
    let reading = "Each line goes through order statistics of the runs: the value with the rank k of n runs is drawn at the share \
                   (k − ½)/n, on the axis of a normal law, on which a normal distribution is a straight line. The extreme runs of \
                   both tails are always among the points. The shaded band holds the whole distribution of all runs at once, with \
                   the confidence of the requirement and whatever the distribution: at each of the K points stand Clopper and \
                   Pearson’s bounds with the confidence 1 − (1 − c)/K, and between the points the band follows from the fact that \
                   a distribution function never decreases. The tolerance point is the bound of the table above. A point is a run \
                   as it is: tails are not fitted.";
    let drawings = figures(scenario, head, |number, requirement, models| {
        let (quantity, name) = (requirement.quantity(), requirement.name());
        let caption =
            format!("“{name}”: distribution of {quantity}, to the extreme runs of both tails");
        let unit = unit_of(scenario, quantity);
        let file = of_requirement(DISTRIBUTION, number);
        distribution_figure(&file, &caption, requirement, unit.as_deref(), models)
    });
    let section = Section::new("Distributions").paragraph(reading);
    let section = match looks(head) {
        Looks::Once => section,
        Looks::Often => section.paragraph(
            "The runs were looked at while they were done, and what was seen decided when they ended. The band takes no account of \
             that: it is the band of one look at as many runs, and covers less often than it says. The tolerance point does take \
             account of it.",
        ),
    };
    section.figures(drawings)
}

/// How the shares that fail come to rest.
pub(super) fn convergence(scenario: &impl Subject, head: &Head) -> Section {
    let share = "The share of the runs that fail each requirement among the first so many runs, in the order of their numbers. ";
    let intervals = match looks(head) {
        Looks::Once => {
            "Each interval is what these runs would tell if nobody had looked before (Clopper and Pearson, with the confidence of the \
             requirement): whoever looks often, and stops when it pleases, takes a greater risk."
        }
        Looks::Often => {
            "The intervals are those of a confidence sequence: with the confidence of the requirement all of them hold together, \
             however often one looks and whenever one stops. They are wider than Clopper and Pearson’s of one look."
        }
    };
    let reading = format!("{share}{intervals}");
    let drawings = figures(scenario, head, |number, requirement, models| {
        let caption = format!("Runs that fail “{}” among the first so many", requirement.name());
        let name = of_requirement(CONVERGENCE, number);
        convergence_figure(&name, &caption, requirement, models)
    });
    Section::folded("Convergence").paragraph(reading).figures(drawings)
}
