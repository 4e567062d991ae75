//! Text: widths, breaking, escaping, numbers.

use crate::visible::visible;

/// Estimated width of the text set in Helvetica or a face of the same metrics, a little generous.
pub(crate) fn width(text: &str, size: f64) -> f64 {
    text.chars().map(em).sum::<f64>() * size
}

/// Advance of a character in em, rounded up within groups of like characters.
fn em(c: char) -> f64 {
    match c {
        'i' | 'j' | 'l' | '\'' => 0.24,
        ' ' | '!' | ',' | '.' | '/' | ':' | ';' | 'I' | '[' | '\\' | ']' | 'f' | 't' | '|' => 0.29,
        '(' | ')' | '-' | 'r' | '`' | '{' | '}' | '"' | '*' | '·' | '°' => 0.38,
        'm' | 'M' | '%' => 0.88,
        'W' | '@' => 1.02,
        'A'..='Z' | '&' => 0.74,
        ' '..='~' => 0.57,
        '\u{2009}' => 0.2,
        '\u{300}'..='\u{36f}' | '\u{200b}'..='\u{200f}' => 0.0,
        _ if shifted(c).is_some() => 0.42,
        '\u{1100}'..='\u{11ff}' | '\u{2e80}'..='\u{ffdc}' => 1.05,
        '\u{10000}'.. => 1.4,
        _ => 0.7,
    }
}

/// The text, cut to fit with an ellipsis at the end if it must be.
pub(crate) fn fit(text: &str, size: f64, room: f64) -> String {
    if width(text, size) <= room {
        return text.to_owned();
    }
    let mut used = width("…", size);
    let kept: String = text
        .chars()
        .take_while(|&c| {
            used += em(c) * size;
            used <= room
        })
        .collect();
    format!("{}…", kept.trim_end())
}

/// The text in at most `most` lines, broken between words, each cut to fit.
pub(crate) fn wrap(text: &str, size: f64, room: f64, most: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let last = lines.len() >= most;
        match lines.last_mut() {
            Some(line) if last || width(line, size) + width(word, size) + 0.3 * size <= room => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines.iter().map(|line| fit(line, size, room)).collect()
}

/// The text with what XML reserves escaped, and what it forbids replaced.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in visible(text).chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\t' | '\n' => out.push(' '),
            '\u{fffe}' | '\u{ffff}' => out.push(char::REPLACEMENT_CHARACTER),
            _ => out.push(c),
        }
    }
    out
}

/// Escaped text, each run in its colour or in that of the line, with superscript and subscript
/// characters set as such in the face of the rest: few faces have them all, and a browser would
/// take each from another.
pub(crate) fn rich(runs: &[(Option<&str>, &str)]) -> String {
    let mut out = String::new();
    let mut raised = 0.0;
    for &(colour, text) in runs {
        for (level, text) in levels(text) {
            let (height, size) = match level {
                // In em of the line.
                Some(Level::Up) => (0.34, SMALL),
                Some(Level::Down) => (-0.16, SMALL),
                None => (0.0, 1.0),
            };
            let mut attributes = String::new();
            if let Some(colour) = colour {
                attributes.push_str(&format!(" fill=\"{colour}\""));
            }
            if level.is_some() {
                attributes.push_str(&format!(" font-size=\"{}%\"", SMALL * 100.0));
            }
            if height != raised {
                // `dy` counts in em of its own run.
                attributes.push_str(&format!(" dy=\"{:.3}em\"", (raised - height) / size));
                raised = height;
            }
            let text = escape(&text);
            if attributes.is_empty() {
                out.push_str(&text);
            } else {
                out.push_str(&format!("<tspan{attributes}>{text}</tspan>"));
            }
        }
    }
    out
}

/// Size of superscripts and subscripts.
const SMALL: f64 = 0.82;

/// The text as runs of one level each.
fn levels(text: &str) -> Vec<(Option<Level>, String)> {
    let mut runs: Vec<(Option<Level>, String)> = Vec::new();
    for c in text.chars() {
        let (plain, level) = shifted(c).map_or((c, None), |(plain, level)| (plain, Some(level)));
        match runs.last_mut() {
            Some((last, run)) if *last == level => run.push(plain),
            _ => runs.push((level, plain.to_string())),
        }
    }
    runs
}

#[derive(Clone, Copy, PartialEq)]
enum Level {
    Up,
    Down,
}

