//! What is uncertain, as it is put together from a scenario file.

use gyradius_dispersion::{Correlation, CorrelationProblem, JointScalar, LawUnit, ScalarLaw};

use super::{
    ScenarioError,
    body::UncertainBody,
    each::{DRAWN, Each},
    file::CorrelationFile,
    joint::{Change, Dispersed, Joint, Number, Target},
    joint_body::{JointBody, Quantity, part, region_key},
    law::{self, GivenLaw, VectorLawFile},
    load::{self, Uncertain},
    scalar::ScalarLawFile,
    vehicles,
};
use crate::fleet::Fleet;

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
    bodies: Vec<Listed>,
}

/// A body as it is put together.
struct Listed {
    place: String,
    region_key: String,
    joint: JointBody,
    /// Its roots, if they can be numbers of their own.
    roots: Vec<Dispersed<usize>>,
    /// What a whole law correlates.
    law: Option<Correlation>,
}

impl<T> List<T> {
    /// Nothing yet, of a scenario with vehicles or without.
    pub(crate) fn of(fleet: Option<Fleet>) -> Self {
        let (all, pairs, fields) = (Vec::new(), Vec::new(), Vec::new());
        Self { fleet, all, pairs, fields, bodies: Vec::new() }
    }

    /// A number that a user gave a name, and the place of its law.
    pub(crate) fn named(
        &mut self,
        name: &str,
        given: String,
        nominal: f64,
        (law, each): (ScalarLaw, Each),
        target: T,
    ) {
        let [column, part_of] = [name; 2].map(str::to_owned);
        let change = None;
        self.all.push(Dispersed { column, part_of, given, nominal, law, each, target, change });
    }

