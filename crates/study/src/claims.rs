//! The paper's claims, judged by what the runs show.

use gyradius_dispersion::ModelKind;
use gyradius_report::percent;
use gyradius_statistics::Interval;
use rayon::prelude::*;

use crate::{
    body::{Body, Entry},
    claim::{Claim, Verdict},
    quantity::Quantity,
    scenario::{ModelLaw, Scenario},
    seen::Seen,
    summary::{ComparisonSummary, ModelSummary, Summary},
};

/// "Considerably more" is taken to mean a deviation larger by at least this factor, with the whole
/// of its interval.
pub(crate) const CONSIDERABLE: f64 = 1.10;
/// "Less" is taken to mean a mean smaller by at least this share.
pub(crate) const LESS: f64 = 0.05;
/// Deviations count as identical within this share.
pub(crate) const IDENTICAL: f64 = 0.05;
/// A claim that something happens is refuted if it happens in less than this share of runs.
pub(crate) const RARE: f64 = 1e-4;
/// Runs below which shapes of distributions are not judged.
const ENOUGH_FOR_SHAPES: usize = 500;
/// A skewness beyond this is one-sided; a Gaussian has none.
pub(crate) const ONE_SIDED: f64 = 1.0;

pub(crate) fn judge(scenario: &Scenario, summary: &Summary, runs: &[Seen]) -> Vec<Claim> {
    let mut claims = vec![always_realizable(summary), naive_unphysical(summary)];
    claims.extend(central_values(scenario, summary));
    if summary.comparisons.is_empty() {
        return claims;
    }
    claims.push(same_deviations(scenario, summary));
    for (quantity, claim) in [
        (Quantity::InertiaRatio, "The naive model spreads the inertia ratio considerably more."),
        (Quantity::Wobble, "The naive model spreads the wobble angle considerably more."),
        (Quantity::Nutation, "The naive model spreads the nutation angle considerably more."),
        (Quantity::Cone, "The naive model spreads the cone angle considerably more."),
    ] {
        claims.push(spreads_more(summary, quantity, claim));
    }
    claims.push(reduces(summary));
    claims.push(shapes(summary, runs));
    claims
}

fn always_realizable(summary: &Summary) -> Claim {
    let physical: Vec<&ModelSummary> =
        summary.models.iter().filter(|m| m.law == ModelLaw::Kind(ModelKind::Principal)).collect();
    let findings = physical.iter().map(|m| unrealizable(m)).collect();
    let parts: Vec<Verdict> = physical
        .iter()
        .map(|m| if m.unrealizable.count == 0 { Verdict::Holds } else { Verdict::DoesNotHold })
        .collect();
    Claim {
        claim: "Moments from squared roots and axes from unit quaternions are physically \
                realizable, always."
            .into(),
        findings,
        verdict: Verdict::of_all(&parts),
    }
}

fn naive_unphysical(summary: &Summary) -> Claim {
    let naive: Vec<&ModelSummary> =
        summary.models.iter().filter(|m| m.given_deviations_kg_m2.is_some()).collect();
    let parts: Vec<Verdict> = naive
        .iter()
        .map(|m| match &m.unrealizable {
            share if share.count > 0 => Verdict::Holds,
            share if share.interval.upper() < RARE => Verdict::DoesNotHold,
            _ => Verdict::NotTested,
        })
        .collect();
    Claim {
        claim:
            "Independent Gaussian entries of these deviations yield matrices that no body can have."
                .into(),
        findings: naive.iter().map(|m| unrealizable(m)).collect(),
        verdict: Verdict::of_all(&parts),
    }
}

fn unrealizable(model: &ModelSummary) -> String {
    let share = &model.unrealizable;
    format!(
        "{}: {} of {} runs drew an unrealizable payload or stage: {}.",
        model.name,
        share.count,
        share.of,
        percent(share)
    )
}

