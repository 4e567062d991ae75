//! Bytes of a file in which some places read otherwise.

use crate::body::Place;

/// A place of a text, and what stands there in a copy. A place without length is one where something is added.
pub(crate) type Edit = (Place, String);

/// The bytes with these places changed, whose offsets begin at `base`; nothing if places overlap or lie outside.
pub(crate) fn edited(bytes: &[u8], base: usize, mut edits: Vec<Edit>) -> Option<Vec<u8>> {
    edits.sort_by_key(|(place, _)| place.start);
    let mut copy = Vec::with_capacity(bytes.len() + 8 * edits.len());
    let mut done = 0;
    for (place, text) in edits {
        copy.extend_from_slice(bytes.get(done..base + place.start)?);
        copy.extend_from_slice(text.as_bytes());
        done = base + place.end;
    }
    copy.extend_from_slice(bytes.get(done..)?);
    Some(copy)
}
