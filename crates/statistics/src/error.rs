//! What can be wrong with a sample or a request.

/// The most bins that are made at once.
pub(crate) const MAX_BINS: usize = 1000;
/// The most trials of a proportion.
pub(crate) const MAX_TRIALS: u64 = 1_000_000_000;

/// Why a summary was refused: what was wrong, the value, and what is allowed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StatisticsError {
    /// A value of the sample is NaN or infinite.
    #[error("value {} of the sample is {}; every value must be finite", index + 1, plain(*value))]
    NotFinite {
        /// Position in the sample, from 0.
        index: usize,
        /// The value found there.
        value: f64,
    },
    /// The sample is too small for what was asked of it.
    #[error("the sample has {n} values; at least {required} are needed")]
    TooFew {
        /// Number of values in the sample.
        n: usize,
        /// The least number that would do.
        required: usize,
    },
    /// The standard deviation is 0 where a formula divides by it.
    #[error("the standard deviation of the sample is 0; it must be positive")]
    Constant,
    /// The standard deviation is larger than the largest `f64`.
    #[error("values from {minimum:e} to {maximum:e} have a standard deviation beyond f64::MAX")]
    TooSpread {
        /// The smallest value.
        minimum: f64,
        /// The largest value.
        maximum: f64,
    },
    /// The level is no confidence level.
    #[error("the confidence level is {}; it must lie strictly between 0 and 1", plain(*value))]
    Confidence {
        /// The level given.
        value: f64,
    },
    /// The number is no probability.
    #[error("the probability is {}; it must lie between 0 and 1", plain(*value))]
    Probability {
        /// The probability given.
        value: f64,
    },
    /// The bounds are out of order, NaN, or both the same infinity.
    #[error(
        "the interval runs from {} to {}; bounds must be in order and hold a number",
        plain(*lower),
        plain(*upper)
    )]
    Bounds {
        /// The lower bound given.
        lower: f64,
        /// The upper bound given.
        upper: f64,
    },
    /// The counts make no proportion.
    #[error(
        "{successes} successes in {trials} trials; trials must be 1 to {MAX_TRIALS}, successes no more"
    )]
    Proportion {
        /// The successes given.
        successes: u64,
        /// The trials given.
        trials: u64,
    },
    /// The share is none that a requirement or an expectation can state.
    #[error("the share is {}; it must lie between 1e-9 and 1 - 1e-9", plain(*value))]
    Share {
        /// The share given.
        value: f64,
    },
    /// The confidence is too low to decide with: a requirement could be met and not met at once.
    #[error(
        "a requirement is to be decided with confidence {}; it must be at least 0.5",
        plain(*value)
    )]
    DecidingConfidence {
        /// The level given.
        value: f64,
    },
    /// The counts of failures and of runs do not go together.
    #[error(
        "{failures} failures in {runs} runs; runs must be at most {MAX_TRIALS}, failures no more"
    )]
    Failures {
        /// The failures given.
        failures: u64,
        /// The runs given.
        runs: u64,
    },
    /// A width that is to be reached is not positive and finite.
    #[error("the width is {}; it must be positive and finite", plain(*width))]
    Width {
        /// The width given.
        width: f64,
    },
    /// The number of bins is out of range.
    #[error("{bins} bins; there must be 1 to {MAX_BINS}")]
    Bins {
        /// The number of bins given.
        bins: usize,
    },
    /// A bin edge is not finite or not above the one before.
    #[error(
        "bin edge {} is {}; edges must be at least two, finite and increasing",
        index + 1,
        plain(*value)
    )]
    Edge {
        /// Position among the edges, from 0.
        index: usize,
        /// The edge found there, NaN where it is missing.
        value: f64,
    },
    /// A bin is so narrow that its density is beyond the largest `f64`.
    #[error("bin {} is {width:e} wide: its density is beyond f64::MAX; widen it", bin + 1)]
    Density {
        /// Position among the bins, from 0.
        bin: usize,
        /// Its width.
        width: f64,
    },
    /// A distribution function returned something that is no probability.
    #[error(
        "the distribution function is {} at {}; it must lie between 0 and 1",
        plain(*value),
        plain(*at)
    )]
    DistributionFunction {
        /// Where it was evaluated.
        at: f64,
        /// What it returned.
        value: f64,
    },
    /// Observed and expected counts do not pair up.
    #[error("{observed} observed counts and {expected} expected; there must be as many of each")]
    Classes {
        /// The number of observed counts.
        observed: usize,
        /// The number of expected counts.
        expected: usize,
    },
    /// An expected count is not a positive number.
    #[error("expected count {} is {}; it must be positive and finite", index + 1, plain(*value))]
    Expected {
        /// Position among the expected counts, from 0.
        index: usize,
        /// The count found there.
        value: f64,
    },
    /// Observed and expected counts do not add up to the same total.
    #[error(
        "{} observed in all and {} expected; the totals must agree to 1e-8",
        plain(*observed),
        plain(*expected)
    )]
    Totals {
        /// Sum of the observed counts.
        observed: f64,
        /// Sum of the expected counts.
        expected: f64,
    },
    /// No degree of freedom is left for a test.
    #[error("{classes} classes and {fitted} fitted parameters; classes must exceed them by 2")]
    DegreesOfFreedom {
        /// The number of classes.
        classes: usize,
        /// The number of parameters fitted to the same data.
        fitted: usize,
    },
    /// Two columns of the same runs are not of the same length.
    #[error("one column has {first} values and the other {second}; there must be as many of each")]
    Columns {
        /// The values of the first.
        first: usize,
        /// The values of the second.
        second: usize,
    },
    /// The logarithm of a weight is NaN or too large.
    #[error("the logarithm of a weight is {}; it must be a number up to {most}", plain(*value))]
    LogWeight {
        /// The logarithm given.
        value: f64,
        /// The largest that is allowed.
        most: f64,
    },
    /// A search for the law of scores is too small or too large.
    #[error("{}", plan(&[(["score", "scores"], *scores, 1, None), (["run of a level", "runs of a level"], *per_level, 100, None)]))]
    SearchPlan {
        /// The scores given.
        scores: usize,
        /// The runs of a level given.
        per_level: usize,
    },
    /// A plan of subset simulations is too small or too large.
    #[error(
        "{}",
        plan(&[
            (["group of inputs", "groups of inputs"], *groups, 1, None),
            (["run of a level", "runs of a level"], *per_level, 100, None),
            (["replica", "replicas"], *replicas, 2, Some(1000)),
        ])
    )]
    SubsetPlan {
        /// The groups of inputs given.
        groups: usize,
        /// The runs of a level given.
        per_level: usize,
        /// The replicas given.
        replicas: usize,
    },
    /// Numbers that were read are not those of a result.
    #[error("the numbers do not belong together: no {of} has them")]
    Apart {
        /// What they should be of.
        of: &'static str,
    },
    /// The number of groups of inputs is out of range.
    #[error("{groups} groups of inputs; there must be 1 to {most}")]
    GroupCount {
        /// The number of groups given.
        groups: usize,
        /// The most that are allowed.
        most: usize,
    },
    /// A base run does not have one output for each group of inputs.
    #[error(
        "{outputs} outputs with one group drawn anew; there must be one for each of {groups} groups"
    )]
    GroupOutputs {
        /// The number of outputs given.
        outputs: usize,
        /// The number of groups.
        groups: usize,
    },
}