fn central_values(scenario: &Scenario, summary: &Summary) -> Option<Claim> {
    let (title, ratio, wobble) = scenario.source()?;
    let checks: Vec<(Quantity, f64)> =
        [(Quantity::InertiaRatio, ratio), (Quantity::Wobble, wobble)]
            .into_iter()
            .filter_map(|(q, printed)| Some((q, printed?)))
            .collect();
    let mut parts = Vec::new();
    let mut findings = Vec::new();
    let mut printed_values = Vec::new();
    for (quantity, printed) in &checks {
        let found = summary.nominal_value(*quantity)?;
        // Printed to three decimals.
        let agrees = (found - printed).abs() <= 0.000_5 + 1e-12;
        parts.push(if agrees { Verdict::Holds } else { Verdict::DoesNotHold });
        printed_values.push(format!("{} {}{}", quantity.label(), printed, unit(*quantity)));
        findings.push(format!("{}: {found:.4}{}", quantity.label(), unit(*quantity)));
    }
    Some(Claim {
        claim: format!("{title}: the central values are {}.", printed_values.join(" and ")),
        findings: vec![format!("Nominal bodies: {}.", findings.join(", "))],
        verdict: Verdict::of_all(&parts),
    })
}

fn unit(quantity: Quantity) -> &'static str {
    match quantity.unit() {
        "deg" => "°",
        _ => "",
    }
}

fn same_deviations(scenario: &Scenario, summary: &Summary) -> Claim {
    let mut findings = Vec::new();
    let mut parts = Vec::new();
    for comparison in &summary.comparisons {
        let (Some(physical), Some(naive)) =
            (summary.model(&comparison.physical), summary.model(&comparison.naive))
        else {
            continue;
        };
        let Some(given) = naive.given_deviations_kg_m2 else { continue };
        if scenario.is_matched(&comparison.naive, &comparison.physical) {
            parts.push(Verdict::Holds);
            findings.push(format!(
                "{}: the deviations given to {} are those of {}, computed by quadrature.",
                comparison.title, comparison.naive, comparison.physical
            ));
            continue;
        }
        let mut words = Vec::new();
        for (body, given) in Body::BOTH.into_iter().zip(given) {
            let entries = Entry::ALL.into_iter().zip(given);
            let ratios: Vec<(f64, Interval)> = entries
                .filter_map(|(entry, given)| {
                    let found = physical.quantity(Quantity::entry(body, entry))?;
                    let interval = found.sample.deviation_interval.filter(|i| i.lower() > 0.0)?;
                    let (low, high) = (given / interval.upper(), given / interval.lower());
                    let interval = Interval::new(low, high, interval.confidence()).ok()?;
                    Some((given / found.sample.deviation?, interval))
                })
                .collect();
            let Some(worst) = ratios
                .iter()
                .map(|r| r.0)
                .max_by(|a, b| (a - 1.0).abs().total_cmp(&(b - 1.0).abs()))
            else {
                parts.push(Verdict::NotTested);
                continue;
            };
            let off = |i: &Interval| i.lower() > 1.0 + IDENTICAL || i.upper() < 1.0 - IDENTICAL;
            let same = |i: &Interval| i.lower() > 1.0 - IDENTICAL && i.upper() < 1.0 + IDENTICAL;
            parts.push(if ratios.iter().any(|(_, i)| off(i)) {
                Verdict::DoesNotHold
            } else if ratios.iter().all(|(_, i)| same(i)) {
                Verdict::Holds
            } else {
                Verdict::NotTested
            });
            words.push(format!(
                "{} entries off by up to {:+.1} %",
                body.name(),
                100.0 * (worst - 1.0)
            ));
        }
        if words.is_empty() {
            words.push("nothing to compare".to_owned());
        }
        findings.push(format!(
            "{}: deviations given to {} against those of the runs of {}: {}.",
            comparison.title,
            comparison.naive,
            comparison.physical,
            words.join(", ")
        ));
    }
    Claim {
        claim: "The naive model has the same deviations of the entries as the physical one.".into(),
        findings,
        verdict: Verdict::of_all(&parts),
    }
}

