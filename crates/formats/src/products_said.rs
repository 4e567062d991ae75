//! What a line says of the sign of products, be it a title or a comment of a table.

use crate::{
    Products,
    products_implied::implies_sign,
    products_words::{NAMES, is_neutral, is_of_sign, is_products, speaks_of_products, split},
};

/// What a line says of the products.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Said {
    Nothing,
    Clear(Products),
    /// It states their sign, in words that may mean either.
    Unclear,
}

/// Whether a line is a comment on the sign of products, though blanks or a quotation mark may stand before it.
pub(crate) fn states_products(line: &str) -> bool {
    let row = line.trim_start();
    let row = row.strip_prefix('"').map_or(row, str::trim_start);
    row.starts_with('#') && said(bare(row)) != Said::Nothing
}

/// What a line holds behind the mark of a comment. Spreadsheets put a quotation mark before it, and separators behind.
pub(crate) fn bare(line: &str) -> &str {
    line.trim_start_matches(|c| c == '#' || is_around(c))
}

/// What may stand around a comment and around its words.
pub(crate) fn is_around(c: char) -> bool {
    c.is_whitespace() || ",;.\"'".contains(c)
}

/// A plain statement is clear. Any other line that has products, or a sign, and a word for what they may be is unclear, unless it says only how
/// they were computed.
pub(crate) fn said(line: &str) -> Said {
    let line = line.to_lowercase().replace("off-diagonals", "products");
    let line = line.replace("off-diagonal", "products");
    let named = known(&line);
    let has_sign = || split(&line).any(|word| word == "sign" || word == "signs");
    // `sign convention: integrals` is that of products.
    let is_convention = |(key, _): (&str, &str)| {
        split(key).any(is_of_sign) && split(key).all(|word| is_of_sign(word) || is_neutral(word))
    };
    let is_of_products = speaks_of_products(&line)
        || !named.is_empty() && (has_sign() || asserted(&line).is_some_and(is_convention));
    let is_stated = || if named.is_empty() { is_vague(&line) } else { !is_method(&line) };
    let is_unclear = is_of_products && is_stated() || implies_sign(&line);
    match clear(&line).filter(|_| is_of_products) {
        Some(products) => Said::Clear(products),
        None if is_unclear => Said::Unclear,
        None => Said::Nothing,
    }
}

/// What a plain statement says: `products = integrals`, `the products are entries of the inertia tensor`, with no words but these.
fn clear(line: &str) -> Option<Products> {
    let (statement, explained) = explanation(line).unwrap_or((line, None));
    // `integrals, not tensor entries`.
    let (statement, denied) = match statement.split_once(", not ") {
        Some((statement, denied)) => (statement, Some(one_of(denied)?)),
        None => (statement, None),
    };
    let found = match asserted(statement) {
        Some((key, value)) => {
            let of_products = |word: &str| is_products(word) || is_of_sign(word);
            let is_key = |word: &str| of_products(word) || is_neutral(word);
            // `I_xy` leaves a letter.
            let is_plain = is_plain(key) && split(key).all(|word| is_key(word) || word == "i");
            if !is_plain || !split(key).any(of_products) {
                return None;
            }
            match value.trim_matches(is_around) {
                "+" => Products::Integrals,
                "-" | "−" => Products::TensorEntries,
                words => one_of(words)?,
            }
        }
        None => explained.and(one_of(statement))?,
    };
    let is_agreed = explained.is_none_or(|explained| explained == found);
    (is_agreed && denied.is_none_or(|denied| denied != found)).then_some(found)
}

/// What words say that are one of the two and change nothing in it.
fn one_of(text: &str) -> Option<Products> {
    let words: Vec<&str> = split(text).collect();
    let is_integrals = |at: usize| words.get(at) == Some(&Products::Integrals.name());
    let is_known = |(at, word): (usize, &&str)| {
        let is_positive = *word == "positive" && is_integrals(at + 1);
        is_neutral(word) || is_positive || Products::parse(word).is_some()
    };
    let known = known(text);
    let (first, rest) = known.split_first()?;
    let is_one = rest.iter().all(|other| other == first);
    (is_one && is_plain(text) && words.iter().enumerate().all(is_known)).then_some(*first)
}

/// Whether a text has no marks that may be those of a sign.
fn is_plain(text: &str) -> bool {
    text.chars().all(|c| c.is_alphanumeric() || is_around(c) || "_:=/&".contains(c))
}

