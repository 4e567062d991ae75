//! How fast two bodies move over a step of the integration, at most.

use crate::{
    Step,
    layout::{OFFSET, PAYLOAD_RATE, STAGE_RATE, TERMS, VELOCITY},
    state::{State, vector},
};

/// Upper bounds of how fast the bodies move over a step, for those who must prove something of all times in it.
///
/// They are the sums of the sizes of all terms of the step's series, |Σ cₖ tᵏ| ≤ Σ |cₖ| Tᵏ, and hold at every time
/// of the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepLimits {
    /// Distance of the mass centres, m.
    pub offset_m: f64,
    /// Speed of the payload's mass centre from the stage's, m/s.
    pub speed_m_per_s: f64,
    /// Acceleration of the payload's mass centre from the stage's, m/s².
    pub acceleration_m_per_s2: f64,
    /// Angular speeds of payload and stage, rad/s.
    pub angular_speed_rad_per_s: [f64; 2],
    /// Angular accelerations of payload and stage, rad/s².
    pub angular_acceleration_rad_per_s2: [f64; 2],
}

impl Step {
    /// How fast the bodies move over the step, at most.
    #[must_use]
    pub fn limits(&self) -> StepLimits {
        let (series, duration) = (self.series(), self.end_s() - self.start_s());
        // A hair above, for the rounding of the sums.
        let most = |at: usize| largest(series, at, duration).map(|x| x * (1.0 + 1e-12));
        let ([offset, _], [speed, growth]) = (most(OFFSET), most(VELOCITY));
        let [[payload, payload_growth], [stage, stage_growth]] =
            [PAYLOAD_RATE, STAGE_RATE].map(most);
        StepLimits {
            offset_m: offset,
            speed_m_per_s: speed,
            // The entries of the velocity are those along the axes of the payload, which turn.
            acceleration_m_per_s2: growth + payload * speed,
            angular_speed_rad_per_s: [payload, stage],
            angular_acceleration_rad_per_s2: [payload_growth, stage_growth],
        }
    }
}

/// The largest size that a vector of a state and its derivative can have up to a time.
fn largest(series: &[State; TERMS], at: usize, duration: f64) -> [f64; 2] {
    let mut power = 1.0;
    let [mut size, mut growth] = [0.0; 2];
    let mut before = 0.0;
    for (k, row) in series.iter().enumerate() {
        let term = vector(row, at).norm();
        size += term * power;
        growth += k as f64 * term * before;
        (before, power) = (power, power * duration);
    }
    [size, growth]
}

#[cfg(test)]
mod tests {
    use crate::{Body, BodyState, Separation, Settings, Snapshot, Spring};
    use gyradius_inertia::InertiaMatrix;
    use nalgebra::Vector3;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Nothing moves faster, within a step and from one time of it to another, and much less fast nothing is said to be.
        #[test]
        fn nothing_is_faster(
            spin in prop::array::uniform3(-3.0..3.0f64),
            stiffness in 1e3..1e6f64,
            points in prop::collection::vec((-0.8..0.8f64, -0.8..0.8f64), 1..5),
        ) {
            let inertia = InertiaMatrix::from_entries([900.0, 800.0, 500.0], [20.0, -30.0, 10.0]).unwrap();
            let body = Body::new(2000.0, inertia).unwrap();
            let spring = |(x, y): &(f64, f64)| {
                Spring::new(stiffness, 0.1, Vector3::new(*x, *y, -0.9), Vector3::new(*x, *y, 0.9)).unwrap()
            };
            let springs: Vec<Spring> = points.iter().map(spring).collect();
            let state = BodyState { position: Vector3::z(), angular_velocity: spin.into(), ..BodyState::default() };
            let payload = body.moving(state);
            let separation = Separation::new(payload, body.at(-Vector3::z()), &springs);
            let Ok(separation) = separation else { return Ok(()) };
            let mut used = [0.0_f64; 5];
            let run = separation.follow(&Settings::default(), 0.0, |step| {
                let limits = step.limits();
                let time = |i: u32| step.start_s() + (step.end_s() - step.start_s()) * f64::from(i) / 50.0;
                let numbers = |now: &Snapshot| {
                    let [p, s] = [now.payload().state(), now.stage().state()];
                    (p.velocity - s.velocity, [p.angular_velocity, s.angular_velocity], p.position - s.position)
                };
                let mut before: Option<(f64, Vector3<f64>, [Vector3<f64>; 2])> = None;
                for i in 0..=50 {
                    let now = step.at(time(i));
                    let (velocity, rates, offset) = numbers(&now);
                    assert!(offset.norm() <= limits.offset_m);
                    let mut use_up = |place: usize, found: f64, most: f64| {
                        assert!(found <= most * (1.0 + 1e-9) + 1e-12, "{place}: {found} {most}");
                        used[place] = used[place].max(found / most);
                    };
                    use_up(0, velocity.norm(), limits.speed_m_per_s);
                    use_up(1, rates[0].norm(), limits.angular_speed_rad_per_s[0]);
                    if let Some((time, was, turned)) = before.filter(|(time, ..)| now.time_s() > *time) {
                        let rate = |a: Vector3<f64>, b: Vector3<f64>| (a - b).norm() / (now.time_s() - time);
                        use_up(2, rate(velocity, was), limits.acceleration_m_per_s2);
                        for i in 0..2 {
                            use_up(3 + i, rate(rates[i], turned[i]), limits.angular_acceleration_rad_per_s2[i]);
                        }
                    }
                    before = Some((now.time_s(), velocity, rates));
                }
            });
            if run.is_ok() {
                prop_assert!(used[..3].iter().all(|used| *used > 0.3), "{used:?}");
            }
        }
    }
}
