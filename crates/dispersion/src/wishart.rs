//! The model of maximum entropy: a Wishart law of the second moment matrix.

use gyradius_inertia::{Inertia, InertiaMatrix};
use nalgebra::{Matrix3, SMatrix};
use rand::Rng;
use rand_distr::{ChiSquared, Distribution, StandardNormal};

use crate::entry_moments::ENTRIES;
use crate::named_model::{NamedModel, NoMatch, inertia_law};
use crate::second_moment_matrix::{body, inertia_covariance, inertia_map};
use crate::{EntryMoments, KnownMoments, ModelParameterError, ModelParameters};
use density::Density;

mod density;

/// Least dispersion that is told from none.
const MIN_DELTA: f64 = 1e-7;
/// Largest mean, so that draws and covariances stay in range.
const MAX_MEAN: f64 = 1e150;

/// Why a mean and a dispersion are refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WishartError {
    /// The dispersion parameter is out of range.
    #[error(
        "dispersion δ = {value:?}: it must be 0 or lie in [{MIN_DELTA:e}, √2), for there is no such law \
         of 3×3 matrices beyond"
    )]
    Delta {
        /// The parameter.
        value: f64,
    },
    /// The mean is too large.
    #[error("mean with a trace of {trace:e} kg·m²: it must be at most {MAX_MEAN:e}")]
    Mean {
        /// tr I, kg·m².
        trace: f64,
    },
}

/// Second mass moments from the maximum-entropy law of positive matrices (Soize 2000; for rigid
/// bodies after Batou & Soize 2012): a Wishart law.
///
/// # Definition
/// Σ = ½ tr(I)·1 − I = Mᵀ G M with Σ̄ = MᵀM the second moments of the mean body, and G of mean 1 with
/// the density ∝ det(G)^{2(1−δ²)/δ²} exp(−2 tr(G)/δ²) over the positive definite 3×3 matrices, which
/// of all laws with that mean and a finite E ln det G has the largest entropy, given δ. It is a
/// Wishart law of p = 4/δ² degrees of freedom, divided by p. δ is the one parameter: δ² = E‖G − 1‖²/‖1‖²
/// (Frobenius norms).
///
/// Mean and covariance are closed: E Σ = Σ̄, Cov(Σ_ij, Σ_kl) = (Σ̄_ik Σ̄_jl + Σ̄_il Σ̄_jk)/p, whence those of
/// the entries of I, which are linear in Σ. The mean inertia is kept exactly.
///
/// # Realizability
/// By construction: Σ is positive definite, or singular where Σ̄ is.
///
/// # Algorithm
/// Bartlett's decomposition (1933): p G = L Lᵀ, L lower triangular with χ² diagonals and normal entries
/// below.
///
/// # Limits
/// 0 ≤ δ < √2. From √½ on, E‖G⁻¹‖² is infinite, which Soize rules out for matrices that are to be
/// inverted: [`has_inverse_moments`](Self::has_inverse_moments). One number spreads everything:
/// moments and axes cannot be told apart, and a body known to 10 % has axes as loose as its shape
/// allows. Mass and mass centre, which Batou & Soize draw too, are left alone.
///
/// # Source
/// C. Soize (2000), doi:10.1016/S0266-8920(99)00028-4; A. Batou & C. Soize (2012), Rigid multibody system
/// dynamics with uncertain rigid bodies, doi:10.1007/s11044-011-9279-2.
///
/// ```
/// use gyradius_dispersion::{KnownMoments, Wishart};
/// use gyradius_inertia::{Inertia, InertiaMatrix};
///
/// let mean = InertiaMatrix::from_entries([5000.0, 4000.0, 3000.0], [20.0, 2.0, -50.0])?;
/// let law = Wishart::new(Inertia::try_from(mean)?, 0.05)?;
/// assert!((law.entry_moments().mean()[5] + 50.0).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, getset::CopyGetters, getset::Getters)]
pub struct Wishart {
    /// The mean body.
    #[getset(get = "pub")]
    mean: Inertia,
    /// δ.
    #[getset(get_copy = "pub")]
    delta: f64,
    /// M/√p, its rows √(K_k/p) r_k.
    root: Matrix3<f64>,
    squares: Option<[ChiSquared<f64>; 3]>,
    /// None where nothing varies, or the mean is a rod, a plate or a point.
    density: Option<Density>,
}

