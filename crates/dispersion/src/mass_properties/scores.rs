//! Expectations over scalar laws that are drawn jointly, by quadrature over their scores.

use nalgebra::DMatrix;
use std::{cell::RefCell, collections::HashMap, rc::Rc, sync::LazyLock};

use super::lognormal::Lognormals;
use super::steps::{AtScore, Over, Steps};
use crate::{Correlation, ScalarLaw};

/// How many scalars a joint law has at most: mass, three of the centre, three of the shape.
pub(super) const SCALARS: usize = 7;

/// Where the logarithm of the lognormal part of a product varies by no more than this, all rules have three digits of it, and those of Gauss and
/// Hermite ten.
const NARROW: f64 = 4.0;
/// The digits that a rule must have of it elsewhere.
const DIGITS: f64 = 1e-3;

/// The function ∏ x_s^p_s of scalars, times a power of the factor that goes with the first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct Monomial {
    pub(super) powers: [i32; SCALARS],
    pub(super) factor: i32,
}

impl Monomial {
    pub(super) fn times(mut self, scalar: usize, power: i32) -> Self {
        self.powers[scalar] += power;
        self
    }

    fn involves(&self, scalar: usize) -> bool {
        self.powers[scalar] != 0 || (scalar == 0 && self.factor != 0)
    }

    /// The part of it that is a function of some of the scalars.
    fn of(&self, scalars: &[usize]) -> Self {
        let mut part = Self::default();
        for &scalar in scalars {
            part.powers[scalar] = self.powers[scalar];
            if scalar == 0 {
                part.factor = self.factor;
            }
        }
        part
    }
}

/// Scalar laws with a Gaussian copula, of which expectations are taken.
pub(super) struct Scores<'a, F> {
    pub(super) laws: Vec<&'a ScalarLaw>,
    pub(super) correlation: &'a Correlation,
    /// The factor that goes with the first scalar.
    pub(super) factor: F,
    /// What has been found of each block of scalars.
    pub(super) known: RefCell<HashMap<Vec<usize>, Rc<Nodes>>>,
}

/// Weights and values of the scalars of a block, one after the other, and what monomials and pairs of them come to there.
pub(super) struct Nodes {
    weights: Vec<f64>,
    values: Vec<f64>,
    monomials: RefCell<HashMap<Monomial, Rc<[f64]>>>,
    /// Of a block there are few parts of monomials, and each pair of them is asked for many times.
    pairs: RefCell<HashMap<[Monomial; 2], Pair>>,
}

/// E f, E g, E fg and Cov(f, g).
#[derive(Clone, Copy, Debug)]
struct Pair {
    first: f64,
    second: f64,
    product: f64,
    covariance: f64,
}

impl Nodes {
    fn new(weights: Vec<f64>, values: Vec<f64>) -> Self {
        Self { weights, values, monomials: RefCell::default(), pairs: RefCell::default() }
    }

    /// Mean and variance of a function of the scalars, which are so many.
    fn moments(&self, width: usize, f: impl Fn(&[f64]) -> f64) -> (f64, f64) {
        let each = || self.weights.iter().zip(self.values.chunks_exact(width).map(&f));
        let mean: f64 = each().map(|(weight, f)| weight * f).sum();
        (mean, each().map(|(weight, f)| weight * (f - mean) * (f - mean)).sum())
    }
}

impl<'a, F: Fn(f64) -> f64> Scores<'a, F> {
    /// E f and Cov(f, g); not numbers where a rule does not resolve lognormal scalars, which are so wide and correlated with
    /// scalars of other laws.
    ///
    /// Scalars that are not correlated with each other are independent, and of products of independent functions
    /// Cov(f f', g g') = Cov(f, g) E f'g' + E f E g Cov(f', g'): nothing cancels, so that narrow laws keep their digits.
    pub(super) fn covariance(&self, f: &Monomial, g: &Monomial) -> (f64, f64) {
        let involved: Vec<usize> =
            (0..self.laws.len()).filter(|&s| f.involves(s) || g.involves(s)).collect();
        let one = Pair { first: 1.0, second: 1.0, product: 1.0, covariance: 0.0 };
        let whole =
            self.blocks(&involved).iter().map(|block| self.block(block, f, g)).fold(one, |a, b| {
                Pair {
                    first: a.first * b.first,
                    second: a.second * b.second,
                    product: a.product * b.product,
                    covariance: a.covariance * b.product + a.first * a.second * b.covariance,
                }
            });
        (whole.first, whole.covariance)
    }

