//! What happens given each fault of a load, beside the runs without any: from columns of the run table alone.

use gyradius_campaign::{FirstLook, Requirement, SampleSummary, Subset, Surveys, Table};
use gyradius_report::{PageCell, PageTable, Section, Text, of_some, optional};
use gyradius_statistics::Confidence;
use serde::{Deserialize, Serialize};
use std::sync::{Mutex, PoisonError};

use crate::{
    quantity::Quantity,
    scenario::{Scenario, Target},
};

/// Outcomes that are told of.
const OUTCOMES: [Quantity; 8] = [
    Quantity::RelativeSpeed,
    Quantity::DirectionError,
    Quantity::PayloadTipOff1,
    Quantity::PayloadTipOff2,
    Quantity::PayloadTipOff3,
    Quantity::Nutation,
    Quantity::Cone,
    Quantity::Clearance,
];

/// What a model's runs with a fault did, or those without any.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct GivenFault {
    /// What is wrong, “spring 6 fails” say; none of the runs without any fault.
    pub(crate) fault: Option<String>,
    pub(crate) runs: u64,
    pub(crate) failed: u64,
    pub(crate) outcomes: Vec<Outcome>,
    /// Of each requirement how many of the runs that count fail it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) requirements: Vec<Failing>,
}

/// An outcome of these runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Outcome {
    column: String,
    #[serde(flatten)]
    sample: SampleSummary,
}

/// How many of these runs fail a requirement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Failing {
    pub(crate) requirement: String,
    pub(crate) counted: u64,
    pub(crate) failures: u64,
}

/// A fault that runs may have.
#[derive(Clone, Debug)]
struct Fault {
    name: String,
    /// Where the run table has it.
    column: String,
    /// Where the run table has when the load starts, if it is late.
    start: Option<String>,
}

/// What is counted of requirements given each fault, block by block.
#[derive(Debug)]
pub(crate) struct Faults<'a> {
    faults: Vec<Fault>,
    requirements: Vec<&'a Requirement>,
    /// By subset and requirement: runs that count, and failures.
    counts: Mutex<Vec<[u64; 2]>>,
}

impl<'a> Faults<'a> {
    /// Of the runs of a model of a scenario.
    pub(crate) fn new(scenario: &'a Scenario, model: &str) -> Self {
        let loads: Vec<_> = scenario.separation().loads().map(|(load, _)| load).collect();
        let dispersed = scenario.dispersions().all();
        let fault = |(place, what, column, start): (usize, &str, &str, Option<Target>)| Fault {
            name: loads
                .get(place)
                .map_or_else(|| column.to_owned(), |load| format!("{load} {what}")),
            column: column.to_owned(),
            start: dispersed.iter().find(|d| Some(d.target) == start).map(|d| d.column.clone()),
        };
        let faults = dispersed.iter().filter_map(|d| match d.target {
            Target::Fails(load) => Some((load, "fails", d.column.as_str(), None)),
            Target::Late(load, start) => {
                Some((load, "is late", d.column.as_str(), Some(Target::Load(load, start, 0))))
            }
            Target::Body(..) | Target::Stack(..) | Target::Load(..) => None,
        });
        let faults: Vec<Fault> = faults.map(fault).collect();
        let own = scenario.requirements().iter();
        let own = own.filter(|own| own.is_of(model) && !faults.is_empty());
        let requirements: Vec<&Requirement> = own.collect();
        let counts = Mutex::new(vec![[0; 2]; (faults.len() + 1) * requirements.len()]);
        Self { faults, requirements, counts }
    }

    /// The runs without any fault, and those with each.
    fn subsets(&self) -> Vec<Subset> {
        if self.faults.is_empty() {
            return Vec::new();
        }
        let columns = || self.faults.iter().map(|fault| fault.column.clone());
        let with = columns().map(Subset::With);
        [Subset::Without(columns().collect())].into_iter().chain(with).collect()
    }

    /// The look at columns that looks at the outcomes given each fault too, and at when what is late starts.
    pub(crate) fn watched_by(
        &self,
        look: FirstLook,
        runs: u64,
        confidence: Confidence,
    ) -> FirstLook {
        let outcomes = || OUTCOMES.iter().map(|quantity| quantity.column().into_owned());
        let starts = [None].into_iter().chain(self.faults.iter().map(|fault| fault.start.clone()));
        let columns = starts.map(|start| outcomes().chain(start).collect());
        look.given(self.subsets().into_iter().zip(columns), runs, confidence)
    }

