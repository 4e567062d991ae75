//! A small writer of SVG.

use crate::style;
use crate::text::{escape, rich, wrap};

/// Where the text stands with respect to its position.
#[derive(Clone, Copy)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// How text is set.
#[derive(Clone, Copy)]
pub(crate) struct Look {
    pub(crate) size: f64,
    pub(crate) colour: &'static str,
    pub(crate) anchor: Anchor,
    pub(crate) bold: bool,
}

impl Look {
    pub(crate) const fn new(size: f64, colour: &'static str) -> Self {
        Self { size, colour, anchor: Anchor::Start, bold: false }
    }

    pub(crate) const fn at(self, anchor: Anchor) -> Self {
        Self { anchor, ..self }
    }

    pub(crate) const fn bold(self) -> Self {
        Self { bold: true, ..self }
    }
}

/// A figure under construction; lengths are CSS pixels at natural size.
pub(crate) struct Svg(String);

impl Svg {
    pub(crate) fn new() -> Self {
        Self(String::new())
    }

    /// A path with the attributes given.
    pub(crate) fn path(&mut self, attributes: &str, d: &str) {
        if !d.is_empty() {
            self.0.push_str(&format!("<path {attributes} d=\"{d}\"/>\n"));
        }
    }

    /// Everything that `draw` adds, in a group with the attributes given.
    pub(crate) fn group(&mut self, attributes: &str, draw: impl FnOnce(&mut Self)) {
        self.0.push_str(&format!("<g {attributes}>\n"));
        draw(self);
        self.0.push_str("</g>\n");
    }

    /// A drawing with its origin moved.
    pub(crate) fn place(&mut self, x: f64, y: f64, drawing: &Self) {
        let attributes = format!("transform=\"translate({} {})\"", px(x), px(y));
        self.group(&attributes, |svg| svg.0.push_str(&drawing.0));
    }

    /// One line of text.
    pub(crate) fn text(&mut self, x: f64, y: f64, look: Look, text: &str) {
        self.runs(x, y, look, &[(look.colour, text)]);
    }

    /// One line of text in several colours.
    pub(crate) fn runs(&mut self, x: f64, y: f64, look: Look, runs: &[(&str, &str)]) {
        let anchor = match look.anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
        };
        let weight = if look.bold { " font-weight=\"600\"" } else { "" };
        let runs: Vec<_> =
            runs.iter().map(|&(c, text)| ((c != look.colour).then_some(c), text)).collect();
        self.0.push_str(&format!(
            "<text x=\"{}\" y=\"{}\" font-size=\"{}\" fill=\"{}\"{anchor}{weight}>{}</text>\n",
            px(x),
            px(y),
            look.size,
            look.colour,
            rich(&runs)
        ));
    }

    /// The title at the top, if any, on at most two lines; returns where it ends.
    pub(crate) fn heading(&mut self, title: &str, figure_width: f64) -> f64 {
        const LOOK: Look = Look::new(15.0, style::INK).bold();
        // Bold letters are wider, and those of other faces than Helvetica by a tenth more.
        let room = (figure_width - 2.0 * style::MARGIN) / 1.2;
        let mut y = style::MARGIN;
        for line in wrap(title, LOOK.size, room, 2) {
            y += 18.0;
            self.text(style::MARGIN, y - 4.0, LOOK, &line);
        }
        y
    }

    /// The whole document. Without a title it is called by its description.
    pub(crate) fn finish(self, size: (f64, f64), title: &str, description: &str) -> String {
        // Letters do not grow larger than those of the page.
        let style = format!("max-width:min(100%,{}px);height:auto", px((1.25 * size.0).ceil()));
        self.whole(&style, size, title, description)
    }

    /// The same, which is as wide as the page, but no wider than so many pixels.
    pub(crate) fn finish_within(
        self,
        widest: f64,
        size: (f64, f64),
        title: &str,
        description: &str,
    ) -> String {
        // Letters of 12 are 9 at least.
        let (least, widest) = (px(0.75 * size.0), px(widest));
        let style = format!("width:100%;min-width:{least}px;max-width:{widest}px;height:auto");
        self.whole(&style, size, title, description)
    }

    fn whole(self, style: &str, size: (f64, f64), title: &str, description: &str) -> String {
        let (w, h) = (px(size.0.ceil()), px(size.1.ceil()));
        let title = if title.trim().is_empty() { description } else { title };
        format!(
            // Without `xml:space` some renderers drop a space after a subscript.
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" \
             viewBox=\"0 0 {w} {h}\" style=\"{style};--natural:{w}px\" role=\"img\" \
             xml:space=\"preserve\" \
             font-family=\"{}\" font-weight=\"400\" fill=\"none\" stroke-linejoin=\"round\">\n\
             <title>{}</title>\n<desc>{}</desc>\n\
             <rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n{}</svg>\n",
            style::FONTS,
            escape(title),
            escape(description),
            self.0
        )
    }
}

