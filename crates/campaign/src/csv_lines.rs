//! The lines of a CSV table that a reader of CSV would pass over without a word: blank lines of a table of one column, and rows that
//! begin with `#`.

use std::io::{self, Read};

/// What a reader of CSV takes for a row with an empty cell, where it would skip a blank line.
const EMPTY_CELL: &[u8] = b"\"\"";
/// Bytes that are taken from the source at a time.
const AT_ONCE: usize = 1 << 13;
/// What Excel begins a table in UTF-8 with.
const MARK: &[u8] = "\u{feff}".as_bytes();
/// A line that begins with `#` and has more bytes is a comment.
const LONGEST: usize = 1 << 16;
/// What spreadsheets write into a cell whose formula has no value, in small letters.
const ERRORS: [&str; 9] =
    ["#div/0!", "#n/a", "#name?", "#null!", "#num!", "#ref!", "#value!", "#calc!", "#spill!"];

/// Hands out the text of a table without its comments, and with `""` in each blank line below the names of the columns, if there is one
/// column. A blank line in quotation marks is a part of a cell, and stays as it is.
///
/// A line that begins with `#` is a comment above the names of the columns, if a blank or another `#` follows, or if it has not as many cells as
/// the names. Else it is a row if its first cell is an error of a spreadsheet, and is refused if not: it may be either.
#[derive(Debug)]
pub(crate) struct CsvLines<R> {
    source: R,
    separator: u8,
    /// Whether the table has one column.
    is_single: bool,
    has_begun: bool,
    place: Place,
    /// The first line that is neither blank nor a comment, as soon as it has begun.
    named: Option<Names>,
    line: u64,
    /// A line that begins with `#`.
    held: Vec<u8>,
    /// What waits to be handed out, from here on.
    ready: Vec<u8>,
    given: usize,
    /// Why nothing more is handed out after that.
    refused: Option<io::Error>,
}

/// The line with the names of the columns.
#[derive(Clone, Copy, Debug)]
struct Names {
    separators: usize,
    are_ended: bool,
}

impl Names {
    fn new() -> Self {
        Self { separators: 0, are_ended: false }
    }
}

/// Where in the text the next byte stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    LineStart,
    /// After a carriage return, which ends a line alone or with a line feed.
    AfterReturn,
    /// After a separator.
    CellStart,
    Cell,
    Quoted,
    /// After a quotation mark in a cell that began with one: it ends the quotation, unless another follows.
    AfterQuote,
    /// In a line that begins with `#`.
    Held,
}

impl<R: Read> CsvLines<R> {
    /// With this separator of cells.
    pub(crate) fn new(source: R, separator: u8, is_single: bool) -> Self {
        Self {
            source,
            separator,
            is_single,
            has_begun: false,
            place: Place::LineStart,
            named: None,
            line: 1,
            held: Vec::new(),
            ready: Vec::new(),
            given: 0,
            refused: None,
        }
    }

    fn take_all(&mut self, mut bytes: &[u8]) -> io::Result<()> {
        let separator = self.separator;
        let is_plain =
            |byte: &u8| !matches!(byte, b'\n' | b'\r' | b'"' | b'#') && *byte != separator;
        while let Some(first) = bytes.first() {
            let plain = bytes.iter().position(|byte| !is_plain(byte)).unwrap_or(bytes.len());
            if plain > 0 {
                let (cell, rest) = bytes.split_at(plain);
                self.take_plain(cell);
                bytes = rest;
            } else {
                self.take(*first)?;
                bytes = &bytes[1..];
            }
        }
        Ok(())
    }

    /// Takes bytes that mean nothing wherever they stand.
    fn take_plain(&mut self, bytes: &[u8]) {
        match self.place {
            Place::Held => self.hold(bytes),
            Place::Quoted => self.ready.extend_from_slice(bytes),
            Place::LineStart
            | Place::AfterReturn
            | Place::CellStart
            | Place::Cell
            | Place::AfterQuote => {
                self.ready.extend_from_slice(bytes);
                self.place = Place::Cell;
                self.named.get_or_insert(Names::new());
            }
        }
    }