impl Wishart {
    /// The mean body and the dispersion parameter δ; zero keeps the body as it is.
    ///
    /// # Errors
    /// δ is not 0 and not in [1e-7, √2), or the trace of the mean is above 1e150 kg·m².
    pub fn new(mean: Inertia, delta: f64) -> Result<Self, WishartError> {
        let refused = WishartError::Delta { value: delta };
        if !(delta == 0.0 || (MIN_DELTA..std::f64::consts::SQRT_2).contains(&delta)) {
            return Err(refused);
        }
        let trace = mean.matrix().trace();
        if !(trace <= MAX_MEAN) {
            return Err(WishartError::Mean { trace });
        }
        let axes = mean.principal_axes();
        let roots = mean.second_moments().roots().values();
        let turn = axes.attitude().to_rotation_matrix();
        let mut root = Matrix3::from_diagonal(&roots.into()) * turn.matrix();
        let (mut squares, mut density) = (None, None);
        if delta > 0.0 {
            let freedom = 4.0 / (delta * delta);
            root /= freedom.sqrt();
            let square = |k: f64| ChiSquared::new(freedom - k).map_err(|_| refused);
            squares = Some([square(0.0)?, square(1.0)?, square(2.0)?]);
            density = Density::new(freedom, roots, turn.matrix());
        }
        Ok(Self { mean, delta, root, squares, density })
    }

    /// Degrees of freedom p = 4/δ², infinite where nothing varies.
    #[must_use]
    pub fn degrees_of_freedom(&self) -> f64 {
        4.0 / (self.delta * self.delta)
    }

    /// The logarithm of the density of I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃ in kg·m²; −∞ of a matrix that no body has. None where
    /// nothing varies, and where the mean is a rod, a plate or a point, which all draws then are. On the boundary, at
    /// rods, plates and points, it is zero where p > 4, δ < 1, and infinite where p < 4.
    #[must_use]
    pub fn ln_density(&self, inertia: &InertiaMatrix) -> Option<f64> {
        let density = self.density.as_ref()?;
        if !inertia.is_realizable() {
            return Some(f64::NEG_INFINITY);
        }
        let mean = self.mean.as_inertia_matrix().second_moment_matrix();
        Some(density.ln_at(&(inertia.second_moment_matrix() - mean)))
    }

    /// Whether E‖G⁻¹‖² is finite, δ < √½, as Soize (2000) demands.
    #[must_use]
    pub fn has_inverse_moments(&self) -> bool {
        self.delta < std::f64::consts::FRAC_1_SQRT_2
    }
}

impl KnownMoments for Wishart {
    fn entry_moments(&self) -> EntryMoments {
        let s = self.mean.as_inertia_matrix().second_moment_matrix();
        let share = self.delta * self.delta / 4.0;
        let covariance = SMatrix::<f64, 6, 6>::from_fn(|e, f| {
            let ((i, j), (k, l)) = (ENTRIES[e], ENTRIES[f]);
            share * (s[(i, k)] * s[(j, l)] + s[(i, l)] * s[(j, k)])
        });
        EntryMoments::unchecked(self.mean.entries(), inertia_covariance(&covariance))
    }
}

impl Distribution<Inertia> for Wishart {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> Inertia {
        let Some(squares) = &self.squares else {
            return self.mean;
        };
        loop {
            let [a, b, c] = [0, 1, 2].map(|i| squares[i].sample(rng).sqrt());
            let mut normal = || -> f64 { StandardNormal.sample(rng) };
            let l = Matrix3::new(a, 0.0, 0.0, normal(), b, 0.0, normal(), normal(), c);
            // Σ = Mᵀ L Lᵀ M.
            if let Some(body) = body(&self.root.tr_mul(&l)) {
                return body;
            }
        }
    }
}

inertia_law!(Wishart, draws Inertia);

impl NamedModel for Wishart {
    const NAME: &'static str = "wishart";
    const DESCRIPTION: &'static str = "maximum-entropy (Wishart) second moments";
    const IS_REALIZABLE: bool = true;
    const NEEDS: &'static [&'static str] = &["delta"];

    fn about(nominal: &Inertia, given: &ModelParameters) -> Result<Self, ModelParameterError> {
        let delta = given.delta.ok_or(ModelParameterError::missing("delta"))?;
        Self::new(*nominal, delta).map_err(|e| ModelParameterError::new("delta", &e))
    }

    fn matched(
        mean: InertiaMatrix,
        moments: &EntryMoments,
    ) -> Result<(Self, &'static str), NoMatch> {
        const WHAT: &str = "mean, and the mean square of the change of the second moments";
        let mean = Inertia::try_from(mean)?;
        let sigma = mean.as_inertia_matrix().second_moment_matrix();
        let map = inertia_map().try_inverse().ok_or("no second moments")?;
        let spread = map * moments.covariance() * map.transpose();
        // Products count twice in the norm of a matrix.
        let square: f64 = (0..6).map(|e| spread[(e, e)] * if e < 3 { 1.0 } else { 2.0 }).sum();
        let size = sigma.norm_squared() + sigma.trace() * sigma.trace();
        let delta = if square == 0.0 { 0.0 } else { 2.0 * (square / size).sqrt() };
        Ok((Self::new(mean, delta)?, WHAT))
    }
}

