//! Rows of a table that sum up others, and are no body of their own: a total, an average.

/// What such a row is called, in words of its name.
const KEYS: [&str; 21] = [
    "total",
    "totals",
    "subtotal",
    "subtotals",
    "sum",
    "sums",
    "σ",
    "average",
    "averages",
    "avg",
    "mean",
    "median",
    "stdev",
    "stddev",
    "std",
    "minimum",
    "maximum",
    "min",
    "max",
    "summe",
    "mittelwert",
];

/// What stands beside it: of a part that is called otherwise, a name has other words.
const BESIDE: [&str; 22] = [
    "grand",
    "sub",
    "of",
    "all",
    "the",
    "mass",
    "masses",
    "dry",
    "wet",
    "launch",
    "value",
    "values",
    "parts",
    "bodies",
    "samples",
    "rows",
    "above",
    "standard",
    "dev",
    "deviation",
    "kg",
    "overall",
];

/// Whether a cell is the name of a row that sums up others.
pub(crate) fn is_summary(cell: &str) -> bool {
    // Longer texts are none.
    if cell.len() > 100 {
        return false;
    }
    let plain = cell.to_lowercase().replace('∑', "σ");
    let words = || plain.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    let is_key = |word: &str| KEYS.contains(&word);
    let deviation = plain.trim() == "standard deviation";
    deviation || words().any(is_key) && words().all(|word| is_key(word) || BESIDE.contains(&word))
}

/// How many rows the row of a name must have the sum of, at least, to be taken for that sum, if the name speaks of one. Two rows, as
/// it may be that of a part all the same, `total pressure sensor`; one, where it can be nothing else: `Bus subtotal`, `Sum of a`.
pub(crate) fn least_summed(name: &str) -> Option<usize> {
    const SUMS: [&str; 10] = [
        "total",
        "totals",
        "subtotal",
        "subtotals",
        "sum",
        "sums",
        "gesamt",
        "summe",
        "totale",
        "somme",
    ];
    const OTHERS: [&str; 3] = ["average", "mean", "mass"];
    const OF: [&str; 4] = ["of", "for", "von", "de"];
    let lower = name.to_lowercase();
    let words = || lower.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    if !words().any(|word| SUMS.contains(&word) || OTHERS.contains(&word)) {
        return None;
    }
    // `Total dry mass of the bus`, `Bus total mass (kg)`.
    let told: Vec<&str> =
        words().filter(|word| OF.contains(word) || !BESIDE.contains(word)).collect();
    let is_sum = |(at, word): (usize, &&str)| {
        let next = told.get(at + 1);
        let is_whole = word.starts_with("subtotal");
        SUMS.contains(word) && (is_whole || next.is_none_or(|next| OF.contains(next)))
    };
    Some(if told.iter().enumerate().any(is_sum) { 1 } else { 2 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_sums_are_told_from_those_of_parts() {
        for name in [
            "Total",
            "TOTAL:",
            "Grand total",
            "Sub-total",
            "Total mass (kg)",
            "Sum",
            "Σ",
            "∑",
            "Average",
            "std dev",
            "Standard deviation",
            "total of all parts",
            "Mean value",
            "Max",
            "TOTAL DRY MASS",
        ] {
            assert!(is_summary(name), "{name}");
        }
        for name in [
            "",
            "12",
            "total station",
            "sump",
            "Max-Q sensor",
            "mass",
            "dry mass",
            "meander line",
            "bus",
            "Summer",
            "average joe",
            "launch adapter",
            "standard",
            "dev",
            "totaliser",
            "mean 3 antenna",
        ] {
            assert!(!is_summary(name), "{name}");
        }
        assert!(!is_summary(&"total ".repeat(50)));
    }

    #[test]
    fn names_that_can_only_be_sums_are_told_from_others() {
        for part in ["a", "bus", "Bus 2", "solar array", "tank (full)"] {
            for name in [
                format!("{part} subtotal"),
                format!("Subtotal {part}"),
                format!("Sub-total of {part}"),
                format!("Sum of {part}"),
                format!("{part} total"),
                format!("{part} TOTAL MASS (kg)"),
                format!("Total for {part}"),
                format!("total dry mass of the {part}"),
                format!("{part}: sum"),
                format!("Summe von {part}"),
            ] {
                assert_eq!(least_summed(&name), Some(1), "{name}");
            }
            for name in [
                format!("total pressure sensor of {part}"),
                format!("sum amplifier, {part}"),
                format!("mean 3 antenna {part}"),
                format!("{part} mass"),
                format!("Total {part}"),
            ] {
                assert_eq!(least_summed(&name), Some(2), "{name}");
            }
            assert_eq!(least_summed(part), None, "{part}");
        }
    }
}
