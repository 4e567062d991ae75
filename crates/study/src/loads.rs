//! What loads are called in run tables and on pages.

use gyradius_separation::{Load, LoadId, Spring};
use std::fmt;

/// A load in a list of several: a spring by its number alone, from 1, another as in `bolt_1`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Short(pub(crate) LoadId);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.kind == Spring::KIND {
            write!(f, "{}", self.0.number + 1)
        } else {
            f.write_str(&self.0.column())
        }
    }
}
