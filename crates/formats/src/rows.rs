//! The rows of a table, with the place of each field.
//!
//! Read by hand, because a copy that changes single numbers needs the places.

use crate::{error::Refusal, products_said::states_products, text::Text};

/// Why quotation marks do not hold a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum QuoteError {
    /// The mark at this offset is never closed.
    #[error("a quotation mark is not closed")]
    Unclosed {
        /// Where the mark stands.
        at: usize,
    },
    /// Something stands between the mark that closes a cell and the separator.
    #[error(
        "something stands behind the quotation mark that closes cell {cell}: a separator or the end of the line must follow \
         there, and a quotation mark inside a cell must be written twice"
    )]
    Trailing {
        /// Where the cell begins.
        at: usize,
        /// Which cell of the row it is, from 1.
        cell: usize,
    },
}

impl QuoteError {
    /// The refusal of the text in which it is.
    pub(crate) fn of(self, text: &Text) -> Refusal {
        text.malformed(self.at(), self)
    }

    /// Where the cell begins.
    pub(crate) fn at(self) -> usize {
        let (Self::Unclosed { at } | Self::Trailing { at, .. }) = self;
        at
    }
}

/// Where a field stands, its quotes not counted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Field {
    pub(crate) start: usize,
    pub(crate) end: usize,
}

impl Field {
    /// What it holds, as it is written.
    pub(crate) fn of(self, text: &str) -> &str {
        text.get(self.start..self.end).unwrap_or_default()
    }
}

/// What R writes where nothing is known. It is an empty cell wherever that stands for no number.
pub(crate) const NOT_KNOWN: &str = "NA";

/// Whether a cell holds nothing.
pub(crate) fn is_blank(cell: &str) -> bool {
    cell.is_empty() || cell == NOT_KNOWN
}

/// The rows of a text that are neither blank nor comments.
#[derive(Clone, Debug)]
pub(crate) struct Rows<'a> {
    text: &'a str,
    at: usize,
    separator: u8,
}

impl<'a> Rows<'a> {
    /// The rows of a text from its beginning, where the first of them tells the separator.
    pub(crate) fn new(text: &'a str) -> Self {
        let first = lines(text).find(|(_, line)| !is_comment(line)).unwrap_or_default();
        Self { at: 0, ..Self::at(text, first.0, first.1) }
    }

    /// Those from an offset on, of which a line tells the separator.
    pub(crate) fn at(text: &'a str, at: usize, line: &str) -> Self {
        let line = record(&text[at..], line);
        // What follows the line tells which of its marks part numbers as well.
        let behind = text[at..].strip_prefix(line).unwrap_or_default();
        let row = behind.lines().find(|line| !is_comment(line)).unwrap_or_default();
        Self { text, at, separator: separator(line, row) as u8 }
    }

    /// The fields of the next row that is neither blank nor a comment, or why its quotation marks hold
    /// no cell. Spreadsheets write separators alone for a blank row.
    pub(crate) fn next(&mut self) -> Option<Result<Vec<Field>, QuoteError>> {
        loop {
            if self.at == self.text.len() {
                return None;
            }
            if self.passes_comment() {
                continue;
            }
            match self.row() {
                Ok(row) if row.iter().all(|field| field.of(self.text).trim().is_empty()) => {}
                row => return Some(row),
            }
        }
    }

    /// Passes over the line that begins here, if it is a comment.
    fn passes_comment(&mut self) -> bool {
        let line = self.text[self.at..].split('\n').next().unwrap_or_default();
        let passes = !line.trim().is_empty() && is_comment(line);
        if passes {
            self.at = (self.at + line.len() + 1).min(self.text.len());
        }
        passes
    }

    /// Passes over the rows before an offset; whether one begins there, and not only a line within a quoted cell.
    fn begins_at(&mut self, at: usize) -> bool {
        while self.at < at {
            if !self.passes_comment() && self.row().is_err() {
                self.at = self.text.len();
            }
        }
        self.at == at
    }

    /// The fields of the row that begins here.
    pub(crate) fn row(&mut self) -> Result<Vec<Field>, QuoteError> {
        let bytes = self.text.as_bytes();
        let mut fields = Vec::new();
        loop {
            while bytes.get(self.at) == Some(&b' ') {
                self.at += 1;
            }
            let (start, end);
            if bytes.get(self.at) == Some(&b'"') {
                start = self.at + 1;
                let mut i = start;
                loop {
                    match (bytes.get(i), bytes.get(i + 1)) {
                        (Some(b'"'), Some(b'"')) => i += 2,
                        (Some(b'"'), _) => break,
                        (Some(_), _) => i += 1,
                        (None, _) => return Err(QuoteError::Unclosed { at: self.at }),
                    }
                }
                end = i;
                self.at = i + 1;
                while !self.at_end_of_field() {
                    self.at += 1;
                }
                // Whoever wrote `"12" lb` means other than 12, or a quotation mark that belongs to the cell.
                if !self.text[i + 1..self.at].trim().is_empty() {
                    return Err(QuoteError::Trailing { at: start - 1, cell: fields.len() + 1 });
                }
            } else {
                start = self.at;
                while !self.at_end_of_field() {
                    self.at += 1;
                }
                end = self.at;
            }
            fields.push(Field { start, end });
            match bytes.get(self.at) {
                Some(b) if *b == self.separator => self.at += 1,
                Some(_) => {
                    self.at += 1;
                    return Ok(fields);
                }
                None => return Ok(fields),
            }
        }
    }

