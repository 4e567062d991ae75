//! Columns of one length, which draws are written into.

/// The length that all columns have.
pub(crate) fn common_length<const N: usize>(
    columns: &[&mut [f64]; N],
) -> Result<usize, ColumnsError> {
    let length = columns.first().map_or(0, |column| column.len());
    match columns.iter().map(|c| c.len()).find(|n| *n != length) {
        Some(other) => Err(ColumnsError { lengths: [length, other] }),
        None => Ok(length),
    }
}

/// The columns are not equally long.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("columns of {} and {} numbers: all must be equally long", .lengths[0], .lengths[1])]
pub struct ColumnsError {
    /// Two lengths that differ.
    pub lengths: [usize; 2],
}
