//! A law on a circle: its extrema, and the trapezoidal rule about its maxima.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Points of a circle whose density is below e⁻³⁸ of the largest there are left out.
const WINDOW: f64 = 38.0;
/// What two rules on a circle may differ by, the finer one having twice the points: it then is
/// right to about the square of that.
const CIRCLE_TOLERANCE: f64 = 1e-10;
const MAX_CIRCLE_POINTS: usize = 1 << 20;
/// A point of a circle; the density is relative to the largest on the circle.
#[derive(Clone, Copy)]
pub(super) struct Point {
    pub(super) cos: f64,
    pub(super) sin: f64,
    pub(super) density: f64,
}

/// exp(−½ λ₀(r cos α − c₀)² − ½ λ₁(r sin α − c₁)²) with λ₀ ≥ λ₁, on circles of any radius.
#[derive(Clone, Debug)]
pub(super) struct Circle {
    pub(super) lambda: [f64; 2],
    pub(super) centre: [f64; 2],
    /// |c| − 1 of all four, by which c is shortened.
    pub(super) excess: f64,
}

/// The maxima and minima on a circle in the angle at which both c are positive; the higher maximum
/// lies in the first quadrant.
pub(super) struct Maxima {
    pub(super) top: f64,
    first: f64,
    /// A minimum in the third quadrant, as an angle in [−π, −π/2].
    far_minimum: f64,
    /// A second maximum in the fourth quadrant, and the minimum between the two.
    second: Option<[f64; 2]>,
}

impl Circle {
    pub(super) fn distance(&self) -> f64 {
        libm::hypot(self.centre[0], self.centre[1])
    }

    /// The smaller deviation.
    pub(super) fn width(&self) -> f64 {
        1.0 / self.lambda[0].sqrt()
    }

    pub(super) fn exponent(&self, r: f64, sin: f64, cos: f64) -> f64 {
        let [a, b] = self.centre.map(f64::abs);
        // In this order: c·(1 − excess) would round to c.
        let u = (r * cos - a) + a * self.excess;
        let v = (r * sin - b) + b * self.excess;
        -0.5 * (self.lambda[0] * u * u + self.lambda[1] * v * v)
    }

    pub(super) fn exponent_at(&self, r: f64, angle: f64) -> f64 {
        let (sin, cos) = libm::sincos(angle);
        self.exponent(r, sin, cos)
    }

    /// The exponent on the circle is nowhere larger.
    pub(super) fn bound(&self, r: f64) -> f64 {
        let gap = |j: usize| (self.centre[j].abs() - r).max(0.0);
        let off = r - self.distance();
        let ridges = self.lambda[0] * gap(0) * gap(0) + self.lambda[1] * gap(1) * gap(1);
        -0.5 * ridges.max(self.lambda[1] * off * off)
    }

    /// The derivative of the exponent is r·(D sin α cos α − B₀ sin α + B₁ cos α), D = (λ₀ − λ₁)r ≥ 0,
    /// B = λ|c|. Divided by sin α cos α it is monotone in the first and the third quadrant, with
    /// one zero each, of one sign in the second, and in the fourth has one extremum, at tan³α =
    /// −B₁/B₀: two zeros if the centre lies inside the ellipse's evolute.
    pub(super) fn maxima(&self, r: f64) -> Maxima {
        let d = (self.lambda[0] - self.lambda[1]) * r;
        let b = [self.lambda[0] * self.centre[0].abs(), self.lambda[1] * self.centre[1].abs()];
        // Each in its own angle from the start of the quadrant's axis, with the signs of the terms.
        let zero = |signs: [f64; 3], low: f64, high: f64| {
            sign_change(r, [signs[0] * d, signs[1] * b[0], signs[2] * b[1]], low, high)
        };
        let first = zero([1.0, -1.0, 1.0], 0.0, FRAC_PI_2);
        let far_minimum = zero([-1.0, -1.0, 1.0], 0.0, FRAC_PI_2) - PI;
        let roots = b.map(libm::cbrt);
        let evolute = roots[0] * roots[0] + roots[1] * roots[1];
        let second = (d > evolute * evolute.sqrt()).then(|| {
            let turn = libm::atan2(roots[1], roots[0]);
            let minimum = zero([-1.0, 1.0, 1.0], 0.0, turn);
            let maximum = zero([1.0, -1.0, -1.0], turn, FRAC_PI_2);
            [-maximum, -minimum]
        });
        Maxima { top: self.exponent_at(r, first), first, far_minimum, second }
    }

