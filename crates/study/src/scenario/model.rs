//! A model of a scenario.

use gyradius_dispersion::{DispersionModel, ModelKind, ModelParameterError, ModelParameters};

use super::{
    ScenarioError, UncertainBody, check_name,
    file::ComparisonFile,
    model_file::{AxesFile as Axes, ModelFile, ModelLaw, OutsideFile, Owner, parameter_key},
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
    /// Roots and axes as the dispersions of the bodies say.
    Principal(Axes),
    /// Any other model with given parameters of each body.
    Given { kind: ModelKind, parameters: Vec<ModelParameters> },
    /// Any other model with the moments of a principal one, or of one from outside.
    Matched { kind: ModelKind, to: String },
    /// That of a program, and what the file says of it.
    Outside(Option<OutsideFile>),
}

impl Law {
    pub(crate) fn named(&self) -> ModelLaw {
        match self {
            Self::Principal(_) => ModelLaw::Kind(ModelKind::Principal),
            Self::Given { kind, .. } | Self::Matched { kind, .. } => ModelLaw::Kind(*kind),
            Self::Outside(_) => ModelLaw::Outside,
        }
    }

    /// The key of the model that says which law it is, beside `law`.
    pub(crate) fn key(&self) -> &'static str {
        match self {
            Self::Principal(_) => ".axes",
            Self::Matched { .. } => ".matched_to",
            Self::Given { .. } | Self::Outside(_) => "",
        }
    }

    /// How it reads the axes of the bodies, if it draws their own laws.
    pub(crate) fn own_axes(&self) -> Option<Axes> {
        match self {
            Self::Principal(axes) => Some(*axes),
            Self::Given { .. } | Self::Matched { .. } | Self::Outside(_) => None,
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

/// The models of a file that is filled in, of these bodies.
pub(crate) fn check_models<O: Owner>(
    files: &[ModelFile<O>],
    bodies: &[(O, &UncertainBody)],
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

fn check_model<O: Owner>(
    index: usize,
    file: &ModelFile<O>,
    all: &[ModelFile<O>],
    bodies: &[(O, &UncertainBody)],
) -> Result<ModelSpec, ScenarioError> {
    let place = place(index);
    let field_error = |field: &str, problem: String| {
        Err(ScenarioError::field(format!("{place}.{field}"), problem))
    };
    let given = || {
        let of = |(body, given): &(O, ModelParameters)| {
            let keys = given.given().map(|key| (parameter_key(body, key), key));
            keys.collect::<Vec<_>>()
        };
        file.parameters.iter().flat_map(of)
    };
    let of_nobody = file.parameters.iter().find(|(body, _)| bodies.iter().all(|(b, _)| b != body));
    if let Some((body, parameters)) = of_nobody {
        let names = bodies.iter().map(|(body, _)| body.name()).collect::<Vec<_>>().join(", ");
        let key = parameters.given().next().unwrap_or_default();
        let there = if names.is_empty() { "none".to_owned() } else { names };
        let problem = format!("there is no body {:?}: the bodies are {there}", body.name());
        return field_error(&parameter_key(body, key), problem);
    }

    let ModelLaw::Kind(kind) = file.law else {
        let mut others = given().map(|(field, _)| field);
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
        // Without bodies they say nothing.
        let none = bodies.is_empty().then_some(Axes::WholeSphere);
        let Some(axes) = file.axes.or(none) else {
            return Err(ScenarioError::field(
                format!("{place}.axes"),
                "missing: law \"principal\" needs axes: \"whole-sphere\", \"mean-half\" or \"jacobian-twice\"",
            ));
        };
        let only = "law \"principal\" takes axes and nothing else: its variances are those of \
                    the dispersion of each body";
        if let Some((field, _)) = given().next() {
            return field_error(&field, only.to_owned());
        }
        if file.matched_to.is_some() {
            return field_error("matched_to", only.to_owned());
        }
        if axes != Axes::WholeSphere && bodies.iter().any(|(_, b)| b.gaussian_axes().is_none()) {
            let problem = "only \"whole-sphere\" goes with bodies whose dispersion.axes are \"uniform\" \
                           or \"fixed\", or are not those of one Gaussian by their law: they have no far half";
            return field_error("axes", problem.to_owned());
        }
        return Ok(ModelSpec { name: file.name.clone(), law: Law::Principal(axes) });
    }

    if file.axes.is_some() {
        return field_error("axes", format!("law \"{kind}\" does not take it"));
    }
    let (needs, defaults) = (kind.needs(), kind.defaults());
    let takes = |key: &str| needs.contains(&key) || defaults.given().any(|other| other == key);
    let of_all = |key: &&str| {
        let keys = bodies.iter().map(|(body, _)| parameter_key(body, key));
        keys.collect::<Vec<_>>().join(" and ")
    };
    let choice = format!(
        "law \"{kind}\" needs either {}, or matched_to, and nothing else",
        needs.iter().map(of_all).collect::<Vec<_>>().join(", ")
    );
    if let Some((field, _)) = given().find(|(_, key)| !takes(key)) {
        return field_error(&field, format!("{choice}; it does not take this"));
    }
    let law = if let Some(other) = &file.matched_to {
        if let Some((field, _)) = given().next() {
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
        for (body, given) in &file.parameters {
            if let Some(need) = needs.iter().find(|need| !given.given().any(|key| key == **need)) {
                return field_error(&parameter_key(body, need), format!("missing: {choice}"));
            }
        }
        // Checked by making the models.
        for ((body, given), (_, uncertain)) in file.parameters.iter().zip(bodies) {
            let wrong = |ModelParameterError { key, problem }| {
                ScenarioError::field(format!("{place}.{}", parameter_key(body, key)), problem)
            };
            DispersionModel::about(kind, uncertain.nominal(), given).map_err(wrong)?;
        }
        Law::Given { kind, parameters: file.parameters.iter().map(|(_, given)| *given).collect() }
    };
    Ok(ModelSpec { name: file.name.clone(), law })
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
