//! Importance sampling of separations against known probabilities, plain runs and subset simulation.

mod functions;

use gyradius_statistics::{Confidence, Proportion, SteeredWarning, WeightWarning, tail};

use super::*;
use crate::{Scenario, groups::Drawing, steering::Steering};

/// The built-in bodies under one model, with what is given beside the roots and axes of the payload and of each spring.
fn text(payload: &str, springs: &str) -> String {
    let text = include_str!("../scenario/peck-2003.toml");
    let (head, rest) = text.split_once("# The law behind").unwrap();
    let (_, source) = rest.split_once("# What the paper prints").unwrap();
    format!("{head}#{source}")
        .replace("[payload.dispersion]\n", &format!("[payload.dispersion]\n{payload}\n"))
        .replace("[[springs]]", &format!("[[springs]]\ndispersion = {{ {springs} }}"))
}

fn scenario(payload: &str, springs: &str) -> Scenario {
    Scenario::from_toml(&text(payload, springs)).unwrap()
}

/// A mass centre whose third coordinate is made of three scores.
const CORRELATED: &str =
    "mass_centre_m = { covariance = [[1e-4, 0.0, 5e-5], [0.0, 1e-4, 5e-5], [5e-5, 5e-5, 1e-4]] }";
const SPRINGS: &str = "stiffness_percent = 2.0, stage_point_m = 0.005";
const FAILING: &str = "stiffness_percent = 2.0, stage_point_m = 0.005, failure_probability = 0.001";

fn options(method: RareMethod, per_level: usize) -> RareOptions {
    RareOptions { method, per_level, ..RareOptions::default() }
}

fn rare(scenario: &Scenario, event: &str, options: &RareOptions) -> RareEstimate {
    find(scenario, &event.parse().unwrap(), options, &|_| {}, &|_| {}).unwrap().estimate().clone()
}

/// The share of plain runs that are the event, with an interval of 99.9 %.
fn plain(scenario: &Scenario, event: &str, count: u64) -> Interval {
    let event = event.parse().unwrap();
    let runs = EventRuns::new(scenario, &event, &RareOptions::default(), &|_| {}).unwrap();
    let excesses = runs.outcomes(Drawing::Plain, count).unwrap().excesses;
    let hits = excesses.iter().filter(|excess| **excess >= 0.0).count();
    println!("{event}: {hits} of {count}");
    Proportion::new(hits as u64, count).unwrap().interval(Confidence::new(0.999).unwrap())
}

fn overlap(a: Interval, b: Interval) -> bool {
    a.lower() <= b.upper() && b.lower() <= a.upper()
}

/// A sum of three scores among 31, beside roots and axes that keep their laws.
#[test]
fn known_probabilities_are_covered() {
    let scenario = scenario(CORRELATED, SPRINGS);
    for limit in [3.09, 5.2] {
        let truth = tail::normal(limit);
        let event = format!("payload_mass_centre_3_m >= {}", 0.01 * limit);
        let (mut covered, mut mean) = (0, 0.0);
        for seed in 0..20 {
            let scenario = scenario.clone().with_seed(seed).unwrap();
            let method = RareMethod::Importance { sample: 1500 };
            let found = rare(&scenario, &event, &options(method, 1000));
            covered += u32::from(found.interval().contains(truth));
            mean += found.probability() / truth / 20.0;
        }
        println!("{limit}: covered {covered} of 20, mean {mean}");
        // 16 of 20 or fewer are found in one of 60 cases at 95 %.
        assert!(covered >= 16 && (mean - 1.0).abs() < 0.08, "{limit}: {covered} {mean}");
    }
}

/// An event that is not rare costs a level and the sample, and nothing is said to be steered.
#[test]
fn nothing_is_steered_for_what_is_not_rare() {
    let scenario = scenario(CORRELATED, SPRINGS);
    let method = RareMethod::Importance { sample: 1500 };
    let event = "payload_mass_centre_3_m >= 0".parse().unwrap();
    let found = find(&scenario, &event, &options(method, 1000), &|_| {}, &|_| {}).unwrap();
    let text = found.to_string();
    assert!(text.contains("steered      none\n") && !text.contains("warning"), "{text}");
    assert_eq!(found.estimate().evaluations(), 2500);
    assert!(found.estimate().interval().contains(0.5), "{text}");
    let RareEstimate::Importance { steered, own_laws, .. } = found.estimate() else {
        panic!("{text}")
    };
    assert!(steered.is_empty() && own_laws.contains(&"payload mass centre".to_owned()), "{text}");
}

