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

/// The number of another unit that is read as `value` to the bit, which is next to the one that conversion gives if there is one.
///
/// There always is one of an angle, for all angles were read in degrees. Of lengths in mm one in forty is stepped over.
fn in_unit(value: f64, converted: f64, read: impl Fn(f64) -> f64) -> f64 {
    let (up, down) = (converted.next_up(), converted.next_down());
    let near = [converted, up, down, up.next_up(), down.next_down()];
    near.into_iter().find(|near| read(*near) == value).unwrap_or(converted)
}

/// mm that are read as this length in m.
fn in_mm(metres: f64) -> f64 {
    in_unit(metres, 1e3 * metres, |mm| 1e-3 * mm)
}

/// Degrees that are read as this angle in rad.
fn in_degrees(angle: f64) -> f64 {
    in_unit(angle, angle.to_degrees(), f64::to_radians)
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
        deg: Three = Three::Each(statement.deviations.map(in_degrees)),
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
        mm: Three = Three::Each(statement.deviations.map(in_mm)),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Statements;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn again(statements: &Statements) -> Statements {
        serde_json::from_str(&serde_json::to_string(statements).unwrap()).unwrap()
    }

    /// 20,000 of them, from tiny ones to the largest, for any number of deviations.
    #[test]
    fn statements_read_back_to_the_bit() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let (mut centres, mut off) = (0, 0);
        for _ in 0..20_000 {
            let mut three = |most: f64| {
                let decades = rng.random_range(-12.0..0.0);
                let share = libm::pow(10.0, decades);
                [0; 3].map(|_| most * share * rng.random_range(0.0..1.0_f64))
            };
            let (percent, kg_m2, deg, metres) = (three(1e2), three(1e3), three(4.5), three(1e3));
            let (total, sigmas) = (three(7.5)[0], 0.1 + 0.99 * three(10.0)[0]);
            let each = AxesStatement::each(deg, sigmas).unwrap();
            let said = Statements {
                moments: MomentsStatement::new(Amount::Percent(percent), sigmas).ok(),
                products: ProductsStatement::new(kg_m2, sigmas).ok(),
                axes: Some(each),
                mass: MassStatement::kg(kg_m2[0], sigmas).ok(),
                centre: None,
            };
            assert_eq!(again(&said), said);
            let said = Statements {
                moments: MomentsStatement::new(Amount::Absolute(kg_m2), sigmas).ok(),
                axes: AxesStatement::total(total, sigmas).ok(),
                mass: MassStatement::percent(0.1 * percent[0], sigmas).ok(),
                ..Statements::default()
            };
            assert_eq!(again(&said), said);
            // As files have it, in mm.
            let json = format!("{{\"mm\":{:?},\"sigmas\":{sigmas:?}}}", metres.map(|x| 1e3 * x));
            let read: CentreStatement = serde_json::from_str(&json).unwrap();
            let of_m = CentreStatement::new(metres, sigmas, [0.1, -0.2, 1e5]).unwrap();
            for said in [read, of_m] {
                let back = again(&Statements { centre: Some(said), ..Statements::default() });
                let pairs = said.deviations.into_iter().zip(back.centre.unwrap().deviations);
                for (a, b) in pairs {
                    centres += 1;
                    off += u32::from(a != b);
                    assert!((a - b).abs() <= f64::EPSILON * a);
                }
                assert_eq!(back.centre.unwrap().arm, said.arm);
            }
        }
        // Lengths that no number of mm is read as.
        assert!(
            (0.02..0.03).contains(&(f64::from(off) / f64::from(centres))),
            "{off} of {centres}"
        );
    }

    /// What a person writes is written as he wrote it.
    #[test]
    fn round_numbers_stay_round() {
        for n in 1..=1000 {
            let mm = 0.1 * f64::from(n);
            let json = format!("{{\"mm\":[{mm:?},0.0,1.0],\"sigmas\":1.0}}");
            let read: CentreStatement = serde_json::from_str(&json).unwrap();
            let written = serde_json::to_value(read).unwrap();
            let found = written["mm"][0].as_f64().unwrap();
            assert!((found - mm).abs() <= f64::EPSILON * mm, "{mm} {found}");
        }
    }
}
