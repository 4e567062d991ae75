//! Which principal axis of one sample is which of another.

use nalgebra::{Matrix3, Matrix4, Quaternion, UnitQuaternion, Vector3};

use super::{
    LIKELIER,
    relabel::{Relabeling, Sample},
};

/// Rounds after which labels that still change are left as they are.
const ROUNDS: usize = 200;
/// Deviations are taken to be no smaller than this share of the largest root, and than this
/// quaternion: six digits, which is what tables carry.
pub(super) const FLOOR: f64 = 1e-6;

/// Namings whose nearness or cost differ by less than this, or by this share, differ by rounding: the first of them is taken,
/// so that the last digits of samples do not decide.
pub(super) const TIE: f64 = 1e-9;

/// Samples whose axes are named alike.
#[derive(Clone, Debug)]
pub(super) struct Matched {
    pub(super) samples: Vec<Sample>,
    pub(super) converged: bool,
}

/// Mean and scatter of the samples under some labels: independent Gaussian roots, and a Gaussian
/// of the vector part of q ⊗ m⁻¹, in principal axes.
#[derive(Clone, Debug)]
pub(super) struct Centre {
    pub(super) attitude: UnitQuaternion<f64>,
    mean: [f64; 3],
    weight: [f64; 3],
    precision: Matrix3<f64>,
    ln_scale: f64,
}

impl Centre {
    pub(super) fn of(samples: &[Sample]) -> Self {
        let n = samples.len() as f64;
        let mut mean = [0.0; 3];
        for s in samples {
            for (sum, k) in mean.iter_mut().zip(s.roots) {
                *sum += k / n;
            }
        }
        let size = mean.iter().fold(f64::MIN_POSITIVE, |a, b| a.max(*b));
        let mut variance = [FLOOR * FLOOR * size * size; 3];
        for s in samples {
            for k in 0..3 {
                variance[k] += (s.roots[k] - mean[k]).powi(2) / n;
            }
        }
        let attitude = mean_attitude(samples.iter().map(|s| &s.attitude));
        let mut scatter = Matrix3::from_diagonal_element(FLOOR * FLOOR);
        for s in samples {
            let t = vector_part(&attitude, &s.attitude);
            scatter += t * t.transpose() / n;
        }
        let ln_scale = variance.iter().map(|v| libm::log(*v)).sum::<f64>()
            + libm::log(scatter.determinant().max(f64::MIN_POSITIVE));
        let precision = scatter.try_inverse().unwrap_or_else(Matrix3::zeros);
        Self { attitude, mean, weight: variance.map(|v| 1.0 / v), precision, ln_scale }
    }

    /// Minus twice the ln-likelihood, but for what all labels share.
    fn cost(&self, roots: [f64; 3], from_mean: &Quaternion<f64>) -> f64 {
        let t = from_mean.imag();
        let k: f64 = (0..3).map(|i| self.weight[i] * (roots[i] - self.mean[i]).powi(2)).sum();
        k + t.dot(&(self.precision * t))
    }

    /// The likeliest label of a sample.
    fn label(&self, sample: &Sample) -> usize {
        let from_mean = sample.attitude * self.attitude.inverse();
        let (mut best, mut least) = (0, f64::INFINITY);
        for (i, g) in Relabeling::all().iter().enumerate() {
            let roots = g.order.map(|i| sample.roots[i]);
            let cost = self.cost(roots, &(g.turn * from_mean));
            if cost < least * (1.0 - TIE) {
                (best, least) = (i, cost);
            }
        }
        best
    }
}

/// The vector part of q ⊗ m⁻¹ with a scalar part that is not negative: half the turn from the mean,
/// in principal axes, if it is small.
pub(super) fn vector_part(m: &UnitQuaternion<f64>, q: &UnitQuaternion<f64>) -> Vector3<f64> {
    let p = q * m.inverse();
    p.imag() * 1.0_f64.copysign(p.w)
}

/// The mean attitude, q and −q alike: the principal axis of Σ q qᵀ (Markley et al. 2007,
/// doi:10.2514/1.28949).
pub(super) fn mean_attitude<'a>(
    attitudes: impl Iterator<Item = &'a UnitQuaternion<f64>>,
) -> UnitQuaternion<f64> {
    let sum: Matrix4<f64> = attitudes.map(|q| q.coords * q.coords.transpose()).sum();
    let eigen = sum.symmetric_eigen();
    let mean = eigen.eigenvectors.column(eigen.eigenvalues.imax()).into_owned();
    UnitQuaternion::from_quaternion(Quaternion::from(mean))
}

