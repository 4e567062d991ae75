//! The normaliser and the moments of exp(−Σθ_j(y_j − c_j)²) on the unit sphere S³, as one contour
//! integral.
//!
//! Writing the constraint |y| = 1 as an inverse Laplace transform leaves a Gaussian integral at
//! every point of the contour:
//!
//! C = 2·(1/2πi) ∫ e^{K(z)} dz,
//! K(z) = (1 − Σc²) z + z² Σ c_j²/(θ_j + z) − ½ Σ ln((θ_j + z)/π),
//!
//! and under it y_j has the (complex) mean θ_j c_j/(θ_j + z) and variance 1/(2(θ_j + z)). In this
//! form nothing cancels and nothing overflows, however concentrated the law is. The contour is
//! the hyperbola of Weideman & Trefethen (2007, doi:10.1090/S0025-5718-07-01945-X) through the
//! saddle point, curved to follow steepest descent there; the midpoint rule on it converges
//! geometrically.

use nalgebra::{Complex, Matrix4, Vector4};
use std::f64::consts::PI;

type C64 = Complex<f64>;

const NODES: usize = 64;
/// Opening angle of the hyperbola: wider is faster and, from 0.9 on, unsafe.
const ANGLE: f64 = 0.6;
/// The contour ends where the integrand has fallen below e⁻⁴¹ of its maximum.
const DEPTH: f64 = 41.0;

/// The nodes and weights of the contour for one law.
#[derive(Clone, Debug)]
pub(crate) struct Contour {
    theta: [f64; 4],
    center: [f64; 4],
    nodes: [(C64, C64); NODES],
    ln_integral: f64,
}

impl Contour {
    /// For the density exp(−½ Σ λ_j (y_j − c_j)²) with λ_j > 0 and |c| ≤ 1 (to rounding).
    pub(crate) fn new(lambda: [f64; 4], center: [f64; 4]) -> Self {
        let theta = lambda.map(|l| 0.5 * l);
        let slack = 1.0 - center.iter().map(|c| c * c).sum::<f64>();
        // Rounding in |c| = 1 must not be amplified by a large saddle point.
        let slack = if slack.abs() < 1e-12 { 0.0 } else { slack };
        let k = Exponent { theta, center, slack };

        let t0 = k.saddle();
        let at_saddle = k.value_real(t0);
        let curvature = k.curvature(t0);
        let (sin, cos) = (libm::sin(ANGLE), libm::cos(ANGLE));
        let nu = sin / (2.0 * cos * cos * curvature);
        let point = |xi: f64| {
            let (e, inverse) = (libm::exp(xi), libm::exp(-xi));
            let (cosh, sinh) = (0.5 * (e + inverse), 0.5 * (e - inverse));
            let z = C64::new(t0 + nu * sin * (1.0 - cosh), nu * cos * sinh);
            let slope = C64::new(-nu * sin * sinh, nu * cos * cosh);
            (z, slope)
        };
        let depth = |xi: f64| at_saddle - k.value(point(xi).0).re;
        // Concentrated laws end at 1e-6, flat ones at 5: found by factors, then by halves.
        let mut end = 1.0;
        while depth(end) < DEPTH && end < 64.0 {
            end *= 2.0;
        }
        while depth(0.5 * end) > DEPTH {
            end *= 0.5;
        }
        let mut start = 0.5 * end;
        for _ in 0..8 {
            let middle = 0.5 * (start + end);
            if depth(middle) < DEPTH { start = middle } else { end = middle }
        }

        let step = end / NODES as f64;
        let nodes = std::array::from_fn(|i| {
            let (z, slope) = point((i as f64 + 0.5) * step);
            (z, exp(k.value(z) - at_saddle) * slope)
        });
        let sum: f64 = nodes.iter().map(|(_, w): &(C64, C64)| w.im).sum();
        let ln_integral = at_saddle + libm::log(2.0 * step / PI * sum);
        let nodes = nodes.map(|(z, w)| (z, w / sum));
        Self { theta, center, nodes, ln_integral }
    }

    /// ln ∫ exp(−½ Σ λ_j (y_j − c_j)²) dS over S³.
    pub(crate) fn ln_integral(&self) -> f64 {
        self.ln_integral
    }

    /// E[y] and E[y yᵀ].
    pub(crate) fn moments(&self) -> (Vector4<f64>, Matrix4<f64>) {
        let (mut first, mut second) = (Vector4::zeros(), Matrix4::zeros());
        for (z, w) in &self.nodes {
            let (g, variance) = self.gaussian(*z);
            for i in 0..4 {
                first[i] += (g[i] * w).im;
                for j in 0..=i {
                    let own = if i == j { variance[i] } else { C64::new(0.0, 0.0) };
                    second[(i, j)] += ((g[i] * g[j] + own) * w).im;
                }
            }
        }
        second.fill_upper_triangle_with_lower_triangle();
        (first, second)
    }

