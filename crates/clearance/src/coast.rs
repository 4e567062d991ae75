//! Two bodies that nothing pushes any more: attitudes as power series, and bounds on their rates.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use crate::{
    free_body::FreeBody,
    motion::{Motion, MotionLimits},
    state::RigidState,
};

/// Degree of the power series of a step.
const DEGREE: usize = 18;
/// Longest step: this angle turned, and this share of the series' radius of convergence.
const TURN: f64 = 0.25;
const SHARE: f64 = 0.14;
/// Most steps of a body: what is computed is kept.
const MOST_STEPS: usize = 30_000;

/// Payload and stage when nothing pushes them any more: no forces, no torques.
///
/// # Algorithm
/// Mass centres move uniformly. Each attitude is a power series of degree 18 in steps of at most
/// 0.25 rad of turning, computed as far as it is asked for; the angular momentum in body axes obeys
/// Ḣ = H × I⁻¹H. The error is of the order of rounding, below 1e-12 rad per 100 rad turned.
///
/// Angular speeds are bounded by the invariants, ω ≤ min(H/I_min, √(2E/I_min)), and angular
/// accelerations through Euler's equations, ω̇ ≤ ω² max|I_j − I_k|/(√3 I_i).
///
/// # Limits
/// A ball that turns by more than about 7,000 rad is not followed further, and other bodies not beyond 7,000 rad ×
/// √(I_min/I_max) at the worst: a slender one may then turn about its length as fast as the bounds allow.
#[derive(Clone, Debug)]
pub struct Coast {
    start: f64,
    bodies: [FreeMotion; 2],
    offset: Vector3<f64>,
    velocity: Vector3<f64>,
}

impl Coast {
    /// From the given states at the time `start_s` (s) on. Backwards it is not known.
    #[must_use]
    pub fn new(payload: &FreeBody, stage: &FreeBody, start_s: f64) -> Self {
        Self {
            start: start_s,
            bodies: [FreeMotion::new(payload), FreeMotion::new(stage)],
            offset: payload.state.position - stage.state.position,
            velocity: payload.state.velocity - stage.state.velocity,
        }
    }
}

impl Motion for Coast {
    fn states(&mut self, time_s: f64) -> Option<[RigidState; 2]> {
        let t = time_s - self.start;
        let [payload, stage] = &mut self.bodies;
        Some([payload.at(t)?, stage.at(t)?])
    }

    fn offset(&mut self, time_s: f64) -> Option<Vector3<f64>> {
        let t = time_s - self.start;
        (t >= 0.0).then(|| self.offset + self.velocity * t)
    }

    fn least_offset(&mut self, from_s: f64, to_s: f64) -> Option<f64> {
        let start = self.offset(from_s)?;
        let square = self.velocity.norm_squared();
        // Where a straight line passes nearest; at rest anywhere.
        let nearest = -start.dot(&self.velocity) / square;
        let nearest = if nearest > 0.0 { nearest.min(to_s - from_s) } else { 0.0 };
        // Less the rounding of the positions.
        let scale = start.norm() + self.velocity.norm() * (to_s - self.start);
        Some((start + self.velocity * nearest).norm() - 1e-14 * scale)
    }

    fn known_until_s(&mut self) -> f64 {
        self.bodies.iter().map(|body| self.start + body.ends()).fold(f64::INFINITY, f64::min)
    }

    fn limits(&mut self, _: f64, _: f64) -> MotionLimits {
        let [p, s] = &self.bodies;
        MotionLimits {
            speed: self.velocity.norm(),
            acceleration: 0.0,
            angular_speed: [p.fastest, s.fastest],
            angular_acceleration: [p.hardest, s.hardest],
        }
    }
}

/// One of the bodies, computed as far as it was asked for.
#[derive(Clone, Debug)]
struct FreeMotion {
    state: RigidState,
    inverse: Matrix3<f64>,
    /// Bounds on angular speed and acceleration.
    fastest: f64,
    hardest: f64,
    step: f64,
    series: Vec<Series>,
}

impl FreeMotion {
    fn new(body: &FreeBody) -> Self {
        let state = body.state;
        let momentum = body.inertia * state.angular_velocity;
        let i = body.principal_moments;
        let smallest = i.into_iter().fold(f64::INFINITY, f64::min);
        let energy2 = momentum.dot(&state.angular_velocity).max(0.0);
        // A hair above, for the rounding of the moments.
        let fastest = (momentum.norm() / smallest).min((energy2 / smallest).sqrt()) * (1.0 + 1e-9);
        let skew = ((i[1] - i[2]).abs() / i[0])
            .max((i[2] - i[0]).abs() / i[1])
            .max((i[0] - i[1]).abs() / i[2]);
        let growth = skew / 3.0_f64.sqrt() * (1.0 + 1e-9);
        let by_polhode = hardest_by_polhode(i, momentum.norm_squared(), energy2) * fastest;
        let hardest = (growth * fastest * fastest).min(by_polhode);
        let step = (TURN / fastest).min(SHARE / (growth * fastest)).min(1e9);
        let inverse = body.inverse_inertia;
        Self { state, inverse, fastest, hardest, step, series: Vec::new() }
    }

