//! Distance of a ring from a ring or a point.
//!
//! In the frame of the second ring (radius R, axis n) a point x = x(θ) of the first is at distance
//! D from it with
//!
//! > D² ≥ c  ⇔  |x|² + R² − c ≥ 2Rρ  ⇐  P = (|x|² + R² − c)² − 4R²(|x|² − (n·x)²) > 0
//!
//! ρ the distance from the axis, provided that |x|² + R² > c somewhere. P is a trigonometric
//! polynomial in θ of two harmonics, whose sign can be told for all θ at once; with every point
//! keeping its velocity over a span of time, of four harmonics and of degree four in time, where the
//! coefficients in Bernstein's basis have to be positive. No case is special: coaxial rings, where all
//! θ are equally near, are told as quickly as others.

use nalgebra::Vector3;

use crate::{
    motion::{Frame, MotionLimits},
    outline::Ring,
    trigonometric::{Sign, Trigonometric},
};

/// c + u cos θ + w sin θ, body axes: a ring, or a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Curve {
    centre: Vector3<f64>,
    across: [Vector3<f64>; 2],
    /// Largest distance from the mass centre.
    radius: f64,
}

impl Curve {
    pub(crate) fn ring(ring: &Ring) -> Self {
        let radius = ring.centre.norm() + ring.radius;
        Self { centre: ring.centre, across: ring.across, radius }
    }

    pub(crate) fn point(point: &Vector3<f64>) -> Self {
        Self { centre: *point, across: [Vector3::zeros(); 2], radius: point.norm() }
    }

    fn at(&self, cos: f64, sin: f64) -> Vector3<f64> {
        self.centre + self.across[0] * cos + self.across[1] * sin
    }
}

/// A curve on one body and a ring on the other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CurveAndRing {
    pub(crate) curve: Curve,
    pub(crate) ring: Ring,
    /// The body with the ring, 0 the payload.
    pub(crate) ring_body: usize,
}

/// Points of a curve in the frame of the ring: c + u cos θ + w sin θ each, and their velocities.
type Triple = [Vector3<f64>; 3];

/// Longest step of a descent, rad.
const WIDEST: f64 = 0.5;

/// Share of the size of a polynomial that rounding may take.
const ROUNDING: f64 = 4e-15;
/// What comes of it in the square of a distance, as a share of the square of the ring's radius.
const SQUARE_ROUNDING: f64 = 4e-14;

impl CurveAndRing {
    /// By how much rounding of the polynomials may change a distance: they give its square, to
    /// within some 1e-14 of the squares of the sizes.
    pub(crate) fn rounding(&self, distance: f64) -> f64 {
        let square = SQUARE_ROUNDING * self.ring.radius * self.ring.radius;
        let left = distance * distance - square;
        // d − √(d² − e), without cancellation.
        if left > 0.0 { square / (distance + left.sqrt()) } else { distance }
    }

    /// Up to which distance rounding may be all of it, m.
    pub(crate) fn untold(&self) -> f64 {
        SQUARE_ROUNDING.sqrt() * self.ring.radius
    }

    fn curve_body(&self) -> usize {
        1 - self.ring_body
    }

    /// Positions from the ring's centre and velocities as the ring's body sees them, in inertial axes.
    fn relative(&self, frame: &Frame) -> (Triple, Triple) {
        let (i, j) = (self.curve_body(), self.ring_body);
        let sign = if i == 0 { 1.0 } else { -1.0 };
        let (r, w) = (&frame.rotation[i], &frame.rate[i]);
        let arm = r * self.curve.centre;
        let from_mass_centre = frame.offset * sign + arm;
        let across = self.curve.across.map(|a| r * a);
        let seen = |x: &Vector3<f64>, v: Vector3<f64>| v - frame.rate[j].cross(x);
        let moving = seen(&from_mass_centre, frame.velocity * sign + w.cross(&arm));
        let centre = from_mass_centre - frame.rotation[j] * self.ring.centre;
        (
            [centre, across[0], across[1]],
            [moving, seen(&across[0], w.cross(&across[0])), seen(&across[1], w.cross(&across[1]))],
        )
    }

