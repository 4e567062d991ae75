//! Colours and sizes common to all figures.

/// Metric-compatible faces first: widths are estimated for Helvetica.
pub(crate) const FONTS: &str = "'Helvetica Neue',Helvetica,Arial,'Liberation Sans',sans-serif";

pub(crate) const INK: &str = "#222222";
pub(crate) const MUTED: &str = "#666666";
pub(crate) const AXIS: &str = "#8c8c8c";
pub(crate) const GRID: &str = "#e8e8e8";
pub(crate) const NOMINAL: &str = "#333333";

/// Models, in order of appearance: the colours of Okabe and Ito that read as lines on white.
const MODELS: [&str; 6] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#a6761d"];

/// Principal axes 1, 2, 3: from Tol's muted scheme, apart from the colours of the models.
pub(crate) const AXES: [&str; 3] = ["#332288", "#2a9d8f", "#cc6677"];

/// Space around the figure.
pub(crate) const MARGIN: f64 = 12.0;

pub(crate) fn model(index: usize) -> &'static str {
    MODELS[index % MODELS.len()]
}