    /// The scalars in groups that are independent of each other.
    fn blocks(&self, involved: &[usize]) -> Vec<Vec<usize>> {
        let mut blocks: Vec<Vec<usize>> = Vec::new();
        for &scalar in involved {
            let tied = |block: &Vec<usize>| {
                block.iter().any(|&other| self.correlation.coefficient(scalar, other) != 0.0)
            };
            let (joined, mut apart): (Vec<_>, Vec<_>) = blocks.into_iter().partition(tied);
            let mut own: Vec<usize> = joined.into_iter().flatten().collect();
            own.push(scalar);
            own.sort_unstable();
            apart.push(own);
            blocks = apart;
        }
        blocks
    }

    fn block(&self, block: &[usize], f: &Monomial, g: &Monomial) -> Pair {
        let parts = [f, g].map(|monomial| monomial.of(block));
        let lognormals = Lognormals::new(&self.laws, block, self.correlation);
        if lognormals.count() == block.len() && parts.iter().all(|part| part.factor == 0) {
            let [first, second] = parts.map(|part| lognormals.mean(&part.powers));
            let together = lognormals.ln_covariance(&parts[0].powers, &parts[1].powers);
            let whole = first * second;
            let (product, covariance) =
                (whole * libm::exp(together), whole * libm::expm1(together));
            return Pair { first, second, product, covariance };
        }
        let known = self.known.borrow().get(block).cloned();
        let nodes = known.unwrap_or_else(|| {
            let nodes = Rc::new(self.nodes(block));
            self.known.borrow_mut().insert(block.to_vec(), Rc::clone(&nodes));
            nodes
        });
        if let Some(pair) = nodes.pairs.borrow().get(&parts) {
            return *pair;
        }
        let pair = if is_resolved(&nodes, block.len(), &lognormals, &parts) {
            self.by_nodes(&nodes, block, parts)
        } else {
            let none = f64::NAN;
            Pair { first: none, second: none, product: none, covariance: none }
        };
        nodes.pairs.borrow_mut().insert(parts, pair);
        pair
    }

    fn by_nodes(&self, nodes: &Nodes, block: &[usize], parts: [Monomial; 2]) -> Pair {
        let [f, g] = parts.map(|monomial| self.at_nodes(nodes, block, monomial));
        let each = || nodes.weights.iter().zip(f.iter().zip(g.iter()));
        let (mut first, mut second, mut product, mut covariance) = (0.0, 0.0, 0.0, 0.0);
        for (weight, (f, g)) in each() {
            first += weight * f;
            second += weight * g;
            product += weight * f * g;
        }
        // One goes with nothing, and rounding must not say else.
        if parts.iter().all(|part| *part != Monomial::default()) {
            for (weight, (f, g)) in each() {
                covariance += weight * (f - first) * (g - second);
            }
        }
        Pair { first, second, product, covariance }
    }

    /// What a monomial of the scalars of a block comes to at its nodes. It is asked for in a pair with each of the others.
    fn at_nodes(&self, nodes: &Nodes, block: &[usize], monomial: Monomial) -> Rc<[f64]> {
        let known = nodes.monomials.borrow().get(&monomial).cloned();
        known.unwrap_or_else(|| {
            let each = nodes.values.chunks_exact(block.len()).map(|x| {
                block.iter().zip(x).fold(1.0, |product, (&scalar, &x)| {
                    // Most powers are of degree zero.
                    let own = match monomial.powers[scalar] {
                        0 => product,
                        power => product * x.powi(power),
                    };
                    if scalar == 0 && monomial.factor != 0 {
                        own * (self.factor)(x).powi(monomial.factor)
                    } else {
                        own
                    }
                })
            });
            let values: Rc<[f64]> = each.collect();
            nodes.monomials.borrow_mut().insert(monomial, Rc::clone(&values));
            values
        })
    }