    /// A number with a name that ends in its unit, if it has one, the parameter that it is part of, and the place of its law; with how the
    /// file says its change from the nominal value, if the law is of that.
    pub(crate) fn push(
        &mut self,
        [name, parameter, given]: [&str; 3],
        unit: &str,
        nominal: f64,
        (law, each, change): (ScalarLaw, Each, Option<Change>),
        target: T,
    ) {
        let column = if unit.is_empty() { name.to_owned() } else { format!("{name}_{unit}") };
        let (part_of, given) = (in_words(parameter), given.to_owned());
        self.all.push(Dispersed { column, part_of, given, nominal, law, each, target, change });
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
        let (each, form) = (self.each(field, law.drawn)?, &law.form);
        let law = law::about(form, field, nominal, unit)?;
        positive(field, nominal, &law)?;
        let (names, change) =
            ([&*place.name, &place.name, field], Change { form: form.clone(), unit });
        self.push(names, place.unit, nominal, (law, each, Some(change)), target);
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
            let (form, each, field) = law.component(&place.field, i);
            let each = self.each(&field, each)?;
            let names = [name.as_str(), &place.name, &field];
            let change = form.map(|form| Change { form: form.clone(), unit: LawUnit::OWN });
            self.push(names, place.unit, *nominal, (scalar, each, change), target(i));
        }
        for (a, b, coefficient) in vector.pairs {
            self.pairs.push((first + a, first + b, coefficient));
            self.fields.push(format!("{}.covariance", place.field));
        }
        Ok(())
    }

    /// A parameter of the body that stands at a place of the file and is called by a name, whose laws may be given as part of a
    /// whole law that is drawn for this.
    pub(crate) fn of_body(
        &mut self,
        [place, name]: [&str; 2],
        uncertain: &Uncertain<'_>,
        laws: Option<&[ScalarLaw]>,
        each: Each,
        target: impl Fn(usize) -> T,
    ) -> Result<(), ScenarioError> {
        let Some(laws) = laws else { return self.parameter(place, name, uncertain, target) };
        let Uncertain { name: quantity, unit, nominal, law: _ } = uncertain;
        let (parameter, given) = (format!("{name}_{quantity}"), format!("{place}.law"));
        for (i, (law, nominal)) in laws.iter().zip(nominal).enumerate() {
            let component = format!("{parameter}_{}", i + 1);
            let name = if laws.len() > 1 { &component } else { &parameter };
            let names = [name.as_str(), &parameter, &given];
            self.push(names, unit, *nominal, (law.clone(), each, None), target(i));
        }
        Ok(())
    }

    /// How mass, mass centre and inertia of a body go together, whose numbers have these targets and nominal values, and
    /// whose inertia is drawn for this.
    pub(crate) fn join(
        &mut self,
        [place, name]: [&str; 2],
        body: &UncertainBody,
        each: Each,
        mass: (T, f64),
        centre: [(T, f64); 3],
    ) -> Result<(), ScenarioError>
    where
        T: PartialEq,
    {
        let quantity = |(target, nominal): (T, f64)| {
            let place = self.all.iter().position(|d| d.target == target);
            Quantity { place, nominal }
        };
        let (share, reference_kg) = body.follows();
        let (region, region_key) = (body.region().cloned(), region_key(place, body));
        let (mass, centre) = (quantity(mass), centre.map(quantity));
        let joint = JointBody { mass, centre, share, reference_kg, region, roots: None };
        if joint.region.is_some()
            && let Some(other) = joint.numbers().map(|i| &self.all[i]).find(|d| d.each != each)
        {
            let problem = format!(
                "{:?} is not drawn for the same as the inertia, as inertia_drawn says it: what is kept to a region is \
                 drawn together",
                other.column
            );
            return Err(ScenarioError::field(region_key, problem));
        }
        let number = self.bodies.len();
        let roots = body.root_numbers().map(|([quantity, unit], laws)| {
            let parameter = format!("{name}_{quantity}");
            let root = |(i, law): (usize, &ScalarLaw)| Dispersed {
                column: format!("{parameter}_{}_{unit}", i + 1),
                part_of: in_words(&parameter),
                given: part(place, body),
                nominal: law.mean(),
                law: law.clone(),
                each,
                target: number,
                change: None,
            };
            laws.iter().enumerate().map(root).collect()
        });
        let (place, roots) = (place.to_owned(), roots.unwrap_or_default());
        let law = body.given_law().map(|law| law.correlation().clone());
        self.bodies.push(Listed { place, region_key, joint, roots, law });
        Ok(())
    }

    /// All of it, correlated as the file says; `what` tells what names the quantities that there are.
    pub(crate) fn correlate(
        mut self,
        given: &[CorrelationFile],
        what: &str,
    ) -> Result<Joint<T>, ScenarioError> {
        let named = |d: &Dispersed<usize>| given.iter().any(|g| g.between.contains(&d.column));
        let mut roots: Vec<Dispersed<usize>> = Vec::new();
        for body in &mut self.bodies {
            let shape = JointScalar::ALL.map(|scalar| scalar as usize);
            let by_law = |law: &Correlation| shape[4..].iter().any(|scalar| law.has(*scalar));
            if body.roots.iter().any(named) || body.law.as_ref().is_some_and(by_law) {
                body.joint.roots = Some(self.all.len() + roots.len());
                roots.append(&mut body.roots);
            }
        }
        let offered = self.bodies.iter().flat_map(|body| &body.roots);
        let mut names: Vec<&str> = Vec::new();
        names.extend(self.all.iter().map(|d| d.column.as_str()));
        names.extend(roots.iter().chain(offered).map(|d| d.column.as_str()));
        let all = self.all.iter().map(Dispersed::number);
        let numbers: Vec<Number<'_>> = all.chain(roots.iter().map(Dispersed::number)).collect();
        for (i, given) in given.iter().enumerate() {
            let field = format!("{CORRELATIONS}[{}]", i + 1);
            let index = |name: &String| {
                numbers.iter().position(|number| number.column == *name).ok_or_else(|| {
                    let problem = if names.is_empty() {
                        format!("{name:?} is not dispersed, and nothing is: there is nothing to correlate")
                    } else {
                        format!("{name:?} is not dispersed: {what} {}", names.join(", "))
                    };
                    ScenarioError::field(format!("{field}.between"), problem)
                })
            };
            let members = given.between.iter().map(index).collect::<Result<Vec<_>, _>>()?;
            if members.len() < 2 {
                let problem = format!("{:?}: it must name at least two quantities", given.between);
                return Err(ScenarioError::field(format!("{field}.between"), problem));
            }
            if let Some(still) = members.iter().find(|i| !(numbers[**i].law.deviation() > 0.0)) {
                let Number { column, given, .. } = numbers[*still];
                let problem = format!(
                    "{column:?} does not vary: all values of {given} are the same, as with a sigma of zero. Give it another law, or leave the name away here"
                );
                return Err(ScenarioError::field(format!("{field}.between"), problem));
            }
            for (j, &b) in members.iter().enumerate() {
                for &a in &members[..j] {
                    together(&numbers, &format!("{field}.between"), a, b, given.coefficient)?;
                    self.pairs.push((a, b, given.coefficient));
                    self.fields.push(field.clone());
                }
            }
        }
        for body in &self.bodies {
            let Some(law) = &body.law else { continue };
            for (a, b, coefficient) in body.joint.correlated_by(law) {
                self.pairs.push((a, b, coefficient));
                self.fields.push(format!("{}.law.correlations", body.place));
            }
        }
        let correlation = Correlation::new(&self.pairs).map_err(|error| {
            let (pair, problem) = (error.pair, error.problem);
            let field = match (problem, self.fields[pair].as_str()) {
                (CorrelationProblem::NoPair | CorrelationProblem::Twice, field)
                    if field.starts_with(CORRELATIONS) =>
                {
                    format!("{field}.between")
                }
                (_, field) if field.starts_with(CORRELATIONS) => format!("{field}.coefficient"),
                (_, field) => field.to_owned(),
            };
            let (a, b, _) = self.pairs[pair];
            let (a, b) = (numbers[a].column, numbers[b].column);
            ScenarioError::field(field, format!("{a:?} and {b:?}: {problem}"))
        })?;
        let bodies = self.bodies.iter().map(|body| body.joint.clone()).collect();
        let joint = Joint { all: self.all, roots, correlation, bodies };
        check_regions(&joint, &self.bodies)?;
        Ok(joint)
    }
}

