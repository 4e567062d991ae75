//! Text as one word of a script for bash.

use std::{ffi::OsStr, fmt::Write, path::Path};

use gyradius_study::visible;

/// A word that bash reads as exactly this text, on one line, whatever stands in it. Bytes that are no text, characters that
/// command a terminal and ends of lines are written as numbers.
pub(crate) fn quote(text: &OsStr) -> String {
    let plain =
        text.to_str().filter(|text| visible(text) == *text && !text.contains(['\n', '\t', '\'']));
    match plain {
        Some(text) if !text.is_empty() && text.bytes().all(is_bare) => text.to_owned(),
        Some(text) => format!("'{text}'"),
        None => {
            let mut word = "$'".to_owned();
            for &byte in text.as_encoded_bytes() {
                if byte == b'\'' || byte == b'\\' {
                    word.push('\\');
                    word.push(char::from(byte));
                } else if byte == b' ' || byte.is_ascii_graphic() {
                    word.push(char::from(byte));
                } else {
                    // Three digits, so that the next character is none of them. Writing to a string does not fail.
                    let _ = write!(word, "\\{byte:03o}");
                }
            }
            word + "'"
        }
    }
}

/// A path as one word of a command, which takes it for no option if it begins with a hyphen.
pub(crate) fn quote_path(path: &Path) -> String {
    let is_option = path.as_os_str().as_encoded_bytes().starts_with(b"-");
    quote(if is_option { Path::new(".").join(path) } else { path.to_owned() }.as_os_str())
}

/// What means itself in a shell, at any place of a word.
fn is_bare(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || b"/._-+:@%".contains(&byte)
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use super::*;
    use proptest::{collection::vec, prelude::*};
    use std::{ffi::OsString, os::unix::ffi::OsStringExt, process::Command};

    /// What bash makes of some words, in a folder in which `*` would be something.
    fn read_by_bash(words: &[OsString]) -> Vec<Vec<u8>> {
        let quoted: Vec<String> = words.iter().map(|word| quote(word)).collect();
        let script = format!("printf '%s\\0' {}", quoted.join(" "));
        assert_eq!(script.lines().count(), 1);
        let output = Command::new("bash").args(["-c", &script]).output().unwrap();
        assert!(output.status.success() && output.stderr.is_empty(), "{script}: {output:?}");
        let mut read: Vec<Vec<u8>> =
            output.stdout.split(|byte| *byte == 0).map(Vec::from).collect();
        assert_eq!(read.pop(), Some(Vec::new()));
        read
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]

        /// Any bytes, characters that mean something to a shell often, any characters.
        #[test]
        fn bash_reads_what_was_quoted(
            bytes in vec(vec(1..=255_u8, 0..20), 1..20),
            special in vec("[ '\"$`\\\\(){}\\[\\]*?!#&;|<>~^=\n\t\r\x1b0-9a-\u{e9}-]{0,12}", 1..20),
            any in vec("[^\0]{0,10}", 1..20),
        ) {
            let words: Vec<OsString> = bytes
                .into_iter()
                .chain(special.into_iter().map(String::into_bytes))
                .chain(any.into_iter().map(String::into_bytes))
                .map(OsString::from_vec)
                .collect();
            let expected: Vec<Vec<u8>> = words.iter().cloned().map(OsString::into_vec).collect();
            prop_assert_eq!(read_by_bash(&words), expected);
        }
    }

    #[test]
    fn words_are_legible() {
        for (text, word) in [
            ("", "''"),
            ("/home/a/b-1.toml", "/home/a/b-1.toml"),
            ("~", "'~'"),
            ("my study", "'my study'"),
            ("$(rm -r x)", "'$(rm -r x)'"),
            ("é", "'é'"),
            ("it's", "$'it\\'s'"),
            ("a\nb", "$'a\\012b'"),
            ("a\u{202e}b", "$'a\\342\\200\\256b'"),
        ] {
            assert_eq!(quote(OsStr::new(text)), word);
        }
    }
}
