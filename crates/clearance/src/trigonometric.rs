//! Trigonometric polynomials, and whether one is positive at all angles.

use std::sync::LazyLock;

/// Harmonics of a trigonometric polynomial beyond the constant.
const HARMONICS: usize = 4;
/// Cells that a circle is cut into first.
const CELLS: usize = 16;
/// Halvings of a cell at most: 1e-6 rad.
const DEEPEST: u8 = 18;
/// Cells looked at: four minima, each followed down, take a hundred, flat ones many more.
const MOST_CELLS: usize = 1024;

/// Middles of the first cells: angle, cosine, sine.
static MIDDLES: LazyLock<[[f64; 3]; CELLS]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let angle = std::f64::consts::PI / CELLS as f64 * (2 * i + 1) as f64;
        let (sin, cos) = libm::sincos(angle);
        [angle, cos, sin]
    })
});

/// c₀ + Σ (cₖ cos kθ + sₖ sin kθ), k up to 4.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Trigonometric {
    pub(crate) constant: f64,
    pub(crate) cos: [f64; HARMONICS],
    pub(crate) sin: [f64; HARMONICS],
}

/// What is known of the sign of a polynomial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Sign {
    /// Above the floor everywhere.
    Above,
    /// Below zero and the floor at the angle with this cosine and sine, about as far below as anywhere.
    Below(f64, f64),
    /// Nowhere seen below, and not proven above the floor.
    Unclear,
}

impl Trigonometric {
    pub(crate) fn constant(constant: f64) -> Self {
        Self { constant, ..Self::default() }
    }

    pub(crate) fn plus(&self, other: &Self, times: f64) -> Self {
        Self {
            constant: self.constant + times * other.constant,
            cos: std::array::from_fn(|k| self.cos[k] + times * other.cos[k]),
            sin: std::array::from_fn(|k| self.sin[k] + times * other.sin[k]),
        }
    }

    /// The product of two polynomials of at most two harmonics.
    pub(crate) fn times(&self, other: &Self) -> Self {
        let mut p = Self::constant(self.constant * other.constant);
        for k in 0..2 {
            p.cos[k] += self.constant * other.cos[k] + self.cos[k] * other.constant;
            p.sin[k] += self.constant * other.sin[k] + self.sin[k] * other.constant;
            for j in 0..2 {
                let cc = 0.5 * self.cos[k] * other.cos[j];
                let ss = 0.5 * self.sin[k] * other.sin[j];
                let cs = 0.5 * self.cos[k] * other.sin[j];
                let sc = 0.5 * self.sin[k] * other.cos[j];
                p.cos[k + j + 1] += cc - ss;
                p.sin[k + j + 1] += cs + sc;
                if k == j {
                    p.constant += cc + ss;
                } else {
                    let low = k.abs_diff(j) - 1;
                    p.cos[low] += cc + ss;
                    p.sin[low] += if k > j { sc - cs } else { cs - sc };
                }
            }
        }
        p
    }

    /// Sum of the moduli of the coefficients: no value is larger.
    pub(crate) fn size(&self) -> f64 {
        let moduli = self.cos.iter().zip(&self.sin).map(|(c, s)| c.abs() + s.abs());
        self.constant.abs() + moduli.sum::<f64>()
    }

    /// Bound on the third derivative.
    fn third(&self) -> f64 {
        let mut sum = 0.0;
        for (k, (c, s)) in self.cos.iter().zip(&self.sin).enumerate() {
            let n = (k + 1) as f64;
            sum += n * n * n * (c * c + s * s).sqrt();
        }
        sum
    }

    /// Value, first and second derivative at an angle.
    pub(crate) fn taylor(&self, cos: f64, sin: f64) -> [f64; 3] {
        let (mut c, mut s) = (cos, sin);
        let mut sums = [self.constant, 0.0, 0.0];
        for k in 0..HARMONICS {
            let n = (k + 1) as f64;
            let even = self.cos[k] * c + self.sin[k] * s;
            sums[0] += even;
            sums[1] += n * (self.sin[k] * c - self.cos[k] * s);
            sums[2] -= n * n * even;
            (c, s) = (c * cos - s * sin, s * cos + c * sin);
        }
        sums
    }

    /// Whether it is proven to be above `floor` everywhere.
    pub(crate) fn is_above(&self, floor: f64) -> bool {
        let least = self.constant - (self.size() - self.constant.abs());
        least > floor || (self.constant > floor && self.search(floor, true) == Sign::Above)
    }

    /// Whether it is above `floor` everywhere: by cells on which the third-order Taylor bound says
    /// so, halved where it does not.
    pub(crate) fn sign(&self, floor: f64) -> Sign {
        self.search(floor, false)
    }

