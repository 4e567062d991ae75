//! Where the energy of the springs has gone.

use crate::MovingBody;

/// Where the energy of the springs has gone, J.
///
/// Translation is that of a body's mass centre relative to the mass centre of the whole, ½m|v − v_c|²:
/// what an observer who moves with the whole sees, so that the speed of flight does not drown it.
/// Rotation is ½ωᵀIω. Each is the change from the start to the last release; the four sum, to
/// rounding, to what the springs had stored, less what friction takes, what late springs give away under
/// their latches and what failed ones keep. A body that was turning may have lost rotation.
///
/// ```
/// # use gyradius_inertia::InertiaMatrix;
/// # use gyradius_separation::{Body, Separation, Spring};
/// # use nalgebra::Vector3;
/// # let inertia = InertiaMatrix::from_entries([5e3, 4e3, 3e3], [0.0; 3])?;
/// # let point = |z| Vector3::new(0.5, 0.0, z);
/// # let spring = Spring::new(1e5, 0.1, point(-0.9), point(0.9))?;
/// # let (payload, stage) = (Body::new(1e4, inertia)?, Body::new(4e3, inertia)?);
/// # let separation =
/// #     Separation::new(payload.at(Vector3::z()), stage.at(-Vector3::z()), &[spring])?;
/// use gyradius_separation::Settings;
///
/// let split = separation.run(&Settings::default())?.energy_split();
/// assert!((split.total_j() / split.stored_j() - 1.0).abs() < 1e-12);
/// // The lighter body takes more.
/// assert!(split.stage_translation_j() > split.payload_translation_j());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(remote = "Self"))]
pub struct EnergySplit {
    stored: f64,
    payload_translation: f64,
    payload_rotation: f64,
    stage_translation: f64,
    stage_rotation: f64,
}

impl EnergySplit {
    /// Of the energy stored at the start, J, and payload and stage at the start and after the last release.
    pub(crate) fn new(stored: f64, before: &[MovingBody; 2], after: &[MovingBody; 2]) -> Self {
        let (was, is) = (translations(before.each_ref()), translations(after.each_ref()));
        let rotation = |i: usize| after[i].rotational_energy() - before[i].rotational_energy();
        Self {
            stored,
            payload_translation: is[0] - was[0],
            payload_rotation: rotation(0),
            stage_translation: is[1] - was[1],
            stage_rotation: rotation(1),
        }
    }

    /// Energy stored in the springs at the start, Σ½kδ², J.
    #[must_use]
    pub fn stored_j(&self) -> f64 {
        self.stored
    }

    /// Into the payload's translation, J.
    #[must_use]
    pub fn payload_translation_j(&self) -> f64 {
        self.payload_translation
    }

    /// Into the payload's rotation, J.
    #[must_use]
    pub fn payload_rotation_j(&self) -> f64 {
        self.payload_rotation
    }

    /// Into the stage's translation, J.
    #[must_use]
    pub fn stage_translation_j(&self) -> f64 {
        self.stage_translation
    }

    /// Into the stage's rotation, J.
    #[must_use]
    pub fn stage_rotation_j(&self) -> f64 {
        self.stage_rotation
    }

    /// The four together, J: the energy stored, to rounding, where springs have no friction and none is
    /// late or fails.
    #[must_use]
    pub fn total_j(&self) -> f64 {
        self.payload_translation
            + self.payload_rotation
            + self.stage_translation
            + self.stage_rotation
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for EnergySplit {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        Self::serialize(self, to)
    }
}

/// Energies that are finite.
#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for EnergySplit {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let read = Self::deserialize(from)?;
        if read.stored.is_finite() && read.total_j().is_finite() {
            return Ok(read);
        }
        Err(serde::de::Error::custom(format!("{read:?}: energies must be finite")))
    }
}

/// Energies of translation of payload and stage relative to their common mass centre, J.
pub(crate) fn translations(bodies: [&MovingBody; 2]) -> [f64; 2] {
    let [payload, stage] = bodies.map(|b| b.body().mass_kg());
    let speed = (bodies[0].state().velocity - bodies[1].state().velocity).norm();
    // v_P − v_c = v m_L/(m_P + m_L), free of cancellation.
    let part = |mass: f64, other: f64| {
        let own = speed * (other / (payload + stage));
        0.5 * mass * own * own
    };
    [part(payload, stage), part(stage, payload)]
}

#[cfg(test)]
mod tests {
    use crate::{Body, BodyState, Separation, Settings, Spring};
    use gyradius_inertia::InertiaMatrix;
    use nalgebra::Vector3;

    fn body(mass: f64, moments: [f64; 3]) -> Body {
        Body::new(mass, InertiaMatrix::from_entries(moments, [0.0; 3]).unwrap()).unwrap()
    }

