//! Rows of a list of parts that belong to others though no column `parent` says so: by a column under another heading, by a path as
//! `Bus/Tank`, or by an indented name.

use std::collections::HashMap;

use super::{
    columns::PartColumns, error::PartsProblem, header::indentation, heading::Column,
    heading::Heading, levels::MARKS, row::PartRow, totals::Totals,
};
use crate::{
    body::shortened, rows::Field, rows::is_blank, spread::parted, spread::words, text::Text,
};

/// Words of a heading whose cells name what a row belongs to, and what may stand beside them.
const PARENTS: [&str; 7] =
    ["parent", "assembly", "assy", "subassembly", "nha", "belongs", "higher"];
const BESIDE: [&str; 13] =
    ["next", "of", "to", "part", "item", "name", "no", "nr", "number", "id", "code", "the", "sub"];

/// Marks of an outline that no name begins with. A dash, a plus or a star may belong to the name.
const OUTLINE: [char; 14] = ['.', '>', '»', '→', '|', '├', '└', '│', '─', '┣', '┗', '┃', '╰', '·'];
/// What parts a path.
const OF_PATH: [char; 2] = ['/', '\\'];
/// Most levels of a tree that are looked through.
const DEEPEST: usize = 100;

/// The columns that may say what belongs to what, and what stands in them.
#[derive(Debug)]
pub(super) struct Nesting {
    columns: Vec<Source>,
    /// Where the names stand among the columns of the list.
    name: usize,
    /// The cells of each row under these columns.
    cells: Vec<Vec<String>>,
    /// How far the name of each row is moved to the right.
    indented: Vec<usize>,
}

/// A column of names or of words that are not read.
#[derive(Debug)]
struct Source {
    place: usize,
    heading: String,
    is_name: bool,
    /// Whether its heading says that its cells name what a row belongs to.
    of_parents: bool,
    /// Whether its cells may be names of rows.
    is_label: bool,
}

/// What each row belongs to.
struct Tree<'a> {
    heading: &'a str,
    above: Vec<Option<usize>>,
    /// Whether it can be nothing else. Otherwise the sums of the masses tell it.
    is_certain: bool,
}

impl Nesting {
    pub(super) fn of(columns: &PartColumns) -> Option<Self> {
        let is_name = |at: usize| columns.meanings[at] == Heading::Column(Column::Name);
        let is_source = |at: &usize| is_name(*at) || columns.meanings[*at] == Heading::Other;
        let source = |place: usize| {
            let heading = &columns.headings[place];
            let parted = parted(heading);
            let all: Vec<&str> = words(&parted).filter(|word| !word.is_empty()).collect();
            let is_key = |word: &&str| PARENTS.contains(word);
            let of_parents =
                all.iter().any(is_key) && all.iter().all(|w| is_key(w) || BESIDE.contains(w));
            let is_label = is_name(place) || columns.labels.contains(&place);
            let heading = shortened(heading);
            Source { place, heading, is_name: is_name(place), of_parents, is_label }
        };
        let name = (0..columns.headings.len()).find(|at| is_name(*at))?;
        let columns = (0..columns.headings.len()).filter(is_source).map(source).collect();
        Some(Self { columns, name, cells: Vec::new(), indented: Vec::new() })
    }

    pub(super) fn add(&mut self, text: &Text, fields: &[Field], cells: &[String]) {
        let cell = |column: &Source| cells.get(column.place).cloned().unwrap_or_default();
        self.cells.push(self.columns.iter().map(cell).collect());
        self.indented.push(fields.get(self.name).map_or(0, |field| indentation(text, field)));
    }

