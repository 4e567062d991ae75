//! The blank lines of a CSV table of one column, each of which is a row with an empty cell.

use std::io::{self, Read};

/// What a reader of CSV takes for a row with an empty cell, where it would skip a blank line.
const EMPTY_CELL: &[u8] = b"\"\"";
/// Bytes that are taken from the source at a time.
const AT_ONCE: usize = 1 << 13;

/// Hands out the text of a table of one column, with `""` in each blank line below the names of the columns. A blank line in quotation
/// marks is a part of a cell, and stays as it is.
#[derive(Debug)]
pub(crate) struct BlankLines<R> {
    source: R,
    place: Place,
    /// Whether the first line that is neither blank nor a comment has begun: it has the name of the column.
    named: bool,
    /// What waits to be handed out, from here on.
    ready: Vec<u8>,
    given: usize,
}

/// Where in the text the next byte stands.
#[derive(Clone, Copy, Debug)]
enum Place {
    LineStart,
    /// After a carriage return, which ends a line alone or with a line feed.
    AfterReturn,
    Cell,
    Comment,
    Quoted,
    /// After a quotation mark in a cell that began with one: it ends the quotation, unless another follows.
    AfterQuote,
}

impl<R: Read> BlankLines<R> {
    pub(crate) fn new(source: R) -> Self {
        Self { source, place: Place::LineStart, named: false, ready: Vec::new(), given: 0 }
    }

    fn take(&mut self, byte: u8) {
        if self.named
            && matches!(
                (self.place, byte),
                (Place::LineStart, b'\r' | b'\n') | (Place::AfterReturn, b'\r')
            )
        {
            self.ready.extend_from_slice(EMPTY_CELL);
        }
        self.ready.push(byte);
        self.place = match (self.place, byte) {
            (Place::Comment, b'\n') => Place::LineStart,
            (Place::Comment, _) => Place::Comment,
            (Place::Quoted, b'"') => Place::AfterQuote,
            (Place::Quoted, _) | (Place::AfterQuote, b'"') => Place::Quoted,
            (Place::LineStart | Place::AfterReturn | Place::Cell | Place::AfterQuote, b'\n') => {
                Place::LineStart
            }
            (Place::LineStart | Place::AfterReturn | Place::Cell | Place::AfterQuote, b'\r') => {
                Place::AfterReturn
            }
            (Place::LineStart | Place::AfterReturn, b'#') => Place::Comment,
            (Place::LineStart | Place::AfterReturn, b'"') => Place::Quoted,
            (Place::LineStart | Place::AfterReturn | Place::Cell | Place::AfterQuote, _) => {
                Place::Cell
            }
        };
        self.named |= matches!(self.place, Place::Cell | Place::Quoted);
    }
}

impl<R: Read> Read for BlankLines<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.given == self.ready.len() {
            let mut bytes = [0; AT_ONCE];
            let read = self.source.read(&mut bytes)?;
            (self.given, self.ready) = (0, Vec::with_capacity(read));
            bytes[..read].iter().for_each(|byte| self.take(*byte));
        }
        let given = (&self.ready[self.given..]).read(buffer)?;
        self.given += given;
        Ok(given)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A line of a table, as it is written, and the cell that it is; none for a comment.
    fn line() -> impl Strategy<Value = (String, Option<String>)> {
        let empty = || Some(String::new());
        prop_oneof![
            3 => Just((String::new(), empty())),
            1 => Just(("\"\"".to_owned(), empty())),
            1 => Just(("  ".to_owned(), empty())),
            3 => (-9..9_i32).prop_map(|x| (x.to_string(), Some(x.to_string()))),
            1 => (-9..9_i32).prop_map(|x| (format!("\"{x}\""), Some(x.to_string()))),
            1 => Just(("\"a \"\"\n\n\r\n#b\"".to_owned(), Some("a \"\n\n\r\n#b".to_owned()))),
            1 => Just(("a\"".to_owned(), Some("a\"".to_owned()))),
            1 => Just(("# \"a comment".to_owned(), None)),
        ]
    }

    /// A source that hands out a few bytes at a time.
    struct Slow<'a>(&'a [u8], usize);

    impl Read for Slow<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            let most = self.1.min(buffer.len());
            self.0.read(&mut buffer[..most])
        }
    }

    proptest! {
        /// Each line below the name is a row, but for comments, with every kind of line end, whether the last line has one or not.
        #[test]
        fn each_line_is_a_row(
            before in prop::collection::vec(prop::sample::select(vec!["", "# a \"comment"]), 0..3),
            name in prop::sample::select(vec!["x", "\"x\"", "\u{feff}x"]),
            lines in prop::collection::vec(line(), 0..30),
            end in prop::sample::select(vec!["\n", "\r\n", "\r"]),
            ended: bool,
            at_once in 4..20_usize,
        ) {
            // A comment ends with a line feed only.
            let comments = before.iter().any(|line| line.starts_with('#')) || lines.iter().any(|line| line.1.is_none());
            let end = if comments && end == "\r" { "\n" } else { end };
            let name = if before.is_empty() { name } else { name.trim_start_matches('\u{feff}') };
            let below = lines.iter().map(|(text, _)| text.as_str());
            let all: Vec<&str> = before.into_iter().chain([name]).chain(below).collect();
            let mut text = all.join(end);
            // What nothing ends and has no letter is no line.
            if ended || all.last().is_some_and(|last| last.is_empty()) {
                text.push_str(end);
            }
            let source = BlankLines::new(Slow(text.as_bytes(), at_once)).chain(&b"\n"[..]);
            let mut builder = csv::ReaderBuilder::new();
            builder.comment(Some(b'#')).trim(csv::Trim::All);
            let mut reader = builder.from_reader(source);
            prop_assert_eq!(reader.headers().unwrap(), vec!["x"]);
            let rows: Vec<String> = reader.records().map(|row| row.unwrap()[0].to_owned()).collect();
            let expected: Vec<String> = lines.into_iter().filter_map(|line| line.1).collect();
            prop_assert_eq!(rows, expected);
        }
    }
}
