//! Units that a line above the header of a table states for all columns, of which none is read.

use crate::{FileProblem, body::shortened, error::Refusal, spread::words, text::Text};

/// Words that say that a line is on units.
const UNITS: [&str; 7] = ["unit", "units", "einheit", "einheiten", "unité", "unités", "unidades"];

/// Units that are not of SI and are no other words, as `in` and `t` are.
const OTHERS: [&str; 16] = [
    "lb", "lbs", "lbm", "lbf", "slug", "slugs", "inch", "inches", "ft", "feet", "mm", "cm", "mg",
    "oz", "pounds", "imperial",
];

/// Why a table is refused that has columns without units, if a line above its header, a title or a comment, says that units are others than
/// those of SI.
pub(crate) fn refused(text: &Text, header: usize, some_lack: bool) -> Result<(), Refusal> {
    let above = text.as_str().get(..header).unwrap_or_default();
    let mut at = 0;
    for line in above.split_inclusive('\n').filter(|_| some_lack) {
        let start = at;
        at += line.len();
        if speaks_of_others(line) {
            let said = shortened(line.trim());
            return Err(text.refuse(start, FileProblem::TitleUnits { said }));
        }
    }
    Ok(())
}

fn speaks_of_others(line: &str) -> bool {
    // Longer lines are no titles.
    if line.len() > 500 {
        return false;
    }
    let lower = line.to_lowercase().replace(['²', '³'], "2");
    let all = || words(&lower).map(|word| word.trim_end_matches(|c: char| c.is_ascii_digit()));
    all().any(|word| UNITS.contains(&word)) && all().any(|word| OTHERS.contains(&word))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_on_other_units_are_told_from_titles() {
        for unit in OTHERS {
            for line in [
                format!("All units: {unit}, in, lb-in2"),
                format!("# Units = {unit}"),
                format!("Einheiten: kg, {unit}, kg {unit}²"),
                format!("\"Mass properties (units {}2)\"", unit.to_uppercase()),
            ] {
                assert!(speaks_of_others(&line), "{line}");
            }
            assert!(!speaks_of_others(&format!("Panel {unit}")));
        }
        for line in ["All units in SI", "units: kg, m, kg m2", "Unit FM-1", "Mass in lb", ""] {
            assert!(!speaks_of_others(line), "{line}");
        }
    }
}
