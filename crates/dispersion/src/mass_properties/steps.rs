//! Nodes for scalars with a Gaussian copula, of which some may have laws of single values: quadrature that breaks where a value becomes the
//! next.

use crate::{Correlation, normal, truncated_normal::share};

/// Conditional scores beyond this have no weight that counts.
const END: f64 = 8.5;
/// Nodes that a block may have.
const MOST: f64 = 1e6;
/// Widths of panels in scores, and into how many values a law is gathered at most: the first that is not too many nodes is taken.
const PLANS: [(f64, usize); 7] =
    [(0.5, 512), (1.0, 128), (1.5, 32), (2.0, 16), (3.0, 8), (4.5, 4), (9.0, 2)];
/// The rule of Gauss and Legendre with four points on [−1, 1].
const RULE: [(f64, f64); 4] = [
    (-0.8611363115940526, 0.34785484513745385),
    (-0.33998104358485626, 0.6521451548625461),
    (0.33998104358485626, 0.6521451548625461),
    (0.8611363115940526, 0.34785484513745385),
];

/// A value and its probability.
type Atom = (f64, f64);

/// The value at a score.
pub(super) type AtScore<'a> = Box<dyn Fn(f64) -> f64 + 'a>;

/// How a scalar is integrated over, given the scores of those before it.
pub(super) enum Over<'a, V = Vec<Atom>> {
    /// A law of these values, in rising order.
    Values(V),
    /// A law by its values, weights and scores.
    Rule(AtScore<'a>, &'a [(f64, f64)]),
}

/// A value from one score to another.
struct Step {
    from: f64,
    to: f64,
    value: f64,
}

/// Scalars in the order of their correlation, whose values stand at other places.
pub(super) struct Steps<'a> {
    /// The lower factor of the correlations, row by row.
    factor: Vec<Vec<f64>>,
    over: Vec<Over<'a, Vec<Step>>>,
    places: &'a [usize],
    width: f64,
}

impl<'a> Steps<'a> {
    /// Of scalars whose values stand at these places.
    pub(super) fn new(correlation: &Correlation, over: Vec<Over<'a>>, places: &'a [usize]) -> Self {
        let n = over.len();
        let columns: Vec<Vec<f64>> = (0..n)
            .map(|j| {
                let mut column: Vec<f64> = (0..n).map(|i| f64::from(u8::from(i == j))).collect();
                correlation.mix(&mut column);
                column
            })
            .collect();
        let factor = (0..n).map(|i| columns.iter().map(|column| column[i]).collect()).collect();
        let count = |(width, most): (f64, usize)| -> f64 {
            let of = |over: &Over<'_>| match over {
                Over::Values(atoms) => {
                    RULE.len() as f64 * (2.0 * END / width + atoms.len().min(most) as f64)
                }
                Over::Rule(_, rule) => rule.len() as f64,
            };
            over.iter().map(of).product()
        };
        let [.., last] = PLANS;
        let (width, most) = PLANS.into_iter().find(|plan| count(*plan) <= MOST).unwrap_or(last);
        let stepped = |over| match over {
            Over::Values(atoms) => Over::Values(steps(&gathered(atoms, most))),
            Over::Rule(value, rule) => Over::Rule(value, rule),
        };
        Self { factor, over: over.into_iter().map(stepped).collect(), places, width }
    }

    /// Weights, whose sum is 1, and the values of all scalars of each.
    pub(super) fn nodes(&self) -> (Vec<f64>, Vec<f64>) {
        let (mut weights, mut values) = (Vec::new(), Vec::new());
        let mut own = vec![0.0; self.over.len()];
        self.fill(1.0, &mut Vec::new(), &mut own, &mut |weight, own| {
            weights.push(weight);
            values.extend_from_slice(own);
        });
        let all: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|weight| *weight /= all);
        (weights, values)
    }

    /// Tells all nodes whose first independent scores are these.
    fn fill(
        &self,
        weight: f64,
        scores: &mut Vec<f64>,
        values: &mut [f64],
        tell: &mut impl FnMut(f64, &[f64]),
    ) {
        let at = scores.len();
        let Some(over) = self.over.get(at) else { return tell(weight, values) };
        let mean: f64 = scores.iter().zip(&self.factor[at]).map(|(z, l)| z * l).sum();
        let deviation = self.factor[at][at];
        let mut go_on = |weight: f64, z: f64, value: f64| {
            values[self.places[at]] = value;
            scores.push(z);
            self.fill(weight, scores, values, tell);
            scores.pop();
        };
        match over {
            Over::Rule(value, rule) => {
                for (own, z) in *rule {
                    go_on(weight * own, *z, value(mean + deviation * z));
                }
            }
            Over::Values(steps) => {
                let is_last = at + 1 == self.over.len();
                for Step { from, to, value } in steps {
                    let [from, to] = [from, to].map(|z| (z - mean) / deviation);
                    if is_last {
                        // Nothing more hangs on the score.
                        let share = share(from, to);
                        if share > 0.0 {
                            go_on(weight * share, 0.0, *value);
                        }
                        continue;
                    }
                    let (from, to) = (from.max(-END), to.min(END));
                    if !(from < to) {
                        continue;
                    }
                    let panels = ((to - from) / self.width).ceil();
                    let half = 0.5 * (to - from) / panels;
                    for panel in 0..panels as usize {
                        let middle = from + (2 * panel + 1) as f64 * half;
                        for (x, own) in RULE {
                            let z = middle + half * x;
                            let density = libm::exp(-0.5 * z * z - normal::LN_ROOT_TAU);
                            go_on(weight * own * half * density, z, *value);
                        }
                    }
                }
            }
        }
    }
}

