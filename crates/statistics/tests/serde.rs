//! What the feature `serde` writes, and what it reads back.

use gyradius_statistics::{
    Acceptance, BinEdges, Confidence, ConfidenceSequence, Deviation, Estimate, GoodnessOfFit,
    Histogram, ImportanceEstimate, ImportanceSampling, Moments, PairSeparation, Proportion,
    QuantileCells, RankCorrelation, ScoreSearch, SequentialAcceptance, SobolIndices, SobolSums,
    SortedSample, SteeredEstimate, SteeredSampling, SubsetEstimate, SubsetSimulation,
    SuccessByDecile, Tolerance, ToleranceSide, Verdict,
};
use serde_json::{Value, from_value, json, to_value};

const SAMPLE: [f64; 5] = [1.0, 2.0, 3.0, 4.0, 5.0];

#[test]
fn results_are_written_field_by_field() {
    let moments = to_value(Moments::new(&SAMPLE).unwrap()).unwrap();
    assert_eq!(moments["mean"], json!(3.0));
    assert_eq!(moments["n"], json!(5));
    let constant = to_value(Moments::new(&[1.0; 2]).unwrap()).unwrap();
    assert_eq!(constant["skewness"], Value::Null);
    let deviation = to_value(Deviation::new(&SAMPLE).unwrap()).unwrap();
    assert!(deviation["kurtosis"].is_f64());
    let proportion = to_value(Proportion::new(1, 4).unwrap()).unwrap();
    assert_eq!(proportion, json!({"successes": 1, "trials": 4}));
    let sorted = SortedSample::new(&SAMPLE).unwrap();
    assert_eq!(to_value(&sorted).unwrap(), json!(SAMPLE));
    let histogram = Histogram::new(&sorted, &BinEdges::uniform(2.0, 4.0, 2).unwrap());
    assert_eq!(
        to_value(&histogram).unwrap(),
        json!({"edges": [2.0, 3.0, 4.0], "counts": [1, 2], "underflow": 1, "overflow": 1})
    );
    let test = GoodnessOfFit::chi_squared(&[1, 1], &[1.0, 1.0], 0).unwrap();
    assert_eq!(to_value(test).unwrap(), json!({"statistic": 0.0, "p_value": 1.0}));
}

#[test]
fn a_confidence_level_is_a_checked_number() {
    assert_eq!(to_value(Confidence::default()).unwrap(), json!(0.95));
    let read = from_value::<Confidence>;
    assert_eq!(read(json!(0.9)).unwrap(), Confidence::new(0.9).unwrap());
    let text = read(json!(95.0)).unwrap_err().to_string();
    assert!(text.contains("95") && text.contains("between 0 and 1"), "{text}");
}

#[test]
fn rules_and_what_they_decide_are_read_back() {
    let confidence = Confidence::new(0.9).unwrap();
    let rule = Acceptance::new(0.9973, confidence).unwrap();
    let text = json!({"probability": 0.9973, "confidence": 0.9});
    assert_eq!(to_value(rule).unwrap(), text);
    assert_eq!(from_value::<Acceptance>(text.clone()).unwrap(), rule);
    let looks = SequentialAcceptance::new(rule);
    assert_eq!(to_value(looks).unwrap(), text);
    assert_eq!(from_value::<SequentialAcceptance>(text).unwrap(), looks);
    let sequence = ConfidenceSequence::about(0.25, confidence).unwrap();
    assert_eq!(to_value(sequence).unwrap(), json!({"about": 0.25, "confidence": 0.9}));
    assert_eq!(from_value::<ConfidenceSequence>(to_value(sequence).unwrap()).unwrap(), sequence);
    for (bad, allowed) in [
        (json!({"probability": 99.73, "confidence": 0.9}), "1 - 1e-9"),
        (json!({"probability": 0.9973, "confidence": 90}), "between 0 and 1"),
        (json!({"probability": 0.9973, "confidence": 0.4}), "at least 0.5"),
        (json!({"probability": 0.9973, "confidence": 0.9, "power": 0.9}), "unknown field"),
    ] {
        let text = from_value::<SequentialAcceptance>(bad).unwrap_err().to_string();
        assert!(text.contains(allowed), "{text}");
    }
    assert!(from_value::<ConfidenceSequence>(json!({"about": 0.0, "confidence": 0.9})).is_err());

    for (verdict, text) in [
        (Verdict::Met, json!("met")),
        (Verdict::NotMet, json!("not_met")),
        (
            rule.verdict(5, 1000).unwrap(),
            json!({"undecided": {"if_no_more_fail": 2433, "at_this_rate": null}}),
        ),
    ] {
        assert_eq!(to_value(verdict).unwrap(), text);
        assert_eq!(from_value::<Verdict>(text).unwrap(), verdict);
    }
    for runs in [10, 5000] {
        for side in [ToleranceSide::AtMost, ToleranceSide::AtLeast, ToleranceSide::Between] {
            let tolerance = rule.tolerance(side, runs, 1);
            let text = to_value(tolerance).unwrap();
            assert_eq!(from_value::<Tolerance>(text).unwrap(), tolerance);
            assert_eq!(from_value::<ToleranceSide>(to_value(side).unwrap()).unwrap(), side);
        }
    }
}

