//! Scalar laws as they stand in files: in scenarios, fragments and JSON.

use super::parameters::{Given, Of, Value};
use super::{ScalarLaw, ScalarLawError, allowed};

/// A law of one number as it stands in a file: a number, which is the standard deviation of a normal law, or a
/// table with `law` (`"normal"` if it is not given) and the keys of the law.
///
/// It is checked where it becomes a [`ScalarLaw`]: [`about`](Self::about) a nominal value, or by `try_from` where the
/// numbers are those of the quantity itself.
///
/// ```
/// # #[cfg(feature = "serde")]
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// use gyradius_dispersion::{LawUnit, ScalarLaw, ScalarLawForm};
///
/// let law: ScalarLawForm = serde_json::from_str(r#"{ "law": "triangular", "low": -1.0, "high": 2.0 }"#)?;
/// assert_eq!(law.about(10.0, LawUnit::OWN)?, ScalarLaw::triangular(9.0, 10.0, 12.0)?);
/// assert!(ScalarLaw::try_from(law).unwrap_err().to_string().contains("needs mode"));
/// # Ok(())
/// # }
/// # #[cfg(not(feature = "serde"))]
/// # fn main() {}
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ScalarLawForm {
    law: &'static Declaration,
    /// As given, in the order of the law's keys where it takes them.
    values: Vec<(&'static str, Value)>,
    /// Whether it is a number alone.
    bare: bool,
}

/// What is declared of a law.
pub(super) struct Declaration {
    pub(super) name: &'static str,
    pub(super) keys: &'static [super::parameters::Key],
    pub(super) quantity: bool,
    pub(super) read: fn(&Given) -> Result<ScalarLaw, ScalarLawError>,
}

impl PartialEq for Declaration {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl std::fmt::Debug for Declaration {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

impl Declaration {
    fn key(&self, name: &str) -> Option<Of> {
        self.keys.iter().find(|key| key.name == name).map(|key| key.of)
    }

    /// Which of its keys are of the change from a nominal value, in words.
    pub(super) fn changes(&self) -> String {
        let of = [Of::Place, Of::Places, Of::Size, Of::Square];
        let keys: Vec<_> =
            self.keys.iter().filter(|key| of.contains(&key.of)).map(|key| key.name).collect();
        format!("{}: of the change from the nominal value", keys.join(", "))
    }

    /// What it takes, in words.
    fn takes(&self) -> String {
        self.keys.iter().map(|key| key.name).collect::<Vec<_>>().join(", ")
    }
}

/// What the numbers of a law about a nominal value are in.
#[derive(Clone, Copy, Debug, PartialEq, getset::CopyGetters)]
#[getset(get_copy = "pub")]
pub struct LawUnit {
    /// In the unit of the quantity itself.
    size: f64,
    /// The largest number that is taken.
    most: f64,
}

impl LawUnit {
    /// That of the quantity itself, with numbers up to 1e9.
    pub const OWN: Self = Self { size: 1.0, most: 1e9 };

    /// Percent of a nominal value, up to 1000.
    #[must_use]
    pub fn percent_of(nominal: f64) -> Self {
        Self { size: 0.01 * nominal, most: 1000.0 }
    }

    /// One that is so many of that of the quantity itself, with numbers up to 1e9.
    #[must_use]
    pub fn of(size: f64) -> Self {
        Self { size, ..Self::OWN }
    }
}

/// What `sigmas` may be, as in statements.
const SIGMAS: [f64; 2] = [0.1, 10.0];

impl ScalarLawForm {
    /// The law of a quantity with this nominal value, of which the numbers say the change in `unit`.
    ///
    /// # Errors
    /// A key is missing or not one of the law's, or its value is not allowed.
    pub fn about(&self, nominal: f64, unit: LawUnit) -> Result<ScalarLaw, ScalarLawFormError> {
        if !self.law.quantity {
            let problem = format!("{:?}: it is of an event, not of a quantity", self.law.name);
            return Err(ScalarLawFormError { key: Some("law"), problem });
        }
        self.read(Some(nominal), unit).map_err(|mut error| {
            if error.made {
                error.inner.problem = format!("{}; {}", error.inner.problem, self.law.changes());
            }
            error.inner
        })
    }

    /// The same of a component of a vector, all of whose three components have this law: a covariance of them could stand in its place,
    /// and a refusal says so.
    ///
    /// # Errors
    /// As [`about`](Self::about).
    pub fn about_component(
        &self,
        nominal: f64,
        unit: LawUnit,
    ) -> Result<ScalarLaw, ScalarLawFormError> {
        self.about(nominal, unit).map_err(|mut error| {
            let is_missing =
                error.key == Some("sigma") && self.values.iter().all(|(key, _)| *key != "sigma");
            if is_missing && self.law.key("covariance").is_some() {
                error.problem += ", or, as the law of all three components of a vector, covariance";
            }
            error
        })
    }

    /// The covariance of a vector, if that is all it says.
    #[must_use]
    pub fn covariance(&self) -> Option<[[f64; 3]; 3]> {
        match self.values[..] {
            [(_, Value::Matrix(covariance))] => Some(covariance),
            [..] => None,
        }
    }

    /// The same law, of values greater by `by`, to twelve digits. A key that alone says where it lies, as `low` of a Weibull law, is stated then.
    #[must_use]
    pub fn moved(&self, by: f64) -> Self {
        let place = |x: f64| {
            let digits = 11 - x.abs().max(by.abs()).log10().floor().clamp(-290.0, 11.0) as i32;
            let scale = 10_f64.powi(digits);
            // No sign before a zero.
            ((x + by) * scale).round() / scale + 0.0
        };
        let is_place = |of: Of| matches!(of, Of::Place | Of::Places);
        let is_at = |key: &str| self.law.key(key).is_some_and(is_place);
        let mut moved = Self { bare: false, ..self.clone() };
        for (key, value) in &mut moved.values {
            match value {
                Value::Number(x) if is_at(key) => *x = place(*x),
                Value::List(all) if is_at(key) => all.iter_mut().for_each(|x| *x = place(*x)),
                Value::Number(_) | Value::List(_) | Value::Matrix(_) => {}
            }
        }
        let mut places = self.law.keys.iter().filter(|key| is_place(key.of));
        if let (Some(only), None) = (places.next(), places.next())
            && self.values.iter().all(|(key, _)| *key != only.name)
        {
            moved.values.push((only.name, place(0.0).into()));
        }
        moved
    }

    fn read(&self, nominal: Option<f64>, unit: LawUnit) -> Result<ScalarLaw, Refused> {
        let refused = |key, problem: String| Refused {
            inner: ScalarLawFormError { key: Some(key), problem },
            made: false,
        };
        let law = self.law;
        let mut given = Vec::new();
        for (key, value) in &self.values {
            let Some(of) = law.key(key) else {
                let problem = format!("law = {:?} takes {}, not {key}", law.name, law.takes());
                return Err(refused(key, problem));
            };
            given.push((*key, of, value));
        }
        let most = unit.most;
        let checked = |key: &'static str, value: f64, [low, high]: [f64; 2]| {
            if (low..=high).contains(&value) {
                return Ok(value);
            }
            let more = if key == "sigmas" {
                ": how many standard deviations sigma stands for"
            } else {
                ""
            };
            let problem = format!("{value:?}: it must be {}{more}", allowed(low, high));
            let key = if self.bare { None } else { Some(key) };
            Err(Refused { inner: ScalarLawFormError { key, problem }, made: false })
        };
        let number = |key: &str| {
            self.values.iter().find_map(|(name, value)| match value {
                Value::Number(value) if *name == key => Some(*value),
                Value::Number(_) | Value::List(_) | Value::Matrix(_) => None,
            })
        };
        let origin = nominal.unwrap_or(0.0);
        let mut values = Vec::new();
        for (key, of, value) in &given {
            let place = |x: f64| checked(key, x, [-most, most]).map(|x| origin + x * unit.size);
            let value = match value {
                Value::Matrix(_) => {
                    let problem = "a covariance is for the three components of a vector together: it is not for a single number, nor in a list, and no \
                                   other key stands beside it";
                    return Err(refused(key, problem.to_owned()));
                }
                Value::List(all) => {
                    Value::List(all.iter().map(|x| place(*x)).collect::<Result<_, _>>()?)
                }
                Value::Number(x) => match of {
                    Of::Place | Of::Places => place(*x)?.into(),
                    Of::Size => {
                        let x = checked(key, *x, [0.0, most])?;
                        let sigmas = number("sigmas").filter(|_| *key == "sigma");
                        (x / sigmas.unwrap_or(1.0) * unit.size).into()
                    }
                    Of::Square => {
                        (checked(key, *x, [0.0, most * most])? * unit.size * unit.size).into()
                    }
                    Of::Sigmas => {
                        checked(key, *x, SIGMAS)?;
                        if number("variance").is_some() {
                            let problem = "it goes with sigma, not with variance";
                            return Err(refused(key, problem.to_owned()));
                        }
                        continue;
                    }
                    Of::Number | Of::Matrix => (*x).into(),
                },
            };
            values.push((*key, value));
        }
        if let (Some(low), Some(high)) = (number("low"), number("high"))
            && low > high
        {
            let problem = format!("{high:?}: it must not be below low, which is {low:?}");
            return Err(refused("high", problem));
        }
        let given = Given { law: law.name, nominal, values };
        (law.read)(&given).map_err(|error| {
            let missing = matches!(error, ScalarLawError::Missing { .. });
            let or_variance =
                missing && error.key() == Some("sigma") && law.key("variance").is_some();
            let problem = format!("{error}{}", if or_variance { " or variance" } else { "" });
            let key = if self.bare { None } else { error.key() };
            Refused { inner: ScalarLawFormError { key, problem }, made: !missing && !self.bare }
        })
    }
}

/// A refusal, and whether it is of values that are no numbers of the file.
struct Refused {
    inner: ScalarLawFormError,
    made: bool,
}

/// Why what stands in a file is no law.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}{problem}", key.map(|key| format!("{key}: ")).unwrap_or_default())]
pub struct ScalarLawFormError {
    /// The key, if it is one alone.
    pub key: Option<&'static str>,
    /// The value and what is allowed.
    pub problem: String,
}

/// The law whose numbers are those of the quantity itself.
impl TryFrom<ScalarLawForm> for ScalarLaw {
    type Error = ScalarLawFormError;

    fn try_from(form: ScalarLawForm) -> Result<Self, Self::Error> {
        form.read(None, LawUnit { size: 1.0, most: f64::INFINITY }).map_err(|error| error.inner)
    }
}

impl From<ScalarLaw> for ScalarLawForm {
    fn from(law: ScalarLaw) -> Self {
        Self { law: law.declaration(), values: law.0.values(), bare: false }
    }
}

/// As an inline table of TOML.
impl std::fmt::Display for ScalarLawForm {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if let (true, [(_, Value::Number(sigma))]) = (self.bare, &self.values[..]) {
            return write!(f, "{sigma:?}");
        }
        write!(f, "{{ law = {:?}", self.law.name)?;
        for (key, value) in &self.values {
            match value {
                Value::Number(x) => write!(f, ", {key} = {x:?}")?,
                Value::List(all) => write!(f, ", {key} = {all:?}")?,
                Value::Matrix(rows) => write!(f, ", {key} = {rows:?}")?,
            }
        }
        f.write_str(" }")
    }
}

/// As in files: an inline table of TOML.
///
/// ```
/// use gyradius_dispersion::ScalarLaw;
///
/// assert_eq!(ScalarLaw::normal(2.0, 0.1)?.to_string(), "{ law = \"normal\", sigma = 0.1, mean = 2.0 }");
/// # Ok::<(), gyradius_dispersion::ScalarLawError>(())
/// ```
impl std::fmt::Display for ScalarLaw {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        ScalarLawForm::from(self.clone()).fmt(f)
    }
}

