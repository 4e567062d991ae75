//! Random correlation coefficients of three lengths: C₁₂, C₁₃, C₂₃ with 1 on the diagonal, never indefinite.

use nalgebra::{Matrix3, Vector3};

use super::symmetric::with_eigenvalues;

/// Largest variance of a coordinate.
const MOST: f64 = 4.0;
/// Steps of the searches, and halvings of a step.
const STEPS: usize = 60;
const HALVINGS: usize = 8;
/// Nodes of the quadrature lie this far apart in deviations, up to this many.
const APART: f64 = 0.5;
const FAR: i32 = 10;
/// Of numerical derivatives.
const STEP: f64 = 1e-5;
/// Where a law has no such mean, one is tried whose deviations are this much smaller.
const NARROWER: f64 = 0.9;
/// Smallest deviation of a correlation that is sought, and how near the deviations come, in deviations.
const SMALLEST: f64 = 1e-9;
const SAME: f64 = 1e-6;
/// How near the means come.
const NEAR: f64 = 1e-12;

/// Three Gaussian coordinates z: C₁₂ = tanh z₁ and C₁₃ = tanh z₂ are correlations, tanh z₃ is the partial correlation of 2 and
/// 3 when 1 is known, so that every z has a correlation matrix and every positive definite one has a z (Joe 2006,
/// doi:10.1016/j.jmva.2005.05.010).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CorrelationLaw {
    mean: Vector3<f64>,
    root: Matrix3<f64>,
}

impl CorrelationLaw {
    /// The law of a mean and of a matrix E C Cᵀ as near as a search finds; none if the mean is not inside.
    pub(super) fn new(mean: &Vector3<f64>, squares: &Matrix3<f64>) -> Option<Self> {
        let start = coordinates(mean)?;
        let inverse = derivative(&start).try_inverse()?;
        let target = squares - mean * mean.transpose();
        let weights = target.diagonal().map(|x| 1.0 / x.max(SMALLEST * SMALLEST).sqrt());
        let project = |v: &Matrix3<f64>| with_eigenvalues(v, |x| x.clamp(0.0, MOST));
        let judge = |centre: &Vector3<f64>, variance: &Matrix3<f64>| {
            let law = Self::of(centre, variance);
            let (found, spread) = law.moments();
            let spread = spread - found * found.transpose();
            let gaps = (mean - found, target - spread);
            // In stated deviations, so that the smallest counts as the largest.
            let shift: Vector3<f64> = gaps.0.component_mul(&weights);
            let wider = gaps.1.component_mul(&(weights * weights.transpose()));
            let off = shift.norm_squared() + wider.norm_squared();
            off.is_finite().then_some((law, gaps, off))
        };
        let (mut centre, mut variance) =
            (start, project(&(inverse * target * inverse.transpose())));
        let (mut best, mut gaps, mut off) = judge(&centre, &variance)?;
        for _ in 0..STEPS {
            let (shift, wider) = (inverse * gaps.0, inverse * gaps.1 * inverse.transpose());
            let mut step = 1.0;
            let nearer = (0..HALVINGS).find_map(|_| {
                let next = (centre + shift * step, project(&(variance + wider * step)));
                step *= 0.5;
                judge(&next.0, &next.1).filter(|f| f.2 < off * (1.0 - 1e-3)).map(|f| (next, f))
            });
            let Some((next, found)) = nearer else { break };
            (centre, variance) = next;
            (best, gaps, off) = found;
            if off < SAME * SAME {
                break;
            }
        }
        best.with_mean(mean)
    }

    fn of(mean: &Vector3<f64>, variance: &Matrix3<f64>) -> Self {
        Self { mean: *mean, root: with_eigenvalues(variance, |x| x.max(0.0).sqrt()) }
    }

    /// The same with exactly this mean: the centre moves, and where that does not do, the law is narrower.
    fn with_mean(mut self, target: &Vector3<f64>) -> Option<Self> {
        for _ in 0..STEPS {
            let mut law = self.clone();
            let mut off = target - law.moments().0;
            for _ in 0..STEPS {
                if off.amax() < NEAR {
                    return Some(law);
                }
                let Some(inverse) = law.slope().try_inverse() else { break };
                let mut step = 1.0;
                let nearer = (0..HALVINGS).find_map(|_| {
                    let next = Self { mean: law.mean + inverse * off * step, root: law.root };
                    step *= 0.5;
                    let found = target - next.moments().0;
                    (found.norm() < 0.9 * off.norm()).then_some((next, found))
                });
                let Some(found) = nearer else { break };
                (law, off) = found;
            }
            self.root *= NARROWER;
        }
        None
    }

    /// Derivative of the mean of C by that of z.
    fn slope(&self) -> Matrix3<f64> {
        let by = |axis: usize| {
            let at = |step: f64| {
                Self { mean: self.mean + Vector3::ith(axis, step), root: self.root }.moments().0
            };
            (at(STEP) - at(-STEP)) / (2.0 * STEP)
        };
        Matrix3::from_columns(&[by(0), by(1), by(2)])
    }

    /// E C and E C Cᵀ by the trapezoidal rule, which converges faster than any power for a Gaussian.
    pub(super) fn moments(&self) -> (Vector3<f64>, Matrix3<f64>) {
        let (mut total, mut mean, mut squares) = (0.0, Vector3::zeros(), Matrix3::zeros());
        // Of each distance once: there are thousands of nodes, and a hundred distances.
        let weight = |square: i32| libm::exp(-0.5 * f64::from(square) * APART * APART);
        let weights: Vec<f64> = (0..=FAR * FAR).map(weight).collect();
        for i in -FAR..=FAR {
            for j in -FAR..=FAR {
                for k in -FAR..=FAR {
                    let square = i * i + j * j + k * k;
                    // Beyond the last of them nothing counts.
                    let Some(weight) = weights.get(square as usize).copied() else { continue };
                    let c = self.at(&(Vector3::new(i.into(), j.into(), k.into()) * APART));
                    total += weight;
                    mean += c * weight;
                    squares += c * c.transpose() * weight;
                }
            }
        }
        (mean / total, squares / total)
    }

    /// C₁₂, C₁₃, C₂₃ of three independent standard normal numbers.
    pub(super) fn at(&self, normal: &Vector3<f64>) -> Vector3<f64> {
        correlations(&(self.mean + self.root * normal))
    }
}

fn correlations(z: &Vector3<f64>) -> Vector3<f64> {
    let [a, b, t] = [z.x, z.y, z.z].map(libm::tanh);
    // √(1 − tanh²) = 1/cosh, without what cancels.
    let rest = 1.0 / (libm::cosh(z.x) * libm::cosh(z.y));
    Vector3::new(a, b, a * b + rest * t)
}

/// z of a correlation matrix; none if it is not positive definite.
fn coordinates(c: &Vector3<f64>) -> Option<Vector3<f64>> {
    let rest = ((1.0 - c.x * c.x) * (1.0 - c.y * c.y)).sqrt();
    let t = [c.x, c.y, (c.z - c.x * c.y) / rest];
    t.iter().all(|t| t.abs() < 1.0 - 1e-9).then(|| Vector3::from(t.map(libm::atanh)))
}

fn derivative(z: &Vector3<f64>) -> Matrix3<f64> {
    let by = |axis: usize| {
        let step = Vector3::ith(axis, STEP);
        (correlations(&(z + step)) - correlations(&(z - step))) / (2.0 * STEP)
    };
    Matrix3::from_columns(&[by(0), by(1), by(2)])
}
