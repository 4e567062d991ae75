//! A figure of one panel that can be read on a telephone: 480 wide, and no text below 12, so that it is 9 in 360 pixels.

use crate::axis::{Spacing, Tick, Units, ticks};
use crate::inline::with_signs;
use crate::legend::{Entry, legend};
use crate::style::{self, MARGIN};
use crate::svg::{Anchor, Look, Svg, px};
use crate::text::{fit, width, wrap};

/// Width of the figure, and what it is shown in at most.
pub(crate) const WIDTH: f64 = 480.0;
const WIDEST: f64 = 640.0;
/// The plot.
pub(crate) const ACROSS: f64 = WIDTH - 2.0 * MARGIN - LABELS - 8.0;
pub(crate) const HIGH: f64 = 270.0;
/// Room of the labels of the vertical axis.
const LABELS: f64 = 58.0;

pub(crate) const TICK: Look = Look::new(12.0, style::MUTED);
pub(crate) const LABEL: Look = Look::new(12.5, style::INK);

/// A figure under construction: title, legend, and a plot whose origin is its upper left corner.
pub(crate) struct Field {
    pub(crate) plot: Svg,
    entries: Vec<Entry>,
    notes: Vec<String>,
    /// From where to where the names of limits stand above the plot.
    limits: Vec<[f64; 2]>,
}

/// A horizontal axis, linear in the units that it is labelled in.
pub(crate) struct Across {
    units: Units,
    lower: f64,
    upper: f64,
}

impl Across {
    /// Of values between `lower ≤ upper`, with some room at both ends.
    pub(crate) fn new(lower: f64, upper: f64) -> Self {
        let units = Units::for_range(lower, upper);
        let (low, high) = (units.of(lower), units.of(upper));
        let room = 0.04 * (high - low);
        let room = if room > 0.0 { room } else { 0.05 * high.abs().max(1e-3) };
        Self { units, lower: low - room, upper: high + room }
    }

    /// From one end to the other, in the unit of the values.
    pub(crate) fn span(&self) -> f64 {
        self.units.length(self.upper - self.lower)
    }

    /// Where a value is.
    pub(crate) fn x(&self, value: f64) -> f64 {
        self.at(self.units.of(value))
    }

    fn at(&self, in_units: f64) -> f64 {
        ((in_units - self.lower) / (self.upper - self.lower)).clamp(-1.0, 2.0) * ACROSS
    }

    fn ticks(&self) -> Vec<Tick> {
        let spacing =
            Spacing { length: ACROSS, most: 6, side_by_side: Some(TICK.size), whole: false };
        let ticks = ticks(self.lower, self.upper, spacing).into_iter();
        ticks.map(|tick| Tick { at: self.at(tick.at), ..tick }).collect()
    }
}

impl Field {
    /// A plot with ticks, whose places are from the lower left corner of the plot, and what is on the axes.
    pub(crate) fn new(across: &[Tick], up: &[Tick], [x_label, y_label]: [&str; 2]) -> Self {
        let mut plot = Svg::new();
        let line = |y: f64| format!("M0 {}h{}", px(y), px(ACROSS));
        let grid: String = up.iter().map(|tick| line(HIGH - tick.at)).collect();
        plot.path(&format!("stroke=\"{}\"", style::GRID), &grid);
        for tick in up {
            plot.text(-6.0, HIGH - tick.at + 4.0, TICK.at(Anchor::End), &tick.label);
        }
        let marks: String =
            across.iter().map(|tick| format!("M{} {}v4", px(tick.at), px(HIGH))).collect();
        plot.path(&format!("stroke=\"{}\"", style::AXIS), &(line(HIGH) + &marks));
        for tick in across {
            plot.text(tick.at, HIGH + 17.0, TICK.at(Anchor::Middle), &tick.label);
        }
        let middle = 0.5 * (ACROSS - LABELS);
        let name = fit(x_label, LABEL.size, ACROSS + LABELS);
        plot.text(middle, HIGH + 37.0, LABEL.at(Anchor::Middle), &name);
        plot.text(-LABELS, -24.0, TICK, &fit(y_label, TICK.size, ACROSS + LABELS));
        Self { plot, entries: Vec::new(), notes: Vec::new(), limits: Vec::new() }
    }

    /// The same with a linear horizontal axis, which says in which units it is labelled.
    pub(crate) fn linear(axis: &Across, up: &[Tick], [x_label, y_label]: [&str; 2]) -> Self {
        let label = format!("{x_label}  {}", axis.units.note());
        Self::new(&axis.ticks(), up, [label.trim_end(), y_label])
    }

