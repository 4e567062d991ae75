//! A law of independent scores, to be drawn from in the place of the standard normal law.

use crate::{law, tail};

/// The share of the own law in every law that scores are drawn from: no weight is above its inverse (Hesterberg 1995,
/// doi:10.1080/00401706.1995.10484303).
pub(super) const OWN: f64 = 0.1;

/// A law of scores: a mixture of the standard normal law, their own, and of others, in each of which the scores are independent. A score
/// has another mean and standard deviation there; one that decides an event has it more often.
#[derive(Clone, Debug, PartialEq, getset::CopyGetters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(remote = "Self"))]
pub struct ScoreLaw {
    /// How many scores it is of.
    #[getset(get_copy = "pub")]
    scores: usize,
    /// The first is the own law.
    parts: Vec<Part>,
}

crate::checked::checked!(ScoreLaw, |read| {
    let is_sound = |part: &Part| {
        part.singles.len() == read.scores && part.singles.iter().all(Single::is_sound)
    };
    crate::error::belong(
        read.parts.first().is_some_and(|own| own.singles.is_empty())
            && read.parts.iter().all(|part| (0.0..=1.0).contains(&part.share))
            && read.parts.iter().skip(1).all(is_sound),
        "law of scores",
    )
});

/// A part of a mixture: its share, and the law of each score, which are none for the own law.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Part {
    share: f64,
    singles: Vec<Single>,
}

/// The law of one score.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) enum Single {
    /// A normal law.
    Normal { mean: f64, deviation: f64 },
    /// An upper tail has another probability, and within and without it the score keeps its law: of an event that a score decides.
    Tail(Tail),
}

/// An upper tail of a score.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Tail {
    /// Where it begins.
    pub(super) from: f64,
    /// Its probability under the own law.
    pub(super) own: f64,
    /// Its probability.
    pub(super) chance: f64,
}

impl Tail {
    /// The tail of a probability, which it keeps.
    pub(super) fn new(own: f64) -> Self {
        Self { from: law::normal(own), own, chance: own }
    }

    /// Whether a score is in it.
    pub(super) fn has(&self, z: f64) -> bool {
        z >= self.from
    }
}

impl Single {
    /// The own law of a score.
    pub(super) const OWN: Self = Self::Normal { mean: 0.0, deviation: 1.0 };

    /// Whether it is a law.
    #[cfg(feature = "serde")]
    fn is_sound(&self) -> bool {
        let is_chance = |p: f64| p > 0.0 && p < 1.0;
        match *self {
            Self::Normal { mean, deviation } => mean.is_finite() && deviation > 0.0,
            Self::Tail(Tail { from, own, chance }) => {
                from.is_finite() && is_chance(own) && is_chance(chance)
            }
        }
    }

    /// Makes a standard normal score one of this law.
    fn draw(self, z: f64) -> f64 {
        match self {
            Self::Normal { mean, deviation } => mean + deviation * z,
            Self::Tail(Tail { own, chance, .. }) if own == chance => z,
            Self::Tail(Tail { from, own, chance }) => {
                let above = tail::normal(z);
                if above < chance {
                    return law::normal(above / chance * own).max(from);
                }
                let below = tail::normal(-z) / (1.0 - chance) * (1.0 - own);
                let drawn =
                    if below < 0.5 { -law::normal(below) } else { law::normal(1.0 - below) };
                drawn.min(from.next_down())
            }
        }
    }

    /// The logarithm of its density over that of the own law, to be asked at many scores.
    fn log_ratio(self) -> LogRatio {
        match self {
            Self::Normal { mean, deviation } => {
                LogRatio::Normal { mean, deviation, log: libm::log(deviation) }
            }
            Self::Tail(tail) => LogRatio::Tail {
                within: libm::log(tail.chance / tail.own),
                without: libm::log((1.0 - tail.chance) / (1.0 - tail.own)),
                tail,
            },
        }
    }
}

/// The logarithm of the density of one score over that of its own law. Its logarithms are taken once for all scores.
#[derive(Clone, Debug)]
enum LogRatio {
    Normal { mean: f64, deviation: f64, log: f64 },
    Tail { tail: Tail, within: f64, without: f64 },
}

impl LogRatio {
    fn at(&self, z: f64) -> f64 {
        match self {
            Self::Normal { mean, deviation, log } => {
                let standard = (z - mean) / deviation;
                0.5 * (z * z - standard * standard) - log
            }
            Self::Tail { tail, within, .. } if tail.has(z) => *within,
            // NaN stays NaN.
            Self::Tail { without, .. } => without + 0.0 * z,
        }
    }
}

