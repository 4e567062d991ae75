//! How likely each of the 24 namings of the axes of a sample is under a law.

use gyradius_attitude::RadiallyConstrainedGaussian;
use gyradius_dispersion::AttitudeMoments;

use super::{
    matching::FLOOR,
    relabel::{Relabeling, Sample},
    root::RootFit,
};

/// Namings whose likelihood is within this factor of another's could be the other: e³.
const LN_DOUBT: f64 = 3.0;
/// ln of a share that rounding loses.
const NEGLIGIBLE: f64 = -40.0;
/// The step of the sequence whose points are evenly spread however many there are: the golden section.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// A law of independent roots about axes, as far as it tells namings apart.
#[derive(Clone, Debug)]
pub(super) struct Names<'a> {
    means: [f64; 3],
    /// No smaller than [`FLOOR`] of the largest root.
    deviations: [f64; 3],
    axes: &'a RadiallyConstrainedGaussian,
    /// What ln of the density of the axes never exceeds.
    at_most: f64,
}

impl<'a> Names<'a> {
    pub(super) fn of(roots: &[RootFit; 3], axes: &'a RadiallyConstrainedGaussian) -> Self {
        let means = roots.map(|root| root.mean());
        let floor = FLOOR * means.into_iter().fold(f64::MIN_POSITIVE, f64::max);
        let deviations = roots.map(|root| root.deviation().max(floor));
        Self { means, deviations, axes, at_most: axes.ln_density_at_most() }
    }

    /// ln of the densities of roots and attitude under each naming, with respect to dk₁ dk₂ dk₃ and Haar measure; −∞
    /// where that is nothing beside another.
    fn ln_densities(&self, sample: &Sample) -> [f64; 24] {
        // ln of the folded normal density of root `k` about axis `axis`, but for 2π.
        let folded = |axis: usize, k: f64| {
            let (m, s) = (self.means[axis], self.deviations[axis]);
            let z = (k - m) / s;
            -0.5 * z * z - libm::log(s) + libm::log1p(libm::exp(-2.0 * (k / s) * (m / s)))
        };
        let of: [[f64; 3]; 3] = std::array::from_fn(|axis| sample.roots.map(|k| folded(axis, k)));
        let mut largest = f64::NEG_INFINITY;
        Relabeling::all().each_ref().map(|g| {
            let roots: f64 = (0..3).map(|axis| of[axis][g.order[axis]]).sum();
            if roots + self.at_most < largest + NEGLIGIBLE {
                return f64::NEG_INFINITY;
            }
            let ln = roots + self.axes.ln_haar_density(&(g.turn * sample.attitude));
            largest = largest.max(ln);
            ln
        })
    }

    /// How likely each naming is, in units of the likeliest.
    pub(super) fn weights(&self, sample: &Sample) -> [f64; 24] {
        let ln = self.ln_densities(sample);
        let largest = ln.into_iter().fold(f64::NEG_INFINITY, f64::max);
        ln.map(|ln| libm::exp(ln - largest))
    }

    /// Each sample with a naming drawn as it is likely, and how many have changed theirs. The numbers that draw are those
    /// of a sequence that fills [0, 1) evenly, from `start` on: so shares of names come out nearer to their
    /// probabilities than by chance, and the same samples have the same names.
    pub(super) fn drawn(&self, samples: &[Sample], start: f64) -> (Vec<Sample>, usize) {
        let mut changed = 0;
        let mut u = start;
        let one = |sample: &Sample| {
            u = (u + GOLDEN).fract();
            let weights = self.weights(sample);
            let mut left = u * weights.iter().sum::<f64>();
            let Some(label) = weights.iter().position(|weight| {
                left -= weight;
                left < 0.0
            }) else {
                return *sample;
            };
            changed += usize::from(label != 0);
            sample.relabeled(&Relabeling::all()[label])
        };
        (samples.iter().map(one).collect(), changed)
    }

    /// How many samples have another naming than the likeliest at odds below 20 : 1.
    pub(super) fn doubtful(&self, samples: &[Sample]) -> usize {
        let in_doubt = |sample: &&Sample| {
            let mut ln = self.ln_densities(sample);
            ln.sort_by(f64::total_cmp);
            ln[23] - ln[22] < LN_DOUBT
        };
        samples.iter().filter(in_doubt).count()
    }

    /// ln of the likelihood of samples whose names are not known, but for what all laws share.
    pub(super) fn ln_likelihood(&self, samples: &[Sample]) -> f64 {
        samples.iter().map(|sample| ln_sum(&self.ln_densities(sample))).sum()
    }
}

fn ln_sum(terms: &[f64]) -> f64 {
    let largest = terms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if !largest.is_finite() {
        return largest;
    }
    largest + libm::log(terms.iter().map(|term| libm::exp(term - largest)).sum())
}
