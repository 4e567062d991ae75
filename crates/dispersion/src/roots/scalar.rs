//! Independent roots, each with a scalar law.

use gyradius_inertia::{PrincipalAxes, RootSecondMoments};
use rand::Rng;
use rand_distr::Distribution;

use super::{FAR, MAX_ROOT, ln_of_squares};
use crate::ln_sum::ln_sum;
use crate::{RootMoments, ScalarLaw, ScalarLawError, SecondMomentStatistics};

/// Independent roots k_k = √K_k, each with a law of its own of any kind.
///
/// # Definition
/// k₁, k₂, k₃ from three [`ScalarLaw`]s, in √kg·m, of any sign; K_k = k_k², and only that matters. Mean and
/// variance of K are those of the square of the law:
///
/// | law | E K | Var K |
/// |---|---|---|
/// | normal (Peck 2003, Eq. 10) | k̄² + σ² | 4k̄²σ² + 2σ⁴ |
/// | uniform, middle c and half width h | c² + h²/3 | 4c²h²/3 + 4h⁴/45 |
/// | lognormal, s² = ln(1 + σ²/k̄²) | k̄² + σ² | (E K)² (e^{4s²} − 1) |
/// | truncated normal | by Gauss and Legendre's rule to 1e-12, for an interval of any length | |
///
/// # Algorithm
/// Truncated normal laws are drawn by rejection, from the Gaussian where the bounds hold a quarter of it, else
/// from the uniform law on the interval or from an exponential at its near end (Robert 1995,
/// doi:10.1007/BF00143942).
///
/// ```
/// use gyradius_attitude::UniformAttitude;
/// use gyradius_dispersion::{EntryMoments, PrincipalDispersion, ScalarLaw, ScalarRoots};
///
/// let roots = ScalarRoots::new([
///     ScalarLaw::uniform(9.0, 12.0)?,
///     ScalarLaw::lognormal(8.0, 0.5)?,
///     ScalarLaw::truncated_normal(1.0, 0.5, 0.0, 2.0)?,
/// ])?;
/// let law = PrincipalDispersion::new(roots, UniformAttitude);
/// assert!(EntryMoments::of(&law).mean()[0] > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, getset::Getters)]
#[getset(get = "pub")]
pub struct ScalarRoots {
    /// The laws of k₁, k₂ and k₃, √kg·m.
    laws: [ScalarLaw; 3],
}

impl ScalarRoots {
    /// From the laws of k₁, k₂ and k₃ in √kg·m.
    ///
    /// # Errors
    /// Roots could come out beyond 1e75 √kg·m.
    pub fn new(laws: [ScalarLaw; 3]) -> Result<Self, ScalarRootsError> {
        for (i, law) in laws.iter().enumerate() {
            if !(law.reach(FAR) <= MAX_ROOT) {
                return Err(ScalarRootsError::Reach { axis: i + 1 });
            }
        }
        Ok(Self { laws })
    }

    /// Gaussian (Peck 2003, Eq. 10), from the means in √kg·m and the variances σ² in kg·m²; zero keeps a root
    /// fixed. A root may come out negative; only its square matters.
    ///
    /// # Errors
    /// A variance is negative or NaN, or roots could come out beyond 1e75 √kg·m.
    pub fn normal(mean: RootSecondMoments, variances: [f64; 3]) -> Result<Self, ScalarRootsError> {
        Self::each(mean, variances, |_, k, variance| {
            ScalarLaw::normal_of(k, variance.sqrt(), variance)
        })
    }

    /// Uniform between k̄ ± √3 σ, from the means in √kg·m and the variances σ² in kg·m².
    ///
    /// # Errors
    /// A variance is negative or NaN, or roots could come out beyond 1e75 √kg·m.
    pub fn uniform(mean: RootSecondMoments, variances: [f64; 3]) -> Result<Self, ScalarRootsError> {
        Self::each(mean, variances, |_, k, variance| {
            let half = (3.0 * variance).sqrt();
            ScalarLaw::uniform(k - half, k + half)
        })
    }

