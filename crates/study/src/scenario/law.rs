//! Laws of single numbers and of vectors, as they stand in a scenario file.

use gyradius_dispersion::{Correlation, CorrelationError, ScalarLaw, ScalarLawError};
use serde::{
    Deserialize, Deserializer, Serialize,
    de::{Error, MapAccess, SeqAccess, Visitor, value::MapAccessDeserializer},
};
use std::fmt;

use super::ScenarioError;

/// A law of a change from the nominal value: a number, which is the deviation of a normal law, or a
/// table.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub(crate) enum LawFile {
    Sigma(f64),
    Table(LawTable),
}

/// Laws of the components of a vector: one for all, one for each, or a covariance.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub(crate) enum VectorLawFile {
    Same(LawFile),
    Each(Vec<LawFile>),
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct LawTable {
    #[serde(default)]
    law: LawName,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sigma: Option<f64>,
    /// How many standard deviations `sigma` stands for, one if it is not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sigmas: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    mean: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    low: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    high: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    covariance: Option<[[f64; 3]; 3]>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum LawName {
    #[default]
    Normal,
    Uniform,
    TruncatedNormal,
    Lognormal,
}

impl LawName {
    fn text(self) -> &'static str {
        match self {
            Self::Normal => "law = \"normal\"",
            Self::Uniform => "law = \"uniform\"",
            Self::TruncatedNormal => "law = \"truncated-normal\"",
            Self::Lognormal => "law = \"lognormal\"",
        }
    }

    fn takes(self) -> &'static [&'static str] {
        match self {
            Self::Normal | Self::Lognormal => &["sigma", "sigmas", "mean"],
            Self::Uniform => &["low", "high"],
            Self::TruncatedNormal => &["sigma", "sigmas", "mean", "low", "high"],
        }
    }
}

/// What stands behind an error of values that are no numbers of the file.
pub(super) const CHANGES: &str =
    "sigma, mean, low and high are of the change from the nominal value";

/// What `sigmas` may be, as in statements.
const SIGMAS: std::ops::RangeInclusive<f64> = 0.1..=10.0;

struct LawVisitor;

// By hand, for an untagged enum would not say what is wrong.
impl<'de> Visitor<'de> for LawVisitor {
    type Value = LawFile;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a standard deviation, or a table with law, sigma, sigmas, mean, low, high")
    }

    fn visit_f64<E>(self, sigma: f64) -> Result<LawFile, E> {
        Ok(LawFile::Sigma(sigma))
    }

    fn visit_i64<E>(self, sigma: i64) -> Result<LawFile, E> {
        Ok(LawFile::Sigma(sigma as f64))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<LawFile, A::Error> {
        LawTable::deserialize(MapAccessDeserializer::new(map)).map(LawFile::Table)
    }
}

impl<'de> Deserialize<'de> for LawFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(LawVisitor)
    }
}

struct VectorLawVisitor;

impl<'de> Visitor<'de> for VectorLawVisitor {
    type Value = VectorLawFile;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "a standard deviation, a table with law, sigma, sigmas, mean, low, high or covariance, or a list of \
             them, one for each component",
        )
    }

    fn visit_f64<E: Error>(self, sigma: f64) -> Result<VectorLawFile, E> {
        LawVisitor.visit_f64(sigma).map(VectorLawFile::Same)
    }

    fn visit_i64<E: Error>(self, sigma: i64) -> Result<VectorLawFile, E> {
        LawVisitor.visit_i64(sigma).map(VectorLawFile::Same)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<VectorLawFile, A::Error> {
        LawVisitor.visit_map(map).map(VectorLawFile::Same)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<VectorLawFile, A::Error> {
        let mut each = Vec::new();
        while let Some(law) = seq.next_element()? {
            each.push(law);
        }
        Ok(VectorLawFile::Each(each))
    }
}

impl<'de> Deserialize<'de> for VectorLawFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(VectorLawVisitor)
    }
}

/// What the numbers of a law are in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Unit {
    /// In the unit of the quantity itself.
    size: f64,
    /// The largest number that is taken.
    most: f64,
}

impl Unit {
    /// That of the quantity itself.
    pub(crate) const OWN: Self = Self { size: 1.0, most: 1e9 };

    /// Percent of a nominal value.
    pub(crate) fn percent_of(nominal: f64) -> Self {
        Self { size: 0.01 * nominal, most: 1000.0 }
    }

