//! Lists of parts with levels, as those of drawings have, or with numbers as `1.2.3`: both say which row belongs to which.

use std::collections::BTreeMap;

use super::error::PartsProblem;
use super::row::PartRow;
use crate::{body::shortened, spread::parted, spread::words};

/// Words for a level, and what may stand beside them. With any other word, it is a level of something else.
const LEVELS: [&str; 10] = [
    "level",
    "lvl",
    "indent",
    "indenture",
    "indentation",
    "ebene",
    "stufe",
    "hierarchy",
    "tier",
    "depth",
];
const BESIDE_LEVELS: [&str; 9] =
    ["bom", "assembly", "assy", "wbs", "product", "structure", "tree", "part", "item"];

/// Words for the number of a row, and what may stand beside them. A `part number` is that of a drawing.
const NUMBERS: [&str; 6] = ["wbs", "item", "pos", "outline", "no", "nr"];
const BESIDE_NUMBERS: [&str; 7] = ["number", "num", "code", "id", "element", "bom", "structure"];

/// What is written as many times as a row is levels deep.
pub(super) const MARKS: [char; 12] = ['.', '>', '»', '→', '-', '–', '—', '+', '*', '•', '·', '|'];

/// The columns that say what belongs to what, and what stands in them.
#[derive(Debug)]
pub(super) struct Levels {
    columns: Vec<Column>,
    rows: Vec<Row>,
}

#[derive(Debug)]
struct Column {
    place: usize,
    heading: String,
    /// Whether a whole number says how deep a row is, and does not only count the rows.
    is_of_levels: bool,
    /// Whether names may stand there: `Item` may hold `Cube.001`, and an `Item no.` may not.
    may_be_names: bool,
}

#[derive(Debug)]
struct Row {
    line: usize,
    /// The name, if the row has numbers.
    name: Option<String>,
    /// What stands in each of the columns.
    cells: Vec<String>,
}

impl Levels {
    /// Those of a header; nothing if it has none.
    pub(super) fn of(headings: &[String]) -> Option<Self> {
        let column = |(place, heading): (usize, &String)| {
            let parted = parted(heading);
            let all: Vec<&str> = words(&parted).filter(|word| !word.is_empty()).collect();
            let is_of = |keys: &[&str], beside: &[&str]| {
                all.iter().any(|word| keys.contains(word))
                    && all.iter().all(|word| keys.contains(word) || beside.contains(word))
            };
            // Alone, a depth is a size.
            let is_of_levels = is_of(&LEVELS, &BESIDE_LEVELS) && all != ["depth"];
            let heading = shortened(heading);
            let may_be_names = all == ["item"];
            (is_of_levels || is_of(&NUMBERS, &BESIDE_NUMBERS)).then_some(Column {
                place,
                heading,
                is_of_levels,
                may_be_names,
            })
        };
        let columns: Vec<Column> = headings.iter().enumerate().filter_map(column).collect();
        (!columns.is_empty()).then_some(Self { columns, rows: Vec::new() })
    }

    pub(super) fn add(&mut self, row: &PartRow, cells: &[String]) {
        let cell = |column: &Column| cells.get(column.place).cloned().unwrap_or_default();
        let cells = self.columns.iter().map(cell).collect();
        let name = row.numbers().map(|_| row.name().to_owned());
        self.rows.push(Row { line: row.place().1, name, cells });
    }

    /// Why the list is refused, if a row with numbers belongs to another one with numbers: line and name of the first such row.
    pub(super) fn problem(&self) -> Option<(usize, &str, PartsProblem)> {
        self.columns.iter().enumerate().find_map(|(at, column)| {
            let cells: Vec<&str> = self.rows.iter().map(|row| row.cells[at].as_str()).collect();
            let (row, above) = if let Some(paths) = paths(&cells, column.may_be_names) {
                self.by_numbers(&paths)
            } else if column.is_of_levels {
                self.by_depths(&depths(&cells))
            } else {
                None
            }?;
            let (heading, above) = (column.heading.clone(), shortened(self.name(above)?));
            let problem = PartsProblem::Level { heading, above };
            Some((self.rows[row].line, self.name(row)?, problem))
        })
    }

