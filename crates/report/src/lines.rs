//! Lines over a few levels on logarithmic axes, in a grid of panels.

use serde::{Deserialize, Serialize};

use crate::axis::{Tick, decades};
use crate::data::{Field, Sheet};
use crate::legend::{Entry, legend};
use crate::style::{self, MARGIN};
use crate::svg::{Anchor, Look, Svg, px};
use crate::text::{fit, significant, width};

const TICK: Look = Look::new(11.0, style::MUTED);
const LABEL: Look = Look::new(12.0, style::INK).at(Anchor::Middle);
const NOTE: Look = Look::new(11.0, style::MUTED);
const NAME: Look = Look::new(12.5, style::INK).bold();

const SIZE: (f64, f64) = (350.0, 190.0);
const ROOM: f64 = 46.0;
const GUTTER: f64 = 30.0;
/// Below the lowest decade: where zeros are drawn.
const ZERO: f64 = 26.0;
/// Decades below the largest value that are worth their place.
const DECADES: i32 = 6;

/// A value at a level.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LinePoint {
    /// The level.
    pub x: f64,
    /// Not negative.
    pub y: f64,
    /// What is drawn as a bar through the point.
    pub interval: Option<[f64; 2]>,
    /// Whether the point is to be told from the others.
    pub hollow: bool,
}

/// A line through points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Line {
    /// As in the legend; a name has the same pen in all panels.
    pub name: String,
    /// Place among the colours of models.
    pub colour: usize,
    /// Whether the line is dashed.
    pub dashed: bool,
    /// From left to right; what is not finite or negative is left out.
    pub points: Vec<LinePoint>,
}

/// Lines on the same axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LinePanel {
    /// What stands above it.
    pub title: String,
    /// The lines.
    pub lines: Vec<Line>,
}

/// What the vertical axes span.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Range {
    /// The same in all panels.
    Common,
    /// What each panel needs.
    Own,
    /// The same in all panels, of shares in percent: to 100 at most.
    Percent,
}

/// Panels in two columns; `levels` are the ticks of the horizontal axis, which is the same in all. Zeros
/// stand below the lowest decade.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LineGrid {
    /// What stands above the panels.
    pub title: String,
    /// The panels, row by row.
    pub panels: Vec<LinePanel>,
    /// What is on the horizontal axes, with its unit.
    pub x_label: String,
    /// What is on the vertical axes, with its unit.
    pub y_label: String,
    /// Ticks of the horizontal axes.
    pub levels: Vec<f64>,
    /// What the vertical axes span.
    pub range: Range,
}

impl LineGrid {
    /// The figure drawn.
    #[must_use]
    pub fn svg(&self) -> String {
        let Self { title, panels, x_label, y_label, levels, range } = self;
        line_grid(title, panels, x_label, y_label, levels, *range)
    }

    /// The points, as a sheet for each panel.
    pub(crate) fn sheets(&self) -> Vec<Sheet> {
        let point = |line: &Line, point: &LinePoint| {
            let ends = [0, 1].map(|i| Field::Number(point.interval.map(|ends| ends[i])));
            let at = [Field::words(&line.name), Field::number(point.x), Field::number(point.y)];
            at.into_iter().chain(ends).collect()
        };
        let rows = |panel: &LinePanel| {
            let points =
                |line: &'_ Line| line.points.iter().map(|p| point(line, p)).collect::<Vec<_>>();
            panel.lines.iter().flat_map(points).collect()
        };
        let sheet = |panel: &LinePanel| Sheet {
            panel: panel.title.clone(),
            columns: ["line", &self.x_label, &self.y_label, "lower", "upper"]
                .map(str::to_owned)
                .into(),
            rows: rows(panel),
        };
        self.panels.iter().map(sheet).collect()
    }
}

