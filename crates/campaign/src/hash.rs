//! SHA-256 of files and texts, in hexadecimal.

use sha2::{Digest, Sha256};
use std::{
    fs::File,
    io::{self, Read},
    path::Path,
};

/// SHA-256 of a file, read piece by piece.
pub(crate) fn sha256_of_file(path: &Path) -> io::Result<String> {
    let (mut file, mut sha) = (File::open(path)?, Sha256::new());
    let mut buffer = vec![0; 1 << 16];
    loop {
        match file.read(&mut buffer)? {
            0 => return Ok(hex(sha)),
            n => sha.update(&buffer[..n]),
        }
    }
}

/// SHA-256 of a text or of bytes, in hexadecimal.
#[must_use]
pub fn sha256(content: impl AsRef<[u8]>) -> String {
    hex(Sha256::new_with_prefix(content))
}

/// A digest in hexadecimal.
pub(crate) fn hex(sha: Sha256) -> String {
    sha.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}
