//! The end of what a process wrote to standard error.

/// Bytes that are kept.
const KEPT: usize = 64 << 10;
/// Characters of its last line that are told.
const TOLD: usize = 300;

/// The end of what a process wrote to standard error.
#[derive(Debug, Default)]
pub(super) struct Tail(Vec<u8>);

impl Tail {
    /// More that it wrote.
    pub(super) fn push(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
        // Cut at twice the size, so that every byte is moved at most once.
        if self.0.len() > 2 * KEPT {
            self.0.drain(..self.0.len() - KEPT);
        }
    }

    /// Its last line that is not blank.
    pub(super) fn last_line(&self) -> Option<String> {
        let kept = &self.0[self.0.len().saturating_sub(KEPT)..];
        let lines = kept.split(|byte| matches!(byte, b'\n' | b'\r')).rev();
        lines.map(|line| shown(line, TOLD)).find(|line| !line.is_empty())
    }
}

/// Bytes as one line of text for people, of so many characters at most.
pub(super) fn shown(bytes: &[u8], characters: usize) -> String {
    // A character takes at most four bytes.
    let start = &bytes[..bytes.len().min(4 * characters + 4)];
    let text = String::from_utf8_lossy(start);
    let clean: String = text.trim().chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    match clean.char_indices().nth(characters) {
        Some((end, _)) => format!("{}…", &clean[..end]),
        None => clean,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Any bytes in any parts: the last line is that of the last 64 KiB of all of them.
        #[test]
        fn tells_the_last_line(
            lines in prop::collection::vec(prop_oneof![4 => 0_usize..50, 1 => 60_000_usize..140_000], 0..6),
            part in 1_usize..100_000,
            ended in any::<bool>(),
        ) {
            let letters = ('a'..).map(|c| c.to_string());
            let lines: Vec<String> = lines.iter().zip(letters).map(|(n, c)| c.repeat(*n)).collect();
            let mut text = lines.join("\n");
            if ended {
                text.push('\n');
            }
            let mut tail = Tail::default();
            text.as_bytes().chunks(part).for_each(|part| tail.push(part));
            prop_assert!(tail.0.len() <= 2 * KEPT);
            let last = lines.iter().rev().find(|line| !line.is_empty());
            // A line end at the very start of what is kept leaves nothing of the line before it.
            match (tail.last_line(), last) {
                (Some(told), Some(last)) => {
                    prop_assert_eq!(told.chars().next(), last.chars().next());
                    prop_assert!(told.chars().count() <= TOLD + 1);
                }
                (None, Some(_)) => prop_assert!(false, "nothing told"),
                (told, None) => prop_assert_eq!(told, None),
            }
        }

        #[test]
        fn shows_any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..200), most in 0_usize..40) {
            let shown = shown(&bytes, most);
            prop_assert!(shown.chars().count() <= most + 1);
            prop_assert!(!shown.chars().any(char::is_control));
        }
    }
}
