//! Why a statement is refused. Keys are those of the serialized form.

use std::fmt;

use super::{MOST_SIGMAS, MOST_TRACES};

/// Why a statement is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StatementError {
    /// A number after the ± is negative, NaN or infinite.
    #[error("{key} = {value:?}: it must be finite and not negative")]
    Amount {
        /// Its key.
        key: String,
        /// The number.
        value: f64,
    },
    /// The number of deviations is not in range.
    #[error(
        "{part}.sigmas = {value:?}: it must be between 0.1 and {MOST_SIGMAS}: how many standard \
         deviations ± stands for"
    )]
    Sigmas {
        /// Which statement.
        part: Part,
        /// The number.
        value: f64,
    },
    /// What nobody means, or what no model can be made of.
    #[error(
        "{key} = {value:?}: with sigmas = {sigmas:?} this is a standard deviation of {:?} {unit}, \
         and it must be at most {most} {unit}",
        rounded(value / sigmas)
    )]
    TooLarge {
        /// Its key.
        key: String,
        /// The number.
        value: f64,
        /// How many standard deviations it stands for.
        sigmas: f64,
        /// The largest standard deviation.
        most: f64,
        /// The unit of both.
        unit: &'static str,
    },
    /// Moments or products that scatter far beyond the body.
    #[error(
        "{part}.kg_m2: a standard deviation of {:?} kg·m² is stated, and it must be at most \
         {MOST_TRACES} times the trace of the nominal inertia, which is {:?} kg·m²",
        rounded(*deviation),
        rounded(*trace)
    )]
    BeyondBody {
        /// Which statement.
        part: Part,
        /// What is stated, kg·m².
        deviation: f64,
        /// The trace of the nominal inertia, kg·m².
        trace: f64,
    },
    /// A mass that scatters beyond itself.
    #[error(
        "mass.kg: a standard deviation of {:?} kg is stated, and it must be at most the \
         nominal mass, which is {:?} kg",
        // What is only just too much has more digits to say.
        if rounded(*deviation) > rounded(*mass) { rounded(*deviation) } else { *deviation },
        rounded(*mass)
    )]
    BeyondMass {
        /// What is stated, kg.
        deviation: f64,
        /// The nominal mass, kg.
        mass: f64,
    },
    /// An arm where mass centre and inertia are drawn together.
    #[error(
        "centre.arm_m = {arm:?}: it must be left out here, where the inertia is drawn about the mass centre as it is drawn: an arm \
         says that the inertia was measured about another point"
    )]
    ArmBesideCentre {
        /// The arm, m.
        arm: [f64; 3],
    },
    /// An arm that is not finite or is very long.
    #[error("centre.arm_m[{}] = {value:?}: it must be between -{most:e} and {most:e}", index + 1)]
    Arm {
        /// Which component, from 0.
        index: usize,
        /// The number.
        value: f64,
        /// The longest, m.
        most: f64,
    },
    /// A statement that gives no amount, or two.
    #[error("{part}: there must be exactly one of {allowed}")]
    Units {
        /// Which statement.
        part: Part,
        /// The keys that give an amount.
        allowed: &'static str,
    },
    /// An amount that was read as one of something else.
    #[error(
        "{part}: an amount of the {part} is needed, and {values:?} {unit} was read as one of the {read_of}"
    )]
    OtherPart {
        /// What was to be stated.
        part: Part,
        /// Of what the amount was read.
        read_of: Part,
        /// Its numbers.
        values: [f64; 3],
        /// Their unit.
        unit: &'static str,
    },
    /// Three rotations where the angle of the whole rotation is stated.
    #[error("axes.deg: there must be one number with of = \"total\", not three")]
    ThreeOfTotal,
    /// There is no statement at all.
    #[error(
        "nothing is stated: there must be at least one of the tables [moments], [products], [axes], \
         [mass] and [centre]"
    )]
    Nothing,
    /// A statement that needs the mass.
    #[error("nominal.mass_kg is missing: what is stated of the {part} needs it")]
    NoMass {
        /// Which statement.
        part: Part,
    },
    /// The mass is not positive and finite.
    #[error("nominal.mass_kg = {value:?}: it must be between 1e-30 and 1e30")]
    Mass {
        /// The mass, kg.
        value: f64,
    },
    /// The nominal body is a point, or so large or small that squares of its moments overflow.
    #[error(
        "nominal.inertia_kg_m2: its trace is {trace:e} kg·m², and must be between 1e-60 and 1e60"
    )]
    Nominal {
        /// The trace, kg·m².
        trace: f64,
    },
    /// What is stated is too large for any law.
    #[error("the statements do not make a law: {problem}")]
    Law {
        /// Why.
        problem: String,
    },
}

/// A number of five digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.4e}").parse().unwrap_or(value)
}

/// Which statement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Part {
    /// On the moments.
    Moments,
    /// On the products.
    Products,
    /// On the axes.
    Axes,
    /// On the mass.
    Mass,
    /// On the mass centre.
    Centre,
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Moments => "moments",
            Self::Products => "products",
            Self::Axes => "axes",
            Self::Mass => "mass",
            Self::Centre => "centre",
        })
    }
}
