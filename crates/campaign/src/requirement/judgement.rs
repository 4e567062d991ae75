//! What runs say of a requirement: how many do not keep it, the bound that the required share keeps, and the verdict.

use gyradius_statistics::{ConfidenceSequence, Interval, Moments, Proportion, Verdict};
use serde::{Deserialize, Serialize};
use std::fmt;

use super::{
    Bound, FailedRuns, Requirement,
    convergence::ConvergencePoint,
    deciding::Looks,
    distribution::Distribution,
    gathering::{Gathering, RunBeyond},
    groups::Groups,
    judgement_error::JudgementError,
    rounding::{
        one_decimal, percent_beside, percent_or_less, percent_or_more, rounded_down,
        stated_in_percent,
    },
};
use crate::{folder::is_zero, number::plain};

/// What runs say of a requirement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Judgement {
    requirement: Requirement,
    /// How often the runs were looked at, if not once: verdict, interval and bound hold for all looks then.
    #[serde(default, skip_serializing_if = "Looks::is_once")]
    looks: Looks,
    /// All runs.
    runs: u64,
    /// Runs without a number, most often because they failed.
    runs_without_number: u64,
    /// Runs whose number is infinite, which count as failures and are never left out.
    #[serde(default, skip_serializing_if = "is_zero")]
    runs_infinite: u64,
    /// The first of them, which are worse than all others.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    first_infinite: Vec<u64>,
    /// Runs whose number is beyond the bound.
    runs_beyond: u64,
    /// Runs that count, and those of them that do not keep the requirement.
    counted: u64,
    failures: u64,
    /// How many failures so many runs may have; none if they are too few for any verdict.
    allowed_failures: Option<u64>,
    /// Share of the runs that keep it, and where the true share lies: Clopper and Pearson's interval, two-sided.
    share: Option<f64>,
    share_interval: Option<Interval>,
    /// The bound that the required share of all runs keeps, with the confidence; none if the runs are too few or too many failed.
    tolerance: Option<Bound>,
    /// How far that is within the limit; negative if it is beyond.
    margin: Option<f64>,
    /// The same in standard deviations of the numbers.
    margin_deviations: Option<f64>,
    /// Of the numbers; none without a number, and of one number there is no standard deviation.
    mean: Option<f64>,
    standard_deviation: Option<f64>,
    verdict: Verdict,
    /// The share of runs in which a vehicle must keep it, to pass nine times in ten as many runs.
    success_to_pass: Option<f64>,
    /// The worst runs, the worst first.
    worst: Vec<RunBeyond>,
    /// The distribution of the numbers; none without a number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    distribution: Option<Distribution>,
    /// The share that fails it among the first so many runs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    convergence: Vec<ConvergencePoint>,
    /// How many runs counted at each look of a rule.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    counted_at_looks: Vec<u64>,
    /// How many vehicles keep it, of runs that are flights of vehicles.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    vehicles: Option<VehiclesKeeping>,
}

/// How many vehicles keep a requirement: in at least the required share of their flights that count, as the requirement counts
/// those that failed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct VehiclesKeeping {
    /// Vehicles all flights of which are done, and of which one flight counts at least.
    pub vehicles: u64,
    /// Those of them that keep it.
    pub keeping: u64,
    /// Where the true share of such vehicles lies: Clopper and Pearson's interval, two-sided, with the confidence of the requirement.
    pub share_interval: Option<Interval>,
}

impl Judgement {
    /// What was gathered, judged.
    pub(super) fn of(gathering: &Gathering) -> Result<Self, JudgementError> {
        let Gathering { requirement, tally, numbers, .. } = gathering;
        let [failures, counted] = tally.failures_of_counted(requirement.failed_runs());
        let deciding = gathering.deciding()?;
        let bound = gathering.bound_of_share()?;
        let moments = numbers.moments();
        let standard_deviation = moments.map(Moments::standard_deviation);
        let margin = bound.map(|(_, excess)| 0.0 - excess);
        Ok(Self {
            requirement: requirement.clone(),
            looks: gathering.looks(),
            runs: tally.runs,
            runs_without_number: tally.without,
            runs_infinite: tally.infinite,
            first_infinite: tally.first_infinite.clone(),
            runs_beyond: tally.beyond,
            counted,
            failures,
            allowed_failures: deciding.allowed_failures(counted),
            share: (counted > 0).then(|| (counted - failures) as f64 / counted as f64),
            share_interval: deciding.kept(failures, counted)?,
            tolerance: bound.map(|(bound, _)| bound),
            margin,
            margin_deviations: margin
                .zip(standard_deviation.filter(|s| *s > 0.0))
                .map(|(m, s)| m / s),
            mean: numbers.mean(),
            standard_deviation,
            verdict: of_all_runs(deciding.verdict(failures, counted)?, tally.runs, counted),
            success_to_pass: deciding.success_to_pass(counted)?,
            worst: tally.worst.clone(),
            distribution: Distribution::new(
                gathering.ranks(),
                |rank| numbers.order_statistic(rank),
                requirement.confidence(),
            )?,
            convergence: tally
                .prefixes
                .estimates(|failures, runs| deciding.share(failures, runs))?,
            counted_at_looks: gathering.counted_at_looks(),
            vehicles: None,
        })
    }

