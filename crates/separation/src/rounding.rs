//! What the arithmetic of a run leaves of quantities whose parts cancel.

use crate::{BodyState, Separation, Settings, load::Size, track::Fate};

/// The size below which the payload's angular momentum and the relative velocity after a run are
/// nothing but rounding, so that their directions mean nothing.
///
/// # Derivation
/// The final momentum is a sum of what there was and of what the springs have given. Spring i gives an
/// impulse of at most J = k x T, with its travel x and the time T from its start to its release, and an
/// angular impulse of at most |r| J, with its point r on the payload. The solution of a step is right to
/// its relative tolerance. Besides, the line s of a spring is a difference of coordinates, as large as
/// the reach R = |s| + |r_P| + |r_L|, so that rounding turns the force by ε R/|s| and changes it by
/// ε R/x; the sums of each step round once more. The bodies are where they are given from the origin, once: their
/// distance is a difference of positions, and grows by one of velocities, so that rounding turns the force by
/// 4 ε C/|s| besides, with C = |c_P| + |c_L| + (|v_P| + |v_L|) T. With n steps the directions are lost below
///
/// > Σ |r| J (tol + ε (4 + n) (1 + R/|s| + R/x) + 4 ε C/|s|) + ε (4 + n) |I| |ω₀|,
///
/// and likewise for the velocity, with 1/μ in the place of |r|, |v_P − v_L| in that of |I| |ω₀|, and 4 ε (|v_P| + |v_L|) besides.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub(crate) struct Rounding {
    /// Of the payload's angular momentum about its mass centre, kg·m²/s.
    #[cfg_attr(feature = "serde", serde(rename = "momentum_kg_m2_per_s"))]
    pub(crate) momentum: f64,
    /// Of the velocity of the mass centres from each other, m/s.
    #[cfg_attr(feature = "serde", serde(rename = "velocity_m_per_s"))]
    pub(crate) velocity: f64,
}

impl Rounding {
    pub(crate) fn new(
        separation: &Separation,
        loads: &[Fate],
        settings: &Settings,
        steps: u32,
    ) -> Self {
        let epsilon = f64::EPSILON * (4.0 + f64::from(steps));
        let (payload, stage) = (separation.payload(), separation.stage());
        // Not |I ω|, which may cancel itself.
        let inertia = payload.body().inertia().matrix();
        let spin = inertia.norm() * payload.state().angular_velocity.norm();
        let speed = (payload.state().velocity - stage.state().velocity).norm();
        let once = 4.0 * f64::EPSILON;
        let states = [payload.state(), stage.state()];
        let [position, velocity]: [f64; 2] =
            [|of: &BodyState| of.position, |of: &BodyState| of.velocity]
                .map(|of| states.iter().map(|state| of(state).norm()).sum());
        let mut rounding =
            Self { momentum: epsilon * spin, velocity: epsilon * speed + once * velocity };
        for (load, fate) in separation.seated().iter().zip(loads) {
            let (Some(release), Some(start)) = (fate.let_go(), load.start_s()) else { continue };
            let Size { travel, force, arms, distance, .. } = load.size();
            let reach = distance + arms[0] + arms[1];
            let impulse = force * (release - start);
            let from_origin = position + velocity * release;
            let relative = settings.relative_tolerance()
                + epsilon * (1.0 + reach / distance + reach / travel)
                + once * from_origin / distance;
            rounding.momentum += arms[0] * impulse * relative;
            rounding.velocity += impulse * separation.inverse_reduced_mass() * relative;
        }
        rounding
    }
}
