//! Quantities against time, in two columns of charts.

use crate::axis::{Spacing, Units, ticks};
use crate::style::{self, Colour, MARGIN};
use crate::svg::{Anchor, Look, Svg, px};
use crate::text::{fit, width};

const TICK: Look = Look::new(11.0, style::MUTED);
const LABEL: Look = Look::new(12.0, style::INK);
const NOTE: Look = Look::new(11.0, style::MUTED);
const WIDTH: f64 = 372.0;
const HEIGHT: f64 = 118.0;
const GUTTER: f64 = 28.0;
/// Names of a chart's curves at most.
const NAMES: usize = 12;

/// The colour of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hue {
    /// That of the words.
    Ink,
    /// That of an axis, from 0.
    Axis(usize),
    /// That of a place among the colours of models, from 0.
    Series(usize),
}

impl Hue {
    fn colour(self) -> Colour {
        match self {
            Self::Ink => Colour { pen: style::INK, words: style::INK },
            Self::Axis(axis) => style::AXES[axis % style::AXES.len()],
            Self::Series(place) => style::model_colour(place),
        }
    }
}

/// A quantity against time.
#[derive(Clone, Debug)]
pub struct Curve {
    /// What it is called beside the label; may be empty.
    pub name: String,
    /// Its colour, which it has in all charts.
    pub hue: Hue,
    /// Time and value; what is not finite is left out.
    pub points: Vec<(f64, f64)>,
}

/// Curves on the same axes from time zero on.
#[derive(Clone, Debug)]
pub struct Chart {
    /// What is shown, with its unit.
    pub label: String,
    /// The curves.
    pub curves: Vec<Curve>,
    /// The end of the time axis.
    pub until: f64,
}

/// Charts row by row in two columns, with marks (what they are called, and when) on all of them.
#[must_use]
pub fn time_charts(title: &str, charts: &[Chart], marks: &[(String, f64)]) -> String {
    let scales: Vec<Scale> = charts.iter().map(Scale::new).collect();
    let room = scales.iter().map(Scale::room).fold(26.0, f64::max);
    let pitch = room + WIDTH + GUTTER;
    let figure_width = 2.0 * MARGIN + 2.0 * pitch - GUTTER + 12.0;
    let mut svg = Svg::new();
    let mut y = svg.heading(title, figure_width);
    if !marks.is_empty() {
        y += 15.0;
        svg.text(MARGIN, y - 3.0, NOTE, "dashed: springs let go, by their numbers");
    }
    for (charts, scales) in charts.chunks(2).zip(scales.chunks(2)) {
        for (column, (chart, scale)) in charts.iter().zip(scales).enumerate() {
            let left = MARGIN + room + pitch * column as f64;
            draw(&mut svg, chart, scale, (left, y + 34.0), marks);
        }
        y += 34.0 + HEIGHT + 34.0;
    }
    let names: Vec<_> = charts.iter().map(|c| c.label.as_str()).collect();
    let description = format!("Against time in seconds: {}.", names.join(", "));
    svg.finish((figure_width, y + 4.0), title, &description)
}

/// The vertical axis of a chart.
struct Scale {
    units: Units,
    lower: f64,
    upper: f64,
    ticks: Vec<crate::axis::Tick>,
}

impl Scale {
    fn new(chart: &Chart) -> Self {
        let shown = chart.curves.iter().flat_map(|curve| shown(curve, chart.until));
        let (lower, upper) = shown
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, u), (_, value)| {
                (l.min(value), u.max(value))
            });
        let (lower, upper) = if lower <= upper { (lower, upper) } else { (0.0, 1.0) };
        let size = lower.abs().max(upper.abs());
        // What differs by rounding only is a line.
        let half = 0.5 * upper - 0.5 * lower;
        let pad = match size {
            0.0 => 1.0,
            _ if half < 1e-9 * size => 0.05 * size,
            _ => 0.12 * half,
        };
        // Beyond f64 is no axis.
        let limit = 0.4 * f64::MAX;
        let (lower, upper) =
            ((lower - pad).clamp(-limit, limit), (upper + pad).clamp(-limit, limit));
        let units = Units::for_range(lower, upper);
        let (lower, upper) = (units.of(lower), units.of(upper));
        let spacing = Spacing { length: HEIGHT, most: 5, side_by_side: None, whole: false };
        Self { units, lower, upper, ticks: ticks(lower, upper, spacing) }
    }

    fn room(&self) -> f64 {
        8.0 + self.ticks.iter().map(|t| width(&t.label, TICK.size)).fold(0.0, f64::max)
    }

    /// The share of the height, from below, where a value in the units of the axis is.
    fn share(&self, value: f64) -> f64 {
        ((value - self.lower) / (self.upper - self.lower)).clamp(0.0, 1.0)
    }
}

