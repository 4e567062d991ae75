//! One panel of histograms: axes, bars, notes.

use serde::{Deserialize, Serialize};

use crate::axis::{Spacing, Tick, Units, ticks, times};
use crate::bins::{Beyond, Binned};
use crate::data::Sheet;
use crate::samples::{Panel, Series};
use crate::style;
use crate::svg::{Anchor, Look, Svg, px};
use crate::text::{count, fit, significant, width};

const TICK: Look = Look::new(11.0, style::MUTED);
const LABEL: Look = Look::new(12.0, style::INK).at(Anchor::Middle);
const NOTE: Look = Look::new(11.0, style::MUTED);

/// Space between the columns.
pub(crate) const GUTTER: f64 = 26.0;
/// The least width of a bin in pixels that still reads as a step.
const STEP: f64 = 2.5;

/// The pen and fill of the bars of a model.
pub(crate) fn outline_pen(model: usize) -> String {
    let colour = style::model(model);
    format!(
        "fill=\"{colour}\" fill-opacity=\"0.16\" stroke=\"{colour}\" stroke-width=\"1.3\" \
         stroke-linejoin=\"miter\"{}",
        style::dashes(model)
    )
}

pub(crate) fn nominal_pen() -> String {
    format!("stroke=\"{}\" stroke-dasharray=\"4 3\"", style::NOMINAL)
}

/// The rectangle that bars are drawn in.
pub(crate) struct Frame {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
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

/// What is known of the samples of a panel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Counted {
    pub(crate) label: String,
    /// A finite value to mark, in the unit of the label.
    pub(crate) nominal: Option<f64>,
    pub(crate) series: Vec<CountedSeries>,
    /// None without data.
    pub(crate) bins: Option<Binned>,
}

/// What is known of a sample beside its bins.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct CountedSeries {
    pub(crate) name: String,
    /// How many runs there are, and how many of them have a value.
    pub(crate) runs: usize,
    pub(crate) values: usize,
    /// Least, middle and largest of the finite values, where there are any.
    pub(crate) quantiles: Option<[f64; 3]>,
}

/// Bins that are wide enough to be seen in a plot of this width.
pub(crate) fn most_bins(width: f64) -> usize {
    (width / STEP) as usize
}

impl Counted {
    /// Of a panel and its bins.
    pub(crate) fn new(panel: &Panel<'_>, bins: Option<Binned>) -> Self {
        let series = |series: &Series<'_>| CountedSeries {
            name: series.name.to_owned(),
            runs: series.runs,
            values: series.values,
            quantiles: series.sample().map(|s| [s.minimum(), s.median(), s.maximum()]),
        };
        Self {
            label: panel.label.clone(),
            nominal: panel.nominal.filter(|x| x.is_finite()),
            series: panel.series.iter().map(series).collect(),
            bins,
        }
    }

    /// Bins and counts of each series, if there are any; what lies beyond the bins has one bound.
    pub(crate) fn sheet(&self) -> Option<Sheet> {
        let rows = self.bins.as_ref()?.rows();
        let names = self.series.iter().map(|series| series.name.clone());
        let columns = ["from".to_owned(), "to".to_owned()].into_iter().chain(names).collect();
        Some(Sheet { panel: self.label.clone(), columns, rows })
    }
}

/// A panel with what is to be drawn of it.
pub(crate) struct Cell<'a> {
    panel: &'a Counted,
    /// Place of each series among the models of the figure.
    models: Vec<usize>,
    /// `None` without data.
    plot: Option<(&'a Binned, Vertical)>,
}

impl<'a> Cell<'a> {
    /// The panel for a plot of the height given.
    pub(crate) fn new(panel: &'a Counted, models: Vec<usize>, density: bool, height: f64) -> Self {
        let plot = panel.bins.as_ref().map(|bins| (bins, Vertical::new(bins, density, height)));
        Self { panel, models, plot }
    }

    /// Width that the labels of the vertical axis need.
    pub(crate) fn room(&self) -> f64 {
        let ticks = self.plot.iter().flat_map(|(_, vertical)| &vertical.ticks);
        8.0 + ticks.map(|tick| width(&tick.label, TICK.size)).fold(0.0, f64::max)
    }

