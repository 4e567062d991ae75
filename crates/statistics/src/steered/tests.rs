//! Searches and their samples against known probabilities, against plain runs, and where they must warn.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::score_law::{Single, Tail};
use super::*;
use crate::{StatisticsError, tail};

mod frequent;

/// How far a run is beyond the limit, of its scores and of what else it draws.
type Excess<'a> = &'a dyn Fn(&[f64], &mut ChaCha8Rng) -> f64;

/// What it costs, and how it is weighted.
#[derive(Clone, Copy)]
struct Plan {
    scores: usize,
    per_level: usize,
    sample: usize,
    events: &'static [(usize, f64)],
}

const PLAN: Plan = Plan { scores: 10, per_level: 1000, sample: 5000, events: &[] };

fn scores(rng: &mut ChaCha8Rng, law: &ScoreLaw) -> (f64, Vec<f64>) {
    let mut scores: Vec<f64> =
        (0..law.scores()).map(|_| StandardNormal.sample(&mut *rng)).collect();
    let choice = rng.random();
    law.draw(choice, &mut scores);
    (choice, scores)
}

fn searched(plan: Plan, rng: &mut ChaCha8Rng, excess: Excess<'_>) -> ScoreSearch {
    let search = ScoreSearch::new(plan.scores, plan.per_level).unwrap();
    let mut search = search.with_events(plan.events).unwrap();
    while !search.is_done() {
        let runs: Vec<(Vec<f64>, f64)> = (0..search.asks())
            .map(|_| {
                let (_, scores) = scores(rng, search.law());
                let y = excess(&scores, rng);
                (scores, y)
            })
            .collect();
        search.tell(&runs).unwrap();
    }
    search
}

fn estimate(plan: Plan, seed: u64, excess: Excess<'_>) -> SteeredEstimate {
    let rng = &mut ChaCha8Rng::seed_from_u64(seed);
    let mut sample = SteeredSampling::new(&searched(plan, rng, excess)).unwrap();
    for _ in 0..plan.sample {
        let (_, scores) = scores(rng, sample.law());
        let y = excess(&scores, rng);
        sample.push(&scores, y).unwrap();
    }
    sample.finish(Confidence::default()).unwrap()
}

/// A weight in the place of the right one: of a law, the scores, and the right one.
type Weight<'a> = &'a dyn Fn(&ScoreLaw, &[f64]) -> f64;

/// In how many of 20 cases the interval of a sample with such weights covers the truth.
fn covered_with(truth: f64, excess: Excess<'_>, weight: Weight<'_>) -> u32 {
    let covered = |seed: u64| {
        let rng = &mut ChaCha8Rng::seed_from_u64(seed);
        let law = SteeredSampling::new(&searched(PLAN, rng, excess)).unwrap().law().clone();
        let mut sums = ImportanceSampling::new();
        for _ in 0..PLAN.sample {
            let (_, scores) = scores(rng, &law);
            let hit = excess(&scores, rng) >= 0.0;
            sums.push(weight(&law, &scores), hit).unwrap();
        }
        u32::from(sums.finish(Confidence::default()).unwrap().interval().contains(truth))
    };
    (0..20).map(covered).sum()
}

/// How often intervals covered the truth and something was warned of, and the mean of the estimates over the truth.
fn covers(what: &str, plan: Plan, truth: f64, seeds: u64, excess: Excess<'_>) -> (u64, u64, f64) {
    let (mut covered, mut warned, mut mean, mut runs, mut effective) = (0, 0, 0.0, 0, 0.0);
    for seed in 0..seeds {
        let found = estimate(plan, seed, excess);
        covered += u64::from(found.interval().contains(truth));
        warned += u64::from(!found.warnings().is_empty());
        mean += found.probability() / truth / seeds as f64;
        runs += found.evaluations();
        effective += found.weighted().effective_hits() / seeds as f64;
    }
    println!(
        "{what}: {truth:.2e} covered {covered} of {seeds}, mean {mean:.3} of it, warned {warned}, {} runs, {effective:.0} effective",
        runs / seeds
    );
    (covered, warned, mean)
}

