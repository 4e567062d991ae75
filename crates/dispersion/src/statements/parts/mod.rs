//! The parts of a statement, each checked by itself.

#[cfg(feature = "serde")]
mod file;

use std::fmt;

/// Most deviations that a statement may stand for.
const MOST_SIGMAS: f64 = 10.0;
/// Largest turn of the axes that is stated, deg: beyond it any axes do.
const LARGEST_TURN: f64 = 45.0;

/// Why a statement is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StatementError {
    /// A number after the ± is negative, NaN or infinite.
    #[error("{part}: ± {value}: it must be finite and not negative")]
    Amount {
        /// Which statement.
        part: Part,
        /// The number.
        value: f64,
    },
    /// The number of deviations is not in range.
    #[error(
        "{part}: sigmas = {value}: it must be between 0.1 and {MOST_SIGMAS}: how many standard \
         deviations ± stands for"
    )]
    Sigmas {
        /// Which statement.
        part: Part,
        /// The number.
        value: f64,
    },
    /// Axes beyond what a turn from a mean can be.
    #[error("axes: ± {value}°: it must be at most {LARGEST_TURN}° (1σ)")]
    Turn {
        /// The turn of one deviation, deg.
        value: f64,
    },
    /// A statement that gives no amount, or two.
    #[error("{part}: there must be exactly one of {allowed}")]
    Units {
        /// Which statement.
        part: Part,
        /// The keys that give an amount.
        allowed: &'static str,
    },
    /// A statement that needs the mass.
    #[error("{part}: it needs the nominal mass")]
    NoMass {
        /// Which statement.
        part: Part,
    },
    /// The mass is not positive and finite.
    #[error("mass = {value} kg: it must be positive and finite")]
    Mass {
        /// The mass, kg.
        value: f64,
    },
    /// The nominal body is a point, or so large or small that squares of its moments overflow.
    #[error("nominal trace of inertia = {trace:e} kg·m²: it must be between 1e-60 and 1e60")]
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

/// What follows the ±.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amount {
    /// In percent of the nominal values.
    Percent([f64; 3]),
    /// In the unit of what is stated.
    Absolute([f64; 3]),
}

fn checked(part: Part, values: [f64; 3], sigmas: f64) -> Result<[f64; 3], StatementError> {
    if !(0.1..=MOST_SIGMAS).contains(&sigmas) {
        return Err(StatementError::Sigmas { part, value: sigmas });
    }
    match values.iter().find(|x| !(**x >= 0.0 && **x <= 1e30)) {
        Some(&value) => Err(StatementError::Amount { part, value }),
        None => Ok(values.map(|x| x / sigmas)),
    }
}

/// “Moments ± 10 % (1σ)”: deviations of the diagonal entries I₁₁, I₂₂, I₃₃, about body axes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "file::Moments", into = "file::Moments")
)]
pub struct MomentsStatement {
    amount: Amount,
}

impl MomentsStatement {
    /// ± `amount` (% or kg·m²) stands for so many standard deviations.
    ///
    /// # Errors
    /// A number is negative or not finite, or `sigmas` is not between 0.1 and 10.
    pub fn new(amount: Amount, sigmas: f64) -> Result<Self, StatementError> {
        let check = |values| checked(Part::Moments, values, sigmas);
        Ok(Self {
            amount: match amount {
                Amount::Percent(values) => Amount::Percent(check(values)?),
                Amount::Absolute(values) => Amount::Absolute(check(values)?),
            },
        })
    }

    /// Standard deviations of I₁₁, I₂₂, I₃₃, kg·m².
    #[must_use]
    pub fn deviations(&self, nominal: [f64; 3]) -> [f64; 3] {
        match self.amount {
            Amount::Percent(p) => std::array::from_fn(|i| 0.01 * p[i] * nominal[i].abs()),
            Amount::Absolute(d) => d,
        }
    }
}

/// “Products within ± 50 kg·m² (3σ)”: deviations of I₁₂, I₁₃, I₂₃ from their nominal values, in
/// body axes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "file::Products", into = "file::Products")
)]
pub struct ProductsStatement {
    deviations: [f64; 3],
}

impl ProductsStatement {
    /// ± kg·m² for I₁₂, I₁₃, I₂₃ stands for so many standard deviations.
    ///
    /// # Errors
    /// As for [`MomentsStatement::new`].
    pub fn new(kg_m2: [f64; 3], sigmas: f64) -> Result<Self, StatementError> {
        Ok(Self { deviations: checked(Part::Products, kg_m2, sigmas)? })
    }

    /// Standard deviations, kg·m².
    #[must_use]
    pub fn deviations(&self) -> [f64; 3] {
        self.deviations
    }
}

/// “Axes within 2°”: deviations of small turns about the principal axes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "file::Axes", into = "file::Axes")
)]
pub struct AxesStatement {
    /// rad.
    deviations: [f64; 3],
}

