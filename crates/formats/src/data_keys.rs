//! The keys of a body in TOML and JSON, and which others are slips for one of them.

use crate::{
    FileBodyError,
    body::shortened,
    units::{Dimension, Unit, UnitProblem},
};

pub(crate) const INERTIA: &str = "inertia_kg_m2";
pub(crate) const MASS: &str = "mass_kg";
pub(crate) const PRODUCTS: &str = "products";
const NAME: &str = "name";

/// Whether a key of a body is read.
pub(crate) fn is_read(key: &str) -> bool {
    [NAME, MASS, INERTIA, PRODUCTS].contains(&key)
}

/// Whether a key of a document that is no body itself is read, or is its name, which says nothing of its bodies.
pub(crate) fn is_read_of_all(key: &str) -> bool {
    [NAME, PRODUCTS].contains(&key)
}

/// Which key a body was meant to have by one that is not read: in other letters, with one letter wrong, or with
/// another unit, or none. Files of other programs may have more keys than ours, so that all others mean nothing here.
pub(crate) fn meant(key: &str) -> Option<&'static str> {
    if is_read(key) {
        return None;
    }
    let plain = |text: &str| -> Vec<u8> {
        text.bytes().filter(u8::is_ascii_alphanumeric).map(|b| b.to_ascii_lowercase()).collect()
    };
    let letters = plain(key);
    let near = [MASS, INERTIA, PRODUCTS].into_iter().find(|known| is_near(&letters, &plain(known)));
    let lower = key.trim().to_ascii_lowercase();
    let in_a_unit = |word: &str, dimension: Dimension| {
        lower.strip_prefix(word).is_some_and(|rest| {
            // Either of two units is one, too.
            matches!(
                Unit::of(&rest.replace(['_', '-'], " "), dimension),
                Ok(_) | Err(UnitProblem::Ambiguous { .. })
            )
        })
    };
    near.or_else(|| in_a_unit("mass", Dimension::Mass).then_some(MASS))
        .or_else(|| in_a_unit("inertia", Dimension::Inertia).then_some(INERTIA))
}

/// What is said of a key that is a slip.
pub(crate) fn error(key: &str) -> FileBodyError {
    let allowed = "name, mass_kg, inertia_kg_m2 and products";
    FileBodyError::Key { key: shortened(key), allowed }
}

/// Whether two words are equal but for one letter, which is another one, or which one of them lacks.
fn is_near(one: &[u8], other: &[u8]) -> bool {
    let (short, long) = if one.len() <= other.len() { (one, other) } else { (other, one) };
    let same = short.iter().zip(long).take_while(|(a, b)| a == b).count();
    match long.len() - short.len() {
        0 => {
            short[same..].get(1..).unwrap_or_default() == long[same..].get(1..).unwrap_or_default()
        }
        1 => short[same..] == long[same + 1..],
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_told_from_keys_of_others() {
        for (key, known) in [
            ("mass", MASS),
            ("Mass", MASS),
            ("mass_KG", MASS),
            ("masskg", MASS),
            ("mass-kg", MASS),
            ("mass_lb", MASS),
            ("mass (g)", MASS),
            ("mas_kg", MASS),
            ("mass_kgs", MASS),
            ("inertia", INERTIA),
            ("Inertia_kg_m2", INERTIA),
            ("inertia_kgm2", INERTIA),
            ("inertia_kg_m", INERTIA),
            ("inertia_kg_mm2", INERTIA),
            ("inertia_lb_ft2", INERTIA),
            ("inertial_kg_m2", INERTIA),
            ("Products", PRODUCTS),
            ("product", PRODUCTS),
            ("prodcts", PRODUCTS),
        ] {
            assert_eq!(meant(key), Some(known), "{key}");
        }
        for key in [
            NAME,
            MASS,
            INERTIA,
            PRODUCTS,
            "",
            "Name",
            "mass_centre_m",
            "massless",
            "mass_percent",
            "inertia_drawn",
            "inertia_source",
            "productions",
            "position_m",
            "dispersion",
        ] {
            assert_eq!(meant(key), None, "{key}");
        }
    }
}
