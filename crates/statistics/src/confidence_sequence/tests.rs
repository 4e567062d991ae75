//! Intervals against 50 digits, and their coverage summed over all paths.

use proptest::prelude::*;

use super::*;
use crate::Proportion;
use crate::binomial_sums::one_more;

/// References: roots found by mpmath 1.3 with 50 digits.
#[test]
fn bounds_have_their_digits_up_to_a_billion_runs() {
    for (about, level, events, runs, lower, upper) in [
        (0.5, 0.95, 3, 1000, 0.0001238737540981003, 0.014312154132124397),
        (0.001, 0.95, 3, 4000, 7.765121874525081e-05, 0.0027516724850000763),
        (0.0027, 0.9, 2_000_000, 1_000_000_000, 0.001993663952695317, 0.00200634943053416),
        (0.5, 0.9, 500_000_000, 1_000_000_000, 0.4999197192140104, 0.5000802807859895),
        (1e-6, 0.99, 700, 1_000_000_000, 5.970289301017552e-07, 8.141804220208856e-07),
    ] {
        let sequence = ConfidenceSequence::about(about, Confidence::new(level).unwrap()).unwrap();
        let interval = sequence.interval(events, runs).unwrap();
        let off = [interval.lower() / lower - 1.0, interval.upper() / upper - 1.0];
        assert!(off.iter().all(|off| off.abs() < 1e-9), "{about} {events}: {off:?}");
    }
}

#[test]
fn without_events_and_without_others_a_bound_is_the_end() {
    let sequence = ConfidenceSequence::new(Confidence::default());
    let ends = |events, runs| {
        let interval = sequence.interval(events, runs).unwrap();
        (interval.lower(), interval.upper())
    };
    assert_eq!(ends(0, 0), (0.0, 1.0));
    assert_eq!((ends(0, 1000).0, ends(1000, 1000).1), (0.0, 1.0));
    assert!((ends(0, 1000).1 + ends(1000, 1000).0 - 1.0).abs() < 1e-12);
    assert!(sequence.interval(2, 1).is_err() && sequence.interval(0, 1_000_000_001).is_err());
    for share in [0.0, 1.0, 1e-10, f64::NAN] {
        assert!(ConfidenceSequence::about(share, Confidence::default()).is_err());
    }
}

#[test]
fn a_width_takes_so_many_runs() {
    let sequence = ConfidenceSequence::new(Confidence::default());
    for (share, width) in [(0.0, 0.001), (0.5, 0.01), (0.003, 0.0005), (1.0, 0.2), (0.9, 1.0)] {
        let runs = sequence.runs_for_width(share, width).unwrap().unwrap();
        // Whole events: within one of the share.
        let at = |runs: u64| {
            sequence.interval((share * runs as f64).round() as u64, runs).unwrap().width()
        };
        assert!(at(runs) <= width * 1.01, "{share} {width}: {runs}");
        assert!(runs == 0 || at(runs - 1) > width * 0.99, "{share} {width}: {runs}");
    }
    assert_eq!(sequence.runs_for_width(0.5, 1e-9), Ok(None));
    assert_eq!(sequence.runs_for_width(0.5, 0.0), Ok(None));
    assert!(sequence.runs_for_width(1.5, 0.1).is_err());
    assert!(sequence.runs_for_width(0.5, f64::INFINITY).is_err());
}

#[test]
fn looking_costs_width() {
    let confidence = Confidence::default();
    let sequence = ConfidenceSequence::about(0.01, confidence).unwrap();
    for (events, width, runs) in [(5, 1.4, 1.9), (50, 1.6, 2.9), (5000, 2.0, 4.4)] {
        let one_look = Proportion::new(events, 100 * events).unwrap().interval(confidence).width();
        let wider = sequence.interval(events, 100 * events).unwrap().width() / one_look;
        let needed = sequence.runs_for_width(0.01, one_look).unwrap().unwrap();
        let more = needed as f64 / (100 * events) as f64;
        assert!((wider - width).abs() < 0.05 && (more - runs).abs() < 0.05, "{wider} {more}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// The probability that all intervals of so many runs hold the share, which those of one look do not keep.
    #[test]
    fn all_intervals_hold_together(
        share in 0.01..0.99f64,
        about in 0.01..0.99f64,
        level in 0.3..0.99f64,
        runs in 50..200u64,
    ) {
        let confidence = Confidence::new(level).unwrap();
        let sequence = ConfidenceSequence::about(about, confidence).unwrap();
        let mut held = vec![1.0];
        for run in 1..=runs {
            one_more(&mut held, share, 1.0 - share);
            for (events, mass) in (0..).zip(&mut held) {
                // What is less does not matter, and takes its time.
                let counts = *mass > 1e-14;
                if counts && !sequence.interval(events, run).unwrap().contains(share) {
                    *mass = 0.0;
                }
            }
        }
        prop_assert!(held.iter().sum::<f64>() >= level - 1e-9);
    }

    /// No sequence is narrower than the one look that could have been the only one, beyond what a one-sided
    /// bound saves where nothing was seen.
    #[test]
    fn intervals_are_wider_than_those_of_one_look(
        runs in 20..1_000_000u64,
        share in 0.0..1.0f64,
        level in 0.8..0.999f64,
    ) {
        let confidence = Confidence::new(level).unwrap();
        let events = (share * runs as f64) as u64;
        let one_look = Proportion::new(events, runs).unwrap().interval(confidence);
        let interval = ConfidenceSequence::new(confidence).interval(events, runs).unwrap();
        prop_assert!(interval.lower() <= one_look.lower() && one_look.upper() <= interval.upper());
    }
}

#[test]
fn intervals_of_one_look_do_not_hold_together() {
    let (share, confidence) = (0.3, Confidence::new(0.9).unwrap());
    let mut held = vec![1.0];
    for run in 1..=100 {
        one_more(&mut held, share, 1.0 - share);
        for (events, mass) in (0..).zip(&mut held) {
            let interval = Proportion::new(events, run).unwrap().interval(confidence);
            if !interval.contains(share) {
                *mass = 0.0;
            }
        }
    }
    assert!(held.iter().sum::<f64>() < 0.8);
}
