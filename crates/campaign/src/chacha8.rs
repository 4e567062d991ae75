//! The blocks of ChaCha8, made one at a time, or sixteen by the machine's vector units.

use pulp::{Scalar, Simd, WithSimd};

/// Words of a block.
pub(crate) const WORDS: usize = 16;
/// How many blocks are made side by side.
pub(crate) const BATCH: usize = 16;

/// A block of a stream of ChaCha8 (Bernstein 2008, “ChaCha, a variant of Salsa20”). Blocks are counted in 64 bits, and so
/// are the streams of a key.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Block {
    key: [u32; 8],
    stream: u64,
    number: u64,
}

impl Block {
    /// The first block of stream 0 of a key.
    pub(crate) fn new(key: &[u8; 32]) -> Self {
        let (words, _) = key.as_chunks();
        let key = std::array::from_fn(|i| u32::from_le_bytes(words[i]));
        Self { key, ..Self::default() }
    }

    /// The first block of another stream of the key.
    pub(crate) fn of_stream(self, stream: u64) -> Self {
        Self { stream, number: 0, ..self }
    }

    /// The block that begins the batch in which it is, if the stream is cut into batches.
    pub(crate) fn batch(self) -> Self {
        Self { number: self.number / BATCH as u64 * BATCH as u64, ..self }
    }

    /// The block that comes as many later in the stream.
    pub(crate) fn later(self, blocks: u64) -> Self {
        Self { number: self.number.wrapping_add(blocks), ..self }
    }

    /// How many come before it in the stream.
    pub(crate) fn number(&self) -> u64 {
        self.number
    }

    pub(crate) fn words(&self) -> [u32; WORDS] {
        mixed(Scalar::new(), self.state())
    }

    #[inline(always)]
    fn state(&self) -> [u32; WORDS] {
        // “expand 32-byte k”.
        let [a, b, c, d] = [0x6170_7865, 0x3320_646e, 0x7962_2d32, 0x6b20_6574];
        let [e, f, g, h, i, j, k, l] = self.key;
        let [m, n] = [self.number as u32, (self.number >> 32) as u32];
        let [o, p] = [self.stream as u32, (self.stream >> 32) as u32];
        [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p]
    }
}

/// The words of some blocks, made side by side.
#[derive(Clone, Debug)]
pub(crate) struct Batch([[u32; BATCH]; WORDS]);

impl Batch {
    /// Blocks of any streams.
    #[inline]
    pub(crate) fn of_each(blocks: impl Iterator<Item = Block>) -> Self {
        let mut made = Self([[0; BATCH]; WORDS]);
        let mut places = 0;
        for block in blocks.take(BATCH) {
            for (row, word) in made.0.iter_mut().zip(&block.state()) {
                row[places] = *word;
            }
            places += 1;
        }
        made.mix(places);
        made
    }

    /// A block and those that follow it in its stream, up to a number of them.
    pub(crate) fn from(first: Block, places: usize) -> Self {
        let mut made = Self(first.state().map(|word| [word; BATCH]));
        let number = |place| first.later(place as u64).number;
        made.0[12] = std::array::from_fn(|place| number(place) as u32);
        made.0[13] = std::array::from_fn(|place| (number(place) >> 32) as u32);
        made.mix(places.min(BATCH));
        made
    }

    /// The words at a place.
    #[inline]
    pub(crate) fn words(&self, place: usize) -> [u32; WORDS] {
        let mut words = [0; WORDS];
        self.give(place, &mut words);
        words
    }

    /// Gives the words at a place.
    #[inline]
    pub(crate) fn give(&self, place: usize, words: &mut [u32; WORDS]) {
        for (word, row) in words.iter_mut().zip(&self.0) {
            *word = row[place];
        }
    }

    fn mix(&mut self, places: usize) {
        pulp::Arch::new().dispatch(Mixing { states: &mut self.0, places });
    }
}

