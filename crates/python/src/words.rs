//! Messages of readers in the words of Python: `a dictionary` for `map` or `struct Fields`.

/// What a reader calls something, and what it is in Python, the longer ones first.
const WORDS: [(&str, &str); 12] = [
    ("a sequence", "a list"),
    ("sequence", "a list"),
    ("an array of length", "a list of length"),
    ("a table", "a dictionary"),
    ("map", "a dictionary"),
    ("a string", "a text"),
    ("string", "a text"),
    ("variant identifier", "a name"),
    ("f64", "a number"),
    ("null", "None"),
    ("field", "key"),
    ("variant", "name"),
];

/// The message without the names of types in Rust. What the user has written stands in quotation marks, and stays.
pub(crate) fn in_python(message: &str) -> String {
    let mut plain = String::with_capacity(message.len());
    let mut rest = message;
    while let Some(start) = rest.find(['`', '"']) {
        let (said, quoted) = rest.split_at(start);
        // The marks are one byte.
        let mark = &quoted[..1];
        let end = quoted[1..].find(mark).map_or(quoted.len(), |end| end + 2);
        plain.push_str(&translated(said));
        plain.push_str(&quoted[..end]);
        rest = &quoted[end..];
    }
    plain.push_str(&translated(rest));
    plain
}

fn translated(said: &str) -> String {
    let mut plain = said.to_owned();
    for named in ["internally tagged enum ", "struct ", "tuple struct ", "enum "] {
        while let Some(start) = plain.find(named) {
            let after = start + named.len();
            let name = |c: char| !(c.is_ascii_alphanumeric() || c == '_');
            let end = plain[after..].find(name).map_or(plain.len(), |end| after + end);
            plain.replace_range(start..end, "a dictionary");
        }
    }
    let mut found = String::with_capacity(plain.len());
    let mut rest = plain.as_str();
    while let Some(first) = rest.chars().next() {
        let begins = !found.ends_with(|c: char| c.is_ascii_alphanumeric());
        let word = WORDS.iter().find(|(word, _)| {
            let after = rest.strip_prefix(word);
            begins && after.is_some_and(|after| !after.starts_with(char::is_alphanumeric))
        });
        let (length, text) = match word {
            Some((word, text)) => (word.len(), *text),
            None => (first.len_utf8(), &rest[..first.len_utf8()]),
        };
        found.push_str(text);
        rest = &rest[length..];
    }
    found
}