    /// Looks at a block.
    pub(crate) fn look(&self, block: &Table) {
        if self.requirements.is_empty() {
            return;
        }
        let failing: Vec<_> = self.requirements.iter().map(|own| own.failing(block)).collect();
        let mut counted = Vec::new();
        for subset in self.subsets() {
            let mask = subset.of(block);
            for failing in &failing {
                let own = failing.iter().zip(&mask).filter(|(_, is_one)| **is_one);
                counted.push(own.fold([0; 2], |[runs, failures], (fails, _)| {
                    [runs + u64::from(fails.is_some()), failures + u64::from(*fails == Some(true))]
                }));
            }
        }
        let mut all = self.counts.lock().unwrap_or_else(PoisonError::into_inner);
        for (own, more) in all.iter_mut().zip(counted) {
            *own = [own[0] + more[0], own[1] + more[1]];
        }
    }

    /// What happens given each fault; nothing without faults.
    pub(crate) fn finish(self, surveys: &Surveys, confidence: Confidence) -> Vec<GivenFault> {
        let subsets = self.subsets();
        let counts = self.counts.into_inner().unwrap_or_else(PoisonError::into_inner);
        let name = |place: usize| Some(self.faults.get(place.checked_sub(1)?)?.name.clone());
        let given = |(place, subset): (usize, Subset)| {
            let [runs, failed] = surveys.runs_given(&subset);
            let outcome = |quantity: &Quantity| {
                let column = quantity.column().into_owned();
                let sample = SampleSummary::of(surveys.column_given(&subset, &column)?, confidence);
                Some(Outcome { column, sample })
            };
            let of_place = counts.iter().skip(place * self.requirements.len());
            let failing =
                |(requirement, [counted, failures]): (&&Requirement, &[u64; 2])| Failing {
                    requirement: requirement.name().to_owned(),
                    counted: *counted,
                    failures: *failures,
                };
            GivenFault {
                fault: name(place),
                runs,
                failed,
                outcomes: OUTCOMES.iter().filter_map(outcome).collect(),
                requirements: self.requirements.iter().zip(of_place).map(failing).collect(),
            }
        };
        subsets.into_iter().enumerate().map(given).collect()
    }
}

impl GivenFault {
    fn outcome(&self, quantity: Quantity) -> Option<&SampleSummary> {
        let column = quantity.column();
        self.outcomes.iter().find(|outcome| outcome.column == column).map(|outcome| &outcome.sample)
    }
}

/// What happens given each fault, of models by their names; none without faults.
pub(crate) fn section(models: &[(&str, &[GivenFault])]) -> Option<Section> {
    let rows: Vec<(&str, &GivenFault)> =
        models.iter().flat_map(|(model, given)| given.iter().map(move |g| (*model, g))).collect();
    let mut table = PageTable::of(&rows)
        .words("fault", |(_, given)| given.fault.clone().unwrap_or_else(|| "no fault".to_owned()))
        .groups(|(model, _)| (*model).to_owned())
        .quiet(|(_, given)| given.fault.is_none())
        .numbers("runs", |(_, given)| given.runs.to_string())
        .numbers("of them failed", |(_, given)| given.failed.to_string());
    let mut names: Vec<&str> = Vec::new();
    for failing in rows.iter().flat_map(|(_, given)| &given.requirements) {
        if !names.contains(&failing.requirement.as_str()) {
            names.push(&failing.requirement);
        }
    }
    for name in names {
        table = table.numbers_of("do not keep the requirement", name, |(_, given)| {
            let failing = given.requirements.iter().find(|failing| failing.requirement == name);
            failing.map_or_else(|| "–".into(), share)
        });
    }
    for quantity in OUTCOMES {
        let has = |(_, given): &(&str, &GivenFault)| {
            given.outcome(quantity).is_some_and(|sample| sample.n > 0)
        };
        if rows.iter().any(has) {
            table = table.numbers(quantity.label_with_unit(), |(_, given)| {
                let sample = given.outcome(quantity).filter(|sample| sample.n > 0);
                let runs = given.runs.saturating_sub(given.failed);
                sample.map_or_else(|| "–".into(), |s| cell(s).noting(of_some(s.n, runs)))
            });
        }
    }
    let reading = "Runs with each fault, beside those without any. A run with several faults counts with each of them. Of \
                   each outcome the mean, below it the standard deviation and the 95th percentile.";
    (!rows.is_empty())
        .then(|| Section::new("What happens given each fault").paragraph(reading).table(table))
}

fn share(failing: &Failing) -> PageCell {
    let Failing { counted, failures, .. } = failing;
    if *counted == 0 {
        return "–".into();
    }
    let percent = 100.0 * *failures as f64 / *counted as f64;
    PageCell::from(format!("{failures} of {counted}"))
        .line(Text::default().quiet(format!("{} %", optional(Some(percent), 3))))
}

fn cell(sample: &SampleSummary) -> PageCell {
    let deviation = sample.deviation.filter(|_| sample.n > 1);
    let quiet = |text: String| Text::default().quiet(text);
    PageCell::from(optional(sample.mean, 4))
        .line(quiet(format!("± {}", optional(deviation, 2))))
        .line(quiet(format!("p95 {}", optional(sample.p95, 4))))
}

#[cfg(test)]
mod tests;
