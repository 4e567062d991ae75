//! The figures of a comparison.

use gyradius_dispersion::ModelKind;
use gyradius_report::{Figure, Line, LineGrid, LinePanel, LinePoint, Picture, Range, with_unit};

use super::{BodyResult, LevelResult, ModelComparison, contest::Results, measure::Measure};

/// Colours of the kinds that are not conditioned, by their place among these; a further kind has that of its place.
const COLOURS: [usize; 4] = [0, 1, 3, 2];

/// Colour and dashes of a model: those that are conditioned have the colour of what they are made of, and dashes.
pub(super) fn pen(kind: ModelKind) -> (usize, bool) {
    let (plain, dashed) = match kind {
        ModelKind::Entries { correlated, realizable_only } => {
            (ModelKind::Entries { correlated, realizable_only: false }, realizable_only)
        }
        plain => (plain, false),
    };
    let is_plain =
        |kind: &ModelKind| !matches!(kind, ModelKind::Entries { realizable_only: true, .. });
    let mut kinds = ModelKind::ALL.into_iter().filter(is_plain);
    let place = kinds.position(|other| other == plain).unwrap_or(COLOURS.len());
    (COLOURS.get(place).copied().unwrap_or(place), dashed)
}

/// What a figure says of itself, and what its vertical axes span.
struct Words {
    name: String,
    title: String,
    label: String,
    caption: String,
    range: Range,
}

const UNREALIZABLE: &str = "compare-unrealizable";

/// Measures whose spread has a figure.
const SPREAD: [Measure; 4] =
    [Measure::InertiaRatio, Measure::Wobble, Measure::Nutation, Measure::LargestMoment];

fn name_of(measure: Measure) -> String {
    format!("compare-{}", measure.name().replace('_', "-"))
}

/// The names of all figures that a comparison may have.
pub(super) fn names() -> Vec<String> {
    let spread = SPREAD.into_iter().map(name_of);
    spread.chain([UNREALIZABLE.to_owned()]).collect()
}

type Value<'a> = &'a dyn Fn(&Results) -> Option<(f64, Option<[f64; 2]>)>;

fn line(body: &BodyResult, kind: ModelKind, value: Value<'_>) -> Line {
    let (colour, dashed) = pen(kind);
    let point = |level: &LevelResult| {
        let r = level.cell(kind)?.results.as_ref()?;
        let (y, interval) = value(r)?;
        let x = level.level_percent?;
        Some(LinePoint { x, y, interval, hollow: r.fit.is_poor() })
    };
    Line {
        name: kind.name().to_owned(),
        colour,
        dashed,
        points: body.levels.iter().filter_map(point).collect(),
    }
}

impl ModelComparison {
    pub(super) fn figures(&self) -> Vec<Figure> {
        let share = |r: &Results| {
            let u = &r.unrealizable;
            let percent = [u.interval.lower() * 100.0, u.interval.upper() * 100.0];
            Some((100.0 * u.share, Some(percent)))
        };
        let may_fail = |kind: &ModelKind| !kind.is_realizable_by_construction();
        let mut figures = Vec::new();
        if self.settings.models.iter().any(may_fail) {
            let safe: Vec<&str> = self
                .settings
                .models
                .iter()
                .filter(|kind| !may_fail(kind))
                .map(|kind| kind.name())
                .collect();
            let caption = if safe.is_empty() {
                String::new()
            } else {
                format!(". Zero at every level, and not shown: {}", safe.join(", "))
            };
            figures.push(self.figure(
                &Words {
                    name: UNREALIZABLE.to_owned(),
                    title: "Draws that no body has".to_owned(),
                    label: "share of draws (%)".to_owned(),
                    caption,
                    range: Range::Percent,
                },
                may_fail,
                &share,
            ));
        }
        for measure in SPREAD {
            figures.push(self.figure(
                &Words {
                    name: name_of(measure),
                    title: capital(measure),
                    label: with_unit(measure.headline().0, measure.unit()),
                    caption: String::new(),
                    // Bodies are to be compared.
                    range: Range::Common,
                },
                |_| true,
                &move |r| headline(r, measure),
            ));
        }
        figures
    }

    fn figure(
        &self,
        Words { name, title, label, caption, range }: &Words,
        shown: impl Fn(&ModelKind) -> bool,
        value: Value<'_>,
    ) -> Figure {
        let panels: Vec<LinePanel> = self
            .bodies
            .iter()
            .map(|body| LinePanel {
                title: body.name.clone(),
                lines: self
                    .settings
                    .models
                    .iter()
                    .filter(|kind| shown(kind))
                    .map(|kind| line(body, *kind, value))
                    .collect(),
            })
            .collect();
        let lines = LineGrid {
            title: title.clone(),
            panels,
            x_label: "uncertainty (% of the largest moment)".to_owned(),
            y_label: label.clone(),
            levels: self.settings.levels_percent.clone(),
            range: *range,
        };
        Figure {
            name: name.clone(),
            caption: format!("{title}, over the uncertainty, for each body{caption}"),
            picture: Picture::Lines(lines),
        }
    }
}

fn headline(results: &Results, measure: Measure) -> Option<(f64, Option<[f64; 2]>)> {
    Some((results.spread(measure)?.headline()?, None))
}

/// Measure and what is told of it, the first letter large.
pub(super) fn capital(measure: Measure) -> String {
    let text = format!("{}: {}", measure.label(), measure.headline().0);
    let mut chars = text.chars();
    chars.next().map_or_else(String::new, |first| first.to_uppercase().chain(chars).collect())
}
