//! The shape of a row of a list of parts.

use gyradius_inertia::Shape;
use serde_json::{Map, Value};

use super::error::PartsProblem;
use super::heading::{Column, Heading};
use super::row::{Cells, boolean};
use crate::body::{Number, shortened};
use crate::rows::is_blank;

impl Cells<'_> {
    /// The shape, if there is one: none of a point.
    pub(super) fn shape(&self) -> Result<Option<Option<Shape>>, PartsProblem> {
        let point = self.text(Column::Point);
        let is_point = point.map(|word| boolean("point", word)).transpose()?;
        let Some(name) = self.text(Column::Shape) else {
            let is_point = is_point.unwrap_or_default();
            let what = if is_point { "the row is a point" } else { "the row has no shape" };
            return self.without_sizes(what).map(|()| is_point.then_some(None));
        };
        let spelled = name;
        let name = name.to_lowercase().replace([' ', '-'], "_");
        if let Some(word) = point.filter(|_| is_point.is_some_and(|is| is != (name == "point"))) {
            let [first, second] = [("shape", spelled), ("point", word)]
                .map(|(field, word)| format!("{field} = {:?}", shortened(word)));
            return Err(PartsProblem::Contradiction { first, second });
        }
        if name == "point" {
            return self.without_sizes("the row is a point").map(|()| Some(None));
        }
        let mut table = Map::new();
        table.insert("shape".to_owned(), Value::from(name));
        let of = |heading: &Heading| match heading {
            Heading::Size(size, unit) => Some((*size, unit.unwrap_or(1.0))),
            _ => None,
        };
        for ((size, si), cell) in self.given(of) {
            let mut numbers = Vec::new();
            for word in numbers_of(cell) {
                let number = Number::parse(size, word, None)?.value;
                numbers.push(Value::from(number * si));
            }
            let one = numbers.len() == 1;
            let value = if one { numbers.remove(0) } else { Value::from(numbers) };
            table.insert(size.to_owned(), value);
        }
        let shape: Result<Shape, _> = serde_json::from_value(Value::Object(table));
        shape.map(|shape| Some(Some(shape))).map_err(|error| {
            // A point is none of the shapes, which have a volume or a surface.
            let mut message = error.to_string();
            if message.starts_with("unknown variant") {
                message = message.replacen("expected one of ", "expected one of `point`, ", 1);
            }
            // Of a number in place of several, and the other way round, the message does not say which size it is.
            let is_several = message.contains("array of length");
            if is_several || message.contains("sequence") {
                let given = self.given(of).map(|((size, _), cell)| format!("{size} = {cell:?}"));
                let given: Vec<String> = given.collect();
                message += "; given are ";
                message += &given.join(", ");
            }
            if is_several {
                message += ", and a size of several numbers has them all in one cell, as `1 1 2`";
            }
            PartsProblem::Shape { message }
        })
    }

    /// That a row which is `what` has no sizes. A program that fills every cell writes zeros, which say nothing here.
    fn without_sizes(&self, what: &'static str) -> Result<(), PartsProblem> {
        let is_zero = |word: &str| word.parse() == Ok(0.0);
        let says_nothing = |cell: &str| {
            is_blank(cell) || (numbers_of(cell).next().is_some() && numbers_of(cell).all(is_zero))
        };
        let mut cells = self.columns.with(self.cells);
        let found = cells
            .find(|((column, _), cell)| matches!(column, Heading::Size(..)) && !says_nothing(cell));
        found.map_or(Ok(()), |((_, heading), cell)| {
            let (heading, value) = (shortened(heading), shortened(cell));
            Err(PartsProblem::Size { heading, value, what })
        })
    }
}

/// The numbers of a size, of which a cell may have several.
fn numbers_of(cell: &str) -> impl Iterator<Item = &str> {
    cell.split([' ', '×', ';', '/']).filter(|word| !word.is_empty())
}
