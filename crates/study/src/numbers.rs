//! Values of runs by columns: numbers that some runs do not have, and texts that many runs share.

use std::collections::HashMap;

/// Numbers of runs, some of which have none: eight bytes and a bit each.
#[derive(Clone, Debug, Default)]
pub(crate) struct Numbers {
    values: Vec<f64>,
    /// Whether the run has one, 64 runs a word.
    present: Vec<u64>,
}

impl Numbers {
    pub(crate) fn push(&mut self, value: Option<f64>) {
        let (word, bit) = (self.values.len() / 64, self.values.len() % 64);
        if bit == 0 {
            self.present.push(0);
        }
        self.present[word] |= u64::from(value.is_some()) << bit;
        self.values.push(value.unwrap_or_default());
    }

    pub(crate) fn get(&self, run: usize) -> Option<f64> {
        let value = *self.values.get(run)?;
        (self.present[run / 64] >> (run % 64) & 1 == 1).then_some(value)
    }

    /// The numbers of the runs that have one, in run order.
    pub(crate) fn present(&self) -> impl Iterator<Item = f64> {
        (0..self.values.len()).filter_map(|run| self.get(run))
    }

    pub(crate) fn append(&mut self, other: &Self) {
        for run in 0..other.values.len() {
            self.push(other.get(run));
        }
    }
}

/// Texts of runs, each kept once.
#[derive(Clone, Debug, Default)]
pub(crate) struct Texts {
    texts: Vec<String>,
    places: HashMap<String, u32>,
    of_run: Vec<Option<u32>>,
}

impl Texts {
    pub(crate) fn push(&mut self, text: Option<&str>) {
        let place = text.map(|text| match self.places.get(text) {
            Some(place) => *place,
            None => {
                let place = self.texts.len() as u32;
                self.texts.push(text.to_owned());
                self.places.insert(text.to_owned(), place);
                place
            }
        });
        self.of_run.push(place);
    }

    pub(crate) fn get(&self, run: usize) -> Option<&str> {
        Some(&self.texts[(*self.of_run.get(run)?)? as usize])
    }

    pub(crate) fn append(&mut self, other: &Self) {
        for run in 0..other.of_run.len() {
            self.push(other.get(run));
        }
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
                    some_texts.push(text.as_deref());
                }
                numbers.append(&some_numbers);
                texts.append(&some_texts);
            }
            for (run, (number, text)) in runs.iter().enumerate() {
                prop_assert_eq!(numbers.get(run).map(f64::to_bits), number.map(f64::to_bits));
                prop_assert_eq!(texts.get(run), text.as_deref());
            }
            prop_assert_eq!(numbers.get(runs.len()), None);
            let present: Vec<u64> = runs.iter().filter_map(|(x, _)| x.map(f64::to_bits)).collect();
            prop_assert_eq!(numbers.present().map(f64::to_bits).collect::<Vec<_>>(), present);
        }
    }
}
