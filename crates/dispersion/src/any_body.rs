//! The inertia of any body, for property tests and domain randomisation.

use gyradius_attitude::UniformAttitude;
use gyradius_inertia::{Inertia, InertiaMatrix, MAX_SECOND_MOMENT, SecondMoments};
use rand::{Rng, RngExt};
use rand_distr::Distribution;
use std::borrow::Cow;

use crate::density_of_entries::ln_density_of_entries;
use crate::{EntryMoments, InertiaLaw, ModelDraw};

/// Why two numbers are not the range of an [`AnyBody`].
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AnyBodyError {
    /// A trace is not a positive number in range, or the second is below the first.
    #[error(
        "traces from {low:e} to {high:e} kg·m²: both must lie between 1e-300 and {MAX_SECOND_MOMENT:.1e}, \
         the second not below the first"
    )]
    Trace {
        /// The smaller trace, kg·m².
        low: f64,
        /// The larger trace, kg·m².
        high: f64,
    },
}

/// The inertia of some body, any body: for property tests and for domain randomisation.
///
/// # Definition
/// Shape: the shares (K₁, K₂, K₃)/ΣK of the second mass moments are uniform on the triangle of all
/// shares, so that every shape of a body, from rods over plates to balls, is equally likely. Size:
/// ln tr I uniform between two limits. Axes: uniform over all attitudes. All three independent.
///
/// # Realizability
/// By construction. Every realizable inertia within the limits can come out, and nothing else.
///
/// # Algorithm
/// The shares are the gaps that two uniform numbers leave in [0, 1].
///
/// ```
/// use gyradius_dispersion::AnyBody;
/// use gyradius_inertia::Inertia;
/// use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
/// use rand_distr::Distribution;
///
/// // From the inertia of a bolt to that of a truck.
/// let bodies = AnyBody::new(1e-6, 1e5)?;
/// let body: Inertia = bodies.sample(&mut ChaCha8Rng::seed_from_u64(1));
/// assert!(body.as_inertia_matrix().is_realizable());
/// # Ok::<(), gyradius_dispersion::AnyBodyError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "[f64; 2]", into = "[f64; 2]"))]
pub struct AnyBody {
    low: f64,
    high: f64,
}

impl AnyBody {
    /// Bodies with tr I from `low` to `high`, kg·m². Equal limits give all bodies the same trace.
    ///
    /// # Errors
    /// A limit is not a positive number in range, or the second is below the first.
    pub fn new(low: f64, high: f64) -> Result<Self, AnyBodyError> {
        if !(low >= 1e-300 && high <= MAX_SECOND_MOMENT && low <= high) {
            return Err(AnyBodyError::Trace { low, high });
        }
        Ok(Self { low, high })
    }

    /// The limits of tr I, kg·m².
    #[must_use]
    pub fn traces(&self) -> [f64; 2] {
        [self.low, self.high]
    }
}

impl Distribution<Inertia> for AnyBody {
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> Inertia {
        loop {
            let (u, v): (f64, f64) = (rng.random(), rng.random());
            let shares = [u.min(v), (u - v).abs(), 1.0 - u.max(v)];
            // The exponential may round past the limit.
            let (from, to) = (libm::log(self.low), libm::log(self.high));
            let trace = libm::exp(from + rng.random::<f64>() * (to - from));
            let trace = trace.clamp(self.low, self.high);
            let axes = UniformAttitude.sample(rng);
            // tr I = 2 ΣK. Never refused: both are in range.
            if let Ok(moments) = SecondMoments::new(shares.map(|s| 0.5 * trace * s))
                && let Ok(inertia) = Inertia::from_second_moments(moments, &axes)
            {
                return inertia;
            }
        }
    }
}

impl TryFrom<[f64; 2]> for AnyBody {
    type Error = AnyBodyError;

    fn try_from([low, high]: [f64; 2]) -> Result<Self, Self::Error> {
        Self::new(low, high)
    }
}