    /// The name of a row with numbers.
    fn name(&self, row: usize) -> Option<&str> {
        self.rows[row].name.as_deref()
    }

    /// The first row with numbers below one with numbers. Levels that are none of a tree may be anything: in one the first row is the highest, and no row is
    /// more than one level below the row before.
    fn by_depths(&self, depths: &[Option<u32>]) -> Option<(usize, usize)> {
        let mut open: Vec<(u32, usize)> = Vec::new();
        for (at, depth) in depths.iter().enumerate() {
            let depth = (*depth)?;
            let is_next = open.last().is_none_or(|(last, _)| depth <= last.saturating_add(1))
                && open.first().is_none_or(|(first, _)| depth >= *first);
            if !is_next {
                return None;
            }
            open.retain(|(above, _)| *above < depth);
            let above = open.iter().rev().find(|(_, row)| self.name(*row).is_some());
            if let (Some((_, above)), Some(_)) = (above, self.name(at)) {
                return Some((at, *above));
            }
            open.push((depth, at));
        }
        None
    }

    /// The first row with numbers whose number begins with that of one with numbers. What stands twice is no number of a row.
    fn by_numbers(&self, paths: &[Option<Vec<&str>>]) -> Option<(usize, usize)> {
        let known = paths.iter().enumerate();
        let known = known.filter_map(|(at, path)| Some((path.as_deref()?, at)));
        let places: BTreeMap<&[&str], usize> = known.clone().collect();
        if places.len() < known.clone().count() {
            return None;
        }
        known.filter(|(_, at)| self.name(*at).is_some()).find_map(|(path, at)| {
            let above = |end: usize| places.get(&path[..end]).copied();
            let mut all_above = (1..path.len()).rev().filter_map(above);
            Some((at, all_above.find(|above| self.name(*above).is_some())?))
        })
    }
}

/// What stands between the dots of each cell, if some cell has two parts: `1.2`. Zeros at the end say nothing, as in `1.0`. Where names may stand, what has
/// two letters between two dots is one: `Cube.001`, and not `A.1` or `2b.3`.
fn paths<'a>(cells: &[&'a str], may_be_names: bool) -> Option<Vec<Option<Vec<&'a str>>>> {
    let path = |cell: &&'a str| {
        let mut path: Vec<&str> = cell.trim_matches('.').split('.').collect();
        while path.len() > 1 && path.last().is_some_and(|last| last.trim_matches('0').is_empty()) {
            path.pop();
        }
        let is_name = |part: &str| part.chars().filter(|c| c.is_alphabetic()).count() > 1;
        let is_part = |part: &&str| {
            let is_word = !part.is_empty() && part.chars().all(char::is_alphanumeric);
            is_word && !(may_be_names && is_name(part))
        };
        // Longer texts are none, and would be searched for long.
        (cell.len() <= 200 && path.iter().all(is_part)).then_some(path)
    };
    let paths: Vec<_> = cells.iter().map(path).collect();
    paths.iter().flatten().any(|path| path.len() > 1).then_some(paths)
}

/// How deep each cell says that its row is: by marks, if all have nothing else, or by a whole number, as `2`, `..2`, `2.0` and `L2`.
fn depths(cells: &[&str]) -> Vec<Option<u32>> {
    let marks = |cell: &&str| {
        let first = cell.chars().next();
        let is_mark = |c: char| MARKS.contains(&c) && Some(c) == first;
        cell.chars().all(is_mark).then(|| u32::try_from(cell.chars().count()).ok())?
    };
    // A dash alone says nothing.
    let says_nothing = |cell: &&str| ["", "-", "–", "—"].contains(cell);
    if cells.iter().all(|cell| marks(cell).is_some()) && !cells.iter().all(says_nothing) {
        return cells.iter().map(marks).collect();
    }
    let number = |cell: &&str| {
        let behind = cell.trim_start_matches(char::is_alphabetic);
        let word = cell[..cell.len() - behind.len()].to_lowercase();
        let is_level = word == "l" || LEVELS.contains(&word.as_str());
        let behind = behind.trim_start_matches([' ', '-', '_']);
        let number = if is_level { behind } else { *cell }.trim_matches(['.', ' ']);
        let (whole, rest) = number.split_once('.').unwrap_or((number, ""));
        whole.parse().ok().filter(|_| rest.trim_matches('0').is_empty())
    };
    cells.iter().map(number).collect()
}

