//! Statements over the space of bodies and of subsets of statements, held against an independent
//! solution: least squares with bounds over the variances of second moments and rotations that the statements
//! open, by coordinate descent, to first order.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::{
    ops::Range,
    sync::atomic::{AtomicU64, AtomicUsize, Ordering},
    thread,
};

use gyradius_attitude::RadiallyConstrainedGaussian;
use gyradius_dispersion::{CorrelatedRoots, EntryMoments, PrincipalDispersion};
use gyradius_estimation::{
    Amount, AxesStatement, CentreStatement, MassStatement, MomentsStatement, ProductsStatement,
    StatedModel, StatementWarning, Statements,
};
use gyradius_inertia::{Inertia, RootSecondMoments};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// The entries in the order I11, I22, I33, I12, I13, I23.
const ENTRIES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

/// A body and what is said of it.
struct Case {
    nominal: Inertia,
    mass_kg: f64,
    statements: Statements,
}

fn between<R: Rng>(rng: &mut R, low: f64, high: f64) -> f64 {
    rng.random_range(low..high)
}

/// Compact, slender, flat and nearly symmetric bodies, along the axes, tilted a little or anyhow, from
/// 1e-9 to 1e9 kg·m².
fn random_body<R: Rng>(rng: &mut R) -> Inertia {
    let size = 10_f64.powf(between(rng, -9.0, 9.0));
    let mut k = match rng.random_range(0..5) {
        0 => [1.0, between(rng, 1.0, 2.0), between(rng, 2.0, 4.0)],
        1 => [between(rng, 0.02, 0.1), between(rng, 0.02, 0.1), 1.0],
        2 => [between(rng, 0.0, 0.02), between(rng, 0.4, 1.0), 1.0],
        3 => [1.0, 1.0 + between(rng, 0.0, 0.02), between(rng, 0.2, 3.0)],
        _ => [between(rng, 0.1, 1.0), between(rng, 0.1, 1.0), between(rng, 0.1, 1.0)],
    };
    let first = rng.random_range(0..3);
    k.rotate_left(first);
    let tilt = match rng.random_range(0..3) {
        0 => 0.0,
        1 => 0.05,
        _ => 3.0,
    };
    let turn = Vector3::from_fn(|_, _| if tilt > 0.0 { between(rng, -tilt, tilt) } else { 0.0 });
    let k = gyradius_inertia::SecondMoments::new(k.map(|k| k * size)).unwrap();
    Inertia::from_second_moments(k, &UnitQuaternion::from_scaled_axis(turn)).unwrap()
}

/// Any subset of statements, of sizes that people state.
fn random_case(seed: u64, subset: u32) -> Case {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let nominal = random_body(&mut rng);
    let trace = nominal.matrix().trace();
    // A body of about a metre.
    let mass_kg = trace * between(&mut rng, 0.5, 3.0);
    let said = |bit: u32| subset & (1 << bit) != 0;
    let one = rng.random_bool(0.6);
    let mut three = |low: f64, high: f64| {
        let first = libm::exp(between(&mut rng, libm::log(low), libm::log(high)));
        let mut other = || if one { first } else { first * between(&mut rng, 0.5, 2.0) };
        [first, other(), other()]
    };
    let moments = three(0.3, 20.0);
    let products = three(1e-4, 0.02).map(|x| x * trace);
    let axes = three(0.1, 5.0);
    let [mass, ..] = three(0.1, 10.0);
    let centre = three(1e-4, 1e-2);
    let arm =
        if rng.random_bool(0.5) { [0.0; 3] } else { [0.0, 0.1, between(&mut rng, -1.0, 1.0)] };
    let statements = Statements {
        moments: said(0).then(|| MomentsStatement::new(Amount::Percent(moments), 1.0).unwrap()),
        products: said(1).then(|| ProductsStatement::new(products, 1.0).unwrap()),
        axes: said(2).then(|| AxesStatement::each(axes, 1.0).unwrap()),
        mass: said(3).then(|| MassStatement::percent(mass, 1.0).unwrap()),
        centre: said(4).then(|| CentreStatement::new(centre, 1.0, arm).unwrap()),
    };
    Case { nominal, mass_kg, statements }
}

