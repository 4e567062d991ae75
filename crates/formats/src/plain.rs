//! Single files read and written with care: no pipe is waited for, nothing is read without a limit, and
//! nothing is written through a link, by halves, or over another file unasked.

use crate::{
    new_file::{NewFile, WriteError, there},
    text::no_text,
};
use std::{
    fs::{self, File, Permissions},
    io::{self, Read},
    path::Path,
};

/// The text of a regular file of at most so many bytes.
///
/// # Errors
/// It is no regular file, or larger, or not UTF-8, or the system refuses.
pub fn read_text(path: &Path, most_bytes: u64) -> io::Result<String> {
    // Asked before opening, which would wait for the other end of a pipe.
    if !fs::metadata(path)?.is_file() {
        return Err(io::Error::other("it is not a regular file"));
    }
    let mut bytes = Vec::new();
    File::open(path)?.take(most_bytes + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most_bytes {
        let problem = format!("it is larger than {} MiB", most_bytes >> 20);
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, problem));
    }
    let no_text = no_text(&bytes).map(|problem| problem.to_string());
    let text = no_text.map_or(Ok(bytes), Err).and_then(|bytes| {
        String::from_utf8(bytes).map_err(|_| "it is not UTF-8: save it as UTF-8".to_owned())
    });
    text.map_err(|problem| io::Error::new(io::ErrorKind::InvalidData, problem))
}

/// Whether two paths lead to one file, by links of either kind too; not where one of them leads to none.
#[must_use]
pub fn is_same_file(one: &Path, other: &Path) -> bool {
    match (fs::canonicalize(one), fs::canonicalize(other)) {
        (Ok(a), Ok(b)) => a == b || is_hard_link(&a, &b),
        (Ok(_) | Err(_), _) => false,
    }
}

/// Whether two names are those of one file.
#[cfg(unix)]
fn is_hard_link(one: &Path, other: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let of = |path| fs::metadata(path).map(|metadata| (metadata.dev(), metadata.ino()));
    matches!((of(one), of(other)), (Ok(one), Ok(other)) if one == other)
}

/// Whether two names are those of one file, which only Unix tells.
#[cfg(not(unix))]
fn is_hard_link(_: &Path, _: &Path) -> bool {
    false
}

/// Whether a file has to be written to have this content; one that has it already is left alone. What is
/// there is replaced with `force` only, and only if it is a regular file.
///
/// # Errors
/// Something else is there, or the system refuses.
pub fn must_write(path: &Path, bytes: &[u8], force: bool) -> Result<bool, WriteError> {
    let fail = |error| WriteError::Io { path: path.to_owned(), error };
    let Some(there) = there(path)? else { return Ok(true) };
    if there.len() == bytes.len() as u64 && fs::read(path).map_err(fail)? == bytes {
        Ok(false)
    } else if force {
        Ok(true)
    } else {
        Err(WriteError::Exists(path.to_owned()))
    }
}

/// Writes a file, whole or not at all, and brings it to the disk; see [`must_write`] for what is
/// replaced. Returns whether anything had to be written.
///
/// # Errors
/// As [`must_write`].
pub fn write_file(path: &Path, bytes: &[u8], force: bool) -> Result<bool, WriteError> {
    write_file_as(path, bytes, force, None)
}

