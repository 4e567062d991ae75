//! Attitudes that mirror one another: laws and their mirror images are equally likely, and rounding must not choose.

use super::*;

/// Pairs of attitudes about any mean, each turned by (a, b, c) and by (a, −b, −c), and some by (a, 0, 0) alone.
fn mirrored(rng: &mut ChaCha8Rng) -> Vec<UnitQuaternion<f64>> {
    let any = |rng: &mut ChaCha8Rng| crate::UniformAttitude.sample(rng);
    let (left, right) = match rng.random_range(0..3) {
        0 => (UnitQuaternion::identity(), UnitQuaternion::identity()),
        1 => (UnitQuaternion::identity(), any(rng)),
        _ => (any(rng), any(rng)),
    };
    let apart = [0; 3].map(|_| rng.random_range(-1.0..1.0_f64));
    let width = [0; 3].map(|_| libm::exp(rng.random_range(-4.0..0.0)));
    let in_plane = rng.random_range(0..6);
    let pairs = rng.random_range(7..25);
    let mut all = Vec::new();
    for i in 0..in_plane + pairs {
        let [a, b, c] = [0, 1, 2].map(|k| {
            let z: f64 = rand_distr::StandardNormal.sample(rng);
            apart[k] + width[k] * z
        });
        let turns = if i < in_plane { vec![[a, 0.0, 0.0]] } else { vec![[a, b, c], [a, -b, -c]] };
        all.extend(
            turns
                .into_iter()
                .map(|turn| left * UnitQuaternion::from_scaled_axis(Vector3::from(turn)) * right),
        );
    }
    all
}

/// The same attitudes to rounding, in another order, with other signs.
fn again(attitudes: &[UnitQuaternion<f64>], rng: &mut ChaCha8Rng) -> Vec<UnitQuaternion<f64>> {
    let mut others: Vec<_> = attitudes
        .iter()
        .map(|q| {
            let sign = if rng.random() { 1.0 } else { -1.0 };
            let noisy = q.coords.map(|x| sign * (x + 2e-16 * rng.random_range(-1.0..1.0)));
            UnitQuaternion::new_normalize(Quaternion::from(noisy))
        })
        .collect();
    for last in (1..others.len()).rev() {
        others.swap(last, rng.random_range(0..=last));
    }
    others
}

#[test]
fn rounding_does_not_choose_between_mirror_images() {
    const SAMPLES: u64 = 300;
    let (mut other, mut sided) = (Vec::new(), 0);
    for seed in 0..SAMPLES {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let attitudes = mirrored(&mut rng);
        let Ok(fit) = RadiallyConstrainedGaussian::fit(&attitudes) else { continue };
        sided += u32::from(matches!(fit.family(), Family::General));
        for _ in 0..3 {
            let again = RadiallyConstrainedGaussian::fit(&again(&attitudes, &mut rng)).unwrap();
            let apart = fit.law().mean().angle_to(&again.law().mean());
            let turns = fit.turn_covariance() - again.turn_covariance();
            if !(apart < 1e-5 && turns.amax() <= 1e-4 * fit.turn_covariance().amax()) {
                other.push((seed, apart, turns.amax() / fit.turn_covariance().amax()));
                break;
            }
        }
    }
    assert!(sided > 40, "the test must have laws to mirror: {sided}");
    assert!(other.is_empty(), "{} of {SAMPLES}: {other:?}", other.len());
}
