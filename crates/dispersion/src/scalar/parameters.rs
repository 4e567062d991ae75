//! What a law takes in files: its keys, and their values once unit and nominal value are accounted for.

use super::ScalarLawError;

/// A key of a law.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Key {
    pub(crate) name: &'static str,
    pub(crate) of: Of,
}

impl Key {
    pub(crate) const fn new(name: &'static str, of: Of) -> Self {
        Self { name, of }
    }
}

/// What the value of a key is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Of {
    /// A value of the quantity: of a law about a nominal value, the change from it.
    Place,
    /// Several of them.
    Places,
    /// A distance between two values, not negative.
    Size,
    /// The square of a distance.
    Square,
    /// How many standard deviations `sigma` stands for.
    Sigmas,
    /// A number without unit.
    Number,
    /// The covariance of a vector, which no law of one number takes.
    Matrix,
}

/// The value of a key.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    Number(f64),
    List(Vec<f64>),
    /// Comes from files alone.
    #[cfg_attr(not(feature = "serde"), allow(dead_code, reason = "no file is read"))]
    Matrix([[f64; 3]; 3]),
}

impl From<f64> for Value {
    fn from(value: f64) -> Self {
        Self::Number(value)
    }
}

/// The values that a law is read from.
pub(crate) struct Given {
    /// The name of the law.
    pub(crate) law: &'static str,
    /// The nominal value, where the law is about one.
    pub(crate) nominal: Option<f64>,
    /// In the unit of the quantity, no longer about the nominal value.
    pub(crate) values: Vec<(&'static str, Value)>,
}

impl Given {
    fn get(&self, key: &str) -> Option<&Value> {
        self.values.iter().find(|(name, _)| *name == key).map(|(_, value)| value)
    }

    fn missing(&self, key: &'static str) -> ScalarLawError {
        ScalarLawError::Missing { law: self.law, key }
    }

    fn found(&self, key: &str) -> Option<f64> {
        if let Some(Value::Number(value)) = self.get(key) { Some(*value) } else { None }
    }

    /// What must be there.
    pub(crate) fn number(&self, key: &'static str) -> Result<f64, ScalarLawError> {
        self.found(key).ok_or_else(|| self.missing(key))
    }

    /// What has a default.
    pub(crate) fn or(&self, key: &str, default: f64) -> f64 {
        self.found(key).unwrap_or(default)
    }

    /// What is the nominal value if it is not given.
    pub(crate) fn about(&self, key: &'static str) -> Result<f64, ScalarLawError> {
        self.found(key).or(self.nominal).ok_or_else(|| self.missing(key))
    }

    /// Numbers that must be there.
    pub(crate) fn list(&self, key: &'static str) -> Result<&[f64], ScalarLawError> {
        let list = self.get(key).and_then(|v| if let Value::List(v) = v { Some(v) } else { None });
        list.map(Vec::as_slice).ok_or_else(|| self.missing(key))
    }

    /// Standard deviation and variance, of which one is given.
    pub(crate) fn spread(&self) -> Result<[f64; 2], ScalarLawError> {
        match (self.found("sigma"), self.found("variance")) {
            (Some(sigma), None) => Ok([sigma, sigma * sigma]),
            (None, Some(value)) if value >= 0.0 => Ok([value.sqrt(), value]),
            (_, Some(value)) => Err(ScalarLawError::Variance { value }),
            (None, None) => Err(self.missing("sigma")),
        }
    }
}
