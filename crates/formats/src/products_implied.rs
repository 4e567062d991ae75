//! Lines of a table that give products a sign by a matrix, a formula, or a word beside them, in none of the words that are read.

use crate::products_words::{NAMES, is_neutral, is_of_sign, is_products, split};

/// What may be written before a product, or before the formula of one.
const SIGNS: [char; 4] = ['-', '−', '+', '±'];

/// Whether a line in small letters implies a sign: `[Ixx -Ixy -Ixz; …]`, `Ixy = Σ m x y`, `(Using positive tensor notation.)`, `POI positive`.
pub(crate) fn implies_sign(line: &str) -> bool {
    line.match_indices(SIGNS).any(|(at, _)| is_before_product(line, at))
        || line.match_indices('=').any(|(at, _)| is_formula(line, at))
        || has_word_of_sign(line)
}

/// Whether the sign at a place is that of a product. A dash between two words, or before an item of a list, is none.
fn is_before_product(line: &str, at: usize) -> bool {
    let (before, behind) = line.split_at(at);
    let behind = behind.trim_start_matches(SIGNS);
    let is_joined = !behind.starts_with(char::is_whitespace);
    let is_first = match before.trim_end().chars().next_back() {
        None => is_joined,
        Some(c) => "=([{,;:|".contains(c) || is_joined && before.ends_with(char::is_whitespace),
    };
    is_first && name(behind.split(|c| !is_of_name(c)).find(|word| !word.is_empty()))
}

/// Whether the `=` at a place gives a product a formula.
fn is_formula(line: &str, at: usize) -> bool {
    let (before, behind) = line.split_at(at);
    let before = before.trim_end_matches([' ', ':']);
    let value = behind.split([';', '|']).next().unwrap_or_default();
    let value = value.trim_start_matches(['=', ' ']);
    // Without indices: `m_i x_i y_i`.
    let letters: String = value.chars().filter(|c| c.is_alphabetic() && *c != 'i').collect();
    let is_sum = ["xy", "xz", "yz", "yx", "zx", "zy"]
        .iter()
        .any(|axes| letters.contains(&format!("m{axes}")) || letters.contains(&format!("{axes}m")));
    let is_signed = value.strip_prefix(SIGNS).map(str::trim_start);
    let is_signed = is_signed.is_some_and(|value| value.starts_with(char::is_alphabetic));
    name(before.rsplit(|c| !is_of_name(c)).next())
        && (is_sum
            || is_signed
            || value.contains(['∫', '∑'])
            || split(value).any(|word| word == "dm"))
}

fn is_of_name(c: char) -> bool {
    c.is_alphanumeric() || "_{}".contains(c)
}

/// Whether a word is the name of products, not that of two axes alone: `I_{xy}`, but not the face `-XY`.
fn name(word: Option<&str>) -> bool {
    let plain: String = word.unwrap_or_default().chars().filter(|c| c.is_alphanumeric()).collect();
    plain.len() > 2 && plain != "product" && is_products(&plain)
}