/// What drives outputs and how rare events are stands in results that are read back, to the bit.
#[test]
fn drivers_and_rare_events_are_read_back() {
    fn back<T>(value: &T)
    where
        T: serde::Serialize + serde::de::DeserializeOwned + PartialEq + std::fmt::Debug,
    {
        let text = serde_json::to_string(value).unwrap();
        assert_eq!(serde_json::from_str::<T>(&text).unwrap(), *value, "{text}");
    }
    let confidence = Confidence::default();
    let (x, y) = ([1.0, 2.0, 3.5, 4.0, 9.0], [0.3, 0.1, 0.2, 0.9, 0.7]);
    let mut sums = SobolSums::new(2).unwrap();
    for (x, y) in x.into_iter().zip(y) {
        sums.push(Some(x), Some(y), &[Some(x * y), None]).unwrap();
    }
    let indices = sums.finish(confidence).unwrap();
    back::<SobolIndices>(&indices);
    assert_eq!(to_value(&indices).unwrap()["groups"][1]["total"], Value::Null);
    let rank = RankCorrelation::new(&x, &y).unwrap();
    back::<RankCorrelation>(&rank);
    back::<Estimate>(&rank.estimate(confidence));
    let failed = [false, true, true, false, false];
    back::<SuccessByDecile>(&SuccessByDecile::new(&x, &failed, confidence).unwrap());
    let [of_x, of_y] = [x, y].map(|column| QuantileCells::new(&column, 2).unwrap());
    back::<PairSeparation>(&PairSeparation::new(&of_x, &of_y, &failed).unwrap());
    let mut weights = ImportanceSampling::new();
    weights.push(-3.0, true).unwrap();
    weights.push(0.5, false).unwrap();
    back::<ImportanceEstimate>(&weights.finish(confidence).unwrap());
    let mut search = ScoreSearch::new(1, 100).unwrap();
    while !search.is_done() {
        search.tell(&vec![(vec![0.5], -1.0); 100]).unwrap();
    }
    let mut sample = SteeredSampling::new(&search).unwrap();
    for excess in [f64::NAN, -1.0, 1.0] {
        sample.push(&[0.5], excess).unwrap();
        sample.push(&[2.5], -1.0).unwrap();
        back::<SteeredEstimate>(&sample.finish(confidence).unwrap());
    }
    let plan = SubsetSimulation::new(2, 100, 2).unwrap();
    for limit in [50.0, 95.0, 200.0] {
        let excess = |draws: &[u64]| (draws[0] % 97) as f64 - limit;
        back::<SubsetEstimate>(&plan.run(&excess, confidence).unwrap());
    }
}