#[cfg(test)]
mod tests {
    use super::super::tests::read;
    use proptest::prelude::*;

    /// How the level of a row may be written.
    fn written(level: u32, form: &str) -> String {
        let level_of = level as usize;
        match form {
            "mark" => ">".repeat(level_of),
            "dots" => ".".repeat(level_of) + &level.to_string(),
            _ => form.replace('N', &level.to_string()),
        }
    }

    proptest! {
        /// A row with numbers that belongs to another one with numbers, by its level, is refused, and no other is. Where the levels are those of no tree,
        /// they may be anything.
        #[test]
        fn no_row_is_a_part_of_another(
            rows in prop::collection::vec((0_u32..4, any::<bool>()), 1..12),
            heading in prop::sample::select(vec![
                "Level", "BOM level", "Indent", "Hierarchy", "Tier", "BOM depth", "Level of detail", "stress level", "Depth", "No.",
            ]),
            form in prop::sample::select(vec!["N", "dots", "mark", "LN", "l-N", "Level N", "lvl_N", "N.", "N.0"]),
            has_parents: bool,
        ) {
            let names = |at: usize| format!("part {at}");
            let mut text = format!("{heading},name,mass,Cx,Cy,Cz,Ixx,Iyy,Izz{}\n", if has_parents { ",parent" } else { "" });
            for (at, (level, has_numbers)) in rows.iter().enumerate() {
                let numbers = if *has_numbers { "1,0,0,0,1,1,1" } else { ",,,,,," };
                text += &format!("{},{},{numbers}{}\n", written(*level, form), names(at), if has_parents { "," } else { "" });
            }
            let belongs = |at: usize| {
                let mut level = rows[at].0;
                let above = rows[..at].iter().enumerate().rev().filter(move |(_, (other, _))| {
                    let is_above = *other < level;
                    level = level.min(*other);
                    is_above
                });
                above.filter(|(_, (_, has_numbers))| *has_numbers).map(|(at, _)| at).next()
            };
            let is_tree = |end: usize| {
                let is_below = |pair: &[(u32, bool)]| pair[1].0 <= pair[0].0 + 1;
                rows[..=end].windows(2).all(is_below) && rows[..=end].iter().all(|row| row.0 >= rows[0].0)
            };
            let is_of_other = ["Level of detail", "stress level", "Depth", "No."].contains(&heading);
            let expected = (0..rows.len())
                .find_map(|at| Some((at, belongs(at).filter(|_| rows[at].1 && is_tree(at) && !is_of_other && !has_parents)?)));
            agrees(&text, heading, expected)?;
        }

        /// The same of rows with numbers as `1.2.3`, in any order: each belongs to those whose number its own begins with.
        #[test]
        fn no_number_of_a_row_begins_with_that_of_another(
            rows in prop::collection::btree_map(prop::collection::vec(1_u32..12, 1..5), any::<bool>(), 1..12),
            order in any::<prop::sample::Index>(),
            twice: bool,
            heading in prop::sample::select(vec![
                "WBS", "WBS code", "Item", "Item no.", "item_number", "Pos.", "Level", "Outline number", "Part no.", "Serial no.", "Depth", "Length",
            ]),
            (before, after) in prop::sample::select(vec![("", ""), ("", "."), ("", ".0"), ("A.", ""), ("B2.", ".0.0")]),
        ) {
            let mut rows: Vec<(Vec<u32>, bool)> = rows.into_iter().collect();
            let middle = order.index(rows.len());
            rows.rotate_left(middle);
            if twice {
                rows.push((rows[0].0.clone(), false));
            }
            let mut text = format!("{heading},name,mass,Cx,Cy,Cz,Ixx,Iyy,Izz\n");
            for (at, (path, has_numbers)) in rows.iter().enumerate() {
                let path = path.iter().map(u32::to_string).collect::<Vec<_>>().join(".");
                let numbers = if *has_numbers { "1,0,0,0,1,1,1" } else { ",,,,,," };
                text += &format!("{before}{path}{after},part {at},{numbers}\n");
            }
            let above = |at: usize| {
                let is_above = |other: &usize| {
                    let (path, has_numbers) = &rows[*other];
                    *has_numbers && path.len() < rows[at].0.len() && rows[at].0.starts_with(path)
                };
                (0..rows.len()).filter(is_above).max_by_key(|other| rows[*other].0.len())
            };
            let has_dots = !before.is_empty() || rows.iter().any(|(path, _)| path.len() > 1);
            let is_read = !twice && has_dots && !["Part no.", "Serial no.", "Depth", "Length"].contains(&heading);
            let is_refused = |at: &usize| is_read && rows[*at].1;
            let expected = (0..rows.len()).filter(is_refused).find_map(|at| Some((at, above(at)?)));
            // Without dots they may be levels.
            if has_dots || heading != "Level" {
                agrees(&text, heading, expected)?;
            }
        }
    }

