//! A model of a scenario.

use gyradius_dispersion::{
    BasiliskDispersion, BasiliskError, CorrelatedEntries, DispersionModel, EntrywiseGaussian,
    LogCholeskyGaussian, ModelKind, RealizableOnly, Wishart,
};
use gyradius_inertia::Inertia;
use nalgebra::SMatrix;

use super::{
    ScenarioError, UncertainBody, check_name,
    file::{AxesFile as Axes, ComparisonFile, GivenFile, ModelFile, ModelLaw, OutsideFile},
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
    /// Roots and axes as payload.dispersion and stage.dispersion say.
    Principal(Axes),
    /// Any other model with given parameters of payload and stage.
    Given { kind: ModelKind, payload: Box<Given>, stage: Box<Given> },
    /// Any other model with the moments of a principal one, or of one from outside.
    Matched { kind: ModelKind, to: String },
    /// That of a program, and what the file says of it.
    Outside(Option<OutsideFile>),
}

/// The parameters of a model for one body.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Given {
    /// Of I11, I22, I33, I12, I13, I23, kg·m².
    Deviations([f64; 6]),
    /// Of the same, (kg·m²)².
    Covariance(SMatrix<f64, 6, 6>),
    /// Of d1, d2, d3, s12, s23, s13.
    LogCholesky(SMatrix<f64, 6, 6>),
    /// Dispersion parameter.
    Delta(f64),
    /// Of the diagonal, kg·m², and of the angles, rad.
    Basilisk { diagonal: f64, bounds: [f64; 2], angle: f64 },
}

impl Law {
    pub(crate) fn named(&self) -> ModelLaw {
        match self {
            Self::Principal(_) => ModelLaw::Kind(ModelKind::Principal),
            Self::Given { kind, .. } | Self::Matched { kind, .. } => ModelLaw::Kind(*kind),
            Self::Outside(_) => ModelLaw::Outside,
        }
    }

    /// Whether it can be the physical model of a comparison; what a file does not say is judged when the law is
    /// there.
    fn may_be_physical(&self) -> bool {
        match (self, self.named()) {
            (_, ModelLaw::Kind(kind)) => kind.is_realizable_by_construction(),
            (Self::Outside(Some(said)), _) => said.realizable_by_construction,
            (_, ModelLaw::Outside) => true,
        }
    }
}

/// A physical model and the naive one that it is set against.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Comparison {
    pub(crate) title: String,
    /// Indices into the models.
    pub(crate) physical: usize,
    pub(crate) naive: usize,
}

pub(crate) fn check_models(
    files: &[ModelFile],
    bodies: [&UncertainBody; 2],
) -> Result<Vec<ModelSpec>, ScenarioError> {
    if files.is_empty() {
        return Err(ScenarioError::field("models", "none: there must be at least one"));
    }
    for (i, file) in files.iter().enumerate() {
        check_name(&format!("{}.name", place(i)), &file.name)?;
        // Some file systems do not tell upper from lower case.
        if files[..i].iter().any(|other| other.name.eq_ignore_ascii_case(&file.name)) {
            let problem =
                format!("two are named {:?}: names must differ in more than case", file.name);
            return Err(ScenarioError::field(format!("{}.name", place(i)), problem));
        }
    }
    files.iter().enumerate().map(|(i, file)| check_model(i, file, files, bodies)).collect()
}

/// The key of a model, counted from 0.
pub(crate) fn place(index: usize) -> String {
    format!("models[{}]", index + 1)
}