    pub(crate) fn shows(&self, model: usize) -> bool {
        self.models.contains(&model)
    }

    pub(crate) fn marks_nominal(&self) -> bool {
        self.plot.as_ref().is_some_and(|(binned, _)| binned.nominal.is_some())
    }

    /// Draws the panel; returns where it ends.
    pub(crate) fn draw(&self, svg: &mut Svg, frame: &Frame) -> f64 {
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
        self.edges(svg, frame, binned, vertical);
        if let Some(nominal) = binned.nominal {
            let d = format!("M{} {}V{}", x(nominal), px(frame.top), px(base));
            svg.path(&nominal_pen(), &d);
        }
    }

    /// What lies beyond the bins: at the ends of the axis a bar for each series, side by side and never too
    /// low to be seen, with arrows that point outwards.
    fn edges(&self, svg: &mut Svg, frame: &Frame, binned: &Binned, vertical: &Vertical) {
        let base = frame.bottom();
        let (lower, upper) = binned.range;
        let scale = frame.width / (upper - lower);
        let first = binned.edges.first().copied().into_iter().chain(binned.nominal);
        let last = binned.edges.last().copied().into_iter().chain(binned.nominal);
        let rooms = [first.fold(upper, f64::min) - lower, upper - last.fold(lower, f64::max)];
        for (side, beyond) in [&binned.below, &binned.above].into_iter().enumerate() {
            let there: Vec<usize> = (0..beyond.len()).filter(|&i| beyond[i].count > 0).collect();
            // A gap between them and the bins.
            let wide = (0.7 * rooms[side] * scale / there.len().max(1) as f64).min(5.0);
            for (place, &series) in there.iter().enumerate() {
                let colour = style::model(self.models[series]);
                let high = (vertical.edges[series][side] / vertical.top * frame.height).max(2.5);
                let along = wide * place as f64;
                let x = if side == 0 {
                    frame.left + along
                } else {
                    frame.left + frame.width - along - wide
                };
                svg.path(
                    &format!("fill=\"{colour}\""),
                    &format!("M{} {}v-{}h{}v{}z", px(x), px(base), px(high), px(wide), px(high)),
                );
            }
            if !there.is_empty() {
                // Below the axis, clear of its labels.
                let (tip, back) =
                    if side == 0 { (frame.left, 6.0) } else { (frame.left + frame.width, -6.0) };
                let arrow = format!("M{} {}l{back} -3v6z", px(tip), px(base + 5.0));
                svg.path(&format!("fill=\"{}\"", style::model(self.models[there[0]])), &arrow);
            }
        }
    }

