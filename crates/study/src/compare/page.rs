//! The comparison as a page.

use gyradius_report::{Document, Figure, PageTable, Section, Text, optional, percent};

use super::{
    BodyResult, ModelComparison,
    answer::answer,
    contest::Cell,
    measure::Measure,
    text::{Block, heading, is_poor, kinds, matched, remarks},
};

/// Its pages are called so.
pub(super) const NAME: &str = "compare";

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

impl ModelComparison {
    pub(super) fn document(&self) -> Document {
        let s = &self.settings;
        let lead = Text::from(format!(
            "{} draws of each model about each body at each level, {} of them separated in the scenario ",
            s.draws, s.separations
        ))
        .strong(&s.scenario)
        .plain(format!(
            " in place of its payload; seed {}. Intervals have a confidence of {} %.",
            s.seed,
            100.0 * self.confidence
        ));
        let origin = Text::from("Every number of this page, and more, is in ")
            .code("compare.json")
            .plain(" and ")
            .code("compare.csv")
            .plain(format!(
                ". Made by gyradius {}; the scenario's SHA-256 is ",
                self.gyradius_version
            ))
            .code(&s.scenario_fingerprint)
            .plain(".");
        let title = "gyradius: models of inertia uncertainty compared";
        Document::new(title, "Models of inertia uncertainty, head to head", lead)
            .section(Section::new("In short").boxed().list(answer(self)))
            .section(reading(s.reference_meaning))
            .section(Section::new("Figures").figures(self.figures().iter().map(Figure::drawn)))
            .sections(self.bodies.iter().map(of_body))
            .section(Section::new("Inputs").paragraph(origin))
    }
}

fn reading(meaning: &str) -> Section {
    Section::new("How to read this")
        .paragraph(meaning)
        .paragraph(
            "Not every kind of model can have every covariance. How far each is off is in the tables: the \
             distance of its mean from the reference's over the reference's deviation, and the distance of the \
             covariances over the size of the reference's, both for the whole matrix. Where the covariance is \
             further off than that of a body known exactly (100 %), points are hollow and numbers in brackets: \
             there the comparison is not of like with like.",
        )
        .paragraph(
            "Spreads are given by quantiles: a matrix that no body has can have an inertia ratio as large as one \
             likes, and a single such draw would make the standard deviation, which is in the files. Where none \
             of the draws was unrealizable an upper bound is given; 0 is by construction.",
        )
}

fn of_body(body: &BodyResult) -> Section {
    let [i11, i22, i33, i12, i13, i23] = body.inertia_kg_m2;
    let nominal = format!(
        "I₁₁, I₂₂, I₃₃ = {i11}, {i22}, {i33} and I₁₂, I₁₃, I₂₃ = {i12}, {i13}, {i23} kg·m². Nominal inertia \
         ratio {}, wobble {}°, nutation {}°.",
        optional(body.nominal(Measure::InertiaRatio), 4),
        optional(body.nominal(Measure::Wobble), 3),
        optional(body.nominal(Measure::Nutation), 3)
    );
    // Models by levels, for one thing after the other.
    let rows: Vec<_> = BLOCKS
        .iter()
        .flat_map(|block| kinds(body).into_iter().map(move |kind| (block, kind)))
        .collect();
    let mut table = PageTable::of(&rows)
        .words("model", |(_, kind)| kind.name())
        .groups(|(block, _)| block.title());
    for level in &body.levels {
        table = table.numbers(heading(level), |(block, kind)| {
            let cell = level.cell(*kind);
            block.told(cell).tip(interval(cell))
        });
    }
    let given = kinds(body).into_iter().map(|kind| {
        Text::default().strong(kind.name()).plain(format!(": {}", matched(body, kind)))
    });
    Section::new(&body.name)
        .paragraph(nominal)
        .table(table)
        .list(remarks(body))
        .sections([Section::folded("What was matched").list(given)])
}

/// The share of unrealizable draws with its interval; nothing if there is no such model.
fn interval(cell: Option<&Cell>) -> String {
    let results = cell.and_then(|cell| cell.results.as_ref());
    results.map_or_else(String::new, |r| format!("unrealizable: {}", percent(&r.unrealizable)))
}

impl Block {
    /// What a cell has to say, in brackets where it is not of like with like.
    pub(super) fn told(self, cell: Option<&Cell>) -> Text {
        let text = self.cell(cell);
        Text::from(if is_poor(cell) { format!("({text})") } else { text })
    }
}
