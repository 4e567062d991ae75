//! Ranges of quantities under several models, a row for each model.

use serde::{Deserialize, Serialize};

use crate::axis::{Spacing, Units, ticks};
use crate::data::{Field, Sheet};
use crate::legend::{Entry, legend};
use crate::panel::nominal_pen;
use crate::style::{self, MARGIN};
use crate::svg::{Anchor, Look, Svg, px};
use crate::text::{significant, width};

const TICK: Look = Look::new(11.0, style::MUTED);
const NAME: Look = Look::new(12.0, style::INK).at(Anchor::End);
const LABEL: Look = Look::new(12.0, style::INK).at(Anchor::Middle);

const WIDTH: f64 = 190.0;
const ROW: f64 = 19.0;
const GUTTER: f64 = 26.0;

/// A row.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Label {
    /// What it is called.
    pub name: String,
    /// Place among the colours of models.
    pub colour: usize,
    /// Whether it is to be told from the others.
    pub hollow: bool,
}

/// A quantity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RangePanel {
    /// What is on the axis, with its unit.
    pub label: String,
    /// A value to mark.
    pub nominal: Option<f64>,
    /// Lower end, middle and upper end in each row, finite, where there is a range.
    pub ranges: Vec<Option<[f64; 3]>>,
}

/// Panels side by side, on the same rows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RangeGrid {
    title: String,
    rows: Vec<Label>,
    panels: Vec<RangePanel>,
}

impl RangeGrid {
    /// Panels of the same rows; what is not finite is left out.
    #[must_use]
    pub fn new(title: &str, rows: Vec<Label>, mut panels: Vec<RangePanel>) -> Self {
        for panel in &mut panels {
            panel.nominal = panel.nominal.filter(|x| x.is_finite());
            for range in &mut panel.ranges {
                *range = range.filter(|range| range.iter().all(|x| x.is_finite()));
            }
        }
        Self { title: title.to_owned(), rows, panels }
    }

    /// The figure drawn.
    #[must_use]
    pub fn svg(&self) -> String {
        range_grid(&self.title, &self.rows, &self.panels)
    }

    /// The ranges, as a sheet for each panel.
    pub(crate) fn sheets(&self) -> Vec<Sheet> {
        let row = |(row, range): (&Label, &Option<[f64; 3]>)| -> Vec<Field> {
            let ends = [0, 1, 2].map(|i| Field::Number(range.map(|range| range[i])));
            [Field::words(&row.name)].into_iter().chain(ends).collect()
        };
        let sheet = |panel: &RangePanel| Sheet {
            panel: panel.label.clone(),
            columns: ["name", "lower", "middle", "upper"].map(str::to_owned).into(),
            rows: self.rows.iter().zip(&panel.ranges).map(row).collect(),
        };
        self.panels.iter().map(sheet).collect()
    }
}

fn range_grid(title: &str, rows: &[Label], panels: &[RangePanel]) -> String {
    let room = 12.0 + rows.iter().map(|r| width(&r.name, NAME.size)).fold(0.0, f64::max);
    let columns = panels.len() as f64;
    let figure_width = 2.0 * MARGIN + room + (WIDTH + GUTTER) * columns.max(1.0) - GUTTER + 12.0;
    let height = ROW * rows.len() as f64;
    let mut svg = Svg::new();
    let y = svg.heading(title, figure_width);
    let top = legend(&mut svg, entries(panels), y + 4.0, figure_width) + 10.0;
    for (i, row) in rows.iter().enumerate() {
        let y = top + ROW * (i as f64 + 0.5) + 4.2;
        svg.text(MARGIN + room - 10.0, y, NAME, &row.name);
    }
    for (column, panel) in panels.iter().enumerate() {
        let left = MARGIN + room + (WIDTH + GUTTER) * column as f64;
        draw(&mut svg, rows, panel, (left, top, height));
    }
    svg.finish((figure_width, top + height + 44.0), title, &description(rows, panels))
}

/// What the marks mean.
fn entries(panels: &[RangePanel]) -> Vec<Entry> {
    let mut swatch = Svg::new();
    let pen = format!("stroke=\"{}\" stroke-width=\"3\" stroke-opacity=\"0.55\"", style::INK);
    swatch.path(&pen, "M0 0h26");
    let pen = format!("fill=\"{}\"", style::INK);
    swatch.path(&pen, "M9 0a4 4 0 1 0 8 0a4 4 0 1 0 -8 0");
    let range = Entry { name: "range and its middle".to_owned(), width: 26.0, swatch };
    let mut swatch = Svg::new();
    swatch.path(&nominal_pen(), "M2 -7v14");
    let nominal = Entry { name: "nominal".to_owned(), width: 4.0, swatch };
    let is_marked = panels.iter().any(|panel| panel.nominal.is_some_and(f64::is_finite));
    let has_range = panels.iter().any(|panel| panel.ranges.iter().any(Option::is_some));
    has_range.then_some(range).into_iter().chain(is_marked.then_some(nominal)).collect()
}

