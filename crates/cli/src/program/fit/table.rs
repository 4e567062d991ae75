//! A table of samples as inertias.

use gyradius_formats::{Body, BodyError, FileError, InertiaFile, Products, TOLERANCE, judge};
use gyradius_inertia::{Inertia, InertiaMatrix, Repair, RepairMethod};
use std::path::Path;

/// Why a table is not fitted.
#[derive(Debug, thiserror::Error)]
pub(super) enum TableError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{place}: {error}")]
    Row { place: String, error: BodyError },
    #[error(
        "{place}: {reason}\n(sample {index}; {more}--skip-impossible sets such samples aside, \
         `gyradius check` lists them)"
    )]
    Impossible { place: String, index: usize, reason: String, more: String },
}

/// The samples of a file.
#[derive(Debug)]
pub(super) struct Table {
    pub(super) samples: Vec<Inertia>,
    /// Samples that no body has, set aside.
    pub(super) aside: usize,
    /// Samples moved onto the boundary, which they had left by the rounding of their digits.
    pub(super) rounded: usize,
}

pub(super) fn read(path: &Path, products: Products, skip: bool) -> Result<Table, TableError> {
    let file = InertiaFile::read(path, products)?;
    let place = path.display().to_string();
    let mut table =
        Table { samples: Vec::with_capacity(file.bodies().len()), aside: 0, rounded: 0 };
    let mut refused: Option<(usize, &Body, String)> = None;
    for (index, body) in file.bodies().iter().enumerate() {
        let at = || format!("{place}:{}", body.line());
        let matrix = *body
            .inertia()
            .map_err(|error| TableError::Row { place: at(), error: error.clone() })?;
        if let Some(fault) = judge(&matrix, None, TOLERANCE).report().faults().first() {
            table.aside += 1;
            refused.get_or_insert((index + 1, body, fault.to_string()));
            continue;
        }
        match Inertia::new(matrix) {
            Ok(inertia) => table.samples.push(inertia),
            Err(_) => {
                let nearest = InertiaMatrix::new(matrix)
                    .ok()
                    .and_then(|matrix| Repair::new(&matrix, RepairMethod::Nearest).ok());
                if let Some(repair) = nearest {
                    table.samples.push(*repair.inertia());
                    table.rounded += 1;
                } else {
                    table.aside += 1;
                    refused.get_or_insert((index + 1, body, "out of range".to_owned()));
                }
            }
        }
    }
    match refused {
        Some((index, body, reason)) if !skip => {
            let more = match table.aside {
                1 => String::new(),
                n => format!("and {} more; ", n - 1),
            };
            let reason = format!("no body has this inertia: {reason}");
            Err(TableError::Impossible {
                place: format!("{place}:{}", body.line()),
                index,
                reason,
                more,
            })
        }
        _ => Ok(table),
    }
}