    fn take(&mut self, byte: u8) -> io::Result<()> {
        let is_end = matches!(byte, b'\n' | b'\r');
        match self.place {
            Place::Held if is_end => self.end_held()?,
            Place::Held
                if byte == self.separator && self.named.is_some() && is_error(&self.held) =>
            {
                self.begin_row();
            }
            Place::Held => {
                self.hold(&[byte]);
                return Ok(());
            }
            Place::LineStart | Place::AfterReturn if byte == b'#' => {
                self.place = Place::Held;
                self.hold(&[byte]);
                return Ok(());
            }
            // A line feed after a return ends no line of its own.
            Place::LineStart if is_end => self.take_blank(),
            Place::AfterReturn if byte == b'\r' => self.take_blank(),
            Place::LineStart
            | Place::AfterReturn
            | Place::CellStart
            | Place::Cell
            | Place::Quoted
            | Place::AfterQuote => {}
        }
        self.ready.push(byte);
        self.line += u64::from(byte == b'\n');
        self.place = match (self.place, byte) {
            (Place::Quoted, b'"') => Place::AfterQuote,
            (Place::Quoted, _)
            | (
                Place::AfterQuote | Place::LineStart | Place::AfterReturn | Place::CellStart,
                b'"',
            ) => Place::Quoted,
            (_, b'\n') => Place::LineStart,
            (_, b'\r') => Place::AfterReturn,
            (_, other) if other == self.separator => Place::CellStart,
            (_, _) => Place::Cell,
        };
        if !matches!(self.place, Place::LineStart | Place::AfterReturn) {
            let names = self.named.get_or_insert(Names::new());
            names.separators += usize::from(self.place == Place::CellStart && !names.are_ended);
        } else if let Some(names) = &mut self.named {
            names.are_ended = true;
        }
        Ok(())
    }

    /// A blank line ends.
    fn take_blank(&mut self) {
        if self.is_single && self.named.is_some() {
            self.ready.extend_from_slice(EMPTY_CELL);
        }
    }

    fn hold(&mut self, bytes: &[u8]) {
        let left = LONGEST.saturating_sub(self.held.len());
        self.held.extend_from_slice(&bytes[..bytes.len().min(left)]);
    }

    /// Takes the line that begins with `#` for what it is.
    fn end_held(&mut self) -> io::Result<()> {
        let held = std::mem::take(&mut self.held);
        self.place = Place::LineStart;
        let is_blank = |byte: &u8| byte.is_ascii_whitespace() || *byte == b'#';
        if held.len() >= LONGEST || held.get(1).is_none_or(is_blank) {
            return Ok(());
        }
        let mut cells = held.split(|byte| *byte == self.separator);
        let first = cells.next().unwrap_or_default();
        let is_row = match self.named {
            // A column of numbers, called #.
            None => {
                let next = cells.next().and_then(|cell| cell.first());
                first == b"#" && next.is_some_and(u8::is_ascii_alphabetic)
            }
            Some(names) if cells.count() != names.separators => false,
            Some(_) if is_error(first) => true,
            Some(_) => {
                let said = format!(
                    "line {}: it begins with {:?}, and may be a comment or a row: write a blank after the # of a comment, and quotation \
                     marks around the first cell of a row",
                    self.line,
                    String::from_utf8_lossy(first.trim_ascii())
                );
                return Err(io::Error::other(said));
            }
        };
        if is_row {
            let separators = held.iter().filter(|byte| **byte == self.separator).count();
            self.named.get_or_insert(Names { separators, are_ended: true });
            self.held = held;
            self.begin_row();
        }
        Ok(())
    }

    /// Hands out what was held: it is of a row. What begins with a blank is no comment, and cells are trimmed.
    fn begin_row(&mut self) {
        self.ready.push(b' ');
        self.ready.append(&mut self.held);
        self.place = Place::Cell;
    }
}

