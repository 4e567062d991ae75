//! A law of independent scores, to be drawn from in the place of the standard normal law.

/// A law of scores: a mixture of the standard normal law, their own, and of normal laws with other means and standard
/// deviations, in each of which the scores are independent.
#[derive(Clone, Debug, PartialEq)]
pub struct ScoreLaw {
    scores: usize,
    /// The first is the own law.
    parts: Vec<Part>,
}

/// A part of a mixture: its share, and the law of each score.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Part {
    share: f64,
    /// Mean and standard deviation of each score; empty for the own law.
    normals: Vec<[f64; 2]>,
}

impl ScoreLaw {
    /// The own law of so many scores: what is drawn from it is what plain runs draw.
    pub fn own(scores: usize) -> Self {
        Self { scores, parts: vec![Part { share: 1.0, normals: Vec::new() }] }
    }

    /// A share of the own law, and the rest of normal laws with shares among themselves, and a mean and a standard deviation for each
    /// score.
    pub(super) fn mixed(scores: usize, own: f64, normals: Vec<(f64, Vec<[f64; 2]>)>) -> Self {
        let all: f64 = normals.iter().map(|(share, _)| share).sum();
        let mut law = Self::own(scores);
        if all > 0.0 {
            law.parts[0].share = own;
            let part = |(share, normals)| Part { share: (1.0 - own) * share / all, normals };
            law.parts.extend(normals.into_iter().map(part));
        }
        law
    }

    /// A share of the own law, and what several laws have besides in equal shares; for each part the law that it is of.
    pub(super) fn together(laws: &[Self], own: f64) -> (Self, Vec<Option<usize>>) {
        let mut of_part = vec![None];
        let mut normals = Vec::new();
        for (i, law) in laws.iter().enumerate() {
            let rest: f64 = law.parts[1..].iter().map(|part| part.share).sum();
            for part in &law.parts[1..] {
                normals.push((part.share / rest, part.normals.clone()));
                of_part.push(Some(i));
            }
        }
        let scores = laws.first().map_or(0, |law| law.scores);
        (Self::mixed(scores, own, normals), of_part)
    }

    /// What it has besides the own law: shares, and a mean and a standard deviation for each score.
    pub(super) fn normals(&self) -> Vec<(f64, Vec<[f64; 2]>)> {
        self.parts[1..].iter().map(|part| (part.share, part.normals.clone())).collect()
    }

    /// The law of those draws that are of some parts.
    pub(super) fn of_parts(&self, wanted: impl Fn(usize) -> bool) -> Self {
        let parts = self.parts.iter().enumerate().filter(|(i, _)| wanted(*i));
        let mut parts: Vec<Part> = parts.map(|(_, part)| part.clone()).collect();
        let all: f64 = parts.iter().map(|part| part.share).sum();
        parts.iter_mut().for_each(|part| part.share /= all);
        Self { scores: self.scores, parts }
    }

    /// How many scores it is of.
    pub fn scores(&self) -> usize {
        self.scores
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
        for (score, [mean, deviation]) in scores.iter_mut().zip(&part.normals) {
            *score = mean + deviation * *score;
        }
    }

    /// The natural logarithm of the weight of scores that were drawn from this law: of their density under the standard
    /// normal law over that under this one. NaN if a score is.
    pub fn log_weight(&self, scores: &[f64]) -> f64 {
        if self.is_own() {
            return 0.0;
        }
        let logs = self.parts.iter().map(|part| libm::log(part.share) + part.log_ratio(scores));
        let logs: Vec<f64> = logs.collect();
        -log_sum(&logs)
    }
}

impl Part {
    /// The logarithm of the density over that of the own law.
    fn log_ratio(&self, scores: &[f64]) -> f64 {
        let of = |(z, [mean, deviation]): (&f64, &[f64; 2])| {
            let standard = (z - mean) / deviation;
            0.5 * (z * z - standard * standard) - libm::log(*deviation)
        };
        scores.iter().zip(&self.normals).map(of).sum()
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
