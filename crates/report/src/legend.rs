//! A legend: swatches and names in rows.

use crate::style;
use crate::svg::{Anchor, Look, Svg};
use crate::text::{fit, width};

const LOOK: Look = Look::new(12.0, style::INK).at(Anchor::Start);
const ROW: f64 = 20.0;
const GAP: f64 = 22.0;

/// One entry: what it is called, and how it is drawn, from the origin so wide to the right.
pub(crate) struct Entry {
    pub(crate) name: String,
    pub(crate) width: f64,
    pub(crate) swatch: Svg,
}

/// Draws the entries from `top` down, in as many rows as it takes; returns where they end.
pub(crate) fn legend(svg: &mut Svg, entries: Vec<Entry>, top: f64, figure_width: f64) -> f64 {
    let right = figure_width - style::MARGIN;
    let (mut x, mut middle) = (style::MARGIN, top + ROW / 2.0);
    let empty = entries.is_empty();
    for entry in entries {
        let before = entry.width + 7.0;
        let name = fit(&entry.name, LOOK.size, right - style::MARGIN - before);
        let wide = before + width(&name, LOOK.size);
        if x > style::MARGIN && x + wide > right {
            (x, middle) = (style::MARGIN, middle + ROW);
        }
        svg.place(x, middle, &entry.swatch);
        svg.text(x + before, middle + 4.2, LOOK, &name);
        x += wide + GAP;
    }
    if empty { top } else { middle + ROW / 2.0 }
}
