//! What else is uncertain than the inertias, in the order in which it is drawn.

use gyradius_dispersion::{MassPropertiesLaw, ScalarLaw};
use gyradius_separation::{
    BodyParameter, LoadId, MovingBody, Parameter, Separation, StackParameter,
};

use super::{
    ScenarioError,
    body::UncertainBody,
    chance::ChanceFile,
    each::Each,
    file::{BodyFile, DispersionFile, FOLLOWS, ScenarioFile},
    follows::Follows,
    joint::{Dispersed, Joint, Target},
    law::GivenLaw,
    list::List,
    load::{self, GivenLoad, Uncertain},
};
use crate::{body::Body, fleet::Fleet};

/// What is uncertain of a separation besides the inertias.
#[derive(Clone, Debug, Default)]
pub(crate) struct Dispersions {
    pub(crate) joint: Joint<Target>,
    /// For what the inertias of payload and stage are drawn.
    pub(crate) inertia: [Each; 2],
}

impl Dispersions {
    /// Of a scenario, and its separation without dispersions.
    pub(crate) fn new(
        file: &ScenarioFile,
        fleet: Option<Fleet>,
        separation: &Separation,
        [payload, stage]: [&UncertainBody; 2],
    ) -> Result<Self, ScenarioError> {
        let mut list = List::of(fleet);
        list.body(Body::Payload, &file.payload, separation.payload(), payload)?;
        list.body(Body::Stage, &file.stage, separation.stage(), stage)?;
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
        let inertia = |name: Body, body: &BodyFile| {
            let field = format!("{}.dispersion.inertia_drawn", name.name());
            list.possible(&field, body.dispersion.inertia_drawn)
        };
        let inertia = [inertia(Body::Payload, &file.payload)?, inertia(Body::Stage, &file.stage)?];
        let joint = list.correlate(
            &file.correlations,
            "the dispersion of payload, stage, stack and springs names",
        )?;
        Ok(Self { joint, inertia })
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

impl List {
    fn body(
        &mut self,
        body: Body,
        file: &BodyFile,
        moving: &MovingBody,
        own: &UncertainBody,
    ) -> Result<(), ScenarioError> {
        let (name, d) = (body.name(), &file.dispersion);
        let each = self.possible(&format!("{name}.dispersion.inertia_drawn"), d.inertia_drawn)?;
        let target = |parameter| move |i| Target::Body(body, parameter, i);
        for &parameter in BodyParameter::ALL {
            let uncertain = uncertain(parameter, moving, d.given(parameter));
            let laws = own.given_law().and_then(|law| given(law, parameter));
            self.of_body([name; 2], &uncertain, laws, each, target(parameter))?;
        }
        check_follows(&format!("{name}.dispersion"), d)?;
        let (mass, centre) = (target(BodyParameter::Mass), target(BodyParameter::MassCentre));
        let centre = [0, 1, 2].map(|i| (centre(i), 0.0));
        self.join([name; 2], own, each, (mass(0), file.mass_kg), centre)
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
            let name = format!("{name}_{chance}");
            self.push([&name, &name, &field], "", 0.0, (law, each, None), target);
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

/// What a whole law says of a parameter of a body.
fn given(law: &MassPropertiesLaw, parameter: BodyParameter) -> Option<&[ScalarLaw]> {
    match parameter {
        BodyParameter::Mass => Some(std::slice::from_ref(law.mass())),
        BodyParameter::MassCentre => Some(law.centre()),
        BodyParameter::Position
        | BodyParameter::Velocity
        | BodyParameter::Attitude
        | BodyParameter::AngularVelocity => None,
    }
}

/// That an inertia that follows the mass has a mass to follow, of a dispersion at a place.
pub(crate) fn check_follows(place: &str, file: &DispersionFile) -> Result<(), ScenarioError> {
    let dispersed = file.mass_kg.is_some() || file.mass_percent.is_some();
    if dispersed || Follows::not_at_all(&file.inertia_follows_mass) {
        return Ok(());
    }
    // Lengths say it of themselves, whether the mass is dispersed or not.
    if file.gyration_lengths_m.is_some() {
        return Ok(());
    }
    let problem = "the mass is not dispersed: it needs mass_kg or mass_percent";
    Err(ScenarioError::field(format!("{place}.{FOLLOWS}"), problem))
}

/// A parameter of what is not a load.
fn uncertain<'a, P: Parameter>(parameter: P, of: &P::Of, law: GivenLaw<'a>) -> Uncertain<'a> {
    let (name, unit, nominal) = (parameter.name(), parameter.unit(), parameter.nominal(of));
    Uncertain { name, unit, nominal, law }
}