    /// Weights and values of the scalars of a block, by the rules that have the own moments of all scalars, or have them more nearly.
    fn nodes(&self, block: &[usize]) -> Nodes {
        let own = |law: &'a ScalarLaw| -> AtScore<'a> { Box::new(|z| law.at_score(z)) };
        let smooth = self.nodes_by(&RULES, own, block);
        let miss = self.miss(&smooth, block);
        if miss <= DIGITS {
            return smooth;
        }
        let close = self.nodes_by(&CLOSE, tabulated, block);
        let best = if self.miss(&close, block) < miss { close } else { smooth };
        self.with_own_moments(best, block)
    }

    /// The largest relative error, at the nodes, of the variance of a scalar and of its square, and of the means in deviations, of
    /// scalars of which a rule is taken and nothing is known otherwise.
    fn miss(&self, nodes: &Nodes, block: &[usize]) -> f64 {
        let is_open = |law: &ScalarLaw| law.as_lognormal().is_none() && law.atoms().is_none();
        let mut miss = 0.0_f64;
        for (at, &scalar) in block.iter().enumerate() {
            let law = self.laws[scalar];
            let (square, square_variance) = law.square_moments();
            let of =
                [(1, law.mean(), law.deviation() * law.deviation()), (2, square, square_variance)];
            for (power, mean, variance) in of.into_iter().filter(|of| is_open(law) && of.2 > 0.0) {
                let (found, found_variance) = nodes.moments(block.len(), |x| x[at].powi(power));
                let off = (found - mean) / variance.sqrt();
                miss = miss.max(off.abs()).max((found_variance / variance - 1.0).abs());
            }
        }
        miss
    }

    /// The same nodes, each scalar stretched to the mean and the deviation of its law.
    fn with_own_moments(&self, mut nodes: Nodes, block: &[usize]) -> Nodes {
        for (at, &scalar) in block.iter().enumerate() {
            let (mean, deviation) = (self.laws[scalar].mean(), self.laws[scalar].deviation());
            let (found, variance) = nodes.moments(block.len(), |x| x[at]);
            let stretch = deviation / variance.sqrt();
            if stretch.is_finite() {
                for x in nodes.values.chunks_exact_mut(block.len()) {
                    x[at] = mean + (x[at] - found) * stretch;
                }
            }
        }
        nodes
    }

    /// By these rules, each law being told by its values.
    ///
    /// Of normal scalars the monomials are polynomials, and with the scores of these last, which the others do not depend on, a few nodes are
    /// exact for them. The first scalar may be taken by its factor. Laws of single values stand before all others.
    fn nodes_by(
        &self,
        rules: &'static [LazyLock<Vec<(f64, f64)>>; 4],
        value: impl Fn(&'a ScalarLaw) -> AtScore<'a>,
        block: &[usize],
    ) -> Nodes {
        let mut atoms: Vec<_> = block.iter().map(|&scalar| self.laws[scalar].atoms()).collect();
        if let [Some(atoms)] = atoms.as_slice() {
            return Nodes::new(
                atoms.iter().map(|atom| atom.1).collect(),
                atoms.iter().map(|atom| atom.0).collect(),
            );
        }
        let is_exact = |&at: &usize| block[at] > 0 && self.laws[block[at]].as_normal().is_some();
        let (mut order, last): (Vec<usize>, Vec<usize>) =
            (0..block.len()).partition(|at| !is_exact(at));
        order.sort_by_key(|&at| atoms[at].is_none());
        let many = order.len();
        order.extend(last);
        let rule = |i: usize| -> &[(f64, f64)] {
            if i < many { &rules[block.len().min(rules.len()) - 1] } else { &EXACT }
        };
        let pairs: Vec<(usize, usize, f64)> = (0..block.len())
            .flat_map(|i| (0..i).map(move |j| (i, j)))
            .map(|(i, j)| (i, j, self.correlation.coefficient(block[order[i]], block[order[j]])))
            .filter(|(_, _, coefficient)| *coefficient != 0.0)
            .collect();
        // Of correlations a part is correlations, too.
        let correlation = Correlation::new(&pairs).unwrap_or_default();
        let over = order.iter().enumerate().map(|(i, &at)| match atoms[at].take() {
            Some(atoms) => Over::Values(atoms),
            None => Over::Rule(value(self.laws[block[at]]), rule(i)),
        });
        let (weights, values) = Steps::new(&correlation, over.collect(), &order).nodes();
        Nodes::new(weights, values)
    }
}

/// Whether nodes have the expectation of the lognormal part of a product, which is known. The factor that goes with the first
/// scalar is at most its power.
fn is_resolved(
    nodes: &Nodes,
    width: usize,
    lognormals: &Lognormals<'_>,
    [f, g]: &[Monomial; 2],
) -> bool {
    let mut powers: [i32; SCALARS] = std::array::from_fn(|s| f.powers[s] + g.powers[s]);
    powers[0] += f.factor + g.factor;
    if lognormals.ln_covariance(&powers, &powers) <= NARROW {
        return true;
    }
    let values = nodes.values.chunks_exact(width).map(|x| lognormals.product(&powers, x));
    let found: f64 = nodes.weights.iter().zip(values).map(|(weight, x)| weight * x).sum();
    (found / lognormals.mean(&powers) - 1.0).abs() <= DIGITS
}

/// The rules for each of one scalar, of two, of three and of more.
static RULES: [LazyLock<Vec<(f64, f64)>>; 4] = [
    // Laws with corners want many nodes.
    LazyLock::new(panels),
    LazyLock::new(|| hermite(48)),
    LazyLock::new(|| hermite(24)),
    LazyLock::new(|| hermite(14)),
];

/// The same for laws that run up within a short way from one end to the other, as beta laws with small shapes do: of functions that are
/// analytic the rule of evenly spaced nodes has more digits than any other of as many.
static CLOSE: [LazyLock<Vec<(f64, f64)>>; 4] = [
    LazyLock::new(panels),
    LazyLock::new(|| even(0.03)),
    LazyLock::new(|| even(0.16)),
    LazyLock::new(|| even(0.43)),
];

/// For a normal scalar: up to degree 7 in each, and products of two monomials are of degree 4.
static EXACT: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| hermite(4));

