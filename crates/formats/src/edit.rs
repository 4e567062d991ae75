//! Bytes of a file in which some places read otherwise.

use crate::{body::Place, text::Offsets};

/// A place of a text, and what stands there in a copy. A place without length is one where something is added.
pub(crate) type Edit = (Place, String);

/// The bytes with these places of their text changed; nothing if places overlap or lie outside.
pub(crate) fn edited(bytes: &[u8], offsets: &Offsets, mut edits: Vec<Edit>) -> Option<Vec<u8>> {
    edits.sort_by_key(|(place, _)| place.start);
    let mut copy = Vec::with_capacity(bytes.len() + 8 * edits.len());
    let mut done = 0;
    for (place, text) in edits {
        copy.extend_from_slice(bytes.get(done..offsets.byte(place.start))?);
        copy.extend_from_slice(text.as_bytes());
        done = offsets.byte(place.end);
    }
    copy.extend_from_slice(bytes.get(done..)?);
    Some(copy)
}

/// Whether two files are the same but for the numbers in them.
#[must_use]
pub fn is_same_but_numbers(one: &[u8], other: &[u8]) -> bool {
    without_numbers(one) == without_numbers(other)
}

/// The bytes with a mark in the place of every number that no letter stands before.
fn without_numbers(bytes: &[u8]) -> Vec<u8> {
    let mut out = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while let Some(&first) = bytes.get(at) {
        let rest = &bytes[at..];
        let is_digit = |b: u8| b.is_ascii_digit() || b"+-.eE".contains(&b);
        let is_word = at > 0 && (bytes[at - 1].is_ascii_alphanumeric() || bytes[at - 1] == b'_');
        let long = rest.iter().take_while(|b| is_digit(**b)).count();
        let number = std::str::from_utf8(&rest[..long]).ok().and_then(|t| t.parse::<f64>().ok());
        if number.is_some() && !is_word {
            out.push(0);
            at += long;
        } else {
            out.push(first);
            at += 1;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_alone_may_differ() {
        let same = |a: &str, b: &str| is_same_but_numbers(a.as_bytes(), b.as_bytes());
        assert!(same("<a x='1 2e-3'/>", "<a x='-1.5 7'/>"));
        assert!(!same("<a x='1 2'/>", "<a x='1  2'/>"));
        assert!(!same("<a x='1 2'/>", "<a x='1 2 3'/>"));
        assert!(!same("<a1/>", "<a2/>") && !same("<a_1/>", "<a_2/>"));
        assert!(same("", "") && !same("1", ""));
    }
}
