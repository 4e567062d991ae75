//! The text of a file, with its lines, and what refuses the whole of it.

use std::cell::OnceCell;

use crate::{FileProblem, encoding::Encoding, error::Refusal};

const BOM: &[u8] = b"\xef\xbb\xbf";

/// The bytes of a file as a text.
#[derive(Debug)]
pub(crate) struct Text {
    text: String,
    offsets: Offsets,
    newlines: OnceCell<Vec<usize>>,
}

/// Where in the bytes of a file the offsets of its text are.
#[derive(Clone, Debug, Default)]
pub(crate) struct Offsets {
    /// Length of the byte order mark, which the text lacks.
    mark: usize,
    /// Offsets of bytes of the text that the file lacks, in order: those after the first of a character that is one byte there.
    more: Vec<usize>,
}

impl Offsets {
    /// The place in the file.
    pub(crate) fn byte(&self, offset: usize) -> usize {
        self.mark + offset - self.more.partition_point(|more| *more < offset)
    }

    /// Of a text whose characters are one byte each.
    fn of_narrow(mark: usize, text: &str) -> Self {
        let more = text.char_indices().flat_map(|(at, c)| at + 1..at + c.len_utf8()).collect();
        Self { mark, more }
    }
}

impl Text {
    /// Takes UTF-8, and of XML what declares an [`Encoding`]. Where `latin` allows it, what is not UTF-8 is in
    /// [that of tables](Encoding::OF_TABLES).
    pub(crate) fn new(bytes: &[u8], latin: bool) -> Result<Self, Refusal> {
        let mark = if bytes.starts_with(BOM) { BOM.len() } else { 0 };
        let body = &bytes[mark..];
        if body.trim_ascii().is_empty() {
            return Err(FileProblem::Empty.into());
        }
        if let Some(problem) = no_text(body) {
            return Err(problem.into());
        }
        // Other encodings are allowed to tables alone, whose rows are lines.
        if latin && body.trim_ascii().contains(&b'\r') && !body.contains(&b'\n') {
            return Err(Refusal { line: Some(1), problem: FileProblem::CarriageReturns });
        }
        let (text, offsets) = match std::str::from_utf8(body) {
            Ok(text) => (text.to_owned(), Offsets { mark, more: Vec::new() }),
            Err(error) => {
                let of_tables = latin.then_some(Encoding::OF_TABLES);
                let encoding = of_tables.or_else(|| Encoding::declared(body)).ok_or_else(|| {
                    let before = &body[..error.valid_up_to()];
                    let line = 1 + before.iter().filter(|b| **b == b'\n').count();
                    Refusal { line: Some(line), problem: FileProblem::NotUtf8 }
                })?;
                let text = encoding.decode(body);
                let offsets = Offsets::of_narrow(mark, &text);
                (text, offsets)
            }
        };
        Ok(Self { text, offsets, newlines: OnceCell::new() })
    }

    pub(crate) fn as_str(&self) -> &str {
        &self.text
    }

    /// Where its offsets are in the file.
    pub(crate) fn offsets(&self) -> &Offsets {
        &self.offsets
    }

    /// Line of an offset, from 1.
    pub(crate) fn line(&self, offset: usize) -> usize {
        let newlines =
            self.newlines.get_or_init(|| self.text.match_indices('\n').map(|(i, _)| i).collect());
        1 + newlines.partition_point(|i| *i < offset)
    }

    /// Offset of a part of this text.
    pub(crate) fn offset_of(&self, part: &str) -> Option<usize> {
        let start = (part.as_ptr() as usize).checked_sub(self.text.as_ptr() as usize)?;
        (start.checked_add(part.len())? <= self.text.len()).then_some(start)
    }

    pub(crate) fn refuse(&self, offset: usize, problem: FileProblem) -> Refusal {
        Refusal { line: Some(self.line(offset)), problem }
    }

    pub(crate) fn malformed(&self, offset: usize, message: impl std::fmt::Display) -> Refusal {
        self.refuse(offset, FileProblem::Malformed { message: message.to_string() })
    }
}

/// Why bytes are no text in eight bits a character, if they are not.
pub(crate) fn no_text(bytes: &[u8]) -> Option<FileProblem> {
    if is_utf16(bytes) {
        return Some(FileProblem::Utf16);
    }
    bytes.contains(&0).then(|| {
        if bytes.starts_with(b"PAR1") {
            FileProblem::Parquet
        } else if bytes.starts_with(b"PK\x03\x04") {
            FileProblem::Zip
        } else {
            FileProblem::Binary
        }
    })
}

/// Whether bytes are sixteen bits a character: by their mark, or a zero in every other of the first bytes.
fn is_utf16(bytes: &[u8]) -> bool {
    let zeros = bytes
        .iter()
        .position(|b| *b == 0)
        .is_some_and(|at| at < 2 && bytes.len() > 3 && (bytes[at ^ 2] == 0 || bytes[2 + at] == 0));
    bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") || zeros
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offsets_and_lines() {
        let text = Text::new(b"\xef\xbb\xbfa\r\nb\nc", false).unwrap();
        assert_eq!((text.as_str(), text.offsets().byte(0)), ("a\r\nb\nc", 3));
        assert_eq!([0, 2, 3, 5].map(|i| text.line(i)), [1, 1, 2, 3]);
        assert_eq!(text.offset_of(&text.as_str()[3..4]), Some(3));
        assert_eq!(text.offset_of("elsewhere"), None);
    }

    #[test]
    fn encodings_are_told_apart() {
        let problem = |bytes: &[u8]| Text::new(bytes, false).unwrap_err().problem;
        assert!(matches!(problem(b""), FileProblem::Empty));
        assert!(matches!(problem(b"\xef\xbb\xbf \n"), FileProblem::Empty));
        assert!(matches!(problem(b"\xff\xfe<\0r\0"), FileProblem::Utf16));
        assert!(matches!(problem(b"<\0r\0o\0"), FileProblem::Utf16));
        assert!(matches!(problem(b"\0<\0r\0o"), FileProblem::Utf16));
        assert!(matches!(problem(b"\x7fELF\x02\x01\0"), FileProblem::Binary));
        assert!(matches!(problem(b"a\0"), FileProblem::Binary));
        assert!(matches!(problem(b"PAR1\x15\0"), FileProblem::Parquet));
        assert!(matches!(problem(b"PK\x03\x04\x14\0"), FileProblem::Zip));
        assert!(Text::new(b"PAR1,PK\n1,2\n", false).is_ok());
        let refusal = Text::new(b"a\nb\xe9\n", false).unwrap_err();
        assert!(matches!(refusal.problem, FileProblem::NotUtf8));
        assert_eq!(refusal.line, Some(2));
        assert_eq!(Text::new(b"m\xb2", true).unwrap().as_str(), "m²");
        let declared = b"<?xml version='1.0' encoding='ISO-8859-1'?><r n='\xe9'/>";
        let text = Text::new(declared, false).unwrap();
        assert!(text.as_str().ends_with("n='é'/>"));
        let (quote, end) = (declared.len() - 3, text.as_str().len());
        assert_eq!(text.offsets().byte(text.as_str().find('é').unwrap()), quote - 1);
        assert_eq!([end - 3, end].map(|at| text.offsets().byte(at)), [quote, declared.len()]);
    }
}