    /// Whether no point of the curve comes nearer to the ring than `target` from `times[0]` to
    /// `times[1]` about the time of the frame.
    pub(crate) fn stays_beyond(
        &self,
        frame: &Frame,
        limits: &MotionLimits,
        times: [f64; 2],
        target: f64,
    ) -> bool {
        let span = times[0].abs().max(times[1].abs());
        // How far points stray from uniform motion, in the frame that turns with the ring: besides
        // their own acceleration there are Coriolis', Euler's and the centrifugal.
        let (i, j) = (self.curve_body(), self.ring_body);
        let reach = frame.offset.norm() + limits.speed * span + self.curve.radius;
        let own = limits.acceleration + limits.turning(i) * self.curve.radius;
        let speed = limits.speed
            + limits.angular_speed[i] * self.curve.radius
            + limits.angular_speed[j] * reach;
        let bend = own + 2.0 * limits.angular_speed[j] * speed + limits.turning(j) * reach;
        let needed = target + 0.5 * bend * span * span;
        let c = needed * needed;

        let (position, velocity) = self.relative(frame);
        let width = times[1] - times[0];
        let start: Triple = std::array::from_fn(|k| position[k] + velocity[k] * times[0]);
        let step: Triple = std::array::from_fn(|k| velocity[k] * width);
        let normal = frame.rotation[j] * self.ring.axis;
        let rr = self.ring.radius * self.ring.radius;
        let square = [inner(&start, &start), inner(&start, &step), inner(&step, &step)];
        // In powers of time: |x|² + R² − c and ρ².
        let a = [
            square[0].plus(&Trigonometric::constant(1.0), rr - c),
            square[1].plus(&square[1], 1.0),
            square[2],
        ];
        if !(a[0].constant > 0.0) {
            return false;
        }
        let (start, step) = (aside(&normal, &start), aside(&normal, &step));
        let across = inner(&start, &step);
        let radial = [inner(&start, &start), across.plus(&across, 1.0), inner(&step, &step)];
        let above = |p: &Trigonometric, size: f64| p.is_above(ROUNDING * size);
        // 2Rρ ≤ R(ρ²/m + m) for any m: the plain polynomial, with m the mean of ρ, has the digits that
        // the squared one lacks, and serves where ρ hardly varies.
        let mean = radial[0].constant + 0.5 * radial[1].constant + radial[2].constant / 3.0;
        if mean >= 0.0 {
            // On the axis any small m will do.
            let m = mean.sqrt().max(1e-12 * self.ring.radius);
            let [f0, f1, f2] = [0, 1, 2].map(|k| a[k].plus(&radial[k], -self.ring.radius / m));
            let f0 = f0.plus(&Trigonometric::constant(1.0), -self.ring.radius * m);
            let size = rr + square.iter().map(Trigonometric::size).sum::<f64>();
            let f = [f0, f0.plus(&f1, 0.5), f0.plus(&f1, 1.0).plus(&f2, 1.0)];
            if f.iter().all(|f| above(f, size)) {
                return true;
            }
        }
        let p0 = a[0].times(&a[0]).plus(&radial[0], -4.0 * rr);
        // Size before cancellation.
        let size = a[0].size() * a[0].size() + 4.0 * rr * radial[0].size();
        if !above(&p0, size) {
            return false;
        }
        if width == 0.0 {
            return true;
        }
        let p1 = a[0].times(&a[1]);
        let p1 = p1.plus(&p1, 1.0).plus(&radial[1], -4.0 * rr);
        let p2 = a[0].times(&a[2]);
        let p2 = p2.plus(&p2, 1.0).plus(&a[1].times(&a[1]), 1.0).plus(&radial[2], -4.0 * rr);
        let p3 = a[1].times(&a[2]);
        let p3 = p3.plus(&p3, 1.0);
        let p4 = a[2].times(&a[2]);
        let size = size + p1.size() + p2.size() + p3.size() + p4.size();
        let b1 = p0.plus(&p1, 0.25);
        let b2 = p0.plus(&p1, 0.5).plus(&p2, 1.0 / 6.0);
        let b3 = p0.plus(&p1, 0.75).plus(&p2, 0.5).plus(&p3, 0.25);
        let b4 = p0.plus(&p1, 1.0).plus(&p2, 1.0).plus(&p3, 1.0).plus(&p4, 1.0);
        [b4, b2, b1, b3].iter().all(|b| above(b, size))
    }