    /// The same, with what is known of groups of runs.
    pub(super) fn of_groups(self, groups: Option<&Groups>) -> Result<Self, JudgementError> {
        let Some(&Groups { whole, keeping, .. }) = groups else { return Ok(self) };
        let confidence = self.requirement.confidence();
        let share_interval = match self.looks {
            _ if whole == 0 => None,
            Looks::Once => Some(Proportion::new(keeping, whole)?.interval(confidence)),
            Looks::Often => Some(ConfidenceSequence::new(confidence).interval(keeping, whole)?),
        };
        let vehicles = Some(VehiclesKeeping { vehicles: whole, keeping, share_interval });
        Ok(Self { vehicles, ..self })
    }

    /// All runs.
    #[must_use]
    pub fn runs(&self) -> u64 {
        self.runs
    }

    /// Whether it tells of more runs that would show that the requirement is met, though the verdict holds for one look.
    #[must_use]
    pub fn asks_for_another_look(&self) -> bool {
        let more = match self.verdict {
            Verdict::Undecided { if_no_more_fail, at_this_rate } => {
                if_no_more_fail.or(at_this_rate).is_some()
            }
            Verdict::Met | Verdict::NotMet => false,
        };
        more && self.looks == Looks::Once
    }

    /// How often the runs were looked at: verdict, interval and bound hold for all looks.
    #[must_use]
    pub fn looks(&self) -> Looks {
        self.looks
    }

    /// What the requirement is.
    #[must_use]
    pub fn requirement(&self) -> &Requirement {
        &self.requirement
    }

