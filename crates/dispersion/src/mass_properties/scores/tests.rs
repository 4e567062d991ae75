//! Expectations over scores against closed forms, integrals and draws.

use super::*;
use nalgebra::SMatrix;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Correlations of any scalars, of which some are independent.
fn correlation_of(
    roots: &[f64],
    is_tied: [bool; 7],
) -> (Correlation, impl Fn(usize, usize) -> f64) {
    let root = SMatrix::<f64, 7, 7>::from_fn(|i, j| {
        if i == j {
            1.0
        } else if is_tied[i] && is_tied[j] {
            roots[7 * i + j]
        } else {
            0.0
        }
    });
    let c = root * root.transpose();
    let coefficient = move |i: usize, j: usize| c[(i, j)] / (c[(i, i)] * c[(j, j)]).sqrt();
    let pairs = (0..7).flat_map(|i| (0..i).map(move |j| (i, j)));
    let pairs: Vec<_> =
        pairs.map(|(i, j)| (i, j, coefficient(i, j))).filter(|p| p.2 != 0.0).collect();
    (Correlation::new(&pairs).unwrap(), coefficient)
}

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
        let (correlation, coefficient) = correlation_of(&roots, is_tied);
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
    each.map(|((a, high, p), (b, wide, q))| (both_above(*a, *b, coefficient) - p * q) * high * wide)
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
        let at =
            |m: &Monomial, x: &[f64; 4]| (0..4).map(|i| x[i].powi(m.powers[i])).product::<f64>();
        let mean =
            |of: &dyn Fn(&[f64; 4]) -> f64| draws.iter().map(of).sum::<f64>() / f64::from(count);
        let (first, second) = (mean(&|x| at(&f, x)), mean(&|x| at(&g, x)));
        let product = |x: &[f64; 4]| (at(&f, x) - first) * (at(&g, x) - second);
        let drawn = mean(&product);
        let error = (mean(&|x| (product(x) - drawn).powi(2)) / f64::from(count)).sqrt();
        let (_, found) = scores.covariance(&f, &g);
        assert!((found - drawn).abs() < 4.0 * error, "{f:?} {g:?}: {found} {drawn} {error}");
    }
}

