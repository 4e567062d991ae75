//! Every number that the report shows.

use gyradius_campaign::{Column, SampleSummary, Share, Subset, Surveys, bounded};
use gyradius_report::Figure;
use gyradius_statistics::{Confidence, Interval, Moments, StatisticsError, Survey};
use rayon::prelude::*;
use serde::{Deserialize, Serialize, Serializer, ser::Error};
use std::borrow::Cow;

use crate::{
    Fleet,
    alerts::Alert,
    body::Body,
    claim::Claim,
    column::{CLEARANCE_NOTE, REALIZABLE},
    compare::Section,
    faults::GivenFault,
    head::Head,
    model::Model,
    quantity::Quantity,
    regions::RegionSummary,
    rounding::Rounding,
    run::Case,
    scenario::{Dispersed, Each, ModelLaw, Scenario, Target},
    seen::Seen,
    subject::{Subject, Summarized, head_of},
    unusual::DrawnInput,
};

/// Every number that the report shows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Of what it is.
    #[serde(flatten)]
    pub head: Head,
    pub(crate) nominal: Vec<Nominal>,
    pub(crate) models: Vec<ModelSummary>,
    pub(crate) comparisons: Vec<ComparisonSummary>,
    pub(crate) claims: Vec<Claim>,
    /// Every model of inertia with the moments of the scenario's bodies.
    pub(crate) every_model: Section,
    /// What the figures show.
    #[serde(serialize_with = "a_line_each")]
    pub(crate) figures: Vec<Figure>,
}

/// A quantity of the run without any dispersion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Nominal {
    #[serde(with = "column")]
    pub(crate) quantity: Quantity,
    pub(crate) unit: Cow<'static, str>,
    pub(crate) value: f64,
}

/// What the runs of one model did.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ModelSummary {
    pub(crate) name: String,
    pub(crate) law: ModelLaw,
    pub(crate) realizable_by_construction: bool,
    /// Estimated shares of draws for payload and stage that a law by rejection keeps.
    pub(crate) acceptance: Option<[f64; 2]>,
    /// What of the draws the regions of the bodies keep.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) regions: Vec<RegionSummary>,
    pub(crate) failed: u64,
    /// Kinds of failure, with how often.
    pub(crate) failures: Vec<(String, u64)>,
    pub(crate) unrealizable: Share,
    /// Draws in the half sphere away from the mean attitude, for payload and stage, where the law
    /// draws attitudes.
    pub(crate) far_half: Option<[Option<Share>; 2]>,
    /// Deviations that an entrywise law was given: payload and stage, each in the order of the run
    /// table, kg·m².
    pub(crate) given_deviations_kg_m2: Option<[[f64; 6]; 2]>,
    pub(crate) releases: Releases,
    pub(crate) quantities: Vec<QuantitySummary>,
    /// What else was drawn, in all runs, those that failed too.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) dispersed: Vec<DispersedSummary>,
    /// What happens given each fault, where loads may fail or be late.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) faults: Vec<GivenFault>,
}

/// A dispersed quantity: its law, and what one model drew of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct DispersedSummary {
    pub(crate) quantity: String,
    pub(crate) law: Cow<'static, str>,
    #[serde(default, skip_serializing_if = "Each::is_flight")]
    pub(crate) drawn: Each,
    pub(crate) nominal: f64,
    pub(crate) law_mean: f64,
    pub(crate) law_deviation: f64,
    pub(crate) mean: Option<f64>,
    pub(crate) deviation: Option<f64>,
    /// Of when a load that may be late starts: what was drawn in the runs in which it is late, to which alone the law applies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) late: Option<LateSummary>,
}

/// When a load starts in the runs in which it is late.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct LateSummary {
    pub(crate) runs: u64,
    pub(crate) mean: Option<f64>,
    /// None below two such runs.
    pub(crate) deviation: Option<f64>,
}

