//! Random streams: one for each run and purpose.

use sha2::{Digest, Sha256};

use crate::{chacha8::Block, stream_rng::StreamRng};

/// Independent random streams of one purpose under one model: one for each run.
///
/// ChaCha8, keyed by (study seed, model, purpose) through SHA-256; the stream number is the run.
/// What run i draws depends on these four alone, never on threads, order or other purposes: every
/// run can be replayed alone, and a new purpose shifts no other draw.
#[derive(Clone, Debug)]
pub struct Streams(Block);

impl Streams {
    /// The streams of a purpose, as “payload inertia”, under a model in a campaign with a seed.
    #[must_use]
    pub fn new(seed: u64, model: &str, purpose: &str) -> Self {
        let mut hash = Sha256::new();
        hash.update(b"gyradius random stream 1\0");
        hash.update(seed.to_le_bytes());
        // Lengths first, so that no two pairs of names run together.
        for name in [model, purpose] {
            hash.update((name.len() as u64).to_le_bytes());
            hash.update(name);
        }
        Self::from_key(hash.finalize().into())
    }

    /// The streams of draws outside of campaigns under a name, as that of the link of a robot: draw i comes from the stream
    /// of run i.
    #[must_use]
    pub fn of_draws(seed: u64, name: &str) -> Self {
        Self::new(seed, "robot", name)
    }

    /// The streams of a key.
    #[must_use]
    pub fn from_key(key: [u8; 32]) -> Self {
        Self(Block::new(&key))
    }

    /// The generator of a run.
    #[must_use]
    #[inline]
    pub fn run(&self, run: u64) -> StreamRng {
        StreamRng::new(self.0.of_stream(run))
    }

    /// Draws with the generators of several streams, of any runs and purposes, one after the other.
    ///
    /// The same as [`run`](Self::run) for each, in a third of the time, for the first words are made side by side. `words`
    /// is how many `u64` most draws take: one for a normal number, some ten for a body. It changes no result.
    ///
    /// ```
    /// use gyradius_campaign::Streams;
    /// use rand::RngExt;
    ///
    /// let masses = Streams::new(2003, "proposed", "payload mass");
    /// let mut drawn = Vec::new();
    /// Streams::each((0..100).map(|run| (&masses, run)), 1, |rng| drawn.push(rng.random::<f64>()));
    /// assert_eq!(drawn[42], masses.run(42).random::<f64>());
    /// ```
    #[inline]
    pub fn each<'a>(
        streams: impl IntoIterator<Item = (&'a Self, u64)>,
        words: usize,
        mut draw: impl FnMut(&mut StreamRng),
    ) {
        let mut first = streams.into_iter().map(|(streams, run)| streams.0.of_stream(run));
        Self::open(&mut first, words, &mut draw);
    }

    fn open(
        first: &mut dyn Iterator<Item = Block>,
        words: usize,
        draw: &mut dyn FnMut(&mut StreamRng),
    ) {
        // A block has eight.
        if words > 8 {
            StreamRng::each::<2>(first, draw);
        } else {
            StreamRng::each::<1>(first, draw);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rand::{Rng, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn first(seed: u64, model: &str, purpose: &str, run: u64) -> u64 {
        Streams::new(seed, model, purpose).run(run).next_u64()
    }

    #[test]
    fn every_coordinate_matters_and_nothing_else() {
        let base = first(1, "proposed", "payload inertia", 0);
        assert_eq!(base, first(1, "proposed", "payload inertia", 0));
        for other in [
            first(2, "proposed", "payload inertia", 0),
            first(1, "naive", "payload inertia", 0),
            first(1, "proposed", "stage inertia", 0),
            first(1, "proposed", "payload inertia", 1),
            first(1, "proposedp", "ayload inertia", 0),
        ] {
            assert_ne!(base, other);
        }
    }

    /// Pinned: a change here changes every study.
    #[test]
    fn value_stability() {
        assert_eq!(first(2003, "proposed", "payload inertia", 7), STABLE);
    }

    proptest! {
        /// Alone and together, few and many, of any keys: the words of the library, as many as are taken.
        #[test]
        fn streams_have_the_words_of_the_library(
            places in prop::collection::vec((any::<[u8; 32]>(), prop_oneof![0..9_u64, any::<u64>()]), 0..40),
            words in 0..20_usize,
            taken in 0..200,
        ) {
            let streams: Vec<_> = places.iter().map(|(key, _)| Streams::from_key(*key)).collect();
            let each = streams.iter().zip(&places).map(|(streams, (_, run))| (streams, *run));
            let mut opened = Vec::new();
            Streams::each(each, words, |rng| opened.push(rng.clone()));
            prop_assert_eq!(opened.len(), places.len());
            for ((mut together, streams), (key, run)) in opened.into_iter().zip(&streams).zip(&places) {
                let (mut alone, mut theirs) = (streams.run(*run), ChaCha8Rng::from_seed(*key));
                theirs.set_stream(*run);
                for _ in 0..taken {
                    let word = theirs.next_u64();
                    prop_assert_eq!([together.next_u64(), alone.next_u64()], [word; 2]);
                }
            }
        }
    }

    const STABLE: u64 = 5_696_740_275_271_275_493;
}
