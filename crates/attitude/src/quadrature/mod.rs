//! Integrals over S³ by quadrature of the three angles.

mod circle;
mod kronrod;

use nalgebra::{Matrix4, Quaternion, UnitQuaternion, Vector4};
use std::f64::consts::FRAC_PI_2;

use crate::{FisherBingham, RadiallyConstrainedGaussian};
use circle::{Circle, Point};
pub(crate) use kronrod::kronrod;

/// Points of the sphere whose density is below e⁻¹⁰⁰ of the largest are left out.
const NEGLIGIBLE: f64 = -100.0;
/// Relative error at which no more arcs are halved.
const TOLERANCE: f64 = 1e-13;
const MAX_ARCS: usize = 2000;
/// 1, y and the lower triangle of y yᵀ.
const INTEGRALS: usize = 15;

/// The normaliser and the moments of a law by quadrature over the angles, as Peck (2003, Eq. 21)
/// writes them.
///
/// A second way to what [`FisherBingham`] computes by a contour integral, for checking: the two
/// share nothing but the eigenvalues and eigenvectors of Σ.
///
/// # Algorithm
/// C = ∫ exp(−½ (x − m)ᵀ Σ⁻¹ (x − m)) dS, a product rule for which in (θ₁, θ₂, θ₃) would need some 1e9
/// points on the paper's example. In the eigenbasis of Σ, with the two smallest variances paired,
///
/// y = (cos η cos α, cos η sin α, sin η cos β, sin η sin β), dS = sin η cos η dη dα dβ,
///
/// the integrand is at every η a product of a function of α and one of β (Hopf's coordinates).
///
/// * *Circles*: the trapezoidal rule, which converges geometrically (Trefethen & Weideman 2014,
///   doi:10.1137/130932132). It is kept to the neighbourhood of the one or two maxima, found from the
///   quartic of the stationary points, and its points are doubled until it settles.
/// * *η*: Gauss-Kronrod rules of 21 points (Piessens et al., QUADPACK, 1983,
///   doi:10.1007/978-3-642-61786-7) on arcs that are graded towards every place where a circle
///   touches a ridge of the density or passes its peak; then the worst arc is halved until the
///   estimated error is small.
///
/// # Limits
/// Agrees with the contour integral to 1e-12 for eigenvalues of Σ between 1e-8 and 1e8, whatever
/// their ratios. For smaller ones rounding takes over: an error of at most about ε/√s for the
/// smallest eigenvalue s, 2e-9 for 1e-14, which [`estimated_error`](Self::estimated_error) includes.
#[derive(Clone, Debug, getset::CopyGetters)]
pub struct AngularQuadrature {
    plane: Planes,
    arcs: Vec<[f64; 2]>,
    /// ln C, as the law itself defines it.
    #[getset(get_copy = "pub")]
    ln_normaliser: f64,
    /// The mean E x of the four coordinates.
    #[getset(get_copy = "pub")]
    mean_vector: Vector4<f64>,
    /// The second moment E xxᵀ.
    #[getset(get_copy = "pub")]
    second_moment: Matrix4<f64>,
    /// The estimated relative error of C, which is also the estimated absolute error of the moments:
    /// that of the rule over η, plus a bound of what rounding does to the exponents.
    #[getset(get_copy = "pub")]
    estimated_error: f64,
    /// How often the density of one circle was evaluated.
    #[getset(get_copy = "pub")]
    evaluations: usize,
}

impl RadiallyConstrainedGaussian {
    /// The normaliser and the moments by quadrature over the angles (Peck 2003, Eq. 21), which checks
    /// [`ln_normaliser`](Self::ln_normaliser), [`mean_vector`](Self::mean_vector) and
    /// [`second_moment`](Self::second_moment) by another way. Takes milliseconds, the contour microseconds.
    ///
    /// ```
    /// use gyradius_attitude::RadiallyConstrainedGaussian;
    /// use nalgebra::{Matrix4, Quaternion, UnitQuaternion, Vector4};
    ///
    /// let mean = UnitQuaternion::from_quaternion(Quaternion::new(0.9996, 0.0249, 0.0005, -0.0100));
    /// let covariance = Matrix4::from_diagonal(&Vector4::new(2e-5, 6e-4, 6e-4, 0.6));
    /// let law = RadiallyConstrainedGaussian::new(mean, covariance)?;
    ///
    /// let check = law.by_quadrature();
    /// assert!((check.ln_normaliser() - law.ln_normaliser()).abs() < 1e-11);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn by_quadrature(&self) -> AngularQuadrature {
        let (axes, lambda, centre, _) = self.law().eigenform();
        AngularQuadrature::new(Planes::new(axes, lambda, centre, excess(centre)), 0.0)
    }
}

