//! Sobol' indices against closed forms, another program, and a plain implementation by influence values.

use std::f64::consts::PI;

use proptest::option::of;
use proptest::prelude::*;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;

/// A function of inputs that are uniform from 0 to 1, and which of them belong to which group.
struct Case {
    inputs: usize,
    groups: Vec<Vec<usize>>,
    output: fn(&[f64]) -> f64,
}

impl Case {
    fn new(inputs: usize, groups: &[&[usize]], output: fn(&[f64]) -> f64) -> Self {
        Self { inputs, groups: groups.iter().map(|group| group.to_vec()).collect(), output }
    }

    /// The outputs of a base run.
    fn run(&self, a: &[f64], b: &[f64]) -> (f64, f64, Vec<f64>) {
        let mixed = self.groups.iter().map(|group| {
            let mut x = a.to_vec();
            group.iter().for_each(|&i| x[i] = b[i]);
            (self.output)(&x)
        });
        ((self.output)(a), (self.output)(b), mixed.collect())
    }

    fn indices(&self, runs: usize, seed: u64) -> SobolIndices {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut draw = || -> Vec<f64> { (0..self.inputs).map(|_| rng.random()).collect() };
        let mut sums = SobolSums::new(self.groups.len()).unwrap();
        for _ in 0..runs {
            let (a, b, mixed) = self.run(&draw(), &draw());
            push(&mut sums, a, b, &mixed);
        }
        sums.finish(Confidence::default()).unwrap()
    }

    /// The share of repetitions in which the intervals of first-order and total index cover the truth, by group.
    fn coverage(&self, runs: usize, repetitions: u64, truth: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let mut covered = vec![[0.0; 2]; truth.len()];
        for seed in 0..repetitions {
            let indices = self.indices(runs, seed);
            for ((group, truth), covered) in indices.groups().iter().zip(truth).zip(&mut covered) {
                for (i, estimate) in both(group).into_iter().enumerate() {
                    covered[i] += f64::from(u8::from(estimate.interval().contains(truth[i])));
                }
            }
        }
        covered.iter().map(|covered| covered.map(|count| count / repetitions as f64)).collect()
    }
}

fn push(sums: &mut SobolSums, a: f64, b: f64, mixed: &[f64]) {
    let mixed: Vec<_> = mixed.iter().map(|y| Some(*y)).collect();
    sums.push(Some(a), Some(b), &mixed).unwrap();
}

fn both(group: &SobolIndex) -> [Estimate; 2] {
    [*group.first().unwrap(), *group.total().unwrap()]
}

fn ishigami(u: &[f64]) -> f64 {
    let [x, y, z] = [u[0], u[1], u[2]].map(|u| (2.0 * u - 1.0) * PI);
    x.sin() + 7.0 * y.sin().powi(2) + 0.1 * z.powi(4) * x.sin()
}

/// First-order and total index of its three inputs (Ishigami & Homma 1990, doi:10.1109/ISUMA.1990.151285).
fn of_ishigami() -> [[f64; 2]; 3] {
    let v1 = 0.5 * (1.0 + 0.1 * PI.powi(4) / 5.0).powi(2);
    let v2 = 49.0 / 8.0;
    let v13 = 0.01 * PI.powi(8) * 8.0 / 225.0;
    let v = v1 + v2 + v13;
    [[v1 / v, (v1 + v13) / v], [v2 / v, v2 / v], [0.0, v13 / v]]
}

const G: [f64; 8] = [0.0, 1.0, 4.5, 9.0, 99.0, 99.0, 99.0, 99.0];

/// The g-function of Saltelli & Sobol' (1995, doi:10.1016/0951-8320(95)00099-2).
fn g_function(u: &[f64]) -> f64 {
    u.iter().zip(G).map(|(u, a)| ((4.0 * u - 2.0).abs() + a) / (1.0 + a)).product()
}