    /// That a number of a law may be what it is: from `least`, in units of the most, to the most.
    fn checked(self, field: &str, value: f64, least: f64) -> Result<f64, ScenarioError> {
        let least = least * self.most;
        if (least..=self.most).contains(&value) {
            return Ok(value);
        }
        let problem = format!("{value:?}: it must be between {least:?} and {:?}", self.most);
        Err(ScenarioError::field(field, problem))
    }
}

impl LawFile {
    /// The law of the value itself, of a quantity with the given nominal value; numbers in the file
    /// are in `unit`.
    pub(crate) fn about(
        &self,
        field: &str,
        nominal: f64,
        unit: Unit,
    ) -> Result<ScalarLaw, ScenarioError> {
        let table = match self {
            Self::Sigma(sigma) => {
                let sigma = unit.checked(field, *sigma, 0.0)?;
                return ScalarLaw::normal(nominal, sigma * unit.size)
                    .map_err(|e| ScenarioError::field(field, e));
            }
            Self::Table(table) => table,
        };
        let at = |key: &str| format!("{field}.{key}");
        let law = table.law;
        let given = [
            ("sigma", table.sigma.is_some()),
            ("sigmas", table.sigmas.is_some()),
            ("mean", table.mean.is_some()),
            ("low", table.low.is_some()),
            ("high", table.high.is_some()),
        ];
        if let Some((name, _)) = given.iter().find(|(name, is)| *is && !law.takes().contains(name))
        {
            let problem = format!("{} takes {}, not {name}", law.text(), law.takes().join(", "));
            return Err(ScenarioError::field(at(name), problem));
        }
        if table.covariance.is_some() {
            let problem = "a covariance is for vectors, and for nothing beside it";
            return Err(ScenarioError::field(at("covariance"), problem));
        }
        if let Some(sigmas) = table.sigmas.filter(|s| !SIGMAS.contains(s)) {
            let problem = format!(
                "{sigmas:?}: it must be between {:?} and {:?}: how many standard deviations sigma stands for",
                SIGMAS.start(),
                SIGMAS.end()
            );
            return Err(ScenarioError::field(at("sigmas"), problem));
        }
        let number = |key: &str, value: Option<f64>, least: f64| {
            value.map(|value| unit.checked(&at(key), value, least)).transpose()
        };
        let [sigma, mean] = [number("sigma", table.sigma, 0.0)?, number("mean", table.mean, -1.0)?];
        let [low, high] = [number("low", table.low, -1.0)?, number("high", table.high, -1.0)?];
        if let (Some(low), Some(high)) = (low, high)
            && low > high
        {
            let problem = format!("{high:?}: it must not be below low, which is {low:?}");
            return Err(ScenarioError::field(at("high"), problem));
        }
        let needed = |key: &str, value: Option<f64>| {
            let problem = || {
                let or = if law == LawName::Normal { ", or, of a vector, covariance" } else { "" };
                format!("missing: {} needs {key}{or}", law.text())
            };
            value.map(|x| x * unit.size).ok_or_else(|| ScenarioError::field(at(key), problem()))
        };
        let sigma = || needed("sigma", sigma.map(|s| s / table.sigmas.unwrap_or(1.0)));
        let mean = nominal + mean.unwrap_or(0.0) * unit.size;
        match law {
            LawName::Normal => ScalarLaw::normal(mean, sigma()?),
            LawName::Lognormal => ScalarLaw::lognormal(mean, sigma()?),
            LawName::Uniform => {
                ScalarLaw::uniform(nominal + needed("low", low)?, nominal + needed("high", high)?)
            }
            LawName::TruncatedNormal => ScalarLaw::truncated_normal(
                mean,
                sigma()?,
                nominal + low.unwrap_or(f64::NEG_INFINITY) * unit.size,
                nominal + high.unwrap_or(f64::INFINITY) * unit.size,
            ),
        }
        .map_err(|error| {
            let key = match error {
                ScalarLawError::NotPositive { .. } => "mean",
                ScalarLawError::Bounds { .. } => "high",
                ScalarLawError::Deviation { .. } => "sigma",
                _ => return ScenarioError::field(field, format!("{error}; {CHANGES}")),
            };
            ScenarioError::field(at(key), format!("{error}; {CHANGES}"))
        })
    }

