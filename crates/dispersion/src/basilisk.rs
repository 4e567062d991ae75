//! The dispersion of inertia in Basilisk's Monte Carlo.

use gyradius_inertia::{Inertia, InertiaMatrix, MAX_ENTRY};
use nalgebra::{Matrix3, SMatrix};
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::TAU;

use crate::entry_moments::ENTRIES;
use crate::named_model::{NamedModel, NoMatch, inertia_law};
use crate::{EntryMoments, KnownMoments, ModelParameterError, ModelParameters, normal};

mod density;

/// Largest deviation and finite bound, so that draws stay in range.
const MAX_DEVIATION: f64 = MAX_ENTRY / 1e3;
/// Largest standard deviation of the angles by which they are matched, rad: beyond, turns say nothing of products.
const MAX_TURN: f64 = 1.0;

/// Why parameters are refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BasiliskError {
    /// A deviation is negative, NaN or too large.
    #[error("{which} deviation = {value:?} {unit}: it must lie in [0, {max:.1e}]")]
    Deviation {
        /// `diagonal` or `angle`.
        which: &'static str,
        /// The deviation.
        value: f64,
        /// Its unit.
        unit: &'static str,
        /// What is allowed at most.
        max: f64,
    },
    /// A bound is NaN, or the second is below the first.
    #[error(
        "bounds from {low:?} to {high:?} kg·m²: they must be numbers, the second not below the first; \
         infinite ones are allowed"
    )]
    Bounds {
        /// The smaller bound, kg·m².
        low: f64,
        /// The larger bound, kg·m².
        high: f64,
    },
}

/// The inertia dispersion of the Basilisk simulator: the diagonal moved, then the whole turned by
/// three small angles.
///
/// # Definition
/// I = C (Ī + diag(e₁, e₂, e₃)) Cᵀ with e_i ~ N(0, σ_d²) independent and cut to bounds (a draw outside is
/// *put on* the bound, not drawn again), and C = C₁(φ) C₂(θ) C₃(ψ) the direction cosines of the 3-2-1 Euler
/// angles (ψ, θ, φ) ~ N(0, σ_a²) independent. All three e have one deviation, whatever the moments.
/// Drawn in the order e₁, e₂, e₃, ψ, θ, φ.
///
/// Mean and covariance of the entries are closed: those of the e by the error function; entries of
/// C are trigonometric polynomials, whose Gaussian means are sums of e^{−n²σ²/2}.
///
/// # Realizability
/// None: the e know nothing of the triangle inequality, and what the nominal body's axes are plays no
/// part, for the diagonal is that of the body frame. Draws are [`InertiaMatrix`].
///
/// # Differences from the original
/// Generators are others (Python's and NumPy's there), so draws agree in law and not in bits. There the
/// bounds are ±1 kg·m² unless they are given, whatever the moments are, and the same run number gives
/// every campaign the same draws; here bounds have to be given, and are infinite for none.
///
/// # Source
/// `InertiaTensorDispersion.generate` in `src/utilities/MonteCarlo/Dispersions.py` and `euler3212C` in
/// `RigidBodyKinematics.py` of AVSLab/basilisk. Here as a baseline.
#[derive(Clone, Copy, Debug, PartialEq, getset::CopyGetters, getset::Getters)]
pub struct BasiliskDispersion {
    /// The nominal matrix.
    #[getset(get = "pub")]
    nominal: InertiaMatrix,
    /// σ_d, kg·m².
    #[getset(get_copy = "pub")]
    diagonal_deviation: f64,
    /// Bounds of what is added to the diagonal, kg·m².
    #[getset(get_copy = "pub")]
    bounds: [f64; 2],
    /// σ_a, rad.
    #[getset(get_copy = "pub")]
    angle_deviation: f64,
}

impl BasiliskDispersion {
    /// The bounds that Basilisk takes if none are given, kg·m².
    pub const DEFAULT_BOUNDS: [f64; 2] = [-1.0, 1.0];

    /// No bounds. They are kept as the largest numbers that serve.
    pub const NO_BOUNDS: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

