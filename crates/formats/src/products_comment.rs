//! What comments in a table say of the sign of its products.

use crate::{Products, body::shortened, error::Refusal, text::Text};

/// What may be said of products.
const ALLOWED: &str = "tensor (I12 = -∫xy dm) or integrals (+∫xy dm)";

/// What the comments say of the products: `# products = integrals`.
///
/// # Errors
/// The first word after `# products =` is none of those known, or two lines contradict each other.
pub(crate) fn stated_products(text: &Text) -> Result<Option<Products>, Refusal> {
    let mut stated: Option<(Products, usize)> = None;
    let mut at = 0;
    for line in text.as_str().split_inclusive('\n') {
        let start = at;
        at += line.len();
        let Some(comment) = line.strip_prefix('#') else { continue };
        let comment = comment.trim().to_lowercase();
        let Some(rest) = comment.strip_prefix("products") else { continue };
        let words = rest.split(|c: char| c.is_whitespace() || "=:,;.\"'".contains(c));
        let mut words = words.filter(|word| !word.is_empty());
        let found = match rest.trim_start().strip_prefix('=') {
            Some(said) => {
                let refused = || {
                    let said = shortened(said.trim());
                    text.malformed(start, format!("products = {said}: it must be {ALLOWED}"))
                };
                words.next().and_then(Products::parse).ok_or_else(refused)?
            }
            // A sentence about products need not speak of their sign.
            None => match words.find_map(Products::parse) {
                Some(products) => products,
                None => continue,
            },
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn stated(source: &str) -> Result<Option<Products>, (Option<usize>, String)> {
        let text = Text::new(source.as_bytes(), true).unwrap();
        stated_products(&text).map_err(|refusal| (refusal.line, refusal.problem.to_string()))
    }

    proptest! {
        /// Any number of lines above and below the header, of which each says tensor, integrals, nothing, or something that is
        /// neither.
        #[test]
        fn the_first_wrong_line_is_named(
            lines in prop::collection::vec(0..6_usize, 0..7),
            above in 0..7_usize,
        ) {
            const LINES: [(&str, Option<Option<Products>>); 6] = [
                ("# products = integrals, not tensor entries\n", Some(Some(Products::Integrals))),
                ("#Products=\"tensor\"\r\n", Some(Some(Products::TensorEntries))),
                ("# products: integrals\n", Some(Some(Products::Integrals))),
                ("# products of inertia are those of the CAD program\n", Some(None)),
                ("# products = integral\n", None),
                ("# products = not tensor\n", None),
            ];
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
}