fn shifted(c: char) -> Option<(char, Level)> {
    const UP: &str = "⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻";
    const DOWN: &str = "₀₁₂₃₄₅₆₇₈₉₊₋";
    let plain = |at: usize| "0123456789+−".chars().nth(at);
    if let Some(at) = UP.chars().position(|x| x == c) {
        plain(at).map(|c| (c, Level::Up))
    } else {
        let at = DOWN.chars().position(|x| x == c)?;
        plain(at).map(|c| (c, Level::Down))
    }
}

/// A whole number in superscript characters.
pub(crate) fn superscript(number: i32) -> String {
    number
        .to_string()
        .chars()
        .map(|c| match c.to_digit(10) {
            Some(digit) => "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth(digit as usize).unwrap_or(c),
            None => '⁻',
        })
        .collect()
}

/// A whole number with thin spaces between thousands from 10 000 on.
pub(crate) fn count(number: usize) -> String {
    thousands(&number.to_string())
}

/// The number with the decimals given, a true minus and thin spaces between thousands.
pub(crate) fn decimal(number: f64, decimals: usize) -> String {
    let text = format!("{:.decimals$}", number.abs());
    if !text.contains(|c: char| ('1'..='9').contains(&c)) {
        return "0".to_owned();
    }
    let sign = if number < 0.0 { "−" } else { "" };
    match text.split_once('.') {
        Some((whole, rest)) => format!("{sign}{}.{rest}", thousands(whole)),
        None => format!("{sign}{}", thousands(&text)),
    }
}

/// The number to so many significant digits, as a decimal or times a power of ten.
pub(crate) fn significant(number: f64, digits: usize) -> String {
    let text = format!("{number:.*e}", digits.saturating_sub(1));
    let Some((mantissa, exponent)) = text.split_once('e') else { return text };
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if (-4..7).contains(&exponent) {
        let decimals = usize::try_from(digits as i32 - 1 - exponent).unwrap_or(0);
        let text = decimal(number, decimals);
        let trimmed = text.trim_end_matches('0').trim_end_matches('.');
        return if text.contains('.') { trimmed.to_owned() } else { text };
    }
    let mantissa = mantissa.replace('-', "−");
    let mantissa = match mantissa.contains('.') {
        true => mantissa.trim_end_matches('0').trim_end_matches('.'),
        false => &mantissa,
    };
    format!("{mantissa}×10{}", superscript(exponent))
}

fn thousands(digits: &str) -> String {
    let n = digits.len();
    if n < 5 {
        return digits.to_owned();
    }
    let mut out = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (n - at).is_multiple_of(3) {
            out.push('\u{2009}');
        }
        out.push(digit);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(decimal(-0.0, 2), "0");
        assert_eq!(decimal(-0.25, 2), "−0.25");
        assert_eq!(decimal(1234.0, 0), "1234");
        assert_eq!(decimal(-12345.5, 1), "−12\u{2009}345.5");
        assert_eq!(count(1_000_000), "1\u{2009}000\u{2009}000");
        assert_eq!(significant(0.1 + 0.2, 6), "0.3");
        assert_eq!(significant(-1234.5678, 6), "−1234.57");
        assert_eq!(significant(100.0, 3), "100");
        assert_eq!(significant(1e300, 4), "1×10³⁰⁰");
        assert_eq!(significant(-2.5e-9, 4), "−2.5×10⁻⁹");
    }

    #[test]
    fn text_is_escaped() {
        assert_eq!(escape("<a href=\"x\">&\u{1}\n"), "&lt;a href=&quot;x&quot;&gt;&amp;\u{fffd} ");
        assert_eq!(rich(&[(None, "a<b")]), "a&lt;b");
        assert_eq!(
            rich(&[(None, "I₁₂ m²"), (Some("red"), "x")]),
            "I<tspan font-size=\"82%\" dy=\"0.195em\">12</tspan><tspan dy=\"-0.160em\"> m</tspan>\
             <tspan font-size=\"82%\" dy=\"-0.415em\">2</tspan>\
             <tspan fill=\"red\" dy=\"0.340em\">x</tspan>"
        );
    }

    #[test]
    fn text_is_cut_and_wrapped_to_fit() {
        let long = "The quick brown fox jumps over the lazy dog";
        assert_eq!(fit(long, 10.0, 1e3), long);
        let short = fit(long, 10.0, 60.0);
        assert!(short.ends_with('…') && width(&short, 10.0) <= 60.0, "{short}");
        let lines = wrap(long, 10.0, 100.0, 2);
        assert_eq!(lines.len(), 2);
        assert!(lines.iter().all(|line| width(line, 10.0) <= 100.0), "{lines:?}");
        assert!(wrap(&"x".repeat(1000), 10.0, 100.0, 2)[0].ends_with('…'));
        assert!(wrap(" ", 10.0, 100.0, 2).is_empty());
    }
}