fn assert_covers(what: &str, plan: Plan, truth: f64, excess: Excess<'_>) {
    let (covered, warned, mean) = covers(what, plan, truth, 40, excess);
    // 34 of 40 or fewer are found once in 250 times at 95 %.
    assert!(
        covered >= 34 && (mean - 1.0).abs() < 0.05 && warned <= 5,
        "{what}: {covered} {mean} {warned}"
    );
}

fn sum(scores: &[f64]) -> f64 {
    scores.iter().sum::<f64>() / (scores.len() as f64).sqrt()
}

#[test]
fn sums_of_scores_down_to_a_ten_millionth() {
    for (limit, scores) in [(3.09, 1), (3.09, 60), (4.265, 10), (5.2, 1), (5.2, 60)] {
        let (plan, truth) = (Plan { scores, ..PLAN }, tail::normal(limit));
        assert_covers(&format!("{scores} scores"), plan, truth, &|z, _| sum(z) - limit);
    }
}

/// What is not rare is told from 1 by the runs that miss it: no estimate is above 1, each lies in its interval, the truth nearly always,
/// and the standard error is how far the estimates scatter.
#[test]
fn what_nearly_always_happens_is_told_from_one() {
    let plan = Plan { per_level: 300, sample: 1000, ..PLAN };
    // Whether or not a score is known to decide something.
    let plans = [plan, Plan { events: &[(0, 1e-3)], ..plan }];
    let cases = [0.45, 0.1, 1e-2, 1e-3, 1e-5].into_iter();
    for (missed, plan) in cases.flat_map(|missed| plans.map(|plan| (missed, plan))) {
        let truth = 1.0 - missed;
        let limit = -crate::law::normal(missed);
        let found: Vec<SteeredEstimate> =
            (0..40).map(|seed| estimate(plan, seed, &|scores, _| sum(scores) - limit)).collect();
        let covered = found.iter().filter(|one| one.interval().contains(truth)).count();
        for one in &found {
            assert!(one.probability() <= 1.0 && one.interval().upper() <= 1.0, "{one:?}");
            assert!(one.interval().contains(one.probability()), "{one:?}");
            assert_eq!(one.evaluations(), 1300);
        }
        let squares = |of: &dyn Fn(&SteeredEstimate) -> f64| {
            (found.iter().map(|one| of(one).powi(2)).sum::<f64>() / 40.0).sqrt()
        };
        let scatter = squares(&|one| one.probability() - truth);
        let told = squares(&|one| one.probability() * one.coefficient_of_variation().unwrap());
        println!("{truth}: covered {covered} of 40, scatter {scatter:.1e}, told {told:.1e}");
        assert!(covered >= 34, "{truth}: {covered}");
        assert!(told < 1.5 * scatter && scatter < 1.5 * told || missed < 1e-3, "{truth}");
    }
}

#[test]
fn two_ways_are_both_found() {
    for (limit, all) in [(3.09, &[1, 10][..]), (5.2, &[1, 10, 30])] {
        for &scores in all {
            let plan = Plan { scores, per_level: 1000.max(100 * scores), ..PLAN };
            let truth = 2.0 * tail::normal(limit);
            let (what, excess) =
                (format!("either side of {scores} scores"), |z: &[f64], _: &mut ChaCha8Rng| {
                    sum(z).abs() - limit
                });
            if scores < 30 {
                assert_covers(&what, plan, truth, &excess);
            } else {
                // Of 12 intervals of 95 % less than 9 hold the truth once in 4,000 times.
                let (covered, warned, mean) = covers(&what, plan, truth, 12, &excess);
                assert!(covered >= 9 && warned <= 2 && (mean - 1.0).abs() < 0.05, "{what}");
            }
        }
    }
}

#[test]
fn lengths_of_vectors() {
    for length in [4.5_f64, 6.5] {
        let half = 0.5 * length * length;
        let truth = (-half).exp() * (1.0 + half);
        assert_covers("length", Plan { scores: 4, ..PLAN }, truth, &|z, _| {
            z.iter().map(|z| z * z).sum::<f64>().sqrt() - length
        });
    }
}

