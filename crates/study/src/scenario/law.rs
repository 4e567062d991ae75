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

impl LawFile {
    /// The law of the value itself, of a quantity with the given nominal value; numbers in the file
    /// are in `unit`.
    pub(crate) fn about(
        &self,
        field: &str,
        nominal: f64,
        unit: f64,
    ) -> Result<ScalarLaw, ScenarioError> {
        let refused = |e: ScalarLawError| ScenarioError::field(field, e);
        let table = match self {
            Self::Sigma(sigma) => {
                return ScalarLaw::normal(nominal, sigma * unit).map_err(refused);
            }
            Self::Table(table) => table,
        };
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
            return Err(ScenarioError::field(field, problem));
        }
        if table.covariance.is_some() {
            let problem = "a covariance is for vectors, and for nothing beside it";
            return Err(ScenarioError::field(field, problem));
        }
        let needed = |name: &str, value: Option<f64>| {
            let problem = || format!("{} needs {name}", law.text());
            value.map(|x| x * unit).ok_or_else(|| ScenarioError::field(field, problem()))
        };
        if let Some(sigmas) = table.sigmas.filter(|s| !SIGMAS.contains(s)) {
            let problem = format!(
                "sigmas = {sigmas:?}: it must be between {:?} and {:?}: how many standard deviations sigma \
                 stands for",
                SIGMAS.start(),
                SIGMAS.end()
            );
            return Err(ScenarioError::field(field, problem));
        }
        let sigma = || needed("sigma", table.sigma.map(|s| s / table.sigmas.unwrap_or(1.0)));
        let mean = nominal + table.mean.unwrap_or(0.0) * unit;
        match law {
            LawName::Normal => ScalarLaw::normal(mean, sigma()?),
            LawName::Lognormal => ScalarLaw::lognormal(mean, sigma()?),
            LawName::Uniform => ScalarLaw::uniform(
                nominal + needed("low", table.low)?,
                nominal + needed("high", table.high)?,
            ),
            LawName::TruncatedNormal => ScalarLaw::truncated_normal(
                mean,
                sigma()?,
                nominal + table.low.unwrap_or(f64::NEG_INFINITY) * unit,
                nominal + table.high.unwrap_or(f64::INFINITY) * unit,
            ),
        }
        .map_err(refused)
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
        unit: f64,
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
    unit: f64,
) -> Result<VectorLaw, ScenarioError> {
    let field = format!("{field}.covariance");
    let refused = |problem: String| Err(ScenarioError::field(&field, problem));
    if nominal.len() != 3 {
        return refused(format!("it is for vectors of three components, not {}", nominal.len()));
    }
    let mut pairs = Vec::new();
    for i in 0..3 {
        if !(matrix[i][i] >= 0.0 && matrix[i][i].is_finite()) {
            let problem = "a variance must be finite and not negative";
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
    let law = |i: usize| ScalarLaw::normal(nominal[i], matrix[i][i].sqrt() * unit);
    let laws = (0..3).map(law).collect::<Result<_, _>>();
    Ok(VectorLaw { laws: laws.map_err(|e| ScenarioError::field(&field, e))?, pairs })
}
