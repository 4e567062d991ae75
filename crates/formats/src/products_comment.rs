//! What comments in a table say of the sign of its products.

use crate::{
    Products,
    body::{entry_of, shortened},
    error::Refusal,
    spread::words,
    text::Text,
};

/// What the products are called as a whole, where `product` may be that of a company.
const NAMES: [&str; 4] = ["products", "poi", "pois", "poiconv"];

/// Words that speak of a sign.
const OF_SIGNS: [&str; 4] = ["sign", "signs", "convention", "conventions"];

/// What may be said of products.
const ALLOWED: &str = "tensor (I12 = -∫xy dm) or integrals (+∫xy dm)";

/// Words that turn a known word into its opposite, if they stand among the three before it.
const NEGATIONS: [&str; 8] =
    ["not", "non", "never", "neither", "nor", "without", "negative", "minus"];

/// What a comment says of the products.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Said {
    Nothing,
    Clear(Products),
    /// It states their sign, in words that may mean either.
    Unclear,
}

/// What the comments say of the products: `# products = integrals`.
///
/// # Errors
/// A comment speaks of their sign and it is not clear which, as where the first word after `# products =` is none of those known, or two lines
/// contradict each other.
pub(crate) fn stated_products(text: &Text) -> Result<Option<Products>, Refusal> {
    let mut stated: Option<(Products, usize)> = None;
    let mut at = 0;
    for line in text.as_str().split_inclusive('\n') {
        let start = at;
        at += line.len();
        let Some(comment) = comment(line) else { continue };
        let found = match said(comment) {
            Said::Nothing => continue,
            Said::Clear(products) => products,
            Said::Unclear => {
                let comment = comment.trim_end_matches(is_around).to_lowercase();
                let said = match assigned(&comment) {
                    Some((_, value)) => format!("products = {}", shortened(value)),
                    None => format!("comment {:?} on the products", shortened(&comment)),
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
    comment(line).is_some_and(|comment| said(comment) != Said::Nothing)
}

/// What stands in a line that is a comment. Spreadsheets put a quotation mark before it, and separators behind.
fn comment(line: &str) -> Option<&str> {
    let line = line.trim_start();
    let line = line.strip_prefix('"').map_or(line, str::trim_start);
    line.starts_with('#').then(|| line.trim_start_matches(|c| c == '#' || is_around(c)))
}

/// What may stand around a comment and around its words.
fn is_around(c: char) -> bool {
    c.is_whitespace() || ",;.\"'".contains(c)
}

fn said(comment: &str) -> Said {
    let comment = comment.to_lowercase();
    // `sign convention: integrals` is that of products.
    let is_convention = |(key, value): (&str, &str)| {
        split(key).any(is_of_sign) && split(key).all(is_beside) && !known(value).is_empty()
    };
    if !speaks_of_products(&comment) && !comment.split_once(['=', ':']).is_some_and(is_convention) {
        return Said::Nothing;
    }
    if let Some((key, value)) = assigned(&comment) {
        let is_key = NAMES.contains(&key.trim()) && comment[key.len()..].starts_with('=');
        match value {
            "+" => return Said::Clear(Products::Integrals),
            "-" | "−" => return Said::Clear(Products::TensorEntries),
            // `-integrals` is tensor entries.
            signed
                if signed.starts_with(['+', '-', '−']) && (is_key || !known(signed).is_empty()) =>
            {
                return Said::Unclear;
            }
            _ => {}
        }
        match split(value).next().and_then(Products::parse) {
            // `integrals, not tensor entries`, but not `integrals or tensor`.
            Some(products) => {
                let is_one = known(value).iter().all(|other| *other == products);
                let is_clear = is_one || split(value).any(|word| word == "not");
                return if is_clear { Said::Clear(products) } else { Said::Unclear };
            }
            None if is_key => return Said::Unclear,
            None => {}
        }
    }
    match known(&comment).as_slice() {
        [] if is_vague(&comment) => Said::Unclear,
        [] => Said::Nothing,
        [first, rest @ ..] if rest.iter().all(|other| other == first) && !is_negated(&comment) => {
            Said::Clear(*first)
        }
        [..] => Said::Unclear,
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

/// Whether a word may stand beside that of products where they are given a sign.
fn is_beside(word: &str) -> bool {
    is_of_sign(word) || ["of", "the", "for", "are", "and", "inertia"].contains(&word)
}

fn speaks_of_products(text: &str) -> bool {
    split(text).any(is_products)
}

/// What stands before and after the first `=` or `:`, if it gives the products a value: `= -∫xy dm` after the word
/// `tensor` only explains it.
fn assigned(comment: &str) -> Option<(&str, &str)> {
    let (key, value) = comment.split_once(['=', ':'])?;
    let is_of_products = speaks_of_products(key) && known(key).is_empty();
    is_of_products.then(|| (key, value.trim_matches(is_around)))
}

/// The known words of a text. An inertia tensor says nothing of the sign, unless its entries are meant.
fn known(text: &str) -> Vec<Products> {
    let has_entries = split(text).any(|word| word == "entries" || word == "entry");
    let mut before = "";
    let mut found = Vec::new();
    for word in split(text) {
        if before != "inertia" || has_entries {
            found.extend(Products::parse(word));
        }
        before = word;
    }
    found
}

/// Whether a known word may mean its opposite.
fn is_negated(comment: &str) -> bool {
    let words: Vec<&str> = split(comment).collect();
    let has_minus = [" -integrals", " −integrals"].iter().any(|minus| comment.contains(minus));
    let is_after_no =
        |at: usize| words[at.saturating_sub(3)..at].iter().any(|word| NEGATIONS.contains(word));
    has_minus || (0..words.len()).any(|at| Products::parse(words[at]).is_some() && is_after_no(at))
}

/// Whether a comment that has none of the known words gives the products a sign nevertheless, as one in which they are misspelt:
/// `products: integral`, `product convention: positive`. `product: widget 7` and `product sign-off: J. S.` do not.
fn is_vague(comment: &str) -> bool {
    const SIGNS: [&str; 7] =
        ["positive", "negative", "plus", "minus", "integral", "tensors", "tensorial"];
    const NONE: [&str; 4] = ["none", "no", "zero", "0"];
    let Some((key, value)) = assigned(comment) else { return false };
    let is_key = |word: &str| is_products(word) || is_beside(word);
    if !split(key).next().is_some_and(is_products) || !split(key).all(is_key) {
        return false;
    }
    let mut words = split(value);
    let one = words.next().filter(|_| words.next().is_none());
    let is_one = |word: &str| NAMES.contains(&key.trim()) && !NONE.contains(&word);
    let is_sign = |word: &str| SIGNS.contains(&word) || word.starts_with("convention");
    one.is_some_and(|word| is_one(word) || is_sign(word))
        || (key.trim() != "product" && (value.contains('∫') || split(value).any(is_sign)))
        || split(key).any(is_of_sign)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn stated(source: &str) -> Result<Option<Products>, (Option<usize>, String)> {
        let text = Text::new(source.as_bytes(), true).unwrap();
        stated_products(&text).map_err(|refusal| (refusal.line, refusal.problem.to_string()))
    }

    const TENSOR: Option<Option<Products>> = Some(Some(Products::TensorEntries));
    const INTEGRALS: Option<Option<Products>> = Some(Some(Products::Integrals));

    /// Comments, and what they say: a convention, nothing, or what is refused.
    const LINES: [(&str, Option<Option<Products>>); 74] = [
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
        ("# tensor of inertia, sign convention as in CAD\n", Some(None)),
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
