//! The serialized forms.

use super::{
    Amount, AxesStatement, CentreStatement, MassStatement, MomentsStatement, Part,
    ProductsStatement, StatementError,
};
use serde::{Deserialize, Serialize};

/// One number for all three, or three.
#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(untagged, expecting = "there must be one number, or a list of three")]
pub(super) enum Three {
    One(f64),
    Each([f64; 3]),
}

impl Three {
    fn values(self) -> [f64; 3] {
        match self {
            Self::One(x) => [x; 3],
            Self::Each(x) => x,
        }
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Moments {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    percent: Option<Three>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    kg_m2: Option<Three>,
    sigmas: f64,
}

impl TryFrom<Moments> for MomentsStatement {
    type Error = StatementError;

    fn try_from(file: Moments) -> Result<Self, StatementError> {
        let amount = match (file.percent, file.kg_m2) {
            (Some(x), None) => Amount::Percent(x.values()),
            (None, Some(x)) => Amount::Absolute(x.values()),
            _ => {
                let allowed = "percent, kg_m2";
                return Err(StatementError::Units { part: Part::Moments, allowed });
            }
        };
        Self::new(amount, file.sigmas)
    }
}

impl From<MomentsStatement> for Moments {
    fn from(statement: MomentsStatement) -> Self {
        let (percent, kg_m2) = match statement.amount {
            Amount::Percent(x) => (Some(Three::Each(x)), None),
            Amount::Absolute(x) => (None, Some(Three::Each(x))),
        };
        Self { percent, kg_m2, sigmas: 1.0 }
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Products {
    kg_m2: Three,
    sigmas: f64,
}

impl TryFrom<Products> for ProductsStatement {
    type Error = StatementError;

    fn try_from(file: Products) -> Result<Self, StatementError> {
        Self::new(file.kg_m2.values(), file.sigmas)
    }
}

impl From<ProductsStatement> for Products {
    fn from(statement: ProductsStatement) -> Self {
        Self { kg_m2: Three::Each(statement.deviations), sigmas: 1.0 }
    }
}

#[derive(Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Of {
    #[default]
    EachAxis,
    Total,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Axes {
    deg: Three,
    sigmas: f64,
    #[serde(default)]
    of: Of,
}

impl TryFrom<Axes> for AxesStatement {
    type Error = StatementError;

    fn try_from(file: Axes) -> Result<Self, StatementError> {
        match (file.of, file.deg) {
            (Of::EachAxis, deg) => Self::each(deg.values(), file.sigmas),
            (Of::Total, Three::One(deg)) => Self::total(deg, file.sigmas),
            (Of::Total, Three::Each(_)) => Err(StatementError::Units {
                part: Part::Axes,
                allowed: "one number of deg with of = \"total\", three with of = \"each-axis\"",
            }),
        }
    }
}

impl From<AxesStatement> for Axes {
    fn from(statement: AxesStatement) -> Self {
        let deg = Three::Each(statement.deviations.map(f64::to_degrees));
        Self { deg, sigmas: 1.0, of: Of::EachAxis }
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Mass {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    percent: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    kg: Option<f64>,
    sigmas: f64,
}

impl TryFrom<Mass> for MassStatement {
    type Error = StatementError;

    fn try_from(file: Mass) -> Result<Self, StatementError> {
        match (file.percent, file.kg) {
            (Some(x), None) => Self::percent(x, file.sigmas),
            (None, Some(x)) => Self::kg(x, file.sigmas),
            _ => Err(StatementError::Units { part: Part::Mass, allowed: "percent, kg" }),
        }
    }
}

impl From<MassStatement> for Mass {
    fn from(statement: MassStatement) -> Self {
        let (percent, kg) = match statement.amount {
            Amount::Percent([x, ..]) => (Some(x), None),
            Amount::Absolute([x, ..]) => (None, Some(x)),
        };
        Self { percent, kg, sigmas: 1.0 }
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Centre {
    mm: Three,
    sigmas: f64,
    #[serde(default)]
    arm_m: [f64; 3],
}

impl TryFrom<Centre> for CentreStatement {
    type Error = StatementError;

    fn try_from(file: Centre) -> Result<Self, StatementError> {
        Self::new(file.mm.values().map(|x| 1e-3 * x), file.sigmas, file.arm_m)
    }
}

impl From<CentreStatement> for Centre {
    fn from(statement: CentreStatement) -> Self {
        let mm = Three::Each(statement.deviations.map(|x| 1e3 * x));
        Self { mm, sigmas: 1.0, arm_m: statement.arm }
    }
}