impl From<AnyBody> for [f64; 2] {
    fn from(law: AnyBody) -> Self {
        law.traces()
    }
}

impl InertiaLaw for AnyBody {
    fn name(&self) -> Cow<'_, str> {
        "any-body".into()
    }

    fn draw(&self, rng: &mut dyn Rng) -> ModelDraw {
        let body: Inertia = self.sample(rng);
        body.into()
    }

    fn is_realizable_by_construction(&self) -> bool {
        true
    }

    fn expected_moments(&self) -> Option<EntryMoments> {
        None
    }

    /// None where the two limits are equal.
    fn ln_density(&self, inertia: &InertiaMatrix) -> Option<f64> {
        const LN_16: f64 = 4.0 * std::f64::consts::LN_2;
        if self.low == self.high {
            return None;
        }
        let trace = inertia.matrix().trace();
        let inside = (self.low..=self.high).contains(&trace);
        let Some(body) = Inertia::try_from(*inertia).ok().filter(|_| inside) else {
            return Some(f64::NEG_INFINITY);
        };
        // The density 2 of the shares and 1/(t ln(high/low)) of the trace t are 16/(t³ ln(high/low)) of the K.
        let ln_range = libm::log(libm::log(self.high) - libm::log(self.low));
        let ln_squares = LN_16 - 3.0 * libm::log(trace) - ln_range;
        Some(ln_density_of_entries(&body, |_| [ln_squares; 6], |_| 0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    /// On the triangle each share has mean ⅓ and variance 1/18, and two have covariance −1/36. The
    /// moments of inertia about fixed axes have mean ⅓ of the trace.
    #[test]
    fn shapes_are_uniform() {
        const N: usize = 100_000;
        let law = AnyBody::new(2.0, 2.0).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let (mut squares, mut about_1, mut ball) = (0.0, 0.0, 0);
        for _ in 0..N {
            let body = law.sample(&mut rng);
            assert!((body.matrix().trace() - 2.0).abs() < 1e-14);
            let k = body.second_moments().values();
            squares += k.iter().map(|k| k * k).sum::<f64>() / N as f64;
            about_1 += body.matrix()[(0, 0)] / N as f64;
            ball += usize::from(k.iter().all(|k| *k > 0.25));
        }
        // E ΣK² = 3 (1/18 + 1/9) = ½.
        assert!((squares - 0.5).abs() < 0.002, "{squares}");
        assert!((about_1 - 2.0 / 3.0).abs() < 0.002, "{about_1}");
        // All shares above ¼: a triangle of a quarter of the side, 1/16 of the area.
        let z = (ball as f64 - N as f64 / 16.0) / (N as f64 * 15.0 / 256.0).sqrt();
        assert!(z.abs() < 4.0, "{z}");
    }

    #[test]
    fn every_draw_is_a_body_at_every_scale() {
        let law = AnyBody::new(1e-300, 1e300).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(6);
        let mut small = 0;
        for _ in 0..10_000 {
            let body = law.sample(&mut rng);
            small += usize::from(body.matrix().trace() < 1e-150);
            assert!(body.as_inertia_matrix().is_realizable());
            let trace = body.matrix().trace();
            assert!((1e-300 * 0.999..=1e300 * 1.001).contains(&trace), "{trace:e}");
        }
        // A quarter of the logarithm's range.
        assert!((2300..2700).contains(&small), "{small}");
    }

    #[test]
    fn bad_limits_are_refused() {
        for (low, high) in [
            (0.0, 1.0),
            (-1.0, 1.0),
            (2.0, 1.0),
            (f64::NAN, 1.0),
            (1.0, f64::INFINITY),
            (1.0, f64::MAX),
        ] {
            let error = AnyBody::new(low, high).unwrap_err().to_string();
            assert!(error.contains("kg·m²"), "{error}");
        }
    }
}
