//! Where random numbers come from: one stream of a generator for each draw.

use gyradius_campaign::Streams;
use numpy::PyReadonlyArray1;
use pyo3::{PyResult, pyclass, pymethods};

use crate::error::refused;

/// So many draws, each of which has a stream of its own: among those of a seed and a term, or of 32 bytes.
#[pyclass(frozen, module = "gyradius._core")]
pub(crate) struct Draws {
    streams: Streams,
    count: usize,
    /// The streams of the draws; none where they are the first.
    places: Option<Vec<u64>>,
}

#[pymethods]
impl Draws {
    /// The first draws of a seed under a name: the same as the program's.
    #[staticmethod]
    fn first(seed: u64, term: &str, count: usize) -> Self {
        Self { streams: Streams::of_draws(seed, term), count, places: None }
    }

    /// Those at some places.
    #[staticmethod]
    fn at(seed: u64, term: &str, places: PyReadonlyArray1<'_, u64>) -> PyResult<Self> {
        let places = places.as_slice().map_err(refused)?.to_vec();
        let streams = Streams::of_draws(seed, term);
        Ok(Self { streams, count: places.len(), places: Some(places) })
    }

    /// The first draws of a key of 32 bytes.
    #[staticmethod]
    fn of_key(key: [u8; 32], count: usize) -> Self {
        Self { streams: Streams::from_key(key), count, places: None }
    }
}

impl Draws {
    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// The stream of a draw, among those of which.
    pub(crate) fn stream(&self, draw: usize) -> (&Streams, u64) {
        let place = self.places.as_ref().map_or(draw as u64, |places| places[draw]);
        (&self.streams, place)
    }
}
