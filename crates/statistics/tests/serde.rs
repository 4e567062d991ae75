//! What the feature `serde` writes, and what it reads back.

use gyradius_statistics::{
    BinEdges, Confidence, Deviation, GoodnessOfFit, Histogram, Moments, Proportion, SortedSample,
};
use serde_json::{Value, json, to_value};

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
    let read = serde_json::from_value::<Confidence>;
    assert_eq!(read(json!(0.9)).unwrap(), Confidence::new(0.9).unwrap());
    let text = read(json!(95.0)).unwrap_err().to_string();
    assert!(text.contains("95") && text.contains("between 0 and 1"), "{text}");
}
