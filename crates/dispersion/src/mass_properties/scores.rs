//! Expectations over scalar laws that are drawn jointly, by quadrature over their scores.

use nalgebra::DMatrix;
use std::{cell::RefCell, collections::HashMap, rc::Rc, sync::LazyLock};

use super::steps::{Over, Steps};
use crate::{Correlation, ScalarLaw};

/// How many scalars a joint law has at most: mass, three of the centre, three of the shape.
pub(super) const SCALARS: usize = 7;

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
}

impl<F: Fn(f64) -> f64> Scores<'_, F> {
    /// E f and Cov(f, g).
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
        let known = self.known.borrow().get(block).cloned();
        let nodes = known.unwrap_or_else(|| {
            let nodes = Rc::new(self.nodes(block));
            self.known.borrow_mut().insert(block.to_vec(), Rc::clone(&nodes));
            nodes
        });
        let parts = [f, g].map(|monomial| monomial.of(block));
        if let Some(pair) = nodes.pairs.borrow().get(&parts) {
            return *pair;
        }
        let [f, g] = parts.map(|monomial| self.at_nodes(&nodes, block, monomial));
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
        let pair = Pair { first, second, product, covariance };
        nodes.pairs.borrow_mut().insert(parts, pair);
        pair
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

    /// Weights and values of the scalars of a block.
    ///
    /// Of normal scalars the monomials are polynomials, and with the scores of these last, which the others do not depend on, a few nodes are
    /// exact for them. The first scalar may be taken by its factor. Laws of single values stand before all others.
    fn nodes(&self, block: &[usize]) -> Nodes {
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
            if i < many { &RULES[block.len().min(RULES.len()) - 1] } else { &EXACT }
        };
        let pairs: Vec<(usize, usize, f64)> = (0..block.len())
            .flat_map(|i| (0..i).map(move |j| (i, j)))
            .map(|(i, j)| (i, j, self.correlation.coefficient(block[order[i]], block[order[j]])))
            .filter(|(_, _, coefficient)| *coefficient != 0.0)
            .collect();
        // Of correlations a part is correlations, too.
        let correlation = Correlation::new(&pairs).unwrap_or_default();
        if atoms.iter().any(Option::is_some) {
            let over = order.iter().enumerate().map(|(i, &at)| match atoms[at].take() {
                Some(atoms) => Over::Values(atoms),
                None => Over::Rule(self.laws[block[at]], rule(i)),
            });
            let (weights, values) = Steps::new(&correlation, over.collect(), &order).nodes();
            return Nodes::new(weights, values);
        }
        let count = (0..block.len()).map(|i| rule(i).len()).product();
        let mut nodes =
            Nodes::new(Vec::with_capacity(count), Vec::with_capacity(count * block.len()));
        let mut scores = vec![0.0; block.len()];
        for node in 0..count {
            let (mut weight, mut rest) = (1.0, node);
            for (i, score) in scores.iter_mut().enumerate() {
                let rule = rule(i);
                let (w, z) = rule[rest % rule.len()];
                (weight, *score, rest) = (weight * w, z, rest / rule.len());
            }
            correlation.mix(&mut scores);
            let start = nodes.values.len();
            nodes.values.resize(start + block.len(), 0.0);
            for (z, &at) in scores.iter().zip(&order) {
                nodes.values[start + at] = self.laws[block[at]].at_score(*z);
            }
            nodes.weights.push(weight);
        }
        nodes
    }
}

