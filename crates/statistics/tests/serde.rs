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
    let mut sample = SteeredSampling::new(&[search]).unwrap();
    for excess in [f64::NAN, -1.0, 1.0] {
        sample.push(0.5, &[0.5], excess).unwrap();
        sample.push(0.5, &[2.5], -1.0).unwrap();
        back::<SteeredEstimate>(&sample.finish(confidence).unwrap());
    }
    let plan = SubsetSimulation::new(2, 100, 2).unwrap();
    for limit in [50.0, 95.0, 200.0] {
        let excess = |draws: &[u64]| (draws[0] % 97) as f64 - limit;
        back::<SubsetEstimate>(&plan.run(&excess, confidence).unwrap());
    }
}
