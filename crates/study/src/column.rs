//! The columns of a separation's run table, each declared in one place: its name and its order, what it means and
//! what a run writes into it.

use gyradius_campaign::{Cell, Column as RunColumn, Kind, Table};
use gyradius_separation::Separation;
use nalgebra::{Quaternion, UnitQuaternion};

use crate::{
    Fleet,
    body::Body,
    quantity::Quantity,
    run::{End, Run},
    scenario::Scenario,
};

/// A column of the run table, after `model`, `run` and `status`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Column {
    /// Which vehicle the run is of, and then which of its flights.
    Place(usize),
    Number(Quantity),
    Realizable,
    /// A component of the attitude of a body's principal axes, scalar last.
    Axes(Body, usize),
    ReleaseOrder,
    Recompressed,
    /// What else was drawn, by its place.
    Drawn(usize),
    ClearanceNote,
}

pub(crate) const REALIZABLE: &str = "realizable";
pub(crate) const RELEASE_ORDER: &str = "release_order";
pub(crate) const RECOMPRESSED: &str = "recompressed";
pub(crate) const CLEARANCE_NOTE: &str = "clearance_note";

impl Column {
    /// All columns of a scenario, in order.
    pub(crate) fn of(scenario: &Scenario) -> Vec<Self> {
        let drawn = scenario.dispersions().all().len();
        Self::all(scenario.separation(), scenario.fleet().is_some(), drawn)
    }

    /// All columns, in order, of a separation by such loads, of vehicles or not, in which so much else is drawn.
    fn all(separation: &Separation, vehicles: bool, drawn: usize) -> Vec<Self> {
        let mut columns = Vec::new();
        if vehicles {
            columns.extend([0, 1].map(Self::Place));
        }
        for quantity in Quantity::of(separation) {
            columns.push(Self::Number(quantity));
            if quantity == Quantity::LAST_BEFORE_REALIZABLE {
                columns.push(Self::Realizable);
                let axes = |b: Body| (0..4).map(move |i| Self::Axes(b, i));
                columns.extend(Body::BOTH.into_iter().flat_map(axes));
            }
        }
        columns.extend([Self::ReleaseOrder, Self::Recompressed]);
        columns.extend((0..drawn).map(Self::Drawn));
        columns.push(Self::ClearanceNote);
        columns
    }

    /// What it is called, holds and means; `drawn` are the names of what else is drawn.
    pub(crate) fn declaration(self, drawn: &[String]) -> RunColumn {
        use Kind::{Flag, Number, Text};
        match self {
            Self::Place(i) => Fleet::columns()[i].clone(),
            Self::Number(q) => RunColumn::number(q.column(), q.unit(), q.meaning()),
            Self::Realizable => {
                let meaning = "Whether the inertias of both bodies are realizable.";
                RunColumn::new(REALIZABLE, Flag, meaning).required()
            }
            Self::Axes(body, i) => RunColumn::new(
                axes_name(body, i),
                Number,
                "Component of the attitude of the body's principal axes as drawn, which takes body components to principal \
                 ones, scalar last; none for entrywise models.",
            ),
            Self::ReleaseOrder => RunColumn::new(
                RELEASE_ORDER,
                Text,
                "Springs from 1 in the order of release, `+` between those that let go together, as in \
                 `1 2 3+4`; without those that never push.",
            ),
            Self::Recompressed => RunColumn::new(
                RECOMPRESSED,
                Text,
                "Springs from 1 that were pressed below their release length after their release, while \
                 others still pushed or had yet to start; none if there is no such spring.",
            ),
            Self::Drawn(i) => {
                let name = drawn.get(i).cloned().unwrap_or_default();
                RunColumn::new(name, Number, "What else is dispersed, as drawn.")
            }
            Self::ClearanceNote => RunColumn::new(
                CLEARANCE_NOTE,
                Text,
                "Why there is no clearance (all outlines are mated; the search failed), or not one of the \
                 whole coast (a body turns too far to be followed), or that it is not proven, or not proven that the bodies \
                 stay apart before the last release (the search was given up), or that the outlines come nearer before the last release, or that some are mated and do not \
                 part; all that hold, with `; ` between them; none if there is nothing to say.",
            )
            .with_kinds(),
        }
    }

    /// What such columns of a scenario are called, hold and mean.
    pub(crate) fn declarations(columns: &[Self], scenario: &Scenario) -> Vec<RunColumn> {
        let names = scenario.dispersions().columns();
        columns.iter().map(|column| column.declaration(&names)).collect()
    }

    /// Whether it tells what is drawn, so that a run has it before it is separated.
    pub(crate) fn is_drawn(self) -> bool {
        match self {
            Self::Number(quantity) => quantity.is_drawn(),
            Self::Place(_) | Self::Realizable | Self::Axes(..) | Self::Drawn(_) => true,
            Self::ReleaseOrder | Self::Recompressed | Self::ClearanceNote => false,
        }
    }

