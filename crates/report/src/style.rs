//! Colours and sizes common to all figures.

/// Metric-compatible faces first: widths are estimated for Helvetica.
pub(crate) const FONTS: &str = "'Helvetica Neue',Helvetica,Arial,'Liberation Sans',sans-serif";

pub(crate) const INK: &str = "#222222";
pub(crate) const MUTED: &str = "#666666";
pub(crate) const AXIS: &str = "#8c8c8c";
pub(crate) const GRID: &str = "#e8e8e8";
pub(crate) const NOMINAL: &str = "#333333";

/// A colour of lines and areas, at least 3 to 1 on white, and the same darker for words, at least 4.5 to 1.
#[derive(Clone, Copy)]
pub(crate) struct Colour {
    pub(crate) pen: &'static str,
    pub(crate) words: &'static str,
}

const fn colour(pen: &'static str, words: &'static str) -> Colour {
    Colour { pen, words }
}

/// Models, in order of appearance: the colours of Okabe and Ito, the light ones a little darker, so that they read as
/// lines on white.
const MODELS: [Colour; 6] = [
    colour("#0072b2", "#0072b2"),
    colour("#d55e00", "#b34f00"),
    colour("#009e73", "#007a58"),
    colour("#cc79a7", "#a8487f"),
    colour("#3b97cf", "#1b76ab"),
    colour("#a6761d", "#85600f"),
];

/// Principal axes 1, 2, 3: from Tol's muted scheme, apart from the colours of the models.
pub(crate) const AXES: [Colour; 3] =
    [colour("#332288", "#332288"), colour("#2a9d8f", "#1d7a70"), colour("#cc6677", "#b04456")];

/// Space around the figure.
pub(crate) const MARGIN: f64 = 12.0;

/// The pen of a model.
pub(crate) fn model(index: usize) -> &'static str {
    model_colour(index).pen
}

pub(crate) fn model_colour(index: usize) -> Colour {
    MODELS[index % MODELS.len()]
}

/// What tells the lines of models apart that have the same colour: none but the first of each is solid.
const DASHES: [&str; 5] = ["", "7 2", "2 2", "9 2 2 2", "4 3 1 3"];

/// The dashes of the line of a model, as an attribute that follows others.
pub(crate) fn dashes(model: usize) -> String {
    match DASHES[model / MODELS.len() % DASHES.len()] {
        "" => String::new(),
        dashes => format!(" stroke-dasharray=\"{dashes}\""),
    }
}

/// Whether a colour alone says which of so many models is meant.
pub(crate) fn is_told_by_colour(models: usize) -> bool {
    models <= MODELS.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    type Rgb = [f64; 3];

    fn rgb(hex: &str) -> Rgb {
        [1, 3, 5].map(|i| f64::from(u8::from_str_radix(&hex[i..i + 2], 16).unwrap()) / 255.0)
    }

    fn luminance(colour: Rgb) -> f64 {
        let linear =
            colour.map(|x| if x <= 0.03928 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) });
        0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
    }

    /// The contrast of WCAG 2.
    fn contrast(a: Rgb, b: Rgb) -> f64 {
        let (a, b) = (luminance(a) + 0.05, luminance(b) + 0.05);
        a.max(b) / a.min(b)
    }

    /// What the filter of the page makes of a colour in the dark: `invert(.92) hue-rotate(180deg)`.
    fn dark(colour: Rgb) -> Rgb {
        let c = colour.map(|x| 0.92 - 0.84 * x);
        let rows = [[-0.574, 1.43, 0.144], [0.426, 0.43, 0.144], [0.426, 1.43, -0.856]];
        rows.map(|row| (0..3).map(|i| row[i] * c[i]).sum::<f64>().clamp(0.0, 1.0))
    }

    /// No two of thirty models have the same line, the same bars or the same marker of the same colour; and what has no inside
    /// is drawn as a line, in legends too.
    #[test]
    fn thirty_models_are_told_apart() {
        use crate::{
            field::line_pen,
            lines::{mark_pen, marker},
            panel::outline_pen,
        };
        use std::collections::BTreeSet;
        let different =
            |of: &dyn Fn(usize) -> String| (0..30).map(of).collect::<BTreeSet<_>>().len();
        assert_eq!(different(&line_pen), 30);
        assert_eq!(different(&outline_pen), 30);
        assert_eq!(different(&|model| marker(model, 0.0, 0.0) + model_colour(model).pen), 30);
        for model in 0..30 {
            let pen = mark_pen(model);
            assert!(marker(model, 0.0, 0.0).ends_with('z') || pen.contains("stroke="), "{pen}");
        }
    }

    #[test]
    fn colours_are_told_from_the_page_by_day_and_by_night() {
        assert!(include_str!("page.css").contains("invert(.92) hue-rotate(180deg)"));
        let white = rgb("#ffffff");
        let told = |colour: &str, least: f64| {
            for (colour, page) in [(rgb(colour), white), (dark(rgb(colour)), dark(white))] {
                let found = contrast(colour, page);
                assert!(found >= least, "{colour:?} on {page:?}: {found}");
            }
        };
        for colour in MODELS.iter().chain(&AXES) {
            told(colour.pen, 3.0);
            told(colour.words, 4.5);
        }
        for words in [INK, MUTED, NOMINAL] {
            told(words, 4.5);
        }
        told(AXIS, 3.0);
    }
}
