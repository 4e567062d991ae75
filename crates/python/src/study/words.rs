//! Errors of studies in the words of Python.

use gyradius_study::StudyError;

/// What is said of an error, with keyword arguments in the place of the program's options: `out=...` for `--out`, `force=True` for
/// `pass --force`. They are called alike.
pub(super) fn in_keywords(error: &StudyError) -> String {
    let text = error.to_string();
    match error {
        StudyError::Folder { path, .. }
        | StudyError::ReadOnly { path, .. }
        | StudyError::Room { path, .. }
        | StudyError::Reduced { path, .. } => {
            // In a path anything may stand.
            let path = path.display().to_string();
            match text.split_once(&path) {
                Some((before, after)) => format!("{before}{path}{}", translated(after)),
                None => translated(&text),
            }
        }
        StudyError::Memory { .. } | StudyError::Campaign(_) => translated(&text),
        // What is wrong with a scenario, with files or with numbers names no option. The enum may grow.
        _ => text,
    }
}

/// With keyword arguments in the place of options.
pub(super) fn translated(text: &str) -> String {
    let mut parts = text.split(" --");
    let mut translated = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let end = part.find(|c: char| !(c.is_ascii_lowercase() || c == '-')).unwrap_or(part.len());
        let (option, rest) = part.split_at(end);
        let value = if translated.ends_with("pass") { "True" } else { "..." };
        translated.push_str(&format!(" {}={value}{rest}", option.replace('-', "_")));
    }
    // What goes on, and what was killed.
    translated.replace("command goes on", "call goes on").replace("a command was", "a call was")
}
