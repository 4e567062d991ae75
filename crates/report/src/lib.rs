//! Pages and figures, made from results alone: no physics, no random numbers.
//!
//! A [`Figure`] is data (bins and counts, attitudes, ranges, lines) that is written beside the other
//! results, reads back, and is drawn as SVG from what was read: the same data give the same bytes. The files
//! name no font to be loaded and hold no `id`, style sheet or script, so that several can be inlined in one
//! page. Their natural size is in `width` and `height`; they shrink with a narrower page.
//!
//! A [`Document`] is a page as data: sections of words, tables and figures, written as HTML that needs nothing but
//! itself and as Markdown. Characters are escaped in one place for each form.
//!
//! The SVG is written by hand: `plotters` rounds every coordinate to a whole pixel, writes one
//! element per dot, and has neither title nor description for readers who cannot see the figure.
//!
//! ```
//! use gyradius_report::{HistogramGrid, Panel, Series};
//!
//! let wobble = [0.4, 0.6, 0.3, 0.5, 0.9, 0.7];
//! let panel = Panel {
//!     label: "wobble (deg)".to_owned(),
//!     series: vec![Series::new("measured", &wobble, 6)],
//!     nominal: Some(0.5),
//! };
//! let histograms = HistogramGrid::new("Wobble after separation", &[Some(panel)], 1);
//! let written = serde_json::to_string(&histograms)?;
//! let read: HistogramGrid = serde_json::from_str(&written)?;
//! assert_eq!(read.svg(), histograms.svg());
//! # Ok::<(), serde_json::Error>(())
//! ```

mod axis;
mod bins;
mod convergence;
mod curves;
mod data;
mod distribution;
mod document;
mod drivers;
mod field;
mod figure;
mod histogram;
mod html;
mod inline;
mod judged_model;
mod kinds;
mod legend;
mod lines;
mod markdown;
mod naming;
mod numbers;
mod overview;
mod page;
mod panel;
mod paper;
mod ranges;
#[cfg(test)]
mod read_back;
mod samples;
mod share;
mod sketch;
mod sphere;
mod style;
mod svg;
mod table;
mod text;
mod visible;

pub use convergence::convergence_figure;
pub use curves::{Chart, Curve, Hue, time_charts};
pub use distribution::distribution_figure;
pub use document::{Document, Section};
pub use drivers::{DrivenOutput, DrivingGroup, drivers_figure};
pub use figure::{Drawing, Figure, Picture, file_of};
pub use histogram::HistogramGrid;
pub use inline::{Text, Tone};
pub use judged_model::JudgedModel;
pub use kinds::most_frequent;
pub use lines::{Line, LineGrid, LinePanel, LinePoint, Range};
pub use naming::first_names;
pub use numbers::{
    below_hundred, direction, estimate, interval, optional, resolved, round_below, significant,
    with_unit,
};
pub use overview::{Overview, spread};
pub use page::page;
pub use ranges::{Label, RangeGrid, RangePanel};
pub use samples::{Panel, Series};
pub use share::{of_some, percent};
pub use sketch::{SketchBody, SketchShape, SketchView, sketch_figure};
pub use sphere::{AttitudeSpheres, Cloud};
pub use table::{PageCell, PageTable, TableOf};
pub use visible::{visible, visible_json};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