/// How springs let go in the runs that succeed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Releases {
    /// The orders of releases, as in the run table, the most frequent first.
    pub(crate) orders: Vec<Order>,
    /// Runs in which a spring was pressed again after it had let go; none if no run succeeds.
    pub(crate) recompressed: Option<Share>,
    /// Runs in which outlines touch again; none without outlines or if no run succeeds.
    pub(crate) recontact: Option<Share>,
    /// Smallest distances of outlines; none without outlines, or if no run succeeds.
    pub(crate) clearance: Option<ClearanceSummary>,
}

/// How near the bodies come.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ClearanceSummary {
    /// Runs that have a clearance.
    pub(crate) n: u64,
    /// Smallest of all runs, m, and in which run.
    pub(crate) least_m: Option<f64>,
    pub(crate) run: Option<u64>,
    /// Percentiles of the clearance that all but so many runs keep, m.
    pub(crate) p01_m: Option<f64>,
    pub(crate) p01_interval_m: Option<Interval>,
    pub(crate) p05_m: Option<f64>,
    /// Why runs have no clearance, or not one of their whole coast, with how often.
    pub(crate) notes: Vec<(String, u64)>,
}

/// How often springs let go in an order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Order {
    pub(crate) order: String,
    #[serde(flatten)]
    pub(crate) share: Share,
}

/// The distribution of one quantity under one model. What a sample cannot tell is null.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct QuantitySummary {
    #[serde(with = "column")]
    pub(crate) quantity: Quantity,
    pub(crate) unit: Cow<'static, str>,
    #[serde(flatten)]
    pub(crate) sample: SampleSummary,
}

/// A naive model beside a physical one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ComparisonSummary {
    pub(crate) title: String,
    pub(crate) physical: String,
    pub(crate) naive: String,
    pub(crate) ratios: Vec<Ratio>,
}

/// How much more a quantity varies, and how much larger it is, under the naive model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Ratio {
    #[serde(with = "column")]
    pub(crate) quantity: Quantity,
    /// Deviation under the naive model over deviation under the physical one.
    pub(crate) deviation_ratio: Option<f64>,
    pub(crate) deviation_ratio_interval: Option<Interval>,
    /// Mean under the naive model less mean under the physical one, in the quantity's unit.
    pub(crate) mean_difference: Option<f64>,
    pub(crate) mean_difference_interval: Option<Interval>,
}

/// Figures hold many numbers, which would have a line each.
fn a_line_each<S: Serializer>(figures: &[Figure], to: S) -> Result<S::Ok, S::Error> {
    let line = |figure| serde_json::value::to_raw_value(figure).map_err(S::Error::custom);
    figures.iter().map(line).collect::<Result<Vec<_>, _>>()?.serialize(to)
}

/// A quantity by the name of its column.
mod column {
    use super::Quantity;
    use serde::{Deserialize, Deserializer, Serializer, de::Error};

    pub(super) fn serialize<S: Serializer>(quantity: &Quantity, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(&quantity.column())
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Quantity, D::Error> {
        let name = String::deserialize(from)?;
        Quantity::of_column(&name).ok_or_else(|| D::Error::custom(format!("no column {name:?}")))
    }
}

impl Summary {
    pub(crate) fn new(
        scenario: &Scenario,
        models: &[Model],
        runs: &[Seen],
        columns: &[Column],
        every_model: Section,
    ) -> Result<Self, StatisticsError> {
        let confidence = Confidence::default();
        let ((nominal, nominal_failed), rounding) = (nominal(scenario), scenario.rounding());
        let models = models
            .par_iter()
            .zip(runs)
            .map(|(model, seen)| ModelSummary::new(scenario, model, seen, confidence))
            .collect::<Result<Vec<_>, _>>()?;
        let comparisons = scenario
            .comparisons()
            .par_iter()
            .map(|c| {
                let (physical, naive) = (&runs[c.physical], &runs[c.naive]);
                ComparisonSummary {
                    title: c.title.clone(),
                    physical: physical.model().to_owned(),
                    naive: naive.model().to_owned(),
                    ratios: all(scenario)
                        .map(|q| Ratio::new(q, physical, naive, rounding, confidence))
                        .collect(),
                }
            })
            .collect();
        let alerts = models
            .iter()
            .zip(runs)
            .flat_map(|(model, seen)| model.alerts(scenario, seen, rounding));
        let alerts = alerts.chain(nominal_failed);
        let alerts =
            alerts.chain(Alert::off_axis(scenario.payload().moving(), scenario.spin_axis()));
        let alerts = alerts.chain(scenario.off_nominal().into_iter().map(Alert::OffNominal));
        let alerts = alerts.chain(scenario.folded().into_iter().map(Alert::Folded));
        let alerts = alerts.chain(scenario.unmatched().into_iter().map(Alert::Unmatched));
        let head = Head { alerts: alerts.collect(), ..head_of(scenario, columns) };
        Ok(Self {
            head,
            nominal,
            models,
            comparisons,
            claims: Vec::new(),
            every_model,
            figures: Vec::new(),
        })
    }

