//! The regularised incomplete beta function and its inverse.

/// Most steps of the continued fraction and of the search: far more than shapes up to 1000 need.
const STEPS: u32 = 500;

/// I_x(α, β) with fixed shapes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct IncompleteBeta {
    a: f64,
    b: f64,
    /// ln B(α, β).
    ln_beta: f64,
}

impl IncompleteBeta {
    /// Of positive shapes.
    pub(crate) fn new(a: f64, b: f64) -> Self {
        let ln_beta = libm::lgamma(a) + libm::lgamma(b) - libm::lgamma(a + b);
        Self { a, b, ln_beta }
    }

    /// α and β.
    pub(crate) fn shapes(&self) -> [f64; 2] {
        [self.a, self.b]
    }

    /// ln B(α, β).
    pub(crate) fn ln_beta(&self) -> f64 {
        self.ln_beta
    }

    /// With α and β swapped: I_{1 − x}(β, α) = 1 − I_x(α, β).
    pub(crate) fn swapped(&self) -> Self {
        Self { a: self.b, b: self.a, ..*self }
    }

    /// I_x, from x and 1 − x, both in [0, 1].
    pub(crate) fn share(&self, x: f64, rest: f64) -> f64 {
        if x <= 0.0 {
            0.0
        } else if rest <= 0.0 {
            1.0
        } else if self.converges(x) {
            libm::exp(self.ln_share(libm::log(x), rest)).min(1.0)
        } else {
            1.0 - libm::exp(self.swapped().ln_share(libm::log(rest), x)).min(1.0)
        }
    }

    /// Whether the continued fraction converges fast here, and not that of 1 − x.
    fn converges(&self, x: f64) -> bool {
        x * (self.a + self.b + 2.0) < self.a + 1.0
    }

    /// ln I_x from ln x and 1 − x, where the continued fraction converges (NIST 8.17.22, by Lentz's method).
    fn ln_share(&self, ln_x: f64, rest: f64) -> f64 {
        let (a, b, x) = (self.a, self.b, libm::exp(ln_x));
        let tiny = |v: f64| if v.abs() < 1e-300 { 1e-300 } else { v };
        let (mut c, mut d) = (1.0, 1.0 / tiny(1.0 - (a + b) * x / (a + 1.0)));
        let mut fraction = d;
        for m in 1..STEPS {
            let m = f64::from(m);
            let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
            let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
            let before = fraction;
            for term in [even, odd] {
                d = 1.0 / tiny(1.0 + term * d);
                c = tiny(1.0 + term / c);
                fraction *= c * d;
            }
            if (fraction / before - 1.0).abs() < 1e-16 {
                break;
            }
        }
        a * ln_x + b * libm::log(rest) - self.ln_beta - libm::log(a) + libm::log(fraction)
    }

    /// The x with I_x = p, for p up to one half: Newton's iteration of ln I over ln x, which is nearly a straight
    /// line at small x, kept in by bisection.
    pub(crate) fn inverse(&self, p: f64) -> f64 {
        if p <= 0.0 {
            return 0.0;
        }
        let target = libm::log(p);
        let (mut low, mut high) = (-745.0, 0.0);
        // As if 1 − x were 1, or from the mean.
        let start = (target + self.ln_beta + libm::log(self.a)) / self.a;
        let mut t = start.clamp(low, libm::log(self.a / (self.a + self.b)));
        for _ in 0..STEPS {
            let (x, rest) = (libm::exp(t), -libm::expm1(t));
            let ln_share = if self.converges(x) {
                self.ln_share(t, rest)
            } else {
                libm::log1p(-libm::exp(self.swapped().ln_share(libm::log(rest), x)).min(1.0))
            };
            let excess = ln_share - target;
            if excess < 0.0 {
                low = t;
            } else {
                high = t;
            }
            let slope = self.a * t + (self.b - 1.0) * libm::log(rest) - self.ln_beta - ln_share;
            let newton = t - excess / libm::exp(slope);
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            let done = (next - t).abs() <= 1e-15 * t.abs().max(1e-3);
            t = next;
            if done {
                break;
            }
        }
        libm::exp(t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By mpmath 1.3, 40 digits: x, α, β and I_x.
    #[test]
    fn shares_agree_with_mpmath() {
        for [x, a, b, share] in REFERENCE {
            let found = IncompleteBeta::new(a, b).share(x, 1.0 - x);
            assert!((found / share - 1.0).abs() < 2e-12, "{x} {a} {b}: {found:e} {share:e}");
        }
    }

    #[test]
    fn the_inverse_is_one() {
        let shapes = [0.1, 0.5, 1.0, 2.5, 40.0, 1000.0];
        for (a, b) in shapes.iter().flat_map(|a| shapes.map(|b| (*a, b))) {
            let law = IncompleteBeta::new(a, b);
            for p in [1e-20, 1e-9, 1e-3, 0.1, 0.3, 0.5] {
                let x = law.inverse(p);
                // Of x = 1 − 1e-6, say, the share moves with the last digit.
                let [before, after] = [x.next_down(), x.next_up()].map(|x| law.share(x, 1.0 - x));
                let room = 1e-11 * p;
                assert!(before - room <= p && p <= after + room, "{a} {b} {p:e}: {x:e}");
            }
        }
    }

    const REFERENCE: [[f64; 4]; 24] = [
        [0.627617987059879, 0.5, 2.0, 0.9397283257625455],
        [0.01805323229621771, 0.1, 40.0, 0.9613901954947469],
        [0.07199512550968454, 1.0, 40.0, 0.9496487453243243],
        [0.1, 0.5, 2.0, 0.458530260724415],
        [0.999, 1000.0, 2.0, 0.7353908495419278],
        [0.019230769230769232, 40.0, 1000.0, 4.285449927545299e-05],
        [0.012195121951219513, 1.0, 40.0, 0.38786577809167994],
        [0.9793167063313744, 2.5, 2.0, 0.9981669416658959],
        [0.45454545454545453, 1.0, 0.1, 0.05881313739260195],
        [0.999, 40.0, 0.1, 0.24168811346359492],
        [0.8333333333333334, 0.5, 0.1, 0.25572381610477485],
        [0.0012468827930174563, 0.1, 40.0, 0.7745637992043144],
        [0.024390243902439025, 1.0, 40.0, 0.627569376302195],
        [0.5, 0.1, 0.1, 0.5],
        [0.999, 40.0, 2.0, 0.9992010191652443],
        [0.9999000099990001, 1000.0, 0.1, 0.17248601910630473],
        [0.16666666666666666, 1.0, 2.0, 0.3055555555555555],
        [0.999, 2.5, 0.1, 0.4335182693991604],
        [0.4987531172069825, 40.0, 0.1, 5.695238444772428e-15],
        [0.997506234413965, 40.0, 0.1, 0.17339515079765197],
        [0.25, 0.1, 0.1, 0.4519578536766497],
        [0.13017393351330855, 2.5, 40.0, 0.9553472642157131],
        [0.3333333333333333, 1.0, 2.0, 0.5555555555555556],
        [0.5223550917004948, 1000.0, 1000.0, 0.9772633902705187],
    ];
}