/// The rule of Gauss and Hermite for the standard normal law, weights and nodes, from the eigenvectors of the matrix of
/// the recursion (Golub & Welsch 1969, doi:10.1090/S0025-5718-69-99647-1).
fn hermite(n: usize) -> Vec<(f64, f64)> {
    let matrix =
        DMatrix::from_fn(
            n,
            n,
            |i, j| {
                if i.abs_diff(j) == 1 { (i.max(j) as f64).sqrt() } else { 0.0 }
            },
        );
    let eigen = matrix.symmetric_eigen();
    let weights = eigen.eigenvectors.row(0).iter().map(|v| v * v).collect::<Vec<_>>();
    weights.into_iter().zip(eigen.eigenvalues.iter().copied()).collect()
}

/// The values of a law of which many are asked, between those at scores that lie close to each other.
fn tabulated(law: &ScalarLaw) -> AtScore<'_> {
    const APART: f64 = 0.004;
    const END: f64 = 12.0;
    let last = (2.0 * END / APART) as usize;
    let values: Vec<f64> = (0..=last).map(|i| law.at_score(i as f64 * APART - END)).collect();
    Box::new(move |z| {
        let at = ((z + END) / APART).clamp(0.0, last as f64);
        let (below, above) = (values[at.floor() as usize], values[at.ceil() as usize]);
        below + (above - below) * (at - at.floor())
    })
}

/// Evenly spaced nodes on [−5.2, 5.2], beyond which a score lies twice in ten million times.
fn even(apart: f64) -> Vec<(f64, f64)> {
    let steps = (5.2 / apart).floor() as i32;
    let density = |z: f64| libm::exp(-0.5 * z * z - crate::normal::LN_ROOT_TAU);
    let scores = (-steps..=steps).map(|i| f64::from(i) * apart);
    scores.map(|z| (apart * density(z), z)).collect()
}

/// A rule with many nodes on [−12, 12], the same in each of its panels.
fn panels() -> Vec<(f64, f64)> {
    const PANELS: usize = 96;
    let half = 12.0 / PANELS as f64;
    let density = |z: f64| libm::exp(-0.5 * z * z) / (2.0 * std::f64::consts::PI).sqrt();
    let nodes = (0..PANELS).flat_map(|i| {
        let middle = -12.0 + (2 * i + 1) as f64 * half;
        crate::gauss_legendre::RULE.iter().flat_map(move |[x, w]| {
            [middle - half * x, middle + half * x].map(|z| (half * w * density(z), z))
        })
    });
    nodes.collect()
}

#[cfg(test)]
mod tests;