    /// Nominal matrix, deviation of the diagonal in kg·m² (`stdDiag`), bounds of what is added to
    /// it in kg·m² (`boundsDiag`), deviation of the angles in rad (`stdAngle`).
    ///
    /// # Errors
    /// A deviation is negative, NaN or too large (angles: above 2π), or bounds are NaN or in the wrong
    /// order.
    pub fn new(
        nominal: impl Into<InertiaMatrix>,
        diagonal_deviation: f64,
        bounds: [f64; 2],
        angle_deviation: f64,
    ) -> Result<Self, BasiliskError> {
        for (which, value, unit, max) in [
            ("diagonal", diagonal_deviation, "kg·m²", MAX_DEVIATION),
            ("angle", angle_deviation, "rad", TAU),
        ] {
            if !(0.0..=max).contains(&value) {
                return Err(BasiliskError::Deviation { which, value, unit, max });
            }
        }
        let [low, high] = bounds;
        if !(low <= high) {
            return Err(BasiliskError::Bounds { low, high });
        }
        let bounds = bounds.map(|b| b.clamp(-MAX_DEVIATION, MAX_DEVIATION));
        Ok(Self { nominal: nominal.into(), diagonal_deviation, bounds, angle_deviation })
    }

    /// Mean and variance of what is added to the diagonal.
    fn diagonal_moments(&self) -> (f64, f64) {
        let s = self.diagonal_deviation;
        if s == 0.0 {
            return (0.0_f64.clamp(self.bounds[0], self.bounds[1]), 0.0);
        }
        // In deviations. Below α and above β all is at the bound.
        let [a, b] = self.bounds.map(|x| (x / s).clamp(-40.0, 40.0));
        let (below, above) = (normal::below(a), normal::above(b));
        let phi = |t: f64| libm::exp(-0.5 * t * t) / TAU.sqrt();
        let mean = a * below + b * above + phi(a) - phi(b);
        let square =
            a * a * below + b * b * above + (1.0 - below - above) + a * phi(a) - b * phi(b);
        (s * mean, s * s * (square - mean * mean).max(0.0))
    }
}

/// C₁(φ) C₂(θ) C₃(ψ).
fn direction_cosines([psi, theta, phi]: [f64; 3]) -> Matrix3<f64> {
    let (s1, c1) = libm::sincos(psi);
    let (s2, c2) = libm::sincos(theta);
    let (s3, c3) = libm::sincos(phi);
    Matrix3::new(
        c2 * c1,
        c2 * s1,
        -s2,
        s3 * s2 * c1 - c3 * s1,
        s3 * s2 * s1 + c3 * c1,
        s3 * c2,
        c3 * s2 * c1 + s3 * s1,
        c3 * s2 * s1 - s3 * c1,
        c3 * c2,
    )
}

impl KnownMoments for BasiliskDispersion {
    fn entry_moments(&self) -> EntryMoments {
        /// Nodes that are exact for polynomials of degree 4 in sine and cosine.
        const NODES: usize = 9;
        let (shift, variance) = self.diagonal_moments();
        let centre = self.nominal.matrix() + Matrix3::from_diagonal_element(shift);
        let angles: [f64; NODES] = std::array::from_fn(|j| TAU * j as f64 / NODES as f64);
        // Σ w f(θ) = E f under the Gaussian: E cos nθ = e^{−n²σ²/2}. Without any scatter all of the weight is on the first node; what
        // scatter takes from there is computed as such, so that small variances have all their digits.
        let taken = |n: f64| libm::expm1(-0.5 * (n * self.angle_deviation).powi(2));
        let weights: [f64; NODES] = std::array::from_fn(|j| {
            let shift = |n: f64| taken(n) * libm::cos(n * angles[j]);
            let sum: f64 = (1..5).map(f64::from).map(shift).sum();
            f64::from(u8::from(j == 0)) + 2.0 * sum / NODES as f64
        });
        let mut nodes = Vec::with_capacity(NODES * NODES * NODES);
        for i in 0..NODES {
            for j in 0..NODES {
                for k in 0..NODES {
                    let c = direction_cosines([angles[i], angles[j], angles[k]]);
                    let turned = c * centre * c.transpose();
                    nodes.push((weights[i] * weights[j] * weights[k], c, turned));
                }
            }
        }
        let entries = |m: &Matrix3<f64>| ENTRIES.map(|(i, j)| m[(i, j)]);
        let mean: [f64; 6] = nodes.iter().fold([0.0; 6], |mut sum, (w, _, turned)| {
            for (sum, x) in sum.iter_mut().zip(entries(turned)) {
                *sum += w * x;
            }
            sum
        });
        let mut covariance = SMatrix::<f64, 6, 6>::zeros();
        for (w, c, turned) in &nodes {
            let turned = entries(turned);
            let columns: [[f64; 6]; 3] =
                std::array::from_fn(|k| ENTRIES.map(|(i, j)| c[(i, k)] * c[(j, k)]));
            for e in 0..6 {
                for f in 0..6 {
                    let of_e: f64 = columns.iter().map(|x| x[e] * x[f]).sum();
                    covariance[(e, f)] +=
                        w * ((turned[e] - mean[e]) * (turned[f] - mean[f]) + variance * of_e);
                }
            }
        }
        let mut covariance = (covariance + covariance.transpose()) * 0.5;
        // Where an entry moves to second order in the angles alone, rounding may be more than all of it.
        for e in 0..6 {
            covariance[(e, e)] = covariance[(e, e)].max(0.0);
        }
        EntryMoments::unchecked(mean, covariance)
    }
}