impl FisherBingham {
    /// The normaliser and the moments by quadrature over the angles, which checks
    /// [`ln_normaliser`](Self::ln_normaliser), [`mean_vector`](Self::mean_vector) and
    /// [`second_moment`](Self::second_moment) by another way.
    #[must_use]
    pub fn by_quadrature(&self) -> AngularQuadrature {
        let (axes, lambda, centre, ln_offset) = self.eigenform();
        AngularQuadrature::new(Planes::new(axes, lambda, centre, 0.0), ln_offset)
    }
}

impl AngularQuadrature {
    fn new(plane: Planes, ln_offset: f64) -> Self {
        let mut scratch = Scratch::default();
        let mut arcs: Vec<Arc> = Vec::new();
        for [low, high] in plane.graded_arcs() {
            arcs.push(plane.integrate(low, high, &mut scratch));
        }
        while arcs.len() < MAX_ARCS {
            let total: f64 = arcs.iter().map(|arc| arc.integrals[0]).sum();
            let error: f64 = arcs.iter().map(|arc| arc.error).sum();
            if error <= TOLERANCE.max(0.1 * plane.rounding()) * total {
                break;
            }
            // Halving does not help an arc much shorter than all there is to see.
            let worst = (0..arcs.len())
                .filter(|&i| arcs[i].high - arcs[i].low > plane.finest)
                .max_by(|&i, &j| arcs[i].error.total_cmp(&arcs[j].error));
            let Some(worst) = worst.filter(|&i| arcs[i].error > 0.0) else {
                break;
            };
            let Arc { low, high, .. } = arcs[worst];
            let middle = 0.5 * (low + high);
            arcs[worst] = plane.integrate(low, middle, &mut scratch);
            arcs.push(plane.integrate(middle, high, &mut scratch));
        }
        arcs.sort_by(|a, b| a.low.total_cmp(&b.low));

        let mut sums = [0.0; INTEGRALS];
        for arc in &arcs {
            for (sum, value) in sums.iter_mut().zip(arc.integrals) {
                *sum += value;
            }
        }
        let total = sums[0];
        let mut mean = Vector4::zeros();
        let mut second = Matrix4::zeros();
        let mut next = 5;
        for i in 0..4 {
            mean[plane.order[i]] = sums[1 + i] / total;
            for j in 0..=i {
                let value = sums[next] / total;
                second[(plane.order[i], plane.order[j])] = value;
                second[(plane.order[j], plane.order[i])] = value;
                next += 1;
            }
        }
        let truncation: f64 = arcs.iter().map(|arc| arc.error).sum::<f64>() / total;
        Self {
            ln_normaliser: libm::log(total) + ln_offset,
            mean_vector: plane.axes * mean,
            second_moment: plane.axes * second * plane.axes.transpose(),
            estimated_error: truncation + plane.rounding(),
            evaluations: scratch.evaluations,
            arcs: arcs.iter().map(|arc| [arc.low, arc.high]).collect(),
            plane,
        }
    }

    /// Expectations of `N` real functions of the attitude, on the points that served the normaliser.
    ///
    /// The error is that of the normaliser for functions as smooth as the law; one with edges, or
    /// finer than the law, gets less. Takes the product of the points on both circles, often
    /// several hundred thousand calls.
    pub fn expect<const N: usize>(
        &self,
        mut functions: impl FnMut(&UnitQuaternion<f64>) -> [f64; N],
    ) -> [f64; N] {
        let mut scratch = Scratch::default();
        let mut total = 0.0;
        let mut sums = [0.0; N];
        for &[low, high] in &self.arcs {
            for (eta, weight, _) in kronrod(low, high) {
                let Some(place) = self.plane.circles(eta, &mut scratch) else {
                    continue;
                };
                for first in &scratch.points[0] {
                    for second in &scratch.points[1] {
                        let share = weight * place.density * first.density * second.density;
                        let y = self.plane.unsort([
                            place.radii[0] * first.cos,
                            place.radii[0] * first.sin,
                            place.radii[1] * second.cos,
                            place.radii[1] * second.sin,
                        ]);
                        let x = Quaternion::from(self.plane.axes * y);
                        let values = functions(&UnitQuaternion::new_unchecked(x));
                        total += share;
                        for (sum, value) in sums.iter_mut().zip(values) {
                            *sum += share * value;
                        }
                    }
                }
            }
        }
        sums.map(|sum| sum / total)
    }
}