#[cfg(feature = "serde")]
mod file {
    use super::{Declaration, Of, ScalarLawForm, Value};
    use crate::scalar::laws::DECLARATIONS;
    use serde::de::{Deserialize, Deserializer, Error, MapAccess, Visitor};
    use serde::ser::{Serialize, SerializeMap, Serializer};
    use std::fmt;

    fn names(all: impl Iterator<Item = &'static str>) -> String {
        all.map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
    }

    /// The keys of all laws.
    fn keys() -> impl Iterator<Item = &'static super::super::parameters::Key> {
        DECLARATIONS.iter().flat_map(|law| law.keys)
    }

    impl ScalarLawForm {
        /// Every key that the table of a law may have, each once: for formats that add keys of their own to it.
        pub fn keys() -> impl Iterator<Item = &'static str> {
            let mut all = vec!["law"];
            for key in keys() {
                if !all.contains(&key.name) {
                    all.push(key.name);
                }
            }
            all.into_iter()
        }
    }

    impl<'de> Deserialize<'de> for &'static Declaration {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            let name = String::deserialize(deserializer)?;
            DECLARATIONS.iter().find(|law| law.name == name).ok_or_else(|| {
                let all = names(DECLARATIONS.iter().map(|law| law.name));
                D::Error::custom(format!("unknown law `{name}`, expected one of {all}"))
            })
        }
    }

    struct FormVisitor;

    impl<'de> Visitor<'de> for FormVisitor {
        type Value = ScalarLawForm;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("a standard deviation, or a table with law, sigma, sigmas, mean, low, high")
        }

        fn visit_f64<E>(self, sigma: f64) -> Result<ScalarLawForm, E> {
            let values = vec![("sigma", sigma.into())];
            Ok(ScalarLawForm { law: &DECLARATIONS[0], values, bare: true })
        }

        fn visit_i64<E: Error>(self, sigma: i64) -> Result<ScalarLawForm, E> {
            self.visit_f64(sigma as f64)
        }

        fn visit_u64<E: Error>(self, sigma: u64) -> Result<ScalarLawForm, E> {
            self.visit_f64(sigma as f64)
        }

        fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<ScalarLawForm, A::Error> {
            let (mut law, mut values) = (None, Vec::new());
            while let Some(name) = map.next_key::<String>()? {
                if name == "law" {
                    if law.replace(map.next_value()?).is_some() {
                        return Err(A::Error::duplicate_field("law"));
                    }
                    continue;
                }
                let Some(key) = keys().find(|key| key.name == name) else {
                    let all = names(ScalarLawForm::keys());
                    let problem = format!("unknown field `{name}`, expected one of {all}");
                    return Err(A::Error::custom(problem));
                };
                if values.iter().any(|(name, _)| *name == key.name) {
                    return Err(A::Error::duplicate_field(key.name));
                }
                let value = match key.of {
                    Of::Place | Of::Size | Of::Square | Of::Sigmas | Of::Number => {
                        Value::Number(map.next_value()?)
                    }
                    Of::Places => Value::List(map.next_value()?),
                    Of::Matrix => Value::Matrix(map.next_value()?),
                };
                values.push((key.name, value));
            }
            let law: &Declaration = law.unwrap_or(&DECLARATIONS[0]);
            let at = |name: &str| law.keys.iter().position(|key| key.name == name);
            values.sort_by_key(|(name, _)| at(name));
            Ok(ScalarLawForm { law, values, bare: false })
        }
    }

    impl<'de> Deserialize<'de> for ScalarLawForm {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            deserializer.deserialize_any(FormVisitor)
        }
    }

    impl Serialize for ScalarLawForm {
        fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            if let (true, [(_, Value::Number(sigma))]) = (self.bare, &self.values[..]) {
                return serializer.serialize_f64(*sigma);
            }
            let mut map = serializer.serialize_map(Some(1 + self.values.len()))?;
            map.serialize_entry("law", self.law.name)?;
            for (key, value) in &self.values {
                match value {
                    Value::Number(x) => map.serialize_entry(key, x)?,
                    Value::List(all) => map.serialize_entry(key, all)?,
                    Value::Matrix(rows) => map.serialize_entry(key, rows)?,
                }
            }
            map.end()
        }
    }
}