    /// Fills in the points of the rule and returns its step.
    pub(super) fn fill(&self, r: f64, peaks: &Maxima, points: &mut Vec<Point>) -> f64 {
        points.clear();
        let floor = peaks.top - WINDOW;
        let above = |angle: f64| self.exponent_at(r, angle) > floor;
        let first = peaks.first;
        let far = [peaks.far_minimum, peaks.far_minimum + TAU];
        let far_above = above(far[0]);
        let edge = |from: f64, to: f64| self.edge(r, floor, from, to);
        let mut windows = [None, None];
        match peaks.second.filter(|&[second, _]| above(second)) {
            _ if far_above && peaks.second.is_none_or(|[_, near]| above(near)) => {
                windows[0] = Some([first - PI, first + PI]);
            }
            None => windows[0] = Some([edge(first, peaks.near_or(far[0])), edge(first, far[1])]),
            Some([second, near]) if above(near) => {
                windows[0] = Some([edge(second, far[0]), edge(first, far[1])]);
            }
            Some([second, near]) if far_above => {
                windows[0] = Some([edge(first, near), edge(second + TAU, near + TAU)]);
            }
            Some([second, near]) => {
                windows[0] = Some([edge(first, near), edge(first, far[1])]);
                windows[1] = Some([edge(second, far[0]), edge(second, near)]);
            }
        }
        // Both windows share the step, which the longer one sets.
        let length = windows.iter().flatten().fold(0.0_f64, |l, w| l.max(w[1] - w[0]));
        let start = if length > 6.0 { 32.0 } else { 16.0 };
        let mut step = length / start;
        for window in windows.into_iter().flatten() {
            let count = libm::ceil((window[1] - window[0]) / step) as usize;
            // The end of a whole circle is its beginning.
            for i in 0..count {
                points.push(self.point(r, peaks.top, window[0] + i as f64 * step));
            }
        }
        // Rounding keeps rules on very narrow peaks further apart than the tolerance.
        let tolerance = CIRCLE_TOLERANCE.max(32.0 * f64::EPSILON / self.width());
        let sum = |points: &[Point]| points.iter().map(|p| p.density).sum::<f64>();
        let mut coarse = sum(points);
        while points.len() < MAX_CIRCLE_POINTS {
            step *= 0.5;
            let old = points.len();
            for window in windows.into_iter().flatten() {
                let count = libm::ceil((window[1] - window[0]) / (2.0 * step)) as usize;
                for i in 0..count {
                    let angle = window[0] + (2.0 * i as f64 + 1.0) * step;
                    points.push(self.point(r, peaks.top, angle));
                }
            }
            // Twice the points have twice the sum.
            let added = sum(&points[old..]);
            let settled = (added - coarse).abs() <= 2.0 * tolerance * coarse;
            coarse += added;
            if settled {
                break;
            }
        }
        step
    }

    fn point(&self, r: f64, top: f64, angle: f64) -> Point {
        let (sin, cos) = libm::sincos(angle);
        let density = libm::exp(self.exponent(r, sin, cos) - top);
        // Back to the quadrant of the true centre.
        let mirrored = |value: f64, c: f64| if c < 0.0 { -value } else { value };
        Point { cos: mirrored(cos, self.centre[0]), sin: mirrored(sin, self.centre[1]), density }
    }

    /// Where the exponent, which falls between a maximum and a minimum, passes the floor.
    fn edge(&self, r: f64, floor: f64, maximum: f64, minimum: f64) -> f64 {
        let below = |x: f64| self.exponent_at(r, maximum + x * (minimum - maximum)) < floor;
        let (mut low, mut high) = (0.0, 1.0);
        // A window half as long again as it need be does no harm.
        while high > 1e-9 && !(low > 0.0 && high < 1.25 * low) {
            let middle = if low > 0.0 { 0.5 * (low + high) } else { 0.25 * high };
            if below(middle) { high = middle } else { low = middle }
        }
        maximum + high * (minimum - maximum)
    }
}

impl Maxima {
    /// The minimum next to the first maximum on the side of the fourth quadrant.
    fn near_or(&self, far: f64) -> f64 {
        self.second.map_or(far, |[_, near]| near)
    }
}

/// The angle in [low, high] at which t₀ sin α cos α + t₁ sin α + t₂ cos α goes from above zero to
/// below, by Newton steps in a bracket, to a small part of the width of an extremum there.
fn sign_change(r: f64, t: [f64; 3], mut low: f64, mut high: f64) -> f64 {
    let mut angle = 0.5 * (low + high);
    for turn in 0..80 {
        let (sin, cos) = libm::sincos(angle);
        let value = (t[0] * cos + t[1]) * sin + t[2] * cos;
        let slope = t[0] * (cos * cos - sin * sin) + t[1] * cos - t[2] * sin;
        if value > 0.0 {
            low = angle
        } else {
            high = angle
        }
        let step = -value / slope;
        if step * step * r * slope.abs() < 1e-6 && step.abs() < 0.1 {
            return (angle + step).clamp(low, high);
        }
        let newton = angle + step;
        let middle = 0.5 * (low + high);
        let inside = newton > low && newton < high;
        angle = if inside && turn % 3 != 2 { newton } else { middle };
    }
    angle
}
