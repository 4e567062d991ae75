//! What lines of a table that are no rows say of the sign of its products.

use crate::{
    Products,
    body::{entry_of, shortened},
    error::Refusal,
    rows::titles,
    spread::words,
    text::Text,
};

/// What the products are called as a whole, where `product` may be that of a company.
const NAMES: [&str; 4] = ["products", "poi", "pois", "poiconv"];

/// Words that speak of a sign.
const OF_SIGNS: [&str; 4] = ["sign", "signs", "convention", "conventions"];

/// Words that change nothing in a statement on the sign of products.
const NEUTRAL: [&str; 16] = [
    "of", "the", "for", "are", "is", "as", "and", "in", "this", "these", "file", "given", "others",
    "inertia", "entries", "entry",
];

/// What may be said of products.
const ALLOWED: &str = "tensor (I12 = -∫xy dm) or integrals (+∫xy dm), with no other words";

/// What a line says of the products.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Said {
    Nothing,
    Clear(Products),
    /// It states their sign, in words that may mean either.
    Unclear,
}

/// What the titles above a header, and the comments above and below it, say of the products: `# products = integrals`.
///
/// # Errors
/// A line speaks of their sign in other words than those of a plain statement, or two lines contradict each other.
pub(crate) fn stated_products(text: &Text, header: usize) -> Result<Option<Products>, Refusal> {
    let mut stated: Option<(Products, usize)> = None;
    for (start, line) in titles(text.as_str(), header) {
        let line = bare(line);
        let found = match said(line) {
            Said::Nothing => continue,
            Said::Clear(products) => products,
            Said::Unclear => {
                let line = line.trim_end_matches(is_around).to_lowercase();
                let said = match assigned(&line) {
                    Some((_, value)) => format!("products = {}", shortened(value)),
                    None => format!("{:?} on the products", shortened(&line)),
                };
                return Err(text.malformed(start, format!("{said}: it must be {ALLOWED}")));
            }
        };
        if let Some((other, first)) = stated.filter(|(other, _)| *other != found) {
            let (first, other, found) = (text.line(first), other.name(), found.name());
            let problem = format!(
                "products = {found}, and line {first} says {other}: one of the two lines must go"
            );
            return Err(text.malformed(start, problem));
        }
        stated.get_or_insert((found, start));
    }
    Ok(stated.map(|(products, _)| products))
}

/// Whether a line is a comment on the sign of products, though blanks or a quotation mark may stand before it.
pub(crate) fn states_products(line: &str) -> bool {
    let row = line.trim_start();
    let row = row.strip_prefix('"').map_or(row, str::trim_start);
    row.starts_with('#') && said(bare(row)) != Said::Nothing
}

/// What a line holds behind the mark of a comment. Spreadsheets put a quotation mark before it, and separators behind.
fn bare(line: &str) -> &str {
    line.trim_start_matches(|c| c == '#' || is_around(c))
}

/// What may stand around a comment and around its words.
fn is_around(c: char) -> bool {
    c.is_whitespace() || ",;.\"'".contains(c)
}

/// A plain statement is clear. Any other line that has products, or a sign, and a word for what they may be is unclear, unless it says only how
/// they were computed.
fn said(line: &str) -> Said {
    let line = line.to_lowercase();
    let named = known(&line);
    let has_sign = || split(&line).any(|word| word == "sign" || word == "signs");
    // `sign convention: integrals` is that of products.
    let is_convention = |(key, _): (&str, &str)| {
        split(key).any(is_of_sign) && split(key).all(|word| is_of_sign(word) || is_neutral(word))
    };
    let is_of_products = speaks_of_products(&line)
        || !named.is_empty() && (has_sign() || asserted(&line).is_some_and(is_convention));
    if !is_of_products {
        return Said::Nothing;
    }
    let is_unclear = if named.is_empty() { is_vague(&line) } else { !is_method(&line) };
    match clear(&line) {
        Some(products) => Said::Clear(products),
        None if is_unclear => Said::Unclear,
        None => Said::Nothing,
    }
}

/// The words of a text, none of them empty.
fn split(text: &str) -> impl Iterator<Item = &str> {
    words(text).filter(|word| !word.is_empty())
}