fn of_g_function(groups: &[Vec<usize>]) -> Vec<[f64; 2]> {
    let product = |keep: &dyn Fn(usize) -> bool| {
        let factors = (0..8).filter(|i| keep(*i)).map(|i| 1.0 + 1.0 / (3.0 * (1.0 + G[i]).powi(2)));
        factors.product::<f64>() - 1.0
    };
    let all = product(&|_| true);
    let of = |group: &Vec<usize>| {
        let (own, rest) = (product(&|i| group.contains(&i)), product(&|i| !group.contains(&i)));
        [own / all, 1.0 - rest / all]
    };
    groups.iter().map(of).collect()
}

/// Asserts shares about 95 %: within four standard deviations, and a slack below.
fn assert_covers(what: &str, covered: &[[f64; 2]], repetitions: u64, slack: f64) {
    let four_sigma = 4.0 * (0.95 * 0.05 / repetitions as f64).sqrt();
    println!("{what}: {covered:?}");
    for share in covered.iter().flatten() {
        assert!(*share > 0.95 - four_sigma - slack, "{what}: {covered:?}");
    }
}

#[test]
fn of_the_function_of_ishigami() {
    let case = Case::new(3, &[&[0], &[1], &[2]], ishigami);
    for (runs, slack) in [(100, 0.03), (1000, 0.01)] {
        assert_covers("Ishigami", &case.coverage(runs, 400, &of_ishigami()), 400, slack);
    }
    let indices = case.indices(100_000, 1);
    for (group, truth) in indices.groups().iter().zip(of_ishigami()) {
        for (estimate, truth) in both(group).iter().zip(truth) {
            assert!((estimate.value() - truth).abs() < 0.01, "{estimate:?} {truth}");
            assert!(estimate.interval().width() < 0.025, "{estimate:?}");
        }
    }
    assert!(
        (indices.variance() / 13.8446 - 1.0).abs() < 0.02 && (indices.mean() - 3.5).abs() < 0.05
    );
}

#[test]
fn of_groups_of_the_g_function() {
    for groups in
        [vec![vec![0, 4], vec![1, 5], vec![2, 3], vec![6, 7]], vec![vec![0], vec![1, 2, 3]]]
    {
        let truth = of_g_function(&groups);
        let case = Case { inputs: 8, groups, output: g_function };
        assert_covers("g", &case.coverage(500, 400, &truth), 400, 0.01);
    }
}

#[test]
fn of_sums_and_of_products() {
    let sum = Case::new(3, &[&[0], &[1], &[2]], |u| u[0] + 2.0 * u[1] + 10.0 * u[2]);
    let truth = [1.0, 4.0, 100.0].map(|v| [v / 105.0; 2]);
    assert_covers("sum", &sum.coverage(300, 400, &truth), 400, 0.01);
    let product = Case::new(2, &[&[0], &[1]], |u| (u[0] - 0.5) * (u[1] - 0.5));
    assert_covers("product", &product.coverage(300, 400, &[[0.0, 1.0]; 2]), 400, 0.01);
    let near = Case::new(2, &[&[0], &[1]], |u| u[0] + 0.01 * u[1]);
    let share = 1.0 / 1.0001;
    let truth = [[share; 2], [1.0 - share; 2]];
    assert_covers("near 0 and 1", &near.coverage(300, 400, &truth), 400, 0.01);
}

/// Whether a requirement was failed: a product of probabilities has both indices in closed form.
#[test]
fn of_indicators() {
    // Failed if both inputs are above 1 − √p: first (p√p − p²)/(p − p²), total by symmetry 1 − first.
    let truth = |p: f64| {
        let first = (p.powf(1.5) - p * p) / (p - p * p);
        [[first, 1.0 - first]; 2]
    };
    let fail = |limit: f64, u: &[f64]| f64::from(u8::from(u[0] > limit && u[1] > limit));
    assert!(fail(0.5, &[0.6, 0.6]) == 1.0);
    let often = Case::new(2, &[&[0], &[1]], |u| f64::from(u8::from(u[0] > 0.5 && u[1] > 0.5)));
    assert_covers("often", &often.coverage(400, 400, &truth(0.25)), 400, 0.01);
    let seldom = Case::new(2, &[&[0], &[1]], |u| f64::from(u8::from(u[0] > 0.9 && u[1] > 0.9)));
    assert_covers("seldom", &seldom.coverage(2000, 400, &truth(0.01)), 400, 0.10);
}