    pub(crate) fn model(&self, name: &str) -> Option<&ModelSummary> {
        self.models.iter().find(|m| m.name == name)
    }

    pub(crate) fn nominal_value(&self, quantity: Quantity) -> Option<f64> {
        self.nominal.iter().find(|n| n.quantity == quantity).map(|n| n.value)
    }
}

impl Summarized for Summary {
    fn head(&self) -> &Head {
        &self.head
    }

    fn head_mut(&mut self) -> &mut Head {
        &mut self.head
    }

    fn failed(&self) -> Vec<(String, u64, u64)> {
        self.models.iter().map(|m| (m.name.clone(), m.failed, m.unrealizable.of)).collect()
    }
}

/// All quantities, for many threads.
fn all(scenario: &Scenario) -> impl IndexedParallelIterator<Item = Quantity> {
    Quantity::of(scenario.separation()).collect::<Vec<_>>().into_par_iter()
}

/// The run of the nominal bodies, and that it failed, if it did: then what follows from the payload alone is known.
fn nominal(scenario: &Scenario) -> (Vec<Nominal>, Option<Alert>) {
    let case = Case::nominal(scenario);
    let result = scenario.separation().run(scenario.settings());
    let run = case.ended(scenario, Some(result));
    let spin = scenario.payload().moving().spin_metrics(scenario.spin_axis());
    let alone = [
        (Quantity::Wobble, Some(spin.wobble().to_degrees())),
        (Quantity::InertiaRatio, spin.inertia_ratio()),
    ];
    let of_payload = |quantity| alone.into_iter().find(|(own, _)| *own == quantity)?.1;
    let told = Quantity::of(scenario.separation()).filter_map(|quantity| {
        let value = quantity.value(&run).or_else(|| of_payload(quantity));
        let value = value.filter(|value| value.is_finite())?;
        Some(Nominal { quantity, unit: quantity.unit().into(), value })
    });
    let failed = run.failure().map(|why| Alert::NominalFailed { why: why.to_string() });
    (told.collect(), failed)
}

fn dispersed(scenario: &Scenario, seen: &Seen) -> Vec<DispersedSummary> {
    let all = scenario.dispersions().all();
    let moments = |column: &str| seen.surveys.column(column).and_then(Survey::moments);
    let late = |start: &Dispersed| {
        let of_start = |d: &&Dispersed| match d.target {
            Target::Late(load, parameter) => Target::Load(load, parameter, 0) == start.target,
            Target::Body(..) | Target::Stack(..) | Target::Load(..) | Target::Fails(_) => false,
        };
        let late = Subset::With(all.iter().find(of_start)?.column.clone());
        Some(LateSummary::new(seen.surveys.column_given(&late, &start.column)?))
    };
    let summary = |d: &Dispersed| DispersedSummary {
        quantity: d.column.clone(),
        law: d.law.name().into(),
        drawn: d.each,
        nominal: d.nominal,
        law_mean: d.law.mean(),
        law_deviation: d.law.deviation(),
        mean: seen.surveys.column(&d.column).and_then(Survey::mean),
        deviation: moments(&d.column).map(Moments::standard_deviation),
        late: late(d),
    };
    all.iter().map(summary).collect()
}

impl LateSummary {
    /// Of when a load starts in the runs in which it is late.
    fn new(start: &Survey) -> Self {
        let deviation = start.moments().map(Moments::standard_deviation);
        Self { runs: start.n(), mean: start.mean(), deviation }
    }
}

impl ModelSummary {
    fn new(
        scenario: &Scenario,
        model: &Model,
        seen: &Seen,
        confidence: Confidence,
    ) -> Result<Self, StatisticsError> {
        let inertia = scenario.dispersions().inertia;
        let sharing = scenario.sharing().map_or(1, Fleet::flights);
        // What a vehicle has drawn counts once.
        let share = |body: Body, count: u64, of: u64| {
            let flights = match inertia[body as usize] {
                Each::Vehicle => sharing,
                Each::Flight => 1,
            };
            let of_vehicles = of / flights;
            let once = (count.div_ceil(flights).min(of_vehicles), of_vehicles);
            Share::of_dependent(count, of, once, confidence)
        };
        let failures = owned(seen.surveys.failures());
        let far = |body: Body| {
            let (far, of) = (seen.far[body as usize], seen.drawn[body as usize]);
            far.filter(|_| of > 0).map(|far| share(body, far, of)).transpose()
        };
        let far_half = [far(Body::Payload)?, far(Body::Stage)?];
        let far_half = far_half.iter().any(Option::is_some).then_some(far_half);
        let [unrealizable, _] = seen.surveys.flags(REALIZABLE);
        // Inertias that each flight draws anew are independent, whatever else flights have in common.
        let anew = inertia.iter().all(Each::is_flight);
        let of_flags = if anew { &seen.surveys } else { seen.surveys.independent() };
        let [independent, _] = of_flags.flags(REALIZABLE);
        let independent = (independent, of_flags.runs());
        Ok(Self {
            name: seen.model().to_owned(),
            law: model.law(),
            realizable_by_construction: model.is_realizable_by_construction(),
            acceptance: model.acceptance(),
            regions: model
                .kept()
                .map(|(body, kept)| RegionSummary::new(body.name(), kept))
                .collect(),
            failed: failures.iter().map(|f| f.1).sum(),
            failures,
            unrealizable: Share::of_dependent(unrealizable, seen.runs(), independent, confidence)?,
            far_half,
            given_deviations_kg_m2: model.given_deviations(),
            releases: Releases::new(&seen.surveys, scenario.outlines().is_some(), confidence)?,
            quantities: all(scenario).map(|q| QuantitySummary::new(q, seen, confidence)).collect(),
            dispersed: dispersed(scenario, seen),
            faults: seen.faults.clone(),
        })
    }