/// A law as two planes, the stiffer coordinates in the first.
#[derive(Clone, Debug)]
struct Planes {
    axes: Matrix4<f64>,
    /// Which coordinate of y each of the four is.
    order: [usize; 4],
    circles: [Circle; 2],
    /// Shorter arcs are not halved.
    finest: f64,
}

/// An arc of η with its integrals.
struct Arc {
    low: f64,
    high: f64,
    integrals: [f64; INTEGRALS],
    error: f64,
}

/// A value of η with a density worth having, the points on both circles being in the scratch.
struct Place {
    radii: [f64; 2],
    /// sin η cos η times the largest density on the two circles times their steps.
    density: f64,
}

#[derive(Default)]
struct Scratch {
    points: [Vec<Point>; 2],
    evaluations: usize,
}

impl Planes {
    /// For the density exp(−½ Σ λ(y − c)²), x = V y, with λ > 0 and |c| ≤ 1. A law with a mean means
    /// |c| = 1, whose rounding, `excess`, would count √λ times as much in C.
    fn new(axes: &Matrix4<f64>, lambda: [f64; 4], centre: [f64; 4], excess: f64) -> Self {
        let mut order = [0, 1, 2, 3];
        order.sort_by(|&i, &j| lambda[j].total_cmp(&lambda[i]));
        let circle = |i: usize, j: usize| Circle {
            lambda: [lambda[order[i]], lambda[order[j]]],
            centre: [centre[order[i]], centre[order[j]]],
            excess,
        };
        let circles = [circle(0, 1), circle(2, 3)];
        let finest = 0.02 * circles[0].width();
        Self { axes: *axes, order, circles, finest }
    }

    /// What rounding of a coordinate, ε, does to the exponents where they matter.
    fn rounding(&self) -> f64 {
        f64::EPSILON * (64.0 + 1.0 / self.circles[0].width())
    }

    fn unsort(&self, sorted: [f64; 4]) -> Vector4<f64> {
        let mut y = Vector4::zeros();
        for (value, &j) in sorted.iter().zip(&self.order) {
            y[j] = *value;
        }
        y
    }

    /// Arcs of [0, π/2], none longer than a few times its distance from any place where the integral
    /// over a circle changes quickly as its radius changes: |c_j|, where it begins to meet the ridge
    /// y_j = c_j, and |c|, where it passes the peak. There it changes within about one deviation.
    fn graded_arcs(&self) -> Vec<[f64; 2]> {
        const REACH: f64 = 6.0;
        let [first, second] = &self.circles;
        let legs = |r: f64| ((1.0 - r) * (1.0 + r)).max(0.0).sqrt();
        let mut marks = vec![(libm::atan2(second.distance(), first.distance()), first.width())];
        for r in [first.centre[0].abs(), first.centre[1].abs(), first.distance()] {
            marks.push((libm::atan2(legs(r), r), first.width()));
        }
        for r in [second.centre[0].abs(), second.centre[1].abs(), second.distance()] {
            marks.push((libm::atan2(r, legs(r)), second.width()));
        }
        let mut ends: Vec<f64> = marks.iter().map(|mark| mark.0).collect();
        ends.extend([0.0, FRAC_PI_2]);
        ends.sort_by(f64::total_cmp);
        ends.dedup_by(|a, b| *a - *b < self.finest.min(1e-3));
        if let Some(last) = ends.last_mut() {
            *last = FRAC_PI_2;
        }

        let mut stack: Vec<[f64; 2]> = ends.windows(2).rev().map(|w| [w[0], w[1]]).collect();
        let mut arcs = Vec::new();
        while let Some([low, high]) = stack.pop() {
            let room = |&(mark, width): &(f64, f64)| {
                let distance = (low - mark).max(mark - high).max(0.0);
                REACH * (distance + width)
            };
            if marks.iter().all(|mark| high - low <= room(mark)) {
                arcs.push([low, high]);
            } else {
                let middle = 0.5 * (low + high);
                stack.push([middle, high]);
                stack.push([low, middle]);
            }
        }
        arcs
    }

