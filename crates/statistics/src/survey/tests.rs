//! Surveys held against what is found of whole samples.

use proptest::prelude::*;

use super::*;

/// A survey of the runs that have a value, in parts, the last first.
fn surveyed(runs: &[Option<f64>], part: usize, stride: u64) -> Survey {
    let confidence = Confidence::default();
    let mut survey = Survey::new(runs.len() as u64)
        .quantiles([0.05, 0.5, 0.95, 0.0, 1.0])
        .quantile_interval_at(0.95, confidence);
    survey.stride = stride;
    advanced(survey, runs, part)
}

/// The survey after all of its passes over the runs, in parts, the last first.
fn advanced(mut survey: Survey, runs: &[Option<f64>], part: usize) -> Survey {
    let mut passes = 0;
    while let Some(empty) = survey.pass() {
        let mut whole = empty.clone();
        for (i, values) in runs.chunks(part).enumerate().rev() {
            let mut pass = empty.clone();
            let first = (i * part) as u64;
            pass.extend((first..).zip(values).filter_map(|(run, x)| Some((run, (*x)?))));
            whole.merge(pass);
        }
        survey.advance(whole);
        passes += 1;
        assert!(passes < 20);
    }
    survey
}

/// That it found what is found of the whole sample at once.
fn assert_same(survey: &Survey, runs: &[Option<f64>]) {
    let values: Vec<f64> = runs.iter().flatten().copied().collect();
    assert_eq!(survey.n(), values.len() as u64);
    assert_eq!(survey.moments(), Moments::new(&values).ok().as_ref());
    let mean = match values.as_slice() {
        [one] if one.is_finite() => Some(*one),
        all if all.iter().any(|x| !x.is_finite()) => None,
        all => Moments::new(all).ok().map(|moments| moments.mean()).or(survey.mean()),
    };
    assert_eq!(survey.mean(), mean);
    assert_eq!(survey.deviation(), Deviation::new(&values).ok().as_ref());
    let sorted = SortedSample::new(&values).ok();
    for p in [0.05, 0.5, 0.95, 0.0, 1.0] {
        let expected = sorted.as_ref().map(|s| s.quantile(p).unwrap().to_bits());
        assert_eq!(survey.quantile(p).map(f64::to_bits), expected, "{p}");
    }
    let confidence = Confidence::default();
    let interval = sorted.as_ref().map(|s| s.quantile_interval(0.95, confidence).unwrap());
    assert_eq!(survey.quantile_interval(0.95, confidence), interval);
    // What was not asked for, and what is no probability, is not there.
    for p in [f64::NAN, -1.0, -1e-300, 1.5, f64::INFINITY, 0.3] {
        assert_eq!((survey.quantile(p), survey.quantile_interval(p, confidence)), (None, None));
    }
    let other = Confidence::new(0.5).unwrap();
    assert_eq!(survey.quantile_interval(0.95, other), None);
    let ends = |x: Option<(f64, u64)>| x.map(|(x, run)| (x.to_bits(), run));
    let run =
        |x: f64| runs.iter().position(|y| y.map(f64::to_bits) == Some(x.to_bits())).unwrap() as u64;
    let at = |x: f64| (x.to_bits(), run(x));
    assert_eq!(ends(survey.minimum()), sorted.as_ref().map(|s| at(s.minimum())));
    assert_eq!(ends(survey.maximum()), sorted.as_ref().map(|s| at(s.maximum())));
}

proptest! {
    /// Of any values, in any parts, whatever is kept of them.
    #[test]
    fn surveys_find_what_whole_samples_show(
        runs in prop::collection::vec(
            prop::option::weighted(0.9, prop_oneof![-1.0..1.0f64, Just(0.5), Just(-0.0), Just(0.0), any::<f64>()]),
            0..120,
        ),
        unit in -1000..1000_i32,
        part in 1..50_usize,
        stride in 0..5_u32,
    ) {
        let half = unit / 2;
        let scaled = |x: f64| x * 2f64.powi(half) * 2f64.powi(unit - half);
        let runs: Vec<Option<f64>> = runs.into_iter().map(|x| x.map(scaled)).collect();
        assert_same(&surveyed(&runs, part, 1 << stride), &runs);
    }

    /// Of larger samples, smooth, heavy-tailed and of few values.
    #[test]
    fn surveys_of_many_values(kind in 0..4_usize, seed in any::<u32>(), n in 1000..40_000_u32) {
        let uniform = |i: u32| f64::from(i.wrapping_mul(2_654_435_761).wrapping_add(seed)) / 2f64.powi(32);
        let value = |i: u32| match kind {
            0 => uniform(i) + uniform(i.wrapping_mul(7)),
            1 => 1.0 / (uniform(i) - 0.5),
            2 => (uniform(i) * 4.0).floor(),
            _ => (uniform(i) - 0.5) * 0.0,
        };
        let runs: Vec<Option<f64>> = (0..n).map(|i| (i % 11 != 3).then(|| value(i))).collect();
        assert_same(&surveyed(&runs, 1000, 64), &runs);
    }
}

/// Many more values than are kept: the sample is evenly spaced, and few passes are made.
#[test]
fn large_samples_are_thinned() {
    let runs: Vec<Option<f64>> = (0..300_000_u32)
        .map(|i| Some(f64::from(i.wrapping_mul(2_654_435_761)) / 2f64.powi(32)))
        .collect();
    let survey = surveyed(&runs, 4096, Survey::new(300_000).stride);
    assert_same(&survey, &runs);
    assert_eq!(survey.sample().unwrap().n(), 18_750);
}

