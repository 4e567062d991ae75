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

use nalgebra::{Complex, SMatrix, SVector};
use std::f64::consts::PI;

pub(crate) type C64 = Complex<f64>;

const NODES: usize = 64;
/// Opening angle of the hyperbola: wider is faster and, from 0.9 on, unsafe.
const ANGLE: f64 = 0.6;
/// The contour ends where the integrand has fallen below e⁻⁴¹ of its maximum.
const DEPTH: f64 = 41.0;

/// The nodes and weights of the contour for one law on S^{N−1}.
#[derive(Clone, Debug)]
pub(crate) struct Contour<const N: usize = 4> {
    /// θ_j c_j, c_j, and θ_j plus the saddle point.
    linear: [f64; N],
    centre: [f64; N],
    d: [f64; N],
    /// Distance from the saddle point, and weight.
    nodes: [(C64, C64); NODES],
    ln_integral: f64,
    shift: f64,
}

impl<const N: usize> Contour<N> {
    /// For the density exp(−½ Σ λ_j (y_j − c_j)²) with λ_j > 0, on |y| = 1. `slack` is 1 − |c|², which
    /// the caller may know better than by that difference.
    pub(crate) fn new(lambda: [f64; N], centre: [f64; N], slack: f64) -> Self {
        let theta = lambda.map(|l| 0.5 * l);
        let k = Exponent::new(theta, centre, slack);
        let path = Path::through(&k);
        let end = path.end(&k);
        let step = end / NODES as f64;
        let nodes = std::array::from_fn(|i| {
            let (u, slope) = path.point((i as f64 + 0.5) * step);
            (u, k.integrand(u) * slope)
        });
        let sum: f64 = nodes.iter().map(|(_, w): &(C64, C64)| w.im).sum();
        let ln_integral = k.at_saddle() + libm::log(2.0 * step / PI * sum);
        let nodes = nodes.map(|(u, w)| (u, w / sum));
        Self {
            linear: std::array::from_fn(|j| theta[j] * centre[j]),
            centre,
            d: k.d,
            nodes,
            ln_integral,
            shift: 2.0 * k.saddle,
        }
    }

    /// ln ∫ exp(−½ Σ λ_j (y_j − c_j)²) dS over the sphere.
    pub(crate) fn ln_integral(&self) -> f64 {
        self.ln_integral
    }

    /// μ for which exp(−½ Σ (λ_j + μ)(y_j − c_j)²), tilted to the same linear term, has |y|² = 1 on
    /// average: twice the saddle point.
    pub(crate) fn shift(&self) -> f64 {
        self.shift
    }

    /// Mean and variance of the coordinates at every point of the contour, with its weight: an
    /// expectation is Σ Im(weight · expectation under that Gaussian of independent coordinates).
    pub(crate) fn nodes(&self) -> impl Iterator<Item = (C64, [C64; N], [C64; N])> {
        self.nodes.iter().map(|(u, w)| {
            let inverse = self.d.map(|d| inverse(u + d));
            let mean = std::array::from_fn(|j| inverse[j] * self.linear[j]);
            (*w, mean, inverse.map(|v| v * 0.5))
        })
    }

    /// The same with the mean of y − c, in which nothing cancels where y keeps to c.
    pub(crate) fn nodes_about_centre(&self) -> impl Iterator<Item = (C64, [C64; N], [C64; N])> {
        let saddle = 0.5 * self.shift;
        self.nodes.iter().map(move |(u, w)| {
            let inverse = self.d.map(|d| inverse(u + d));
            let offset = std::array::from_fn(|j| inverse[j] * (u + saddle) * -self.centre[j]);
            (*w, offset, inverse.map(|v| v * 0.5))
        })
    }