/// That two quantities are drawn for the same, if they are correlated at all: what is drawn for a flight would
/// hold a part that all flights of a vehicle have.
fn together(
    numbers: &[Number<'_>],
    field: &str,
    a: usize,
    b: usize,
    coefficient: f64,
) -> Result<(), ScenarioError> {
    let (a, b) = (numbers[a], numbers[b]);
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

/// The name of a parameter in words: `payload mass centre`.
fn in_words(parameter: &str) -> String {
    parameter.replace('_', " ")
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

/// That no two bodies that are kept to regions depend on each other, for of both together it is not known how many
/// draws are kept.
fn check_regions<T>(joint: &Joint<T>, bodies: &[Listed]) -> Result<(), ScenarioError> {
    let kept = |body: &&JointBody| body.region.is_some();
    let own = joint.bodies.iter().filter(kept).flat_map(JointBody::together);
    let sets = joint.sets(joint.numbers().count(), own);
    let mut seen: Vec<usize> = Vec::new();
    for (body, listed) in joint.bodies.iter().zip(bodies).filter(|(body, _)| kept(body)) {
        let Some(set) = body.numbers().next().map(|number| sets[number]) else { continue };
        if seen.contains(&set) {
            let problem = "what is drawn of the body is correlated with that of another that is kept to a region: at \
                           most one of them can be";
            return Err(ScenarioError::field(&listed.region_key, problem));
        }
        seen.push(set);
    }
    Ok(())
}