    /// A coaxial spring: ½kδ² goes into translation in the inverse ratio of the masses, whatever the
    /// speed of the whole.
    #[test]
    fn a_coaxial_spring_shares_by_masses() {
        let spring = Spring::new(800.0, 0.1, Vector3::z() * -0.5, Vector3::z() * 0.5).unwrap();
        for speed in [0.0, 3.0, 7500.0] {
            let at = |z: f64| BodyState {
                position: Vector3::z() * z,
                velocity: Vector3::new(speed, 0.0, -speed),
                ..BodyState::default()
            };
            let separation = Separation::new(
                body(30.0, [5.0, 4.0, 3.0]).moving(at(1.0)),
                body(10.0, [2.0, 2.0, 1.0]).moving(at(-1.0)),
                &[spring],
            )
            .unwrap();
            let outcome = separation.run(&Settings::default()).unwrap();
            let split = outcome.energy_split();
            // Velocities of 7.5 km/s carry 1e-12 m/s.
            let near = if speed > 100.0 { 1e-11 } else { 1e-13 };
            assert!((split.payload_translation_j() - 1.0).abs() < 4.0 * near, "{split:?}");
            assert!((split.stage_translation_j() - 3.0).abs() < 4.0 * near, "{split:?}");
            assert!(split.payload_rotation_j().abs() < 1e-25, "{split:?}");
            assert!(split.stage_rotation_j().abs() < 1e-25, "{split:?}");
            assert!((split.stored_j() - 4.0).abs() < 1e-15);
            #[cfg(feature = "serde")]
            {
                let json = serde_json::to_value(split).unwrap();
                let back = serde_json::from_str::<crate::EnergySplit>(&json.to_string());
                assert_eq!(back.unwrap(), split);
                for field in ["stored", "stage_rotation"] {
                    // The sum of two of these is no number.
                    let mut bad = json.clone();
                    bad[field] = f64::MAX.into();
                    bad["payload_translation"] = f64::MAX.into();
                    let read = serde_json::from_value::<crate::EnergySplit>(bad);
                    assert_eq!(read.is_err(), field == "stage_rotation");
                }
            }
        }
    }

    /// What friction takes, and what a failed spring keeps: the rest is ½k(δ − f/k)².
    #[test]
    fn friction_and_failure_have_their_part() {
        let points = (Vector3::z() * -0.5, Vector3::z() * 0.5);
        let spring = Spring::new(800.0, 0.1, points.0, points.1).unwrap();
        let rubbing = spring.with_friction(20.0).unwrap();
        let separation = Separation::new(
            body(30.0, [5.0, 4.0, 3.0]).at(Vector3::z()),
            body(10.0, [2.0, 2.0, 1.0]).at(-Vector3::z()),
            &[rubbing, spring.never_pushing()],
        )
        .unwrap();
        let outcome = separation.run(&Settings::default()).unwrap();
        let split = outcome.energy_split();
        assert!((split.stored_j() - 8.0).abs() < 1e-14, "{split:?}");
        let given = 0.5 * 800.0 * (0.1_f64 - 20.0 / 800.0).powi(2);
        assert!((split.total_j() - given).abs() < 1e-12, "{split:?}");
        assert_eq!(outcome.release_order(), [[0]]);
        assert_eq!(outcome.release_times().nth(1), Some(None));
    }

    /// Two bodies apart from one another but for a spring on equal arms: by the blow of a short
    /// stroke, J = √(2E/w), rotation takes the share of r×n in the inverse mass w.
    #[test]
    fn an_offset_spring_turns_the_bodies_as_a_blow_does() {
        let (p, l) = (Vector3::new(0.4, 0.0, -0.5), Vector3::new(0.4, 0.0, 0.5));
        let stroke = 1e-5;
        let spring = Spring::new(2.0 / (stroke * stroke), stroke, p, l).unwrap();
        let separation = Separation::new(
            body(12.0, [4.0, 3.0, 2.0]).at(Vector3::z()),
            body(5.0, [2.0, 1.5, 1.8]).at(-Vector3::z()),
            &[spring],
        )
        .unwrap();
        let outcome = separation.run(&Settings::default()).unwrap();
        let split = outcome.energy_split();
        let shares = [1.0 / 12.0, 0.16 / 3.0, 1.0 / 5.0, 0.16 / 1.5];
        let whole: f64 = shares.iter().sum();
        let found = [
            split.payload_translation_j(),
            split.payload_rotation_j(),
            split.stage_translation_j(),
            split.stage_rotation_j(),
        ];
        for (found, share) in found.iter().zip(shares) {
            assert!((found - share / whole).abs() < 1e-4, "{found} {}", share / whole);
        }
        // The stroke is a difference of lengths a hundred thousand times its own.
        assert!((split.total_j() - 1.0).abs() < 1e-10, "{split:?}");
    }
}
