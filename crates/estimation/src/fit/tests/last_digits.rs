//! Tables that differ by rounding alone: in other units, in another order, with other last digits.

use super::*;

/// Hard tables: few samples, wide axes, roots next to one another, so that up to all names are in doubt. Every fourth turns about
/// one axis alone, and has the other products zero.
fn hard_table(seed: u64) -> Vec<Inertia> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let count = rng.random_range(13..60);
    let apart = [rng.random_range(0.0..0.2), rng.random_range(0.0..0.5)];
    let roots = [1.0, 1.0 + apart[0], 1.0 + apart[1]].map(|root| 30.0 * root);
    let deviations = [0; 3].map(|_| rng.random_range(0.5..9.0));
    let turn = [0; 3].map(|_| rng.random_range(0.1..0.9));
    if !seed.is_multiple_of(4) {
        let mean = any_attitude(&mut rng);
        return draws(&law(roots, deviations, mean, turn), count, seed);
    }
    let mut one = || {
        let [z, a, b] = [0, 1, 2].map(|i| (roots[i] + deviations[i] * three(&mut rng)[i]).powi(2));
        let (sin, cos) = libm::sincos(turn[2] * three(&mut rng)[0]);
        let (aa, bb) = (a * cos * cos + b * sin * sin, a * sin * sin + b * cos * cos);
        let rows = [
            [bb + z, (b - a) * sin * cos, 0.0],
            [(b - a) * sin * cos, aa + z, 0.0],
            [0.0, 0.0, a + b],
        ];
        Inertia::new(Matrix3::from(rows)).unwrap()
    };
    (0..count).map(|_| one()).collect()
}

/// The same samples, times a factor, to rounding and perhaps backwards.
fn again(samples: &[Inertia], factor: f64, backwards: bool, rng: &mut impl Rng) -> Vec<Inertia> {
    let one = |sample: &Inertia| {
        let noise = Matrix3::from_fn(|_, _| 1.0 + 1e-15 * (rng.random::<f64>() - 0.5));
        let matrix = sample.matrix().component_mul(&noise) * factor;
        Inertia::new((matrix + matrix.transpose()) * 0.5).unwrap()
    };
    let mut others: Vec<Inertia> = samples.iter().map(one).collect();
    if backwards {
        others.reverse();
    }
    others
}

/// The same with the mirror image of each body beside it, as those of the parts of port and starboard: laws and their mirror images
/// are equally likely.
fn mirrored_table(seed: u64) -> Vec<Inertia> {
    let mirror = |sample: &Inertia| {
        let axis = (seed % 3) as usize;
        let side = Matrix3::from_fn(|i, j| if (i == axis) == (j == axis) { 1.0 } else { -1.0 });
        [*sample, Inertia::new(sample.matrix().component_mul(&side)).unwrap()]
    };
    hard_table(seed).iter().flat_map(mirror).collect()
}

/// A table, and the same in other last digits, and in another unit and order.
fn tables(samples: Vec<Inertia>, seed: u64) -> [(f64, Vec<Inertia>); 3] {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let noisy = again(&samples, 1.0, false, &mut rng);
    let pounds = 0.45359237 * 0.0254 * 0.0254;
    let in_pounds = again(&samples, pounds, true, &mut rng);
    [(1.0, samples), (1.0, noisy), (pounds, in_pounds)]
}

/// Whether numbers of this size are the same but for rounding.
fn same(a: f64, b: f64, size: f64) -> bool {
    (a - b).abs() <= 1e-6 * size
}

#[test]
fn a_table_has_one_fit() {
    have_one_fit(hard_table);
}

#[test]
fn a_table_of_mirror_images_has_one_fit() {
    have_one_fit(mirrored_table);
}

fn have_one_fit(table: fn(u64) -> Vec<Inertia>) {
    const TABLES: u64 = 120;
    let (mut others, mut doubtful) = (Vec::new(), 0);
    for seed in 0..TABLES {
        let [one, rest @ ..] = tables(table(seed), seed).map(|(unit, samples)| {
            let fit = PrincipalFit::new(&samples).unwrap();
            let roots = fit.roots().map(|root| [root.mean(), root.deviation()]);
            (fit, roots.map(|root| root.map(|x| x / unit.sqrt())), unit)
        });
        doubtful += one.0.matching().doubtful;
        for other in rest {
            let roots = one.1.iter().flatten().zip(other.1.iter().flatten());
            let nominal = |of: &(PrincipalFit, [[f64; 2]; 3], f64)| of.0.nominal().matrix() / of.2;
            let [a, b] = [&one.0, &other.0].map(|fit| fit.axes().law().covariance());
            let is_same = roots.into_iter().all(|(a, b)| same(*a, *b, 30.0))
                && same((a - b).amax(), 0.0, a.amax())
                && same((nominal(&one) - nominal(&other)).amax(), 0.0, 1e3)
                && one.0.axes().finding() == other.0.axes().finding()
                && one.0.matching() == other.0.matching();
            if !is_same {
                others.push(seed);
            }
        }
    }
    assert!(doubtful > 1000, "the test must have something to doubt: {doubtful}");
    assert!(others.is_empty(), "{others:?}");
}

#[test]
fn a_table_has_one_verdict() {
    const TABLES: u64 = 60;
    let (mut others, mut refused) = (Vec::new(), 0);
    for seed in 0..TABLES {
        let [one, rest @ ..] = tables(hard_table(seed), seed).map(|(_, samples)| {
            let fit = PrincipalFit::new(&samples).unwrap();
            fit.assess(&mut ChaCha8Rng::seed_from_u64(1))
        });
        refused += usize::from(!one.fits());
        for other in rest {
            let pairs = one.tests().iter().zip(other.tests());
            let is_same = one.tests().len() == other.tests().len()
                && pairs
                    .into_iter()
                    .all(|(a, b)| a.aspect() == b.aspect() && same(a.p_value(), b.p_value(), 1.0));
            if !is_same {
                others.push(seed);
            }
        }
    }
    assert!(refused > 2, "the test must have something to refuse: {refused}");
    assert!(others.is_empty(), "{others:?}");
}