    /// Lognormal, factors of uncertainty, from the means in √kg·m and the variances in kg·m².
    ///
    /// # Errors
    /// A variance is negative or NaN, a mean is not positive where its variance is, or roots could come out
    /// beyond 1e75 √kg·m.
    pub fn lognormal(
        mean: RootSecondMoments,
        variances: [f64; 3],
    ) -> Result<Self, ScalarRootsError> {
        Self::each(mean, variances, |_, k, variance| {
            // What has no thickness keeps none, and draws nothing.
            if k == 0.0 && variance == 0.0 {
                return ScalarLaw::truncated_normal(0.0, 0.0, 0.0, 0.0);
            }
            ScalarLaw::lognormal_of(k, variance.sqrt(), variance)
        })
    }

    /// Gaussian, kept between the bounds [low, high] in √kg·m, which may be infinite and are then kept as ±1e75;
    /// means in √kg·m and variances in kg·m² are those before. A variance of zero keeps a root at its mean,
    /// which must lie within the bounds.
    ///
    /// # Errors
    /// A variance is negative or NaN, roots could come out beyond 1e75 √kg·m, a bound is NaN, the second is
    /// not above the first, or the mean is more than 6σ outside of them.
    pub fn truncated_normal(
        mean: RootSecondMoments,
        variances: [f64; 3],
        bounds: [[f64; 2]; 3],
    ) -> Result<Self, ScalarRootsError> {
        let bounds = bounds.map(|b| b.map(|x| x.clamp(-MAX_ROOT, MAX_ROOT)));
        Self::each(mean, variances, |i, k, variance| {
            let [low, high] = bounds[i];
            ScalarLaw::truncated_normal(k, variance.sqrt(), low, high)
        })
    }

    fn each(
        mean: RootSecondMoments,
        variances: [f64; 3],
        law: impl Fn(usize, f64, f64) -> Result<ScalarLaw, ScalarLawError>,
    ) -> Result<Self, ScalarRootsError> {
        let k = mean.values();
        let of = |i: usize| {
            let (axis, value) = (i + 1, variances[i]);
            if !(value >= 0.0 && k[i].abs() + value.sqrt() <= MAX_ROOT) {
                return Err(ScalarRootsError::Variance { axis, mean: k[i], value });
            }
            law(i, k[i], value).map_err(|problem| ScalarRootsError::Law { axis, problem })
        };
        Self::new([of(0)?, of(1)?, of(2)?]).map_err(|error| match error {
            ScalarRootsError::Reach { axis } => {
                let i = axis - 1;
                ScalarRootsError::Variance { axis, mean: k[i], value: variances[i] }
            }
            other => other,
        })
    }

    /// Mean in √kg·m and variance in kg·m² of each, if all three are normal.
    #[must_use]
    pub fn as_normal(&self) -> Option<[[f64; 2]; 3]> {
        let [a, b, c] = self.laws.each_ref().map(ScalarLaw::as_normal);
        Some([a?, b?, c?])
    }
}

impl RootMoments for ScalarRoots {
    fn second_moment_statistics(&self) -> SecondMomentStatistics {
        let moments = self.laws.each_ref().map(ScalarLaw::square_moments);
        SecondMomentStatistics::independent(moments.map(|m| m.0), moments.map(|m| m.1))
    }

    fn ln_density_of_squares(&self, second_moments: [f64; 3]) -> Option<f64> {
        // The first order changes nothing.
        self.ln_densities_in_orders(second_moments).map(|found| found[0])
    }