/// A non-negative x that minimises |Ax − b|², and is within `most`, by coordinate descent.
fn bounded_least_squares(a: &[Vec<f64>], b: &[f64], most: &[f64]) -> Vec<f64> {
    let n = most.len();
    let mut x = vec![0.0; n];
    let mut rest = b.to_vec();
    for _ in 0..3_000 {
        for j in 0..n {
            let size: f64 = a.iter().map(|row| row[j] * row[j]).sum();
            if !(size > 0.0) {
                continue;
            }
            let slope: f64 = a.iter().zip(&rest).map(|(row, r)| row[j] * r).sum();
            let next = (x[j] + slope / size).clamp(0.0, most[j]);
            for (row, r) in a.iter().zip(&mut rest) {
                *r -= row[j] * (next - x[j]);
            }
            x[j] = next;
        }
    }
    x
}

/// What a law of independent second moments and rotations gives that is made of the stated variances
/// alone, to first order: deviations of the six entries. And what its rotations do to the moments by their squares.
fn oracle(case: &Case) -> ([f64; 6], f64) {
    let nominal = &case.nominal;
    let axes = nominal.principal_axes();
    let r = axes.attitude().to_rotation_matrix();
    let moments = axes.moments();
    let growth = |e: usize, k: usize| {
        let (a, b) = ENTRIES[e];
        let delta = if a == b { 1.0 } else { 0.0 };
        (delta - r[(k, a)] * r[(k, b)]).powi(2)
    };
    let swing = |e: usize, j: usize| {
        let (a, b) = ENTRIES[e];
        let (m, n) = ((j + 1) % 3, (j + 2) % 3);
        ((moments[m] - moments[n]) * (r[(m, a)] * r[(n, b)] + r[(n, a)] * r[(m, b)])).powi(2)
    };
    let s = &case.statements;
    let [i11, i22, i33, ..] = nominal.entries();
    let most = s.axes.map_or([0.125; 3], |a| a.deviations().map(|d| d * d));
    let mut given = [0.0; 3];
    if s.products.is_none() {
        given = s.axes.map_or([0.0; 3], |_| most);
    }
    let mut rows = Vec::new();
    let mut right = Vec::new();
    if let Some(m) = s.moments {
        for (e, d) in m.deviations([i11, i22, i33]).into_iter().enumerate() {
            rows.push((e, d * d));
        }
    }
    if let Some(p) = s.products {
        for (e, d) in p.deviations().into_iter().enumerate() {
            rows.push((3 + e, d * d));
        }
    }
    let largest = rows.iter().map(|r| r.1).fold(0.0, f64::max);
    let a: Vec<Vec<f64>> = rows
        .iter()
        .map(|&(e, variance)| {
            let by_axes: f64 = (0..3).map(|j| swing(e, j) * given[j]).sum();
            right.push((variance - by_axes) / variance);
            (0..6)
                .map(|x| match x {
                    0..3 if s.moments.is_some() => growth(e, x) * largest / variance,
                    3.. if s.products.is_some() => swing(e, x - 3) / variance,
                    _ => 0.0,
                })
                .collect()
        })
        .collect();
    let bound = [f64::INFINITY, f64::INFINITY, f64::INFINITY, most[0], most[1], most[2]];
    let x = bounded_least_squares(&a, &right, &bound);
    let by_squares = |j: usize| {
        let apart = moments[(j + 1) % 3] - moments[(j + 2) % 3];
        2_f64.sqrt() * apart.abs() * (x[3 + j] + given[j])
    };
    let squares = (0..3).map(by_squares).sum();
    let deviations = std::array::from_fn(|e| {
        let by_moments: f64 = (0..3).map(|k| growth(e, k) * x[k] * largest).sum();
        let by_axes: f64 = (0..3).map(|j| swing(e, j) * (x[3 + j] + given[j])).sum();
        (by_moments + by_axes).sqrt()
    });
    (deviations, squares)
}

/// Subsets of statements, by bits.
const MOMENTS: u32 = 1;
const PRODUCTS: u32 = 2;
const AXES: u32 = 4;
const MASS: u32 = 8;
const CENTRE: u32 = 16;

/// Errors of a deviation that are none.
const NEAR: f64 = 0.03;

/// Whether a model says that it misses an entry.
fn missed(model: &StatedModel, of: usize) -> bool {
    let warnings = model.warnings().iter();
    warnings
        .into_iter()
        .any(|w| matches!(w, StatementWarning::Missed { entry, .. } if *entry == of))
}