    /// Why the list is refused, if a row with numbers belongs to another one with numbers: that row.
    pub(super) fn problem<'a>(&self, rows: &'a [PartRow]) -> Option<(&'a PartRow, PartsProblem)> {
        let totals = Totals::of(rows);
        let mut trees = self.by_names().chain(self.by_paths()).chain(self.by_indentation());
        trees.find_map(|tree| {
            let (at, above) = tree.counted_twice(rows, &totals)?;
            let (heading, above) = (tree.heading.to_owned(), shortened(rows[above].name()));
            Some((&rows[at], PartsProblem::Level { heading, above }))
        })
    }

    fn column(&self, column: usize) -> impl Iterator<Item = (usize, &str)> {
        self.cells.iter().map(move |row| row[column].as_str()).enumerate()
    }

    /// The row of each cell of a column; none of those that stand twice.
    fn rows_by_cell(&self, column: usize) -> HashMap<&str, Option<usize>> {
        let mut rows = HashMap::new();
        for (at, cell) in self.column(column).filter(|(_, cell)| !is_blank(cell)) {
            rows.entry(cell).and_modify(|row| *row = None).or_insert(Some(at));
        }
        rows
    }

    /// By a column whose cells are names of other rows.
    fn by_names(&self) -> impl Iterator<Item = Tree<'_>> {
        let is_key = |(_, source): &(usize, &Source)| source.is_label && !source.of_parents;
        let keys = self.columns.iter().enumerate().filter(is_key);
        let keys: Vec<_> = keys.map(|(at, _)| (at, self.rows_by_cell(at))).collect();
        let sources = self.columns.iter().enumerate().filter(|(_, source)| !source.is_name);
        sources.flat_map(move |(of, source)| {
            let is_number = |cell: &str| is_blank(cell) || cell.parse::<f64>().is_ok();
            let is_left_out =
                !source.of_parents && self.column(of).all(|(_, cell)| is_number(cell));
            let keys = keys.iter().filter(|(key, _)| !is_left_out && *key != of);
            let tree = |(_, rows): &(usize, HashMap<&str, Option<usize>>)| {
                // A row that names itself is one of a group, which may be called as one of its parts.
                let mut is_group = false;
                let mut above = |(at, cell): (usize, &str)| {
                    let row = rows.get(cell).copied().flatten()?;
                    is_group |= row == at;
                    (row != at).then_some(row)
                };
                let above = self.column(of).map(&mut above).collect();
                Tree { heading: &source.heading, above, is_certain: source.of_parents && !is_group }
            };
            keys.map(tree).collect::<Vec<_>>()
        })
    }

    /// By cells as `Bus/Tank`, of which `Bus` is another one of the column.
    fn by_paths(&self) -> impl Iterator<Item = Tree<'_>> {
        self.columns.iter().enumerate().filter_map(|(of, source)| {
            let has_paths = self.column(of).any(|(_, cell)| cell.contains(OF_PATH));
            let rows = has_paths.then(|| self.rows_by_cell(of))?;
            let above = |(_, cell): (usize, &str)| {
                let mut ends = cell.rmatch_indices(OF_PATH).take(DEEPEST);
                ends.find_map(|(end, _)| rows.get(cell[..end].trim()).copied().flatten())
            };
            let above = self.column(of).map(above).collect();
            Some(Tree { heading: &source.heading, above, is_certain: false })
        })
    }

    /// By names that are moved to the right, or have marks before them.
    fn by_indentation(&self) -> Option<Tree<'_>> {
        let (of, source) = self.columns.iter().enumerate().find(|(_, source)| source.is_name)?;
        let mut is_certain = false;
        let depths: Vec<usize> = self
            .column(of)
            .zip(&self.indented)
            .map(|((_, name), blanks)| {
                let (lead, is_outline) = lead(name);
                is_certain |= is_outline;
                blanks + lead
            })
            .collect();
        // A tree begins with its highest row.
        let first = depths.first()?;
        if depths.iter().any(|depth| depth < first) || depths.iter().all(|depth| depth == first) {
            return None;
        }
        let mut open: Vec<(usize, usize)> = Vec::new();
        let above = depths.into_iter().enumerate().map(|(at, depth)| {
            open.retain(|(higher, _)| *higher < depth);
            let above = open.last().map(|(_, row)| *row);
            open.push((depth, at));
            above
        });
        let above = above.collect();
        Some(Tree { heading: &source.heading, above, is_certain })
    }
}

/// How many characters before a name are marks of an outline and blanks, and whether some can be nothing else.
fn lead(name: &str) -> (usize, bool) {
    let is_mark = |c: char| MARKS.contains(&c) || OUTLINE.contains(&c) || c.is_whitespace();
    let bare = name.trim_start_matches(is_mark);
    let lead = &name[..name.len() - bare.len()];
    let count = lead.chars().count();
    // `-Y panel` and `+Y panel` are names, and so may be `.5 in bolt`.
    let is_name = count == 1 && !lead.contains(OUTLINE)
        || bare.starts_with(|c: char| c.is_ascii_digit()) && !lead.ends_with(char::is_whitespace);
    if is_name { (0, false) } else { (count, lead.contains(OUTLINE)) }
}

impl Tree<'_> {
    /// The first row with numbers that belongs to one with numbers, and that one, if both are counted.
    fn counted_twice(&self, rows: &[PartRow], totals: &Totals) -> Option<(usize, usize)> {
        let has_numbers = |row: &usize| rows[*row].numbers().is_some();
        let above = |at: usize| {
            let mut row = self.above[at];
            for _ in 0..DEEPEST {
                match row {
                    Some(found) if !has_numbers(&found) => row = self.above[found],
                    _ => break,
                }
            }
            row.filter(has_numbers).filter(|above| *above != at)
        };
        let pairs = (0..rows.len()).filter(has_numbers).filter_map(|at| Some((at, above(at)?)));
        if self.is_certain {
            return pairs.min();
        }
        let mut parts: HashMap<usize, Vec<usize>> = HashMap::new();
        pairs.for_each(|(at, above)| parts.entry(above).or_default().push(at));
        let is_sum = |(above, parts): &(&usize, &Vec<usize>)| totals.is_of(**above, parts);
        let sums: Vec<_> = parts.iter().filter(is_sum).collect();
        // One part as heavy as another at the same place may be one that goes together with it.
        let are_told = sums.len() == parts.len() || sums.iter().any(|(_, parts)| parts.len() > 1);
        let first = sums.iter().filter_map(|(above, parts)| Some((*parts.first()?, **above)));
        first.min().filter(|_| are_told)
    }
}

#[cfg(test)]
mod tests;