    /// An entry of the legend: its name, and how it is drawn, from the origin 26 to the right.
    pub(crate) fn entry(&mut self, name: impl Into<String>, draw: impl FnOnce(&mut Svg)) {
        let mut swatch = Svg::new();
        draw(&mut swatch);
        self.entries.push(Entry { name: name.into(), width: 26.0, swatch });
    }

    /// What is said below the plot.
    pub(crate) fn note(&mut self, text: impl Into<String>) {
        self.notes.push(text.into());
    }

    /// The vertical line of a limit, with its name above the plot, where there is room beside other names, and else in the plot beside it.
    pub(crate) fn limit(&mut self, x: f64, name: &str) {
        let x = x.clamp(0.0, ACROSS);
        let pen = format!("stroke=\"{}\" stroke-width=\"1.6\"", style::INK);
        self.plot.path(&pen, &format!("M{} 0v{}", px(x), px(HIGH)));
        let half = 0.5 * width(name, TICK.size);
        let at = x.clamp(half - LABELS, ACROSS - half);
        let look = Look::new(TICK.size, style::INK);
        let (own, gap) = ([at - half, at + half], 6.0);
        if self.limits.iter().all(|other| own[1] + gap < other[0] || other[1] + gap < own[0]) {
            self.limits.push(own);
            self.plot.text(at, -6.0, look.at(Anchor::Middle), name);
        } else if x + 5.0 + 2.0 * half < ACROSS {
            self.plot.text(x + 5.0, TICK.size + 2.0, look.at(Anchor::Start), name);
        } else {
            self.plot.text(x - 5.0, TICK.size + 2.0, look.at(Anchor::End), name);
        }
    }

    /// The whole figure.
    pub(crate) fn finish(self, title: &str, description: &str) -> String {
        let mut svg = Svg::new();
        let y = svg.heading(&with_signs(title), WIDTH);
        let y = legend(&mut svg, self.entries, y + 4.0, WIDTH) + 42.0;
        svg.place(MARGIN + LABELS, y, &self.plot);
        let mut y = y + HIGH + 42.0;
        for note in &self.notes {
            // Other faces than Helvetica are a tenth wider.
            for line in wrap(note, TICK.size, (WIDTH - 2.0 * MARGIN) / 1.15, 3) {
                y += 17.0;
                svg.text(MARGIN, y - 3.0, TICK, &line);
            }
        }
        svg.finish_within(WIDEST, (WIDTH, y + 8.0), title, description)
    }
}

/// The pen of what is required.
pub(crate) fn required_pen() -> String {
    format!("stroke=\"{}\" stroke-width=\"1.3\" stroke-dasharray=\"5 4\"", style::MUTED)
}

/// The fill of a band about the line of a model.
pub(crate) fn band_pen(model: usize) -> String {
    format!("fill=\"{}\" fill-opacity=\"0.16\"", style::model(model))
}

/// The line of a model.
pub(crate) fn line_pen(model: usize) -> String {
    format!("stroke=\"{}\" stroke-width=\"1.6\"{}", style::model(model), style::dashes(model))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Where a text of a drawing is, from its baseline's left end: left, right and baseline.
    fn place(text: &str, name: &str) -> [f64; 3] {
        let attribute = |of: &str| {
            let value = text.split_once(&format!(" {of}=\""))?.1;
            value.split('"').next()
        };
        let number = |of: &str| attribute(of).unwrap().parse::<f64>().unwrap();
        let wide = width(name, TICK.size);
        let left = match attribute("text-anchor") {
            None => number("x"),
            Some("middle") => number("x") - 0.5 * wide,
            Some(_) => number("x") - wide,
        };
        [left, left + wide, number("y")]
    }

    proptest! {
        /// The names of two limits, as of a requirement between them, never stand over each other, and stay in the figure.
        #[test]
        fn names_of_limits_do_not_touch(
            places in prop::array::uniform2(0.0..1.0_f64),
            names in prop::array::uniform2("limit [0-9.]{1,12}"),
        ) {
            let mut field = Field::new(&[], &[], ["x", "y"]);
            for (at, name) in places.iter().zip(&names) {
                field.limit(at * ACROSS, name);
            }
            let svg = field.finish("", "");
            let texts: Vec<&str> = svg.split("<text").filter(|text| text.contains(">limit ")).collect();
            prop_assert_eq!(texts.len(), 2);
            let [a, b] = [place(texts[0], &names[0]), place(texts[1], &names[1])];
            let apart = a[1] < b[0] || b[1] < a[0] || (a[2] - b[2]).abs() >= TICK.size;
            prop_assert!(apart, "{:?} {:?}", a, b);
            for [left, right, _] in [a, b] {
                prop_assert!(left >= -LABELS - 1.0 && right <= ACROSS + 1.0, "{left} {right}");
            }
        }
    }
}
