//! References to entities in XML: to those that every reader knows, and to those that a file declares itself.

/// Whether a reference is one that every reader knows: a character by its number, or one of five.
pub(crate) fn is_character(reference: &str) -> bool {
    reference.starts_with('#') || matches!(reference, "lt" | "gt" | "amp" | "quot" | "apos")
}

/// How many references to entities of a file's own are in the value of an attribute. An `&` before what is no name is none, as in `a=1&b=2;`.
pub(crate) fn entities_in(value: &str) -> usize {
    let is_name = |name: &&str| {
        let plain = |c: char| c.is_alphanumeric() || "_:-.".contains(c);
        name.starts_with(|c: char| c.is_alphabetic() || c == '_' || c == ':')
            && name.chars().all(plain)
    };
    let names = value.split('&').skip(1).filter_map(|rest| Some(rest.split_once(';')?.0));
    names.filter(is_name).filter(|name| !is_character(name)).count()
}
