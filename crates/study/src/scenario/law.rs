//! Laws of single numbers and of vectors, as they stand in a scenario file.

use gyradius_dispersion::{
    Correlation, CorrelationProblem, LawUnit, ScalarLaw, ScalarLawForm, ScalarLawFormError,
};
use serde::{
    Deserialize, Deserializer, Serialize,
    de::{Error, IntoDeserializer, MapAccess, SeqAccess, Visitor, value::MapAccessDeserializer},
};
use std::fmt;

use super::{ScenarioError, each::Each, parse::whole_numbers, scalar::ScalarLawFile};

/// Laws of the components of a vector: one for all, one for each, or a covariance.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub(crate) enum VectorLawFile {
    Same(ScalarLawFile),
    Each(Vec<ScalarLawFile>),
}

/// What a file says of a parameter: a law of a number, in its unit or in percent, or of a vector.
#[derive(Clone, Copy)]
pub(crate) enum GivenLaw<'a> {
    Number(Option<&'a ScalarLawFile>, Option<&'a ScalarLawFile>),
    Vector(Option<&'a VectorLawFile>),
}

struct VectorLawVisitor;

impl<'de> Visitor<'de> for VectorLawVisitor {
    type Value = VectorLawFile;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "a standard deviation, a table with law, sigma, sigmas, mean, low, high, drawn or covariance, or a list of \
             them, one for each component",
        )
    }

    fn visit_f64<E: Error>(self, sigma: f64) -> Result<VectorLawFile, E> {
        ScalarLawFile::deserialize(sigma.into_deserializer()).map(VectorLawFile::Same)
    }

    whole_numbers!();

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<VectorLawFile, A::Error> {
        ScalarLawFile::deserialize(MapAccessDeserializer::new(map)).map(VectorLawFile::Same)
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

/// A refusal at its key below a field.
pub(crate) fn refused(field: &str, error: &ScalarLawFormError) -> ScenarioError {
    match error.key {
        Some(key) => ScenarioError::field(format!("{field}.{key}"), &error.problem),
        None => ScenarioError::field(field, &error.problem),
    }
}

/// The law of the value itself, of a quantity with the given nominal value; numbers in the file are in `unit`.
pub(super) fn about(
    law: &ScalarLawForm,
    field: &str,
    nominal: f64,
    unit: LawUnit,
) -> Result<ScalarLaw, ScenarioError> {
    law.about(nominal, unit).map_err(|error| refused(field, &error))
}

/// Laws of the components of a vector, and the correlations of pairs of them.
pub(crate) struct VectorLaw {
    pub(crate) laws: Vec<ScalarLaw>,
    pub(crate) pairs: Vec<(usize, usize, f64)>,
}

impl VectorLawFile {
    /// The law of a component, for what it is drawn, and its key, of a vector whose key is `field`.
    pub(crate) fn component(
        &self,
        field: &str,
        component: usize,
    ) -> (Option<&ScalarLawForm>, Each, String) {
        match self {
            Self::Same(law) => (Some(&law.form), law.drawn, field.to_owned()),
            Self::Each(laws) => {
                let law = laws.get(component);
                let drawn = law.map_or_else(Each::default, |law| law.drawn);
                (law.map(|law| &law.form), drawn, format!("{field}[{}]", component + 1))
            }
        }
    }

    pub(crate) fn about(
        &self,
        field: &str,
        nominal: &[f64],
        unit: LawUnit,
    ) -> Result<VectorLaw, ScenarioError> {
        let each = match self {
            Self::Same(law) => match law.form.covariance() {
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
        let could_covary = matches!(self, Self::Same(_)) && nominal.len() == 3;
        let laws = each.iter().zip(nominal).enumerate().map(|(i, (law, nominal))| {
            let law = if could_covary {
                law.form.about_component(*nominal, unit)
            } else {
                law.form.about(*nominal, unit)
            };
            law.map_err(|error| refused(&self.component(field, i).2, &error))
        });
        Ok(VectorLaw { laws: laws.collect::<Result<_, _>>()?, pairs: Vec::new() })
    }
}

fn covariance(
    field: &str,
    matrix: &[[f64; 3]; 3],
    nominal: &[f64],
    unit: LawUnit,
) -> Result<VectorLaw, ScenarioError> {
    let field = format!("{field}.covariance");
    let refused = |problem: String| Err(ScenarioError::field(&field, problem));
    if nominal.len() != 3 {
        return refused(format!("it is for vectors of three components, not {}", nominal.len()));
    }
    let mut pairs = Vec::new();
    for i in 0..3 {
        if !(0.0..=unit.most() * unit.most()).contains(&matrix[i][i]) {
            let problem =
                format!("a variance must be between 0 and {:e}", unit.most() * unit.most());
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
        let [i, j] = error.quantities;
        let entry = format!("entry ({}, {})", i + 1, j + 1);
        return refused(match error.problem {
            CorrelationProblem::Coefficient { .. } => {
                format!("{entry}: it is larger than its two variances allow")
            }
            CorrelationProblem::Indefinite { eigenvalue, .. } => format!(
                "{entry} contradicts the others: the correlations have an eigenvalue of {eigenvalue:.3}, and \
                 none may be negative"
            ),
            other => format!("{entry}: {other}"),
        });
    }
    let law = |i: usize| ScalarLaw::normal(nominal[i], matrix[i][i].sqrt() * unit.size());
    let laws = (0..3).map(law).collect::<Result<_, _>>();
    Ok(VectorLaw { laws: laws.map_err(|e| ScenarioError::field(&field, e))?, pairs })
}