fn line_grid(
    title: &str,
    panels: &[LinePanel],
    x_label: &str,
    y_label: &str,
    levels: &[f64],
    range: Range,
) -> String {
    let columns = panels.len().clamp(1, 2);
    let (w, h) = SIZE;
    let pitch = ROOM + w + GUTTER;
    let figure_width = 2.0 * MARGIN + pitch * columns as f64 - GUTTER + 12.0;
    let axes: Vec<Option<Axes>> = match range {
        Range::Common => vec![Axes::new(panels, levels, f64::INFINITY); panels.len()],
        Range::Percent => vec![Axes::new(panels, levels, 100.0); panels.len()],
        Range::Own => {
            let own = |p| Axes::new(std::slice::from_ref(p), levels, f64::INFINITY);
            panels.iter().map(own).collect()
        }
    };
    let mut svg = Svg::new();
    let mut y = svg.heading(title, figure_width);
    y = legend(&mut svg, entries(panels), y + 4.0, figure_width) + 10.0;
    for (row, axes) in panels.chunks(columns).zip(axes.chunks(columns)) {
        for (column, (panel, axes)) in row.iter().zip(axes).enumerate() {
            let left = MARGIN + ROOM + pitch * column as f64;
            if let Some(axes) = axes {
                axes.draw(&mut svg, panel, (left, y + 34.0), (x_label, y_label));
            } else {
                svg.text(left, y + 14.0, NAME, &fit(&panel.title, NAME.size, w));
                svg.text(left + w / 2.0, y + 34.0 + h / 2.0, TICK.at(Anchor::Middle), "no data");
            }
        }
        y += 34.0 + h + 46.0;
    }
    if panels.is_empty() {
        svg.text(figure_width / 2.0, y + 30.0, TICK.at(Anchor::Middle), "no data");
        y += 60.0;
    }
    svg.finish((figure_width, y), title, &description(panels))
}

fn entries(panels: &[LinePanel]) -> Vec<Entry> {
    let mut shown: Vec<&Line> = Vec::new();
    for line in panels.iter().flat_map(|p| &p.lines).filter(|l| !l.points.is_empty()) {
        if !shown.iter().any(|s| s.name == line.name) {
            shown.push(line);
        }
    }
    let mut entries: Vec<Entry> = shown
        .into_iter()
        .map(|line| {
            let mut swatch = Svg::new();
            swatch.path(&pen(line), "M0 0h26");
            swatch.path(&marker_pen(line, false), &marker(line.colour, 13.0, 0.0));
            Entry { name: line.name.clone(), width: 26.0, swatch }
        })
        .collect();
    if panels.iter().flat_map(|p| &p.lines).flat_map(|l| &l.points).any(|p| p.hollow) {
        let mut swatch = Svg::new();
        let pen = format!("fill=\"#ffffff\" stroke=\"{}\" stroke-width=\"1.4\"", style::MUTED);
        swatch.path(&pen, &marker(0, 4.0, 0.0));
        let name = "covariance far off (hollow)".to_owned();
        entries.push(Entry { name, width: 8.0, swatch });
    }
    entries
}

fn pen(line: &Line) -> String {
    let own = style::dashes(line.colour);
    let dashes = if line.dashed { " stroke-dasharray=\"5 3\"" } else { &own };
    format!("stroke=\"{}\" stroke-width=\"1.6\"{dashes}", style::model(line.colour))
}

fn marker_pen(line: &Line, hollow: bool) -> String {
    let colour = style::model(line.colour);
    let fill = if hollow { "#ffffff" } else { colour };
    format!("fill=\"{fill}\" stroke=\"{colour}\" stroke-width=\"1.4\"")
}

/// The pen of the markers of a model, of which crossed lines have no inside.
pub(crate) fn mark_pen(model: usize) -> String {
    let colour = style::model(model);
    format!("fill=\"{colour}\" stroke=\"{colour}\"")
}