/// A fault that multiplies a number, an addition of one that is seldom there, and heavy tails: whoever looks at the indices is told. Where
/// nobody is told, they cover what they should.
#[test]
fn few_runs_that_carry_an_index_are_told() {
    /// A normal number from two uniform ones.
    fn normal(u: f64, v: f64) -> f64 {
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }
    fn fault<const PERCENT: u32>(u: &[f64]) -> f64 {
        if u[2] < f64::from(PERCENT) / 100.0 { normal(u[0], u[1]) } else { 0.0 }
    }
    let groups: &[&[usize]] = &[&[0, 1], &[2]];
    let told = |output, runs| {
        let case = Case::new(3, groups, output);
        (0..40).filter(|seed| case.indices(runs, *seed).is_of_few()).count()
    };
    // With p of the runs faulty, the number alone explains p of the variance, and the fault nothing.
    assert_eq!(told(fault::<5>, 1000), 40);
    // Both of a pair of runs are faulty in 3 pairs of 8,000.
    let of_pairs = told(fault::<2>, 8000);
    assert!(of_pairs >= 24, "{of_pairs}");
    assert_eq!(told(|u| 0.01 * normal(u[0], u[1]) + f64::from(u8::from(u[2] < 0.003)), 1000), 40);
    assert_eq!(told(|u| (normal(u[0], u[1]) + 3.0 * u[2]).exp(), 100), 40);
    assert_eq!(told(|u| normal(u[0], u[1]) + u[2], 100), 0);
    assert!(told(fault::<50>, 400) <= 2);
    let covered = Case::new(3, groups, fault::<30>).coverage(1000, 400, &[[0.3, 1.0], [0.0, 0.7]]);
    assert_covers("a frequent fault", &covered, 400, 0.02);
}

/// Whether something happens that is as rare as can be: whoever looks at the indices is told, and where nobody is told they cover as the documentation says.
#[test]
fn seldom_events_are_told() {
    for (limit, runs, told) in [
        (0.9, 200, true),
        (0.9, 1000, true),
        (0.97, 1000, true),
        (0.8, 4000, false),
        (0.5, 400, false),
    ] {
        let case = |inputs: &[f64]| f64::from(u8::from(inputs[0] > limit && inputs[1] > limit));
        for seed in 0..20 {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let mut draw = || -> [f64; 2] { [rng.random(), rng.random()] };
            let mut sums = SobolSums::new(2).unwrap();
            let mut happened = 0;
            for _ in 0..runs {
                let (a, b) = (draw(), draw());
                let [of_a, of_b] = [case(&a), case(&b)];
                happened += u64::from(of_a > 0.0) + u64::from(of_b > 0.0);
                push(&mut sums, of_a, of_b, &[case(&[b[0], a[1]]), case(&[a[0], b[1]])]);
            }
            match sums.finish(Confidence::default()) {
                Ok(indices) => {
                    // Of a flag, its kurtosis in closed form.
                    let (n, p) = (2.0 * runs as f64, happened as f64 / (2.0 * runs as f64));
                    let effective = n * p * (1.0 - p) / (1.0 - 3.0 * p * (1.0 - p));
                    let found = indices.effective_runs();
                    assert!(
                        (found - effective).abs() <= 0.01 * effective,
                        "{found} is not {effective}"
                    );
                    assert_eq!(indices.is_of_few(), told, "{limit} {runs}: {happened}");
                }
                Err(error) => assert_eq!((error, happened), (StatisticsError::Constant, 0)),
            }
        }
    }
    // Numbers that all differ, whole numbers of which most are 0, and a rare one that comes first.
    let smooth = Case::new(2, &[&[0], &[1]], |u| u[0] + u[1]).indices(100, 1);
    assert!((70.0..100.0).contains(&smooth.effective_runs()) && !smooth.is_of_few());
    let mut sums = SobolSums::new(1).unwrap();
    for i in 0..1000 {
        let count = |i: u32| f64::from(if i.is_multiple_of(300) { i / 300 + 1 } else { 0 });
        push(&mut sums, count(i), 0.0, &[count(i)]);
    }
    let counts = sums.finish(Confidence::default()).unwrap();
    assert!((2.0..4.0).contains(&counts.effective_runs()) && counts.is_of_few());
}

