//! The generator of a run: ChaCha8, which gives few words quickly.

use rand::{SeedableRng, TryRng};
use std::convert::Infallible;

use crate::chacha8::{BATCH, Batch, Block, WORDS};

/// The most blocks that are made when a generator is opened.
const AHEAD: usize = 2;
/// From how many blocks on they are made side by side.
const FEW: usize = 4;

/// The generator of one stream: ChaCha8 with the words of `rand_chacha::ChaCha8Rng`, in the same order.
///
/// A run opens many streams and takes a few words from each. This generator makes one block of 64 bytes at first, where
/// `ChaCha8Rng` makes four before it gives a word. Long slices and what comes late in a stream it makes sixteen blocks
/// at a time, by the machine's vector units.
///
/// ```
/// use gyradius_campaign::StreamRng;
/// use rand::{RngExt, SeedableRng};
/// use rand_chacha::ChaCha8Rng;
///
/// let (mut ours, mut theirs) = (StreamRng::seed_from_u64(7), ChaCha8Rng::seed_from_u64(7));
/// assert_eq!(ours.random::<[u64; 100]>(), theirs.random::<[u64; 100]>());
/// ```
#[derive(Clone, Debug)]
pub struct StreamRng {
    /// The block after those that are held.
    next: Block,
    /// Words of one block or of two, which stand at the end.
    held: [u32; AHEAD * WORDS],
    used: usize,
    /// The batch of blocks from which words were held last, and its first block, if the stream has become long.
    batch: Option<Box<(Block, Batch)>>,
}

impl StreamRng {
    /// A stream from a block on.
    #[inline]
    pub(crate) fn new(next: Block) -> Self {
        Self { next, held: [0; AHEAD * WORDS], used: AHEAD * WORDS, batch: None }
    }

    /// Opens streams in turn, from a block on, with the words of as many blocks made side by side.
    ///
    /// Compiled here, once, and not with everything that draws.
    pub(crate) fn each<const BLOCKS: usize>(
        from: &mut dyn Iterator<Item = Block>,
        with: &mut dyn FnMut(&mut Self),
    ) {
        let mut from = from.fuse();
        let mut first = [Block::default(); BATCH];
        // One generator for all, for to make each anew takes as long as its words.
        let mut opened = Self::new(Block::default());
        loop {
            let mut n = 0;
            for (first, block) in first[..BATCH / BLOCKS].iter_mut().zip(&mut from) {
                *first = block;
                n += 1;
            }
            let first = &first[..n];
            if n * BLOCKS < FEW {
                return first.iter().for_each(|block| with(&mut Self::new(*block)));
            }
            let blocks = first.iter().flat_map(|block| (0..BLOCKS).map(|i| block.later(i as u64)));
            let made = Batch::of_each(blocks);
            for (i, block) in first.iter().enumerate() {
                opened.next = block.later(BLOCKS as u64);
                opened.used = (AHEAD - BLOCKS) * WORDS;
                opened.batch = None;
                let (held, _) = opened.held[opened.used..].as_chunks_mut();
                for (held, place) in held.iter_mut().zip(BLOCKS * i..) {
                    made.give(place, held);
                }
                with(&mut opened);
            }
        }
    }

    #[inline]
    fn word(&mut self) -> u32 {
        if self.used == self.held.len() {
            self.hold_next();
        }
        self.used += 1;
        self.held[self.used - 1]
    }

    fn hold_next(&mut self) {
        let words = if self.next.number() < FEW as u64 {
            self.next.words()
        } else {
            let first = self.next.batch();
            let made = self.batch.take().filter(|made| made.0 == first);
            let made = made.unwrap_or_else(|| Box::new((first, Batch::from(first, BATCH))));
            let words = made.1.words((self.next.number() - first.number()) as usize);
            self.batch = Some(made);
            words
        };
        self.used -= WORDS;
        self.held[self.used..].copy_from_slice(&words);
        self.next = self.next.later(1);
    }