/// States, of which those at the first places are turned into their words by the machine's vector units.
struct Mixing<'a> {
    states: &'a mut [[u32; BATCH]; WORDS],
    places: usize,
}

impl WithSimd for Mixing<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        for at in 0..self.places.div_ceil(S::U32_LANES) {
            let state = std::array::from_fn(|i| S::as_simd_u32s(&self.states[i]).0[at]);
            for (row, words) in self.states.iter_mut().zip(mixed(simd, state)) {
                S::as_mut_simd_u32s(row).0[at] = words;
            }
        }
    }
}

/// The words of as many blocks as a vector has places.
#[inline(always)]
fn mixed<S: Simd>(simd: S, state: [S::u32s; WORDS]) -> [S::u32s; WORDS] {
    let mut x = state;
    // Each quarter is written out: where code is to be small, loops are not unrolled, and the words then do not stay in
    // registers.
    for _ in 0..4 {
        quarter_round(simd, &mut x, [0, 4, 8, 12]);
        quarter_round(simd, &mut x, [1, 5, 9, 13]);
        quarter_round(simd, &mut x, [2, 6, 10, 14]);
        quarter_round(simd, &mut x, [3, 7, 11, 15]);
        quarter_round(simd, &mut x, [0, 5, 10, 15]);
        quarter_round(simd, &mut x, [1, 6, 11, 12]);
        quarter_round(simd, &mut x, [2, 7, 8, 13]);
        quarter_round(simd, &mut x, [3, 4, 9, 14]);
    }
    for (x, state) in x.iter_mut().zip(state) {
        *x = simd.add_u32s(*x, state);
    }
    x
}

#[inline(always)]
fn quarter_round<S: Simd>(simd: S, x: &mut [S::u32s; WORDS], [a, b, c, d]: [usize; 4]) {
    add_and_turn(simd, x, [a, b, d], 16);
    add_and_turn(simd, x, [c, d, b], 12);
    add_and_turn(simd, x, [a, b, d], 8);
    add_and_turn(simd, x, [c, d, b], 7);
}

/// x[to] += x[with], x[turned] = (x[turned] ⊕ x[to]) turned left by some bits.
#[inline(always)]
fn add_and_turn<S: Simd>(
    simd: S,
    x: &mut [S::u32s; WORDS],
    [to, with, turned]: [usize; 3],
    left: u32,
) {
    x[to] = simd.add_u32s(x[to], x[with]);
    let bits = simd.xor_u32s(x[turned], x[to]);
    let upper = simd.wrapping_dyn_shl_u32s(bits, simd.splat_u32s(left));
    let lower = simd.wrapping_dyn_shr_u32s(bits, simd.splat_u32s(32 - left));
    x[turned] = simd.or_u32s(upper, lower);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every vector unit that this machine has, and none.
    #[test]
    fn vectors_of_any_length_make_the_same_words() {
        let blocks = |i: usize| Block::new(&[i as u8; 32]).of_stream(1 << (4 * i)).later(i as u64);
        let states: [[u32; BATCH]; WORDS] =
            std::array::from_fn(|i| std::array::from_fn(|place| blocks(place).state()[i]));
        let expected: [_; BATCH] = std::array::from_fn(|place| blocks(place).words());
        let made = |mix: &dyn Fn(Mixing<'_>)| {
            let mut states = states;
            mix(Mixing { states: &mut states, places: BATCH });
            std::array::from_fn(|place| Batch(states).words(place))
        };
        assert_eq!(made(&|mixing| Scalar::new().vectorize(mixing)), expected);
        assert_eq!(made(&|mixing| pulp::Scalar256b.vectorize(mixing)), expected);
        #[cfg(target_arch = "x86_64")]
        if let Some(simd) = pulp::x86::V3::try_new() {
            assert_eq!(made(&|mixing| Simd::vectorize(simd, mixing)), expected);
        }
        assert_eq!(made(&|mixing| pulp::Arch::new().dispatch(mixing)), expected);
    }
}