/// Influence values in place of gradients and covariances: two passes over all runs.
struct Plain {
    value: f64,
    influence: Vec<f64>,
}

impl Plain {
    fn correlation(u: &[f64], v: &[f64]) -> Self {
        let n = u.len() as f64;
        let mean = u.iter().chain(v).sum::<f64>() / (2.0 * n);
        let pairs: Vec<_> = u.iter().zip(v).map(|(u, v)| (u - mean, v - mean)).collect();
        let variance = pairs.iter().map(|(u, v)| (u * u + v * v) / 2.0).sum::<f64>() / n;
        let value = pairs.iter().map(|(u, v)| u * v).sum::<f64>() / n / variance;
        let of = |(u, v): &(f64, f64)| (u * v - value * (u * u + v * v) / 2.0) / variance;
        Self { value, influence: pairs.iter().map(of).collect() }
    }

    fn less(&self, other: &Self, weight: f64) -> Self {
        let influence = self
            .influence
            .iter()
            .zip(&other.influence)
            .map(|(own, of)| own - weight * of)
            .collect();
        Self { value: self.value - weight * other.value, influence }
    }

    /// The bounds of the interval by the hyperbolic functions of `std`.
    fn bounds(&self) -> [f64; 2] {
        let n = self.influence.len() as f64;
        let error = (self.influence.iter().map(|x| x * x).sum::<f64>() / (n - 1.0) / n).sqrt();
        let half = law::students_t(0.025, n - 1.0) * error / (1.0 - self.value.powi(2));
        [-half, half].map(|half| (self.value.atanh() + half).tanh())
    }
}

/// On the same outputs as salib 0.3.0, `estimate_janon` of the pairs (a, b), (b, c), (a, c). It is no dependency, for
/// it brings other versions of nalgebra and rand.
#[test]
fn agree_with_salib_and_with_influence_values() {
    let case = Case::new(3, &[&[0], &[1], &[2]], ishigami);
    let u = |i: u32, prime: f64| (f64::from(i) * prime.sqrt()).fract();
    let mut sums = SobolSums::new(3).unwrap();
    let (mut a, mut b, mut mixed) = (vec![], vec![], vec![vec![]; 3]);
    for i in 1..=256 {
        let (of_a, of_b, of_mixed) = case.run(
            &[2.0, 3.0, 5.0].map(|prime| u(i, prime)),
            &[7.0, 11.0, 13.0].map(|prime| u(i, prime)),
        );
        push(&mut sums, of_a, of_b, &of_mixed);
        a.push(of_a);
        b.push(of_b);
        mixed.iter_mut().zip(of_mixed).for_each(|(all, y)| all.push(y));
    }
    let near = |found: f64, expected: f64| {
        assert!((found - expected).abs() < 1e-11, "{found} is not {expected}");
    };
    let indices = sums.finish(Confidence::default()).unwrap();
    let zero = Plain::correlation(&a, &b);
    near(zero.value, -0.006627865790358551);
    let salib = [
        [0.2628815537378724, 0.4511557378912818],
        [0.4754048265932193, 0.43807986577558544],
        [-0.034677366859817586, 0.24515596813973106],
    ];
    for ((group, c), [of_b, of_a]) in indices.groups().iter().zip(&mixed).zip(salib) {
        let [first, total] = both(group);
        let (own, rest) = (Plain::correlation(&b, c), Plain::correlation(&a, c));
        near(own.value, of_b);
        near(1.0 - rest.value, of_a);
        near(total.value(), of_a);
        let weight = |first: f64| rest.value * (1.0 - first * first);
        let once = own.less(&zero, weight(own.value));
        let own = own.less(&zero, weight(once.value));
        near(first.value(), own.value);
        near(first.interval().lower(), own.bounds()[0]);
        near(first.interval().upper(), own.bounds()[1]);
        near(total.interval().lower(), 1.0 - rest.bounds()[1]);
        near(total.interval().upper(), 1.0 - rest.bounds()[0]);
    }
}

