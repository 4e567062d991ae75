//! Arcs of a ring, and how near one comes to a hull.

use nalgebra::Vector3;

use crate::{convex::direction, motion::Frame, outline::Ring};

/// An arc of a ring: angles from middle − half to middle + half.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arc {
    pub(crate) middle: f64,
    pub(crate) half: f64,
}

impl Arc {
    /// The two halves.
    pub(crate) fn halves(&self) -> [Self; 2] {
        let half = 0.5 * self.half;
        [-half, half].map(|by| Self { middle: self.middle + by, half })
    }
}

/// A ring on one body and the hull of points on the other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RingAndHull<'a> {
    pub(crate) ring: &'a Ring,
    /// The body with the ring, 0 the payload.
    pub(crate) ring_body: usize,
    pub(crate) hull: &'a [Vector3<f64>],
}

/// A direction from the hull to the ring, n + n_φ φ + n_τ τ, with φ the angle from the middle of the arc
/// and τ the time from that of the frame. n is a unit vector and the others are at right angles to it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turning {
    pub(crate) normal: Vector3<f64>,
    pub(crate) by_angle: Vector3<f64>,
    pub(crate) by_time: Vector3<f64>,
}

impl RingAndHull<'_> {
    /// The derivative of the middle of an arc by its angle, inertial axes.
    pub(crate) fn tangent(&self, frame: &Frame, arc: &Arc) -> Vector3<f64> {
        let (sin, cos) = libm::sincos(arc.middle);
        frame.rotation[self.ring_body] * (self.ring.across[1] * cos - self.ring.across[0] * sin)
    }

    /// The least of m·(x − y) − `needed` |m| over the arc and the hull at two times from the frame's,
    /// if every point kept its velocity: m the direction, x on the arc, y on the hull. Where it is not
    /// negative, nothing is nearer than `needed` at these times.
    ///
    /// At a time, m·x is a polynomial of φ of degree two and a remainder, largest m·y is convex and
    /// below its chord, and |m| ≤ 1 + ½|n_φ φ + n_τ τ|².
    pub(crate) fn excess(
        &self,
        frame: &Frame,
        arc: &Arc,
        turning: &Turning,
        times: [f64; 2],
        needed: f64,
    ) -> f64 {
        let (i, j) = (self.ring_body, 1 - self.ring_body);
        let sign = if i == 0 { 1.0 } else { -1.0 };
        let (sin, cos) = libm::sincos(arc.middle);
        let (r, w) = (&frame.rotation[i], &frame.rate[i]);
        let [a, b] = self.ring.across;
        let centre = r * self.ring.centre;
        let out = r * (a * cos + b * sin);
        let along = r * (b * cos - a * sin);
        let Turning { normal, by_angle: m, by_time } = turning;
        let h = arc.half;
        let times = if times[0] == times[1] { &times[..1] } else { &times[..] };
        let mut least = f64::INFINITY;
        for &t in times {
            let n = normal + by_time * t;
            let centre = (frame.offset + frame.velocity * t) * sign + centre + w.cross(&centre) * t;
            let out = out + w.cross(&out) * t;
            let along = along + w.cross(&along) * t;
            let [low, high] = {
                let d = [-h, h].map(|angle| direction(frame, j, &(n + m * angle), t));
                let mut most = [f64::NEG_INFINITY; 2];
                for p in self.hull {
                    most = [most[0].max(p.dot(&d[0])), most[1].max(p.dot(&d[1]))];
                }
                most
            };
            let middle = centre + out;
            let (n_out, n_along, m_out, m_along) =
                (n.dot(&out), n.dot(&along), m.dot(&out), m.dot(&along));
            let slope = if h > 0.0 { (high - low) / (2.0 * h) } else { 0.0 };
            let constant = n.dot(&middle)
                - 0.5 * (low + high)
                - needed * (1.0 + 0.5 * by_time.norm_squared() * t * t);
            let linear = n_along + m.dot(&middle) - slope - needed * m.dot(by_time) * t;
            let square = m_along - 0.5 * n_out - 0.5 * needed * m.norm_squared();
            let remainder = h * h * h * (n_along.abs() / 6.0 + 0.5 * m_out.abs())
                + h * h * h * h * (n_out.abs() / 24.0 + m_along.abs() / 6.0);
            let polynomial = if square > 0.0 && linear.abs() < 2.0 * square * h {
                -linear * linear / (4.0 * square)
            } else {
                square * h * h - linear.abs() * h
            };
            let value = constant + polynomial - remainder;
            // Written so that NaN proves nothing.
            least = if value < least {
                value
            } else if value >= least {
                least
            } else {
                f64::NEG_INFINITY
            };
        }
        least
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RigidState;
    use crate::motion::MotionLimits;
    use crate::outline::{Kind, OutlineShape};
    use crate::part::parts;
    use nalgebra::UnitQuaternion;
    use proptest::prelude::*;

    type V = Vector3<f64>;

    fn frame(states: [(V, [f64; 3], V, V); 2]) -> Frame {
        Frame::new(&states.map(|(position, turn, velocity, rate)| RigidState {
            position,
            velocity,
            attitude: UnitQuaternion::from_scaled_axis(turn.into()),
            angular_velocity: rate,
        }))
        .unwrap()
    }

    /// The frame as it is after a time in which every point kept its velocity: no rotation.
    fn later(frame: &Frame, t: f64) -> Frame {
        let sheared = |i: usize| {
            let [x, y, z] = [0, 1, 2].map(|k| {
                let column = frame.rotation[i].column(k).into_owned();
                column + frame.rate[i].cross(&column) * t
            });
            nalgebra::Matrix3::from_columns(&[x, y, z])
        };
        let offset = frame.offset + frame.velocity * t;
        Frame { offset, rotation: [sheared(0), sheared(1)], ..*frame }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]
        /// Whatever the directions, nothing sampled on the arc and between the times is nearer than what
        /// they prove; with those of the nearest points a small cell is proven to the third order.
        #[test]
        fn what_is_proven_holds_and_is_sharp(
            hull in prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), 2..9),
            (centre, axis, radius) in
                (prop::array::uniform3(-0.5..0.5f64), prop::array::uniform3(-1.0..1.0f64), 0.2..1.5f64),
            (offset, velocity) in (prop::array::uniform3(-3.0..3.0f64), prop::array::uniform3(-1.0..1.0f64)),
            turns in prop::array::uniform2(prop::array::uniform3(-3.0..3.0f64)),
            rates in prop::array::uniform2(prop::array::uniform3(-1.0..1.0f64)),
            (middle, half, span) in (-3.0..3.0f64, 0.01..0.8f64, 0.0..0.5f64),
            ring_body in 0..2usize,
        ) {
            prop_assume!(V::from(axis).norm() > 0.1);
            let zero = V::zeros();
            let frame = frame([
                (offset.into(), turns[0], velocity.into(), rates[0].into()),
                (zero, turns[1], zero, rates[1].into()),
            ]);
            let hull: Vec<V> = hull.into_iter().map(V::from).collect();
            let shapes = [OutlineShape::ring(centre.into(), axis.into(), radius).unwrap(), OutlineShape::hull(&hull).unwrap()];
            let Kind::Ring(ring) = shapes[0].kind() else { panic!() };
            let pair = RingAndHull { ring, ring_body, hull: &hull };
            let all = parts(&shapes[ring_body], &shapes[1 - ring_body]);
            let part = &all[0];
            let distance = |frame: &Frame, angle: f64| {
                let arc = Arc { middle: angle, half: 0.0 };
                part.look(frame, &arc, &zero, 0.0, f64::INFINITY, 1e-9)
            };
            let at = |arc: &Arc, times: [f64; 2], count: u32| {
                let mut least = f64::INFINITY;
                for i in 0..=count {
                    let t = times[0] + (times[1] - times[0]) * f64::from(i) / f64::from(count);
                    let frame = later(&frame, t);
                    for k in 0..=count {
                        let share = 2.0 * f64::from(k) / f64::from(count) - 1.0;
                        let angle = arc.middle + arc.half * share;
                        least = least.min(distance(&frame, angle).seen.distance);
                    }
                }
                least
            };
            let look = distance(&frame, middle);
            prop_assume!(look.seen.distance > 0.05);
            // No accelerations: the frame after a time is exact.
            let limits = MotionLimits { speed: 1e3, ..MotionLimits::default() };
            let arc = Arc { middle, half };
            let times = [-span, 0.7 * span];
            let sampled = at(&arc, times, 12);
            for target in [0.3 * sampled, 0.9 * sampled, sampled, sampled + 0.1] {
                if !(target > 0.0) {
                    continue;
                }
                let excess = part.excess(&frame, &limits, &arc, &look, times, target);
                prop_assert!(sampled >= target + excess.min(0.0) - 1e-12, "{sampled} {target} {excess}");
            }
            // Sharp to the third order at an instant, where the nearest feature stays.
            let small = Arc { middle, half: 2e-3 };
            let exact = at(&small, [0.0; 2], 40);
            let ends = [-1.0, 1.0].map(|s| distance(&frame, middle + s * small.half));
            let same = ends.iter().all(|e| (e.by_angle - look.by_angle).norm() < 0.05);
            if same {
                let turning = Turning {
                    normal: look.direction.normalize() * if ring_body == 0 { 1.0 } else { -1.0 },
                    by_angle: look.by_angle,
                    by_time: zero,
                };
                let excess = pair.excess(&frame, &small, &turning, [0.0; 2], exact);
                prop_assert!(excess > -1e-6, "{excess:e}");
            }
        }
    }
}