/// A coordinate to a tenth of a pixel.
pub(crate) fn px(x: f64) -> String {
    let tenths = if x.is_finite() { (x * 10.0).round() } else { 0.0 };
    // Adding 0 makes a zero of −0.
    format!("{}", tenths / 10.0 + 0.0)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// The text that a reader sees, provided that the figure is well-formed, its coordinates are
    /// numbers, and what is in a page with it is left alone.
    pub(crate) fn read(svg: &str) -> String {
        let (mut open, mut seen) = (Vec::new(), String::new());
        let mut rest = svg.strip_suffix('\n').unwrap();
        while !rest.is_empty() {
            let (tag, after) = rest.strip_prefix('<').unwrap().split_once('>').unwrap();
            let (text, _) = after.split_once('<').unwrap_or((after, ""));
            rest = &after[text.len()..];
            if let Some(name) = tag.strip_prefix('/') {
                assert_eq!(open.pop(), Some(name));
                if name == "text" {
                    seen.push('\n');
                }
            } else {
                let (name, pairs) = tag.split_once(' ').unwrap_or((tag, ""));
                attributes(pairs.trim_end_matches('/'));
                if !tag.ends_with('/') {
                    open.push(name);
                }
            }
            assert!(!text.contains(|c: char| c.is_control() && c != '\n'));
            if open.contains(&"text") {
                seen.push_str(&unescape(text));
            }
            assert!(!open.is_empty() || rest.is_empty(), "one root");
        }
        assert!(open.is_empty());
        seen
    }

    fn attributes(mut pairs: &str) {
        while let Some((name, rest)) = pairs.trim_start().split_once("=\"") {
            let (value, rest) = rest.split_once('"').unwrap();
            assert!(name.bytes().all(|b| b.is_ascii_lowercase() || b"-:B".contains(&b)));
            assert!(name != "id" && !value.contains(['<', '&']));
            if ["d", "x", "y"].contains(&name) {
                assert!(!value.contains(['N', 'i', 'e']), "{value}");
            }
            pairs = rest;
        }
        assert_eq!(pairs.trim(), "");
    }

    pub(crate) fn unescape(text: &str) -> String {
        let known = [("&lt;", "<"), ("&gt;", ">"), ("&quot;", "\"")];
        let plain = known.iter().fold(text.to_owned(), |text, (from, to)| text.replace(from, to));
        assert_eq!(plain.matches('&').count(), plain.matches("&amp;").count());
        plain.replace("&amp;", "&")
    }

    #[test]
    fn coordinates_are_short_and_finite() {
        let cases = [(1.0, "1"), (-0.04, "0"), (12.345, "12.3"), (0.1 + 0.2, "0.3")];
        for (x, text) in cases {
            assert_eq!(px(x), text);
        }
        assert_eq!((px(f64::NAN), px(f64::INFINITY)), ("0".to_owned(), "0".to_owned()));
    }

    #[test]
    fn markup_in_text_stays_text() {
        let mut svg = Svg::new();
        let text = "</text><script>&\"\u{0}";
        svg.heading(text, 500.0);
        svg.text(0.0, 0.0, Look::new(10.0, style::INK), text);
        let svg = svg.finish((10.5, 20.0), text, text);
        assert_eq!(read(&svg), "</text><script>&\"\u{fffd}\n".repeat(2));
        assert!(svg.contains("viewBox=\"0 0 11 20\""));
    }
}
