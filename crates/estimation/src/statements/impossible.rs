//! How often moments that scatter independently are those of no body.

use std::f64::consts::TAU;

use gyradius_inertia::{Inertia, RELATIVE_TOLERANCE};
use gyradius_statistics::tail;
use nalgebra::{Matrix3, Vector3};

/// Directions, each of which is looked along both ways: the share is right to 0.2 % of all bodies, and a small one to 0.5 % of itself.
const DIRECTIONS: u32 = 1024;
/// The turn from one direction to the next, of a whole one.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// The share of bodies that would break the triangle inequality if the moments I₁₁, I₂₂, I₃₃ were independent normal numbers
/// with these deviations, and the products were nominal.
///
/// The moments that some body has beside given products are a convex set, and the nominal ones lie in it. In each direction of the
/// normal scores it therefore ends at one distance, and the probability to be farther away is that of χ² with three degrees of
/// freedom. Directions are those of a Fibonacci lattice.
pub(super) fn impossible_share(nominal: &Inertia, deviations: [f64; 3]) -> f64 {
    let tolerance = RELATIVE_TOLERANCE * nominal.matrix().trace();
    let sizes = nominal.second_moments().values().map(|k| 1.0 / (k + tolerance).sqrt());
    let axes = nominal.principal_axes().attitude().to_rotation_matrix();
    // In these axes the second moments of the nominal body are a unit matrix.
    let to_unit = Matrix3::from_diagonal(&Vector3::from(sizes)) * axes.matrix();
    let of_trace = to_unit * to_unit.transpose() * 0.5;
    let by_score: [Matrix3<f64>; 3] = std::array::from_fn(|a| {
        let axis = to_unit.column(a);
        (of_trace - axis * axis.transpose()) * deviations[a]
    });
    let beyond = |pull: f64| if pull > 0.0 { tail::chi_squared(pull.powi(-2), 3.0) } else { 0.0 };
    let sum: f64 = (0..DIRECTIONS)
        .map(|i| {
            let turn = TAU * (f64::from(i) * GOLDEN).fract();
            let height = (f64::from(i) + 0.5) / f64::from(DIRECTIONS);
            let (sin, cos) = libm::sincos(turn);
            let radius = (1.0 - height * height).sqrt();
            let change =
                by_score[0] * (radius * cos) + by_score[1] * (radius * sin) + by_score[2] * height;
            let change = change.symmetric_eigenvalues();
            beyond(-change.min()) + beyond(change.max())
        })
        .sum();
    0.5 * sum / f64::from(DIRECTIONS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Amount, MomentsStatement, StatementWarning, Statements};
    use gyradius_inertia::{InertiaMatrix, SecondMoments};
    use nalgebra::UnitQuaternion;
    use proptest::prelude::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    const DRAWS: u32 = 20_000;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Compact, slender and flat bodies on their axes, a little off them and tilted: the one share that is told is that of
        /// draws, and none is told where there are next to none.
        #[test]
        fn the_share_is_that_of_draws(
            k in prop::array::uniform3(prop_oneof![8 => (-3.0..0.0_f64).prop_map(|x| libm::pow(10.0, x)), 1 => Just(0.0)]),
            turn in prop::array::uniform3(-1.0..1.0_f64),
            tilt in prop::sample::select(vec![0.0, 0.003, 0.03, 3.0]),
            percents in prop::array::uniform3(prop_oneof![4 => 1.0..40.0_f64, 1 => Just(0.0)]),
            seed in any::<u64>(),
        ) {
            prop_assume!(k.iter().filter(|k| **k > 0.0).count() > 1);
            let q = UnitQuaternion::from_scaled_axis(Vector3::from(turn) * tilt);
            let nominal = Inertia::from_second_moments(SecondMoments::new(k).unwrap(), &q).unwrap();
            let moments = MomentsStatement::new(Amount::Percent(percents), 1.0).unwrap();
            let statements = Statements { moments: Some(moments), ..Statements::default() };
            let model = statements.model(&nominal, None).unwrap();
            let told: Vec<f64> = model.warnings().iter().filter_map(|warning| match warning {
                StatementWarning::Impossible { share } => Some(*share),
                _ => None,
            }).collect();
            prop_assert!(told.len() < 2 && told.iter().all(|share| *share > 1e-3), "{told:?}");

            let [i11, i22, i33, i12, i13, i23] = nominal.entries();
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let is_impossible = |_: &u32| {
                let scattered = [i11, i22, i33].into_iter().zip(percents).map(|(moment, percent)| {
                    let score: f64 = StandardNormal.sample(&mut rng);
                    moment * (1.0 + 0.01 * percent * score)
                });
                let moments: Vec<f64> = scattered.collect();
                let drawn = InertiaMatrix::from_entries([moments[0], moments[1], moments[2]], [i12, i13, i23]);
                !drawn.unwrap().is_realizable()
            };
            let drawn = f64::from((0..DRAWS).filter(is_impossible).count() as u32) / f64::from(DRAWS);
            let error = (drawn.max(1e-3) / f64::from(DRAWS)).sqrt();
            let told = told.first().copied().unwrap_or(0.0);
            // What is not told is up to a thousandth.
            let near = if told > 0.0 { 0.003 } else { 0.001 };
            prop_assert!((told - drawn).abs() < near + 5.0 * error, "{told} {drawn}");
        }
    }
}