    /// From the nine densities of three laws at three roots.
    fn ln_densities_in_orders(&self, second_moments: [f64; 3]) -> Option<[f64; 6]> {
        let roots = second_moments.map(f64::sqrt);
        let mut folded = [[0.0; 3]; 3];
        for (law, of_law) in self.laws.iter().zip(&mut folded) {
            for (k, found) in roots.into_iter().zip(of_law) {
                *found = ln_sum(&[law.ln_density(k)?, law.ln_density(-k)?]);
            }
        }
        let ln_of_squares = ln_of_squares(roots);
        Some(PrincipalAxes::ORDERS.map(|(order, _)| {
            let [a, b, c] = [0, 1, 2].map(|i| folded[i][order[i]]);
            // Where one is zero, so is the product, whatever the others are.
            let none = a.min(b).min(c) == f64::NEG_INFINITY;
            if none { f64::NEG_INFINITY } else { a + b + c + ln_of_squares }
        }))
    }
}

impl Distribution<RootSecondMoments> for ScalarRoots {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> RootSecondMoments {
        loop {
            let draw = std::array::from_fn(|i| self.laws[i].draw(rng));
            // Never refused within 40 deviations.
            if let Ok(roots) = RootSecondMoments::new(draw) {
                return roots;
            }
        }
    }
}

/// Why laws of roots are refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ScalarRootsError {
    /// A variance is negative or NaN, or roots so large that their fourth powers would overflow.
    #[error(
        "variance of k_{axis} = {value:?} kg·m² about the mean {mean:?} √kg·m: it must not be negative, and no root may \
         come out beyond {MAX_ROOT:e} √kg·m"
    )]
    Variance {
        /// Axis, from 1.
        axis: usize,
        /// The mean of the root, √kg·m.
        mean: f64,
        /// The variance, kg·m².
        value: f64,
    },
    /// Roots are so large that their fourth powers would overflow.
    #[error("law of k_{axis}: no root may come out beyond {MAX_ROOT:e} √kg·m")]
    Reach {
        /// Axis, from 1.
        axis: usize,
    },
    /// There is no such law.
    #[error("k_{axis}: {problem}")]
    Law {
        /// Axis, from 1.
        axis: usize,
        /// Why.
        problem: ScalarLawError,
    },
}

