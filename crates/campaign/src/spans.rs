//! Whole numbers that were seen, as spans: in their order they need no memory.

use std::collections::BTreeMap;

/// Numbers that were seen, as of runs or of vehicles, as spans that one file has: the first of each, with the last and the file. In their
/// order they need the memory of one span a file.
///
/// ```
/// use gyradius_campaign::Spans;
///
/// let mut seen = Spans::default();
/// assert_eq!([seen.add(7, 0), seen.add(8, 1)], [Ok(()); 2]);
/// assert_eq!(seen.add(8, 0), Err(1));
/// ```
#[derive(Clone, Debug, Default)]
pub struct Spans(BTreeMap<u64, (u64, usize)>);

impl Spans {
    /// Adds a number of a file.
    ///
    /// # Errors
    /// It was seen before: the file that has had it.
    pub fn add(&mut self, number: u64, file: usize) -> Result<(), usize> {
        let before = self.0.range(..=number).next_back().map(|(first, span)| (*first, *span));
        let first = match before {
            Some((_, (last, there))) if number <= last => return Err(there),
            Some((first, (last, there))) if number == last + 1 && there == file => first,
            Some(_) | None => number,
        };
        let next = number.checked_add(1);
        let after = next.and_then(|next| self.0.get(&next));
        let after = after.filter(|(_, there)| *there == file).map(|(last, _)| *last);
        if let (Some(_), Some(next)) = (after, next) {
            self.0.remove(&next);
        }
        self.0.insert(first, (after.unwrap_or(number), file));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::HashMap;

    proptest! {
        /// Runs in any order, of any files: the first that was seen before is told, with the file that had it.
        #[test]
        fn what_was_seen_is_known(runs in prop::collection::vec((0..60_u64, 0..3_usize), 0..80)) {
            let (mut seen, mut expected) = (Spans::default(), HashMap::new());
            for (run, file) in runs {
                let there = expected.get(&run).copied();
                prop_assert_eq!(seen.add(run, file), there.map_or(Ok(()), Err));
                expected.entry(run).or_insert(file);
            }
        }

        /// In their order, or the other way round, runs of a file are one span.
        #[test]
        fn runs_in_their_order_need_no_memory(first in 0..1000_u64, count in 1..500_u64, reversed: bool) {
            let mut seen = Spans::default();
            let runs = first..first + count;
            let all: Vec<u64> = if reversed { runs.rev().collect() } else { runs.collect() };
            all.into_iter().for_each(|run| seen.add(run, 0).unwrap());
            prop_assert_eq!(seen.0.into_iter().collect::<Vec<_>>(), [(first, (first + count - 1, 0))]);
        }
    }
}
