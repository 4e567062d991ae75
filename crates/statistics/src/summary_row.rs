//! Names of rows of a table that sum up others, and are none of their kind: a total, an average, a percentile.

/// Words that speak of a sum.
const SUMS: [&str; 14] = [
    "total",
    "totals",
    "subtotal",
    "subtotals",
    "sum",
    "sums",
    "gesamt",
    "gesamtmasse",
    "summe",
    "totale",
    "somme",
    "suma",
    "totaal",
    "zwischensumme",
];

/// Words that speak of another number of all rows.
const STATISTICS: [&str; 50] = [
    "σ",
    "sigma",
    "average",
    "averages",
    "avg",
    "mean",
    "median",
    "stdev",
    "stddev",
    "std",
    "sd",
    "variance",
    "rms",
    "rmse",
    "range",
    "minimum",
    "maximum",
    "min",
    "max",
    "count",
    "percentile",
    "percentiles",
    "quantile",
    "quantiles",
    "quartile",
    "quartiles",
    "skewness",
    "kurtosis",
    "confidence",
    "moyenne",
    "médiane",
    "mediane",
    "écart",
    "ecart",
    "étendue",
    "etendue",
    "mittelwert",
    "mittel",
    "durchschnitt",
    "standardabweichung",
    "stabw",
    "varianz",
    "spannweite",
    "anzahl",
    "media",
    "promedio",
    "desviación",
    "desviacion",
    "varianza",
    "deviazione",
];

/// What stands beside it: of a part that is called otherwise, a name has other words.
const BESIDE: [&str; 40] = [
    "grand",
    "sub",
    "of",
    "all",
    "the",
    "mass",
    "masses",
    "masse",
    "dry",
    "wet",
    "launch",
    "value",
    "values",
    "parts",
    "bodies",
    "samples",
    "sample",
    "runs",
    "rows",
    "above",
    "standard",
    "dev",
    "deviation",
    "error",
    "kg",
    "overall",
    "absolute",
    "type",
    "level",
    "interval",
    "lower",
    "upper",
    "population",
    "estándar",
    "estandar",
    "th",
    "st",
    "nd",
    "rd",
    "percent",
];

/// What a number may stand before.
const COUNTED: [&str; 10] = ["σ", "sigma", "sd", "std", "%", "percent", "th", "st", "nd", "rd"];

/// What a number may stand behind.
const COUNTING: [&str; 4] = ["percentile", "quantile", "quartile", "confidence"];

/// Tells among the names in a column, from the first row on, those of rows that sum up others.
///
/// A share alone, such as `95%`, is one of them where the first name of the column is no share: a column of shares says something else.
///
/// ```
/// use gyradius_statistics::SummaryNames;
///
/// let mut names = SummaryNames::default();
/// let found = ["arm", "Total Station", "Mean", "Mean + 3σ", "95%"].map(|name| names.sums_up(name));
/// assert_eq!(found, [false, false, true, true, true]);
/// ```
#[derive(Clone, Debug, Default)]
pub struct SummaryNames {
    /// Whether the first name is a share.
    of_shares: Option<bool>,
}

impl SummaryNames {
    /// Whether the next name is that of a row that sums up others.
    pub fn sums_up(&mut self, name: &str) -> bool {
        let kind = Kind::of(name);
        let of_shares = *self.of_shares.get_or_insert(kind == Kind::Share);
        match kind {
            Kind::Summary => true,
            Kind::Share => !of_shares,
            Kind::Other => false,
        }
    }
}

/// What a name is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// That of a row that sums up others.
    Summary,
    /// A share, which may be a percentile.
    Share,
    /// Any other.
    Other,
}

impl Kind {
    fn of(name: &str) -> Self {
        // Longer texts are none, and numbers are not worth a closer look.
        if name.len() > 100 || !name.contains(|c: char| c.is_alphabetic() || "%∑".contains(c)) {
            return Self::Other;
        }
        let plain = name.to_lowercase().replace('∑', "σ");
        let words = words(&plain);
        let is_key = |word: &str| SUMS.contains(&word) || STATISTICS.contains(&word);
        let is_plain = |(at, word): (usize, &&str)| {
            let next = words.get(at + 1).is_some_and(|next| COUNTED.contains(next));
            let before = at.checked_sub(1).and_then(|at| words.get(at));
            let is_counted = next || before.is_some_and(|before| COUNTING.contains(before));
            let is_share = *word == "%" && before.is_some_and(|before| is_number(before));
            is_key(word) || BESIDE.contains(word) || is_share || is_number(word) && is_counted
        };
        if !words.iter().enumerate().all(is_plain) {
            return Self::Other;
        }
        let has = |some: &[&str]| words.iter().any(|word| some.contains(word));
        let deviation = has(&["standard", "st"]) && has(&["dev", "deviation", "error"]);
        if deviation || words.iter().any(|word| is_key(word)) {
            return Self::Summary;
        }
        if matches!(words.as_slice(), [_, "%"]) { Self::Share } else { Self::Other }
    }
}

