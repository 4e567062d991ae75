//! The parts of a statement, each checked by itself.

mod check;
mod error;
#[cfg(feature = "serde")]
mod file;
mod written;

use written::{Unit, Written};

pub use error::{Part, StatementError};

/// Most deviations that a statement may stand for.
const MOST_SIGMAS: f64 = 10.0;
/// Largest stated deviation of moments and products, in traces of the nominal inertia.
const MOST_TRACES: f64 = 10.0;
/// Longest arm, m.
const LONGEST_ARM: f64 = 1e6;

/// What follows the ±.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amount {
    /// In percent of the nominal values.
    Percent([f64; 3]),
    /// In the unit of what is stated.
    Absolute([f64; 3]),
}

/// “Moments ± 10 % (1σ)”: deviations of the diagonal entries I₁₁, I₂₂, I₃₃, about body axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MomentsStatement {
    amount: Amount,
}

impl MomentsStatement {
    /// ± `amount` (% or kg·m²) stands for so many standard deviations.
    ///
    /// # Errors
    /// A number is negative, not finite or beyond a standard deviation of 1000 %, or `sigmas` is not
    /// between 0.1 and 10.
    pub fn new(amount: Amount, sigmas: f64) -> Result<Self, StatementError> {
        Self::written(amount, true, sigmas)
    }

    fn written(amount: Amount, each: bool, sigmas: f64) -> Result<Self, StatementError> {
        let written = |unit, values| Written { part: Part::Moments, unit, values, each, sigmas };
        let amount = match amount {
            Amount::Percent(x) => Amount::Percent(written(Unit::PERCENT, x).deviations()?),
            Amount::Absolute(x) => Amount::Absolute(written(Unit::KG_M2, x).deviations()?),
        };
        Ok(Self { amount })
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
#[derive(Clone, Copy, Debug, PartialEq, getset::CopyGetters)]
#[getset(get_copy = "pub")]
pub struct ProductsStatement {
    /// Standard deviations, kg·m².
    deviations: [f64; 3],
}

impl ProductsStatement {
    /// ± kg·m² for I₁₂, I₁₃, I₂₃ stands for so many standard deviations.
    ///
    /// # Errors
    /// As for [`MomentsStatement::new`].
    pub fn new(kg_m2: [f64; 3], sigmas: f64) -> Result<Self, StatementError> {
        Self::written(kg_m2, true, sigmas)
    }

    fn written(values: [f64; 3], each: bool, sigmas: f64) -> Result<Self, StatementError> {
        let written = Written { part: Part::Products, unit: Unit::KG_M2, values, each, sigmas };
        Ok(Self { deviations: written.deviations()? })
    }
}

/// “Axes within 2°”: deviations of small turns about the principal axes.
#[derive(Clone, Copy, Debug, PartialEq, getset::CopyGetters)]
#[getset(get_copy = "pub")]
pub struct AxesStatement {
    /// Standard deviations of the turns about principal axes 1, 2, 3, rad.
    deviations: [f64; 3],
}

impl AxesStatement {
    /// ± degrees of the turn about each principal axis stands for so many standard deviations.
    ///
    /// # Errors
    /// As for [`MomentsStatement::new`], but a standard deviation may be 45° at most.
    pub fn each(deg: [f64; 3], sigmas: f64) -> Result<Self, StatementError> {
        Self::written(deg, true, sigmas)
    }

    /// ± degrees of the angle of the whole turn, whatever its axis: its root mean square is
    /// `deg`/`sigmas`, a third of its square falls on each axis.
    ///
    /// # Errors
    /// As for [`each`](Self::each), but a standard deviation may be 75° at most.
    pub fn total(deg: f64, sigmas: f64) -> Result<Self, StatementError> {
        let (unit, values) = (Unit::DEG_IN_ALL, [deg; 3]);
        let written = Written { part: Part::Axes, unit, values, each: false, sigmas };
        let deviations = written.scaled(1.0 / 3_f64.sqrt())?;
        Ok(Self { deviations: deviations.map(f64::to_radians) })
    }

    fn written(values: [f64; 3], each: bool, sigmas: f64) -> Result<Self, StatementError> {
        let written = Written { part: Part::Axes, unit: Unit::DEG, values, each, sigmas };
        Ok(Self { deviations: written.deviations()?.map(f64::to_radians) })
    }
}

/// “Mass ± 1 %”: the whole inertia grows and shrinks with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassStatement {
    amount: Amount,
}

impl MassStatement {
    /// ± percent.
    ///
    /// # Errors
    /// As for [`MomentsStatement::new`], but a standard deviation may be 100 % at most.
    pub fn percent(percent: f64, sigmas: f64) -> Result<Self, StatementError> {
        Self::written(Unit::PERCENT_OF_MASS, percent, sigmas)
            .map(|x| Self { amount: Amount::Percent(x) })
    }

    /// ± kg.
    ///
    /// # Errors
    /// As for [`MomentsStatement::new`].
    pub fn kg(kg: f64, sigmas: f64) -> Result<Self, StatementError> {
        Self::written(Unit::KG, kg, sigmas).map(|x| Self { amount: Amount::Absolute(x) })
    }

    fn written(unit: Unit, value: f64, sigmas: f64) -> Result<[f64; 3], StatementError> {
        Written { part: Part::Mass, unit, values: [value; 3], each: false, sigmas }.deviations()
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
#[derive(Clone, Copy, Debug, PartialEq, getset::CopyGetters)]
pub struct CentreStatement {
    /// Standard deviations along body axes 1, 2, 3, m.
    #[getset(get_copy = "pub")]
    deviations: [f64; 3],
    arm: [f64; 3],
}

impl CentreStatement {
    /// ± metres along body axes 1, 2, 3 stands for so many standard deviations. `arm_m` is the
    /// nominal mass centre as seen from the point about which the inertia was measured before it was
    /// moved to the mass centre; zero if it was computed about the nominal mass centre.
    ///
    /// # Errors
    /// A number is negative, not finite or beyond a standard deviation of 10 km, `sigmas` is not between
    /// 0.1 and 10, or the arm is not finite or longer than 1000 km.
    pub fn new(metres: [f64; 3], sigmas: f64, arm_m: [f64; 3]) -> Result<Self, StatementError> {
        let unit = Unit::M;
        let written = Written { part: Part::Centre, unit, values: metres, each: true, sigmas };
        Self::with_arm(written.deviations()?, arm_m)
    }

    fn with_arm(deviations: [f64; 3], arm: [f64; 3]) -> Result<Self, StatementError> {
        match arm.iter().position(|x| !(x.abs() <= LONGEST_ARM)) {
            Some(index) => Err(StatementError::Arm { index, value: arm[index], most: LONGEST_ARM }),
            None => Ok(Self { deviations, arm }),
        }
    }

    /// The mass centre as seen from where the inertia was measured, m; none if that was at the mass centre.
    pub(crate) fn arm(&self) -> Option<[f64; 3]> {
        (self.arm != [0.0; 3]).then_some(self.arm)
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
