//! What else is uncertain than the inertias, in the order in which it is drawn.

use gyradius_dispersion::{Correlation, CorrelationError, LawUnit, ScalarLaw, ScalarLawForm};
use gyradius_separation::{
    BodyParameter, MovingBody, Parameter, Separation, Spring, SpringParameter, StackParameter,
};

use super::{
    ScenarioError,
    file::{BodyFile, Given, ScenarioFile, SpringFile},
    law::{self, VectorLawFile},
};
use crate::body::Body;

/// A number that every run draws.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Dispersed {
    /// Its name in correlations and in the run table, and of its random stream.
    pub(crate) column: String,
    pub(crate) unit: &'static str,
    pub(crate) nominal: f64,
    pub(crate) law: ScalarLaw,
    pub(crate) target: Target,
}

/// What a number is of: a component, from 0, of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Target {
    Body(Body, BodyParameter, usize),
    Stack(StackParameter, usize),
    /// Springs are numbered from 0.
    Spring(usize, SpringParameter, usize),
    /// Whether a spring starts late.
    Late(usize),
    /// Whether it never pushes.
    Fails(usize),
}

/// All of them, and how they are correlated.
#[derive(Clone, Debug, Default)]
pub(crate) struct Dispersions {
    pub(crate) all: Vec<Dispersed>,
    pub(crate) correlation: Correlation,
    /// The share of its mass's relative change that the drawn inertia of payload and stage takes.
    pub(crate) inertia_follows_mass: [f64; 2],
}

impl Dispersions {
    /// Of a scenario, and its separation without dispersions.
    pub(crate) fn new(file: &ScenarioFile, separation: &Separation) -> Result<Self, ScenarioError> {
        let mut list = List::default();
        list.body(Body::Payload, &file.payload, separation.payload())?;
        list.body(Body::Stage, &file.stage, separation.stage())?;
        if let Some(stack) = file.stack.as_ref().and_then(|s| s.dispersion.as_ref()) {
            for &parameter in StackParameter::ALL {
                let target = |i| Target::Stack(parameter, i);
                list.parameter("stack", "stack", parameter, stack.given(parameter), &(), target)?;
            }
        }
        for (i, (file, spring)) in file.springs.iter().zip(separation.springs()).enumerate() {
            list.spring(i, file, spring)?;
        }
        let correlation = list.correlate(file)?;
        let follows = |body: &BodyFile| body.dispersion.inertia_follows_mass.share();
        let inertia_follows_mass = [follows(&file.payload), follows(&file.stage)];
        Ok(Self { all: list.all, correlation, inertia_follows_mass })
    }

    pub(crate) fn columns(&self) -> Vec<String> {
        self.all.iter().map(|d| d.column.clone()).collect()
    }
}

/// Where in the file, in its own unit and in percent, and what it is called.
struct Place {
    field: String,
    percent: String,
    name: String,
    unit: &'static str,
}

/// The key of the correlations.
const CORRELATIONS: &str = "correlations";

/// As it is put together.
#[derive(Default)]
struct List {
    all: Vec<Dispersed>,
    /// Pairs that covariances correlate, and where they are given.
    pairs: Vec<(usize, usize, f64)>,
    fields: Vec<String>,
}

impl List {
    fn push(
        &mut self,
        name: &str,
        unit: &'static str,
        nominal: f64,
        law: ScalarLaw,
        target: Target,
    ) {
        let column = if unit.is_empty() { name.to_owned() } else { format!("{name}_{unit}") };
        self.all.push(Dispersed { column, unit, nominal, law, target });
    }

    /// A parameter of what stands at a place of the file, and is called by a name.
    fn parameter<P: Parameter>(
        &mut self,
        place: &str,
        name: &str,
        parameter: P,
        given: Given<'_>,
        of: &P::Of,
        target: impl Fn(usize) -> Target,
    ) -> Result<(), ScenarioError> {
        let (quantity, unit) = (parameter.name(), parameter.unit());
        let place = Place {
            field: format!("{place}.dispersion.{quantity}_{unit}"),
            percent: format!("{place}.dispersion.{quantity}_percent"),
            name: format!("{name}_{quantity}"),
            unit,
        };
        let nominal = parameter.nominal(of);
        match given {
            Given::Number(law, percent) => {
                nominal.iter().enumerate().try_for_each(|(i, nominal)| {
                    self.number(&place, law, percent, *nominal, target(i))
                })
            }
            Given::Vector(law) => self.vector(&place, law, &nominal, target),
        }
    }

    /// A number given in its unit or in percent.
    fn number(
        &mut self,
        place: &Place,
        law: Option<&ScalarLawForm>,
        percent: Option<&ScalarLawForm>,
        nominal: f64,
        target: Target,
    ) -> Result<(), ScenarioError> {
        let (field, unit, law) = match (law, percent) {
            (None, None) => return Ok(()),
            (Some(_), Some(_)) => {
                let problem = format!("there is {} already: one of the two says it", place.field);
                return Err(ScenarioError::field(&place.percent, problem));
            }
            (Some(law), None) => (&place.field, LawUnit::OWN, law),
            (None, Some(law)) => (&place.percent, LawUnit::percent_of(nominal), law),
        };
        let law = law::about(law, field, nominal, unit)?;
        positive(field, nominal, &law)?;
        self.push(&place.name, place.unit, nominal, law, target);
        Ok(())
    }

