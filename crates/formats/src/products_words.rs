//! The words in which lines of a table speak of products of inertia and their sign.

use crate::{
    body::{entry_of, lower_of},
    spread::words,
};

/// What the products are called as a whole, where `product` may be that of a company.
pub(crate) const NAMES: [&str; 4] = ["products", "poi", "pois", "poiconv"];

/// Words that speak of a sign.
const OF_SIGNS: [&str; 4] = ["sign", "signs", "convention", "conventions"];

/// Words that change nothing in a statement on the sign of products.
const NEUTRAL: [&str; 19] = [
    "of", "the", "for", "are", "is", "as", "and", "in", "this", "these", "file", "given",
    "defined", "others", "inertia", "entries", "entry", "elements", "terms",
];

/// The words of a text, none of them empty.
pub(crate) fn split(text: &str) -> impl Iterator<Item = &str> {
    words(text).filter(|word| !word.is_empty())
}

/// Whether a word is that of products, or the name of one.
pub(crate) fn is_products(word: &str) -> bool {
    // `Ixy`, and what is left of `I_xy`, but not the number 12.
    let is_entry =
        |name: &str| entry_of(name).is_some_and(|entry| entry >= 3) || lower_of(name).is_some();
    word == "product"
        || NAMES.contains(&word)
        || is_entry(word)
        || word.len() == 2 && word.starts_with(char::is_alphabetic) && is_entry(&format!("i{word}"))
}

pub(crate) fn is_of_sign(word: &str) -> bool {
    OF_SIGNS.contains(&word)
}

pub(crate) fn is_neutral(word: &str) -> bool {
    NEUTRAL.contains(&word)
}

pub(crate) fn speaks_of_products(text: &str) -> bool {
    split(text).any(is_products)
}