impl Distribution<InertiaMatrix> for BasiliskDispersion {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> InertiaMatrix {
        let [low, high] = self.bounds;
        loop {
            let mut normal = || -> f64 { StandardNormal.sample(rng) };
            let diagonal = [(); 3].map(|()| (self.diagonal_deviation * normal()).clamp(low, high));
            let angles = [(); 3].map(|()| self.angle_deviation * normal());
            let c = direction_cosines(angles);
            let moved = self.nominal.matrix() + Matrix3::from_diagonal(&diagonal.into());
            // Refused only where the nominal matrix lies at the edge of the floating-point range.
            if let Ok(matrix) = InertiaMatrix::new(c * moved * c.transpose()) {
                return matrix;
            }
        }
    }
}

inertia_law!(BasiliskDispersion, draws InertiaMatrix);

impl NamedModel for BasiliskDispersion {
    const NAME: &'static str = "basilisk";
    const DESCRIPTION: &'static str = "Gaussian diagonal, then three Gaussian Euler angles";
    const IS_REALIZABLE: bool = false;
    const NEEDS: &'static [&'static str] = &["diagonal_deviation_kg_m2", "angle_deviation_rad"];

    fn defaults() -> ModelParameters {
        let diagonal_bounds_kg_m2 = Some(Self::NO_BOUNDS);
        ModelParameters { diagonal_bounds_kg_m2, ..ModelParameters::default() }
    }

    fn about(nominal: &Inertia, given: &ModelParameters) -> Result<Self, ModelParameterError> {
        const DIAGONAL: &str = "diagonal_deviation_kg_m2";
        const ANGLE: &str = "angle_deviation_rad";
        let diagonal =
            given.diagonal_deviation_kg_m2.ok_or(ModelParameterError::missing(DIAGONAL))?;
        let angle = given.angle_deviation_rad.ok_or(ModelParameterError::missing(ANGLE))?;
        let bounds = given.diagonal_bounds_kg_m2.unwrap_or(Self::NO_BOUNDS);
        Self::new(*nominal, diagonal, bounds, angle).map_err(|error| {
            let key = match error {
                BasiliskError::Bounds { .. } => "diagonal_bounds_kg_m2",
                BasiliskError::Deviation { which: "angle", .. } => ANGLE,
                BasiliskError::Deviation { .. } => DIAGONAL,
            };
            ModelParameterError::new(key, &error)
        })
    }

    fn matched(
        mean: InertiaMatrix,
        moments: &EntryMoments,
    ) -> Result<(Self, &'static str), NoMatch> {
        const WHAT: &str =
            "the mean as its nominal matrix; variances summed over moments and over products";
        const STEPS: usize = 100;
        let sums = |c: &SMatrix<f64, 6, 6>| {
            let of = |range: std::ops::Range<usize>| range.map(|e| c[(e, e)]).sum::<f64>();
            (of(0..3), of(3..6))
        };
        let (of_moments, products) = sums(moments.covariance());
        let (mut diagonal, mut angle) = (of_moments / 3.0, 1e-4);
        if products == 0.0 {
            angle = 0.0;
        }
        let none = Self::NO_BOUNDS;
        let square = mean.matrix().amax().powi(2);
        for _ in 0..STEPS {
            let law = Self::new(mean, diagonal.sqrt(), none, angle)?;
            let found = sums(law.entry_moments().covariance());
            // What arithmetic leaves: turns of any size have weights of the square of the angle.
            let of_turns = (f64::EPSILON + angle * angle) * square;
            let rounding = 64.0 * f64::EPSILON * (of_turns + of_moments);
            let close = |a: f64, b: f64| (a - b).abs() <= 1e-6 * b + rounding;
            if close(found.0, of_moments) && close(found.1, products) {
                return Ok((law, WHAT));
            }
            diagonal = (diagonal + (of_moments - found.0) / 3.0).max(0.0);
            if products > 0.0 {
                if !(found.1 > 0.0) {
                    break;
                }
                angle *= (products / found.1).sqrt().clamp(0.1, 10.0);
            }
            if angle > MAX_TURN {
                break;
            }
        }
        Err("no turn of the axes by small angles gives the products this spread: the moments of the body \
             are too alike, or their own spread is smaller than the turns make it"
            .into())
    }
}

