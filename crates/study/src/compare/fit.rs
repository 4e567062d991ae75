//! How well a model matches the reference of a comparison.

use gyradius_dispersion::EntryMoments;
use nalgebra::{SMatrix, SVector};
use serde::{Deserialize, Deserializer, Serialize};

/// A covariance further off than this, in sizes of the reference's, is called a poor match: a body known
/// exactly is no further.
const POOR: f64 = 1.0;
/// And further than this, none: the law has next to nothing to do with what was asked for.
const NONE: f64 = 10.0;

/// How far the mean and covariance of a model are from those it was to have.
///
/// In the norm ‖M‖² = Σ M_ab² of the matrix, in which products count twice and which is the same in
/// every frame: the distance of the means over the deviation of the whole matrix, √E‖I − E I‖², and
/// the norm of the difference of the covariances over that of the reference's.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Fit {
    #[serde(deserialize_with = "number")]
    pub(crate) mean_off: f64,
    #[serde(deserialize_with = "number")]
    pub(crate) covariance_off: f64,
    /// Estimated from the draws, so with their noise, rather than known.
    pub(crate) from_draws: bool,
    /// Standard deviations of I11, I22, I33, I12, I13, I23 of the model, kg·m².
    #[serde(deserialize_with = "numbers")]
    pub(crate) deviations_kg_m2: [f64; 6],
}

/// A number, or null for one that JSON does not know.
fn number<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or(f64::NAN))
}

fn numbers<'de, D: Deserializer<'de>>(from: D) -> Result<[f64; 6], D::Error> {
    let numbers = <[Option<f64>; 6]>::deserialize(from)?;
    Ok(numbers.map(|number| number.unwrap_or(f64::NAN)))
}

impl Fit {
    pub(crate) fn known(found: &EntryMoments, target: &EntryMoments) -> Self {
        Self::new(found.mean().into(), found.covariance(), target, false)
    }

    /// Of the entries of draws; none below two draws.
    pub(crate) fn of_draws(entries: &[[f64; 6]], target: &EntryMoments) -> Option<Self> {
        let n = entries.len() as f64;
        if !(n > 1.0) {
            return None;
        }
        let sum: SVector<f64, 6> = entries.iter().map(|e| SVector::from(*e)).sum();
        let mean = sum / n;
        let covariance = entries
            .iter()
            .map(|e| SVector::from(*e) - mean)
            .fold(SMatrix::<f64, 6, 6>::zeros(), |c, d| c + d * d.transpose())
            / (n - 1.0);
        Some(Self::new(mean, &covariance, target, true))
    }

    fn new(
        mean: SVector<f64, 6>,
        covariance: &SMatrix<f64, 6, 6>,
        target: &EntryMoments,
        from_draws: bool,
    ) -> Self {
        let weight = |e: usize| if e < 3 { 1.0_f64 } else { 2.0 };
        let norm = |c: &SMatrix<f64, 6, 6>| {
            // Scaled, for squares of squares of large moments.
            let size = c.amax().max(f64::MIN_POSITIVE);
            let square = |e, f| weight(e) * weight(f) * (c[(e, f)] / size).powi(2);
            let sum: f64 = (0..36).map(|i| square(i / 6, i % 6)).sum();
            size * sum.sqrt()
        };
        let asked = target.covariance();
        let gap = mean - SVector::from(target.mean());
        let total: f64 = (0..6).map(|e| weight(e) * asked[(e, e)]).sum();
        let distance: f64 = (0..6).map(|e| weight(e) * gap[e] * gap[e]).sum();
        Self {
            mean_off: (distance / total).sqrt(),
            covariance_off: norm(&(covariance - asked)) / norm(asked),
            from_draws,
            deviations_kg_m2: std::array::from_fn(|e| covariance[(e, e)].max(0.0).sqrt()),
        }
    }

    /// Whether the model is a rival at all.
    pub(crate) fn is_near(&self) -> bool {
        self.covariance_off <= NONE && self.mean_off <= NONE
    }

    pub(crate) fn is_poor(&self) -> bool {
        !(self.covariance_off <= POOR)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gyradius_dispersion::{EntrywiseGaussian, KnownMoments};
    use gyradius_inertia::InertiaMatrix;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
    use rand_distr::Distribution;

    fn law(deviation: f64) -> EntrywiseGaussian {
        let mean = InertiaMatrix::from_entries([9.0, 8.0, 6.0], [0.0; 3]).unwrap();
        EntrywiseGaussian::new(mean, [deviation; 6]).unwrap()
    }

    #[test]
    fn the_same_moments_are_not_off_and_twice_the_deviation_is() {
        let target = law(1.0).entry_moments();
        let same = Fit::known(&target, &target);
        assert_eq!((same.mean_off, same.covariance_off), (0.0, 0.0));
        let wide = Fit::known(&law(2.0).entry_moments(), &target);
        assert!((wide.covariance_off - 3.0).abs() < 1e-14);
        assert!(wide.is_poor() && wide.is_near() && !same.is_poor());
        // A mean off by (3, 4, 0) and a product by 6, of a deviation of 1·√(3 + 6).
        let moved = EntryMoments::new([12.0, 12.0, 6.0, 6.0, 0.0, 0.0], *target.covariance());
        let expected = f64::sqrt(9.0 + 16.0 + 2.0 * 36.0) / 3.0;
        assert!((Fit::known(&moved.unwrap(), &target).mean_off - expected).abs() < 1e-14);
    }

    #[test]
    fn draws_tend_to_what_is_known() {
        let law = law(1.0);
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let entries: Vec<[f64; 6]> = (0..40_000)
            .map(|_| Distribution::<InertiaMatrix>::sample(&law, &mut rng).entries())
            .collect();
        let fit = Fit::of_draws(&entries, &law.entry_moments()).unwrap();
        assert!(fit.from_draws);
        // About √(42/n)·… : a few percent at most.
        assert!(fit.covariance_off < 0.04 && fit.mean_off < 0.02, "{fit:?}");
        assert!(Fit::of_draws(&entries[..1], &law.entry_moments()).is_none());
    }
}