/// Of runs in groups: what is found with plain sums over the groups of the whole sample, and the same bits in whatever
/// parts the runs come.
#[derive(Debug, PartialEq)]
struct OfGroups {
    mean: Option<Interval>,
    deviation: Option<Interval>,
    quantile: Option<Interval>,
    of_first: Option<Moments>,
}

fn grouped(runs: &[Option<f64>], size: u64, part: usize, stride: u64) -> OfGroups {
    let confidence = Confidence::default();
    let mut survey = Survey::new(runs.len() as u64)
        .quantiles([0.5])
        .quantile_interval_at(0.5, confidence)
        .in_groups_of(size);
    survey.stride = stride;
    let survey = advanced(survey, runs, part);
    OfGroups {
        mean: survey.mean_interval(confidence),
        deviation: survey.deviation_interval(confidence),
        quantile: survey.quantile_interval(0.5, confidence),
        of_first: survey.independent().moments().copied(),
    }
}

proptest! {
    #[test]
    fn groups_are_what_is_independent(
        runs in prop::collection::vec(prop::option::weighted(0.9, -1.0..1.0f64), 0..150),
        shared in prop::collection::vec(-3.0..3.0f64, 150),
        // Its fourth power is a number, too.
        unit in -100..100_i32,
        size in 1..12_u64,
        parts in prop::array::uniform2(1..60_usize),
        stride in 0..3_u32,
    ) {
        let value = |(run, x): (usize, &Option<f64>)| {
            x.map(|x| (x + shared[run / size as usize]) * 2f64.powi(unit))
        };
        let runs: Vec<Option<f64>> = runs.iter().enumerate().map(value).collect();
        let [found, again] = parts.map(|part| grouped(&runs, size, part, 1 << stride));
        prop_assert_eq!(&found, &again);

        let confidence = Confidence::default();
        let of = |runs: &[Option<f64>]| runs.iter().flatten().copied().collect::<Vec<f64>>();
        let first: Vec<_> = runs.iter().step_by(size as usize).copied().collect();
        prop_assert_eq!(found.of_first, Moments::new(&of(&first)).ok());
        let sorted = SortedSample::new(&of(&first)).ok();
        let expected = sorted.map(|s| s.quantile_interval(0.5, confidence).unwrap());
        prop_assert_eq!(found.quantile, expected);

        let values = of(&runs);
        let moments = Moments::new(&values).ok();
        if size == 1 {
            prop_assert_eq!(found.mean, moments.map(|m| m.mean_interval(confidence)));
            return Ok(());
        }
        let groups: Vec<Vec<f64>> =
            runs.chunks(size as usize).map(of).filter(|group| !group.is_empty()).collect();
        let (count, n) = (groups.len() as f64, values.len() as f64);
        // Of equal values the first of each group are counted.
        let constant = moments.is_some_and(|m| m.standard_deviation() == 0.0);
        let enough = if constant { found.of_first.is_some() } else { groups.len() > 1 };
        let Some(moments) = moments.filter(|_| enough) else {
            prop_assert_eq!((found.mean, found.deviation), (None, None));
            return Ok(());
        };
        let mean = moments.mean();
        let square = |x: &f64| (x - mean).powi(2);
        let m2 = values.iter().map(square).sum::<f64>() / n;
        let variance = |of_group: &dyn Fn(&Vec<f64>) -> f64| {
            groups.iter().map(|g| of_group(g).powi(2)).sum::<f64>() * count / (count - 1.0) / (n * n)
        };
        let of_mean = variance(&|g| g.iter().map(|x| x - mean).sum());
        let of_square = variance(&|g| g.iter().map(|x| square(x) - m2).sum());
        let t = crate::law::students_t(confidence.tail(), count - 1.0);
        let interval = found.mean.unwrap();
        let scale = 2f64.powi(unit);
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * (a.abs() + scale);
        prop_assert!(near(interval.lower(), mean - t * of_mean.sqrt()), "{interval} {mean} {of_mean}");
        prop_assert!(near(interval.upper(), mean + t * of_mean.sqrt()), "{interval} {mean} {of_mean}");
        if values.len() >= 5 && !constant {
            let (centre, half) = ((m2 + of_mean).sqrt(), 0.5 * t * of_square.sqrt() / m2);
            let interval = found.deviation.unwrap();
            // The square root of what cancels keeps half of its digits.
            let near = |a: f64, b: f64| (a / b).ln().abs() < 1e-6;
            prop_assert!(near(interval.lower(), centre * (-half).exp()), "{interval}");
            prop_assert!(near(interval.upper(), centre * half.exp()), "{interval}");
        }
    }
}

proptest! {
    /// Ranks that are asked for after the first pass, also those that no value has, are those of the sorted sample.
    #[test]
    fn order_statistics_are_those_of_the_sorted_sample(
        values in prop::collection::vec(prop_oneof![-3.0..3.0, Just(1.0), Just(-0.0), Just(0.0)], 1..400),
        ranks in prop::collection::vec(0_u64..450, 0..6),
        part in 1_usize..50,
    ) {
        let mut survey = Survey::new(values.len() as u64);
        while let Some(empty) = survey.pass() {
            let mut whole = empty.clone();
            for (i, values) in values.chunks(part).enumerate() {
                let mut pass = empty.clone();
                pass.extend(((i * part) as u64..).zip(values.iter().copied()));
                whole.merge(pass);
            }
            survey.advance_selecting(whole, ranks.iter().copied());
        }
        let mut sorted: Vec<f64> = values.clone();
        sorted.sort_by(f64::total_cmp);
        for rank in ranks {
            let found = survey.order_statistic(rank).map(f64::to_bits);
            prop_assert_eq!(found, sorted.get(rank as usize).map(|x| x.to_bits()));
        }
    }
}