#[cfg(all(test, feature = "serde"))]
mod tests {
    use super::*;

    /// A key that stands twice is refused, whichever it is and of whichever law, with other keys between or without.
    #[test]
    fn keys_stand_once() {
        for (law, _) in crate::scalar::laws::examples() {
            let serde_json::Value::Object(written) = serde_json::to_value(&law).unwrap() else {
                unreachable!("a table")
            };
            let entry = |(key, value): (&String, &serde_json::Value)| format!("\"{key}\":{value}");
            let all: Vec<String> = written.iter().map(entry).collect();
            let read = |entries: &[String]| {
                serde_json::from_str::<ScalarLaw>(&format!("{{{}}}", entries.join(",")))
            };
            assert_eq!(read(&all).unwrap(), law);
            for (i, key) in written.keys().enumerate() {
                for place in 0..=all.len() {
                    let mut twice = all.clone();
                    twice.insert(place, all[i].clone());
                    let refused = read(&twice).unwrap_err().to_string();
                    assert!(refused.contains(&format!("duplicate field `{key}`")), "{refused}");
                }
            }
        }
    }

    /// A covariance is named where a law could have one: of three components at once.
    #[test]
    fn a_covariance_is_named_where_it_may_stand() {
        let form = |text: &str| serde_json::from_str::<ScalarLawForm>(text).unwrap();
        let normal = form(r#"{"law":"normal"}"#);
        let single = normal.about(1.0, LawUnit::OWN).unwrap_err().to_string();
        assert!(single.ends_with("needs sigma or variance"), "{single}");
        let of_vector = normal.about_component(1.0, LawUnit::OWN).unwrap_err().to_string();
        assert!(
            of_vector.ends_with(
                "needs sigma or variance, or, as the law of all three components of a vector, covariance"
            ),
            "{of_vector}"
        );
        // Where another law lacks its sigma, or sigma is wrong, a covariance is no way out.
        for text in [
            r#"{"law":"normal","sigma":-1.0}"#,
            r#"{"law":"truncated-normal","low":0.0,"high":1.0}"#,
        ] {
            let refused = form(text).about_component(1.0, LawUnit::OWN).unwrap_err().to_string();
            assert!(!refused.contains("covariance"), "{refused}");
        }
    }
}
