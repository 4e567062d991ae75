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
    assert_eq!(survey.deviation(), Deviation::new(&values).ok().as_ref());
    let sorted = SortedSample::new(&values).ok();
    for p in [0.05, 0.5, 0.95, 0.0, 1.0] {
        let expected = sorted.as_ref().map(|s| s.quantile(p).unwrap().to_bits());
        assert_eq!(survey.quantile(p).map(f64::to_bits), expected, "{p}");
    }
    let confidence = Confidence::default();
    let interval = sorted.as_ref().map(|s| s.quantile_interval(0.95, confidence).unwrap());
    assert_eq!(survey.quantile_interval(0.95, confidence), interval);
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