/// Whether a clause has nothing but `positive` or the like, or has it beside products, a tensor, a notation or a convention, or speaks of a sign of products.
fn has_word_of_sign(line: &str) -> bool {
    let is_subject = |word: &str| is_products(word) || word.starts_with("tensor");
    let speaks = split(line).any(|word| is_subject(word) || word.starts_with("inertia"));
    let is_sign = |word: &str| word.starts_with("positiv") || word.starts_with("negat");
    let is_beside = |word: &str| is_subject(word) || is_of_sign(word) || word == "notation";
    speaks
        && line.split([',', ';', '.', '(', ')', '[', ']', '|', '\t']).any(|clause| {
            let is_passed =
                |word: &&str| !is_neutral(word) && !["not", "all", "using"].contains(word);
            let words: Vec<&str> = split(clause).filter(is_passed).collect();
            // `positive definite`, `positive x`.
            let is_of_other = |word: &str| word.ends_with("definite") || word.chars().count() == 1;
            let is_signed = |at: usize, word: &str| {
                let next = words.get(at + 1);
                let before = at.checked_sub(1).and_then(|before| words.get(before));
                is_sign(word)
                    && !next.is_some_and(|next| is_of_other(next))
                    && (words.len() == 1
                        || before.into_iter().chain(next).any(|word| is_beside(word)))
            };
            let has_name = words.iter().any(|word| NAMES.contains(word) || name(Some(word)));
            let is_of_sign = |(at, word): (usize, &&str)| {
                ["sign", "signs"].contains(word) && words.get(at + 1) != Some(&"off")
            };
            words.iter().enumerate().any(|(at, word)| is_signed(at, word))
                || has_name && words.iter().enumerate().any(is_of_sign)
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::{prelude::*, sample::select};

    const NAMES: [&str; 6] = ["Ixy", "I_xz", "I12", "I_{yz}", "Iyx", "POI"];

    proptest! {
        /// A sign before a product is one of it, wherever that stands, and a dash between two words is none.
        #[test]
        fn signs_before_products_are_seen(
            before in select(&["I = [Ixx ", "I = (Ixx, ", "tensor: ", "Entries are ", "matrix is Ixx | "][..]),
            sign in select(&["-", "−", "+", "±"][..]),
            name in select(&NAMES[..]),
            after in select(&["", " -Ixz; -Ixy Iyy]", ", kg m2"][..]),
        ) {
            let line = format!("{before}{sign}{name}{after}").to_lowercase();
            prop_assert!(implies_sign(&line), "{}", line);
            for line in [format!("Ixx{sign}{name}"), format!("Ixx {sign} {name}, kg m2"), format!("- {name} in kg m2"), format!("CG, {name}"), format!("panel {sign}XY, {name}")] {
                prop_assert!(!implies_sign(&line.to_lowercase()), "{}", line);
            }
        }

        /// A formula of a product gives it a sign, and a number, a unit or another name does not.
        #[test]
        fn formulas_of_products_are_seen(
            before in select(&["", "matrix entries: ", "Mass in kg, ", "with "][..]),
            name in select(&NAMES[..]),
            mark in select(&[" = ", "=", " := "][..]),
            formula in select(&["sum(m*x*y)", "Σ m x y", "∑ m_i x_i y_i", "∫xy dm", "-∫ xz dm", "Int(xy dm)", "Σ x·y·m", "-Pxy", "- sum", "+S"][..]),
            value in select(&["0", "-0.5 kg m2", "0.5 by CAD", "Ixz = 0", "product of inertia about x and y", "n/a", "sum of all parts"][..]),
        ) {
            let line = |value: &str| format!("{before}{name}{mark}{value}").to_lowercase();
            prop_assert!(implies_sign(&line(formula)), "{}", line(formula));
            prop_assert!(!implies_sign(&line(value)), "{}", line(value));
        }

        /// `Positive` beside products, a tensor or a convention gives a sign, and beside anything else it does not.
        #[test]
        fn words_of_signs_are_seen(
            before in select(&["", "Moments of inertia: taken at the center of mass. ", "Mass, CG, ", "Convention: "][..]),
            sign in select(&["positive", "negative", "positively", "negated"][..]),
            form in select(&[
                "(Using S tensor notation.)", "S POI", "POI S", "Ixy S", "S product convention used", "Tensor notation: S", "products of inertia (S)",
                "Inertia tensor, S convention", "Ixy, Ixz, Iyz are NOT S", "all products of inertia are S", "products with the sign of CAD",
            ][..]),
            other in select(&[
                "inertia tensor is S definite", "S definite inertia tensor", "products of inertia, z S up", "Axes: S x forward, inertia tensor",
                "moments of inertia are S", "Ixx, Iyy, Izz must be S; Ixy may be S", "POI of the panel on the S side", "product sign-off: J. Doe",
                "products of inertia in kg m2", "sign convention: right-handed; moments plus products",
            ][..]),
        ) {
            let of = |form: &str| format!("{before}{}", form.replace('S', sign)).to_lowercase();
            prop_assert!(implies_sign(&of(form)), "{}", of(form));
            prop_assert!(!implies_sign(&of(other)), "{}", of(other));
        }
    }
}
