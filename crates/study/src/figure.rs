//! A figure beside what it shows, and where it is written.

/// A figure with what it shows.
#[derive(Clone, Debug)]
pub(crate) struct Figure {
    /// Name of its file, without the ending.
    pub(crate) name: String,
    pub(crate) caption: String,
    pub(crate) svg: String,
}

/// Where a figure is written, from the folder.
pub(crate) fn file_of(name: &str) -> String {
    format!("figures/{name}.svg")
}

/// Of all models of inertia, which the summary makes.
pub(crate) const EVERY_MODEL: &str = "figure-models";