/// Whether a word is that of products, or the name of one.
fn is_products(word: &str) -> bool {
    // `Ixy`, and what is left of `I_xy`, but not the number 12.
    let is_entry = |name: &str| entry_of(name).is_some_and(|entry| entry >= 3);
    word == "product"
        || NAMES.contains(&word)
        || is_entry(word)
        || word.len() == 2 && word.starts_with(char::is_alphabetic) && is_entry(&format!("i{word}"))
}

fn is_of_sign(word: &str) -> bool {
    OF_SIGNS.contains(&word)
}

fn is_neutral(word: &str) -> bool {
    NEUTRAL.contains(&word)
}

fn speaks_of_products(text: &str) -> bool {
    split(text).any(is_products)
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
fn assigned(line: &str) -> Option<(&str, &str)> {
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
    let Some((key, value)) = assigned(line) else { return false };
    let is_name = NAMES.contains(&key.trim());
    if is_name && line[key.len()..].starts_with('=') {
        return true;
    }
    let is_key = |word: &str| is_products(word) || is_of_sign(word) || is_neutral(word);
    if !split(key).next().is_some_and(is_products) || !split(key).all(is_key) {
        return false;
    }
    let mut words = split(value);
    let one = words.next().filter(|_| words.next().is_none());
    let is_sign = |word: &str| SIGNS.contains(&word) || word.starts_with("convention");
    one.is_some_and(|word| is_name && !NONE.contains(&word) || is_sign(word))
        || (key.trim() != "product" && (value.contains('∫') || split(value).any(is_sign)))
        || split(key).any(is_of_sign)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::{prelude::*, sample::select};

    fn stated(source: &str) -> Result<Option<Products>, (Option<usize>, String)> {
        let text = Text::new(source.as_bytes(), true).unwrap();
        let header = source.find("ixx,iyy").unwrap_or(source.len());
        stated_products(&text, header)
            .map_err(|refusal| (refusal.line, refusal.problem.to_string()))
    }

    const TENSOR: Option<Option<Products>> = Some(Some(Products::TensorEntries));
    const INTEGRALS: Option<Option<Products>> = Some(Some(Products::Integrals));

    /// Comments, and what they say: a convention, nothing, or what is refused.
    const LINES: [(&str, Option<Option<Products>>); 87] = [
        ("# tensor = [Ixx -Ixy -Ixz; -Ixy Iyy -Iyz; -Ixz -Iyz Izz]\n", None),
        ("# POI sign: tensor entries are -POI\n", None),
        ("# Ixy = Ixy_NX (positive), tensor has -Ixy\n", None),
        ("# the tensor entries are the negatives of the products\n", None),
        ("# products: tensor (I12 = +∫xy dm)\n", None),
        ("# products = integrals (-∫xy dm)\n", None),
        ("# products: integrals (I12 = ∫xy dm)\n", INTEGRALS),
        ("# signs of the tensor are flipped\n", None),
        ("# Products of inertia: positive tensor notation\n", None),
        ("# Ixy, Ixz, Iyz from surface integrals of the STL\n", Some(None)),
        ("# products of inertia computed by volume integrals over the mesh\n", Some(None)),
        ("# products from integrals, negated\n", None),
        ("# products by CAD, integrals\n", None),
        ("# POI = integrals\n", INTEGRALS),
        ("# POIs: tensor\n", TENSOR),
        ("# POI: +\n", INTEGRALS),
        ("# POI sign convention: integrals\n", INTEGRALS),
        ("# Sign convention: tensor entries\n", TENSOR),
        ("# Convention = integrals\n", INTEGRALS),
        ("# Ixy, Ixz, Iyz are positive integrals\n", INTEGRALS),
        ("# I_xy and the others are integrals\n", INTEGRALS),
        ("# I12 I13 I23: integrals\n", INTEGRALS),
        ("# I_xy: tensor\n", TENSOR),
        ("# 12 bodies of the tensor\n", Some(None)),
        ("# entries of the tensor (I12 = -∫xy dm)\n", TENSOR),
        ("# name,mass,ixx,iyy,izz,ixy,ixz,iyz,sign\n", Some(None)),
        ("# Ixy = 0.5 by CAD\n", Some(None)),
        ("# sign: +\n", Some(None)),
        ("# tensor of inertia, sign convention as in CAD\n", None),
        ("# Sign convention: not tensor\n", None),
        ("# sign convention: right-handed\n", Some(None)),
        ("# Ixy was measured on the integral rig\n", Some(None)),
        ("# POI = integral\n", None),
        ("# POI: not tensor\n", None),
        ("# Ixy = -∫xy dm\n", None),
        ("# Ixy, Ixz and Iyz: positive\n", None),
        ("# Ixy and Ixz are -integrals\n", None),
        ("# products = integrals, not tensor entries\n", INTEGRALS),
        ("#Products=\"tensor\"\r\n", TENSOR),
        ("# products: integrals\n", INTEGRALS),
        ("## products : Tensor\n", TENSOR),
        ("\"# products = integrals\",,,,,\n", INTEGRALS),
        ("\" #products = tensor\";;;\r\n", TENSOR),
        ("# products = integrals,,,,,\n", INTEGRALS),
        (" # products = integrals\n", INTEGRALS),
        ("\t#products=integrals\n", INTEGRALS),
        ("# products: +\n", INTEGRALS),
        ("\"# products = -\",,\n", TENSOR),
        ("# products: −\n", TENSOR),
        ("# Product convention: integrals\n", INTEGRALS),
        ("# PRODUCTS OF INERTIA: these are integrals\n", INTEGRALS),
        ("# The products of inertia are positive integrals\n", INTEGRALS),
        ("# Sign of products = integrals\n", INTEGRALS),
        ("# POIconv = integrals\n", INTEGRALS),
        ("# products are tensor entries (I12 = -∫xy dm)\n", TENSOR),
        ("# products are entries of the inertia tensor\n", TENSOR),
        ("# products of inertia are those of the CAD program\n", Some(None)),
        ("# products of our company\n", Some(None)),
        ("# product: widget 7\n", Some(None)),
        ("# Product: integrated sensor\n", Some(None)),
        ("# Product sign-off: J. Smith\n", Some(None)),
        ("# products: bolts, nuts and washers\n", Some(None)),
        ("# products: none\n", Some(None)),
        ("# product = widget\n", Some(None)),
        ("# products of the inertia tensor were measured\n", Some(None)),
        ("# integrals are in kg m2\n", Some(None)),
        ("# production: integrals\n", Some(None)),
        ("# name, mass, products\n", Some(None)),
        ("# products = integral\n", None),
        ("# products = not tensor\n", None),
        ("# products = -integrals\n", None),
        ("# products = tensor or integrals\n", None),
        ("# products =\n", None),
        ("# products: integral\n", None),
        ("# products: negative integrals\n", None),
        ("# products: -integrals\n", None),
        ("# products: not tensor\n", None),
        ("# products: CAD\n", None),
        ("# products of inertia: -∫xy dm\n", None),
        ("# Product convention: positive\n", None),
        ("# product sign convention: see the drawing\n", None),
        ("# products are not tensor entries but integrals\n", None),
        ("# products are not tensor entries\n", None),
        ("# In this file the products are integrals, no tensor\n", None),
        ("\"# products = integral\",,,\n", None),
        (" # products: positive\n", None),
        ("# products are -integrals\n", None),
    ];

    proptest! {
        /// Products by any of their names are given one of the two. With a word or a mark that may turn it, wherever that stands, the line is
        /// refused, and one on how they were computed says nothing.
        #[test]
        fn only_plain_statements_are_clear(
            products in select(&["products", "Products of inertia", "POI", "The POIs", "Ixy, Ixz, Iyz", "I_xy and the others", "POI sign"][..]),
            verb in select(&[" = ", ": ", " are ", " are given as ", ": these are "][..]),
            (word, found, formula) in select(&[
                ("tensor", Products::TensorEntries, "-∫xy dm"),
                ("tensor entries", Products::TensorEntries, "−∫xy dm"),
                ("entries of the inertia tensor", Products::TensorEntries, "I12 = -∫ xy dm"),
                ("integrals", Products::Integrals, "+∫xy dm"),
                ("positive integrals", Products::Integrals, "Ixy = ∫xy dm"),
            ][..]),
            turn in select(&[
                "negated", "not", "minus", "opposite of", "-", "−", "-1 x", "* -1", "flipped", "the negative of", "swapped", "as NX has them but",
                "with the reverse sign of", "±", "or", "inverse", "[-Ixy]", "(with minus sign)", "which tools call",
            ][..]),
            at in 0..3_usize,
            how in select(&["from", "computed by", "found using"][..]),
            has_formula in any::<bool>(),
        ) {
            let formula = if has_formula { format!(" ({formula})") } else { String::new() };
            let plain = format!("{products}{verb}{word}{formula}");
            prop_assert_eq!(said(&plain), Said::Clear(found), "{}", plain);
            let turned = match at {
                0 => format!("{products}{verb}{turn} {word}{formula}"),
                1 => format!("{products}{verb}{word}, {turn}{formula}"),
                _ => format!("{turn} {plain}"),
            };
            prop_assert_eq!(said(&turned), Said::Unclear, "{}", turned);
            let word = word.trim_start_matches("positive ");
            let method = format!("{products} {how} the volume {word} of the mesh");
            let expected = if products.ends_with("sign") { Said::Unclear } else { Said::Nothing };
            prop_assert_eq!(said(&method), expected, "{}", method);
        }

        /// A line above the header counts with and without the mark of a comment, one below it with the mark, and none within a quoted cell.
        #[test]
        fn titles_count_as_comments_do(
            which in 0..LINES.len(),
            is_title in any::<bool>(),
            place in 0..4_usize,
            rows in 0..3_usize,
        ) {
            let (line, expected) = LINES[which];
            let bare = bare(line).trim_end().trim_end_matches([',', ';', '"']);
            let line = if is_title { bare.to_owned() } else { format!("# {bare}") };
            let rows = "1,1,1,\"a\nb\"\n".repeat(rows);
            let cell = format!("1,1,1,\"notes\n{}\n\"\n", line.replace('"', ""));
            let (above, below, is_read) = match place {
                0 => (format!("{line}\n"), rows, true),
                1 => (String::new(), format!("{rows}{line}\n"), !is_title),
                2 => (String::new(), format!("{rows}{cell}"), false),
                _ => (format!("Table 3\n\n{line}\n"), format!("{rows}{cell}"), true),
            };
            let source = format!("{above}ixx,iyy,izz,notes\n{below}");
            let expected = if is_read { expected } else { Some(None) };
            prop_assert_eq!(stated(&source).ok(), expected, "{}", source);
        }

        /// Any number of lines above and below the header, of which each says tensor, integrals, nothing, or something that is
        /// neither.
        #[test]
        fn the_first_wrong_line_is_named(
            lines in prop::collection::vec(0..LINES.len(), 0..7),
            above in 0..7_usize,
        ) {
            let (before, after) = lines.split_at(above.min(lines.len()));
            let text = |lines: &[usize]| lines.iter().map(|i| LINES[*i].0).collect::<String>();
            let source = text(before) + "ixx,iyy,izz\n1,1,1\n" + &text(after);
            let mut expected = Ok(None);
            for (number, line) in lines.iter().enumerate() {
                match (LINES[*line].1, expected) {
                    (Some(None), _) => {}
                    (Some(Some(found)), Ok(None)) => expected = Ok(Some(found)),
                    (Some(Some(found)), Ok(Some(known))) if found == known => {}
                    (Some(Some(_)) | None, _) => {
                        expected = Err(number + if number < before.len() { 1 } else { 3 });
                        break;
                    }
                }
            }
            match (stated(&source), expected) {
                (Ok(found), Ok(expected)) => prop_assert_eq!(found, expected),
                (Err((line, message)), Err(expected)) => {
                    prop_assert_eq!(line, Some(expected), "{}", message);
                    prop_assert!(message.contains("it must be tensor") || message.contains("must go"));
                }
                (found, expected) => prop_assert!(false, "{source}: {found:?}, {expected:?}"),
            }
        }
    }

    /// Each comment alone, which is a comment to who reads the rows as well if it says anything.
    #[test]
    fn every_comment_says_what_it_says() {
        for (line, expected) in LINES {
            assert_eq!(stated(line).ok(), expected, "{line}");
            let is_comment = line.starts_with('#') || expected != Some(None);
            assert_eq!(crate::rows::is_comment(line), is_comment, "{line}");
        }
        for row in ["\"#1\",2,3\n", " #2,3\n", "\"# product 7\",1\n", "\"products = tensor\",\n"] {
            assert!(!crate::rows::is_comment(row), "{row}");
        }
    }
}
