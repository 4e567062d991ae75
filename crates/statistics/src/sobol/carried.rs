//! Whether a sum over runs is carried by a few of them.

use super::STATISTICS;

/// Parts that the runs are dealt out to in turn.
const PARTS: usize = 32;

/// How many numbers of the same size would have the fourth moment of these about 0 for their second one: all of them if they
/// are of one size, 1 if one of them is all there is. None if all are 0.
fn effective_number(numbers: impl Iterator<Item = f64>) -> Option<f64> {
    let (mut squares, mut fourths) = (0.0, 0.0);
    for square in numbers.map(|x| x * x) {
        squares += square;
        fourths += square * square;
    }
    (fourths > 0.0).then(|| squares * squares / fourths)
}

/// Sums of the statistics over parts of the runs. Of many runs of like weight the parts differ as normal numbers do; where one run
/// carries a sum, its part stands out, and all of its run need not be kept to tell.
#[derive(Clone, Debug)]
pub(super) struct Parts {
    n: u64,
    sums: Box<[[f64; STATISTICS]; PARTS]>,
}

impl Parts {
    pub(super) fn new() -> Self {
        Self { n: 0, sums: Box::new([[0.0; STATISTICS]; PARTS]) }
    }

    pub(super) fn add(&mut self, x: &[f64; STATISTICS]) {
        let part = &mut self.sums[(self.n % PARTS as u64) as usize];
        part.iter_mut().zip(x).for_each(|(sum, x)| *sum += x);
        self.n += 1;
    }

    /// As if each statistic had been multiplied by its factor before it was pushed.
    pub(super) fn rescale(&mut self, factors: &[f64; STATISTICS]) {
        for part in self.sums.iter_mut() {
            part.iter_mut().zip(factors).for_each(|(sum, factor)| *sum *= factor);
        }
    }

    /// How many parts of the same weight would scatter as much about their mean as these do in a linear form of the
    /// statistics. None if they do not scatter.
    pub(super) fn effective(
        &self,
        mean: &[f64; STATISTICS],
        gradient: &[f64; STATISTICS],
    ) -> Option<f64> {
        let influence = |(i, part): (usize, &[f64; STATISTICS])| {
            let runs = (self.n + (PARTS - 1 - i) as u64) / PARTS as u64;
            let terms = part.iter().zip(mean).zip(gradient);
            terms.map(|((sum, mean), slope)| slope * (sum - runs as f64 * mean)).sum::<f64>()
        };
        effective_number(self.sums.iter().enumerate().map(influence))
    }
}
