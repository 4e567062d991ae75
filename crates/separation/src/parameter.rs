//! What of bodies and loads can be uncertain: declared with name, unit and nominal values.

use crate::MovingBody;

/// What of a body or a load can be uncertain: a number, or a vector of a few.
pub trait Parameter: Copy + Eq + std::fmt::Debug + 'static {
    /// What it is of.
    type Of;
    /// All, in the order in which a run table holds them.
    const ALL: &'static [Self];
    /// Its name, as in `stiffness`.
    fn name(self) -> &'static str;
    /// Its unit as names of fields and columns end, as in `n_per_m`.
    fn unit(self) -> &'static str;
    /// The values as built, one for each component.
    fn nominal(self, of: &Self::Of) -> Vec<f64>;
}

/// What of a body can be uncertain, besides its inertia. Position and velocity are those of the nominal
/// mass centre, a point of the structure, which need not be the true one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyParameter {
    /// Mass.
    Mass,
    /// From the nominal mass centre to the true one, body axes.
    MassCentre,
    /// Position, inertial axes.
    Position,
    /// Velocity, inertial axes.
    Velocity,
    /// Rotation vector from the nominal attitude, body axes.
    Attitude,
    /// Angular velocity, body axes.
    AngularVelocity,
}

impl Parameter for BodyParameter {
    type Of = MovingBody;
    const ALL: &'static [Self] = &[
        Self::Mass,
        Self::MassCentre,
        Self::Position,
        Self::Velocity,
        Self::Attitude,
        Self::AngularVelocity,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Mass => "mass",
            Self::MassCentre => "mass_centre",
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Attitude => "attitude",
            Self::AngularVelocity => "angular_velocity",
        }
    }

    fn unit(self) -> &'static str {
        match self {
            Self::Mass => "kg",
            Self::MassCentre | Self::Position => "m",
            Self::Velocity => "m_per_s",
            Self::Attitude => "deg",
            Self::AngularVelocity => "rad_per_s",
        }
    }

    fn nominal(self, of: &MovingBody) -> Vec<f64> {
        let state = of.state();
        match self {
            Self::Mass => vec![of.body().mass_kg()],
            Self::MassCentre | Self::Attitude => vec![0.0; 3],
            Self::Position => state.position.as_slice().to_vec(),
            Self::Velocity => state.velocity.as_slice().to_vec(),
            Self::AngularVelocity => state.angular_velocity.as_slice().to_vec(),
        }
    }
}

/// How the stack as a whole may move when the clamp opens, besides the nominal motion of its bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StackParameter {
    /// Rotation vector about the common mass centre, stage axes.
    Attitude,
    /// Angular velocity, stage axes.
    AngularVelocity,
}

impl Parameter for StackParameter {
    type Of = ();
    const ALL: &'static [Self] = &[Self::Attitude, Self::AngularVelocity];

    fn name(self) -> &'static str {
        match self {
            Self::Attitude => "attitude",
            Self::AngularVelocity => "angular_velocity",
        }
    }

    fn unit(self) -> &'static str {
        match self {
            Self::Attitude => "deg",
            Self::AngularVelocity => "rad_per_s",
        }
    }

    fn nominal(self, (): &()) -> Vec<f64> {
        vec![0.0; 3]
    }
}