    /// What a reader should know of it first.
    fn alerts(&self, scenario: &Scenario, seen: &Seen, rounding: Rounding) -> Vec<Alert> {
        let name = &self.name;
        let failed = Alert::failed(&seen.surveys);
        let unmoved = scenario.dispersions().all().iter().filter_map(|dispersed| {
            let survey = seen.surveys.column(&dispersed.column)?;
            Alert::unmoved(name, dispersed, survey, scenario.fleet())
        });
        let outcomes = || self.quantities.iter().filter(|q| q.quantity.is_told());
        let heavy = outcomes().map(|q| {
            (q.quantity.label().into_owned(), (q.quantity.column(), q.quantity.unit()), &q.sample)
        });
        let near = Body::BOTH.map(Body::name).into_iter().zip(seen.near_boundary);
        let near = near.filter_map(|(body, [near, of])| Alert::near_boundary(name, body, near, of));
        let parted = seen.quantity(Quantity::DirectionError).map_or(0, Survey::n);
        let backwards =
            Alert::backwards(name, seen.backwards, parted, scenario.outlines().is_some());
        let told = outcomes().map(|q| (q.quantity.label().into_owned(), q.sample.n));
        let few = Alert::few_values(name, told, self.succeeded());
        let first = failed.into_iter().chain(backwards).chain(few).chain(unmoved);
        first.chain(Alert::heavy_tails(name, heavy, rounding)).chain(near).collect()
    }

