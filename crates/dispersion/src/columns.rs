//! Six columns of one length, which draws are written into.

/// The length that all columns have.
pub(crate) fn common_length(columns: &[&mut [f64]; 6]) -> Result<usize, ColumnsError> {
    let length = columns[0].len();
    match columns.iter().map(|c| c.len()).find(|n| *n != length) {
        Some(other) => Err(ColumnsError { lengths: [length, other] }),
        None => Ok(length),
    }
}

/// The columns are not equally long.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("columns of {} and {} numbers: all six must be equally long", .lengths[0], .lengths[1])]
pub struct ColumnsError {
    /// Two lengths that differ.
    pub lengths: [usize; 2],
}