/// Holds the models of every subset of statements about one random body against the rules.
fn check(seed: u64) {
    let cases: Vec<_> = (0..32).map(|subset| random_case(seed, subset)).collect();
    let model = |case: &Case| case.statements.model(&case.nominal, Some(case.mass_kg)).unwrap();
    let models: Vec<_> = cases.iter().map(model).collect();
    for (subset, (case, model)) in (0..).zip(cases.iter().zip(&models)) {
        let says = |bits: u32| subset & bits != 0;
        let implied = model.implied().deviations();
        let (oracle, squares) = oracle(case);
        let what = format!(
            "seed {seed}, subset {subset:05b}: stated {:?}, implied {implied:?}, oracle {oracle:?}, {:?}",
            model.stated(),
            model.warnings()
        );
        let trace = case.nominal.matrix().trace();
        let miss = |found: f64, stated: f64| (found / stated - 1.0).abs();

        // What is stated comes out where independent second moments and rotations do it to first order, and the
        // squares of the rotations move no moment beyond what is stated of it. A mass that speaks for the moments alone may move the products more.
        let oracle_within = |share: f64| {
            (0..6).all(|e| model.stated()[e].is_none_or(|s| miss(oracle[e], s) < share))
        };
        let moments = model.stated()[..3].iter().flatten().copied().fold(f64::INFINITY, f64::min);
        let by_oracle = oracle_within(NEAR) && squares < 0.9 * moments;
        let spoken = says(MASS | CENTRE) && !says(MOMENTS);
        for (e, stated) in model.stated().into_iter().enumerate() {
            let Some(stated) = stated else { continue };
            let limited = e >= 3 && says(AXES) && implied[e] < stated;
            if limited || miss(implied[e], stated) < NEAR {
                continue;
            }
            assert!(!by_oracle || spoken, "entry {e} missed: {what}");
            let told = missed(model, e);
            let largest = model.stated().into_iter().flatten().fold(0.0, f64::max);
            let little = 1.1 * NEAR * stated + 3e-3 * largest;
            assert!(told || (implied[e] - stated).abs() < little, "not told: {what}");
        }

        // Numbers in messages can be read, whatever the size of the body.
        for warning in model.warnings() {
            assert!(!warning.to_string().contains(" 0.0000 "), "{warning}");
        }

        // What nothing is said of scatters as the first order forces it, and by squares of rotations.
        if oracle_within(1e-3) && !says(MASS | CENTRE) {
            let rotation = model.turns().into_iter().fold(0.0, f64::max);
            let second = 1.5 * trace * rotation * rotation;
            let largest = oracle.iter().copied().fold(0.0, f64::max);
            for e in 0..6 {
                let most = 1.05 * oracle[e] + second + 5e-3 * largest + 1e-5 * trace;
                let free = model.stated()[e].is_none();
                assert!(!free || implied[e] < most, "entry {e} scatters: {what}");
            }
        }
        if subset == 0 {
            assert!(implied.iter().all(|d| *d < 1e-5 * trace), "{what}");
        }

        // A further statement makes no entry more certain than it was stated.
        for further in [PRODUCTS, AXES, MASS, CENTRE, MOMENTS] {
            if says(further) {
                continue;
            }
            let further_model = &models[(subset | further) as usize];
            let more = further_model.implied().deviations();
            for e in 0..6 {
                // Of entries that are missed, which is told, another miss may be the nearest then.
                let Some(stated) = model.stated()[e].filter(|s| implied[e] > s * (1.0 - NEAR))
                else {
                    continue;
                };
                // Statements that contradict each other say so themselves.
                let says_so = missed(further_model, e) && more[e] < stated;
                let least = implied[e].min(stated) * (1.0 - 1.5 * NEAR) - 3e-3 * stated;
                assert!(says_so || more[e] > least, "{further:05b} takes {more:?} from {what}");
            }
        }

        // A mass is a part of the moments, and moves all that it can.
        if let Some(mass) = model.mass() {
            let part = mass.inertia_follows() * mass.relative_deviation();
            let entries = case.nominal.entries();
            for e in 0..3 {
                let least = part * entries[e];
                assert!(implied[e] > least * (1.0 - NEAR), "{what}");
            }
            assert!(says(MOMENTS) || mass.inertia_follows() == 1.0, "{what}");
            let in_part =
                |w: &StatementWarning| matches!(w, StatementWarning::FollowsInPart { .. });
            assert_eq!(
                mass.inertia_follows() < 1.0,
                model.warnings().iter().any(in_part),
                "{what}"
            );
        }
    }
}