    /// The verdict. What it says of further runs is of all of them: if failures go on at the same rate, so do runs that are left out.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        self.verdict
    }

    /// Whether some of the runs do not count.
    #[must_use]
    pub fn leaves_runs_out(&self) -> bool {
        self.counted < self.runs
    }

    /// Runs that count.
    #[must_use]
    pub fn counted(&self) -> u64 {
        self.counted
    }

    /// Runs of them that do not keep it.
    #[must_use]
    pub fn failures(&self) -> u64 {
        self.failures
    }

    /// How many failures so many runs may have; none if they are too few.
    #[must_use]
    pub fn allowed_failures(&self) -> Option<u64> {
        self.allowed_failures
    }

    /// The bound that the required share of all runs keeps, with the confidence.
    #[must_use]
    pub fn tolerance(&self) -> Option<Bound> {
        self.tolerance
    }

    /// How many vehicles keep it, of runs that are flights of vehicles which have something in common.
    #[must_use]
    pub fn vehicles(&self) -> Option<VehiclesKeeping> {
        self.vehicles
    }

    /// Runs without a number, most often because they failed.
    #[must_use]
    pub fn runs_without_number(&self) -> u64 {
        self.runs_without_number
    }

    /// Runs whose number is infinite: they keep no requirement, and are never left out.
    #[must_use]
    pub fn runs_infinite(&self) -> u64 {
        self.runs_infinite
    }

    /// The first of these, by their numbers, from 0. They are worse than all of [`worst`](Self::worst).
    #[must_use]
    pub fn first_infinite(&self) -> &[u64] {
        &self.first_infinite
    }

    /// Share of the runs that count that keep it.
    #[must_use]
    pub fn share(&self) -> Option<f64> {
        self.share
    }

    /// Where the true share lies, with the confidence of the requirement: Clopper and Pearson's interval, two-sided, or, of runs
    /// that are looked at often, that of a confidence sequence.
    #[must_use]
    pub fn share_interval(&self) -> Option<Interval> {
        self.share_interval
    }

    /// How far the bound is within the limit; negative if it is beyond.
    #[must_use]
    pub fn margin(&self) -> Option<f64> {
        self.margin
    }

    /// The same in standard deviations of the quantity.
    #[must_use]
    pub fn margin_deviations(&self) -> Option<f64> {
        self.margin_deviations
    }

    /// The share of its runs in which a vehicle must keep it, to pass nine times in ten with as many runs.
    #[must_use]
    pub fn success_to_pass(&self) -> Option<f64> {
        self.success_to_pass
    }

    /// The distribution of the numbers, with a band that holds it with the confidence of the requirement; none without a number.
    #[must_use]
    pub fn distribution(&self) -> Option<&Distribution> {
        self.distribution.as_ref()
    }

    /// The share of runs that fail it among the first so many, the fewest first.
    #[must_use]
    pub fn convergence(&self) -> &[ConvergencePoint] {
        &self.convergence
    }

    /// How many runs counted at each look of a rule, the first look first; nothing if none looked.
    #[must_use]
    pub fn counted_at_looks(&self) -> &[u64] {
        &self.counted_at_looks
    }

    /// The verdict in a line, with what it rests on.
    #[must_use]
    pub fn line(&self) -> String {
        let Self { failures, counted, .. } = self;
        let keep =
            if *failures == 1 || *counted == 1 { "does not keep it" } else { "do not keep it" };
        let allowed = match (self.allowed_failures, self.verdict) {
            (Some(allowed), _) => format!("at most {allowed} may fail"),
            (None, Verdict::NotMet) => "that is more than the required share allows".to_owned(),
            (None, Verdict::Met | Verdict::Undecided { .. }) => {
                format!("so few {} cannot show that it is met", self.unit(0))
            }
        };
        let (verdict, unit) = (words(self.verdict), self.unit(*counted));
        format!("{verdict}: {failures} of {counted} {unit} {keep}; {allowed}")
    }

    /// What so many of those that are counted are called: runs, or, of vehicles whose flights have something in common, first flights.
    #[must_use]
    pub fn unit(&self, number: u64) -> &'static str {
        match (self.vehicles, number) {
            (None, 1) => "run",
            (None, _) => "runs",
            (Some(_), 1) => "first flight",
            (Some(_), _) => "first flights",
        }
    }

    /// What further runs are called, if there are to be so many: runs, or, where the first flight of each vehicle is counted, vehicles.
    #[must_use]
    pub fn unit_of_more(&self, number: u64) -> &'static str {
        match (self.vehicles, number) {
            (None, _) => self.unit(number),
            (Some(_), 1) => "vehicle",
            (Some(_), _) => "vehicles",
        }
    }

    /// The worst runs of those whose numbers are finite, the worst first.
    #[must_use]
    pub fn worst(&self) -> &[RunBeyond] {
        &self.worst
    }
}