    /// Expectations of `N` polynomials of y of degree at most 9, to machine precision: at every
    /// node the Gaussian integral is done by five-point Gauss-Hermite quadrature a coordinate.
    /// The polynomials are evaluated at complex points, where |y| = 1 does not hold.
    pub(crate) fn expect<const N: usize>(
        &self,
        polynomials: impl Fn(&[C64; 4]) -> [C64; N],
    ) -> [f64; N] {
        // Zeros and weights of the Hermite polynomial He₅ = x⁵ − 10x³ + 15x.
        let root = 10.0_f64.sqrt();
        let (a, b) = ((5.0 - root).sqrt(), (5.0 + root).sqrt());
        let weight = |x: f64| {
            let he4 = x * x * x * x - 6.0 * x * x + 3.0;
            120.0 / (25.0 * he4 * he4)
        };
        let rule = [-b, -a, 0.0, a, b].map(|x| (x, weight(x)));

        let mut total = [0.0; N];
        for (z, w) in &self.nodes {
            let (g, variance) = self.gaussian(*z);
            let points: [[C64; 5]; 4] = std::array::from_fn(|j| {
                let deviation = sqrt(variance[j]);
                rule.map(|(x, _)| g[j] + deviation * x)
            });
            let mut inner = [C64::new(0.0, 0.0); N];
            for cell in 0..625 {
                let index = [cell % 5, cell / 5 % 5, cell / 25 % 5, cell / 125];
                let weight: f64 = index.iter().map(|&i| rule[i].1).product();
                let values = polynomials(&std::array::from_fn(|j| points[j][index[j]]));
                for (sum, value) in inner.iter_mut().zip(values) {
                    *sum += value * weight;
                }
            }
            for (sum, value) in total.iter_mut().zip(inner) {
                *sum += (value * w).im;
            }
        }
        total
    }

    /// Mean and variance of the coordinates at a point of the contour.
    fn gaussian(&self, z: C64) -> ([C64; 4], [C64; 4]) {
        let inverse = self.theta.map(|t| (z + t).inv());
        let mean = std::array::from_fn(|j| inverse[j] * (self.theta[j] * self.center[j]));
        (mean, inverse.map(|v| v * 0.5))
    }
}

/// K and its derivatives.
struct Exponent {
    theta: [f64; 4],
    center: [f64; 4],
    slack: f64,
}

impl Exponent {
    fn terms(&self) -> impl Iterator<Item = (f64, f64)> {
        self.theta.into_iter().zip(self.center.map(|c| c * c))
    }

    fn value_real(&self, t: f64) -> f64 {
        let sums = self.terms().fold((0.0, 0.0), |(rational, ln), (theta, cc)| {
            (rational + cc / (theta + t), ln + libm::log((theta + t) / PI))
        });
        self.slack * t + t * t * sums.0 - 0.5 * sums.1
    }

    fn value(&self, z: C64) -> C64 {
        let mut rational = C64::new(0.0, 0.0);
        let mut logarithm = C64::new(0.0, 0.0);
        for (theta, cc) in self.terms() {
            let d = z + theta;
            rational += d.inv() * cc;
            logarithm += ln(d / PI);
        }
        z * self.slack + z * z * rational - logarithm * 0.5
    }

    /// The zero of K′ on (−min θ, ∞), where K′ rises from −∞ to 1: Newton, kept in a bracket.
    fn saddle(&self) -> f64 {
        let floor = self.theta.into_iter().fold(f64::INFINITY, f64::min);
        // In terms of d = t + min θ > 0; K′ < 1 − 1/(2d) makes d = ½ a lower bound.
        let slope = |d: f64| {
            let t = d - floor;
            let mut k1 = self.slack;
            let mut k2 = 0.0;
            for (theta, cc) in self.terms() {
                let s = (theta - floor) + d;
                k1 += cc * t * (theta + s) / (s * s) - 0.5 / s;
                k2 += 2.0 * cc * theta * theta / (s * s * s) + 0.5 / (s * s);
            }
            (k1, k2)
        };
        let (mut low, mut high) = (0.5, 2.0);
        while slope(high).0 < 0.0 && high < 1e300 {
            low = high;
            high *= 4.0;
        }
        let mut d = 0.5 * (low + high);
        for _ in 0..200 {
            let (k1, k2) = slope(d);
            if k1 < 0.0 {
                low = d
            } else {
                high = d
            }
            let newton = d - k1 / k2;
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            if (next - d).abs() <= 1e-14 * d {
                break;
            }
            d = next;
        }
        d - floor
    }