    /// Until when it is followed, s; the last step is left out for the rounding of times.
    fn ends(&self) -> f64 {
        self.step * (MOST_STEPS - 1) as f64
    }

    fn at(&mut self, t: f64) -> Option<RigidState> {
        let index = (t / self.step).floor();
        // Written so that NaN is refused: of the time, and of a step that is none.
        if !(t >= 0.0 && index < MOST_STEPS as f64) {
            return None;
        }
        let index = index as usize;
        while self.series.len() <= index {
            let (q, h) = match self.series.last() {
                Some(last) => last.at(self.step),
                None => {
                    let inertia = self.inverse.try_inverse()?;
                    (self.state.attitude, inertia * self.state.angular_velocity)
                }
            };
            self.series.push(Series::new(&q, &h, &self.inverse));
        }
        let (attitude, momentum) = self.series[index].at(t - index as f64 * self.step);
        Some(RigidState {
            position: self.state.position + self.state.velocity * t,
            velocity: self.state.velocity,
            attitude,
            angular_velocity: self.inverse * momentum,
        })
    }
}

/// A bound on the angular acceleration over the angular speed, 1/s, of a body with these principal moments, from h² and twice the
/// energy: next to nothing for one that spins about its axis of the largest or the smallest moment.
///
/// Of the axis k of either, h² − 2 T I_k = Σ I_j (I_j − I_k) ω_j², in which all terms have one sign, so that each |ω_j| is bounded,
/// and with it I_i α_i = (I_j − I_k) ω_j ω_k. I_k α_k = (I_i − I_j) ω_i ω_j, and |I_i − I_j| is at most the larger |I_j − I_k|.
fn hardest_by_polhode(moments: [f64; 3], momentum2: f64, energy2: f64) -> f64 {
    let about = |k: usize| {
        let off = momentum2 - energy2 * moments[k];
        // And what rounding may have taken.
        let most = off.abs() + 1e-13 * (momentum2 + energy2 * moments[k]);
        let [i, j] = [(k + 1) % 3, (k + 2) % 3];
        let [by_i, by_j] =
            [i, j].map(|j| (most * (moments[j] - moments[k]).abs() / moments[j]).sqrt());
        let [a, b, c] = [by_j / moments[i], by_i / moments[j], by_i.max(by_j) / moments[k]];
        (a * a + b * b + c * c).sqrt() * (1.0 + 1e-9)
    };
    let is_end = |k: usize| {
        let [a, b] = [1, 2].map(|by| moments[(k + by) % 3]);
        (moments[k] - a) * (moments[k] - b) >= 0.0
    };
    (0..3).filter(|k| is_end(*k)).map(about).fold(f64::INFINITY, f64::min)
}

/// Attitude and angular momentum (body axes) as power series in time.
#[derive(Clone, Debug)]
struct Series {
    attitude: [Quaternion<f64>; DEGREE + 1],
    momentum: [Vector3<f64>; DEGREE + 1],
}

impl Series {
    fn new(
        attitude: &UnitQuaternion<f64>,
        momentum: &Vector3<f64>,
        inverse: &Matrix3<f64>,
    ) -> Self {
        let mut q = [Quaternion::new(0.0, 0.0, 0.0, 0.0); DEGREE + 1];
        let mut h = [Vector3::zeros(); DEGREE + 1];
        let mut w = [Vector3::zeros(); DEGREE + 1];
        (q[0], h[0], w[0]) = (attitude.into_inner(), *momentum, inverse * momentum);
        for k in 0..DEGREE {
            let mut turn = Quaternion::new(0.0, 0.0, 0.0, 0.0);
            let mut torque = Vector3::zeros();
            for j in 0..=k {
                torque += h[j].cross(&w[k - j]);
                turn += q[j] * Quaternion::from_imag(w[k - j]);
            }
            let next = 1.0 / (k + 1) as f64;
            h[k + 1] = torque * next;
            w[k + 1] = inverse * h[k + 1];
            q[k + 1] = turn * (0.5 * next);
        }
        Self { attitude: q, momentum: h }
    }

