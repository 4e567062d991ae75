//! One panel of histograms: axes, bars, notes.

use super::axis::{Spacing, Tick, Units, ticks, times};
use super::bins::Binned;
use super::histogram::Panel;
use super::style;
use super::svg::{Anchor, Look, Svg, px};
use super::text::{count, fit, significant, width};

const TICK: Look = Look::new(11.0, style::MUTED);
const LABEL: Look = Look::new(12.0, style::INK).at(Anchor::Middle);
const NOTE: Look = Look::new(10.5, style::MUTED);

/// Space between the columns.
pub(super) const GUTTER: f64 = 26.0;
/// The least width of a bin in pixels that still reads as a step.
const STEP: f64 = 2.5;

/// The pen and fill of the bars of a model.
pub(super) fn outline_pen(model: usize) -> String {
    let colour = style::model(model);
    format!(
        "fill=\"{colour}\" fill-opacity=\"0.16\" stroke=\"{colour}\" stroke-width=\"1.3\" \
         stroke-linejoin=\"miter\""
    )
}

pub(super) fn nominal_pen() -> String {
    format!("stroke=\"{}\" stroke-dasharray=\"4 3\"", style::NOMINAL)
}

/// The rectangle that bars are drawn in.
pub(super) struct Frame {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) width: f64,
    pub(super) height: f64,
}

impl Frame {
    fn bottom(&self) -> f64 {
        self.top + self.height
    }

    fn middle(&self) -> f64 {
        self.left + self.width / 2.0
    }

    fn line(&self, y: f64) -> String {
        format!("M{} {}h{}", px(self.left), px(y), px(self.width))
    }
}

/// A panel with what is to be drawn of it.
pub(super) struct Cell<'a> {
    panel: &'a Panel<'a>,
    /// Place of each series among the models of the figure.
    models: Vec<usize>,
    /// `None` without data.
    plot: Option<(Binned, Vertical)>,
}

impl<'a> Cell<'a> {
    /// The panel for a plot of the width and height given.
    pub(super) fn new(
        panel: &'a Panel<'a>,
        models: Vec<usize>,
        density: bool,
        (width, height): (f64, f64),
    ) -> Self {
        let plot = Binned::new(panel, (width / STEP) as usize).map(|binned| {
            let vertical = Vertical::new(&binned, density, height);
            (binned, vertical)
        });
        Self { panel, models, plot }
    }

    /// Width that the labels of the vertical axis need.
    pub(super) fn room(&self) -> f64 {
        let ticks = self.plot.iter().flat_map(|(_, vertical)| &vertical.ticks);
        8.0 + ticks.map(|tick| width(&tick.label, TICK.size)).fold(0.0, f64::max)
    }

    pub(super) fn marks_nominal(&self) -> bool {
        self.plot.as_ref().is_some_and(|(binned, _)| binned.nominal.is_some())
    }

    /// Draws the panel; returns where it ends.
    pub(super) fn draw(&self, svg: &mut Svg, frame: &Frame) -> f64 {
        let base = frame.bottom();
        let units = if let Some((binned, vertical)) = &self.plot {
            vertical.draw(svg, frame);
            self.bars(svg, frame, binned, vertical);
            binned.units.note()
        } else {
            svg.path(&format!("stroke=\"{}\"", style::AXIS), &frame.line(base));
            let y = frame.top + frame.height / 2.0 + 4.0;
            svg.text(frame.middle(), y, TICK.at(Anchor::Middle), "no data");
            String::new()
        };
        let units = if units.is_empty() { units } else { format!("  {units}") };
        let room = frame.width + GUTTER - width(&units, LABEL.size);
        let label = fit(&self.panel.label, LABEL.size, room);
        let runs = [(style::INK, label.as_str()), (style::MUTED, units.as_str())];
        svg.runs(frame.middle(), base + 33.0, LABEL, &runs);
        self.notes(svg, frame)
    }

    fn bars(&self, svg: &mut Svg, frame: &Frame, binned: &Binned, vertical: &Vertical) {
        let base = frame.bottom();
        let (lower, upper) = binned.range;
        let x = |value: f64| px(frame.left + (value - lower) / (upper - lower) * frame.width);
        let spacing =
            Spacing { length: frame.width, most: 6, side_by_side: Some(TICK.size), whole: false };
        let ticks = ticks(lower, upper, spacing);
        let marks: String =
            ticks.iter().map(|tick| format!("M{} {}v4", x(tick.at), px(base))).collect();
        svg.path(&format!("stroke=\"{}\"", style::AXIS), &(frame.line(base) + &marks));
        for tick in &ticks {
            let at = frame.left + (tick.at - lower) / (upper - lower) * frame.width;
            svg.text(at, base + 16.0, TICK.at(Anchor::Middle), &tick.label);
        }
        for (heights, &model) in vertical.heights.iter().zip(&self.models) {
            let d = steps(&binned.edges, heights, x, |height| px(vertical.y(height, frame)));
            svg.path(&outline_pen(model), &d);
        }
        if let Some(nominal) = binned.nominal {
            let d = format!("M{} {}V{}", x(nominal), px(frame.top), px(base));
            svg.path(&nominal_pen(), &d);
        }
    }

