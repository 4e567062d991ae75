//! Draws of a whole from those of its parts, each from a stream of its own.

use gyradius_campaign::{
    CampaignError, Cell, Column, Failure, Simulation, Streams, Table, TableError, go_on,
};
use gyradius_dispersion::TenParameters;
use gyradius_estimation::{Assembly, AssemblyPart, FirstOrder, TEN_UNITS};
use gyradius_inertia::MassProperties;
use nalgebra::{Cholesky, SMatrix, SVector};
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use std::{ops::Range, sync::atomic::AtomicBool};

/// Under which streams are keyed, beside seed and name of the part.
const DRAWN: &str = "rollup";
const NAIVE: &str = "rollup naive";

/// The draws as a simulation: one row each.
#[derive(Debug)]
pub(super) struct Draws<'a> {
    /// A body of each part, in the order of their names: those that vary are drawn over it.
    bodies: Vec<MassProperties>,
    varying: Vec<(usize, &'a AssemblyPart, Streams)>,
}

impl<'a> Draws<'a> {
    pub(super) fn new(assembly: &'a Assembly, seed: u64) -> Self {
        let stream = |(name, part)| (part, Streams::new(seed, DRAWN, name));
        let parts: Vec<(&AssemblyPart, Streams)> = assembly.parts().map(stream).collect();
        let bodies = parts.iter().map(|(part, streams)| part.sample(&mut streams.run(0))).collect();
        let numbered = parts.into_iter().enumerate();
        let varying = numbered
            .filter(|(_, (part, _))| part.varies())
            .map(|(index, (part, streams))| (index, part, streams))
            .collect();
        Self { bodies, varying }
    }

    /// The parts of a draw, in the order of their names.
    fn parts(&self, run: u64, into: &mut Vec<MassProperties>) {
        into.clone_from(&self.bodies);
        let mut next = self.varying.iter();
        let each = self.varying.iter().map(|(_, _, streams)| (streams, run));
        Streams::each(each, 10, |rng| {
            if let Some((index, part, _)) = next.next() {
                into[*index] = part.sample(rng);
            }
        });
    }

    #[cfg(test)]
    pub(super) fn of(&self, run: u64) -> Vec<MassProperties> {
        let mut drawn = Vec::new();
        self.parts(run, &mut drawn);
        drawn
    }
}

impl Simulation for Draws<'_> {
    type Worker = Vec<MassProperties>;

    fn columns(&self) -> Vec<Column> {
        let pairs = TenParameters::COLUMNS.into_iter().zip(TEN_UNITS);
        pairs.map(|(name, unit)| Column::number(name, unit, "Of the whole, as drawn.")).collect()
    }

    fn worker(&self) -> Vec<MassProperties> {
        Vec::with_capacity(self.bodies.len())
    }

    fn run(
        &self,
        runs: Range<u64>,
        drawn: &mut Vec<MassProperties>,
        rows: &mut Table,
    ) -> Result<(), TableError> {
        for run in runs {
            self.parts(run, drawn);
            match Assembly::whole(drawn) {
                Ok(whole) => {
                    let ten = TenParameters::from(whole).values();
                    rows.push(None, ten.map(Cell::Number))?;
                }
                Err(error) => {
                    let failure = Failure::new("sum", error.to_string());
                    rows.push(Some(failure), [const { Cell::Null }; 10])?;
                }
            }
        }
        Ok(())
    }
}

/// How many Gaussian draws are no body's, where realizability is not asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct NaiveShares {
    /// How many were drawn of each.
    pub draws: u64,
    /// Of the whole, ten Gaussian numbers with mean and covariance by first order.
    pub whole: u64,
    /// Of the parts, ten independent Gaussian numbers each with what is stated, in which at least one part is impossible.
    pub any_part: u64,
    /// Names of the parts and their impossible draws, the most first; those without any are left away.
    pub parts: Vec<(String, u64)>,
}

/// Counts impossible naive draws, from streams of their own, part by part.
///
/// # Errors
/// It was told to stop.
pub(super) fn naive(
    assembly: &Assembly,
    seed: u64,
    draws: u64,
    stop: Option<&AtomicBool>,
) -> Result<NaiveShares, CampaignError> {
    let parts: Vec<(&str, &AssemblyPart)> = assembly.parts().collect();
    let none = || (vec![false; usize::try_from(draws).unwrap_or_default()], Vec::new());
    let (any, mut parts) = parts
        .into_par_iter()
        .filter(|(_, part)| part.varies())
        .try_fold(none, |(mut any, mut counts), (name, part)| {
            go_on(stop)?;
            let streams = Streams::new(seed, NAIVE, name);
            let mut count = 0;
            for (run, any) in (0..).zip(&mut any) {
                let impossible = !part.naive_draw_is_possible(&mut streams.run(run));
                count += u64::from(impossible);
                *any |= impossible;
            }
            if count > 0 {
                counts.push((name.to_owned(), count));
            }
            Ok::<_, CampaignError>((any, counts))
        })
        .try_reduce(none, |(mut any, mut counts), (others, more)| {
            any.iter_mut().zip(others).for_each(|(any, other)| *any |= other);
            counts.extend(more);
            Ok((any, counts))
        })?;
    parts.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
    let any_part = any.iter().filter(|any| **any).count() as u64;
    let whole = naive_whole(assembly.first_order(), seed, draws);
    Ok(NaiveShares { draws, whole, any_part, parts })
}

/// Impossible draws of ten Gaussian numbers.
fn naive_whole(moments: &FirstOrder, seed: u64, draws: u64) -> u64 {
    let (mean, root) = (SVector::from(moments.values()), root(moments));
    // No part has this name, for those have one.
    let streams = Streams::new(seed, NAIVE, "");
    let impossible = |run: &u64| {
        let mut rng = streams.run(*run);
        let normal = SVector::<f64, 10>::from_fn(|_, _| StandardNormal.sample(&mut rng));
        let ten = TenParameters::from_values((mean + root * normal).into());
        !ten.is_ok_and(|ten| ten.is_realizable())
    };
    (0..draws).filter(impossible).count() as u64
}

/// A square root of the covariance: that of the correlations of what varies, for units differ.
fn root(moments: &FirstOrder) -> SMatrix<f64, 10, 10> {
    let deviations = SMatrix::<f64, 10, 10>::from_diagonal(&SVector::from(moments.deviations()));
    let correlations = moments.correlations();
    let still = SMatrix::<f64, 10, 10>::from_fn(|i, j| {
        f64::from(u8::from(i == j && correlations[(i, i)] == 0.0))
    });
    // Where some combination does not vary, a hair more keeps the root real.
    let root = [0.0, 1e-12, 1e-9, 1e-6]
        .into_iter()
        .find_map(|more| Cholesky::new(correlations + still + SMatrix::identity() * more));
    deviations * root.map_or_else(SMatrix::identity, |root| root.l())
}
