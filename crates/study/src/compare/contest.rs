//! One model about one body at one level.

use gyradius_campaign::{Share, Streams, counted};
use gyradius_dispersion::ModelKind;
use gyradius_inertia::InertiaMatrix;
use gyradius_separation::{Batch, Outcome, SpinMetrics};
use gyradius_statistics::{Confidence, StatisticsError};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

use super::{
    fit::Fit,
    measure::{Measure, Spread},
    options::Size,
    reference::{Candidate, Target},
};
use crate::{StudyError, failure::RunFailure, scenario::Scenario};

/// How a model did, or why there is none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Cell {
    pub(crate) model: ModelKind,
    pub(crate) realizable_by_construction: bool,
    /// Why no model of this kind has the moments.
    pub(crate) problem: Option<String>,
    pub(crate) results: Option<Results>,
}

/// Separations of a batch: its lanes stand idle at its end alone, and there are enough batches for many threads.
const TOGETHER: usize = 32;

/// Refuses once somebody wants an end: a separation of some scenarios takes a second.
pub(crate) type GoOn<'a> = &'a (dyn Fn() -> Result<(), StudyError> + Sync);

/// What the draws of a model are like.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Results {
    /// What of the moments it was given.
    pub(crate) matched: Cow<'static, str>,
    pub(crate) fit: Fit,
    /// The share of draws that rejection keeps, if it rejects.
    pub(crate) acceptance: Option<f64>,
    pub(crate) unrealizable: Share,
    pub(crate) spreads: Vec<Spread>,
    pub(crate) separations: u64,
    pub(crate) failed_separations: u64,
    pub(crate) failures: Vec<(String, u64)>,
}

impl Results {
    pub(crate) fn spread(&self, measure: Measure) -> Option<&Spread> {
        self.spreads.iter().find(|s| s.measure == measure)
    }
}

struct Drawn {
    entries: [f64; 6],
    realizable: bool,
    measures: [Option<f64>; Measure::OF_DRAWS],
}

impl Cell {
    pub(crate) fn new(
        kind: ModelKind,
        target: &Target,
        scenario: &Scenario,
        streams: &Streams,
        size: Size,
        go_on: GoOn<'_>,
    ) -> Result<Self, StudyError> {
        let mut cell = Self {
            model: kind,
            realizable_by_construction: kind.is_realizable_by_construction(),
            problem: None,
            results: None,
        };
        match target.model(kind) {
            Err(problem) => cell.problem = Some(problem),
            Ok(Candidate { law: model, moments, matched }) => {
                let draw = |run: u64| model.draw(&mut streams.run(run)).inertia;
                let drawn: Vec<Drawn> = (0..size.draws)
                    .into_par_iter()
                    .map(|run| Drawn::new(&draw(run), scenario))
                    .collect();
                let runs: Vec<u64> = (0..size.separations).collect();
                let groups = runs.par_chunks(TOGETHER).map(|runs| {
                    let payloads = runs.iter().map(|run| draw(*run));
                    nutations(payloads, scenario, go_on)
                });
                let separated = groups.collect::<Result<Vec<_>, StudyError>>()?.concat();
                let entries = || drawn.iter().map(|d| d.entries).collect::<Vec<_>>();
                let fit = match moments {
                    Some(moments) => Some(Fit::known(&moments, target.moments())),
                    None => Fit::of_draws(&entries(), target.moments()),
                };
                if let Some(fit) = fit {
                    let results =
                        Results::new(matched, fit, model.acceptance(), &drawn, &separated)?;
                    cell.results = Some(results);
                } else {
                    cell.problem = Some("too few draws".to_owned());
                }
            }
        }
        Ok(cell)
    }
}

impl Results {
    fn new(
        matched: &'static str,
        fit: Fit,
        acceptance: Option<f64>,
        drawn: &[Drawn],
        separated: &[Result<Option<f64>, RunFailure>],
    ) -> Result<Self, StatisticsError> {
        let unrealizable = drawn.iter().filter(|d| !d.realizable).count() as u64;
        let failed = separated.iter().filter_map(|s| s.as_ref().err());
        let failures = counted(failed.map(|failure| failure.kind().into_owned()));
        let spreads = Measure::ALL.into_iter().enumerate().map(|(i, measure)| {
            if i < Measure::OF_DRAWS {
                Spread::new(measure, drawn.iter().map(|d| d.measures[i]))
            } else {
                Spread::new(measure, separated.iter().flatten().copied())
            }
        });
        Ok(Self {
            matched: matched.into(),
            fit,
            acceptance,
            unrealizable: Share::new(unrealizable, drawn.len() as u64, Confidence::default())?,
            spreads: spreads.collect(),
            separations: separated.len() as u64,
            failed_separations: failures.iter().map(|f| f.1).sum(),
            failures,
        })
    }
}

impl Drawn {
    fn new(inertia: &InertiaMatrix, scenario: &Scenario) -> Self {
        Self {
            entries: inertia.entries(),
            realizable: inertia.is_realizable(),
            measures: measures(inertia, scenario),
        }
    }
}

/// Principal moments in descending order, inertia ratio, wobble in degrees.
pub(crate) fn measures(
    inertia: &InertiaMatrix,
    scenario: &Scenario,
) -> [Option<f64>; Measure::OF_DRAWS] {
    let mut moments = inertia.principal_axes().moments();
    moments.sort_by(f64::total_cmp);
    let [smallest, middle, largest] = moments;
    // Neither depends on how fast the body turns.
    let spin = SpinMetrics::new(inertia, scenario.spin_axis().as_ref(), scenario.spin_axis());
    let wobble = spin.wobble().to_degrees();
    [Some(largest), Some(middle), Some(smallest), spin.inertia_ratio(), Some(wobble)]
}

/// Nutation in degrees after the separation of the scenario with each of these payloads, which are separated together.
pub(crate) fn nutations(
    payloads: impl Iterator<Item = InertiaMatrix>,
    scenario: &Scenario,
    go_on: GoOn<'_>,
) -> Result<Vec<Result<Option<f64>, RunFailure>>, StudyError> {
    let stage = *scenario.stage().nominal().as_inertia_matrix();
    let separation = |payload| scenario.separation().with_inertias(payload, stage);
    let separations: Vec<_> = payloads.map(separation).collect();
    let places: Vec<usize> = (0..separations.len()).filter(|i| separations[*i].is_ok()).collect();
    let nutation = |outcome: Outcome| {
        outcome.spin_metrics(scenario.spin_axis()).nutation().map(f64::to_degrees)
    };
    let mut results = vec![Ok(None); separations.len()];
    // Ends early once somebody wants an end, which is asked again below.
    let queue = separations.iter().flatten().take_while(|_| go_on().is_ok());
    Batch::new(*scenario.settings()).run(queue, |i, outcome| {
        results[places[i]] = outcome.map(nutation).map_err(RunFailure::from);
    });
    go_on()?;
    for (result, refused) in results.iter_mut().zip(separations) {
        if let Err(refused) = refused {
            *result = Err(refused.into());
        }
    }
    Ok(results)
}
