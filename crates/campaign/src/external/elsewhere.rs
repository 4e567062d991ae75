//! Processes of simulators on systems without process groups, where none is started.

use std::{
    convert::Infallible,
    io::{self, ErrorKind},
    path::Path,
    time::Instant,
};

use super::{patience::Patience, program::Program, trouble::Trouble};

/// A process that is never started.
#[derive(Debug)]
pub(super) struct Child(Infallible);

impl Child {
    pub(super) fn start(_: &Program) -> io::Result<Self> {
        let problem = "simulators of your own need Linux, macOS or another Unix";
        Err(io::Error::new(ErrorKind::Unsupported, problem))
    }

    pub(super) fn start_in(program: &Program, _: &Path) -> io::Result<Self> {
        Self::start(program)
    }

    pub(super) fn is_quiet(&mut self) -> bool {
        match self.0 {}
    }

    pub(super) fn unasked(&self) -> &[u8] {
        match self.0 {}
    }

    pub(super) fn ask(&mut self, _: &[u8], _: Patience<'_>) -> Result<Vec<u8>, Trouble> {
        match self.0 {}
    }

    pub(super) fn finish(&mut self, _: Patience<'_>) -> Result<(), Trouble> {
        match self.0 {}
    }

    pub(super) fn close(&mut self) {
        match self.0 {}
    }

    pub(super) fn ends_by(&mut self, _: Instant) -> bool {
        match self.0 {}
    }
}