/// The answer first, and then what it rests on, in lines.
impl fmt::Display for Judgement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (counted, requirement) = (self.counted, &self.requirement);
        let (share, confidence) = (requirement.probability(), requirement.confidence().level());
        let (share, confidence) = (stated_in_percent(share), stated_in_percent(confidence));
        let of_which = requirement.failed_runs().of_which();
        writeln!(f, "  {}", self.line())?;
        if let Verdict::Undecided { if_no_more_fail, at_this_rate } = self.verdict {
            let met = |runs: u64, if_so: &str| {
                let unit = self.unit_of_more(runs);
                // What does not fit into the column of names is told by the sentence.
                let label = self.vehicles.map_or("more runs", |_| "more");
                format!("  {label:<12} {runs} more {unit} would show that it is met, {if_so}\n")
            };
            let all = if_no_more_fail.map(|runs| met(runs, "if all of them keep it"));
            let rate = at_this_rate.filter(|runs| Some(*runs) != if_no_more_fail);
            let if_so = match self.leaves_runs_out() {
                true => "if the shares that fail and that are left out stay as they are",
                false => "if the share that fails stays as it is",
            };
            let rate = rate.map(|runs| met(runs, if_so));
            f.write_str(&(all.unwrap_or_default() + &rate.unwrap_or_default()))?;
            if self.asks_for_another_look() {
                writeln!(
                    f,
                    "  again        judging a second time adds a risk of its own; a study with --until counts all looks"
                )?;
            }
        }
        if self.runs_without_number > 0 {
            let runs = self.runs_without_number;
            let fate = match (requirement.failed_runs(), runs) {
                (FailedRuns::Against, 1) => "counts against it",
                (FailedRuns::Against, _) => "count against it",
                (FailedRuns::LeftOut, 1) => "is left out",
                (FailedRuns::LeftOut, _) => "are left out",
            };
            writeln!(f, "  failed       {runs} {} without a number {fate}", self.unit(runs))?;
        }
        if self.runs_infinite > 0 {
            let runs = self.runs_infinite;
            let [numbers, count] = match runs {
                1 => ["whose number is infinite", "counts"],
                _ => ["whose numbers are infinite", "count"],
            };
            let unit = self.unit(runs);
            let first: Vec<String> = self.first_infinite.iter().map(u64::to_string).collect();
            let more = if first.len() as u64 == runs { "" } else { ", …" };
            let first = first.join(", ");
            writeln!(
                f,
                "  infinite     {runs} {unit} {numbers} {count} against it: {first}{more}"
            )?;
        }
        match self.tolerance {
            Some(bound) => writeln!(
                f,
                "  bound        {share} of {of_which} are {}, with {confidence} confidence",
                bound.outwards(requirement.bound(), 5)
            )?,
            None => writeln!(f, "  bound        none: too few runs, or too many failed")?,
        }
        if let Some(margin) = self.margin {
            write!(f, "  margin       {}", plain(rounded_down(margin, 5)))?;
            match self.margin_deviations {
                Some(deviations) => {
                    let deviations = one_decimal(deviations);
                    writeln!(f, ", which is {deviations} standard deviations")?;
                }
                None => writeln!(f)?,
            }
        }
        if let (Some(observed), Some(interval)) = (self.share, &self.share_interval) {
            let (lower, upper) =
                (percent_or_less(interval.lower()), percent_or_more(interval.upper()));
            writeln!(
                f,
                "  share        {} of the {} keep it ({confidence} interval: {lower} to {upper})",
                percent_beside(observed, requirement.probability()),
                self.unit(0)
            )?;
        }
        if let Some(good) = self.success_to_pass {
            writeln!(
                f,
                "  to pass      a vehicle that keeps it in {} of {of_which} passes {counted} {} nine times in ten",
                percent_or_more(good),
                self.unit(counted)
            )?;
        }
        // A part of a table may hold no vehicle whole, of which nothing can be said then.
        if let Some(vehicles) = self.vehicles.filter(|vehicles| vehicles.vehicles > 0) {
            writeln!(f, "  vehicles     {vehicles}")?;
        }
        let worst: Vec<String> = self
            .worst
            .iter()
            .map(|run| format!("{} ({})", run.run, plain(requirement.bound().rounded(run.value))))
            .collect();
        if worst.is_empty() { Ok(()) } else { writeln!(f, "  worst runs   {}", worst.join(", ")) }
    }
}

/// In a line.
impl fmt::Display for VehiclesKeeping {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { vehicles, keeping, share_interval } = self;
        write!(f, "{keeping} of {vehicles} keep it in that share of their flights")?;
        let Some(interval) = share_interval else { return Ok(()) };
        let (lower, upper) = (percent_or_less(interval.lower()), percent_or_more(interval.upper()));
        let confidence = stated_in_percent(interval.confidence().level());
        write!(f, " ({confidence} interval: {lower} to {upper})")
    }
}

/// A verdict on the runs that count, in further runs of all: of them, too, some are left out, if rates stay as they are.
fn of_all_runs(verdict: Verdict, runs: u64, counted: u64) -> Verdict {
    match verdict {
        Verdict::Met | Verdict::NotMet => verdict,
        Verdict::Undecided { if_no_more_fail, at_this_rate } => {
            // The fewest runs of which so many count, if as large a share of them does as so far.
            let runs_of = |counting: u64| {
                let all = (u128::from(counting) * u128::from(runs)).div_ceil(counted.into());
                u64::try_from(all).ok()
            };
            let at_this_rate = at_this_rate.filter(|_| counted > 0);
            let at_this_rate = at_this_rate.and_then(|more| Some(runs_of(counted + more)? - runs));
            // Runs that keep a requirement count.
            Verdict::Undecided { if_no_more_fail, at_this_rate }
        }
    }
}

/// A verdict in words, in capital letters.
fn words(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Met => "MET",
        Verdict::NotMet => "NOT MET",
        Verdict::Undecided { .. } => "NOT DECIDED",
    }
}
