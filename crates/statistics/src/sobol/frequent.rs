//! How many outputs differ from the most frequent one.

/// Values that are counted: the first different ones. One that most outputs have is among them.
const COUNTED: usize = 8;

/// How often the first few different values occur.
#[derive(Clone, Debug, Default)]
pub(super) struct Frequent {
    counts: Vec<(f64, u64)>,
    all: u64,
}

impl Frequent {
    pub(super) fn add(&mut self, value: f64) {
        self.all += 1;
        if let Some((_, count)) = self.counts.iter_mut().find(|(known, _)| *known == value) {
            *count += 1;
        } else if self.counts.len() < COUNTED {
            self.counts.push((value, 1));
        }
    }

    /// How many values differ from the most frequent one that is counted.
    pub(super) fn others(&self) -> u64 {
        self.all - self.counts.iter().map(|(_, count)| *count).max().unwrap_or(0)
    }
}