    /// Whether it is a number or a flag that comes of a run: the flag that follows from what is drawn is one, too.
    pub(crate) fn is_outcome(self) -> bool {
        match self {
            Self::Number(quantity) => !quantity.is_drawn(),
            Self::Realizable => true,
            Self::Place(_)
            | Self::Axes(..)
            | Self::Drawn(_)
            | Self::ReleaseOrder
            | Self::Recompressed
            | Self::ClearanceNote => false,
        }
    }

    /// What a run writes into it.
    pub(crate) fn cell(self, run: &Run<'_>) -> Cell<'static> {
        let text = |text: Option<String>| text.map_or(Cell::Null, |text| Cell::Text(text.into()));
        match self {
            Self::Place(i) => run.case.flight.map_or(Cell::Null, |place| Cell::Integer(place[i])),
            Self::Number(quantity) => quantity.value(run).into(),
            Self::Realizable => run.realizable().into(),
            Self::Axes(body, i) => run.axes(body).map(|q| q.coords[i]).into(),
            Self::ReleaseOrder => text(run.end().map(End::release_order)),
            Self::Recompressed => {
                text(run.end().map(End::recompressed).filter(|loads| !loads.is_empty()))
            }
            Self::Drawn(i) => run.case.drawn.get(i).copied().into(),
            Self::ClearanceNote => {
                let notes = run.end().map(End::clearance_notes).unwrap_or_default();
                if notes.is_empty() {
                    return Cell::Null;
                }
                let kinds: Vec<_> = notes.iter().map(|note| note.kind()).collect();
                let texts: Vec<_> = notes.iter().map(ToString::to_string).collect();
                Cell::Note { kind: kinds.join("; ").into(), text: texts.join("; ").into() }
            }
        }
    }
}

fn axes_name(body: Body, component: usize) -> String {
    format!("{}_q{}", body.name(), component + 1)
}

/// The attitudes of the principal axes of a body as drawn, each with its run, of the runs that have one.
pub(crate) fn attitudes(table: &Table, body: Body) -> Vec<(u64, UnitQuaternion<f64>)> {
    let Some(components) =
        (0..4).map(|i| table.numbers(&axes_name(body, i))).collect::<Option<Vec<_>>>()
    else {
        return Vec::new();
    };
    let attitude = |place: usize| {
        let [x, y, z, w] = [0, 1, 2, 3].map(|c: usize| components[c].get(place));
        let attitude = UnitQuaternion::new_unchecked(Quaternion::new(w?, x?, y?, z?));
        Some((table.first() + place as u64, attitude))
    };
    (0..table.len()).filter_map(attitude).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scenario;
    use gyradius_separation::{Load, LoadId, Spring};
    use std::fmt::Write;

    /// The page of the run table, from the declarations.
    fn page() -> String {
        let drawn = ["payload_mass_kg".to_owned()];
        let mut page = "# The run table\n\n\
            `runs/<model>/` holds one row a run, in Parquet files that are named by their first and last runs; pandas, polars and\n\
            DuckDB open the folder as one table, in run order. A half-written Parquet file is refused by readers; half a\n\
            CSV is read without a word. What a failed run has drawn is there, and its outcomes are null, except for an infinite\n\
            answer of a [simulator](simulators.md#what-can-go-wrong); so is every number that has no\n\
            meaning for a run. Numbers are stored bit for bit. They are not compressed, because hardly anything would be gained: of the 63 columns of\n\
            numbers of the built-in study, 467 bytes a run, LZ4 would leave 391 and zstd 380, both with the bytes of the numbers\n\
            split into streams (measured with pyarrow 26). [What to keep](study.md#keeping-less) saves more.\n\n\
            Each spring has a `spring_…_release_s`, springs from 1. In the place of `payload_mass_kg` stands what else is\n\
            [dispersed](scenario.md#what-else-is-uncertain), in that order; if nothing else is dispersed, the column is not there. The outcomes are explained in\n\
            [separation](models/separation.md), equation numbers are those of Peck (2003).\n\n\
            | column | unit | |\n|---|---|---|\n"
            .to_owned();
        let mut own = Column::all(Scenario::peck_2003().unwrap().separation(), true, 1);
        // Of all springs the first.
        let first = LoadId { kind: Spring::KIND, number: 0 };
        own.retain(
            |column| !matches!(column, Column::Number(Quantity::Release(load)) if *load != first),
        );
        let own = own.into_iter().map(|column| column.declaration(&drawn));
        let table = Table::new("", 0, own.collect()).unwrap();
        for column in table.columns() {
            let unit = column.unit().unwrap_or_default();
            writeln!(page, "| `{}` | {unit} | {} |", column.name(), column.meaning()).unwrap();
        }
        page
    }

    /// Run with `WRITE_PAGE` set to write it anew.
    #[test]
    fn the_page_lists_every_column() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/run-table.md");
        if std::env::var_os("WRITE_PAGE").is_some() {
            std::fs::write(path, page()).unwrap();
        }
        assert_eq!(std::fs::read_to_string(path).unwrap(), page());
    }
}
