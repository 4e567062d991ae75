//! What the runs of a model say of a requirement, as a line of a figure.

use gyradius_campaign::Judgement;

/// What the runs of a model say of a requirement, as a line of a figure.
#[derive(Clone, Copy, Debug)]
pub struct JudgedModel<'a> {
    /// The name of the model, as in the legend.
    pub name: &'a str,
    /// Place among the colours of models: its place among all, so that it has one colour in all figures.
    pub colour: usize,
    /// What its runs say.
    pub judgement: &'a Judgement,
}
