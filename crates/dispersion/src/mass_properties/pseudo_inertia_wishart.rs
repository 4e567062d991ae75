//! A Wishart law of the pseudo-inertia: a rival of the joint law.

use gyradius_inertia::{MassProperties, PseudoInertia, PseudoInertiaError};
use nalgebra::{Cholesky, Matrix4, SMatrix, SVector, U4};
use rand::Rng;
use rand_distr::{ChiSquared, Distribution, StandardNormal};
use std::f64::consts::LN_2;

use super::model::draws_bodies;
use super::{MassPropertiesModel, TenMoments};

/// Fewer degrees of freedom have no density, and more are no scatter.
const FREEDOM: [f64; 2] = [4.0, 1e14];
/// Largest entry of the mean, so that covariances stay in range.
const MAX_ENTRY: f64 = 1e150;
/// Least entry on the diagonal of the mean, for the same reason.
const LEAST_ENTRY: f64 = 1e-150;
/// The least share of the largest entry that one on the diagonal may be, so that draws have a mass centre: √(Σ_ii/m) m and
/// more from the origin.
const LEAST_SHARE: f64 = 1e-180;

/// A Wishart law of the pseudo-inertia J = ∫ (x, 1)(x, 1)ᵀ dm: J = L G Lᵀ/p, L Lᵀ the mean and G a 4×4 Wishart matrix of p
/// degrees of freedom.
///
/// # Definition
/// E J = J̄ and Cov(J_ij, J_kl) = (J̄_ik J̄_jl + J̄_il J̄_jk)/p: one number spreads everything, mass and mass centre too. The
/// mass has the relative deviation √(2/p), and for whole p the body is p points at places from one Gaussian.
///
/// # Realizability
/// By construction: G is positive definite.
///
/// ```
/// use gyradius_dispersion::{MassPropertiesModel, PseudoInertiaWishart};
/// use gyradius_inertia::Shape;
///
/// let body = Shape::solid_box([1.0, 2.0, 3.0])?.of_mass(5.0)?;
/// let law = PseudoInertiaWishart::new(&body, 800.0)?;
/// let mass = law.linear_moments().deviations()[0];
/// assert!((mass - 0.05 * 5.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, getset::CopyGetters)]
pub struct PseudoInertiaWishart {
    mean: PseudoInertia,
    /// The degrees of freedom.
    #[getset(get_copy = "pub")]
    degrees_of_freedom: f64,
    /// L, lower triangular.
    root: Matrix4<f64>,
    squares: [ChiSquared<f64>; 4],
}

impl PseudoInertiaWishart {
    /// The mean body and the degrees of freedom p.
    ///
    /// # Errors
    /// p is not in [4, 1e14], or the body is a rod, a plate, a point, too large or too small, also in its mass beside its
    /// second moments.
    pub fn new(mean: &MassProperties, freedom: f64) -> Result<Self, PseudoInertiaWishartError> {
        Self::about(PseudoInertia::of(mean)?, freedom)
    }

    fn about(mean: PseudoInertia, freedom: f64) -> Result<Self, PseudoInertiaWishartError> {
        let refused = PseudoInertiaWishartError::Freedom { value: freedom };
        if !(FREEDOM[0]..=FREEDOM[1]).contains(&freedom) {
            return Err(refused);
        }
        let matrix = mean.matrix();
        let largest = matrix.amax();
        let singular = PseudoInertiaWishartError::Singular;
        if !(largest <= MAX_ENTRY) {
            return Err(PseudoInertiaWishartError::TooLarge { value: largest });
        }
        let least = LEAST_ENTRY.max(LEAST_SHARE * largest);
        let smallest = matrix.diagonal().min();
        if smallest > 0.0 && smallest < least {
            return Err(PseudoInertiaWishartError::TooSmall { value: smallest, least });
        }
        // Rows have different units: what is positive definite is the matrix of correlations.
        let sizes = matrix.diagonal().map(f64::sqrt);
        let unit = matrix.component_div(&(sizes * sizes.transpose()));
        let root = Cholesky::<f64, U4>::new(unit).ok_or(singular)?.l();
        if !(root.diagonal().min() > 1e-7) {
            return Err(singular);
        }
        let root = Matrix4::from_diagonal(&sizes) * root;
        let square = |k: f64| ChiSquared::new(freedom - k).map_err(|_| refused);
        let squares = [square(0.0)?, square(1.0)?, square(2.0)?, square(3.0)?];
        Ok(Self { mean, degrees_of_freedom: freedom, root, squares })
    }