/// The points of a curve that a chart shows.
fn shown(curve: &Curve, until: f64) -> impl Iterator<Item = (f64, f64)> {
    let points = curve.points.iter().copied();
    points.filter(move |(time, value)| *time <= until && value.is_finite())
}

fn draw(svg: &mut Svg, chart: &Chart, scale: &Scale, origin: (f64, f64), marks: &[(String, f64)]) {
    let (left, top) = origin;
    let base = top + HEIGHT;
    let until = if chart.until > 0.0 { chart.until } else { 1.0 };
    let x = |time: f64| left + time / until * WIDTH;
    let y = |share: f64| base - share * HEIGHT;
    let line = |y: f64| format!("M{} {}h{}", px(left), px(y), px(WIDTH));
    let grid: String = scale.ticks.iter().map(|tick| line(y(scale.share(tick.at)))).collect();
    svg.path(&format!("stroke=\"{}\"", style::GRID), &grid);
    for tick in &scale.ticks {
        let at = y(scale.share(tick.at)) + 4.0;
        svg.text(left - 5.0, at, TICK.at(Anchor::End), &tick.label);
    }
    let spacing = Spacing { length: WIDTH, most: 7, side_by_side: Some(TICK.size), whole: false };
    let units = Units::for_range(0.0, until);
    let times = ticks(0.0, units.of(until), spacing);
    let at = |tick: f64| left + tick / units.of(until) * WIDTH;
    let strokes: String =
        times.iter().map(|t| format!("M{} {}v4", px(at(t.at)), px(base))).collect();
    svg.path(&format!("stroke=\"{}\"", style::AXIS), &(line(base) + &strokes));
    for tick in &times {
        svg.text(at(tick.at), base + 16.0, TICK.at(Anchor::Middle), &tick.label);
    }
    let note = units.note();
    let seconds = format!("time (s)  {note}");
    svg.text(left + WIDTH, base + 29.0, NOTE.at(Anchor::End), seconds.trim_end());
    releases(svg, origin, until, marks);

    for curve in &chart.curves {
        let place = |(time, value)| (x(time), y(scale.share(scale.units.of(value))));
        let points = thinned(shown(curve, chart.until).map(place));
        let pen = |k: usize| if k == 0 { 'M' } else { 'L' };
        let pieces = points.iter().enumerate();
        let d: String = pieces.map(|(k, p)| format!("{}{} {}", pen(k), px(p.0), px(p.1))).collect();
        svg.path(&format!("stroke=\"{}\" stroke-width=\"1.5\"", curve.hue.colour().pen), &d);
    }

    let note = scale.units.note();
    let label =
        if note.is_empty() { chart.label.clone() } else { format!("{}  {note}", chart.label) };
    let label = fit(&label, LABEL.size, WIDTH);
    svg.text(left, top - 20.0, LABEL, &label);
    let mut across = left + width(&label, LABEL.size) + 10.0;
    for (i, curve) in chart.curves.iter().enumerate().take(NAMES) {
        let more = i + 1 == NAMES && chart.curves.len() > NAMES;
        let name = if more { "…" } else { curve.name.as_str() };
        let wide = width(name, LABEL.size);
        if name.is_empty() || across + wide > left + WIDTH {
            continue;
        }
        let look = Look::new(LABEL.size, curve.hue.colour().words).bold();
        svg.text(across, top - 20.0, look, name);
        across += wide + 10.0;
    }
}

/// Of the points of a curve on the page, in the order of time, those that show: no more than two in each step across, the
/// lowest and the highest, so that what swings faster than that is seen as wide as it swings.
fn thinned(points: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    const ACROSS: f64 = 0.75;
    const SEEN: f64 = 0.4;
    let mut kept: Vec<(f64, f64)> = Vec::new();
    // The lowest and the highest of a step, and its last.
    let mut step: Option<[(f64, f64); 3]> = None;
    let mut end = f64::NEG_INFINITY;
    let mut close = |step: Option<[(f64, f64); 3]>| {
        let Some([low, high, last]) = step else { return };
        if high.1 - low.1 > SEEN {
            kept.extend(if low.0 <= high.0 { [low, high] } else { [high, low] });
        } else {
            kept.push(last);
        }
    };
    for point in points {
        match &mut step {
            Some([low, high, last]) if point.0 < end => {
                *last = point;
                if point.1 < low.1 {
                    *low = point;
                }
                if point.1 > high.1 {
                    *high = point;
                }
            }
            _ => {
                close(step.replace([point; 3]));
                end = point.0 + ACROSS;
            }
        }
    }
    let last = step.map(|[_, _, last]| last);
    close(step);
    if let Some(last) = last.filter(|last| kept.last() != Some(last)) {
        kept.push(last);
    }
    kept
}