/// The shape of a model, for those who do not tell the colours apart; and one shape more than there are colours, so that models
/// of one colour have other shapes.
pub(crate) fn marker(model: usize, x: f64, y: f64) -> String {
    let from = |dx: f64, dy: f64| format!("M{} {}", px(x + dx), px(y + dy));
    match model % 7 {
        1 => from(-2.5, -2.5) + "h5v5h-5z",
        2 => from(0.0, -3.7) + "l3.7 3.7l-3.7 3.7l-3.7 -3.7z",
        3 => from(0.0, -3.6) + "l3.5 6h-7z",
        4 => from(0.0, 3.6) + "l3.5 -6h-7z",
        5 => from(-3.0, -3.0) + "l6 6m0 -6l-6 6",
        6 => from(-3.2, -3.2) + "h6.4l-6.4 6.4h6.4z",
        _ => from(-2.7, 0.0) + "a2.7 2.7 0 1 0 5.4 0a2.7 2.7 0 1 0 -5.4 0",
    }
}

/// Logarithmic axes.
#[derive(Debug, Clone)]
struct Axes {
    levels: Vec<f64>,
    /// Common logarithms of the range.
    x: [f64; 2],
    y: [f64; 2],
    ticks: Vec<Tick>,
    /// Whether there is a place for zeros.
    zeros: bool,
}

impl Axes {
    /// Of panels whose values are at most so large by their nature.
    fn new(panels: &[LinePanel], levels: &[f64], most: f64) -> Option<Self> {
        let usable = |p: &&LinePoint| p.y >= 0.0 && p.y.is_finite() && p.x > 0.0;
        let points = || panels.iter().flat_map(|p| &p.lines).flat_map(|l| &l.points).filter(usable);
        let positive = || points().map(|p| p.y).filter(|y| *y > 0.0).map(f64::log10);
        let highest = positive().fold(f64::NEG_INFINITY, f64::max);
        if !highest.is_finite() {
            // Nothing, or zeros only.
            points().next()?;
        }
        let highest = if highest.is_finite() { highest } else { 0.0 };
        let lowest = positive().fold(highest, f64::min).max(highest - f64::from(DECADES));
        // Whole decades: their ends are ticks.
        let mut y = [lowest.floor(), (highest + 0.02).ceil()];
        // An end at 2 or 5 is a tick as well, and leaves less empty.
        let top = y[1];
        for end in [5_f64, 2.0].map(f64::log10) {
            if highest < top - 1.0 + end - 0.02 && top - 1.0 + end > y[0] + 0.9 {
                y[1] = top - 1.0 + end;
            }
        }
        for start in [2_f64, 5.0].map(f64::log10) {
            if lowest > lowest.floor() + start + 0.02 && y[1] - lowest.floor() - start > 0.9 {
                y[0] = lowest.floor() + start;
            }
        }
        if y[1] - y[0] < 1.0 {
            y[1] = y[0] + 1.0;
        }
        if highest <= most.log10() && y[1] > most.log10() {
            y[1] = most.log10();
            y[0] = y[0].min(y[1] - 1.0);
        }
        let zeros = points().any(|p| !(p.y > 0.0) || p.y.log10() < y[0]);
        let log = |x: &f64| x.log10();
        let mut ends = levels.iter().filter(|x| **x > 0.0).map(log);
        let first = ends.next()?;
        let [a, b] = ends.fold([first, first], |[a, b], x| [a.min(x), b.max(x)]);
        let margin = if b > a { 0.04 * (b - a) } else { 0.5 };
        let ticks = decades(y);
        Some(Self { levels: levels.to_vec(), x: [a - margin, b + margin], y, ticks, zeros })
    }

    fn x(&self, level: f64) -> f64 {
        (level.log10() - self.x[0]) / (self.x[1] - self.x[0]) * SIZE.0
    }

    /// From the bottom up.
    fn y(&self, value: f64) -> f64 {
        let foot = if self.zeros { ZERO } else { 0.0 };
        let log = value.log10();
        if !(log >= self.y[0]) {
            return 0.0;
        }
        foot + (log.min(self.y[1]) - self.y[0]) / (self.y[1] - self.y[0]) * (SIZE.1 - foot)
    }

