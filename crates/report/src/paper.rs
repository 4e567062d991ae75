//! Tables on paper: how wide they are, and how those that are wider than a sheet are split.

use std::ops::Range;

use crate::{
    inline::{Span, Style, Text},
    table::{Align, PageCell, PageColumn, PageTable},
    text::width,
};

/// Widths count in em of the letters of the table. So many of the smallest letters (6.6 pt) stand side by side on A4
/// between margins of 12 mm.
const SHEET: f64 = 78.0;
/// Space beside the words of a cell.
const SPACE: f64 = 0.7;
/// What a reader's face may be wider than Helvetica.
const WIDER: f64 = 1.15;
/// Words in a column of numbers, and codes, which break anywhere, need no more.
const WRAPPED: f64 = 14.0;
const BADGE: f64 = 1.2;

/// A part of a table that fits on a sheet: its columns, of which the first is always that of the table, and its width.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Part {
    pub(crate) columns: Vec<usize>,
    pub(crate) em: f64,
}

/// The table in parts that fit on a sheet; one if all of it does. Columns that share a heading stay together if they can.
pub(crate) fn parts(table: &PageTable) -> Vec<Part> {
    let needs = |tight| -> Vec<f64> {
        (0..table.columns.len()).map(|i| SPACE + need(table, i, tight)).collect()
    };
    let fits = |needs: &Vec<f64>| needs.iter().sum::<f64>() <= SHEET;
    let (loose, tight) = (needs(false), needs(true));
    let needs = if !fits(&loose) && fits(&tight) { tight } else { loose };
    let Some((first, others)) = needs.split_first() else { return Vec::new() };
    if fits(&needs) || others.is_empty() {
        return vec![part(&needs, 1..needs.len())];
    }
    let mut parts = Vec::new();
    let mut from = 1;
    while from < needs.len() {
        let mut used = *first;
        let fits = needs[from..].iter().take_while(|need| {
            used += **need;
            used <= SHEET
        });
        let mut to = from + fits.count().max(1);
        let shared = |i: usize| -> Option<&String> { table.columns.get(i)?.group.as_ref() };
        let mut start = to;
        while start > from && shared(start).is_some() && shared(start - 1) == shared(start) {
            start -= 1;
        }
        if start > from {
            to = start;
        }
        parts.push(part(&needs, from..to));
        from = to;
    }
    parts
}

fn part(needs: &[f64], columns: Range<usize>) -> Part {
    let columns: Vec<usize> = [0].into_iter().chain(columns).collect();
    let em = columns.iter().map(|i| needs[*i]).sum();
    Part { columns, em }
}

/// What a column needs: numbers stand on one line, and words wrap; if it must be tight, what words stand among numbers
/// wraps as well.
fn need(table: &PageTable, i: usize, tight: bool) -> f64 {
    let PageColumn { label, align, group: _ } = &table.columns[i];
    let cells = || table.rows.iter().map(|row| &row.cells[i]);
    let longest = |of: fn(&PageCell) -> f64| cells().map(of).fold(0.0, f64::max);
    let whole = longest(whole);
    let words = longest(word).max(word(label));
    let is_word = |word: &str| word.chars().filter(|c| c.is_alphabetic()).count() > 2;
    let says = |line: &Text| line.words().split(' ').any(is_word);
    if tight && cells().flat_map(PageCell::lines).any(says) {
        return words;
    }
    match align {
        Align::Left => words.max(whole.min(WRAPPED)),
        Align::Right if whole > WRAPPED => words.max(WRAPPED),
        Align::Right => words.max(whole),
    }
}

/// The width of the longest line of a cell.
fn whole(cell: &PageCell) -> f64 {
    let line = |line: &Text| line.spans().iter().map(|span| extent(span, &span.text)).sum();
    cell.lines().iter().map(line).fold(0.0, f64::max)
}

/// The width of the longest word of a cell.
fn word(cell: &PageCell) -> f64 {
    let spans = cell.lines().iter().flat_map(Text::spans);
    let longest = |span: &Span| match span.style {
        Style::Badge(_) => extent(span, &span.text),
        Style::Plain | Style::Strong | Style::Emphasis | Style::Code | Style::Quiet => {
            span.text.split([' ', '\n']).map(|word| extent(span, word)).fold(0.0, f64::max)
        }
    };
    spans.map(longest).fold(0.0, f64::max)
}

fn extent(span: &Span, text: &str) -> f64 {
    let wide = WIDER * width(text, 1.0);
    match span.style {
        Style::Plain | Style::Emphasis | Style::Quiet => wide,
        Style::Strong => 1.06 * wide,
        Style::Code => wide.min(WRAPPED),
        Style::Badge(_) => 1.06 * wide + BADGE,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn table(widths: &[usize], shared: usize) -> PageTable {
        let rows = [0, 1];
        let mut of = PageTable::of(&rows).words("name", |row| format!("row {row}"));
        for (i, wide) in widths.iter().enumerate() {
            let cell = move |_: &i32| "8".repeat(*wide);
            of = match i.checked_div(shared) {
                None => of.numbers(format!("c{i}"), cell),
                Some(group) => of.numbers_of(&format!("g{group}"), format!("c{i}"), cell),
            };
        }
        of.into()
    }

    proptest! {
        /// Any table: no column is lost or comes twice, the first leads every part, and what can fit does.
        #[test]
        fn no_column_is_lost(widths in prop::collection::vec(0_usize..40, 0..40), shared in 0_usize..5) {
            let table = table(&widths, shared);
            let parts = parts(&table);
            prop_assert!(parts.iter().all(|part| part.columns[0] == 0));
            let others: Vec<usize> = parts.iter().flat_map(|part| part.columns[1..].to_vec()).collect();
            prop_assert_eq!(others, (1..=widths.len()).collect::<Vec<_>>());
            for part in &parts {
                prop_assert!(part.em <= SHEET || part.columns.len() <= 2, "{:?}", part);
            }
            // Columns that share a heading are apart only where one sheet cannot hold them.
            for pair in parts.windows(2) {
                let (last, next) = (pair[0].columns.last().unwrap(), pair[1].columns[1]);
                let group = |i: usize| table.columns[i].group.clone();
                if group(next).is_some() && group(*last) == group(next) {
                    prop_assert_eq!(group(pair[0].columns[1]), group(next));
                }
            }
        }
    }

    #[test]
    fn a_table_that_fits_is_whole() {
        let found = parts(&table(&[5, 5, 5], 0));
        assert_eq!(found.len(), 1);
        assert!(found[0].em < 20.0, "{found:?}");
        assert_eq!(parts(&table(&[12; 20], 0)).len(), 3);
    }
}
