//! What is unusual among what the worst runs have drawn.

use gyradius_campaign::{Runs, RunsError};
use serde::{Deserialize, Serialize};
use std::{
    collections::BTreeSet,
    sync::{Mutex, PoisonError},
};

use crate::rounding::Rounding;

/// Inputs of a run that are told of, at most.
const TOLD: usize = 3;
/// Standard deviations from the mean of the runs from which on an input is unusual.
const UNUSUAL: f64 = 2.0;

/// What is unusual among what a run has drawn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Unusual {
    pub(crate) run: u64,
    /// The most unusual first.
    pub(crate) inputs: Vec<UnusualInput>,
}

/// A number that a run has drawn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct UnusualInput {
    pub(crate) column: String,
    pub(crate) value: f64,
    /// How many standard deviations it lies above the mean of all runs of the model.
    pub(crate) score: f64,
}

/// A deviation that is a smaller share of the entries of an inertia is rounding, for they are computed of what is drawn.
const ROUNDING_OF_ENTRIES: f64 = 1e-12;

/// The inputs whose deviation is more than rounding, and those of which it is rounding alone: of an entry of an inertia,
/// beside the largest of the six. `inertias` are the columns of each.
pub(crate) fn without_rounding(
    inputs: Vec<DrawnInput>,
    inertias: &[[String; 6]],
) -> (Vec<DrawnInput>, Vec<DrawnInput>) {
    let size = |input: &DrawnInput| input.mean.abs() + input.deviation;
    let moves = |input: &DrawnInput| {
        let Some(entries) = inertias.iter().find(|entries| entries.contains(&input.column)) else {
            return Rounding::OF_LAST_PLACES.is_exceeded_by(input.deviation, size(input));
        };
        let beside = inputs.iter().filter(|other| entries.contains(&other.column));
        input.deviation > ROUNDING_OF_ENTRIES * beside.map(size).fold(0.0, f64::max)
    };
    let moves: Vec<bool> = inputs.iter().map(moves).collect();
    let (moving, rounding): (Vec<_>, Vec<_>) =
        inputs.into_iter().zip(moves).partition(|(_, moves)| *moves);
    let inputs = |of: Vec<(DrawnInput, bool)>| of.into_iter().map(|(input, _)| input).collect();
    (inputs(moving), inputs(rounding))
}

/// A number that runs draw, with its mean and standard deviation over the runs.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct DrawnInput {
    pub(crate) column: String,
    pub(crate) mean: f64,
    pub(crate) deviation: f64,
}

impl DrawnInput {
    /// None if runs do not differ in it.
    pub(crate) fn new(column: &str, mean: Option<f64>, deviation: Option<f64>) -> Option<Self> {
        let (mean, deviation) = (mean?, deviation.filter(|d| *d > 0.0 && d.is_finite())?);
        Some(Self { column: column.to_owned(), mean, deviation })
    }
}

/// What some runs have drawn that is unusual, of those that have something.
pub(crate) fn unusual(
    inputs: &[DrawnInput],
    worst: &BTreeSet<u64>,
    runs: &Runs,
) -> Result<Vec<Unusual>, RunsError> {
    let found = Mutex::new(Vec::new());
    runs.scan_those_with(worst, |block| {
        let last = block.first() + block.len() as u64;
        for run in worst.range(block.first()..last) {
            let place = (run - block.first()) as usize;
            let scored = |input: &DrawnInput| {
                let value = block.numbers(&input.column)?.get(place)?;
                let score = (value - input.mean) / input.deviation;
                let column = input.column.clone();
                (score.abs() >= UNUSUAL).then_some(UnusualInput { column, value, score })
            };
            let mut inputs: Vec<UnusualInput> = inputs.iter().filter_map(scored).collect();
            inputs.sort_by(|a, b| b.score.abs().total_cmp(&a.score.abs()));
            inputs.truncate(TOLD);
            if !inputs.is_empty() {
                let unusual = Unusual { run: *run, inputs };
                found.lock().unwrap_or_else(PoisonError::into_inner).push(unusual);
            }
        }
    })?;
    Ok(found.into_inner().unwrap_or_else(PoisonError::into_inner))
}

#[cfg(test)]
mod tests {
    use super::*;
    use gyradius_campaign::{Cell, Column, Table};
    use proptest::prelude::*;

    /// The columns of the inertia of a body.
    fn entries(body: &str) -> [String; 6] {
        ["11", "22", "33", "12", "13", "23"].map(|entry| format!("{body}_i{entry}"))
    }

