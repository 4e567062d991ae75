//! The serialized forms.

use serde::{
    Deserialize, Deserializer, Serialize,
    de::{Error, IgnoredAny, SeqAccess, Visitor},
};
use std::fmt;

use super::{
    Amount, AxesStatement, CentreStatement, MassStatement, MomentsStatement, Part,
    ProductsStatement, StatementError, Unit, Written,
};

/// One number for all three, or three.
#[derive(Clone, Copy, Serialize)]
#[serde(untagged)]
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

    fn each(self) -> bool {
        matches!(self, Self::Each(_))
    }
}

// By hand, for an untagged enum would not say what is there instead, nor which number is wrong.
impl<'de> Deserialize<'de> for Three {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ThreeVisitor)
    }
}

struct ThreeVisitor;

impl<'de> Visitor<'de> for ThreeVisitor {
    type Value = Three;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("one number, or a list of three")
    }

    fn visit_f64<E>(self, value: f64) -> Result<Three, E> {
        Ok(Three::One(value))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Three, E> {
        Ok(Three::One(value as f64))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Three, E> {
        Ok(Three::One(value as f64))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Three, A::Error> {
        let mut values = [0.0; 3];
        for (i, value) in values.iter_mut().enumerate() {
            *value = list.next_element()?.ok_or_else(|| A::Error::invalid_length(i, &self))?;
        }
        match list.next_element::<IgnoredAny>()? {
            Some(_) => Err(A::Error::custom(
                "there are more than three numbers: there must be one, or three",
            )),
            None => Ok(Three::Each(values)),
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
        let (amount, each) = match (file.percent, file.kg_m2) {
            (Some(x), None) => (Amount::Percent(x.values()), x.each()),
            (None, Some(x)) => (Amount::Absolute(x.values()), x.each()),
            (Some(_), Some(_)) | (None, None) => {
                let allowed = "percent, kg_m2";
                return Err(StatementError::Units { part: Part::Moments, allowed });
            }
        };
        Self::written(amount, each, file.sigmas)
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
        Self::written(file.kg_m2.values(), file.kg_m2.each(), file.sigmas)
    }
}

impl From<ProductsStatement> for Products {
    fn from(statement: ProductsStatement) -> Self {
        Self { kg_m2: Three::Each(statement.deviations), sigmas: 1.0 }
    }
}

#[derive(Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", try_from = "String")]
pub(super) enum Of {
    #[default]
    EachAxis,
    Total,
}

// By way of a text, for an enum would not say what is there instead.
impl TryFrom<String> for Of {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        match text.as_str() {
            "each-axis" => Ok(Self::EachAxis),
            "total" => Ok(Self::Total),
            _ => Err(format!("{text:?}: it must be \"each-axis\" or \"total\"")),
        }
    }
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
            (Of::EachAxis, deg) => Self::written(deg.values(), deg.each(), file.sigmas),
            (Of::Total, Three::One(deg)) => Self::total(deg, file.sigmas),
            (Of::Total, Three::Each(_)) => Err(StatementError::ThreeOfTotal),
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
            (Some(_), Some(_)) | (None, None) => {
                Err(StatementError::Units { part: Part::Mass, allowed: "percent, kg" })
            }
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
        let Centre { mm, sigmas, arm_m } = file;
        let (unit, values, each) = (Unit::MM, mm.values(), mm.each());
        let written = Written { part: Part::Centre, unit, values, each, sigmas };
        Self::with_arm(written.scaled(1e-3)?, arm_m)
    }
}

impl From<CentreStatement> for Centre {
    fn from(statement: CentreStatement) -> Self {
        let mm = Three::Each(statement.deviations.map(|x| 1e3 * x));
        Self { mm, sigmas: 1.0, arm_m: statement.arm }
    }
}
