//! Rust source as tokens, without comments, literals and tests: enough to see which paths it names.

/// A word, `::`, or any other sign.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Token {
    Word(String),
    Path,
    Sign(char),
}

impl Token {
    pub(crate) fn word(&self) -> Option<&str> {
        match self {
            Self::Word(word) => Some(word),
            Self::Path | Self::Sign(_) => None,
        }
    }

    pub(crate) fn is(&self, sign: char) -> bool {
        *self == Self::Sign(sign)
    }
}

/// The tokens of a source; items under `#[cfg(test)]` are left out.
pub(crate) fn tokens(source: &str) -> Vec<Token> {
    without_tests(&scan(source))
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn scan(source: &str) -> Vec<Token> {
    let mut found = Vec::new();
    let mut rest = source;
    while let Some(c) = rest.chars().next() {
        let after = if rest.starts_with("//") {
            rest.find('\n').map_or("", |end| &rest[end..])
        } else if let Some(open) = rest.strip_prefix("/*") {
            // Comments in comments are not written here.
            open.split_once("*/").map_or("", |(_, after)| after)
        } else if let Some(after) = raw_string(rest) {
            after
        } else if let Some(open) = rest.strip_prefix('"') {
            closed(open, '"')
        } else if let Some(open) = rest.strip_prefix('\'') {
            // 'a' and '\n' are characters, 'a a lifetime.
            let mut inside = open.chars();
            let first = inside.next();
            if first == Some('\\') || inside.next() == Some('\'') {
                closed(open, '\'')
            } else {
                open
            }
        } else if is_word(c) {
            let end = rest.find(|c| !is_word(c)).unwrap_or(rest.len());
            found.push(Token::Word(rest[..end].to_owned()));
            &rest[end..]
        } else if let Some(after) = rest.strip_prefix("::") {
            found.push(Token::Path);
            after
        } else {
            if !c.is_whitespace() {
                found.push(Token::Sign(c));
            }
            &rest[c.len_utf8()..]
        };
        rest = after;
    }
    found
}

/// What stands after a raw string that a text begins with.
fn raw_string(text: &str) -> Option<&str> {
    let open = text.strip_prefix("br").or_else(|| text.strip_prefix('r'))?;
    let hashes = open.len() - open.trim_start_matches('#').len();
    let inside = open[hashes..].strip_prefix('"')?;
    let end = format!("\"{}", "#".repeat(hashes));
    Some(inside.split_once(&end).map_or("", |(_, after)| after))
}

/// What stands after the end of a literal, of which the beginning is gone.
fn closed(inside: &str, end: char) -> &str {
    let mut escaped = false;
    let close = inside.find(|c| {
        let ends = c == end && !escaped;
        escaped = c == '\\' && !escaped;
        ends
    });
    close.map_or("", |at| &inside[at + 1..])
}

fn without_tests(tokens: &[Token]) -> Vec<Token> {
    let attribute = scan("#[cfg(test)]");
    let mut kept = Vec::new();
    let mut rest = tokens;
    while !rest.is_empty() {
        if rest.starts_with(&attribute) {
            rest = &rest[item(rest)..];
        } else {
            kept.push(rest[0].clone());
            rest = &rest[1..];
        }
    }
    kept
}

/// How many tokens an item has: to the semicolon or to the closing brace, whichever ends it.
fn item(tokens: &[Token]) -> usize {
    let mut depth = 0;
    for (i, token) in tokens.iter().enumerate() {
        match token {
            Token::Sign('{' | '(' | '[') => depth += 1,
            Token::Sign(close @ ('}' | ')' | ']')) => {
                depth -= 1;
                if depth == 0 && *close == '}' {
                    return i + 1;
                }
            }
            Token::Sign(';') if depth == 0 => return i + 1,
            Token::Sign(_) | Token::Path | Token::Word(_) => {}
        }
    }
    tokens.len()
}

#[test]
fn tests_comments_and_literals_are_left_out() {
    let source = r##"
        use a::b; // use c::d;
        /* e::f */ const X: &'static str = "g::h \" i"; let c = ['"', '\'', 'k']; r#"l::m "n"#;
        #[cfg(test)]
        mod tests { use o::p; fn q() { r::s() } }
        #[cfg(test)] mod t;
        fn u() {}
    "##;
    let words: Vec<_> = tokens(source).iter().filter_map(|t| t.word().map(str::to_owned)).collect();
    let expected = "use a b const X static str let c fn u";
    assert_eq!(words.join(" "), expected);
}