    fn vector(
        &mut self,
        place: &Place,
        law: Option<&VectorLawFile>,
        nominal: &[f64],
        target: impl Fn(usize) -> Target,
    ) -> Result<(), ScenarioError> {
        let Some(law) = law else { return Ok(()) };
        let law = law.about(&place.field, nominal, LawUnit::OWN)?;
        let first = self.all.len();
        for (i, (law, nominal)) in law.laws.into_iter().zip(nominal).enumerate() {
            let name = format!("{}_{}", place.name, i + 1);
            self.push(&name, place.unit, *nominal, law, target(i));
        }
        for (a, b, coefficient) in law.pairs {
            self.pairs.push((first + a, first + b, coefficient));
            self.fields.push(format!("{}.covariance", place.field));
        }
        Ok(())
    }

    fn body(
        &mut self,
        body: Body,
        file: &BodyFile,
        moving: &MovingBody,
    ) -> Result<(), ScenarioError> {
        let (name, d) = (body.name(), &file.dispersion);
        for &parameter in BodyParameter::ALL {
            let target = |i| Target::Body(body, parameter, i);
            self.parameter(name, name, parameter, d.given(parameter), moving, target)?;
        }
        if !d.inertia_follows_mass.not_at_all() && d.mass_kg.is_none() && d.mass_percent.is_none() {
            let problem = "the mass is not dispersed: it needs mass_kg or mass_percent";
            let field = format!("{name}.dispersion.inertia_follows_mass");
            return Err(ScenarioError::field(field, problem));
        }
        Ok(())
    }

    fn spring(
        &mut self,
        i: usize,
        file: &SpringFile,
        spring: &Spring,
    ) -> Result<(), ScenarioError> {
        let Some(d) = &file.dispersion else { return Ok(()) };
        let (place, name) = (format!("springs[{}]", i + 1), format!("spring_{}", i + 1));
        for &parameter in SpringParameter::ALL {
            let target = |component| Target::Spring(i, parameter, component);
            self.parameter(&place, &name, parameter, d.given(parameter), spring, target)?;
        }
        let at = |field: &str| format!("{place}.dispersion.{field}");
        if d.late_probability.is_some() && d.start_s.is_none() {
            let problem = "it needs start_s, which says how late a late spring is";
            return Err(ScenarioError::field(at("late_probability"), problem));
        }
        let chances = [
            ("late", d.late_probability, Target::Late(i)),
            ("failure", d.failure_probability, Target::Fails(i)),
        ];
        for (chance, probability, target) in chances {
            if let Some(p) = probability {
                let field = at(&format!("{chance}_probability"));
                let law = ScalarLaw::bernoulli(p).map_err(|e| ScenarioError::field(field, e))?;
                self.push(&format!("{name}_{chance}"), "", 0.0, law, target);
            }
        }
        Ok(())
    }

    fn correlate(&mut self, file: &ScenarioFile) -> Result<Correlation, ScenarioError> {
        for (i, given) in file.correlations.iter().enumerate() {
            let field = format!("{CORRELATIONS}[{}]", i + 1);
            let index = |name: &String| {
                self.all.iter().position(|d| d.column == *name).ok_or_else(|| {
                    let names: Vec<_> = self.all.iter().map(|d| d.column.as_str()).collect();
                    let problem = if names.is_empty() {
                        format!("{name:?} is not dispersed, and nothing is: there is nothing to correlate")
                    } else {
                        format!(
                            "{name:?} is not dispersed: the dispersion of payload, stage, stack and springs names {}",
                            names.join(", ")
                        )
                    };
                    ScenarioError::field(format!("{field}.between"), problem)
                })
            };
            let members = given.between.iter().map(index).collect::<Result<Vec<_>, _>>()?;
            if members.len() < 2 {
                let problem = format!("{:?}: it must name at least two quantities", given.between);
                return Err(ScenarioError::field(format!("{field}.between"), problem));
            }
            for (j, &b) in members.iter().enumerate() {
                for &a in &members[..j] {
                    self.pairs.push((a, b, given.coefficient));
                    self.fields.push(field.clone());
                }
            }
        }
        Correlation::new(&self.pairs).map_err(|error| {
            let pair = match &error {
                CorrelationError::Coefficient { pair, .. }
                | CorrelationError::NoPair { pair }
                | CorrelationError::Twice { pair }
                | CorrelationError::Indefinite { pair, .. } => *pair,
                _ => return ScenarioError::field(CORRELATIONS, error),
            };
            let field = match (&error, self.fields[pair].as_str()) {
                (CorrelationError::NoPair { .. } | CorrelationError::Twice { .. }, field)
                    if field.starts_with(CORRELATIONS) =>
                {
                    format!("{field}.between")
                }
                (_, field) if field.starts_with(CORRELATIONS) => format!("{field}.coefficient"),
                (_, field) => field.to_owned(),
            };
            let (a, b, _) = self.pairs[pair];
            let (a, b) = (&self.all[a].column, &self.all[b].column);
            ScenarioError::field(field, format!("{a:?} and {b:?}: {error}"))
        })
    }
}

/// That a law of what cannot be negative is not so more often than not.
fn positive(field: &str, nominal: f64, law: &ScalarLaw) -> Result<(), ScenarioError> {
    if law.cdf(-f64::MIN_POSITIVE) < 0.5 {
        return Ok(());
    }
    let problem = format!(
        "at least half of the draws would be negative: the nominal value is {nominal:?} ({}); laws \"lognormal\" \
         (with a mean), \"uniform\" and \"truncated-normal\" need not be negative",
        law.changes()
    );
    Err(ScenarioError::field(field, problem))
}