/// Springs that fail twice, in any of six pairs, and an event in which axes decide that no score steers.
#[test]
fn discrete_and_unsteered_inputs_are_right() {
    let failing = scenario(CORRELATED, FAILING);
    let p: f64 = 1e-3;
    let truth = 1.0 - (1.0 - p).powi(4) - 4.0 * p * (1.0 - p).powi(3);
    let names = [1, 2, 3, 4].map(|i| format!("spring_{i}_failure")).join(", ");
    let event = format!("norm({names}) >= 1.2");
    let method = RareMethod::Importance { sample: 4000 };
    let mut covered = 0;
    for seed in 0..10 {
        let failing = failing.clone().with_seed(seed).unwrap();
        let found = rare(&failing, &event, &options(method, 1000));
        covered += u32::from(found.interval().contains(truth));
        assert!(found.warnings().is_empty(), "{:?}", found.warnings());
    }
    assert!(covered >= 8, "{covered}");

    for (scenario, event, runs) in [
        (&failing, "abs(payload_tip_off_2_deg_per_s) >= 6", 100_000),
        (&scenario(CORRELATED, SPRINGS), "cone_deg >= 14", 100_000),
    ] {
        let expected = plain(scenario, event, runs);
        let found = rare(scenario, event, &options(method, 1000));
        println!("{expected} {found:?}");
        assert!(overlap(found.interval(), expected) && found.interval().lower() > 0.0, "{event}");
        let subset = rare(scenario, event, &RareOptions::default());
        assert!(overlap(found.interval(), subset.interval()), "{event} {subset:?}");
        let RareEstimate::Importance { steered, own_laws, .. } = found else { panic!("{event}") };
        assert_eq!(own_laws, ["payload roots", "payload axes", "stage roots", "stage axes"]);
        assert!(steered.contains(&"spring 4 stiffness".to_owned()), "{steered:?}");
        assert_eq!(steered[0], "payload mass centre");
    }
}

/// Steered runs of the own law are plain runs to the bit, and scores that are weighed are those that make the values.
#[test]
fn what_is_weighed_is_what_was_drawn() {
    let scenario = scenario(CORRELATED, FAILING);
    let event = "payload_mass_centre_3_m >= 0.05".parse().unwrap();
    let runs = EventRuns::new(&scenario, &event, &RareOptions::default(), &|_| {}).unwrap();
    let steering = Steering::new(scenario.seed(), runs.model(), runs.groups().scored());
    let own = runs.outcomes(Drawing::Steered(steering.clone().into()), 200).unwrap().excesses;
    let plain = runs.outcomes(Drawing::Plain, 200).unwrap().excesses;
    assert_eq!(
        own.iter().map(|x| x.to_bits()).collect::<Vec<_>>(),
        plain.iter().map(|x| x.to_bits()).collect::<Vec<_>>()
    );

    let mut search = gyradius_statistics::ScoreSearch::new(steering.scores(), 300).unwrap();
    let mut first = 0;
    while !search.is_done() {
        let drawing = Drawing::Steered(steering.with(search.law(), first).into());
        let scores = runs.scores(drawing.clone(), 300).unwrap();
        let excesses = runs.outcomes(drawing, 300).unwrap().excesses;
        let told: Vec<_> = scores.into_iter().zip(excesses).collect();
        for (z, excess) in &told {
            // The first three scores are the mass centre's: the row of the factor of the coefficients 1, 0, 1/2; 0, 1, 1/2; 1/2, 1/2, 1.
            let value = 0.01 * (0.5 * z[0] + 0.5 * z[1] + 0.5_f64.sqrt() * z[2]);
            assert!((value - 0.05 - excess).abs() < 1e-12, "{value} {excess}");
        }
        first += 300;
        search.tell(&told).unwrap();
    }
    assert!(search.reached() && !search.law().is_own());
}

