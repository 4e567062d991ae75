//! Samples that are shown together.

/// One sample of one quantity under one model.
#[derive(Debug, Clone, Copy)]
pub struct Series<'a> {
    /// Name of the model, as in the legend; a name has the same colour in all panels.
    pub name: &'a str,
    /// The values of the runs that have one, in the unit that the label of the panel names; values
    /// that are not finite cannot be drawn, and are counted in a note.
    pub values: &'a [f64],
    /// How many runs there are; those without a value are counted in a note.
    pub runs: usize,
}

/// Histograms of the same quantity under several models, on the same axes and bins.
#[derive(Debug, Clone)]
pub struct Panel<'a> {
    /// What is on the horizontal axis, with its unit: `wobble (deg)`, `I₁₂ (kg·m²)`.
    pub label: String,
    /// The samples, one per model.
    pub series: Vec<Series<'a>>,
    /// A value to mark, in the unit of the label.
    pub nominal: Option<f64>,
}