    /// What its runs draw, the entries of the inertias too.
    pub(crate) fn drawn_inputs(&self) -> Vec<DrawnInput> {
        let entries = self.quantities.iter().filter(|q| q.quantity.is_drawn());
        let entries = entries.filter_map(|q| {
            DrawnInput::new(&q.quantity.column(), q.sample.mean, q.sample.deviation)
        });
        let others = self.dispersed.iter();
        let others = others.filter_map(|d| DrawnInput::new(&d.quantity, d.mean, d.deviation));
        entries.chain(others).collect()
    }

    /// Runs that did not fail.
    pub(crate) fn succeeded(&self) -> u64 {
        self.unrealizable.of.saturating_sub(self.failed)
    }

    pub(crate) fn quantity(&self, quantity: Quantity) -> Option<&QuantitySummary> {
        self.quantities.iter().find(|q| q.quantity == quantity)
    }
}

impl ClearanceSummary {
    pub(crate) fn new(surveys: &Surveys, confidence: Confidence) -> Option<Self> {
        let clearances = surveys.column(&Quantity::Clearance.column())?;
        let notes = owned(surveys.texts(CLEARANCE_NOTE));
        if clearances.n() == 0 && notes.is_empty() {
            return None;
        }
        let least = clearances.minimum();
        Some(Self {
            n: clearances.n(),
            least_m: least.map(|(clearance, _)| clearance),
            run: least.map(|(_, run)| run),
            p01_m: clearances.quantile(0.01),
            p01_interval_m: bounded(clearances.quantile_interval(0.01, confidence)),
            p05_m: clearances.quantile(0.05),
            notes,
        })
    }
}

impl QuantitySummary {
    fn new(quantity: Quantity, seen: &Seen, confidence: Confidence) -> Self {
        let none = || SampleSummary::new(&[], confidence);
        let sample = seen.quantity(quantity).map(|survey| SampleSummary::of(survey, confidence));
        Self { quantity, unit: quantity.unit().into(), sample: sample.unwrap_or_else(none) }
    }
}

impl Ratio {
    fn new(
        quantity: Quantity,
        physical: &Seen,
        naive: &Seen,
        rounding: Rounding,
        confidence: Confidence,
    ) -> Self {
        let both = naive.quantity(quantity).zip(physical.quantity(quantity));
        // Over a spread of rounding no ratio means anything.
        let moving = both.filter(|(_, physical)| rounding.is_exceeded_in(quantity, physical));
        let deviations = moving.and_then(|(n, p)| n.deviation().zip(p.deviation()));
        let means = both.and_then(|(n, p)| n.mean().zip(p.mean()));
        Self {
            quantity,
            deviation_ratio: deviations.map(|(n, p)| n.ratio(p)),
            deviation_ratio_interval: moving
                .and_then(|(n, p)| n.deviation_ratio_interval(p, confidence)),
            mean_difference: means.map(|(naive, physical)| naive - physical),
            mean_difference_interval: both
                .and_then(|(n, p)| n.mean_difference_interval(p, confidence)),
        }
    }
}

fn owned(counts: Vec<(&str, u64)>) -> Vec<(String, u64)> {
    counts.into_iter().map(|(kind, count)| (kind.to_owned(), count)).collect()
}

impl ComparisonSummary {
    pub(crate) fn ratio(&self, quantity: Quantity) -> Option<&Ratio> {
        self.ratios.iter().find(|r| r.quantity == quantity)
    }
}