/// Dashed lines where loads let go, and which: together where they have no room apart.
fn releases(svg: &mut Svg, (left, top): (f64, f64), until: f64, marks: &[(String, f64)]) {
    const ROOM: f64 = 12.0;
    let mut groups: Vec<([f64; 2], Vec<&str>)> = Vec::new();
    let mut d = String::new();
    for (load, time) in marks.iter().filter(|(_, time)| *time <= until) {
        let across = left + time / until * WIDTH;
        match groups.last_mut() {
            Some(([_, last], loads)) if across - *last < ROOM => {
                loads.push(load);
                if across - *last < 1.0 {
                    continue;
                }
                *last = across;
            }
            _ => groups.push(([across; 2], vec![load])),
        }
        d += &format!("M{} {}v{}", px(across), px(top), px(HEIGHT));
    }
    let pen = format!("stroke=\"{}\" stroke-width=\"0.8\" stroke-dasharray=\"3 3\"", style::AXIS);
    svg.path(&pen, &d);
    let mut free = f64::NEG_INFINITY;
    for ([first, last], loads) in groups {
        let name = fit(&loads.join(", "), NOTE.size, 60.0);
        let (at, half) = (0.5 * (first + last), 0.5 * width(&name, NOTE.size));
        if at - half > free {
            svg.text(at, top - 4.0, NOTE.at(Anchor::Middle), &name);
            free = at + half + 3.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::svg::tests::read;

    fn chart(values: impl Fn(f64) -> f64) -> Chart {
        let points = (0..2000).map(|i| f64::from(i) * 0.01).map(|t| (t, values(t))).collect();
        Chart {
            label: "rate (deg/s)".to_owned(),
            curves: vec![Curve { name: "ω₁".to_owned(), hue: Hue::Axis(0), points }],
            until: 15.0,
        }
    }

    fn mark(load: usize, time: f64) -> (String, f64) {
        (load.to_string(), time)
    }

    #[test]
    fn charts_are_well_formed_and_small() {
        let charts = [chart(f64::sin), chart(|t| 1e-300 * t), chart(|_| 7.0), chart(|_| f64::NAN)];
        let svg = time_charts(
            "a <title>",
            &charts,
            &[mark(1, 0.3), mark(2, 0.301), mark(3, 14.0), mark(4, 17.0)],
        );
        let seen = read(&svg);
        for text in ["a <title>", "rate (deg/s)", "ω1", "1, 2", "3", "time (s)"] {
            assert!(seen.contains(text), "{text} is missing: {seen}");
        }
        assert!(!seen.contains("\n4\n"), "beyond the axis: {seen}");
        assert!(svg.len() < 60_000, "{} bytes", svg.len());
    }

    /// However fast a curve swings, it is drawn as wide as it swings, everywhere and with few points; and it ends where it ends.
    #[test]
    fn what_swings_fast_is_as_wide_as_it_swings() {
        for points in [50_u32, 400, 3000, 40_000] {
            for turns in [1.0, 7.0, 151.0, 2000.0_f64] {
                let per_turn = f64::from(points) / turns;
                if per_turn < 9.0 {
                    continue;
                }
                let at = |k: u32| {
                    let share = f64::from(k) / f64::from(points);
                    (372.0 * share, 50.0 + 40.0 * (turns * share * std::f64::consts::TAU).sin())
                };
                let kept = thinned((0..=points).map(at));
                assert!(kept.len() <= 1000 && kept.is_sorted_by(|a, b| a.0 <= b.0));
                assert_eq!(kept.last(), Some(&at(points)));
                // In each piece of the page as long as a turn, or as two steps across.
                let piece = f64::max(1.1 * 372.0 / turns, 1.5);
                let mut from = 0.0;
                while from + piece <= 372.0 {
                    let here =
                        kept.iter().filter(|p| (from..from + piece).contains(&p.0)).map(|p| p.1);
                    let (low, high) = here
                        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), y| (l.min(y), h.max(y)));
                    assert!(
                        high - low > 70.0,
                        "{points} points, {turns} turns: {low} to {high} at {from}"
                    );
                    from += piece;
                }
            }
        }
    }

    #[test]
    fn any_numbers_give_a_figure() {
        for extreme in [f64::MAX, f64::MIN, f64::INFINITY, 5e-324, 0.0, -0.0] {
            read(&time_charts("", &[chart(|t| extreme * (t - 1.0)), chart(|_| extreme)], &[]));
        }
        read(&time_charts("", &[], &[mark(1, 0.0)]));
        let empty = Chart { curves: Vec::new(), until: 0.0, ..chart(|t| t) };
        read(&time_charts("", &[empty], &[mark(1, 0.0)]));
    }
}
