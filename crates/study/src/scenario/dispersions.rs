//! What else is uncertain than the inertias, in the order in which it is drawn.

use gyradius_dispersion::{Correlation, CorrelationError, LawUnit, ScalarLaw};
use gyradius_separation::{
    BodyParameter, LoadId, LoadParameter, MovingBody, Parameter, Separation, StackParameter,
};

use super::{
    ScenarioError,
    chance::ChanceFile,
    each::{DRAWN, Each},
    file::{BodyFile, CorrelationFile, ScenarioFile},
    law::{self, GivenLaw, VectorLawFile},
    load::{self, GivenLoad, Uncertain},
    scalar::ScalarLawFile,
    vehicles,
};
use crate::{body::Body, fleet::Fleet};

/// A number that every run draws.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Dispersed<T = Target> {
    /// Its name in correlations and in the run table, and of its random stream.
    pub(crate) column: String,
    /// What it is part of: its parameter, without the component.
    pub(crate) part_of: String,
    pub(crate) nominal: f64,
    pub(crate) law: ScalarLaw,
    /// For what it is drawn.
    pub(crate) each: Each,
    pub(crate) target: T,
}

/// What a number is of: a component, from 0, of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Target {
    Body(Body, BodyParameter, usize),
    Stack(StackParameter, usize),
    /// Loads by their places, from 0.
    Load(usize, LoadParameter, usize),
    /// Whether a load starts late, and what then says when.
    Late(usize, LoadParameter),
    /// Whether it never acts.
    Fails(usize),
}

/// All of them, and how they are correlated.
#[derive(Clone, Debug)]
pub(crate) struct Joint<T> {
    pub(crate) all: Vec<Dispersed<T>>,
    pub(crate) correlation: Correlation,
}

/// What is uncertain of a separation besides the inertias.
#[derive(Clone, Debug, Default)]
pub(crate) struct Dispersions {
    pub(crate) joint: Joint<Target>,
    /// For what the inertias of payload and stage are drawn.
    pub(crate) inertia: [Each; 2],
    /// The share of its mass's relative change that the drawn inertia of payload and stage takes.
    pub(crate) inertia_follows_mass: [f64; 2],
}

impl Dispersions {
    /// Of a scenario, and its separation without dispersions.
    pub(crate) fn new(
        file: &ScenarioFile,
        fleet: Option<Fleet>,
        separation: &Separation,
    ) -> Result<Self, ScenarioError> {
        let mut list = List::of(fleet);
        list.body(Body::Payload, &file.payload, separation.payload())?;
        list.body(Body::Stage, &file.stage, separation.stage())?;
        if let Some(stack) = file.stack.as_ref().and_then(|s| s.dispersion.as_ref()) {
            for &parameter in StackParameter::ALL {
                let target = |i| Target::Stack(parameter, i);
                let uncertain = uncertain(parameter, &(), stack.given(parameter));
                list.parameter("stack", "stack", &uncertain, target)?;
            }
        }
        for (place, (id, given)) in file.loads().enumerate() {
            list.load(place, id, given)?;
        }
        let follows = |body: &BodyFile| body.dispersion.inertia_follows_mass.share();
        let inertia_follows_mass = [follows(&file.payload), follows(&file.stage)];
        let inertia = |name: Body, body: &BodyFile| {
            let field = format!("{}.dispersion.inertia_drawn", name.name());
            list.possible(&field, body.dispersion.inertia_drawn)
        };
        let inertia = [inertia(Body::Payload, &file.payload)?, inertia(Body::Stage, &file.stage)?];
        let joint = list.correlate(
            &file.correlations,
            "the dispersion of payload, stage, stack and springs names",
        )?;
        Ok(Self { joint, inertia, inertia_follows_mass })
    }

    /// For what each of all that is uncertain is drawn.
    pub(crate) fn drawn_for(&self) -> impl Iterator<Item = Each> {
        self.inertia.into_iter().chain(self.joint.drawn_for())
    }

    /// What they are, in order.
    pub(crate) fn all(&self) -> &[Dispersed] {
        &self.joint.all
    }

    pub(crate) fn columns(&self) -> Vec<String> {
        self.all().iter().map(|d| d.column.clone()).collect()
    }
}

impl<T> Joint<T> {
    /// For what each of them is drawn.
    pub(crate) fn drawn_for(&self) -> impl Iterator<Item = Each> {
        self.all.iter().map(|d| d.each)
    }
}