/// Plates, rods and plates whose second moment is zero but for rounding: every statement makes a model.
#[test]
fn flat_bodies_have_models() {
    for (seed, k) in
        (0..).zip([[1.0, 2.0, 0.0], [0.0, 1.0, 1.0], [0.0, 0.0, 3.0], [1e-17, 1.0, 2.0]])
    {
        for subset in [MOMENTS, PRODUCTS, AXES, MASS, CENTRE, MOMENTS | PRODUCTS, AXES | MASS] {
            let k = gyradius_inertia::SecondMoments::new(k).unwrap();
            let tilt = if subset % 2 == 0 { 0.0 } else { 0.7 };
            let turn = UnitQuaternion::from_scaled_axis(Vector3::new(tilt, 0.5 * tilt, -tilt));
            let nominal = Inertia::from_second_moments(k, &turn).unwrap();
            let case = Case { nominal, ..random_case(seed, subset) };
            let model = case.statements.model(&case.nominal, Some(2.0)).unwrap();
            let implied = model.implied().deviations();
            assert!(implied.iter().all(|d| d.is_finite()), "{subset:05b} {implied:?}");
        }
    }
}

/// Deviations that a law of the model's own family has come out of a model again, whatever its correlations.
#[test]
fn what_a_law_has_comes_out() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let mut missed = 0;
    for case in 0..24 {
        let size = 10_f64.powf(between(&mut rng, -3.0, 3.0));
        let mean = [(); 3].map(|()| size * between(&mut rng, 1.0, 3.0));
        let tilt = if case % 4 == 0 { 0.0 } else { 2.0 };
        let turn = Vector3::from_fn(|_, _| tilt * between(&mut rng, -1.0, 1.0));
        let mut covariance = |size: f64| {
            let f = Matrix3::from_fn(|_, _| between(&mut rng, -1.0, 1.0)) * size;
            f * f.transpose() + Matrix3::identity() * (0.01 * size * size)
        };
        let (roots, turns) = (covariance(0.08 * size), covariance(0.03));
        let roots = CorrelatedRoots::new(RootSecondMoments::new(mean).unwrap(), roots).unwrap();
        let attitude = UnitQuaternion::from_scaled_axis(turn);
        let axes =
            RadiallyConstrainedGaussian::from_rotation_covariance(attitude, turns, 0.01).unwrap();
        let k = gyradius_inertia::SecondMoments::new(mean.map(|k| k * k)).unwrap();
        let nominal = Inertia::from_second_moments(k, &attitude).unwrap();
        let has = EntryMoments::of(&PrincipalDispersion::new(roots, axes)).deviations();
        let [m1, m2, m3, p1, p2, p3] = has;
        let statements = Statements {
            moments: Some(MomentsStatement::new(Amount::Absolute([m1, m2, m3]), 1.0).unwrap()),
            products: Some(ProductsStatement::new([p1, p2, p3], 1.0).unwrap()),
            ..Statements::default()
        };
        let model = statements.model(&nominal, None).unwrap();
        let implied = model.implied().deviations();
        let worst = (0..6).map(|e| (implied[e] / has[e] - 1.0).abs()).fold(0.0, f64::max);
        missed += u32::from(worst > NEAR);
        assert!(worst < 0.3, "case {case}: {has:?} {implied:?}");
    }
    // The search may end in a hollow beside the best: rarely, and not far from it.
    assert!(missed <= 1, "{missed}");
}

/// How many seeds there are whose cases do not come out, on all cores.
fn failures(seeds: Range<u64>) -> usize {
    let (next, failures) = (AtomicU64::new(seeds.start), AtomicUsize::new(0));
    let threads = thread::available_parallelism().map_or(1, usize::from);
    thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed >= seeds.end {
                        break;
                    }
                    let failed = std::panic::catch_unwind(|| check(seed)).is_err();
                    failures.fetch_add(usize::from(failed), Ordering::Relaxed);
                }
            });
        }
    });
    failures.into_inner()
}

#[test]
fn every_subset_of_statements_comes_out() {
    let cases = std::env::var("CENSUS").map_or(8, |n| n.parse().unwrap());
    assert_eq!(failures(0..cases), 0);
}

/// The same over 10,240 cases. Half an hour.
#[test]
#[ignore = "takes half an hour"]
fn ten_thousand_statements_come_out() {
    assert_eq!(failures(1_000..1_320), 0);
}