/// What belongs to no result is refused, and says of which: each field wrong by itself.
#[test]
fn numbers_that_do_not_belong_together_are_refused() {
    fn refused<T: serde::de::DeserializeOwned>(whole: &Value, wrong: &[(&str, Value)]) {
        from_value::<T>(whole.clone()).unwrap_or_else(|error| panic!("{whole}: {error}"));
        for (field, value) in wrong {
            let mut bad = whole.clone();
            *bad.pointer_mut(field).unwrap() = value.clone();
            let error = from_value::<T>(bad.clone()).err();
            let text = error.unwrap_or_else(|| panic!("{bad}")).to_string();
            assert!(text.contains("do not belong together"), "{bad}: {text}");
        }
    }
    let interval = json!({"lower": 0.0, "upper": 1.0, "confidence": 0.9});
    refused::<Estimate>(
        &json!({"value": 0.5, "interval": interval}),
        &[("/value", json!(5)), ("/value", json!(-0.1))],
    );
    refused::<Moments>(
        &to_value(Moments::new(&SAMPLE).unwrap()).unwrap(),
        &[
            ("/n", json!(1)),
            ("/mean", json!(6)),
            ("/standard_deviation", json!(-1)),
            ("/standard_deviation", json!(5)),
            ("/skewness", json!(2)),
            ("/skewness", Value::Null),
            ("/kurtosis", json!(-3)),
            ("/kurtosis", json!(0.5)),
            ("/kurtosis", json!(6)),
            ("/kurtosis", Value::Null),
            ("/minimum", json!(5)),
            ("/maximum", json!(1)),
        ],
    );
    refused::<Moments>(
        &to_value(Moments::new(&[2.0; 3]).unwrap()).unwrap(),
        &[("/standard_deviation", json!(1)), ("/maximum", json!(3))],
    );
    refused::<Deviation>(
        &to_value(Deviation::new(&SAMPLE).unwrap()).unwrap(),
        &[
            ("/n", json!(4)),
            ("/standard_deviation", json!(0)),
            ("/kurtosis", json!(0.1)),
            ("/kurtosis", json!(0.99)),
        ],
    );
    let most = u64::MAX;
    refused::<Histogram>(
        &json!({"edges": [0, 1], "counts": [1], "underflow": 0, "overflow": 0}),
        &[
            ("/counts", json!([0])),
            ("/counts", json!([1, 1])),
            ("/edges", json!([0, 1, 2])),
            ("/underflow", json!(most)),
            ("/overflow", json!(most)),
            ("/counts", json!([])),
        ],
    );
    let full = json!({"edges": [0, 1], "counts": [most - 2], "underflow": 1, "overflow": 1});
    assert_eq!(from_value::<Histogram>(full.clone()).unwrap().total(), most);
    refused::<Histogram>(&full, &[("/underflow", json!(2)), ("/counts", json!([most]))]);
    let ranks = json!({"ranks": {"lower": 2, "upper": 5, "confidence": 0.95}});
    refused::<Tolerance>(
        &ranks,
        &[
            ("/ranks/lower", json!(0)),
            ("/ranks/lower", json!(6)),
            ("/ranks/upper", json!(1)),
            ("/ranks/confidence", json!(7)),
            ("/ranks/confidence", json!(-0.1)),
        ],
    );
    for (lower, upper) in [(Value::Null, Value::Null), (json!(0), Value::Null)] {
        let mut bad = ranks.clone();
        (bad["ranks"]["lower"], bad["ranks"]["upper"]) = (lower, upper);
        assert!(from_value::<Tolerance>(bad).is_err());
    }
    assert!(from_value::<Tolerance>(json!({"too_few_runs": {"needed": 0}})).is_err());
    let failed = [false, true, true, false, false];
    let shares = SuccessByDecile::new(&SAMPLE, &failed, Confidence::default()).unwrap();
    let shares = to_value(shares).unwrap();
    let tenth = shares["tenths"][0].clone();
    refused::<SuccessByDecile>(
        &shares,
        &[
            ("/tenths", json!([])),
            ("/tenths", json!([tenth, tenth])),
            ("/tenths/0/interval/lower", json!(0.5)),
            ("/tenths/1/least", json!(9)),
        ],
    );
}

/// Every result that a sample of any size and scale has is read back as it is.
#[test]
fn all_that_samples_have_is_read_back() {
    fn back<T>(value: &T)
    where
        T: serde::Serialize + serde::de::DeserializeOwned + PartialEq + std::fmt::Debug,
    {
        let text = serde_json::to_string(value).unwrap();
        assert_eq!(serde_json::from_str::<T>(&text).unwrap(), *value, "{text}");
    }
    for n in [2, 3, 5, 6, 17, 400_u32] {
        for unit in [1.0, 1e300, 1e-300, 5e-324, 1e-12] {
            for shape in 0..5 {
                let value = |i: u32| match shape {
                    0 => f64::from(i),
                    1 => f64::from(i % 2),
                    2 => f64::from(u8::from(i == 0)),
                    3 => libm::exp(f64::from(i % 83)) / 1e36,
                    _ => 1.0,
                };
                let sample: Vec<f64> = (0..n).map(|i| value(i) * unit).collect();
                let Ok(moments) = Moments::new(&sample) else { continue };
                back(&moments);
                let _ = Deviation::new(&sample).map(|deviation| back(&deviation));
                let sorted = SortedSample::new(&sample).unwrap();
                let edges = BinEdges::freedman_diaconis(&[&sorted]).unwrap();
                back(&Histogram::new(&sorted, &edges));
                let failed: Vec<bool> = (0..n).map(|i| i % 3 == 1).collect();
                back(&SuccessByDecile::new(&sample, &failed, Confidence::default()).unwrap());
                if let Ok(rank) = RankCorrelation::new(&sample, &sample) {
                    back(&rank.estimate(Confidence::new(1e-17).unwrap()));
                }
            }
        }
    }
}