/// What moves nothing is exactly 0, what moves all exactly 1.
#[test]
fn of_inputs_that_move_nothing() {
    let case = Case::new(2, &[&[1], &[0]], |u| (3.0 * u[0]).sin());
    for runs in [2, 5, 100] {
        let indices = case.indices(runs, 7);
        let [first, total] = both(&indices.groups()[0]);
        assert_eq!((first.value(), total.value(), total.interval().width()), (0.0, 0.0, 0.0));
        assert_eq!(first.interval().width(), 0.0);
        let [first, total] = both(&indices.groups()[1]);
        assert!((first.value() - 1.0).abs() < 1e-9 && total.value() > 0.5, "{first:?} {total:?}");
    }
    // A control variate: a group of little effect has an estimate near 0, where r(b, c) is ± 0.1.
    let small = Case::new(2, &[&[0], &[1]], |u| 0.01 * u[0] + u[1]);
    for seed in 0..20 {
        let first = both(&small.indices(100, seed).groups()[0])[0];
        assert!(first.value().abs() < 0.005 && first.interval().width() < 0.02, "{first:?}");
    }
}

#[test]
fn what_cannot_be_answered_is_refused() {
    for groups in [0, MAX_GROUPS + 1, usize::MAX] {
        assert!(matches!(SobolSums::new(groups), Err(StatisticsError::GroupCount { .. })));
    }
    let mut sums = SobolSums::new(2).unwrap();
    let refused = StatisticsError::GroupOutputs { outputs: 1, groups: 2 };
    assert_eq!(sums.push(Some(1.0), Some(1.0), &[None]), Err(refused));
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for at in 0..4 {
            let mut y = [Some(1.0); 4];
            y[at] = Some(bad);
            assert!(matches!(
                sums.push(y[0], y[1], &y[2..]),
                Err(StatisticsError::NotFinite { index: 0, .. })
            ));
        }
    }
    let finish = |sums: &SobolSums| sums.finish(Confidence::default());
    assert_eq!(sums.runs(), 0);
    assert_eq!(finish(&sums), Err(StatisticsError::TooFew { n: 0, required: 2 }));
    for _ in 0..3 {
        sums.push(Some(0.1), Some(0.1), &[Some(0.1), None]).unwrap();
    }
    assert_eq!(finish(&sums), Err(StatisticsError::Constant));
    // One that varies, where the outputs of another group are constant or missing.
    sums.push(Some(0.1), None, &[Some(3.0), Some(5.0)]).unwrap();
    sums.push(None, Some(0.7), &[Some(3.0), Some(5.0)]).unwrap();
    let indices = finish(&sums).unwrap();
    let numbers: Vec<_> = indices.groups().iter().map(|g| (g.runs(), g.left_out())).collect();
    assert_eq!((indices.runs(), numbers), (5, vec![(3, 2), (0, 5)]));
    assert!(
        indices.groups().iter().all(|group| group.first().is_none() && group.total().is_none())
    );
    let mut sums = SobolSums::new(1).unwrap();
    push(&mut sums, f64::MAX, f64::MIN, &[0.0]);
    push(&mut sums, f64::MIN, f64::MAX, &[0.0]);
    assert!(matches!(finish(&sums), Err(StatisticsError::TooSpread { .. })));
}

/// A first deviation that is tiny beside the others sets no scale for them: any order gives the same to rounding.
#[test]
fn deviations_of_any_size_may_come_first() {
    let mut runs = outputs(11, 40);
    runs.insert(0, [0.0; 4]);
    // The others are up to 2⁶⁰ times as large, which leaves the scale, and the last is larger.
    runs.insert(1, [2_f64.powi(-50), 0.0, 0.0, 0.0]);
    runs.push([3000.0, 100.0, 2000.0, 50.0]);
    let of = |runs: &mut dyn Iterator<Item = &[f64; 4]>| {
        let mut sums = SobolSums::new(2).unwrap();
        runs.for_each(|y| push(&mut sums, y[0], y[1], &y[2..]));
        sums.finish(Confidence::default()).unwrap()
    };
    let (forward, backward) = (of(&mut runs.iter()), of(&mut runs.iter().rev()));
    let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
    near(forward.variance(), backward.variance());
    near(forward.mean(), backward.mean());
    for (a, b) in forward.groups().iter().zip(backward.groups()) {
        for (a, b) in both(a).iter().zip(both(b)) {
            near(a.value(), b.value());
            near(a.interval().lower(), b.interval().lower());
            near(a.interval().upper(), b.interval().upper());
        }
    }
}

