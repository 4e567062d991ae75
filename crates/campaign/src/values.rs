//! Values of runs by columns: numbers that some runs do not have, and texts that many runs share.

use std::collections::HashMap;

/// Numbers of runs, some of which have none: eight bytes and a bit each.
#[derive(Clone, Debug, Default)]
pub struct Numbers {
    values: Vec<f64>,
    /// Whether the run has one, 64 runs a word.
    present: Vec<u64>,
}

impl Numbers {
    /// That of the next run.
    #[inline]
    pub(crate) fn push(&mut self, value: Option<f64>) {
        let (word, bit) = (self.values.len() / 64, self.values.len() % 64);
        if bit == 0 {
            self.present.push(0);
        }
        self.present[word] |= u64::from(value.is_some()) << bit;
        self.values.push(value.unwrap_or_default());
    }

    /// The number of the run in a place, from 0.
    #[must_use]
    pub fn get(&self, run: usize) -> Option<f64> {
        let value = *self.values.get(run)?;
        (self.present[run / 64] >> (run % 64) & 1 == 1).then_some(value)
    }

    /// The numbers, if every run has one.
    pub(crate) fn all(&self) -> Option<&[f64]> {
        let count: u32 = self.present.iter().map(|word| word.count_ones()).sum();
        (count as usize == self.values.len()).then_some(&self.values)
    }

    /// The numbers of the runs that have one, in run order.
    pub fn present(&self) -> impl Iterator<Item = f64> {
        (0..self.values.len()).filter_map(|run| self.get(run))
    }

    /// The numbers of the runs that have one, with the runs from a first number on.
    pub(crate) fn of_runs(&self, first: u64) -> impl Iterator<Item = (u64, f64)> {
        let words = self.values.chunks(64).zip(&self.present);
        (first..).step_by(64).zip(words).flat_map(|(first, (values, present))| {
            let of = move |(i, value): (usize, &f64)| {
                (present >> i & 1 == 1).then_some((first + i as u64, *value))
            };
            values.iter().enumerate().filter_map(of)
        })
    }

    pub(crate) fn truncate(&mut self, runs: usize) {
        self.values.truncate(runs);
        self.present.truncate(runs.div_ceil(64));
        // Bits are added where there are none.
        if let (Some(last), rest @ 1..) = (self.present.last_mut(), runs % 64) {
            *last &= (1 << rest) - 1;
        }
    }

    pub(crate) fn append(&mut self, other: &Self) {
        if self.values.len().is_multiple_of(64) {
            self.values.extend_from_slice(&other.values);
            self.present.extend_from_slice(&other.present);
        } else {
            (0..other.values.len()).for_each(|run| self.push(other.get(run)));
        }
    }
}

/// Texts of runs, each kept once, and what kind each is.
#[derive(Clone, Debug, Default)]
pub(crate) struct Texts {
    /// Text and kind.
    texts: Vec<(String, String)>,
    /// By text, which tells its kind.
    places: HashMap<String, u32>,
    of_run: Vec<Option<u32>>,
}

impl Texts {
    pub(crate) fn push(&mut self, text: Option<(&str, &str)>) {
        let place = text.map(|(text, kind)| match self.places.get(text) {
            Some(place) => *place,
            None => {
                let place = self.texts.len() as u32;
                self.texts.push((text.to_owned(), kind.to_owned()));
                self.places.insert(text.to_owned(), place);
                place
            }
        });
        self.of_run.push(place);
    }

    pub(crate) fn get(&self, run: usize) -> Option<(&str, &str)> {
        let (text, kind) = &self.texts[(*self.of_run.get(run)?)? as usize];
        Some((text, kind))
    }

    /// The texts of the runs that have one, in run order.
    pub(crate) fn present(&self) -> impl Iterator<Item = (&str, &str)> {
        (0..self.of_run.len()).filter_map(|run| self.get(run))
    }

    /// The kind of each text that some runs have, with the place of the first of them and how many have it.
    pub(crate) fn counted(
        &self,
        which: impl Fn(usize) -> bool,
    ) -> impl Iterator<Item = (&str, usize, u64)> {
        let mut counted = vec![(0, 0); self.texts.len()];
        for (run, place) in self.of_run.iter().enumerate().filter(|(run, _)| which(*run)) {
            if let Some((first, count)) = place.map(|place| &mut counted[place as usize]) {
                *first = if *count == 0 { run } else { *first };
                *count += 1;
            }
        }
        let counted = self.texts.iter().zip(counted);
        counted.filter_map(|((_, kind), (first, count))| {
            (count > 0).then_some((kind.as_str(), first, count))
        })
    }

    pub(crate) fn append(&mut self, other: &Self) {
        for run in 0..other.of_run.len() {
            self.push(other.get(run));
        }
    }

    pub(crate) fn truncate(&mut self, runs: usize) {
        self.of_run.truncate(runs);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Against plain lists, pushed one by one and in parts of any size.
        #[test]
        fn columns_hold_what_was_pushed(
            runs in prop::collection::vec((prop::option::of(any::<f64>()), prop::option::of("[a-c]{0,2}")), 0..300),
            part in 1_usize..100,
        ) {
            let (mut numbers, mut texts) = (Numbers::default(), Texts::default());
            for part in runs.chunks(part) {
                let (mut some_numbers, mut some_texts) = (Numbers::default(), Texts::default());
                for (number, text) in part {
                    some_numbers.push(*number);
                    some_texts.push(text.as_deref().map(|text| (text, &text[..text.len().min(1)])));
                }
                numbers.append(&some_numbers);
                texts.append(&some_texts);
            }
            for (run, (number, text)) in runs.iter().enumerate() {
                prop_assert_eq!(numbers.get(run).map(f64::to_bits), number.map(f64::to_bits));
                let expected = text.as_deref().map(|text| (text, &text[..text.len().min(1)]));
                prop_assert_eq!(texts.get(run), expected);
            }
            prop_assert_eq!(numbers.get(runs.len()), None);
            let mut counted: Vec<_> = texts.counted(|_| true).collect();
            counted.sort_by_key(|(_, first, _)| *first);
            let mut expected: Vec<(&str, usize, u64)> = Vec::new();
            let mut known: Vec<&str> = Vec::new();
            for (run, text) in runs.iter().enumerate().filter_map(|(run, (_, text))| Some((run, text.as_deref()?))) {
                match known.iter().position(|known| *known == text) {
                    Some(place) => expected[place].2 += 1,
                    None => {
                        known.push(text);
                        expected.push((&text[..text.len().min(1)], run, 1));
                    }
                }
            }
            prop_assert_eq!(counted, expected);
            let present: Vec<u64> = runs.iter().filter_map(|(x, _)| x.map(f64::to_bits)).collect();
            prop_assert_eq!(numbers.present().map(f64::to_bits).collect::<Vec<_>>(), present);
        }
    }
}
