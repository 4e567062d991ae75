//! The law that has given moments where they are spread wide: Newton's method along a path from no spread to all of it.

use nalgebra::{SMatrix, SVector};

use super::{EntryMoments, Start, moments_of};

/// Six means and the covariance on and above its diagonal.
const UNKNOWNS: usize = 27;
/// Newton's steps at one place of the path.
const MOST_STEPS: usize = 12;
/// Shortest step along the path, of which the whole is 1.
const SHORTEST: f64 = 1.0 / 512.0;
/// Of deviations: where Newton's method has arrived, and over what the derivative is taken.
const ARRIVED: f64 = 1e-10;
const SHIFT: f64 = 1e-6;
/// Least of the scales, of the largest of them: what does not scatter has none of its own.
const LEAST_SCALE: f64 = 1e-3;

type Unknowns = SVector<f64, UNKNOWNS>;

/// What is sought, in units of its deviations: of the coordinates to first order, and of the entries.
struct Search<'a> {
    moments: &'a EntryMoments,
    coordinates: SVector<f64, 6>,
    entries: SVector<f64, 6>,
}

/// Mean and covariance of the coordinates with which the entries have these moments; none if the path to them ends before.
///
/// The entries have the mean at once, and a share of the covariance that grows from 0, where the coordinates are those of the
/// mean and scatter by nothing, to 1. Each place of the path begins where the last two lead to.
pub(super) fn matched(
    start: &Start,
    moments: &EntryMoments,
) -> Option<(SVector<f64, 6>, SMatrix<f64, 6, 6>)> {
    // d has no unit, and s that of e^d.
    let root = libm::exp(start.mean.fixed_rows::<3>(0).max());
    let units = SVector::from([1.0, 1.0, 1.0, root, root, root]);
    let search = Search {
        moments,
        coordinates: scales(&start.covariance, &units)?,
        entries: scales(moments.covariance(), &SVector::repeat(1.0))?,
    };
    let mut here = search.unknowns(&start.mean, &SMatrix::zeros());
    let (mut share, mut step, mut slope) = (0.0, 0.25, Unknowns::zeros());
    while share < 1.0 {
        let next = f64::min(share + step, 1.0);
        if let Some(there) = search.solve(here + slope * (next - share), next) {
            slope = (there - here) / (next - share);
            (here, share, step) = (there, next, 1.5 * step);
        } else if step > SHORTEST {
            step *= 0.5;
        } else {
            return None;
        }
    }
    Some(search.coordinates(&here))
}

/// Deviations, none of them zero beside the others where each has its unit; none if nothing scatters.
fn scales(covariance: &SMatrix<f64, 6, 6>, units: &SVector<f64, 6>) -> Option<SVector<f64, 6>> {
    let deviations = covariance.diagonal().map(|variance| variance.max(0.0).sqrt());
    let deviations = deviations.component_div(units);
    let least = LEAST_SCALE * deviations.amax();
    let scales = deviations.map(|deviation| deviation.max(least)).component_mul(units);
    (least > 0.0 && scales.amax().is_finite()).then_some(scales)
}

/// Places of the covariance on and above the diagonal.
fn pairs() -> impl Iterator<Item = (usize, usize)> {
    (0..6).flat_map(|i| (i..6).map(move |j| (i, j)))
}

impl Search<'_> {
    fn unknowns(&self, mean: &SVector<f64, 6>, covariance: &SMatrix<f64, 6, 6>) -> Unknowns {
        let scale = &self.coordinates;
        let means = (0..6).map(|i| mean[i] / scale[i]);
        let covariances = pairs().map(|(i, j)| covariance[(i, j)] / (scale[i] * scale[j]));
        Unknowns::from_iterator(means.chain(covariances))
    }

    fn coordinates(&self, x: &Unknowns) -> (SVector<f64, 6>, SMatrix<f64, 6, 6>) {
        let scale = &self.coordinates;
        let mut covariance = SMatrix::zeros();
        for ((i, j), x) in pairs().zip(x.iter().skip(6)) {
            covariance[(i, j)] = x * scale[i] * scale[j];
            covariance[(j, i)] = covariance[(i, j)];
        }
        (SVector::from_fn(|i, _| x[i] * scale[i]), covariance)
    }

    /// By how much the moments differ from the mean and from this share of the covariance.
    fn gap(&self, x: &Unknowns, share: f64) -> Unknowns {
        let (mean, covariance) = self.coordinates(x);
        let found = moments_of(&mean, &covariance);
        let scale = &self.entries;
        let (is, to) = (found.mean(), self.moments.mean());
        let means = (0..6).map(|e| (is[e] - to[e]) / scale[e]);
        let covariances = pairs().map(|(e, f)| {
            let (is, to) = (found.covariance()[(e, f)], self.moments.covariance()[(e, f)]);
            (is - share * to) / (scale[e] * scale[f])
        });
        Unknowns::from_iterator(means.chain(covariances))
    }

    /// Where there is no gap, from nearby; none if Newton's method does not lead there.
    fn solve(&self, mut x: Unknowns, share: f64) -> Option<Unknowns> {
        let mut gap = self.gap(&x, share);
        for _ in 0..MOST_STEPS {
            if gap.amax() <= ARRIVED {
                return Some(x);
            }
            let mut derivative = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::zeros();
            for i in 0..UNKNOWNS {
                let mut shifted = x;
                shifted[i] += SHIFT;
                derivative.set_column(i, &((self.gap(&shifted, share) - gap) / SHIFT));
            }
            x -= derivative.lu().solve(&gap)?;
            let before = gap.amax();
            gap = self.gap(&x, share);
            if !(gap.amax() < 2.0 * before) {
                return None;
            }
        }
        None
    }
}