/// The rules for each of one scalar, of two, of three and of more.
static RULES: [LazyLock<Vec<(f64, f64)>>; 4] = [
    // Laws with corners want many nodes.
    LazyLock::new(panels),
    LazyLock::new(|| hermite(48)),
    LazyLock::new(|| hermite(24)),
    LazyLock::new(|| hermite(14)),
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
mod tests {
    use super::*;
    use nalgebra::SMatrix;
    use proptest::prelude::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    /// E Π x_i over the listed scalars (Isserlis 1918, doi:10.1093/biomet/12.1-2.134).
    fn product(of: &[usize], mean: &[f64; 7], c: &SMatrix<f64, 7, 7>) -> f64 {
        let Some((&first, rest)) = of.split_first() else { return 1.0 };
        let pairs = rest.iter().enumerate().map(|(at, &other)| {
            let left = [&rest[..at], &rest[at + 1..]].concat();
            c[(first, other)] * product(&left, mean, c)
        });
        mean[first] * product(rest, mean, c) + pairs.sum::<f64>()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        /// Of normal scalars, wide or narrow, with any correlations, against the closed form: all that the moments of a joint law are made of,
        /// in any order of the scalars.
        #[test]
        fn covariances_of_normal_scalars_are_exact(
            means in prop::array::uniform7(0.5..2.0_f64),
            deviations in prop::array::uniform7(-3.0..-0.5_f64),
            roots in prop::collection::vec(-1.0..1.0_f64, 49),
            is_tied in prop::array::uniform7(any::<bool>()),
        ) {
            let deviations = deviations.map(|e| 10_f64.powf(e));
            let laws: Vec<ScalarLaw> = means.iter().zip(deviations).map(|(m, s)| ScalarLaw::normal(*m, s).unwrap()).collect();
            let root = SMatrix::<f64, 7, 7>::from_fn(|i, j| {
                if i == j { 1.0 } else if is_tied[i] && is_tied[j] { roots[7 * i + j] } else { 0.0 }
            });
            let c = root * root.transpose();
            let coefficient = |i: usize, j: usize| c[(i, j)] / (c[(i, i)] * c[(j, j)]).sqrt();
            let pairs = (0..7).flat_map(|i| (0..i).map(move |j| (i, j)));
            let pairs: Vec<_> = pairs.map(|(i, j)| (i, j, coefficient(i, j))).filter(|p| p.2 != 0.0).collect();
            let correlation = Correlation::new(&pairs).unwrap();
            let scores = Scores {
                laws: laws.iter().collect(),
                correlation: &correlation,
                factor: |x| x,
                known: RefCell::default(),
            };
            let covariance = SMatrix::<f64, 7, 7>::from_fn(|i, j| coefficient(i, j) * deviations[i] * deviations[j]);
            let one = Monomial::default();
            let mass = one.times(0, 1);
            let all = [
                (mass, vec![0]),
                (one.times(2, 1), vec![2]),
                (mass.times(1, 1).times(3, 1), vec![0, 1, 3]),
                (mass.times(2, 2), vec![0, 2, 2]),
                (mass.times(4, 2), vec![0, 4, 4]),
                (one.times(6, 2), vec![6, 6]),
            ];
            let mean = |of: &[usize]| product(of, &means, &covariance);
            let difference = |f: &[usize], g: &[usize]| mean(&[f, g].concat()) - mean(f) * mean(g);
            for (f, of_f) in &all {
                for (g, of_g) in &all {
                    let (first, found) = scores.covariance(f, g);
                    prop_assert!((first / mean(of_f) - 1.0).abs() < 1e-12, "{of_f:?}");
                    // The closed form is a difference of expectations.
                    let size = (difference(of_f, of_f) * difference(of_g, of_g)).sqrt();
                    let allowed = 1e-10 * size + 1e-13 * (mean(of_f) * mean(of_g)).abs();
                    let gap = found - difference(of_f, of_g);
                    prop_assert!(gap.abs() < allowed, "{of_f:?} {of_g:?}: {gap:e} {allowed:e}");
                }
            }
        }
    }

    /// E 1{z₁ > a, z₂ > b} of standard normal scores (Plackett 1954, doi:10.1093/biomet/41.3-4.351): Φ(−a)Φ(−b) and the integral of their
    /// density over the coefficients up to theirs, by Simpson's rule in its angle.
    fn both_above(a: f64, b: f64, coefficient: f64) -> f64 {
        const STEPS: usize = 2000;
        let end = coefficient.asin();
        let at = |i: usize| {
            let (s, c) = (end * i as f64 / STEPS as f64).sin_cos();
            (-0.5 * (a * a - 2.0 * s * a * b + b * b) / (c * c)).exp()
        };
        let weight = |i: usize| if i == 0 || i == STEPS { 1.0 } else { (2 + 2 * (i % 2)) as f64 };
        let sum: f64 = (0..=STEPS).map(|i| weight(i) * at(i)).sum();
        let independent = crate::normal::above(a) * crate::normal::above(b);
        independent + sum * end / (3 * STEPS) as f64 / std::f64::consts::TAU
    }

    /// A random law of single values: few or many, rare or frequent.
    fn stepped(rng: &mut ChaCha8Rng, most: usize) -> ScalarLaw {
        if rng.random::<f64>() < 0.4 {
            return ScalarLaw::bernoulli(10_f64.powf(rng.random_range(-3.0..-0.01))).unwrap();
        }
        let count = rng.random_range(1..most);
        let values: Vec<f64> = (0..count).map(|_| rng.random_range(-1.0_f64..3.0)).collect();
        ScalarLaw::samples(&values.iter().map(|x| (4.0 * x).round()).collect::<Vec<_>>()).unwrap()
    }

    /// Σ P(x₁ > u, x₂ > v) over the steps of both, and as much for the means: exact but for rounding.
    fn exact_covariance(laws: [&ScalarLaw; 2], coefficient: f64) -> f64 {
        let [first, second] = laws.map(|law| {
            let atoms = law.atoms().unwrap();
            let mut above = 1.0;
            let step = |pair: &[(f64, f64)]| {
                above -= pair[0].1;
                (-crate::normal::score(above), pair[1].0 - pair[0].0, above)
            };
            atoms.windows(2).map(step).collect::<Vec<_>>()
        });
        let each = first.iter().flat_map(|a| second.iter().map(move |b| (a, b)));
        each.map(|((a, high, p), (b, wide, q))| {
            (both_above(*a, *b, coefficient) - p * q) * high * wide
        })
        .sum()
    }

    /// Laws of single values: alone exact, in pairs against the integral of Plackett, and the same of pairs among three, with coefficients up to
    /// the ends.
    #[test]
    fn laws_of_single_values_are_exact() {
        let rng = &mut ChaCha8Rng::seed_from_u64(7);
        let one = Monomial::default();
        for case in 0..60 {
            let laws = [(); 3].map(|()| stepped(rng, 12));
            // Of a law with its own mean as a fourth: normal, and the last in the order.
            let normal = ScalarLaw::normal(1.0, 0.1).unwrap();
            let signs: [f64; 3] = [(); 3].map(|()| rng.random_range(-1.0..1.0));
            let tied = |i: usize, j: usize| (i, j, 0.995 * signs[i] * signs[j]);
            let correlation = Correlation::new(&[tied(0, 1), tied(0, 2), tied(1, 2)]).unwrap();
            let [a, b, c] = &laws;
            let scores = Scores {
                laws: vec![a, b, c, &normal],
                correlation: &correlation,
                factor: |x| x,
                known: RefCell::default(),
            };
            let x = [0, 1, 2].map(|s| one.times(s, 1));
            for (law, x) in laws.iter().zip(&x) {
                let (mean, variance) = scores.covariance(x, x);
                let size = law.reach(1.0).max(1.0);
                assert!((mean - law.mean()).abs() < 1e-13 * size, "{case} {law:?}: {mean}");
                assert!(
                    (variance.max(0.0).sqrt() - law.deviation()).abs() < 1e-7 * size,
                    "{case} {law:?}"
                );
            }
            for (i, j) in [(0, 1), (0, 2), (1, 2)] {
                let exact = exact_covariance([&laws[i], &laws[j]], tied(i, j).2);
                let (_, found) = scores.covariance(&x[i], &x[j]);
                let size = laws[i].deviation() * laws[j].deviation();
                assert!(
                    (found - exact).abs() <= 1e-5 * size + 1e-14,
                    "{case} {i} {j}: {found} {exact} {size}"
                );
                // All three at once: E x_i x_j is the first.
                let k = 3 - i - j;
                let (product, _) = scores.covariance(&x[i].times(j, 1), &x[k]);
                let gap = product - exact - laws[i].mean() * laws[j].mean();
                assert!(gap.abs() <= 1e-3 * (size + product.abs()), "{case} {i} {j}: {gap} {size}");
            }
        }
    }

    /// Many samples that go with a normal scalar and a lognormal one: as if they were drawn.
    #[test]
    fn many_samples_go_with_other_scalars() {
        let rng = &mut ChaCha8Rng::seed_from_u64(8);
        let values: Vec<f64> = (0..3000).map(|_| rng.random::<f64>().powi(3)).collect();
        let laws = [
            ScalarLaw::lognormal(2.0, 0.7).unwrap(),
            ScalarLaw::samples(&values).unwrap(),
            ScalarLaw::normal(1.0, 0.3).unwrap(),
            ScalarLaw::samples(&values[..40]).unwrap(),
        ];
        let correlation =
            Correlation::new(&[(0, 1, 0.6), (1, 2, -0.5), (0, 2, 0.1), (1, 3, 0.5)]).unwrap();
        let scores = Scores {
            laws: laws.iter().collect(),
            correlation: &correlation,
            factor: |x| x,
            known: RefCell::default(),
        };
        let one = Monomial::default();
        let x = [0, 1, 2, 3].map(|s| one.times(s, 1));
        let pairs = [
            (x[0], x[1]),
            (x[0].times(1, 1), x[2]),
            (x[1].times(3, 1), x[0]),
            (x[1], x[1].times(3, 2)),
        ];
        let count = 400_000;
        let draws: Vec<[f64; 4]> = (0..count)
            .map(|_| {
                let mut z = [(); 4].map(|()| StandardNormal.sample(rng));
                correlation.mix(&mut z);
                std::array::from_fn(|i| laws[i].at_score(z[i]))
            })
            .collect();
        for (f, g) in pairs {
            let at = |m: &Monomial, x: &[f64; 4]| {
                (0..4).map(|i| x[i].powi(m.powers[i])).product::<f64>()
            };
            let mean = |of: &dyn Fn(&[f64; 4]) -> f64| {
                draws.iter().map(of).sum::<f64>() / f64::from(count)
            };
            let (first, second) = (mean(&|x| at(&f, x)), mean(&|x| at(&g, x)));
            let product = |x: &[f64; 4]| (at(&f, x) - first) * (at(&g, x) - second);
            let drawn = mean(&product);
            let error = (mean(&|x| (product(x) - drawn).powi(2)) / f64::from(count)).sqrt();
            let (_, found) = scores.covariance(&f, &g);
            assert!((found - drawn).abs() < 4.0 * error, "{f:?} {g:?}: {found} {drawn} {error}");
        }
    }
}
