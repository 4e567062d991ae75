//! The law that has given moments, in closed form: its coordinates one after another.

use nalgebra::{SMatrix, SVector};

use super::{EntryMoments, inertia_map};
use crate::gaussian_monomials::{log_cholesky_entries, moments};

/// Of each entry of Σ its place among Σ₁₁, Σ₂₂, Σ₃₃, Σ₁₂, Σ₁₃, Σ₂₃, the coordinate that no entry before it has, and the d of its
/// leading monomial, the one with that coordinate: e^{2d} where the coordinate is d itself, e^d s where it is s.
const ENTRIES: [(usize, usize, usize); 6] =
    [(2, 2, 2), (5, 4, 2), (4, 5, 2), (1, 1, 1), (3, 3, 1), (0, 0, 0)];
/// A d of which e^d is zero.
const NOTHING: f64 = -1e3;

/// Mean and covariance of the coordinates with which the entries have these moments, but for rounding. Where no law has them,
/// these are not finite or no covariance.
///
/// # Algorithm
/// In the order of [`ENTRIES`] each of the 27 equations has one unknown more than those before it, so at most one law has given
/// moments. Let a leading monomial have x and d, p = 2 if x is d and 1 if not, and g = E e^{p d}. Its mean is g if x is d and
/// g (E x + Cov(d, x)) if not, from E[e^{aᵀx} q(x)] = E e^{aᵀx} E[q(x + Ca)]. While the means are kept, the covariance of two
/// entries, of which the other has y, k, q and h, grows with C(x, y) from zero by
///
/// ```text
/// g h (e^{4 C(x, y)} − 1)           if x is d and y is k,
/// g h p q e^{p q C(d, k)} C(x, y)   if not.
/// ```
///
/// So the unknown is found from what is left of this covariance by the coordinates as far as they are known.
pub(super) fn matched(entries: &EntryMoments) -> Option<(SVector<f64, 6>, SMatrix<f64, 6, 6>)> {
    let map = inertia_map().try_inverse()?;
    let means = map * SVector::from(entries.mean());
    let covariances = map * entries.covariance() * map.transpose();
    let sums = log_cholesky_entries::<6>(None, 0);
    let mut mean = SVector::from([NOTHING, NOTHING, NOTHING, 0.0, 0.0, 0.0]);
    let mut c = SMatrix::<f64, 6, 6>::zeros();
    for (place, &(e, x, d)) in ENTRIES.iter().enumerate() {
        let rest = means[e] - moments(&sums, &mean, &c).0[e];
        mean[x] = if x == d { 0.5 * libm::log(rest) } else { rest / size(&mean, &c, d, 1.0) };
        for &(f, y, k) in &ENTRIES[..=place] {
            let [p, q] = [x == d, y == k].map(|is_d| if is_d { 2.0 } else { 1.0 });
            let rest = covariances[(e, f)] - moments(&sums, &mean, &c).1[(e, f)];
            let rest = rest / (size(&mean, &c, d, p) * size(&mean, &c, k, q));
            c[(x, y)] = if x == d && y == k {
                0.25 * libm::log1p(rest)
            } else {
                rest * libm::exp(-p * q * c[(d, k)]) / (p * q)
            };
            c[(y, x)] = c[(x, y)];
            // So that the mean of the leading monomial is kept.
            if y == d {
                mean[x] -= c[(x, y)];
            }
        }
    }
    Some((mean, c))
}

/// E e^{p d}.
fn size(mean: &SVector<f64, 6>, c: &SMatrix<f64, 6, 6>, d: usize, p: f64) -> f64 {
    libm::exp(p * mean[d] + 0.5 * p * p * c[(d, d)])
}