    /// Draws what the panel leaves out, a line each; returns where the last ends.
    fn notes(&self, svg: &mut Svg, frame: &Frame) -> f64 {
        let mut y = frame.bottom() + 37.0;
        let mut line = |runs: &[(&str, &str)]| {
            y += 14.0;
            svg.runs(frame.middle(), y - 3.0, NOTE.at(Anchor::Middle), runs);
        };
        let mut tell = |what: &str, of: &[usize]| {
            if of.iter().all(|&n| n == 0) {
                return;
            }
            let numbers: Vec<String> = of.iter().map(|&n| count(n)).collect();
            let mut runs = vec![(style::MUTED, what)];
            for (i, number) in numbers.iter().enumerate() {
                if i > 0 {
                    runs.push((style::MUTED, " · "));
                }
                runs.push((style::model(self.models[i]), number));
            }
            line(&runs);
        };
        let binned = self.plot.as_ref().map(|(binned, _)| binned);
        if let Some(binned) = binned {
            tell("runs left of the axis: ", &binned.below);
            tell("runs right of the axis: ", &binned.above);
        }
        let finite = |i: usize| binned.map_or(0, |b| b.finite[i]);
        let sizes = self.panel.series.iter().map(|s| s.values.len());
        tell(
            "runs not finite: ",
            &sizes.enumerate().map(|(i, n)| n - finite(i)).collect::<Vec<_>>(),
        );
        if let Some(nominal) = self.panel.nominal.filter(|x| x.is_finite() && !self.marks_nominal())
        {
            let off = if binned.is_some() { ", off the axis" } else { "" };
            line(&[(style::MUTED, &format!("nominal{off}: {}", significant(nominal, 5)))]);
        }
        y
    }
}

/// The vertical axis of a panel.
struct Vertical {
    /// Height of each bin of each series, in the units of the axis.
    heights: Vec<Vec<f64>>,
    /// The value at the top of the plot.
    top: f64,
    ticks: Vec<Tick>,
    label: String,
}

impl Vertical {
    fn new(binned: &Binned, density: bool, length: f64) -> Self {
        let mut heights: Vec<Vec<f64>> =
            (0..binned.counts.len()).map(|i| binned.heights(i, density)).collect();
        let highest = heights.iter().flatten().copied().fold(0.0, f64::max);
        // A density is per unit of the horizontal axis, whose factor its own then has to undo.
        let factor = if density { -binned.units.exponent } else { 0 };
        let units =
            if factor == 0 { Units::for_range(0.0, highest) } else { Units::with_factor(highest) };
        heights.iter_mut().flatten().for_each(|height| *height = units.of(*height));
        let top = if highest > 0.0 { 1.06 * units.of(highest) } else { 1.0 };
        let most = if length > 200.0 { 6 } else { 5 };
        let whole = !density && units.exponent == 0;
        let ticks = ticks(0.0, top, Spacing { length, most, side_by_side: None, whole });
        let what = if density { "density" } else { "runs per bin" };
        let label = format!("{what} {}", times(units.exponent + factor));
        Self { heights, top, ticks, label }
    }

    fn y(&self, height: f64, frame: &Frame) -> f64 {
        frame.bottom() - height / self.top * frame.height
    }

    fn draw(&self, svg: &mut Svg, frame: &Frame) {
        let grid: String =
            self.ticks.iter().skip(1).map(|tick| frame.line(self.y(tick.at, frame))).collect();
        svg.path(&format!("stroke=\"{}\"", style::GRID), &grid);
        for tick in &self.ticks {
            let y = self.y(tick.at, frame) + 4.0;
            svg.text(frame.left - 5.0, y, TICK.at(Anchor::End), &tick.label);
        }
        svg.text(frame.left, frame.top - 6.0, NOTE, self.label.trim_end());
    }
}

/// The outline of the bars, lifted off the axis where there are none.
fn steps(
    edges: &[f64],
    heights: &[f64],
    x: impl Fn(f64) -> String,
    y: impl Fn(f64) -> String,
) -> String {
    let mut d = String::new();
    let mut before = 0.0;
    for (pair, &height) in edges.windows(2).zip(heights) {
        if height != before {
            if before == 0.0 {
                d.push_str(&format!("M{} {}", x(pair[0]), y(0.0)));
            } else {
                d.push_str(&format!("H{}", x(pair[0])));
            }
            d.push_str(&format!("V{}", y(height)));
        }
        before = height;
    }
    if let (Some(&last), true) = (edges.last(), before > 0.0) {
        d.push_str(&format!("H{}V{}", x(last), y(0.0)));
    }
    d
}
