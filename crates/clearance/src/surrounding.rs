//! How near a ring comes to a hull that is inside of it, whatever the arc.

use nalgebra::Vector3;

use crate::{
    arc::RingAndHull,
    motion::{Frame, MotionLimits},
};

impl RingAndHull<'_> {
    /// No point of the hull is nearer to the ring than this at the time of the frame, and as long as `span` before and after; nothing
    /// where the hull may reach out of the cylinder on the ring.
    ///
    /// Along the radius on which a point of the ring lies, the hull reaches no farther than its farthest corner is from the axis of the
    /// ring, ρ. What of it turns about the axis only does not change ρ: c, the foot of a corner on the axis, is taken along by the
    /// body with the hull, so that ρ grows by no more than c leaves the axis, |(c − C) × a|, with C the centre of the ring and a its
    /// axis. So this is as sharp for bodies that spin about the axis as for others, where arcs would have to follow each corner.
    pub(crate) fn surrounded(&self, frame: &Frame, limits: &MotionLimits, span: f64) -> f64 {
        let (i, j) = (self.ring_body, 1 - self.ring_body);
        let sign = if i == 0 { 1.0 } else { -1.0 };
        let (r, w) = (&frame.rotation, &frame.rate);
        let (axis, arm) = (r[i] * self.ring.axis, r[i] * self.ring.centre);
        // From the mass centre of the body with the hull.
        let centre = frame.offset * sign + arm;
        let velocity = frame.velocity * sign + w[i].cross(&arm);
        // |ω × v| of what a body takes along grows by no more than |α||v| and |ω| times itself.
        let speed = |body: usize, of: &Vector3<f64>| {
            let gained = limits.angular_acceleration[body] * of.norm() * span;
            (w[body].cross(of).norm() + gained) * libm::exp(limits.angular_speed[body] * span)
        };
        let second = |body: usize, of: &Vector3<f64>| {
            limits.angular_acceleration[body] * of.norm()
                + limits.angular_speed[body] * speed(body, of)
        };
        let (tilting, of_axis, of_arm) = (speed(i, &axis), second(i, &axis), second(i, &arm));
        let mut least = self.ring.radius;
        for corner in self.hull {
            let from_centre = r[j] * corner - centre;
            let height = from_centre.dot(&axis);
            let foot = centre + axis * height;
            let moving = w[j].cross(&foot) - velocity;
            let leaving = moving.cross(&axis) + axis.cross(&w[i].cross(&axis)) * height;
            let apart = limits.acceleration + second(j, &foot) + of_arm;
            let parting = moving.norm() + apart * span;
            let bend = apart + 2.0 * parting * tilting + (height.abs() + parting * span) * of_axis;
            let from_axis = (from_centre - axis * height).norm();
            let inside = self.ring.radius - from_axis - (leaving.norm() + 0.5 * bend * span) * span;
            // Written so that NaN proves nothing.
            if !(inside > 0.0) {
                return f64::NEG_INFINITY;
            }
            least = least.min(inside);
        }
        least
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        arc::Arc,
        outline::{Kind, OutlineShape},
        part::parts,
        state::RigidState,
    };
    use nalgebra::UnitQuaternion;
    use proptest::prelude::*;

    type V = Vector3<f64>;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]
        /// Whatever the motion with steady rates, nothing sampled is nearer than what is proven, which is all of the distance for bodies
        /// that do not more than spin about the axis and move along it; some of it is proven in most cases.
        #[test]
        fn what_is_proven_holds(
            hull in prop::collection::vec(prop::array::uniform3(-0.5..0.5f64), 2..9),
            (centre, axis, outside) in
                (prop::array::uniform3(-0.5..0.5f64), prop::array::uniform3(-1.0..1.0f64), 0.01..0.5f64),
            (offset, velocity) in (prop::array::uniform3(-0.2..0.2f64), prop::array::uniform3(-0.3..0.3f64)),
            turn in prop::array::uniform3(-3.0..3.0f64),
            rates in prop::array::uniform2(prop::array::uniform3(-1.0..1.0f64)),
            (span, size) in (0.0..0.5f64, prop::sample::select(vec![0.0, 1e-3, 1.0])),
            (ring_body, along, spins) in (0..2usize, -1.0..1.0f64, prop::array::uniform2(-5.0..5.0f64)),
        ) {
            prop_assume!(V::from(axis).norm() > 0.1);
            let hull: Vec<V> = hull.into_iter().map(V::from).collect();
            let axis = V::from(axis).normalize();
            // In the axes of the ring's body, which are inertial at first. Its centre and the mass centre of the hull's body lie on the
            // axis but for what has this size.
            let centre = axis * along + V::from(centre) * size;
            let place = axis * offset[0] + V::from(offset) * size;
            let turn = UnitQuaternion::from_scaled_axis(turn.into());
            let velocity = axis * along + V::from(velocity) * size;
            let [of_ring, of_hull] = [0, 1].map(|i| axis * spins[i] + V::from(rates[i]) * size);
            let in_body = turn.inverse() * of_hull;
            let state = |t: f64| {
                let ring = RigidState {
                    attitude: UnitQuaternion::from_scaled_axis(of_ring * t),
                    angular_velocity: of_ring,
                    ..RigidState::default()
                };
                let hull = RigidState {
                    position: place + velocity * t,
                    velocity,
                    attitude: UnitQuaternion::from_scaled_axis(of_hull * t) * turn,
                    angular_velocity: in_body,
                };
                Frame::new(&if ring_body == 0 { [ring, hull] } else { [hull, ring] }).unwrap()
            };
            let from_axis = |p: &V| (place + turn * p - centre).cross(&axis).norm();
            let farthest = hull.iter().map(from_axis).fold(0.0, f64::max);
            let radius = farthest + outside;
            let shapes = [OutlineShape::ring(centre, axis, radius).unwrap(), OutlineShape::hull(&hull).unwrap()];
            let Kind::Ring(ring) = shapes[0].kind() else { panic!() };
            let pair = RingAndHull { ring, ring_body, hull: &hull };
            let [p, s] = [&shapes[ring_body], &shapes[1 - ring_body]];
            let all = parts(p, s);
            let speeds = [of_ring.norm(), of_hull.norm()];
            let angular_speed = if ring_body == 0 { speeds } else { [speeds[1], speeds[0]] };
            let limits = MotionLimits { speed: velocity.norm(), angular_speed, ..MotionLimits::default() };
            let proven = pair.surrounded(&state(0.0), &limits, span);
            for i in -6..=6 {
                let frame = state(span * f64::from(i) / 6.0);
                for k in 0..48 {
                    let arc = Arc { middle: std::f64::consts::TAU * f64::from(k) / 48.0, half: 0.0 };
                    let look = all[0].look(&frame, &arc, &V::zeros(), 0.0, f64::INFINITY, 1e-9);
                    prop_assert!(look.seen.distance > proven - 1e-12, "{} {proven}", look.seen.distance);
                }
            }
            if size == 0.0 {
                prop_assert!((proven - outside).abs() < 1e-12, "{proven} {outside}");
            }
            if size == 1e-3 {
                // The axis is left at about these speeds, and the rest is of the second order.
                let lost = (0.02 + 0.4 * span) * span;
                prop_assert!(proven > outside - lost || outside < lost, "{proven} {outside} {lost}");
            }
        }
    }
}