fn draw(svg: &mut Svg, rows: &[Label], panel: &RangePanel, (left, top, height): (f64, f64, f64)) {
    let base = top + height;
    svg.path(
        &format!("stroke=\"{}\"", style::AXIS),
        &format!("M{} {}h{WIDTH}", px(left), px(base)),
    );
    let finite = |r: &&[f64; 3]| r.iter().all(|x| x.is_finite());
    let all = panel.ranges.iter().flatten().filter(finite).flatten().copied();
    let all = || all.clone().chain(panel.nominal.filter(|x| x.is_finite()));
    let (low, high) =
        all().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    if !(low <= high) {
        let look = TICK.at(Anchor::Middle);
        svg.text(left + WIDTH / 2.0, top + height / 2.0 + 4.0, look, "no data");
        svg.text(left + WIDTH / 2.0, base + 33.0, LABEL, &panel.label);
        return;
    }
    let units = Units::for_range(low, high);
    let (low, high) = (units.of(low), units.of(high));
    let margin = if high > low { 0.05 * (high - low) } else { 1.0 };
    let (low, high) = (low - margin, high + margin);
    let x = |value: f64| left + (units.of(value) - low) / (high - low) * WIDTH;
    let spacing = Spacing { length: WIDTH, most: 6, side_by_side: Some(TICK.size), whole: false };
    let ticks = ticks(low, high, spacing);
    let at = |u: f64| left + (u - low) / (high - low) * WIDTH;
    let grid: String =
        ticks.iter().map(|t| format!("M{} {}V{}", px(at(t.at)), px(base), px(top))).collect();
    svg.path(&format!("stroke=\"{}\"", style::GRID), &grid);
    for tick in &ticks {
        svg.text(at(tick.at), base + 16.0, TICK.at(Anchor::Middle), &tick.label);
    }
    let note = units.note();
    let label =
        if note.is_empty() { panel.label.clone() } else { format!("{}  {note}", panel.label) };
    svg.text(left + WIDTH / 2.0, base + 33.0, LABEL, &label);
    if let Some(nominal) = panel.nominal.filter(|x| x.is_finite()) {
        svg.path(&nominal_pen(), &format!("M{} {}V{}", px(x(nominal)), px(base), px(top)));
    }
    for (i, (row, range)) in rows.iter().zip(&panel.ranges).enumerate() {
        let y = top + ROW * (i as f64 + 0.5);
        let Some([a, b, c]) = range.filter(|r| r.iter().all(|x| x.is_finite())) else {
            svg.text(left + WIDTH / 2.0, y + 4.0, TICK.at(Anchor::Middle), "no value");
            continue;
        };
        let colour = style::model(row.colour);
        let bar = format!("stroke=\"{colour}\" stroke-width=\"3\" stroke-opacity=\"0.55\"");
        svg.path(&bar, &format!("M{} {}H{}", px(x(a)), px(y), px(x(c))));
        let fill = if row.hollow { "#ffffff" } else { colour };
        let pen = format!("fill=\"{fill}\" stroke=\"{colour}\" stroke-width=\"1.5\"");
        svg.path(&pen, &format!("M{} {}a4 4 0 1 0 8 0a4 4 0 1 0 -8 0", px(x(b) - 4.0), px(y)));
    }
}

/// The figure in words.
fn description(rows: &[Label], panels: &[RangePanel]) -> String {
    let mut text = String::from("Ranges.");
    for panel in panels {
        let ranges: Vec<String> = rows
            .iter()
            .zip(&panel.ranges)
            .map(|(row, range)| match range {
                Some([a, b, c]) => format!(
                    "{} from {} to {}, median {}",
                    row.name,
                    significant(*a, 4),
                    significant(*c, 4),
                    significant(*b, 4)
                ),
                None => format!("{} none", row.name),
            })
            .collect();
        text.push_str(&format!(" {}: {}.", panel.label, ranges.join("; ")));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::svg::tests::read;

    #[test]
    fn whatever_the_data_there_is_a_figure() {
        let rows =
            ["one", "two"].map(|name| Label { name: name.to_owned(), colour: 0, hollow: true });
        for range in [
            None,
            Some([0.0; 3]),
            Some([1.0, 2.0, 3.0]),
            Some([-1e300, 0.0, 1e300]),
            Some([f64::NAN; 3]),
            Some([0.0, 5e-324, 5e-324]),
        ] {
            for nominal in [None, Some(2.0), Some(f64::NAN)] {
                let panel = RangePanel {
                    label: "wobble (deg)".to_owned(),
                    nominal,
                    ranges: vec![range, None],
                };
                let text = read(&range_grid("Title", &rows, &[panel.clone(), panel]));
                let is_marked = nominal.is_some_and(f64::is_finite);
                assert_eq!(text.contains("\nnominal\n"), is_marked, "{text}");
                assert!(text.contains("wobble (deg)") && text.contains("two"), "{range:?}");
            }
        }
        assert!(read(&range_grid("Title", &[], &[])).contains("Title"));
    }
}
