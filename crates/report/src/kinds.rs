//! Kinds of failures in words: the most frequent of them, and how many more there are.

/// Kinds that are named.
const NAMED: usize = 5;

/// The most frequent kinds of failures with how often each was, and last how many more runs failed for other reasons. Kinds that are as
/// frequent stand in the order in which they are given.
#[must_use]
pub fn most_frequent(kinds: &[(String, u64)]) -> Vec<String> {
    let mut sorted: Vec<&(String, u64)> = kinds.iter().collect();
    sorted.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    // One kind more takes no more room than the words that tell of it.
    let named = if sorted.len() == NAMED + 1 { NAMED + 1 } else { NAMED.min(sorted.len()) };
    let (named, others) = sorted.split_at(named);
    let mut words: Vec<String> =
        named.iter().map(|(kind, count)| format!("{count} × {kind}")).collect();
    if !others.is_empty() {
        let runs: u64 = others.iter().map(|(_, count)| count).sum();
        words.push(format!("and {runs} more failed runs of {} other kinds", others.len()));
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// No run is forgotten, and what is not named is no more frequent than what is.
        #[test]
        fn every_run_is_told(counts in prop::collection::vec(1..50_u64, 0..20)) {
            let kinds: Vec<_> = counts.iter().enumerate().map(|(i, n)| (format!("kind {i}"), *n)).collect();
            let words = most_frequent(&kinds);
            let number = |word: &str| word.parse::<u64>().unwrap();
            let named: Vec<(u64, &str)> = words.iter()
                .filter_map(|line| line.split_once(" × ")).map(|(n, kind)| (number(n), kind)).collect();
            for (count, kind) in &named {
                prop_assert!(kinds.iter().any(|(other, n)| other == kind && n == count), "{kind}");
            }
            prop_assert!(named.is_sorted_by(|a, b| a.0 >= b.0), "{words:?}");
            prop_assert!(named.len() >= kinds.len().min(5));
            let told: u64 = named.iter().map(|(n, _)| n).sum();
            let rest: Vec<_> =
                kinds.iter().filter(|(kind, _)| named.iter().all(|(_, other)| other != kind)).collect();
            let runs: u64 = rest.iter().map(|(_, n)| n).sum();
            prop_assert_eq!(told + runs, counts.iter().sum::<u64>());
            let least = named.last().map_or(0, |(n, _)| *n);
            prop_assert!(rest.iter().all(|(_, n)| *n <= least));
            let last = format!("and {runs} more failed runs of {} other kinds", rest.len());
            prop_assert_eq!(words.last() == Some(&last), runs > 0);
        }
    }
}
