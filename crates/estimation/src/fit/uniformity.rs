//! Which angles of the axes the samples may leave undetermined: tests of uniformity.

use gyradius_statistics::tail;
use nalgebra::{Matrix3, SMatrix, UnitQuaternion, Vector3};

use super::{relabel::Sample, root::RootFit, round::Roundness};

/// Uniform angles are taken for not uniform this often.
const SIZE: f64 = 0.01;
/// Moments this many deviations apart are never taken for each other.
const APART: f64 = 3.0;

/// Whether the samples may leave all angles of the axes undetermined, and the turn about which axes: by tests of uniformity
/// that do not depend on how axes of equal moments are named, at 1 %. A turn that changes nothing is undetermined.
pub(super) fn undetermined(
    samples: &[Sample],
    roots: &[RootFit; 3],
    mean: &UnitQuaternion<f64>,
    round: Roundness,
) -> (bool, [bool; 3]) {
    let n = samples.len() as f64;
    // Axis k is the odd one of the pair that remains.
    let apart: [bool; 3] = std::array::from_fn(|k| {
        let (a, b) = (roots[(k + 1) % 3], roots[(k + 2) % 3]);
        (a.mean() - b.mean()).abs() > APART * a.deviation().hypot(b.deviation())
    });
    if round == Roundness::Ball {
        return (true, [false; 3]);
    }
    let any = uniform_p_value(samples, apart) > SIZE;
    if round != Roundness::No {
        return (any, [0, 1, 2].map(|axis| round.is_about(axis)));
    }
    let mut about = [false; 3];
    for (axis, apart) in apart.into_iter().enumerate() {
        // Named by moment, an axis is known but for its sign; else up to quarter turns.
        let fold = if apart { 2.0 } else { 4.0 };
        let (mut c, mut s) = (0.0, 0.0);
        for sample in samples {
            let p = sample.attitude * mean.inverse();
            let angle = 2.0 * libm::atan2(p.imag()[axis], p.w);
            let (sin, cos) = libm::sincos(fold * angle);
            c += cos / n;
            s += sin / n;
        }
        about[axis] = tail::rayleigh(libm::hypot(c, s), n) > SIZE;
    }
    (any, about)
}

/// p-value of uniform axes, from tensors that change with no naming of the axes that could be
/// confused: Σ a_k aₖᵀ of each axis that is known by its moment, Σ_k a_k⊗a_k⊗a_k⊗a_k if none is.
fn uniform_p_value(samples: &[Sample], apart: [bool; 3]) -> f64 {
    let n = samples.len() as f64;
    let axes = |s: &Sample| *s.attitude.to_rotation_matrix().matrix();
    let known = apart.iter().filter(|a| **a).count();
    if known == 0 {
        // Harmonics of degree four: 9 components, of variance 2/15 each.
        let mut sum = SMatrix::<f64, 9, 9>::zeros();
        for s in samples {
            let r = axes(s);
            for k in 0..3 {
                let a: Vector3<f64> = r.row(k).transpose();
                let square = SMatrix::<f64, 9, 1>::from_fn(|i, _| a[i / 3] * a[i % 3]);
                sum += square * square.transpose() / n;
            }
        }
        return tail::chi_squared(n * (sum.norm_squared() - 9.0 / 5.0) * 7.5, 9.0);
    }
    let mut tensors = [-Matrix3::identity() / 3.0; 3];
    for s in samples {
        let r = axes(s);
        for (k, tensor) in tensors.iter_mut().enumerate() {
            let a: Vector3<f64> = r.row(k).transpose();
            *tensor += a * a.transpose() / n;
        }
    }
    if known == 3 {
        let [q1, q2, q3] = tensors;
        let statistic = (q1 - q2).norm_squared() * 2.5 + q3.norm_squared() * 7.5;
        return tail::chi_squared(n * statistic, 10.0);
    }
    // One pair cannot be told apart: the third axis can. With two such pairs, none can.
    let pairs: Vec<usize> = (0..3).filter(|k| !apart[*k]).collect();
    match pairs[..] {
        [axis] => tail::chi_squared(n * tensors[axis].norm_squared() * 7.5, 5.0),
        _ => uniform_p_value(samples, [false; 3]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gyradius_attitude::UniformAttitude;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
    use rand_distr::Distribution;

    /// The test of uniform axes rejects uniform axes as often as it says.
    #[test]
    fn uniformity_has_its_size() {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let mut rejected = [0; 3];
        const REPEATS: usize = 2000;
        for _ in 0..REPEATS {
            let samples: Vec<Sample> = (0..100)
                .map(|_| Sample { roots: [1.0; 3], attitude: UniformAttitude.sample(&mut rng) })
                .collect();
            let cases = [[false; 3], [true; 3], [true, true, false]];
            for (count, apart) in rejected.iter_mut().zip(cases) {
                *count += usize::from(uniform_p_value(&samples, apart) < 0.05);
            }
        }
        for count in rejected {
            // 5 % ± 4 deviations, and a little for n = 100.
            assert!((60..=145).contains(&count), "{rejected:?}");
        }
    }
}