/// Names the axes of all samples alike.
///
/// # Algorithm
/// Classification EM (Celeux & Govaert 1992, doi:10.1016/0167-9473(92)90042-E): under the mean and
/// scatter of roots and attitudes so far, each sample takes the likeliest of its 24 labels; mean
/// and scatter are taken anew; until no label changes. Nearness in attitude and in the moments count
/// together, each in units of its own scatter: axes that point the same way stay together where
/// moments cross, moments that differ stay apart where axes turn. Three starts: axes ordered by
/// moment, the nearest to those of the mean matrix, the nearest to those of the middle sample. The
/// most likely outcome is taken. The samples come in ascending order of their first entry.
pub(super) fn matched(samples: &[Sample], mean_axes: &UnitQuaternion<f64>) -> Matched {
    let nearest = |reference: &UnitQuaternion<f64>, ordered: bool| -> Vec<Sample> {
        let near = |s: &Sample| {
            let candidates = Relabeling::all().iter().map(|g| s.relabeled(g));
            let kept = candidates.filter(|s| !ordered || s.roots.is_sorted());
            let score = |s: &Sample| s.attitude.coords.dot(&reference.coords).abs();
            kept.reduce(|best, s| if score(&s) > score(&best) + TIE { s } else { best })
                .unwrap_or(*s)
        };
        samples.iter().map(near).collect()
    };
    let middle = samples.get(samples.len() / 2);
    // Ordered itself: from another order of its axes, all ways to point them are equally far.
    let reference = middle.and_then(ordered).map_or(*mean_axes, |middle| {
        mean_attitude(nearest(&middle.attitude, true).iter().map(|s| &s.attitude))
    });
    let starts = [
        nearest(&reference, true),
        nearest(mean_axes, false),
        nearest(&middle.map_or(*mean_axes, |s| s.attitude), false),
    ];
    let mut best: Option<(f64, Matched)> = None;
    for start in starts {
        let (height, matched) = iterate(start);
        if best.as_ref().is_none_or(|(highest, _)| height > *highest + LIKELIER) {
            best = Some((height, matched));
        }
    }
    best.map_or_else(|| iterate(samples.to_vec()).1, |(_, matched)| matched)
}

/// A sample with its roots in ascending order.
fn ordered(sample: &Sample) -> Option<Sample> {
    let mut all = Relabeling::all().iter().map(|g| sample.relabeled(g));
    all.find(|s| s.roots.is_sorted())
}

fn iterate(mut samples: Vec<Sample>) -> (f64, Matched) {
    let mut centre = Centre::of(&samples);
    for _ in 0..ROUNDS {
        let mut changed = 0;
        for sample in &mut samples {
            let label = centre.label(sample);
            if label != 0 {
                *sample = sample.relabeled(&Relabeling::all()[label]);
                changed += 1;
            }
        }
        if changed == 0 {
            // The scatter is that of the samples: their squared distances add up to a constant.
            let height = -centre.ln_scale;
            return (height, Matched { samples, converged: true });
        }
        centre = Centre::of(&samples);
    }
    let height = -centre.ln_scale;
    (height, Matched { samples, converged: false })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::RngExt;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
    use rand_distr::{Distribution, StandardNormal};

    /// Draws, with labels changed at random, and how many come back with labels that differ from the
    /// truth by more than one relabeling of all.
    fn misnamed(means: [f64; 3], deviation: f64, turn: f64, n: usize) -> usize {
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        let mean = UnitQuaternion::from_euler_angles(0.5, -0.3, 0.7);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let truth: Vec<Sample> = (0..n)
            .map(|_| Sample {
                roots: means.map(|m| m + deviation * normal()),
                attitude: UnitQuaternion::from_scaled_axis(
                    Vector3::new(normal(), normal(), normal()) * turn,
                ) * mean,
            })
            .collect();
        let shuffled: Vec<Sample> = truth
            .iter()
            .map(|s| s.relabeled(&Relabeling::all()[rng.random_range(0..24)]))
            .collect();
        let found = matched(&shuffled, &shuffled[0].attitude);
        assert!(found.converged);
        let same = |a: &Sample, b: &Sample| a.attitude.angle_to(&b.attitude) < 1e-9;
        let wrong = |g: &Relabeling| {
            let pairs = truth.iter().zip(&found.samples);
            pairs.filter(|(t, f)| !same(&t.relabeled(g), f)).count()
        };
        Relabeling::all().iter().map(wrong).min().unwrap()
    }

    #[test]
    fn distinct_moments_and_narrow_axes_come_back() {
        assert_eq!(misnamed([40.0, 50.0, 60.0], 1.0, 0.02, 1000), 0);
    }

    /// The order of the moments changes from sample to sample; the axes do not.
    #[test]
    fn axes_stay_together_where_moments_cross() {
        assert_eq!(misnamed([40.0, 40.1, 60.0], 1.0, 0.02, 1000), 0);
        assert_eq!(misnamed([40.0, 40.0, 40.0], 1.0, 0.02, 1000), 0);
    }

    /// Axes turn past 45°, where the nearest naming is wrong; the moments say which is which.
    /// Signs cannot be told beyond a quarter turn.
    #[test]
    fn moments_stay_apart_where_axes_turn() {
        let wrong = misnamed([30.0, 45.0, 60.0], 0.5, 0.4, 1000);
        assert!(wrong < 20, "{wrong}");
    }
}