    /// That the first row which belongs to another is refused with its name, if there is one.
    fn agrees(
        text: &str,
        heading: &str,
        expected: Option<(usize, usize)>,
    ) -> Result<(), TestCaseError> {
        match (read(text), expected) {
            (Ok(_), None) => {}
            (Err(error), Some((at, above))) => {
                let said = format!(
                    "line {}: part {at}: column {heading:?} says that the row belongs to \"part {above}\"",
                    at + 2
                );
                prop_assert!(error.to_string().starts_with(&said), "{}{}", text, error);
            }
            (found, expected) => prop_assert!(false, "{}{:?} {:?}", text, found, expected),
        }
        Ok(())
    }

    /// Cells that say nothing, or something else than levels.
    #[test]
    fn other_cells_are_no_levels() {
        for (heading, cells, is_refused) in [
            ("Indent", [">", ">>", ">>", ">"], true),
            ("Indent", ["", "-", "-", ""], false),
            ("Indent", ["", "--", "", "--"], false),
            ("Indent", ["", ">", ">", ""], true),
            ("Level", ["1", "2", "2", "-"], true),
            ("Level", ["A", "B", "B", "A"], false),
            ("Level", ["2", "2", "1", "1"], false),
            ("Level", ["1.", "..2", "..2", "1"], true),
            ("Level", ["-1", "0", "1", "2"], false),
            ("Level", ["1", "1.5", "2.5", "2"], true),
            ("Level", ["0.5", "1.5", "2.5", "1.5"], false),
            ("Level", ["high", "low", "low", "high"], false),
            ("Item no.", ["1", "2", "3", "4"], false),
            ("WBS", ["1.2", "1.2.3", "1.2.3", "1.2.4"], false),
            ("WBS", ["1.2", "", "NA", "1.2.4"], true),
            ("WBS", ["SYS", "SYS.BUS", "SYS.BUS.TANK", "SYS.PAY"], true),
            ("Item", ["Cube", "Cube.001", "Cube.002", "Cube.003"], false),
            ("Item", ["Motor", "Motor.cover", "Tank", "Tank.1"], false),
            ("Item", ["Wheel1", "Wheel1.2", "12", "13"], false),
            ("Item", ["A", "A.1", "B", "B.2"], true),
            ("Item", ["1", "1.1", "2", "2.1"], true),
        ] {
            let mut text = format!("{heading},name,mass,Cx,Cy,Cz,Ixx,Iyy,Izz\n");
            for (at, cell) in cells.iter().enumerate() {
                text += &format!("{cell},part {at},1,0,0,0,1,1,1\n");
            }
            assert_eq!(read(&text).is_err(), is_refused, "{heading} {cells:?}");
        }
    }
}
