//! A body whose mass, mass centre and inertia are drawn for each run of a simulator.

use gyradius_campaign::Column;

use super::file::SimulatedBodyFile;
use crate::{
    ScenarioError,
    body::Entry,
    scenario::{Each, GivenLaw, List, Uncertain, UncertainBody, check_follows, largest_mass},
};

/// A body whose mass, mass centre and inertia are drawn for each run of a simulator.
#[derive(Clone, Debug)]
pub(super) struct SimulatedBody {
    pub(super) name: String,
    pub(super) uncertain: UncertainBody,
    /// For what its inertia is drawn.
    pub(super) inertia_drawn: Each,
    /// Mass, and mass centre where it is given.
    pub(super) numbers: Vec<Number>,
}

impl SimulatedBody {
    /// The body in a place of the file, after others, whose roots and axes a model draws or none does; what is dispersed of its numbers, of which the first has the number `first` among
    /// all, joins the list.
    pub(super) fn new(
        file: &SimulatedBodyFile,
        draws_roots_and_axes: bool,
        before: &[Self],
        first: usize,
        list: &mut List<usize>,
    ) -> Result<Self, ScenarioError> {
        let (field, name) = (format!("bodies[{}]", before.len() + 1), &file.name);
        check_column(&format!("{field}.name"), name)?;
        if before.iter().any(|other| other.name == *name) {
            let problem = format!("{name:?}: another body has this name");
            return Err(ScenarioError::field(format!("{field}.name"), problem));
        }
        let d = &file.dispersion;
        let at = |key: &str| format!("{field}.dispersion.{key}");
        let motion = [
            ("position_m", d.position_m.is_some()),
            ("velocity_m_per_s", d.velocity_m_per_s.is_some()),
            ("attitude_deg", d.attitude_deg.is_some()),
            ("angular_velocity_rad_per_s", d.angular_velocity_rad_per_s.is_some()),
        ];
        if let Some((key, _)) = motion.into_iter().find(|(_, given)| *given) {
            let problem = "a body of a simulator has mass, mass centre and inertia; what else is uncertain stands in \
                           [[quantities]]";
            return Err(ScenarioError::field(at(key), problem));
        }
        let inertia_drawn = list.possible(&at("inertia_drawn"), d.inertia_drawn)?;
        if d.mass_centre_m.is_some() && file.mass_centre_m.is_none() {
            let problem = format!("the body has no mass centre: it needs {field}.mass_centre_m");
            return Err(ScenarioError::field(at("mass_centre_m"), problem));
        }
        if let Some(centre) = file.mass_centre_m
            && !centre.iter().all(|x| x.is_finite())
        {
            let problem = format!("{centre:?}: every entry must be finite");
            return Err(ScenarioError::field(format!("{field}.mass_centre_m"), problem));
        }
        largest_mass(&field, file.mass_kg)?;
        check_follows(&format!("{field}.dispersion"), d)?;
        if file.law.is_some() && file.mass_centre_m.is_none() {
            let problem = "it says where the mass centre is, and the body needs mass_centre_m";
            return Err(ScenarioError::field(format!("{field}.law"), problem));
        }
        let uncertain = UncertainBody::new(&field, &file.at_rest(draws_roots_and_axes))?;
        let mass = Uncertain {
            name: "mass",
            unit: "kg",
            nominal: vec![file.mass_kg],
            law: GivenLaw::Number(d.mass_kg.as_ref(), d.mass_percent.as_ref()),
        };
        let (law, place) = (uncertain.given_law(), [field.as_str(), name]);
        let own = law.map(|law| std::slice::from_ref(law.mass()));
        list.of_body(place, &mass, own, inertia_drawn, |_| first)?;
        let meaning = format!("Mass of the body {name}, as drawn.");
        let column = Column::number(format!("{name}_mass_kg"), "kg", meaning);
        let mut numbers = vec![Number { column, nominal: file.mass_kg }];
        if let Some(nominal) = file.mass_centre_m {
            let centre = Uncertain {
                name: "mass_centre",
                unit: "m",
                nominal: nominal.to_vec(),
                law: GivenLaw::Vector(d.mass_centre_m.as_ref()),
            };
            let target = |i| first + 1 + i;
            let own = law.map(|law| &law.centre()[..]);
            list.of_body(place, &centre, own, inertia_drawn, target)?;
            for (i, nominal) in nominal.into_iter().enumerate() {
                let meaning = format!(
                    "Coordinate {} of the mass centre of the body {name}, as drawn.",
                    i + 1
                );
                let column =
                    Column::number(format!("{name}_mass_centre_{}_m", i + 1), "m", meaning);
                numbers.push(Number { column, nominal });
            }
        }
        let nominal = file.mass_centre_m.unwrap_or_default();
        let centre = [0, 1, 2].map(|i| (first + 1 + i, nominal[i]));
        // Without a mass centre, numbers of others stand there.
        let none = usize::MAX;
        let centre = if file.mass_centre_m.is_some() { centre } else { [(none, 0.0); 3] };
        list.join([&field, name], &uncertain, inertia_drawn, (first, file.mass_kg), centre)?;
        let name = name.clone();
        Ok(Self { name, uncertain, inertia_drawn, numbers })
    }

    /// The columns of the six entries of its inertia.
    pub(super) fn entries(&self) -> [String; 6] {
        Entry::ALL.map(|entry| format!("{}_i{}", self.name, digits(entry)))
    }

    /// Its numbers, the six entries of the inertia, and the attitude of the principal axes.
    pub(super) fn columns(&self) -> impl Iterator<Item = Column> {
        let name = &self.name;
        let entry = move |entry: Entry| {
            let digits = digits(entry);
            let meaning = format!(
                "Entry {digits} of the inertia matrix of the body {name} as drawn, about its mass centre, body axes."
            );
            Column::number(format!("{name}_i{digits}"), "kg·m²", meaning)
        };
        let axes = move |i: usize| {
            let meaning = format!(
                "Component of the attitude of the principal axes of the body {name} as drawn, scalar last; none for \
                 entrywise models."
            );
            Column::number(format!("{name}_q{i}"), "1", meaning)
        };
        let numbers = self.numbers.iter().map(|number| number.column.clone());
        numbers.chain(Entry::ALL.into_iter().map(entry)).chain((1..=4).map(axes))
    }
}

/// The axes of an entry: `12`.
fn digits(entry: Entry) -> String {
    format!("{entry:?}").replace('I', "")
}

/// A number that is sent, and what it is where nothing is drawn.
#[derive(Clone, Debug)]
pub(super) struct Number {
    pub(super) column: Column,
    pub(super) nominal: f64,
}

/// Names of bodies, quantities and outputs are keys in JSON and columns.
pub(super) fn check_column(field: &str, name: &str) -> Result<(), ScenarioError> {
    let letters = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let begins = name.starts_with(|c: char| c.is_ascii_alphabetic());
    if begins && name.len() <= 64 && name.chars().all(letters) {
        return Ok(());
    }
    let problem = format!(
        "{name:?}: it must be 1 to 64 letters, digits and underscores, and begin with a letter, for it names a column"
    );
    Err(ScenarioError::field(field, problem))
}