    fn at_end_of_field(&self) -> bool {
        self.text.as_bytes().get(self.at).is_none_or(|b| *b == b'\n' || *b == self.separator)
    }
}

/// What the cells of a line may be that has quotation marks which hold no cells, by each separator: each cell without its marks, and what stands
/// within them.
pub(crate) fn without_marks(line: &str) -> impl Iterator<Item = Vec<String>> {
    SEPARATORS.into_iter().map(|separator| {
        let each = line.split(separator).flat_map(|cell| {
            let within = cell.split('"').nth(1).map(str::to_owned);
            [Some(cell.replace('"', " ")), within].into_iter().flatten()
        });
        each.map(|cell| cell.trim().to_owned()).collect()
    })
}

/// What may stand between cells.
const SEPARATORS: [char; 3] = [',', ';', '\t'];

/// Most lines above a header, titles and the like, that are looked through for it.
const TITLES: usize = 100;

/// The lines that a header may be, with their offsets: the first ones that are neither blank nor comments.
pub(crate) fn headers(text: &str) -> impl Iterator<Item = (usize, &str)> {
    lines(text).filter(|(_, line)| !is_comment(line)).take(TITLES)
}

/// What the first comments hold, with its offsets: one of them may be the header where no other line is.
pub(crate) fn commented_headers(text: &str) -> impl Iterator<Item = (usize, &str)> {
    lines(text).filter(|(_, line)| line.starts_with('#')).take(TITLES).map(|(at, line)| {
        let content = line.trim_start_matches(['#', ' ', '\t']);
        (at + line.len() - content.len(), content)
    })
}

/// The lines of a text with their offsets.
pub(crate) fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut at = 0;
    text.split_inclusive('\n').map(move |line| {
        at += line.len();
        (at - line.len(), line)
    })
}

/// The lines that are no rows, with their offsets: titles and comments above a header, and comments below it.
pub(crate) fn titles(text: &str, header: usize) -> impl Iterator<Item = (usize, &str)> {
    let line = text.get(header..).unwrap_or_default().lines().next().unwrap_or_default();
    let mut rows = Rows::at(text, header, line);
    lines(text).filter(move |(at, line)| {
        let mut is_below = || *at > header && is_comment(line) && rows.begins_at(*at);
        !line.trim().is_empty() && (at + line.len() <= header || is_below())
    })
}

pub(crate) fn is_comment(line: &str) -> bool {
    (line.starts_with('#') && !is_numbered(line)) || line.trim().is_empty() || states_products(line)
}

/// Whether a line that begins with # is a row: the heading of a column of numbers, `#,name,mass`, or a number or a name
/// with one, `#2,…` or `#2 thruster,…`.
fn is_numbered(line: &str) -> bool {
    let is_separator = |c: char| SEPARATORS.contains(&c);
    let Some((first, rest)) = line[1..].split_once(is_separator) else { return false };
    let digits = first.len() - first.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    first.is_empty() && rest.starts_with(char::is_alphabetic)
        || digits > 0
            && (first[digits..].trim().is_empty() || first[digits..].contains(char::is_alphabetic))
}

/// A line with those that belong to it: a quotation mark at the beginning of a cell may be closed in a later line. Where it is closed nowhere, the line alone.
fn record<'a>(text: &'a str, line: &'a str) -> &'a str {
    let is_even = |part: &str| part.matches('"').count().is_multiple_of(2);
    let opens_cell = |before: &str| {
        let before = before.trim_end_matches(' ');
        before.is_empty() || before.ends_with(SEPARATORS)
    };
    if is_even(line) || !line.rsplit_once('"').is_some_and(|(before, _)| opens_cell(before)) {
        return line;
    }
    let behind = text.get(line.len()..).unwrap_or_default();
    let Some(mut end) = behind.match_indices('"').map(|(at, _)| line.len() + at + 1).next() else {
        return line;
    };
    // In the line of the mark that closes the cell, another one may open the next.
    loop {
        end += text[end..].find('\n').map_or(text.len() - end, |newline| newline + 1);
        if is_even(&text[..end]) {
            return &text[..end];
        }
        match text[end..].find('"') {
            Some(at) => end += at + 1,
            None => return line,
        }
    }
}

/// What there is as often in a header as in the row below it, or else most of in the header; a comma where nothing is. What
/// stands in quotes does not count.
fn separator(header: &str, row: &str) -> char {
    let count = |line: &str, separator: char| -> usize {
        line.split('"').step_by(2).map(|open| open.matches(separator).count()).sum()
    };
    let rank = |separator: &char| {
        let there = count(header, *separator);
        let agrees = there > 0 && there == count(row, *separator);
        (agrees, there, *separator == ',')
    };
    SEPARATORS.into_iter().max_by_key(rank).unwrap_or(',')
}
