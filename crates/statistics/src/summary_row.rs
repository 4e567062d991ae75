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

/// What a value may be off, and what it should be. A model may be called so, of which all rows are then. `Nominal` is none of them: a run or a
/// body is called so.
const ASIDE: [&str; 7] = [
    "uncertainty",
    "uncertainties",
    "tolerance",
    "tolerances",
    "cov",
    "requirement",
    "requirements",
];

/// What stands beside it: of a part that is called otherwise, a name has other words.
const BESIDE: [&str; 65] = [
    "%",
    // What is estimated, expected at most and not to be exceeded.
    "cbe",
    "mev",
    "nte",
    "basic",
    "predicted",
    "allowable",
    "estimated",
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

/// What stands between a sum and what is added to it, and how words for that begin: `Total incl. margin`. Numbers stand there, too. A margin
/// without them is one, and may be a part of its own: `Total margin`.
const WITH: [&str; 11] =
    ["incl", "including", "inc", "with", "w", "and", "plus", "after", "inkl", "mit", "avec"];
const ADDED: [&str; 9] = [
    "margin",
    "contingenc",
    "growth",
    "mga",
    "allowance",
    "reserve",
    "uncertaint",
    "marge",
    "zuschlag",
];

/// How many of the words stand before what is added to a sum, if something is.
fn before_margin(words: &[&str]) -> Option<usize> {
    let is_added = |word: &&str| ADDED.iter().any(|added| word.starts_with(added));
    let added = words.iter().rposition(is_added)?;
    words[..added].iter().position(|word| WITH.contains(word) || is_number(word))
}

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
const COUNTING: [&str; 7] =
    ["percentile", "quantile", "quartile", "confidence", "n", "of", "count"];

/// What a number stands before that is a share, and one that may be a percentile.
const SHARES: [&str; 3] = ["%", "percent", "pct"];
const ORDINALS: [&str; 4] = ["th", "st", "nd", "rd"];

/// How spreadsheets end the names of these functions, as in `STDEV.S`.
const ENDS: [&str; 4] = ["s", "p", "inc", "exc"];
const FUNCTIONS: [&str; 5] = ["stdev", "stddev", "var", "percentile", "quartile"];

/// Tells among the names in a column, from the first row on, those of rows that sum up others.
///
/// A share without a word of a statistic, such as `95%` or `P99.73`, is one of them where the first name of the column is none: a column of
/// shares says something else. The same holds for words as `Uncertainty` and `Requirement`.
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
    /// Whether the first name is a share or another that all rows may have.
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
    /// A share, which may be a percentile, or a word that may be the name of all rows.
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
        // No part is called so that weighs what others weigh and a margin.
        let with_margin = plain.replace(['+', '&'], " plus ");
        let with_margin = words(&with_margin);
        if before_margin(&with_margin).is_some_and(|end| is_surely_sum(&with_margin[..end])) {
            return Self::Summary;
        }
        let words = words(&plain);
        let is_key = |word: &str| is_of_sum(word) || STATISTICS.contains(&word);
        let is_aside = |word: &&str| ASIDE.contains(word);
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
            let is_plain = is_key(word) || is_aside(word) || BESIDE.contains(word) || is_end;
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
        if shares.is_empty() && !words.iter().any(is_aside) { Self::Other } else { Self::Share }
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
    let lower = name.to_lowercase();
    let words = words(&lower);
    if !is_whole_mass(&words) && !words.iter().any(|word| is_of_sum(word)) {
        return None;
    }
    Some(if can_only_be_sum(&words) { 1 } else { 2 })
}

/// Whether it speaks of the mass of a whole: a mass alone may be that of a part, as a balance mass.
fn is_whole_mass(words: &[&str]) -> bool {
    const WHOLE: [&str; 5] = ["dry", "wet", "launch", "gross", "liftoff"];
    let has = |some: &[&str]| words.iter().any(|word| some.contains(word));
    has(&MASSES) && has(&WHOLE)
}

const MASSES: [&str; 2] = ["mass", "masse"];

/// `Total dry mass of the bus`, `Bus total mass (kg)`.
fn can_only_be_sum(words: &[&str]) -> bool {
    const OF: [&str; 4] = ["of", "for", "von", "de"];
    let is_told = |word: &&&str| OF.contains(*word) || !BESIDE.contains(*word);
    let told: Vec<&str> = words.iter().filter(is_told).copied().collect();
    let is_sum = |(at, word): (usize, &&str)| {
        let next = told.get(at + 1);
        let is_whole = word.starts_with("subtot") || word.ends_with("summe") && *word != "summe";
        is_of_sum(word) && (is_whole || next.is_none_or(|next| OF.contains(next)))
    };
    told.iter().enumerate().any(is_sum)
}

/// Whether words before a margin are those of a sum: `launch mass simulator` are those of a part.
fn is_surely_sum(words: &[&str]) -> bool {
    let ends_so = words.last().is_some_and(|word| MASSES.contains(word) || *word == "kg");
    can_only_be_sum(words) || is_whole_mass(words) && ends_so
}

#[cfg(test)]
mod tests;