    /// `quick`: the first angle that is below will do.
    fn search(&self, floor: f64, quick: bool) -> Sign {
        let third = self.third() / 6.0;
        if !third.is_finite() || !self.constant.is_finite() {
            return Sign::Unclear;
        }
        let mut best = (floor.min(0.0), None);
        let mut unclear = false;
        let first = std::f64::consts::PI / CELLS as f64;
        let middles = &*MIDDLES;
        // Depth first: at most one sibling waits on each level.
        let mut stack = [(0.0, 0u8); DEEPEST as usize + 2];
        let mut waiting = 0;
        let mut begun = 0;
        let mut looks = 0;
        while (waiting > 0 || begun < CELLS) && looks < MOST_CELLS {
            looks += 1;
            let (angle, depth, cos, sin) = if waiting > 0 {
                waiting -= 1;
                let (angle, depth) = stack[waiting];
                let (sin, cos) = libm::sincos(angle);
                (angle, depth, cos, sin)
            } else {
                let [angle, cos, sin] = middles[begun];
                begun += 1;
                (angle, 0, cos, sin)
            };
            let half = first / f64::from(1u32 << depth);
            let [value, slope, bend] = self.taylor(cos, sin);
            // The lowest point of the parabola on the cell.
            let at = if bend > 0.0 { (-slope / bend).clamp(-half, half) } else { 0.0 };
            let parabola = |x: f64| value + x * (slope + 0.5 * bend * x);
            let (x, lowest) = [at, -half, half]
                .map(|x| (x, parabola(x)))
                .into_iter()
                .fold((0.0, value), |a, b| if b.1 < a.1 { b } else { a });
            let bound = lowest - third * half * half * half;
            // Within a thousandth of the lowest is low enough.
            let enough = if best.1.is_some() { 1.001 * best.0 } else { floor };
            if bound >= enough {
                continue;
            }
            if lowest < best.0 {
                let (sin, cos) = libm::sincos(angle + x);
                let value = self.taylor(cos, sin)[0];
                if value < best.0 {
                    best = (value, Some((cos, sin)));
                    if quick {
                        break;
                    }
                    if bound >= 1.001 * value {
                        continue;
                    }
                }
            }
            if depth == DEEPEST {
                unclear = true;
                continue;
            }
            stack[waiting] = (angle - 0.5 * half, depth + 1);
            stack[waiting + 1] = (angle + 0.5 * half, depth + 1);
            waiting += 2;
        }
        match best.1 {
            Some((cos, sin)) => Sign::Below(cos, sin),
            None if unclear || waiting > 0 || begun < CELLS => Sign::Unclear,
            None => Sign::Above,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn poly(c: &[f64]) -> Trigonometric {
        let mut p = Trigonometric::constant(c[0]);
        for k in 0..(c.len() - 1) / 2 {
            (p.cos[k], p.sin[k]) = (c[1 + 2 * k], c[2 + 2 * k]);
        }
        p
    }

    fn value(p: &Trigonometric, angle: f64) -> f64 {
        let terms = (0..4).map(|k| {
            let (s, c) = ((k + 1) as f64 * angle).sin_cos();
            p.cos[k] * c + p.sin[k] * s
        });
        p.constant + terms.sum::<f64>()
    }

    #[test]
    fn what_is_not_a_number_is_not_above() {
        assert_eq!(Trigonometric::constant(f64::NAN).sign(0.0), Sign::Unclear);
        assert_eq!(Trigonometric::constant(f64::INFINITY).sign(0.0), Sign::Unclear);
        assert_eq!(Trigonometric::constant(1.0).sign(0.0), Sign::Above);
        assert!(matches!(Trigonometric::constant(-1.0).sign(0.0), Sign::Below(..)));
        // (1 − cos θ)² has a fourfold zero.
        let flat = poly(&[1.5, -2.0, 0.0, 0.5, 0.0]);
        assert_eq!(flat.plus(&Trigonometric::constant(1.0), 1e-9).sign(0.0), Sign::Above);
        let dipped = flat.plus(&Trigonometric::constant(1.0), -1e-9).sign(0.0);
        assert!(matches!(dipped, Sign::Below(..)));
    }

    proptest! {
        #[test]
        fn products_multiply_values(
            a in prop::array::uniform5(-2.0..2.0f64),
            b in prop::array::uniform5(-2.0..2.0f64),
            angle in -4.0..4.0f64,
        ) {
            let (p, q) = (poly(&a), poly(&b));
            let product = value(&p, angle) * value(&q, angle);
            prop_assert!((value(&p.times(&q), angle) - product).abs() < 1e-12);
            let (s, c) = angle.sin_cos();
            prop_assert!((p.taylor(c, s)[0] - value(&p, angle)).abs() < 1e-13);
        }

        #[test]
        fn signs_agree_with_dense_sampling(c in prop::array::uniform9(-1.0..1.0f64), lift in -1.0..1.0f64) {
            let mut p = poly(&c);
            let lowest = (0..20_000)
                .map(|i| value(&p, f64::from(i) * 3.1415926535e-4))
                .fold(f64::INFINITY, f64::min);
            // About half of them close to zero.
            p.constant -= lowest + lift * 1e-3;
            let lowest = -lift * 1e-3;
            match p.sign(0.0) {
                Sign::Above => prop_assert!(lowest > -1e-9),
                Sign::Below(cos, sin) => {
                    let at = value(&p, sin.atan2(cos));
                    prop_assert!(at < 0.0 && lowest < 1e-5);
                    prop_assert!(at <= 0.998 * lowest, "{at} {lowest}");
                }
                Sign::Unclear => prop_assert!(lowest.abs() < 1e-5),
            }
        }
    }
}