    /// The mean body.
    #[must_use]
    pub fn mean(&self) -> MassProperties {
        self.mean.mass_properties()
    }

    /// Mean and covariance of the ten in which the equations of motion are linear, in closed form.
    #[must_use]
    pub fn linear_moments(&self) -> TenMoments {
        // Each of the ten as a sum of entries of J.
        const TRACES: [&[(usize, usize, f64)]; 10] = [
            &[(3, 3, 1.0)],
            &[(0, 3, 1.0)],
            &[(1, 3, 1.0)],
            &[(2, 3, 1.0)],
            &[(1, 1, 1.0), (2, 2, 1.0)],
            &[(0, 0, 1.0), (2, 2, 1.0)],
            &[(0, 0, 1.0), (1, 1, 1.0)],
            &[(0, 1, -1.0)],
            &[(0, 2, -1.0)],
            &[(1, 2, -1.0)],
        ];
        let j = self.mean.matrix();
        let sum = |f: &dyn Fn(usize, usize, usize, usize) -> f64, a: usize, b: usize| -> f64 {
            let terms = TRACES[a].iter().flat_map(|x| TRACES[b].iter().map(move |y| (x, y)));
            terms.map(|((i, k, s), (l, m, t))| s * t * f(*i, *k, *l, *m)).sum()
        };
        let mean = SVector::from_fn(|a, _| TRACES[a].iter().map(|(i, k, s)| s * j[(*i, *k)]).sum());
        let covariance = SMatrix::from_fn(|a, b| {
            let own = |i, k, l, m| {
                (j[(i, l)] * j[(k, m)] + j[(i, m)] * j[(k, l)]) / self.degrees_of_freedom
            };
            sum(&own, a, b)
        });
        TenMoments::unchecked(mean, covariance)
    }

    /// The logarithm of the density with respect to dm d³c dI₁₁ dI₂₂ dI₃₃ dI₁₂ dI₁₃ dI₂₃: that of the ten entries of J,
    /// times m³ for the mass centre in place of the first moments, over 2 for I in place of Σ.
    #[must_use]
    pub fn ln_density(&self, body: &MassProperties) -> f64 {
        let p = self.degrees_of_freedom;
        let Ok(pseudo) = PseudoInertia::of(body) else { return f64::NEG_INFINITY };
        let Some(whitened) = self.root.solve_lower_triangular(pseudo.matrix()) else {
            return f64::NEG_INFINITY;
        };
        let Some(whitened) = self.root.solve_lower_triangular(&whitened.transpose()) else {
            return f64::NEG_INFINITY;
        };
        let Some(root) = Cholesky::<f64, U4>::new((whitened + whitened.transpose()) * 0.5) else {
            return f64::NEG_INFINITY;
        };
        let ln_det = 2.0 * root.l().diagonal().map(libm::log).sum();
        let ln_mean = 2.0 * self.root.diagonal().map(libm::log).sum();
        // G = p J: its density at unit mean, and the Jacobian of J = L (G/p) Lᵀ, which is det(L Lᵀ)^{5/2}/p¹⁰.
        let gammas: f64 = (0..4).map(|k| libm::lgamma(0.5 * (p - f64::from(k)))).sum();
        let normaliser = 2.0 * p * LN_2 + 3.0 * std::f64::consts::PI.ln() + gammas;
        let exponent = 0.5 * (p - 5.0) * (ln_det + 4.0 * libm::log(p)) - 0.5 * p * whitened.trace();
        let of_j = exponent - normaliser + 10.0 * libm::log(p) - 2.5 * ln_mean;
        of_j + 3.0 * libm::log(body.mass_kg()) - LN_2
    }
}

crate::written!(
    PseudoInertiaWishart,
    |law| { mean: PseudoInertia = law.mean, degrees_of_freedom: f64 = law.degrees_of_freedom, },
    PseudoInertiaWishart::about(mean, degrees_of_freedom)?
);

