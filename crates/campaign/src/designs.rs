//! Runs that draw some of their groups of inputs twice: the designs of pick-freeze, by which Sobol' indices are found.

use gyradius_statistics::{Confidence, SobolIndices, SobolSums, StatisticsError};

use crate::{
    requirement::{Measured, Requirement},
    runs::Runs,
    runs_error::RunsError,
    table::Table,
};

/// The streams of a second draw, which no run of a campaign has: the highest bit of their numbers is set.
const SECOND: u64 = 1 << 63;

/// The runs of a campaign in which inputs are exchanged group by group: for each base run one with the first draw of all
/// groups, one with the second draw of all, and for each group one with the second draw of this and the first of all others.
///
/// They follow each other, base run by base run, so that more base runs change no run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Designs {
    groups: usize,
}

/// Which draws a run takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mix<'a> {
    base: u64,
    draws: Draws<'a>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Draws<'a> {
    First,
    Second,
    /// The second draw of a group, and the first of all others.
    SecondOf(u64),
    /// The draw of this number of each group.
    Given(&'a [u64]),
}

impl Designs {
    /// Of so many groups.
    #[must_use]
    pub fn new(groups: usize) -> Self {
        Self { groups }
    }

    /// How many runs so many base runs take.
    #[must_use]
    pub fn runs(self, base: u64) -> u64 {
        base.saturating_mul(self.each())
    }

    /// Which draws a run takes.
    #[must_use]
    pub fn of(self, run: u64) -> Mix<'static> {
        let draws = match run % self.each() {
            0 => Draws::First,
            1 => Draws::Second,
            after => Draws::SecondOf(after - 2),
        };
        Mix { base: run / self.each(), draws }
    }

    /// Runs for each base run.
    fn each(self) -> u64 {
        (self.groups as u64).saturating_add(2)
    }

    /// Which share of the variance of each output each group drives, as the runs of so many base runs tell, which stand in the
    /// order of the designs.
    ///
    /// # Errors
    /// A block cannot be read, or there are no groups.
    pub fn indices(
        self,
        base: u64,
        runs: &Runs,
        outputs: &[Output],
        confidence: Confidence,
    ) -> Result<Vec<Option<SobolIndices>>, DesignsError> {
        let new = |_| SobolSums::new(self.groups);
        let mut sums = outputs.iter().map(new).collect::<Result<Vec<_>, _>>()?;
        let mut of_base: Vec<Vec<Option<f64>>> = vec![Vec::new(); outputs.len()];
        let mut refused = None;
        runs.in_order(0..self.runs(base), |block| {
            let left = self.runs(base).saturating_sub(block.first());
            let count = usize::try_from(left).unwrap_or(usize::MAX);
            for ((output, sums), of_base) in outputs.iter().zip(&mut sums).zip(&mut of_base) {
                for y in output.of(block).into_iter().take(count) {
                    of_base.push(y);
                    if let [a, b, exchanged @ ..] = &of_base[..]
                        && exchanged.len() == self.groups
                    {
                        refused = sums.push(*a, *b, exchanged).err().or(refused.take());
                        of_base.clear();
                    }
                }
            }
        })?;
        if let Some(error) = refused {
            return Err(error.into());
        }
        // What is constant, or has no two outputs, is driven by nothing.
        Ok(sums.iter().map(|sums| sums.finish(confidence).ok()).collect())
    }
}

impl<'a> Mix<'a> {
    /// The draw of this number of each group; of a group without one the first.
    #[must_use]
    pub fn given(base: u64, draws: &'a [u64]) -> Self {
        Self { base, draws: Draws::Given(draws) }
    }

    /// The first draw of all groups.
    #[must_use]
    pub fn plain(run: u64) -> Self {
        Self { base: run, draws: Draws::First }
    }

    /// The base run.
    #[must_use]
    pub fn base(self) -> u64 {
        self.base
    }

    /// The same draws, of another base run.
    #[must_use]
    pub fn at(self, base: u64) -> Self {
        Self { base, ..self }
    }

    /// The number of the random stream of what belongs to a group, of which the first draw has this number.
    #[must_use]
    pub fn stream(self, group: usize, first: u64) -> u64 {
        match self.draws {
            Draws::First => first,
            Draws::SecondOf(second) if second != group as u64 => first,
            Draws::Second | Draws::SecondOf(_) => first | SECOND,
            Draws::Given(draws) => draws.get(group).copied().unwrap_or(first),
        }
    }
}

/// What is driven: a number, or whether a requirement is not kept.
#[derive(Clone, Debug, PartialEq)]
pub enum Output {
    /// A column.
    Column(String),
    /// 1 if the requirement is not kept, and 0 if it is; nothing of a run that failed if those are left out.
    Fails(Box<Requirement>),
}

impl Output {
    /// What the runs of a block have of it.
    #[must_use]
    pub fn of(&self, block: &Table) -> Vec<Option<f64>> {
        match self {
            Self::Column(name) => Measured::column(name).finite_numbers(block),
            Self::Fails(requirement) => {
                let failing = requirement.failing(block).into_iter();
                failing.map(|fails| fails.map(|fails| f64::from(u8::from(fails)))).collect()
            }
        }
    }
}