crate::written!(
    ScalarRoots,
    |law| { laws_sqrt_kg_m: [ScalarLaw; 3] = law.laws.clone(), },
    ScalarRoots::new(laws_sqrt_kg_m)?
);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::root_moments::tests::check_moments;

    const INF: f64 = f64::INFINITY;

    fn roots(k: [f64; 3]) -> RootSecondMoments {
        RootSecondMoments::new(k).unwrap()
    }

    /// Every kind of law, with roots of either sign, without width, and every way to draw a truncated one.
    #[test]
    fn squares_have_their_moments() {
        let uniform = |low, high| ScalarLaw::uniform(low, high).unwrap();
        let bounds = [uniform(3.0, 4.0), uniform(-1.0, 2.0), uniform(-2.0, -2.0)];
        let any = [
            ScalarLaw::normal(3.0, 1.5).unwrap(),
            ScalarLaw::lognormal(2.0, 0.3).unwrap(),
            ScalarLaw::bernoulli(0.3).unwrap(),
        ];
        let wide = [[27.0, 33.0], [0.0, INF], [-INF, 1.0]];
        let tails = [[3.0, INF], [-INF, -2.5], [4.0, 4.2]];
        let narrow = [[1.9, 2.3], [4.0, 6.0], [-0.5, 0.2]];
        let truncated = |mean, v, bounds| ScalarRoots::truncated_normal(roots(mean), v, bounds);
        for (seed, law) in (17..).zip([
            ScalarRoots::new(bounds),
            ScalarRoots::new(any),
            ScalarRoots::uniform(roots([30.0, 20.0, 0.5]), [1.0, 0.2, 3.0]),
            ScalarRoots::lognormal(roots([30.0, 1.0, 0.0]), [4.0, 0.01, 0.0]),
            ScalarRoots::lognormal(roots([1e-3, 2.0, 5.0]), [1e-9, 0.0, 1.0]),
            truncated([30.0, 1.0, 0.0], [9.0, 4.0, 2.0], wide),
            truncated([0.0, 1.0, 0.0], [1.0; 3], tails),
            truncated([2.0, 5.0, 1.0], [1.0, 0.0, 4.0], narrow),
        ]) {
            check_moments(&law.unwrap(), seed);
        }
    }

    /// Without bounds it is Gaussian, and three normal laws are Gaussian roots, to the bit where their variances
    /// are squares.
    #[test]
    fn normal_laws_are_gaussian_roots() {
        use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
        let (mean, deviations) = ([3.0, 1.0, 0.0], [0.5, 2.0, 1.25]);
        let variances = deviations.map(|s| s * s);
        let gaussian = ScalarRoots::normal(roots(mean), variances).unwrap();
        let normal = |i: usize| ScalarLaw::normal(mean[i], deviations[i]).unwrap();
        let scalar = ScalarRoots::new([normal(0), normal(1), normal(2)]).unwrap();
        assert_eq!(scalar.second_moment_statistics(), gaussian.second_moment_statistics());
        let mut rngs = [1, 1].map(ChaCha8Rng::seed_from_u64);
        for _ in 0..100 {
            assert_eq!(scalar.sample(&mut rngs[0]), gaussian.sample(&mut rngs[1]));
        }
        let free = ScalarRoots::truncated_normal(roots(mean), variances, [[-INF, INF]; 3]).unwrap();
        let (a, b) = (free.second_moment_statistics(), gaussian.second_moment_statistics());
        for i in 0..3 {
            assert!((a.mean()[i] / b.mean()[i] - 1.0).abs() < 1e-14);
            assert!((a.variances()[i] / b.variances()[i] - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn bad_parameters_are_named() {
        let ones = roots([1.0; 3]);
        for bad in [-1.0, f64::NAN, INF, 1e198] {
            let v = [0.1, bad, 0.1];
            let bounds = [[0.0, 2.0]; 3];
            for law in [
                ScalarRoots::uniform(ones, v),
                ScalarRoots::lognormal(ones, v),
                ScalarRoots::truncated_normal(ones, v, bounds),
            ] {
                let error = law.unwrap_err();
                assert!(matches!(error, ScalarRootsError::Variance { axis: 2, .. }), "{error}");
            }
        }
        // A mean that is too large is named with its variance.
        for mean in [1e76, 1e90, 1e150] {
            let law = ScalarRoots::normal(roots([1.0, mean, 1.0]), [0.0; 3]);
            let told = format!("variance of k_2 = 0.0 kg·m² about the mean {mean:?} √kg·m: ");
            assert!(law.unwrap_err().to_string().starts_with(&told));
        }
        let with = |mean: f64, variance: f64, bounds: [f64; 2]| {
            let all = [[0.0, 2.0], bounds, [0.0, 2.0]];
            let law =
                ScalarRoots::truncated_normal(roots([1.0, mean, 1.0]), [0.1, variance, 0.1], all);
            law.unwrap_err().to_string()
        };
        for message in [
            with(1.0, 0.1, [2.0, 0.0]),
            with(1.0, 0.1, [f64::NAN, 2.0]),
            with(1.0, 0.0, [2.0, 3.0]),
            with(1.0, 0.1, [1.0, 1.0]),
        ] {
            assert!(message.starts_with("k_2: "), "{message}");
        }
        assert!(with(1.0, 0.01, [5.0, 6.0]).contains("4.000e1 standard deviations outside"));
        for (mean, variance) in [(0.0, 1.0), (-1.0, 0.0)] {
            let law = ScalarRoots::lognormal(roots([1.0, mean, 1.0]), [0.1, variance, 0.1]);
            assert!(law.unwrap_err().to_string().starts_with("k_2: a lognormal"));
        }
        assert!(ScalarRoots::lognormal(roots([1e74; 3]), [1e148; 3]).is_err());
        assert!(ScalarRoots::lognormal(roots([1e-150; 3]), [1e-304; 3]).is_ok());
        let far = [(); 3].map(|()| ScalarLaw::normal(0.0, 1e74).unwrap());
        assert_eq!(ScalarRoots::new(far), Err(ScalarRootsError::Reach { axis: 1 }));
    }
}