impl AxesStatement {
    /// ± degrees of the turn about each principal axis stands for so many standard deviations.
    ///
    /// # Errors
    /// As for [`MomentsStatement::new`], or a deviation is beyond 45°.
    pub fn each(deg: [f64; 3], sigmas: f64) -> Result<Self, StatementError> {
        let deviations = checked(Part::Axes, deg, sigmas)?;
        match deviations.iter().find(|d| **d > LARGEST_TURN) {
            Some(&value) => Err(StatementError::Turn { value }),
            None => Ok(Self { deviations: deviations.map(f64::to_radians) }),
        }
    }

    /// ± degrees of the angle of the whole turn, whatever its axis: its root mean square is
    /// `deg`/`sigmas`, a third of its square falls on each axis.
    ///
    /// # Errors
    /// As for [`each`](Self::each).
    pub fn total(deg: f64, sigmas: f64) -> Result<Self, StatementError> {
        Self::each([deg / 3_f64.sqrt(); 3], sigmas)
    }

    /// Standard deviations of the turns about principal axes 1, 2, 3, rad.
    #[must_use]
    pub fn deviations(&self) -> [f64; 3] {
        self.deviations
    }
}

/// “Mass ± 1 %”: the whole inertia grows and shrinks with it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "file::Mass", into = "file::Mass")
)]
pub struct MassStatement {
    amount: Amount,
}

impl MassStatement {
    /// ± percent.
    ///
    /// # Errors
    /// As for [`MomentsStatement::new`].
    pub fn percent(percent: f64, sigmas: f64) -> Result<Self, StatementError> {
        Ok(Self { amount: Amount::Percent(checked(Part::Mass, [percent; 3], sigmas)?) })
    }

    /// ± kg.
    ///
    /// # Errors
    /// As for [`MomentsStatement::new`].
    pub fn kg(kg: f64, sigmas: f64) -> Result<Self, StatementError> {
        Ok(Self { amount: Amount::Absolute(checked(Part::Mass, [kg; 3], sigmas)?) })
    }

    /// Standard deviation over the nominal mass.
    ///
    /// # Errors
    /// It was given in kg, and there is no nominal mass.
    pub fn relative(&self, mass_kg: Option<f64>) -> Result<f64, StatementError> {
        match self.amount {
            Amount::Percent([p, ..]) => Ok(0.01 * p),
            Amount::Absolute([kg, ..]) => {
                Ok(kg / mass_kg.ok_or(StatementError::NoMass { part: Part::Mass })?)
            }
        }
    }
}

/// “Centre of mass ± 10 mm”: the inertia was taken about a point that is off by that.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "file::Centre", into = "file::Centre")
)]
pub struct CentreStatement {
    deviations: [f64; 3],
    arm: [f64; 3],
}

impl CentreStatement {
    /// ± metres along body axes 1, 2, 3 stands for so many standard deviations. `arm_m` is the
    /// nominal mass centre as seen from the point about which the inertia was measured before it was
    /// moved to the mass centre; zero if it was computed about the nominal mass centre.
    ///
    /// # Errors
    /// As for [`MomentsStatement::new`]; the arm must be finite.
    pub fn new(metres: [f64; 3], sigmas: f64, arm_m: [f64; 3]) -> Result<Self, StatementError> {
        if let Some(&value) = arm_m.iter().find(|x| !(x.abs() <= 1e12)) {
            return Err(StatementError::Amount { part: Part::Centre, value });
        }
        Ok(Self { deviations: checked(Part::Centre, metres, sigmas)?, arm: arm_m })
    }

    /// Standard deviations along body axes 1, 2, 3, m.
    #[must_use]
    pub fn deviations(&self) -> [f64; 3] {
        self.deviations
    }

    /// Variances of the six entries, (kg·m²)², in the order 11, 22, 33, 12, 13, 23.
    ///
    /// With the mass centre off by d and the arm L, the inertia moved to the nominal centre is wrong by
    /// m[(|L + d|² − |L|²)·1 − (L + d)(L + d)ᵀ + LLᵀ], whose linear part is that of the parallel
    /// axes, 2m L·d and so on, and whose square part is all there is without an arm.
    pub(super) fn entry_variances(&self, mass: f64) -> [f64; 6] {
        let (l, s) = (self.arm, self.deviations);
        // L_b d_b twice: variance 4L²s² + 2s⁴.
        let along = |b: usize| 4.0 * (l[b] * s[b]).powi(2) + 2.0 * s[b].powi(4);
        let across = |a: usize, b: usize| {
            (l[a] * s[b]).powi(2) + (l[b] * s[a]).powi(2) + (s[a] * s[b]).powi(2)
        };
        [
            along(1) + along(2),
            along(0) + along(2),
            along(0) + along(1),
            across(0, 1),
            across(0, 2),
            across(1, 2),
        ]
        .map(|v| v * mass * mass)
    }
}