/// Why nothing is known of what drives an output.
#[derive(Debug, thiserror::Error)]
pub enum DesignsError {
    /// The runs cannot be read.
    #[error(transparent)]
    Runs(#[from] RunsError),
    /// There are no groups, or too many.
    #[error(transparent)]
    Statistics(#[from] StatisticsError),
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cell, Column, Streams};
    use proptest::prelude::*;
    use rand::RngExt;

    proptest! {
        /// Each base run takes each of its designs once, and a group takes its second draw in two of them.
        #[test]
        fn each_design_is_taken_once(groups in 1..60_usize, base in 0..1_u64 << 40, first in 0..1_u64 << 62) {
            let designs = Designs::new(groups);
            let runs = designs.runs(base)..designs.runs(base + 1);
            prop_assert_eq!(runs.end - runs.start, groups as u64 + 2);
            let mixes: Vec<Mix<'_>> = runs.map(|run| designs.of(run)).collect();
            for group in 0..groups {
                let second: Vec<usize> =
                    (0..mixes.len()).filter(|i| mixes[*i].stream(group, first) != first).collect();
                prop_assert_eq!(second, vec![1, group + 2]);
            }
            for mix in mixes {
                prop_assert_eq!(mix.base(), base);
                let streams: Vec<u64> = (0..groups).map(|group| mix.stream(group, first)).collect();
                prop_assert!(streams.iter().all(|s| *s == first || *s == first | 1 << 63));
            }
        }

        /// Of any number of groups, any run has its draws, also where a base run takes more runs than there are numbers.
        #[test]
        fn any_number_of_groups_has_designs(groups: usize, run: u64, base: u64) {
            for groups in [groups, usize::MAX, usize::MAX - 1, usize::MAX - 2, 0] {
                let designs = Designs::new(groups);
                for run in [run, u64::MAX, 0] {
                    let mix = designs.of(run);
                    prop_assert!(designs.runs(mix.base()) <= run);
                    prop_assert!([7, 7 | SECOND].contains(&mix.stream(0, 7)));
                }
                prop_assert!(designs.runs(base) >= base);
                prop_assert!(designs.runs(1) >= 2);
            }
        }
    }

    /// Ishigami's function of three streams, in blocks of any size: within the intervals of the closed form, also as an
    /// indicator, and with runs that fail.
    #[test]
    fn indices_of_streams_are_those_of_ishigami() {
        let streams = ["x1", "x2", "x3", "x4"].map(|name| Streams::new(3, "m", name));
        let designs = Designs::new(4);
        let base = 4000;
        let angle = |mix: Mix<'_>, i: usize| {
            let pi = std::f64::consts::PI;
            streams[i].run(mix.stream(i, mix.base())).random_range(-pi..pi)
        };
        let y = |run: u64| {
            let mix = designs.of(run);
            let [x1, x2, x3] = [0, 1, 2].map(|i| angle(mix, i));
            libm::sin(x1) + 7.0 * libm::sin(x2).powi(2) + 0.1 * x3.powi(4) * libm::sin(x1)
        };
        let mut blocks = Vec::new();
        let mut first = 0;
        for size in [1, 5, 777, 4096].into_iter().cycle() {
            let last = (first + size).min(designs.runs(base));
            let columns =
                vec![Column::number("y", "1", "output"), Column::number("same", "1", "one")];
            let mut block = Table::new("m", first, columns).unwrap();
            (first..last).for_each(|run| {
                block.push(None, [Cell::Number(y(run)), Cell::Number(1.0)]).unwrap()
            });
            blocks.push(block);
            first = last;
            if first == designs.runs(base) {
                break;
            }
        }
        let empty = blocks[0].from_run(0);
        let runs = Runs::new(&empty, Vec::new(), blocks);
        let requirement: Requirement = "y <= 100 in 90 % at 90 %".parse().unwrap();
        let column = |name: &str| Output::Column(name.to_owned());
        let outputs =
            [column("y"), column("same"), column("none"), Output::Fails(Box::new(requirement))];
        let found = designs.indices(base, &runs, &outputs, Confidence::new(0.99).unwrap()).unwrap();
        assert!(found[1..].iter().all(Option::is_none), "nothing drives what is constant");
        let fewer = designs.indices(base - 1, &runs, &outputs[..1], Confidence::default()).unwrap();
        assert_eq!(fewer[0].as_ref().unwrap().runs(), base - 1);
        let found = found[0].as_ref().unwrap();
        assert_eq!(found.runs(), base);
        // Homma & Saltelli (1996), a = 7, b = 0.1.
        let expected = [(0.3139, 0.5576), (0.4424, 0.4424), (0.0, 0.2437), (0.0, 0.0)];
        for (index, (first, total)) in found.groups().iter().zip(expected) {
            for (estimate, expected) in [(index.first(), first), (index.total(), total)] {
                let interval = estimate.unwrap().interval();
                let near =
                    interval.lower() - 1e-4 <= expected && expected <= interval.upper() + 1e-4;
                assert!(near, "{interval} {expected}");
            }
        }
        assert_eq!(found.groups()[3].total().unwrap().value(), 0.0);
    }
}
