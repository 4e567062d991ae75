use super::{
    ScenarioError, check_name,
    file::{AxesFile as Axes, ComparisonFile, LawFile, ModelFile},
};

/// A model as the scenario describes it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ModelSpec {
    pub(crate) name: String,
    pub(crate) law: Law,
}

/// A law of inertia.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Law {
    /// Gaussian roots of the second moments; axes from the radially constrained Gaussian.
    Principal(Axes),
    /// Independent Gaussian entries with given deviations of payload and stage, in the order
    /// I11, I22, I33, I12, I13, I23, kg·m².
    Entrywise { payload: [f64; 6], stage: [f64; 6] },
    /// Independent Gaussian entries with the deviations of a principal model.
    EntrywiseMatched(String),
}

/// A physical model and the naive one that it is set against.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Comparison {
    pub(crate) title: String,
    /// Indices into the models.
    pub(crate) physical: usize,
    pub(crate) naive: usize,
}

pub(crate) fn check_models(files: &[ModelFile]) -> Result<Vec<ModelSpec>, ScenarioError> {
    if files.is_empty() {
        return Err(ScenarioError::field("models", "none: there must be at least one"));
    }
    for (i, file) in files.iter().enumerate() {
        check_name(&format!("models[{}].name", i + 1), &file.name)?;
        // Some file systems do not tell upper from lower case.
        if files[..i].iter().any(|other| other.name.eq_ignore_ascii_case(&file.name)) {
            let problem =
                format!("two are named {:?}: names must differ in more than case", file.name);
            return Err(ScenarioError::field("models", problem));
        }
    }
    files.iter().map(|file| check_model(file, files)).collect()
}

fn check_model(file: &ModelFile, all: &[ModelFile]) -> Result<ModelSpec, ScenarioError> {
    let place = format!("models.{}", file.name);
    let fail = |problem: &str| Err(ScenarioError::field(place.clone(), problem));
    let deviations = (file.payload_deviation_kg_m2, file.stage_deviation_kg_m2);
    let law = match (file.law, file.axes, deviations, &file.matched_to) {
        (LawFile::Principal, Some(axes), (None, None), None) => Law::Principal(axes),
        (LawFile::Principal, None, ..) => {
            return fail(
                "law \"principal\" needs axes: \"whole-sphere\", \"mean-half\" or \"jacobian-twice\"",
            );
        }
        (LawFile::Principal, ..) => {
            return fail(
                "law \"principal\" takes axes and nothing else: its variances are those of \
                         payload.dispersion and stage.dispersion",
            );
        }
        (LawFile::Entrywise, None, (Some(payload), Some(stage)), None) => Law::Entrywise {
            payload: entries(&format!("{place}.payload_deviation_kg_m2"), &payload)?,
            stage: entries(&format!("{place}.stage_deviation_kg_m2"), &stage)?,
        },
        (LawFile::Entrywise, None, (None, None), Some(other)) => {
            let matchable = |m: &ModelFile| {
                m.name == *other && m.law == LawFile::Principal && m.axes == Some(Axes::WholeSphere)
            };
            if !all.iter().any(matchable) {
                let problem = format!(
                    "{other:?}: it must name a model with law \"principal\" and axes \
                     \"whole-sphere\", whose deviations can be computed"
                );
                return Err(ScenarioError::field(format!("{place}.matched_to"), problem));
            }
            Law::EntrywiseMatched(other.clone())
        }
        (LawFile::Entrywise, ..) => {
            return fail(
                "law \"entrywise\" needs either payload_deviation_kg_m2 and \
                         stage_deviation_kg_m2, or matched_to, and nothing else",
            );
        }
    };
    Ok(ModelSpec { name: file.name.clone(), law })
}

/// The six entries of a symmetric matrix of deviations.
fn entries(field: &str, m: &[[f64; 3]; 3]) -> Result<[f64; 6], ScenarioError> {
    for (i, j) in [(0, 1), (0, 2), (1, 2)] {
        let (upper, lower) = (m[i][j], m[j][i]);
        if upper != lower && !(upper.is_nan() && lower.is_nan()) {
            let problem = format!(
                "entries ({}, {}) = {upper} and ({}, {}) = {lower}: the matrix must be symmetric",
                i + 1,
                j + 1,
                j + 1,
                i + 1
            );
            return Err(ScenarioError::field(field, problem));
        }
    }
    let entries = [m[0][0], m[1][1], m[2][2], m[0][1], m[0][2], m[1][2]];
    match entries.iter().find(|d| !(**d >= 0.0 && d.is_finite())) {
        Some(bad) => {
            let problem = format!("{bad} kg·m²: deviations must be finite and not negative");
            Err(ScenarioError::field(field, problem))
        }
        None => Ok(entries),
    }
}

pub(crate) fn check_comparisons(
    files: &[ComparisonFile],
    models: &[ModelSpec],
) -> Result<Vec<Comparison>, ScenarioError> {
    let find = |i: usize, role: &str, name: &str| {
        let law = if role == "physical" { "principal" } else { "entrywise" };
        let fits = |m: &&ModelSpec| matches!(m.law, Law::Principal(_)) == (role == "physical");
        let names: Vec<&str> = models.iter().filter(fits).map(|m| m.name.as_str()).collect();
        models.iter().position(|m| m.name == name && fits(&m)).ok_or_else(|| {
            let problem = format!(
                "{name:?}: it must be one of the models with law {law:?}: {}",
                names.join(", ")
            );
            ScenarioError::field(format!("comparisons[{}].{role}", i + 1), problem)
        })
    };
    let mut comparisons: Vec<Comparison> = Vec::with_capacity(files.len());
    for (i, file) in files.iter().enumerate() {
        let title = file.title.trim().to_owned();
        if title.is_empty() || comparisons.iter().any(|c| c.title == title) {
            let problem = format!("{title:?}: it must not be empty, and no two may be the same");
            return Err(ScenarioError::field(format!("comparisons[{}].title", i + 1), problem));
        }
        let physical = find(i, "physical", &file.physical)?;
        let naive = find(i, "naive", &file.naive)?;
        if comparisons.iter().any(|c| (c.physical, c.naive) == (physical, naive)) {
            let problem = "the same two models are compared twice";
            return Err(ScenarioError::field(format!("comparisons[{}]", i + 1), problem));
        }
        comparisons.push(Comparison { title, physical, naive });
    }
    Ok(comparisons)
}