    fn draw(
        &self,
        svg: &mut Svg,
        panel: &LinePanel,
        (left, top): (f64, f64),
        (x_label, y_label): (&str, &str),
    ) {
        let (w, h) = SIZE;
        let base = top + h;
        svg.text(left, top - 20.0, NAME, &fit(&panel.title, NAME.size, w));
        svg.text(left, top - 6.0, NOTE, y_label);
        let across = |y: f64| format!("M{} {}h{}", px(left), px(y), px(w));
        let grid: String =
            self.ticks.iter().map(|t| across(base - self.y(10_f64.powf(t.at)))).collect();
        svg.path(&format!("stroke=\"{}\"", style::GRID), &grid);
        for tick in self.ticks.iter().filter(|t| !t.label.is_empty()) {
            let y = base - self.y(10_f64.powf(tick.at)) + 4.0;
            svg.text(left - 6.0, y, TICK.at(Anchor::End), &tick.label);
        }
        if self.zeros {
            // Small values stand there too.
            let below = |p: &LinePoint| p.y > 0.0 && p.y.log10() < self.y[0];
            let small = panel.lines.iter().flat_map(|l| &l.points).any(below);
            let foot = if small {
                format!("<{}", significant(10_f64.powf(self.y[0]), 1))
            } else {
                "0".to_owned()
            };
            svg.text(left - 6.0, base + 4.0, TICK.at(Anchor::End), &foot);
        }
        let marks: String = self
            .levels
            .iter()
            .map(|x| format!("M{} {}v4", px(left + self.x(*x)), px(base)))
            .collect();
        svg.path(&format!("stroke=\"{}\"", style::AXIS), &(across(base) + &marks));
        let mut free = f64::NEG_INFINITY;
        for level in &self.levels {
            let (at, text) = (left + self.x(*level), significant(*level, 6));
            let half = width(&text, TICK.size) / 2.0;
            if at - half > free {
                svg.text(at, base + 16.0, TICK.at(Anchor::Middle), &text);
                free = at + half + 4.0;
            }
        }
        svg.text(left + w / 2.0, base + 33.0, LABEL, x_label);
        for line in &panel.lines {
            self.line(svg, line, (left, base));
        }
    }

    fn line(&self, svg: &mut Svg, line: &Line, (left, base): (f64, f64)) {
        let points: Vec<&LinePoint> =
            line.points.iter().filter(|p| p.y >= 0.0 && p.y.is_finite() && p.x > 0.0).collect();
        let at = |p: &LinePoint| (left + self.x(p.x), base - self.y(p.y));
        let mut d = String::new();
        let mut bars = String::new();
        for (i, point) in points.iter().enumerate() {
            let (x, y) = at(point);
            // A level that was left out breaks the line.
            let place = |p: &LinePoint| self.levels.iter().position(|l| *l == p.x);
            let joined = i > 0
                && matches!((place(points[i - 1]), place(point)), (Some(a), Some(b)) if b == a + 1);
            d.push_str(&format!("{}{} {}", if joined { "L" } else { "M" }, px(x), px(y)));
            if let Some([low, high]) = point.interval.filter(|_| point.y > 0.0) {
                let (low, high) = (base - self.y(low), base - self.y(high));
                if low - high > 6.0 {
                    bars.push_str(&format!("M{} {}V{}", px(x), px(low), px(high)));
                }
            }
        }
        svg.path(&pen(line), &d);
        svg.path(
            &format!("stroke=\"{}\" stroke-opacity=\"0.6\"", style::model(line.colour)),
            &bars,
        );
        for hollow in [false, true] {
            let d: String = points
                .iter()
                .filter(|p| p.hollow == hollow)
                .map(|p| marker(line.colour, at(p).0, at(p).1))
                .collect();
            svg.path(&marker_pen(line, hollow), &d);
        }
    }
}