    /// Entries of an inertia are held against each other, other inputs each against itself.
    #[test]
    fn rounding_is_no_input() {
        let all = [
            ("payload_i11", 5000.0, 40.0),
            ("payload_i12", 0.0, 8e-15),
            ("payload_i13", 20.0, 1e-3),
            ("stage_i11", 1e-9, 1e-10),
            ("stage_i23", 0.0, 1e-12),
            ("thrust_1", 1e9, 1e6),
            ("thrust_2", 0.0, 1e-6),
            ("still", 12.0, 2e-15),
        ];
        let input =
            |(column, mean, deviation)| DrawnInput::new(column, Some(mean), Some(deviation));
        let inputs = all.into_iter().filter_map(input).collect();
        let (moving, rounding) = without_rounding(inputs, &["payload", "stage"].map(entries));
        assert_eq!(moving.len() + rounding.len(), all.len());
        let found: Vec<&str> = moving.iter().map(|input| input.column.as_str()).collect();
        assert_eq!(
            found,
            ["payload_i11", "payload_i13", "stage_i11", "stage_i23", "thrust_1", "thrust_2"]
        );
    }

    proptest! {
        /// Numbers whose names end as entries of an inertia do are none unless a body has them: whatever they are called, each moves or
        /// not as it would alone.
        #[test]
        fn numbers_called_as_entries_are_no_inertia(
            sizes in prop::collection::vec((-20..20_i32, -20..4_i32), 12),
            bodies in prop::collection::vec(any::<bool>(), 2),
        ) {
            let names: Vec<[String; 6]> = ["sensor", "payload"].map(entries).into();
            let input = |(name, (mean, share)): (&String, &(i32, i32))| {
                let mean = 10_f64.powi(*mean);
                DrawnInput::new(name, Some(mean), Some(mean * 10_f64.powi(*share))).unwrap()
            };
            let inputs: Vec<DrawnInput> = names.as_flattened().iter().zip(&sizes).map(input).collect();
            let inertias: Vec<[String; 6]> =
                names.iter().zip(&bodies).filter(|(_, is_body)| **is_body).map(|(names, _)| names.clone()).collect();
            let (moving, rounding) = without_rounding(inputs.clone(), &inertias);
            prop_assert_eq!(moving.len() + rounding.len(), inputs.len());
            for (six, is_body) in inputs.chunks(6).zip(&bodies) {
                let size = |input: &DrawnInput| input.mean.abs() + input.deviation;
                let largest = six.iter().map(size).fold(0.0, f64::max);
                for input in six {
                    let least = if *is_body { 1e-12 * largest } else { 16.0 * f64::EPSILON * size(input) };
                    prop_assert_eq!(moving.contains(input), input.deviation > least);
                }
            }
        }
    }

    proptest! {
        /// Against looking at every number of every run.
        #[test]
        fn the_most_unusual_inputs_are_told(
            rows in prop::collection::vec(prop::collection::vec(prop::option::weighted(0.9, -5.0..5.0_f64), 5), 1..40),
            worst in prop::collection::btree_set(0..40_u64, 0..12),
        ) {
            let names: Vec<String> = (0..5).map(|i| format!("x{i}")).collect();
            let columns = names.iter().map(|name| Column::number(name.clone(), "1", "A number."));
            let mut table = Table::new("model", 0, columns.collect()).unwrap();
            for row in &rows {
                table.push(None, row.iter().map(|x| Cell::from(*x))).unwrap();
            }
            let inputs: Vec<DrawnInput> =
                names.iter().zip(1..).map(|(name, i)| DrawnInput::new(name, Some(0.1), Some(0.5 * f64::from(i))).unwrap()).collect();
            let found = unusual(&inputs, &worst, &Runs::from(table)).unwrap();
            let mut expected = Vec::new();
            for run in worst.iter().filter(|run| **run < rows.len() as u64) {
                let scores = rows[*run as usize].iter().zip(1..).enumerate();
                let mut scores: Vec<(usize, f64)> = scores
                    .filter_map(|(column, (x, i))| Some((column, ((*x)? - 0.1) / (0.5 * f64::from(i)))))
                    .filter(|(_, score)| score.abs() >= 2.0)
                    .collect();
                scores.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
                scores.truncate(3);
                if !scores.is_empty() {
                    expected.push((*run, scores));
                }
            }
            let told: Vec<(u64, Vec<(usize, f64)>)> = found
                .iter()
                .map(|u| (u.run, u.inputs.iter().map(|i| (i.column[1..].parse().unwrap(), i.score)).collect()))
                .collect();
            prop_assert_eq!(told, expected);
        }
    }

    #[test]
    fn what_does_not_differ_is_not_unusual() {
        assert_eq!(DrawnInput::new("x", Some(1.0), Some(0.0)), None);
        assert_eq!(DrawnInput::new("x", None, Some(1.0)), None);
        assert_eq!(DrawnInput::new("x", Some(1.0), None), None);
    }
}
