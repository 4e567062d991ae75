//! Lists of parts with a column of levels, as those of drawings have: a row belongs to the last one above it that is a level higher.

use super::error::PartsProblem;
use super::row::PartRow;
use crate::{body::shortened, spread::parted, spread::words};

/// Words for a level, and what may stand beside them. With any other word, it is a level of something else.
const LEVELS: [&str; 7] = ["level", "lvl", "indent", "indenture", "indentation", "ebene", "stufe"];
const BESIDE: [&str; 10] =
    ["bom", "assembly", "assy", "wbs", "product", "structure", "tree", "part", "item", "hierarchy"];

/// The column of levels, and what its cells say so far.
#[derive(Debug)]
pub(super) struct Levels {
    place: usize,
    heading: String,
    /// Levels, from the first row down to the last one, with the names of those that have numbers.
    open: Vec<(u32, Option<String>)>,
    /// Whether all cells so far are levels of a tree: the first is the highest, and none is more than one below that of the row before.
    is_tree: bool,
}

impl Levels {
    /// The column of levels, if there is one.
    pub(super) fn of(headings: &[String]) -> Option<Self> {
        let is_of_levels = |heading: &String| {
            let parted = parted(heading);
            let all: Vec<&str> = words(&parted).filter(|word| !word.is_empty()).collect();
            all.iter().any(|word| LEVELS.contains(word))
                && all.iter().all(|word| LEVELS.contains(word) || BESIDE.contains(word))
        };
        let place = headings.iter().position(is_of_levels)?;
        let heading = shortened(&headings[place]);
        Some(Self { place, heading, open: Vec::new(), is_tree: true })
    }

    /// The next row; why it is refused, if it has numbers and belongs to one that has some, too.
    pub(super) fn add(&mut self, row: &PartRow, cells: &[String]) -> Option<PartsProblem> {
        // Some write a point for each level: `..2`.
        let level = cells.get(self.place)?.trim_start_matches(['.', ' ']).parse::<u32>().ok();
        let [first, last] = [self.open.first(), self.open.last()].map(|row| row.map(|(at, _)| *at));
        let is_next = |level: &u32| {
            let below_last = last.is_none_or(|last| *level <= last.saturating_add(1));
            first.is_none_or(|first| *level >= first) && below_last
        };
        let Some(level) = level.filter(is_next) else {
            self.is_tree = false;
            return None;
        };
        self.open.retain(|(above, _)| *above < level);
        let has_numbers = row.numbers().is_some();
        let above = self.open.iter().rev().find_map(|(_, name)| name.clone());
        self.open.push((level, has_numbers.then(|| row.name().to_owned())));
        let above = above.filter(|_| has_numbers && self.is_tree)?;
        Some(PartsProblem::Level { heading: self.heading.clone(), above: shortened(&above) })
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::read;
    use proptest::prelude::*;

    proptest! {
        /// A row with numbers that belongs to another one with numbers, by its level, is refused, and no other is. Where the levels are those of no tree,
        /// they may be anything.
        #[test]
        fn no_row_is_a_part_of_another(
            rows in prop::collection::vec((0_u32..4, any::<bool>()), 1..12),
            heading in prop::sample::select(vec!["Level", "BOM level", "Indent", "Level of detail", "stress level"]),
            (points, has_parents) in any::<(bool, bool)>(),
        ) {
            let names = |at: usize| format!("part {at}");
            let mut text = format!("{heading},name,mass,Cx,Cy,Cz,Ixx,Iyy,Izz{}\n", if has_parents { ",parent" } else { "" });
            for (at, (level, has_numbers)) in rows.iter().enumerate() {
                let level = if points { ".".repeat(*level as usize) + &level.to_string() } else { level.to_string() };
                let numbers = if *has_numbers { "1,0,0,0,1,1,1" } else { ",,,,,," };
                text += &format!("{level},{},{numbers}{}\n", names(at), if has_parents { "," } else { "" });
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
            let is_level = !heading.contains("of") && !heading.contains("stress") && !has_parents;
            let expected = (0..rows.len())
                .find_map(|at| Some((at, belongs(at).filter(|_| rows[at].1 && is_tree(at) && is_level)?)));
            match (read(&text), expected) {
                (Ok(_), None) => {}
                (Err(error), Some((at, above))) => {
                    let said = format!("line {}: {}: column {heading:?} says that the row belongs to {:?}", at + 2, names(at), names(above));
                    prop_assert!(error.to_string().starts_with(&said), "{}{}", text, error);
                }
                (found, expected) => prop_assert!(false, "{}{:?} {:?}", text, found, expected),
            }
        }
    }
}