/// From which score to which each value is.
fn steps(atoms: &[Atom]) -> Vec<Step> {
    let mut from = f64::NEG_INFINITY;
    let mut below = 0.0;
    let mut above: f64 = atoms.iter().map(|atom| atom.1).sum();
    let step = |(value, share): &Atom| {
        below += share;
        above -= share;
        let to = if below < 0.5 { normal::score(below) } else { -normal::score(above.max(0.0)) };
        let step = Step { from, to, value: *value };
        from = to;
        step
    };
    let mut steps: Vec<Step> = atoms.iter().map(step).collect();
    if let Some(last) = steps.last_mut() {
        last.to = f64::INFINITY;
    }
    steps
}

/// Not more values than so many, two for each part of the law: with the mean and deviation of the part.
fn gathered(atoms: Vec<Atom>, most: usize) -> Vec<Atom> {
    if atoms.len() <= most {
        return atoms;
    }
    let parts = (most / 2).max(1) as f64;
    let all: f64 = atoms.iter().map(|atom| atom.1).sum();
    let mut found = Vec::with_capacity(most);
    let (mut rest, mut before) = (atoms.as_slice(), 0.0);
    for part in 1..=parts as usize {
        let until = all * part as f64 / parts;
        let mut sum = before;
        let mut is_in = |atom: &Atom| {
            sum += atom.1;
            // The middle of a value decides in which part it is.
            sum - 0.5 * atom.1 <= until
        };
        let count = rest.iter().copied().take_while(|atom| is_in(atom)).count();
        let (own, left) = rest.split_at(if part == parts as usize { rest.len() } else { count });
        rest = left;
        let share: f64 = own.iter().map(|atom| atom.1).sum();
        before += share;
        if share > 0.0 {
            let mean = own.iter().map(|(value, p)| value * p / share).sum::<f64>();
            let variance = own.iter().map(|(value, p)| (value - mean) * (value - mean) * p / share);
            let deviation = variance.sum::<f64>().sqrt();
            found.extend([(mean - deviation, 0.5 * share), (mean + deviation, 0.5 * share)]);
        }
    }
    found
}
