//! What of bodies and loads can be uncertain: declared once, with name, unit, how it is given and its nominal values.

use crate::MovingBody;

/// What of a body or a load can be uncertain: a number, or a vector of a few.
pub trait Parameter: Copy + Eq + std::fmt::Debug + Send + Sync + 'static {
    /// What it is of.
    type Of;
    /// All, in the order in which a run table holds them.
    const ALL: &'static [Self];
    /// Its name, as in `stiffness`.
    fn name(self) -> &'static str;
    /// Its unit as names of fields and columns end, as in `n_per_m`.
    fn unit(self) -> &'static str;
    /// Its key in scenarios: name and unit.
    fn key(self) -> String {
        format!("{}_{}", self.name(), self.unit())
    }

    /// Whether it must be given, and how large it may be.
    fn given(self) -> Given;
    /// How many numbers it is.
    fn components(self) -> usize;
    /// The values as built, one for each component, and zeros in the place of those that there are not.
    fn built(self, of: &Self::Of) -> [f64; 3];

    /// The values as built, one for each component.
    fn nominal(self, of: &Self::Of) -> Vec<f64> {
        self.built(of)[..self.components()].to_vec()
    }
}

/// Whether a parameter must be given. The number is that beyond which nothing that separates is, in the parameter's
/// unit: beyond it the rounding of double precision would be larger than what is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Given {
    /// It must be, and is not zero.
    Always(f64),
    /// It is zero if it is not given.
    OrZero(f64),
    /// Never: it is a deviation from what else is given, and nominally zero.
    Never,
}

impl Given {
    /// The greatest magnitude that can be given; none if nothing can.
    #[must_use]
    pub fn most(self) -> Option<f64> {
        match self {
            Self::Always(most) | Self::OrZero(most) => Some(most),
            Self::Never => None,
        }
    }
}

/// Declares the parameters of something, in the order of a run table: what it is, then
/// `Name: name, unit, components, how it is given, its nominal values`.
macro_rules! parameters {
    ($(#[$about:meta])* $name:ident of $of:ty; $(
        $(#[$meaning:meta])+ $variant:ident:
        $text:literal, $unit:literal, $components:literal, $given:expr, $nominal:expr;
    )+) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $name {
            $($(#[$meaning])+ $variant,)+
        }

        impl $crate::Parameter for $name {
            type Of = $of;
            const ALL: &'static [Self] = &[$(Self::$variant),+];

            fn name(self) -> &'static str {
                match self { $(Self::$variant => $text,)+ }
            }

            fn unit(self) -> &'static str {
                match self { $(Self::$variant => $unit,)+ }
            }

            fn given(self) -> $crate::Given {
                use $crate::Given::*;
                match self { $(Self::$variant => $given,)+ }
            }

            fn components(self) -> usize {
                match self { $(Self::$variant => $components,)+ }
            }

            fn built(self, of: &$of) -> [f64; 3] {
                let mut values = [0.0; 3];
                match self {
                    $(Self::$variant => {
                        let nominal: fn(&$of) -> [f64; $components] = $nominal;
                        values[..$components].copy_from_slice(&nominal(of));
                    })+
                }
                values
            }
        }
    };
}
pub(crate) use parameters;

parameters! {
    /// What of a body can be uncertain, besides its inertia. Position and velocity are those of the nominal
    /// mass centre, a point of the structure, which need not be the true one.
    BodyParameter of MovingBody;
    /// Mass.
    Mass: "mass", "kg", 1, Always(1e12), |moving| [moving.body().mass_kg()];
    /// From the nominal mass centre to the true one, body axes.
    MassCentre: "mass_centre", "m", 3, Never, |_| [0.0; 3];
    /// Position, inertial axes.
    Position: "position", "m", 3, Always(1e9), |moving| moving.state().position.into();
    /// Velocity, inertial axes.
    Velocity: "velocity", "m_per_s", 3, OrZero(1e6), |moving| moving.state().velocity.into();
    /// Rotation vector from the nominal attitude, body axes.
    Attitude: "attitude", "deg", 3, Never, |_| [0.0; 3];
    /// Angular velocity, body axes.
    AngularVelocity: "angular_velocity", "rad_per_s", 3, OrZero(1e4), |moving| moving.state().angular_velocity.into();
}

parameters! {
    /// How the stack as a whole may move when the clamp opens, besides the nominal motion of its bodies.
    StackParameter of ();
    /// Rotation vector about the common mass centre, stage axes.
    Attitude: "attitude", "deg", 3, Never, |()| [0.0; 3];
    /// Angular velocity, stage axes.
    AngularVelocity: "angular_velocity", "rad_per_s", 3, Never, |()| [0.0; 3];
}