    /// The mean E[y] and the covariance E[(y − E y)(y − E y)ᵀ].
    pub(crate) fn moments(&self) -> (SVector<f64, N>, SMatrix<f64, N, N>) {
        let mut mean = SVector::<f64, N>::zeros();
        for (w, g, _) in self.nodes() {
            for i in 0..N {
                mean[i] += product_im(g[i], w);
            }
        }
        // About the mean, so that small variances keep their digits.
        let mut covariance = SMatrix::<f64, N, N>::zeros();
        for (w, g, variance) in self.nodes() {
            for i in 0..N {
                covariance[(i, i)] += product_im(variance[i], w);
                let weighted = (g[i] - mean[i]) * w;
                for j in 0..=i {
                    covariance[(i, j)] += product_im(weighted, g[j] - mean[j]);
                }
            }
        }
        covariance.fill_upper_triangle_with_lower_triangle();
        (mean, covariance)
    }
}

impl Contour {
    /// Expectations of polynomials of y of degree at most 9, to machine precision: at every node
    /// the Gaussian integral is done by five-point Gauss-Hermite quadrature a coordinate. The
    /// polynomials are evaluated at complex points, where |y| = 1 does not hold.
    pub(crate) fn expect<const M: usize>(
        &self,
        polynomials: impl Fn(&[C64; 4]) -> [C64; M],
    ) -> [f64; M] {
        // Zeros and weights of the Hermite polynomial He₅ = x⁵ − 10x³ + 15x.
        let root = 10.0_f64.sqrt();
        let (a, b) = ((5.0 - root).sqrt(), (5.0 + root).sqrt());
        let weight = |x: f64| {
            let he4 = x * x * x * x - 6.0 * x * x + 3.0;
            120.0 / (25.0 * he4 * he4)
        };
        let rule = [-b, -a, 0.0, a, b].map(|x| (x, weight(x)));

        let mut total = [0.0; M];
        for (w, g, variance) in self.nodes() {
            let points: [[C64; 5]; 4] = std::array::from_fn(|j| {
                let deviation = sqrt(variance[j]);
                rule.map(|(x, _)| g[j] + deviation * x)
            });
            let mut inner = [C64::new(0.0, 0.0); M];
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
}

/// K about its saddle point t₀, in u = z − t₀, where nothing large is subtracted:
/// K − K(t₀) = (1 − Σc²) u + Σ c² u(u + a)/(d + u) − ½ Σ ln(1 + u/d), d = θ + t₀,
/// a = t₀(2θ + t₀)/d.
struct Exponent<const N: usize> {
    theta: [f64; N],
    /// c².
    square: [f64; N],
    slack: f64,
    saddle: f64,
    d: [f64; N],
    inverse_d: [f64; N],
    a: [f64; N],
}

impl<const N: usize> Exponent<N> {
    fn new(theta: [f64; N], centre: [f64; N], slack: f64) -> Self {
        let square = centre.map(|c| c * c);
        let floor = theta.into_iter().fold(f64::INFINITY, f64::min);
        let above = theta.map(|t| t - floor);
        let lift = saddle(&theta, &above, &square, slack);
        let saddle = lift - floor;
        let d = above.map(|t| t + lift);
        Self {
            theta,
            square,
            slack,
            saddle,
            d,
            inverse_d: d.map(|d| 1.0 / d),
            a: std::array::from_fn(|j| saddle * (2.0 * theta[j] + saddle) / d[j]),
        }
    }

    fn at_saddle(&self) -> f64 {
        let t = self.saddle;
        let rational: f64 = (0..N).map(|j| self.square[j] * self.inverse_d[j]).sum();
        let logarithm: f64 = self.d.iter().map(|d| libm::log(d / PI)).sum();
        self.slack * t + t * t * rational - 0.5 * logarithm
    }

    /// The exponential's argument, and √Π(1 + u/d) with its branch followed from u = 0 through the
    /// upper half plane.
    fn parts(&self, u: C64) -> (C64, C64) {
        let mut exponent = u * self.slack;
        let mut root = C64::new(1.0, 0.0);
        let mut pending: Option<C64> = None;
        for j in 0..N {
            exponent += u * (u + self.a[j]) * inverse(u + self.d[j]) * self.square[j];
            let factor = u * self.inverse_d[j] + 1.0;
            pending = match pending {
                // The arguments of two factors add up to less than 2π.
                Some(first) => {
                    root *= upper_sqrt(first * factor);
                    None
                }
                None => Some(factor),
            };
        }
        if let Some(last) = pending {
            root *= upper_sqrt(last);
        }
        (exponent, root)
    }

    /// e^{K(t₀ + u) − K(t₀)}.
    fn integrand(&self, u: C64) -> C64 {
        let (exponent, root) = self.parts(u);
        let (sin, cos) = libm::sincos(exponent.im);
        C64::new(cos, sin) * inverse(root) * libm::exp(exponent.re)
    }

    /// How far ln |e^K| lies below the saddle point.
    fn depth(&self, u: C64) -> f64 {
        let (exponent, root) = self.parts(u);
        0.5 * libm::log(root.norm_sqr()) - exponent.re
    }

    /// K″, and R = −K‴/(6 K″), which sets the width of the contour.
    fn curvature(&self) -> (f64, f64) {
        let (mut k2, mut k3) = (0.0, 0.0);
        for j in 0..N {
            let inverse = self.inverse_d[j];
            let ratio = self.theta[j] * inverse;
            let bend = self.square[j] * ratio * ratio;
            k2 += (2.0 * bend + 0.5 * inverse) * inverse;
            k3 += (6.0 * bend + inverse) * inverse * inverse;
        }
        (k2, k3 / (6.0 * k2))
    }
}

/// The zero of K′ on (−min θ, ∞), where K′ rises from −∞ to 1, less −min θ: Newton, kept in a
/// bracket.
fn saddle<const N: usize>(
    theta: &[f64; N],
    above: &[f64; N],
    square: &[f64; N],
    slack: f64,
) -> f64 {
    let floor = theta[0] - above[0];
    let slope = |d: f64| {
        let t = d - floor;
        let mut k1 = slack;
        let mut k2 = 0.0;
        for j in 0..N {
            let inverse = 1.0 / (above[j] + d);
            let ratio = theta[j] * inverse;
            k1 += (square[j] * t * (1.0 + ratio) - 0.5) * inverse;
            k2 += (2.0 * square[j] * ratio * ratio + 0.5 * inverse) * inverse;
        }
        (k1, k2)
    };
    // K′ < 1 − 1/(2d) makes d = ½ a lower bound.
    let (mut low, mut high) = (0.5, f64::INFINITY);
    // Where the mean carries the law, t₀ is about ¾ whatever the scale.
    let mut d = floor + 0.75;
    for _ in 0..200 {
        let (k1, k2) = slope(d);
        if k1 < 0.0 {
            low = d;
        } else {
            high = d;
        }
        let newton = d - k1 / k2;
        let next = if newton > low && newton < high {
            newton
        } else if high < f64::INFINITY {
            0.5 * (low + high)
        } else {
            4.0 * d
        };
        if (next - d).abs() <= 1e-14 * d {
            break;
        }
        d = next;
    }
    d
}

/// The hyperbola, as distances from the saddle point.
struct Path {
    real: f64,
    imaginary: f64,
    /// √(2/K″) over the speed at the saddle point.
    scale: f64,
}

impl Path {
    fn through<const N: usize>(k: &Exponent<N>) -> Self {
        let (k2, width) = k.curvature();
        let (sin, cos) = libm::sincos(ANGLE);
        let nu = sin / (2.0 * cos * cos * width);
        Self { real: nu * sin, imaginary: nu * cos, scale: (2.0 / k2).sqrt() / (nu * cos) }
    }

    /// u and du/dξ.
    fn point(&self, xi: f64) -> (C64, C64) {
        // e^ξ − 1 and 1 − e^{−ξ}: concentrated laws end at ξ = 1e-6.
        let half = libm::expm1(xi);
        let other = half / (1.0 + half);
        let sinh = 0.5 * (half + other);
        let bend = 0.5 * half * other;
        let cosh = 1.0 + bend;
        let u = C64::new(-self.real * bend, self.imaginary * sinh);
        (u, C64::new(-self.real * sinh, self.imaginary * cosh))
    }

    /// Where the integrand has fallen by DEPTH. The depth is about quadratic in ξ, so its root is
    /// about linear.
    fn end<const N: usize>(&self, k: &Exponent<N>) -> f64 {
        let root = |xi: f64| k.depth(self.point(xi).0).max(0.0).sqrt() - DEPTH.sqrt();
        let (mut low, mut at_low) = (0.0, -DEPTH.sqrt());
        let mut high = (self.scale * DEPTH.sqrt()).clamp(f64::MIN_POSITIVE, 8.0);
        let mut at_high = root(high);
        while at_high < 0.0 && high < 64.0 {
            (low, at_low) = (high, at_high);
            high *= 1.5;
            at_high = root(high);
        }
        for _ in 0..20 {
            if at_high < 0.1 {
                break;
            }
            let middle = low - at_low * (high - low) / (at_high - at_low);
            let value = root(middle);
            if value < 0.0 {
                (low, at_low) = (middle, value);
                // Illinois: an end that stays is worth half.
                at_high = 0.1_f64.max(0.5 * at_high);
            } else {
                (high, at_high) = (middle, value);
            }
        }
        high
    }
}

// `libm` rather than the methods of `Complex`, which use the platform's elementary functions and
// so differ between machines.

/// The square root with a non-negative imaginary part.
fn upper_sqrt(z: C64) -> C64 {
    let root = sqrt(z);
    if root.im < 0.0 { -root } else { root }
}

/// 1/z, for |z| that can be squared.
fn inverse(z: C64) -> C64 {
    let scale = 1.0 / z.norm_sqr();
    C64::new(z.re * scale, -z.im * scale)
}

/// Im(ab).
fn product_im(a: C64, b: C64) -> f64 {
    a.re * b.im + a.im * b.re
}

fn sqrt(z: C64) -> C64 {
    let half = 0.5 * (z.norm_sqr().sqrt() + z.re.abs());
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
    use nalgebra::{Matrix4, Vector4};
    use proptest::prelude::*;

    /// Σ = 1·s and |c| = 1 is the von Mises-Fisher law: C = 4π² e^{-1/s} s I₁(1/s).
    #[test]
    fn isotropic_is_a_bessel_function() {
        // I₁(1) and I₁(10) e^{-10}, DLMF 10.25.2 summed in 50 digits.
        for (s, scaled_bessel) in [(1.0, 0.207_910_415_349_708_45), (0.1, 0.121_262_681_384_455_52)]
        {
            let law = Contour::new([1.0 / s; 4], [0.0, 0.6, 0.0, 0.8], 0.0);
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
            let law = Contour::new([1.0 / s; 4], [0.0, 0.6, 0.0, 0.8], 0.0);
            let series = 1.0 - s * (3.0 / 8.0 + s * (15.0 / 128.0 + s * 315.0 / 3072.0));
            let exact = 1.5 * (2.0 * PI * s).ln() + series.ln();
            let error = law.ln_integral() - exact;
            assert!(error.abs() < 2e-14, "s = 1e-{exponent}: {error:e}");
            assert!(law.moments().0.norm() <= 1.0 + 1e-13);
        }
    }

    #[test]
    fn flat_is_the_area_of_the_sphere() {
        let law = Contour::new([1e-12; 4], [0.0; 4], 1.0);
        assert!((law.ln_integral() - (2.0 * PI * PI).ln()).abs() < 1e-11);
        let (mean, covariance) = law.moments();
        assert!(mean.amax() < 1e-12);
        assert!((covariance - Matrix4::identity() * 0.25).amax() < 1e-12);
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
            let law = Contour::new(exponents.map(|e| 10f64.powf(e)), c.normalize().into(), 0.0);
            let (mean, covariance) = law.moments();
            let trace = covariance.trace() + mean.norm_squared();
            prop_assert!((trace - 1.0).abs() < 1e-13, "{trace}");
            prop_assert!(mean.norm() <= 1.0 + 1e-13);
            let [square, eighth] = law.expect(|y| {
                let s: C64 = y.iter().map(|x| x * x).sum();
                [s, s * s * s * s]
            });
            prop_assert!((square - 1.0).abs() < 1e-12 && (eighth - 1.0).abs() < 1e-10, "{eighth}");
        }
    }
}
