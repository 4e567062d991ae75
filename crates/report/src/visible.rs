//! Text that commands nothing: what users and files write, before it is shown.

/// The text with every character replaced that is no sign but a command, to a terminal or to the order
/// in which text is shown: control characters but line break and tab, and marks of direction.
#[must_use]
pub fn visible(text: &str) -> String {
    text.chars().map(|c| if is_command(c) { '\u{fffd}' } else { c }).collect()
}

/// The text of a JSON document with the same characters escaped, as JSON writes them.
#[must_use]
pub fn visible_json(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        if is_command(c) {
            // Such characters stand in strings only.
            let mut units = [0; 2];
            for unit in c.encode_utf16(&mut units) {
                out.push_str(&format!("\\u{unit:04x}"));
            }
        } else {
            out.push(c);
        }
    }
    out
}

fn is_command(c: char) -> bool {
    let direction = matches!(c,
        '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    // Separators of lines and paragraphs, a mark of byte order, tags and notes between lines.
    let hidden = matches!(c,
        '\u{2028}' | '\u{2029}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}');
    direction || hidden || (c.is_control() && !matches!(c, '\n' | '\t'))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every character there is.
    #[test]
    fn no_command_is_shown() {
        for c in '\0'..=char::MAX {
            let text = format!("a{c}b");
            let shown = visible(&text);
            let controls =
                |text: &str| text.chars().any(|c| c.is_control() && c != '\n' && c != '\t');
            assert!(!controls(&shown), "{c:?}");
            let json = visible_json(&serde_json::to_string(&text).unwrap());
            assert!(!controls(&json), "{c:?}");
            assert_eq!(serde_json::from_str::<String>(&json).unwrap(), text);
            assert_eq!(visible(&json), json);
            if c.is_alphanumeric() || c.is_ascii_graphic() {
                assert_eq!(shown, text);
            }
        }
        let bidi = "safe\u{202e}lmth.exe \u{2066}a\u{2069} \u{9b}2J\u{1b}[2J";
        assert!(visible(bidi).chars().all(|c| c == '\u{fffd}' || c.is_ascii()));
    }
}
