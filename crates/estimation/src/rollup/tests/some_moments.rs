//! Deviations of some moments alone, and what no plate can have.

use gyradius_inertia::InertiaMatrix;
use nalgebra::{Matrix3, UnitQuaternion};
use rand::RngExt;
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

use super::super::{AssemblyPart, PartFinding, PartStatement};

/// A part in its principal axes, with deviations of its moments.
fn of_moments(moments: [f64; 3], deviations: [f64; 3]) -> AssemblyPart {
    let [i, j, k] = moments;
    let [s, t, u] = deviations;
    AssemblyPart::new(PartStatement {
        mass_kg: 5.0,
        mass_centre_m: [0.0; 3],
        inertia: InertiaMatrix::new(Matrix3::from_diagonal(&[i, j, k].into())).unwrap(),
        attitude: UnitQuaternion::identity(),
        deviations: [0.0, 0.0, 0.0, 0.0, s, t, u, 0.0, 0.0, 0.0],
        inertia_follows_mass: false,
    })
    .unwrap()
}

/// A deviation of one or two moments, the others left out: what is stated is what is drawn, and what is not stated hardly moves.
#[test]
fn deviations_of_some_moments_are_not_given_up_for_those_left_out() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    for round in 0..300 {
        let lengths = std::array::from_fn::<f64, 3, _>(|_| rng.random_range(0.5..1.5_f64).powi(2));
        let [a, b, c] = lengths;
        let moments = [b + c, a + c, a + b];
        let subset = 1 + round % 6;
        let wide = |e: usize| rng.random_range(0.01..0.08) * moments[e];
        let mut stated = [0, 1, 2].map(wide);
        (0..3).filter(|e| subset >> e & 1 == 0).for_each(|e| stated[e] = 0.0);
        let part = of_moments(moments, stated);
        let mut found = stated;
        for finding in part.findings() {
            if let PartFinding::Moved { entries } = finding {
                for (name, _, law) in entries {
                    found[InertiaMatrix::ENTRY_NAMES.iter().position(|e| e == name).unwrap()] =
                        *law;
                }
            }
        }
        let largest = stated.iter().copied().fold(0.0, f64::max);
        for (found, stated) in found.iter().zip(stated) {
            let (gap, most) = ((found - stated).abs(), if stated == largest { 0.06 } else { 0.2 });
            assert!(gap < most * largest, "{moments:?} {stated:?} {found:?}");
        }
        for finding in part.findings() {
            assert!(!finding.is_impossible() && !finding.to_string().contains("inf"), "{finding}");
        }
    }
}

/// In the plane, I₃₃ = I₁₁ + I₂₂: what no plate can have is told as such, and nothing else.
#[test]
fn what_no_plate_can_have_is_told_apart() {
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    let mut told = [0; 2];
    for _ in 0..200 {
        let [i, j]: [f64; 2] = std::array::from_fn(|_| rng.random_range(0.5..2.0));
        let [s, t]: [f64; 2] = std::array::from_fn(|_| rng.random_range(0.02..0.1));
        let sum = rng.random_range(0.0..1.6) * (s + t);
        let part = of_moments([i, j, i + j], [s, t, sum]);
        let is_impossible = part.findings().iter().any(PartFinding::is_impossible);
        let can_be = ((s - t).abs()..=s + t).contains(&sum);
        // At the limits, the search tells what it has not shown as unfound, not as impossible.
        let is_near = sum < 1.25 * (s + t) && sum > 0.6 * (s - t).abs();
        assert!(!(is_impossible && can_be), "{i} {j} {s} {t} {sum}");
        assert!(is_impossible || is_near, "{i} {j} {s} {t} {sum}");
        told[usize::from(is_impossible)] += 1;
    }
    assert!(told.iter().all(|count| *count > 20), "{told:?}");
}
