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
#[derive(Clone, Debug)]
pub struct AngularQuadrature {
    plane: Planes,
    arcs: Vec<[f64; 2]>,
    ln_normaliser: f64,
    mean: Vector4<f64>,
    second_moment: Matrix4<f64>,
    error: f64,
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
        let (axes, lambda, center, _) = self.law().eigenform();
        AngularQuadrature::new(Planes::new(axes, lambda, center, excess(center)), 0.0)
    }
}

impl FisherBingham {
    /// The normaliser and the moments by quadrature over the angles, which checks
    /// [`ln_normaliser`](Self::ln_normaliser), [`mean_vector`](Self::mean_vector) and
    /// [`second_moment`](Self::second_moment) by another way.
    #[must_use]
    pub fn by_quadrature(&self) -> AngularQuadrature {
        let (axes, lambda, center, ln_offset) = self.eigenform();
        AngularQuadrature::new(Planes::new(axes, lambda, center, 0.0), ln_offset)
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
            mean: plane.axes * mean,
            second_moment: plane.axes * second * plane.axes.transpose(),
            error: truncation + plane.rounding(),
            evaluations: scratch.evaluations,
            arcs: arcs.iter().map(|arc| [arc.low, arc.high]).collect(),
            plane,
        }
    }

    /// ln C, as the law itself defines it.
    #[must_use]
    pub fn ln_normaliser(&self) -> f64 {
        self.ln_normaliser
    }

    /// The mean E x of the four coordinates.
    #[must_use]
    pub fn mean_vector(&self) -> Vector4<f64> {
        self.mean
    }

    /// The second moment E xxᵀ.
    #[must_use]
    pub fn second_moment(&self) -> Matrix4<f64> {
        self.second_moment
    }

    /// The estimated relative error of C, which is also the estimated absolute error of the moments:
    /// that of the rule over η, plus a bound of what rounding does to the exponents.
    #[must_use]
    pub fn estimated_error(&self) -> f64 {
        self.error
    }

    /// How often the density of one circle was evaluated.
    #[must_use]
    pub fn evaluations(&self) -> usize {
        self.evaluations
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
    fn new(axes: &Matrix4<f64>, lambda: [f64; 4], center: [f64; 4], excess: f64) -> Self {
        let mut order = [0, 1, 2, 3];
        order.sort_by(|&i, &j| lambda[j].total_cmp(&lambda[i]));
        let circle = |i: usize, j: usize| Circle {
            lambda: [lambda[order[i]], lambda[order[j]]],
            center: [center[order[i]], center[order[j]]],
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
        for r in [first.center[0].abs(), first.center[1].abs(), first.distance()] {
            marks.push((libm::atan2(legs(r), r), first.width()));
        }
        for r in [second.center[0].abs(), second.center[1].abs(), second.distance()] {
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
fn excess(center: [f64; 4]) -> f64 {
    let (mut sum, mut rest) = (-1.0, 0.0);
    for c in center {
        let square = c * c;
        let total = sum + square;
        let part = total - sum;
        rest += ((sum - (total - part)) + (square - part)) + libm::fma(c, c, -square);
        sum = total;
    }
    0.5 * (sum + rest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::HypersphericalAngles;
    use proptest::prelude::*;
    use std::f64::consts::{PI, TAU};

    fn law(mean: [f64; 4], variances: [f64; 4]) -> RadiallyConstrainedGaussian {
        turned(mean, variances, Matrix4::identity())
    }

    fn turned(
        mean: [f64; 4],
        variances: [f64; 4],
        turn: Matrix4<f64>,
    ) -> RadiallyConstrainedGaussian {
        let mean = UnitQuaternion::from_quaternion(Quaternion::from(Vector4::from(mean)));
        let covariance = turn * Matrix4::from_diagonal(&variances.into()) * turn.transpose();
        let covariance = (covariance + covariance.transpose()) * 0.5;
        RadiallyConstrainedGaussian::new(mean, covariance).unwrap()
    }

    fn paper() -> RadiallyConstrainedGaussian {
        law([0.0249, 0.0005, -0.0100, 0.9996], [2e-5, 6e-4, 6e-4, 0.6])
    }

    /// Laws with one, two or three narrow coordinates, means on the axes, on ridges and off them.
    fn hard() -> Vec<RadiallyConstrainedGaussian> {
        let mut laws = Vec::new();
        for mean in [
            [1.0, 2.0, 3.0, 4.0],
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, 1.0],
            [1e-4, 0.6, 0.0, 0.8],
            [0.6, 1e-5, 0.8, -1e-4],
        ] {
            for variances in [
                [1e-8; 4],
                [1e8; 4],
                [1e-8, 1.0, 1.0, 1.0],
                [1e-8, 1e8, 1e8, 1e8],
                [1e-8, 1e-8, 1e8, 1e8],
                [1e-8, 1e-8, 1e-8, 1e8],
                [1e-8, 1e-5, 1e-2, 10.0],
                [1e8, 1e-8, 1e-4, 1e-8],
            ] {
                laws.push(law(mean, variances));
            }
        }
        laws
    }

    fn check(law: &RadiallyConstrainedGaussian, tolerance: f64) -> Result<(), String> {
        let rule = law.by_quadrature();
        let errors = [
            (rule.ln_normaliser() - law.ln_normaliser()).abs(),
            (rule.mean_vector() - law.mean_vector()).amax(),
            (rule.second_moment() - law.second_moment()).amax(),
            (rule.second_moment().trace() - 1.0).abs(),
        ];
        let good = |e: f64| e < tolerance && e < rule.estimated_error() + 1e-13;
        if errors.into_iter().all(good) && rule.estimated_error() < 1e-10 {
            return Ok(());
        }
        Err(format!("{errors:?}, {:e} estimated: {law:?}", rule.estimated_error()))
    }

    /// ln C of five laws from a contour integral in 200-bit arithmetic.
    #[test]
    fn normaliser_matches_the_reference() {
        for (mean, variances, expected) in [
            ([0.0249, 0.0005, -0.01, 0.9996], [2e-5, 6e-4, 6e-4, 0.6], -10.035_477_697_452_611),
            ([0.0, 0.0, 0.0, 1.0], [1.0; 4], 2.105_106_145_327_859_7),
            ([1.0, 2.0, 3.0, 4.0], [0.1, 0.2, 0.3, 0.4], 0.345_857_164_922_322_6),
            ([1.0, -1.0, 1.0, -1.0], [1e-6, 1e-4, 1e-2, 1.0], -9.770_789_315_952_086),
            ([0.02, -0.01, 0.03, 0.999], [1e-4, 2e-4, 3e-4, 100.0], -9.478_599_176_362_945),
        ] {
            let rule = law(mean, variances).by_quadrature();
            let error = rule.ln_normaliser() - expected;
            assert!(error.abs() < 1e-13, "{variances:?}: {error:e}");
        }
    }

    #[test]
    fn hard_laws_match_the_contour() {
        for law in hard() {
            check(&law, 1e-12).unwrap();
        }
    }

    #[test]
    fn closed_forms() {
        // Isotropic Σ = s·1: C = 4π² s I₁(1/s) exp(−1/s), and |E x| = I₂/I₁, by their integrals.
        let bessel = |n: f64, k: f64| {
            let count = 2000;
            let sum: f64 = (0..count)
                .map(|i| {
                    let t = PI * (f64::from(i) + 0.5) / f64::from(count);
                    (k * (t.cos() - 1.0)).exp() * (n * t).cos()
                })
                .sum();
            sum / f64::from(count)
        };
        for s in [1e-4, 0.03, 0.5, 3.0, 1e3] {
            let rule = law([0.1, -0.2, 0.3, 0.9], [s; 4]).by_quadrature();
            let expected = (4.0 * PI * PI * s * bessel(1.0, 1.0 / s)).ln();
            assert!((rule.ln_normaliser() - expected).abs() < 1e-11, "{s}");
            let length = bessel(2.0, 1.0 / s) / bessel(1.0, 1.0 / s);
            assert!((rule.mean_vector().norm() - length).abs() < 1e-11, "{s}");
        }
        let flat = FisherBingham::new(Matrix4::zeros(), Vector4::zeros()).unwrap().by_quadrature();
        assert!((flat.ln_normaliser() - (2.0 * PI * PI).ln()).abs() < 1e-14);
        assert!((flat.second_moment() - Matrix4::identity() * 0.25).amax() < 1e-14);
        assert!(flat.mean_vector().amax() < 1e-14);
    }

    /// ∫ g(Φ) dΦ by the midpoint rule in θ₃ and Gauss's, in panels, in θ₁ and θ₂.
    fn over_angles(g: impl Fn(&HypersphericalAngles) -> f64) -> f64 {
        let nodes: Vec<_> = (0..3)
            .flat_map(|i| kronrod(f64::from(i) * PI / 3.0, f64::from(i + 1) * PI / 3.0))
            .collect();
        let mut sum = 0.0;
        for &(first, w1, _) in &nodes {
            for &(second, w2, _) in &nodes {
                for k in 0..64 {
                    let third = TAU * (f64::from(k) + 0.5) / 64.0;
                    let angles = HypersphericalAngles::new([first, second, third]).unwrap();
                    sum += w1 * w2 * TAU / 64.0 * g(&angles);
                }
            }
        }
        sum
    }

    /// Eq. 21 and 26 to the letter, in Φ with the Jacobian of Eq. 25, for a law mild enough; without
    /// the Jacobian, or with its square, the same sum is far off.
    #[test]
    fn a_product_rule_in_the_papers_angles_agrees() {
        let turn =
            Matrix4::from_fn(|i, j| f64::from((3 * i as i32 + 5 * j as i32) % 7) - 2.5).qr().q();
        let law = turned([0.2, -0.1, 0.3, 0.9], [0.3, 0.4, 0.5, 0.8], turn);
        let e = |a: &HypersphericalAngles| {
            let e = a.quaternion().coords - law.mean().coords;
            (-0.5 * e.dot(&(law.precision() * e))).exp()
        };
        let ln_c = law.by_quadrature().ln_normaliser();
        let right = over_angles(|a| a.jacobian() * e(a));
        assert!((right.ln() - ln_c).abs() < 1e-12, "{:e}", right.ln() - ln_c);
        let total = over_angles(|a| law.ln_density_of_angles(a).exp());
        assert!((total - 1.0).abs() < 1e-12, "{total}");
        for power in [0, 2] {
            let wrong = over_angles(|a| a.jacobian().powi(power) * e(a));
            assert!((wrong.ln() - ln_c).abs() > 0.1, "{power}: {}", wrong.ln() - ln_c);
        }
    }

    #[test]
    fn expectations_are_those_of_the_contour() {
        let law = paper();
        let rule = law.by_quadrature();
        let [one, x4, fourth] = rule.expect(|q| [1.0, q.w, q.w.powi(3) * q.i]);
        let [exact] = law.expect(|x| [x[3] * x[3] * x[3] * x[0]]);
        assert!((one - 1.0).abs() < 1e-13);
        assert!((x4 - law.mean_vector()[3]).abs() < 1e-12);
        assert!((fourth - exact).abs() < 1e-12, "{:e}", fourth - exact);
        // Not a polynomial: the mean turn of a flat law is π/2 + 2/π.
        let flat = self::law([0.0, 0.0, 0.0, 1.0], [1e12; 4]).by_quadrature();
        let [turn] = flat.expect(|q| [q.angle()]);
        assert!((turn - FRAC_PI_2 - 2.0 / PI).abs() < 1e-3, "{turn}");
    }

    /// Beyond the range of 1e-8 to 1e8 the error grows, and is owned to.
    #[test]
    fn the_error_is_owned_to() {
        for s in [1e-10, 1e-12, 1e-14] {
            for variances in [[s; 4], [s, s, 1.0, 1.0], [s, 1.0, 1e14, 1e14]] {
                let law = law([0.5, -0.5, 0.1, 0.7], variances);
                let rule = law.by_quadrature();
                let error = (rule.ln_normaliser() - law.ln_normaliser()).abs();
                assert!(error < rule.estimated_error(), "{variances:?}: {error:e}");
                assert!(rule.estimated_error() < 10.0 * f64::EPSILON / s.sqrt());
            }
        }
    }

    #[test]
    fn a_fisher_bingham_law_keeps_its_own_normaliser() {
        let p = Matrix4::from_diagonal(&Vector4::new(1e6, -3e4, 30.0, 0.0));
        for b in [Vector4::zeros(), Vector4::new(1e5, 3e4, 2.0, -1.0)] {
            let law = FisherBingham::new(p, b).unwrap();
            let (rule, exact) = (law.by_quadrature(), law.ln_normaliser());
            let error = (rule.ln_normaliser() - exact).abs();
            assert!(error < 1e-11 + 4.0 * f64::EPSILON * exact.abs(), "{error:e}");
            assert!((rule.second_moment() - law.second_moment()).amax() < 1e-11);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(160))]
        #[test]
        fn any_law_matches_the_contour(
            x in prop::array::uniform16(-1.0..1.0f64),
            exponents in prop::array::uniform4(-8.0..8.0f64),
            mean in prop::array::uniform4(-1.0..1.0f64),
            equal in 0..4usize,
            diagonal in any::<bool>(),
            on_axis in 0..4usize,
        ) {
            let mut mean = mean;
            let mut variances = exponents.map(|e| 10f64.powf(e));
            variances[equal] = variances[0];
            if on_axis > 0 {
                mean[on_axis] = 0.0;
            }
            prop_assume!(Vector4::from(mean).norm() > 0.1);
            let turn = if diagonal { Matrix4::identity() } else { Matrix4::from_row_slice(&x).qr().q() };
            // Turning large variances takes the small ones below rounding.
            let floor = variances.into_iter().fold(0.0, f64::max) * 1e-12;
            if !diagonal {
                variances = variances.map(|s| s.max(floor));
            }
            if let Err(message) = check(&turned(mean, variances, turn), 1e-11) {
                return Err(TestCaseError::fail(message));
            }
        }
    }
}
