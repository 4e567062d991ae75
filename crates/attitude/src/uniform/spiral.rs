//! An even grid of attitudes along a spiral.

use nalgebra::{Quaternion, UnitQuaternion};
use std::f64::consts::{SQRT_2, TAU};

/// The positive root of ψ⁴ = ψ + 4.
const PSI: f64 = 1.533_751_168_755_204_3;

/// An evenly spread, deterministic set of n attitudes: a grid rather than noise.
///
/// # Definition
/// The super-Fibonacci spiral on S³ (Alexa 2022, doi:10.1109/CVPR52688.2022.00811): for
/// s = i + ½, i = 0 … n − 1, the point with radii √(s/n) and √(1 − s/n) and angles 2πs/√2 and
/// 2πs/ψ in two planes, ψ⁴ = ψ + 4. Equal shares of the radius squared are equal volumes, as in
/// Shoemake's algorithm; the two irrational turns keep neighbours apart. Any n will do, there are no
/// levels to be filled.
///
/// # Errors
/// None: n = 0 gives an empty set.
///
/// ```
/// let attitudes: Vec<_> = gyradius_attitude::super_fibonacci(1000).collect();
/// let mean = attitudes.iter().map(|q| q.w * q.w).sum::<f64>() / 1000.0;
/// assert!((mean - 0.25).abs() < 1e-3);
/// ```
pub fn super_fibonacci(n: u32) -> impl ExactSizeIterator<Item = UnitQuaternion<f64>> {
    (0..n as usize).map(move |i| {
        let s = i as f64 + 0.5;
        let share = s / f64::from(n);
        let (r, complement) = (share.sqrt(), (1.0 - share).sqrt());
        // Turns are reduced before they become angles, which keeps their digits for large n.
        let (sin_a, cos_a) = libm::sincos(TAU * (s / SQRT_2).fract());
        let (sin_b, cos_b) = libm::sincos(TAU * (s / PSI).fract());
        UnitQuaternion::new_unchecked(Quaternion::new(
            complement * cos_b,
            r * sin_a,
            r * cos_a,
            complement * sin_b,
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::UniformAttitude;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
    use rand_distr::Distribution;

    #[test]
    fn psi_solves_its_equation() {
        assert!((PSI.powi(4) - PSI - 4.0).abs() < 1e-14);
    }

    #[test]
    fn any_number_of_unit_quaternions() {
        for n in [0, 1, 2, 17, 1000] {
            assert_eq!(super_fibonacci(n).len(), n as usize);
            assert!(super_fibonacci(n).all(|q| (q.norm() - 1.0).abs() < 1e-15));
        }
    }

    /// Haar measure is approached much faster than by random draws: entries of the rotation matrix
    /// and their squares have means 0 and 1/3.
    #[test]
    fn means_beat_random_draws_by_far() {
        const N: u32 = 10_000;
        let worst = |attitudes: &[UnitQuaternion<f64>]| {
            let mut worst = 0.0_f64;
            for entry in 0..9 {
                let values = attitudes.iter().map(|q| q.to_rotation_matrix().matrix()[entry]);
                let (first, second) = values.fold((0.0, 0.0), |(a, b), x| (a + x, b + x * x));
                let n = f64::from(N);
                worst = worst.max((first / n).abs()).max((second / n - 1.0 / 3.0).abs());
            }
            worst
        };
        let spiral: Vec<_> = super_fibonacci(N).collect();
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let random: Vec<_> = (0..N).map(|_| UniformAttitude.sample(&mut rng)).collect();
        assert!(worst(&spiral) < 1e-3, "{}", worst(&spiral));
        assert!(worst(&spiral) < 0.1 * worst(&random));
    }

    /// No two attitudes are close: the nearest pair is within a factor of two of what a lattice of
    /// balls could have, where random draws have pairs ten times closer.
    #[test]
    fn neighbours_keep_apart() {
        const N: u32 = 1000;
        let nearest = |attitudes: &[UnitQuaternion<f64>]| {
            let mut cosine = 0.0_f64;
            for (i, a) in attitudes.iter().enumerate() {
                for b in &attitudes[..i] {
                    cosine = cosine.max(a.coords.dot(&b.coords).abs());
                }
            }
            cosine.acos()
        };
        // Balls of radius ρ on half of S³ (volume π²) hold at most N·4πρ³/3 = 0.74 π².
        let bound = 2.0 * (0.74 * std::f64::consts::PI * 0.75 / f64::from(N)).cbrt();
        let spiral: Vec<_> = super_fibonacci(N).collect();
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let random: Vec<_> = (0..N).map(|_| UniformAttitude.sample(&mut rng)).collect();
        let (even, uneven) = (nearest(&spiral), nearest(&random));
        assert!(even > 0.5 * bound, "{even} of {bound}");
        assert!(uneven < 0.2 * even, "{uneven} {even}");
    }

    /// No attitude is far from the grid. The deepest hole among 1000 is at the given attitude (the
    /// largest empty facet of the convex hull of the grid and its negative, `scripts/grids.py`),
    /// 0.4029 rad from its nearest neighbours; random attitudes find nothing farther.
    #[test]
    fn no_attitude_is_left_out() {
        const N: u32 = 1000;
        const DEEPEST: f64 = 0.402_925_365_027;
        let hole = UnitQuaternion::new_unchecked(Quaternion::from([
            0.211_732_323_813_761_97,
            -0.969_487_854_337_336_5,
            0.077_501_340_074_570_57,
            -0.096_209_488_261_072_45,
        ]));
        let spiral: Vec<_> = super_fibonacci(N).collect();
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let random: Vec<_> = (0..N).map(|_| UniformAttitude.sample(&mut rng)).collect();
        let distance = |grid: &[UnitQuaternion<f64>], q: &UnitQuaternion<f64>| {
            2.0 * grid.iter().map(|p| p.coords.dot(&q.coords).abs()).fold(0.0, f64::max).acos()
        };
        assert!((distance(&spiral, &hole) - DEEPEST).abs() < 1e-9, "{}", distance(&spiral, &hole));
        let (mut even, mut uneven) = (0.0_f64, 0.0_f64);
        for _ in 0..10_000 {
            let q = UniformAttitude.sample(&mut rng);
            even = even.max(distance(&spiral, &q));
            uneven = uneven.max(distance(&random, &q));
        }
        assert!(even < DEEPEST, "{even}");
        // Negative control: draws leave holes half as wide again.
        assert!(uneven > 1.3 * DEEPEST, "{uneven}");
    }
}