    /// Says what lies beyond the axis and what cannot be drawn, a line each; returns where the last ends.
    fn notes(&self, svg: &mut Svg, frame: &Frame) -> f64 {
        let mut y = frame.bottom() + 37.0;
        let mut line = |runs: &[(&str, &str)]| {
            y += 14.0;
            svg.runs(frame.middle(), y - 3.0, NOTE.at(Anchor::Middle), runs);
        };
        // Texts in the colours of their series, on one line if they have room.
        let by_colour = self.models.iter().all(|model| style::is_told_by_colour(model + 1));
        let mut tell = |what: &str, of: Vec<Option<String>>| {
            let named = |(i, text): (usize, Option<String>)| {
                let text = text?;
                // Of models with the same colour it says which.
                let name = &self.panel.series[i].name;
                Some((i, if by_colour { text } else { format!("{name}: {text}") }))
            };
            let said: Vec<(usize, String)> = of.into_iter().enumerate().filter_map(named).collect();
            let whole: String = said.iter().map(|(_, text)| format!("{text} · ")).collect();
            let room = frame.width + GUTTER;
            let together = width(what, NOTE.size) + width(&whole, NOTE.size) <= room;
            for group in said.chunks(if together { said.len().max(1) } else { 1 }) {
                let mut runs = vec![(style::MUTED, what)];
                for (place, (i, text)) in group.iter().enumerate() {
                    if place > 0 {
                        runs.push((style::MUTED, " · "));
                    }
                    runs.push((style::model_colour(self.models[*i]).words, text));
                }
                line(&runs);
            }
        };
        let binned = self.panel.bins.as_ref();
        if let Some(binned) = binned {
            let beyond = |all: &[Beyond]| {
                let text =
                    |b: &Beyond| format!("{}, to {}", count(b.count), significant(b.extreme, 4));
                all.iter().map(|b| (b.count > 0).then(|| text(b))).collect::<Vec<_>>()
            };
            tell("at the left edge: ", beyond(&binned.below));
            tell("at the right edge: ", beyond(&binned.above));
        }
        let series = || self.panel.series.iter();
        let told = |n: usize| (n > 0).then(|| count(n));
        let finite = |i: usize| binned.map_or(0, |binned| binned.finite[i]);
        let lost = series().enumerate().map(|(i, s)| told(s.values - finite(i)));
        tell("not finite: ", lost.collect());
        let without = |s: &CountedSeries| told(s.runs.saturating_sub(s.values));
        tell("runs without a value: ", series().map(without).collect());
        if let Some(nominal) = self.panel.nominal.filter(|_| !self.marks_nominal()) {
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
    /// Heights below and above the bins, of each series.
    edges: Vec<[f64; 2]>,
    /// The value at the top of the plot.
    top: f64,
    ticks: Vec<Tick>,
    label: String,
}

impl Vertical {
    fn new(binned: &Binned, density: bool, length: f64) -> Self {
        let mut heights: Vec<Vec<f64>> =
            (0..binned.counts.len()).map(|i| binned.heights(i, density)).collect();
        let mut edges: Vec<[f64; 2]> =
            (0..binned.counts.len()).map(|i| binned.edge_heights(i, density)).collect();
        let all = heights.iter().flatten().chain(edges.iter().flatten());
        let highest = all.copied().fold(0.0, f64::max);
        // A density is per unit of the horizontal axis, whose factor its own then has to undo.
        let factor = if density { -binned.units.exponent } else { 0 };
        let units =
            if factor == 0 { Units::for_range(0.0, highest) } else { Units::with_factor(highest) };
        let all = heights.iter_mut().flatten().chain(edges.iter_mut().flatten());
        all.for_each(|height| *height = units.of(*height));
        let top = if highest > 0.0 { 1.06 * units.of(highest) } else { 1.0 };
        let most = if length > 200.0 { 6 } else { 5 };
        let whole = !density && units.exponent == 0;
        let ticks = ticks(0.0, top, Spacing { length, most, side_by_side: None, whole });
        let what = if density { "density" } else { "runs per bin" };
        let label = format!("{what} {}", times(units.exponent + factor));
        Self { heights, edges, top, ticks, label }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::svg::tests::read;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
    use rand_distr::{Cauchy, Distribution, Normal, Uniform};

    /// Runs of some law: heavy tails, ties, a constant, a far clump, nothing, one.
    fn sample(kind: usize, random: &mut ChaCha8Rng) -> Vec<f64> {
        let n = [0, 1, 2, 7, 100, 3000][Uniform::new(0, 6).unwrap().sample(random)];
        let normal = Normal::new(4.364_f64, 0.01).unwrap();
        let cauchy = Cauchy::new(0.0_f64, 1.0).unwrap();
        let share = Uniform::new(0.0_f64, 1.0).unwrap();
        let rare = 0.03 * share.sample(random);
        (0..n)
            .map(|_| match kind {
                0 => normal.sample(random),
                1 => cauchy.sample(random),
                2 => (3.0 * share.sample(random)).floor(),
                3 => -7.25,
                4 if share.sample(random) < rare => 0.0,
                4 => normal.sample(random),
                5 if share.sample(random) < rare => f64::NAN,
                5 => 1e9 * cauchy.sample(random).exp(),
                _ => normal.sample(random) * 1e-9,
            })
            .collect()
    }

    /// Numbers of a note of a series: counts, and how far values go.
    fn notes(text: &str, what: &str) -> usize {
        let lines = text.lines().filter_map(|line| line.strip_prefix(what));
        let counts = lines.flat_map(|line| line.split(" · "));
        let number = |part: &str| -> usize {
            let digits = part.split(',').next().unwrap().replace('\u{2009}', "");
            digits.trim().parse().unwrap()
        };
        counts.map(number).sum()
    }

    /// A number as it is read in a figure, where raised digits are digits.
    fn plain(x: f64) -> String {
        let raised = "⁰¹²³⁴⁵⁶⁷⁸⁹⁻";
        let flat: Vec<char> = "0123456789−".chars().collect();
        let lower = |c: char| raised.chars().position(|r| r == c).map_or(c, |i| flat[i]);
        significant(x, 4).chars().map(lower).collect()
    }

    /// Whatever the data: bins, edges, and what is said not to be drawn are all the runs; what is at an
    /// edge is drawn there in the colour of its series.
    #[test]
    fn no_run_is_left_out() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let mut at_edges = 0;
        for round in 0..300 {
            let series = 1 + round % 3;
            let samples: Vec<Vec<f64>> = (0..series)
                .map(|i| sample((round / 3 + i * (round % 2)) % 7, &mut random))
                .collect();
            let failed: Vec<usize> = (0..series).map(|i| [0, 5, 12][(round + i) % 3]).collect();
            let panel = Panel {
                label: "clearance (m)".to_owned(),
                series: samples
                    .iter()
                    .zip(&failed)
                    .map(|(values, failed)| Series::new("", values, values.len() + failed))
                    .collect(),
                nominal: [None, Some(4.3), Some(1e12)][round % 3],
            };
            let density = round % 2 == 0;
            let size = [(500.0, 220.0), (350.0, 160.0), (232.0, 122.0)][round % 3];
            let counted = Counted::new(
                &panel,
                Binned::new(panel.series.iter(), panel.nominal, most_bins(size.0)),
            );
            let cell = Cell::new(&counted, (0..series).collect(), density, size.1);
            let mut svg = Svg::new();
            let frame = Frame { left: 50.0, top: 20.0, width: size.0, height: size.1 };
            let end = cell.draw(&mut svg, &frame);
            let svg = svg.finish((600.0, end), "", "figure");
            let text = read(&svg);
            let binned = cell.plot.as_ref().map(|(binned, _)| binned);
            let inside: u64 = binned.iter().flat_map(|b| &b.counts).flatten().sum();
            let [left, right] =
                ["at the left edge: ", "at the right edge: "].map(|what| notes(&text, what));
            let told = left
                + right
                + notes(&text, "not finite: ")
                + notes(&text, "runs without a value: ");
            let runs: usize = panel.series.iter().map(|s| s.runs).sum();
            assert_eq!(inside as usize + told, runs, "{text}");
            // A bar for each series at each edge that has something.
            let beyond = binned.iter().flat_map(|b| [&b.below, &b.above]).enumerate();
            for (side, beyond) in beyond {
                for (i, beyond) in beyond.iter().enumerate().filter(|(_, b)| b.count > 0) {
                    at_edges += 1;
                    let worst = samples[i].iter().copied().filter(|x| x.is_finite());
                    let worst = worst.fold(f64::NAN, if side == 0 { f64::min } else { f64::max });
                    assert_eq!(beyond.extreme, worst);
                    assert!(text.contains(&format!(", to {}", plain(worst))), "{text}");
                    let bar = format!("<path fill=\"{}\" d=\"M", style::model(i));
                    assert!(svg.contains(&bar), "{svg}");
                }
            }
            // Bins and edges do not overlap, and nothing reaches out of the frame but arrows.
            if let Some((binned, vertical)) = &cell.plot {
                assert!(binned.range.0 < binned.edges[0]);
                assert!(binned.range.1 > *binned.edges.last().unwrap());
                let heights =
                    vertical.heights.iter().flatten().chain(vertical.edges.iter().flatten());
                assert!(heights.into_iter().all(|h| (0.0..=vertical.top).contains(h)));
            }
        }
        assert!(at_edges > 40, "{at_edges}");
    }
}