    /// The Gauss-Kronrod rule on one arc, its error estimated as in QUADPACK.
    fn integrate(&self, low: f64, high: f64, scratch: &mut Scratch) -> Arc {
        let mut values = [[0.0; INTEGRALS]; 21];
        let mut kronrod_sums = [0.0; INTEGRALS];
        let mut gauss_sums = [0.0; INTEGRALS];
        for (i, (eta, fine, coarse)) in kronrod(low, high).enumerate() {
            values[i] = self.integrand(eta, scratch);
            for k in 0..INTEGRALS {
                kronrod_sums[k] += fine * values[i][k];
                gauss_sums[k] += coarse * values[i][k];
            }
        }
        let mut error: f64 = 0.0;
        for k in 0..INTEGRALS {
            let mean = kronrod_sums[k] / (high - low);
            let spread: f64 = kronrod(low, high)
                .enumerate()
                .map(|(i, (_, fine, _))| fine * (values[i][k] - mean).abs())
                .sum();
            let difference = (kronrod_sums[k] - gauss_sums[k]).abs();
            if spread > 0.0 {
                let ratio = 200.0 * difference / spread;
                error = error.max(spread * (ratio * ratio.sqrt()).min(1.0));
            }
        }
        Arc { low, high, integrals: kronrod_sums, error }
    }

    /// 1, y and y yᵀ integrated over both circles at η, times sin η cos η.
    fn integrand(&self, eta: f64, scratch: &mut Scratch) -> [f64; INTEGRALS] {
        let Some(place) = self.circles(eta, scratch) else {
            return [0.0; INTEGRALS];
        };
        let [(p, u, uu), (q, v, vv)] = [0, 1].map(|k| {
            let r = place.radii[k];
            let mut sums = [0.0; 6];
            for point in &scratch.points[k] {
                let (x, y) = (r * point.cos, r * point.sin);
                let terms = [1.0, x, y, x * x, x * y, y * y];
                for (sum, term) in sums.iter_mut().zip(terms) {
                    *sum += point.density * term;
                }
            }
            (sums[0], [sums[1], sums[2]], [sums[3], sums[4], sums[5]])
        });
        [
            p * q,
            u[0] * q,
            u[1] * q,
            p * v[0],
            p * v[1],
            uu[0] * q,
            uu[1] * q,
            uu[2] * q,
            u[0] * v[0],
            u[1] * v[0],
            p * vv[0],
            u[0] * v[1],
            u[1] * v[1],
            p * vv[1],
            p * vv[2],
        ]
        .map(|value| value * place.density)
    }

    /// Puts the points of both circles into the scratch; none where the density is negligible.
    fn circles(&self, eta: f64, scratch: &mut Scratch) -> Option<Place> {
        let (sin, cos) = libm::sincos(eta);
        let radii = [cos, sin];
        let bound = self.circles[0].bound(cos) + self.circles[1].bound(sin);
        if bound < NEGLIGIBLE {
            return None;
        }
        let peaks = [self.circles[0].maxima(cos), self.circles[1].maxima(sin)];
        let top = peaks[0].top + peaks[1].top;
        if top < NEGLIGIBLE {
            return None;
        }
        let mut density = sin * cos * libm::exp(top);
        for k in 0..2 {
            let points = &mut scratch.points[k];
            density *= self.circles[k].fill(radii[k], &peaks[k], points);
            scratch.evaluations += points.len();
        }
        Some(Place { radii, density })
    }
}

/// |c| − 1 for |c| near 1, to many digits.
fn excess(centre: [f64; 4]) -> f64 {
    let (mut sum, mut rest) = (-1.0, 0.0);
    for c in centre {
        let square = c * c;
        let total = sum + square;
        let part = total - sum;
        rest += ((sum - (total - part)) + (square - part)) + libm::fma(c, c, -square);
        sum = total;
    }
    0.5 * (sum + rest)
}

#[cfg(test)]
mod tests;