fn spreads_more(summary: &Summary, quantity: Quantity, claim: &str) -> Claim {
    let mut findings = Vec::new();
    let mut parts = Vec::new();
    for comparison in &summary.comparisons {
        let ratio = comparison.ratio(quantity);
        let estimate = ratio.and_then(|r| r.deviation_ratio.zip(r.deviation_ratio_interval));
        let words = match estimate {
            Some((ratio, interval)) => {
                parts.push(Verdict::above(interval, CONSIDERABLE));
                format!("{ratio:.3} {interval:.3}")
            }
            None => {
                parts.push(Verdict::NotTested);
                "cannot be told from these runs".to_owned()
            }
        };
        findings.push(format!("{}: ratio of deviations {words}.", names(comparison)));
    }
    Claim { claim: claim.to_owned(), findings, verdict: Verdict::of_all(&parts) }
}

fn names(c: &ComparisonSummary) -> String {
    format!("{} ({} over {})", c.title, c.naive, c.physical)
}

fn reduces(summary: &Summary) -> Claim {
    let mut findings = Vec::new();
    let mut parts = Vec::new();
    for comparison in &summary.comparisons {
        let mut words = Vec::new();
        for quantity in [Quantity::Nutation, Quantity::Cone] {
            let ratio = comparison.ratio(quantity);
            let difference = ratio.and_then(|r| r.mean_difference.zip(r.mean_difference_interval));
            let naive =
                summary.model(&comparison.naive).and_then(|m| m.quantity(quantity)?.sample.mean);
            let (Some((difference, interval)), Some(naive)) = (difference, naive) else {
                parts.push(Verdict::NotTested);
                words.push(format!("{} cannot be told from these runs", quantity.label()));
                continue;
            };
            parts.push(Verdict::above(interval, LESS * naive));
            words.push(format!("{} {difference:+.3}° {interval:+.3}", quantity.label()));
        }
        findings.push(format!(
            "{}, difference of the mean angles: {}.",
            names(comparison),
            words.join(", ")
        ));
    }
    Claim {
        claim:
            "For the same means and deviations of the entries, the physical model predicts less \
                nutation and coning."
                .into(),
        findings,
        verdict: Verdict::of_all(&parts),
    }
}

fn shapes(summary: &Summary, runs: &[Seen]) -> Claim {
    let mut findings = Vec::new();
    let mut parts = Vec::new();
    let shapes: Vec<Shape> = runs.par_iter().map(Shape::of).collect();
    for comparison in &summary.comparisons {
        let of = |name: &str| Some(&shapes[runs.iter().position(|seen| seen.model() == name)?]);
        let (Some(physical), Some(naive)) = (of(&comparison.physical), of(&comparison.naive))
        else {
            continue;
        };
        let independent = summary.head.independent_runs();
        let few = independent < ENOUGH_FOR_SHAPES as u64;
        parts.push(match (physical.one_sided(), physical.two_peaked.is_some()) {
            _ if few => Verdict::NotTested,
            _ if naive.one_sided() || naive.two_peaked.is_some() => Verdict::DoesNotHold,
            (true, true) => Verdict::Holds,
            (false, false) => Verdict::DoesNotHold,
            _ => Verdict::HoldsInPart,
        });
        findings.push(format!(
            "{}: {} {}; {} {}.",
            comparison.title, comparison.physical, physical, comparison.naive, naive
        ));
    }
    Claim {
        claim: "Entries of the inertia matrix are one-sided or two-peaked, which independent \
                Gaussians do not capture."
            .into(),
        findings,
        verdict: Verdict::of_all(&parts),
    }
}

/// The most telling features of the twelve distributions of entries.
struct Shape {
    skewed: (Quantity, f64),
    two_peaked: Option<Quantity>,
}