/// Beta laws that run up within a short way from one end to the other, or that are smooth: where they are hardly correlated, products
/// have the moments of independent scalars; where a coefficient is anything, a pair has the integral over its scores, in which the second
/// conditional one is taken in narrow panels, and among others the same.
#[test]
fn laws_with_short_ways_are_resolved() {
    let rng = &mut ChaCha8Rng::seed_from_u64(9);
    let one = Monomial::default();
    let fine = even(0.01);
    for case in 0..8 {
        let mut law = || {
            let [low, wide, a, b] = [(-1.0, 1.0), (0.3, 2.0), (-1.0, 1.0), (-1.0, 1.0)]
                .map(|(least, most)| rng.random_range(least..most));
            ScalarLaw::beta(low, low + wide, libm::pow(10.0, a), libm::pow(10.0, b)).unwrap()
        };
        let laws = [(); 4].map(|()| law());
        let sign = |rng: &mut ChaCha8Rng| rng.random_range(-0.99..0.99_f64);
        let signs = [(); 4].map(|()| sign(rng));
        for size in [1e-5, 1.0] {
            let tied = |i: usize, j: usize| size * signs[i] * signs[j];
            let pairs: Vec<_> = (0..4)
                .flat_map(|i| (0..i).map(move |j| (i, j)))
                .map(|(i, j)| (i, j, tied(i, j)))
                .collect();
            let correlation = Correlation::new(&pairs).unwrap();
            let scores = Scores {
                laws: laws.iter().collect(),
                correlation: &correlation,
                factor: |x| x,
                known: RefCell::default(),
            };
            // As they stand, in a pair, and beside the others.
            let x = [0, 1, 2, 3].map(|s| one.times(s, 1));
            let (first, second) = (&laws[0], &laws[1]);
            let own = first.deviation() * second.deviation();
            let slope = (1.0 - tied(0, 1) * tied(0, 1)).sqrt();
            let at_first: Vec<_> =
                fine.iter().map(|(w, z)| (*w, *z, first.at_score(*z) - first.mean())).collect();
            let exact: f64 = if size < 1.0 {
                0.0
            } else {
                // E x₂ given z₁ on a grid as fine as z₁ itself is.
                at_first
                    .iter()
                    .step_by(8)
                    .map(|(w, z, x)| {
                        let beside = fine
                            .iter()
                            .step_by(8)
                            .map(|(v, y)| 8.0 * v * second.at_score(tied(0, 1) * z + slope * y));
                        8.0 * w * x * (beside.sum::<f64>() - second.mean())
                    })
                    .sum()
            };
            let (_, found) = scores.covariance(&x[0], &x[1]);
            assert!(
                (found - exact).abs() < 1e-3 * own,
                "{case} {size}: {found} {exact} {own} {laws:?}"
            );
            let (_, beside) = scores.covariance(&x[0].times(2, 1), &x[1].times(3, 1));
            let (together, _) = scores.covariance(&x[0].times(1, 1).times(2, 1), &x[3]);
            if size < 1.0 {
                // Squares of products are products of squares.
                let three = x[0].times(1, 1).times(2, 1);
                for f in [three, three.times(3, 1)] {
                    let square: f64 = laws
                        .iter()
                        .enumerate()
                        .filter(|(s, _)| f.involves(*s))
                        .map(|(_, law)| law.square_moments().0)
                        .product();
                    let mean: f64 = laws
                        .iter()
                        .enumerate()
                        .filter(|(s, _)| f.involves(*s))
                        .map(|(_, law)| law.mean())
                        .product();
                    let (first, variance) = scores.covariance(&f, &f);
                    let allowed = 1e-3 * square;
                    assert!(
                        (variance - (square - mean * mean)).abs() < allowed,
                        "{case}: {variance} {square} {mean} {laws:?}"
                    );
                    assert!((first - mean).abs() < 1e-3 * square.sqrt(), "{case}: {first} {mean}");
                }
            }
            assert!(beside.is_finite() && together.is_finite());
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Of lognormal scalars of any width: among themselves in closed form, as Π x_i^p_i is lognormal with E ln = p·μ and
    /// Var ln = pᵀΣp; and with a normal scalar E Π x_i^p_i n = E Π x_i^p_i (E n + Cov(ln Π x_i^p_i, n)), or no number.
    #[test]
    fn covariances_of_lognormal_scalars_are_right(
        means in prop::array::uniform7(-3.0..3.0_f64),
        ratios in prop::array::uniform7(-3.0..1.5_f64),
        roots in prop::collection::vec(-1.0..1.0_f64, 49),
        is_tied in prop::array::uniform7(any::<bool>()),
        has_normal in any::<bool>(),
    ) {
        let means = means.map(|e| 10_f64.powf(e));
        let ratios = ratios.map(|e| 10_f64.powf(e));
        let laws: Vec<ScalarLaw> = (0..7).map(|i| {
            let (mean, sigma) = (means[i], means[i] * ratios[i]);
            if has_normal && i == 3 { ScalarLaw::normal(mean, sigma) } else { ScalarLaw::lognormal(mean, sigma) }.unwrap()
        }).collect();
        let (correlation, coefficient) = correlation_of(&roots, is_tied);
        let scores = Scores {
            laws: laws.iter().collect(),
            correlation: &correlation,
            factor: |x| x,
            known: RefCell::default(),
        };
        let s = ratios.map(|ratio| (ratio * ratio).ln_1p().sqrt());
        let ln_covariance = |f: &Monomial, g: &Monomial| -> f64 {
            let each = |i: usize, j: usize| f64::from(f.powers[i] * g.powers[j]) * s[i] * s[j] * coefficient(i, j);
            (0..7).map(|i| (0..7).map(|j| each(i, j)).sum::<f64>()).sum()
        };
        let mean = |f: &Monomial| {
            let ln: f64 = (0..7).map(|i| f64::from(f.powers[i]) * (means[i].ln() - 0.5 * s[i] * s[i])).sum();
            (ln + 0.5 * ln_covariance(f, f)).exp()
        };
        let mass = Monomial::default().times(0, 1);
        let all = [mass, mass.times(1, 1).times(2, 1), mass.times(2, 2), mass.times(4, 2), mass.times(5, 2), mass.times(4, 1).times(5, 1)];
        for f in &all {
            for g in &all {
                let (first, found) = scores.covariance(f, g);
                let expected = mean(f) * mean(g) * ln_covariance(f, g).exp_m1();
                let size = mean(f) * mean(g) * (1e-3 + ln_covariance(f, g).abs());
                prop_assert!((first / mean(f) - 1.0).abs() < 1e-11, "{f:?}: {first:e}");
                prop_assert!((found - expected).abs() < 1e-11 * expected.abs() + 1e-12 * size, "{f:?} {g:?}: {found:e} {expected:e}");
            }
            if has_normal {
                let (first, found) = scores.covariance(f, &Monomial::default().times(3, 1));
                let with: f64 = (0..7).map(|i| f64::from(f.powers[i]) * s[i] * coefficient(i, 3)).sum();
                let expected = mean(f) * with * means[3] * ratios[3];
                let wide = (0..7).any(|i| ratios[i] > 0.5);
                let size = mean(f) * means[3] * ratios[3] * (1.0 + with.abs());
                prop_assert!(
                    if found.is_nan() { wide } else { (found - expected).abs() < 0.03 * size && (first / mean(f) - 1.0).abs() < 1e-3 },
                    "{f:?}: {found:e} {expected:e}"
                );
            }
        }
    }
}
