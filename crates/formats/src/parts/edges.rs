//! The second table of a list of parts, which says what belongs to what.

use std::collections::BTreeMap;

use super::columns::PartColumns;
use super::error::{PartsError, PartsProblem};
use super::header::{cell, line_of, next, written};
use super::row::Cells;
use crate::{
    FileBodyError, FileProblem, body::shortened, error::Refusal, rows::Rows,
    table_terms::TableTerms, text::Text,
};

/// A table of what belongs to what.
pub(super) struct Edges {
    /// Line, child and parent of each row.
    pub(super) edges: Vec<(usize, String, String)>,
    pub(super) passed_over: Vec<String>,
}

impl Edges {
    pub(super) fn of(bytes: &[u8]) -> Result<Self, PartsError> {
        let text = Text::new(bytes, true)?;
        let mut rows = Rows::new(text.as_str());
        let Some(first) = next(&text, &mut rows)? else {
            return Err(Refusal::from(FileProblem::Empty).into());
        };
        let headings: Vec<String> = first.iter().map(|field| cell(&text, field)).collect();
        let place = |column: &'static str| {
            let refused = |problem| PartsError::new(line_of(&text, &first), None, problem);
            let is_it = |(at, heading): (usize, &String)| {
                (heading.to_lowercase() == column).then_some((at, shortened(heading)))
            };
            let mut found = headings.iter().enumerate().filter_map(is_it);
            match (found.next(), found.next()) {
                (None, _) => Err(refused(PartsProblem::NoColumn { column })),
                (Some((_, first)), Some((_, second))) => {
                    Err(refused(PartsProblem::Columns { first, second }))
                }
                (Some((at, _)), None) => Ok(at),
            }
        };
        let places = [("child", place("child")?), ("parent", place("parent")?)];
        let is_other = |(at, heading): (usize, &String)| {
            places.iter().all(|(_, place)| *place != at).then(|| shortened(heading))
        };
        let passed_over = headings.iter().enumerate().filter_map(is_other).collect();
        let columns = PartColumns::unread(headings, passed_over);
        let terms = TableTerms::default();
        let mut edges = Vec::new();
        let mut lines: BTreeMap<(String, String), usize> = BTreeMap::new();
        while let Some(fields) = next(&text, &mut rows)? {
            let line = line_of(&text, &fields);
            let refused = |problem| PartsError::new(line, None, problem);
            let (found, allowed) = (fields.len(), columns.headings.len());
            if found != allowed {
                let problem = FileBodyError::Count { field: "the row", found, allowed }.into();
                return Err(refused(problem));
            }
            let of = |(field, place): (&'static str, usize)| {
                let found = fields.get(place).map(|field| cell(&text, field));
                let missing = || refused(FileBodyError::Missing { field }.into());
                found.filter(|name| !name.is_empty()).ok_or_else(missing)
            };
            let (child, parent) = (of(places[0])?, of(places[1])?);
            // A child that stands four times, or has a 4 beside it, is meant to be there four times.
            let cells: Vec<String> = fields.iter().map(|field| written(&text, field)).collect();
            let row = Cells {
                columns: &columns,
                cells: &cells,
                stated: None,
                products: None,
                terms: &terms,
            };
            if let Some(problem) = row.unread().or_else(|| row.not_known(false, false)) {
                return Err(PartsError::new(line, Some(&child), problem));
            }
            if let Some(first) = lines.insert((child.clone(), parent.clone()), line) {
                return Err(refused(PartsProblem::EdgeTwice { child, parent, first }));
            }
            edges.push((line, child, parent));
        }
        Ok(Self { edges, passed_over: columns.passed_over })
    }
}
