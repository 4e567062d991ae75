//! Headings that look like a product of inertia under a name that does not tell its sign.

use crate::{body::entry_of, spread, units::longest_name};

/// The two axes of a product, in letters and in digits.
const LETTERS: [&str; 6] = ["xy", "xz", "yz", "yx", "zx", "zy"];
const DIGITS: [&str; 6] = ["12", "13", "23", "21", "31", "32"];

/// What products and moments are called in formulas.
const SYMBOLS: [&str; 5] = ["i", "j", "k", "l", "p"];

/// Words of products and inertias, which make a product with two axes. The shorter ones are of other things beside
/// digits: `IO 12`.
const WORDS: [&str; 15] = [
    "poi",
    "moi",
    "prod",
    "product",
    "products",
    "productofinertia",
    "inertia",
    "inertias",
    "inertial",
    "moment",
    "moments",
    "tensor",
    "integral",
    "integrals",
    "centrifugal",
];
const SHORT_WORDS: [&str; 8] = ["i", "j", "pi", "io", "ig", "icg", "icog", "icom"];

/// Whether a heading that is neither read nor the name of a deviation looks like a product of inertia.
pub(crate) fn is_unread_product(heading: &str) -> bool {
    // Longer texts are none, and would be searched for names for long.
    if heading.len() > 200 {
        return false;
    }
    let like = |name: &str| is_like_product(name).then_some(());
    longest_name(heading, like).is_some_and(|((), tail)| tail.is_apart())
        || (!spread::is_marked(heading) && !spread::has_word(heading) && holds_product(heading))
}

/// Whether a name is as good as that of a product of inertia, as programs call it that have a sign of their own: `Pxy`, `Lxy`.
fn is_like_product(name: &str) -> bool {
    let mut pairs = LETTERS.iter().chain(&DIGITS);
    let word = pairs.find_map(|pair| name.strip_suffix(pair));
    let is_word = |word: &str| SYMBOLS.contains(&word) || WORDS.contains(&word);
    entry_of(name).is_none() && word.is_some_and(is_word)
}

/// Whether one is named anywhere in a heading, with other words or marks around it: `POI Ixy`, `inertia_xy`, `∫xy dm`.
fn holds_product(heading: &str) -> bool {
    let words = words(heading);
    let is_integral = heading.contains('∫');
    let is_of_products = |word: &str| WORDS.contains(&word) || SHORT_WORDS.contains(&word);
    let speaks_of_products = is_integral || words.iter().any(|word| is_of_products(word));
    words.iter().enumerate().any(|(at, word)| {
        let before = words[..at].last().map_or("", String::as_str);
        let after = words.get(at + 1).map_or("", String::as_str);
        let in_letters =
            LETTERS.iter().any(|pair| match (word.strip_suffix(pair), word.strip_prefix(pair)) {
                (Some(""), _) => speaks_of_products || is_letter(before),
                (Some(name), _) => {
                    let is_in_order = LETTERS[..3].contains(pair);
                    let is_symbol = SYMBOLS.contains(&name) || (is_in_order && is_letter(name));
                    is_symbol || name.ends_with('i') || is_of_products(name)
                }
                (None, Some(rest)) => is_integral || is_of_products(rest),
                (None, None) => word.strip_prefix('i').is_some_and(|rest| rest.starts_with(pair)),
            });
        let in_digits = DIGITS.iter().any(|pair| match word.strip_suffix(pair) {
            Some("") => {
                ["i", "j"].contains(&before) || WORDS.contains(&before) || WORDS.contains(&after)
            }
            Some(name) => ["i", "j"].contains(&name) || WORDS.contains(&name),
            None => false,
        });
        in_letters || in_digits
    })
}

/// Whether a word is a letter that may stand for a product. `oxy` is another word, and `zxy` an order of axes.
fn is_letter(word: &str) -> bool {
    word.len() == 1 && word.chars().all(|c| c.is_ascii_lowercase() && !"oxyz".contains(c))
}

/// The words of a heading in small letters, axes that stand apart as one word: `I(x, y)` has `i` and `xy`.
fn words(heading: &str) -> Vec<String> {
    let digit = |c| match c {
        '₁' => '1',
        '₂' => '2',
        '₃' => '3',
        other => other,
    };
    let heading: String = heading.to_lowercase().chars().map(digit).collect();
    let mut words: Vec<String> = Vec::new();
    let mut ends_in_axis = false;
    for word in spread::words(&heading).filter(|word| !word.is_empty()) {
        let is_axis = word.len() == 1 && "xyz123".contains(word);
        match words.last_mut() {
            Some(last) if is_axis && ends_in_axis => last.push_str(word),
            _ => words.push(word.to_owned()),
        }
        ends_in_axis = is_axis;
    }
    words
}
