//! Numbers in cells, as other programs write them.

use crate::csv_lines::is_error;

/// What stands in a cell that has no number, in small letters.
const MISSING: [&str; 7] = ["", "nan", "na", "n/a", "null", "none", "-"];

/// What stands in a cell: a number, or nothing; none if it is something else.
pub(super) fn number(cell: &str) -> Option<Option<f64>> {
    if let Ok(number) = cell.parse::<f64>() {
        return Some(Some(number).filter(|x| !x.is_nan()));
    }
    let small = cell.to_ascii_lowercase();
    match small.as_str() {
        "true" => Some(Some(1.0)),
        "false" => Some(Some(0.0)),
        other => (MISSING.contains(&other) || is_error(other.as_bytes())).then_some(None),
    }
}

/// What is said beside a cell that is no number: of one with a comma why.
pub(super) fn hint(cell: &str) -> &'static str {
    if cell.contains(',') && cell.replace([',', '.'], "").parse::<f64>().is_ok() {
        ": commas are not read in numbers, neither before decimals nor between thousands: a point must stand before decimals"
    } else {
        ""
    }
}