/// The logarithms of what the parts of a mixture have at scores: of the share, and of the density over that of the own law.
#[derive(Clone, Debug)]
pub(super) struct LogParts(Vec<(f64, Vec<LogRatio>)>);

impl LogParts {
    /// Of parts with their shares.
    pub(super) fn new<'a>(parts: impl Iterator<Item = (f64, &'a [Single])>) -> Self {
        let part = |(share, singles): (f64, &[Single])| {
            (libm::log(share), singles.iter().map(|single| single.log_ratio()).collect())
        };
        Self(parts.map(part).collect())
    }

    /// At some scores, for each part.
    pub(super) fn at(&self, scores: &[f64]) -> Vec<f64> {
        let ratio = |(single, z): (&LogRatio, &f64)| single.at(*z);
        let part = |(share, singles): &(f64, Vec<LogRatio>)| {
            share + singles.iter().zip(scores).map(ratio).sum::<f64>()
        };
        self.0.iter().map(part).collect()
    }

    /// As [`ScoreLaw::log_weight`].
    pub(super) fn log_weight(&self, scores: &[f64]) -> f64 {
        -log_sum(&self.at(scores))
    }
}

impl ScoreLaw {
    /// The own law of so many scores: what is drawn from it is what plain runs draw.
    pub fn own(scores: usize) -> Self {
        Self { scores, parts: vec![Part { share: 1.0, singles: Vec::new() }] }
    }

    /// A share of the own law, and the rest of other laws with shares among themselves.
    pub(super) fn mixed(scores: usize, own: f64, others: Vec<(f64, Vec<Single>)>) -> Self {
        let all: f64 = others.iter().map(|(share, _)| share).sum();
        let mut law = Self::own(scores);
        if all > 0.0 {
            law.parts[0].share = own;
            let part = |(share, singles)| Part { share: (1.0 - own) * share / all, singles };
            law.parts.extend(others.into_iter().map(part));
        }
        law
    }

    /// A share of the own law, and what several laws have besides, with shares among themselves.
    pub(super) fn together<'a>(laws: impl Iterator<Item = (f64, &'a Self)>, own: f64) -> Self {
        let (mut scores, mut others) = (0, Vec::new());
        for (share, law) in laws {
            scores = law.scores;
            let rest: f64 = law.parts[1..].iter().map(|part| part.share).sum();
            let of = |part: &Part| (share * part.share / rest, part.singles.clone());
            others.extend(law.parts[1..].iter().map(of));
        }
        Self::mixed(scores, own, others)
    }

    /// What it has besides the own law: shares, and the law of each score.
    pub(super) fn others(&self) -> Vec<(f64, Vec<Single>)> {
        self.parts[1..].iter().map(|part| (part.share, part.singles.clone())).collect()
    }

    /// Whether it is nothing but the own law.
    pub fn is_own(&self) -> bool {
        self.parts.len() == 1
    }

    /// The share of the own law: no weight is above its inverse.
    pub(super) fn share_of_own(&self) -> f64 {
        self.parts[0].share
    }

    /// The part that a number between 0 and 1 chooses.
    pub(super) fn part(&self, choice: f64) -> usize {
        let mut below = 0.0;
        let chosen = self.parts.iter().position(|part| {
            below += part.share;
            choice < below
        });
        chosen.unwrap_or(self.parts.len() - 1)
    }

    /// Makes standard normal scores scores of this law, by a further number that is uniform between 0 and 1. Those of the own law stay as
    /// they are, to the bit.
    pub fn draw(&self, choice: f64, scores: &mut [f64]) {
        let part = &self.parts[self.part(choice)];
        for (score, single) in scores.iter_mut().zip(&part.singles) {
            *score = single.draw(*score);
        }
    }

    /// The natural logarithm of the weight of scores that were drawn from this law: of their density under the standard
    /// normal law over that under this one. NaN if a score is.
    pub fn log_weight(&self, scores: &[f64]) -> f64 {
        if self.is_own() {
            return 0.0;
        }
        self.log_parts().log_weight(scores)
    }

    /// What tells its weights, to be asked at many scores.
    pub(super) fn log_parts(&self) -> LogParts {
        LogParts::new(self.parts.iter().map(|part| (part.share, part.singles.as_slice())))
    }
}

/// The logarithm of a sum of exponentials.
pub(super) fn log_sum(logs: &[f64]) -> f64 {
    let largest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if !largest.is_finite() {
        return largest;
    }
    largest + libm::log(logs.iter().map(|log| libm::exp(log - largest)).sum())
}
