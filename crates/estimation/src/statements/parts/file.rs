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

impl Amount {
    fn percent(self) -> Option<[f64; 3]> {
        if let Self::Percent(x) = self { Some(x) } else { None }
    }

    fn absolute(self) -> Option<[f64; 3]> {
        if let Self::Absolute(x) = self { Some(x) } else { None }
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

gyradius_dispersion::written!(
    MomentsStatement,
    |statement| {
        #[serde(default, skip_serializing_if = "Option::is_none")]
        percent: Option<Three> = statement.amount.percent().map(Three::Each),
        #[serde(default, skip_serializing_if = "Option::is_none")]
        kg_m2: Option<Three> = statement.amount.absolute().map(Three::Each),
        sigmas: f64 = 1.0,
    },
    {
        let (amount, each) = match (percent, kg_m2) {
            (Some(x), None) => (Amount::Percent(x.values()), x.each()),
            (None, Some(x)) => (Amount::Absolute(x.values()), x.each()),
            (Some(_), Some(_)) | (None, None) => {
                let allowed = "percent, kg_m2";
                return Err(StatementError::Units { part: Part::Moments, allowed }.into());
            }
        };
        MomentsStatement::written(amount, each, sigmas)?
    }
);

gyradius_dispersion::written!(
    ProductsStatement,
    |statement| { kg_m2: Three = Three::Each(statement.deviations), sigmas: f64 = 1.0, },
    ProductsStatement::written(kg_m2.values(), kg_m2.each(), sigmas)?
);

gyradius_dispersion::written!(
    AxesStatement,
    |statement| {
        deg: Three = Three::Each(statement.deviations.map(f64::to_degrees)),
        sigmas: f64 = 1.0,
        #[serde(default)]
        of: Of = Of::EachAxis,
    },
    match (of, deg) {
        (Of::EachAxis, deg) => AxesStatement::written(deg.values(), deg.each(), sigmas)?,
        (Of::Total, Three::One(deg)) => AxesStatement::total(deg, sigmas)?,
        (Of::Total, Three::Each(_)) => return Err(StatementError::ThreeOfTotal.into()),
    }
);

gyradius_dispersion::written!(
    MassStatement,
    |statement| {
        #[serde(default, skip_serializing_if = "Option::is_none")]
        percent: Option<f64> = statement.amount.percent().map(|[x, ..]| x),
        #[serde(default, skip_serializing_if = "Option::is_none")]
        kg: Option<f64> = statement.amount.absolute().map(|[x, ..]| x),
        sigmas: f64 = 1.0,
    },
    match (percent, kg) {
        (Some(x), None) => MassStatement::percent(x, sigmas)?,
        (None, Some(x)) => MassStatement::kg(x, sigmas)?,
        (Some(_), Some(_)) | (None, None) => {
            let allowed = "percent, kg";
            return Err(StatementError::Units { part: Part::Mass, allowed }.into());
        }
    }
);

gyradius_dispersion::written!(
    CentreStatement,
    |statement| {
        mm: Three = Three::Each(statement.deviations.map(|x| 1e3 * x)),
        sigmas: f64 = 1.0,
        #[serde(default)]
        arm_m: [f64; 3] = statement.arm,
    },
    {
        let (unit, values, each) = (Unit::MM, mm.values(), mm.each());
        let written = Written { part: Part::Centre, unit, values, each, sigmas };
        CentreStatement::with_arm(written.scaled(1e-3)?, arm_m)?
    }
);
