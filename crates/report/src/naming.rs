//! The first of many names, and how many more there are.

/// The first names, at most so many, and how many others follow.
#[must_use]
pub fn first_names(names: impl IntoIterator<Item = String>, most: usize) -> String {
    let mut names: Vec<String> = names.into_iter().collect();
    let others = names.len().saturating_sub(most);
    names.truncate(most);
    let first = names.join(", ");
    if others == 0 { first } else { format!("{first} and {others} more") }
}