crate::written!(
    BasiliskDispersion,
    |law| {
        nominal_kg_m2: InertiaMatrix = law.nominal,
        diagonal_deviation_kg_m2: f64 = law.diagonal_deviation,
        diagonal_bounds_kg_m2: [f64; 2] = law.bounds,
        angle_deviation_rad: f64 = law.angle_deviation,
    },
    BasiliskDispersion::new(
        nominal_kg_m2,
        diagonal_deviation_kg_m2,
        diagonal_bounds_kg_m2,
        angle_deviation_rad,
    )?
);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::entry_moments::tests::check_entries;
    use nalgebra::Vector3;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    const NONE: [f64; 2] = BasiliskDispersion::NO_BOUNDS;

    fn payload() -> InertiaMatrix {
        InertiaMatrix::from_entries([5.0, 4.0, 3.0], [0.3, 0.2, -0.5]).unwrap()
    }

    #[test]
    fn draws_have_the_moments() {
        let cases = [
            (0.5, NONE, 0.1),
            (0.5, NONE, 0.0),
            (0.0, NONE, 0.3),
            (0.5, [-0.3, 0.6], 0.05),
            (10.0, BasiliskDispersion::DEFAULT_BOUNDS, 2.0),
            (0.1, [0.3, 0.6], 0.7),
        ];
        for (i, (diagonal, bounds, angle)) in cases.into_iter().enumerate() {
            let law = BasiliskDispersion::new(payload(), diagonal, bounds, angle).unwrap();
            let seed = 130 + i as u64;
            check_entries::<InertiaMatrix>(&format!("{i}"), &law.entry_moments(), &law, seed);
        }
    }

    /// Small deviations, down to none: to first order a small turn v takes I to I + [v×]I − I[v×], and what is put on the diagonal
    /// comes to that.
    #[test]
    fn small_deviations_have_their_digits() {
        let nominal = payload();
        let units: [Matrix3<f64>; 3] = std::array::from_fn(|k| Vector3::ith(k, 1.0).cross_matrix());
        for angle in [0.0, 1e-14, 1e-11, 1e-9, 1e-6, 1e-4] {
            for diagonal in [0.0, 1e-15, 1e-9, 1e-3] {
                let law = BasiliskDispersion::new(nominal, diagonal, NONE, angle).unwrap();
                let moments = law.entry_moments();
                for (e, (i, j)) in ENTRIES.into_iter().enumerate() {
                    let turned = units.map(|unit| {
                        (unit * nominal.matrix() - nominal.matrix() * unit)[(i, j)] * angle
                    });
                    let own = if i == j { diagonal } else { 0.0 };
                    let expected = turned.into_iter().chain([own]).map(|x| x * x).sum::<f64>();
                    let found = moments.covariance()[(e, e)];
                    let reach =
                        1e-6 * expected + (1e-15 + 20.0 * angle * (angle + diagonal)).powi(2);
                    assert!(
                        (found - expected).abs() <= reach,
                        "{angle} {diagonal} {e}: {found} {expected}"
                    );
                    assert!(found >= 0.0 && moments.deviations()[e].is_finite());
                }
            }
        }
        // Equal moments, which a small angle moves to second order: nearly nothing, and no NaN.
        let equal = InertiaMatrix::from_entries([2.0, 2.0, 3.0], [0.0; 3]).unwrap();
        for angle in [1e-14, 1e-11, 1e-9, 1e-8, 1e-7, 1e-6] {
            let law = BasiliskDispersion::new(equal, 0.0, NONE, angle).unwrap();
            for deviation in law.entry_moments().deviations() {
                assert!((0.0..2.0 * angle).contains(&deviation), "{angle} {deviation}");
            }
        }
    }

    /// The transform of the original, evaluated by NumPy for given deviations and angles.
    #[test]
    fn the_turn_is_the_originals() {
        let c = direction_cosines([0.1, -0.2, 0.3]);
        // (C₁(0.3) C₂(−0.2) C₃(0.1)) by three matrices.
        let first = Matrix3::new(
            1.0,
            0.0,
            0.0,
            0.0,
            0.3_f64.cos(),
            0.3_f64.sin(),
            0.0,
            -0.3_f64.sin(),
            0.3_f64.cos(),
        );
        let (s, t) = (-0.2_f64.sin(), 0.2_f64.cos());
        let second = Matrix3::new(t, 0.0, -s, 0.0, 1.0, 0.0, s, 0.0, t);
        let (s, t) = (0.1_f64.sin(), 0.1_f64.cos());
        let third = Matrix3::new(t, s, 0.0, -s, t, 0.0, 0.0, 0.0, 1.0);
        assert!((c - first * second * third).amax() < 1e-15);
    }

    /// What was measured of the original with σ_d a tenth of the largest moment and no bounds.
    #[test]
    fn the_share_of_impossible_draws_is_the_originals() {
        const N: usize = 50_000;
        for (moments, expected, allowed) in [
            ([900.0, 800.0, 600.0], 0.0007, 0.0005),
            ([1000.0, 1200.0, 1800.0], 0.10, 0.01),
            ([2000.0, 15000.0, 15500.0], 0.44, 0.01),
        ] {
            let nominal = InertiaMatrix::from_entries(moments, [0.0; 3]).unwrap();
            let deviation = 0.1 * moments.iter().fold(0.0_f64, |a, b| a.max(*b));
            let law = BasiliskDispersion::new(nominal, deviation, NONE, 0.01).unwrap();
            let mut rng = ChaCha8Rng::seed_from_u64(140);
            let bad = (0..N).filter(|_| !law.sample(&mut rng).is_realizable()).count();
            let share = bad as f64 / N as f64;
            assert!((share - expected).abs() < allowed, "{moments:?}: {share}");
        }
    }

    #[test]
    fn draws_outside_the_bounds_are_put_on_them() {
        let law = BasiliskDispersion::new(payload(), 100.0, [-1.0, 1.0], 0.0).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(141);
        let on_bound = (0..1000)
            .map(|_| law.sample(&mut rng).entries()[0] - 5.0)
            .inspect(|e| assert!(e.abs() <= 1.0 + 1e-15))
            .filter(|e| e.abs() == 1.0)
            .count();
        // All but P(|z| < 0.01) = 0.8 %.
        assert!(on_bound > 970, "{on_bound}");
    }

    #[test]
    fn bad_parameters_are_named() {
        let with = |d, b, a| BasiliskDispersion::new(payload(), d, b, a).unwrap_err().to_string();
        assert!(with(-1.0, NONE, 0.1).contains("diagonal deviation"));
        assert!(with(1.0, NONE, f64::NAN).contains("angle deviation"));
        assert!(with(1.0, NONE, 10.0).contains("rad"));
        assert!(with(1.0, [1.0, -1.0], 0.1).contains("bounds"));
        assert!(with(1.0, [f64::NAN, 1.0], 0.1).contains("bounds"));
    }
}
