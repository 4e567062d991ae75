//! What else is uncertain than the inertias, in the order in which it is drawn.

use gyradius_dispersion::{Correlation, CorrelationError, LawUnit, ScalarLaw, ScalarLawForm};

use super::{
    ScenarioError,
    file::{BodyFile, ScenarioFile, SpringFile},
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

/// What a number is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Target {
    Body(Body, BodyPart),
    Stack(StackPart),
    /// Which spring, from 0.
    Spring(usize, SpringPart),
}

/// Components of vectors are numbered from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BodyPart {
    Mass,
    MassCentre(usize),
    Position(usize),
    Velocity(usize),
    Attitude(usize),
    AngularVelocity(usize),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StackPart {
    Attitude(usize),
    AngularVelocity(usize),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SpringPart {
    Stiffness,
    Stroke,
    Friction,
    LineOfAction(usize),
    PayloadPoint(usize),
    StagePoint(usize),
    Start,
    Late,
    Fails,
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
    pub(crate) fn new(file: &ScenarioFile) -> Result<Self, ScenarioError> {
        let mut list = List::default();
        for (body, file) in [(Body::Payload, &file.payload), (Body::Stage, &file.stage)] {
            list.body(body, file)?;
        }
        if let Some(stack) = file.stack.as_ref().and_then(|s| s.dispersion.as_ref()) {
            let zero = [0.0; 3];
            let target = |i| Target::Stack(StackPart::Attitude(i));
            let place = Place::new("stack.dispersion.attitude_deg", "stack_attitude", "deg");
            list.vector(&place, stack.attitude_deg.as_ref(), &zero, target)?;
            let target = |i| Target::Stack(StackPart::AngularVelocity(i));
            let place = "stack.dispersion.angular_velocity_rad_per_s";
            let place = Place::new(place, "stack_angular_velocity", "rad_per_s");
            list.vector(&place, stack.angular_velocity_rad_per_s.as_ref(), &zero, target)?;
        }
        for (i, spring) in file.springs.iter().enumerate() {
            list.spring(i, spring)?;
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

/// Where in the file, and what it is called.
struct Place {
    field: String,
    name: String,
    unit: &'static str,
}

impl Place {
    fn new(field: impl Into<String>, name: impl Into<String>, unit: &'static str) -> Self {
        Self { field: field.into(), name: name.into(), unit }
    }
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

    fn scalar(
        &mut self,
        place: &Place,
        law: Option<&ScalarLawForm>,
        nominal: f64,
        target: Target,
    ) -> Result<(), ScenarioError> {
        if let Some(law) = law {
            let law = law::about(law, &place.field, nominal, LawUnit::OWN)?;
            positive(&place.field, nominal, &law)?;
            self.push(&place.name, place.unit, nominal, law, target);
        }
        Ok(())
    }

    /// A number given in its unit or in percent.
    fn either(
        &mut self,
        place: &Place,
        law: Option<&ScalarLawForm>,
        percent: (&str, Option<&ScalarLawForm>),
        nominal: f64,
        target: Target,
    ) -> Result<(), ScenarioError> {
        match (law, percent) {
            (Some(_), (field, Some(_))) => {
                let problem = format!("there is {} already: one of the two says it", place.field);
                Err(ScenarioError::field(field, problem))
            }
            (None, (field, Some(law))) => {
                let law = law::about(law, field, nominal, LawUnit::percent_of(nominal))?;
                positive(field, nominal, &law)?;
                self.push(&place.name, place.unit, nominal, law, target);
                Ok(())
            }
            (law, _) => self.scalar(place, law, nominal, target),
        }
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

    fn body(&mut self, body: Body, file: &BodyFile) -> Result<(), ScenarioError> {
        let name = body.name();
        let of = |part| Target::Body(body, part);
        let at = |field: &str| format!("{name}.dispersion.{field}");
        let d = &file.dispersion;
        let place = Place::new(at("mass_kg"), format!("{name}_mass"), "kg");
        let percent = at("mass_percent");
        let percent = (percent.as_str(), d.mass_percent.as_ref());
        self.either(&place, d.mass_kg.as_ref(), percent, file.mass_kg, of(BodyPart::Mass))?;
        if !d.inertia_follows_mass.not_at_all() && d.mass_kg.is_none() && d.mass_percent.is_none() {
            let problem = "the mass is not dispersed: it needs mass_kg or mass_percent";
            return Err(ScenarioError::field(at("inertia_follows_mass"), problem));
        }
        let place = |field: &str, quantity: &str, unit| {
            Place::new(at(field), format!("{name}_{quantity}"), unit)
        };
        let zero = [0.0; 3];
        let p = place("mass_centre_m", "mass_centre", "m");
        self.vector(&p, d.mass_centre_m.as_ref(), &zero, |i| of(BodyPart::MassCentre(i)))?;
        let p = place("position_m", "position", "m");
        let nominal = &file.position_m;
        self.vector(&p, d.position_m.as_ref(), nominal, |i| of(BodyPart::Position(i)))?;
        let p = place("velocity_m_per_s", "velocity", "m_per_s");
        let nominal = &file.velocity_m_per_s;
        self.vector(&p, d.velocity_m_per_s.as_ref(), nominal, |i| of(BodyPart::Velocity(i)))?;
        let p = place("attitude_deg", "attitude", "deg");
        self.vector(&p, d.attitude_deg.as_ref(), &zero, |i| of(BodyPart::Attitude(i)))?;
        let p = place("angular_velocity_rad_per_s", "angular_velocity", "rad_per_s");
        let (law, nominal) = (&d.angular_velocity_rad_per_s, &file.angular_velocity_rad_per_s);
        self.vector(&p, law.as_ref(), nominal, |i| of(BodyPart::AngularVelocity(i)))
    }

    fn spring(&mut self, spring: usize, file: &SpringFile) -> Result<(), ScenarioError> {
        let Some(d) = &file.dispersion else { return Ok(()) };
        let of = |part| Target::Spring(spring, part);
        let at = |field: &str| format!("springs[{}].dispersion.{field}", spring + 1);
        let place = |field: &str, quantity: &str, unit| {
            Place::new(at(field), format!("spring_{}_{quantity}", spring + 1), unit)
        };
        let p = place("stiffness_n_per_m", "stiffness", "n_per_m");
        let percent = at("stiffness_percent");
        let percent = (percent.as_str(), d.stiffness_percent.as_ref());
        let nominal = file.stiffness_n_per_m;
        let law = d.stiffness_n_per_m.as_ref();
        self.either(&p, law, percent, nominal, of(SpringPart::Stiffness))?;
        let p = place("stroke_m", "stroke", "m");
        let percent = at("stroke_percent");
        let percent = (percent.as_str(), d.stroke_percent.as_ref());
        self.either(&p, d.stroke_m.as_ref(), percent, file.stroke_m, of(SpringPart::Stroke))?;
        let p = place("friction_n", "friction", "n");
        let nominal = file.friction_n.unwrap_or(0.0);
        self.scalar(&p, d.friction_n.as_ref(), nominal, of(SpringPart::Friction))?;
        let p = place("line_of_action_deg", "line_of_action", "deg");
        let law = d.line_of_action_deg.as_ref();
        self.vector(&p, law, &[0.0; 2], |i| of(SpringPart::LineOfAction(i)))?;
        let p = place("payload_point_m", "payload_point", "m");
        let (law, nominal) = (d.payload_point_m.as_ref(), &file.payload_point_m);
        self.vector(&p, law, nominal, |i| of(SpringPart::PayloadPoint(i)))?;
        let p = place("stage_point_m", "stage_point", "m");
        let (law, nominal) = (d.stage_point_m.as_ref(), &file.stage_point_m);
        self.vector(&p, law, nominal, |i| of(SpringPart::StagePoint(i)))?;
        let p = place("start_s", "start", "s");
        let nominal = file.start_s.unwrap_or(0.0);
        self.scalar(&p, d.start_s.as_ref(), nominal, of(SpringPart::Start))?;
        if d.late_probability.is_some() && d.start_s.is_none() {
            let problem = "it needs start_s, which says how late a late spring is";
            return Err(ScenarioError::field(at("late_probability"), problem));
        }
        let chances = [
            ("late", d.late_probability, SpringPart::Late),
            ("failure", d.failure_probability, SpringPart::Fails),
        ];
        for (name, probability, part) in chances {
            if let Some(p) = probability {
                let field = at(&format!("{name}_probability"));
                let law = ScalarLaw::bernoulli(p).map_err(|e| ScenarioError::field(field, e))?;
                self.push(&format!("spring_{}_{name}", spring + 1), "", 0.0, law, of(part));
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
