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

/// Whether a name speaks of a sum, and may be that of a part all the same: `Bus subtotal`, `total pressure sensor`.
pub(crate) fn speaks_of_sums(name: &str) -> bool {
    const SUMS: [&str; 11] = [
        "total",
        "totals",
        "subtotal",
        "subtotals",
        "sum",
        "average",
        "mean",
        "gesamt",
        "totale",
        "somme",
        "mass",
    ];
    let lower = name.to_lowercase();
    lower.split(|c: char| !c.is_alphanumeric()).any(|word| SUMS.contains(&word))
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
}
