//! A figure: what it shows as data, what it says, and where it is written.

use serde::{Deserialize, Serialize};

use crate::data::{self, Sheet};
use crate::inline::with_signs;
use crate::{AttitudeSpheres, HistogramGrid, LineGrid, RangeGrid};

/// A figure with what it shows. Kept as data it can be drawn again, to the byte, from results that were
/// read back.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figure {
    /// Name of its file, without the ending.
    pub name: String,
    /// What stands below it.
    pub caption: String,
    /// What it shows.
    #[serde(flatten)]
    pub picture: Picture,
}

/// What a figure shows, as data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Picture {
    /// Histograms of quantities.
    Histograms(HistogramGrid),
    /// Attitudes on the unit sphere.
    Attitudes(AttitudeSpheres),
    /// Ranges of quantities.
    Ranges(RangeGrid),
    /// Lines over levels.
    Lines(LineGrid),
}

impl Figure {
    /// The figure drawn: SVG that can stand alone or in a page. The same data give the same bytes.
    #[must_use]
    pub fn svg(&self) -> String {
        match &self.picture {
            Picture::Histograms(histograms) => histograms.svg(),
            Picture::Attitudes(spheres) => spheres.svg(),
            Picture::Ranges(ranges) => ranges.svg(),
            Picture::Lines(lines) => lines.svg(),
        }
    }

    /// The figure drawn for a page.
    #[must_use]
    pub fn drawn(&self) -> Drawing {
        let (name, caption) = (self.name.clone(), self.caption.clone());
        Drawing { name, caption, svg: self.svg(), numbers: data::json(&self.sheets()) }
    }

    /// Its numbers, where they are few enough for a page.
    fn sheets(&self) -> Vec<Sheet> {
        match &self.picture {
            Picture::Histograms(histograms) => histograms.sheets(),
            Picture::Attitudes(_) => Vec::new(),
            Picture::Ranges(ranges) => ranges.sheets(),
            Picture::Lines(lines) => lines.sheets(),
        }
    }
}

/// Where a figure of a name is written, from the folder of the results.
#[must_use]
pub fn file_of(name: &str) -> String {
    format!("figures/{name}.svg")
}

/// A figure drawn: SVG that can stand alone or in a page, and what stands below it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Drawing {
    pub(crate) name: String,
    pub(crate) caption: String,
    pub(crate) svg: String,
    /// Its numbers as JSON, in which nothing ends a script.
    pub(crate) numbers: Option<String>,
}

impl Drawing {
    /// A figure of a name, with what stands below it.
    pub(crate) fn new(name: &str, caption: &str, svg: String) -> Self {
        Self { name: name.to_owned(), caption: with_signs(caption), svg, numbers: None }
    }

    /// With its numbers as JSON, in which nothing ends a script.
    pub(crate) fn with_numbers(self, numbers: Option<String>) -> Self {
        Self { numbers, ..self }
    }

    pub(crate) fn file(&self) -> String {
        file_of(&self.name)
    }

    /// Its file as a page beside the folder of figures names it.
    pub(crate) fn address(&self) -> String {
        address(&self.file())
    }
}

/// The path of a file as an address.
fn address(path: &str) -> String {
    let byte = |b: u8| match b {
        b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'/' => {
            char::from(b).to_string()
        }
        _ => format!("%{b:02X}"),
    };
    path.bytes().map(byte).collect()
}