fn check_model(
    index: usize,
    file: &ModelFile,
    all: &[ModelFile],
    bodies: [&UncertainBody; 2],
) -> Result<ModelSpec, ScenarioError> {
    let place = place(index);
    let field_error = |field: &str, problem: String| {
        Err(ScenarioError::field(format!("{place}.{field}"), problem))
    };
    let (payload, stage) = (file.payload(), file.stage());
    let given = || {
        let of = |body: &str, given: &GivenFile| {
            let body = body.to_owned();
            given.fields().map(|(field, there)| (format!("{body}_{field}"), field, there))
        };
        of("payload", &payload).into_iter().chain(of("stage", &stage)).filter(|f| f.2)
    };

    let ModelLaw::Kind(kind) = file.law else {
        let mut others = given().map(|(field, ..)| field);
        let axes = file.axes.map(|_| "axes".to_owned());
        let matched = file.matched_to.as_ref().map(|_| "matched_to".to_owned());
        return match others.next().or(axes).or(matched) {
            Some(field) => {
                let problem = "law \"outside\" does not take it: a program gives the law by Scenario::with_model";
                field_error(&field, problem.to_owned())
            }
            None => {
                Ok(ModelSpec { name: file.name.clone(), law: Law::Outside(file.outside.clone()) })
            }
        };
    };
    if file.outside.is_some() {
        return field_error("outside", format!("law \"{kind}\" does not take it"));
    }
    if kind == ModelKind::Principal {
        let Some(axes) = file.axes else {
            return Err(ScenarioError::field(
                format!("{place}.axes"),
                "missing: law \"principal\" needs axes: \"whole-sphere\", \"mean-half\" or \"jacobian-twice\"",
            ));
        };
        let only = "law \"principal\" takes axes and nothing else: its variances are those of \
                    payload.dispersion and stage.dispersion";
        if let Some((field, ..)) = given().next() {
            return field_error(&field, only.to_owned());
        }
        if file.matched_to.is_some() {
            return field_error("matched_to", only.to_owned());
        }
        if axes != Axes::WholeSphere && bodies.iter().any(|b| b.gaussian_axes().is_none()) {
            let problem = "only \"whole-sphere\" goes with bodies whose dispersion.axes are \"uniform\" \
                           or \"fixed\": they have no far half";
            return field_error("axes", problem.to_owned());
        }
        return Ok(ModelSpec { name: file.name.clone(), law: Law::Principal(axes) });
    }

    if file.axes.is_some() {
        return field_error("axes", format!("law \"{kind}\" does not take it"));
    }
    let (needs, takes) = parameters(kind);
    let choice = format!(
        "law \"{kind}\" needs either {}, or matched_to, and nothing else",
        needs.iter().map(|f| format!("payload_{f} and stage_{f}")).collect::<Vec<_>>().join(", ")
    );
    if let Some((field, ..)) = given().find(|(_, field, _)| !takes.contains(field)) {
        return field_error(&field, format!("{choice}; it does not take this"));
    }
    let law = if let Some(other) = &file.matched_to {
        if let Some((field, ..)) = given().next() {
            return field_error(&field, choice);
        }
        let known = [ModelLaw::Kind(ModelKind::Principal), ModelLaw::Outside];
        if !all.iter().any(|m| m.name == *other && known.contains(&m.law)) {
            let problem = format!(
                "{other:?}: it must name a model with law \"principal\", whose mean and deviations \
                 can be computed"
            );
            return field_error("matched_to", problem);
        }
        Law::Matched { kind, to: other.clone() }
    } else {
        for (body, given) in [("payload", &payload), ("stage", &stage)] {
            for need in needs {
                if !given.fields().contains(&(*need, true)) {
                    return field_error(&format!("{body}_{need}"), format!("missing: {choice}"));
                }
            }
        }
        let [p, s] = bodies.map(UncertainBody::nominal);
        let payload = Box::new(check_given(kind, &format!("{place}.payload"), &payload, p)?);
        let stage = Box::new(check_given(kind, &format!("{place}.stage"), &stage, s)?);
        Law::Given { kind, payload, stage }
    };
    Ok(ModelSpec { name: file.name.clone(), law })
}

/// The fields that a law needs, and those that it takes.
fn parameters(kind: ModelKind) -> (&'static [&'static str], &'static [&'static str]) {
    match kind {
        ModelKind::Entrywise | ModelKind::RealizableEntrywise => {
            (&["deviation_kg_m2"], &["deviation_kg_m2"])
        }
        ModelKind::CorrelatedEntries | ModelKind::RealizableCorrelatedEntries => {
            (&["covariance_kg2_m4"], &["covariance_kg2_m4"])
        }
        ModelKind::LogCholesky => (&["log_cholesky_covariance"], &["log_cholesky_covariance"]),
        ModelKind::Wishart => (&["delta"], &["delta"]),
        ModelKind::Basilisk => (
            &["diagonal_deviation_kg_m2", "angle_deviation_rad"],
            &["diagonal_deviation_kg_m2", "diagonal_bounds_kg_m2", "angle_deviation_rad"],
        ),
        ModelKind::Principal => (&[], &[]),
    }
}