/// The words, numbers and per cent signs of a name: `mean+3σ` has three.
fn words(plain: &str) -> Vec<&str> {
    let class = |c: char| match c {
        '0'..='9' | '.' | ',' => 1,
        '%' => 2,
        _ if c.is_alphanumeric() => 3,
        _ => 0,
    };
    let mut words = Vec::new();
    let mut rest = plain;
    while let Some(first) = rest.chars().next() {
        let of = class(first);
        let end = rest.find(|c| class(c) != of).unwrap_or(rest.len());
        let (word, after) = rest.split_at(end);
        // A full stop or a comma alone parts words.
        if of != 0 && word.contains(char::is_alphanumeric) || of == 2 {
            words.push(word);
        }
        rest = after;
    }
    words
}

fn is_number(word: &str) -> bool {
    word.starts_with(|c: char| c.is_ascii_digit() || c == '.' || c == ',')
}

/// How many rows the row of a name must have the sum of, at least, to be taken for that sum, if the name speaks of one. Two rows, as
/// it may be that of a part all the same, `total pressure sensor`; one, where it can be nothing else: `Bus subtotal`, `Sum of a`.
#[must_use]
pub fn least_summed(name: &str) -> Option<usize> {
    const OTHERS: [&str; 4] = ["average", "mean", "mass", "masse"];
    const OF: [&str; 4] = ["of", "for", "von", "de"];
    let lower = name.to_lowercase();
    let words = words(&lower);
    if !words.iter().any(|word| SUMS.contains(word) || OTHERS.contains(word)) {
        return None;
    }
    // `Total dry mass of the bus`, `Bus total mass (kg)`.
    let told: Vec<&str> =
        words.into_iter().filter(|word| OF.contains(word) || !BESIDE.contains(word)).collect();
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

    /// The words of a name in any letters, with what stands beside them and between them, are one name.
    #[test]
    fn each_word_is_a_name_with_what_stands_beside_it() {
        for key in SUMS.into_iter().chain(STATISTICS) {
            for beside in BESIDE.into_iter().chain([""]) {
                for name in [
                    format!("{key} {beside}"),
                    format!("{beside}-{key}:"),
                    format!("{key} ({beside})").to_uppercase(),
                    format!(" {beside}_{key} + 3σ"),
                    format!("{key} - 3 sigma {beside}"),
                ] {
                    assert_eq!(Kind::of(&name), Kind::Summary, "{name}");
                }
                let part = format!("{key} {beside} antenna");
                assert_eq!(Kind::of(&part), Kind::Other, "{part}");
            }
        }
    }

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
            "St. Dev.",
            "Standard deviation",
            "Standard Error",
            "Sample Variance",
            "Confidence Level(95.0%)",
            "total of all parts",
            "Mean value",
            "Max",
            "TOTAL DRY MASS",
            "3σ",
            "3-sigma",
            "mean+3σ",
            "99.7th percentile",
            "percentile 95",
            "Écart-type",
            "1st quartile",
        ] {
            assert_eq!(Kind::of(name), Kind::Summary, "{name}");
        }
        for name in ["5%", "95 %", "99,7%", ".5%"] {
            assert_eq!(Kind::of(name), Kind::Share, "{name}");
        }
        for name in [
            "",
            "12",
            "1.5",
            "%",
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
            "max 9",
            "sigma 2",
            "P95",
            "5% fill",
        ] {
            assert_eq!(Kind::of(name), Kind::Other, "{name}");
        }
        assert_eq!(Kind::of(&"total ".repeat(50)), Kind::Other);
    }

    #[test]
    fn a_share_is_a_summary_below_other_names_only() {
        let found = |names: &[&str]| {
            let mut column = SummaryNames::default();
            names.iter().map(|name| column.sums_up(name)).collect::<Vec<_>>()
        };
        assert_eq!(found(&["0", "1", "5%", "95%"]), [false, false, true, true]);
        assert_eq!(found(&["5%", "95%", "Mean"]), [false, false, true]);
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
