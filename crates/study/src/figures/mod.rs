//! Figures as SVG, made to stand in a paper or inline in a page.
//!
//! Pure functions from data to text: the same input gives the same bytes, and any data gives a
//! figure. The files name no font to be loaded and hold no `id`, style sheet or script, so that
//! several can be inlined in one page. Their natural size is in `width` and `height`; they shrink
//! with a narrower page.
//!
//! The SVG is written by hand: `plotters` rounds every coordinate to a whole pixel, writes one
//! element per dot, and has neither title nor description for readers who cannot see the figure.

mod axis;
mod bins;
mod curves;
mod histogram;
mod legend;
mod lines;
mod panel;
mod ranges;
mod samples;
mod sphere;
mod style;
mod svg;
mod text;

pub(crate) use curves::{Chart, Colours, Curve, time_charts};
pub(crate) use histogram::histogram_grid;
pub(crate) use lines::{Line, LinePanel, LinePoint, Range, line_grid};
pub(crate) use ranges::{Label, RangePanel, range_grid};
pub(crate) use samples::{Panel, Series};
pub(crate) use sphere::{Cloud, attitude_spheres};