/// The figure in words.
fn description(panels: &[LinePanel]) -> String {
    let mut text = String::from("Lines over levels.");
    for panel in panels {
        let lines: Vec<String> = panel
            .lines
            .iter()
            .map(|line| {
                let points: Vec<String> = line
                    .points
                    .iter()
                    .map(|p| format!("{} at {}", significant(p.y, 3), significant(p.x, 3)))
                    .collect();
                format!("{}: {}", line.name, points.join(", "))
            })
            .collect();
        text.push_str(&format!(" {}: {}.", panel.title, lines.join("; ")));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::svg::tests::read;

    const LEVELS: [f64; 6] = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0];

    fn panel(values: &[f64]) -> LinePanel {
        let points = values.iter().zip(LEVELS).map(|(&y, x)| LinePoint {
            x,
            y,
            interval: Some([0.5 * y, 2.0 * y]),
            hollow: y > 1.0,
        });
        let line =
            Line { name: "one".to_owned(), colour: 0, dashed: false, points: points.collect() };
        LinePanel { title: "bus".to_owned(), lines: vec![line.clone(), line] }
    }

    fn draw(values: &[f64]) -> String {
        line_grid("Title", &[panel(values), panel(values)], "level (%)", "%", &LEVELS, Range::Own)
    }

    #[test]
    fn whatever_the_data_there_is_a_figure() {
        for values in [
            vec![],
            vec![0.0; 3],
            vec![1.0],
            vec![0.0, 0.01, 99.0],
            vec![1e-300, 1.0, 1e300],
            vec![f64::NAN, f64::INFINITY, -1.0],
            vec![5e-324, f64::MAX],
            vec![f64::NAN, 2.0, 3.0],
        ] {
            let svg = draw(&values);
            assert!(read(&svg).contains("Title"), "{values:?}");
        }
        assert!(read(&line_grid("Title", &[], "", "", &[], Range::Common)).contains("no data"));
        assert!(read(&draw(&[f64::NAN])).contains("no data"));
    }

    /// An axis of percentages ends at 100 at most, and holds all of them; other axes go beyond.
    #[test]
    fn shares_end_at_a_hundred() {
        for exponent in -60..=20 {
            for others in [vec![], vec![0.0], vec![1e-4], vec![30.0, 100.0]] {
                let largest = 10_f64.powf(0.1 * f64::from(exponent));
                let panels = [panel(&[&[largest][..], &others].concat())];
                let axes = Axes::new(&panels, &LEVELS, 100.0).unwrap();
                assert!(
                    axes.y[1] <= 2.0 && axes.y[1] - axes.y[0] >= 0.9,
                    "{largest} {others:?}: {:?}",
                    axes.y
                );
                assert!(axes.y[1] >= largest.log10() - 1e-12, "{largest}: {:?}", axes.y);
            }
        }
        let beyond = Axes::new(&[panel(&[100.0])], &LEVELS, f64::INFINITY).unwrap();
        assert!(beyond.y[1] > 2.0);
    }

    #[test]
    fn zeros_have_a_place_of_their_own() {
        assert!(read(&draw(&[0.0, 1.0, 10.0])).contains("\n0\n"));
        assert!(!read(&draw(&[1.0, 1.0, 10.0])).contains("\n0\n"));
    }

    #[test]
    fn a_missing_level_breaks_the_line() {
        let path = |values: &[f64]| {
            let svg = draw(values);
            // The lines, and not their swatch in the legend.
            let path = svg.lines().filter(|l| l.contains("stroke-width=\"1.6\"")).nth(1);
            path.unwrap_or_default().matches('M').count()
        };
        assert_eq!(path(&[1.0, 2.0, 3.0]), 1);
        assert_eq!(path(&[1.0, f64::NAN, 3.0]), 2);
    }

    #[test]
    fn hollow_points_are_explained() {
        assert!(read(&draw(&[0.5, 2.0])).contains("covariance far off (hollow)"));
        assert!(!read(&draw(&[0.5, 0.6])).contains("covariance"));
    }
}
