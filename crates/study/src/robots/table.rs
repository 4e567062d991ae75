//! The draws of all links as one table.

use gyradius_campaign::{Cell, Column, Extent, Kind, Progress, Table, TableFormat, go_on, threads};
use gyradius_dispersion::TenParameters;
use rayon::prelude::*;
use std::io::Write;

use super::{RobotDraw, RobotDrawError, drawn_link::DrawnLink};

/// Draws of a block.
const BLOCK: u64 = 1 << 14;

impl RobotDraw<'_> {
    /// How many rows [`write_table`](Self::write_table) draws, twice if the form needs that.
    #[must_use]
    pub fn steps(&self, format: TableFormat) -> u64 {
        let rows = self.options.draws.saturating_mul(self.links.len() as u64);
        rows.saturating_mul(1 + u64::from(format.needs_extent()))
    }

    /// Writes a row for each link and draw: `link`, `draw`, and the ten numbers of
    /// [`TenParameters`], the mass centre in the frame of the link and the inertia about the mass centre in axes
    /// parallel to the link's. All draws of the first link come first. The same bytes on any number of threads, in
    /// memory that does not grow with the draws.
    ///
    /// # Errors
    /// The threads cannot be started, it was told to stop, or the output refuses.
    pub fn write_table(
        &self,
        format: TableFormat,
        output: impl Write + Send,
        progress: Progress<'_>,
    ) -> Result<(), RobotDrawError> {
        let empty = Table::of_draws("", heads(), columns())?;
        threads(self.options.threads)?.install(|| {
            let mut done = 0;
            let mut extent = Extent::default();
            if format.needs_extent() {
                self.each(&empty, &mut done, progress, |table| {
                    extent.add(table);
                    Ok(())
                })?;
            }
            let mut writer = format.writer(&empty, &extent, output)?;
            self.each(&empty, &mut done, progress, |table| Ok(writer.write(table)?))?;
            Ok(writer.finish()?)
        })
    }

    fn each(
        &self,
        empty: &Table,
        done: &mut u64,
        progress: Progress<'_>,
        mut take: impl FnMut(&Table) -> Result<(), RobotDrawError>,
    ) -> Result<(), RobotDrawError> {
        let end = self.options.first + self.options.draws;
        for link in &self.links {
            let mut first = self.options.first;
            while first < end {
                go_on(self.options.stop.as_deref())?;
                let last = end.min(first.saturating_add(BLOCK));
                take(&link.table(empty, first, last)?)?;
                *done += last - first;
                progress(*done);
                first = last;
            }
        }
        Ok(())
    }
}

impl DrawnLink {
    fn table(&self, empty: &Table, first: u64, last: u64) -> Result<Table, RobotDrawError> {
        let drawn: Vec<[f64; 10]> = (first..last)
            .into_par_iter()
            .map(|draw| TenParameters::from(self.body(draw)).values())
            .collect();
        let mut table = empty.from_draw(&self.name, first);
        for ten in drawn {
            table.push(None, ten.map(Cell::Number))?;
        }
        Ok(table)
    }
}

fn heads() -> [Column; 2] {
    [
        Column::new("link", Kind::Text, "Name of the link.").required(),
        Column::new("draw", Kind::Integer, "Number of the draw, from 0.").required(),
    ]
}

fn columns() -> Vec<Column> {
    let unit = |place: usize| match place {
        0 => "kg",
        1..=3 => "m",
        4.. => "kg·m²",
    };
    let meaning = |place: usize| match place {
        0 => "Mass of the link.",
        1..=3 => "Mass centre, in the frame of the link.",
        4.. => {
            "Inertia about the mass centre, in axes parallel to the link's; products are tensor entries."
        }
    };
    let column = |(place, name)| Column::number(name, unit(place), meaning(place)).required();
    TenParameters::COLUMNS.into_iter().enumerate().map(column).collect()
}