    fn at(&self, t: f64) -> (UnitQuaternion<f64>, Vector3<f64>) {
        let mut q = self.attitude[DEGREE];
        let mut h = self.momentum[DEGREE];
        for k in (0..DEGREE).rev() {
            q = q * t + self.attitude[k];
            h = h * t + self.momentum[k];
        }
        (UnitQuaternion::new_normalize(q), h)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    type V = Vector3<f64>;

    fn body(moments: [f64; 3], products: [f64; 3], w: [f64; 3]) -> FreeBody {
        let [[a, b, c], [p, q, r]] = [moments, products];
        let state = RigidState {
            angular_velocity: w.into(),
            velocity: Vector3::new(0.1, -0.2, 0.5),
            ..RigidState::default()
        };
        FreeBody::new(state, Matrix3::new(a, p, q, p, b, r, q, r, c)).unwrap()
    }

    /// Axisymmetric: the body precesses about H at H/I_t and turns about its axis besides.
    #[test]
    fn axisymmetric_motion_is_the_closed_form() {
        let (spin, transverse) = (3.0, 2.0);
        let moving = body([transverse, transverse, spin], [0.0; 3], [0.4, 0.0, 2.0]);
        let mut coast = Coast::new(&moving, &moving, 5.0);
        let h = Vector3::new(transverse * 0.4, 0.0, spin * 2.0);
        let relative = 2.0 * (transverse - spin) / transverse;
        for t in [0.0, 0.01, 1.0, 17.3, 60.0] {
            let [state, _] = coast.states(5.0 + t).unwrap();
            let exact = UnitQuaternion::from_scaled_axis(h * (t / transverse))
                * UnitQuaternion::from_scaled_axis(Vector3::z() * (relative * t));
            assert!(state.attitude.angle_to(&exact) < 2e-13 * (1.0 + t), "{t}");
            let w = Vector3::new(0.4 * (relative * t).cos(), -0.4 * (relative * t).sin(), 2.0);
            assert!((state.angular_velocity - w).norm() < 1e-12 * (1.0 + t));
            assert!((state.position - moving.state.velocity * t).norm() < 1e-13);
        }
        assert!(coast.states(4.9).is_none() && coast.offset(4.9).is_none());
        for t in [f64::NAN, f64::INFINITY, 1e9] {
            assert!(coast.states(t).is_none());
        }
    }

    #[test]
    fn a_body_at_rest_stays() {
        let moving = body([1.0, 2.0, 2.5], [0.0; 3], [0.0; 3]);
        let mut coast = Coast::new(&moving, &moving, 0.0);
        let [state, _] = coast.states(1e6).unwrap();
        assert_eq!(state.attitude, UnitQuaternion::identity());
        assert_eq!(coast.limits(0.0, 1.0).angular_speed, [0.0; 2]);
    }

    #[test]
    fn mass_centres_are_never_nearer_than_the_least_offset() {
        for (position, velocity) in [
            (V::new(-5.0, 1.0, 0.0), V::new(1.0, 0.1, 0.2)),
            (V::new(2.0, 1.0, 0.0), V::new(1.0, 0.1, 0.2)),
            (V::new(2.0, 1.0, 0.0), V::zeros()),
            (V::zeros(), V::x()),
        ] {
            let state = RigidState { position, velocity, ..RigidState::default() };
            let moving = FreeBody::new(state, Matrix3::identity()).unwrap();
            let still = FreeBody::new(RigidState::default(), Matrix3::identity()).unwrap();
            let mut coast = Coast::new(&moving, &still, 0.0);
            for (from, to) in [(0.0, 10.0), (0.0, 3.0), (6.0, 9.0), (4.0, 4.0)] {
                let at = |i: u32| from + (to - from) * f64::from(i) / 1000.0;
                let least = coast.least_offset(from, to).unwrap();
                let sampled = (0..=1000)
                    .map(|i| coast.offset(at(i)).unwrap().norm())
                    .fold(f64::INFINITY, f64::min);
                assert!(least <= sampled && least > sampled - 1e-4, "{least} {sampled}");
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]
        /// Momentum in inertial axes and energy stay; steps half as long say the same; limits hold.
        #[test]
        fn triaxial_motion_keeps_its_invariants_and_its_limits(
            moments in prop::array::uniform3(1.0..6.0f64),
            w in prop::array::uniform3(-3.0..3.0f64),
        ) {
            // Not all realizable, which the motion does not ask.
            let moving = body(moments, [0.2, -0.1, 0.15], w);
            let inertia = moving.inertia;
            let mut coast = Coast::new(&moving, &moving, 0.0);
            let mut fine = coast.clone();
            fine.bodies[0].step *= 0.5;
            let limits = coast.limits(0.0, 30.0);
            let h0 = inertia * moving.state.angular_velocity;
            let mut before: Option<(f64, Vector3<f64>)> = None;
            for i in 0..300 {
                let t = 0.1 * f64::from(i);
                let [state, _] = coast.states(t).unwrap();
                let w = state.angular_velocity;
                let h = state.attitude * (inertia * w);
                prop_assert!((h - h0).norm() < 1e-11 * h0.norm());
                let energy = w.dot(&(inertia * w)) / moving.state.angular_velocity.dot(&h0);
                prop_assert!((energy - 1.0).abs() < 1e-11);
                let [other, _] = fine.states(t).unwrap();
                prop_assert!(state.attitude.angle_to(&other.attitude) < 1e-10);
                prop_assert!(w.norm() <= limits.angular_speed[0]);
                if let Some((_, last)) = before {
                    prop_assert!((w - last).norm() <= 0.1 * limits.angular_acceleration[0] + 1e-12);
                }
                before = Some((t, w));
            }
        }
    }
}