/// Of other numbers than scores only some lead to the event.
#[test]
fn what_is_not_steered_keeps_its_law() {
    let truth = 0.1 * tail::normal(3.5) + 0.9 * tail::normal(6.0);
    assert_covers("coin", PLAN, truth, &|z, rng| {
        sum(z) - if rng.random::<f64>() < 0.1 { 3.5 } else { 6.0 }
    });
}

/// What is wrong with a weight shows in these tests: none at all, that of another variance, or without the own law's share.
#[test]
fn wrong_weights_are_found_out() {
    let limit = 4.265;
    let (truth, excess): (f64, Excess<'_>) = (tail::normal(limit), &|z, _| sum(z) - limit);
    let wider = |z: &[f64], by: f64| -> f64 {
        z.iter().map(|z| 0.5 * z * z * (1.0 - 1.0 / (by * by)) - by.ln()).sum()
    };
    let right = covered_with(truth, excess, &|law, z| law.log_weight(z));
    assert!(right >= 17, "{right}");
    let wrong: [Weight<'_>; 4] = [
        &|_, _| 0.0,
        &|law, z| law.log_weight(z) - wider(z, 1.1),
        &|law, z| law.log_weight(z) + wider(z, 1.1),
        &|law, z| {
            let parts = ScoreLaw::mixed(law.scores(), 0.0, law.others());
            parts.log_weight(z) + 0.1_f64.ln()
        },
    ];
    for (i, weight) in wrong.into_iter().enumerate() {
        let covered = covered_with(truth, excess, weight);
        assert!(covered <= 5, "{i}: {covered}");
    }
}

/// What cannot be, what is constant, what is rarer than the least, and what only other numbers than scores decide: no estimate, a
/// bound that holds, and a warning.
#[test]
fn what_is_not_reached_is_told() {
    let cases: [(&str, f64, Excess<'_>); 6] = [
        ("bounded", 0.0, &|z, _| sum(z).tanh() - 1.5),
        ("constant", 0.0, &|_, _| -1.0),
        ("failing", 0.0, &|_, _| f64::NAN),
        ("rare", tail::normal(40.0), &|z, _| sum(z) - 40.0),
        ("hidden", 1e-7, &|_, rng| if rng.random::<f64>() < 1e-7 { 1.0 } else { -1.0 }),
        ("nearer, hidden", 1e-9, &|z, rng| {
            let hidden = rng.random::<f64>() < 1e-9;
            if hidden { 1.0 } else { (sum(z) - 9.0).min(-1.0) }
        }),
    ];
    for (what, truth, excess) in cases {
        for seed in 0..5 {
            let found = estimate(PLAN, seed, excess);
            let interval = found.interval();
            println!("{what}: {} {interval} {:?}", found.probability(), found.warnings(),);
            assert!(interval.contains(truth), "{what}: {interval}");
            let expected = SteeredWarning::NotReached { searches: 2 };
            assert!(found.warnings().contains(&expected), "{what}: {found:?}");
            let no_hit = SteeredWarning::Weights(WeightWarning::NoHit);
            assert!(found.warnings().contains(&no_hit), "{what}");
            assert_eq!((found.probability(), interval.lower()), (0.0, 0.0), "{what}");
            assert!(interval.upper() > 3.0 / PLAN.sample as f64, "{what}: {interval}");
        }
    }
}

/// An event that needs a rare hidden number has few effective runs.
#[test]
fn what_is_hardly_seen_is_warned_of() {
    for seed in 0..20 {
        let found = estimate(PLAN, seed, &|z, rng| {
            if rng.random::<f64>() < 0.001 { sum(z) - 3.0 } else { (sum(z) - 9.0).min(-1.0) }
        });
        let few = found.warnings().iter().any(|warning| {
            matches!(
                warning,
                SteeredWarning::Weights(
                    WeightWarning::FewEffectiveHits { .. } | WeightWarning::NoHit
                )
            )
        });
        assert!(few, "{found:?}");
    }
}

/// A run of the own law is a plain run: the same scores to the bit, of weight 1. A moved one has the ratio of the densities.
#[test]
fn weights_are_ratios_of_densities() {
    let mut plain = [0.3, -0.0, 1e-300, -7.5];
    let before = plain.map(f64::to_bits);
    let own = ScoreLaw::own(4);
    own.draw(0.999, &mut plain);
    assert_eq!(plain.map(f64::to_bits), before);
    assert_eq!(own.log_weight(&plain), 0.0);

    let density = |z: f64, [mean, deviation]: [f64; 2]| {
        (-0.5 * ((z - mean) / deviation).powi(2)).exp() / deviation
    };
    let normals = [[[1.0, 0.5], [0.0, 1.0]], [[-3.0, 2.0], [0.5, 3.0]]];
    let singles = normals.map(|normals| {
        normals.map(|[mean, deviation]| Single::Normal { mean, deviation }).to_vec()
    });
    let [one, other] = singles;
    let parts = vec![(3.0, one), (1.0, other)];
    let law = ScoreLaw::mixed(2, 0.1, parts);
    let rng = &mut ChaCha8Rng::seed_from_u64(1);
    let mut sums = ImportanceSampling::new();
    for _ in 0..100_000 {
        let (choice, z) = scores(rng, &law);
        let of = |normals: [[f64; 2]; 2]| density(z[0], normals[0]) * density(z[1], normals[1]);
        let (f, g) = (of([[0.0, 1.0]; 2]), [of(normals[0]), of(normals[1])]);
        let expected = f / (0.1 * f + 0.9 * (0.75 * g[0] + 0.25 * g[1]));
        let found = law.log_weight(&z);
        assert!((found.exp() / expected - 1.0).abs() < 1e-9 && found <= 10_f64.ln() + 1e-12);
        let expected = if choice < 0.1 { 0 } else { 1 + usize::from(choice >= 0.775) };
        assert_eq!(law.part(choice), expected);
        sums.push(found, false).unwrap();
    }
    // A weight has the mean 1; its standard error is below 3/√n.
    let mean = sums.finish(Confidence::default()).unwrap().mean_weight();
    assert!((mean - 1.0).abs() < 0.02, "{mean}");
}

/// An event that a score decides is as frequent as asked for, and the score keeps its law within it and without.
#[test]
fn tails_are_as_frequent_as_asked_for() {
    for (own, chance) in [(1e-9, 0.5), (1e-3, 0.05), (0.3, 0.9), (0.5, 0.5), (0.999, 0.9991)] {
        let tail = Tail { chance, ..Tail::new(own) };
        let law = ScoreLaw::mixed(1, 0.0, vec![(1.0, vec![Single::Tail(tail)])]);
        let rng = &mut ChaCha8Rng::seed_from_u64(1);
        let (mut inside, mut within, mut without) = (0.0, Vec::new(), Vec::new());
        for _ in 0..20_000 {
            let (_, z) = scores(rng, &law);
            let above = tail::normal(z[0]);
            assert_eq!(tail.has(z[0]), above <= own * (1.0 + 1e-9), "{own} {chance}: {}", z[0]);
            let expected = if tail.has(z[0]) { own / chance } else { (1.0 - own) / (1.0 - chance) };
            assert!((law.log_weight(&z).exp() / expected - 1.0).abs() < 1e-9);
            inside += f64::from(u8::from(tail.has(z[0])));
            if tail.has(z[0]) {
                within.push(above / own);
            } else {
                without.push((above - own) / (1.0 - own));
            }
        }
        let share = inside / 20_000.0;
        let error = (chance * (1.0 - chance) / 20_000.0).sqrt();
        assert!((share - chance).abs() < 4.0 * error, "{own} {chance}: {share}");
        // Uniform: the mean of n such numbers.
        for part in [within, without].into_iter().filter(|part| !part.is_empty()) {
            let mean = part.iter().sum::<f64>() / part.len() as f64;
            assert!((mean - 0.5).abs() < 4.0 / (12.0 * part.len() as f64).sqrt(), "{own}: {mean}");
        }
    }
}

/// Of eight parts that fail once in a thousand times any two bring the event about, and one brings it nearer.
#[test]
fn events_that_scores_decide_are_found() {
    let p: f64 = 1e-3;
    let failing = |z: &[f64]| z[..8].iter().filter(|z| tail::normal(**z) < p).count();
    let n = 8.0;
    let none = (1.0 - p).powi(8);
    let one = n * p * (1.0 - p).powi(7);
    let plan = Plan {
        scores: 10,
        events: &[
            (0, 1e-3),
            (1, 1e-3),
            (2, 1e-3),
            (3, 1e-3),
            (4, 1e-3),
            (5, 1e-3),
            (6, 1e-3),
            (7, 1e-3),
        ],
        ..PLAN
    };
    let two = 1.0 - none - one;
    assert_covers("two of eight", plan, two, &|z, _| failing(z) as f64 - 1.5);
    let truth = none * tail::normal(6.0) + one * tail::normal(4.0) + two * tail::normal(0.0);
    assert_covers("and loads", plan, truth, &|z, _| {
        (z[8] + z[9]) / 2_f64.sqrt() - [6.0, 4.0, 0.0][failing(z).min(2)]
    });
}

#[test]
fn what_cannot_be_is_refused() {
    for (scores, per_level) in [(0, 1000), (1, 99), (1_000_001, 100), (usize::MAX, usize::MAX)] {
        let refused = ScoreSearch::new(scores, per_level).unwrap_err();
        assert_eq!(refused, StatisticsError::SearchPlan { scores, per_level });
    }
    let search = ScoreSearch::new(2, 100).unwrap();
    for least in [0.0, 1.0, f64::NAN] {
        assert!(matches!(search.clone().with_least(least), Err(StatisticsError::Share { .. })));
    }
    for value in [0.0, 1.0, f64::NAN] {
        let refused = search.clone().with_events(&[(0, value)]);
        assert!(matches!(refused, Err(StatisticsError::Probability { .. })), "{value}");
    }
    for place in [2, usize::MAX] {
        let refused = search.clone().with_events(&[(place, 0.5)]);
        assert!(matches!(refused, Err(StatisticsError::Columns { .. })), "{place}");
    }
    let required = StatisticsError::TooFew { n: 0, required: 100 };
    assert_eq!(SteeredSampling::new(&search).unwrap_err(), required);
    let mut told = search.clone();
    let runs = |scores: Vec<f64>, n: usize| vec![(scores, 0.0); n];
    for (scores, n) in [(vec![0.0; 2], 99), (vec![0.0; 3], 100)] {
        assert!(matches!(told.tell(&runs(scores, n)), Err(StatisticsError::Columns { .. })));
    }
    while !told.is_done() {
        told.tell(&runs(vec![0.5; 2], 100)).unwrap();
    }
    let refused = told.tell(&runs(vec![f64::NAN; 2], 100)).unwrap_err();
    assert!(matches!(refused, StatisticsError::Columns { .. }), "nothing is asked for");
    let mut sample = SteeredSampling::new(&told).unwrap();
    let mut unfit = search.clone();
    let refused = unfit.tell(&runs(vec![0.5, f64::NAN], 100)).unwrap_err();
    assert!(matches!(refused, StatisticsError::LogWeight { .. }));
    assert_eq!((unfit.evaluations(), unfit.asks()), (0, 100));
    let nan = sample.push(&[f64::NAN; 2], 1.0).unwrap_err();
    assert!(matches!(nan, StatisticsError::LogWeight { .. }));
    assert!(matches!(sample.push(&[0.0], 1.0), Err(StatisticsError::Columns { .. })));
    assert!(sample.finish(Confidence::default()).is_err());
}

/// Both methods against 100,000,000 plain runs of a function of ten scores with a switch that no score steers; the page of rare events
/// has the figures. `cargo test -p gyradius-statistics --lib -- --ignored --nocapture plain_runs`.
#[test]
#[ignore = "some ten seconds"]
fn both_methods_agree_with_plain_runs() {
    let excess = |z: &[f64], switch: f64| {
        let energy: f64 = z.iter().map(|z| z * z).sum();
        z[0] + 0.8 * z[1] * z[2] + 0.1 * energy + if switch < 0.05 { 1.5 } else { 0.0 } - 11.0
    };
    let runs = 100_000_000_u64;
    let threads = 2;
    let plain: u64 = std::thread::scope(|scope| {
        let count = |thread: u64| {
            let mut rng = ChaCha8Rng::seed_from_u64(thread);
            let mut z = [0.0; 10];
            let mut hits = 0;
            for _ in 0..runs / threads {
                z.iter_mut().for_each(|z| *z = StandardNormal.sample(&mut rng));
                hits += u64::from(excess(&z, rng.random()) >= 0.0);
            }
            hits
        };
        let started: Vec<_> = (0..threads).map(|t| scope.spawn(move || count(t))).collect();
        started.into_iter().map(|thread| thread.join().unwrap()).sum()
    });
    let plain = Proportion::new(plain, runs).unwrap();
    let truth = plain.interval(Confidence::new(0.99).unwrap());
    println!("plain: {} {}", plain.value(), plain.interval(Confidence::default()));
    let overlaps = |what: &str, p: f64, found: Interval, runs: u64| {
        println!("{what}: {p:.3e} {found} of {runs} runs");
        assert!(found.lower() < truth.upper() && truth.lower() < found.upper(), "{what}");
    };
    for seed in 0..3 {
        let plan = Plan { per_level: 5000, sample: 50_000, ..PLAN };
        let found = estimate(plan, seed, &|z, rng| excess(z, rng.random()));
        overlaps("importance", found.probability(), found.interval(), found.evaluations());
        assert!(found.warnings().is_empty(), "{found:?}");
        let subset = crate::SubsetSimulation::new(11, 5000, 10).unwrap();
        let found = subset.run(
            &|draws: &[u64]| {
                let rng = |group: usize| {
                    let mut rng = ChaCha8Rng::seed_from_u64(seed << 8 | group as u64);
                    rng.set_stream(draws[group]);
                    rng
                };
                let z: Vec<f64> =
                    (0..10).map(|group| StandardNormal.sample(&mut rng(group))).collect();
                excess(&z, rng(10).random())
            },
            Confidence::default(),
        );
        let found = found.unwrap();
        overlaps("subset", found.probability(), found.interval(), found.evaluations());
    }
}

/// Any one of some scores can cause the event alone: so many of 16 intervals hold the truth, and none is far off. (Of two searches that knew
/// nothing of each other 20, 8 and 6 of 40 held it.)
#[test]
fn ways_are_found_one_after_the_other() {
    for (scores, active, limit, least) in [(6, 6, 4.3, 14), (10, 10, 4.5, 11), (30, 10, 4.5, 9)] {
        let plan = Plan { scores, sample: 10_000, ..PLAN };
        let truth = -libm::expm1(active as f64 * libm::log1p(-tail::normal(limit)));
        let (mut held, mut runs) = (0, 0);
        for seed in 0..16 {
            let found = estimate(plan, seed, &|z, _| {
                z[..active].iter().copied().fold(f64::MIN, f64::max) - limit
            });
            held += u32::from(found.interval().contains(truth));
            runs += found.evaluations() / 16;
            let is_near = (0.3..2.0).contains(&(found.probability() / truth));
            assert!(is_near || !found.warnings().is_empty(), "{active} of {scores}: {found:?}");
        }
        println!("any of {active} of {scores} scores: held {held} of 16, {runs} runs");
        assert!(held >= least, "{active} of {scores}: {held}");
    }
}

/// More ways than searches find: that is told.
#[test]
fn more_ways_than_are_found_are_warned_of() {
    let plan = Plan { scores: 60, sample: 1000, ..PLAN };
    for seed in 0..2 {
        let found = estimate(plan, seed, &|z, _| z.iter().copied().fold(f64::MIN, f64::max) - 5.0);
        let is_told = found.warnings().iter().any(
            |warning| matches!(warning, SteeredWarning::MoreWays { searches } if *searches > 2),
        );
        assert!(is_told, "{found:?}");
    }
}