    /// Fills a slice word by word, the last of which may be cut.
    fn fill(&mut self, bytes: &mut [u8]) {
        for four in bytes.chunks_mut(size_of::<u32>()) {
            four.copy_from_slice(&self.word().to_le_bytes()[..four.len()]);
        }
    }
}

impl SeedableRng for StreamRng {
    type Seed = [u8; 32];

    /// Stream 0 of the key that the seed is.
    fn from_seed(seed: Self::Seed) -> Self {
        Self::new(Block::new(&seed))
    }
}

impl TryRng for StreamRng {
    type Error = Infallible;

    #[inline]
    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        Ok(self.word())
    }

    #[inline]
    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        let (low, high) = (self.word(), self.word());
        Ok(u64::from(low) | (u64::from(high) << 32))
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        let held = size_of_val(&self.held[self.used..]);
        let (first, mut rest) = bytes.split_at_mut(held.min(bytes.len()));
        self.fill(first);
        let block = WORDS * size_of::<u32>();
        while rest.len() >= FEW * block {
            let made = (rest.len() / block).min(BATCH);
            let (now, later) = rest.split_at_mut(made * block);
            let words = Batch::from(self.next, made);
            let (fours, _) = now.as_chunks_mut();
            for (place, fours) in fours.chunks_exact_mut(WORDS).enumerate() {
                for (four, word) in fours.iter_mut().zip(words.words(place)) {
                    *four = word.to_le_bytes();
                }
            }
            self.next = self.next.later(made as u64);
            rest = later;
        }
        self.fill(rest);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rand::Rng;
    use rand_chacha::ChaCha8Rng;

    /// Ways to take words.
    #[derive(Clone, Debug)]
    enum Take {
        U32,
        U64,
        Bytes(usize),
    }

    fn take() -> impl Strategy<Value = Take> {
        let bytes = prop_oneof![0..70_usize, 200..300_usize, 0..5000_usize];
        prop_oneof![Just(Take::U32), Just(Take::U64), bytes.prop_map(Take::Bytes)]
    }

    fn taken(rng: &mut impl Rng, takes: &[Take]) -> Vec<u8> {
        let mut all = Vec::new();
        for take in takes {
            match take {
                Take::U32 => all.extend(rng.next_u32().to_le_bytes()),
                Take::U64 => all.extend(rng.next_u64().to_le_bytes()),
                Take::Bytes(n) => {
                    let at = all.len();
                    all.resize(at + n, 0);
                    rng.fill_bytes(&mut all[at..]);
                }
            }
        }
        all
    }

    proptest! {
        /// From any block of any stream, also where its number passes 32 bits and 64.
        #[test]
        fn words_are_those_of_the_library(
            seed: [u8; 32],
            stream: u64,
            block in prop_oneof![Just(0), u64::from(u32::MAX - 40)..u64::from(u32::MAX), u64::MAX - 40..],
            takes in prop::collection::vec(take(), 0..20),
        ) {
            let mut theirs = ChaCha8Rng::from_seed(seed);
            theirs.set_stream(stream);
            theirs.set_word_pos(u128::from(block) * WORDS as u128);
            let from = Block::new(&seed).of_stream(stream).later(block);
            let expected = taken(&mut theirs, &takes);
            prop_assert_eq!(&taken(&mut StreamRng::new(from), &takes), &expected);
            let mut n = 0;
            let mut take = |rng: &mut StreamRng| n += i32::from(taken(rng, &takes) == expected);
            StreamRng::each::<1>(&mut [from; 5].into_iter(), &mut take);
            StreamRng::each::<2>(&mut [from; 33].into_iter(), &mut take);
            prop_assert_eq!(n, 5 + 33);
        }
    }

    #[test]
    fn seeds_of_numbers_are_those_of_the_library() {
        let words = |rng: &mut dyn Rng| [(); 40].map(|()| rng.next_u64());
        for seed in [0, 1, u64::MAX] {
            let (mut ours, mut theirs) =
                (StreamRng::seed_from_u64(seed), ChaCha8Rng::seed_from_u64(seed));
            assert_eq!(words(&mut ours), words(&mut theirs));
        }
    }
}