/// What stands before the formula in brackets that ends a line, and which sign that gives: `(I12 = -∫xy dm)`.
fn explanation(line: &str) -> Option<(&str, Option<Products>)> {
    let (before, formula) = line.trim_end_matches(is_around).strip_suffix(')')?.rsplit_once('(')?;
    let (name, integral) = formula.rsplit_once('=').unwrap_or(("ixy", formula));
    let integral = integral.trim();
    let (found, integral) = match integral.strip_prefix(['-', '−']) {
        Some(integral) => (Products::TensorEntries, integral),
        None => (Products::Integrals, integral.strip_prefix('+').unwrap_or(integral)),
    };
    let integrand = integral.trim_start().strip_prefix('∫')?.strip_suffix("dm")?;
    let is_formula = split(name).all(is_products) && is_plain(name) && is_plain(integrand);
    is_formula.then_some((before, Some(found)))
}

/// What stands before and after the first word or mark that states something.
fn asserted(line: &str) -> Option<(&str, &str)> {
    let found = ["=", ":", " are ", " is ", " as "].into_iter();
    let found = found.filter_map(|mark| Some((line.find(mark)?, mark.len())));
    let (at, length) = found.min()?;
    Some((&line[..at], &line[at + length..]))
}

/// What stands before and after the first `=` or `:`, if it gives the products a value.
pub(crate) fn assigned(line: &str) -> Option<(&str, &str)> {
    let (key, value) = line.split_once(['=', ':'])?;
    let is_of_products = speaks_of_products(key) && known(key).is_empty();
    is_of_products.then(|| (key, value.trim_matches(is_around)))
}

/// The known words of a text. An inertia tensor says nothing of the sign, unless its entries are meant.
fn known(text: &str) -> Vec<Products> {
    let has_entries = split(text).any(|word| word == "entries" || word == "entry");
    let mut found = Vec::new();
    for clause in text.split(['=', ':', ',', ';', '(']) {
        let mut before = "";
        for word in split(clause) {
            if before != "inertia" || has_entries {
                found.extend(Products::parse(word));
            }
            before = word;
        }
    }
    found
}

/// Whether a line that has a known word says only how products were computed: `from surface integrals of the mesh`. One that states something,
/// or speaks of signs, may say more.
fn is_method(line: &str) -> bool {
    const HOW: [&str; 4] = ["from", "by", "using", "via"];
    const SIGNS: [&str; 11] = [
        "sign",
        "convention",
        "positiv",
        "negat",
        "minus",
        "plus",
        "oppos",
        "flip",
        "revers",
        "invert",
        "no",
    ];
    let has_sign = split(line).any(|word| SIGNS.iter().any(|sign| word.starts_with(sign)));
    let mut before = None;
    let mut has_mark = false;
    for c in line.chars() {
        // A dash within a word is no sign.
        has_mark |= "-−+±".contains(c) && !before.is_some_and(char::is_alphanumeric);
        before = Some(c);
    }
    let is_how = |clause: &str| {
        let mut before = split(clause).take_while(|word| !HOW.contains(word));
        before.all(|word| Products::parse(word).is_none())
    };
    let mut clauses = line.split([',', ';', '(', ')']);
    asserted(line).is_none() && !has_sign && !has_mark && clauses.all(is_how)
}

/// Whether a line that has none of the known words gives the products a sign nevertheless, as one in which they are misspelt:
/// `products: integral`, `product convention: positive`. `product: widget 7` and `product sign-off: J. S.` do not.
fn is_vague(line: &str) -> bool {
    const SIGNS: [&str; 7] =
        ["positive", "negative", "plus", "minus", "integral", "tensors", "tensorial"];
    const NONE: [&str; 4] = ["none", "no", "zero", "0"];
    let Some((key, value)) = asserted(line) else { return false };
    let mark = line.get(key.len()..).unwrap_or_default();
    let is_name = NAMES.contains(&key.trim());
    if is_name && mark.starts_with('=') {
        return true;
    }
    let is_key = |word: &str| is_products(word) || is_of_sign(word) || is_neutral(word);
    if !speaks_of_products(key) || !split(key).all(is_key) {
        return false;
    }
    let mut words = split(value);
    let one = words.next().filter(|_| words.next().is_none());
    let is_one = |word: &str| is_name && mark.starts_with(':') && !NONE.contains(&word);
    let is_sign = |word: &str| SIGNS.contains(&word) || word.starts_with("convention");
    one.is_some_and(|word| is_one(word) || is_sign(word))
        || (key.trim() != "product" && (value.contains('∫') || split(value).any(is_sign)))
        || split(key).any(is_of_sign)
}
