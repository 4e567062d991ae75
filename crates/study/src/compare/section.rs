//! The same comparison for the bodies of a study, at the uncertainty that its scenario gives them.

use gyradius_dispersion::ModelKind;
use gyradius_report::{Figure, Label, Picture, RangeGrid, RangePanel};
use gyradius_statistics::StatisticsError;
use maud::{Markup, html};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

use super::{
    BodyResult,
    body::NominalBody,
    contest::Cell,
    level,
    measure::Measure,
    options::Size,
    reference::Target,
    text::{Block, is_poor, kinds, matched, remarks},
};
use crate::scenario::{Axes, Scenario, UncertainBody};

/// Name of the figure of all models of inertia.
pub(crate) const EVERY_MODEL: &str = "figure-models";
/// Enough for a share to a percent and a quantile to a few.
const DRAWS: u64 = 2000;
const SEPARATIONS: u64 = 150;

/// All models about payload and stage of a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Section {
    draws: u64,
    separations: u64,
    bodies: Vec<BodyResult>,
}

impl Section {
    pub(crate) fn new(scenario: &Scenario) -> Result<Self, StatisticsError> {
        let size = Size { draws: DRAWS, separations: SEPARATIONS, seed: scenario.seed() };
        let of = |name: &str, body: &UncertainBody, size| {
            let law = body.principal(Axes::WholeSphere).map_err(|e| e.to_string());
            let target = law.and_then(|law| {
                Target::of_law(Arc::new(law)).ok_or_else(|| "its moments are not known".to_owned())
            });
            let label = format!("study {name}");
            let levels = level(None, &label, target, &ModelKind::ALL, scenario, size, &|| {})?;
            Ok(BodyResult::new(
                &NominalBody::of_study(name, *body.nominal()),
                scenario,
                vec![levels],
            ))
        };
        let payload = of("payload", scenario.payload(), size)?;
        // The spin is the payload's.
        let stage = of("stage", scenario.stage(), Size { separations: 0, ..size })?;
        Ok(Self { draws: DRAWS, separations: SEPARATIONS, bodies: vec![payload, stage] })
    }

    /// Where the payload's spin lies under each model.
    pub(crate) fn figure(&self) -> Option<Figure> {
        let payload = self.bodies.first()?;
        let level = payload.levels.first()?;
        let panel = |measure: Measure| RangePanel {
            label: match measure.unit() {
                "1" => measure.label().to_owned(),
                unit => format!("{} ({unit})", measure.label()),
            },
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
        let panels = [Measure::InertiaRatio, Measure::Wobble, Measure::Nutation].map(panel);
        let title = "Every model with the payload's mean and covariance";
        Some(Figure {
            name: EVERY_MODEL.to_owned(),
            caption: format!(
                "{title}: median and middle 90 % of {DRAWS} draws (nutation: {SEPARATIONS} separations, \
                 nominal stage)"
            ),
            picture: Picture::Ranges(RangeGrid::new(title, names, panels.into())),
        })
    }

    pub(crate) fn markup(&self) -> Markup {
        let [payload, stage] = self.bodies.as_slice() else { return html! {} };
        let level = |body: &BodyResult| body.levels.first().cloned();
        let (Some(of_payload), Some(of_stage)) = (level(payload), level(stage)) else {
            return html! {};
        };
        html! {
            h2 { "Other models of the same uncertainty" }
            p {
                "Every model that gyradius has, given the mean and the covariance that the scenario's "
                "dispersion gives the six entries of a body, as far as its kind can have them: "
                (self.draws) " draws of each; nutation from " (self.separations) " separations from the "
                "nominal stage. Numbers in brackets: the covariance is further off than that of a body "
                "known exactly (100 %), so not like for like. " code { "gyradius compare" } " does this for other bodies and levels."
            }
            div.wide { table.results {
                thead { tr {
                    th { "model" }
                    th { "unrealizable: payload, %" }
                    th { "stage, %" }
                    @for measure in [Measure::InertiaRatio, Measure::Wobble, Measure::Nutation] {
                        th { (measure.label()) br; (measure.headline().0) (unit(measure)) }
                    }
                    th { "covariance off: payload, %" }
                    th { "stage, %" }
                } }
                tbody { @for kind in kinds(payload) {
                    @let p = of_payload.cell(kind);
                    @let s = of_stage.cell(kind);
                    tr {
                        th scope="row" title=(matched(payload, kind)) { (kind) }
                        (td(Block::Unrealizable, p)) (td(Block::Unrealizable, s))
                        (td(Block::Spread(Measure::InertiaRatio), p))
                        (td(Block::Spread(Measure::Wobble), p))
                        (td(Block::Spread(Measure::Nutation), p))
                        (td(Block::CovarianceOff, p)) (td(Block::CovarianceOff, s))
                    }
                } }
            } }
            @for (body, remarks) in [payload, stage].map(|body| (body, remarks(body))) {
                @for remark in remarks { p.warning { (body.name) ": " (remark) } }
            }
        }
    }
}

fn unit(measure: Measure) -> String {
    if measure.unit() == "1" { String::new() } else { format!(", {}", measure.unit()) }
}

fn td(block: Block, cell: Option<&Cell>) -> Markup {
    html! {
        td { @if is_poor(cell) { "(" (block.cell(cell)) ")" } @else { (block.cell(cell)) } }
    }
}