impl Distribution<MassProperties> for PseudoInertiaWishart {
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> MassProperties {
        let share = self.degrees_of_freedom.sqrt();
        loop {
            // Bartlett's decomposition.
            let mut lower = Matrix4::zeros();
            for i in 0..4 {
                lower[(i, i)] = self.squares[i].sample(rng).sqrt() / share;
                for j in 0..i {
                    let z: f64 = StandardNormal.sample(rng);
                    lower[(i, j)] = z / share;
                }
            }
            let root = self.root * lower;
            if let Ok(pseudo) = PseudoInertia::new(root * root.transpose()) {
                return pseudo.mass_properties();
            }
        }
    }
}

impl MassPropertiesModel for PseudoInertiaWishart {
    draws_bodies!("pseudo-inertia-wishart");

    fn ln_density(&self, body: &MassProperties) -> Option<f64> {
        Some(self.ln_density(body))
    }

    fn linear_moments(&self) -> Option<TenMoments> {
        Some(self.linear_moments())
    }
}

/// Why a mean body and degrees of freedom are refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PseudoInertiaWishartError {
    /// The degrees of freedom are out of range.
    #[error("degrees of freedom = {value:?}: they must lie in [{:?}, {:e}]", FREEDOM[0], FREEDOM[1])]
    Freedom {
        /// The value.
        value: f64,
    },
    /// The mean body is none.
    #[error(transparent)]
    Mean(#[from] PseudoInertiaError),
    /// The mean body is a rod, a plate or a point.
    #[error(
        "the mean body is a rod, a plate or a point: no Wishart law has its pseudo-inertia as its mean"
    )]
    Singular,
    /// The mean body is too large.
    #[error(
        "largest entry of the mean pseudo-inertia = {value:e}: it must be at most {MAX_ENTRY:e}"
    )]
    TooLarge {
        /// The value.
        value: f64,
    },
    /// The mean body is too small, or its mass beside its second moments.
    #[error(
        "smallest entry on the diagonal of the mean pseudo-inertia = {value:e}: it must be at least {least:e}"
    )]
    TooSmall {
        /// The value.
        value: f64,
        /// The least that is allowed.
        least: f64,
    },
}

#[cfg(test)]
mod tests {
    use gyradius_inertia::Inertia;
    use nalgebra::{UnitQuaternion, Vector3};
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// Of any mass and size, as far as bodies have them: a law whose draws come to an end, or a refusal that says what is too small.
    #[test]
    fn laws_of_any_size_are_drawn_or_refused() {
        let mut rng = ChaCha8Rng::seed_from_u64(17);
        let (mut drawn, mut small) = (0, 0);
        for mass in (-300..=140).step_by(5) {
            for moment in (-300..=140).step_by(5) {
                let [mass, moment] = [mass, moment].map(|power| 10_f64.powi(power));
                let inertia =
                    Inertia::from_principal_moments([moment; 3], &UnitQuaternion::identity())
                        .unwrap();
                let Ok(body) = MassProperties::new(mass, Vector3::zeros(), inertia) else {
                    continue;
                };
                for freedom in [4.0, 20.0, 1e14] {
                    match PseudoInertiaWishart::new(&body, freedom) {
                        Ok(law) => {
                            for _ in 0..8 {
                                let draw = law.sample(&mut rng).mass_kg() / mass;
                                assert!(draw > 0.0 && draw < 1e3, "{mass:e} {moment:e}: {draw}");
                            }
                            drawn += 1;
                        }
                        Err(PseudoInertiaWishartError::TooSmall { value, least }) => {
                            assert!(value < least && value <= mass.min(moment), "{value:e}");
                            small += 1;
                        }
                        Err(error) => panic!("{mass:e} {moment:e}: {error}"),
                    }
                }
            }
        }
        assert!(drawn > 5000 && small > 1000, "{drawn} {small}");
        let ordinary = [1e-200, 1e-40, 1.0].map(|mass| {
            let inertia = Inertia::from_principal_moments([1e-30; 3], &UnitQuaternion::identity());
            let body = MassProperties::new(mass, Vector3::zeros(), inertia.unwrap()).unwrap();
            PseudoInertiaWishart::new(&body, 20.0).is_ok()
        });
        assert_eq!(ordinary, [false, true, true]);
    }
}