    /// A pair of points (payload, stage; body axes) nearer than `than`, the nearest at this instant to
    /// within `tolerance`, if any is nearer.
    ///
    /// An angle where P is negative for c = D² is a nearer point, from which D descends further.
    pub(crate) fn nearer(
        &self,
        frame: &Frame,
        than: f64,
        tolerance: f64,
    ) -> Option<(f64, [Vector3<f64>; 2])> {
        let (position, _) = self.relative(frame);
        let normal = frame.rotation[self.ring_body] * self.ring.axis;
        let radius = self.ring.radius;
        let square = inner(&position, &position);
        let beside = aside(&normal, &position);
        let radial = inner(&beside, &beside);
        let distance = |cos: f64, sin: f64| {
            let x = position[0] + position[1] * cos + position[2] * sin;
            let z = normal.dot(&x);
            let aside = (x - normal * z).norm() - radius;
            (z * z + aside * aside).sqrt()
        };
        // Newton's iteration on D² = |x|² + R² − 2Rρ, as long as it descends.
        let descend = |mut at: (f64, f64, f64)| {
            for _ in 0..12 {
                let [_, s1, s2] = square.taylor(at.1, at.2);
                let [r, r1, r2] = radial.taylor(at.1, at.2);
                let rho = r.max(0.0).sqrt();
                let first = s1 - radius * r1 / rho;
                let second = s2 - radius * (r2 - 0.5 * r1 * r1 / r) / rho;
                let step = if second > 0.0 { -first / second } else { -first.signum() * WIDEST };
                let (sin, cos) = libm::sincos(step.clamp(-WIDEST, WIDEST));
                let (cos, sin) = (at.1 * cos - at.2 * sin, at.2 * cos + at.1 * sin);
                let d = distance(cos, sin);
                if !(d < at.0) {
                    break;
                }
                at = (d, cos, sin);
            }
            at
        };
        let corners = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)];
        let start = corners
            .map(|(c, s)| (distance(c, s), c, s))
            .into_iter()
            .fold((f64::INFINITY, 1.0, 0.0), |a, b| if b.0 < a.0 { b } else { a });
        let start = descend(start);
        let mut best = (start.0 < than).then_some(start);
        // Each round ends in another local minimum, of which there are no more than four.
        for _ in 0..60 {
            let d = best.map_or(than, |b| b.0);
            if !(d > tolerance) {
                break;
            }
            let aim = d - tolerance;
            let a = square.plus(&Trigonometric::constant(1.0), radius * radius - aim * aim);
            let p = a.times(&a).plus(&radial, -4.0 * radius * radius);
            let size = a.size() * a.size() + 4.0 * radius * radius * radial.size();
            let Sign::Below(cos, sin) = p.sign(-ROUNDING * size) else {
                break;
            };
            let found = descend((distance(cos, sin), cos, sin));
            if !(found.0 < d) {
                break;
            }
            best = Some(found);
        }
        let (d, cos, sin) = best?;
        let on_curve = self.curve.at(cos, sin);
        let x = position[0] + position[1] * cos + position[2] * sin;
        let x = frame.rotation[self.ring_body].tr_mul(&x);
        let aside = x - self.ring.axis * self.ring.axis.dot(&x);
        let aside = aside.try_normalize(0.0).map_or(self.ring.across[0], |a| a * radius);
        let on_ring = self.ring.centre + aside;
        let points = if self.ring_body == 1 { [on_curve, on_ring] } else { [on_ring, on_curve] };
        Some((d, points))
    }
}

/// x(θ)·y(θ).
fn inner(x: &Triple, y: &Triple) -> Trigonometric {
    let (uu, ww) = (x[1].dot(&y[1]), x[2].dot(&y[2]));
    let mut p = Trigonometric::constant(x[0].dot(&y[0]) + 0.5 * (uu + ww));
    p.cos[0] = x[0].dot(&y[1]) + x[1].dot(&y[0]);
    p.sin[0] = x[0].dot(&y[2]) + x[2].dot(&y[0]);
    p.cos[1] = 0.5 * (uu - ww);
    p.sin[1] = 0.5 * (x[1].dot(&y[2]) + x[2].dot(&y[1]));
    p
}