/// A spring that fails has no time of release, and a step of few chains may be of such runs alone: the search goes on. How many runs
/// have no number is told, and how few of them failed; the truth is that of plain runs.
#[test]
fn runs_without_a_number_are_no_step() {
    let springs = "stiffness_percent = 2.0, failure_probability = 0.3";
    let failing = scenario(CORRELATED, springs);
    let event = "spring_2_release_s >= 0.0".parse().unwrap();
    let plain = options(RareMethod::default(), 100);
    let runs = EventRuns::new(&failing, &event, &plain, &|_| {}).unwrap();
    let mut times = runs.outcomes(Drawing::Plain, 10_000).unwrap().excesses;
    let undefined = times.iter().filter(|time| time.is_nan()).count();
    assert!((undefined as f64 / 10_000.0 - 0.3).abs() < 0.02, "{undefined}");
    times.retain(|time| !time.is_nan());
    times.sort_unstable_by(f64::total_cmp);
    let limit = times[times.len() - 60];
    let event = format!("spring_2_release_s >= {limit}");
    for method in [RareMethod::Subset { replicas: 4 }, RareMethod::Importance { sample: 500 }] {
        let mut covered = 0;
        for seed in 0..5 {
            let failing = failing.clone().with_seed(seed).unwrap();
            let found =
                find(&failing, &event.parse().unwrap(), &options(method, 100), &|_| {}, &|_| {})
                    .unwrap();
            let estimate = found.estimate();
            covered += u32::from(estimate.interval().contains(60.0 / 10_000.0));
            let without = estimate.without_excess();
            // Where every spring fails, the run does too.
            assert!(found.failed() < without && without < estimate.evaluations());
            let said = format!(
                "  no number    {without} runs have no spring_2_release_s, and are not the event"
            );
            assert!(found.to_string().contains(&said), "{found}");
            assert_eq!(found.to_string().contains("\n  failed "), found.failed() > 0, "{found}");
        }
        assert!(covered >= 4, "{method:?}: {covered}");
    }
}

/// The same bits with any number of threads, and with vehicles: what is drawn for them, and what for their flights.
#[test]
fn threads_change_nothing_and_vehicles_are_steered() {
    let payload = "mass_kg = { sigma = 100.0, drawn = \"vehicle\" }\nmass_centre_m = 0.01";
    let text = text(payload, SPRINGS).replace("runs = 2000\n", "vehicles = 50\nflights = 40\n");
    let scenario = Scenario::from_toml(&text).unwrap();
    assert!(scenario.fleet().is_some());
    let method = RareMethod::Importance { sample: 2000 };
    for (event, truth) in [
        ("payload_mass_kg >= 10450", tail::normal(4.5)),
        ("payload_mass_centre_1_m <= -0.045", tail::normal(4.5)),
    ] {
        let found = [1, 2].map(|threads| {
            let options = RareOptions { threads: Some(threads), ..options(method, 1000) };
            serde_json::to_string(&rare(&scenario, event, &options)).unwrap()
        });
        assert_eq!(found[0], found[1]);
        let found = rare(&scenario, event, &options(method, 1000));
        let off = found.probability() / truth - 1.0;
        assert!(off.abs() < 4.0 * found.coefficient_of_variation().unwrap(), "{found:?}");
    }
}

#[test]
fn what_cannot_be_found_is_told() {
    let steered = scenario(CORRELATED, SPRINGS);
    let method = RareMethod::Importance { sample: 2000 };
    let event = "payload_mass_centre_3_m >= 1".parse().unwrap();
    let whole = find(&steered, &event, &options(method, 500), &|_| {}, &|_| {}).unwrap();
    let found = whole.estimate();
    assert_eq!(found.probability(), 0.0);
    assert!(found.interval().upper() > 1e-3, "{found:?}");
    let RareEstimate::Importance { estimate, .. } = found else { panic!("{found:?}") };
    let no_hit = SteeredWarning::Weights(WeightWarning::NoHit);
    assert_eq!(estimate.warnings(), [SteeredWarning::NotReached { searches: 2 }, no_hit]);
    assert!(whole.warnings_in_words()[0].contains("--method subset"), "{whole}");

    let refused = |scenario: &Scenario, options: &RareOptions| {
        let event = "cone_deg >= 5".parse().unwrap();
        find(scenario, &event, options, &|_| {}, &|_| {}).unwrap_err().to_string()
    };
    let built_in = Scenario::peck_2003().unwrap();
    let said = refused(&built_in, &options(method, 1000));
    assert!(said.starts_with("method: importance") && said.contains("\"subset\""), "{said}");
    for (sample, per_level, least, expected) in [
        (99, 1000, 1e-9, "sample: 99 runs"),
        (u64::MAX, 1000, 1e-9, "sample: "),
        (100, 99, 1e-9, "per-level: "),
        (100, usize::MAX, 1e-9, "per-level: "),
        (100, 100, f64::NAN, "least: "),
    ] {
        let method = RareMethod::Importance { sample };
        let said = refused(&steered, &RareOptions { least, ..options(method, per_level) });
        assert!(said.starts_with(expected), "{said}");
    }
}