    /// R = −K‴/(6 K″), which sets the width of the contour.
    fn curvature(&self, t: f64) -> f64 {
        let (mut k2, mut k3) = (0.0, 0.0);
        for (theta, cc) in self.terms() {
            let d = theta + t;
            let bend = cc * (theta / d) * (theta / d);
            k2 += 2.0 * bend / d + 0.5 / (d * d);
            k3 += (6.0 * bend + 1.0 / d) / (d * d);
        }
        k3 / (6.0 * k2)
    }
}

// `libm` rather than the methods of `Complex`, which use the platform's elementary functions and
// so differ between machines.

fn exp(z: C64) -> C64 {
    let (sin, cos) = libm::sincos(z.im);
    C64::new(cos, sin) * libm::exp(z.re)
}

fn ln(z: C64) -> C64 {
    C64::new(libm::log(libm::hypot(z.re, z.im)), libm::atan2(z.im, z.re))
}

fn sqrt(z: C64) -> C64 {
    let half = 0.5 * (libm::hypot(z.re, z.im) + z.re.abs());
    let root = half.sqrt();
    if root == 0.0 {
        return C64::new(0.0, 0.0);
    }
    let other = 0.5 * z.im / root;
    if z.re >= 0.0 { C64::new(root, other) } else { C64::new(other.abs(), root.copysign(z.im)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Σ = 1·s and |c| = 1 is the von Mises-Fisher law: C = 4π² e^{-1/s} s I₁(1/s).
    #[test]
    fn isotropic_is_a_bessel_function() {
        // I₁(1) and I₁(10) e^{-10}, DLMF 10.25.2 summed in 50 digits.
        for (s, scaled_bessel) in [(1.0, 0.207_910_415_349_708_45), (0.1, 0.121_262_681_384_455_52)]
        {
            let law = Contour::new([1.0 / s; 4], [0.0, 0.6, 0.0, 0.8]);
            let exact = (4.0 * PI * PI * s * scaled_bessel).ln();
            assert!((law.ln_integral() - exact).abs() < 1e-14, "{} {exact}", law.ln_integral());
        }
    }

    /// Σ = s·1 with tiny s: the asymptotic series of I₁ (DLMF 10.40.1), whose next term is below
    /// rounding.
    #[test]
    fn concentrated_laws_match_the_asymptotic_series() {
        for exponent in 4..=14 {
            let s = 10f64.powi(-exponent);
            let law = Contour::new([1.0 / s; 4], [0.0, 0.6, 0.0, 0.8]);
            let series = 1.0 - s * (3.0 / 8.0 + s * (15.0 / 128.0 + s * 315.0 / 3072.0));
            let exact = 1.5 * (2.0 * PI * s).ln() + series.ln();
            let error = law.ln_integral() - exact;
            let allowed = if exponent < 9 { 1e-13 } else { 1e-10 };
            assert!(error.abs() < allowed, "s = 1e-{exponent}: {error:e}");
            assert!(law.moments().0.norm() <= 1.0 + 1e-13);
        }
    }

    #[test]
    fn flat_is_the_area_of_the_sphere() {
        let law = Contour::new([1e-12; 4], [0.0; 4]);
        assert!((law.ln_integral() - (2.0 * PI * PI).ln()).abs() < 1e-11);
        let (first, second) = law.moments();
        assert!(first.amax() < 1e-12);
        assert!((second - Matrix4::identity() * 0.25).amax() < 1e-12);
    }

    #[test]
    fn complex_roots_are_the_principal_ones() {
        for (re, im) in [(3.0, 4.0), (-3.0, 4.0), (-3.0, -4.0), (0.0, 1.0), (0.0, 0.0), (-1.0, 0.0)]
        {
            let z = C64::new(re, im);
            let root = sqrt(z);
            assert!((root * root - z).norm() < 1e-15 && root.re >= 0.0);
        }
    }

    proptest! {
        /// |y| = 1 makes the trace of E[y yᵀ] one and E[|y|⁸] one: two checks of the whole chain.
        #[test]
        fn moments_know_the_sphere(
            exponents in prop::array::uniform4(-6.0..8.0f64),
            c in prop::array::uniform4(-1.0..1.0f64),
        ) {
            let c = Vector4::from(c);
            prop_assume!(c.norm() > 0.1);
            let law = Contour::new(exponents.map(|e| 10f64.powf(e)), c.normalize().into());
            let (first, second) = law.moments();
            prop_assert!((second.trace() - 1.0).abs() < 1e-13, "{}", second.trace());
            prop_assert!(first.norm() <= 1.0 + 1e-13);
            let [square, eighth] = law.expect(|y| {
                let s: C64 = y.iter().map(|x| x * x).sum();
                [s, s * s * s * s]
            });
            prop_assert!((square - 1.0).abs() < 1e-12 && (eighth - 1.0).abs() < 1e-10, "{eighth}");
        }
    }
}