impl Shape {
    /// From the runs whose values are kept.
    fn of(seen: &Seen) -> Self {
        let mut skewed = (Quantity::PayloadI11, 0.0_f64);
        let mut two_peaked: Option<(Quantity, f64)> = None;
        for quantity in
            Body::BOTH.into_iter().flat_map(|b| Entry::ALL.map(|e| Quantity::entry(b, e)))
        {
            let Some(survey) = seen.quantity(quantity) else { continue };
            // Equal values of the flights of a vehicle would make peaks.
            let survey = survey.independent();
            let Some((moments, sample)) = survey.moments().zip(survey.sample()) else { continue };
            let skewness = moments.skewness().unwrap_or(0.0);
            if skewness.abs() > skewed.1.abs() {
                skewed = (quantity, skewness);
            }
            let standard = |x: &f64| ((x - moments.mean()) / moments.standard_deviation()).abs();
            let dip = dip(sample.values().iter().map(standard));
            if dip.is_some_and(|d| d < two_peaked.map_or(1.0, |(_, other)| other)) {
                two_peaked = dip.map(|d| (quantity, d));
            }
        }
        Self { skewed, two_peaked: two_peaked.map(|(q, _)| q) }
    }

    fn one_sided(&self) -> bool {
        self.skewed.1.abs() > ONE_SIDED
    }
}

impl std::fmt::Display for Shape {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let name = |q: Quantity| {
            let of_stage = Entry::ALL.iter().any(|e| Quantity::entry(Body::Stage, *e) == q);
            let body = if of_stage { Body::Stage } else { Body::Payload };
            format!("{} {}", body.name(), q.label())
        };
        write!(f, "has skewness up to {:.2} ({})", self.skewed.1, name(self.skewed.0))?;
        match self.two_peaked {
            Some(quantity) => write!(f, " and two peaks ({})", name(quantity)),
            None => write!(f, " and no two peaks"),
        }
    }
}

/// The density around the mean over that around one deviation on either side, by counts within a
/// quarter deviation; 1.65 for a Gaussian, below 1 with two peaks. Given as the upper end of its
/// 99.9 % interval, twelve distributions being looked at; none with too few values.
fn dip(standard: impl Iterator<Item = f64>) -> Option<f64> {
    const Z: f64 = 3.29;
    let (mut centre, mut shoulders) = (0.0, 0.0);
    for z in standard {
        if z < 0.25 {
            centre += 1.0;
        } else if (0.75..1.25).contains(&z) {
            shoulders += 1.0;
        }
    }
    if shoulders < 1.0 {
        return None;
    }
    // The shoulders are twice as wide as the centre.
    let ratio = 2.0 * f64::max(centre, 0.5) / shoulders;
    let error = (1.0 / f64::max(centre, 0.5) + 1.0 / shoulders).sqrt();
    Some(ratio * (Z * error).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts_add_up() {
        use Verdict::*;
        assert_eq!(Verdict::of_all(&[]), NotTested);
        assert_eq!(Verdict::of_all(&[NotTested, Holds]), HoldsInPart);
        assert_eq!(Verdict::of_all(&[NotTested, DoesNotHold]), NotTested);
        assert_eq!(Verdict::of_all(&[DoesNotHold, Holds]), HoldsInPart);
        assert_eq!(Verdict::of_all(&[HoldsInPart, HoldsInPart]), HoldsInPart);
        assert_eq!(Verdict::of_all(&[Holds, Holds]), Holds);
        assert_eq!(Verdict::of_all(&[DoesNotHold, DoesNotHold]), DoesNotHold);
        let interval = Interval::new(0.9, 1.2, gyradius_statistics::Confidence::default()).unwrap();
        assert_eq!(Verdict::above(interval, 0.8), Holds);
        assert_eq!(Verdict::above(interval, 1.3), DoesNotHold);
        assert_eq!(Verdict::above(interval, 1.0), NotTested);
    }

    #[test]
    fn two_peaks_are_told_from_one() {
        let grid = (0..4000).map(|i| (f64::from(i) + 0.5) / 2000.0 - 1.0);
        // Uniform: standard deviation 1/√3, ratio 1 exactly; the interval is above 1.
        let uniform = dip(grid.clone().map(|x| (x * 3_f64.sqrt()).abs()));
        assert!(uniform.unwrap() > 1.0);
        // Density ∝ |x|: deviation 1/√2.
        let vee = grid.map(|x| x.abs().sqrt() * 2_f64.sqrt());
        assert!(dip(vee).unwrap() < 1.0);
        assert_eq!(dip(std::iter::empty()), None);
    }
}
