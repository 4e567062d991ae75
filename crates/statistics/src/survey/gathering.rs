//! What a pass gathers of values, and how parts of it are put together.

use super::*;

impl Pass {
    /// Takes up values, each with the number of its run.
    pub fn extend(&mut self, values: impl IntoIterator<Item = (u64, f64)>) {
        let Some((size, first)) = &mut self.first else {
            if let Some(gathered) = &mut self.gathered {
                gathered.extend(values);
            }
            return;
        };
        let values: Vec<(u64, f64)> = values.into_iter().collect();
        let begins = values.iter().filter(|(run, _)| run.is_multiple_of(*size));
        first.extend(begins.map(|(run, x)| (run / *size, *x)).collect::<Vec<_>>());
        if let Some(gathered) = &mut self.gathered {
            gathered.extend(values);
        }
    }

    /// Takes up what another part of the same pass has gathered.
    pub fn merge(&mut self, other: Self) {
        if let (Some(gathered), Some(more)) = (&mut self.gathered, other.gathered) {
            gathered.merge(more);
        }
        if let (Some((_, first)), Some((_, more))) = (&mut self.first, other.first) {
            first.merge(*more);
        }
    }
}

impl Gathered {
    fn extend(&mut self, values: impl IntoIterator<Item = (u64, f64)>) {
        match self {
            Self::First(first) => values.into_iter().for_each(|(run, x)| first.add(run, x)),
            Self::Later(later) => {
                let Later { centred, powers, count, groups } = &mut **later;
                let deviations = values.into_iter().map(|(run, x)| {
                    let deviation = centred.map_or(0.0, |centred| centred.map(x));
                    if let Some(powers) = powers {
                        powers.add(deviation);
                    }
                    if let Some(count) = count {
                        count.add(x, deviation);
                    }
                    (run, deviation)
                });
                match groups {
                    Some(groups) => groups.part(deviations),
                    None => deviations.for_each(drop),
                }
            }
        }
    }

    fn merge(&mut self, other: Self) {
        match (self, other) {
            (Self::First(first), Self::First(other)) => {
                first.n += other.n;
                first.finite += other.finite;
                first.sampled += other.sampled;
                first.sum.merge(&other.sum);
                first.sample.extend(other.sample);
                other.range.into_iter().for_each(|range| first.stretch(range));
            }
            (Self::Later(later), Self::Later(other)) => {
                if let (Some(powers), Some(more)) = (&mut later.powers, &other.powers) {
                    powers.merge(more);
                }
                if let (Some(count), Some(more)) = (&mut later.count, &other.count) {
                    count.merge(more);
                }
                if let (Some(groups), Some(more)) = (&mut later.groups, other.groups) {
                    groups.merge(more);
                }
            }
            // Of another pass, which knows nothing of this one.
            (Self::First(_) | Self::Later(_), _) => {}
        }
    }
}