/// What a law was given for one body, checked by making the model. `place` ends with the body's name.
fn check_given(
    kind: ModelKind,
    place: &str,
    file: &GivenFile,
    nominal: &Inertia,
) -> Result<Given, ScenarioError> {
    let square = |m: &[[f64; 6]; 6]| SMatrix::from_fn(|i, j| m[i][j]);
    let (field, given) = if let Some(m) = &file.deviation_kg_m2 {
        let field = "deviation_kg_m2";
        (field, Given::Deviations(entries(&format!("{place}_{field}"), m)?))
    } else if let Some(m) = &file.covariance_kg2_m4 {
        ("covariance_kg2_m4", Given::Covariance(square(m)))
    } else if let Some(m) = &file.log_cholesky_covariance {
        ("log_cholesky_covariance", Given::LogCholesky(square(m)))
    } else if let Some(delta) = file.delta {
        ("delta", Given::Delta(delta))
    } else {
        let bounds = file.diagonal_bounds_kg_m2.unwrap_or(BasiliskDispersion::NO_BOUNDS);
        let diagonal = file.diagonal_deviation_kg_m2.unwrap_or(0.0);
        let angle = file.angle_deviation_rad.unwrap_or(0.0);
        let field = match BasiliskDispersion::new(*nominal, diagonal, bounds, angle) {
            Err(BasiliskError::Bounds { .. }) => "diagonal_bounds_kg_m2",
            Err(BasiliskError::Deviation { which: "angle", .. }) => "angle_deviation_rad",
            _ => "diagonal_deviation_kg_m2",
        };
        (field, Given::Basilisk { diagonal, bounds, angle })
    };
    let made = given.model(kind, nominal);
    made.map_err(|e| ScenarioError::field(format!("{place}_{field}"), e))?;
    Ok(given)
}

impl Given {
    /// The model of a kind with these parameters, about a nominal body.
    pub(crate) fn model(
        &self,
        kind: ModelKind,
        nominal: &Inertia,
    ) -> Result<DispersionModel, Box<dyn std::error::Error>> {
        Ok(match self {
            Self::Deviations(deviations) => {
                let law = EntrywiseGaussian::new(*nominal, *deviations)?;
                if kind == ModelKind::RealizableEntrywise {
                    RealizableOnly::new(law)?.into()
                } else {
                    law.into()
                }
            }
            Self::Covariance(covariance) => {
                let law = CorrelatedEntries::new(*nominal, *covariance)?;
                if kind == ModelKind::RealizableCorrelatedEntries {
                    RealizableOnly::new(law)?.into()
                } else {
                    law.into()
                }
            }
            Self::LogCholesky(covariance) => {
                LogCholeskyGaussian::about(nominal, *covariance)?.into()
            }
            Self::Delta(delta) => Wishart::new(*nominal, *delta)?.into(),
            Self::Basilisk { diagonal, bounds, angle } => {
                BasiliskDispersion::new(*nominal, *diagonal, *bounds, *angle)?.into()
            }
        })
    }
}

/// The six entries of a symmetric matrix of deviations.
fn entries(field: &str, m: &[[f64; 3]; 3]) -> Result<[f64; 6], ScenarioError> {
    for (i, j) in [(0, 1), (0, 2), (1, 2)] {
        let (upper, lower) = (m[i][j], m[j][i]);
        if upper != lower && !(upper.is_nan() && lower.is_nan()) {
            let problem = format!(
                "entries ({}, {}) = {upper:?} and ({}, {}) = {lower:?}: the matrix must be symmetric",
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
            let problem = format!("{bad:?} kg·m²: deviations must be finite and not negative");
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
        let fits = |m: &&ModelSpec| {
            if role == "physical" {
                m.law.may_be_physical()
            } else {
                m.law.named() != ModelLaw::Kind(ModelKind::Principal)
            }
        };
        let which = if role == "physical" {
            "whose law is realizable by construction"
        } else {
            "with another law than \"principal\""
        };
        let names: Vec<&str> = models.iter().filter(fits).map(|m| m.name.as_str()).collect();
        models.iter().position(|m| m.name == name && fits(&m)).ok_or_else(|| {
            let problem = format!(
                "{name:?}: it must be the name of one of the models {which}: {}",
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
