//! Where random numbers come from: one stream of a generator for each draw.

use gyradius_campaign::Streams;
use numpy::{PyReadonlyArray1, PyUntypedArrayMethods};
use pyo3::{PyResult, pyclass, pymethods};

use crate::error::refused;

/// The streams of a seed and a term, or of 32 bytes.
#[pyclass(frozen, module = "gyradius._core")]
pub(crate) struct Stream(Streams);

#[pymethods]
impl Stream {
    /// Those of the draws of a seed under a name: the same as the program's.
    #[staticmethod]
    fn of(seed: u64, term: &str) -> Self {
        Self(Streams::of_draws(seed, term))
    }

    /// Those of a key of 32 bytes.
    #[staticmethod]
    fn from_key(key: [u8; 32]) -> Self {
        Self(Streams::from_key(key))
    }
}

impl Stream {
    pub(crate) fn streams(&self) -> &Streams {
        &self.0
    }
}

/// Which streams draws come from.
pub(crate) enum Places<'a> {
    /// Those of their own numbers.
    First,
    /// These.
    These(&'a [u64]),
}

impl<'a> Places<'a> {
    /// As Python gives them: a count, or numbers.
    pub(crate) fn new(
        count: usize,
        these: Option<&'a PyReadonlyArray1<'_, u64>>,
    ) -> PyResult<Self> {
        let Some(these) = these else { return Ok(Self::First) };
        if these.len() != count {
            return Err(refused(format_args!("{} places of {count} draws", these.len())));
        }
        these
            .as_slice()
            .map(Self::These)
            .map_err(|_| refused("the array of places must be contiguous"))
    }

    /// The stream of a draw.
    pub(crate) fn at(&self, draw: usize) -> u64 {
        match self {
            Self::First => draw as u64,
            Self::These(places) => places[draw],
        }
    }
}
