//! Laws of independent scores, fitted to weighted runs.

use super::score_law::{LogParts, Single, Tail, log_sum};

/// Bounds of a standard deviation.
const NARROW: f64 = 0.3;
const WIDE: f64 = 3.0;
/// No event is made more frequent than this.
const OFTEN: f64 = 0.9;
/// A standard deviation stays 1 unless its square is so many standard errors off.
const SURE: f64 = 3.0;
/// Most parts of a mixture. Each has at least so many runs of equal weight, and this share.
const MOST_PARTS: usize = 12;
const FEW: f64 = 4.0;
const SMALL: f64 = 0.02;
/// A further part must be worth so much more likelihood for each of its parameters.
const WORTH: f64 = 1.5;
/// Steps of an iteration that splits runs.
const STEPS: usize = 20;

/// The scores of a run that leads on, and its weight.
pub(super) struct Elite<'a> {
    pub(super) scores: &'a [f64],
    pub(super) weight: f64,
}

/// A law of each score.
type Singles = Vec<Single>;

/// Laws with their shares; none if no run has a weight. Several are kept as long as there are runs near each of those
/// before. No standard deviation is below 1, and no event less frequent than at the start, if they are to lead further: a narrow part
/// would be left behind by a wide one.
pub(super) fn fit(
    elites: &[Elite<'_>],
    start: &[Single],
    before: &[(f64, Singles)],
    leads_on: bool,
) -> Option<Vec<(f64, Singles)>> {
    let weights: Vec<f64> = elites.iter().map(|elite| elite.weight).collect();
    let (raw, cautious, _) = singles(elites, start, &weights)?;
    let kept = (before.len() > 1).then(|| maximised(elites, start, shares(elites, before)));
    let parts = split(elites, start, kept.flatten().unwrap_or_else(|| vec![(1.0, raw)]));
    let mut found = vec![(1.0, cautious)];
    if parts.len() > 1 {
        found.clear();
        // What is drawn from is as cautious as a single law.
        let near = shares(elites, &parts);
        for (part, (share, _)) in parts.iter().enumerate() {
            let mine = elites.iter().zip(&near).map(|(elite, near)| elite.weight * near[part]);
            found.push((*share, singles(elites, start, &mine.collect::<Vec<_>>())?.1));
        }
    }
    if leads_on {
        for (_, singles) in &mut found {
            for (single, start) in singles.iter_mut().zip(start) {
                match (single, start) {
                    (Single::Normal { deviation, .. }, _) => *deviation = deviation.max(1.0),
                    (Single::Tail(tail), Single::Tail(start)) => {
                        tail.chance = tail.chance.max(start.chance);
                    }
                    (Single::Tail(_), Single::Normal { .. }) => {}
                }
            }
        }
    }
    Some(found)
}

/// Divides the part that is the most worth dividing, as long as one is.
fn split(
    elites: &[Elite<'_>],
    start: &[Single],
    mut parts: Vec<(f64, Singles)>,
) -> Vec<(f64, Singles)> {
    let all: f64 = elites.iter().map(|elite| elite.weight).sum();
    let squares: f64 = elites.iter().map(|elite| elite.weight * elite.weight).sum();
    let likelihood = |parts: &[(f64, Singles)]| -> f64 {
        let logs = logs(parts);
        let of = |elite: &Elite<'_>| elite.weight * log_sum(&logs.at(elite.scores));
        elites.iter().map(of).sum::<f64>() / all
    };
    // For each run of equal weight.
    let worth = WORTH * (2 * start.len() + 1) as f64 * squares / (all * all);
    while parts.len() < MOST_PARTS {
        let near = shares(elites, &parts);
        let divided = (0..parts.len()).filter_map(|part| {
            let sides = halves(elites, &near, part, &parts[part].1)?;
            let near = near.iter().zip(sides).map(|(near, side)| {
                let (mut near, whole) = (near.clone(), near[part]);
                near[part] = whole * side;
                near.push(whole * (1.0 - side));
                near
            });
            let found = maximised(elites, start, near.collect())?;
            Some((likelihood(&found), found))
        });
        let Some((height, found)) = divided.max_by(|(a, _), (b, _)| a.total_cmp(b)) else { break };
        if !(height - likelihood(&parts) > worth) {
            break;
        }
        parts = found;
    }
    parts
}

/// The likeliest laws of weighted runs, the same with caution, and how many runs of equal weight they are.
fn singles(
    elites: &[Elite<'_>],
    start: &[Single],
    weights: &[f64],
) -> Option<(Singles, Singles, f64)> {
    let all: f64 = weights.iter().sum();
    let squares: f64 = weights.iter().map(|weight| weight * weight).sum();
    if !(all > 0.0 && squares > 0.0) {
        return None;
    }
    let count = all * all / squares;
    let likeliest = |(j, start): (usize, &Single)| match *start {
        Single::Normal { .. } => {
            let mean = mean_of(elites, weights, |scores| scores[j]);
            let variance =
                mean_of(elites, weights, |scores| (scores[j] - mean) * (scores[j] - mean));
            Single::Normal { mean, deviation: variance.sqrt().clamp(NARROW, WIDE) }
        }
        Single::Tail(tail) => {
            let share = mean_of(elites, weights, |scores| f64::from(u8::from(tail.has(scores[j]))));
            Single::Tail(Tail { chance: share.clamp(tail.own, tail.own.max(OFTEN)), ..tail })
        }
    };
    let raw: Singles = start.iter().enumerate().map(likeliest).collect();
    // What of the means is chance, and what would be of a variance.
    let (mut length, mut chance) = (0.0, 0.0);
    for single in &raw {
        if let Single::Normal { mean, deviation } = single {
            length += mean * mean;
            chance += deviation * deviation / count;
        }
    }
    let kept = if length > 0.0 { (1.0 - chance / length).max(0.0) } else { 0.0 };
    let sure = SURE * (2.0 / count).sqrt();
    let cautious = raw.iter().map(|single| match *single {
        Single::Normal { mean, deviation } => {
            let off = (deviation * deviation - 1.0).abs();
            let deviation = if off > sure { deviation } else { 1.0 };
            Single::Normal { mean: kept * mean, deviation }
        }
        Single::Tail(tail) => {
            let chance = (count * tail.chance + tail.own) / (count + 1.0);
            Single::Tail(Tail { chance, ..tail })
        }
    });
    let cautious = cautious.collect();
    Some((raw, cautious, count))
}

/// The weighted mean of a function of the scores.
fn mean_of(elites: &[Elite<'_>], weights: &[f64], of: impl Fn(&[f64]) -> f64) -> f64 {
    let (mut sum, mut all) = (0.0, 0.0);
    for (elite, weight) in elites.iter().zip(weights) {
        sum += weight * of(elite.scores);
        all += weight;
    }
    sum / all
}

/// For each run 1 or 0: on which side it is, across the direction in which those near a part scatter most about its middle.
fn halves(
    elites: &[Elite<'_>],
    near: &[Vec<f64>],
    part: usize,
    middle: &Singles,
) -> Option<Vec<f64>> {
    let scores = middle.len();
    let centred = |elite: &Elite<'_>, j: usize| match middle[j] {
        Single::Normal { mean, .. } => elite.scores[j] - mean,
        Single::Tail(_) => 0.0,
    };
    let along = |elite: &Elite<'_>, direction: &[f64]| -> f64 {
        direction.iter().enumerate().map(|(j, d)| d * centred(elite, j)).sum()
    };
    // Power iteration, from the run that is farthest off.
    let far = |(elite, near): (&Elite<'_>, &Vec<f64>)| {
        near[part] * (0..scores).map(|j| centred(elite, j).powi(2)).sum::<f64>()
    };
    let (start, _) = elites.iter().zip(near).max_by(|a, b| far(*a).total_cmp(&far(*b)))?;
    let mut direction: Vec<f64> = (0..scores).map(|j| centred(start, j)).collect();
    for _ in 0..STEPS {
        let mut next = vec![0.0; scores];
        for (elite, near) in elites.iter().zip(near) {
            let factor = near[part] * elite.weight * along(elite, &direction);
            for (j, entry) in next.iter_mut().enumerate() {
                *entry += factor * centred(elite, j);
            }
        }
        let length = next.iter().map(|x| x * x).sum::<f64>().sqrt();
        if !(length > 0.0) {
            return None;
        }
        direction = next.into_iter().map(|x| x / length).collect();
    }
    let side = |elite: &Elite<'_>| f64::from(u8::from(along(elite, &direction) > 0.0));
    Some(elites.iter().map(side).collect())
}

/// A mixture of several laws, by expectation and maximisation from the share that each run has in each of them; none if one of them
/// has too few.
fn maximised(
    elites: &[Elite<'_>],
    start: &[Single],
    mut near: Vec<Vec<f64>>,
) -> Option<Vec<(f64, Singles)>> {
    let all: f64 = elites.iter().map(|elite| elite.weight).sum();
    let mut parts = Vec::new();
    for _ in 0..STEPS {
        parts.clear();
        for part in 0..near.first()?.len() {
            let share = |(elite, near): (&Elite<'_>, &Vec<f64>)| elite.weight * near[part];
            let weights: Vec<f64> = elites.iter().zip(&near).map(share).collect();
            let (law, _, count) = singles(elites, start, &weights)?;
            let share = weights.iter().sum::<f64>() / all;
            if count < FEW || share < SMALL {
                return None;
            }
            parts.push((share, law));
        }
        near = shares(elites, &parts);
    }
    Some(parts)
}

/// The logarithms of what each part has at a run, but for a constant.
fn logs(parts: &[(f64, Singles)]) -> LogParts {
    LogParts::new(parts.iter().map(|(share, singles)| (*share, singles.as_slice())))
}

/// For each run with which probability it is of each part.
fn shares(elites: &[Elite<'_>], parts: &[(f64, Singles)]) -> Vec<Vec<f64>> {
    let logs = logs(parts);
    let of = |elite: &Elite<'_>| {
        let logs = logs.at(elite.scores);
        let all = log_sum(&logs);
        logs.into_iter().map(|log| libm::exp(log - all)).collect()
    };
    elites.iter().map(of).collect()
}