crate::written!(
    Wishart,
    |law| { mean_kg_m2: Inertia = law.mean, delta: f64 = law.delta, },
    Wishart::new(mean_kg_m2, delta)?
);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::entry_moments::tests::check_entries;
    use gyradius_inertia::{InertiaMatrix, SecondMoments};
    use proptest::prelude::*;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    fn payload() -> Inertia {
        let mean = InertiaMatrix::from_entries([5.0, 4.0, 3.0], [0.3, 0.2, -0.5]).unwrap();
        Inertia::try_from(mean).unwrap()
    }

    #[test]
    fn draws_have_the_moments() {
        for (i, delta) in [0.0, 1e-3, 0.1, 0.5, 0.7, 1.3].into_iter().enumerate() {
            let law = Wishart::new(payload(), delta).unwrap();
            let seed = 100 + i as u64;
            check_entries::<Inertia>(&format!("δ = {delta}"), &law.entry_moments(), &law, seed);
        }
    }

    /// Close to √2 many draws are as flat as rounding can tell, where the density has no bound: as many as the documentation says.
    #[test]
    fn flat_draws_of_wide_laws_have_an_infinite_density() {
        const N: usize = 5000;
        for (delta, low, high) in [(1.2, 0.0, 0.0), (1.4, 0.27, 0.31)] {
            let law = Wishart::new(payload(), delta).unwrap();
            let mut rng = ChaCha8Rng::seed_from_u64(3);
            let flat = (0..N).filter(|_| {
                let drawn: Inertia = law.sample(&mut rng);
                law.ln_density(drawn.as_inertia_matrix()) == Some(f64::INFINITY)
            });
            let share = flat.count() as f64 / N as f64;
            assert!((low..=high).contains(&share), "{delta}: {share}");
        }
    }

    /// −E ln det G = Σ_i (ln(p/2) − ψ((p − i)/2)), which no other law of that mean and δ shares.
    #[test]
    fn the_determinant_is_a_product_of_chi_squares() {
        const N: usize = 100_000;
        let law = Wishart::new(payload(), 0.5).unwrap();
        let nominal = payload().as_inertia_matrix().second_moment_matrix().determinant().ln();
        let mut rng = ChaCha8Rng::seed_from_u64(110);
        let logs: Vec<f64> = (0..N)
            .map(|_| law.sample(&mut rng).as_inertia_matrix().second_moment_matrix())
            .map(|s| s.determinant().ln() - nominal)
            .collect();
        let mean = logs.iter().sum::<f64>() / N as f64;
        let variance = logs.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / N as f64;
        // p = 16: ψ(8) + ψ(15/2) + ψ(7) − 3 ln 8, scipy.special.digamma.
        let expected = -0.403_141_327_739_343;
        let z = (mean - expected) / (variance / N as f64).sqrt();
        assert!(z.abs() < 4.0, "{mean}: z = {z}");
    }

    /// Plates and rods stay what they are.
    #[test]
    fn boundary_bodies_stay_on_the_boundary() {
        let q = nalgebra::UnitQuaternion::from_euler_angles(0.4, -1.0, 2.0);
        let mut rng = ChaCha8Rng::seed_from_u64(111);
        for k in [[1.0, 2.0, 0.0], [1.0, 0.0, 0.0], [0.0; 3]] {
            let mean = Inertia::from_second_moments(SecondMoments::new(k).unwrap(), &q).unwrap();
            let law = Wishart::new(mean, 0.6).unwrap();
            check_entries::<Inertia>("plate", &law.entry_moments(), &law, 112);
            for _ in 0..1000 {
                let drawn = law.sample(&mut rng);
                let least = drawn.second_moments().values().into_iter().fold(1.0, f64::min);
                assert!(least < 1e-12, "{least}");
            }
        }
    }

    proptest! {
        #[test]
        fn no_draw_is_unrealizable(
            k in prop::array::uniform3(0.0..100.0f64),
            delta in 0.0..1.41f64,
            scale in -140.0..140.0f64,
            seed in 0..u64::MAX,
        ) {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let q = gyradius_attitude::UniformAttitude.sample(&mut rng);
            let k = SecondMoments::new(k.map(|k| k * 10f64.powf(scale))).unwrap();
            let law = Wishart::new(Inertia::from_second_moments(k, &q).unwrap(), delta).unwrap();
            for _ in 0..100 {
                prop_assert!(law.sample(&mut rng).as_inertia_matrix().is_realizable());
            }
        }
    }

    #[test]
    fn bad_parameters_are_named() {
        for bad in [-0.1, f64::NAN, 1.5, f64::INFINITY, 1e-9] {
            let error = Wishart::new(payload(), bad).unwrap_err();
            assert!(error.to_string().contains("δ"), "{error}");
        }
        let huge = SecondMoments::new([1e200; 3]).unwrap();
        let huge =
            Inertia::from_second_moments(huge, &nalgebra::UnitQuaternion::identity()).unwrap();
        assert!(Wishart::new(huge, 0.1).unwrap_err().to_string().contains("trace"));
        assert!(Wishart::new(payload(), 0.7).unwrap().has_inverse_moments());
        assert!(!Wishart::new(payload(), 0.71).unwrap().has_inverse_moments());
    }
}