impl<T> Default for Joint<T> {
    fn default() -> Self {
        Self { all: Vec::new(), correlation: Correlation::default() }
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
pub(crate) struct List<T = Target> {
    fleet: Option<Fleet>,
    all: Vec<Dispersed<T>>,
    /// Pairs that covariances correlate, and where they are given.
    pairs: Vec<(usize, usize, f64)>,
    fields: Vec<String>,
}

impl<T> List<T> {
    /// Nothing yet, of a scenario with vehicles or without.
    pub(crate) fn of(fleet: Option<Fleet>) -> Self {
        Self { fleet, all: Vec::new(), pairs: Vec::new(), fields: Vec::new() }
    }

    /// A number with a name that ends in its unit, if it has one, and what it is part of.
    pub(crate) fn push(
        &mut self,
        [name, part_of]: [&str; 2],
        unit: &str,
        nominal: f64,
        (law, each): (ScalarLaw, Each),
        target: T,
    ) {
        let column = if unit.is_empty() { name.to_owned() } else { format!("{name}_{unit}") };
        let part_of = part_of.to_owned();
        self.all.push(Dispersed { column, part_of, nominal, law, each, target });
    }

    /// A parameter of what stands at a place of the file, and is called by a name.
    pub(crate) fn parameter(
        &mut self,
        place: &str,
        name: &str,
        uncertain: &Uncertain<'_>,
        target: impl Fn(usize) -> T,
    ) -> Result<(), ScenarioError> {
        let Uncertain { name: quantity, unit, nominal, law } = uncertain;
        let place = Place {
            field: format!("{place}.dispersion.{quantity}_{unit}"),
            percent: format!("{place}.dispersion.{}", load::percent(quantity)),
            name: format!("{name}_{quantity}"),
            unit,
        };
        match law {
            GivenLaw::Number(law, percent) => {
                nominal.iter().enumerate().try_for_each(|(i, nominal)| {
                    self.number(&place, *law, *percent, *nominal, target(i))
                })
            }
            GivenLaw::Vector(law) => self.vector(&place, *law, nominal, target),
        }
    }

    /// For what a law is drawn that stands at a field, if the scenario has that.
    pub(crate) fn each(&self, field: &str, each: Each) -> Result<Each, ScenarioError> {
        self.possible(&format!("{field}.{DRAWN}"), each)
    }

    /// For what something is drawn, as a key says, if the scenario has that.
    pub(crate) fn possible(&self, key: &str, each: Each) -> Result<Each, ScenarioError> {
        vehicles::possible(key, each, self.fleet)
    }

    /// A number given in its unit or in percent.
    fn number(
        &mut self,
        place: &Place,
        law: Option<&ScalarLawFile>,
        percent: Option<&ScalarLawFile>,
        nominal: f64,
        target: T,
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
        let each = self.each(field, law.drawn)?;
        let law = law::about(&law.form, field, nominal, unit)?;
        positive(field, nominal, &law)?;
        self.push([&place.name; 2], place.unit, nominal, (law, each), target);
        Ok(())
    }

    fn vector(
        &mut self,
        place: &Place,
        law: Option<&VectorLawFile>,
        nominal: &[f64],
        target: impl Fn(usize) -> T,
    ) -> Result<(), ScenarioError> {
        let Some(law) = law else { return Ok(()) };
        let vector = law.about(&place.field, nominal, LawUnit::OWN)?;
        let first = self.all.len();
        for (i, (scalar, nominal)) in vector.laws.into_iter().zip(nominal).enumerate() {
            let name = format!("{}_{}", place.name, i + 1);
            let (each, field) = law.drawn(&place.field, i);
            let each = self.each(&field, each)?;
            self.push([&name, &place.name], place.unit, *nominal, (scalar, each), target(i));
        }
        for (a, b, coefficient) in vector.pairs {
            self.pairs.push((first + a, first + b, coefficient));
            self.fields.push(format!("{}.covariance", place.field));
        }
        Ok(())
    }

    /// That two quantities are drawn for the same, if they are correlated at all: what is drawn for a flight would
    /// hold a part that all flights of a vehicle have.
    fn together(
        &self,
        field: &str,
        a: usize,
        b: usize,
        coefficient: f64,
    ) -> Result<(), ScenarioError> {
        let (a, b) = (&self.all[a], &self.all[b]);
        if a.each == b.each || coefficient == 0.0 {
            return Ok(());
        }
        let (of_vehicle, of_flight) = if a.each.is_flight() { (b, a) } else { (a, b) };
        let problem = format!(
            "{:?} is drawn for each vehicle and {:?} for each flight: what is correlated must have the same {DRAWN}",
            of_vehicle.column, of_flight.column
        );
        Err(ScenarioError::field(field, problem))
    }

    /// All of it, correlated as the file says; `names` tells what names the quantities that there are.
    pub(crate) fn correlate(
        mut self,
        given: &[CorrelationFile],
        names: &str,
    ) -> Result<Joint<T>, ScenarioError> {
        for (i, given) in given.iter().enumerate() {
            let field = format!("{CORRELATIONS}[{}]", i + 1);
            let index = |name: &String| {
                self.all.iter().position(|d| d.column == *name).ok_or_else(|| {
                    let all: Vec<_> = self.all.iter().map(|d| d.column.as_str()).collect();
                    let problem = if all.is_empty() {
                        format!("{name:?} is not dispersed, and nothing is: there is nothing to correlate")
                    } else {
                        format!("{name:?} is not dispersed: {names} {}", all.join(", "))
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
                    self.together(&format!("{field}.between"), a, b, given.coefficient)?;
                    self.pairs.push((a, b, given.coefficient));
                    self.fields.push(field.clone());
                }
            }
        }
        let correlation = Correlation::new(&self.pairs).map_err(|error| {
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
        })?;
        Ok(Joint { all: self.all, correlation })
    }
}

impl List {
    fn body(
        &mut self,
        body: Body,
        file: &BodyFile,
        moving: &MovingBody,
    ) -> Result<(), ScenarioError> {
        let (name, d) = (body.name(), &file.dispersion);
        for &parameter in BodyParameter::ALL {
            let target = |i| Target::Body(body, parameter, i);
            let uncertain = uncertain(parameter, moving, d.given(parameter));
            self.parameter(name, name, &uncertain, target)?;
        }
        if !d.inertia_follows_mass.not_at_all() && d.mass_kg.is_none() && d.mass_percent.is_none() {
            let problem = "the mass is not dispersed: it needs mass_kg or mass_percent";
            let field = format!("{name}.dispersion.inertia_follows_mass");
            return Err(ScenarioError::field(field, problem));
        }
        Ok(())
    }

    fn load(
        &mut self,
        load: usize,
        id: LoadId,
        given: &dyn GivenLoad,
    ) -> Result<(), ScenarioError> {
        let Some(d) = given.dispersion() else { return Ok(()) };
        let (place, name) = (load::key(id), id.column());
        for (parameter, uncertain) in &d.parameters {
            let target = |component| Target::Load(load, *parameter, component);
            self.parameter(&place, &name, uncertain, target)?;
        }
        let at = |field: &str| format!("{place}.dispersion.{field}");
        let mut chance = |chance: &str, given: Option<ChanceFile>, target: Target| {
            let Some(given) = given else { return Ok(()) };
            let field = at(&format!("{chance}_probability"));
            let each = self.each(&field, given.drawn)?;
            let law = ScalarLaw::bernoulli(given.probability)
                .map_err(|e| ScenarioError::field(given.key(&field), e))?;
            self.push([&format!("{name}_{chance}"); 2], "", 0.0, (law, each), target);
            Ok(())
        };
        if let (Some(_), Some(start)) = (d.late_probability, d.start) {
            let said = |uncertain: &Uncertain<'_>| match uncertain.law {
                GivenLaw::Number(law, percent) => law.or(percent).is_some(),
                GivenLaw::Vector(law) => law.is_some(),
            };
            let start_of = d.parameters.iter().find(|(parameter, _)| *parameter == start);
            if let Some((_, uncertain)) = start_of.filter(|(_, uncertain)| !said(uncertain)) {
                let problem = format!(
                    "it needs {}_{}, which says how late a late {} is",
                    uncertain.name, uncertain.unit, id.kind
                );
                return Err(ScenarioError::field(at("late_probability"), problem));
            }
            chance("late", d.late_probability, Target::Late(load, start))?;
        }
        chance("failure", d.failure_probability, Target::Fails(load))
    }
}

/// A parameter of what is not a load.
fn uncertain<'a, P: Parameter>(parameter: P, of: &P::Of, law: GivenLaw<'a>) -> Uncertain<'a> {
    let (name, unit, nominal) = (parameter.name(), parameter.unit(), parameter.nominal(of));
    Uncertain { name, unit, nominal, law }
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