    fn covariance(&self) -> Option<[[f64; 3]; 3]> {
        match self {
            Self::Table(LawTable {
                law: LawName::Normal,
                sigma: None,
                sigmas: None,
                mean: None,
                low: None,
                high: None,
                covariance,
            }) => *covariance,
            _ => None,
        }
    }
}

/// Laws of the components of a vector, and the correlations of pairs of them.
pub(crate) struct VectorLaw {
    pub(crate) laws: Vec<ScalarLaw>,
    pub(crate) pairs: Vec<(usize, usize, f64)>,
}

impl VectorLawFile {
    pub(crate) fn about(
        &self,
        field: &str,
        nominal: &[f64],
        unit: Unit,
    ) -> Result<VectorLaw, ScenarioError> {
        let each = match self {
            Self::Same(law) => match law.covariance() {
                Some(matrix) => return covariance(field, &matrix, nominal, unit),
                None => vec![law; nominal.len()],
            },
            Self::Each(laws) if laws.len() == nominal.len() => laws.iter().collect(),
            Self::Each(laws) => {
                let problem = format!(
                    "{} laws: it must be one for all components or {}, one for each",
                    laws.len(),
                    nominal.len()
                );
                return Err(ScenarioError::field(field, problem));
            }
        };
        let laws = each.iter().zip(nominal).enumerate().map(|(i, (law, nominal))| {
            let field = match self {
                Self::Same(_) => field.to_owned(),
                Self::Each(_) => format!("{field}[{}]", i + 1),
            };
            law.about(&field, *nominal, unit)
        });
        Ok(VectorLaw { laws: laws.collect::<Result<_, _>>()?, pairs: Vec::new() })
    }
}

fn covariance(
    field: &str,
    matrix: &[[f64; 3]; 3],
    nominal: &[f64],
    unit: Unit,
) -> Result<VectorLaw, ScenarioError> {
    let field = format!("{field}.covariance");
    let refused = |problem: String| Err(ScenarioError::field(&field, problem));
    if nominal.len() != 3 {
        return refused(format!("it is for vectors of three components, not {}", nominal.len()));
    }
    let mut pairs = Vec::new();
    for i in 0..3 {
        if !(0.0..=unit.most * unit.most).contains(&matrix[i][i]) {
            let problem = format!("a variance must be between 0 and {:e}", unit.most * unit.most);
            return refused(format!("entry ({0}, {0}) = {1:?}: {problem}", i + 1, matrix[i][i]));
        }
        for j in 0..i {
            let (a, b) = (matrix[i][j], matrix[j][i]);
            let size = matrix[i][i].sqrt() * matrix[j][j].sqrt();
            if !((a - b).abs() <= 1e-9 * size) {
                return refused(format!(
                    "entries ({0}, {1}) = {a:?} and ({1}, {0}) = {b:?}: the matrix must be symmetric",
                    i + 1,
                    j + 1
                ));
            }
            if size == 0.0 && a != 0.0 {
                return refused(format!(
                    "entry ({}, {}) = {a:?}: what does not vary covaries with nothing",
                    i + 1,
                    j + 1
                ));
            }
            if a != 0.0 {
                let coefficient = 0.5 * (a / size + b / size);
                // Rounding of the file's digits.
                let over = coefficient.abs() > 1.0 && coefficient.abs() < 1.0 + 1e-9;
                let coefficient = if over { coefficient.signum() } else { coefficient };
                pairs.push((j, i, coefficient));
            }
        }
    }
    if let Err(error) = Correlation::new(&pairs) {
        let entry = |pair: usize| {
            let (i, j, _) = pairs[pair];
            format!("entry ({}, {})", i + 1, j + 1)
        };
        return refused(match error {
            CorrelationError::Coefficient { pair, .. } => {
                format!("{}: it is larger than its two variances allow", entry(pair))
            }
            CorrelationError::Indefinite { pair, eigenvalue, .. } => format!(
                "{} contradicts the others: the correlations have an eigenvalue of {eigenvalue:.3}, and \
                 none may be negative",
                entry(pair)
            ),
            other => other.to_string(),
        });
    }
    let law = |i: usize| ScalarLaw::normal(nominal[i], matrix[i][i].sqrt() * unit.size);
    let laws = (0..3).map(law).collect::<Result<_, _>>();
    Ok(VectorLaw { laws: laws.map_err(|e| ScenarioError::field(&field, e))?, pairs })
}
