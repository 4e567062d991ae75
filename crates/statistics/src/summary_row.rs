//! Names of rows of a table that sum up others, and are none of their kind: a total, an average, a percentile.

use std::cmp::Ordering;

/// Words that speak of a sum.
const SUMS: [&str; 17] = [
    "total",
    "totals",
    "tot",
    "subtotal",
    "subtotals",
    "subtot",
    "sum",
    "sums",
    "gesamt",
    "gesamtmasse",
    "insgesamt",
    "summe",
    "totale",
    "somme",
    "suma",
    "totaal",
    "totaux",
];

/// Whether a word speaks of a sum. In German any word may go before it: `Zwischensumme`, `Gesamtsumme`.
fn is_of_sum(word: &str) -> bool {
    SUMS.contains(&word) || word.ends_with("summe")
}

/// Words that speak of another number of all rows.
const STATISTICS: [&str; 63] = [
    "σ",
    "sigma",
    // The sign for a millionth, and the Greek letter.
    "µ",
    "μ",
    "average",
    "averages",
    "avg",
    "ave",
    "aver",
    "mean",
    "median",
    "stdev",
    "stddev",
    "std",
    "sd",
    "variance",
    "var",
    "rms",
    "rmse",
    "rss",
    "rsd",
    "iqr",
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
    "skew",
    "kurtosis",
    "kurt",
    "confidence",
    "moyenne",
    "médiane",
    "mediane",
    "écart",
    "ecart",
    "étendue",
    "etendue",
    "mittelwert",
    "mittelw",
    "mittel",
    "durchschnitt",
    "standardabweichung",
    "standardabw",
    "stdabw",
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
const BESIDE: [&str; 57] = [
    "grand",
    "sub",
    "of",
    "over",
    "across",
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
    "n",
    "above",
    "standard",
    "dev",
    "deviation",
    "error",
    "kg",
    "overall",
    "absolute",
    "abs",
    "arithmetic",
    "geometric",
    "root",
    "square",
    "plus",
    "minus",
    "mu",
    "type",
    "level",
    "interval",
    "ci",
    "bound",
    "limit",
    "lower",
    "upper",
    "low",
    "high",
    "population",
    "estándar",
    "estandar",
    "th",
    "st",
    "nd",
    "rd",
    "percent",
    "pct",
];

/// What a number may stand before that is no share, besides [`ORDINALS`].
const COUNTED: [&str; 13] = [
    "σ",
    "sigma",
    "sd",
    "std",
    "percentile",
    "percentiles",
    "quantile",
    "quartile",
    "runs",
    "samples",
    "rows",
    "parts",
    "bodies",
];

/// What a number may stand behind.
const COUNTING: [&str; 5] = ["percentile", "quantile", "quartile", "confidence", "n"];

/// What a number stands before that is a share, and one that may be a percentile.
const SHARES: [&str; 3] = ["%", "percent", "pct"];
const ORDINALS: [&str; 4] = ["th", "st", "nd", "rd"];

/// How spreadsheets end the names of these functions, as in `STDEV.S`.
const ENDS: [&str; 4] = ["s", "p", "inc", "exc"];
const FUNCTIONS: [&str; 5] = ["stdev", "stddev", "var", "percentile", "quartile"];

/// Tells among the names in a column, from the first row on, those of rows that sum up others.
///
/// A share without a word of a statistic, such as `95%` or `P99.73`, is one of them where the first name of the column is no share: a column of
/// shares says something else.
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
        let is_key = |word: &str| is_of_sum(word) || STATISTICS.contains(&word);
        let is_share = |at: &usize| {
            let (number, next) = (words[*at], words.get(at + 1));
            let is_of = |some: &[&str]| next.is_some_and(|next| some.contains(next));
            // The first, second and third are counted more often than percentiles, and so are P1 to P99.
            let is_ordinal = is_of(&ORDINALS) && number.len() > 1;
            let is_percentile = *at > 0 && words[at - 1] == "p" && number.contains(['.', ',']);
            is_number(number) && (is_of(&SHARES) || is_ordinal || is_percentile)
        };
        let shares: Vec<usize> = (0..words.len()).filter(is_share).collect();
        let is_plain = |(at, word): (usize, &&str)| {
            let is_counter = |word: &&str| COUNTED.contains(word) || ORDINALS.contains(word);
            let next = words.get(at + 1).is_some_and(is_counter);
            let before = at.checked_sub(1).and_then(|at| words.get(at));
            let is_counted = next || before.is_some_and(|before| COUNTING.contains(before));
            let is_end = before.is_some_and(|w| FUNCTIONS.contains(w)) && ENDS.contains(word);
            let is_of = |share: &usize| match at.cmp(share) {
                Ordering::Less => at + 1 == *share && *word == "p",
                Ordering::Equal => true,
                Ordering::Greater => at == share + 1 && *word == "%",
            };
            let is_plain = is_key(word) || BESIDE.contains(word) || is_end;
            is_plain || is_number(word) && is_counted || shares.iter().any(is_of)
        };
        if !words.iter().enumerate().all(is_plain) {
            return Self::Other;
        }
        let has = |some: &[&str]| words.iter().any(|word| some.contains(word));
        let deviation = has(&["standard", "st"]) && has(&["dev", "deviation", "error"]);
        if deviation || words.iter().any(|word| is_key(word)) {
            return Self::Summary;
        }
        if shares.is_empty() { Self::Other } else { Self::Share }
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
    const OF: [&str; 4] = ["of", "for", "von", "de"];
    // The mass of a whole: a mass alone may be that of a part, as a balance mass.
    const MASSES: [&str; 2] = ["mass", "masse"];
    const WHOLE: [&str; 5] = ["dry", "wet", "launch", "gross", "liftoff"];
    let lower = name.to_lowercase();
    let words = words(&lower);
    let has = |some: &[&str]| words.iter().any(|word| some.contains(word));
    let is_whole_mass = has(&MASSES) && has(&WHOLE);
    if !is_whole_mass && !words.iter().any(|word| is_of_sum(word)) {
        return None;
    }
    // `Total dry mass of the bus`, `Bus total mass (kg)`.
    let told: Vec<&str> =
        words.into_iter().filter(|word| OF.contains(word) || !BESIDE.contains(word)).collect();
    let is_sum = |(at, word): (usize, &&str)| {
        let next = told.get(at + 1);
        let is_whole = word.starts_with("subtot") || word.ends_with("summe") && *word != "summe";
        is_of_sum(word) && (is_whole || next.is_none_or(|next| OF.contains(next)))
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
            "Gesamtsumme",
            "Tot.",
            "Insgesamt",
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
            "99.73 percentile",
            "Mean (n=50)",
            "Average (50 runs)",
            "Mean over all runs",
            "Ave.",
            "STDEV.S",
            "stdev_p",
            "Stdabw",
            "RSS",
            "µ+3σ",
            "μ - 3σ",
            "95% CI of the mean",
        ] {
            assert_eq!(Kind::of(name), Kind::Summary, "{name}");
        }
        for name in [
            "5%",
            "95 %",
            "99,7%",
            ".5%",
            "95 pct",
            "99.73th",
            "99.7th",
            "P99.73",
            "p 0.135",
            "95% CI",
            "Lower 95%",
            "95 percent of runs",
        ] {
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
            "1st",
            "P1.5 antenna",
            "p",
            "s",
            "50 runs",
            "max s",
            "upper limit",
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
                format!("Zwischensumme {part}"),
                format!("{part} insgesamt"),
                format!("Subtot {part}"),
            ] {
                assert_eq!(least_summed(&name), Some(1), "{name}");
            }
            for name in [
                format!("total pressure sensor of {part}"),
                format!("sum amplifier, {part}"),
                format!("Total {part}"),
                format!("{part} launch mass"),
                format!("dry mass of {part}"),
            ] {
                assert_eq!(least_summed(&name), Some(2), "{name}");
            }
            for name in [
                part.to_owned(),
                format!("mean 3 antenna {part}"),
                format!("{part} mass"),
                format!("balance mass {part}"),
            ] {
                assert_eq!(least_summed(&name), None, "{name}");
            }
        }
    }
}
