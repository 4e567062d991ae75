//! What lines of a table that are no rows say of the sign of its products.

use crate::{
    Products,
    body::shortened,
    error::Refusal,
    products_said::{Said, assigned, bare, is_around, said},
    rows::titles,
    text::Text,
};

/// What may be said of products.
const ALLOWED: &str = "tensor (I12 = -∫xy dm) or integrals (+∫xy dm), with no other words";

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
    const LINES: [(&str, Option<Option<Products>>); 93] = [
        ("# sign of products: positive\n", None),
        ("# POI are positive\n", None),
        ("# products of inertia are defined as +∫ xy dm\n", None),
        ("# Off-diagonal terms are integrals\n", INTEGRALS),
        ("# off-diagonals: tensor\n", TENSOR),
        ("# Products are bolts and nuts\n", Some(None)),
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