/// The same with these permissions, from before the first byte on; without any it has those of the file that it
/// replaces, or of a new one.
///
/// # Errors
/// As [`must_write`].
pub fn write_file_as(
    path: &Path,
    bytes: &[u8],
    force: bool,
    permissions: Option<Permissions>,
) -> Result<bool, WriteError> {
    if !must_write(path, bytes, force)? {
        return Ok(false);
    }
    let new = NewFile::create_as(path, force, permissions.clone());
    match new.and_then(|new| new.finish_with(bytes)) {
        Ok(()) => Ok(true),
        // Another program has written something in the meantime, which may be the same.
        Err(WriteError::Exists(_)) => write_file_as(path, bytes, force, permissions),
        Err(error) => Err(error),
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::{
        io::Write,
        os::unix::fs::{PermissionsExt, symlink},
    };

    /// A file by itself, by links, by links to links and by other names, from another folder too; and what is another file.
    #[test]
    fn links_of_either_kind_lead_to_the_same_file() {
        let scratch = tempfile::tempdir().unwrap();
        let at = |name: &str| scratch.path().join(name);
        fs::create_dir(at("folder")).unwrap();
        fs::write(at("file"), "x").unwrap();
        fs::write(at("other"), "x").unwrap();
        fs::hard_link(at("file"), at("hard")).unwrap();
        symlink("file", at("soft")).unwrap();
        symlink("soft", at("twice")).unwrap();
        symlink("hard", at("both")).unwrap();
        symlink("..", at("folder/up")).unwrap();
        symlink("nowhere", at("lost")).unwrap();
        let same = ["file", "hard", "soft", "twice", "both", "folder/up/file", "folder/../hard"];
        let others = ["other", "folder", "lost", "nowhere"];
        for (one, other) in same.iter().flat_map(|a| same.iter().map(move |b| (a, b))) {
            assert!(is_same_file(&at(one), &at(other)), "{one} {other}");
        }
        for (one, other) in same.iter().flat_map(|a| others.iter().map(move |b| (a, b))) {
            assert!(!is_same_file(&at(one), &at(other)) && !is_same_file(&at(other), &at(one)));
        }
    }

    /// Whoever writes the same bytes at the same time is in nobody's way.
    #[test]
    fn two_may_write_the_same() {
        let scratch = tempfile::tempdir().unwrap();
        let write_all = |bytes: &[u8]| -> Vec<bool> {
            let path = |i: u32| scratch.path().join(i.to_string());
            (0..200).map(|i| write_file(&path(i), bytes, false).unwrap()).collect()
        };
        let both = std::thread::scope(|scope| {
            let two = [(); 2].map(|()| scope.spawn(|| write_all(b"the same")));
            two.map(|thread| thread.join().unwrap())
        });
        assert!(std::iter::zip(&both[0], &both[1]).all(|(one, other)| one != other));
    }

    /// Every kind of thing that may be at a path, with and without force.
    #[test]
    fn what_is_there_is_replaced_only_if_it_is_a_file_and_by_force() {
        for (kind, force) in (0..8).flat_map(|kind| [(kind, false), (kind, true)]) {
            let scratch = tempfile::tempdir().unwrap();
            let path = scratch.path().join("fragment.toml");
            let elsewhere = scratch.path().join("elsewhere");
            fs::write(&elsewhere, "dear").unwrap();
            match kind {
                0 => {}
                1 => fs::write(&path, "mine").unwrap(),
                2 => fs::write(&path, "new").unwrap(),
                3 => fs::create_dir(&path).unwrap(),
                4 => symlink(&elsewhere, &path).unwrap(),
                5 => symlink(scratch.path().join("nowhere"), &path).unwrap(),
                6 => {
                    fs::write(&path, "mine").unwrap();
                    fs::set_permissions(&path, Permissions::from_mode(0o400)).unwrap();
                }
                _ => assert!(
                    std::process::Command::new("mkfifo").arg(&path).status().unwrap().success()
                ),
            }
            let kind_before = fs::symlink_metadata(&path).ok().map(|m| m.file_type());
            let mode = fs::symlink_metadata(&path).ok().map(|m| m.permissions().mode());
            // By pieces, of a file that is never the same as the one that is there.
            if kind != 2 {
                let begun = NewFile::create(&path, force);
                assert_eq!(begun.is_ok(), kind == 0 || (force && matches!(kind, 1 | 6)), "{kind}");
                if let Ok(mut begun) = begun {
                    begun.write_all(b"half").unwrap();
                }
            }
            let result = write_file(&path, b"new", force);
            let expected = match (kind, force) {
                (0, _) | (1 | 6, true) => Some(true),
                (2, _) => Some(false),
                _ => None,
            };
            assert_eq!(result.as_ref().ok().copied(), expected, "{kind} {force}: {result:?}");
            if let Some(before) = kind_before {
                let after = fs::symlink_metadata(&path).unwrap();
                assert_eq!(after.file_type(), before);
                assert_eq!(Some(after.permissions().mode()), mode);
            }
            if kind <= 2 || kind == 6 {
                let text = if expected.is_some() { "new" } else { "mine" };
                assert_eq!(fs::read_to_string(&path).unwrap(), text, "{kind} {force}");
            }
            assert_eq!(fs::read_to_string(&elsewhere).unwrap(), "dear");
            assert!(!scratch.path().join("nowhere").exists());
            let count = fs::read_dir(scratch.path()).unwrap().count();
            assert_eq!(count, 1 + usize::from(kind != 0 || expected.is_some()), "no drafts");
        }
    }

    /// Any text in sixteen bits a character, with a mark and without, either end first, is told what to do.
    #[test]
    fn other_encodings_are_told_what_to_do() {
        let scratch = tempfile::tempdir().unwrap();
        let path = scratch.path().join("file.toml");
        for text in ["ab", "name = \"study\"\nruns = 5\n", "[nominal]\nmass_kg = 1.0 # ± 2 %\n"] {
            for (mark, little) in [(true, true), (true, false), (false, true), (false, false)] {
                let marked = mark.then_some('\u{feff}').into_iter().chain(text.chars());
                let units: Vec<u16> = marked.collect::<String>().encode_utf16().collect();
                let bytes = |u: &u16| if little { u.to_le_bytes() } else { u.to_be_bytes() };
                fs::write(&path, units.iter().flat_map(bytes).collect::<Vec<u8>>()).unwrap();
                let message = read_text(&path, 1 << 20).unwrap_err().to_string();
                assert_eq!(message, "it is encoded in UTF-16: save it as UTF-8", "{text}");
            }
            fs::write(&path, text).unwrap();
            assert_eq!(read_text(&path, 1 << 20).unwrap(), text);
        }
        fs::write(&path, b"a = \"\xe9\"").unwrap();
        let message = read_text(&path, 1 << 20).unwrap_err().to_string();
        assert_eq!(message, "it is not UTF-8: save it as UTF-8");
        for (bytes, told) in [(&b"PAR1\x15\0"[..], "Parquet"), (b"PK\x03\x04\x14\0", ".xlsx")] {
            fs::write(&path, bytes).unwrap();
            let message = read_text(&path, 1 << 20).unwrap_err().to_string();
            assert!(message.contains(told), "{message}");
        }
    }

    #[test]
    fn only_regular_files_within_the_limit_are_read() {
        let scratch = tempfile::tempdir().unwrap();
        let path = scratch.path().join("file");
        for (length, allowed) in [(0, true), (1 << 20, true), ((1 << 20) + 1, false)] {
            fs::write(&path, vec![b'a'; length]).unwrap();
            assert_eq!(read_text(&path, 1 << 20).is_ok(), allowed, "{length}");
        }
        let pipe = scratch.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        for path in [pipe.as_path(), scratch.path(), Path::new("/dev/zero")] {
            let message = read_text(path, 1 << 20).unwrap_err().to_string();
            assert!(message.contains("not a regular file"), "{message}");
        }
    }
}