/// What of x(θ) is at right angles to the normal.
fn aside(normal: &Vector3<f64>, x: &Triple) -> Triple {
    x.map(|x| x - normal * normal.dot(&x))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RigidState;
    use crate::outline::{Kind, OutlineShape};
    use nalgebra::UnitQuaternion;
    use proptest::prelude::*;

    fn ring(centre: [f64; 3], axis: [f64; 3], radius: f64) -> Ring {
        match OutlineShape::ring(centre.into(), axis.into(), radius).unwrap().kind() {
            Kind::Ring(ring) => *ring,
            _ => unreachable!(),
        }
    }

    fn frame(offset: [f64; 3], turn: [f64; 3]) -> Frame {
        let state = |position: Vector3<f64>, turn: Vector3<f64>| RigidState {
            position,
            attitude: UnitQuaternion::from_scaled_axis(turn),
            ..RigidState::default()
        };
        let stage = state(Vector3::zeros(), Vector3::zeros());
        Frame::new(&[state(offset.into(), turn.into()), stage]).unwrap()
    }

    fn distance(pair: &CurveAndRing, frame: &Frame) -> f64 {
        let (d, [p, q]) = pair.nearer(frame, f64::INFINITY, 1e-13).unwrap();
        let gap = frame.offset + frame.rotation[0] * p - frame.rotation[1] * q;
        assert!((gap.norm() - d).abs() < 1e-13, "{d} {gap}");
        d
    }

    #[test]
    fn rings_in_closed_form() {
        let (o, z) = ([0.0; 3], [0.0, 0.0, 1.0]);
        let pair =
            |a: Ring, b: Ring| CurveAndRing { curve: Curve::ring(&a), ring: b, ring_body: 1 };
        let unit = ring(o, z, 1.0);
        let at = |p: &CurveAndRing, x: [f64; 3], turn: [f64; 3]| distance(p, &frame(x, turn));
        let coaxial = pair(ring(o, z, 0.7), unit);
        assert!((at(&coaxial, [0.0, 0.0, 0.4], [0.0; 3]) - 0.5).abs() < 1e-12);
        assert!((at(&coaxial, [0.0, 0.1, 0.0], [0.0; 3]) - 0.2).abs() < 1e-12);
        assert!((at(&coaxial, [2.0, 0.0, 0.0], [0.0; 3]) - 0.3).abs() < 1e-12);
        // Linked at right angles, and through the centre.
        let same = pair(unit, unit);
        let quarter = [std::f64::consts::FRAC_PI_2, 0.0, 0.0];
        assert!((at(&same, [1.0, 0.0, 0.0], quarter) - 1.0).abs() < 1e-12);
        assert!(at(&same, [0.0; 3], quarter) < 1e-7);
        assert!(at(&same, [0.0; 3], [0.0; 3]) < 1e-7);
        // A point on the axis is as far from all of the ring.
        let point =
            |p: [f64; 3]| CurveAndRing { curve: Curve::point(&p.into()), ring: unit, ring_body: 1 };
        assert!((at(&point([0.0, 0.0, 0.75]), [0.0; 3], [0.0; 3]) - 1.25).abs() < 1e-12);
        assert!((at(&point([3.0, 4.0, 0.0]), [0.0; 3], [0.0; 3]) - 4.0).abs() < 1e-12);
        // Nothing nearer than what is known.
        assert!(coaxial.nearer(&frame([0.0, 0.0, 0.4], [0.0; 3]), 0.4999, 1e-12).is_none());
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]
        #[test]
        fn ring_distances_agree_with_sampling(
            c in prop::array::uniform3(-2.0..2.0f64),
            axes in prop::array::uniform2(prop::array::uniform3(-1.0..1.0f64)),
            radii in prop::array::uniform2(0.05..2.0f64),
            turn in prop::array::uniform3(-3.0..3.0f64),
            ring_body in 0..2usize,
        ) {
            prop_assume!(axes.iter().all(|a| Vector3::from(*a).norm() > 1e-2));
            let frame = frame(c, turn);
            let rings = [ring([0.1, 0.2, -0.3], axes[0], radii[0]), ring([0.0, 0.3, 0.3], axes[1], radii[1])];
            let pair = CurveAndRing {
                curve: Curve::ring(&rings[1 - ring_body]),
                ring: rings[ring_body],
                ring_body,
            };
            let found = distance(&pair, &frame);
            // Distance to the other circle in closed form along one, 20,000 points, then a parabola.
            let (i, j) = (1 - ring_body, ring_body);
            let sign = if i == 0 { 1.0 } else { -1.0 };
            let sampled = |k: i32| {
                let (s, c) = (f64::from(k) * std::f64::consts::TAU / 20_000.0).sin_cos();
                let x = frame.offset * sign + frame.rotation[i] * rings[i].point(c, s);
                let x = frame.rotation[j].tr_mul(&x) - rings[j].centre;
                let z = x.dot(&rings[j].axis);
                let aside = (x - rings[j].axis * z).norm() - rings[j].radius;
                aside.hypot(z)
            };
            let least = (0..20_000).map(sampled).fold(f64::INFINITY, f64::min);
            prop_assert!(found <= least + 1e-9, "{found} {least}");
            prop_assert!(found > least - 3.2e-4 * radii[i], "{found} {least}");
            // The proof at an instant says the same to within its rounding.
            let limits = MotionLimits::default();
            if found > 1e-3 {
                prop_assert!(pair.stays_beyond(&frame, &limits, [0.0; 2], found - 1e-9));
            }
            prop_assert!(!pair.stays_beyond(&frame, &limits, [0.0; 2], found + 1e-9));
        }
    }
}