/// Masses, and lengths of which one is correlated, are steered unless a region keeps the body; where nothing is, the refusal says what there is
/// and whether the region is the reason.
#[test]
fn a_region_and_no_correlation_leave_nothing_to_steer() {
    for case in 0..8_u8 {
        let [has_mass, is_correlated, has_region] = [1, 2, 4].map(|bit| case & bit > 0);
        let given = |is_given: bool, what: &'static str| if is_given { what } else { "" };
        let text = format!(
            "name = \"own\"\n[payload]\nmass_kg = 500.0\ninertia_kg_m2 = [[120.0, 0.0, 0.0], [0.0, 110.0, 0.0], [0.0, 0.0, 90.0]]\nposition_m = [0, 0, 1]\n\
             [payload.dispersion]\ngyration_lengths_m = [0.01, 0.01, 0.01]\naxes = \"fixed\"\n{}{}\
             [stage]\nmass_kg = 2000.0\ninertia_kg_m2 = [[3000.0, 0.0, 0.0], [0.0, 3000.0, 0.0], [0.0, 0.0, 900.0]]\n\
             position_m = [0, 0, -1]\n[stage.dispersion]\nroot_second_moment_variance_kg_m2 = [0.0, 0.0, 0.0]\naxes = \"fixed\"\n\
             [[springs]]\nstiffness_n_per_m = 20000.0\nstroke_m = 0.1\npayload_point_m = [0.0, 0.1, -0.9]\n\
             stage_point_m = [0.0, 0.1, 0.9]\n[[models]]\nname = \"own\"\nlaw = \"principal\"\naxes = \"whole-sphere\"\n{}",
            given(has_mass, "mass_percent = 5.0\n"),
            given(
                has_region,
                "inside = { box = { middle_m = [0, 0, 0], half_sides_m = [0.6, 0.6, 0.5] } }\n"
            ),
            given(
                is_correlated,
                "[[correlations]]\nbetween = [\"payload_gyration_length_1_m\", \"payload_gyration_length_2_m\"]\ncoefficient = 0.5\n"
            ),
        );
        let scenario = Scenario::from_toml(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        let method = options(RareMethod::Importance { sample: 100 }, 100);
        let event = "cone_deg >= 5".parse().unwrap();
        let runs = EventRuns::new(&scenario, &event, &method, &|_| {}).unwrap();
        let [steered, own] = runs.groups().by_scores();
        let expected = [(has_mass, "payload mass"), (is_correlated, "payload gyration length")];
        let expected = expected.into_iter().filter(|(is_there, _)| *is_there && !has_region);
        assert_eq!(steered, expected.map(|(_, name)| name).collect::<Vec<_>>(), "{text}");
        if steered.is_empty() {
            let refused =
                find(&scenario, &event, &method, &|_| {}, &|_| {}).unwrap_err().to_string();
            assert!(refused.contains(&own.join("; ")), "{refused}");
            assert_eq!(refused.contains("`inside`"), has_region, "{refused}");
        }
    }
}

/// Every probability is told from 0 and from 1, in as many digits as asked.
#[test]
fn probabilities_near_one_are_no_one() {
    for (p, digits, text) in [
        (1.0, 3, "1.000"),
        (0.999_631, 3, "0.999631"),
        (0.5, 4, "0.5000"),
        (0.1, 3, "0.100"),
        (0.099, 3, "9.90e-2"),
        (1.491e-5, 4, "1.491e-5"),
        (0.0, 3, "0.00e0"),
    ] {
        assert_eq!(in_digits(p, digits), text);
    }
    for exponent in 1..15 {
        let missing = 10_f64.powi(-exponent) * 3.7;
        let told: f64 = in_digits(1.0 - missing, 3).parse().unwrap();
        assert!(((1.0 - told) / missing - 1.0).abs() < 0.02, "{told}");
    }
}

/// An event that hardly ever fails to happen is counted in plain runs, with an exact interval that is not the whole answer in one number.
#[test]
fn what_nearly_always_happens_has_an_interval() {
    let scenario = scenario(CORRELATED, SPRINGS);
    let method = RareMethod::Subset { replicas: 10 };
    let event = "payload_mass_centre_3_m >= -0.05".parse().unwrap();
    let found = find(&scenario, &event, &options(method, 200), &|_| {}, &|_| {}).unwrap();
    let estimate = found.estimate();
    let all = Proportion::new(2000, 2000).unwrap().interval(Confidence::default());
    assert_eq!((estimate.probability(), estimate.interval()), (1.0, all));
    assert!(found.to_string().contains("interval: 0.99816 to 1.000)"), "{found}");
    assert_eq!((estimate.evaluations(), found.plain_runs()), (2200, None));
}