/// Whether a cell has what a spreadsheet writes where a formula has no value.
pub(crate) fn is_error(cell: &[u8]) -> bool {
    let cell = cell.trim_ascii();
    ERRORS.iter().any(|error| cell.eq_ignore_ascii_case(error.as_bytes()))
}

impl<R: Read> Read for CsvLines<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        // What was read may all be a comment.
        while self.given == self.ready.len() {
            if let Some(refused) = self.refused.take() {
                return Err(refused);
            }
            let mut bytes = [0; AT_ONCE];
            let mut read = 0;
            // As many as tell the mark of an encoding.
            while read < MARK.len() {
                let more = self.source.read(&mut bytes[read..])?;
                if more == 0 {
                    break;
                }
                read += more;
            }
            (self.given, self.ready) = (0, Vec::with_capacity(read));
            let bytes = &bytes[..read];
            let marked = if self.has_begun { None } else { bytes.strip_prefix(MARK) };
            self.has_begun = true;
            let mut taken = self.take_all(marked.unwrap_or(bytes));
            if read == 0 && self.place == Place::Held {
                taken = self.end_held();
            }
            // What stands before it is read first: the names may be all that is wanted.
            self.refused = taken.err();
            // Nobody asks again after the end.
            if read == 0 && self.refused.is_none() {
                break;
            }
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

    /// A source that hands out a few bytes at a time.
    struct Slow<'a>(&'a [u8], usize);

    impl Read for Slow<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            let most = self.1.min(buffer.len());
            self.0.read(&mut buffer[..most])
        }
    }

    /// A cell, as it is written and as it is read.
    fn cell() -> impl Strategy<Value = (String, String)> {
        let written = |text: &str, read: &str| Just((text.to_owned(), read.to_owned()));
        prop_oneof![
            4 => (-9..9_i32).prop_map(|x| (x.to_string(), x.to_string())),
            1 => (-9..9_i32).prop_map(|x| (format!("\"{x}\""), x.to_string())),
            1 => written("\"\"", ""),
            1 => written("  ", ""),
            1 => written("\"a \"\"\n\n\r\n#b,\"", "a \"\n\n\r\n#b,"),
            1 => written("a\"", "a\""),
            1 => written("\"#1\"", "#1"),
            1 => written("#N/A", "#N/A"),
            1 => written("#Div/0! ", "#Div/0!"),
        ]
    }

    /// A line of a table of so many columns, as it is written, and the row that it is, if it is one.
    fn line(columns: usize) -> impl Strategy<Value = (String, Option<Vec<String>>)> {
        let row = prop::collection::vec(cell(), columns).prop_map(|cells| {
            let (written, read): (Vec<_>, Vec<_>) = cells.into_iter().unzip();
            (written.join(","), Some(read))
        });
        let blank = (columns == 1).then(|| vec![String::new()]);
        let comment = |text: &str| (text.to_owned(), None);
        let comments = vec![
            comment("# \"a comment"),
            comment("#"),
            comment("##a"),
            comment("#a,b,c,d,e,f"),
            comment("#\t1"),
        ];
        prop_oneof![
            6 => row,
            2 => Just((String::new(), blank)),
            2 => prop::sample::select(comments),
        ]
    }

    /// What a reader of CSV has of a text: the names and the rows.
    fn read(
        text: &str,
        columns: usize,
        at_once: usize,
    ) -> csv::Result<(Vec<String>, Vec<Vec<String>>)> {
        let source =
            CsvLines::new(Slow(text.as_bytes(), at_once), b',', columns == 1).chain(&b"\n"[..]);
        let mut builder = csv::ReaderBuilder::new();
        builder.comment(Some(b'#')).trim(csv::Trim::All);
        let mut reader = builder.from_reader(source);
        let owned = |row: &csv::StringRecord| row.iter().map(str::to_owned).collect::<Vec<_>>();
        let names = owned(reader.headers()?);
        let rows = reader.records().map(|row| Ok(owned(&row?))).collect::<csv::Result<_>>()?;
        Ok((names, rows))
    }

    proptest! {
        /// Each line below the names is a row, but for comments and blank lines beside several columns, with every kind of line end, whether
        /// the last line has one or not.
        #[test]
        fn each_line_is_a_row(
            before in prop::collection::vec(prop::sample::select(vec!["", "# a \"comment", "#a", "#N/A", "#1,2"]), 0..3),
            mark: bool,
            quoted: bool,
            (columns, lines) in (1..4_usize).prop_flat_map(|columns| (Just(columns), prop::collection::vec(line(columns), 0..30))),
            end in prop::sample::select(vec!["\n", "\r\n", "\r"]),
            ended: bool,
            at_once in 1..20_usize,
        ) {
            let names = ["x", "y,y", "#z"].map(|name| if quoted || name.contains(',') { format!("\"{name}\"") } else { name.to_owned() });
            let header = names[..columns].join(",");
            let below = lines.iter().map(|(text, _)| text.as_str());
            let all: Vec<&str> = before.into_iter().chain([header.as_str()]).chain(below).collect();
            let mut text = if mark { "\u{feff}".to_owned() } else { String::new() };
            text += &all.join(end);
            // What nothing ends and has no letter is no line.
            if ended || all.last().is_some_and(|last| last.is_empty()) {
                text.push_str(end);
            }
            let (names, rows) = read(&text, columns, at_once).unwrap();
            prop_assert_eq!(names, ["x", "y,y", "#z"][..columns].to_vec());
            let expected: Vec<Vec<String>> = lines.into_iter().filter_map(|line| line.1).collect();
            prop_assert_eq!(rows, expected);
        }

        /// A line that may be a comment or a row is neither, wherever it stands.
        #[test]
        fn what_may_be_a_row_is_refused(
            columns in 1..4_usize,
            (before, after) in (0..30_usize, 0..3_usize),
            ended: bool,
            at_once in 1..20_usize,
            id in "#[0-9a-zA-Z]{1,8}",
        ) {
            let row = |first: &str| format!("{first}{}\n", ",1".repeat(columns - 1));
            let mut text = row("x") + &row("0").repeat(before) + &row(&id) + &row("0").repeat(after);
            if !ended {
                text.pop();
            }
            let refused = read(&text, columns, at_once).unwrap_err().to_string();
            prop_assert!(refused.starts_with(&format!("line {}: it begins with {id:?}", before + 2)), "{}", refused);
            let quoted = row("x") + &row("0").repeat(before) + &row(&format!("\"{id}\""));
            prop_assert_eq!(read(&quoted, columns, 7).unwrap().1.len(), before + 1);
        }
    }

    /// Which separator a table has is found by trying: a comment that would be a row under another one refuses nothing.
    #[test]
    fn comments_are_those_of_the_right_separator() {
        let text = "id;x\n1;0.5\n#note\n2;0.7\n";
        let of = |separator: u8| {
            let mut builder = csv::ReaderBuilder::new();
            builder.delimiter(separator).comment(Some(b'#'));
            builder.from_reader(CsvLines::new(text.as_bytes(), separator, false))
        };
        assert_eq!(of(b',').headers().unwrap(), vec!["id;x"]);
        assert_eq!(of(b',').records().filter(Result::is_err).count(), 1);
        assert_eq!(of(b';').records().filter(Result::is_ok).count(), 2);
    }

    /// A column of numbers may be called `#`.
    #[test]
    fn a_column_may_be_called_so() {
        let (names, rows) = read("# t\n#,x\n1,2\n", 2, 5).unwrap();
        assert_eq!(
            (names, rows),
            (vec!["#".to_owned(), "x".to_owned()], vec![vec!["1".to_owned(), "2".to_owned()]])
        );
    }

    /// A line without an end takes no memory without end.
    #[test]
    fn long_comments_are_passed_over() {
        let text = format!("x\n1\n#{}\n2\n", "a".repeat(3 * LONGEST));
        assert_eq!(read(&text, 1, 1 << 20).unwrap().1.len(), 2);
    }
}