/// What is missing is left out of its own group alone.
#[test]
fn missing_outputs_leave_the_rest_as_it_is() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let (mut holed, mut without) = (SobolSums::new(2).unwrap(), SobolSums::new(2).unwrap());
    for i in 0..200 {
        let mut y: Vec<Option<f64>> = (0..4).map(|_| Some(rng.random())).collect();
        let missing = i % 10;
        if missing < 4 {
            y[missing] = None;
        }
        holed.push(y[0], y[1], &y[2..]).unwrap();
        if missing != 0 && missing != 1 && missing != 2 {
            without.push(y[0], y[1], &y[2..]).unwrap();
        }
    }
    let finish = |sums: &SobolSums| sums.finish(Confidence::default()).unwrap();
    let (holed, without) = (finish(&holed), finish(&without));
    assert_eq!(holed.groups()[0].left_out(), 60);
    let [found, expected] = [&holed, &without].map(|indices| both(&indices.groups()[0]));
    for (found, expected) in found.iter().zip(expected) {
        assert!((found.value() - expected.value()).abs() < 1e-14);
        assert!((found.interval().upper() - expected.interval().upper()).abs() < 1e-14);
    }
}

fn outputs(seed: u64, runs: usize) -> Vec<[f64; 4]> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let draw = |rng: &mut dyn Rng| f64::from(rng.next_u32() >> 12) / 1024.0;
    (0..runs).map(|_| [(); 4].map(|()| draw(&mut rng))).collect()
}

proptest! {
    /// Outputs of another unit and another zero have the same indices: to the bit for powers of two, and with a mean
    /// of a billion deviations as far as the outputs hold digits.
    #[test]
    fn units_and_zeros_do_not_matter(
        seed: u64, runs in 3..30_usize, exponent in -900..900_i32, shift in -1e9..1e9_f64,
    ) {
        let outputs = outputs(seed, runs);
        let of = |map: &dyn Fn(f64) -> f64| {
            let mut sums = SobolSums::new(2).unwrap();
            outputs.iter().for_each(|y| push(&mut sums, map(y[0]), map(y[1]), &[map(y[2]), map(y[3])]));
            sums.finish(Confidence::default()).unwrap()
        };
        let plain = of(&|y| y);
        let scaled = of(&|y| y * 2_f64.powi(exponent));
        prop_assert_eq!(plain.groups(), scaled.groups());
        // Whole numbers of 1/1024 up to 1024, and shifts that keep them.
        let shift = shift.round();
        let shifted = of(&|y| y + shift);
        prop_assert_eq!(plain.groups(), shifted.groups());
        prop_assert_eq!(plain.variance(), shifted.variance());
    }

    /// No outputs make numbers that are none.
    #[test]
    fn every_output_gives_numbers_or_a_refusal(
        outputs in prop::collection::vec((of(any::<f64>()), of(-2.0..2.0_f64), of(Just(1.0)), of(any::<f64>())), 0..12),
        level in 0.01..0.9999_f64,
    ) {
        let mut sums = SobolSums::new(2).unwrap();
        for y in outputs {
            let y = [y.0, y.1, y.2, y.3];
            let _ = sums.push(y[0], y[1], &y[2..]);
            let _ = sums.push(y[2], y[1], &y[..2]);
        }
        if let Ok(indices) = sums.finish(Confidence::new(level).unwrap()) {
            prop_assert!(indices.variance() >= 0.0 && indices.mean().is_finite());
            for group in indices.groups() {
                for estimate in [group.first(), group.total()].into_iter().flatten() {
                    let (value, interval) = (estimate.value(), estimate.interval());
                    prop_assert!(value.is_finite() && interval.contains(value), "{:?}", estimate);
                }
            }
        }
    }
}
