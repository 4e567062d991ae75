//! The same comparison for the bodies of a study, at the uncertainty that its scenario gives them.

use gyradius_dispersion::ModelKind;
use gyradius_report::{
    self as page, Figure, Label, PageCell, PageTable, Picture, RangeGrid, RangePanel, Text,
    with_unit,
};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

use super::{
    BodyResult, LevelResult,
    body::NominalBody,
    contest::GoOn,
    level,
    measure::Measure,
    options::Size,
    reference::Target,
    text::{Block, is_poor, kinds, matched, remarks},
};
use crate::{
    StudyError,
    scenario::{Axes, Scenario, UncertainBody},
};

/// Name of the figure of all models of inertia.
pub(crate) const EVERY_MODEL: &str = "figure-models";
/// Enough for a share to a percent and a quantile to a few.
const DRAWS: u64 = 2000;
const SEPARATIONS: u64 = 150;
/// What is told of the payload.
const SHOWN: [Measure; 3] = [Measure::InertiaRatio, Measure::Wobble, Measure::Nutation];

/// All models about payload and stage of a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Section {
    draws: u64,
    separations: u64,
    bodies: Vec<BodyResult>,
}

impl Section {
    pub(crate) fn new(scenario: &Scenario, go_on: GoOn<'_>) -> Result<Self, StudyError> {
        let size = Size { draws: DRAWS, separations: SEPARATIONS, seed: scenario.seed() };
        let of = |name: &str, body: &UncertainBody, size| {
            let law = body.law(Axes::WholeSphere).map_err(|e| e.to_string());
            let target = law.and_then(|law| {
                let moments = body.expected_moments(Axes::WholeSphere);
                let moments = moments.ok_or("its moments are not known")?;
                Ok(if body.has_correlated_roots() {
                    Target::of_moments(moments)
                } else {
                    Target::of_law(Arc::new(law), moments)
                })
            });
            let label = format!("study {name}");
            let all = &ModelKind::ALL;
            let levels = level(None, &label, target, all, scenario, size, (&|| {}, go_on))?;
            let nominal = NominalBody::of_study(name, *body.nominal());
            Ok::<_, StudyError>(BodyResult::new(&nominal, scenario, vec![levels]))
        };
        let payload = of("payload", scenario.payload(), size)?;
        // The spin is the payload's.
        let stage = of("stage", scenario.stage(), Size { separations: 0, ..size })?;
        Ok(Self { draws: DRAWS, separations: SEPARATIONS, bodies: vec![payload, stage] })
    }

    /// Where the payload's spin lies under each model.
    pub(crate) fn figure(&self) -> Option<Figure> {
        let payload = self.bodies.first()?;
        let level = payload.levels.first().filter(|level| !level.models.is_empty())?;
        let panel = |measure: Measure| RangePanel {
            label: with_unit(&measure.label(), measure.unit()),
            nominal: payload.nominal(measure),
            ranges: kinds(payload)
                .into_iter()
                .map(|kind| {
                    let spread = level.cell(kind)?.results.as_ref()?.spread(measure)?;
                    Some([spread.p05?, spread.median?, spread.p95?])
                })
                .collect(),
        };
        let names: Vec<Label> = kinds(payload)
            .into_iter()
            .map(|kind| Label {
                name: kind.name().to_owned(),
                colour: super::figures_of_models::pen(kind).0,
                hollow: is_poor(level.cell(kind)),
            })
            .collect();
        let panels = SHOWN.map(panel);
        let hollow = if names.iter().any(|name| name.hollow) {
            ". A hollow point marks a model whose covariance is further off than that of a body known exactly (100 %), so that it is \
             not like for like"
        } else {
            ""
        };
        let title = "Every model with the payload's mean and covariance";
        Some(Figure {
            name: EVERY_MODEL.to_owned(),
            caption: format!(
                "{title}: median and middle 90 % of {DRAWS} draws (nutation: {SEPARATIONS} separations, \
                 nominal stage){hollow}"
            ),
            picture: Picture::Ranges(RangeGrid::new(title, names, panels.into())),
        })
    }

    pub(crate) fn section(&self) -> Option<page::Section> {
        let [payload, stage] = self.bodies.as_slice() else { return None };
        let (of_payload, of_stage) = (payload.levels.first()?, stage.levels.first()?);
        let reading = Text::from(format!(
            "Every model that gyradius has, given the mean and the covariance that the scenario's dispersion gives \
             the six entries of a body at its nominal mass, as far as its kind can have them: {} draws of each; nutation from {} \
             separations from the nominal stage. Numbers in brackets: the covariance is further off than that of \
             a body known exactly (100 %), so not like for like. ",
            self.draws, self.separations
        ))
        .code("gyradius compare")
        .plain(" does this for other bodies and levels.");
        let cell = |level: &'_ LevelResult, block: Block| {
            let level = level.clone();
            move |kind: &ModelKind| block.told(level.cell(*kind))
        };
        // A body that is known exactly has no models.
        let told = [payload, stage].into_iter().find(|body| !kinds(body).is_empty())?;
        let rows = kinds(told);
        let mut table = PageTable::of(&rows)
            .words("model", |kind| Text::from(kind.name()).tip(matched(told, *kind)))
            .numbers("unrealizable: payload, %", cell(of_payload, Block::Unrealizable))
            .numbers("stage, %", cell(of_stage, Block::Unrealizable));
        for measure in SHOWN {
            let label = PageCell::from(measure.label()).line(format!(
                "{}{}",
                measure.headline().0,
                measure.comma_unit()
            ));
            table = table.numbers(label, cell(of_payload, Block::Spread(measure)));
        }
        let table = table
            .numbers("covariance off: payload, %", cell(of_payload, Block::CovarianceOff))
            .numbers("stage, %", cell(of_stage, Block::CovarianceOff));
        let remarks = [payload, stage]
            .map(|body| remarks(body).into_iter().map(|remark| format!("{}: {remark}", body.name)));
        Some(
            page::Section::new("Other models of the same uncertainty")
                .paragraph(reading)
                .table(table)
                .warnings(remarks.into_iter().flatten()),
        )
    }
}