/// Which numbers of a plan are out of range; if none is for itself, that their product is. Each is given with what it counts, one of it
/// and several, the least and the most.
fn plan(numbers: &[([&str; 2], usize, usize, Option<usize>)]) -> String {
    let counted = |[one, several]: [&str; 2], value: usize| {
        format!("{value} {}", if value == 1 { one } else { several })
    };
    let wrong = numbers
        .iter()
        .filter(|(_, value, least, most)| value < least || most.is_some_and(|most| *value > most));
    let wrong = wrong.map(|(what, value, least, most)| {
        let most = most.map_or(" or more".to_owned(), |most| format!(" to {most}"));
        format!("{}; there must be {least}{most}", counted(*what, *value))
    });
    let wrong: Vec<String> = wrong.collect();
    if !wrong.is_empty() {
        return wrong.join(", and ");
    }
    let all = numbers.iter().map(|(what, value, ..)| counted(*what, *value));
    format!("{}; their product may be 100000000 at most", all.collect::<Vec<_>>().join(" times "))
}

/// A number as it reads: 1000, 0.5, 1e300. Never in hundreds of digits.
fn plain(value: f64) -> String {
    let text = format!("{value:?}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

/// Refuses numbers that were read unless they belong together.
#[cfg(feature = "serde")]
pub(crate) fn belong(together: bool, of: &'static str) -> Result<(), StatisticsError> {
    if together { Ok(()) } else { Err(StatisticsError::Apart { of }) }
}

/// The number, if it is between 0 and 1.
pub(crate) fn probability(value: f64) -> Result<f64, StatisticsError> {
    if (0.0..=1.0).contains(&value) {
        Ok(value)
    } else {
        Err(StatisticsError::Probability { value })
    }
}

/// The share, if it is one that can be stated; beyond these, floats are too coarse near one.
pub(crate) fn share(value: f64) -> Result<f64, StatisticsError> {
    // Near one, floats are a part in 10⁷ of 1e-9 apart.
    let least = 1e-9 * (1.0 - 1e-6);
    if value >= least && 1.0 - value >= least {
        Ok(value)
    } else {
        Err(StatisticsError::Share { value })
    }
}

/// Refuses more failures than runs, and more runs than are tested.
pub(crate) fn failures(failures: u64, runs: u64) -> Result<(), StatisticsError> {
    if failures <= runs && runs <= MAX_TRIALS {
        Ok(())
    } else {
        Err(StatisticsError::Failures { failures, runs })
    }
}

/// Refuses a sample with fewer than `required` values or with a value that is not finite.
pub(crate) fn validate(sample: &[f64], required: usize) -> Result<(), StatisticsError> {
    if sample.len() < required {
        return Err(StatisticsError::TooFew { n: sample.len(), required });
    }
    match sample.iter().position(|value| !value.is_finite()) {
        Some(index) => Err(StatisticsError::NotFinite { index, value: sample[index] }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_name_the_value_and_what_is_allowed() {
        let text = validate(&[1.0, f64::NAN], 2).unwrap_err().to_string();
        assert_eq!(text, "value 2 of the sample is NaN; every value must be finite");
        let text = validate(&[1.0], 2).unwrap_err().to_string();
        assert_eq!(text, "the sample has 1 values; at least 2 are needed");
        let text = StatisticsError::Bins { bins: 0 }.to_string();
        assert_eq!(text, "0 bins; there must be 1 to 1000");
    }

    /// Wherever it stands and whatever its size: counted from 1, in few digits that read back.
    #[test]
    fn places_count_from_one_and_numbers_are_short() {
        for index in 0..40 {
            let mut sample = [1.0; 40];
            sample[index] = f64::INFINITY;
            let text = validate(&sample, 1).unwrap_err().to_string();
            assert!(text.starts_with(&format!("value {} of the sample is inf;", index + 1)));
            for error in [
                StatisticsError::Edge { index, value: 1.0 },
                StatisticsError::Expected { index, value: 0.0 },
                StatisticsError::Density { bin: index, width: 1e-320 },
            ] {
                assert!(error.to_string().contains(&format!(" {} is ", index + 1)), "{error}");
            }
        }
        for exponent in -308..=308 {
            let value = 1.25 * 10_f64.powi(exponent);
            let text = plain(value);
            assert!(text.len() < 25 && text.parse() == Ok(value), "{text}");
            let error = StatisticsError::Bounds { lower: value, upper: -value }.to_string();
            assert!(error.len() < 120, "{error}");
        }
        assert_eq!([0.0, 3.0, 0.5, -2.0].map(plain), ["0", "3", "0.5", "-2"]);
    }
}
