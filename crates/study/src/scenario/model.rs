//! A model of a scenario.

use gyradius_dispersion::{DispersionModel, ModelKind, ModelParameterError, ModelParameters};
use std::fmt::Display;

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
    let written = files.iter().enumerate().map(|(i, file)| WrittenModel {
        place: place(i),
        file,
        all: files,
        bodies,
    });
    written.map(|written| written.check()).collect()
}

/// The key of a model, counted from 0.
pub(crate) fn place(index: usize) -> String {
    format!("models[{}]", index + 1)
}

/// A model as it is written, and what it is about.
struct WrittenModel<'a, O> {
    place: String,
    file: &'a ModelFile<O>,
    all: &'a [ModelFile<O>],
    bodies: &'a [(O, &'a UncertainBody)],
}

impl<O: Owner> WrittenModel<'_, O> {
    fn check(&self) -> Result<ModelSpec, ScenarioError> {
        self.check_names()?;
        let law = match self.file.law {
            ModelLaw::Outside => self.outside()?,
            ModelLaw::Kind(kind) => {
                if self.file.outside.is_some() {
                    let problem = format!("law \"{kind}\" does not take it");
                    return Err(self.error("outside", problem));
                }
                match kind {
                    ModelKind::Principal => self.principal()?,
                    ModelKind::Entries { .. }
                    | ModelKind::LogCholesky
                    | ModelKind::Wishart
                    | ModelKind::Basilisk => self.entries(kind)?,
                }
            }
        };
        Ok(ModelSpec { name: self.file.name.clone(), law })
    }

    fn error(&self, field: &str, problem: impl Display) -> ScenarioError {
        ScenarioError::field(format!("{}.{field}", self.place), problem)
    }

    /// The parameters that are given: how each is written, and its key.
    fn given(&self) -> impl Iterator<Item = (String, &'static str)> {
        self.file
            .parameters
            .iter()
            .flat_map(|(body, given)| given.given().map(move |key| (parameter_key(body, key), key)))
    }

    /// Parameters are those of bodies that are there.
    fn check_names(&self) -> Result<(), ScenarioError> {
        let is_there = |body: &O| self.bodies.iter().any(|(other, _)| other == body);
        let Some((body, given)) = self.file.parameters.iter().find(|(body, _)| !is_there(body))
        else {
            return Ok(());
        };
        let names: Vec<&str> = self.bodies.iter().map(|(body, _)| body.name()).collect();
        let there = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
        let key = given.given().next().unwrap_or_default();
        let problem = format!("there is no body {:?}: the bodies are {there}", body.name());
        Err(self.error(&parameter_key(body, key), problem))
    }

    /// A law that a program gives.
    fn outside(&self) -> Result<Law, ScenarioError> {
        let parameter = self.given().map(|(field, _)| field).next();
        let axes = self.file.axes.map(|_| "axes".to_owned());
        let matched = self.file.matched_to.as_ref().map(|_| "matched_to".to_owned());
        match parameter.or(axes).or(matched) {
            Some(field) => Err(self.error(
                &field,
                "law \"outside\" does not take it: a program gives the law by Scenario::with_model",
            )),
            None => Ok(Law::Outside(self.file.outside.clone())),
        }
    }

    /// The law of roots and principal axes.
    fn principal(&self) -> Result<Law, ScenarioError> {
        // Without bodies they say nothing.
        let none = self.bodies.is_empty().then_some(Axes::WholeSphere);
        let Some(axes) = self.file.axes.or(none) else {
            let problem = "missing: law \"principal\" needs axes: \"whole-sphere\", \"mean-half\" or \"jacobian-twice\"";
            return Err(self.error("axes", problem));
        };
        let only = "law \"principal\" takes axes and nothing else: its variances are those of \
                    the dispersion of each body";
        if let Some((field, _)) = self.given().next() {
            return Err(self.error(&field, only));
        }
        if self.file.matched_to.is_some() {
            return Err(self.error("matched_to", only));
        }
        let has_no_half = |(_, body): &(O, &UncertainBody)| body.gaussian_axes().is_none();
        if axes != Axes::WholeSphere && self.bodies.iter().any(has_no_half) {
            let problem = "only \"whole-sphere\" goes with bodies whose dispersion.axes are \"uniform\" \
                           or \"fixed\", or are not those of one Gaussian by their law: they have no far half";
            return Err(self.error("axes", problem));
        }
        Ok(Law::Principal(axes))
    }

    /// A law of the entries, by its own parameters or as another model is.
    fn entries(&self, kind: ModelKind) -> Result<Law, ScenarioError> {
        if self.file.axes.is_some() {
            return Err(self.error("axes", format!("law \"{kind}\" does not take it")));
        }
        let (needs, defaults) = (kind.needs(), kind.defaults());
        let takes = |key: &str| needs.contains(&key) || defaults.given().any(|other| other == key);
        let of_all = |key: &&str| {
            let keys: Vec<String> =
                self.bodies.iter().map(|(body, _)| parameter_key(body, key)).collect();
            keys.join(" and ")
        };
        let choice = format!(
            "law \"{kind}\" needs either {}, or matched_to, and nothing else",
            needs.iter().map(of_all).collect::<Vec<_>>().join(", ")
        );
        if let Some((field, _)) = self.given().find(|(_, key)| !takes(key)) {
            return Err(self.error(&field, format!("{choice}; it does not take this")));
        }
        if let Some(other) = &self.file.matched_to {
            if let Some((field, _)) = self.given().next() {
                return Err(self.error(&field, choice));
            }
            let known = [ModelLaw::Kind(ModelKind::Principal), ModelLaw::Outside];
            if !self.all.iter().any(|m| m.name == *other && known.contains(&m.law)) {
                let problem = format!(
                    "{other:?}: it must name a model with law \"principal\", whose mean and deviations \
                     can be computed"
                );
                return Err(self.error("matched_to", problem));
            }
            return Ok(Law::Matched { kind, to: other.clone() });
        }
        for (body, given) in &self.file.parameters {
            if let Some(need) = needs.iter().find(|need| !given.given().any(|key| key == **need)) {
                return Err(self.error(&parameter_key(body, need), format!("missing: {choice}")));
            }
        }
        // Checked by making the models.
        for ((body, given), (_, uncertain)) in self.file.parameters.iter().zip(self.bodies) {
            let wrong = |ModelParameterError { key, problem }| {
                self.error(&parameter_key(body, key), problem)
            };
            DispersionModel::about(kind, uncertain.nominal(), given).map_err(wrong)?;
        }
        let parameters = self.file.parameters.iter().map(|(_, given)| *given).collect();
        Ok(Law::Given { kind, parameters })
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
